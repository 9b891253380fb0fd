"""Air across a single tube: the correlations with which Nguyen (2015) checks his apparatus.

All give the mean Nusselt number of a tube, h D/k, for the Reynolds number of the free velocity and the tube's outer
diameter.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside

__all__ = [
    "ashrae_tube",
    "checked_constants",
    "churchill_bernstein_tube",
    "hilpert_tube",
    "zhukauskas_tube",
]

# upper ends of the segments in Re, and C and m in each (Incropera and DeWitt 2002, Tables 7.2 and 7.4)
_Segments = tuple[tuple[float, ...], tuple[tuple[float, float], ...]]
_HILPERT: _Segments = (
    (0.4, 4.0, 40.0, 4000.0, 40000.0, 400000.0),
    ((0.989, 0.330), (0.911, 0.385), (0.683, 0.466), (0.193, 0.618), (0.027, 0.805)),
)
_ZHUKAUSKAS: _Segments = (
    (1.0, 40.0, 1000.0, 2e5, 1e6),
    ((0.75, 0.4), (0.51, 0.5), (0.26, 0.6), (0.076, 0.7)),
)


def _segment_power(
    name: str, reynolds: FloatArray, segments: _Segments, constants: tuple[float, float] | None
) -> FloatArray:
    """C Re^m by segments of Re, or with the constants given, whose segment is then the range if the table has them."""
    limits, table = segments
    if constants is None:
        warn_outside(f"{name}: Reynolds number", reynolds, limits[0], limits[-1])
        segment = np.searchsorted(limits[1:-1], reynolds, side="right")
        C, m = np.moveaxis(np.asarray(table)[segment], -1, 0)
        return np.asarray(C * reynolds**m)
    constants = checked_constants(constants)
    if constants in table:
        i = table.index(constants)
        what = f"{name} with C = {constants[0]:g}, m = {constants[1]:g}: Reynolds number"
        warn_outside(what, reynolds, limits[i], limits[i + 1])
    return np.asarray(constants[0] * reynolds ** constants[1])


def checked_constants(constants: ArrayLike) -> tuple[float, float]:
    """C and m of C Re^m, refused unless they are two positive numbers."""
    values = positive("constants", constants)
    if values.shape != (2,):
        raise ValueError(f"constants has shape {values.shape}; expected two numbers, C and m")
    return float(values[0]), float(values[1])


def hilpert_tube(reynolds: ArrayLike, prandtl: ArrayLike, constants: tuple[float, float] | None = None) -> FloatArray:
    """Nusselt number of a tube in cross flow, Nu = C Re^m Pr^(1/3) (Hilpert 1933; Nguyen 2015, Table 1).

    Parameters
    ----------
    reynolds, prandtl : float or array
        Reynolds number of the free velocity, and Prandtl number.
    constants : (C, m), optional
        Constants to use at every Reynolds number, in place of those of the segment that it lies in; Nguyen (2015)
        takes (0.683, 0.466), the segment up to 4000, at Reynolds numbers a little above it.

    Returns
    -------
    float or array
        Nusselt number.

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Outside 0.4 < Re < 400000, or outside the segment of the constants given.
    """
    Re, Pr = positive("reynolds", reynolds), positive("prandtl", prandtl)
    return plain(_segment_power("hilpert_tube (Hilpert 1933)", Re, _HILPERT, constants) * Pr ** (1.0 / 3.0))


def ashrae_tube(reynolds: ArrayLike) -> FloatArray:
    """Nusselt number of a tube in air, Nu = 0.24 Re^0.6 (ASHRAE 1977; Nguyen 2015, Table 1).

    Parameters
    ----------
    reynolds : float or array
        Reynolds number of the free velocity, G D/mu.

    Returns
    -------
    float or array
        Nusselt number.

    Raises
    ------
    ValueError
        If a Reynolds number is not positive.

    Warns
    -----
    RangeWarning
        Outside 1000 < Re < 50000.
    """
    Re = positive("reynolds", reynolds)
    warn_outside("ashrae_tube (ASHRAE 1977): Reynolds number", Re, 1000.0, 50000.0)
    return plain(0.24 * Re**0.6)


def churchill_bernstein_tube(reynolds: ArrayLike, prandtl: ArrayLike) -> FloatArray:
    """Nusselt number of a tube in cross flow (Churchill and Bernstein 1977; Nguyen 2015, Table 5).

    Nu = 0.3 + 0.62 Re^(1/2) Pr^(1/3)/(1 + (0.4/Pr)^(2/3))^(1/4) (1 + (Re/282000)^(5/8))^(4/5).

    Parameters
    ----------
    reynolds, prandtl : float or array
        Reynolds number of the free velocity, and Prandtl number.

    Returns
    -------
    float or array
        Nusselt number.

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Where Re Pr is below 0.2.
    """
    Re, Pr = positive("reynolds", reynolds), positive("prandtl", prandtl)
    warn_outside("churchill_bernstein_tube (Churchill and Bernstein 1977): Re Pr", Re * Pr, 0.2, np.inf)
    laminar = 0.62 * np.sqrt(Re) * Pr ** (1.0 / 3.0) / (1.0 + (0.4 / Pr) ** (2.0 / 3.0)) ** 0.25
    return plain(0.3 + laminar * (1.0 + (Re / 282000.0) ** 0.625) ** 0.8)


def zhukauskas_tube(
    reynolds: ArrayLike,
    prandtl: ArrayLike,
    surface_prandtl: ArrayLike,
    constants: tuple[float, float] | None = None,
) -> FloatArray:
    """Nusselt number of a tube in cross flow (Zhukauskas 1972; Nguyen 2015, Table 1).

    Nu = C Re^m Pr^n (Pr/Pr_s)^(1/4), n = 0.37 up to Pr = 10 and 0.36 above.

    Parameters
    ----------
    reynolds, prandtl : float or array
        Reynolds number of the free velocity, and Prandtl number of the free stream.
    surface_prandtl : float or array
        Prandtl number at the temperature of the surface.
    constants : (C, m), optional
        Constants to use at every Reynolds number, in place of those of the segment that it lies in; Nguyen (2015)
        prints (0.51, 0.5), which hold from 40 to 1000, for all.

    Returns
    -------
    float or array
        Nusselt number.

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Outside 1 < Re < 1e6 or 0.7 < Pr < 500, or outside the segment of the constants given.
    """
    Re, Pr, Pr_s = (
        positive("reynolds", reynolds),
        positive("prandtl", prandtl),
        positive("surface_prandtl", surface_prandtl),
    )
    name = "zhukauskas_tube (Zhukauskas 1972)"
    warn_outside(f"{name}: Prandtl number", Pr, 0.7, 500.0)
    power = _segment_power(name, Re, _ZHUKAUSKAS, constants)
    return plain(power * Pr ** np.where(Pr <= 10.0, 0.37, 0.36) * (Pr / Pr_s) ** 0.25)
