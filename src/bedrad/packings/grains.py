"""What the spheres of a DEM run are and how they meet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bedrad.walls import Tube, Wall

__all__ = ["Grains", "Mixture", "check_number", "check_seed", "mixture_of", "tube_for"]

Mixture = list[tuple[float, float]]
"""Diameter [m] and number fraction of each size; the fractions add up to one."""

_DIAMETER = 600e-6


@dataclass(frozen=True)
class Grains:
    """What the spheres are and how they meet.

    Parameters
    ----------
    density : float
        Density of the spheres. [kg/m3]
    friction : float
        Coefficient of friction between spheres.
    wall_friction : float or None
        Coefficient of friction between spheres and wall; None takes `friction`.
    restitution : float
        Coefficient of restitution of head-on collisions.
    stiffness : float or None
        Stiffness of the normal spring; None takes the softened one. [N/m]
    gravity : float
        Acceleration of gravity. [m/s2]
    youngs_modulus : float or None
        Young's modulus of spheres and wall, for Hertz contacts in place of linear springs. [Pa]
    poisson_ratio : float
        Poisson's ratio, for Hertz contacts.

    Raises
    ------
    ValueError
        If one of them is out of range.
    """

    density: float
    friction: float
    wall_friction: float | None
    restitution: float
    stiffness: float | None
    gravity: float
    youngs_modulus: float | None = None
    poisson_ratio: float = 0.3

    def __post_init__(self) -> None:
        for name in ("density", "gravity", "stiffness", "youngs_modulus"):
            value = getattr(self, name)
            left_open = value is None and name in ("stiffness", "youngs_modulus")
            check_number(name, value, left_open or value > 0, "a positive number")
        for name in ("friction", "wall_friction"):
            value = getattr(self, name)
            left_open = value is None and name == "wall_friction"
            check_number(name, value, left_open or 0 <= value <= 1e4, "a number from 0 to 10000")
        inside = 0 < self.restitution < 1
        check_number("restitution", self.restitution, inside, "a number between 0 and 1, both excluded")
        check_number("poisson_ratio", self.poisson_ratio, 0 <= self.poisson_ratio < 0.5, "a number from 0 to below 0.5")
        if self.stiffness is not None and self.youngs_modulus is not None:
            raise ValueError(
                f"stiffness {self.stiffness!r} N/m and youngs_modulus {self.youngs_modulus!r} Pa were both given; "
                "expected one of them"
            )

    @property
    def friction_with_wall(self) -> float:
        """Coefficient of friction between spheres and wall."""
        return float(self.friction if self.wall_friction is None else self.wall_friction)


def check_number(name: str, value: object, fits: bool, expected: str) -> None:
    """Refuse a value that is not finite or does not fit; None has been allowed where it `fits`.

    Raises
    ------
    ValueError
        With the name, the value and what was expected.
    """
    finite = value is None or (isinstance(value, (int, float)) and math.isfinite(value))
    if not (fits and finite):
        raise ValueError(f"{name} is {value!r}; expected {expected}")


def check_seed(seed: object) -> int:
    """Return a seed that is an integer and not negative; a ValueError otherwise."""
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise ValueError(f"seed is {seed!r}; expected an integer that is not negative")
    return int(seed)


def mixture_of(diameter: float | None, sizes: Sequence[tuple[float, float]] | None) -> Mixture:
    """Return diameters [m] and number fractions that add up to one, from what a user gave.

    Parameters
    ----------
    diameter : float or None
        Diameter of all spheres; 600 um if `sizes` is not given either. [m]
    sizes : sequence of (float, float) or None
        In place of `diameter`: diameter [m] and number fraction of each size.

    Raises
    ------
    ValueError
        If both are given, a number is not positive, a size comes twice, or the fractions do not add up to one.
    """
    if sizes is None:
        chosen = _DIAMETER if diameter is None else diameter
        check_number("diameter", chosen, chosen > 0, "a positive number of metres")
        return [(float(chosen), 1.0)]
    if diameter is not None:
        raise ValueError(f"diameter {diameter!r} m and sizes were both given; expected one of them")
    pairs = [(float(d), float(share)) for d, share in sizes]
    for d, share in pairs:
        check_number("sizes: diameter", d, d > 0, "a positive number of metres")
        check_number("sizes: number fraction", share, share > 0, "a positive number")
    total = sum(share for _, share in pairs)
    if not math.isclose(total, 1.0, rel_tol=1e-6):
        raise ValueError(f"sizes: the number fractions add up to {total:.8g}; expected 1")
    if len({d for d, _ in pairs}) < len(pairs):
        raise ValueError("sizes: a diameter comes twice")
    return [(d, share / total) for d, share in pairs]


def tube_for(wall: Wall, mixture: Mixture, done: str) -> Tube:
    """Return the wall if it is a tube that holds the largest sphere; `done` says what is done there, in messages."""
    if not isinstance(wall, Tube):
        raise ValueError(f"wall is {wall!r}; spheres are {done} in a Tube only")  # noqa: TRY004
    largest = max(d for d, _ in mixture)
    if largest >= 2.0 * wall.radius:
        raise ValueError(f"a sphere of {largest:.6g} m does not fit into a tube of {2.0 * wall.radius:.6g} m diameter")
    return wall
