"""Published correlations for the porosity of beds of equal spheres in a tube, to hold packings against.

The mean porosity of the tube depends on A, tube over sphere diameter: the wall keeps spheres away. Each function is
named after its authors and gives their equation, nothing more; the equations were taken from works that quote them.
They differ by 0.02 to 0.03 in wide tubes and by more in narrow ones, as beds do that were poured, tapped or shaken:
docs/near_wall_structure.md sets them beside settled beds.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["benyahia_oneill", "cheng", "de_klerk_profile", "dixon", "foumeny", "zou_yu_loose"]

FloatArray = NDArray[np.float64]


def dixon(diameter_ratio: ArrayLike) -> FloatArray:
    """Mean porosity of spheres in a tube, 0.4 + 0.05/A + 0.412/A^2 (Dixon 1988).

    A. G. Dixon, Can. J. Chem. Eng. 66 (1988) 705-708; the branch for tubes of at least two spheres' width.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over sphere diameter, A >= 2.

    Returns
    -------
    float or array
        Porosity.

    Raises
    ------
    ValueError
        If A is less than 2 or not finite.
    """
    A = _at_least(2.0, diameter_ratio)
    return _plain(0.4 + 0.05 / A + 0.412 / A**2)


def foumeny(diameter_ratio: ArrayLike) -> FloatArray:
    """Mean porosity of spheres in a tube, 0.383 + 0.254 A^-0.923 (0.723 A - 1)^-0.5 (Foumeny et al. 1991).

    E. A. Foumeny, F. A. Moallemi, C. McGreavy, J. A. A. Castro, Can. J. Chem. Eng. 69 (1991) 1010-1015.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over sphere diameter; the equation is used here for A >= 2.

    Returns
    -------
    float or array
        Porosity.

    Raises
    ------
    ValueError
        If A is less than 2 or not finite.
    """
    A = _at_least(2.0, diameter_ratio)
    return _plain(0.383 + 0.254 * A**-0.923 / np.sqrt(0.723 * A - 1.0))


def zou_yu_loose(diameter_ratio: ArrayLike) -> FloatArray:
    """Mean porosity of loosely packed spheres in a tube (Zou and Yu 1995).

    R. P. Zou, A. B. Yu, Chem. Eng. Sci. 50 (1995) 1504-1507: 0.400 + 0.010 (exp(10.686/A) - 1) for A >= 3.95,
    0.846 - 1.898/A + 2.725/A^2 below. The branches meet within 0.001, which settled a factor and a sign that were
    misprinted where the equations are quoted.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over sphere diameter, at least 1.86 (1/0.538); narrower tubes hold regular packings.

    Returns
    -------
    float or array
        Porosity.

    Raises
    ------
    ValueError
        If A is too small or not finite.
    """
    A = _at_least(1.0 / 0.538, diameter_ratio)
    wide = 0.400 + 0.010 * np.expm1(10.686 / A)
    return _plain(np.where(A >= 3.95, wide, 0.846 - 1.898 / A + 2.725 / A**2))


def benyahia_oneill(diameter_ratio: ArrayLike) -> FloatArray:
    """Mean porosity of spheres in a tube, 0.390 + 1.740/(A + 1.140)^2 (Benyahia and O'Neill 2005).

    F. Benyahia, K. E. O'Neill, Part. Sci. Technol. 23 (2005) 169-177; average error 1.5 %.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over sphere diameter, 1.5 <= A <= 50.

    Returns
    -------
    float or array
        Porosity.

    Raises
    ------
    ValueError
        If A is less than 1.5 or not finite. Above 50 the equation is within 0.001 of its limit.
    """
    A = _at_least(1.5, diameter_ratio)
    return _plain(0.390 + 1.740 / (A + 1.140) ** 2)


def cheng(diameter_ratio: ArrayLike) -> FloatArray:
    """Mean porosity of spheres in a tube, from narrow to wide (Cheng 2011).

    N.-S. Cheng, Powder Technol. 210 (2011) 261-266: (e1^-3 + e2^-3)^(-1/3), e1 = 0.8 (A - 1)^0.27 in narrow tubes,
    e2 = 0.38 (1 + (A - 1)^-1.9) in wide ones.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over sphere diameter, A > 1.

    Returns
    -------
    float or array
        Porosity.

    Raises
    ------
    ValueError
        If A is not above 1, or not finite.
    """
    A = _at_least(np.nextafter(1.0, 2.0), diameter_ratio)
    narrow = 0.8 * (A - 1.0) ** 0.27
    wide = 0.38 * (1.0 + (A - 1.0) ** -1.9)
    return _plain((narrow**-3 + wide**-3) ** (-1.0 / 3.0))


def de_klerk_profile(depth: ArrayLike, bulk_porosity: float = 0.4) -> FloatArray:
    """Porosity against the distance from the wall (de Klerk 2003).

    A. de Klerk, AIChE J. 49 (2003) 2022-2029, with z the distance over the sphere diameter: 2.14 z^2 - 2.53 z + 1 up
    to z = 0.637, from there the bulk porosity + 0.29 exp(-0.6 z) cos(2.3 pi (z - 0.16)) + 0.15 exp(-0.9 z). The first
    minimum lies at z = 0.591; the period is 0.870, the decay length 1.67 diameters. The two parts meet where the
    bulk porosity is 0.361; else there is a step.

    Parameters
    ----------
    depth : float or array
        Distance from the wall over the sphere diameter, zero or more.
    bulk_porosity : float
        Porosity far from the wall.

    Returns
    -------
    float or array
        Porosity.

    Raises
    ------
    ValueError
        If a depth is negative or not finite, or the bulk porosity does not lie between 0 and 1.
    """
    z = np.asarray(depth, dtype=np.float64)
    if not (np.isfinite(z) & (z >= 0.0)).all():
        raise ValueError(f"depth is {_first(z, np.isfinite(z) & (z >= 0.0))}; expected a distance that is not negative")
    if not 0.0 < bulk_porosity < 1.0:
        raise ValueError(f"bulk_porosity is {bulk_porosity}; expected a number between 0 and 1")
    near = 2.14 * z**2 - 2.53 * z + 1.0
    swing = 0.29 * np.exp(-0.6 * z) * np.cos(2.3 * np.pi * (z - 0.16))
    return _plain(np.where(z <= 0.637, near, bulk_porosity + swing + 0.15 * np.exp(-0.9 * z)))


def _at_least(smallest: float, diameter_ratio: ArrayLike) -> FloatArray:
    A = np.asarray(diameter_ratio, dtype=np.float64)
    good = np.isfinite(A) & (smallest <= A)
    if not good.all():
        raise ValueError(f"diameter_ratio is {_first(A, good)}; expected a finite number from {smallest:.4g}")
    return A


def _first(values: FloatArray, good: NDArray[np.bool_]) -> float:
    """First value that is not good."""
    return float(np.atleast_1d(values)[~np.atleast_1d(good)][0])


def _plain(values: ArrayLike) -> FloatArray:
    """Return a number for a number and an array for an array."""
    result: FloatArray = np.asarray(values, dtype=np.float64)[()]
    return result
