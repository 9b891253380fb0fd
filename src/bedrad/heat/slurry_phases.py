"""The phases of a slurry (Scelzo et al.), what their mixture is like, and how fast a particle settles in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.correlations import STANDARD_GRAVITY
from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside, within

__all__ = [
    "POLYSTYRENE",
    "WATER",
    "Liquid",
    "Particles",
    "mixture_conductivity",
    "mixture_density",
    "mixture_specific_heat",
    "mixture_viscosity",
    "settling_velocity",
]


@dataclass(frozen=True)
class Liquid:
    """The liquid of a slurry.

    Parameters
    ----------
    density : float
        [kg/m3]
    viscosity : float
        [Pa s]
    conductivity : float
        [W/(m K)]
    specific_heat : float
        [J/(kg K)]
    """

    density: float
    viscosity: float
    conductivity: float
    specific_heat: float

    def __post_init__(self) -> None:
        positive("density", self.density, "kg/m3")
        positive("viscosity", self.viscosity, "Pa s")
        positive("conductivity", self.conductivity, "W/(m K)")
        positive("specific_heat", self.specific_heat, "J/(kg K)")

    @property
    def prandtl(self) -> float:
        """Prandtl number, c_p mu/k."""
        return self.specific_heat * self.viscosity / self.conductivity


@dataclass(frozen=True)
class Particles:
    """The particles of a slurry.

    Parameters
    ----------
    density : float
        [kg/m3]
    conductivity : float
        [W/(m K)]
    specific_heat : float
        [J/(kg K)]
    """

    density: float
    conductivity: float
    specific_heat: float

    def __post_init__(self) -> None:
        positive("density", self.density, "kg/m3")
        positive("conductivity", self.conductivity, "W/(m K)")
        positive("specific_heat", self.specific_heat, "J/(kg K)")


WATER: Final = Liquid(density=999.0, viscosity=1e-3, conductivity=0.6, specific_heat=4186.0)
"""Water as in S, Table 3."""

POLYSTYRENE: Final = Particles(density=1050.0, conductivity=1.33, specific_heat=1339.0)
"""Polystyrene as in S, Table 3; solid polystyrene usually has about a tenth of this conductivity."""


_NEWTON_STEPS: Final = 12


def mixture_density(volume_fraction: ArrayLike, particle_density: ArrayLike, liquid_density: ArrayLike) -> FloatArray:
    """Density of a slurry, `alpha rho_p + (1 - alpha) rho_l`, which is rho_l (1 + (beta - 1) alpha) (S, eq. 10).

    Parameters
    ----------
    volume_fraction : float or array
        Volume of the particles over that of the slurry, alpha.
    particle_density, liquid_density : float or array
        [kg/m3]

    Returns
    -------
    float or array
        [kg/m3]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    alpha = within("volume_fraction", volume_fraction, 0.0, 1.0)
    solid = positive("particle_density", particle_density, "kg/m3")
    return plain(alpha * solid + (1.0 - alpha) * positive("liquid_density", liquid_density, "kg/m3"))


def mixture_specific_heat(volume_fraction: ArrayLike, particles: Particles, liquid: Liquid) -> FloatArray:
    """Specific heat of a slurry, the mean of both phases by mass: their heats add up.

    Parameters
    ----------
    volume_fraction : float or array
        Volume of the particles over that of the slurry, alpha.
    particles, liquid : Particles, Liquid
        The phases.

    Returns
    -------
    float or array
        [J/(kg K)]

    Raises
    ------
    ValueError
        If the volume fraction is not from 0 to 1.
    """
    alpha = within("volume_fraction", volume_fraction, 0.0, 1.0)
    density = mixture_density(alpha, particles.density, liquid.density)
    mass = alpha * particles.density / density
    return plain(mass * particles.specific_heat + (1.0 - mass) * liquid.specific_heat)


