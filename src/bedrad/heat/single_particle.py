"""Heat conduction from a flat wall through the gas into one particle (Watkins 2018, eq. 32-37, 42).

The heat is taken to run straight from the wall through gas and particle to the plane one particle radius
away. The functions are written in `x = 1 - 1/K`, which turns the 0/0 of the printed forms at K = 1 into
sums of positive terms that hold to rounding for every K > 0.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within

__all__ = [
    "NC_DISTANCE",
    "contact_factor",
    "cut_particle",
    "logarithm_terms",
    "no_contact_factor",
    "particle_conductivity",
]

NC_DISTANCE = 0.22
"""Distance of the no-contact particles from the wall that Watkins takes as constant, in particle radii."""

_SERIES_BELOW = 0.1
_SERIES_TERMS = 18


def logarithm_terms(y: FloatArray, rest: FloatArray) -> tuple[FloatArray, FloatArray]:
    """`-ln(1-y)/y` and `(-ln(1-y)-y)/y^2`, given y and 1 - y, each to full relative accuracy."""
    near = np.abs(y) < 0.5
    logarithm = -np.where(near, np.log1p(-np.where(near, y, 0.0)), np.log(rest))
    small = np.abs(y) < _SERIES_BELOW
    safe = np.where(small, 1.0, y)
    series = np.zeros_like(y)
    power_argument = np.where(small, y, 0.0)
    for n in range(_SERIES_TERMS + 1, 1, -1):
        series = series * power_argument + 1.0 / n
    second = np.where(small, series, (logarithm - y) / (safe * safe))
    first = np.where(small, 1.0 + y * series, logarithm / safe)
    return first, second


def _factor(K: FloatArray, a: FloatArray) -> FloatArray:
    """Phi_NC / (1 - a), which stays finite as a -> 1."""
    y = np.asarray((1.0 - a) * ((K - 1.0) / K))
    # 1 - y = (1-a)/K + a: for large K the difference 1 - y itself would keep few digits
    first, second = logarithm_terms(y, np.asarray((1.0 - a) / K + a))
    return np.asarray((1.0 - a) * second + a * first)


def _arguments(K: ArrayLike, a: ArrayLike) -> tuple[FloatArray, FloatArray]:
    ratio, distance = np.broadcast_arrays(
        positive("K (solid over gas conductivity)", K), within("a (distance in particle radii)", a, 0.0, 1.0)
    )
    return ratio, distance


def contact_factor(K: ArrayLike) -> FloatArray:
    """Phi_C of a particle that touches the wall (Watkins 2018, eq. 36).

    Parameters
    ----------
    K : float or array
        Solid over gas conductivity, k_s/k_g.

    Returns
    -------
    float or array
        Phi_C; `2 Phi_C` is the conductivity of the cylinder of one particle radius below the particle over
        k_g.

    Raises
    ------
    ValueError
        If K is not positive and finite.
    """
    ratio, distance = _arguments(K, 0.0)
    return plain(_factor(ratio, distance))


def no_contact_factor(K: ArrayLike, a: ArrayLike = NC_DISTANCE) -> FloatArray:
    """Phi_NC of a particle at a distance from the wall (Watkins 2018, eq. 37; eq. 42 for a = 0.22).

    Parameters
    ----------
    K : float or array
        Solid over gas conductivity, k_s/k_g.
    a : float or array
        Gap between wall and particle surface, in particle radii, from 0 (contact) to 1.

    Returns
    -------
    float or array
        Phi_NC.

    Raises
    ------
    ValueError
        If K is not positive and finite, or a not from 0 to 1.
    """
    ratio, distance = _arguments(K, a)
    return plain((1.0 - distance) * _factor(ratio, distance))


def particle_conductivity(K: ArrayLike, a: ArrayLike = 0.0) -> FloatArray:
    """Conductivity of gas and particle in the wall layer over k_g, flat wall (Watkins 2018, eq. 34).

    Parameters
    ----------
    K : float or array
        Solid over gas conductivity, k_s/k_g.
    a : float or array
        Gap between wall and particle surface, in particle radii, from 0 (contact) to 1.

    Returns
    -------
    float or array
        k_particle/k_g, averaged over the wall area that the part of the particle inside the layer covers.

    Raises
    ------
    ValueError
        If K is not positive and finite, or a not from 0 to 1.
    """
    ratio, distance = _arguments(K, a)
    return plain(2.0 * _factor(ratio, distance) / (1.0 + distance))


def _columns(p: FloatArray, q: FloatArray, start: FloatArray, width: FloatArray, last: FloatArray) -> FloatArray:
    """Integral of u/(p - q (u - start)) over u from start to start + width; `last` is the denominator at the end."""
    # written with both ends given, so that neither q = 0 nor a contact (last = 1/K) loses digits
    first, second = logarithm_terms(np.asarray(q * width / p), np.asarray(last / p))
    return np.asarray(width / p * (start * first + width * second))


def cut_particle(
    K: ArrayLike, nc_distance: ArrayLike = 0.0, layer_depth: ArrayLike = 1.0
) -> tuple[FloatArray, FloatArray]:
    """Covered area and conductivity of a particle in a layer of any depth at a flat wall.

    The integral of Watkins 2018, eq. 32-34, carried to a depth other than one radius of the particle: where the layer
    ends below the centre of the particle, there is gas again behind its edge.

    Parameters
    ----------
    K : float or array
        Solid over gas conductivity, k_s/k_g.
    nc_distance : float or array
        Gap between wall and particle surface, in radii of this particle, from 0 to the depth of the layer.
    layer_depth : float or array
        Depth of the wall layer, in radii of this particle.

    Returns
    -------
    (area, conductivity) : floats or arrays
        Area in particle radii squared, and k_particle/k_g averaged over it; eq. 34 for a depth of 1.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    ratio = positive("K (solid over gas conductivity)", K)
    depth = positive("layer_depth", layer_depth, "particle radii")
    a = non_negative("nc_distance", nc_distance, "particle radii")
    if np.any(a > depth):
        raise ValueError(f"nc_distance is {float(np.max(a)):g} particle radii; expected at most layer_depth")
    ratio, a, depth = np.broadcast_arrays(ratio, a, depth)
    x = (ratio - 1.0) / ratio
    cap = np.minimum(depth - a, 2.0)
    # what of the particle lies beyond the layer, or of the layer beyond the particle, to full accuracy
    beyond = (2.0 - depth) + a
    behind = np.maximum(-beyond, 0.0)
    # u is the cosine at the surface; columns with u below `turn` leave the particle again before the layer ends
    turn = np.clip(cap - 1.0, 0.0, 1.0)
    start = np.where(cap < 1.0, 1.0 - cap, turn)
    at_turn = np.where(cap < 1.0, depth, a + np.abs(beyond)) + 2.0 * turn / ratio
    through = _columns(depth, 2.0 * x, np.zeros_like(turn), turn, at_turn)
    ends = _columns(at_turn, x, start, np.where(cap < 1.0, cap, np.maximum(beyond, 0.0)), a + behind + cap / ratio)
    covered = np.where(cap < 1.0, cap * (2.0 - cap), 1.0)
    # at the edge of the layer (cap 0) nothing is covered, and gas is all there is
    total = np.divide(2.0 * depth * (ends + through), covered, out=np.ones_like(covered), where=covered > 0.0)
    return plain(math.pi * covered), plain(total)
