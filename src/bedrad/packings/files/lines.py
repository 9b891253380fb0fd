"""Lines of a text file of any size: one by one, many at once, counted without being looked at, and found again."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.text import open_bytes

__all__ = ["Lines", "Mark", "open_lines"]

_BLOCK = 1 << 20
"""What is read at once. [bytes]"""

_LONGEST = 1 << 20
"""What no line of a table reaches, so that a file without line ends does not fill the memory. [bytes]"""

_USUAL = 256
"""What a line is taken to have at most where a few of them are looked for in a block. [bytes]"""

_MOST_SINGLY = 300_000
"""Lines that may come one by one without a row of numbers between them: headers, comments, walls."""

_BLANK = re.compile(rb"\s*\n")

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"

Mark = tuple[int, int]
"""A place in the file: its byte, and the number of lines before it."""


@contextmanager
def open_lines(path: Path) -> Iterator[Lines]:
    """Open a text file, gzip or plain; errors as for `open_bytes`, and of lines longer than any of a table."""
    with open_bytes(path) as stream:
        yield Lines(path, stream)


class Lines:
    """The lines of a file in UTF-8, with any of the usual line ends, and the number of the last one read.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    stream : binary stream
        The file at its beginning.
    """

    def __init__(self, path: Path, stream: BinaryIO) -> None:
        self.path = path
        self.number = 0
        self._stream = stream
        self._data = stream.read(_BLOCK)
        # a line end of its own, of old spreadsheets; where there are line feeds, it only comes before them
        self._only_returns = b"\r" in self._data and b"\n" not in self._data
        self._data = self._with_line_feeds(self._data)
        self._at = len(_BYTE_ORDER_MARK) if self._data.startswith(_BYTE_ORDER_MARK) else 0
        self._before = 0
        self._singly = 0

    def next(self) -> str | None:
        """Return the next line without its end, or None at the end of the file."""
        end = self._end_of_line()
        if end is None:
            return None
        line = self._data[self._at : end]
        self._at = min(end + 1, len(self._data))
        self.number += 1
        self._singly += 1
        if self._singly > _MOST_SINGLY:
            raise self.error(f"no rows of spheres among the last {_MOST_SINGLY} lines that are not blank")
        return line.rstrip(b"\r").decode(errors="replace")

    def next_filled(self) -> str | None:
        """Return the next line that is not blank, or None at the end of the file."""
        self._pass_blank()
        line = self.next()
        return line if line is None or line.strip() else self.next()

    def wanted(self, what: str) -> str:
        """Return the next line that is not blank, which must be there."""
        line = self.next_filled()
        if line is None:
            raise BadFileError(f"{self.path}: cut off after line {self.number}; expected {what}")
        return line

    def peek(self) -> str | None:
        """Return the next line, which stays the next one."""
        mark = self.mark()
        line = self.next()
        self.go_to(mark)
        self._singly -= line is not None
        return line

    def peek_filled(self) -> str | None:
        """Return the next line that is not blank, which becomes the next one, or None at the end of the file."""
        self._pass_blank()
        line = self.peek()
        return line if line and line.strip() else None

    def take(self, count: int, stop: bytes | None = None) -> list[bytes]:
        """Return at least one and at most `count` of the next lines, as bytes.

        There are none only at the end of the file, or where the next line begins with `stop`.
        """
        found = self._stretch(count, stop)
        if found is None:
            return []
        *lines, rest = self._data[self._at : found].split(b"\n", count)
        if not lines:
            # the last line of a file that does not end it
            lines, rest = [rest], b""
        self._at = found - len(rest)
        self.number += len(lines)
        self._singly = 0
        return lines

    def skip(self, count: int, stop: bytes | None = None) -> int:
        """Pass over lines, and return how many there were.

        They are fewer than `count` where the file ends before, or a line begins with `stop`, which then is the next.
        """
        passed = 0
        while passed < count and (end := self._stretch(count - passed, stop)) is not None:
            lines = max(self._data.count(b"\n", self._at, end), 1)
            if lines > count - passed:
                lines = count - passed
                block = np.frombuffer(self._data, np.uint8, end - self._at, self._at)
                end = self._at + int(np.flatnonzero(block == ord("\n"))[lines - 1]) + 1
            self._at = end
            self._singly = 0
            passed += lines
            self.number += lines
        return passed

    def mark(self) -> Mark:
        """Return the place of the next line."""
        return self._before + self._at, self.number

    def go_to(self, mark: Mark) -> None:
        """Make the line at a place the next one."""
        place, self.number = mark
        if self._before <= place <= self._before + len(self._data):
            self._at = place - self._before
            return
        self._before, self._at = place, 0
        self._stream.seek(place)
        self._data = self._with_line_feeds(self._stream.read(_BLOCK))

    def error(self, message: str) -> BadFileError:
        """Return an error about the last line read."""
        return BadFileError(f"{self.path}, line {self.number}: {message}")

    def _pass_blank(self) -> None:
        """Make a line the next one that is not blank, unless it is the last of the file and has no end."""
        while self._end_of_line() is not None and (blank := _BLANK.match(self._data, self._at)):
            self.number += self._data.count(b"\n", self._at, blank.end())
            self._at = blank.end()

    def _stretch(self, count: int, stop: bytes | None) -> int | None:
        """Where lines end that are held whole: one at least, and some more than `count` at most, none from `stop` on.

        None at the end of the file and where the next line begins with `stop`.
        """
        first = self._end_of_line()
        if first is None or (stop is not None and self._data.startswith(stop, self._at)):
            return None
        # of a block with thousands of short frames only the beginning is looked at for each of them
        window = self._at + _USUAL * count
        end = max(self._data.rfind(b"\n", self._at, window), first) + 1
        if stop is not None and (found := self._data.find(b"\n" + stop, self._at, end)) >= 0:
            end = found + 1
        return min(end, len(self._data))

    def _end_of_line(self) -> int | None:
        """Read on until the next line is held, and return where it ends; None at the end of the file."""
        looked_at = self._at
        while (end := self._data.find(b"\n", looked_at)) < 0:
            block = self._with_line_feeds(self._stream.read(_BLOCK))
            if not block:
                return len(self._data) if self._at < len(self._data) else None
            looked_at = len(self._data) - self._at
            self._before += self._at
            self._data = self._data[self._at :] + block
            self._at = 0
            if looked_at > _LONGEST:
                break
        if end < 0 or end - self._at > _LONGEST:
            raise BadFileError(
                f"{self.path}, line {self.number + 1}: longer than {_LONGEST} bytes; no table has such lines"
            )
        return end

    def _with_line_feeds(self, data: bytes) -> bytes:
        return data.replace(b"\r", b"\n") if self._only_returns else data
