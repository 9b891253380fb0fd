"""Opening files, plain or packed with gzip, and showing what they hold in messages."""

from __future__ import annotations

import gzip
import io
import stat
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, cast

from bedrad.errors import BadFileError

__all__ = ["first_bytes", "is_ordinary", "open_bytes", "shown"]

_GZIP_MAGIC = b"\x1f\x8b"

_HARMLESS = 1 << 24
"""What any gzip file may unpack to. [bytes]"""

_LARGEST_RATIO = 25
"""What a larger one may unpack to, in packed sizes: coordinates of spheres shrink to a half or a third, the most
regular tables to a twentieth, and nothing but repetition beyond that. Who has such a file can unpack it."""

_SHOWN = 60
"""How much of a text from a file stands in a message. [characters]"""


def first_bytes(path: Path, count: int = 8192) -> bytes:
    """Return the first bytes of a file, unpacked if it is a gzip file; errors as for `open_bytes`."""
    with open_bytes(path) as stream:
        return stream.read(count)


def is_ordinary(path: Path) -> bool:
    """Whether a path leads to a file or folder, and not to a pipe, which may never answer, or a device without end.

    Raises
    ------
    OSError
        If it leads nowhere.
    BadFileError
        If no file can have such a name.
    """
    try:
        mode = path.stat().st_mode
    except ValueError:
        raise BadFileError(f"{shown(str(path))}: has a NUL in its name; expected the name of a file") from None
    return stat.S_ISREG(mode) or stat.S_ISDIR(mode)


@contextmanager
def open_bytes(path: Path) -> Iterator[BinaryIO]:
    """Open a file, gzip or plain, for reading.

    Raises
    ------
    BadFileError
        If it cannot be opened, is a pipe or device, or the gzip stream is broken, cut off, or unpacks to far more than
        any table of spheres does, also while it is read.
    """
    try:
        if not is_ordinary(path):
            raise BadFileError(f"{path}: a pipe or device; expected a file")
        with path.open("rb") as stream:
            packed = stream.read(len(_GZIP_MAGIC)) == _GZIP_MAGIC
            stream.seek(0)
            yield cast(BinaryIO, io.BufferedReader(_Unpacked(path, stream))) if packed else stream
    except FileNotFoundError as error:
        raise BadFileError(f"{path}: no such file") from error
    except IsADirectoryError as error:
        raise BadFileError(f"{path}: is a folder; expected a file") from error
    except (gzip.BadGzipFile, zlib.error, EOFError) as error:
        raise BadFileError(f"{path}: broken or cut-off gzip file ({error})") from error
    except OSError as error:
        raise BadFileError(f"{path}: cannot be read: {error.strerror or error}") from error


class _Unpacked(io.RawIOBase):
    """The bytes of a gzip file, as long as they are in proportion to its size."""

    def __init__(self, path: Path, stream: BinaryIO) -> None:
        self._path = path
        self._packed = stream
        self._gzip = gzip.GzipFile(fileobj=stream)

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        count = self._gzip.readinto(buffer)
        self._check(self._gzip.tell(), self._packed.tell())
        return count

    def seek(self, offset: int, whence: int = io.SEEK_SET, /) -> int:
        if whence == io.SEEK_SET:
            self._check(offset, self._path.stat().st_size)
        return self._gzip.seek(offset, whence)

    def tell(self) -> int:
        return self._gzip.tell()

    def _check(self, place: int, packed: int) -> None:
        """Refuse to go as far as a place that so many packed bytes cannot reach."""
        if place > max(_HARMLESS, _LARGEST_RATIO * packed):
            raise BadFileError(
                f"{self._path}: the gzip file unpacks to {place} bytes and more, over {_LARGEST_RATIO} times what is "
                "packed, as no table of spheres does; if this one is right, unpack it first"
            )


def shown(text: object) -> str:
    """Return a text from a file as it stands in messages: in quotes, without line ends, and not longer than a line."""
    full = str(text)
    return repr(full) if len(full) <= _SHOWN else f"{full[:_SHOWN]!r}..."
