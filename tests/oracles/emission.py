"""Radiation from spheres: cosine rays from their surfaces, followed by `first_hit`; which sphere each of them meets."""

from __future__ import annotations

import itertools

import numpy as np
from numba import njit
from scipy.spatial import cKDTree

from bedrad.raytrace.kernels import ESCAPED, first_hit

LIFT = 1e-9
"""Rays start this far above their sphere, in its radii: on its surface rounding would let half of them end at once.

Of a touching neighbour's share that takes less than 1e-8: what starts within sqrt(2 LIFT) radii of the contact.
"""


def surface_rays(rng, center, radius, count):
    """Origins just above a sphere and directions by the cosine law: normal plus a random point of the unit sphere."""
    normals, others = (_unit(rng.normal(size=(count, 3))) for _ in range(2))
    return center + radius * (1.0 + LIFT) * normals, _unit(normals + others)


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


@njit
def _follow(origins, directions, limits, low, size, cells, period, starts, columns, room, found):
    for k in range(len(origins)):
        o, d = origins[k], directions[k]
        found[k] = first_hit(
            o[0], o[1], o[2], d[0], d[1], d[2], limits[k], low, size, cells, period, starts, columns, room
        )


def distances(grid, origins, directions, limits=np.inf):
    """Distance of every ray to the first sphere by bedrad's kernel; infinite or `ESCAPED` where there is none."""
    *axes, starts, columns = grid
    found = np.empty(len(origins))
    room = np.empty(int(np.diff(starts).max()))
    _follow(origins, directions, np.broadcast_to(limits, len(origins)), *axes, starts, columns, room, found)
    return found


def scene_grid(scene):
    """The grid of a scene beside a wall."""
    return scene.low, scene.size, scene.cells, np.array(scene.packing.box), scene.starts, scene.columns


def lattice_grid(centers, radius, edge, cells):
    """A grid of cells^3 over a cube that repeats in all three directions, which no packing beside a wall does."""
    shifts = np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=3))) * edge
    images = (np.asarray(centers)[:, None] + shifts).reshape(-1, 3)
    size = edge / cells
    columns, starts = [], [0]
    for corner in itertools.product(range(cells), repeat=3):
        nearest = np.clip(images, size * np.array(corner), size * (np.array(corner) + 1.0))
        inside = images[np.linalg.norm(images - nearest, axis=1) <= radius * (1.0 + 1e-9)]
        columns.append(np.column_stack([inside, np.full(len(inside), radius**2)]).T)
        starts.append(starts[-1] + len(inside))
    three = np.ones(3)
    return (
        np.zeros(3), size * three, np.full(3, cells), edge * three,
        np.array(starts), np.ascontiguousarray(np.concatenate(columns, axis=1)),
    )  # fmt: skip


def nearest_spheres(points, centers, radii, box):
    """Number of the sphere on whose surface each point lies: the smallest |distance - radius| of the nearest ten."""
    wrapped = points.copy()
    for axis in np.flatnonzero(box):
        wrapped[:, axis] %= box[axis]
    tree = cKDTree(centers, boxsize=box if any(box) else None)
    distance, index = tree.query(wrapped, k=min(10, len(radii)))
    off = np.abs(distance - radii[index])
    best = off.argmin(axis=1)[:, None]
    return np.take_along_axis(index, best, axis=1)[:, 0], np.take_along_axis(off, best, axis=1)[:, 0]


def hit(found):
    """Which rays met a sphere."""
    return (found != ESCAPED) & np.isfinite(found)
