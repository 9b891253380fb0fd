"""What the readers of text formats share: opening (gzip or plain), and turning fields into numbers."""

from __future__ import annotations

import gzip
import io
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, TextIO, cast

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError

__all__ = ["GZIP_MAGIC", "first_bytes", "numbers", "open_text"]

GZIP_MAGIC = b"\x1f\x8b"


def first_bytes(path: Path, count: int = 8192) -> bytes:
    """Return the first bytes of a file, unpacked if it is a gzip file.

    Raises
    ------
    BadFileError
        If the file is missing, is a folder, cannot be opened, or is a broken gzip file.
    """
    with _reading(path), path.open("rb") as stream:
        packed = stream.read(len(GZIP_MAGIC)) == GZIP_MAGIC
        stream.seek(0)
        return (cast(BinaryIO, gzip.GzipFile(fileobj=stream)) if packed else stream).read(count)


@contextmanager
def open_text(path: Path) -> Iterator[TextIO]:
    """Open a text file, gzip or plain, for reading line by line.

    Raises
    ------
    BadFileError
        If it cannot be opened or the gzip stream is broken or cut off, also while the lines are read.
    """
    with _reading(path), path.open("rb") as stream:
        packed = stream.read(len(GZIP_MAGIC)) == GZIP_MAGIC
        stream.seek(0)
        plain = cast(BinaryIO, gzip.GzipFile(fileobj=stream)) if packed else stream
        # bytes that are no UTF-8 turn into a sign that no number contains, and are refused with their line
        yield io.TextIOWrapper(plain, encoding="utf-8-sig", errors="replace")


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError as error:
        raise BadFileError(f"{path}: no such file") from error
    except IsADirectoryError as error:
        raise BadFileError(f"{path}: is a folder; expected a file") from error
    except (gzip.BadGzipFile, zlib.error, EOFError) as error:
        raise BadFileError(f"{path}: broken or cut-off gzip file ({error})") from error
    except OSError as error:
        raise BadFileError(f"{path}: cannot be read: {error.strerror or error}") from error


def numbers(
    path: Path, fields: Sequence[Sequence[str]], names: Sequence[str], lines: Sequence[int]
) -> NDArray[np.float64]:
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
        row, column = next((i, j) for i, row in enumerate(fields) for j, text in enumerate(row) if not _is_number(text))
        raise BadFileError(
            f"{path}, line {lines[row]}: {names[column]} is {fields[row][column]!r}; expected a number"
        ) from None
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, column = (int(k) for k in bad[0])
        raise BadFileError(
            f"{path}, line {lines[row]}: {names[column]} is {fields[row][column]!r}; expected a finite number"
        )
    return values


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
