"""Rows of a table among comments: read a block at a time, put in the order of ids, and what their digits allow."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.lines import LineReader
from bedrad.packings.files.text import numbers

__all__ = ["Rows", "filled_lines", "rounding_notes", "sorted_by_id"]

FloatArray = NDArray[np.float64]

_BLOCK_ROWS = 20_000
_BLOCK_CHARACTERS = 2**22
"""How much text is held before it is turned into numbers."""

_FULL_DIGITS = 15
"""Decimal digits that every double can hold."""

_SAMPLE = 1000
"""Rows whose digits are counted."""


def filled_lines(path: Path, stream: TextIO) -> Iterator[tuple[int, str]]:
    """Yield the lines of a text stream that are not blank, without the space around them, and their numbers from 1.

    Raises
    ------
    BadFileError
        If a line is longer than any line of a table can be.
    """
    lines = LineReader(path, stream)
    while texts := lines.take(_BLOCK_ROWS):
        for number, text in enumerate(map(str.strip, texts), start=lines.number - len(texts) + 1):
            if text:
                yield number, text


class Rows:
    """Collects rows of a table and turns them into numbers block by block, so that the text is not kept.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    places : mapping of str to int
        Name of every wanted column, for messages, and its place in the row, from 0.
    width : int
        Fields that every row has.
    said : str
        What says so, for messages; e.g. ``"the first row has 4"``.
    """

    def __init__(self, path: Path, places: Mapping[str, int], width: int, said: str) -> None:
        self._path, self._width, self._said = path, width, said
        self._names, self._places = list(places), list(places.values())
        self._texts: list[str] = []
        self._characters = 0
        self._blocks: list[FloatArray] = []
        # numbers in few bytes: as Python integers they would take more memory than the spheres
        self._lines = array("q")

    def __len__(self) -> int:
        return len(self._lines)

    def add(self, line: int, text: str) -> None:
        """Take one row, the text of the line of this number; errors are those of `finish`."""
        self._texts.append(text)
        self._lines.append(line)
        self._characters += len(text)
        if len(self._texts) >= _BLOCK_ROWS or self._characters >= _BLOCK_CHARACTERS:
            self._convert()

    def finish(self) -> tuple[dict[str, FloatArray], Sequence[int]]:
        """Return the columns by name, and the line of every row.

        Raises
        ------
        BadFileError
            If a row has another number of fields, or a field is no finite number; the message names the line.
        """
        self._convert()
        values = np.concatenate([*self._blocks, np.empty((0, len(self._names)))])
        return dict(zip(self._names, values.T, strict=True)), self._lines

    def _convert(self) -> None:
        lines = self._lines[len(self._lines) - len(self._texts) :]
        cells = [text.split() for text in self._texts]
        for line, row in zip(lines, cells, strict=True):
            if len(row) != self._width:
                raise BadFileError(f"{self._path}, line {line}: {len(row)} fields; {self._said}")
        wanted = [[row[place] for place in self._places] for row in cells]
        self._blocks.append(numbers(self._path, wanted, self._names, lines))
        self._texts.clear()
        self._characters = 0


def sorted_by_id(
    path: Path, ids: FloatArray, lines: Sequence[int]
) -> tuple[NDArray[np.int64], Sequence[int], Sequence[int]]:
    """Return the order that sorts the ids, and the lines and ids in that order.

    Raises
    ------
    BadFileError
        If an id is no integer or comes twice; the message names the lines.
    """
    broken = np.flatnonzero((ids != np.floor(ids)) | (np.abs(ids) > 2**53))
    if len(broken):
        i = int(broken[0])
        raise BadFileError(f"{path}, line {lines[i]}: id is {ids[i]}; expected an integer")
    order = np.argsort(ids, kind="stable")
    twice = np.flatnonzero(np.diff(ids[order]) == 0)
    if len(twice):
        first, second = (int(order[k]) for k in (twice[0], twice[0] + 1))
        raise BadFileError(f"{path}, lines {lines[first]} and {lines[second]}: both have the id {int(ids[first])}")
    numbered = np.asarray(lines, dtype=np.int64)[order]
    return order, array("q", numbered.tobytes()), array("q", ids[order].astype(np.int64).tobytes())


def rounding_notes(centers: FloatArray, radii: FloatArray | None) -> dict[str, str | float | int]:
    """Say how far the positions are rounded, for the provenance of a packing from a text.

    Two spheres in contact are apart in such a file, or overlap, by up to what their digits leave open: a tolerance
    for contacts below that counts the rounding.

    Parameters
    ----------
    centers : (n, 3) array
        Sphere centres, as the file has them.
    radii : (n,) array or None
        Sphere radii, in the same unit.

    Returns
    -------
    dict
        `position_digits`: significant digits of the positions (at least 6, the fewest that programs print by
        default); `gap_rounding_radii`: bound of the rounding of a gap between two spheres, in mean radii. Empty
        where the positions have all digits of a double, or there are none.
    """
    step = max(1, len(centers) // _SAMPLE)
    sample = centers[::step].ravel().tolist()
    digits = next((d for d in range(6, _FULL_DIGITS) if all(float(f"{x:.{d}g}") == x for x in sample)), None)
    if digits is None or not sample:
        return {}
    notes: dict[str, str | float | int] = {"position_digits": digits}
    if radii is not None and radii.min() > 0:
        # every coordinate of both centres may be half a unit of its last digit off, and so may both radii
        apart = 2 * math.sqrt(3) * _half_unit(float(np.abs(centers).max()), digits)
        notes["gap_rounding_radii"] = float((apart + 2 * _half_unit(float(radii.max()), digits)) / float(radii.mean()))
    return notes


def _half_unit(largest: float, digits: int) -> float:
    """Half a unit in the last of so many significant digits."""
    return 0.5 * 10.0 ** (math.floor(math.log10(largest)) + 1 - digits) if largest > 0 else 0.0
