"""Text dumps of LAMMPS and LIGGGHTS: columns by name, rows in any order, any number of frames."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.text import numbers, open_text

__all__ = ["iterate_dump", "looks_like_dump", "read_dump"]

_LENGTH_UNITS = {"si": 1.0, "cgs": 1e-2, "micro": 1e-6, "nano": 1e-9}
_POSITIONS = (("x", "y", "z"), ("xs", "ys", "zs"), ("xu", "yu", "zu"), ("xsu", "ysu", "zsu"))


@dataclass
class _Header:
    """What the items before the rows say; the units are written once, in the first frame."""

    step: int | None = None
    count: int | None = None
    bounds: list[tuple[float, float]] | None = None
    flags: list[str] = field(default_factory=list)
    metre: float = 1.0


@dataclass(frozen=True)
class _Frame:
    """One frame, its rows still text."""

    index: int
    header: _Header
    columns: list[str]
    columns_line: int
    rows: list[str]


class _Lines:
    """The lines of a file and the number of the last one read."""

    def __init__(self, path: Path, stream: TextIO) -> None:
        self.path = path
        self.number = 0
        self._stream = stream
        self._held: str | None = None

    def next(self) -> str | None:
        """Return the next line without its end, or None at the end of the file."""
        line = self._stream.readline() if self._held is None else self._held
        self._held = None
        if not line:
            return None
        self.number += 1
        return line.rstrip("\r\n")

    def put_back(self, line: str) -> None:
        """Let `next` return this line once more."""
        self.number -= 1
        self._held = line + "\n"

    def wanted(self, what: str) -> str:
        """Return the next line, which must be there."""
        line = self.next()
        if line is None:
            raise BadFileError(f"{self.path}: cut off after line {self.number}; expected {what}")
        return line

    def error(self, message: str) -> BadFileError:
        """Return an error about the last line read."""
        return BadFileError(f"{self.path}, line {self.number}: {message}")


def looks_like_dump(head: bytes) -> bool:
    """Whether a file begins as a LAMMPS text dump does."""
    return head.lstrip().startswith(b"ITEM:")


def read_dump(path: Path, frame: int = -1) -> Contents:
    """Read one frame of a text dump.

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
    count = 0
    # a frame counted from the end is known only when the file has ended: keep that many
    kept: deque[_Frame] = deque(maxlen=max(-frame, 1))
    with open_text(path) as stream:
        for found in _frames(_Lines(path, stream)):
            kept.append(found)
            count += 1
            if found.index == frame:
                return _contents(path, found)
    if not count:
        raise BadFileError(f"{path}: no 'ITEM: ATOMS' in the whole file")
    if frame >= 0 or -frame > count:
        raise BadFileError(f"{path}: frame {frame} was asked for; the file has {count}, counted from 0")
    return _contents(path, kept[0])


def iterate_dump(path: Path) -> Iterator[Contents]:
    """Yield the frames of a text dump one after the other, keeping one in memory."""
    with open_text(path) as stream:
        for found in _frames(_Lines(path, stream)):
            yield _contents(path, found)


def _frames(lines: _Lines) -> Iterator[_Frame]:
    index = 0
    header = _Header()
    while (line := lines.next()) is not None:
        if not line.strip():
            continue
        if not line.startswith("ITEM:"):
            raise lines.error(f"expected a line that begins with 'ITEM:', found {line[:60]!r}")
        item = line.removeprefix("ITEM:").strip()
        if item.startswith("ATOMS"):
            columns_line = lines.number
            rows = _rows(lines, header, index)
            yield _Frame(index, header, item.split()[1:], columns_line, rows)
            index += 1
            header = _Header(metre=header.metre)
        else:
            _read_item(lines, header, item)


def _read_item(lines: _Lines, header: _Header, item: str) -> None:
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
        if units not in _LENGTH_UNITS:
            raise lines.error(f"the units are {units!r}; expected one of {', '.join(_LENGTH_UNITS)}")
        header.metre = _LENGTH_UNITS[units]
    else:
        # TIME, LABEL and whatever else a code adds: nothing a packing needs
        while (line := lines.next()) is not None:
            if line.startswith("ITEM:"):
                lines.put_back(line)
                break


def _read_bounds(lines: _Lines, header: _Header, words: list[str]) -> None:
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


def _integer(lines: _Lines, what: str) -> int:
    text = lines.wanted(what).strip()
    try:
        return int(text)
    except ValueError:
        raise lines.error(f"{what} is {text!r}; expected an integer") from None


