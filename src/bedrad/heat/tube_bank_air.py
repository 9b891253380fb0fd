"""Air across a staggered or aligned tube bank: the correlations with which Nguyen (2015) checks his apparatus.

All give the mean Nusselt number of a tube, h D/k, for the Reynolds number of the largest velocity between the tubes
(`maximum_velocity`) and the tube's outer diameter.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside, within
from bedrad.heat.tube_bank_single import checked_constants

__all__ = [
    "BankArrangement",
    "colburn_bank",
    "grimison_bank",
    "grimison_constants",
    "maximum_velocity",
    "zhukauskas_bank",
]

BankArrangement = Literal["staggered", "aligned"]

# rows and factors of banks with few rows (Incropera and DeWitt 2002, Tables 7.6 and 7.8)
_GRIMISON_ROWS = {
    "staggered": (0.68, 0.75, 0.83, 0.89, 0.92, 0.95, 0.97, 0.98, 0.99, 1.0),
    "aligned": (0.64, 0.80, 0.87, 0.90, 0.92, 0.94, 0.96, 0.98, 0.99, 1.0),
}
_ZHUKAUSKAS_ROW_NUMBERS = (1, 2, 3, 4, 5, 7, 10, 13, 16, 20)
_ZHUKAUSKAS_ROWS = {
    "staggered": (0.64, 0.76, 0.84, 0.89, 0.92, 0.95, 0.97, 0.98, 0.99, 1.0),
    "aligned": (0.70, 0.80, 0.86, 0.90, 0.92, 0.95, 0.97, 0.98, 0.99, 1.0),
}

# for each transverse pitch over D: the longitudinal ones, C and m (Grimison 1937; Incropera and DeWitt 2002, Table 7.5)
_PITCHES = (1.25, 1.5, 2.0, 3.0)
_Column = tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]
_GRIMISON: dict[str, dict[float, _Column]] = {
    "staggered": {
        1.25: (_PITCHES, (0.518, 0.451, 0.404, 0.310), (0.556, 0.568, 0.572, 0.592)),
        1.5: ((1.0, *_PITCHES), (0.497, 0.505, 0.460, 0.416, 0.356), (0.558, 0.554, 0.562, 0.568, 0.580)),
        2.0: (
            (0.9, 1.125, *_PITCHES),
            (0.446, 0.478, 0.519, 0.452, 0.482, 0.440),
            (0.571, 0.565, 0.556, 0.568, 0.556, 0.562),
        ),
        3.0: (
            (0.6, 0.9, 1.125, *_PITCHES),
            (0.213, 0.401, 0.518, 0.522, 0.488, 0.449, 0.428),
            (0.636, 0.581, 0.560, 0.562, 0.568, 0.570, 0.574),
        ),
    },
    "aligned": {
        1.25: (_PITCHES, (0.348, 0.367, 0.418, 0.290), (0.592, 0.586, 0.570, 0.601)),
        1.5: (_PITCHES, (0.275, 0.250, 0.299, 0.357), (0.608, 0.620, 0.602, 0.584)),
        2.0: (_PITCHES, (0.100, 0.101, 0.229, 0.374), (0.704, 0.702, 0.632, 0.581)),
        3.0: (_PITCHES, (0.0633, 0.0678, 0.198, 0.286), (0.752, 0.744, 0.648, 0.608)),
    },
}


def _check_arrangement(arrangement: str) -> None:
    if arrangement not in ("staggered", "aligned"):
        raise ValueError(f"arrangement is {arrangement!r}; expected 'staggered' or 'aligned'")


def maximum_velocity(
    velocity: ArrayLike,
    diameter: ArrayLike,
    transverse_pitch: ArrayLike,
    longitudinal_pitch: ArrayLike,
    arrangement: BankArrangement = "staggered",
) -> FloatArray:
    """Largest velocity between the tubes of a bank (Incropera and DeWitt 2002, eq. 7.62 and 7.63).

    Parameters
    ----------
    velocity : float or array
        Velocity ahead of the bank. [m/s]
    diameter, transverse_pitch, longitudinal_pitch : float or array
        Outer diameter of the tubes and their distances across and along the flow. [m]
    arrangement : {"staggered", "aligned"}
        The gap between two tubes of a row, or, if staggered, the two gaps to the next row if those are narrower.

    Returns
    -------
    float or array
        Velocity in the narrowest gap. [m/s]

    Raises
    ------
    ValueError
        If an input is not positive or the tubes overlap.
    """
    _check_arrangement(arrangement)
    U, D = positive("velocity", velocity, "m/s"), positive("diameter", diameter, "m")
    across = positive("transverse_pitch", transverse_pitch, "m")
    along = positive("longitudinal_pitch", longitudinal_pitch, "m")
    gap = np.asarray(across - D)
    if arrangement == "staggered":
        gap = np.minimum(gap, 2.0 * (np.hypot(along, 0.5 * across) - D))
    if np.any(gap <= 0.0):
        raise ValueError(
            f"the gap between the tubes is {float(np.min(gap)):g} m; expected pitches with room between them"
        )
    return plain(U * across / gap)


def colburn_bank(maximum_reynolds: ArrayLike, prandtl: ArrayLike) -> FloatArray:
    """Nusselt number of a staggered bank, Nu = 0.33 Re_max^0.6 Pr^(1/3) (Colburn 1933; Nguyen 2015, eq. 2-4).

    For ten rows or more and turbulent flow; the source gives no limits of the Reynolds number, and none are checked.

    Parameters
    ----------
    maximum_reynolds, prandtl : float or array
        Reynolds number of the largest velocity, G_max D/mu, and Prandtl number.

    Returns
    -------
    float or array
        Nusselt number.

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    Re, Pr = positive("maximum_reynolds", maximum_reynolds), positive("prandtl", prandtl)
    return plain(0.33 * Re**0.6 * Pr ** (1.0 / 3.0))


