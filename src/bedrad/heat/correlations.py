"""What the wall layer holds, by correlation: packing fraction and contacts (Watkins 2018, eq. 38-40).

Fitted to discrete-element runs of zirconia-silica spheres of 0.3 to 0.6 mm in tubes of 7.75 and 10.92 mm
(Watkins 2018, Table 3.1).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, warn_outside

__all__ = [
    "FITTED_DIAMETER_RATIOS",
    "FITTED_VELOCITIES",
    "STANDARD_GRAVITY",
    "contact_ratio",
    "dimensionless_velocity",
    "maximum_contacts",
    "packing_fraction",
    "warn_outside_fit",
]

STANDARD_GRAVITY = 9.81
"""Acceleration of gravity as the source takes it. [m/s2]"""

FITTED_DIAMETER_RATIOS = (12.9, 36.4)
"""Tube over particle diameter of the runs behind eq. 38 and 40."""

FITTED_VELOCITIES = (0.002, 0.25)
"""Mean flow velocity of the runs behind eq. 38 and 40. [m/s]"""


def warn_outside_fit(what: str, diameter_ratio: ArrayLike, velocity: ArrayLike) -> None:
    """Warn where the diameter ratio or the velocity [m/s] lies outside the runs behind eq. 38 and 40."""
    warn_outside(f"{what}: diameter_ratio", diameter_ratio, *FITTED_DIAMETER_RATIOS)
    warn_outside(f"{what}: velocity", velocity, *FITTED_VELOCITIES, "m/s")


def dimensionless_velocity(velocity: ArrayLike, particle_diameter: ArrayLike) -> FloatArray:
    """U/sqrt(g d) from a velocity [m/s] and a particle diameter [m]."""
    speed = non_negative("velocity", velocity, "m/s")
    diameter = positive("particle_diameter", particle_diameter, "m")
    return np.asarray(speed / np.sqrt(STANDARD_GRAVITY * diameter))


def packing_fraction(
    diameter_ratio: ArrayLike, velocity: ArrayLike, particle_diameter: ArrayLike, *, warn: bool = True
) -> FloatArray:
    """Packing fraction of the wall-adjacent layer of a dense flow in a tube (Watkins 2018, eq. 38).

    Fitted to the flows faster than 0.02 m/s; below, the runs rise a little with the velocity where the fit
    falls. It is stated to hold within 5 % for all of them, down to 0.002 m/s.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter.
    velocity : float or array
        Mean flow velocity. [m/s]
    particle_diameter : float or array
        Particle diameter. [m]
    warn : bool
        Warn outside the fitted range.

    Returns
    -------
    float or array
        Packing fraction.

    Raises
    ------
    ValueError
        If a diameter is not positive, the velocity negative, or the fit gives no positive packing fraction.

    Warns
    -----
    RangeWarning
        Outside diameter ratios 12.9 to 36.4 or velocities 0.002 to 0.25 m/s.
    """
    A = positive("diameter_ratio", diameter_ratio)
    fraction = unchecked_packing_fraction(A, velocity, particle_diameter)
    if warn:
        warn_outside_fit("packing_fraction (Watkins 2018, eq. 38)", A, velocity)
    if np.any(fraction <= 0.0):
        raise ValueError(
            f"packing_fraction (Watkins 2018, eq. 38) gives {float(np.min(fraction)):g}; expected a positive "
            "value: velocity or diameter_ratio lie too far outside the fitted range"
        )
    return plain(fraction)


def unchecked_packing_fraction(A: FloatArray, velocity: ArrayLike, particle_diameter: ArrayLike) -> FloatArray:
    """The formula of eq. 38 alone, which far outside its range is negative; for draws about `packing_fraction`."""
    return np.asarray(
        0.43 - 2.0 / (3.0 * A * A) - (0.003 + 0.25 / A) * dimensionless_velocity(velocity, particle_diameter)
    )


def unchecked_contact_ratio(A: FloatArray, velocity: ArrayLike, particle_diameter: ArrayLike) -> FloatArray:
    """The formula of eq. 40 alone, which is negative for diameter ratios above 5e4."""
    speed = dimensionless_velocity(velocity, particle_diameter)
    return np.asarray((1.6 / A**0.09 - 0.6) * np.exp(-(0.07 + 175.0 / A**2.55) * speed))


def contact_ratio(
    diameter_ratio: ArrayLike, velocity: ArrayLike, particle_diameter: ArrayLike, *, warn: bool = True
) -> FloatArray:
    """Particle-wall contacts over their maximum, n_C/n_C,max, in a dense flow (Watkins 2018, eq. 40).

    Stated to hold within 16 %.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter.
    velocity : float or array
        Mean flow velocity. [m/s]
    particle_diameter : float or array
        Particle diameter. [m]
    warn : bool
        Warn outside the fitted range.

    Returns
    -------
    float or array
        n_C/n_C,max.

    Raises
    ------
    ValueError
        If a diameter is not positive, the velocity negative, or the fit gives a negative ratio.

    Warns
    -----
    RangeWarning
        Outside diameter ratios 12.9 to 36.4 or velocities 0.002 to 0.25 m/s.
    """
    A = positive("diameter_ratio", diameter_ratio)
    ratio = unchecked_contact_ratio(A, velocity, particle_diameter)
    if warn:
        warn_outside_fit("contact_ratio (Watkins 2018, eq. 40)", A, velocity)
    if np.any(ratio < 0.0):
        raise ValueError(
            f"contact_ratio (Watkins 2018, eq. 40) gives {float(np.min(ratio)):g}; expected no negative value: "
            "diameter_ratio lies too far outside the fitted range"
        )
    return plain(ratio)


def maximum_contacts(diameter_ratio: ArrayLike, particle_diameter: ArrayLike) -> FloatArray:
    """Contacts per wall area of a hexagonal layer on the wall of a tube (Watkins 2018, eq. 39).

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, above 1; infinite for a flat wall.
    particle_diameter : float or array
        Particle diameter. [m]

    Returns
    -------
    float or array
        n_C,max. [1/m2] For A above 4; it lies 1.2 % above exact staggered rings at A = 4.24, 5.0 % at A =
        2.70.

    Raises
    ------
    ValueError
        If the particle diameter is not positive or the diameter ratio not above 1.
    """
    A = positive("diameter_ratio", diameter_ratio, infinite=True)
    if np.any(A <= 1.0):
        raise ValueError(f"diameter_ratio is {float(np.min(A)):g}; expected more than 1")
    radius = 0.5 * positive("particle_diameter", particle_diameter, "m")
    return plain((1.0 - 1.0 / A) / (2.0 * math.sqrt(3.0) * radius * radius))
