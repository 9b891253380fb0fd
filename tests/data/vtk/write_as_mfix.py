"""Write the spheres of plain2000.dump in the form that MFiX gives its .vtp and .pvd files: python write_as_mfix.py."""

from pathlib import Path

import numpy as np

ROWS = np.loadtxt(Path(__file__).with_name("plain2000.dump"), skiprows=9)


def write(name, shift, time):
    columns = (ROWS[:, 2:5] + [0, 0, shift], 2 * ROWS[:, 5], np.ones((12, 3)), ROWS[:, 0])
    # blanks before the numbers and the underscore, UInt32 counts without saying so, vertices that nothing declares
    arrays = [array.astype(">f4").tobytes() for array in columns]
    arrays += [np.arange(12, dtype=">i4").tobytes(), np.arange(1, 13, dtype=">i4").tobytes()]
    offsets = np.cumsum([0, *(4 + len(array) for array in arrays)])
    head = f"""<?xml version="1.0"?>
 <!-- Time =  {time:.16f}       sec. -->
<VTKFile type="PolyData" version="0.1" byte_order="BigEndian">
  <PolyData>
     <Piece NumberOfPoints="          12 "  NumberOfVerts="           0 " NumberOfLines ="0" NumberOfStrips="0" \
NumberOfPolys="0" >
       <Points>
         <DataArray type="Float32" Name="coordinates" NumberOfComponents="3" format="appended" \
offset="{offsets[0]:12d} " />
       </Points>
 <PointData Scalars="Diameter" Vectors="Velocity">
        <DataArray type="Float32" Name="Diameter" format="appended" offset="{offsets[1]:12d}" />
        <DataArray type="Float32" Name="Velocity"  NumberOfComponents="3" format="appended" offset="{offsets[2]:12d}" />
        <DataArray type="Float32" Name="Particle_ID" format="appended" offset="{offsets[3]:12d}" />
       </PointData>
       <Verts> </Verts>
       <Lines> </Lines>
       <Strips> </Strips>
       <Polys> </Polys>
     </Piece>
   </PolyData>
   <AppendedData encoding="raw">
 _"""
    data = b"".join(len(array).to_bytes(4, "big") + array for array in arrays)
    Path(name).write_bytes(head.encode() + data + b"\n   </AppendedData>\n </VTKFile>\n")


write("mfix_0000.vtp", 0.0, 0.0)
write("mfix_0001.vtp", -1e-4, 0.005)
Path("mfix.pvd").write_text("""<?xml version="1.0"?>
<VTKFile type="Collection" version="0.1" byte_order="BigEndian">
<Collection>
<DataSet timestep="    0.000000000000000E+00" group="" part="0" file="mfix_0000.vtp"/>
<DataSet timestep="    5.000000000000000E-03" group="" part="0" file="mfix_0001.vtp"/>
</Collection>
</VTKFile>
""")
