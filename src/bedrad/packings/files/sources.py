"""Which files a trajectory is: one, several, a pattern or a folder, in the order of the numbers in their names."""

from __future__ import annotations

import fnmatch
import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from bedrad.errors import BadFileError

__all__ = ["Source", "is_pattern", "natural_key", "source_files"]

PathLike = str | os.PathLike[str]
Source = PathLike | Iterable[PathLike]

_WILD = re.compile(r"[*?\[]")
_NUMBER = re.compile(r"(\d+)")
_NO_FRAME = re.compile(r"boundingBox(_\d+)?\.\w+$", re.IGNORECASE)
"""What LIGGGHTS writes beside every VTK dump, after the name without its suffix."""


def natural_key(path: Path) -> tuple[tuple[int, int | str], ...]:
    """Key that sorts names by the numbers in them: ``dump_9.vtk`` before ``dump_10.vtk``."""
    parts = _NUMBER.split(path.name)
    return tuple((0, int(part)) if place % 2 else (1, part) for place, part in enumerate(parts))


def is_pattern(path: Path) -> bool:
    """Whether a name has wild cards and is not just the odd name of a file."""
    return bool(_WILD.search(path.name)) and not path.exists()


def source_files(source: Source, suffixes: Sequence[str]) -> list[Path]:
    """Return the files of a trajectory, in order.

    Parameters
    ----------
    source : path or iterable of paths
        A file; a pattern such as ``"dump_*.vtk"``, with wild cards in the last part only; a folder, of whose files
        those with a known suffix are taken, which must be one and the same; or several files, in the order wanted.
        Bounding boxes of LIGGGHTS are left out of patterns and folders.
    suffixes : sequence of str
        The known suffixes.

    Raises
    ------
    BadFileError
        If nothing matches, or a folder holds files of different suffixes.
    """
    if not isinstance(source, (str, os.PathLike)):
        paths = [Path(path) for path in source]
        if not paths:
            raise BadFileError("no files were given; expected at least one")
        return paths
    path = Path(source)
    if path.is_dir():
        return _of_folder(path, suffixes)
    if not is_pattern(path):
        return [path]
    if _WILD.search(str(path.parent)) and not path.parent.exists():
        raise BadFileError(f"{path}: wild cards in the name of a folder; expected them in the last part only")
    found = [each for each in _frames_in(path.parent) if fnmatch.fnmatchcase(each.name, path.name)]
    if not found:
        raise BadFileError(f"{path}: no such files")
    return found


def _frames_in(folder: Path) -> list[Path]:
    try:
        inside = [each for each in folder.iterdir() if each.is_file()]
    except OSError as error:
        raise BadFileError(f"{folder}: cannot be read: {error.strerror or error}") from error
    return sorted(
        (each for each in inside if not each.name.startswith(".") and not _NO_FRAME.search(each.name)),
        key=natural_key,
    )


def _of_folder(folder: Path, suffixes: Sequence[str]) -> list[Path]:
    def suffix(path: Path) -> str:
        return Path(path.name.lower().removesuffix(".gz")).suffix

    found = [each for each in _frames_in(folder) if suffix(each) in suffixes]
    kinds = sorted({suffix(each) for each in found})
    if not found:
        raise BadFileError(f"{folder}: a folder without a file of a known suffix; known are {' '.join(suffixes)}")
    if len(kinds) > 1:
        raise BadFileError(
            f"{folder}: a folder with files of several kinds ({' '.join(kinds)}); expected one kind, or a pattern such "
            f"as {str(folder / ('*' + kinds[0]))!r}"
        )
    return found
