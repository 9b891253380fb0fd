"""A half-space heated through a contact resistance, exactly and with both resistances in series.

The half-space starts cold at the time 0 and touches a wall of constant temperature through the coefficient `h_c`. All
depends on `B = h_c sqrt(alpha t)/k` (Carslaw and Jaeger 1959, section 2.7; Sullivan and Sabersky 1975). A plug that
flows past a heated wall sees the same with t = distance/velocity.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from bedrad.heat.ranges import FloatArray, non_negative, plain

__all__ = [
    "gain_over_series",
    "in_series_error",
    "local_half_space",
    "local_in_series",
    "mean_half_space",
    "mean_in_series",
]

_C: Final = 0.5 * math.sqrt(math.pi)

_POWERS: Final = np.arange(40)
_MEAN_COEFFICIENTS: Final = (-1.0) ** _POWERS / special.gamma(0.5 * _POWERS + 2.0)
"""Power series of `mean_half_space`, which the 40 terms give to rounding up to B = 1."""
_GAIN_COEFFICIENTS: Final = np.append(0.0, _MEAN_COEFFICIENTS[1:] + _C * _MEAN_COEFFICIENTS[:-1])


def mean_half_space(contact_number: ArrayLike) -> FloatArray:
    """Mean coefficient of a half-space behind a contact resistance: `[exp(B^2) erfc(B) - 1 + 2 B/sqrt(pi)]/B^2`.

    The exact solution for a plug (Carslaw and Jaeger 1959, section 2.7, integrated over the time of contact).

    Parameters
    ----------
    contact_number : float or array
        B = h_c sqrt(alpha t)/k, from 0 to infinity.

    Returns
    -------
    float or array
        h/h_c, from 1 to 0.

    Raises
    ------
    ValueError
        If B is negative.
    """
    B = _checked(contact_number)
    return plain((1.0 + gain_over_series(B)) / (1.0 + _C * B))


def local_half_space(contact_number: ArrayLike) -> FloatArray:
    """Local coefficient of a half-space behind a contact resistance, at the time t: `exp(B^2) erfc(B)`.

    Parameters
    ----------
    contact_number : float or array
        B = h_c sqrt(alpha t)/k, from 0 to infinity.

    Returns
    -------
    float or array
        h/h_c, from 1 to 0.

    Raises
    ------
    ValueError
        If B is negative.
    """
    return plain(special.erfcx(_checked(contact_number)))


def mean_in_series(contact_number: ArrayLike) -> FloatArray:
    """Mean coefficient with both resistances in series, `1/(1 + sqrt(pi) B/2)` (Watkins 2018, eq. 43).

    Parameters
    ----------
    contact_number : float or array
        B = h_c sqrt(alpha t)/k, from 0 to infinity.

    Returns
    -------
    float or array
        h/h_c.

    Raises
    ------
    ValueError
        If B is negative.
    """
    return plain(1.0 / (1.0 + _C * _checked(contact_number)))


def local_in_series(contact_number: ArrayLike) -> FloatArray:
    """Local coefficient that belongs to `mean_in_series`: `(1 + sqrt(pi) B/4)/(1 + sqrt(pi) B/2)^2`.

    Parameters
    ----------
    contact_number : float or array
        B = h_c sqrt(alpha t)/k, from 0 to infinity.

    Returns
    -------
    float or array
        h/h_c.

    Raises
    ------
    ValueError
        If B is negative.
    """
    mean = 1.0 / (1.0 + _C * _checked(contact_number))
    return plain(0.5 * mean * (1.0 + mean))


def in_series_error(contact_number: ArrayLike) -> FloatArray:
    """Error of eq. 43 against the exact mean coefficient: `mean_in_series/mean_half_space - 1`.

    Never positive; -4.764 % at worst, at B = 1.371. A property of the form, not of the computation.

    Parameters
    ----------
    contact_number : float or array
        B = h_c sqrt(alpha t)/k, from 0 to infinity.

    Returns
    -------
    float or array
        Relative error.

    Raises
    ------
    ValueError
        If B is negative.
    """
    gain = gain_over_series(contact_number)
    return plain(-gain / (1.0 + gain))


def _checked(contact_number: ArrayLike) -> FloatArray:
    B = np.asarray(contact_number, dtype=np.float64)
    non_negative("contact_number", np.where(np.isposinf(B), 0.0, B))
    return B


def gain_over_series(contact_number: ArrayLike) -> FloatArray:
    """Exact mean coefficient over that of the resistances in series, less 1: never negative, at most 0.0500.

    Written so that neither it nor anything made of it cancels: by its power series up to B = 1, and beyond as
    `[(1/C - C) + C e - (1 - e)/B]/B` with e = exp(B^2) erfc(B) and C = sqrt(pi)/2.

    Parameters
    ----------
    contact_number : float or array
        B = h_c sqrt(alpha t)/k, from 0 to infinity.

    Returns
    -------
    float or array
        `mean_half_space/mean_in_series - 1`; 0.134 B for small B, 0.242/B for large.

    Raises
    ------
    ValueError
        If B is negative.
    """
    B = _checked(contact_number)
    short = B < 1.0
    series = np.polynomial.polynomial.polyval(np.where(short, B, 0.0), _GAIN_COEFFICIENTS)
    long = np.where(short, 1.0, B)
    e = special.erfcx(long)
    return plain(np.where(short, series, ((1.0 / _C - _C) + _C * e - (1.0 - e) / long) / long))
