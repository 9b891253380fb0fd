"""Whether two results files say the same, bit for bit, but for how long it took."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

__all__ = ["TIMING", "differences"]

TIMING = ("seconds", "created")
"""Endings of the names of datasets and attributes that tell of time: run times differ from run to run."""


def differences(first: Path, second: Path) -> list[str]:
    """Names of all groups, datasets and attributes of two HDF5 files that are not the same bit for bit.

    Parameters
    ----------
    first, second : Path
        The files.

    Returns
    -------
    list of str
        What is missing in one of them or differs in kind, shape, or a bit; without what tells of time, see `TIMING`.
    """
    with h5py.File(first, "r") as a, h5py.File(second, "r") as b:
        one, two = _contents(a), _contents(b)
    return sorted(name for name in one.keys() | two.keys() if one.get(name) != two.get(name))


def _contents(file: h5py.File) -> dict[str, Any]:
    found: dict[str, Any] = {}

    def take(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            found[name] = _plain(item[()])
        found.setdefault(name, "group")
        for key, value in item.attrs.items():
            found[f"{name}@{key}"] = _plain(value)

    take("/", file)
    file.visititems(take)
    return {
        name: value
        for name, value in found.items()
        if not name.partition("@")[0].endswith(TIMING) and not name.endswith(TIMING)
    }


def _plain(value: Any) -> Any:
    array = np.asarray(value)
    content = array.tolist() if array.dtype == object else array.tobytes()
    return array.dtype.str, array.shape, content
