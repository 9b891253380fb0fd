"""One XML file of VTK, read from its beginning to its end without ever holding more of it than is wanted."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.facts import FACTS
from bedrad.packings.files.text import open_bytes
from bedrad.packings.files.vtk_points import Piece, as_declared, is_wanted
from bedrad.packings.files.vtk_xml_data import TYPES, Layout, TextNumbers, from_appended, from_base64, make_layout

__all__ = ["COLLECTION", "FIELD_PREFIX", "PARALLEL", "Document", "parse"]

COLLECTION = "Collection"
PARALLEL = {"PPolyData": "PolyData", "PUnstructuredGrid": "UnstructuredGrid"}
"""The parallel kinds of files and the kinds of their pieces."""

FIELD_PREFIX = "bedrad_"
"""What the names of bedrad's facts have before them in the field data."""

_SERIAL = frozenset(PARALLEL.values())
_FORMATS = ("ascii", "binary", "appended")
_BLOCK = 1 << 16
_LONGEST_TAG = 1 << 12
_DEEPEST = 64
_ABOUT_POINTS = "PointData"


@dataclass
class Document:
    """What an XML file of VTK holds.

    Parameters
    ----------
    kind : str
        The type of the file.
    pieces : list of Piece
        The points, if the file itself holds them.
    files : list of (str, str)
        Time (empty without one) and name of the files that it refers to.
    facts : mapping of str to str
        The facts that bedrad wrote, not understood yet.
    """

    kind: str = ""
    pieces: list[Piece] = field(default_factory=list)
    files: list[tuple[str, str]] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class _Array:
    """An array that is wanted, and where it belongs."""

    where: str
    place: str
    name: str
    kind: str
    form: str
    count: int | None
    offset: int
    piece: int


class _AppendedError(Exception):
    """The appended data begin: what follows is no XML."""


def parse(path: Path) -> Document:
    """Read an XML file of VTK.

    Raises
    ------
    BadFileError
        If it is no such file, is damaged or cut off, or is of a kind that holds no points.
    """
    with open_bytes(path) as stream:
        return _Parser(path, stream).parse()


