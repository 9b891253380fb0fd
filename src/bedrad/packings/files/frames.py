"""Files of several frames, each a header and rows: one of them in memory, found from either end."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.lines import Lines, Mark, open_lines
from bedrad.packings.files.rows import Rows, Table, read_rows

__all__ = ["Frame", "FrameFile", "frame_rows"]

Header = TypeVar("Header")


@dataclass(frozen=True)
class Frame(Generic[Header]):
    """A frame whose header has been read.

    Parameters
    ----------
    index : int
        Its number, from 0.
    count : int
        How many rows the header says.
    header : object
        What else it says.
    rows : (int, int)
        Where the rows begin.
    """

    index: int
    count: int
    header: Header
    rows: Mark


@dataclass(frozen=True)
class FrameFile(Generic[Header]):
    """How the frames of a format are read.

    Parameters
    ----------
    header : callable
        Reads on to the rows of the next frame: `header(lines, index, before)` gives what the header says and the number
        of rows, or None at the end of the file; `before` is the frame before, None for the first.
    contents : callable
        Reads the rows of a frame, which are the next lines.
    no_frame : str
        What to say of a file without frames.
    stop : bytes, optional
        What no row begins with, but what follows the last does.
    """

    header: Callable[[Lines, int, Frame[Header] | None], tuple[Header, int] | None]
    contents: Callable[[Lines, Frame[Header]], Contents]
    no_frame: str
    stop: bytes | None = None

    def read(self, path: Path, wanted: int) -> Contents:
        """Read one frame, counted from 0, or from the end if negative; the rows of the others are counted, not read.

        Raises
        ------
        BadFileError
            If the frame does not exist, or what is read up to it is broken; the message names the line.
        """
        # a frame counted from the end is known only when the file has ended: keep the places of that many
        kept: deque[Frame[Header]] = deque(maxlen=max(-wanted, 1))
        count = 0
        with open_lines(path) as lines:
            for frame in self._headers(lines):
                if frame.index == wanted:
                    return self.contents(lines, frame)
                count += 1
                kept.append(frame)
                found = lines.skip(frame.count, self.stop)
                if found < frame.count:
                    raise _cut_off(lines, frame, found)
            if wanted >= 0 or -wanted > count:
                raise BadFileError(f"{path}: frame {wanted} was asked for; the file has {count}, counted from 0")
            lines.go_to(kept[0].rows)
            return self.contents(lines, kept[0])

    def iterate(self, path: Path) -> Iterator[Contents]:
        """Yield the frames one after the other, keeping one in memory; errors as for `read`."""
        with open_lines(path) as lines:
            for frame in self._headers(lines):
                yield self.contents(lines, frame)

    def _headers(self, lines: Lines) -> Iterator[Frame[Header]]:
        """Yield the headers, whose rows must be read or passed over before the next."""
        before: Frame[Header] | None = None
        index = 0
        while (found := self.header(lines, index, before)) is not None:
            header, count = found
            before = Frame(index, count, header, lines.mark())
            yield before
            index += 1
        if before is None:
            raise BadFileError(f"{lines.path}: {self.no_frame}")


def frame_rows(lines: Lines, frame: Frame[Header], rows: Rows, stop: bytes | None = None) -> Table:
    """Read all rows of a frame; errors as for `read_rows`, and if there are fewer."""
    table = read_rows(lines, rows, frame.count, stop)
    if len(table) < frame.count:
        raise _cut_off(lines, frame, len(table))
    return table


def _cut_off(lines: Lines, frame: Frame[Header], found: int) -> BadFileError:
    line = lines.next()
    end = f"the file ends after line {lines.number}" if line is None else f"line {lines.number} is {line[:60]!r}"
    whole = f"; {frame.index} whole frames come before it" if frame.index else ""
    return BadFileError(
        f"{lines.path}: frame {frame.index} is cut off: {frame.count} rows expected, {found} found, {end}{whole}"
    )
