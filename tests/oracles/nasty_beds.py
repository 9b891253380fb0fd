"""Beds on which rays may go wrong: wide tubes, mixed sizes, far from the origin, a million spheres."""

from __future__ import annotations

import numpy as np

import bedrad
from bedrad.walls import Window
from oracles.beds import random_bed
from oracles.layers_beds import free_gas

WALLS = {
    "tube": (bedrad.Tube(5.0), 6.0),
    "rod": (bedrad.Rod(2.0), 6.0),
    "plate": (bedrad.Plate(), (7.0, 6.0)),
}
"""Walls of each kind, and periods."""


def lined_sector(tube_radius, count, seed, half_width=5.0, length=10.0, deepest=4.0):
    """Unit spheres at random near both ends of a tube's diameter; its window, ends open.

    However wide the tube, `sector_points` starts rays there, and some cross to the other side.
    """
    rng = np.random.default_rng(seed)
    centers = np.empty((0, 3))
    angle = min(half_width / tube_radius, np.pi / 2)
    while len(centers) < count:
        radial = tube_radius - rng.uniform(1.0, min(deepest, tube_radius))
        a = rng.uniform(-angle, angle) + np.pi * rng.integers(0, 2)
        c = np.array([radial * np.cos(a), radial * np.sin(a), rng.uniform(1.0, length - 1.0)])
        if (np.linalg.norm(centers - c, axis=1) > 2.0).all():
            centers = np.vstack([centers, c])
    marks = [[0.0, 0.0, 1e-3], [0.0, 0.0, length - 1e-3]]
    bed = bedrad.Packing([*marks, *centers], [1e-3, 1e-3, *np.ones(count)], bedrad.Tube(tube_radius))
    return bed, Window((1.0, length - 1.0))


def sector_points(tube_radius, count, seed, half_width=5.0):
    """Points of the unit hypercube that start at the sector, half of them in a plane all but normal to the axis."""
    points = np.random.default_rng(seed).random((count, 4))
    share = min(half_width / tube_radius / np.pi, 1.0)
    points[:, 1] = (points[:, 1] - 0.5) * share % 1.0
    points[::2, 3] = 0.5 * np.round(points[::2, 3]) + (points[::2, 3] - 0.5) / (4.0 * tube_radius)
    points[:, 3] %= 1.0
    return points


def two_sizes(large, small, ratio, seed, period=(5.0, 5.0)):
    """Unit spheres over a periodic plate and, where there is room below, many that are `ratio` times smaller."""
    rng = np.random.default_rng(seed)
    centers, radii = np.empty((0, 3)), np.empty(0)
    box = np.array([*period, np.inf])
    for count, r, deepest in ((large, 1.0, 3.0), (small, 1.0 / ratio, 1.0)):
        left = count
        while left:
            c = np.array([*rng.uniform(0.0, period), rng.uniform(r, deepest)])
            apart = np.abs(centers - c)
            if (np.linalg.norm(np.minimum(apart, box - apart), axis=1) > radii + r).all():
                centers, radii, left = np.vstack([centers, c]), np.append(radii, r), left - 1
    return bedrad.Packing(centers, radii, bedrad.Plate(), period=period)


def jittered_lattice(across, along, high, seed=0, step=2.2):
    """Unit spheres over a periodic plate, each up to 0.1 off its place in a cubic lattice, none touching."""
    rng = np.random.default_rng(seed)
    places = np.stack(np.meshgrid(*(step * np.arange(n) for n in (across, along, high)), indexing="ij"), axis=-1)
    centers = places.reshape(-1, 3) + rng.uniform(-0.05, 0.05, (across * along * high, 3)) + 1.1
    return bedrad.Packing(centers, 1.0, bedrad.Plate(), period=(step * across, step * along))


def any_overlap(kind):
    """Spheres at random that overlap each other by anything, two in five of them a tenth of a diameter in the wall."""
    wall, period = WALLS[kind]
    gas = free_gas(wall, seed=3, mean_count=25, length=period, deepest=2.5)
    return bedrad.Packing(gas.centers, gas.radii / 0.8, wall, period, max_overlap=2.0)


def twice(bed):
    """Every sphere twice, on the same point."""
    return bedrad.Packing(np.tile(bed.centers, (2, 1)), np.tile(bed.radii, 2), bed.wall, bed.period, max_overlap=2.0)


def one_a_period(kind, period, many=1):
    """A unit sphere a period along the axis, written as `many` periods, and the window of one of them."""
    wall, center = {
        "tube": (bedrad.Tube(1.5), [0.3, 0.0, 0.01]),
        "rod": (bedrad.Rod(1.5), [2.6, 0.0, 0.01]),
        "plate": (bedrad.Plate(), [0.01, 0.3, 1.2]),
    }[kind]
    centers = np.tile(np.array(center), (many, 1))
    centers[:, wall.axial] += period * np.arange(many)
    periods = (many * period, 3.0) if kind == "plate" else many * period
    window = Window((0.0, period), (0.0, 3.0) if kind == "plate" else None)
    return bedrad.Packing(centers, 1.0, wall, periods, max_overlap=2.0), window


def micrometres(kind):
    """A bed of spheres of 1 um with open ends, its coordinates whole multiples of the spacing of numbers at 10 km."""
    wall, _ = WALLS[kind]
    bed = random_bed(wall, 60, seed=3, length=12.0, spread=3.5)
    spacing = np.spacing(1e4)
    scaled = wall if kind == "plate" else type(wall)(wall.radius * 1e-6)
    centers = np.round(bed.centers * 1e-6 / spacing) * spacing
    bed = bedrad.Packing(centers, bed.radii * 1e-6, scaled)
    low, high = np.round(2e-6 / spacing) * spacing, np.round(10e-6 / spacing) * spacing
    return bed, Window((low, high), (low, high) if kind == "plate" else None)


def moved(bed, window, offset):
    along = np.zeros(3)
    along[list(bed.wall.periodic_axes)] = offset
    lateral = None if window.lateral is None else (window.lateral[0] + offset, window.lateral[1] + offset)
    return (
        bedrad.Packing(bed.centers + along, bed.radii, bed.wall),
        Window((window.axial[0] + offset, window.axial[1] + offset), lateral),
    )
