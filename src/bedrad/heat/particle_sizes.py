"""Mean diameters of particles of unequal size (Nguyen 2015, section 3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = ["SIEVE_OPENINGS", "sauter_diameter", "sieve_sauter_diameter"]

SIEVE_OPENINGS = {
    18: 1.00e-3,
    20: 0.850e-3,
    25: 0.710e-3,
    30: 0.600e-3,
    35: 0.500e-3,
    40: 0.425e-3,
    45: 0.355e-3,
    50: 0.300e-3,
    60: 0.250e-3,
    70: 0.212e-3,
    80: 0.180e-3,
    100: 0.150e-3,
    120: 0.125e-3,
    140: 0.106e-3,
}
"""Openings of sieves by their number (ASTM E11). [m]"""


def sauter_diameter(diameters: ArrayLike, masses: ArrayLike) -> FloatArray:
    """Sauter mean diameter, of the sphere with the ratio of volume to surface of all (Nguyen 2015, eq. 3-2).

    d_32 = sum(w)/sum(w/d) with the masses w. The ratio of volume to surface itself is d_32/6 (eq. 3-1).

    Parameters
    ----------
    diameters : (..., n) array
        Diameter of each class of particles. [m]
    masses : (..., n) array
        Mass, or share of the mass, of each class, in any unit: they need not add up to one.

    Returns
    -------
    float or (...) array
        Sauter mean diameter. [m]

    Raises
    ------
    ValueError
        If a diameter is not positive, a mass is negative, or a distribution has no mass.
    """
    d, w = np.broadcast_arrays(
        np.atleast_1d(positive("diameters", diameters, "m")), np.atleast_1d(non_negative("masses", masses))
    )
    total = positive("sum of the masses", w.sum(axis=-1))
    return plain(total / np.sum(w / d, axis=-1))


def sieve_sauter_diameter(openings: ArrayLike, masses: ArrayLike) -> FloatArray:
    """Sauter mean diameter of a sieved sample, each class at the mean of the two openings that bound it.

    Parameters
    ----------
    openings : (n + 1,) array
        Openings from the coarsest to the finest sieve, or the other way: class i lies between openings i and i + 1.
        What the finest sieve lets through needs a bound of its own. [m]
    masses : (..., n) array
        Mass, or share of the mass, of each class, in any unit.

    Returns
    -------
    float or (...) array
        Sauter mean diameter. [m]

    Raises
    ------
    ValueError
        If the openings are not positive and in order, there is not one more of them than classes, a mass is
        negative, or a distribution has no mass.
    """
    bounds = positive("openings", openings, "m")
    w = np.atleast_1d(non_negative("masses", masses))
    if bounds.ndim != 1 or bounds.size != w.shape[-1] + 1:
        raise ValueError(
            f"openings has shape {bounds.shape} for {w.shape[-1]} masses; expected {w.shape[-1] + 1} openings"
        )
    steps = np.diff(bounds)
    if not (np.all(steps < 0.0) or np.all(steps > 0.0)):
        raise ValueError("openings are out of order; expected them from the coarsest to the finest or the other way")
    return sauter_diameter(0.5 * (bounds[1:] + bounds[:-1]), w)
