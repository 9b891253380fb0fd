"""Clusters of particles that come and go at the bottom wall of a slurry pipe (Scelzo et al., eq. 12-15, corrected).

Part f of the wall is covered by packets of slurry that stay for a time and take up heat by unsteady conduction, the
rest sees liquid with few particles, and the stream adds its turbulent convection: `h = f h_p + (1 - f) h_l + h_s`.
The model is that of Basu and Nag (1996) for circulating fluidised beds with the last term added. Four of its printed
expressions cannot stand as they are; docs/heat_slurry.md gives the evidence for each.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.correlations import STANDARD_GRAVITY
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within
from bedrad.heat.slurry_correlations import nusselt_dittus_boelter
from bedrad.heat.slurry_phases import (
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
    "ClusterModel",
    "cluster_model",
    "contact_time",
    "dispersed_coefficient",
    "packet_coefficient",
    "stream_coefficient",
    "wall_coverage",
]

FULL_COVERAGE: Final = (1.0 / 3.5) ** (1.0 / 0.37)
"""Volume fraction at the wall from which on it is covered, where 3.5 alpha^0.37 is 1: 0.0338."""


def wall_coverage(volume_fraction: ArrayLike) -> FloatArray:
    """Part of the wall that clusters cover: `min(3.5 alpha^0.37, 1)` (Scelzo et al., eq. 15, corrected).

    The print has 3.5 alpha^0.37 up to alpha = 0.1 and 1 above, meant to keep it between 0 and 1; but it reaches 1 at
    0.0338 and 1.49 at 0.1.

    Parameters
    ----------
    volume_fraction : float or array
        Volume fraction of the particles in the lower part of the pipe, alpha_down.

    Returns
    -------
    float or array
        f, from 0 to 1.

    Raises
    ------
    ValueError
        If the volume fraction is not from 0 to 1.
    """
    return plain(np.minimum(3.5 * within("volume_fraction", volume_fraction, 0.0, 1.0) ** 0.37, 1.0))


def contact_time(velocity: ArrayLike, pipe_diameter: ArrayLike) -> FloatArray:
    """Time that a cluster stays at the wall: `t = D/U` (Scelzo et al., below eq. 13, corrected).

    The print has 1/U, which is no time; the 0.2 s that it states are D/U at the lowest Reynolds number measured, 4500.

    Parameters
    ----------
    velocity : float or array
        Velocity of the slurry. [m/s]
    pipe_diameter : float or array
        Inner diameter. [m]

    Returns
    -------
    float or array
        [s]

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    return plain(positive("pipe_diameter", pipe_diameter, "m") / positive("velocity", velocity, "m/s"))


def packet_coefficient(
    contact_time: ArrayLike,
    conductivity: ArrayLike,
    density: ArrayLike,
    specific_heat: ArrayLike,
    film_thickness: ArrayLike = 0.0,
    liquid_conductivity: ArrayLike = 1.0,
) -> FloatArray:
    """Coefficient of a packet of slurry at the wall (Scelzo et al., eq. 13, corrected).

    `h_p = 1/(delta/k_l + sqrt(pi t/(4 k rho c)))`: a film of liquid in series with the mean of unsteady conduction
    over the time. The print lacks the specific heat under the root, without which the terms are of different units,
    and has d/(delta k_l) for the film, with which a film of no thickness would let nothing through.

    Parameters
    ----------
    contact_time : float or array
        Time at the wall, t, see `contact_time`. [s]
    conductivity, density, specific_heat : float or array
        k, rho and c of the packet, a mixture. [W/(m K)], [kg/m3], [J/(kg K)]
    film_thickness : float or array
        Film of liquid between packet and wall, delta; the source neglects it. [m]
    liquid_conductivity : float or array
        k_l; matters with a film only. [W/(m K)]

    Returns
    -------
    float or array
        h_p. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    t = positive("contact_time", contact_time, "s")
    k = positive("conductivity", conductivity, "W/(m K)")
    capacity = positive("density", density, "kg/m3") * positive("specific_heat", specific_heat, "J/(kg K)")
    film = non_negative("film_thickness", film_thickness, "m")
    k_l = positive("liquid_conductivity", liquid_conductivity, "W/(m K)")
    return plain(1.0 / (film / k_l + np.sqrt(math.pi * t / (4.0 * k * capacity))))


def dispersed_coefficient(
    particle_diameter: ArrayLike,
    liquid_conductivity: ArrayLike,
    specific_heat_ratio: ArrayLike,
    density_ratio: ArrayLike,
    settling_velocity: ArrayLike,
    gravity: ArrayLike = STANDARD_GRAVITY,
) -> FloatArray:
    """Coefficient of the part of the wall without clusters (Scelzo et al., eq. 13).

    `h_l = (k_l/d) (C_p/C_p,l) (rho_l/rho_p)^0.3 (v^2/(g d))^0.21`, after Wen and Miller (1961), whose form has the
    Prandtl number of the fluid as a factor too.

    Parameters
    ----------
    particle_diameter : float or array
        Particle diameter. [m]
    liquid_conductivity : float or array
        k_l. [W/(m K)]
    specific_heat_ratio : float or array
        C_p/C_p,l; elsewhere in the source C_p is that of the mixture.
    density_ratio : float or array
        rho_p/rho_l, beta.
    settling_velocity : float or array
        v, either sign. [m/s]
    gravity : float or array
        [m/s2]

    Returns
    -------
    float or array
        h_l. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    d = positive("particle_diameter", particle_diameter, "m")
    k_l = positive("liquid_conductivity", liquid_conductivity, "W/(m K)")
    c_ratio = positive("specific_heat_ratio", specific_heat_ratio)
    beta = positive("density_ratio", density_ratio)
    speed = non_negative("settling_velocity", np.abs(settling_velocity), "m/s")
    froude = speed**2 / (positive("gravity", gravity, "m/s2") * d)
    return plain(k_l / d * c_ratio * beta**-0.3 * froude**0.21)


