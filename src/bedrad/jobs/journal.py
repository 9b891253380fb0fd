"""The journal of an ensemble: finished units, appended one by one, so that whatever ends a run loses none of them."""

from __future__ import annotations

import errno
import os
import struct
import time
import zlib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from bedrad.errors import BadFileError

__all__ = ["Journal"]

_START = b"bedrad journal 1\n"
_HEAD = struct.Struct("<II")
"""Before each entry: its length and its CRC-32."""

_FLUSH_EVERY = 2.0
"""How often what was written is flushed to the disk, for a machine that loses its power. [s]"""


class Journal:
    """A file of entries, each whole or not there.

    HDF5 cannot be appended to safely: a process killed while it writes leaves a file that cannot be opened. Here the
    only harm is an entry cut off at the end, which the next run takes away.

    Parameters
    ----------
    path : Path
        The file; made by the first entry.

    Raises
    ------
    BadFileError
        If it is something else.
    OSError
        If it cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._stream: int | None = None
        self._end = self._flushed = 0
        self._flushed_at = 0.0

    def entries(self) -> Iterator[bytes]:
        """Yield the whole entries, first to last; what follows the last is cut off by the next `append`."""
        try:
            stream = self.path.open("rb")
        except FileNotFoundError:
            self._end = 0
            return
        with stream:
            start = stream.read(len(_START))
            if not _START.startswith(start):
                raise BadFileError(f"{self.path}: not a journal of bedrad; remove it, or name another results file")
            self._end = len(start) if start == _START else 0
            while len(head := stream.read(_HEAD.size)) == _HEAD.size:
                length, check = _HEAD.unpack(head)
                # a header of damaged bytes may claim any length
                if length > os.fstat(stream.fileno()).st_size - stream.tell():
                    return
                content = stream.read(length)
                if zlib.crc32(content) != check:
                    return
                self._end = stream.tell()
                yield content

    def append(self, content: bytes) -> None:
        """Add an entry.

        Raises
        ------
        OSError
            If the disk is full or the like; the entries before stay as they are.
        """
        stream = self._open()
        entry = _HEAD.pack(len(content), zlib.crc32(content)) + content
        try:
            self._write(stream, entry if self._end else _START + entry)
        except OSError as error:
            with suppress(OSError):
                os.ftruncate(stream, self._end)
            number = error.errno or errno.EIO
            raise OSError(number, f"cannot write: {os.strerror(number)}", str(self.path)) from None
        if time.monotonic() - self._flushed_at > _FLUSH_EVERY:
            self.flush()

    def flush(self) -> None:
        """See to it that what was written is on the disk."""
        if self._stream is not None and self._flushed != self._end:
            with suppress(OSError):
                os.fsync(self._stream)
            self._flushed, self._flushed_at = self._end, time.monotonic()

    def close(self) -> None:
        """Flush and close the file."""
        self.flush()
        if self._stream is not None:
            os.close(self._stream)
            self._stream = None

    def remove(self) -> None:
        """Close and remove the file, once the results are elsewhere."""
        if self._stream is not None:
            os.close(self._stream)
            self._stream = None
        self.path.unlink(missing_ok=True)
        self._end = 0

    def _open(self) -> int:
        if self._stream is None:
            try:
                self._stream = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o666)
                os.ftruncate(self._stream, self._end)
            except OSError as error:
                number = error.errno or errno.EIO
                raise OSError(number, f"cannot write: {os.strerror(number)}", str(self.path)) from None
            self._flushed, self._flushed_at = self._end, time.monotonic()
        return self._stream

    def _write(self, stream: int, entry: bytes) -> None:
        """Write all of it after the last entry: a disk that runs full takes a part and says so at the next."""
        written = 0
        while written < len(entry):
            written += os.pwrite(stream, entry[written:], self._end + written)
        self._end += written
