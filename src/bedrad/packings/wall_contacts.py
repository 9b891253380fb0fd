"""Contacts with the wall, the distance of particles that have none, and what overlapping spheres share.

The gap of a sphere is its depth minus its radius, here always in units of its own radius. A contact of soft
spheres is an overlap; a contact in a list of positions is a gap below a tolerance, and the count depends on
that tolerance.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from bedrad.packings.layers import whole_volumes
from bedrad.packings.overlaps import pair_overlaps
from bedrad.packings.packing import Packing
from bedrad.walls import Plate, Tube, Wall

__all__ = ["closing_distance", "hexagonal_maximum", "overlap_share", "particle_volume", "wall_gaps"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def wall_gaps(packing: Packing) -> FloatArray:
    """Gap between every sphere and the wall, in its own radii; negative where it overlaps the wall."""
    return (packing.depths - packing.radii) / packing.radii


def hexagonal_maximum(wall: Wall, radius: float) -> float:
    """Wall contacts per wall area of an ideal hexagonal layer against the wall (Watkins 2018, eq. 39).

    The centres of a touching layer lie on a cylinder of radius R - r in a tube and R + r around a rod, each
    sphere taking 2 sqrt(3) r^2 of that surface; per wall area this is (1 -+ 1/A)/(2 sqrt(3) r^2) with A =
    R/r. The publication gives the tube; the rod and the plate (A infinite) follow in the same way.

    Parameters
    ----------
    wall : Tube, Rod or Plate
        The wall.
    radius : float
        Sphere radius. [m]

    Returns
    -------
    float
        [1/m2]
    """
    flat = 1.0 / (2.0 * math.sqrt(3.0) * radius * radius)
    if isinstance(wall, Plate):
        return flat
    inward = -1.0 if isinstance(wall, Tube) else 1.0
    return flat * max(0.0, 1.0 + inward * radius / wall.radius)


def particle_volume(wall: Wall, radius: float, gap: float, thickness: float) -> float:
    """Volume that one sphere at a gap (in radii) from the wall has in the layer of the given thickness. [m3]

    For a tube this is Watkins 2018, eq. 88, whose print lacks `dr` and a factor 2 in the denominator.
    """
    depth = radius * (1.0 + gap)
    if isinstance(wall, Plate):
        center = (0.0, 0.0, depth)
    else:
        center = (wall.radius + (-depth if isinstance(wall, Tube) else depth), 0.0, 0.0)
    volumes = whole_volumes(wall, np.array([center]), np.array([radius]), np.array([0.0, thickness]))
    return float(volumes[0, 0])


def closing_distance(
    wall: Wall, radius: float, thickness: float, solid: float, contacts: float, no_contacts: float
) -> float:
    """Gap `a` of the no-contact particles that closes the wall layer's solid volume (Watkins 2018, eq. 31).

    All particles have one radius; those in contact touch the wall at a point, and all others share one gap.

    Parameters
    ----------
    wall : Tube, Rod or Plate
        The wall.
    radius, thickness : float
        Sphere radius and thickness of the wall layer. [m]
    solid : float
        Solid volume in the wall layer per wall area. [m]
    contacts, no_contacts : float
        Particles with and without contact per wall area. [1/m2]

    Returns
    -------
    float
        The gap in radii; nan where there are no such particles, or no gap closes the balance.
    """
    if no_contacts <= 0.0:
        return math.nan
    each = (solid - contacts * particle_volume(wall, radius, 0.0, thickness)) / no_contacts
    largest = min(thickness, wall.largest_depth - radius) / radius

    def excess(gap: float) -> float:
        return (particle_volume(wall, radius, gap, thickness) - each) / radius**3

    if largest <= 0.0 or excess(0.0) < 0.0 or excess(largest) > 0.0:
        return math.nan
    return float(brentq(excess, 0.0, largest, xtol=1e-13, rtol=1e-13))


def overlap_share(packing: Packing, counted: BoolArray, near: BoolArray) -> float:
    """Volume counted twice where spheres overlap each other, as a share of the volume of the counted spheres.

    Parameters
    ----------
    packing : Packing
        The spheres.
    counted : (n,) array of bool
        The spheres whose volume is counted. A pair of which one is counted enters with half its common
        volume.
    near : (n,) array of bool
        The spheres that are looked at as partners; includes the counted ones.

    Returns
    -------
    float
        The share; 0 where nothing is counted. Places where three spheres overlap are not treated apart.
    """
    spheres = np.flatnonzero(near)
    volume = 4.0 / 3.0 * math.pi * float((packing.radii[counted] ** 3).sum())
    if volume == 0.0:
        return 0.0
    radii = packing.radii[spheres]
    first, second, depth = pair_overlaps(packing.centers[spheres], radii, packing.box)
    members = 0.5 * (counted[spheres[first]].astype(float) + counted[spheres[second]])
    return float((members * _common_volume(radii[first], radii[second], depth)).sum()) / volume


def _common_volume(first: FloatArray, second: FloatArray, depth: FloatArray) -> FloatArray:
    """Volume common to pairs of spheres that overlap by `depth`. [m3]"""
    small, large = np.minimum(first, second), np.maximum(first, second)
    distance = np.maximum(first + second - depth, 0.0)
    swallowed = distance <= large - small
    apart = np.where(swallowed, 1.0, distance)
    # depth^2 (d^2 + 2 d (r1 + r2) - 3 (r1 - r2)^2)/(12 d): the two caps, with no difference of large terms
    lens = math.pi * depth**2 * (apart**2 + 2.0 * apart * (small + large) - 3.0 * (large - small) ** 2)
    return np.where(swallowed, 4.0 / 3.0 * math.pi * small**3, lens / (12.0 * apart))
