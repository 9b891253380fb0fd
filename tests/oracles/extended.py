"""Where rays end, by brute force in extended precision (80 bits on x86: 19 digits), and how close each call was."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numba import njit

from bedrad.raytrace.kernels import PLATE, ROD, TUBE, sphere_distances, start_ray
from oracles.rays import fates

SIEVE = 0.01
"""Rays that pass a sphere farther off than this share of its radius, by float64, need no more digits."""

BATCH = 64


@dataclass(frozen=True)
class Ends:
    """Ends of n rays.

    `fates` as bedrad counts them, `spheres` the first sphere met (-1: none), `margins` the smallest shift of a sphere
    or of a layer's edge that would have changed the outcome [m].
    """

    fates: np.ndarray
    spheres: np.ndarray
    margins: np.ndarray


def rays_of(bed, window, points):
    """Origins and directions (n, 3) of bedrad's rays for points of the unit hypercube."""
    kind = {"tube": TUBE, "rod": ROD, "plate": PLATE}[bed.wall.kind]
    lateral = window.lateral or (0.0, 0.0)
    place = (window.axial[0], window.axial[1] - window.axial[0], lateral[0], lateral[1] - lateral[0])
    rays = np.array([start_ray(*u, kind, getattr(bed.wall, "radius", 0.0), *place) for u in points])
    return rays[:, :3], rays[:, 3:6]


def ends(bed, edges, window, points):
    """Every ray against every sphere and as many of its images as the rays can reach."""
    origins, directions = (x.astype(np.longdouble) for x in rays_of(bed, window, points))
    directions /= np.sqrt((directions**2).sum(axis=1))[:, None]
    shifts = _shifts(bed, origins, directions, edges[-1])
    centers = (bed.centers[:, None] + shifts).reshape(-1, 3)
    radii = np.repeat(bed.radii, len(shifts))
    ray, sphere = _near(origins, directions, centers, radii)
    v = centers[sphere].astype(np.longdouble) - origins[ray]
    r = radii[sphere].astype(np.longdouble)
    along = (v * directions[ray]).sum(axis=1)
    miss = np.sqrt(((v - along[:, None] * directions[ray]) ** 2).sum(axis=1))
    half = np.sqrt(np.maximum(r * r - miss * miss, 0.0))
    t = np.where((miss < r) & (along + half > 0.0), np.maximum(along - half, 0.0), np.inf)
    best = np.full(len(origins), np.inf, np.longdouble)
    np.minimum.at(best, ray, t)
    whose = np.full(len(origins), -1)
    first = (t == best[ray]) & np.isfinite(t)
    whose[ray[first]] = sphere[first] // len(shifts)
    axes = (0, 1) if bed.wall.kind == "plate" else (2,)
    open_ends = {axis: bed.extent(axis) for axis in axes if not bed.box[axis]}
    margins = np.full(len(origins), np.inf)
    reached = (along - r < best[ray]) & (along + r > 0.0)
    np.minimum.at(margins, ray[reached], np.abs(miss - r)[reached].astype(float))
    met = np.isfinite(best)
    depth = bed.wall.depth((origins[met] + best[met, None] * directions[met]).astype(float))
    margins[met] = np.minimum(margins[met], np.abs(depth[:, None] - edges[1:]).min(axis=1))
    return Ends(fates(bed.wall, origins, directions, best, edges, open_ends), whose, margins)


def _shifts(bed, origins, directions, deepest):
    """Translations to all the periods that some ray enters before its end."""
    flat = (directions[:, :2] ** 2).sum(axis=1)
    if bed.wall.kind == "tube":
        far = -2.0 * (origins[:, :2] * directions[:, :2]).sum(axis=1) / flat
    elif bed.wall.kind == "rod":
        far = (2.0 * bed.wall.radius + deepest) / np.sqrt(flat)
    else:
        far = deepest / directions[:, 2]
    spans = []
    for axis, period in enumerate(bed.box):
        count = 1 + int(np.ceil(np.abs(far * directions[:, axis]).max() / period)) if period else 0
        if count > 200:
            raise ValueError(f"the rays enter {count} periods along {'xyz'[axis]}; choose steeper ones")
        spans.append(np.arange(-count, count + 1) * period)
    return np.array(list(itertools.product(*spans)))


def _near(origins, directions, centers, radii):
    """Pairs (ray, sphere) that need all digits."""
    wide = radii * (1.0 + SIEVE)
    rays, spheres = [], []
    for start in range(0, len(origins), BATCH):
        o, d = (x[start : start + BATCH].astype(float) for x in (origins, directions))
        x, y, z = (centers[:, k] - o[:, k, None] for k in range(3))
        along = x * d[:, 0, None] + y * d[:, 1, None] + z * d[:, 2, None]
        square = sum((w - along * d[:, k, None]) ** 2 for k, w in enumerate((x, y, z)))
        i, j = np.nonzero((square < wide**2) & (along > -wide))
        rays.append(i + start)
        spheres.append(j)
    return np.concatenate(rays), np.concatenate(spheres)


@njit
def _first(origins, directions, columns, room, first):
    for k in range(len(origins)):
        o, d = origins[k], directions[k]
        sphere_distances(o[0], o[1], o[2], d[0], d[1], d[2], columns, 0, columns.shape[1], room)
        best = np.argmin(room)
        first[k] = best if room[best] < np.inf else -1


def first_spheres(bed, window, points, precision):
    """Sphere that each ray meets first (-1: none), by bedrad's kernel with all numbers in one precision; no periods."""
    origins, directions = (x.astype(precision) for x in rays_of(bed, window, points))
    columns = np.ascontiguousarray(np.column_stack([bed.centers, bed.radii]).T.astype(precision))
    columns[3] **= 2
    first = np.empty(len(points), np.int64)
    _first(origins, directions, columns, np.empty(len(bed), precision), first)
    return first
