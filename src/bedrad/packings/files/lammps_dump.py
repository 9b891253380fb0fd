"""Text dumps of LAMMPS and LIGGGHTS: columns by name, rows in any order, any number of frames."""

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.byte_lines import ByteLines, Mark
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.number_rows import ROWS_AT_ONCE, NumberRows
from bedrad.packings.files.text import numbers, open_text

__all__ = ["iterate_dump", "looks_like_dump", "read_dump"]

_LENGTH_UNITS = {"si": 1.0, "cgs": 1e-2, "micro": 1e-6, "nano": 1e-9}
_NO_UNITS = "lj"
"""The units of LAMMPS in which a length is a number."""

_POSITIONS = (("x", "y", "z"), ("xs", "ys", "zs"), ("xu", "yu", "zu"), ("xsu", "ysu", "zsu"))


@dataclass
class _Header:
    """What the items before the rows say; the units are written once, in the first frame."""

    step: int | None = None
    count: int = -1
    bounds: list[tuple[float, float]] | None = None
    flags: list[str] = field(default_factory=list)
    metre: float | None = None


@dataclass(frozen=True)
class _Frame:
    """One frame: what its header says, and where its rows begin."""

    index: int
    header: _Header
    columns: list[str]
    rows: Mark


def looks_like_dump(head: bytes) -> bool:
    """Whether a file begins as a LAMMPS text dump does."""
    return head.lstrip().startswith(b"ITEM:")


def read_dump(path: Path, frame: int = -1) -> Contents:
    """Read one frame of a text dump; the rows of the others are counted, not read.

    Parameters
    ----------
    path : pathlib.Path
        The dump, plain or gzip.
    frame : int
        Which frame, counted from 0, or from the end if negative.

    Raises
    ------
    BadFileError
        If the frame does not exist, or what is read up to it is not a dump; the message names the line.
    """
    # a frame counted from the end is known only when the file has ended: keep the places of that many
    kept: deque[_Frame] = deque(maxlen=max(-frame, 1))
    count = 0
    with open_text(path) as stream:
        lines = ByteLines(path, stream)
        header = _Header()
        while (found := _next_frame(lines, header, count)) is not None:
            kept.append(found)
            count += 1
            if found.index == frame:
                return _contents(lines, found)
            passed = lines.skip(found.header.count, b"ITEM:")
            if passed < found.header.count:
                raise _cut_off(lines, found, passed)
            header = _Header(metre=found.header.metre)
        if not count:
            raise BadFileError(f"{path}: no 'ITEM: ATOMS' in the whole file")
        if frame >= 0 or -frame > count:
            raise BadFileError(f"{path}: frame {frame} was asked for; the file has {count}, counted from 0")
        lines.go_to(kept[0].rows)
        return _contents(lines, kept[0])


def iterate_dump(path: Path) -> Iterator[Contents]:
    """Yield the frames of a text dump one after the other, keeping one in memory."""
    with open_text(path) as stream:
        lines = ByteLines(path, stream)
        header = _Header()
        index = 0
        while (found := _next_frame(lines, header, index)) is not None:
            yield _contents(lines, found)
            header = _Header(metre=found.header.metre)
            index += 1
        if not index:
            raise BadFileError(f"{path}: no 'ITEM: ATOMS' in the whole file")


def _next_frame(lines: ByteLines, header: _Header, index: int) -> _Frame | None:
    """Read on to the rows of the next frame; None at the end of the file."""
    while (line := lines.next()) is not None:
        if not line.strip():
            continue
        if not line.startswith("ITEM:"):
            raise lines.error(f"expected a line that begins with 'ITEM:', found {line[:60]!r}")
        item = line.removeprefix("ITEM:").strip()
        if item.startswith("ATOMS"):
            if header.count < 0:
                raise lines.error(f"frame {index} has no 'ITEM: NUMBER OF ATOMS' before its rows")
            return _Frame(index, header, item.split()[1:], lines.mark())
        _read_item(lines, header, item)
    return None


def _read_item(lines: ByteLines, header: _Header, item: str) -> None:
    if item == "TIMESTEP":
        header.step = _integer(lines, "the time step")
    elif item == "NUMBER OF ATOMS":
        header.count = _integer(lines, "the number of atoms")
        if header.count < 0:
            raise lines.error(f"the number of atoms is {header.count}; expected 0 or more")
    elif item.startswith("BOX BOUNDS"):
        _read_bounds(lines, header, item.split()[2:])
    elif item == "UNITS":
        units = lines.wanted("the name of the units").strip()
        if units not in _LENGTH_UNITS and units != _NO_UNITS:
            raise lines.error(f"the units are {units!r}; expected one of {', '.join([*_LENGTH_UNITS, _NO_UNITS])}")
        header.metre = _LENGTH_UNITS.get(units)
    else:
        # TIME, LABEL and whatever else a code adds: nothing a packing needs
        while not lines.starts_with(b"ITEM:") and lines.next() is not None:
            pass


def _read_bounds(lines: ByteLines, header: _Header, words: list[str]) -> None:
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


