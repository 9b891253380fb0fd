"""Heat transfer to a slurry of liquid and particles in a heated horizontal pipe.

After Scelzo, Peveroni, Laboureur and Buchlin, "The effect of solid particles on the heat transfer in a slurry pipe
flow" ("S"): water with polystyrene spheres of 0.35 and 0.85 mm in a pipe of 30 mm, Re 4500 to 14000. This module has
their correlation, the modified Froude number, the energy balance and the uncertainty; `slurry_clusters` the
renewal of clusters at the bottom wall, `slurry_correlations` the correlations before theirs, `slurry_phases` the
properties. All are to be had from here.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.heat.correlations import STANDARD_GRAVITY
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, warn_outside, within
from bedrad.heat.slurry_clusters import (
    FULL_COVERAGE,
    ClusterModel,
    cluster_model,
    contact_time,
    dispersed_coefficient,
    packet_coefficient,
    stream_coefficient,
    wall_coverage,
)
from bedrad.heat.slurry_correlations import (
    nusselt_dittus_boelter,
    nusselt_harada,
    nusselt_ku,
    nusselt_ozbelge_somer,
    nusselt_salamone_newman,
)
from bedrad.heat.slurry_phases import (
    POLYSTYRENE,
    WATER,
    Liquid,
    Particles,
    mixture_conductivity,
    mixture_density,
    mixture_specific_heat,
    mixture_viscosity,
    settling_velocity,
)

__all__ = [
    "FULL_COVERAGE",
    "POLYSTYRENE",
    "SUSPENSION_FROUDE",
    "WATER",
    "ClusterModel",
    "Liquid",
    "Particles",
    "cluster_model",
    "coefficient_uncertainty",
    "contact_time",
    "dispersed_coefficient",
    "fully_suspended",
    "mixture_conductivity",
    "mixture_density",
    "mixture_specific_heat",
    "mixture_viscosity",
    "modified_froude",
    "nusselt_dittus_boelter",
    "nusselt_harada",
    "nusselt_ku",
    "nusselt_ozbelge_somer",
    "nusselt_salamone_newman",
    "nusselt_scelzo",
    "outlet_temperature_gain",
    "packet_coefficient",
    "settling_time_ratio",
    "settling_velocity",
    "stream_coefficient",
    "suspension_velocity",
    "wall_coverage",
    "wall_heat_flux",
]

SUSPENSION_FROUDE: Final = 10.0
"""Modified Froude number above which all particles were suspended and the energy balance held (S, section 4.2)."""


def nusselt_scelzo(
    reynolds: ArrayLike,
    prandtl: ArrayLike,
    diameter_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    density_ratio: ArrayLike,
) -> FloatArray:
    """Nusselt number of a slurry in a pipe (S, eq. 16).

    `h D/k_l = 0.077 Re^0.71 Pr^0.68 (d/D)^0.12 alpha^-0.07 beta^-1.2`. It stands for 35 % about the data compared
    with. It has no limit for alpha -> 0, and with its beta^-1.2 falls below the liquid alone for heavy particles.

    Parameters
    ----------
    reynolds, prandtl : float or array
        rho_l U D/mu_l and c_p,l mu_l/k_l, both with the properties of the liquid.
    diameter_ratio : float or array
        Pipe over particle diameter, D/d.
    volume_fraction : float or array
        Volume of the particles over that of particles and liquid, alpha, above 0.
    density_ratio : float or array
        Density of the particles over that of the liquid, beta. 1.05 in the experiments of S.

    Returns
    -------
    float or array
        h D/k_l.

    Raises
    ------
    ValueError
        If an input is not positive or the volume fraction above 1.

    Warns
    -----
    RangeWarning
        Outside Re 3000 to 140000, Pr 2.1 to 7, D/d 14 to 1050 or above alpha 0.1. No range is given for beta.
    """
    Re, Pr = positive("reynolds", reynolds), positive("prandtl", prandtl)
    ratio = positive("diameter_ratio", diameter_ratio)
    alpha = within("volume_fraction", positive("volume_fraction", volume_fraction), 0.0, 1.0)
    beta = positive("density_ratio", density_ratio)
    warn_outside("nusselt_scelzo: reynolds", Re, 3e3, 1.4e5)
    warn_outside("nusselt_scelzo: prandtl", Pr, 2.1, 7.0)
    warn_outside("nusselt_scelzo: diameter_ratio", ratio, 14.0, 1050.0)
    warn_outside("nusselt_scelzo: volume_fraction", alpha, 0.0, 0.1)
    return plain(0.077 * Re**0.71 * Pr**0.68 * ratio**-0.12 * alpha**-0.07 * beta**-1.2)


def modified_froude(
    velocity: ArrayLike,
    particle_diameter: ArrayLike,
    volume_fraction: ArrayLike,
    density_ratio: ArrayLike,
    gravity: ArrayLike = STANDARD_GRAVITY,
) -> FloatArray:
    """Inertia of the flow over the weight of the particles: `Fr* = U^2/(g d) 1/(1 + (beta - 1) alpha)` (S, eq. 10).

    Parameters
    ----------
    velocity : float or array
        Velocity of the slurry. [m/s]
    particle_diameter : float or array
        [m]
    volume_fraction : float or array
        Volume of the particles over that of particles and liquid, alpha.
    density_ratio : float or array
        Density of the particles over that of the liquid, beta.
    gravity : float or array
        [m/s2]

    Returns
    -------
    float or array
        Fr*.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    U, d = non_negative("velocity", velocity, "m/s"), positive("particle_diameter", particle_diameter, "m")
    density = mixture_density(volume_fraction, density_ratio, 1.0)
    return plain(U**2 / (positive("gravity", gravity, "m/s2") * d * density))


