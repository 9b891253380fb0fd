"""`Packing`: spheres beside a wall, checked once and immutable afterwards; the one thing that travels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.packings.overlaps import worst_overlap
from bedrad.walls import Plate, Rod, Tube, Wall, Window

__all__ = ["END_MARGIN", "LARGEST_OVERLAP", "Packing", "Provenance"]

FloatArray = NDArray[np.float64]
Provenance = Mapping[str, str | float | int]

LARGEST_OVERLAP = 0.1
"""Overlap with the wall or another sphere that a packing may have by default, in radii of the smaller sphere."""

END_MARGIN = 4.0
"""What a measuring window leaves out at each open end by default, in mean particle diameters."""


@dataclass(frozen=True, eq=False)
class Packing:
    """Spheres beside a wall.

    Soft spheres overlap each other and the wall a little; volumes and rays treat each sphere as whole and cut it at
    the wall, and what lies beyond the wall does not count.

    Parameters
    ----------
    centers : (n, 3) array
        Sphere centres; copied. Along a periodic axis they are wrapped into [0, period). [m]
    radii : (n,) array or float
        Sphere radii. [m]
    wall : Tube, Rod or Plate
        The wall.
    period : float, (float, float) or None
        Axial period along z for a tube or rod; periods along x and y for a plate; None for open ends. [m]
    provenance : mapping, optional
        Where the packing comes from: names to texts or numbers.
    max_overlap : float
        Overlap with the wall or with another sphere that is still accepted, in radii (of the smaller sphere).

    Raises
    ------
    ValueError
        If a coordinate is not finite, a radius is not positive, a sphere reaches further through the wall than
        `max_overlap`, or two spheres overlap deeper than that. The message names the sphere (counted from 0) and the
        value.
    """

    centers: FloatArray
    radii: FloatArray
    wall: Wall
    period: float | tuple[float, float] | None = None
    provenance: Provenance = field(default_factory=dict)
    max_overlap: float = LARGEST_OVERLAP

    def __init__(
        self,
        centers: ArrayLike,
        radii: ArrayLike,
        wall: Wall,
        period: float | tuple[float, float] | None = None,
        provenance: Provenance | None = None,
        max_overlap: float = LARGEST_OVERLAP,
    ) -> None:
        if not isinstance(wall, (Tube, Rod, Plate)):
            raise TypeError(f"wall is {wall!r}; expected a bedrad.Tube, bedrad.Rod or bedrad.Plate")
        if not (math.isfinite(max_overlap) and max_overlap >= 0):
            raise ValueError(f"max_overlap is {max_overlap}; expected a number of radii that is not negative")
        c = _as_centers(centers)
        r = _as_radii(radii, len(c))
        p = _as_period(period, wall)
        _check_spheres(c, r)
        box = _box(p, wall)
        for axis in wall.periodic_axes:
            if box[axis]:
                c[:, axis] = np.mod(c[:, axis], box[axis])
                # np.mod of a tiny negative number rounds up to the period itself
                c[c[:, axis] >= box[axis], axis] = 0.0
        _check_period(r, box, max_overlap)
        _check_wall(c, r, wall, max_overlap)
        _check_pairs(c, r, box, max_overlap)
        c.setflags(write=False)
        r.setflags(write=False)
        for name, value in (
            ("centers", c),
            ("radii", r),
            ("wall", wall),
            ("period", p),
            ("provenance", MappingProxyType(dict(provenance or {}))),
            ("max_overlap", float(max_overlap)),
        ):
            object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        # a mapping proxy cannot be pickled; a copy in another process is checked and immutable again
        return Packing, (
            self.centers,
            self.radii,
            self.wall,
            self.period,
            dict(self.provenance),
            self.max_overlap,
        )

    def __len__(self) -> int:
        return len(self.radii)

    def __repr__(self) -> str:
        size = f", mean diameter {self.mean_diameter:.6g} m" if len(self) else ""
        return f"Packing({len(self)} spheres{size}, wall={self.wall!r}, period={self.period!r})"

    @property
    def box(self) -> tuple[float, float, float]:
        """Period of each Cartesian axis, 0 where it is open. [m]"""
        return _box(self.period, self.wall)

    @property
    def mean_diameter(self) -> float:
        """Number mean of the diameters. [m]"""
        if not len(self):
            raise ValueError("an empty packing has no mean diameter")
        return 2.0 * float(self.radii.mean())

    @property
    def depths(self) -> FloatArray:
        """Depth of every centre below the wall. [m]"""
        return self.wall.depth(self.centers)

    def extent(self, axis: int) -> tuple[float, float]:
        """Lowest and highest coordinate that the spheres reach along an axis, or (0, period) where periodic. [m]"""
        if self.box[axis]:
            return 0.0, self.box[axis]
        if not len(self):
            raise ValueError("an empty packing without a period has no extent")
        x = self.centers[:, axis]
        return float((x - self.radii).min()), float((x + self.radii).max())

    def window(self, margin: float = END_MARGIN) -> Window:
        """The piece of wall to measure: all of a period, or what is left after the open ends are left out.

        Parameters
        ----------
        margin : float
            What is left out at each open end, in mean particle diameters; a margin of 1 or more leaves
            out at least the largest diameter.

        Raises
        ------
        ValueError
            If the margin is negative or not finite, or nothing is left.
        """
        if not (math.isfinite(margin) and margin >= 0):
            raise ValueError(f"margin is {margin}; expected a number of mean diameters that is not negative")
        axes = (self.wall.axial,) if not isinstance(self.wall, Plate) else (0, 1)
        ranges = []
        for axis in axes:
            low, high = self.extent(axis)
            if not self.box[axis]:
                # the ends disturb at least the spheres that touch them, however small the mean
                cut = max(margin * self.mean_diameter, min(margin, 1.0) * 2.0 * float(self.radii.max()))
                if high - low <= 2 * cut:
                    raise ValueError(
                        f"the bed is {high - low:.6g} m long in {'xyz'[axis]}; leaving out {margin:g} mean "
                        f"diameters ({cut:.6g} m) at each end leaves nothing to measure: "
                        "give a taller bed or a smaller margin"
                    )
                low, high = low + cut, high - cut
            ranges.append((low, high))
        return Window(ranges[0], ranges[1] if len(ranges) > 1 else None)


def _as_centers(centers: ArrayLike) -> FloatArray:
    c = np.array(centers, dtype=np.float64, copy=True, order="C")
    if c.size == 0:
        c = c.reshape(0, 3)
    if c.ndim != 2 or c.shape[1] != 3:
        raise ValueError(f"centers has the shape {c.shape}; expected (n, 3)")
    return c


def _as_radii(radii: ArrayLike, count: int) -> FloatArray:
    r = np.asarray(radii, dtype=np.float64)
    if r.ndim == 0:
        return np.full(count, float(r))
    if r.shape != (count,):
        raise ValueError(f"radii has the shape {r.shape}; expected one radius or ({count},), one a centre")
    return r.copy()


def _as_period(period: float | tuple[float, float] | None, wall: Wall) -> float | tuple[float, float] | None:
    if period is None:
        return None
    values = np.atleast_1d(np.asarray(period, dtype=float))
    wanted = len(wall.periodic_axes)
    if values.shape != (wanted,) or not (np.isfinite(values).all() and (values > 0).all()):
        form = "one positive length" if wanted == 1 else "two positive lengths (along x and y)"
        raise ValueError(f"period is {period!r}; a {wall.kind} takes {form} in metres, or None")
    return float(values[0]) if wanted == 1 else (float(values[0]), float(values[1]))


def _box(period: float | tuple[float, float] | None, wall: Wall) -> tuple[float, float, float]:
    box = [0.0, 0.0, 0.0]
    if period is not None:
        for axis, length in zip(wall.periodic_axes, np.atleast_1d(period), strict=True):
            box[axis] = float(length)
    return box[0], box[1], box[2]


def _check_spheres(c: FloatArray, r: FloatArray) -> None:
    bad = np.flatnonzero(~np.isfinite(c).all(axis=1))
    if len(bad):
        i = int(bad[0])
        raise ValueError(f"sphere {i}: centre {tuple(c[i].tolist())} m is not finite ({len(bad)} such)")
    bad = np.flatnonzero(~(np.isfinite(r) & (r > 0)))
    if len(bad):
        i = int(bad[0])
        raise ValueError(f"sphere {i}: radius {r[i]} m; expected a positive, finite number ({len(bad)} such)")


def _check_period(r: FloatArray, box: tuple[float, float, float], max_overlap: float) -> None:
    lengths = [b for b in box if b]
    if len(r) and lengths and min(lengths) < r.max() * (2.0 - max_overlap) * (1.0 - 1e-12):
        i = int(r.argmax())
        raise ValueError(
            f"sphere {i}: radius {r[i]:.6g} m overlaps its own image in a period of {min(lengths):.6g} m "
            f"by more than the {max_overlap:g} radii that are accepted"
        )


def _check_wall(c: FloatArray, r: FloatArray, wall: Wall, max_overlap: float) -> None:
    through = (r - wall.depth(c)) / r
    if len(through) and through.max() > max_overlap * (1.0 + 1e-12):
        i = int(through.argmax())
        many = int((through > max_overlap).sum())
        raise ValueError(
            f"sphere {i}: centre {tuple(c[i].tolist())} m, radius {r[i]:.6g} m reaches {through[i]:.4g} of its radius "
            f"through the {wall.kind} wall ({wall!r}); at most {max_overlap:g} is accepted ({many} such)"
        )


def _check_pairs(c: FloatArray, r: FloatArray, box: tuple[float, float, float], max_overlap: float) -> None:
    worst = worst_overlap(c, r, box, enough=max_overlap)
    if worst is None or worst.share <= max_overlap:
        return
    i, j = worst.first, worst.second
    where = "lie on one point" if np.array_equal(c[i], c[j]) else f"overlap by {worst.share:.4g} of the smaller radius"
    raise ValueError(
        f"spheres {i} and {j}, at {tuple(c[i].tolist())} m and {tuple(c[j].tolist())} m, {where}; "
        f"at most {max_overlap:g} is accepted"
    )
