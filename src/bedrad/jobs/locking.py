"""One process at a time on a results file, and no temporary files of those that were killed."""

from __future__ import annotations

import errno
import fcntl
import os
import re
import socket
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

__all__ = ["remove_leftovers", "results_lock"]


@contextmanager
def results_lock(path: Path) -> Iterator[None]:
    """Hold a results file for this process; what killed processes left half-written of it is removed.

    The lock is a file beside the results, ``.NAME.lock``, which the system unlocks when the process ends in any way.

    Raises
    ------
    OSError
        If another process holds it, or the lock cannot be made; the message names the results file.
    """
    final = path.resolve()
    lock = final.with_name(f".{final.name}.lock")
    with _locked(lock, path):
        remove_leftovers(final)
        try:
            yield
        finally:
            # while it is held: another process that opened it before sees that its file is gone, and opens the next
            lock.unlink(missing_ok=True)


@contextmanager
def _locked(lock: Path, path: Path) -> Iterator[None]:
    while True:
        try:
            stream = lock.open("ab+")
        except OSError as error:
            number = error.errno or errno.EIO
            raise OSError(number, f"cannot write: {os.strerror(number)}", str(path)) from None
        with stream:
            _take(stream, path)
            if _is_at(stream, lock):
                _sign(stream)
                yield
                return


def _is_at(stream: BinaryIO, path: Path) -> bool:
    """Whether an open file is still the one at its path, and not removed by who held it before."""
    try:
        return os.path.samestat(os.fstat(stream.fileno()), path.stat())
    except FileNotFoundError:
        return False


def _take(stream: BinaryIO, path: Path) -> None:
    """Lock an open file, or refuse."""
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        stream.seek(0)
        holder = stream.read(200).decode(errors="replace").strip() or "process unknown"
        raise OSError(
            errno.EBUSY,
            f"another bedrad run is writing these results ({holder}); wait for it, end it, or name another file",
            str(path),
        ) from None
    except OSError as error:
        warnings.warn(
            f"{path}: the file system has no locks ({error.strerror}); do not run two jobs on these results at a time",
            stacklevel=5,
        )


def _sign(stream: BinaryIO) -> None:
    """Say who holds the lock."""
    with suppress(OSError):
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}".encode())
        stream.flush()


def remove_leftovers(target: Path) -> None:
    """Remove the temporary files of `bedrad.atomic` for a target that no other process is writing."""
    # by no pattern of the shell: the name may have its signs
    name = re.compile(re.escape(f".{target.name}.") + r"[0-9a-f]{8}\.part")
    with suppress(OSError):
        for file in target.parent.iterdir():
            if name.fullmatch(file.name):
                file.unlink(missing_ok=True)
