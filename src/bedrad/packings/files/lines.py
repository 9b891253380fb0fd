"""Tables of numbers in text files, read a block at a time: however large a file is or claims to be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.text import numbers

__all__ = ["LineReader", "read_rows"]

_BLOCK = 1 << 18
"""What is read at once. [characters]"""

_LONGEST = 1 << 20
"""What no line of a table reaches, so that a file without line ends does not fill the memory. [characters]"""

_ROWS = 1 << 14
"""How many rows are text at the same time."""


class LineReader:
    """The lines of a text stream and the number of the last one read.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    stream : text stream
        The stream, as `open_text` gives it.
    """

    def __init__(self, path: Path, stream: TextIO) -> None:
        self.path = path
        self.number = 0
        self._stream = stream
        self._lines: list[str] = []
        self._at = 0
        self._rest = ""

    def take(self, count: int) -> list[str]:
        """Return the next lines without their ends; fewer than `count` only where the file ends."""
        taken: list[str] = []
        while len(taken) < count and (self._at < len(self._lines) or self._fill()):
            part = self._lines[self._at : self._at + count - len(taken)]
            self._at += len(part)
            self.number += len(part)
            taken += part
        return taken

    def skip(self, count: int) -> int:
        """Pass over lines, and return how many there were: fewer than `count` only where the file ends."""
        passed = 0
        while passed < count and (self._at < len(self._lines) or self._fill()):
            step = min(count - passed, len(self._lines) - self._at)
            self._at += step
            self.number += step
            passed += step
        return passed

    def next(self) -> str | None:
        """Return the next line, or None at the end of the file."""
        taken = self.take(1)
        return taken[0] if taken else None

    def next_filled(self) -> str | None:
        """Return the next line that is not blank, or None at the end of the file."""
        while (line := self.next()) is not None:
            if line.strip():
                return line
        return None

    def error(self, message: str) -> BadFileError:
        """Return an error about the last line read."""
        return BadFileError(f"{self.path}, line {self.number}: {message}")

    def _fill(self) -> bool:
        """Read until there is at least one whole line; False at the end of the file."""
        self._lines, self._at = [], 0
        while not self._lines:
            block = self._stream.read(_BLOCK)
            if not block:
                self._lines = [self._rest] if self._rest else []
                self._rest = ""
                break
            *self._lines, self._rest = (self._rest + block).split("\n")
            if len(self._rest) > _LONGEST:
                line = self.number + len(self._lines) + 1
                raise BadFileError(f"{self.path}, line {line}: longer than {_LONGEST} characters; no table is")
        return bool(self._lines)


def read_rows(
    lines: LineReader, count: int | None, pick: Callable[[list[str], int], Sequence[str]], names: Sequence[str]
) -> NDArray[np.float64]:
    """Read rows of numbers.

    Parameters
    ----------
    lines : LineReader
        The lines; the first row is the next of them.
    count : int or None
        How many rows; None reads to the end of the file, where blank lines may follow the last row.
    pick : callable
        Gives the wanted fields of a row from all its fields and its line number, or raises BadFileError.
    names : (m,) texts
        Names of the wanted fields, for messages.

    Returns
    -------
    (n, m) array
        The numbers; fewer than `count` rows if the file ends before.

    Raises
    ------
    BadFileError
        If a field is no finite number; the message names the line and the field.
    """
    parts = [np.empty((0, len(names)))]
    done = 0
    while count is None or done < count:
        first = lines.number + 1
        texts = lines.take(_ROWS if count is None else min(_ROWS, count - done))
        if count is None:
            texts = _before_the_end(lines, texts)
        if not texts:
            break
        fields = [pick(text.split(), line) for line, text in enumerate(texts, start=first)]
        parts.append(numbers(lines.path, fields, names, range(first, first + len(fields))))
        done += len(texts)
    return np.concatenate(parts)


def _before_the_end(lines: LineReader, texts: list[str]) -> list[str]:
    """Return the rows before the first blank line, after which nothing but blank lines may come."""
    blank = next((place for place, text in enumerate(texts) if not text.strip()), None)
    if blank is None:
        return texts
    line = lines.number - len(texts) + blank + 1
    if any(text.strip() for text in texts[blank:]) or lines.next_filled() is not None:
        raise BadFileError(f"{lines.path}, line {line}: a blank line between rows of numbers")
    return texts[:blank]
