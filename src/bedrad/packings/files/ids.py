"""The order that ids give spheres, which programs write in any."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError

__all__ = ["id_order"]


def id_order(
    where: Path | str, ids: NDArray[np.int64], things: str, places: Sequence[int] | NDArray[np.int64] | None = None
) -> NDArray[np.intp]:
    """Return the order that sorts ids.

    Parameters
    ----------
    where : path or str
        The file, or the place in it, for messages.
    ids : (n,) array
        The ids.
    things : str
        What has the ids, for messages, such as ``"lines"``.
    places : (n,) integers, optional
        The numbers of these things; counted from 0 if not given.

    Raises
    ------
    BadFileError
        If an id comes twice; the message names both places.
    """
    order = np.argsort(ids, kind="stable")
    twice = np.flatnonzero(np.diff(ids[order]) == 0)
    if len(twice):
        first, second = order[twice[0] : twice[0] + 2].tolist()
        a, b = (first, second) if places is None else (places[first], places[second])
        raise BadFileError(f"{where}, {things} {a} and {b}: both have the id {ids[first]}")
    return order