def mixture_conductivity(
    volume_fraction: ArrayLike, particle_conductivity: ArrayLike, liquid_conductivity: ArrayLike
) -> FloatArray:
    """Conductivity of a liquid with few spheres in it (Maxwell 1873, article 314). S names no formula for it.

    `k/k_l = (k_p + 2 k_l + 2 alpha (k_p - k_l))/(k_p + 2 k_l - alpha (k_p - k_l))`.

    Parameters
    ----------
    volume_fraction : float or array
        Volume of the particles over that of the slurry, alpha.
    particle_conductivity, liquid_conductivity : float or array
        k_p and k_l. [W/(m K)]

    Returns
    -------
    float or array
        [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    alpha = within("volume_fraction", volume_fraction, 0.0, 1.0)
    k_p = positive("particle_conductivity", particle_conductivity, "W/(m K)")
    k_l = positive("liquid_conductivity", liquid_conductivity, "W/(m K)")
    excess = alpha * (k_p - k_l)
    return plain(k_l * (k_p + 2.0 * k_l + 2.0 * excess) / (k_p + 2.0 * k_l - excess))


def mixture_viscosity(volume_fraction: ArrayLike, liquid_viscosity: ArrayLike) -> FloatArray:
    """Viscosity of a suspension of spheres (Thomas 1965, J. Colloid Science 20, 267). S names no formula for it.

    `mu/mu_l = 1 + 2.5 alpha + 10.05 alpha^2 + 0.00273 exp(16.6 alpha)`.

    Parameters
    ----------
    volume_fraction : float or array
        Volume of the particles over that of the slurry, alpha.
    liquid_viscosity : float or array
        [Pa s]

    Returns
    -------
    float or array
        [Pa s]; 0.27 % above that of the liquid for no particles, as the fit was published.

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        Above a volume fraction of 0.6.
    """
    alpha = within("volume_fraction", volume_fraction, 0.0, 1.0)
    warn_outside("mixture_viscosity (Thomas 1965): volume_fraction", alpha, 0.0, 0.6)
    ratio = 1.0 + 2.5 * alpha + 10.05 * alpha**2 + 0.00273 * np.exp(16.6 * alpha)
    return plain(positive("liquid_viscosity", liquid_viscosity, "Pa s") * ratio)


def settling_velocity(
    particle_diameter: ArrayLike, particle_density: ArrayLike, liquid: Liquid, gravity: ArrayLike = STANDARD_GRAVITY
) -> FloatArray:
    """Velocity at which a single sphere settles, with the drag of Schiller and Naumann (1935). S names no formula.

    The Reynolds number of the sphere solves `Re (1 + 0.15 Re^0.687) = Ar/18` with the Archimedes number
    `Ar = g d^3 rho_l (rho_p - rho_l)/mu^2`.

    Parameters
    ----------
    particle_diameter : float or array
        [m]
    particle_density : float or array
        [kg/m3]
    liquid : Liquid
        The liquid.
    gravity : float or array
        [m/s2]

    Returns
    -------
    float or array
        Velocity, negative where a particle lighter than the liquid rises. [m/s]

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Above a Reynolds number of 800, the end of the drag law.
    """
    d = positive("particle_diameter", particle_diameter, "m")
    excess = positive("particle_density", particle_density, "kg/m3") - liquid.density
    g = positive("gravity", gravity, "m/s2")
    drive = np.asarray(g * d**3 * liquid.density * np.abs(excess) / (18.0 * liquid.viscosity**2))
    # Newton's method in ln Re from Stokes' law, on a function that is convex and rises with a slope of 1 to 1.687
    x = np.log(np.where(drive > 0.0, drive, 1.0))
    target = x
    for _ in range(_NEWTON_STEPS):
        drag = 0.15 * np.exp(0.687 * x)
        x = x - (x + np.log1p(drag) - target) / (1.0 + 0.687 * drag / (1.0 + drag))
    reynolds = np.where(drive > 0.0, np.exp(x), 0.0)
    warn_outside("settling_velocity (Schiller and Naumann 1935): Reynolds number", reynolds, 0.0, 800.0)
    return plain(np.sign(excess) * reynolds * liquid.viscosity / (liquid.density * d))
