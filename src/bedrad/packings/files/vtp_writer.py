"""Packings as VTK's XML PolyData, which ParaView opens and `read_vtk_xml` gives back bit for bit."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.files.facts import fact_texts
from bedrad.packings.files.vtk_points import is_wanted
from bedrad.packings.files.vtk_xml_document import FIELD_PREFIX
from bedrad.packings.packing import Packing

__all__ = ["write_vtp"]

_TYPES = {"<f8": "Float64", "<i8": "Int64", "|u1": "UInt8"}
_HEADER_BYTES = 8


class _Appended:
    """The arrays that come after the XML, and how far each is from their beginning."""

    def __init__(self) -> None:
        self.arrays: list[NDArray[Any]] = []
        self._length = 0

    def element(self, name: str, values: NDArray[Any]) -> str:
        """Keep an array; returns the element that refers to it."""
        components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
        kind = _TYPES[values.dtype.str]
        text = (
            f'<DataArray type="{kind}" Name={quoteattr(name)}{components} format="appended" offset="{self._length}"/>'
        )
        self.arrays.append(values)
        self._length += _HEADER_BYTES + values.nbytes
        return text


def write_vtp(packing: Packing, path: Path, arrays: Mapping[str, NDArray[Any]] | None = None) -> None:
    """Write a packing as a ``.vtp`` file, overwriting `path`.

    The points are the centres [m], each with a vertex so that it is seen; the point arrays are ``radius`` [m], ``id``
    (the number of the sphere, from 0) and those given. Wall, period, overlap limit and provenance are texts in the
    field data.

    Parameters
    ----------
    packing : Packing
        The packing.
    path : pathlib.Path
        The file.
    arrays : mapping of str to (n,) or (n, 3) array, optional
        More about every sphere: numbers or truth values.

    Raises
    ------
    ValueError
        If an array has another shape or holds no numbers, if its name cannot be written or a reader would take it for
        sizes or ids, or if a provenance value cannot be stored.
    """
    count = len(packing)
    appended = _Appended()
    points = appended.element("Points", np.ascontiguousarray(packing.centers, dtype="<f8"))
    about = {"radius": np.asarray(packing.radii, dtype="<f8"), "id": np.arange(count, dtype="<i8")}
    about |= {name: _checked(name, values, count) for name, values in (arrays or {}).items()}
    indent = "\n" + 8 * " "
    about_points = indent.join(appended.element(name, values) for name, values in about.items())
    facts = indent.join(_text_element(FIELD_PREFIX + key, text) for key, text in fact_texts(packing).items())
    vertices = np.arange(count, dtype="<i8")
    cells = indent.join((appended.element("connectivity", vertices), appended.element("offsets", vertices + 1)))
    text = f"""<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <PolyData>
    <FieldData>
        {facts}
    </FieldData>
    <Piece NumberOfPoints="{count}" NumberOfVerts="{count}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
      <Points>
        {points}
      </Points>
      <PointData Scalars="radius">
        {about_points}
      </PointData>
      <Verts>
        {cells}
      </Verts>
    </Piece>
  </PolyData>
  <AppendedData encoding="raw">
   _"""
    with path.open("wb") as stream:
        stream.write(text.encode())
        for values in appended.arrays:
            stream.write(values.nbytes.to_bytes(_HEADER_BYTES, "little"))
            stream.write(np.ascontiguousarray(values).tobytes())
        stream.write(b"\n  </AppendedData>\n</VTKFile>\n")


def _text_element(name: str, text: str) -> str:
    """A text in the field data: VTK writes the number of every byte and a zero at the end."""
    numbers = " ".join(str(byte) for byte in (*text.encode(), 0))
    return f'<Array type="String" Name="{name}" NumberOfTuples="1" format="ascii">{numbers}</Array>'


def _checked(name: str, values: NDArray[Any], count: int) -> NDArray[Any]:
    if not name.isprintable() or name != name.strip() or not name or is_wanted(name):
        raise ValueError(f"the array {name!r}: expected a printable name that says nothing about sizes and ids")
    given = np.asarray(values)
    if given.shape not in ((count,), (count, 3)):
        raise ValueError(f"the array {name!r} has the shape {given.shape}; expected ({count},) or ({count}, 3)")
    kinds = {"f": "<f8", "i": "<i8", "u": "<i8", "b": "|u1"}
    if given.dtype.kind not in kinds or (given.dtype.kind == "u" and given.dtype.itemsize == 8):
        raise ValueError(
            f"the array {name!r} holds {given.dtype}; expected floats, integers below 2^63 or truth values"
        )
    return given.astype(kinds[given.dtype.kind])
