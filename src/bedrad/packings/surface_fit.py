"""Cylinders and planes through points by least squares, with the standard errors that the residuals give them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.placing import turn_to_z

__all__ = ["Surface", "fit_cylinder", "fit_plane", "local"]

FloatArray = NDArray[np.float64]

_ROUNDS = 10
_STEPS = 10


@dataclass(frozen=True)
class Surface:
    """A cylinder or plane through points that may each stand off from it.

    Parameters
    ----------
    origin : (3,) array
        A point of the axis, or of the plane, amid the points. [m]
    direction : (3,) array
        Unit vector of the axis, or normal of the plane.
    radius : float or None
        Radius of the cylinder. [m]
    misses : (n,) array
        How far outside (or above) the points lie. [m]
    covariance : (m, m) array
        Of x, y and radius of the cylinder, or the height of the plane, in the coordinates of `local`; then of the two
        slopes against z there, where the direction was fitted. [m2, m, 1]
    """

    origin: FloatArray
    direction: FloatArray
    radius: float | None
    misses: FloatArray
    covariance: FloatArray

    @property
    def rms(self) -> float:
        """Root mean square of the misses. [m]"""
        return float(np.sqrt(np.mean(self.misses**2)))

    @property
    def origin_error(self) -> float:
        """Standard error of each coordinate of the axis across itself, or of the height of the plane. [m]"""
        count = 1 if self.radius is None else 2
        return float(np.sqrt(np.mean(np.diag(self.covariance)[:count])))

    @property
    def radius_error(self) -> float | None:
        """Standard error of the radius. [m]"""
        return None if self.radius is None else float(np.sqrt(self.covariance[2, 2]))

    @property
    def direction_error(self) -> float | None:
        """Standard error of each of the two tilts, None where the direction was given. [rad]"""
        fixed = 1 if self.radius is None else 3
        return None if len(self.covariance) == fixed else float(np.sqrt(np.mean(np.diag(self.covariance)[fixed:])))

    def tilt_sureness(self, direction: FloatArray) -> float:
        """Squared tilt from a direction over its covariance: of two degrees of freedom where there is no tilt."""
        tilt = (turn_to_z(self.direction) @ direction)[:2]
        return float(tilt @ np.linalg.solve(self.covariance[-2:, -2:], tilt))

    def miss(self, points: FloatArray, standoff: FloatArray) -> FloatArray:
        """How far outside (or above) the surface points lie, as in `fit_cylinder` and `fit_plane`. [m]"""
        p = local(points, self.origin, self.direction)
        if self.radius is None:
            return np.asarray(p[:, 2] + standoff)
        return np.asarray(np.hypot(p[:, 0], p[:, 1]) + standoff - self.radius)


def local(points: FloatArray, origin: FloatArray, direction: FloatArray) -> FloatArray:
    """Return (n, 3) points in coordinates about `origin` in which `direction` is z. [m]"""
    moved = points - origin
    turn = turn_to_z(direction)
    return moved if np.array_equal(turn, np.eye(3)) else np.asarray(moved @ turn.T)


def fit_cylinder(
    points: FloatArray, standoff: FloatArray, origin: FloatArray, direction: FloatArray, *, free: bool
) -> Surface:
    """Fit a cylinder: the distances from its axis, plus the stand-off of each point, are to be its radius.

    Parameters
    ----------
    points : (n, 3) array
        The points, more than there are unknowns. [m]
    standoff : (n,) array
        What is added to the distance: the radius of a sphere that touches from inside, its negative from outside. [m]
    origin, direction : (3,) arrays
        Where the search starts. [m, 1]
    free : bool
        Whether the direction is fitted too.

    Raises
    ------
    ValueError
        If the points do not say where the cylinder is.
    """
    for _ in range(_ROUNDS):
        p = local(points, origin, direction)
        middle = float(p[:, 2].mean())
        p[:, 2] -= middle
        values, covariance, misses = _circle(p, standoff, free)
        frame = turn_to_z(direction).T
        origin = origin + frame @ np.array([values[0], values[1], middle])
        if not free or float(np.abs(values[3:]).max()) < 1e-13:
            break
        direction = frame @ np.array([values[3], values[4], 1.0])
        direction = direction / np.linalg.norm(direction)
    return Surface(origin, direction, float(values[2]), misses, covariance)


def fit_plane(points: FloatArray, standoff: FloatArray, direction: FloatArray, *, free: bool) -> Surface:
    """Fit a plane: the heights above it, plus the stand-off of each point, are to be zero; as `fit_cylinder`."""
    origin = points.mean(axis=0)
    for _ in range(_ROUNDS):
        p = local(points, origin, direction)
        slopes = np.stack([np.ones(len(p)), *(p[:, :2].T if free else ())], axis=1)
        values, covariance, misses = _solved(slopes, p[:, 2] + standoff)
        frame = turn_to_z(direction).T
        origin = origin + frame @ np.array([0.0, 0.0, values[0]])
        if not free or float(np.abs(values[1:]).max()) < 1e-13:
            break
        direction = frame @ np.array([-values[1], -values[2], 1.0])
        direction = direction / np.linalg.norm(direction)
    return Surface(origin, direction, None, misses, covariance)


def _circle(p: FloatArray, standoff: FloatArray, free: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x, y, radius (and the slopes of the axis) that minimise the squared misses, by Gauss-Newton steps."""
    values = np.zeros(5 if free else 3)
    values[2] = float((np.hypot(p[:, 0], p[:, 1]) + standoff).mean())
    for _ in range(_STEPS):
        x, y, radius = values[:3]
        dx, dy = p[:, 0] - x, p[:, 1] - y
        if free:
            dx, dy = dx - values[3] * p[:, 2], dy - values[4] * p[:, 2]
        distance = np.hypot(dx, dy)
        # a point on the axis has no direction; it is an outermost one only where the tube is one sphere wide
        safe = np.where(distance > 0.0, distance, 1.0)
        slopes = [dx / safe, dy / safe, np.ones_like(safe)]
        if free:
            slopes += [dx / safe * p[:, 2], dy / safe * p[:, 2]]
        step, covariance, misses = _solved(np.stack(slopes, axis=1), distance + standoff - radius)
        values = values + step
        if float(np.abs(step[:3]).max()) < 1e-14 * abs(values[2]):
            break
    return values, covariance, misses


def _solved(slopes: FloatArray, misses: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Linear least squares: the step, its covariance from the residuals, and what is missed after it."""
    # columns of one length, so that metres and slopes do not make the problem look singular
    scale = np.linalg.norm(slopes, axis=0)
    if len(slopes) <= slopes.shape[1] or not (scale > 0.0).all():
        raise ValueError("the points are too few to say where the surface is")
    step, _, rank, _ = np.linalg.lstsq(slopes / scale, misses, rcond=1e-10)
    if rank < slopes.shape[1]:
        raise ValueError("the points do not say where the surface is")
    left = misses - slopes @ (step / scale)
    variance = float(left @ left) / (len(slopes) - slopes.shape[1])
    inverse = np.linalg.inv((slopes / scale).T @ (slopes / scale))
    return step / scale, variance * inverse / np.outer(scale, scale), left
