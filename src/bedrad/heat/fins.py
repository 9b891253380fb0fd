"""Tubes with annular fins of rectangular profile: fin efficiency and areas (Nguyen 2015, eq. 6-9 to 6-15)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = ["FinnedTube", "annular_fin_efficiency", "corrected_radius", "fin_parameter"]

_LARGEST = 1e8
"""Largest m r of the scaled Bessel functions; a fin is flat and endless long before."""

_SMALLEST = 1e-60
"""Smallest m r that the Bessel functions are asked for; the efficiency is 1 to rounding long before."""

_TERMS = 40
"""Terms of the series for short fins, which converges like (s^n, (x s)^n/n!) with s <= 0.1 and x s <= 2."""


def fin_parameter(coefficient: ArrayLike, conductivity: ArrayLike, thickness: ArrayLike) -> FloatArray:
    """Fin parameter m = sqrt(2 h/(k t)) (Nguyen 2015, eq. 6-15).

    Parameters
    ----------
    coefficient : float or array
        Heat transfer coefficient at the surface of the fin. [W/(m2 K)]
    conductivity : float or array
        Conductivity of the fin. [W/(m K)]
    thickness : float or array
        Thickness of the fin. [m]

    Returns
    -------
    float or array
        m. [1/m]

    Raises
    ------
    ValueError
        If the coefficient is negative, or another input is not positive.
    """
    h = non_negative("coefficient", coefficient, "W/(m2 K)")
    k = positive("conductivity", conductivity, "W/(m K)")
    return plain(np.sqrt(2.0 * h / k / positive("thickness", thickness, "m")))


def corrected_radius(outer_radius: ArrayLike, thickness: ArrayLike) -> FloatArray:
    """Radius of a fin with an insulated tip that has the area of the tip on its faces (Nguyen 2015, eq. 6-11).

    Parameters
    ----------
    outer_radius, thickness : float or array
        Radius and thickness of the fin. [m]

    Returns
    -------
    float or array
        r_2c = r_2 + t/2. [m]

    Raises
    ------
    ValueError
        If the radius is not positive or the thickness negative.
    """
    radius = positive("outer_radius", outer_radius, "m")
    return plain(radius + 0.5 * non_negative("thickness", thickness, "m"))


def annular_fin_efficiency(inner_radius: ArrayLike, outer_radius: ArrayLike, fin_parameter: ArrayLike) -> FloatArray:
    """Efficiency of an annular fin with an insulated tip (Nguyen 2015, eq. 6-14 with its misprints put right).

    With x = m r_1 and y = m r_2c: 2 x/(y^2 - x^2) (K1(x) I1(y) - I1(x) K1(y))/(I0(x) K1(y) + K0(x) I1(y)), in scaled
    Bessel functions that neither overflow nor vanish. Where the difference in the numerator would cancel it is
    summed as a power series instead.

    Parameters
    ----------
    inner_radius : float or array
        Radius of the tube, where the fin starts. [m]
    outer_radius : float or array
        Radius of the fin, corrected for its tip (`corrected_radius`). [m]
    fin_parameter : float or array
        m = sqrt(2 h/(k t)), zero for a perfect conductor (see the function `fin_parameter`). [1/m]

    Returns
    -------
    float or array
        Heat of the fin over that of a fin with the temperature of the tube throughout, from 0 to 1.

    Raises
    ------
    ValueError
        If a radius is not positive, the outer one is smaller, m is negative, or m times the outer radius is above
        1e8.
    """
    r1, r2 = positive("inner_radius", inner_radius, "m"), positive("outer_radius", outer_radius, "m")
    m = non_negative("fin_parameter", fin_parameter, "1/m")
    r1, r2, m = np.broadcast_arrays(r1, r2, m)
    if np.any(r2 < r1):
        i = int(np.argmax(r2 < r1))
        raise ValueError(f"outer_radius is {r2.flat[i]:g} m; expected at least inner_radius, {r1.flat[i]:g} m")
    if np.any(m * r2 > _LARGEST):
        raise ValueError(
            f"fin_parameter times outer_radius is {float(np.max(m * r2)):g}; expected at most {_LARGEST:g}"
        )
    x = np.asarray(m * r1)
    s = np.asarray((r2 - r1) / r1)
    whole = (m * r2 < _SMALLEST) | (r2 == r1)
    x = np.where(whole, 1.0, x)
    s = np.where(whole, 0.0, s)
    short = (s <= 0.1) & (x * s <= 2.0)
    efficiency = np.where(short, _short_fin(np.where(short, x, 1.0), np.where(short, s, 0.0)), _long_fin(x, s, ~short))
    return plain(np.where(whole, 1.0, np.minimum(efficiency, 1.0)))


def _long_fin(x: FloatArray, s: FloatArray, used: ArrayLike) -> FloatArray:
    """Efficiency with x = m r_1 and s = r_2c/r_1 - 1, from scaled Bessel functions."""
    s = np.where(used, s, 1.0)
    y = np.asarray(x * (1.0 + s))
    back = np.exp(-2.0 * x * s)
    i0, k0 = special.ive(0, x), special.kve(0, x)
    i1, k1 = special.ive(1, x), special.kve(1, x)
    i1_tip, k1_tip = special.ive(1, y), special.kve(1, y)
    numerator = k1 * i1_tip - back * i1 * k1_tip
    denominator = k0 * i1_tip + back * i0 * k1_tip
    return np.asarray(2.0 / ((x * s) * (2.0 + s)) * numerator / denominator)


def _short_fin(x: FloatArray, s: FloatArray) -> FloatArray:
    """The same where the fin is short: K1(x) I1(y) - I1(x) K1(y) as a power series in s.

    With y = x (1 + s) it solves (1+s)^2 c'' + (1+s) c' - (x^2 (1+s)^2 + 1) c = 0 with c = 0 and, by the Wronskian,
    c' = 1 at s = 0.
    """
    # the terms b = a_n s^(n-1) of c/s rather than its coefficients, which overflow for a large x
    xs = np.asarray((x * s) ** 2)
    b = [np.zeros_like(s), np.zeros_like(s), np.zeros_like(s), np.ones_like(s)]
    total = np.ones_like(s)
    for n in range(_TERMS):
        following = -(n + 1.0) * (2.0 * n + 1.0) * s * b[3] - ((n * n - 1.0) * s * s - xs) * b[2]
        following = (following + 2.0 * xs * s * b[1] + xs * s * s * b[0]) / ((n + 2.0) * (n + 1.0))
        b = [*b[1:], following]
        total = total + following
    y = np.asarray(x * (1.0 + s))
    grown, fallen = np.exp(x * s), np.exp(-x * s)
    denominator = grown * special.kve(0, x) * special.ive(1, y) + fallen * special.ive(0, x) * special.kve(1, y)
    return np.asarray(2.0 * total / (x * (2.0 + s)) / denominator)


@dataclass(frozen=True)
class FinnedTube:
    """A tube with annular fins of rectangular profile.

    Parameters
    ----------
    base_radius : float
        Outer radius of the tube, where the fins start. [m]
    fin_radius : float
        Outer radius of the fins. [m]
    fin_thickness : float
        Thickness of a fin. [m]
    fins : float
        Number of fins.
    length : float
        Length of the tube. [m]
    conductivity : float
        Conductivity of the fins. [W/(m K)]
    """

    base_radius: float
    fin_radius: float
    fin_thickness: float
    fins: float
    length: float
    conductivity: float

    def __post_init__(self) -> None:
        for name, unit in (
            ("base_radius", "m"),
            ("fin_radius", "m"),
            ("fin_thickness", "m"),
            ("length", "m"),
            ("conductivity", "W/(m K)"),
        ):
            positive(name, getattr(self, name), unit)
        non_negative("fins", self.fins)
        if self.fin_radius < self.base_radius:
            raise ValueError(
                f"fin_radius is {self.fin_radius:g} m; expected at least base_radius, {self.base_radius:g} m"
            )
        if self.base_area <= 0.0:
            raise ValueError(
                f"{self.fins:g} fins of {self.fin_thickness:g} m cover the whole length of {self.length:g} m; "
                "expected some tube between them"
            )

    @property
    def corrected_radius(self) -> float:
        """Fin radius corrected for the tip (eq. 6-11). [m]"""
        return self.fin_radius + 0.5 * self.fin_thickness

    @property
    def base_area(self) -> float:
        """Area of the tube between the fins (eq. 6-9). [m2]"""
        return 2.0 * math.pi * self.base_radius * (self.length - self.fins * self.fin_thickness)

    @property
    def fin_area(self) -> float:
        """Area of one fin, both faces and the tip (eq. 6-10). [m2]"""
        return 2.0 * math.pi * (self.corrected_radius**2 - self.base_radius**2)

    @property
    def total_area(self) -> float:
        """Area of tube and fins (eq. 6-12). [m2]"""
        return self.base_area + self.fins * self.fin_area

    @property
    def bare_area(self) -> float:
        """Area of the tube without fins (eq. 6-1). [m2]"""
        return 2.0 * math.pi * self.base_radius * self.length

    def efficiency(self, coefficient: ArrayLike) -> FloatArray:
        """Efficiency of the fins at a heat transfer coefficient [W/(m2 K)] (eq. 6-14, 6-15)."""
        m = fin_parameter(coefficient, self.conductivity, self.fin_thickness)
        return annular_fin_efficiency(self.base_radius, self.corrected_radius, m)

    def effective_area(self, coefficient: ArrayLike) -> FloatArray:
        """Area of tube and fins, the latter times their efficiency (eq. 6-13). [m2]"""
        return plain(self.base_area + self.fins * self.fin_area * self.efficiency(coefficient))