def zhukauskas_bank(
    maximum_reynolds: ArrayLike,
    prandtl: ArrayLike,
    surface_prandtl: ArrayLike,
    pitch_ratio: ArrayLike,
    rows: ArrayLike = 20,
    arrangement: BankArrangement = "staggered",
) -> FloatArray:
    """Nusselt number of a tube bank (Zhukauskas 1972; Nguyen 2015, eq. 2-3).

    Nu = C_2 C Re_max^m Pr^0.36 (Pr/Pr_s)^(1/4), with C and m of Incropera and DeWitt (2002), Table 7.7.

    Parameters
    ----------
    maximum_reynolds, prandtl : float or array
        Reynolds number of the largest velocity, and Prandtl number at the mean of inlet and outlet.
    surface_prandtl : float or array
        Prandtl number at the temperature of the surface.
    pitch_ratio : float or array
        Transverse over longitudinal pitch.
    rows : float or array
        Number of rows, for the factor C_2 below 20 rows, linear between those tabulated.
    arrangement : {"staggered", "aligned"}
        Arrangement of the tubes.

    Returns
    -------
    float or array
        Nusselt number.

    Raises
    ------
    ValueError
        If an input is not positive, or there is less than one row.

    Warns
    -----
    RangeWarning
        Outside 1000 < Re_max < 2e6 or 0.7 < Pr < 500, or aligned tubes with a pitch ratio below 0.7.
    """
    _check_arrangement(arrangement)
    Re, Pr, Pr_s = (
        positive("maximum_reynolds", maximum_reynolds),
        positive("prandtl", prandtl),
        positive("surface_prandtl", surface_prandtl),
    )
    ratio = positive("pitch_ratio", pitch_ratio)
    number = within("rows", rows, 1.0, np.inf)
    name = "zhukauskas_bank (Zhukauskas 1972)"
    warn_outside(f"{name}: Reynolds number", Re, 1000.0, 2e6)
    warn_outside(f"{name}: Prandtl number", Pr, 0.7, 500.0)
    if arrangement == "staggered":
        moderate, high = np.where(ratio < 2.0, 0.35 * ratio**0.2, 0.40) * Re**0.60, 0.022 * Re**0.84
    else:
        warn_outside(f"{name}, aligned: pitch ratio", ratio, 0.7, np.inf)
        moderate, high = 0.27 * Re**0.63, 0.021 * Re**0.84
    power = np.where(Re < 2e5, moderate, high)
    few = np.interp(number, _ZHUKAUSKAS_ROW_NUMBERS, _ZHUKAUSKAS_ROWS[arrangement])
    return plain(few * power * Pr**0.36 * (Pr / Pr_s) ** 0.25)