def _rows(lines: _Lines, header: _Header, index: int) -> list[str]:
    if header.count is None:
        raise lines.error(f"frame {index} has no 'ITEM: NUMBER OF ATOMS' before its rows")
    rows: list[str] = []
    for _ in range(header.count):
        line = lines.next()
        if line is None or line.startswith("ITEM:"):
            end = f"the file ends after line {lines.number}" if line is None else f"line {lines.number} is {line!r}"
            whole = f"; {index} whole frames come before it" if index else ""
            raise BadFileError(
                f"{lines.path}: frame {index} is cut off: {header.count} rows expected, {len(rows)} found, {end}{whole}"
            )
        rows.append(line)
    return rows


def _contents(path: Path, frame: _Frame) -> Contents:
    """Turn the rows of a frame into numbers, sorted by id where there is one."""
    where = f"{path}, line {frame.columns_line}"
    form = next((names for names in _POSITIONS if all(name in frame.columns for name in names)), None)
    if form is None:
        raise BadFileError(
            f"{where}: no columns x, y, z (nor xs, xu or xsu and their like); "
            f"the columns are {', '.join(frame.columns) or 'none'}"
        )
    size = next((name for name in ("radius", "diameter") if name in frame.columns), None)
    names = [*form, *([size] if size else []), *(["id"] if "id" in frame.columns else [])]
    lines = np.arange(len(frame.rows)) + frame.columns_line + 1
    values = _numbers(path, frame, names, lines.tolist())
    metre = frame.header.metre
    centers = _unscaled(where, frame.header, values[:, :3]) if "s" in form[0] else values[:, :3]
    radii = None if size is None else values[:, 3] * metre / (1.0 if size == "radius" else 2.0)
    ids = None
    if "id" in frame.columns:
        order, ids = _sorted_ids(path, values[:, -1], lines)
        centers, lines = centers[order], lines[order]
        radii = None if radii is None else radii[order]
    provenance: dict[str, str | float | int] = {
        "file": path.name,
        "format": "LAMMPS dump",
        "frame": frame.index,
    }
    if frame.header.step is not None:
        provenance["timestep"] = frame.header.step
    return Contents(
        centers=np.ascontiguousarray(centers) * metre,
        radii=radii,
        axis_periods=_periods(frame.header),
        provenance=provenance,
        lines=lines.tolist(),
        ids=ids,
    )


def _numbers(path: Path, frame: _Frame, names: Sequence[str], lines: Sequence[int]) -> NDArray[np.float64]:
    places = [frame.columns.index(name) for name in names]
    fields = []
    for line, row in zip(lines, frame.rows, strict=True):
        cells = row.split()
        if len(cells) != len(frame.columns):
            raise BadFileError(
                f"{path}, line {line}: {len(cells)} fields; 'ITEM: ATOMS' names {len(frame.columns)} columns"
            )
        fields.append([cells[place] for place in places])
    return numbers(path, fields, names, lines)


def _unscaled(where: str, header: _Header, scaled: NDArray[np.float64]) -> NDArray[np.float64]:
    if header.bounds is None:
        raise BadFileError(f"{where}: scaled coordinates need 'ITEM: BOX BOUNDS', which is missing")
    low, high = np.array(header.bounds).T
    return np.asarray(low + scaled * (high - low))


def _sorted_ids(
    path: Path, values: NDArray[np.float64], lines: NDArray[np.int64]
) -> tuple[NDArray[np.int64], list[int]]:
    broken = np.flatnonzero(values != np.floor(values))
    if len(broken):
        i = int(broken[0])
        raise BadFileError(f"{path}, line {lines[i]}: id is {values[i]}; expected an integer")
    order = np.argsort(values, kind="stable")
    twice = np.flatnonzero(np.diff(values[order]) == 0)
    if len(twice):
        i = int(twice[0])
        first, second = (int(lines[order[k]]) for k in (i, i + 1))
        raise BadFileError(f"{path}, lines {first} and {second}: both have the id {int(values[order[i]])}")
    return order, values[order].astype(np.int64).tolist()


def _periods(header: _Header) -> dict[int, float]:
    """Periods of the axes whose two faces are both periodic, in metres."""
    if header.bounds is None:
        return {}
    return {
        axis: (high - low) * header.metre
        for axis, (flag, (low, high)) in enumerate(zip(header.flags, header.bounds, strict=False))
        if flag == "pp"
    }