def stream_coefficient(nusselt: ArrayLike, conductivity: ArrayLike, pipe_diameter: ArrayLike) -> FloatArray:
    """Coefficient of the stream: `h_s = Nu k/D` (Scelzo et al., above eq. 14; the print has Nu D/k).

    Parameters
    ----------
    nusselt : float or array
        Nusselt number of the pipe.
    conductivity : float or array
        Conductivity that it was made with. [W/(m K)]
    pipe_diameter : float or array
        Inner diameter. [m]

    Returns
    -------
    float or array
        [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    k = positive("conductivity", conductivity, "W/(m K)")
    return plain(positive("nusselt", nusselt) * k / positive("pipe_diameter", pipe_diameter, "m"))


@dataclass(frozen=True, eq=False)
class ClusterModel:
    """Coefficients at the bottom wall of a slurry pipe, and what they are made of.

    Parameters
    ----------
    total : float or array
        h of the slurry, the sum of the shares below. [W/(m2 K)]
    coverage : float or array
        Part of the wall that clusters cover, f.
    packet, dispersed, stream : float or array
        Shares f h_p, (1 - f) h_l and h_s. [W/(m2 K)]
    liquid : float or array
        h of the liquid alone at the same velocity. [W/(m2 K)]
    """

    total: FloatArray
    coverage: FloatArray
    packet: FloatArray
    dispersed: FloatArray
    stream: FloatArray
    liquid: FloatArray

    @property
    def enhancement(self) -> FloatArray:
        """Coefficient of the slurry over that of the liquid alone."""
        return plain(self.total / self.liquid)

    def __str__(self) -> str:
        rows = (
            ("h", self.total, " W/(m2 K)"),
            ("packets", self.packet, " W/(m2 K)"),
            ("dispersed", self.dispersed, " W/(m2 K)"),
            ("stream", self.stream, " W/(m2 K)"),
            ("liquid", self.liquid, " W/(m2 K)"),
            ("h/liquid", self.enhancement, ""),
            ("coverage", self.coverage, ""),
        )
        return "\n".join(f"{name:9} " + np.array2string(np.asarray(x), precision=4) + unit for name, x, unit in rows)


def cluster_model(
    velocity: ArrayLike,
    pipe_diameter: ArrayLike,
    particle_diameter: ArrayLike,
    volume_fraction: ArrayLike,
    particles: Particles,
    liquid: Liquid,
    time: ArrayLike | None = None,
    film_thickness: ArrayLike = 0.0,
) -> ClusterModel:
    """Heat transfer at the bottom wall of a slurry pipe by clusters that are renewed (Scelzo et al., eq. 14).

    Packets and stream have the properties of the mixture at the volume fraction at the bottom (`slurry_phases`), the
    stream and the liquid alone follow Dittus and Boelter.

    Parameters
    ----------
    velocity : float or array
        Velocity of the slurry. [m/s]
    pipe_diameter, particle_diameter : float or array
        [m]
    volume_fraction : float or array
        Volume fraction of the particles in the lower part of the pipe, alpha_down.
    particles, liquid : Particles, Liquid
        The phases.
    time : float or array, optional
        Time that a cluster stays at the wall; left out, `contact_time`. [s]
    film_thickness : float or array
        Film of liquid between cluster and wall. [m]

    Returns
    -------
    ClusterModel
        Coefficients.

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        Outside the ranges of Dittus and Boelter and of the settling velocity.
    """
    alpha = within("volume_fraction", volume_fraction, 0.0, 1.0)
    U, D = positive("velocity", velocity, "m/s"), positive("pipe_diameter", pipe_diameter, "m")
    rho = mixture_density(alpha, particles.density, liquid.density)
    c = mixture_specific_heat(alpha, particles, liquid)
    k = mixture_conductivity(alpha, particles.conductivity, liquid.conductivity)
    mu = mixture_viscosity(alpha, liquid.viscosity)
    f = wall_coverage(alpha)
    stay = contact_time(U, D) if time is None else time
    settling = settling_velocity(particle_diameter, particles.density, liquid)
    shares = (
        f * packet_coefficient(stay, k, rho, c, film_thickness, liquid.conductivity),
        (1.0 - f)
        * dispersed_coefficient(
            particle_diameter,
            liquid.conductivity,
            c / liquid.specific_heat,
            particles.density / liquid.density,
            settling,
        ),
        stream_coefficient(nusselt_dittus_boelter(rho * U * D / mu, c * mu / k, warn=False), k, D),
    )
    clear = nusselt_dittus_boelter(liquid.density * U * D / liquid.viscosity, liquid.prandtl)
    clear = stream_coefficient(clear, liquid.conductivity, D)
    return ClusterModel(*map(plain, np.broadcast_arrays(shares[0] + shares[1] + shares[2], f, *shares, clear)))
