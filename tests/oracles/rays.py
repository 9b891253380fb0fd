"""First hits by brute force: every ray against every sphere and image, by the plain quadratic formula."""

from __future__ import annotations

import numpy as np


def first_hits(origins, directions, centers, radii, shifts):
    """Distances to the first sphere, infinite for none; `shifts` are the periodic translations to try, (k, 3)."""
    best = np.full(len(origins), np.inf)
    for shift in shifts:
        for center, radius in zip(centers + shift, radii, strict=True):
            oc = origins - center
            b = (oc * directions).sum(axis=1)
            c = (oc * oc).sum(axis=1) - radius**2
            square = b * b - c
            root = np.sqrt(np.where(square > 0, square, 0.0))
            near, far = -b - root, -b + root
            t = np.where(near >= 0, near, np.where(far > 0, 0.0, np.inf))
            best = np.minimum(best, np.where(square > 0, t, np.inf))
    return best


def cosine_rays(rng, wall, window, count):
    """Origins on the wall and directions by the cosine law, by another route than the kernels: a normalised sum of the
    normal and a random point of the unit sphere."""
    axial = rng.uniform(*window.axial, count)
    if wall.kind == "plate":
        origins = np.column_stack([axial, rng.uniform(*window.lateral, count), np.zeros(count)])
    else:
        angle = rng.uniform(0, 2 * np.pi, count)
        origins = np.column_stack([wall.radius * np.cos(angle), wall.radius * np.sin(angle), axial])
    sphere = rng.normal(size=(count, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    directions = wall.normal(origins) + sphere
    return origins, directions / np.linalg.norm(directions, axis=1)[:, None]


def fates(wall, origins, directions, hits, edges, ends):
    """Layer of each ray's end, then len(edges) - 1 beyond, + 1 wall, + 2 escaped.

    `ends` maps an open axis to its (low, high). Beside a rod or plate a ray is beyond once deeper than the last edge.
    """
    layers = len(edges) - 1
    fate = np.full(len(hits), layers)
    if wall.kind == "tube":
        flat = (directions[:, :2] ** 2).sum(axis=1)
        t_other = -2 * (origins[:, :2] * directions[:, :2]).sum(axis=1) / flat
        fate[t_other < hits] = layers + 1
    elif wall.kind == "plate":
        t_other = edges[-1] / directions[:, 2]
    else:
        flat = (directions[:, :2] ** 2).sum(axis=1)
        b = (origins[:, :2] * directions[:, :2]).sum(axis=1)
        t_other = (-b + np.sqrt(b * b + flat * ((wall.radius + edges[-1]) ** 2 - wall.radius**2))) / flat
    t_end = np.minimum(hits, t_other)
    met = hits < t_other
    depth = wall.depth(origins[met] + hits[met, None] * directions[met])
    fate[met] = np.searchsorted(edges[1:], depth, side="left")
    for axis, (low, high) in ends.items():
        d = directions[:, axis]
        with np.errstate(divide="ignore"):
            o = origins[:, axis]
            t_out = np.where(d > 0, (high - o) / d, np.where(d < 0, (low - o) / d, np.inf))
        fate[t_out < t_end] = layers + 2
    return fate
