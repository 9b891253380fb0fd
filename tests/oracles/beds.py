"""Small beds for the ray-tracing tests."""

from __future__ import annotations

import numpy as np

import bedrad


def random_bed(wall, count, seed, length, spread, ratio=3.0, period=None):
    """Spheres of random size thrown one by one beside a wall where there is room; depths down to `spread`."""
    rng = np.random.default_rng(seed)
    centers, radii = [], []
    lengths = np.atleast_1d(period) if period is not None else np.array([])
    while len(radii) < count:
        r = rng.uniform(1.0, ratio) / ratio
        depth = rng.uniform(r, spread)
        if wall.kind == "plate":
            c = np.array([*rng.uniform(0, length, 2), depth])
            shifts = [np.zeros(3)] if period is None else [
                np.array([i * lengths[0], j * lengths[1], 0]) for i in (-1, 0, 1) for j in (-1, 0, 1)]  # fmt: skip
        else:
            radial = wall.radius - depth if wall.kind == "tube" else wall.radius + depth
            angle = rng.uniform(0, 2 * np.pi)
            c = np.array([radial * np.cos(angle), radial * np.sin(angle), rng.uniform(0, length)])
            shifts = [np.zeros(3)] if period is None else [np.array([0, 0, k * lengths[0]]) for k in (-1, 0, 1)]
        if all(np.linalg.norm(c - o - s) > r + q for o, q in zip(centers, radii, strict=True) for s in shifts):
            centers.append(c)
            radii.append(r)
    return bedrad.Packing(np.array(centers), np.array(radii), wall, period)


def hexagonal_layer(radius=1.0):
    """A touching hexagonal layer on a plate, one rectangular cell of it."""
    centers = [[0.0, 0.0, radius], [radius, np.sqrt(3) * radius, radius]]
    return bedrad.Packing(centers, radius, bedrad.Plate(), period=(2 * radius, 2 * np.sqrt(3) * radius))


def axial_chain(tube_radius, radius=1.0):
    """Touching spheres on the axis of an infinite tube, one of them a period."""
    return bedrad.Packing([[0.0, 0.0, 0.0]], radius, bedrad.Tube(tube_radius), period=2 * radius)
