"""Conductivity of a bed of spheres in a stagnant gas by the unit cell of Zehner, Bauer and Schluender.

Conduction alone (Zehner and Schluender 1970), and with the radiation, contacts and Smoluchowski effect that Bauer added
(Bauer and Schluender 1978; VDI Heat Atlas, D6.3).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.radiation import STEFAN_BOLTZMANN
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within

__all__ = [
    "conductivity_ratio",
    "deformation",
    "logarithm_rest",
    "modified_free_path",
    "void_fraction",
    "zehner_bauer_schluender",
    "zehner_schluender",
]


def modified_free_path(
    temperature: ArrayLike,
    gas_conductivity: ArrayLike,
    pressure: ArrayLike = 101325.0,
    molar_mass: ArrayLike = 0.028964,
    specific_heat: ArrayLike = 1003.5,
    accommodation: ArrayLike = 1.0,
) -> FloatArray:
    """Mean free path of a gas as the Smoluchowski effect in narrow gaps needs it (VDI Heat Atlas, D6.3).

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]
    gas_conductivity : float or array
        Conductivity of the gas. [W/(m K)]
    pressure : float or array
        Pressure. [Pa]
    molar_mass : float or array
        Molar mass, default air. [kg/mol]
    specific_heat : float or array
        Specific heat at constant pressure, default air. [J/(kg K)]
    accommodation : float or array
        Thermal accommodation coefficient, above 0 to 1.

    Returns
    -------
    float or array
        l [m]; it lowers the conductivity of the gas across a gap of width s to k_g/(1 + l/s).

    Raises
    ------
    ValueError
        If an input is not positive or the accommodation above 1.
    """
    gas_constant = 8.314462618 / positive("molar_mass", molar_mass, "kg/mol")
    T = positive("temperature", temperature, "K")
    share = within("accommodation", positive("accommodation", accommodation), 0.0, 1.0)
    speed = np.sqrt(2.0 * math.pi * gas_constant * T)
    capacity = 2.0 * positive("specific_heat", specific_heat, "J/(kg K)") - gas_constant
    k_g = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    return plain(2.0 * (2.0 - share) / share * speed * k_g / (positive("pressure", pressure, "Pa") * capacity))


def logarithm_rest(q: FloatArray) -> FloatArray:
    """(ln(1 + q) - q + q^2/2)/q^3, which is 1/3 at q = 0."""
    small = np.abs(q) < 0.25
    series = np.zeros_like(q)
    for n in range(28, 2, -1):
        series = series * np.where(small, -q, 0.0) + 1.0 / n
    safe = np.where(small, 1.0, q)
    return np.asarray(np.where(small, series, (np.log1p(safe) - safe + 0.5 * safe**2) / safe**3))


def conductivity_ratio(gas_conductivity: ArrayLike, solid_conductivity: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Conductivity of the gas, and that of the solid over it."""
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    return gas, np.asarray(positive("solid_conductivity", solid_conductivity, "W/(m K)") / gas)


def void_fraction(porosity: ArrayLike) -> FloatArray:
    """Porosity as floats, refused unless between 0 and 1."""
    return within("porosity", positive("porosity", porosity), 0.0, 1.0, open_above=True)


def deformation(porosity: ArrayLike, shape: ArrayLike = 1.25) -> FloatArray:
    """Deformation parameter of Zehner and Schluender's unit cell, `B = C ((1 - eps)/eps)^(10/9)`.

    Parameters
    ----------
    porosity : float or array
        Void fraction of the bed, between 0 and 1.
    shape : float or array
        C: 1.25 for spheres, 1.4 for broken particles, 2.5 for cylinders (VDI Heat Atlas, D6.3).

    Returns
    -------
    float or array
        B.

    Raises
    ------
    ValueError
        If the porosity is not between 0 and 1 or the shape not positive.
    """
    # below 1e-200 nothing changes but B, which would overflow
    eps = np.maximum(void_fraction(porosity), 1e-200)
    return plain(positive("shape", shape) * ((1.0 - eps) / eps) ** (10.0 / 9.0))


