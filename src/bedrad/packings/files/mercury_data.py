"""Data files of MercuryDPM: a header and a row a sphere, any number of frames one after the other."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.lines import LineReader, read_rows
from bedrad.packings.files.rows import rounding_notes
from bedrad.packings.files.text import numbers, open_text

__all__ = ["iterate_mercury_data", "looks_like_mercury_data", "read_mercury_data"]

_HEADER = ("N", "time", "xmin", "ymin", "zmin", "xmax", "ymax", "zmax")
_FLAT_HEADER = ("N", "time", "xmin", "ymin", "xmax", "ymax")
_ROW_LENGTHS = (14, 15)
"""Fields of a row; the last ones are what the user of the program wants them to be, one or two numbers."""
_FLAT_ROW_LENGTH = 8
_RADIUS = 6
"""Place of the radius in a row: after the position and the velocity."""


@dataclass(frozen=True)
class _Header:
    """The first line of a frame."""

    index: int
    line: int
    count: int
    time: float


def looks_like_mercury_data(head: bytes) -> bool:
    """Whether a file begins with a frame: a header with an integer and an ordered box, and a row that fits it."""
    previous: list[str] = []
    for line in head.decode("ascii", errors="replace").splitlines():
        fields = line.split()
        if not fields:
            continue
        if previous and int(previous[0]) > 0:
            lengths = _ROW_LENGTHS if len(previous) == len(_HEADER) else (_FLAT_ROW_LENGTH,)
            return len(fields) in lengths and all(map(_is_number, fields))
        # frames without particles come one after the other
        if not _is_header(fields):
            return False
        previous = fields
    return bool(previous) and int(previous[0]) == 0


def read_mercury_data(path: Path, frame: int = -1) -> Contents:
    """Read one frame of a data file of MercuryDPM.

    The three-dimensional form has a header `N t xmin ymin zmin xmax ymax zmax` and N rows
    `x y z vx vy vz radius`, three angles, three angular velocities and one or two numbers more, of which
    position and radius are read. The two-dimensional form (`N t xmin ymin xmax ymax`, rows of 8) describes
    discs in a plane; what bedrad measures has no meaning for them, and it is refused. The box of the header is
    the domain of the program; whether it is periodic stands in the restart file only, so it gives no period.
    The file names no unit.

    Parameters
    ----------
    path : pathlib.Path
        The file, plain or gzip.
    frame : int
        Which frame, counted from 0, or from the end if negative.

    Raises
    ------
    BadFileError
        If the frame does not exist, or what is read up to it is no such file; the message names the line.
    """
    wanted = frame
    if frame < 0:
        # one pass to count, one to read: at most one frame is in memory however far from the end it is
        count = _count(path)
        wanted = count + frame
        if count and wanted < 0:
            raise BadFileError(f"{path}: frame {frame} was asked for; the file has {count}, counted from 0")
    found = 0
    with open_text(path) as stream:
        lines = LineReader(path, stream)
        header: _Header | None = None
        while (header := _read_header(lines, found, header)) is not None:
            if found == wanted:
                return _contents(lines, header)
            _skip(lines, header)
            found += 1
    if not found:
        raise BadFileError(f"{path}: no frame in the whole file")
    raise BadFileError(f"{path}: frame {frame} was asked for; the file has {found}, counted from 0")


def iterate_mercury_data(path: Path) -> Iterator[Contents]:
    """Yield the frames of a data file of MercuryDPM one after the other, keeping one in memory."""
    with open_text(path) as stream:
        lines = LineReader(path, stream)
        index = 0
        header: _Header | None = None
        while (header := _read_header(lines, index, header)) is not None:
            yield _contents(lines, header)
            index += 1


def _count(path: Path) -> int:
    with open_text(path) as stream:
        lines = LineReader(path, stream)
        count = 0
        header: _Header | None = None
        while (header := _read_header(lines, count, header)) is not None:
            _skip(lines, header)
            count += 1
    return count


def _read_header(lines: LineReader, index: int, before: _Header | None) -> _Header | None:
    """Read the first line of a frame; None at the end of the file."""
    line = lines.next_filled()
    if line is None:
        return None
    fields = line.split()
    if len(fields) == len(_FLAT_HEADER):
        raise lines.error(
            f"a header of {len(fields)} numbers, {' '.join(_FLAT_HEADER)}: a two-dimensional frame, whose discs "
            "lie in a plane; only frames of spheres in space are read"
        )
    if len(fields) != len(_HEADER):
        said = f"; frame {before.index} says {before.count} rows after line {before.line}" if before else ""
        raise lines.error(f"{len(fields)} fields; expected the header of frame {index}, {' '.join(_HEADER)}{said}")
    if not re.fullmatch(r"[0-9]{1,18}", fields[0]):
        raise lines.error(f"N is {fields[0]!r}; expected the number of rows of frame {index}, an integer")
    values = numbers(lines.path, [fields], _HEADER, [lines.number])[0].tolist()
    for axis, low, high in zip("xyz", values[2:5], values[5:8], strict=True):
        if not low <= high:
            raise lines.error(f"the box of frame {index} reaches from {low} to {high} along {axis}")
    return _Header(index, lines.number, int(fields[0]), values[1])


def _skip(lines: LineReader, header: _Header) -> None:
    found = lines.skip(header.count)
    if found < header.count:
        raise _cut_off(lines, header, found)


def _contents(lines: LineReader, header: _Header) -> Contents:
    def pick(fields: list[str], line: int) -> tuple[str, str, str, str]:
        if len(fields) not in _ROW_LENGTHS:
            if len(fields) == len(_HEADER) and _is_header(fields):
                raise BadFileError(
                    f"{lines.path}: frame {header.index} is cut off: {header.count} rows expected, "
                    f"{line - header.line - 1} found, line {line} is the header of another frame"
                )
            raise BadFileError(f"{lines.path}, line {line}: {len(fields)} fields; a row of spheres has 14 or 15")
        return fields[0], fields[1], fields[2], fields[_RADIUS]

    values = read_rows(lines, header.count, pick, ("x", "y", "z", "radius"))
    if len(values) < header.count:
        raise _cut_off(lines, header, len(values))
    centers, radii = np.ascontiguousarray(values[:, :3]), values[:, 3].copy()
    return Contents(
        centers=centers,
        radii=radii,
        provenance={
            "file": lines.path.name,
            "format": "MercuryDPM data",
            "frame": header.index,
            "time": header.time,
            **rounding_notes(centers, radii),
        },
        lines=range(header.line + 1, header.line + 1 + header.count),
    )


def _cut_off(lines: LineReader, header: _Header, found: int) -> BadFileError:
    return BadFileError(
        f"{lines.path}: frame {header.index} is cut off: {header.count} rows expected, {found} found, "
        f"the file ends after line {lines.number}"
    )


def _is_header(fields: list[str]) -> bool:
    """Whether fields are an integer, a time and an ordered box in two or three dimensions."""
    if len(fields) not in (len(_HEADER), len(_FLAT_HEADER)) or not re.fullmatch(r"[0-9]{1,18}", fields[0]):
        return False
    if not all(map(_is_number, fields)):
        return False
    box = [float(text) for text in fields[2:]]
    half = len(box) // 2
    sides = [high - low for low, high in zip(box[:half], box[half:], strict=True)]
    # an empty frame has no row that would confirm it, so its box must
    return all(side > 0 if fields[0] == "0" else side >= 0 for side in sides)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
