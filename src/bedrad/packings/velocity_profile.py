"""The velocity of a flow across its tube: plug core, shear layer, and the Gaussian form fitted to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from bedrad.packings.flow_frames import Motion
from bedrad.packings.time_averages import block_averaged_variance

__all__ = ["GaussianFit", "VelocityProfile", "velocity_profile"]

FloatArray = NDArray[np.float64]

BINS_PER_DIAMETER = 2
"""Bins of the profile, from the wall inwards; one has a sphere of the mean size that touches the wall in its middle."""

CORE_SHARE = 0.5
"""The plug core's speed is the mean within this share of the tube's radius."""

SHEAR_END = 0.1
"""The shear layer ends where the speed is short of the core's by this share of what it is short of at the wall."""


@dataclass(frozen=True)
class GaussianFit:
    """``u = A exp(-((r - B)/Y)^2) + Z`` (Chilamkurti and Gould 2015), fitted to a profile by least squares.

    Parameters
    ----------
    amplitude, offset : float
        A and Z. [m/s]
    center, width : float
        B and Y. [m]
    residual : float
        Root mean square of what the fit misses, over the mean velocity; nan (with all others) where no fit was found.
    """

    amplitude: float
    center: float
    width: float
    offset: float
    residual: float


@dataclass(frozen=True, eq=False)
class VelocityProfile:
    """Mean speed downwards against the distance from the axis, over the sampling window.

    Parameters
    ----------
    radii : (bins + 1,) array
        Distances from the axis that bound the bins: half a diameter wide, but the outermost. That one ends at the
        wall, a quarter of a diameter away, and holds only spheres of a mixture that are small, or large ones that
        are pressed into the wall; the one before has those of the mean size that touch the wall in its middle. [m]
    speeds, speeds_error : (bins,) arrays
        Mean speed of the spheres with their centre in each bin, nan where there were none. [m/s]
    core, wall : float
        Speed of the plug core, and of the spheres whose centres are within 3/4 of a diameter of the wall; nan where
        there were none. [m/s]
    shear_width : float
        Distance from the wall at which nine tenths of the difference between the core and the outermost bin that
        holds spheres are made up; nan where the difference is less than its error. [m]
    gaussian : GaussianFit
        The Gaussian form.
    """

    radii: FloatArray
    speeds: FloatArray
    speeds_error: FloatArray
    core: float
    wall: float
    shear_width: float
    gaussian: GaussianFit


def velocity_profile(
    motions: Sequence[Motion], window: tuple[float, float], tube_radius: float, diameter: float
) -> VelocityProfile:
    """Measure the velocity profile.

    Parameters
    ----------
    motions : sequence of Motion
        What moved between the frames.
    window : (float, float)
        Heights between which spheres count. [m]
    tube_radius, diameter : float
        Radius of the tube and mean diameter of the spheres. [m]
    """
    edges = _edges(tube_radius, diameter)
    counts = np.empty((len(motions), len(edges) - 1))
    sums = np.empty_like(counts)
    distances = np.zeros(len(edges) - 1)
    inner_count = inner_sum = 0.0
    for k, motion in enumerate(motions):
        inside = (motion.places[:, 2] >= window[0]) & (motion.places[:, 2] < window[1])
        out = np.hypot(motion.places[inside, 0], motion.places[inside, 1])
        speeds = motion.speeds[inside]
        counts[k] = np.histogram(out, edges)[0]
        sums[k] = np.histogram(out, edges, weights=speeds)[0]
        distances += np.histogram(out, edges, weights=out)[0]
        core = out < CORE_SHARE * tube_radius
        inner_count, inner_sum = inner_count + core.sum(), inner_sum + speeds[core].sum()
    total = counts.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        means, radii = sums.sum(axis=0) / total, distances / total
        # what a bin's sum is beyond its mean, linear in both sums, so that an empty bin in one frame does no harm
        deviations = np.where(total > 0, (sums - means * counts) / counts.mean(axis=0), 0.0)
    errors = np.sqrt(block_averaged_variance(deviations)) if len(motions) > 1 else np.full(len(means), math.nan)
    errors[total == 0] = math.nan
    core = float(inner_sum / inner_count) if inner_count else math.nan
    known = np.flatnonzero(total > 0)
    wall = float(sums[:, -2:].sum() / total[-2:].sum()) if total[-2:].any() else math.nan
    return VelocityProfile(
        edges, means, errors, core, wall,
        # spheres stand in layers near the wall: a bin's speed is that at their mean place, not at its middle
        _shear_width(radii[known], means[known], errors[known], core, tube_radius),
        _gaussian(radii[known], means[known], total[known], tube_radius),
    )  # fmt: skip


