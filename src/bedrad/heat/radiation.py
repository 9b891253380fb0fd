"""Radiation from the wall into the layers of particles behind it (Watkins 2018, section 5.3).

Wall and particles are black, each layer has one temperature. The view factors come from the wall: to the
wall-adjacent layer (one particle radius thick), then to the following layers (one diameter each). The
temperature falls by the same step from the wall to the first layer and from each layer to the next. What these
assumptions are worth: `bedrad.heat.wall_temperature_profile` for the steps and the fourth powers,
`bedrad.heat.grey_enclosure` for black surfaces.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, finite, non_negative, plain, positive, within
from bedrad.heat.two_layer import nusselt_developed

__all__ = [
    "STEFAN_BOLTZMANN",
    "WATKINS_FACTORS",
    "conductivity",
    "fourth_power_difference",
    "heat_flux",
    "largest_effect",
    "linearisation_condition",
    "linearisation_error",
    "linearised_heat_flux",
    "penetration",
]

STEFAN_BOLTZMANN: Final = 5.670374419e-8
"""Stefan-Boltzmann constant (CODATA 2018). [W/(m2 K4)]"""

WATKINS_FACTORS: Final = (0.80, 0.18, 0.02)
"""View factors from the wall to the first three layers in a 7.75 mm tube with 0.6 mm particles at 0.016 m/s,
leakage folded in so that they sum to one (Watkins 2018, Table 5.3)."""


def _factors(factors: ArrayLike) -> FloatArray:
    F = within("view factor", factors, 0.0, 1.0)
    if F.ndim == 0 or F.shape[-1] == 0:
        raise ValueError(f"view factors have the shape {F.shape}; expected the layers along the last axis")
    if np.any(F.sum(axis=-1) > 1.0 + 1e-9):
        raise ValueError(f"view factors sum to {float(np.max(F.sum(axis=-1))):.9g}; expected at most 1")
    return F


def fourth_power_difference(temperature: ArrayLike, fall: ArrayLike) -> FloatArray:
    """Give `T^4 - (T - fall)^4`, the bracket of Watkins (2018), eq. 48, factored so that a small fall keeps its digits.

    Parameters
    ----------
    temperature : float or array
        T. [K]
    fall : float or array
        How much colder the other surface is. [K]

    Returns
    -------
    float or array
        Difference of the fourth powers, whatever the signs. [K4]

    Raises
    ------
    ValueError
        If an input is not finite.
    """
    T, down = finite("temperature", temperature, "K"), finite("fall", fall, "K")
    other = T - down
    return plain(down * (T + other) * (T * T + other * other))


def penetration(factors_to_layers: ArrayLike) -> FloatArray:
    """Mean number of temperature steps that wall radiation crosses: F_w1 + 2 F_w2 + 3 F_w3 + ...

    Parameters
    ----------
    factors_to_layers : (..., layers) array
        View factors from the wall to the layers, the wall-adjacent layer first, any number of them.

    Returns
    -------
    float or (...) array
        The sum of eq. 49-50 of Watkins (2018), generalised to any number of layers.

    Raises
    ------
    ValueError
        If a factor is not from 0 to 1, or they sum to more than 1.
    """
    F = _factors(factors_to_layers)
    return plain(F @ np.arange(1.0, F.shape[-1] + 1.0))


def conductivity(factors_to_layers: ArrayLike, particle_diameter: ArrayLike, wall_temperature: ArrayLike) -> FloatArray:
    """Radiative conductivity of the wall-adjacent layer (Watkins 2018, eq. 50).

    `k_rad = 4 sigma r T_w^3 (F_w1 + 2 F_w2 + 3 F_w3 + ...)`, to be added to the conductive k_wa. What returns
    to the wall or leaves through open ends carries nothing: only the factors to layers count.

    Parameters
    ----------
    factors_to_layers : (..., layers) array
        View factors from the wall to the layers, the wall-adjacent layer first.
    particle_diameter : float or array
        Particle diameter. [m]
    wall_temperature : float or array
        Wall temperature. [K]

    Returns
    -------
    float or array
        k_rad [W/(m K)], broadcast over the leading axes of the factors and the other two.

    Raises
    ------
    ValueError
        If a factor is not from 0 to 1, they sum to more than 1, or a diameter or temperature is not positive.
    """
    radius = 0.5 * positive("particle_diameter", particle_diameter, "m")
    T = positive("wall_temperature", wall_temperature, "K")
    return plain(4.0 * STEFAN_BOLTZMANN * radius * T**3 * penetration(factors_to_layers))


def heat_flux(factors_to_layers: ArrayLike, wall_temperature: ArrayLike, layer_temperatures: ArrayLike) -> FloatArray:
    """Net radiative flux from the wall to the layers (Watkins 2018, eq. 48).

    Parameters
    ----------
    factors_to_layers : (..., layers) array
        View factors from the wall to the layers, the wall-adjacent layer first.
    wall_temperature : float or (...) array
        Wall temperature. [K]
    layer_temperatures : (..., layers) array
        Temperature of each layer. [K]

    Returns
    -------
    float or (...) array
        Flux, positive away from the wall. [W/m2]

    Raises
    ------
    ValueError
        If a factor is not from 0 to 1, they sum to more than 1, or a temperature is not positive.
    """
    F = _factors(factors_to_layers)
    T_wall = positive("wall_temperature", wall_temperature, "K")[..., None]
    T = positive("layer_temperatures", layer_temperatures, "K")
    return plain(STEFAN_BOLTZMANN * (F * fourth_power_difference(T_wall, T_wall - T)).sum(axis=-1))


def linearised_heat_flux(
    factors_to_layers: ArrayLike, wall_temperature: ArrayLike, temperature_step: ArrayLike
) -> FloatArray:
    """Net radiative flux for equal, small temperature steps from layer to layer (Watkins 2018, eq. 49).

    Parameters
    ----------
    factors_to_layers : (..., layers) array
        View factors from the wall to the layers, the wall-adjacent layer first.
    wall_temperature : float or array
        Wall temperature. [K]
    temperature_step : float or array
        Fall of the temperature from the wall to the first layer, and from each layer to the next. [K]

    Returns
    -------
    float or array
        Flux, positive away from the wall. [W/m2]

    Raises
    ------
    ValueError
        If a factor is not from 0 to 1, they sum to more than 1, or the temperature is not positive.
    """
    T = positive("wall_temperature", wall_temperature, "K")
    step = finite("temperature_step", temperature_step, "K")
    return plain(4.0 * STEFAN_BOLTZMANN * T**3 * step * penetration(factors_to_layers))


def linearisation_condition(wall_temperature: ArrayLike, layer_temperature: ArrayLike) -> FloatArray:
    """Give `(T_w - T_j)^2/(4 T_mean^2)`, which must be much less than 1 for eq. 49 (Watkins 2018).

    It is the exact relative error of `T_w^4 - T_j^4 = 4 T_mean^3 (T_w - T_j)`, T_mean the mean of the two.

    Parameters
    ----------
    wall_temperature, layer_temperature : float or array
        Temperatures of the wall and of a layer. [K]

    Returns
    -------
    float or array
        The relative error, 0 or more.

    Raises
    ------
    ValueError
        If a temperature is not positive.
    """
    T_wall = positive("wall_temperature", wall_temperature, "K")
    T = positive("layer_temperature", layer_temperature, "K")
    return plain(((T_wall - T) / (T_wall + T)) ** 2)


def linearisation_error(
    factors_to_layers: ArrayLike, wall_temperature: ArrayLike, temperature_step: ArrayLike
) -> FloatArray:
    """Relative error of the linearised flux (eq. 49) against the full one (eq. 48) for equal steps.

    Larger than `linearisation_condition`, because eq. 49 also puts the wall temperature in place of the mean
    one.

    Parameters
    ----------
    factors_to_layers : (..., layers) array
        View factors from the wall to the layers, the wall-adjacent layer first.
    wall_temperature : float or array
        Wall temperature. [K]
    temperature_step : float or array
        Fall of the temperature from the wall to the first layer, and from each layer to the next; not 0. [K]

    Returns
    -------
    float or array
        Linearised over full flux, less 1; positive where the wall is hotter than the bed.

    Raises
    ------
    ValueError
        As `heat_flux`, and where the step is 0 or takes a layer to absolute zero.
    """
    step = np.asarray(temperature_step, dtype=np.float64)
    if np.any(step == 0.0):
        raise ValueError("temperature_step is 0 K: there is no flux to compare")
    T = positive("wall_temperature", wall_temperature, "K")
    F = _factors(factors_to_layers)
    falls = step[..., None] * np.arange(1.0, F.shape[-1] + 1.0)
    positive("layer_temperatures", T[..., None] - falls, "K")
    full = STEFAN_BOLTZMANN * (F * fourth_power_difference(T[..., None], falls)).sum(axis=-1)
    return plain(linearised_heat_flux(F, T, step) / full - 1.0)


def largest_effect(
    diameter_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    wall_temperature: ArrayLike,
    wall_layer_conductivity: ArrayLike,
    bulk_conductivity: ArrayLike,
    bulk_conductivity_without: ArrayLike | None = None,
    reach: ArrayLike = 3.0,
) -> FloatArray:
    """Upper bound on what radiation can add to h, known before any view factor is.

    By eq. 22 h rises with both conductivities, and no set of view factors makes `penetration` larger than the
    number of the last layer that radiation reaches (2 to 3 particle diameters in a random bed, Watkins 2018,
    section 5.3). So h with `k_rad = 4 sigma r T_w^3 reach` bounds h from above.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter.
    particle_diameter : float or array
        Particle diameter. [m]
    wall_temperature : float or array
        Wall temperature. [K]
    wall_layer_conductivity : float or array
        k_wa without radiation. [W/(m K)]
    bulk_conductivity : float or array
        k_b with radiation. [W/(m K)]
    bulk_conductivity_without : float or array, optional
        k_b without radiation; left out, only the effect of radiation in the wall layer is bounded. [W/(m K)]
    reach : float or array
        Number of the last layer that radiation from the wall reaches.

    Returns
    -------
    float or array
        Largest possible h with radiation over h without, less 1.

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    radius = 0.5 * positive("particle_diameter", particle_diameter, "m")
    T = positive("wall_temperature", wall_temperature, "K")
    k_wa = positive("wall_layer_conductivity", wall_layer_conductivity, "W/(m K)")
    k_b = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    k_b0 = (
        k_b
        if bulk_conductivity_without is None
        else positive("bulk_conductivity_without", bulk_conductivity_without, "W/(m K)")
    )
    k_rad = 4.0 * STEFAN_BOLTZMANN * radius * T**3 * non_negative("reach", reach)
    most = nusselt_developed(diameter_ratio, k_b / (k_wa + k_rad)) * k_b
    return plain(most / (nusselt_developed(diameter_ratio, k_b0 / k_wa) * k_b0) - 1.0)
