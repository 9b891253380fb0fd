"""From the columns of a table to spheres: sizes, the order of the ids, and what the digits allow."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.facts import Facts
from bedrad.packings.files.ids import id_order
from bedrad.packings.files.rows import Table

__all__ = ["table_spheres"]

FloatArray = NDArray[np.float64]

_FULL_DIGITS = 15
"""Decimal digits that every double can hold."""

_SAMPLE = 1000
"""Rows whose digits are counted."""


def table_spheres(
    path: Path,
    table: Table,
    origin: Mapping[str, str | float | int],
    facts: Facts | None = None,
    *,
    metre: float = 1.0,
    **others: Any,
) -> Contents:
    """Make spheres of a table.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    table : Table
        Columns x, y, z and, where the file has them, radius or diameter, and id.
    origin : mapping
        The provenance, if the file holds none. Where the numbers are rounded, it is added how far: `position_digits`,
        the significant digits of the positions (at least 6, the fewest that programs print by default), and
        `gap_rounding_radii`, the bound of the rounding of a gap between two spheres, in mean radii. Two spheres in
        contact are apart in such a file, or overlap, by up to that: a tolerance for contacts below it counts the
        rounding.
    facts : Facts, optional
        What else bedrad wrote into the file.
    metre : float
        Metres in the unit of the table.
    **others
        Further arguments of `Contents`.

    Returns
    -------
    Contents
        The spheres, in the order of their ids, or of the rows where there are none.

    Raises
    ------
    BadFileError
        If an id is no integer or comes twice, or a fact is not understood; the message names the lines.
    """
    columns, lines = table.columns, table.lines
    order: NDArray[np.intp] | slice = slice(None)
    ids = None
    if "id" in columns:
        ids = _integers(path, table)
        order = id_order(path, ids, "lines", lines)
        ids = ids[order]
    centers = np.stack([columns[axis][order] for axis in "xyz"], axis=1)
    radii = None
    if "radius" in columns:
        radii = columns["radius"][order].copy()
    elif "diameter" in columns:
        radii = columns["diameter"][order] / 2.0
    provenance = {**origin, **rounding_notes(centers, radii)}
    known = {"provenance": provenance} if facts is None else facts.understood(provenance)
    # a factor of one changes no bit
    centers *= metre
    if radii is not None:
        radii *= metre
    return Contents(centers, radii, lines=lines[order], ids=ids, **known, **others)


def _integers(path: Path, table: Table) -> NDArray[np.int64]:
    ids = table.columns["id"]
    broken = np.flatnonzero((ids != np.floor(ids)) | (np.abs(ids) > 2**53))
    if len(broken):
        i = int(broken[0])
        raise BadFileError(f"{path}, line {table.lines[i]}: id is {ids[i]}; expected an integer")
    return ids.astype(np.int64)


def rounding_notes(centers: FloatArray, radii: FloatArray | None) -> dict[str, str | float | int]:
    """Say how far spheres of a text are rounded; the result is described at `table_spheres`.

    Parameters
    ----------
    centers : (n, 3) array
        Sphere centres, as the file has them.
    radii : (n,) array or None
        Sphere radii, in the same unit.
    """
    step = max(1, len(centers) // _SAMPLE)
    sample = centers[::step].ravel().tolist()
    digits = next((d for d in range(6, _FULL_DIGITS) if all(float(f"{x:.{d}g}") == x for x in sample)), None)
    if digits is None or not sample:
        return {}
    notes: dict[str, str | float | int] = {"position_digits": digits}
    if radii is not None and radii.min() > 0:
        with np.errstate(over="ignore"):
            reach, largest, mean = (float(value) for value in (np.abs(centers).max(), radii.max(), radii.mean()))
        # beyond that there are no spheres, but numbers that are refused where they are checked
        if max(reach, mean) < math.inf:
            # every coordinate of both centres may be half a unit of its last digit off, and so may both radii
            apart = 2 * math.sqrt(3) * _half_unit(reach, digits)
            notes["gap_rounding_radii"] = (apart + 2 * _half_unit(largest, digits)) / mean
    return notes


def _half_unit(largest: float, digits: int) -> float:
    """Half a unit in the last of so many significant digits."""
    return 0.5 * 10.0 ** (math.floor(math.log10(largest)) + 1 - digits) if largest > 0 else 0.0
