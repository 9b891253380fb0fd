"""What the tests of VTK's XML files share: two spheres in a file, and where the files of programs are."""

from __future__ import annotations

from pathlib import Path

from bedrad.packings.files.contents import Contents
from bedrad.packings.files.lammps_dump import read_dump

DATA = Path(__file__).parents[1] / "data" / "vtk"

SMALL = """\
<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian">
<PolyData>
<Piece NumberOfPoints="2" NumberOfVerts="0">
<PointData>
<DataArray type="Int32" Name="id" format="ascii">9 4</DataArray>
<DataArray type="Float64" Name="radius" format="ascii">0.5 0.25</DataArray>
<DataArray type="Float32" Name="v" NumberOfComponents="3" format="ascii">not read</DataArray>
</PointData>
<Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 2
0 0 -1<InformationKey name="L2_NORM_RANGE"><Value index="0">7</Value></InformationKey></DataArray>
</Points>
</Piece>
</PolyData>
</VTKFile>
"""


def put(tmp_path: Path, content: str | bytes, name: str = "bed.vtp") -> Path:
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def plain() -> Contents:
    """The spheres in all digits, from the text dump that the same run of LIGGGHTS wrote."""
    return read_dump(DATA / "plain2000.dump")


def collection(*names: str, times: str = "0123") -> str:
    """A collection of files, one a time."""
    files = "".join(
        f'<DataSet timestep="{time}" part="0" file="{name}"/>' for time, name in zip(times, names, strict=False)
    )
    return f'<VTKFile type="Collection"><Collection>{files}</Collection></VTKFile>'
