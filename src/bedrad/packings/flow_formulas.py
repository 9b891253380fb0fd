"""Laws of granular flow that a run is held against: discharge through an orifice, pressure in a tube."""

from __future__ import annotations

import math

__all__ = ["beverloo_discharge", "janssen_pressure"]


def beverloo_discharge(
    orifice: float,
    diameter: float,
    bulk_density: float,
    gravity: float = 9.81,
    coefficient: float = 0.58,
    empty_annulus: float = 1.4,
) -> float:
    """Mass flow through a round orifice in a flat floor (Beverloo, Leniger and van de Velde 1961).

    Parameters
    ----------
    orifice : float
        Diameter of the orifice. [m]
    diameter : float
        Diameter of the spheres. [m]
    bulk_density : float
        Density of the bed, solid fraction times density of the spheres. [kg/m3]
    gravity : float
        Acceleration of gravity. [m/s2]
    coefficient, empty_annulus : float
        C (0.55 to 0.65) and k (about 1.4 for spheres) of the law.

    Returns
    -------
    float
        ``C rho_b sqrt(g) (D_o - k d)^2.5``; 0 where the orifice is narrower than k d. [kg/s]
    """
    opening = max(orifice - empty_annulus * diameter, 0.0)
    return float(coefficient * bulk_density * math.sqrt(gravity) * opening**2.5)


def janssen_pressure(bulk_density: float, gravity: float, tube_diameter: float, wall_friction: float) -> float:
    """Pressure on the wall deep in a tube whose wall carries all the weight (Janssen 1895).

    Parameters
    ----------
    bulk_density : float
        Density of the bed. [kg/m3]
    gravity : float
        Acceleration of gravity. [m/s2]
    tube_diameter : float
        Inner diameter of the tube. [m]
    wall_friction : float
        Coefficient of friction with the wall, taken as fully mobilised.

    Returns
    -------
    float
        ``rho_b g D/(4 mu_w)``. [Pa]
    """
    return bulk_density * gravity * tube_diameter / (4.0 * wall_friction) if wall_friction else math.inf
