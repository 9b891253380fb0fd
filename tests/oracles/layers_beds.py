"""Beds whose layers and contacts are known: ring packings, hexagonal layers, and a gas of spheres."""

from __future__ import annotations

import math

import numpy as np

import bedrad


def staggered_rings(count, convex=False):
    """Unit spheres in touching rings of `count`, each ring turned by half a sphere and touching the last.

    They line a tube, or surround a rod, which they all touch; two rings make a period.
    """
    on = 1.0 / math.sin(math.pi / count)
    wall = bedrad.Rod(on - 1.0) if convex else bedrad.Tube(on + 1.0)
    rise = math.sqrt(4.0 - (2.0 * on * math.sin(math.pi / (2 * count))) ** 2)
    angles = 2 * math.pi * np.arange(count) / count
    rings = [
        np.c_[on * np.cos(a), on * np.sin(a), np.full(count, height)]
        for a, height in ((angles, 0.0), (angles + math.pi / count, rise))
    ]
    return bedrad.Packing(np.vstack(rings), 1.0, wall, period=2 * rise, max_overlap=1e-9)


def hexagonal_sheet(across, along, gap=0.0):
    """Unit spheres in a touching hexagonal sheet over a plate, `across` by `along` cells a period."""
    cell = np.array([[0.0, 0.0, 1.0 + gap], [1.0, math.sqrt(3.0), 1.0 + gap]])
    period = (2.0 * across, 2.0 * math.sqrt(3.0) * along)
    shifts = [(2.0 * i, 2.0 * math.sqrt(3.0) * j, 0.0) for i in range(across) for j in range(along)]
    return bedrad.Packing(np.vstack([cell + s for s in shifts]), 1.0, bedrad.Plate(), period=period)


def free_gas(wall, seed, mean_count, length, touching=0.4, deepest=3.0):
    """Unit spheres that ignore each other: a Poisson number, a share of them touching the wall."""
    rng = np.random.default_rng(seed)
    n = rng.poisson(mean_count)
    depth = 1.0 + np.where(rng.random(n) < touching, 0.0, rng.uniform(0.02, deepest - 1.0, n))
    if wall.kind == "plate":
        centers = np.c_[rng.uniform(0, length[0], n), rng.uniform(0, length[1], n), depth]
    else:
        radial = wall.radius - depth if wall.kind == "tube" else wall.radius + depth
        angle = rng.uniform(0, 2 * np.pi, n)
        centers = np.c_[radial * np.cos(angle), radial * np.sin(angle), rng.uniform(0, length, n)]
    return bedrad.Packing(centers, 1.0, wall, period=length, max_overlap=2.0)
