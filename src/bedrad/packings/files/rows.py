"""Rows of numbers in text files, read a block at a time: however large a file is or claims to be."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.lines import Lines
from bedrad.packings.files.text import shown

__all__ = ["PickedRows", "RegularRows", "Table", "is_number", "numbers", "read_rows"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ROWS_AT_ONCE = 1 << 14
"""How many rows are held as text."""

_MOST_WITHOUT = 1_000_000
"""Lines of comments and blanks that may come one after the other in a table."""


@dataclass(frozen=True)
class Table:
    """Columns of numbers, and where their rows stood.

    Parameters
    ----------
    columns : mapping of str to (n,) array
        The columns by name.
    lines : (n,) array
        Line number of every row, from 1.
    """

    columns: dict[str, FloatArray]
    lines: IntArray

    def __len__(self) -> int:
        return len(self.lines)


class Rows(Protocol):
    """How the lines of a table are turned into numbers: `RegularRows`, or `PickedRows`."""

    @property
    def names(self) -> Sequence[str]:
        """Names of the columns."""
        ...

    def parse(self, lines: Sequence[bytes], first: int) -> tuple[FloatArray, IntArray]:
        """Return the numbers of the rows among some lines, (n, m), and the line of every row.

        Raises
        ------
        BadFileError
            If a row cannot be understood, or a field is no finite number; the message names the line.
        """
        ...


@dataclass(frozen=True)
class PickedRows:
    """Rows whose fields are looked for line by line.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    names : sequence of str
        Names of the wanted fields.
    pick : callable
        Gives the wanted fields of a line from its text and its number; None for a line that is no row, such as a
        comment. Raises BadFileError.
    """

    path: Path
    names: Sequence[str]
    pick: Callable[[str, int], Sequence[str] | None]

    def parse(self, lines: Sequence[bytes], first: int) -> tuple[FloatArray, IntArray]:
        """As `Rows.parse`."""
        fields: list[Sequence[str]] = []
        places: list[int] = []
        for line, text in enumerate(lines, start=first):
            wanted = self.pick(text.decode(errors="replace"), line)
            if wanted is not None:
                fields.append(wanted)
                places.append(line)
        return numbers(self.path, fields, self.names, places), np.array(places, dtype=np.int64)


def _words(text: str, _: int) -> list[str]:
    return text.split()


@dataclass(frozen=True)
class RegularRows:
    """Rows with equally many fields, read many at once, and one by one only where something is wrong with them.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    places : mapping of str to int
        Name of every wanted column, and its place in a row, from 0.
    width : int
        Fields that every row has.
    said : str
        What says so, for messages; e.g. ``"the header names 4 columns"``.
    split : callable
        Gives the fields of a line from its text and its number; None for a line that is no row, such as a comment.
    separator : str or None
        What stands between two fields; None for white space.
    open_end : bool
        Whether rows may have more fields.
    """

    path: Path
    places: Mapping[str, int]
    width: int
    said: str
    split: Callable[[str, int], list[str] | None] = _words
    separator: str | None = None
    open_end: bool = False

    @property
    def names(self) -> Sequence[str]:
        """Names of the wanted columns."""
        return list(self.places)

    def parse(self, lines: Sequence[bytes], first: int) -> tuple[FloatArray, IntArray]:
        """As `Rows.parse`."""
        values = self._at_once(lines)
        if values is not None:
            return values, np.arange(first, first + len(lines))
        return PickedRows(self.path, self.names, self._pick).parse(lines, first)

    def _pick(self, text: str, line: int) -> list[str] | None:
        cells = self.split(text, line)
        if cells is None:
            return None
        if len(cells) < self.width or (len(cells) > self.width and not self.open_end):
            raise BadFileError(f"{self.path}, line {line}: {len(cells)} fields; {self.said}")
        return [cells[place] for place in self.places.values()]

    def _at_once(self, lines: Sequence[bytes]) -> FloatArray | None:
        """The same, where every line is a row of finite numbers with the right number of fields."""
        text = b"\n".join(lines)
        # some bytes of UTF-8 are white space to NumPy
        if not text.isascii() or b'"' in text or not text.strip():
            return None
        if not self.open_end and _fields(text, len(lines), self.separator) != self.width * len(lines):
            return None
        try:
            # asking for the last field too makes sure that no row is short, so that none is long either
            values = np.loadtxt(
                lines,
                delimiter=self.separator,
                comments=None,
                usecols=[*self.places.values(), self.width - 1],
                ndmin=2,
            )
        except ValueError:
            return None
        wanted = values[:, : len(self.places)]
        return wanted if len(values) == len(lines) and np.isfinite(wanted).all() else None


def read_rows(lines: Lines, rows: Rows, count: int | None = None, stop: bytes | None = None) -> Table:
    """Read rows of numbers; memory grows with what is read, not with what a header claims.

    Parameters
    ----------
    lines : Lines
        The lines; the first row is the next of them.
    rows : RegularRows or PickedRows
        What the rows look like.
    count : int, optional
        How many lines there are; if not given, all to the end of the file.
    stop : bytes, optional
        What a line begins with that ends the rows before their time.

    Returns
    -------
    Table
        The columns; fewer than `count` rows if the file ends before, or a line begins with `stop`.

    Raises
    ------
    BadFileError
        If a row cannot be understood, or a field is no finite number; the message names the line.
    """
    parts: list[FloatArray] = []
    places: list[IntArray] = []
    left = sys.maxsize if count is None else count
    last = lines.number
    while left:
        first = lines.number + 1
        taken = lines.take(min(left, _ROWS_AT_ONCE), stop)
        if not taken:
            break
        part, place = rows.parse(taken, first)
        parts.append(part)
        places.append(place)
        left -= len(taken)
        last = lines.number if len(place) else last
        if lines.number - last > _MOST_WITHOUT:
            raise lines.error(f"no row of numbers among the last {_MOST_WITHOUT} lines")
    values = _put_together(parts, len(rows.names))
    return Table(dict(zip(rows.names, values.T, strict=True)), np.concatenate([np.empty(0, np.int64), *places]))


def _put_together(parts: list[FloatArray], width: int) -> FloatArray:
    """Return all rows, and give back the memory of each part as soon as it is copied."""
    whole = np.empty((sum(map(len, parts)), width))
    end = len(whole)
    while parts:
        part = parts.pop()
        whole[end - len(part) : end] = part
        end -= len(part)
    return whole


def numbers(path: Path, fields: Sequence[Sequence[str]], names: Sequence[str], lines: Sequence[int]) -> FloatArray:
    """Turn rows of text fields into finite numbers.

    Parameters
    ----------
    path : pathlib.Path
        The file, for the message.
    fields : (n, m) texts
        The fields.
    names : (m,) texts
        Column names, for the message.
    lines : (n,) integers
        Line number of every row, for the message.

    Returns
    -------
    (n, m) array
        The numbers, correctly rounded.

    Raises
    ------
    BadFileError
        If a field is no number, or is not finite; the message names the line and the column.
    """
    try:
        values = np.array(fields, dtype=np.float64).reshape(len(fields), len(names))
    except ValueError:
        row, column = next((i, j) for i, row in enumerate(fields) for j, text in enumerate(row) if not is_number(text))
        raise BadFileError(
            f"{path}, line {lines[row]}: {names[column]} is {shown(fields[row][column])}; expected a number"
        ) from None
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, column = (int(k) for k in bad[0])
        raise BadFileError(
            f"{path}, line {lines[row]}: {names[column]} is {shown(fields[row][column])}; expected a finite number"
        )
    return values


def is_number(text: str | bytes) -> bool:
    """Whether a text is a number, finite or not."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _fields(text: bytes, rows: int, separator: str | None) -> int:
    """Fields in a text of so many lines."""
    if separator is not None:
        return text.count(separator.encode()) + rows
    blank = np.frombuffer(text, np.uint8) <= ord(" ")
    return int(np.count_nonzero(blank[1:] & ~blank[:-1])) + int(len(blank) > 0 and not blank[-1])
