"""Walls that a bed of spheres lies against: `Tube` (concave), `Rod` (convex) and `Plate` (flat).

A wall knows the depth of a point below it, its normal, its area and the volume of a layer between two depths.
`Tube` and `Rod` have the z axis as their axis. `Plate` is the plane z = 0 with the bed above it; its two directions
along the wall are x (called axial here, as z is for a tube) and y (lateral).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Plate", "Rod", "Tube", "Wall", "Window"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Window:
    """The piece of wall that is measured.

    Parameters
    ----------
    axial : (float, float)
        Range along the axis (z of a tube or rod, x of a plate). [m]
    lateral : (float, float) or None
        Range of y for a plate; None for a tube or rod, which are measured all round. [m]

    Raises
    ------
    ValueError
        If a range is empty or not finite.
    """

    axial: tuple[float, float]
    lateral: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for name, interval in (("axial", self.axial), ("lateral", self.lateral)):
            if interval is None:
                continue
            low, high = interval
            if not (math.isfinite(low) and math.isfinite(high) and low < high):
                raise ValueError(f"{name} window ({low}, {high}) m is empty or not finite; expected low < high")

    @property
    def length(self) -> float:
        """Axial length of the window. [m]"""
        return self.axial[1] - self.axial[0]


def _check_radius(what: str, radius: float) -> None:
    if not (isinstance(radius, (int, float, np.floating, np.integer)) and math.isfinite(radius) and radius > 0):
        raise ValueError(f"{what} radius is {radius!r}; expected a positive, finite number of metres")


@dataclass(frozen=True)
class Tube:
    """A concave wall: the inside of a circular tube around the z axis.

    Parameters
    ----------
    radius : float
        Inner radius. [m]

    Raises
    ------
    ValueError
        If the radius is not positive and finite.
    """

    radius: float
    kind: ClassVar[str] = "tube"
    axial: ClassVar[int] = 2
    periodic_axes: ClassVar[tuple[int, ...]] = (2,)

    def __post_init__(self) -> None:
        _check_radius("tube", self.radius)
        object.__setattr__(self, "radius", float(self.radius))

    @property
    def largest_depth(self) -> float:
        """Depth of the axis, the deepest point there is. [m]"""
        return self.radius

    def depth(self, points: ArrayLike) -> FloatArray:
        """Distance of (n, 3) points from the wall, positive inside the tube. [m]"""
        x = np.asarray(points, dtype=float)
        return np.asarray(self.radius - np.hypot(x[..., 0], x[..., 1]))

    def normal(self, points: ArrayLike) -> FloatArray:
        """Unit vectors (n, 3) from the wall into the bed at the wall points nearest to `points`."""
        return -_radial(points)

    def area(self, window: Window) -> float:
        """Wall area in the window. [m2]"""
        return 2.0 * math.pi * self.radius * window.length

    def layer_volume(self, inner: float, outer: float, window: Window) -> float:
        """Volume between the depths `inner` < `outer` over the window. [m3]"""
        near, far = max(self.radius - inner, 0.0), max(self.radius - outer, 0.0)
        return math.pi * (near - far) * (near + far) * window.length


@dataclass(frozen=True)
class Rod:
    """A convex wall: the outside of a circular rod around the z axis.

    Parameters
    ----------
    radius : float
        Outer radius. [m]

    Raises
    ------
    ValueError
        If the radius is not positive and finite.
    """

    radius: float
    kind: ClassVar[str] = "rod"
    axial: ClassVar[int] = 2
    periodic_axes: ClassVar[tuple[int, ...]] = (2,)

    def __post_init__(self) -> None:
        _check_radius("rod", self.radius)
        object.__setattr__(self, "radius", float(self.radius))

    @property
    def largest_depth(self) -> float:
        """No end to the depth outside a rod."""
        return math.inf

    def depth(self, points: ArrayLike) -> FloatArray:
        """Distance of (n, 3) points from the wall, positive outside the rod. [m]"""
        x = np.asarray(points, dtype=float)
        return np.asarray(np.hypot(x[..., 0], x[..., 1]) - self.radius)

    def normal(self, points: ArrayLike) -> FloatArray:
        """Unit vectors (n, 3) from the wall into the bed at the wall points nearest to `points`."""
        return _radial(points)

    def area(self, window: Window) -> float:
        """Wall area in the window. [m2]"""
        return 2.0 * math.pi * self.radius * window.length

    def layer_volume(self, inner: float, outer: float, window: Window) -> float:
        """Volume between the depths `inner` < `outer` over the window. [m3]"""
        near, far = self.radius + inner, self.radius + outer
        return math.pi * (far - near) * (far + near) * window.length


@dataclass(frozen=True)
class Plate:
    """A flat wall: the plane z = 0, with the bed at z > 0."""

    kind: ClassVar[str] = "plate"
    axial: ClassVar[int] = 0
    periodic_axes: ClassVar[tuple[int, ...]] = (0, 1)

    @property
    def largest_depth(self) -> float:
        """No end to the depth above a plate."""
        return math.inf

    def depth(self, points: ArrayLike) -> FloatArray:
        """Height of (n, 3) points above the plate. [m]"""
        return np.array(np.asarray(points, dtype=float)[..., 2])

    def normal(self, points: ArrayLike) -> FloatArray:
        """Unit vectors (n, 3) from the wall into the bed: +z everywhere."""
        normals = np.zeros_like(np.asarray(points, dtype=float))
        normals[..., 2] = 1.0
        return normals

    def area(self, window: Window) -> float:
        """Wall area in the window. [m2]"""
        if window.lateral is None:
            raise ValueError("the window of a plate needs a lateral range; it is None")
        return window.length * (window.lateral[1] - window.lateral[0])

    def layer_volume(self, inner: float, outer: float, window: Window) -> float:
        """Volume between the depths `inner` < `outer` over the window. [m3]"""
        return self.area(window) * (outer - inner)


Wall = Tube | Rod | Plate


def _radial(points: ArrayLike) -> FloatArray:
    """Unit vectors away from the z axis; +x for points on the axis, where every direction is as good."""
    x = np.asarray(points, dtype=float)
    distance = np.hypot(x[..., 0], x[..., 1])
    away = np.zeros_like(x)
    # also where so few digits are left that there is no direction
    on_axis = distance < np.finfo(float).tiny
    safe = np.where(on_axis, 1.0, distance)
    away[..., 0] = np.where(on_axis, 1.0, x[..., 0] / safe)
    away[..., 1] = np.where(on_axis, 0.0, x[..., 1] / safe)
    return away
