"""Ray kernels for many rays from one patch of wall: blocks of rays against the few spheres near the patch.

A block of rays is tested against the spheres of a shell around the patch, sphere by sphere. A ray whose nearest hit is
nearer than any sphere outside the shell is settled; the others are packed together and go on to the next shell. The
few that are left after the last shell are handed back, to be followed through a grid.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from bedrad.raytrace.block_kernels import (
    DX,
    DY,
    DZ,
    HIT,
    OX,
    OY,
    OZ,
    end_at,
    find_fates,
    pack,
    start_block,
    tally,
    test_sphere,
)
from bedrad.raytrace.candidate_kernels import LEAN, gather, localise, make_patch, select
from bedrad.raytrace.kernels import PLATE, TUBE

__all__ = ["BLOCK", "Search", "Strata", "Surroundings", "make_room", "trace_groups"]

BLOCK = 256
"""Rays that are traced together; their data stay in the fastest cache."""

SHELLS = 8
"""Most shells that a block passes."""

GROWTH = 1.6
"""Ratio of the outer distances of two shells."""

WALK_COST, SEARCH_COST, SELECT_COST = 14.0, 80.0, 12.0
"""What it costs, in tests of eight rays, to follow a ray through the grid, to find the spheres of another shell in the
bins, and to select them from those that are known near the group."""

FAR_BLOCK = 200
"""Rays of a half from which on a group's first search takes in the second and third shell."""

MOST_ADAPTED = 4.0
"""Largest ratio of the first shell's distance to that where it begins."""

MOST_NEAR = 2048
"""Most spheres near one group of patches."""


class Strata(NamedTuple):
    """How the window is cut, and what each piece emits.

    Parameters
    ----------
    along, around : int
        Number of strata along and around (or across) the wall.
    parts_along, parts_around : int
        Number of patches of a stratum; one is drawn by each of its two halves where there are several.
    window : (4,) array
        Axial start and length, start and length around (0 and 2 pi) or across.
    net : (4, m) uint32 array
        The points of one half of a stratum, before they are shifted: along, around, polar, azimuth.
    seed : int
        Decides shifts and drawn patches.
    tile : int
        Patches along each side of a group that shares one search for spheres.
    wanted : float
        Spheres that the first shell should hold; its distance follows what the last patch needed.
    """

    along: int
    around: int
    parts_along: int
    parts_around: int
    window: NDArray[np.float64]
    net: NDArray[np.uint32]
    seed: np.uint64
    tile: int
    wanted: float


class Surroundings(NamedTuple):
    """What the rays meet: wall, depths, open ends, first shell.

    Parameters
    ----------
    kind : int
        `TUBE`, `ROD` or `PLATE`.
    wall_radius : float
        Radius of the wall.
    edges : (layers + 1,) array
        Depths that part the layers.
    ends : (2, 2) array
        Ends of the bed along and across, infinite where it is periodic or closed.
    first_shell : float
        Distance of the first shell to begin with.
    """

    kind: int
    wall_radius: float
    edges: NDArray[np.float64]
    ends: NDArray[np.float64]
    first_shell: float


@njit(inline="always", **LEAN)
def mix(x):
    """Scramble 64 bits (the output function of SplitMix64, Steele, Lea and Flood 2014)."""
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return x ^ (x >> np.uint64(31))


class Search(NamedTuple):
    """What is known of the spheres near a group of patches and near one of them; filled as shells are needed.

    Parameters
    ----------
    near : (4, n) array
        Spheres near the group: centres, images included, and radii.
    local : (5, n) array
        The same in the frame of the present patch, with distances.
    candidates : (4, n) array
        Those of the shells so far, shell by shell: centres and squared radii in the frame of the patch.
    counts : (3,) int array
        Number of spheres near, of those in the frame, and of shells.
    ends : (shells,) int array
        Where each shell ends in `candidates`.
    upto : (shells + 2,) array
        Outer distance of each shell; then that of the spheres near, and of the next first shell.
    """

    near: NDArray[np.float64]
    local: NDArray[np.float64]
    candidates: NDArray[np.float64]
    counts: NDArray[np.int64]
    ends: NDArray[np.int64]
    upto: NDArray[np.float64]


def make_room() -> tuple[Search, tuple[NDArray[Any], ...]]:
    """Room for `trace_groups` to work in."""
    search = Search(
        np.empty((4, MOST_NEAR)), np.empty((5, MOST_NEAR)), np.empty((4, 2 * MOST_NEAR)),
        np.zeros(3, np.int64), np.zeros(SHELLS, np.int64), np.zeros(SHELLS + 2),
    )  # fmt: skip
    scratch = (
        np.empty((9, BLOCK)), np.empty((2, 9, BLOCK)), np.empty((2, BLOCK), np.int64),
        np.empty(BLOCK, np.int32), np.empty((5, 512)),
    )  # fmt: skip
    return search, scratch


NEAR, LOCAL, SHELL = range(3)
HORIZON, FIRST = SHELLS, SHELLS + 1


