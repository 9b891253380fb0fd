"""How hexagonal the particles lie that touch the wall, on the wall unrolled into a plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.neighbours import close_pairs
from bedrad.packings.packing import Packing
from bedrad.walls import Plate, Tube

__all__ = ["FIRST_SHELL", "WallOrder", "wall_order"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

FIRST_SHELL = 0.5 * (1.0 + 3.0**0.5)
"""Reach of the first shell over the sum of two radii: midway between the first and second of a hexagonal layer."""


@dataclass(frozen=True)
class WallOrder:
    """Order of every sphere of a packing; zero for those that do not touch the wall.

    Attributes
    ----------
    order : (n,) array
        Bond-orientational order |psi_6|, from 0 to 1.
    neighbours : (n,) array
        Number of touching spheres in the first shell.
    """

    order: FloatArray
    neighbours: IntArray


def wall_order(packing: Packing, touching: BoolArray) -> WallOrder:
    """Bond-orientational order of the particles that touch the wall.

    The centres are unrolled: along the axis, and around it by the arc at the mean distance of the two centres from
    the axis. Neighbours are touching particles no further apart there than `FIRST_SHELL` times the sum of their
    radii. With theta the angle of the line to a neighbour, psi_6 = sum(exp(6 i theta))/N over the N neighbours; a
    particle with one neighbour or none has no order, 0. A hexagonal layer has 1, a square one, whose four
    neighbours cancel, 0.

    Parameters
    ----------
    packing : Packing
        The spheres.
    touching : (n,) array of bool
        The spheres that touch the wall.

    Returns
    -------
    WallOrder
        Order and number of neighbours of every sphere.
    """
    spheres = np.flatnonzero(touching)
    total = np.zeros(len(packing), dtype=complex)
    neighbours = np.zeros(len(packing), dtype=np.int64)
    # no chord is longer than its arc
    for pairs in close_pairs(packing, spheres, spheres, FIRST_SHELL):
        along, across = _unrolled(packing, pairs.first, pairs.vector)
        reach = FIRST_SHELL * (packing.radii[pairs.first] + packing.radii[pairs.second])
        near = np.hypot(along, across) <= reach
        first = pairs.first[near]
        bond = np.exp(6j * np.arctan2(along[near], across[near]))
        neighbours += np.bincount(first, minlength=len(packing))
        total += np.bincount(first, weights=bond.real, minlength=len(packing))
        total += 1j * np.bincount(first, weights=bond.imag, minlength=len(packing))
    order = np.where(neighbours > 1, np.abs(total) / np.maximum(neighbours, 1), 0.0)
    return WallOrder(order, neighbours)


def _unrolled(packing: Packing, first: IntArray, vector: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lengths of vectors between centres along the wall's axis and across it, on the unrolled wall. [m]"""
    wall = packing.wall
    along = vector[:, wall.axial]
    if isinstance(wall, Plate):
        return along, vector[:, 1]
    start = packing.centers[first, :2]
    end = start + vector[:, :2]
    inward = -1.0 if isinstance(wall, Tube) else 1.0
    depths = wall.depth(np.stack([start, end]))
    radial = wall.radius + inward * depths.mean(axis=0)
    turned = np.arctan2(start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0], np.einsum("ij,ij->i", start, end))
    return along, radial * turned
