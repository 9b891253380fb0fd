"""Pairs of spheres that are close, with all periodic images."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bedrad.packings.packing import Packing

__all__ = ["Pairs", "close_pairs"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

SPHERES_AT_ONCE = 2**16
"""Spheres whose partners are sought together, which bounds the memory."""


@dataclass(frozen=True)
class Pairs:
    """Pairs as seen from their first sphere: sphere numbers, and the vector between the centres [m].

    A pair stands twice if both spheres were looked at, and once for every image that is close.
    """

    first: IntArray
    second: IntArray
    vector: FloatArray

    @property
    def distance(self) -> FloatArray:
        """Distance of the centres. [m]"""
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", self.vector, self.vector)))


def close_pairs(packing: Packing, first: IntArray, second: IntArray, stretch: float) -> Iterator[Pairs]:
    """Yield the pairs whose centres are no further apart than `stretch` times the sum of the radii, some at a time.

    Spheres are searched by octaves of radius, so that a few large ones do not widen every search.

    Parameters
    ----------
    packing : Packing
        The spheres.
    first, second : (m,), (n,) arrays
        Numbers of the spheres whose partners are sought, and of those that may be partners.
    stretch : float
        Largest distance of the centres over the sum of the radii.
    """
    if not (len(first) and len(second)):
        return
    centers, spheres, moved = _images(packing, second, 2.0 * stretch * float(packing.radii.max()))
    octaves = _octaves(packing.radii[spheres])
    trees = [(o, cKDTree(centers[o]), float(packing.radii[spheres[o]].max())) for o in octaves]
    for start in range(0, len(first), SPHERES_AT_ONCE):
        some = first[start : start + SPHERES_AT_ONCE]
        for octave in _octaves(packing.radii[some]):
            these = some[octave]
            own = cKDTree(packing.centers[these])
            for members, tree, largest in trees:
                reach = stretch * (float(packing.radii[these].max()) + largest)
                found = own.sparse_distance_matrix(tree, reach, output_type="ndarray")
                a, image = these[found["i"]], members[found["j"]]
                b = spheres[image]
                keep = found["v"] <= stretch * (packing.radii[a] + packing.radii[b])
                keep &= (a != b) | moved[image]
                a, b, image = a[keep], b[keep], image[keep]
                yield Pairs(a, b, centers[image] - packing.centers[a])


def _octaves(radii: FloatArray) -> list[IntArray]:
    octave = np.floor(np.log2(radii / radii.min())).astype(np.int64)
    return [np.flatnonzero(octave == k) for k in np.unique(octave)]


def _images(packing: Packing, spheres: IntArray, reach: float) -> tuple[FloatArray, IntArray, BoolArray]:
    """Centres of spheres and of their images within reach of the period, their numbers, and which were moved."""
    centers = packing.centers[spheres]
    numbers = []
    for length in packing.box:
        most = math.ceil(reach / length) if length else 0
        numbers.append(range(-most, most + 1))
    parts = []
    for shift in itertools.product(*numbers):
        image = centers + np.multiply(shift, packing.box)
        near = np.ones(len(image), dtype=bool)
        for axis, length in enumerate(packing.box):
            if length:
                near &= (image[:, axis] >= -reach) & (image[:, axis] <= length + reach)
        parts.append((image[near], spheres[near], np.full(int(near.sum()), any(shift))))
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))  # type: ignore[return-value]
