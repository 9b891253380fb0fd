"""Beds on which rays may go wrong: wide tubes, mixed sizes, far from the origin, a million spheres."""

from __future__ import annotations

import numpy as np

import bedrad
from bedrad.walls import Window


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