def _edges(tube_radius: float, diameter: float) -> FloatArray:
    """Bounds of the bins from the axis to the wall, (bins + 1,)."""
    width = diameter / BINS_PER_DIAMETER
    # no bound lies where a sphere of the mean size has its centre when it touches the wall
    outermost = tube_radius - 0.5 * width
    inwards = outermost - width * np.arange(math.ceil(outermost / width - 1e-9) + 1)
    return np.array([*np.flip(np.maximum(inwards, 0.0)), tube_radius])


def _shear_width(radii: FloatArray, speeds: FloatArray, errors: FloatArray, core: float, tube_radius: float) -> float:
    """Distance from the wall at which the speed is short of the core's by a tenth of what it is short of there."""
    if len(radii) < 2 or not core - speeds[-1] > errors[-1]:
        return math.nan
    short = (core - speeds) / (core - speeds[-1]) - SHEAR_END
    # from the wall inwards: the first bin that is no longer short
    inner = int(np.flatnonzero(short <= 0.0)[-1]) if (short <= 0.0).any() else 0
    if short[inner] > 0.0 or inner + 1 >= len(radii):
        return math.nan
    share = short[inner] / (short[inner] - short[inner + 1])
    return float(tube_radius - (radii[inner] + share * (radii[inner + 1] - radii[inner])))


def _gaussian(radii: FloatArray, speeds: FloatArray, counts: FloatArray, tube_radius: float) -> GaussianFit:
    nothing = GaussianFit(*[math.nan] * 5)
    mean = float((speeds * counts).sum() / counts.sum()) if len(radii) else 0.0
    if len(radii) < 5 or not mean:
        return nothing

    def form(r: FloatArray, a: float, b: float, y: float, z: float) -> FloatArray:
        return np.asarray(a * np.exp(-(((r - b) / y) ** 2)) + z)

    x, u = radii / tube_radius, speeds / mean
    change = float(u[0] - u[-1]) or 1e-3
    # a hump about the axis, or a plug that is short of its speed in a layer at the wall
    starts = ((change, 0.0, 0.7, float(u[-1])), (-change, 1.0, 0.1, float(u[0])))
    fits = [fit for start in starts if (fit := _least_squares(form, x, u, start, counts)) is not None]
    if not fits:
        return nothing
    a, b, y, z = min(fits, key=lambda fit: float((counts * (u - form(x, *fit)) ** 2).sum()))
    missed = u - form(x, a, b, y, z)
    residual = math.sqrt(float((counts * missed * missed).sum() / counts.sum()))
    return GaussianFit(float(a * mean), float(b * tube_radius), float(y * tube_radius), float(z * mean), residual)


def _least_squares(
    form: Callable[..., FloatArray],
    x: FloatArray,
    u: FloatArray,
    start: tuple[float, ...],
    counts: FloatArray,
) -> tuple[float, ...] | None:
    """The form's parameters from one start; None where they are not found."""
    # a width beyond the tube's diameter would only trade amplitude against offset
    limits = ((-np.inf, -0.5, 1e-3, -np.inf), (np.inf, 1.5, 2.0, np.inf))
    try:
        found, _ = curve_fit(form, x, u, start, 1.0 / np.sqrt(counts), bounds=limits, max_nfev=2000)
    except RuntimeError:
        return None
    return tuple(found.tolist())