def grimison_constants(
    transverse_ratio: float, longitudinal_ratio: float, arrangement: BankArrangement = "staggered"
) -> tuple[float, float]:
    """C and m of Grimison's correlation for a bank (Incropera and DeWitt 2002, Table 7.5).

    Between the pitches of the table, ln C and m are linear, and so is ln Nu at any Reynolds number.

    Parameters
    ----------
    transverse_ratio, longitudinal_ratio : float
        Pitch across and along the flow over the outer diameter, S_T/D and S_L/D.
    arrangement : {"staggered", "aligned"}
        Arrangement of the tubes.

    Returns
    -------
    (float, float)
        C and m.

    Raises
    ------
    ValueError
        If the pitches are outside the table.
    """
    _check_arrangement(arrangement)
    across = float(within("transverse_ratio", transverse_ratio, _PITCHES[0], _PITCHES[-1]))
    columns = _GRIMISON[arrangement]
    upper = next(pitch for pitch in _PITCHES if pitch >= across)
    lower = max(pitch for pitch in _PITCHES if pitch <= across)
    share = (across - lower) / (upper - lower) if upper > lower else 0.0
    ends = []
    for pitch in (lower, upper):
        along, C, m = columns[pitch]
        name = f"longitudinal_ratio at transverse_ratio {pitch:g} ({arrangement})"
        x = float(within(name, longitudinal_ratio, along[0], along[-1]))
        ends.append((float(np.interp(x, along, np.log(C))), float(np.interp(x, along, m))))
    (log_low, m_low), (log_high, m_high) = ends
    return float(np.exp(log_low + share * (log_high - log_low))), m_low + share * (m_high - m_low)


def grimison_bank(
    maximum_reynolds: ArrayLike,
    prandtl: ArrayLike,
    constants: tuple[float, float],
    rows: ArrayLike = 10,
    arrangement: BankArrangement = "staggered",
) -> FloatArray:
    """Nusselt number of a tube bank, Nu = 1.13 C_2 C Re_max^m Pr^(1/3) (Grimison 1937).

    Nguyen (2015), eq. 2-2, where the exponent m is lost in print.

    Parameters
    ----------
    maximum_reynolds, prandtl : float or array
        Reynolds number of the largest velocity, and Prandtl number.
    constants : (C, m)
        From `grimison_constants`.
    rows : float or array
        Number of rows, for the factor C_2 below 10 rows.
    arrangement : {"staggered", "aligned"}
        Arrangement of the tubes.

    Returns
    -------
    float or array
        Nusselt number.

    Raises
    ------
    ValueError
        If an input is not positive, or there is less than one row.

    Warns
    -----
    RangeWarning
        Outside 2000 < Re_max < 40000, or below Pr = 0.7.
    """
    _check_arrangement(arrangement)
    Re, Pr = positive("maximum_reynolds", maximum_reynolds), positive("prandtl", prandtl)
    number = within("rows", rows, 1.0, np.inf)
    C, m = checked_constants(constants)
    warn_outside("grimison_bank (Grimison 1937): Reynolds number", Re, 2000.0, 40000.0)
    warn_outside("grimison_bank (Grimison 1937): Prandtl number", Pr, 0.7, np.inf)
    few = np.interp(number, np.arange(1.0, 11.0), _GRIMISON_ROWS[arrangement])
    return plain(1.13 * few * C * Re**m * Pr ** (1.0 / 3.0))
