"""How deep spheres overlap each other: soft-sphere DEM leaves overlaps, broken files leave nonsense."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bedrad.walls import Wall

__all__ = ["Overlap", "overlap_facts", "pair_overlaps", "worst_overlap"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_CHUNK = 1 << 12
"""Spheres whose neighbours are looked for at once."""

_LARGEST_SEARCH = 1 << 20
"""Pairs within reach that a search may give; what gives more is searched in halves."""

_CROWD = 32
"""Points that share a cube as wide as the reach, up to which a chunk cannot give more."""

_CROWDED = 100
"""Pairs within reach for each sphere above which they cannot be the spheres of a packing."""

_MOST_PAIRS = 2 * 10**7
"""Pairs in reach that are looked at in a crowd whose overlaps are all allowed: short periods crowd a few spheres."""


@dataclass(frozen=True)
class Overlap:
    """The pair of spheres that overlap most, in units of the smaller radius."""

    first: int
    second: int
    share: float


def pair_overlaps(
    centers: FloatArray, radii: FloatArray, box: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> tuple[IntArray, IntArray, FloatArray]:
    """All pairs of spheres that overlap.

    Spheres are sorted into octaves of radius and searched octave against octave, so that a few large spheres among
    many small ones do not make every search as wide as the largest.

    Parameters
    ----------
    centers : (n, 3) array
        Centres, inside [0, box) along periodic axes. [m]
    radii : (n,) array
        Radii. [m]
    box : (float, float, float)
        Period of each axis, 0 where it is not periodic. [m]

    Returns
    -------
    first, second : (m,) arrays
        Sphere numbers of each pair, the smaller one first, in ascending order.
    depth : (m,) array
        Sum of the radii minus the distance of the centres, positive. [m]
    """
    parts = [(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))]
    parts += [(found.first, found.second, found.depth) for found in _searched(centers, radii, box)]
    first, second, depth = (np.concatenate(part) for part in zip(*parts, strict=True))
    order = np.lexsort((second, first))
    return first[order], second[order], depth[order]


def worst_overlap(
    centers: FloatArray,
    radii: FloatArray,
    box: tuple[float, float, float] = (0.0, 0.0, 0.0),
    enough: float = math.inf,
) -> Overlap | None:
    """The deepest overlap in units of the smaller radius of its pair, or None where no spheres overlap.

    Parameters
    ----------
    centers, radii, box
        The spheres, as for `pair_overlaps`.
    enough : float
        An overlap deeper than this ends the search where spheres crowd as they cannot in a packing, as the search
        would take the square of their number.

    Raises
    ------
    ValueError
        If they crowd so although no overlap is deeper than what is enough.
    """
    worst: Overlap | None = None
    seen = 0
    for found in _searched(centers, radii, box):
        seen += found.seen
        if len(found.depth):
            share = found.depth / np.minimum(radii[found.first], radii[found.second])
            # of overlaps that are alike, the one of the first spheres
            best = int(np.lexsort((found.second, found.first, -share))[0])
            deep = Overlap(int(found.first[best]), int(found.second[best]), float(share[best]))
            if worst is None or (-deep.share, deep.first, deep.second) < (-worst.share, worst.first, worst.second):
                worst = deep
        if seen > _CROWDED * len(radii):
            if worst is not None and worst.share > enough:
                break
            if math.isfinite(enough) and seen > _MOST_PAIRS:
                raise ValueError(
                    f"{len(radii)} spheres of which more than {_CROWDED} are in reach of each; no packing is so crowded"
                )
    return worst


def overlap_facts(centers: FloatArray, radii: FloatArray, wall: Wall) -> dict[str, str | float | int]:
    """Mean and largest overlap between spheres and with the wall, in mean diameters, by the name of each."""
    mean = 2.0 * float(radii.mean())
    _, _, between = pair_overlaps(centers, radii)
    beyond = radii - wall.depth(centers)
    beyond = beyond[beyond > 0.0]
    return {
        "mean_pair_overlap_d": float(between.mean()) / mean if len(between) else 0.0,
        "largest_pair_overlap_d": float(between.max(initial=0.0)) / mean,
        "mean_wall_overlap_d": float(beyond.mean()) / mean if len(beyond) else 0.0,
        "largest_wall_overlap_d": float(beyond.max(initial=0.0)) / mean,
    }


@dataclass(frozen=True)
class _Found:
    """What one search gives: the pairs that overlap, and how many were within reach."""

    first: IntArray
    second: IntArray
    depth: FloatArray
    seen: int


def _searched(centers: FloatArray, radii: FloatArray, box: tuple[float, float, float]) -> Iterator[_Found]:
    """Search for overlaps chunk by chunk, each pair in one of them, with bounded memory."""
    octave = np.floor(np.log2(radii / radii.min())).astype(np.int64) if len(radii) else np.empty(0, np.int64)
    members = [np.flatnonzero(octave == k) for k in np.unique(octave)]
    for a, in_a in enumerate(members):
        points = centers[in_a]
        tree = _tree(points, box)
        for b in range(a, len(members)):
            in_b = members[b]
            reach = float(radii[in_a].max() + radii[in_b].max())
            other = tree if b == a else _tree(centers[in_b], box)
            crowded = _largest_crowd(other.data, reach) > _CROWD
            # in the order of the tree neighbours lie together, so that a chunk meets few branches
            for start in range(0, len(in_a), _CHUNK):
                chunk = tree.indices[start : start + _CHUNK]
                for part, found in _within(points, chunk, other, reach, box, crowded):
                    first, second = in_a[part[found["i"]]], in_b[found["j"]]
                    depth = radii[first] + radii[second] - found["v"]
                    keep = (depth > 0.0) & (first != second) & ((b != a) | (first < second))
                    first, second = first[keep], second[keep]
                    yield _Found(np.minimum(first, second), np.maximum(first, second), depth[keep], len(found))


def _within(
    centers: FloatArray,
    chunk: IntArray,
    other: cKDTree,
    reach: float,
    box: tuple[float, float, float],
    crowded: bool,
) -> Iterator[tuple[IntArray, NDArray[np.void]]]:
    """Pairs within reach of a chunk of points and those of a tree, in halves where there are too many."""
    tree = _tree(centers[chunk], box)
    # counting takes as long as searching, so it is done only where it may matter
    if crowded and len(chunk) > 1 and tree.count_neighbors(other, reach) > _LARGEST_SEARCH:
        half = len(chunk) // 2
        yield from _within(centers, chunk[:half], other, reach, box, crowded)
        yield from _within(centers, chunk[half:], other, reach, box, crowded)
    else:
        yield chunk, tree.sparse_distance_matrix(other, reach, output_type="ndarray")


def _tree(points: FloatArray, box: tuple[float, float, float]) -> cKDTree:
    return cKDTree(points, boxsize=box if any(box) else None)


def _largest_crowd(points: FloatArray, reach: float) -> int:
    """The most points that share a cube as wide as the reach."""
    # further out than 2^20 cubes they share the last one, which only makes the crowd larger
    cells = np.minimum((points - points.min(axis=0)) / reach, 2.0**20).astype(np.int64)
    keys = (cells[:, 0] << 42) | (cells[:, 1] << 21) | cells[:, 2]
    return int(np.unique(keys, return_counts=True)[1].max())
