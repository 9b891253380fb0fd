"""Legacy files of VTK (``# vtk DataFile Version``), text and big-endian binary, as LIGGGHTS and YADE write them."""

from __future__ import annotations

import re
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.text import open_bytes, shown
from bedrad.packings.files.vtk_points import Piece, as_declared, is_wanted, number_array, spheres, take

__all__ = ["looks_like_vtk_legacy", "read_vtk_legacy"]

_MAGIC = b"# vtk datafile version"
_DATASETS = ("POLYDATA", "UNSTRUCTURED_GRID")
_TYPES = {
    "unsigned_char": "u1",
    "char": "i1",
    "signed_char": "i1",
    "unsigned_short": "u2",
    "short": "i2",
    "unsigned_int": "u4",
    "int": "i4",
    "unsigned_long": "u8",
    "long": "i8",
    "unsigned_long_long": "u8",
    "long_long": "i8",
    "float": "f4",
    "double": "f8",
    # VTK writes its own type of index as an int, whatever it is in memory
    "vtkidtype": "i4",
    "vtktypeint8": "i1",
    "vtktypeuint8": "u1",
    "vtktypeint16": "i2",
    "vtktypeuint16": "u2",
    "vtktypeint32": "i4",
    "vtktypeuint32": "u4",
    "vtktypeint64": "i8",
    "vtktypeuint64": "u8",
    "vtktypefloat32": "f4",
    "vtktypefloat64": "f8",
}
_VECTORS = {
    "vectors": 3,
    "normals": 3,
    "tensors": 9,
    "tensors6": 6,
    "global_ids": 1,
    "pedigree_ids": 1,
    "edge_flags": 1,
}
"""Attributes whose line is ``KEYWORD name type``, and how many numbers a point has."""

_CELLS = ("vertices", "lines", "polygons", "triangle_strips", "cells")
_LONGEST_LINE = 4096
_LONGEST_NUMBER = 512
_CHUNK = 1 << 16
_STEP = 64


def looks_like_vtk_legacy(head: bytes) -> bool:
    """Whether a file begins as a legacy file of VTK does."""
    return head.lstrip().lower().startswith(_MAGIC)


def read_vtk_legacy(path: Path) -> Contents:
    """Read the points of a legacy file of VTK as spheres.

    Sizes come from the point array ``radius`` (or ``radii``) or, without one, ``diameter``, ids from ``id``; small
    and capital letters are the same. Lengths are returned as in the file.

    Raises
    ------
    BadFileError
        If the file is damaged or cut off, or holds something else than points; the message names the line of a
        text file.
    """
    with open_bytes(path) as stream:
        reader = _Reader(path, stream)
        reader.read_header()
        reader.read_sections()
    if reader.points is None:
        raise BadFileError(f"{path}: no POINTS in the whole file")
    piece = Piece(str(path), reader.points, reader.arrays, reader.shapes, reader.single)
    return spheres(path, [piece], {"file": path.name, "format": "VTK legacy"})


