"""From what a file holds to a packing: units, sizes, the axis along z, and the wall, given or fitted."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.units import metres
from bedrad.packings.packing import LARGEST_OVERLAP, Packing
from bedrad.packings.placing import Placing, direction_vector, turn_to_z
from bedrad.packings.wall_fit import WallKind, fit_wall
from bedrad.packings.wall_stl import WallSurface
from bedrad.walls import Wall

__all__ = ["Axis", "Options", "Period", "as_packing"]

FloatArray = NDArray[np.float64]
Axis = str | Sequence[float]
Period = float | tuple[float, float]

_Z = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Options:
    """How the spheres of a file are to be read: see `bedrad.read`, which these come from.

    Parameters
    ----------
    wall : Tube, Rod, Plate, WallSurface, str or None
        The wall, the surface that is one, or the kind of wall to fit; None takes the file's, or fits a tube.
    diameter : float or None
        Sphere diameter, for files that hold positions only. [m]
    period : float, (float, float) or None
        Axial period. [m]
    max_overlap : float or None
        Overlap that is still accepted, in radii.
    unit : str or None
        What the lengths of the file are in.
    axis : str, (float, float, float) or None
        Direction of the wall's axis, or of the normal into the bed, in the file.
    origin : (float, float, float) or None
        A point of that axis, or of the plate, in the file. [m]

    Raises
    ------
    ValueError
        If the unit or axis is none, or the origin is not three finite numbers, or axis or origin are given although
        a file says where the wall is.
    """

    wall: Wall | WallSurface | WallKind | None = None
    diameter: float | None = None
    period: Period | None = None
    max_overlap: float | None = None
    unit: str | None = None
    axis: Axis | None = None
    origin: Sequence[float] | None = None

    def __post_init__(self) -> None:
        if self.unit is not None:
            metres(self.unit)
        if self.axis is not None:
            direction_vector(self.axis)
        if self.origin is not None:
            try:
                finite = len(self.origin) == 3 and all(math.isfinite(value) for value in self.origin)
            except TypeError:
                finite = False
            if not finite:
                raise ValueError(f"origin is {self.origin!r}; expected three finite numbers of metres")
        if isinstance(self.wall, WallSurface) and self.places:
            raise ValueError(f"{self.wall.path} says where the wall is; axis and origin are for other walls")
        if isinstance(self.wall, str) and self.origin is not None:
            raise ValueError(f"an origin was given, but where the {self.wall} is will be fitted")

    @property
    def places(self) -> bool:
        """Whether they say where the wall is in the file."""
        return self.axis is not None or self.origin is not None


def as_packing(path: Path, held: Contents, options: Options) -> Packing:
    """Make the packing from what a file holds.

    Raises
    ------
    BadFileError
        If it is not a valid packing, or no wall can be fitted to it.
    ValueError
        If an option does not fit the file.
    """
    held = _in_metres(path, held, options.unit)
    radii = _sizes(path, held, options.diameter)
    if options.wall is None and held.wall is not None and options.places:
        raise ValueError(f"axis or origin was given, but {path} holds a bed whose wall is in place")
    if options.wall is None and held.wall is None and options.origin is not None:
        raise ValueError(f"an origin was given, but no wall, so that the tube around the bed of {path} is fitted")
    provenance = dict(held.provenance)
    try:
        # numbers whose squares or ratios are none any more: what comes of them is compared, and refused
        with np.errstate(over="ignore", invalid="ignore"):
            held = _placed(held, options, provenance)
            wall, held = _walled(held, radii, options, provenance)
            limit = options.max_overlap if options.max_overlap is not None else held.max_overlap
            return Packing(
                held.centers,
                radii,
                wall,
                _period(held, wall, options.period),
                provenance,
                LARGEST_OVERLAP if limit is None else limit,
            )
    except ValueError as error:
        raise BadFileError(f"{path}: {error}{_origins(held, str(error))}") from error


def _in_metres(path: Path, held: Contents, unit: str | None) -> Contents:
    if held.states_unit:
        if unit is not None:
            raise ValueError(f"the unit {unit!r} was given, but {path} states the unit of its lengths")
        return held
    if unit is None:
        if held.no_unit:
            raise BadFileError(f"{path}, {held.no_unit}; give the unit of its lengths, such as 'mm'")
        return replace(held, provenance={**held.provenance, "length_unit": "m, assumed"})
    return held.scaled(metres(unit), {**held.provenance, "length_unit": f"{unit.strip()}, as given"})


def _sizes(path: Path, held: Contents, diameter: float | None) -> FloatArray:
    if held.radii is None:
        if diameter is None:
            raise BadFileError(f"{path}: no column radius or diameter; give the diameter of the spheres")
        if not (math.isfinite(diameter) and diameter > 0):
            raise ValueError(f"diameter is {diameter!r}; expected a positive number of metres")
        return np.full(len(held.centers), diameter / 2)
    if diameter is not None:
        raise ValueError(f"diameter {diameter!r} m was given, but {path} has the sizes of its spheres")
    return held.radii


def _placed(held: Contents, options: Options, provenance: dict[str, str | float | int]) -> Contents:
    """The spheres turned and moved as the options say."""
    if not options.places:
        return held
    direction = direction_vector(_Z if options.axis is None else options.axis)
    x, y, z = (0.0, 0.0, 0.0) if options.origin is None else map(float, options.origin)
    if options.axis is not None:
        provenance["axis_turned_to_z"] = " ".join(f"{value:.9g}" for value in direction.tolist())
    if options.origin is not None:
        provenance["origin_moved_to_0_m"] = f"{x!r} {y!r} {z!r}"
    return _moved(held, Placing((x, y, z), turn_to_z(direction)))


def _moved(held: Contents, placing: Placing) -> Contents:
    return replace(held, centers=placing.place(held.centers), axis_periods=placing.periods(held.axis_periods))


def _walled(
    held: Contents, radii: FloatArray, options: Options, provenance: dict[str, str | float | int]
) -> tuple[Wall, Contents]:
    """The wall, and the spheres where they are beside it; what was fitted goes into the provenance."""
    wall = held.wall if options.wall is None else options.wall
    if isinstance(wall, WallSurface):
        beside = wall.beside(held.centers)
        provenance |= beside.notes
        return beside.wall, _moved(held, beside.placing)
    if wall is not None and not isinstance(wall, str):
        return wall, held
    kind: WallKind = "tube" if wall is None else wall
    # along a direction that was given, or in which the bed repeats, the wall is straight
    known = options.axis is not None or bool(options.period) or bool(held.axis_periods)
    fit = fit_wall(kind, held.centers, radii, _directions(kind, held, options) if known else None, may_turn=not known)
    provenance |= fit.notes()
    return fit.wall, _moved(held, fit.placing)


def _directions(kind: WallKind, held: Contents, options: Options) -> list[FloatArray]:
    """Directions along which a wall may lie where one is known."""
    axes = np.eye(3)
    if kind == "plate" or options.axis is not None or options.period:
        return [axes[2]]
    # z first, then x, then y
    return [axes[axis] for axis in (2, 0, 1) if axis in held.axis_periods]


def _period(held: Contents, wall: Wall, given: Period | None) -> Period | None:
    if given is not None:
        return None if given == 0 else given
    if held.wall is not None:
        # a period along the wall means something else for another kind of wall
        return held.period if held.wall.kind == wall.kind else None
    lengths = [held.axis_periods[axis] for axis in wall.periodic_axes if axis in held.axis_periods]
    if len(lengths) < len(wall.periodic_axes):
        return None
    return lengths[0] if len(lengths) == 1 else (lengths[0], lengths[1])


def _origins(held: Contents, message: str) -> str:
    """Where the spheres that a message of `Packing` names stand in the file."""
    match = re.match(r"spheres? (\d+)(?: and (\d+))?", message)
    places = [held.origin(int(number)) for number in match.groups() if number is not None] if match else []
    return f" ({' and '.join(places)})" if any(places) else ""
