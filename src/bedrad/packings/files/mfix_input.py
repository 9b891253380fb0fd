"""Particle files of MFiX, `particle_input.dat` and `particle_output.dat`: Version 2.0, and the rows of version 1.0."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.lines import Lines, open_lines
from bedrad.packings.files.rows import RegularRows, Table, numbers, read_rows
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown

__all__ = ["looks_like_mfix", "read_mfix"]

_VERSION = "2.0"
_INSTRUCTIONS = 17
"""Lines between the version and the dimension, which the program passes over whatever they say."""
_HEADING = 3
"""Lines before the options, and again between them and the rows: a bar, names, a bar."""
_OPTIONS = (
    ("Coordinates", 3),
    ("Phase_ID", 1),
    ("Diameter", 1),
    ("Density", 1),
    ("Velocity", 3),
    ("Temperature", None),
    ("Species", None),
    ("User_Scalar", None),
)
"""The options in their order, and how many columns each fills when it is read. The last three are read only if the
simulation has such equations, which the file does not say."""
_ROWS_LOOKED_AT = 20
_LEAST_DENSITY = 10.0
"""Least ratio of a density to a radius: in SI it is above 1e3, in cm and g above 10."""
_OLD_ROW = ("x", "y", "z", "radius", "density", "u", "v", "w")


@dataclass(frozen=True)
class _Layout:
    """What the header says of the rows."""

    count: int
    fewest: int
    exact: bool
    diameter_place: int | None
    diameter: float | None


def looks_like_mfix(head: bytes) -> bool:
    """Whether a file begins with the version line of MFiX, or with rows of version 1.0.

    Those have no header: they are told by eight numbers, of which the fourth may be a radius, and the fifth a density.
    """
    if re.match(rb"Version [0-9]+\.[0-9]+\s*[\r\n]", head):
        return True
    rows = [line.split() for line in head.splitlines() if line.strip()]
    # the last line of a long file is cut off
    if len(rows) > 1 and not head.endswith((b"\n", b"\r")):
        rows.pop()
    return bool(rows) and all(map(_may_be_old_row, rows[:_ROWS_LOOKED_AT]))


def read_mfix(path: Path) -> Contents:
    """Read the spheres of a particle file of MFiX.

    Version 2.0 has a header of 34 lines: the version, 17 lines of instructions, the dimension, the number of
    particles, three lines of heading, the options (coordinates, phase, diameter, density, velocity, temperature,
    species, user scalars, each `T`, a column, or `F` and the value that all particles have) and three lines more.
    Blank lines do not count, as for the program. Position and diameter are read; the columns of temperature,
    species and user scalars come last and may be there or not. Like the program, bedrad reads as many rows as the
    header says, whatever follows. Version 1.0 has no header, and rows `x y z radius density u v w`. The
    diameter is that of the file, also for coarse-grained particles. Files in two dimensions are refused. The file
    names no unit.

    Raises
    ------
    BadFileError
        If the file is damaged, or of another version or dimension; the message names the line.
    """
    with open_lines(path) as lines:
        start = lines.mark()
        first = lines.next_filled()
        if first is None:
            raise BadFileError(f"{path}: an empty file")
        if first.startswith("Version"):
            table, version = _read_version_2(lines, first), _VERSION
        else:
            lines.go_to(start)
            table, version = _read_version_1(lines), "1.0"
    return table_spheres(path, table, {"file": path.name, "format": f"MFiX particles, version {version}"})


def _read_version_2(lines: Lines, first: str) -> Table:
    version = first.removeprefix("Version").strip()
    if version != _VERSION:
        raise lines.error(f"the version is {shown(version)}; the versions that are read are {_VERSION} and 1.0")
    layout = _read_header(lines)
    fields = (lines.peek() or "").split()
    width = layout.fewest
    if layout.count and fields and len(fields) != width:
        if layout.exact or len(fields) < width:
            raise BadFileError(
                f"{lines.path}, line {lines.number + 1}: {len(fields)} fields; expected {width}"
                f"{'' if layout.exact else ' or more'} by the options of the header"
            )
        width = len(fields)
    places = {"x": 0, "y": 1, "z": 2}
    if layout.diameter_place is not None:
        places["diameter"] = layout.diameter_place
    rows = RegularRows(lines.path, places, width, f"expected {width} as in the first row")
    table = read_rows(lines, rows, layout.count)
    if len(table) < layout.count:
        raise BadFileError(
            f"{lines.path}: cut off: {layout.count} rows expected, {len(table)} found, "
            f"the file ends after line {lines.number}"
        )
    if layout.diameter is not None:
        table.columns["diameter"] = np.full(len(table), layout.diameter)
    return table


def _read_header(lines: Lines) -> _Layout:
    for _ in range(_INSTRUCTIONS):
        lines.wanted("the instructions")
    dimension = _integer(lines, "Dimension")
    if dimension != 3:
        raise lines.error(f"the dimension is {dimension}; only files of spheres in space, dimension 3, are read")
    count = _integer(lines, "Particles")
    for _ in range(_HEADING):
        lines.wanted("the heading of the options")
    fewest, exact = 0, True
    diameter_place: int | None = None
    diameter: float | None = None
    for name, columns in _OPTIONS:
        fields = _labelled(lines, name)
        # the program looks at one character
        flag = fields[1][:1].upper() if len(fields) > 1 else ""
        if flag not in ("T", "F") or (name == "Coordinates" and flag == "F"):
            said = fields[1] if len(fields) > 1 else ""
            raise lines.error(f"{name} is {shown(said)}; expected T{'' if name == 'Coordinates' else ' or F'}")
        if name == "Diameter":
            diameter_place, diameter = (fewest, None) if flag == "T" else (None, _default(lines, fields))
        if flag == "T":
            fewest += columns or 0
            exact = exact and columns is not None
    for _ in range(_HEADING):
        lines.wanted("the heading of the columns")
    return _Layout(count, fewest, exact, diameter_place, diameter)


def _labelled(lines: Lines, name: str) -> list[str]:
    """Read the next line, which must begin with this name."""
    fields = lines.wanted(f"the line {name!r}").split()
    if fields[0].rstrip(":").lower() != name.lower():
        raise lines.error(f"expected the line {name!r}, found {shown(' '.join(fields))}")
    return fields


def _integer(lines: Lines, name: str) -> int:
    fields = _labelled(lines, name)
    if len(fields) < 2 or not re.fullmatch(r"[0-9]{1,18}", fields[1]):
        raise lines.error(f"{name} is {shown(' '.join(fields[1:]))}; expected an integer")
    return int(fields[1])


def _default(lines: Lines, fields: list[str]) -> float:
    """The diameter that all particles have."""
    if len(fields) < 3:
        raise lines.error("Diameter is F, and no value follows that all particles have")
    value = float(numbers(lines.path, [fields[2:3]], ["the diameter"], [lines.number])[0, 0])
    if value <= 0:
        raise lines.error(f"the diameter of all particles is {value}; expected a positive number")
    return value


def _may_be_old_row(fields: list[bytes]) -> bool:
    try:
        row = [float(text) for text in fields]
    except ValueError:
        return False
    return len(row) == len(_OLD_ROW) and 0 < _LEAST_DENSITY * row[3] <= row[4]


def _read_version_1(lines: Lines) -> Table:
    width = len(_OLD_ROW)
    said = f"a file of MFiX begins with 'Version {_VERSION}', or has rows {' '.join(_OLD_ROW)}"
    places = {name: place for place, name in enumerate(_OLD_ROW)}
    # the program passes over blank lines
    return read_rows(lines, RegularRows(lines.path, places, width, said, lambda text, _: text.split() or None))
