"""Heat conduction from a flat wall through the gas into one particle (Watkins 2018, eq. 32-37, 42).

The heat is taken to run straight from the wall through gas and particle to the plane one particle radius
away. All three functions are written in `x = 1 - 1/K`, which turns the 0/0 of the printed forms at K = 1 into
sums of positive terms that hold to rounding for every K > 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, within

__all__ = ["NC_DISTANCE", "contact_factor", "no_contact_factor", "particle_conductivity"]

NC_DISTANCE = 0.22
"""Distance of the no-contact particles from the wall that Watkins takes as constant, in particle radii."""

_SERIES_BELOW = 0.1
_SERIES_TERMS = 18


def _logarithm(K: FloatArray, a: FloatArray, y: FloatArray) -> FloatArray:
    """-ln(1 - y) with y = (1-a)(1 - 1/K), without loss of digits for y near 0 nor near 1."""
    near = np.abs(y) < 0.5
    # 1 - y = (1-a)/K + a: for large K the difference 1 - y itself would keep few digits
    return np.asarray(-np.where(near, np.log1p(-np.where(near, y, 0.0)), np.log((1.0 - a) / K + a)))


def _terms(K: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray]:
    """`S1 = -ln(1-y)/y` and `S2 = (-ln(1-y)-y)/y^2` with y = (1-a)(1 - 1/K)."""
    y = np.asarray((1.0 - a) * ((K - 1.0) / K))
    logarithm = _logarithm(K, a, y)
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
    first, second = _terms(K, a)
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
