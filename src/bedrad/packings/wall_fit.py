"""A wall fitted to a bed whose wall nobody wrote down: a tube around it, a rod inside it or a plate below it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.placing import Placing, turn_to_z
from bedrad.packings.surface_fit import Surface, fit_cylinder, fit_plane, local
from bedrad.walls import Plate, Rod, Tube, Wall

__all__ = ["WALL_KINDS", "WallFit", "WallKind", "fit_wall"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
WallKind = Literal["tube", "rod", "plate"]

WALL_KINDS: tuple[str, ...] = get_args(WallKind)
"""The walls that can be fitted."""

_PATCH = 3.0
"""Side of the pieces of wall whose outermost sphere is taken to touch the wall, in mean diameters."""

_FEWEST_SECTORS = 6
_FEWEST_PATCHES = 12
_LARGEST_RESIDUAL = 0.05
_CONTACT = 0.02
"""How close to the first fit a sphere must reach to count in the second, in mean radii."""

_LARGEST_TILT = math.radians(20.0)
"""How far a fit may turn the direction that it started with."""

_SURE = 18.42
"""Squared tilt over its covariance from which on a tilt counts: once in 10,000 straight walls by chance."""

_LARGEST_REACH = 1e9
"""What coordinates may be to fit a wall, in mean radii; beyond that their roundings are no contacts any more."""

_LARGEST_NUMBER = 1e100
"""What radii may be, so that their squares are numbers. [m]"""

_ROUNDS = 10
_NEAREST = {"tube": "outermost", "rod": "innermost", "plate": "lowest"}
_SHAPE = {"tube": "circle", "rod": "circle", "plate": "plane"}


@dataclass(frozen=True)
class WallFit:
    """A fitted wall.

    Parameters
    ----------
    wall : Tube, Rod or Plate
        The wall, around z or at z = 0 once the bed is placed.
    origin : (float, float, float)
        The point of its axis, or of the plate, that is nearest to 0, 0, 0. [m]
    direction : (float, float, float)
        Unit vector along its axis, or from the plate into the bed.
    residual : float
        Root mean square distance from the wall of the spheres that should touch it, in mean radii.
    touching : int
        How many spheres the result comes from.
    radius_error : float or None
        Standard error of the radius; None for a plate. [m]
    origin_error : float
        Standard error of each of the two coordinates of the axis across itself, or of the height of the plate. [m]
    direction_error : float or None
        Standard error of each of the two tilts of the direction, None where the direction was given. [rad]
    """

    wall: Wall
    origin: tuple[float, float, float]
    direction: tuple[float, float, float]
    residual: float
    touching: int
    radius_error: float | None
    origin_error: float
    direction_error: float | None

    @property
    def placing(self) -> Placing:
        """What brings the bed to where the wall is around z, or at z = 0."""
        return Placing(self.origin, turn_to_z(np.array(self.direction)))

    def notes(self) -> dict[str, str | float | int]:
        """Return the provenance that says what was fitted, and how sure it is."""
        kind = self.wall.kind
        turned = self.direction != (0.0, 0.0, 1.0)
        moved = "moved to z = 0" if kind == "plate" else "its axis moved to 0, 0"
        notes: dict[str, str | float | int] = {
            "wall_origin": f"{kind} fitted by least squares to the {_NEAREST[kind]} spheres, {moved}"
            + (" and turned to z" if turned else ""),
            "wall_fit_residual_radii": self.residual,
            "wall_fit_spheres": self.touching,
        }
        if kind == "plate":
            notes["wall_fit_height_m"] = float(np.dot(self.origin, self.direction))
            notes["wall_fit_height_error_m"] = self.origin_error
        else:
            notes |= {f"wall_fit_axis_{name}_m": value for name, value in zip("xyz", self.origin, strict=True)}
            notes["wall_fit_axis_error_m"] = self.origin_error
        if self.radius_error is not None:
            notes["wall_fit_radius_error_m"] = self.radius_error
        if turned:
            notes |= {f"wall_fit_direction_{name}": value for name, value in zip("xyz", self.direction, strict=True)}
        if self.direction_error is not None:
            notes["wall_fit_direction_error_rad"] = self.direction_error
        return notes


def fit_wall(
    kind: WallKind,
    centers: FloatArray,
    radii: FloatArray,
    directions: Sequence[FloatArray] | None = None,
    *,
    may_turn: bool = True,
) -> WallFit:
    """Fit a wall to the spheres nearest to it.

    The wall is divided into pieces of about 3 by 3 diameters; the outermost sphere of each is taken to touch it, and a
    circle (or plane) is put through what these spheres reach. A second one through all spheres that touch the first
    within 2 % of a radius gives the result: the first lies too far out, as it takes the deepest contact of every
    piece. The second still lies one mean wall overlap too far out, which no standard error contains.

    The standard errors come from the residuals of the second fit, taken as independent. The direction is fitted too,
    and taken where it differs from the one tried by more than chance does once in 10,000 beds, and by more than 2 % of
    a radius over the length of the bed.

    Parameters
    ----------
    kind : "tube", "rod" or "plate"
        The wall.
    centers : (n, 3) array
        Sphere centres. [m]
    radii : (n,) array
        Sphere radii. [m]
    directions : sequence of (3,) arrays, optional
        Directions of the axis, or of the normal into the bed, that are tried one after the other. If not given: z, and
        for a tube or rod then x, y and the principal directions of the cloud.
    may_turn : bool
        Whether the direction may differ from those tried, by up to 20 degrees.

    Returns
    -------
    WallFit
        Where the wall is, and how well it fits.

    Raises
    ------
    ValueError
        If there are too few spheres, they do not surround an axis, or the outermost spheres miss a common circle or
        plane by more than 5 % of a radius; the message is about the first direction tried.
    """
    if kind not in WALL_KINDS:
        raise ValueError(f"the wall to fit is {kind!r}; expected {', '.join(map(repr, WALL_KINDS))}")
    if len(radii) < _FEWEST_PATCHES:
        raise ValueError(f"{len(centers)} spheres are too few to fit a {kind} to them; give the wall")
    if not (np.isfinite(centers).all() and np.isfinite(radii).all() and (radii > 0.0).all()):
        raise ValueError("a centre or radius is not finite and positive")
    reach, mean = float(np.abs(centers).max()), float(radii.mean())
    if not (reach <= _LARGEST_REACH * mean and 1.0 / _LARGEST_NUMBER < mean < _LARGEST_NUMBER):
        raise ValueError(
            f"spheres of a mean radius of {mean:.3g} m lie up to {reach:.3g} m from 0, 0, 0, too far to fit a {kind}; "
            "give the wall"
        )
    refusal: ValueError | None = None
    for direction in _candidates(kind, centers) if directions is None else directions:
        if may_turn and (tilted := _tilted(kind, centers, radii, direction)) is not None:
            return tilted
        try:
            return _fit(kind, centers, radii, direction, free=False)[0]
        except ValueError as error:
            refusal = refusal or error
    raise refusal or ValueError(f"no direction along which a {kind} could be fitted was given")


def _candidates(kind: WallKind, centers: FloatArray) -> list[FloatArray]:
    x, y, z = np.eye(3)
    if kind == "plate":
        # on which side of a plane the bed lies is not seen from the spheres
        return [z]
    principal = np.linalg.eigh(np.cov(centers.T))[1].T
    # an axis has no sense of its own: the one nearest to an axis of the file
    return [z, x, y, *(v * np.sign(v[np.argmax(np.abs(v))]) for v in principal)]


def _tilted(kind: WallKind, centers: FloatArray, radii: FloatArray, direction: FloatArray) -> WallFit | None:
    """A fit with a direction of its own, where there is one that certainly differs from the given one."""
    try:
        fit, surface = _fit(kind, centers, radii, direction, free=True)
    except ValueError:
        return None
    tilt = float(np.linalg.norm(np.cross(surface.direction, direction)))
    p = local(centers, surface.origin, surface.direction)
    length = float(np.ptp(p[:, 2]) if kind != "plate" else np.ptp(p[:, :2], axis=0).max())
    # of exact contacts nothing but roundings is left, and these are no tilt however sure it seems
    certain = tilt * length > _CONTACT * float(radii.mean()) and surface.tilt_sureness(direction) > _SURE
    return fit if certain else None


def _fit(
    kind: WallKind, centers: FloatArray, radii: FloatArray, direction: FloatArray, *, free: bool
) -> tuple[WallFit, Surface]:
    mean = float(radii.mean())
    standoff = radii if kind == "tube" else -radii
    surface, nearest = _first_fit(kind, centers, radii, direction, free)
    residual = surface.rms / mean
    if residual > _LARGEST_RESIDUAL:
        raise ValueError(
            f"the {_NEAREST[kind]} spheres miss a common {_SHAPE[kind]} by {residual:.3g} radii (root mean square); "
            f"at most {_LARGEST_RESIDUAL:g} is accepted for fitting a {kind}; give the wall"
        )
    touching = np.flatnonzero(np.abs(surface.miss(centers, standoff)) < _CONTACT * mean)
    if len(touching) < _FEWEST_PATCHES:
        touching = nearest
    surface = _surface(kind, centers[touching], standoff[touching], surface.origin, surface.direction, free)
    # the nearest point of the axis (or plane): what lies along it keeps its place
    along = surface.direction * float(surface.direction @ surface.origin)
    x, y, z = (along if kind == "plate" else surface.origin - along).tolist()
    u, v, w = surface.direction.tolist()
    wall = Plate() if surface.radius is None else (Tube if kind == "tube" else Rod)(surface.radius)
    fit = WallFit(
        wall,
        (x, y, z),
        (u, v, w),
        residual,
        len(touching),
        surface.radius_error,
        surface.origin_error,
        surface.direction_error,
    )
    return fit, surface


def _first_fit(
    kind: WallKind, centers: FloatArray, radii: FloatArray, direction: FloatArray, free: bool
) -> tuple[Surface, IntArray]:
    """The fit to the outermost sphere of every piece of wall, until it picks the same spheres again."""
    start = direction
    origin = _middle(centers, radii, direction)
    nearest = np.empty(0, np.int64)
    for _ in range(_ROUNDS):
        before, nearest = nearest, _nearest(kind, local(centers, origin, direction), radii)
        if np.array_equal(before, nearest):
            break
        standoff = radii if kind == "tube" else -radii
        surface = _surface(kind, centers[nearest], standoff[nearest], origin, direction, free)
        origin, direction = surface.origin, surface.direction
        if float(direction @ start) < math.cos(_LARGEST_TILT):
            raise ValueError(f"the {kind} turns too far from the direction tried")
    return surface, nearest


def _surface(
    kind: WallKind, points: FloatArray, standoff: FloatArray, origin: FloatArray, direction: FloatArray, free: bool
) -> Surface:
    if kind == "plate":
        return fit_plane(points, standoff, direction, free=free)
    return fit_cylinder(points, standoff, origin, direction, free=free)


def _middle(centers: FloatArray, radii: FloatArray, direction: FloatArray) -> FloatArray:
    """Middle of the box around the spheres that is turned to the direction."""
    p = local(centers, np.zeros(3), direction)
    middle = ((p - radii[:, None]).min(axis=0) + (p + radii[:, None]).max(axis=0)) / 2
    return np.asarray(turn_to_z(direction).T @ middle)


def _nearest(kind: WallKind, p: FloatArray, radii: FloatArray) -> IntArray:
    """Numbers of the spheres that reach furthest out in each piece of wall; `p` is about the axis or plane."""
    side = _PATCH * 2.0 * float(radii.mean())
    if kind == "plate":
        cells = np.floor((p[:, :2] - p[:, :2].min(axis=0)) / side).astype(np.int64)
        patch = cells[:, 0] * (int(cells[:, 1].max()) + 1) + cells[:, 1]
        _, which, counts = np.unique(patch, return_inverse=True, return_counts=True)
        # where the bed reaches into a piece only a little, none of its spheres need touch the plate
        inside = np.flatnonzero(counts[which] >= np.median(counts) / 2)
        patch, reach = patch[inside], radii - p[:, 2]
    else:
        inside, reach, patch = _mantle(kind, p, radii, side)
    order = np.lexsort((-reach[inside], patch))
    _, first = np.unique(patch[order], return_index=True)
    if len(first) < _FEWEST_PATCHES:
        raise ValueError(
            f"the spheres lie against {len(first)} pieces of wall of 3 by 3 diameters, too few to fit a {kind} to "
            "them; give the wall"
        )
    return np.asarray(inside[order[first]])


def _mantle(kind: WallKind, p: FloatArray, radii: FloatArray, side: float) -> tuple[IntArray, FloatArray, IntArray]:
    """The spheres away from the ragged ends of the bed, how far all reach out, and the pieces that these lie on."""
    distance = np.hypot(p[:, 0], p[:, 1])
    reach = distance + radii if kind == "tube" else radii - distance
    around = 2.0 * math.pi * abs(float(reach.max()))
    count = max(_FEWEST_SECTORS, int(around / side))
    # narrow tubes get narrow, tall pieces of the same area
    height = side * side * count / around if around > 0.0 else side
    z = p[:, 2]
    # the ragged top of a bed need not touch the wall
    inside = np.flatnonzero((z >= np.quantile(z, 0.02)) & (z <= np.quantile(z, 0.95)))
    turn = np.arctan2(p[inside, 1], p[inside, 0]) / (2.0 * math.pi) + 0.5
    sector = np.minimum((turn * count).astype(np.int64), count - 1)
    sixths = np.minimum((turn * _FEWEST_SECTORS).astype(np.int64), _FEWEST_SECTORS - 1)
    on_axis = kind == "rod" and float(reach.max()) >= 0.0
    if on_axis or len(np.unique(sixths)) < _FEWEST_SECTORS:
        raise ValueError(f"the spheres do not surround an axis along z, so that no {kind} can be fitted; give the wall")
    level = np.floor((z[inside] - z[inside].min()) / height).astype(np.int64)
    return inside, reach, level * count + sector