@njit(**LEAN)
def _widen(search, bins, tile, upper, kind, wall_radius, room):
    """Find the spheres near a group up to a larger distance, or as many of them as there is room for."""
    horizon = search.upto[HORIZON]
    upper = min(upper, bins.depth)
    for _ in range(24):
        if upper <= horizon:
            return
        found = gather(bins, tile, horizon, upper, kind, wall_radius, room, search.near, search.counts[NEAR])
        if found >= 0:
            search.counts[NEAR] = found
            search.upto[HORIZON] = upper
            return
        upper = 0.5 * upper if horizon == -math.inf else 0.5 * (horizon + upper)


@njit(**LEAN)
def _add_shell(search, bins, tile, patch, wall, strata, room):
    """Add the next shell around a patch; False if no wider one can be complete."""
    shell = search.counts[SHELL]
    lower = search.upto[shell - 1] if shell else -math.inf
    upper = lower * GROWTH if shell else search.upto[FIRST]
    if upper > search.upto[HORIZON]:
        if shell == 0 and (strata.tile > 1 or strata.net.shape[1] >= FAR_BLOCK):
            # the patches of a group need nearly the same spheres, and most large blocks a second and third shell
            _widen(search, bins, tile, upper * GROWTH * GROWTH, wall.kind, wall.wall_radius, room)
        _widen(search, bins, tile, upper, wall.kind, wall.wall_radius, room)
        upper = min(upper, search.upto[HORIZON])
    if not upper > max(lower, 0.0):
        return False
    known, near = search.counts[LOCAL], search.counts[NEAR]
    if known < near:
        localise(search.near, known, near - known, 0.0, 0.0, patch, wall.kind, wall.wall_radius, search.local, known)
        search.counts[LOCAL] = near
    at = search.ends[shell - 1] if shell else 0
    found = select(search.local, near, lower, upper, search.candidates, at)
    if found < 0:
        return False
    search.ends[shell], search.upto[shell] = found, upper
    search.counts[SHELL] = shell + 1
    if shell == 0:
        adapted = upper * min(max((strata.wanted + 1.0) / (found + 1.0), 0.8), 1.25)
        search.upto[FIRST] = min(adapted, MOST_ADAPTED * wall.first_shell)
    return True


@njit(inline="always", **LEAN)
def _worth_a_shell(kept, shell, search):
    """Whether testing the unsettled rays against another shell costs less than following most of them on their own."""
    tested = search.ends[shell - 1]
    if shell < search.counts[SHELL]:
        cost = float(search.ends[shell] - tested)
    else:
        known = search.upto[shell - 1] * GROWTH <= search.upto[HORIZON]
        # a shell holds as many spheres as its volume has room for
        cost = (GROWTH**3 - 1.0) * tested + (SELECT_COST if known else SEARCH_COST)
    return cost * (0.75 + 0.03 * kept) < 0.75 * WALK_COST * kept


@njit(**LEAN)
def _settle(rays, spare, index, count, search, bins, tile, patch, wall, strata, room):
    """Find the nearest hits of a block, shell by shell.

    Returns the number of rays that no shell settled; their numbers are the first in ``index[0]``.
    """
    open_rays, now, target = count, rays, 0
    for shell in range(SHELLS):
        if shell == search.counts[SHELL] and not _add_shell(search, bins, tile, patch, wall, strata, room):
            break
        begin = search.ends[shell - 1] if shell else 0
        # a few rays too many cost nothing: the compiler takes them eight at a time
        padded = (open_rays + 7) & ~7
        c = search.candidates
        for k in range(begin, search.ends[shell]):
            test_sphere(c[0, k], c[1, k], c[2, k], c[3, k], now, padded)
        if shell:
            for j in range(open_rays):
                rays[HIT, index[0, j]] = now[HIT, j]
        kept = pack(now, open_rays, search.upto[shell], index[1], spare[target])
        for j in range(kept):
            index[0, j] = index[0, index[1, j]] if shell else index[1, j]
        open_rays, now, target = kept, spare[target], 1 - target
        if kept == 0 or not _worth_a_shell(kept, shell + 1, search):
            return kept
    if search.counts[SHELL] == 0:
        for j in range(count):
            index[0, j] = j
    return open_rays


@njit(**LEAN)
def _hand_back(rays, index, kept, patch, kind, wall_radius, slot, half, left, slots, at):
    """Append unsettled rays: origin, direction, cosine to the wall's normal, in the bed's frame."""
    for j in range(kept):
        i = index[j]
        x, y, z = rays[OX, i], rays[OY, i], rays[OZ, i] + patch.along
        dx, dy, dz = rays[DX, i], rays[DY, i], rays[DZ, i]
        if kind == PLATE:
            values = (z, y + patch.around, 0.0, dz, dy, dx, dx)
        else:
            inward = -1.0 if kind == TUBE else 1.0
            radial, c, s = wall_radius + inward * x, patch.cosine, patch.sine
            dr = inward * dx
            # the angle to the normal, from origin and direction in the frame of the patch
            cosine = (dx * (wall_radius + inward * x) + inward * dy * y) / wall_radius
            values = (radial * c - y * s, radial * s + y * c, z, dr * c - dy * s, dr * s + dy * c, dz, cosine)
        for k in range(7):
            left[k, at] = values[k]
        slots[at, 0], slots[at, 1] = slot, half
        at += 1
    return at


