"""Kernels that find the spheres near a patch of wall.

A patch is a small rectangle of the wall. Its frame has its origin on the wall at the middle of the patch, x along the
normal into the bed, y around (or across) and z along the wall's axis. A sphere's distance to the patch is that of its
surface to the box that just holds the patch; no ray from the patch can meet a sphere nearer than that.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from bedrad.raytrace.kernels import OPTIONS, PLATE, TUBE

__all__ = ["BRANCH_FREE", "LEAN", "Bins", "Patch", "gather", "localise", "make_patch", "select"]

LEAN = OPTIONS | {"_nrt": False}
BRANCH_FREE = LEAN | {"fastmath": {"contract", "nnan", "nsz"}}
"""How loops without branches are compiled: no number is nan, the sign of zero does not matter, so that the compiler may
take several rays or spheres at a time; the order of sums stays."""


class Bins(NamedTuple):
    """Spheres in bins of the wall's surface, by the position of their centres, larger and smaller ones apart.

    Parameters
    ----------
    classes : (classes, 5) array
        Largest radius; lower end and bin size along the axis; lower end and bin size around [rad] or across.
    shapes : (classes, 3) int array
        Number of bins along the axis and around, and number of the first bin in `starts`.
    starts : (bins + 1,) int array
        Where the spheres of each bin begin, bins along the axis in a row.
    spheres : (4, n) array
        Centres and radii, bin by bin.
    periods : (2,) array
        Period along the axis and across, 0 where open.
    depth : float
        Spheres farther than this from the whole wall, and not out of reach of all rays, are not in the bins.
    """

    classes: NDArray[np.float64]
    shapes: NDArray[np.int64]
    starts: NDArray[np.int64]
    spheres: NDArray[np.float64]
    periods: NDArray[np.float64]
    depth: float


class Patch(NamedTuple):
    """A rectangle of the wall: middle (along, around or across), cosine and sine of its angle, and its box.

    The box reaches from `low` to `high` along the normal, and half its size to either side along y and z.
    """

    along: float
    around: float
    cosine: float
    sine: float
    low: float
    high: float
    half_y: float
    half_z: float


@njit(**LEAN)
def make_patch(along, around, length, width, kind, wall_radius):
    """A patch around a point of the wall; `around` and `width` are angles beside a tube or rod."""
    if kind == PLATE:
        return Patch(along, around, 1.0, 0.0, 0.0, 0.0, 0.5 * width, 0.5 * length)
    half = min(0.5 * width, math.pi)
    sag = 2.0 * wall_radius * math.sin(0.5 * half) ** 2
    half_y = wall_radius * math.sin(half) if half < 0.5 * math.pi else wall_radius
    low, high = (0.0, sag) if kind == TUBE else (-sag, 0.0)
    return Patch(along, around, math.cos(around), math.sin(around), low, high, half_y, 0.5 * length)


@njit(**BRANCH_FREE)
def localise(spheres, first, count, shift_along, shift_across, patch, kind, wall_radius, local, at):
    """Centres in the frame of a patch, radii and distances to the patch, of a run of spheres.

    Parameters
    ----------
    spheres : (4, n) array
        Centres and radii.
    first, count : int
        The run of spheres.
    shift_along, shift_across : float
        Added to the centres (images across periodic faces).
    patch : Patch
        The patch.
    kind, wall_radius : int, float
        The wall.
    local : (5, m) array
        Filled with x, y, z, radius, distance.
    at : int
        Where to begin in `local`.
    """
    if kind == PLATE:
        along, across = patch.along - shift_along, patch.around - shift_across
        for i in range(count):
            local[0, at + i] = spheres[2, first + i]
            local[1, at + i] = spheres[1, first + i] - across
            local[2, at + i] = spheres[0, first + i] - along
    else:
        along = patch.along - shift_along
        inward = -1.0 if kind == TUBE else 1.0
        for i in range(count):
            x, y = spheres[0, first + i], spheres[1, first + i]
            local[0, at + i] = inward * (x * patch.cosine + y * patch.sine - wall_radius)
            local[1, at + i] = y * patch.cosine - x * patch.sine
            local[2, at + i] = spheres[2, first + i] - along
    low, high, half_y, half_z = patch.low, patch.high, patch.half_y, patch.half_z
    for i in range(count):
        x = max(max(local[0, at + i] - high, low - local[0, at + i]), 0.0)
        y, z = max(abs(local[1, at + i]) - half_y, 0.0), max(abs(local[2, at + i]) - half_z, 0.0)
        local[3, at + i] = spheres[3, first + i]
        local[4, at + i] = math.sqrt(x * x + y * y + z * z) - spheres[3, first + i]


@njit(**LEAN)
def select(local, count, lower, upper, candidates, at):
    """Append the spheres whose distance is in [lower, upper): x, y, z and squared radius.

    Returns
    -------
    int
        Number of candidates now, or -1 if there might not be room for all.
    """
    if at + count > candidates.shape[1]:
        return -1
    for i in range(count):
        candidates[0, at] = local[0, i]
        candidates[1, at] = local[1, i]
        candidates[2, at] = local[2, i]
        candidates[3, at] = local[3, i] * local[3, i]
        at += (local[4, i] >= lower) & (local[4, i] < upper)
    return at


@njit(**LEAN)
def gather(bins, patch, lower, upper, kind, wall_radius, local, found, at):
    """Append the spheres of the bed, images included, whose distance to a patch is in [lower, upper).

    Parameters
    ----------
    bins : Bins
        The spheres.
    patch : Patch
        The patch.
    lower, upper : float
        Range of the distance.
    kind, wall_radius : int, float
        The wall.
    local : (5, m) array
        Room to work in.
    found : (4, k) array
        Filled from number `at` on with centres (not in the frame of the patch) and radii.
    at : int
        Number of spheres found before.

    Returns
    -------
    int
        Number of spheres found now, or -1 if there is no room for all.
    """
    axis, lateral = (0, 1) if kind == PLATE else (2, 0)
    for c in range(bins.classes.shape[0]):
        largest, z_low, z_size, y_low, y_size = bins.classes[c]
        nz, ny, base = bins.shapes[c]
        z_reach, y_reach = _spans(patch, upper + largest, kind, wall_radius)
        z_first, z_last = _bin_range(patch.along, z_reach, z_low, z_size, nz, bins.periods[0] == 0.0)
        y_first, y_last = _bin_range(patch.around, y_reach, y_low, y_size, ny, kind == PLATE and bins.periods[1] == 0.0)
        if kind != PLATE and y_last - y_first >= ny - 1:
            y_first, y_last = 0, ny - 1
        for iy in range(y_first, y_last + 1):
            y_turns = iy // ny
            across = y_turns * bins.periods[1] if kind == PLATE else 0.0
            row = base + (iy - y_turns * ny) * nz
            iz = z_first
            while iz <= z_last:
                z_turns = iz // nz
                end = min(z_last, z_turns * nz + nz - 1)
                along = z_turns * bins.periods[0]
                first, last = bins.starts[row + iz - z_turns * nz], bins.starts[row + end - z_turns * nz + 1]
                iz = end + 1
                while first < last:
                    count = min(last - first, local.shape[1])
                    if at + count > found.shape[1]:
                        return -1
                    localise(bins.spheres, first, count, along, across, patch, kind, wall_radius, local, 0)
                    for i in range(count):
                        for k in range(4):
                            found[k, at] = bins.spheres[k, first + i]
                        found[axis, at] += along
                        found[lateral, at] += across
                        at += (local[4, i] >= lower) & (local[4, i] < upper)
                    first += count
    return at


@njit(inline="always", **LEAN)
def _spans(patch, reach, kind, wall_radius):
    """How far along and around the wall a sphere's centre may lie that is `reach` from the patch's box."""
    if kind == PLATE:
        return reach + patch.half_z, reach + patch.half_y
    away = reach + math.sqrt(patch.half_y**2 + patch.half_z**2 + (patch.high - patch.low) ** 2)
    # a ball that does not hold the axis is seen from there within asin(its radius / its distance)
    return reach + patch.half_z, math.asin(away / wall_radius) if away < wall_radius else 2.0 * math.pi


@njit(inline="always", **LEAN)
def _bin_range(middle, reach, low, size, count, open_ended):
    """First and last bin that a stretch touches; beyond the ends where the bins repeat."""
    first = math.floor((middle - reach - low) / size)
    last = math.floor((middle + reach - low) / size)
    if open_ended:
        return max(first, 0), min(last, count - 1)
    return first, last
