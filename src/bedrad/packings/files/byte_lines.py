"""Lines of a large text file: read one by one or many at once, counted without being looked at, found again."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO, TextIO

import numpy as np

from bedrad.errors import BadFileError

__all__ = ["ByteLines", "Mark"]

_BLOCK = 1 << 20
"""What is read at once. [bytes]"""

_LONGEST = 1 << 20
"""What no line of a table reaches, so that a file without line ends does not fill the memory. [bytes]"""

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"

Mark = tuple[int, int]
"""A place in the file: its byte, and the number of lines before it."""


class ByteLines:
    """The lines of a file and the number of the last one read.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    stream : text stream
        The file at its beginning, as `open_text` gives it; only its bytes are read.
    """

    def __init__(self, path: Path, stream: TextIO) -> None:
        self.path = path
        self.number = 0
        self._stream: BinaryIO = stream.buffer
        self._data = self._stream.read(_BLOCK)
        self._at = len(_BYTE_ORDER_MARK) if self._data.startswith(_BYTE_ORDER_MARK) else 0
        self._before = 0

    def next(self) -> str | None:
        """Return the next line without its end, or None at the end of the file."""
        if not self._whole_line():
            return None
        end = self._data.find(b"\n", self._at)
        line = self._data[self._at : end if end >= 0 else None]
        self._at = end + 1 if end >= 0 else len(self._data)
        self.number += 1
        return line.rstrip(b"\r").decode(errors="replace")

    def starts_with(self, start: bytes) -> bool:
        """Whether there is a next line, and it begins so."""
        return self._whole_line() and self._data.startswith(start, self._at)

    def take(self, count: int) -> list[bytes]:
        """Return at least one and at most `count` of the next lines, as bytes; none only at the end of the file."""
        if not self._whole_line():
            return []
        end = self._data.rfind(b"\n", self._at) + 1 or len(self._data)
        *lines, rest = self._data[self._at : end].split(b"\n", count)
        if not lines:
            # the last line of a file that does not end it
            lines, rest = [rest], b""
        self._at = end - len(rest)
        self.number += len(lines)
        return lines

    def skip(self, count: int, stop: bytes) -> int:
        """Pass over lines, and return how many there were.

        They are fewer than `count` where the file ends before, or a line begins with `stop`, which then is the next.
        """
        passed = 0
        while passed < count and self._whole_line() and not self._data.startswith(stop, self._at):
            found = self._data.find(b"\n" + stop, self._at)
            end = found + 1 if found >= 0 else self._data.rfind(b"\n", self._at) + 1 or len(self._data)
            lines = max(self._data.count(b"\n", self._at, end), 1)
            if lines > count - passed:
                lines = count - passed
                block = np.frombuffer(self._data, np.uint8, offset=self._at)
                end = self._at + int(np.flatnonzero(block == ord("\n"))[lines - 1]) + 1
            self._at = end
            passed += lines
            self.number += lines
        return passed

    def mark(self) -> Mark:
        """Return the place of the next line."""
        return self._before + self._at, self.number

    def go_to(self, mark: Mark) -> None:
        """Make the line at a place the next one."""
        self._before, self.number = mark
        self._at = 0
        self._stream.seek(self._before)
        self._data = self._stream.read(_BLOCK)

    def wanted(self, what: str) -> str:
        """Return the next line, which must be there."""
        line = self.next()
        if line is None:
            raise BadFileError(f"{self.path}: cut off after line {self.number}; expected {what}")
        return line

    def error(self, message: str) -> BadFileError:
        """Return an error about the last line read."""
        return BadFileError(f"{self.path}, line {self.number}: {message}")

    def _whole_line(self) -> bool:
        """Read on until the next line is held to its end; False if there is none."""
        while self._data.find(b"\n", self._at) < 0:
            block = self._stream.read(_BLOCK)
            if not block:
                return self._at < len(self._data)
            self._before += self._at
            self._data = self._data[self._at :] + block
            self._at = 0
            if len(self._data) > _LONGEST + _BLOCK:
                raise BadFileError(
                    f"{self.path}, line {self.number + 1}: longer than {_LONGEST} bytes; no table has such lines"
                )
        return True
