"""Many rows of a table turned into numbers at once, and one by one only where something is wrong with them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.text import numbers

__all__ = ["ROWS_AT_ONCE", "NumberRows"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

ROWS_AT_ONCE = 1 << 14
"""How many rows are held as text."""


@dataclass(frozen=True)
class NumberRows:
    """What the rows of a table look like, and which of their fields are wanted.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    names : sequence of str
        Names of the wanted columns, for messages.
    places : sequence of int
        Their places in a row, from 0.
    width : int
        Fields that every row has.
    said : str
        What says so, for messages; e.g. ``"the header names 4 columns"``.
    split : callable
        Gives the fields of a line from its text and its number; None for a line that is no row, such as a comment.
    delimiter : str or None
        What stands between two fields; None for white space.
    """

    path: Path
    names: Sequence[str]
    places: Sequence[int]
    width: int
    said: str
    split: Callable[[str, int], list[str] | None] = lambda text, _: text.split()
    delimiter: str | None = None

    def parse(self, lines: Sequence[bytes], first: int) -> tuple[FloatArray, IntArray]:
        """Return the wanted fields of the rows, (n, m), and the line of every row.

        Parameters
        ----------
        lines : sequence of bytes
            The lines.
        first : int
            Number of the first of them.

        Raises
        ------
        BadFileError
            If a row has another number of fields, or a field is no finite number; the message names the line.
        """
        values = self._at_once(lines)
        if values is not None:
            return values, np.arange(first, first + len(lines))
        fields: list[list[str]] = []
        places: list[int] = []
        for line, text in enumerate(lines, start=first):
            cells = self.split(text.decode(errors="replace"), line)
            if cells is None:
                continue
            if len(cells) != self.width:
                raise BadFileError(f"{self.path}, line {line}: {len(cells)} fields; {self.said}")
            fields.append([cells[place] for place in self.places])
            places.append(line)
        return numbers(self.path, fields, self.names, places), np.array(places, dtype=np.int64)

    def _at_once(self, lines: Sequence[bytes]) -> FloatArray | None:
        """The same, where every line is a row of finite numbers with the right number of fields."""
        text = b"\n".join(lines)
        if b'"' in text or not text or _count(text, len(lines), self.delimiter) != self.width * len(lines):
            return None
        try:
            # asking for the last field too makes sure that no row is short, so that none is long either
            values = np.loadtxt(
                lines, delimiter=self.delimiter, comments=None, usecols=[*self.places, self.width - 1], ndmin=2
            )
        except ValueError:
            return None
        wanted = values[:, : len(self.places)]
        return wanted if len(values) == len(lines) and np.isfinite(wanted).all() else None


def _count(text: bytes, rows: int, delimiter: str | None) -> int:
    """Fields in a text of so many lines."""
    if delimiter is not None:
        return text.count(delimiter.encode()) + rows
    blank = np.frombuffer(text, np.uint8) <= ord(" ")
    return int(np.count_nonzero(blank[1:] & ~blank[:-1])) + (not blank[-1])