def fully_suspended(modified_froude: ArrayLike) -> NDArray[np.bool_]:
    """Whether all particles are sure to be suspended, so that the energy balance, eq. 9, gives the temperature.

    Below, some flows had a moving bed and some had not.

    Parameters
    ----------
    modified_froude : float or array
        Fr*, see `modified_froude`.

    Returns
    -------
    bool or array of bool
        Fr* above 10.

    Raises
    ------
    ValueError
        If the number is negative.
    """
    result: NDArray[np.bool_] = np.asarray(non_negative("modified_froude", modified_froude) > SUSPENSION_FROUDE)[()]
    return result


def suspension_velocity(
    particle_diameter: ArrayLike,
    volume_fraction: ArrayLike,
    density_ratio: ArrayLike,
    gravity: ArrayLike = STANDARD_GRAVITY,
) -> FloatArray:
    """Velocity above which all particles are suspended, where the modified Froude number is 10 (Scelzo et al., eq. 10).

    Parameters
    ----------
    particle_diameter, volume_fraction, density_ratio, gravity : float or array
        As for `modified_froude`.

    Returns
    -------
    float or array
        [m/s]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    return plain(
        np.sqrt(SUSPENSION_FROUDE / modified_froude(1.0, particle_diameter, volume_fraction, density_ratio, gravity))
    )


def settling_time_ratio(
    velocity: ArrayLike, pipe_diameter: ArrayLike, length: ArrayLike, settling_velocity: ArrayLike
) -> FloatArray:
    """Time to settle over time in the pipe, `(D/(2 v))/(L/U)`: what decides the regime (S, section 4.1).

    Parameters
    ----------
    velocity : float or array
        Velocity of the slurry. [m/s]
    pipe_diameter, length : float or array
        Inner diameter, and length of the way. [m]
    settling_velocity : float or array
        Velocity at which a particle sinks. [m/s]

    Returns
    -------
    float or array
        Above 1 where a particle from the axis is still afloat at the end.

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    U, v = positive("velocity", velocity, "m/s"), positive("settling_velocity", settling_velocity, "m/s")
    return plain(positive("pipe_diameter", pipe_diameter, "m") * U / (2.0 * v * positive("length", length, "m")))


