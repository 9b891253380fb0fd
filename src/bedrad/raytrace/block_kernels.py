"""Kernels for a block of rays from one patch of wall: start them, test them against a sphere, settle them, count them.

The loops have no branches, so that the compiler takes several rays at a time. A block is a (9, n) array whose rows are
origin, direction, the distance at which the ray ends without a hit, that of its nearest hit so far, and the fate
without a hit, in the frame of the patch (see `bedrad.raytrace.candidate_kernels`).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from bedrad.raytrace.candidate_kernels import BRANCH_FREE, LEAN
from bedrad.raytrace.kernels import PLATE, TUBE, turn

__all__ = ["end_at", "find_fates", "pack", "start_block", "tally", "test_sphere"]

OX, OY, OZ, DX, DY, DZ, END, HIT, MISS = range(9)
"""Rows of a block."""


@njit(inline="always", **LEAN)
def _small_turn(angle):
    """1 - cosine and sine of an angle below 0.4 rad, to two roundings, without a branch."""
    z = angle * angle
    versine = 0.5 * z * (1.0 - z / 12 * (1.0 - z / 30 * (1.0 - z / 56 * (1.0 - z / 90 * (1.0 - z / 132)))))
    sine = angle * (1.0 - z / 6 * (1.0 - z / 20 * (1.0 - z / 42 * (1.0 - z / 72 * (1.0 - z / 110 * (1.0 - z / 156))))))
    return versine, sine


@njit(**BRANCH_FREE)
def start_block(net, first, count, shift, length, width, kind, wall_radius, reach, miss, rays):
    """Origins and directions, in the frame of a patch, of rays by the cosine law.

    Parameters
    ----------
    net : (4, m) uint32 array
        Points: along, around, square of the sine of the polar angle, azimuth.
    first, count : int
        The run of points to take.
    shift : 4 uint32
        Digital shift of the points.
    length, width : float
        Size of the patch along and around the wall, both as lengths; beside a tube or rod less than 0.8 of its radius.
    kind, wall_radius : int, float
        The wall.
    reach : float
        Depth at which a ray ends beside a rod or plate.
    miss : float
        Fate of a ray that meets no sphere.
    rays : (9, n) array
        Filled.
    """
    scale = 1.0 / 4294967296.0
    s0, s1, s2, s3 = shift[0], shift[1], shift[2], shift[3]
    for i in range(count):
        u0 = (np.float64(net[0, first + i] ^ s0) + 0.5) * scale
        u1 = (np.float64(net[1, first + i] ^ s1) + 0.5) * scale
        u2 = (np.float64(net[2, first + i] ^ s2) + 0.5) * scale
        u3 = (np.float64(net[3, first + i] ^ s3) + 0.5) * scale
        across, along = turn(u3)
        sine = math.sqrt(u2)
        rays[OZ, i] = (u0 - 0.5) * length
        rays[OY, i] = (u1 - 0.5) * width
        rays[DX, i] = math.sqrt(1.0 - u2)
        rays[DY, i] = across * sine
        rays[DZ, i] = along * sine
        rays[MISS, i] = miss
    # one loop for each wall: a choice inside the loop would keep the compiler from taking several rays at a time
    if kind == PLATE:
        for i in range(count):
            rays[OX, i] = 0.0
            rays[END, i] = reach / rays[DX, i]
    elif kind == TUBE:
        for i in range(count):
            cosine, across = rays[DX, i], rays[DY, i]
            versine, sine = _small_turn(rays[OY, i] / wall_radius)
            rays[OX, i] = wall_radius * versine
            rays[OY, i] = wall_radius * sine
            dx = cosine * (1.0 - versine) + across * sine
            dy = across * (1.0 - versine) - cosine * sine
            rays[DX, i] = dx
            rays[DY, i] = dy
            rays[END, i] = 2.0 * wall_radius * cosine / (dx * dx + dy * dy)
    else:
        # outward from R to R + reach: the root of flat t^2 + 2 R cos t - reach (2 R + reach), without cancellation
        c = reach * (2.0 * wall_radius + reach)
        for i in range(count):
            cosine, across = rays[DX, i], rays[DY, i]
            versine, sine = _small_turn(rays[OY, i] / wall_radius)
            rays[OX, i] = -wall_radius * versine
            rays[OY, i] = wall_radius * sine
            dx = cosine * (1.0 - versine) - across * sine
            dy = across * (1.0 - versine) + cosine * sine
            rays[DX, i] = dx
            rays[DY, i] = dy
            b = wall_radius * cosine
            rays[END, i] = c / (b + math.sqrt(b * b + (dx * dx + dy * dy) * c))
    for i in range(count):
        rays[HIT, i] = rays[END, i]


@njit(**BRANCH_FREE)
def end_at(rays, count, row, lower, upper, fate):
    """End the rays that leave a slab, `lower` < origin < `upper` along one axis (row of the origin), with a fate."""
    for i in range(count):
        direction = rays[row + 3, i]
        distance = max((upper - rays[row, i]) / direction, (lower - rays[row, i]) / direction)
        leaves = distance < rays[END, i]
        rays[MISS, i] = fate if leaves else rays[MISS, i]
        rays[END, i] = distance if leaves else rays[END, i]
        rays[HIT, i] = rays[END, i]


@njit(**BRANCH_FREE)
def test_sphere(cx, cy, cz, square_radius, rays, count):
    """Shorten the rays that meet a sphere; 0 from inside it.

    The half chord comes from the distance between centre and ray, not from the difference of two squares of the
    distance to the centre, so that far spheres lose no digits.
    """
    for i in range(count):
        x, y, z = cx - rays[OX, i], cy - rays[OY, i], cz - rays[OZ, i]
        dx, dy, dz = rays[DX, i], rays[DY, i], rays[DZ, i]
        along = x * dx + y * dy + z * dz
        px, py, pz = x - along * dx, y - along * dy, z - along * dz
        square = square_radius - (px * px + py * py + pz * pz)
        half = math.sqrt(max(square, 0.0))
        t = max(along - half, 0.0) if (square > 0.0) & (along + half > 0.0) else math.inf
        rays[HIT, i] = min(rays[HIT, i], t)


@njit(**LEAN)
def pack(rays, count, distance, index, packed):
    """Pack the rays together that are not settled within a distance; their places go to `index`."""
    kept = 0
    for i in range(count):
        index[kept] = i
        kept += rays[HIT, i] > distance
    for k in range(MISS):
        for j in range(kept):
            packed[k, j] = rays[k, index[j]]
    return kept


@njit(**BRANCH_FREE)
def find_fates(rays, count, kind, wall_radius, edges, fates):
    """Fates of settled rays: the layer that holds the hit, or what a ray without a hit has as its fate."""
    if kind == PLATE:
        for i in range(count):
            rays[OY, i] = rays[OX, i] + rays[HIT, i] * rays[DX, i]
    else:
        inward = -1.0 if kind == TUBE else 1.0
        for i in range(count):
            x = rays[OX, i] + rays[HIT, i] * rays[DX, i]
            y = rays[OY, i] + rays[HIT, i] * rays[DY, i]
            # R - sqrt((R - x)^2 + y^2) without the difference of two large numbers
            radial = math.sqrt((wall_radius + inward * x) ** 2 + y * y)
            rays[OY, i] = (2.0 * wall_radius * x + inward * (x * x + y * y)) / (wall_radius + radial)
    for i in range(count):
        fates[i] = 0
    for k in range(1, edges.size):
        edge = edges[k]
        for i in range(count):
            fates[i] += np.int32(rays[OY, i] > edge)
    for i in range(count):
        fates[i] = fates[i] if rays[HIT, i] < rays[END, i] else np.int32(rays[MISS, i])


@njit(**BRANCH_FREE)
def tally(fates, count, counts):
    """Add the numbers of rays of each fate."""
    for k in range(counts.size):
        found = np.int64(0)
        for i in range(count):
            found += np.int64(fates[i] == k)
        counts[k] += found
