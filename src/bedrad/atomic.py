"""Writing a file so that it is either there whole or not there at all."""

from __future__ import annotations

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

__all__ = ["atomic_path"]

_DISK_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS, errno.EACCES, errno.EPERM)


@contextmanager
def atomic_path(target: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path beside `target`; rename it to `target` when the block ends without an error.

    The content is flushed to the disk before the rename. Whatever ends the block early, Ctrl-C included,
    removes the temporary file and leaves an older `target` as it was.

    Parameters
    ----------
    target : path
        The file to write. A symbolic link is followed, so that the file it points to is replaced.

    Yields
    ------
    pathlib.Path
        An empty file in the same folder, to be written or overwritten. Build HDF5 in memory and write its bytes:
        where a disk is full, HDF5 crashes the process.

    Raises
    ------
    OSError
        If the folder is missing or read-only, the disk is full, or `target` is a folder. The message names
        `target`.
    """
    final = Path(target).resolve()
    try:
        if final.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(final))
        temporary = _reserve(final)
    except OSError as error:
        raise _named(error, target) from error
    try:
        yield temporary
        _flush(temporary)
        temporary.replace(final)
        _flush_folder(final.parent)
    except OSError as error:
        if _is_about(error, temporary):
            raise _named(error, target) from error
        raise
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def _reserve(final: Path) -> Path:
    """Create an empty file beside the target; a read-only folder shows here, before anything is computed."""
    temporary = final.with_name(f".{final.name}.{secrets.token_hex(4)}.part")
    # mode 0o666 lets the umask decide, as for a file written directly
    os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    return temporary


def _flush(path: Path) -> None:
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())


def _flush_folder(folder: Path) -> None:
    """Flush the rename itself; some file systems cannot open a folder, and lose nothing by it."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _is_about(error: OSError, temporary: Path) -> bool:
    """Whether the error belongs to the file being written, not to something else done inside the block."""
    if error.filename is None:
        return error.errno in _DISK_ERRORS
    return str(error.filename) == str(temporary)


def _named(error: OSError, target: str | os.PathLike[str]) -> OSError:
    number = errno.EIO if error.errno is None else error.errno
    return OSError(number, f"cannot write: {os.strerror(number)}", str(target))
