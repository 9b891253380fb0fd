"""Data files of MercuryDPM: a header and a row a sphere, any number of frames one after the other."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.frames import Frame, FrameFile, frame_rows
from bedrad.packings.files.lines import Lines
from bedrad.packings.files.rows import RegularRows, is_number, numbers
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown
from bedrad.packings.packing import Provenance

__all__ = ["iterate_mercury_data", "looks_like_mercury_data", "read_mercury_data"]

_HEADER = ("N", "time", "xmin", "ymin", "zmin", "xmax", "ymax", "zmax")
_FLAT_HEADER = ("N", "time", "xmin", "ymin", "xmax", "ymax")
_ROW_LENGTHS = (14, 15)
"""Fields of a row; the last ones are what the user of the program wants them to be, one or two numbers."""
_FLAT_ROW_LENGTH = 8
_PLACES = {"x": 0, "y": 1, "z": 2, "radius": 6}
"""Places in a row; between position and radius stands the velocity."""


def looks_like_mercury_data(head: bytes) -> bool:
    """Whether a file begins with a frame: a header with an integer and an ordered box, and a row that fits it."""
    previous: list[str] = []
    for line in head.decode("ascii", errors="replace").splitlines():
        fields = line.split()
        if not fields:
            continue
        if previous and int(previous[0]) > 0:
            lengths = _ROW_LENGTHS if len(previous) == len(_HEADER) else (_FLAT_ROW_LENGTH,)
            return len(fields) in lengths and all(map(is_number, fields))
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
    return _DATA.read(path, frame)


def iterate_mercury_data(path: Path) -> Iterator[Contents]:
    """Yield the frames of a data file of MercuryDPM one after the other, keeping one in memory."""
    return _DATA.iterate(path)


def _read_header(lines: Lines, index: int, before: Frame[float] | None) -> tuple[float, int] | None:
    """Read the first line of a frame: the time and the number of rows; None at the end of the file."""
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
        said = f"; frame {before.index} says {before.count} rows after line {before.rows[1]}" if before else ""
        raise lines.error(f"{len(fields)} fields; expected the header of frame {index}, {' '.join(_HEADER)}{said}")
    if not re.fullmatch(r"[0-9]{1,18}", fields[0]):
        raise lines.error(f"N is {shown(fields[0])}; expected the number of rows of frame {index}, an integer")
    values = numbers(lines.path, [fields], _HEADER, [lines.number])[0].tolist()
    for axis, low, high in zip("xyz", values[2:5], values[5:8], strict=True):
        if not low <= high:
            raise lines.error(f"the box of frame {index} reaches from {low} to {high} along {axis}")
    return values[1], int(fields[0])


def _contents(lines: Lines, frame: Frame[float]) -> Contents:
    """Read the rows of a frame."""

    def split(text: str, line: int) -> list[str]:
        fields = text.split()
        if len(fields) == len(_HEADER) and _is_header(fields):
            raise BadFileError(
                f"{lines.path}: frame {frame.index} is cut off: {frame.count} rows expected, "
                f"{line - frame.rows[1] - 1} found, line {line} is the header of another frame"
            )
        return fields

    first = (lines.peek() or "").split()
    width = len(first) if len(first) in _ROW_LENGTHS else _ROW_LENGTHS[0]
    said = "a row of spheres has 14, or 15 in all of a frame"
    rows = RegularRows(lines.path, _PLACES, width, said, split)
    origin: Provenance = {
        "file": lines.path.name,
        "format": "MercuryDPM data",
        "frame": frame.index,
        "time": frame.header,
    }
    return table_spheres(lines.path, frame_rows(lines, frame, rows), origin)


def _is_header(fields: list[str]) -> bool:
    """Whether fields are an integer, a time and an ordered box in two or three dimensions."""
    if len(fields) not in (len(_HEADER), len(_FLAT_HEADER)) or not re.fullmatch(r"[0-9]{1,18}", fields[0]):
        return False
    if not all(map(is_number, fields)):
        return False
    box = [float(text) for text in fields[2:]]
    half = len(box) // 2
    sides = [high - low for low, high in zip(box[:half], box[half:], strict=True)]
    # an empty frame has no row that would confirm it, so its box must
    return all(side > 0 if fields[0] == "0" else side >= 0 for side in sides)


_DATA = FrameFile(_read_header, _contents, "no frame in the whole file")
