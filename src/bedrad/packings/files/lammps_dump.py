"""Text dumps of LAMMPS and LIGGGHTS: columns by name, rows in any order, any number of frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.frames import Frame, FrameFile, frame_rows
from bedrad.packings.files.lines import Lines
from bedrad.packings.files.rows import RegularRows, Table, numbers
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown

__all__ = ["iterate_dump", "looks_like_dump", "read_dump"]

_LENGTH_UNITS = {"si": 1.0, "cgs": 1e-2, "micro": 1e-6, "nano": 1e-9}
_NO_UNITS = "lj"
"""The units of LAMMPS in which a length is a number."""

_POSITIONS = (("x", "y", "z"), ("xs", "ys", "zs"), ("xu", "yu", "zu"), ("xsu", "ysu", "zsu"))
_ITEM = "ITEM:"
_LARGEST_COUNT = 10**18
_LONGEST_INTEGER = 40


@dataclass
class _Header:
    """What stands before the rows; the units are written once, in the first frame."""

    step: int | None = None
    count: int | None = None
    bounds: list[tuple[float, float]] | None = None
    flags: list[str] = field(default_factory=list)
    metre: float | None = None
    columns: list[str] = field(default_factory=list)

    @property
    def periods(self) -> dict[int, float]:
        """Periods of the axes whose two faces are both periodic. [m]"""
        if self.bounds is None:
            return {}
        return {
            axis: (high - low) * (self.metre or 1.0)
            for axis, (flag, (low, high)) in enumerate(zip(self.flags, self.bounds, strict=False))
            if flag == "pp"
        }


def looks_like_dump(head: bytes) -> bool:
    """Whether a file begins as a LAMMPS text dump does."""
    return head.lstrip().startswith(_ITEM.encode())


def read_dump(path: Path, frame: int = -1) -> Contents:
    """Read one frame of a text dump, plain or gzip; parameters and errors as for `FrameFile.read`."""
    return _DUMP.read(path, frame)


def iterate_dump(path: Path) -> Iterator[Contents]:
    """Yield the frames of a text dump one after the other, keeping one in memory."""
    return _DUMP.iterate(path)


def _read_header(lines: Lines, index: int, before: Frame[_Header] | None) -> tuple[_Header, int] | None:
    """Read on to the rows of the next frame; None at the end of the file."""
    header = _Header(metre=before.header.metre if before else None)
    while (line := lines.next_filled()) is not None:
        if not line.startswith(_ITEM):
            raise lines.error(f"expected a line that begins with {_ITEM!r}, found {shown(line)}")
        item = line.removeprefix(_ITEM).strip()
        if item.startswith("ATOMS"):
            if header.count is None:
                raise lines.error(f"frame {index} has no 'ITEM: NUMBER OF ATOMS' before its rows")
            header.columns = item.split()[1:]
            return header, header.count
        _read_item(lines, header, item)
    return None


def _read_item(lines: Lines, header: _Header, item: str) -> None:
    if item == "TIMESTEP":
        header.step = _integer(lines, "the time step")
    elif item == "NUMBER OF ATOMS":
        header.count = _integer(lines, "the number of atoms")
        if not 0 <= header.count < _LARGEST_COUNT:
            raise lines.error(f"the number of atoms is {header.count}; expected 0 or more")
    elif item.startswith("BOX BOUNDS"):
        _read_bounds(lines, header, item.split()[2:])
    elif item == "UNITS":
        units = lines.wanted("the name of the units").strip()
        if units not in _LENGTH_UNITS and units != _NO_UNITS:
            raise lines.error(f"the units are {shown(units)}; expected one of {', '.join([*_LENGTH_UNITS, _NO_UNITS])}")
        header.metre = _LENGTH_UNITS.get(units)
    else:
        # TIME, LABEL and whatever else a code adds: nothing a packing needs
        lines.skip(_LARGEST_COUNT, _ITEM.encode())


def _read_bounds(lines: Lines, header: _Header, words: list[str]) -> None:
    # a tilted box names its tilts (xy xz yz, or abc origin) and gives more than two numbers a line
    if any(word in ("xy", "xz", "yz", "abc", "origin") for word in words):
        raise lines.error("a triclinic box; only boxes with right angles are read")
    header.flags = words
    header.bounds = []
    for axis in "xyz":
        parts = lines.wanted(f"the bounds of the box along {axis}").split()
        if len(parts) != 2:
            raise lines.error(f"{len(parts)} numbers for the box along {axis}; expected 2 (low, high)")
        low, high = numbers(lines.path, [parts], ["the lower bound", "the upper bound"], [lines.number])[0].tolist()
        if not low < high:
            raise lines.error(f"the box along {axis} reaches from {low} to {high}; expected low < high")
        header.bounds.append((low, high))


def _integer(lines: Lines, what: str) -> int:
    text = lines.wanted(what).strip()
    try:
        if len(text) > _LONGEST_INTEGER:
            raise ValueError
        return int(text)
    except ValueError:
        raise lines.error(f"{what} is {shown(text)}; expected an integer") from None


def _contents(lines: Lines, frame: Frame[_Header]) -> Contents:
    """Read the rows of a frame."""
    header = frame.header
    where = f"{lines.path}, line {frame.rows[1]}"
    form = next((names for names in _POSITIONS if all(name in header.columns for name in names)), None)
    if form is None:
        raise BadFileError(
            f"{where}: no columns x, y, z (nor xs, xu or xsu and their like); "
            f"the columns are {', '.join(header.columns)[:200] or 'none'}"
        )
    size = next((name for name in ("radius", "diameter") if name in header.columns), None)
    names = [*form, *([size] if size else []), *(["id"] if "id" in header.columns else [])]
    width = len(header.columns)
    places = {name: header.columns.index(name) for name in names}
    rows = RegularRows(lines.path, places, width, f"'ITEM: ATOMS' names {width} columns")
    table = frame_rows(lines, frame, rows, _ITEM.encode())
    _name_positions(where, header, form, table)
    provenance: dict[str, str | float | int] = {"file": lines.path.name, "format": "LAMMPS dump", "frame": frame.index}
    if header.step is not None:
        provenance["timestep"] = header.step
    return table_spheres(
        lines.path,
        table,
        provenance,
        metre=header.metre or 1.0,
        axis_periods=header.periods,
        states_unit=header.metre is not None,
    )


def _name_positions(where: str, header: _Header, form: tuple[str, ...], table: Table) -> None:
    """Call the columns of the positions x, y and z, in the unit of the box also where they are shares of it."""
    scaled = "s" in form[0]
    if scaled and header.bounds is None:
        raise BadFileError(f"{where}: scaled coordinates need 'ITEM: BOX BOUNDS', which is missing")
    for axis, name in enumerate(form):
        column = table.columns.pop(name)
        if scaled and header.bounds is not None:
            low, high = header.bounds[axis]
            # what is beyond all numbers is found where the spheres are checked
            with np.errstate(over="ignore", invalid="ignore"):
                column = low + column * np.subtract(high, low)
        table.columns["xyz"[axis]] = column


_DUMP = FrameFile(_read_header, _contents, "no 'ITEM: ATOMS' in the whole file", _ITEM.encode())