def _core(K: FloatArray, B: FloatArray, k_rad: FloatArray, slip: FloatArray) -> FloatArray:
    """Conductivity over that of the gas of the core of the unit cell, spheres and the gas between them.

    `slip` is the free path over the diameter, so the atlas' k_gap is 1/(1 + slip). The atlas divides by powers of
    N = B g (m - 1)/(K k_gap), which passes through 0. Away from there the printed form is used; near it, one in
    which the terms that cancel are taken out by hand.
    """
    k_gap = 1.0 / (1.0 + slip)
    S = K + k_rad
    g = k_gap * (1.0 + slip * S)
    m = S / (B * g)
    near = np.abs(m - 1.0) < 0.25
    inverse = K / (B * g)  # (m - 1)/(N k_gap)
    rest = inverse * ((B * m - 1.0) * logarithm_rest(np.where(near, m - 1.0, 0.0)) - 0.5 * B)
    rest = rest + 0.5 * (B + 1.0) * (1.0 + slip * k_rad)
    q = np.where(near, 1.0, m - 1.0)
    printed = (S - 1.0) * inverse * k_gap / g / q / q * np.log(m)
    printed = printed + 0.5 * (B + 1.0) / B * (k_rad * (1.0 + slip - B * slip) - B)
    printed = printed - (B - 1.0) * inverse / q
    return np.asarray(2.0 * inverse * k_gap * np.where(near, rest, printed / q))


def zehner_schluender(
    gas_conductivity: ArrayLike, solid_conductivity: ArrayLike, porosity: ArrayLike, shape: ArrayLike = 1.25
) -> FloatArray:
    """Conductivity of a bed of spheres by conduction alone (Zehner and Schluender 1970, 1972).

    Chem. Ing. Tech. 42, 933-941 and 44, 1303-1308. With K = k_s/k_g, B = `deformation` and N = 1 - B/K,

    `k_e/k_g = 1 - sqrt(1-eps) + 2 sqrt(1-eps)/N [(1 - 1/K) B/N^2 ln(K/B) - (B+1)/2 - (B-1)/N]`.

    Point contacts: k_e grows with ln K. No range is checked; the constant C was fitted to measured beds. A bed
    of K = 1 conducts like the gas, exactly.

    Parameters
    ----------
    gas_conductivity, solid_conductivity : float or array
        Conductivities of gas and solid. [W/(m K)]
    porosity : float or array
        Void fraction of the bed, between 0 and 1.
    shape : float or array
        Shape constant C, see `deformation`.

    Returns
    -------
    float or array
        Bulk conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    gas, K = conductivity_ratio(gas_conductivity, solid_conductivity)
    eps = void_fraction(porosity)
    core = _core(K, np.asarray(deformation(eps, shape)), np.zeros(()), np.zeros(()))
    root = np.sqrt(1.0 - eps)
    return plain(gas * (eps / (1.0 + root) + root * core))


def zehner_bauer_schluender(
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    porosity: ArrayLike,
    particle_diameter: ArrayLike,
    temperature: ArrayLike,
    emissivity: ArrayLike = 0.8,
    contact: ArrayLike = 0.0,
    free_path: ArrayLike = 0.0,
    *,
    radiation: bool = True,
    shape: ArrayLike = 1.25,
) -> FloatArray:
    """Conductivity of a bed of spheres with stagnant gas (Zehner, Bauer, Schluender; VDI Heat Atlas, D6.3).

    Zehner and Schluender's unit cell with radiation, flattened contacts and the Smoluchowski effect. The
    radiation of a cell is `4 sigma T^3 d/(2/e - 1)`. Made for beds, porosities from 0.26 to some 0.6; with
    radiation the model's core diverges as the porosity goes to 1, like (1 - eps)^(-11/18).

    Parameters
    ----------
    gas_conductivity, solid_conductivity : float or array
        Conductivities of gas and solid. [W/(m K)]
    porosity : float or array
        Void fraction of the bed, between 0 and 1.
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.
    contact : float or array
        Share of the core that conducts through flattened contacts, phi (0.0077 for steel).
    free_path : float or array
        Modified mean free path of the gas (see `modified_free_path`); 0 leaves out the Smoluchowski effect.
        [m]
    radiation : bool
        Radiation from particle to particle included.
    shape : float or array
        Shape constant C, see `deformation`.

    Returns
    -------
    float or array
        Bulk conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    gas, K = conductivity_ratio(gas_conductivity, solid_conductivity)
    eps = void_fraction(porosity)
    d = positive("particle_diameter", particle_diameter, "m")
    T = positive("temperature", temperature, "K")
    e = within("emissivity", emissivity, 0.0, 1.0)
    phi = within("contact", contact, 0.0, 1.0)
    slip = np.asarray(non_negative("free_path", free_path, "m") / d)
    k_rad = np.asarray(4.0 * STEFAN_BOLTZMANN * T**3 * d * e / ((2.0 - e) * gas) * float(radiation))
    core = _core(K, np.asarray(deformation(eps, shape)), k_rad, slip)
    root = np.sqrt(1.0 - eps)
    voids = eps / (1.0 + root) * eps * (1.0 / (eps + slip) + k_rad)
    return plain(gas * (voids + root * (phi * K + (1.0 - phi) * core)))
