"""The beds that the benchmarks trace, the same in every run, at most some 10 s of work each."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import KDTree

import bedrad
from bedrad.walls import Plate, Tube

__all__ = ["BEDS", "demo_bed", "large_bed", "layer_bed", "mixed_bed", "repeated", "wide_bed"]

FloatArray = NDArray[np.float64]

RADIUS = 300e-6
DENSITY = 0.55
"""Volume share of spheres of equal size, that of a loose random packing."""

ROUNDS, SWEEPS = 20, 16
"""Searches for neighbours, and times after each that overlapping spheres are pushed apart."""

DEEPEST = 0.03
"""Overlap beyond which one of two spheres is left out, in radii."""

NEAR = 0.3
"""Widest gap between neighbours, in radii."""

PULL = 0.01
"""How far all are pulled to the wall in each of the first half of the sweeps, in radii."""

OCTAVES = 6
"""Size classes of a bed of mixed radii, from the largest down."""

MIXED_DENSITY = 0.70
"""Volume share of spheres of mixed sizes, those included for which there is no place after so many tries."""

MOST_TRIES = 3000


def demo_bed(path: str | None = None) -> bedrad.Packing:
    """A settled bed in a tube of R/r = 12.9, read from `path`.

    Without a path a bed like the demo's is settled and kept in results/, which needs the extra dem.
    """
    if path is not None:
        return bedrad.read(path)
    kept = Path("results/benchmark_bed.h5")
    if not kept.exists():
        kept.parent.mkdir(exist_ok=True)
        bedrad.write(bedrad.settle(bedrad.Tube(3.875e-3), 600e-6, 18e-3, seed=1), kept)
    return bedrad.read(kept)


def large_bed() -> bedrad.Packing:
    """About 100,000 spheres in a tube of R/r = 50."""
    return random_bed(Tube(50.0), 100_000, 50.0)


def wide_bed() -> bedrad.Packing:
    """A tube of R/r = 1,000, lined 10 radii deep with about 100,000 spheres, and hollow inside."""
    return random_bed(Tube(1000.0), 100_000, 10.0)


def mixed_bed() -> bedrad.Packing:
    """Radii 1:50 in a tube of eight of the largest, every octave with the same cross-section, larger spheres first."""
    rng = np.random.default_rng(1)
    wall, length, largest = 400.0, 300.0, 50.0
    radii = []
    volume = 0.0
    while volume < MIXED_DENSITY * math.pi * wall**2 * length:
        # numbers fall with the cube of the radius
        some = (1.0 - rng.random(1000) * (1.0 - largest**-2)) ** -0.5
        radii.append(some)
        volume += 4.0 / 3.0 * math.pi * float((some**3).sum())
    sizes = np.sort(np.concatenate(radii))[::-1].copy()
    centers = np.empty((len(sizes), 3))
    limits = largest / 2.0 ** np.arange(OCTAVES)
    placed = fill_gaps(sizes, wall, length, limits, MOST_TRIES, rng, centers)
    return bedrad.Packing(centers[placed] * RADIUS, sizes[placed] * RADIUS, Tube(wall * RADIUS), length * RADIUS)


def layer_bed(count: int) -> bedrad.Packing:
    """A square piece of plate under 12 radii of spheres, periodic."""
    return random_bed(Plate(), count, 12.0)


BEDS = {"demo": demo_bed, "large": large_bed, "wide": wide_bed, "mixed": mixed_bed}
"""Names of the beds that engines are compared on."""


def repeated(packing: bedrad.Packing, times: int) -> bedrad.Packing:
    """Write a periodic bed as so many of its periods along every periodic axis."""
    centers, period = packing.centers, []
    for axis in packing.wall.periodic_axes:
        steps = np.zeros((times, 1, 3))
        steps[:, 0, axis] = np.arange(times) * packing.box[axis]
        centers = (centers[None] + steps).reshape(-1, 3)
        period.append(times * packing.box[axis])
    radii = np.tile(packing.radii, len(centers) // len(packing))
    return bedrad.Packing(centers, radii, packing.wall, tuple(period) if len(period) > 1 else period[0])


def random_bed(wall: Tube | Plate, count: int, depth: float, seed: int = 1) -> bedrad.Packing:
    """Spheres of one size thrown in at random and pushed apart; sizes in sphere radii.

    Parameters
    ----------
    wall : Tube or Plate
        The wall.
    count : int
        Number of spheres.
    depth : float
        Depth of the bed.
    seed : int
        Seed of the places where they start.
    """
    rng = np.random.default_rng(seed)
    volume = 4.0 / 3.0 * math.pi * count / DENSITY
    if isinstance(wall, Tube):
        radius, inner = wall.radius, wall.radius - depth
        length = volume / (math.pi * (radius**2 - inner**2))
        box = np.array([0.0, 0.0, length])
        radial = np.sqrt(rng.uniform((inner + (inner > 0.0)) ** 2, (radius - 1.0) ** 2, count))
        angle = rng.uniform(0.0, 2.0 * math.pi, count)
        centers = np.column_stack([radial * np.cos(angle), radial * np.sin(angle), rng.uniform(0.0, length, count)])
    else:
        radius, length = 0.0, math.sqrt(volume / depth)
        box = np.array([length, length, 0.0])
        centers = rng.uniform((0.0, 0.0, 1.0), (length, length, depth - 1.0), (count, 3))
    for k in range(ROUNDS):
        centers = _wrapped(centers, box)
        pairs = KDTree(centers, boxsize=box).query_pairs(2.0 + NEAR, output_type="ndarray")
        push_apart(centers, pairs, radius, depth, box, PULL if 2 * k < ROUNDS else 0.0, SWEEPS)
    centers = _without_overlaps(centers, box)
    period = length * RADIUS
    if isinstance(wall, Tube):
        return bedrad.Packing(centers * RADIUS, RADIUS, Tube(radius * RADIUS), period)
    return bedrad.Packing(centers * RADIUS, RADIUS, wall, (period, period))


def _wrapped(centers: FloatArray, box: FloatArray) -> FloatArray:
    """Bring the centres back into the box along its periodic axes."""
    return np.where(box > 0.0, np.mod(centers, np.where(box > 0.0, box, 1.0)), centers)


def _without_overlaps(centers: FloatArray, box: FloatArray) -> FloatArray:
    """Leave out one of each two spheres that were not pushed apart, a few in 1,000."""
    wrapped = _wrapped(centers, box)
    pairs = KDTree(wrapped, boxsize=box).query_pairs(2.0 - DEEPEST, output_type="ndarray")
    return np.delete(wrapped, np.unique(pairs[:, 1]), axis=0)


@njit
def push_apart(centers, pairs, wall_radius, depth, box, pull, sweeps):
    """Move overlapping spheres of radius one apart, pair by pair, and back between the wall and the bed's depth.

    Parameters
    ----------
    centers : (n, 3) array
        Changed.
    pairs : (m, 2) int array
        Spheres that may overlap.
    wall_radius : float
        Radius of the tube, 0 for a plate.
    depth : float
        Depth of the bed.
    box : (3,) array
        Period of each axis, 0 where there is none.
    pull : float
        How far all are pulled to the wall in each sweep.
    sweeps : int
        Sweeps over all spheres.
    """
    for _ in range(sweeps):
        for i, j in pairs:
            _push_pair(centers[i], centers[j], box)
        for c in centers:
            if wall_radius > 0.0:
                radial = math.sqrt(c[0] * c[0] + c[1] * c[1])
                wanted = min(max(radial + pull, wall_radius - depth + 1.0), wall_radius - 1.0)
                if radial > 0.0:
                    c[0] *= wanted / radial
                    c[1] *= wanted / radial
            else:
                c[2] = min(max(c[2] - pull, 1.0), depth - 1.0)


@njit(inline="always")
def _push_pair(p, q, box):
    """Push two spheres apart, a little further than until they touch, if they overlap."""
    square = 0.0
    step = np.empty(3)
    for k in range(3):
        step[k] = q[k] - p[k]
        if box[k] > 0.0:
            step[k] -= box[k] * math.floor(step[k] / box[k] + 0.5)
        square += step[k] * step[k]
    if 0.0 < square < 2.005**2:
        push = 0.5 * (2.005 / math.sqrt(square) - 1.0)
        for k in range(3):
            p[k] -= push * step[k]
            q[k] += push * step[k]


@njit
def fill_gaps(radii, wall_radius, length, limits, most_tries, rng, centers):
    """Place spheres in a tube, in the order given, each at the first place tried that is free.

    Parameters
    ----------
    radii : (n,) array
        Radii, descending.
    wall_radius, length : float
        The tube, periodic.
    limits : (classes,) array
        Largest radius of each size class, descending.
    most_tries : int
        Places tried for a sphere before it is left out.
    rng : numpy.random.Generator
        Where places come from.
    centers : (n, 3) array
        Filled.

    Returns
    -------
    (n,) bool array
        Which spheres were placed.
    """
    classes = len(limits)
    cells = np.empty((classes, 2), np.int64)
    base = np.zeros(classes + 1, np.int64)
    for k in range(classes):
        cells[k, 0] = max(1, int(wall_radius / limits[k]))
        cells[k, 1] = max(1, int(0.5 * length / limits[k]))
        base[k + 1] = base[k] + cells[k, 0] ** 2 * cells[k, 1]
    heads = np.full(base[classes], -1)
    following = np.full(len(radii), -1)
    placed = np.zeros(len(radii), np.bool_)
    own = 0
    for i in range(len(radii)):
        while own + 1 < classes and radii[i] <= limits[own + 1]:
            own += 1
        room = wall_radius - radii[i]
        for _ in range(most_tries):
            x, y = rng.uniform(-room, room), rng.uniform(-room, room)
            z = rng.uniform(0.0, length)
            if x * x + y * y > room * room:
                continue
            if _is_free(x, y, z, radii[i], centers, radii, limits, cells, base, heads, following, wall_radius, length):
                centers[i, 0], centers[i, 1], centers[i, 2] = x, y, z
                placed[i] = True
                n, m = cells[own]
                a = min(int((x + wall_radius) / (2.0 * wall_radius) * n), n - 1)
                b = min(int((y + wall_radius) / (2.0 * wall_radius) * n), n - 1)
                cell = base[own] + (a * n + b) * m + min(int(z / length * m), m - 1)
                following[i] = heads[cell]
                heads[cell] = i
                break
    return placed


@njit
def _is_free(x, y, z, radius, centers, radii, limits, cells, base, heads, following, wall_radius, length):
    """Whether a sphere would overlap none of those placed."""
    for k in range(len(limits)):
        n, m = cells[k]
        reach = radius + limits[k]
        across, along = 2.0 * wall_radius / n, length / m
        a0, a1 = max(int((x - reach + wall_radius) / across), 0), min(int((x + reach + wall_radius) / across), n - 1)
        b0, b1 = max(int((y - reach + wall_radius) / across), 0), min(int((y + reach + wall_radius) / across), n - 1)
        c0, c1 = math.floor((z - reach) / along), math.floor((z + reach) / along)
        if c1 - c0 >= m:
            c0, c1 = 0, m - 1
        for a in range(a0, a1 + 1):
            for b in range(b0, b1 + 1):
                for c in range(c0, c1 + 1):
                    j = heads[base[k] + (a * n + b) * m + c % m]
                    while j >= 0:
                        dx, dy, dz = centers[j, 0] - x, centers[j, 1] - y, centers[j, 2] - z
                        dz -= length * math.floor(dz / length + 0.5)
                        if dx * dx + dy * dy + dz * dz < (radius + radii[j]) ** 2:
                            return False
                        j = following[j]
    return True
