"""What a file format is to bedrad: how it is told, read and written."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.packing import Packing

__all__ = ["COLUMN_NAMES", "Columns", "Format", "sharing", "single"]

COLUMN_NAMES = ("x", "y", "z", "radius", "diameter")
"""The columns of a table that the user may name."""

Columns = Mapping[str, str]
"""bedrad's name of a quantity (one of `COLUMN_NAMES`) to its column in the file: a name, or a number from 1."""


@dataclass(frozen=True)
class Format:
    """A file format.

    Parameters
    ----------
    name : str
        Its name in messages.
    suffixes : tuple of str
        Its usual suffixes, without ``.gz``.
    recognises : callable
        Whether the first (unpacked) bytes of a file are of this format.
    read : callable
        Reads the frame of the given number from a path: `read(path, frame)`, or `read(path, frame, columns)`.
    frames : callable
        Yields all frames of a path: `frames(path)`, or `frames(path, columns)`.
    write : callable or None
        Writes a packing to a path; None if the format is only read.
    takes_columns : bool
        Whether the user may say which column is which; `read` and `frames` then take them, a mapping that may be
        empty, as their last argument.
    """

    name: str
    suffixes: tuple[str, ...]
    recognises: Callable[[bytes], bool]
    read: Callable[..., Contents]
    frames: Callable[..., Iterator[Contents]]
    write: Callable[[Packing, Path], None] | None = None
    takes_columns: bool = False


def single(
    name: str,
    suffixes: tuple[str, ...],
    recognises: Callable[[bytes], bool],
    read_all: Callable[..., Contents],
    write: Callable[[Packing, Path], None] | None = None,
    takes_columns: bool = False,
) -> Format:
    """Make the row of a format that holds one packing a file; the arguments are those of `Format`."""

    def read_one(path: Path, frame: int, *columns: Columns) -> Contents:
        if frame not in (0, -1):
            raise BadFileError(f"{path}: frame {frame} was asked for; a {name} file holds one packing")
        return read_all(path, *columns)

    def iterate(path: Path, *columns: Columns) -> Iterator[Contents]:
        yield read_all(path, *columns)

    return Format(name, suffixes, recognises, read_one, iterate, write, takes_columns)


def sharing(form: Format, other: Format, is_other: Callable[[Path], bool]) -> Format:
    """Make the row of a format whose first bytes another format has too: it hands the other's files on.

    Parameters
    ----------
    form, other : Format
        The formats.
    is_other : callable
        Whether the file at a path is of the other format.
    """

    def read(path: Path, frame: int) -> Contents:
        return (other if is_other(path) else form).read(path, frame)

    def frames(path: Path) -> Iterator[Contents]:
        yield from (other if is_other(path) else form).frames(path)

    return replace(form, read=read, frames=frames)