@njit(**LEAN)
def _trace_half(half, slot, key, strata, wall, bins, tile, patch, search, scratch, counts, left, slots, at):
    """Trace the rays of one half of a stratum from a patch; returns the number of rays handed back so far."""
    rays, spare, index, fates, room = scratch
    one, two = mix(key + np.uint64(0x9E3779B97F4A7C15)), mix(key + np.uint64(0x3C6EF372FE94F82A))
    low = np.uint64(0xFFFFFFFF)
    shift = (
        np.uint32(one & low), np.uint32(one >> np.uint64(32)), np.uint32(two & low), np.uint32(two >> np.uint64(32))
    )  # fmt: skip
    layers, points = wall.edges.size - 1, strata.net.shape[1]
    length = 2.0 * patch.half_z
    width = strata.window[3] / (strata.around * strata.parts_around)
    if wall.kind != PLATE:
        width *= wall.wall_radius
    miss = layers + 1.0 if wall.kind == TUBE else float(layers)
    for begin in range(0, points, BLOCK):
        count = min(BLOCK, points - begin)
        start_block(
            strata.net, begin, count, shift, length, width, wall.kind, wall.wall_radius, wall.edges[layers], miss, rays
        )
        for axis in range(2):
            if wall.ends[axis, 0] > -math.inf:
                middle = patch.around if axis else patch.along
                lower, upper = wall.ends[axis, 0] - middle, wall.ends[axis, 1] - middle
                end_at(rays, count, OY if axis else OZ, lower, upper, layers + 2.0)
        kept = _settle(rays, spare, index, count, search, bins, tile, patch, wall, strata, room)
        at = _hand_back(rays, index[0], kept, patch, wall.kind, wall.wall_radius, slot, half, left, slots, at)
        find_fates(rays, count, wall.kind, wall.wall_radius, wall.edges, fates)
        for j in range(kept):
            fates[index[0, j]] = -1
        tally(fates, count, counts[slot, half])
    return at


@njit(**LEAN)
def trace_groups(first, last, strata, wall, bins, search, scratch, rows, counts, left, slots):
    """Trace the rays of some groups of strata and count where they end.

    Parameters
    ----------
    first, last : int
        Range of groups: tiles of neighbouring strata, or single strata where each half draws its own patch.
    strata : Strata
        How the window is cut.
    wall : Surroundings
        The wall.
    bins : Bins
        The spheres.
    rows : (n,) int array
        Filled with the axial number of each stratum of these groups.
    counts : (n, 2, layers + 3) int array
        Numbers of rays of each stratum, half and fate, added to.
    left : (7, k) array
        Filled with rays that the shells did not settle: origin, direction, cosine of the angle to the wall's normal.
    slots : (k, 2) int array
        Filled with stratum and half of each of those.

    Returns
    -------
    int
        Number of rays left.
    """
    search.upto[FIRST] = wall.first_shell
    drawn = strata.parts_along * strata.parts_around > 1
    side = 1 if drawn else strata.tile
    tiles = (strata.around + side - 1) // side
    length, width = strata.window[1] / strata.along, strata.window[3] / strata.around
    # of the type that it has later: a bare 0 would have the kernels below compiled twice
    at, slot = np.int64(0), -1
    for group in range(first, last):
        z0, y0 = (group // tiles) * side, (group % tiles) * side
        z1, y1 = min(z0 + side, strata.along), min(y0 + side, strata.around)
        if not drawn:
            tile = make_patch(
                strata.window[0] + 0.5 * (z0 + z1) * length, strata.window[2] + 0.5 * (y0 + y1) * width,
                (z1 - z0) * length, (y1 - y0) * width, wall.kind, wall.wall_radius,
            )  # fmt: skip
            search.counts[NEAR], search.upto[HORIZON] = 0, -math.inf
        for iz in range(z0, z1):
            for iy in range(y0, y1):
                slot += 1
                rows[slot] = iz
                for half in range(2):
                    key = mix(strata.seed + np.uint64(2 * (iz * strata.around + iy) + half))
                    if drawn or half == 0:
                        bits = mix(key)
                        pz = int(bits % np.uint64(strata.parts_along))
                        py = int((bits >> np.uint64(32)) % np.uint64(strata.parts_around))
                        patch = make_patch(
                            strata.window[0] + (iz + (pz + 0.5) / strata.parts_along) * length,
                            strata.window[2] + (iy + (py + 0.5) / strata.parts_around) * width,
                            length / strata.parts_along, width / strata.parts_around, wall.kind, wall.wall_radius,
                        )  # fmt: skip
                        search.counts[LOCAL], search.counts[SHELL] = 0, 0
                        if drawn:
                            tile = patch
                            search.counts[NEAR], search.upto[HORIZON] = 0, -math.inf
                    at = _trace_half(
                        half, slot, key, strata, wall, bins, tile, patch, search, scratch, counts, left, slots, at
                    )
    return at