class _Reader:
    """Reads one file from its beginning to its end and keeps what is wanted."""

    def __init__(self, path: Path, stream: BinaryIO) -> None:
        self.path = path
        self.points: NDArray[Any] | None = None
        self.arrays: dict[str, NDArray[Any]] = {}
        self.shapes = 0
        self.single = False
        self._stream = stream
        self._held = b""
        self._line = 0
        self._text = True
        self._count = 0
        self._of_points = False

    def read_header(self) -> None:
        """Read everything up to the line that names the kind of data set."""
        if not self._read_line("the version").lower().lstrip().startswith(_MAGIC.decode()):
            raise self._error("expected '# vtk DataFile Version'")
        self._read_line("the title")
        form = self._words("ASCII or BINARY")
        if len(form) != 1 or form[0].lower() not in ("ascii", "binary"):
            raise self._error(f"{' '.join(form)[:80]!r}; expected ASCII or BINARY")
        self._text = form[0].lower() == "ascii"
        words = self._words("DATASET")
        if len(words) != 2 or words[0].lower() != "dataset":
            raise self._error(f"{' '.join(words)[:80]!r}; expected DATASET and its kind")
        kind = words[1].upper()
        if kind == "RECTILINEAR_GRID":
            raise self._error(
                "a rectilinear grid, as the bounding box is that LIGGGHTS writes beside each frame; it holds no "
                "spheres, give the frame itself"
            )
        if kind not in _DATASETS:
            raise self._error(f"the data set is {words[1][:40]!r}; expected {' or '.join(_DATASETS)}")

    def read_sections(self) -> None:
        """Read all sections that follow."""
        while words := self._words(None):
            self._read_section(words[0].lower(), words)

    def _read_section(self, keyword: str, words: list[str]) -> None:
        readers = {
            "points": self._read_points,
            "cell_types": self._skip_types,
            "point_data": self._begin_data,
            "cell_data": self._begin_data,
            "field": self._read_field,
            "scalars": self._read_scalars,
            "texture_coordinates": self._skip_texture,
            "color_scalars": self._skip_colours,
            "lookup_table": self._skip_colours,
            **dict.fromkeys(_CELLS, self._skip_cells),
            **dict.fromkeys(_VECTORS, self._read_vectors),
        }
        if keyword not in readers:
            raise self._error(f"{words[0][:40]!r} is no keyword of VTK's legacy files")
        readers[keyword](keyword, words)

    def _read_points(self, _: str, words: list[str]) -> None:
        if self.points is not None:
            raise self._error("POINTS comes twice")
        count = self._integer(words, 1)
        kind = self._word(words, 2)
        self.points = self._numbers(3 * count, kind, "POINTS").reshape(count, 3)
        self.single = _TYPES[kind.lower()] == "f4"

    def _skip_types(self, _: str, words: list[str]) -> None:
        self._numbers(self._integer(words, 1), "int", "CELL_TYPES", keep=False)

    def _read_scalars(self, _: str, words: list[str]) -> None:
        components = self._integer(words, 3) if len(words) > 3 else 1
        if self._peek(len("lookup_table")).lower() == b"lookup_table":
            self._read_line("LOOKUP_TABLE")
        self._read_attribute(words, components, 2)

    def _read_vectors(self, keyword: str, words: list[str]) -> None:
        self._read_attribute(words, _VECTORS[keyword], 2)

    def _skip_texture(self, _: str, words: list[str]) -> None:
        self._read_attribute(words, self._integer(words, 2), 3)

    def _skip_colours(self, keyword: str, words: list[str]) -> None:
        count = self._integer(words, 2) * (self._count if keyword == "color_scalars" else 4)
        self._numbers(count, "unsigned_char", keyword.upper(), keep=False)

    def _skip_cells(self, keyword: str, words: list[str]) -> None:
        cells, size = self._integer(words, 1), self._integer(words, 2)
        if keyword not in ("vertices", "cells"):
            self.shapes += cells
        if self._peek(len("offsets")).lower() != b"offsets":
            self._numbers(size, "int", keyword.upper(), keep=False)
            return
        # since version 5: the first number counts the offsets, one more than there are cells
        for name, count in (("offsets", cells), ("connectivity", size)):
            line = self._words(name.upper())
            if line[0].lower() != name:
                raise self._error(f"{line[0][:40]!r}; expected {name.upper()}")
            self._numbers(count, self._word(line, 1), f"{name.upper()} of {keyword.upper()}", keep=False)

    def _begin_data(self, keyword: str, words: list[str]) -> None:
        self._count = self._integer(words, 1)
        self._of_points = keyword == "point_data"
        have = 0 if self.points is None else len(self.points)
        if self._of_points and self._count != have:
            raise self._error(f"POINT_DATA of {self._count} points; the file has {have}")

    def _read_field(self, _: str, words: list[str]) -> None:
        for _array in range(self._integer(words, 2)):
            array = self._words("an array of the field")
            if array[0].lower() == "null_array":
                continue
            name, components, count = unquote(array[0]), self._integer(array, 1), self._integer(array, 2)
            kind = self._word(array, 3).lower()
            if kind == "string":
                self._skip_strings(components * count)
                continue
            keep = self._of_points and is_wanted(name)
            if keep and (components, count) != (1, self._count):
                raise self._error(
                    f"array {shown(name)} has {count} rows of {components}; expected one number for each of "
                    f"{self._count} points"
                )
            values = self._numbers(components * count, kind, name, keep=keep)
            if keep:
                self.arrays.setdefault(name.lower(), values)

    def _read_attribute(self, words: list[str], components: int, type_at: int) -> None:
        name, kind = unquote(self._word(words, 1)), self._word(words, type_at)
        keep = self._of_points and is_wanted(name)
        if keep and components != 1:
            raise self._error(f"array {shown(name)} has {components} numbers a point; expected 1")
        values = self._numbers(components * self._count, kind, name, keep=keep)
        if keep:
            self.arrays.setdefault(name.lower(), values)

    def _skip_strings(self, count: int) -> None:
        for _ in range(count):
            if self._text:
                self._read_line("a text of a field")
                continue
            # two bits say how many bytes the length has
            first = self._bytes(1, "a text")[0]
            more = (7, 3, 1, 0)[first >> 6]
            length = int.from_bytes(bytes([first & 0x3F]) + self._bytes(more, "a text"), "big")
            self._bytes(length, "a text")

    def _numbers(self, count: int, kind: str, name: str, *, keep: bool = True) -> NDArray[Any]:
        """Read numbers, in the type of the file if it is binary; an empty array if they are not to be kept."""
        if not keep and self._text:
            return self._text_numbers(count, name, keep)
        if kind.lower() == "bit" and not keep:
            self._bytes((count + 7) // 8, name)
            return np.zeros(0)
        if kind.lower() not in _TYPES:
            raise self._error(f"{name} is of the type {kind[:40]!r}; expected one of {', '.join(_TYPES)}")
        if self._text:
            # in text an index is not cut to an int
            declared = "i8" if kind.lower() == "vtkidtype" else _TYPES[kind.lower()]
            return as_declared(f"{self.path}: {name}", self._text_numbers(count, name, keep), declared)
        form = np.dtype(">" + _TYPES[kind.lower()])
        data = self._bytes(count * form.itemsize, name)
        return np.frombuffer(data, dtype=form) if keep else np.zeros(0)

    def _text_numbers(self, count: int, name: str, keep: bool) -> NDArray[np.float64]:
        parts = []
        left = count
        while left:
            chunk = self._chunk(min(_CHUNK, 32 * left + 64))
            words = chunk.split()
            if not words and not chunk:
                raise BadFileError(
                    f"{self.path}: cut off after line {self._line}: {name} has {count - left} numbers; expected {count}"
                )
            if len(words) > left:
                end = next(islice(re.finditer(rb"\S+", chunk), left - 1, None)).end()
                self._held = chunk[end:] + self._held
                chunk, words = chunk[:end], words[:left]
            if keep:
                parts.append(self._parsed(chunk, words, name))
            self._line += chunk.count(b"\n")
            left -= len(words)
        return np.concatenate(parts) if parts else np.zeros(0)

    def _parsed(self, chunk: bytes, words: list[bytes], name: str) -> NDArray[np.float64]:
        try:
            return number_array(words)
        except ValueError as error:
            bad = next(islice(re.finditer(rb"\S+", chunk), int(error.args[0]), None))
            line = self._line + 1 + chunk[: bad.start()].count(b"\n")
            text = bad.group().decode(errors="replace")[:40]
            raise BadFileError(f"{self.path}, line {line}: {name} has {text!r}; expected a number") from None

    def _chunk(self, size: int) -> bytes:
        """Read at most about so many bytes, which do not end within a word; nothing at the end of the file."""
        chunk = self._some(size)
        words, gap, rest = chunk.rpartition(max((b" ", b"\n", b"\t", b"\r"), key=chunk.rfind))
        if words.strip():
            self._held = rest + self._held
            return words + gap
        # one word only: read on to its end
        while chunk.strip() and not chunk[-1:].isspace() and (more := self._some(_STEP)):
            found = re.search(rb"\s", more)
            end = found.end() if found else len(more)
            chunk += more[:end]
            self._held = more[end:] + self._held
            if len(chunk) > size + _LONGEST_NUMBER:
                raise self._error(f"a word of more than {_LONGEST_NUMBER} characters; expected a number")
        return chunk

    def _some(self, size: int) -> bytes:
        if self._held:
            chunk, self._held = self._held[:size], self._held[size:]
            return chunk
        return self._stream.read(size)

    def _peek(self, size: int) -> bytes:
        if len(self._held) < size:
            self._held += bytes(take(self._stream, size - len(self._held)))
        return self._held[:size]

    def _bytes(self, count: int, name: str) -> bytes | bytearray:
        if self._held:
            start, self._held = self._held[:count], self._held[count:]
            data = bytearray(start)
            data += take(self._stream, count - len(start))
        else:
            data = take(self._stream, count)
        if len(data) < count:
            raise BadFileError(f"{self.path}: cut off: {name} has {len(data)} bytes; expected {count}")
        return data

    def _next_line(self) -> str | None:
        line, end, rest = self._held.partition(b"\n")
        self._held = rest
        if not end:
            line += self._stream.readline(_LONGEST_LINE)
            if not line:
                return None
        self._line += 1
        if len(line) >= _LONGEST_LINE:
            raise self._error(f"a line of more than {_LONGEST_LINE} characters")
        return line.decode("utf-8", errors="replace").strip()

    def _read_line(self, what: str) -> str:
        line = self._next_line()
        if line is None:
            raise BadFileError(f"{self.path}: cut off after line {self._line}; expected {what}")
        return line

    def _words(self, what: str | None) -> list[str]:
        """Return the words of the next line that has any and is no METADATA; an empty list at the end, if it may be."""
        while (line := self._next_line()) is not None:
            words = line.split()
            if words and words[0].lower() == "metadata":
                # ends with an empty line
                while self._next_line():
                    pass
            elif words:
                return words
        if what is not None:
            raise BadFileError(f"{self.path}: cut off after line {self._line}; expected {what}")
        return []

    def _word(self, words: list[str], place: int) -> str:
        if len(words) <= place:
            raise self._error(f"{' '.join(words)[:80]!r}: {len(words)} words; expected {place + 1} or more")
        return words[place]

    def _integer(self, words: list[str], place: int) -> int:
        text = self._word(words, place)
        if not re.fullmatch(r"[0-9]{1,18}", text):
            raise self._error(f"{' '.join(words)[:80]!r}: {text[:40]!r}; expected a count")
        return int(text)

    def _error(self, message: str) -> BadFileError:
        return BadFileError(f"{self.path}, line {self._line}: {message}" if self._text else f"{self.path}: {message}")
