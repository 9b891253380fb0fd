"""Write the spheres of plain2000.dump with VTK's own writers: python write_with_vtk.py (pip install vtk)."""

from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

ROWS = np.loadtxt(Path(__file__).with_name("plain2000.dump"), skiprows=9)


def named(name, array):
    array.SetName(name)
    return array


def spheres(kind):
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(ROWS[:, 2:5].copy(), deep=True))
    data = kind()
    data.SetPoints(points)
    about = data.GetPointData()
    velocities = named("v of it", numpy_to_vtk(np.ones((12, 3), dtype=np.float32), deep=True))
    for component, name in enumerate("xyz"):
        velocities.SetComponentName(component, name)
    about.AddArray(velocities)
    about.AddArray(named("id", numpy_to_vtk(ROWS[:, 0].astype(np.int64), deep=True)))
    about.AddArray(named("Radius", numpy_to_vtk(ROWS[:, 5].copy(), deep=True)))
    texts = named("texts", vtk.vtkStringArray())
    texts.InsertNextValue("a text of more than sixty-three letters, so that its length needs two bytes")
    texts.InsertNextValue("")
    bits = named("bits", vtk.vtkBitArray())
    for bit in (1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1):
        bits.InsertNextValue(bit)
    for array in (texts, bits):
        data.GetFieldData().AddArray(array)
    cells = vtk.vtkCellArray()
    for number in range(12):
        cells.InsertNextCell(1)
        cells.InsertCellPoint(number)
    if kind is vtk.vtkPolyData:
        data.SetVerts(cells)
    else:
        data.SetCells(vtk.VTK_VERTEX, cells)
    return data


def write_xml(name, *, mode, compressor, order="Little", header=32, base64=False):
    poly = name.endswith("vtp")
    writer = vtk.vtkXMLPolyDataWriter() if poly else vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(spheres(vtk.vtkPolyData if poly else vtk.vtkUnstructuredGrid))
    getattr(writer, f"SetDataModeTo{mode}")()
    getattr(writer, f"SetCompressorTypeTo{compressor}")()
    getattr(writer, f"SetByteOrderTo{order}Endian")()
    getattr(writer, f"SetHeaderTypeToUInt{header}")()
    writer.SetEncodeAppendedData(base64)
    if compressor != "None":
        # 64 bytes: several blocks, the last of them shorter
        writer.SetBlockSize(64)
    writer.SetFileName(name)
    writer.Write()


def write_legacy(name, *, kind, version, text):
    writer = vtk.vtkPolyDataWriter() if kind is vtk.vtkPolyData else vtk.vtkUnstructuredGridWriter()
    writer.SetInputData(spheres(kind))
    writer.SetFileVersion(version)
    getattr(writer, "SetFileTypeToASCII" if text else "SetFileTypeToBinary")()
    writer.SetFileName(name)
    writer.Write()


write_xml("vtk_text.vtp", mode="Ascii", compressor="None")
write_xml("vtk_base64.vtp", mode="Binary", compressor="None", order="Big", header=64)
write_xml("vtk_base64_lzma.vtu", mode="Binary", compressor="LZMA", header=64)
write_xml("vtk_appended_raw_zlib.vtp", mode="Appended", compressor="ZLib", order="Big")
write_xml("vtk_appended_base64_zlib.vtu", mode="Appended", compressor="ZLib", base64=True)
write_xml("vtk_lz4.vtp", mode="Appended", compressor="LZ4")
write_legacy("vtk_4.2_binary.vtk", kind=vtk.vtkUnstructuredGrid, version=42, text=False)
write_legacy("vtk_4.2_text.vtk", kind=vtk.vtkPolyData, version=42, text=True)
write_legacy("vtk_5.1_binary.vtk", kind=vtk.vtkPolyData, version=51, text=False)
write_legacy("vtk_5.1_text.vtk", kind=vtk.vtkUnstructuredGrid, version=51, text=True)
