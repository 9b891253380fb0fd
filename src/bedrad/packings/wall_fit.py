"""A tube fitted around a bed whose wall nobody wrote down."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["TubeFit", "fit_tube"]

FloatArray = NDArray[np.float64]

_PATCH = 3.0
"""Side of the pieces of wall whose outermost sphere is taken to touch the wall, in mean diameters."""

_FEWEST_SECTORS = 6
_FEWEST_PATCHES = 12
_LARGEST_RESIDUAL = 0.05
_CONTACT = 0.02
"""How close to the first circle a sphere must reach to count in the second fit, in mean radii."""


@dataclass(frozen=True)
class TubeFit:
    """A tube around the z direction.

    Parameters
    ----------
    axis : (float, float)
        x and y of its axis. [m]
    radius : float
        Its radius. [m]
    residual : float
        Root mean square distance from the wall of the spheres that should touch it, in mean radii.
    touching : int
        How many spheres the radius comes from.
    """

    axis: tuple[float, float]
    radius: float
    residual: float
    touching: int

    def notes(self) -> dict[str, str | float | int]:
        """Return the provenance that says what was fitted."""
        return {
            "wall_origin": "tube fitted by least squares to the outermost spheres, its axis moved to 0, 0",
            "wall_fit_axis_x_m": self.axis[0],
            "wall_fit_axis_y_m": self.axis[1],
            "wall_fit_residual_radii": self.residual,
            "wall_fit_spheres": self.touching,
        }


def fit_tube(centers: FloatArray, radii: FloatArray) -> TubeFit:
    """Fit a tube around the z direction to a bed that fills it.

    The mantle is divided into pieces of about 3 by 3 diameters; the outermost sphere of each is taken to
    touch the wall, and a circle is put through what these spheres reach. A second circle through all spheres
    that touch the first within 2 % of a radius gives the result: the first lies too far out, as it takes the
    deepest contact of every piece. The second still lies one mean wall overlap too far out.

    Parameters
    ----------
    centers : (n, 3) array
        Sphere centres. [m]
    radii : (n,) array
        Sphere radii. [m]

    Returns
    -------
    TubeFit
        Axis, radius, and how well they fit.

    Raises
    ------
    ValueError
        If there are too few spheres, they do not surround an axis, or the outermost spheres miss a common
        circle by more than 5 % of a radius.
    """
    advice = "give the wall"
    if len(radii) < _FEWEST_PATCHES:
        raise ValueError(f"{len(centers)} spheres are too few to fit a tube around them; {advice}")
    if not (np.isfinite(centers).all() and np.isfinite(radii).all() and (radii > 0).all()):
        raise ValueError("a centre or radius is not finite and positive")
    mean_radius = float(radii.mean())
    outer = _outermost(centers, radii)
    sectors = _sectors(centers[outer], *_middle(centers, radii))
    if len(outer) < _FEWEST_PATCHES or len(np.unique(sectors)) < _FEWEST_SECTORS:
        raise ValueError(f"the spheres do not surround an axis along z, so that no tube can be fitted; {advice}")
    x, y, radius = _circle(centers[outer], radii[outer], _middle(centers, radii))
    residual = _rms(_reach(centers[outer], radii[outer], x, y) - radius) / mean_radius
    if residual > _LARGEST_RESIDUAL:
        raise ValueError(
            f"the outermost spheres miss a common circle by {residual:.3g} radii (root mean square); "
            f"at most {_LARGEST_RESIDUAL:g} is accepted for fitting a tube; {advice}"
        )
    touching = np.flatnonzero(np.abs(_reach(centers, radii, x, y) - radius) < _CONTACT * mean_radius)
    if len(touching) >= _FEWEST_PATCHES:
        x, y, radius = _circle(centers[touching], radii[touching], (x, y))
    else:
        touching = outer
    return TubeFit((x, y), radius, residual, len(touching))


def _middle(centers: FloatArray, radii: FloatArray) -> tuple[float, float]:
    xy = centers[:, :2]
    low, high = (xy - radii[:, None]).min(axis=0), (xy + radii[:, None]).max(axis=0)
    x, y = ((low + high) / 2).tolist()
    return x, y


def _outermost(centers: FloatArray, radii: FloatArray) -> NDArray[np.int64]:
    """Numbers of the spheres that reach furthest out in each piece of the mantle."""
    x, y = _middle(centers, radii)
    reach = _reach(centers, radii, x, y)
    side = _PATCH * 2.0 * float(radii.mean())
    around = 2.0 * math.pi * float(reach.max())
    count = max(_FEWEST_SECTORS, int(around / side))
    # narrow tubes get narrow, tall pieces of the same area
    height = side * side * count / around
    z = centers[:, 2]
    # the ragged top of a bed need not touch the wall
    inside = np.flatnonzero((z >= np.quantile(z, 0.02)) & (z <= np.quantile(z, 0.95)))
    level = np.floor((z[inside] - z[inside].min()) / height).astype(np.int64)
    patch = level * count + _sectors(centers[inside], x, y, count)
    order = np.lexsort((-reach[inside], patch))
    _, first = np.unique(patch[order], return_index=True)
    return inside[order[first]]


def _sectors(centers: FloatArray, x: float, y: float, count: int = _FEWEST_SECTORS) -> NDArray[np.int64]:
    turn = np.arctan2(centers[:, 1] - y, centers[:, 0] - x) / (2.0 * math.pi) + 0.5
    return np.minimum((turn * count).astype(np.int64), count - 1)


def _reach(centers: FloatArray, radii: FloatArray, x: float, y: float) -> FloatArray:
    return np.asarray(np.hypot(centers[:, 0] - x, centers[:, 1] - y) + radii)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values * values)))


def _circle(centers: FloatArray, radii: FloatArray, start: tuple[float, float]) -> tuple[float, float, float]:
    """Circle that minimises the squared distances of the reaches from it, by Gauss-Newton steps."""
    x, y = start
    radius = float(_reach(centers, radii, x, y).mean())
    for _ in range(20):
        dx, dy = centers[:, 0] - x, centers[:, 1] - y
        distance = np.hypot(dx, dy)
        # a sphere on the axis has no direction; it is an outermost one only where the tube is one sphere wide
        safe = np.where(distance > 0.0, distance, 1.0)
        slopes = np.stack([dx / safe, dy / safe, np.ones_like(safe)], axis=1)
        step = np.linalg.lstsq(slopes, distance + radii - radius, rcond=None)[0]
        x, y, radius = x + float(step[0]), y + float(step[1]), radius + float(step[2])
        if float(np.abs(step).max()) < 1e-14 * radius:
            break
    return x, y, radius
