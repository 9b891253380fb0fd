"""The loose column of spheres that a bed settles from: random, without overlaps, reproducible from a seed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

__all__ = ["Column", "count_spheres", "loose_column"]

FloatArray = NDArray[np.float64]
Sizes = Sequence[tuple[float, float]]

_SOLID_FRACTION = 0.3
"""Solid fraction of the column: random placing slows down towards 0.38, and a looser column falls longer."""

_SLOW = 0.002
"""Share of random places that must turn out free; below it the column is made taller."""


@dataclass(frozen=True)
class Column:
    """Spheres in a tube above the floor z = 0, none touching another or the wall.

    Parameters
    ----------
    centers : (n, 3) array
        Centres. [m]
    diameters : (n,) array
        Diameters. [m]
    height : float
        Height of the column. [m]
    """

    centers: FloatArray
    diameters: FloatArray
    height: float

    def data_file(self, density: float, margin: float, period: float | None = None) -> str:
        """Text of a LAMMPS data file (atom style sphere), its box a margin [m] around the column, or a period high."""
        reach = float(np.hypot(self.centers[:, 0], self.centers[:, 1]).max(initial=0.0)) + margin
        low, high = (-margin, self.height + margin) if period is None else (0.0, period)
        lines = [
            "loose column of spheres",
            "",
            f"{len(self.diameters)} atoms",
            "1 atom types",
            f"{-reach!r} {reach!r} xlo xhi",
            f"{-reach!r} {reach!r} ylo yhi",
            f"{low!r} {high!r} zlo zhi",
            "",
            "Atoms # sphere",
            "",
        ]
        rows = zip(self.diameters.tolist(), self.centers.tolist(), strict=True)
        lines += [f"{i} 1 {d!r} {density!r} {x!r} {y!r} {z!r}" for i, (d, (x, y, z)) in enumerate(rows, start=1)]
        return "\n".join(lines) + "\n"


def count_spheres(sizes: Sizes, volume: float) -> list[int]:
    """How many spheres of each size have at least this solid volume together.

    Parameters
    ----------
    sizes : sequence of (float, float)
        Diameter [m] and number fraction of each size; the fractions add up to one.
    volume : float
        Solid volume. [m3]

    Returns
    -------
    list of int
        Numbers; each is within one of its exact share, rounded by largest remainder.
    """
    mean = sum(fraction * math.pi / 6.0 * diameter**3 for diameter, fraction in sizes)
    total = max(1, math.ceil(volume / mean))
    exact = [fraction * total for _, fraction in sizes]
    counts = [math.floor(share) for share in exact]
    by_remainder = sorted(range(len(sizes)), key=lambda k: counts[k] - exact[k])
    for k in by_remainder[: total - sum(counts)]:
        counts[k] += 1
    return counts


def loose_column(radius: float, sizes: Sizes, counts: Sequence[int], rng: np.random.Generator) -> Column:
    """Place spheres one after the other at random where there is room, the largest first.

    Parameters
    ----------
    radius : float
        Tube radius. [m]
    sizes : sequence of (float, float)
        Diameter [m] and number fraction of each size.
    counts : sequence of int
        Number of spheres of each size.
    rng : numpy.random.Generator
        Source of the random places.

    Returns
    -------
    Column
        The spheres. Ids follow no order of height.
    """
    diameters = np.repeat([d for d, _ in sizes], counts)
    diameters = np.sort(diameters)[::-1].copy()
    solid = math.pi / 6.0 * float((diameters**3).sum())
    height = max(solid / (_SOLID_FRACTION * math.pi * radius**2), float(diameters[0]))
    centers = np.empty((0, 3))
    share = 0.5
    while len(centers) < len(diameters):
        placed = len(centers)
        # one size at a time, so that a round compares equal spheres with each other
        left = int((diameters[placed:] == diameters[placed]).sum())
        tries = _random_points(rng, math.ceil(left / share), radius, height, float(diameters[placed]))
        free = _free(tries, float(diameters[placed]), centers, diameters[:placed])
        centers = np.concatenate([centers, tries[free[:left]]])
        share = max(len(free) / len(tries), _SLOW)
        if share == _SLOW and len(tries) >= 1.0 / _SLOW:
            height *= 1.05
    return Column(centers, diameters, height)


def _random_points(rng: np.random.Generator, count: int, radius: float, height: float, diameter: float) -> FloatArray:
    """Points uniform in the part of the cylinder that centres of this diameter can take."""
    across, turn, up = rng.random((3, count))
    distance = (radius - diameter / 2.0) * np.sqrt(across)
    angle = 2.0 * math.pi * turn
    z = diameter / 2.0 + (height - diameter) * up
    return np.stack([distance * np.cos(angle), distance * np.sin(angle), z], axis=1)


def _free(tries: FloatArray, diameter: float, centers: FloatArray, diameters: FloatArray) -> NDArray[np.int64]:
    """Which places are free of the spheres already there and of the free places before them."""
    blocked = np.zeros(len(tries), dtype=bool)
    for size in np.unique(diameters):
        tree = cKDTree(centers[diameters == size])
        distance, _ = tree.query(tries, distance_upper_bound=(diameter + float(size)) / 2.0)
        blocked |= np.isfinite(distance)
    candidates = np.flatnonzero(~blocked)
    pairs = cKDTree(tries[candidates]).query_pairs(diameter, output_type="ndarray")
    taken = np.ones(len(candidates), dtype=bool)
    # pairs run from low to high and are sorted, so that the first of a pair is settled before the second
    for low, high in pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].tolist():
        if taken[low]:
            taken[high] = False
    return candidates[taken]