def _integer(lines: ByteLines, what: str) -> int:
    text = lines.wanted(what).strip()
    try:
        return int(text)
    except ValueError:
        raise lines.error(f"{what} is {text!r}; expected an integer") from None


def _cut_off(lines: ByteLines, frame: _Frame, found: int) -> BadFileError:
    line = lines.next()
    end = f"the file ends after line {lines.number}" if line is None else f"line {lines.number} is {line[:60]!r}"
    whole = f"; {frame.index} whole frames come before it" if frame.index else ""
    return BadFileError(
        f"{lines.path}: frame {frame.index} is cut off: {frame.header.count} rows expected, {found} found, {end}{whole}"
    )


def _contents(lines: ByteLines, frame: _Frame) -> Contents:
    """Turn the rows of a frame into numbers, sorted by id where there is one."""
    header, path = frame.header, lines.path
    where = f"{path}, line {frame.rows[1]}"
    form = next((names for names in _POSITIONS if all(name in frame.columns for name in names)), None)
    if form is None:
        raise BadFileError(
            f"{where}: no columns x, y, z (nor xs, xu or xsu and their like); "
            f"the columns are {', '.join(frame.columns) or 'none'}"
        )
    size = next((name for name in ("radius", "diameter") if name in frame.columns), None)
    names = [*form, *([size] if size else []), *(["id"] if "id" in frame.columns else [])]
    values = _rows(lines, frame, names)
    order: NDArray[np.int64] | slice = slice(None)
    numbered = np.arange(len(values)) + frame.rows[1] + 1
    ids = None
    if "id" in frame.columns:
        order = _order(path, values[:, -1], numbered)
        ids = array("q", values[order, -1].astype(np.int64).tobytes())
    metre = 1.0 if header.metre is None else header.metre
    centers = values[order, :3]
    if "s" in form[0]:
        centers = _unscaled(where, header, centers)
    provenance: dict[str, str | float | int] = {"file": path.name, "format": "LAMMPS dump", "frame": frame.index}
    if header.step is not None:
        provenance["timestep"] = header.step
    return Contents(
        centers=np.ascontiguousarray(centers) * metre,
        radii=None if size is None else values[order, 3] * metre / (1.0 if size == "radius" else 2.0),
        axis_periods=_periods(header),
        provenance=provenance,
        # numbers in few bytes: as Python integers they would take more memory than the spheres
        lines=array("q", numbered[order].tobytes()),
        ids=ids,
        states_unit=header.metre is not None,
    )


def _rows(lines: ByteLines, frame: _Frame, names: list[str]) -> NDArray[np.float64]:
    """The wanted columns of all rows; memory grows with what is read, not with what the header claims."""
    rows = NumberRows(
        lines.path,
        names,
        [frame.columns.index(name) for name in names],
        len(frame.columns),
        f"'ITEM: ATOMS' names {len(frame.columns)} columns",
    )
    parts = [np.empty((0, len(names)))]
    left = frame.header.count
    while left:
        first = lines.number + 1
        taken = lines.take(min(left, ROWS_AT_ONCE))
        cut = next((place for place, line in enumerate(taken) if line.startswith(b"ITEM:")), len(taken))
        if not taken or cut < len(taken):
            lines.go_to(frame.rows)
            raise _cut_off(lines, frame, lines.skip(frame.header.count, b"ITEM:"))
        parts.append(rows.parse(taken, first)[0])
        left -= len(taken)
    return np.concatenate(parts)


def _unscaled(where: str, header: _Header, scaled: NDArray[np.float64]) -> NDArray[np.float64]:
    if header.bounds is None:
        raise BadFileError(f"{where}: scaled coordinates need 'ITEM: BOX BOUNDS', which is missing")
    low, high = np.array(header.bounds).T
    return np.asarray(low + scaled * (high - low))


def _order(path: Path, ids: NDArray[np.float64], lines: NDArray[np.int64]) -> NDArray[np.int64]:
    """The order that sorts the ids."""
    broken = np.flatnonzero((ids != np.floor(ids)) | (np.abs(ids) > 2**53))
    if len(broken):
        i = int(broken[0])
        raise BadFileError(f"{path}, line {lines[i]}: id is {ids[i]}; expected an integer")
    order = np.argsort(ids, kind="stable")
    twice = np.flatnonzero(np.diff(ids[order]) == 0)
    if len(twice):
        i = int(twice[0])
        first, second = (int(lines[order[k]]) for k in (i, i + 1))
        raise BadFileError(f"{path}, lines {first} and {second}: both have the id {int(ids[order[i]])}")
    return order


def _periods(header: _Header) -> dict[int, float]:
    """Periods of the axes whose two faces are both periodic, in metres."""
    if header.bounds is None:
        return {}
    metre = 1.0 if header.metre is None else header.metre
    return {
        axis: (high - low) * metre
        for axis, (flag, (low, high)) in enumerate(zip(header.flags, header.bounds, strict=False))
        if flag == "pp"
    }
