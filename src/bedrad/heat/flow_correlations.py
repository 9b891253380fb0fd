"""Wall layer and view factors of dense flows in tubes, by correlations fitted to bedrad's own flows.

``y = c_0 + c_1/A + (c_2 + c_3/A) U/sqrt(g d)`` for every quantity, fitted to discrete-element runs of flows fed by a
hopper (docs/flow_study.md says how they were made, what they depend on beside A and U, and how far they agree with
Watkins 2018). They carry errors: of the coefficients, and of a flow about the fit.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.correlations import dimensionless_velocity
from bedrad.heat.flow_coefficients import DIAMETER_RATIOS, FITS, TERMS, VELOCITIES, VIEW_FACTOR_CORRELATIONS
from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside

__all__ = ["Quantity", "estimate", "view_factors", "warn_outside_fit"]

Quantity = Literal[
    "packing_fraction", "contact_ratio", "nc_distance", "view_factor_1", "view_factor_2", "view_factor_3"
]


def warn_outside_fit(diameter_ratio: ArrayLike, velocity: ArrayLike, particle_diameter: ArrayLike) -> None:
    """Warn where a flow lies outside the diameter ratios or the velocities U/sqrt(g d) of the runs."""
    warn_outside("correlations of bedrad's flows: diameter_ratio", diameter_ratio, *DIAMETER_RATIOS)
    speed = dimensionless_velocity(velocity, particle_diameter)
    warn_outside("correlations of bedrad's flows: velocity/sqrt(g d)", speed, *VELOCITIES)


def estimate(
    quantity: Quantity,
    diameter_ratio: ArrayLike,
    velocity: ArrayLike,
    particle_diameter: ArrayLike,
    *,
    warn: bool = True,
) -> tuple[FloatArray, FloatArray]:
    """Estimate a quantity of a dense flow in a tube.

    Parameters
    ----------
    quantity : str
        "packing_fraction" (of the wall-adjacent layer), "contact_ratio" (wall contacts within 0.01 radii over their
        hexagonal maximum, `correlations.maximum_contacts`), "nc_distance" (of the particles without contact, the one
        that closes the layer's solid volume; in radii), or "view_factor_1", "_2", "_3" (from the wall to the layers;
        what returns to the wall or goes beyond is left out).
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
    value, error : float or array
        The quantity, and the standard error with which one flow is predicted.

    Raises
    ------
    ValueError
        If the quantity is unknown, a diameter is not positive, or the velocity negative.

    Warns
    -----
    RangeWarning
        Outside the diameter ratios and velocities of the runs.
    """
    if quantity not in FITS:
        raise ValueError(f"quantity is {quantity!r}; expected one of {', '.join(FITS)}")
    A = positive("diameter_ratio", diameter_ratio)
    speed = dimensionless_velocity(velocity, particle_diameter)
    if warn:
        warn_outside_fit(A, velocity, particle_diameter)
    coefficients, covariance, scatter = FITS[quantity]
    terms = np.stack(np.broadcast_arrays(*(A**-p * speed**q for p, q in TERMS)), axis=-1)
    variance = np.einsum("...i,ij,...j->...", terms, np.array(covariance), terms)
    return plain(terms @ np.array(coefficients)), plain(np.sqrt(variance + scatter**2))


def view_factors(
    diameter_ratio: float, velocity: float, particle_diameter: float, *, warn: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Estimate the view factors from the wall to the first three layers of a dense flow in a tube, together.

    Parameters
    ----------
    diameter_ratio : float
        Tube inner diameter over particle diameter.
    velocity : float
        Mean flow velocity. [m/s]
    particle_diameter : float
        Particle diameter. [m]
    warn : bool
        Warn outside the fitted range.

    Returns
    -------
    values : (3,) array
        The view factors.
    covariance : (3, 3) array
        Of one flow about them: what a looser wall layer takes from the first factor it gives to the others, so that
        their errors partly cancel in the radiative conductivity.

    Raises
    ------
    ValueError
        If a diameter is not positive or the velocity negative.

    Warns
    -----
    RangeWarning
        Outside the diameter ratios and velocities of the runs.
    """
    if warn:
        warn_outside_fit(diameter_ratio, velocity, particle_diameter)
    names: tuple[Quantity, ...] = ("view_factor_1", "view_factor_2", "view_factor_3")
    found = [estimate(name, diameter_ratio, velocity, particle_diameter, warn=False) for name in names]
    errors = np.array([float(error) for _, error in found])
    covariance = errors[:, None] * np.array(VIEW_FACTOR_CORRELATIONS) * errors
    return np.array([float(value) for value, _ in found]), covariance
