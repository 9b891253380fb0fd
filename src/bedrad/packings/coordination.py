"""Contacts between spheres: how many each has, within every gap tolerance, and where they lie.

The gap between two spheres is taken in radii of the smaller one, as overlaps are; it is the smaller one whose place a
gap decides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.neighbours import close_pairs
from bedrad.packings.packing import Packing

__all__ = ["RATTLER_CONTACTS", "Contacts", "sphere_contacts"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

RATTLER_CONTACTS = 4
"""A sphere with fewer contacts, the wall counted as one, is a rattler.

Without friction no fewer than four forces hold a sphere in place. With friction two or three can, so that the share of
rattlers is an upper bound there.
"""


@dataclass(frozen=True)
class Contacts:
    """Contacts of chosen spheres with others.

    Attributes
    ----------
    counts : (m, tolerances) array
        Number of contacts of every chosen sphere within each tolerance.
    first : (c,) array
        For every contact within the chosen tolerance the sphere, as its place among the chosen ones.
    depths : (c,) array
        Depth of these contacts below the wall: in the middle of the gap. [m]
    """

    counts: IntArray
    first: IntArray
    depths: FloatArray


def sphere_contacts(packing: Packing, chosen: BoolArray, tolerances: FloatArray, kept: int) -> Contacts:
    """Count the contacts of spheres with other spheres, periodic images of themselves among them.

    Parameters
    ----------
    packing : Packing
        The spheres. Partners are sought among all of them.
    chosen : (n,) array of bool
        The spheres whose contacts are counted.
    tolerances : (k,) array
        Gaps that count as contact, in radii of the smaller sphere.
    kept : int
        Which of the tolerances the places of the contacts are wanted for.

    Returns
    -------
    Contacts
        Counts, and depths of the contacts.
    """
    spheres = np.flatnonzero(chosen)
    place = np.full(len(packing), -1, dtype=np.int64)
    place[spheres] = np.arange(len(spheres))
    counts = np.zeros((len(spheres), len(tolerances)), dtype=np.int64)
    if not len(spheres):
        return Contacts(counts, np.empty(0, np.int64), np.empty(0))
    widest = float(tolerances.max())
    near_side = packing.depths - packing.radii
    # what touches a sphere begins no deeper than its far side and the widest gap
    deepest = float((packing.depths + packing.radii * (1.0 + widest))[spheres].max())
    others = np.flatnonzero(near_side <= deepest)
    firsts, depths = [], []
    # (r_i + r_j)(1 + g/2) is at least r_i + r_j + g min(r_i, r_j)
    for pairs in close_pairs(packing, spheres, others, 1.0 + 0.5 * widest):
        r, q = packing.radii[pairs.first], packing.radii[pairs.second]
        distance = pairs.distance
        gap = (distance - r - q) / np.minimum(r, q)
        first = place[pairs.first]
        for k, tolerance in enumerate(tolerances):
            counts[:, k] += np.bincount(first[gap <= tolerance], minlength=len(spheres))
        touching = gap <= tolerances[kept]
        # of spheres on one point any direction is as good
        share = 0.5 * (1.0 + (r - q) / np.where(distance > 0.0, distance, np.inf))[touching]
        points = packing.centers[pairs.first[touching]] + share[:, None] * pairs.vector[touching]
        firsts.append(first[touching])
        depths.append(packing.wall.depth(points))
    return Contacts(counts, np.concatenate(firsts), np.concatenate(depths))
