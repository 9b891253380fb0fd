"""Bulk conductivity: the fits of Watkins (2018), the model of Zehner, Bauer and Schluender."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.radiation import STEFAN_BOLTZMANN
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, warn_outside, within

__all__ = [
    "TABLE_2_4",
    "TABLE_5_2",
    "BulkFit",
    "find_fit",
    "measured",
    "modified_free_path",
    "zehner_bauer_schluender",
]


@dataclass(frozen=True)
class BulkFit:
    """A straight line through bulk conductivities, `k_b = slope (T - 273.15 K) + intercept`.

    Parameters
    ----------
    material : str
        Particle material.
    particle_diameter : float
        Particle diameter. [m]
    slope : float
        [W/(m K2)]
    intercept : float
        [W/(m K)]
    lowest, highest : float
        Range of the fit. [K]
    table : str
        Table of Watkins (2018).
    """

    material: str
    particle_diameter: float
    slope: float
    intercept: float
    lowest: float
    highest: float
    table: str

    def conductivity(self, temperature: ArrayLike) -> FloatArray:
        """Bulk conductivity [W/(m K)] at a temperature [K]; warns outside the range of the fit."""
        T = positive("temperature", temperature, "K")
        what = f"bulk conductivity of {self.particle_diameter * 1e6:.0f} um {self.material} (Watkins 2018, "
        warn_outside(f"{what}Table {self.table}): temperature", T, self.lowest, self.highest, "K")
        return plain(self.slope * (T - ZERO_CELSIUS) + self.intercept)


TABLE_2_4 = (
    BulkFit("zirconia-silica", 140e-6, 0.000264, 0.252, 313.15, 873.15, "2.4"),
    BulkFit("zirconia-silica", 270e-6, 0.000248, 0.287, 313.15, 973.15, "2.4"),
    BulkFit("zirconia-silica", 320e-6, 0.000371, 0.281, 313.15, 623.15, "2.4"),
    BulkFit("alumina-silicate", 340e-6, 0.000425, 0.244, 313.15, 793.15, "2.4"),
)
"""Fits to the measurements with the concentric tubes (Watkins 2018, Table 2.4)."""

TABLE_5_2 = (
    BulkFit("zirconia-silica", 270e-6, 0.00031, 0.273, 313.15, 1273.15, "5.2"),
    BulkFit("zirconia-silica", 320e-6, 0.00033, 0.270, 313.15, 1273.15, "5.2"),
)
"""Fits to the model of van Antwerpen, itself fitted to the measurements; radiation included (Watkins 2018,
Table 5.2)."""

_TABLES = {"2.4": TABLE_2_4, "5.2": TABLE_5_2}


def find_fit(particle_diameter: float, material: str = "zirconia-silica", table: str = "5.2") -> BulkFit | None:
    """Find the fit for a particle diameter [m] (to 1 %) and material; None where the table has none."""
    if table not in _TABLES:
        raise ValueError(f"table is {table!r}; expected '2.4' or '5.2'")
    for fit in _TABLES[table]:
        if fit.material == material and math.isclose(fit.particle_diameter, particle_diameter, rel_tol=0.01):
            return fit
    return None


def measured(
    temperature: ArrayLike, particle_diameter: float, material: str = "zirconia-silica", table: str = "5.2"
) -> FloatArray:
    """Bulk conductivity by the fits of Watkins (2018), Table 2.4 (measured) or 5.2 (for high temperatures).

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]
    particle_diameter : float
        Particle diameter, one of the table's. [m]
    material : str
        "zirconia-silica" or "alumina-silicate".
    table : {"5.2", "2.4"}
        Which table.

    Returns
    -------
    float or array
        Bulk conductivity, radiation included. [W/(m K)]

    Raises
    ------
    ValueError
        If the table has no such particles.

    Warns
    -----
    RangeWarning
        Outside the temperatures of the fit.
    """
    fit = find_fit(particle_diameter, material, table)
    if fit is None:
        have = ", ".join(f"{f.particle_diameter * 1e6:.0f} um {f.material}" for f in _TABLES[table])
        raise ValueError(
            f"particle_diameter is {particle_diameter * 1e6:g} um ({material}); Table {table} has {have}; "
            "use zehner_bauer_schluender for others"
        )
    return fit.conductivity(temperature)


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


def _logarithm_rest(q: FloatArray) -> FloatArray:
    """(ln(1 + q) - q + q^2/2)/q^3, which is 1/3 at q = 0."""
    small = np.abs(q) < 0.25
    series = np.zeros_like(q)
    for n in range(28, 2, -1):
        series = series * np.where(small, -q, 0.0) + 1.0 / n
    safe = np.where(small, 1.0, q)
    return np.asarray(np.where(small, series, (np.log1p(safe) - safe + 0.5 * safe**2) / safe**3))


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
) -> FloatArray:
    """Conductivity of a bed of spheres with stagnant gas (Zehner, Bauer, Schluender; VDI Heat Atlas, D6.3).

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
        Emissivity of the particle surface, above 0 to 1.
    contact : float or array
        Share of the core that conducts through flattened contacts, phi (0.0077 for steel).
    free_path : float or array
        Modified mean free path of the gas (see `modified_free_path`); 0 leaves out the Smoluchowski effect.
        [m]
    radiation : bool
        Radiation from particle to particle included.

    Returns
    -------
    float or array
        Bulk conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    K = positive("solid_conductivity", solid_conductivity, "W/(m K)") / gas
    eps = within("porosity", positive("porosity", porosity), 0.0, 1.0, open_above=True)
    d = positive("particle_diameter", particle_diameter, "m")
    T = positive("temperature", temperature, "K")
    e = within("emissivity", positive("emissivity", emissivity), 0.0, 1.0)
    phi = within("contact", contact, 0.0, 1.0)
    k_gap = 1.0 / (1.0 + non_negative("free_path", free_path, "m") / d)
    k_rad = 4.0 * STEFAN_BOLTZMANN * T**3 * d / ((2.0 / e - 1.0) * gas) * float(radiation)
    B = 1.25 * ((1.0 - eps) / eps) ** (10.0 / 9.0)
    # The atlas divides by powers of N, which passes through 0; with g and m below N = B g (m - 1)/(K k_gap),
    # and the terms that cancel at N = 0 are taken out by hand.
    g = k_gap + (1.0 - k_gap) * (K + k_rad)
    m = np.asarray((K + k_rad) / (B * g))
    rest = K / (B * g) * ((B * m - 1.0) * _logarithm_rest(m - 1.0) - 0.5 * B)
    rest = rest + 0.5 * (B + 1.0) * (1.0 + (1.0 - k_gap) * k_rad / k_gap)
    core = 2.0 * K * k_gap / (B * g) * rest
    root = np.sqrt(1.0 - eps)
    voids = (1.0 - root) * eps * (1.0 / (eps - 1.0 + 1.0 / k_gap) + k_rad)
    return plain(gas * (voids + root * (phi * K + (1.0 - phi) * core)))
