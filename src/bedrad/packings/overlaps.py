"""How deep spheres overlap each other: soft-sphere DEM leaves overlaps, broken files leave nonsense."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bedrad.walls import Wall

__all__ = ["Overlap", "overlap_facts", "pair_overlaps", "worst_overlap"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


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
        Sphere numbers of each pair, the smaller one first.
    depth : (m,) array
        Sum of the radii minus the distance of the centres, positive. [m]
    """
    octave = np.floor(np.log2(radii / radii.min())).astype(np.int64) if len(radii) else np.empty(0, np.int64)
    members = [np.flatnonzero(octave == k) for k in np.unique(octave)]
    trees = [cKDTree(centers[m], boxsize=box if any(box) else None) for m in members]
    firsts, seconds, depths = [], [], []
    for a, (tree_a, in_a) in enumerate(zip(trees, members, strict=True)):
        for b in range(a, len(trees)):
            in_b = members[b]
            reach = float(radii[in_a].max() + radii[in_b].max())
            found = tree_a.sparse_distance_matrix(trees[b], reach, output_type="ndarray")
            first, second = in_a[found["i"]], in_b[found["j"]]
            depth = radii[first] + radii[second] - found["v"]
            keep = (depth > 0.0) & (first != second) & ((b != a) | (first < second))
            firsts.append(np.minimum(first, second)[keep])
            seconds.append(np.maximum(first, second)[keep])
            depths.append(depth[keep])
    if not firsts:
        return np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0)
    return np.concatenate(firsts), np.concatenate(seconds), np.concatenate(depths)


def worst_overlap(
    centers: FloatArray, radii: FloatArray, box: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> Overlap | None:
    """The deepest overlap in units of the smaller radius of its pair, or None where no spheres overlap."""
    first, second, depth = pair_overlaps(centers, radii, box)
    if not len(depth):
        return None
    share = depth / np.minimum(radii[first], radii[second])
    worst = int(np.argmax(share))
    return Overlap(int(first[worst]), int(second[worst]), float(share[worst]))


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
