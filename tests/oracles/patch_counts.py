"""Rays from patches, counted stratum by stratum, with and without the shells of spheres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bedrad.raytrace.patch_kernels import make_room, trace_groups


@dataclass(frozen=True)
class PatchCounts:
    """Rays by stratum, half and fate (strata, 2, fates), and those that the shells handed back to the grid (7, n)."""

    counts: np.ndarray
    left: np.ndarray

    @property
    def handed_back(self):
        return self.left.shape[1]

    @property
    def rays(self):
        return int(self.counts.sum())


def patch_counts(tracer, strata, hand_back=False, groups=None, room=None):
    """Trace the strata of a range of groups, all if none is given.

    With `hand_back` no shell is possible, so that all of the very same rays are followed through the grid.
    """
    side = tracer.side(strata)
    first, last = groups or (0, -(-strata.along // side) * -(-strata.around // side))
    most = (last - first) * side**2
    rays = most * 2 * strata.net.shape[1]
    rows = np.full(most, -1)
    counts = np.zeros((most, 2, len(tracer.wall.edges) + 2), np.int64)
    left, slots = np.empty((7, rays)), np.empty((rays, 2), np.int64)
    wall = tracer.wall._replace(first_shell=-1.0) if hand_back else tracer.wall
    count = trace_groups(first, last, strata, wall, tracer.bins, *(room or make_room()), rows, counts, left, slots)
    left, slots = left[:, :count], slots[:count]
    np.add.at(counts, (slots[:, 0], slots[:, 1], tracer.grid.follow(left)), 1)
    return PatchCounts(counts[rows >= 0], left)
