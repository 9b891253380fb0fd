"""The contact laws of a DEM run as LAMMPS takes them: commands for the spheres, a style for the wall."""

from __future__ import annotations

from bedrad.packings.contact import TANGENTIAL_SHARE, damping_rate, effective_mass, sphere_mass

__all__ = ["SKIN", "hertz_contacts", "linear_contacts"]

SKIN = 0.2
"""Skin of the neighbour lists, in mean diameters: .08 costs a quarter more time, .15 to .25 make no difference."""


def linear_contacts(
    stiffness: float,
    restitution: float,
    friction: float,
    wall_friction: float,
    density: float,
    diameter: float | None,
) -> tuple[str, str]:
    """Linear springs and dashpots between spheres (two commands) and with the wall (a style and its numbers).

    Equal spheres take gran/hooke/history, whose damping rate is one number for all contacts. Unlike ones need the
    granular style, half as fast, where the damping follows from the restitution and the masses of each contact.
    The wall always takes the granular style: up to the release of 22 July 2025 (update 4), fix wall/gran with
    hooke/history multiplies the tangential spring by the contact radius (lammps pull request 5007). In SI units
    that is a factor of 1e-5: such a wall has no static friction, and the wall layer comes out too dense.

    Parameters
    ----------
    stiffness : float
        Stiffness of the normal spring. [N/m]
    restitution, friction, wall_friction : float
        Restitution head-on; friction between spheres, and between spheres and wall.
    density : float
        Density of the spheres. [kg/m3]
    diameter : float or None
        The one diameter of all spheres; None for a mixture. [m]
    """
    tangential = TANGENTIAL_SHARE * stiffness
    between, wall = (
        f"hooke {stiffness!r} {restitution!r} tangential linear_history {tangential!r} 0.5 {coefficient!r} "
        "damping coeff_restitution"
        for coefficient in (friction, wall_friction)
    )
    if diameter is not None:
        mass = sphere_mass(diameter, density)
        rate = damping_rate(stiffness, effective_mass(mass, mass), restitution)
        numbers = f"{stiffness!r} {tangential!r} {rate!r} {rate / 2.0!r} {friction!r} 1"
        return f"pair_style      gran/hooke/history {numbers}\npair_coeff      * *", f"granular {wall}"
    return f"pair_style      granular\npair_coeff      * * {between}", f"granular {wall}"


def hertz_contacts(
    youngs_modulus: float, poisson_ratio: float, restitution: float, friction: float, wall_friction: float
) -> tuple[str, str]:
    """Hertz contacts with Mindlin's tangential spring, between spheres and with a wall of the same material.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus. [Pa]
    poisson_ratio, restitution, friction, wall_friction : float
        Poisson's ratio; restitution head-on; friction between spheres, and between spheres and wall.
    """
    between, wall = (
        f"hertz/material {youngs_modulus!r} {restitution!r} {poisson_ratio!r} tangential mindlin NULL 1.0 "
        f"{coefficient!r} damping coeff_restitution"
        for coefficient in (friction, wall_friction)
    )
    return f"pair_style      granular\npair_coeff      * * {between}", f"granular {wall}"
