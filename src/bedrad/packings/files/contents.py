"""What a file holds before it is a packing, and the wall as a word and a radius."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bedrad.walls import Plate, Rod, Tube, Wall

if TYPE_CHECKING:
    from bedrad.packings.packing import Provenance

__all__ = ["Contents", "describe_wall", "make_wall", "plain_value"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Contents:
    """The spheres of one frame of a file, and whatever else the file says.

    Parameters
    ----------
    centers : (n, 3) array
        Sphere centres. [m]
    radii : (n,) array or None
        Sphere radii, where the file has them. [m]
    wall : Tube, Rod, Plate or None
        The wall, where the file names it. [m]
    period : float, (float, float) or None
        Axial period, where the file names the wall too. [m]
    axis_periods : mapping of int to float
        Periods of the Cartesian axes, where the file knows a box but no wall. [m]
    provenance : mapping
        Provenance stored in the file, or the file, frame and step the spheres come from.
    max_overlap : float or None
        Overlap limit stored in the file, in radii.
    lines, ids : (n,) arrays or None
        Line number (from 1) and particle id of every sphere, for messages.
    states_unit : bool
        Whether the file says what its lengths are in, or its format does. They are metres then; if not, the user
        may say what they are, and metres are assumed.
    no_unit : str
        Where a file that does not say so should have, such as ``"line 1: column x has no unit"``: nothing is assumed
        then, and the user has to say what the lengths are in.
    wall_in_file_unit : bool
        Whether the wall and its period are in the unit of the other lengths, whatever that is, and not in metres.
    """

    centers: FloatArray
    radii: FloatArray | None
    wall: Wall | None = None
    period: float | tuple[float, float] | None = None
    axis_periods: Mapping[int, float] = field(default_factory=dict)
    provenance: Provenance = field(default_factory=dict)
    max_overlap: float | None = None
    lines: IntArray | None = None
    ids: IntArray | None = None
    states_unit: bool = False
    no_unit: str = ""
    wall_in_file_unit: bool = False

    def scaled(self, metre: float, provenance: Provenance) -> Contents:
        """Return the same in metres, for lengths in a unit of so many metres, with another provenance."""
        wall, period = self.wall, self.period
        if self.wall_in_file_unit:
            wall = wall if wall is None or isinstance(wall, Plate) else type(wall)(wall.radius * metre)
            if period is not None:
                period = period * metre if isinstance(period, float) else (period[0] * metre, period[1] * metre)
        return replace(
            self,
            centers=self.centers * metre,
            radii=None if self.radii is None else self.radii * metre,
            wall=wall,
            period=period,
            axis_periods={axis: length * metre for axis, length in self.axis_periods.items()},
            provenance=provenance,
        )

    def origin(self, sphere: int) -> str:
        """Where a sphere stands in the file, as ``"line 12, id 7"``; empty where that is unknown."""
        parts = []
        if self.lines is not None:
            parts.append(f"line {self.lines[sphere]}")
        if self.ids is not None:
            parts.append(f"id {self.ids[sphere]}")
        return ", ".join(parts)


def describe_wall(wall: Wall) -> tuple[str, float | None]:
    """Return the wall's kind and its radius [m], None for a plate."""
    return wall.kind, None if isinstance(wall, Plate) else wall.radius


def make_wall(kind: object, radius: object) -> Wall:
    """Build the wall that `describe_wall` described.

    Raises
    ------
    ValueError
        If the kind is unknown, or the radius is missing or not a positive number.
    """
    if kind == Plate.kind:
        return Plate()
    for shape in (Tube, Rod):
        if kind == shape.kind:
            if not isinstance(radius, (int, float, np.floating, np.integer)):
                raise ValueError(f"the {kind} wall has the radius {radius!r:.40}; expected a number of metres")
            return shape(float(radius))
    raise ValueError(f"the wall is {kind!r:.40}; expected {Tube.kind!r}, {Rod.kind!r} or {Plate.kind!r}")


def plain_value(key: str, value: object) -> str | float | int:
    """Return a provenance value as a Python text, float or integer that every format can hold.

    Raises
    ------
    ValueError
        If it is none of these, or an integer beyond 64 bits.
    """
    if isinstance(value, str):
        return value
    if isinstance(value, (float, np.floating)):
        return float(value)
    if isinstance(value, (int, np.integer)) and -(2**63) <= int(value) < 2**63:
        return int(value)
    raise ValueError(f"provenance {key!r:.40} is {value!r:.40}; expected a text, a float or a 64-bit integer")