def wall_heat_flux(
    mass_flow: ArrayLike, specific_heat: ArrayLike, rise: ArrayLike, pipe_diameter: ArrayLike, length: ArrayLike
) -> FloatArray:
    """Heat flux at the wall from what the flow took up: `m c_p (T_out - T_in)/(pi D L)` (S, eq. 6, corrected).

    The print lacks the area of the wall and so gives a power; eq. 9 has it.

    Parameters
    ----------
    mass_flow : float or array
        [kg/s]
    specific_heat : float or array
        Of the mixture. [J/(kg K)]
    rise : float or array
        Rise of the bulk temperature from inlet to outlet, either sign. [K]
    pipe_diameter, length : float or array
        Inner diameter and heated length. [m]

    Returns
    -------
    float or array
        [W/m2]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    area = math.pi * positive("pipe_diameter", pipe_diameter, "m") * positive("length", length, "m")
    capacity = positive("mass_flow", mass_flow, "kg/s") * positive("specific_heat", specific_heat, "J/(kg K)")
    difference = np.asarray(rise, dtype=np.float64)
    non_negative("rise", np.abs(difference), "K")
    return plain(capacity * difference / area)


def outlet_temperature_gain(
    heat_flux: ArrayLike,
    pipe_diameter: ArrayLike,
    length: ArrayLike,
    mass_flow: ArrayLike,
    specific_heat: ArrayLike,
    liquid_specific_heat: ArrayLike,
) -> FloatArray:
    """How much hotter a slurry leaves the pipe than the liquid alone: `q pi D L/m (1/c_p - 1/c_p,l)` (S, eq. 9).

    Parameters
    ----------
    heat_flux : float or array
        At the wall, the same for both. [W/m2]
    pipe_diameter, length : float or array
        Inner diameter and heated length. [m]
    mass_flow : float or array
        The same for both. [kg/s]
    specific_heat, liquid_specific_heat : float or array
        Of the slurry, see `mixture_specific_heat`, and of the liquid. [J/(kg K)]

    Returns
    -------
    float or array
        Difference of the bulk temperatures at the outlet. [K]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    area = math.pi * positive("pipe_diameter", pipe_diameter, "m") * positive("length", length, "m")
    c = positive("specific_heat", specific_heat, "J/(kg K)")
    c_l = positive("liquid_specific_heat", liquid_specific_heat, "J/(kg K)")
    per_mass = non_negative("heat_flux", heat_flux, "W/m2") * area / positive("mass_flow", mass_flow, "kg/s")
    return plain(per_mass * (c_l - c) / c / c_l)


def coefficient_uncertainty(
    wall_difference: ArrayLike,
    wall_difference_error: ArrayLike,
    rise: ArrayLike,
    rise_error: ArrayLike,
    mass_flow_error: ArrayLike = 0.0,
) -> FloatArray:
    """Relative uncertainty of h out of temperatures and mass flow (S, eq. 8).

    `sqrt((s(T_w - T_b)/(T_w - T_b))^2 + (s(T_out - T_in)/(T_out - T_in))^2)`, and the mass flow, which the source
    leaves out as small (0.5 %), if it is given.

    Parameters
    ----------
    wall_difference, wall_difference_error : float or array
        Wall less bulk temperature, and its uncertainty. [K]
    rise, rise_error : float or array
        Outlet less inlet temperature, and its uncertainty. [K]
    mass_flow_error : float or array
        Relative uncertainty of the mass flow.

    Returns
    -------
    float or array
        Uncertainty of h over h, at the confidence of the inputs.

    Raises
    ------
    ValueError
        If a difference is not positive or an uncertainty negative.
    """
    wall = non_negative("wall_difference_error", wall_difference_error, "K")
    heat = non_negative("rise_error", rise_error, "K")
    wall = wall / positive("wall_difference", wall_difference, "K")
    heat = heat / positive("rise", rise, "K")
    return plain(np.hypot(np.hypot(wall, heat), non_negative("mass_flow_error", mass_flow_error)))