class _Parser:
    """Follows the elements of a file, and reads the arrays that are wanted."""

    def __init__(self, path: Path, stream: BinaryIO) -> None:
        self._path = path
        self._stream = stream
        self._document = Document()
        self._layout: Layout | None = None
        self._open: list[str] = []
        self._counts: list[int] = []
        self._array: _Array | None = None
        self._depth = 0
        self._numbers: TextNumbers | None = None
        self._texts: list[str] = []
        self._waiting: list[tuple[_Array, str]] = []
        self._appended: list[_Array] = []
        self._encoding = ""
        self._appended_at = 0
        self._read = 0
        self._end_of_data = 0
        self._expat = expat.ParserCreate()

    def parse(self) -> Document:
        """Read the file."""
        appended_at = self._read_elements()
        start = 0
        if self._appended:
            if appended_at is None:
                raise BadFileError(f"{self._appended[0].where}: the file has no AppendedData")
            start = self._start_of_data(appended_at)
        # points first: how many there really are limits what the other arrays may claim
        self._read_appended(start, [array for array in self._appended if array.place != _ABOUT_POINTS])
        for number, (piece, count) in enumerate(zip(self._document.pieces, self._counts, strict=True)):
            if len(piece.points) != count:
                raise BadFileError(f"{self._path}: piece {number} has {count} points but no element Points")
        for array, text in self._waiting:
            self._keep_base64(array, text)
        self._read_appended(start, [array for array in self._appended if array.place == _ABOUT_POINTS])
        return self._document

    def _read_appended(self, start: int, arrays: list[_Array]) -> None:
        base64 = self._encoding == "base64"
        for array in arrays:
            self._stream.seek(start + array.offset)
            distinct = array.place != _ABOUT_POINTS
            values = from_appended(
                self._known_layout(), array.where, self._stream, base64, array.kind, array.count, distinct=distinct
            )
            self._keep(array, values)
            after = self._stream.tell() - start
            self._read += after - array.offset
            self._end_of_data = max(self._end_of_data, after)
            if self._read > self._end_of_data:
                raise BadFileError(f"{array.where}: shares its appended data with another array")

    def _read_elements(self) -> int | None:
        """Read the XML; returns where the appended data begin."""
        self._expat.buffer_text = True
        self._expat.buffer_size = _BLOCK
        self._expat.StartElementHandler = self._start
        self._expat.EndElementHandler = self._end
        self._expat.CharacterDataHandler = self._text
        self._expat.StartDoctypeDeclHandler = self._refuse_doctype
        try:
            while block := self._stream.read(_BLOCK):
                self._expat.Parse(block, False)
            self._expat.Parse(b"", True)
        except _AppendedError:
            return self._appended_at
        except expat.ExpatError as error:
            raise BadFileError(f"{self._path}, line {error.lineno}: broken XML ({error})") from error
        except BadFileError:
            raise
        except (ValueError, LookupError) as error:
            raise BadFileError(f"{self._path}: XML in an encoding that is not read ({error})") from error
        return None

    def _start_of_data(self, tag_at: int) -> int:
        self._stream.seek(tag_at)
        tag = self._stream.read(_LONGEST_TAG)
        found = re.match(rb"[^>]*>\s*_", tag)
        if not found:
            raise self._error("no underscore at the beginning of AppendedData")
        return tag_at + found.end()

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self._open.append(name)
        if len(self._open) > _DEEPEST:
            raise self._error(f"more than {_DEEPEST} elements inside each other")
        if len(self._open) == 1:
            self._begin(name, attributes)
        elif name == "Piece":
            self._begin_piece(attributes)
        elif name == "DataSet" and self._document.kind == COLLECTION:
            self._document.files.append((attributes.get("timestep", "").strip(), self._text_of(attributes, "file")))
        elif name in ("DataArray", "Array") and self._array is None:
            self._begin_array(attributes)
        elif name == "AppendedData":
            self._encoding = attributes.get("encoding", "raw").strip()
            if self._encoding not in ("raw", "base64"):
                raise self._error(f"encoding of AppendedData is {self._encoding[:40]!r}; expected raw or base64")
            self._appended_at = self._expat.CurrentByteIndex
            raise _AppendedError

    def _end(self, _: str) -> None:
        self._open.pop()
        if self._array is not None and len(self._open) < self._depth:
            array, self._array = self._array, None
            if array.form == "ascii":
                numbers = self._known_numbers().finish()
                text_of_bytes = array.place == "FieldData"
                self._keep(array, numbers if text_of_bytes else as_declared(array.where, numbers, TYPES[array.kind]))
            elif array.form == "binary":
                text = "".join(self._texts)
                if array.place == _ABOUT_POINTS:
                    self._waiting.append((array, text))
                else:
                    self._keep_base64(array, text)
            self._texts = []

    def _text(self, text: str) -> None:
        # elements within an array, such as InformationKey, have texts of their own
        if self._array is None or len(self._open) != self._depth:
            return
        if self._array.form == "ascii":
            self._known_numbers().add(text)
        elif self._array.form == "binary":
            self._texts.append(text)

    def _refuse_doctype(self, *_: object) -> None:
        raise self._error("a document type declaration; such files are not read")

    def _begin(self, name: str, attributes: Mapping[str, str]) -> None:
        if name != "VTKFile":
            raise self._error(f"the file begins with the element {name[:40]!r}; expected VTKFile")
        kind = self._text_of(attributes, "type")
        if kind.removeprefix("P") == "RectilinearGrid":
            raise self._error(
                "a rectilinear grid, as the bounding box is that LIGGGHTS writes beside each frame; it holds no "
                "spheres, give the frame itself"
            )
        if kind not in (*_SERIAL, *PARALLEL, COLLECTION):
            known = ", ".join((*sorted(_SERIAL), *PARALLEL, COLLECTION))
            raise self._error(f"a file of the type {kind[:40]!r}; expected {known}")
        self._document.kind = kind
        self._layout = make_layout(
            f"{self._path}",
            attributes.get("byte_order", "LittleEndian").strip(),
            attributes.get("header_type", "UInt32").strip(),
            attributes.get("compressor", "").strip(),
        )

    def _begin_piece(self, attributes: Mapping[str, str]) -> None:
        if self._document.kind in PARALLEL:
            self._document.files.append(("", self._text_of(attributes, "Source")))
        elif self._document.kind in _SERIAL:
            self._counts.append(self._integer(attributes, "NumberOfPoints"))
            shapes = sum(self._integer(attributes, f"NumberOf{shape}", 0) for shape in ("Lines", "Strips", "Polys"))
            where = f"{self._path}, piece {len(self._document.pieces)}"
            self._document.pieces.append(Piece(where, np.zeros((0, 3)), shapes=shapes))

    def _begin_array(self, attributes: Mapping[str, str]) -> None:
        place = self._open[-2]
        name = attributes.get("Name", "").strip()
        if place == "FieldData":
            wanted = name.startswith(FIELD_PREFIX) and name.removeprefix(FIELD_PREFIX) in FACTS
        else:
            wanted = bool(self._counts) and (place == "Points" or (place == _ABOUT_POINTS and is_wanted(name)))
        if not wanted or self._document.kind not in _SERIAL:
            return
        where = f"{self._path}, line {self._expat.CurrentLineNumber}: array {name[:40]!r}"
        kind = self._text_of(attributes, "type")
        if kind not in TYPES or (kind == "String") != (place == "FieldData"):
            expected = "String" if place == "FieldData" else "a type of numbers"
            raise BadFileError(f"{where} has the type {kind[:40]!r}; expected {expected}")
        form = attributes.get("format", "ascii").strip()
        if form not in _FORMATS:
            raise BadFileError(f"{where} has the format {form[:40]!r}; expected {', '.join(_FORMATS)}")
        each = 3 if place == "Points" else 1
        components = self._integer(attributes, "NumberOfComponents", each)
        if place != "FieldData" and components != each:
            raise BadFileError(f"{where} has {components} numbers a point; expected {each}")
        count = None if place == "FieldData" else each * self._counts[-1]
        offset = self._integer(attributes, "offset") if form == "appended" else 0
        self._array = _Array(where, place, name, kind, form, count, offset, len(self._counts) - 1)
        self._depth = len(self._open)
        if form == "appended":
            self._appended.append(self._array)
        elif form == "ascii":
            self._numbers = TextNumbers(where, count)

    def _keep(self, array: _Array, values: NDArray[Any]) -> None:
        if array.place == "FieldData":
            if not (np.abs(values.astype(np.float64)) < 256).all():
                raise BadFileError(f"{array.where}: expected a text, one byte a number")
            text = (values.astype(np.int64) & 0xFF).astype(np.uint8).tobytes().partition(b"\0")[0]
            self._document.facts[array.name.removeprefix(FIELD_PREFIX)] = text.decode("utf-8", errors="replace")
            return
        piece = self._document.pieces[array.piece]
        if array.place == "Points":
            piece.points = values.reshape(-1, 3)
            piece.single = array.kind == "Float32"
        else:
            piece.arrays.setdefault(array.name.lower(), values)

    def _keep_base64(self, array: _Array, text: str) -> None:
        distinct = array.place != _ABOUT_POINTS
        self._keep(
            array, from_base64(self._known_layout(), array.where, text, array.kind, array.count, distinct=distinct)
        )

    def _known_layout(self) -> Layout:
        assert self._layout is not None  # noqa: S101 - the element VTKFile comes before everything else
        return self._layout

    def _known_numbers(self) -> TextNumbers:
        assert self._numbers is not None  # noqa: S101 - begins with every array of text
        return self._numbers

    def _text_of(self, attributes: Mapping[str, str], name: str) -> str:
        if name not in attributes:
            raise self._error(f"the element {self._open[-1]} has no attribute {name!r}")
        return attributes[name].strip()

    def _integer(self, attributes: Mapping[str, str], name: str, default: int | None = None) -> int:
        if default is not None and name not in attributes:
            return default
        text = self._text_of(attributes, name)
        if not re.fullmatch(r"[0-9]{1,18}", text):
            raise self._error(f"{name} of the element {self._open[-1]} is {text[:40]!r}; expected a count")
        return int(text)

    def _error(self, message: str) -> BadFileError:
        return BadFileError(f"{self._path}, line {self._expat.CurrentLineNumber}: {message}")
