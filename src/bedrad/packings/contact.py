"""The linear spring and dashpot contact of soft-sphere DEM: softened stiffness, damping, duration, time step.

Two spheres of effective mass m that meet head-on obey ``m x'' + m gamma x' + k x = 0`` until the overlap x is
zero again (Cundall and Strack 1979; Silbert et al. 2001, eqs. 1-5).
"""

from __future__ import annotations

import math

__all__ = [
    "STEPS_PER_CONTACT",
    "TANGENTIAL_SHARE",
    "contact_duration",
    "damping_rate",
    "damping_ratio",
    "effective_mass",
    "hertz_duration",
    "softened_stiffness",
    "softening_rule",
    "sphere_mass",
]

TANGENTIAL_SHARE = 2.0 / 7.0
"""Tangential over normal stiffness; both springs of a solid sphere then swing in step (Silbert 2001)."""

STEPS_PER_CONTACT = 20
"""Time steps in the shortest contact; the restitution comes out within 0.02 of the one asked for."""

_STIFFNESS = 100.0
_DENSITY = 3800.0
_GRAVITY = 9.81
_DIAMETER = 6e-4
_TUBE_DIAMETER = 7.75e-3
_DEEPEST_IMPACT = 0.1
"""Overlap in diameters of two spheres that meet at the highest speed of the fall."""


def sphere_mass(diameter: float, density: float) -> float:
    """Mass of a sphere. [kg]."""
    return density * math.pi / 6.0 * diameter**3


def effective_mass(first: float, second: float = math.inf) -> float:
    """Effective mass of two bodies that meet; a wall has an infinite mass. [kg]."""
    return first if math.isinf(second) else first * second / (first + second)


def softened_stiffness(
    diameter: float, density: float, gravity: float, tube_diameter: float, fall_height: float
) -> float:
    """Choose a normal stiffness that keeps overlaps small without tiny time steps.

    Real grains are some thousand times stiffer. The first rule gives every bed the overlaps (in diameters) of
    the reference bed, 0.6 mm zirconia-silica in a 7.75 mm tube at 100 N/m, where the mean is 0.1 % and the
    largest about 1.5 %: the pressure in a tall tube grows as density, gravity and tube diameter do (Janssen
    1895), the force on a contact with the diameter squared. The second limits the overlap of two spheres that
    meet at the speed of the fall to a tenth of a diameter, and decides where the fall is longer than eleven
    tube diameters.

    Parameters
    ----------
    diameter : float
        Diameter of the (largest) spheres. [m]
    density : float
        Density of the spheres. [kg/m3]
    gravity : float
        Acceleration of gravity. [m/s2]
    tube_diameter : float
        Inner diameter of the tube. [m]
    fall_height : float
        How far the highest sphere falls. [m]

    Returns
    -------
    float
        Stiffness of the normal spring. [N/m]
    """
    load = (
        _STIFFNESS
        * (density / _DENSITY)
        * (gravity / _GRAVITY)
        * (diameter / _DIAMETER)
        * (tube_diameter / _TUBE_DIAMETER)
    )
    mass = sphere_mass(diameter, density)
    impact = effective_mass(mass, mass) * 2.0 * gravity * fall_height / (_DEEPEST_IMPACT * diameter) ** 2
    return max(load, impact)


def softening_rule() -> str:
    """Say the rule of `softened_stiffness` in words, for the provenance."""
    return (
        f"softened: the larger of {_STIFFNESS:g} N/m (density / {_DENSITY:g} kg/m3) "
        f"(gravity / {_GRAVITY:g} m/s2) (largest diameter / {_DIAMETER:g} m) "
        f"(tube diameter / {_TUBE_DIAMETER:g} m) and the stiffness at which two spheres that meet at "
        f"the speed of the fall overlap by {_DEEPEST_IMPACT:g} diameters"
    )


def damping_ratio(restitution: float) -> float:
    """Share of critical damping that gives this restitution head-on: ``-ln e / sqrt(pi^2 + ln^2 e)``."""
    return -math.log(restitution) / math.hypot(math.pi, math.log(restitution))


def damping_rate(stiffness: float, mass: float, restitution: float) -> float:
    """Rate gamma in the damping force ``m gamma v``, from the restitution. [1/s]."""
    return 2.0 * damping_ratio(restitution) * math.sqrt(stiffness / mass)


def contact_duration(stiffness: float, mass: float, restitution: float) -> float:
    """Half a period of the damped spring. [s]."""
    ratio = damping_ratio(restitution)
    return math.pi / math.sqrt(stiffness / mass * (1.0 - ratio) * (1.0 + ratio))


def hertz_duration(youngs_modulus: float, poisson_ratio: float, diameter: float, density: float, speed: float) -> float:
    """Duration of the elastic head-on impact of two equal spheres with Hertz contacts (Johnson 1985, eq. 11.24).

    Parameters
    ----------
    youngs_modulus, poisson_ratio : float
        Elastic constants of both. [Pa], -
    diameter, density : float
        Diameter [m] and density [kg/m3] of the spheres.
    speed : float
        Relative speed before the impact. [m/s]

    Returns
    -------
    float
        [s]
    """
    mass = sphere_mass(diameter, density) / 2.0
    radius = diameter / 4.0
    modulus = youngs_modulus / (2.0 * (1.0 - poisson_ratio**2))
    return 2.87 * math.pow(mass * mass / (radius * modulus * modulus * speed), 0.2)
