"""Going through a results file that anybody may have made, before it is read where a crash would do harm."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from bedrad.errors import BadFileError, visible
from bedrad.packings.files.hdf5_access import DAMAGED, attribute, check_together, open_hdf5

__all__ = ["DEEPEST", "MOST_A_BYTE", "record_stages", "survey"]

DEEPEST = 8
"""Groups in each other, at most."""

MOST_A_BYTE = 1000
"""What datasets may state over the size of their file: compressed zeros shrink a thousandfold."""


def survey(path: Path) -> str | None:
    """Read everything in a results file and forget it.

    Parameters
    ----------
    path : pathlib.Path
        The file. One that is no results file is not gone through.

    Returns
    -------
    str or None
        What is wrong with it; None if all of it could be read, or if whoever opens it will see what it is.
    """
    try:
        with open_hdf5(path) as file:
            if "schema_version" in file.attrs:
                # whoever opens the file looks at it, and may crash of it, before it is told to be something else
                file.attrs["schema_version"]
                if "job" in file.attrs:
                    _Survey(file, path).go_through(file)
    except BadFileError as error:
        return str(error).removeprefix(f"{path}: ").removeprefix(DAMAGED)
    return None


def record_stages(path: Path, version: int) -> list[str]:
    """Names of the groups of a file with one record; none if it is something else, or of another schema version."""
    try:
        with open_hdf5(path) as file:
            return list(file) if attribute(file, "schema_version") == version else []
    except BadFileError:
        return []


class _Survey:
    """What was seen of a file on the way through it."""

    def __init__(self, file: h5py.File, path: Path) -> None:
        self._file = file
        self._size = path.stat().st_size
        self._seen = {_number(file)}
        self._held: dict[tuple[int, int], int] = {}
        self._together = 0

    def go_through(self, group: h5py.Group, depth: int = 0) -> None:
        if depth > DEEPEST:
            raise BadFileError(f"{_name(group)}: groups lie deeper than {DEEPEST} in each other")
        _read_attributes(group)
        for key in group:
            if not isinstance(key, str):
                raise BadFileError(f"{_name(group)}: holds {key!r:.60}, a name that is not UTF-8")
            place = f"{_name(group).rstrip('/')}/{visible(key)[:200]}"
            link = group.get(key, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise BadFileError(f"{place}: is a link to elsewhere, and no run writes one")
            if not isinstance(link, h5py.HardLink):
                # these lead to what is gone through by its own name, or nowhere
                continue
            item = group[key]
            number = _number(item)
            if number in self._seen and isinstance(item, h5py.Group):
                raise BadFileError(f"{place}: is a group that has another name too, and no run writes one")
            if number not in self._seen:
                self._seen.add(number)
                if isinstance(item, h5py.Group):
                    self.go_through(item, depth + 1)
                    continue
                _read_attributes(item)
                if isinstance(item, h5py.Dataset) and item.shape is not None:
                    self._held[number] = self._read(item, place)
            # whoever reads the file reads it as often as it has names
            self._together += self._held.get(number, 0)
            check_together(self._file, self._together)

    def _read(self, item: h5py.Dataset, place: str) -> int:
        """Read a dataset; how many bytes that gave."""
        if item.is_virtual or item.external:
            raise BadFileError(f"{place}: its values lie in other files, which no run does")
        if item.nbytes > MOST_A_BYTE * self._size:
            raise BadFileError(f"{place}: states {item.nbytes} bytes, far more than the file holds")
        values = np.asarray(item[()])
        inner = sum(_bytes_of(each) for each in values.flat) if values.dtype == object else 0
        return int(values.nbytes) + inner


def _number(item: Any) -> tuple[int, int]:
    """What tells an object from others, whatever its name."""
    info = h5py.h5o.get_info(item.id)
    return info.fileno, info.addr


def _read_attributes(item: Any) -> None:
    for key in item.attrs:
        if not isinstance(key, str):
            raise BadFileError(f"{_name(item)}: the attribute {key!r:.60} has a name that is not UTF-8")
        item.attrs[key]


def _bytes_of(value: object) -> int:
    return len(value) if isinstance(value, bytes) else int(getattr(value, "nbytes", 0))


def _name(group: Any) -> str:
    return visible(str(group.name))[:200]
