"""Dry air at atmospheric pressure by published fits, and any gas that CoolProp knows (extra `gas`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import gas_coolprop
from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside, within

__all__ = [
    "AIR_GAS_CONSTANT",
    "AIR_RANGE",
    "ATMOSPHERE",
    "IDEAL_AIR_RANGE",
    "GasProperties",
    "air_conductivity",
    "air_density",
    "air_prandtl_number",
    "air_properties",
    "air_specific_heat",
    "air_viscosity",
    "properties",
]

AIR_RANGE = (85.0, 2000.0)
"""Temperatures of the correlations for conductivity and viscosity. [K]"""

IDEAL_AIR_RANGE = (200.0, 2000.0)
"""Temperatures at which air of 101.325 kPa is an ideal gas to 0.5 % in density and specific heat. [K]"""

ATMOSPHERE = 101325.0
"""Standard atmosphere. [Pa]"""

AIR_GAS_CONSTANT = 287.05
"""Gas constant of dry air, 8.314463 J/(mol K) over 28.965 g/mol. [J/(kg K)]"""

# Kadoya, Matsunaga, Nagashima 1985: reducing temperature and density, scales, powers of T/132.5 K with their
# coefficients, coefficients of rising powers of the reduced density
_TEMPERATURE = 132.5
_DENSITY = 314.3
_CONDUCTIVITY_SCALE = 25.9778e-3
_CONDUCTIVITY_DILUTE = (
    (1.0, 0.239503),
    (0.5, 0.00649768),
    (0.0, 1.0),
    (-1.0, -1.92615),
    (-2.0, 2.00383),
    (-3.0, -1.07553),
    (-4.0, 0.229414),
)
_CONDUCTIVITY_RESIDUAL = (0.402287, 0.356603)
_VISCOSITY_SCALE = 6.16090e-6
_VISCOSITY_DILUTE = (
    (1.0, 0.128517),
    (0.5, 2.60661),
    (0.0, -1.0),
    (-1.0, -0.709661),
    (-2.0, 0.662534),
    (-3.0, -0.197846),
    (-4.0, 0.00770147),
)
_VISCOSITY_RESIDUAL = (0.465601, 1.26469)

# Lemmon, Jacobsen, Penoncello, Friend 2000, Table 12: a power series of T, then three vibrations
_HEAT_POWERS = (
    (0.0, 3.490888032),
    (1.0, 2.395525583e-6),
    (2.0, 7.172111248e-9),
    (3.0, -3.115413101e-13),
    (-1.5, 0.223806688),
)
_HEAT_VIBRATIONS = ((0.791309509, 3364.011), (0.212236768, 2242.45))
_HEAT_ELECTRONIC = (0.197938904, 11580.4)


@dataclass(frozen=True)
class GasProperties:
    """What the models need to know of a gas, at one or more states.

    Parameters
    ----------
    gas : str
        Name of the gas.
    source : str
        Where the numbers come from.
    temperature : float or array
        Temperature. [K]
    pressure : float or array
        Pressure. [Pa]
    conductivity : float or array
        Thermal conductivity. [W/(m K)]
    viscosity : float or array
        Dynamic viscosity. [Pa s]
    specific_heat : float or array
        At constant pressure. [J/(kg K)]
    density : float or array
        Density. [kg/m3]
    """

    gas: str
    source: str
    temperature: FloatArray
    pressure: FloatArray
    conductivity: FloatArray
    viscosity: FloatArray
    specific_heat: FloatArray
    density: FloatArray

    @property
    def prandtl_number(self) -> FloatArray:
        """Prandtl number, viscosity times specific heat over conductivity."""
        return plain(self.viscosity * self.specific_heat / self.conductivity)

    @property
    def diffusivity(self) -> FloatArray:
        """Thermal diffusivity. [m2/s]"""
        return plain(self.conductivity / (self.density * self.specific_heat))

    def __str__(self) -> str:
        """One line a state."""
        lines = [f"{self.gas} ({self.source})"]
        columns = (
            self.temperature,
            self.pressure,
            self.conductivity,
            self.viscosity,
            self.specific_heat,
            self.density,
            self.prandtl_number,
        )
        for T, p, k, eta, c_p, rho, Pr in zip(*(np.ravel(c) for c in np.broadcast_arrays(*columns)), strict=True):
            lines.append(
                f"{T:8.2f} K  {p:9.0f} Pa  k {k:.5f} W/(m K)  viscosity {eta:.4e} Pa s  "
                f"c_p {c_p:.1f} J/(kg K)  density {rho:.4f} kg/m3  Pr {Pr:.4f}"
            )
        return "\n".join(lines)


def _power_series(terms: tuple[tuple[float, float], ...], x: FloatArray) -> FloatArray:
    total = np.zeros_like(x)
    for power, coefficient in terms:
        total = total + coefficient * x**power
    return total


def _kadoya(
    T: FloatArray, scale: float, dilute: tuple[tuple[float, float], ...], residual: tuple[float, float]
) -> FloatArray:
    # the residual part is 0.15 % at 300 K, so the ideal gas law is exact enough, and its cubic and higher
    # terms nothing
    density = ATMOSPHERE / (AIR_GAS_CONSTANT * T) / _DENSITY
    return scale * (_power_series(dilute, T / _TEMPERATURE) + density * (residual[0] + residual[1] * density))


def air_conductivity(temperature: ArrayLike) -> FloatArray:
    """Thermal conductivity of dry air at 101.325 kPa (Kadoya, Matsunaga and Nagashima 1985).

    J. Phys. Chem. Ref. Data 14, 947-970, for 85 to 2000 K and up to 100 MPa. Against the equation of Lemmon
    and Jacobsen (2004) it lies 0.8 % lower at 200 K, 0.6 % lower at 300 to 600 K, equal at 1000 K and 1.3 %
    higher at 1500 K; within 1.5 % of the usual textbook table from 300 to 1000 K (0.0263 and 0.0667 W/(m K)
    there).

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    float or array
        Conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If a temperature is not positive.

    Warns
    -----
    RangeWarning
        Outside 85 to 2000 K. Below, where the correlation turns up without limit, it goes on in proportion to T.
    """
    T = positive("temperature", temperature, "K")
    warn_outside("air_conductivity (Kadoya et al. 1985): temperature", T, *AIR_RANGE, "K")
    within_range = np.maximum(T, AIR_RANGE[0])
    found = _kadoya(within_range, _CONDUCTIVITY_SCALE, _CONDUCTIVITY_DILUTE, _CONDUCTIVITY_RESIDUAL)
    return plain(found * (T / within_range))


def air_viscosity(temperature: ArrayLike) -> FloatArray:
    """Dynamic viscosity of dry air at 101.325 kPa (Kadoya, Matsunaga and Nagashima 1985).

    J. Phys. Chem. Ref. Data 14, 947-970, for 85 to 2000 K and up to 100 MPa. Against the equation of Lemmon
    and Jacobsen (2004) it lies 0.02 % lower at 200 K and 0.1 to 0.4 % higher from 250 to 1500 K.

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    float or array
        Viscosity. [Pa s]

    Raises
    ------
    ValueError
        If a temperature is not positive.

    Warns
    -----
    RangeWarning
        Outside 85 to 2000 K.
    """
    T = positive("temperature", temperature, "K")
    warn_outside("air_viscosity (Kadoya et al. 1985): temperature", T, *AIR_RANGE, "K")
    return plain(_kadoya(T, _VISCOSITY_SCALE, _VISCOSITY_DILUTE, _VISCOSITY_RESIDUAL))


def air_specific_heat(temperature: ArrayLike) -> FloatArray:
    """Specific heat of dry air as an ideal gas (Lemmon, Jacobsen, Penoncello and Friend 2000, Table 12).

    J. Phys. Chem. Ref. Data 29, 331-385. Real air of 101.325 kPa has 0.44 % more at 200 K, 0.16 % more at
    300 K and less than 0.05 % more from 500 K.

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    float or array
        Specific heat at constant pressure. [J/(kg K)]

    Raises
    ------
    ValueError
        If a temperature is not positive, or above 10,000 K.

    Warns
    -----
    RangeWarning
        Outside 200 to 2000 K.
    """
    T = positive("temperature", temperature, "K")
    within("temperature", T, 0.0, gas_coolprop.HOTTEST, "K")
    warn_outside("air_specific_heat (Lemmon et al. 2000): temperature", T, *IDEAL_AIR_RANGE, "K")
    share = _power_series(_HEAT_POWERS, T)
    for weight, characteristic in _HEAT_VIBRATIONS:
        # u^2 e^u/(e^u - 1)^2 in a form that does not overflow
        u = np.minimum(characteristic / T, 700.0)
        share = share + weight * u**2 * np.exp(-u) / np.expm1(-u) ** 2
    weight, characteristic = _HEAT_ELECTRONIC
    w = np.minimum(characteristic / T, 700.0)
    share = share + weight * w**2 * (2.0 / 3.0) * np.exp(-w) / (1.0 + (2.0 / 3.0) * np.exp(-w)) ** 2
    return plain(AIR_GAS_CONSTANT * share)


def air_density(temperature: ArrayLike, pressure: ArrayLike = ATMOSPHERE) -> FloatArray:
    """Density of dry air by the ideal gas law, p/(R T) with R = 287.05 J/(kg K).

    At 101.325 kPa real air is 0.24 % denser at 200 K, 0.03 % denser at 300 K, and 0.04 % less dense at 600 K.
    The departure grows with the pressure.

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]
    pressure : float or array
        Pressure. [Pa]

    Returns
    -------
    float or array
        Density. [kg/m3]

    Raises
    ------
    ValueError
        If a temperature or pressure is not positive.

    Warns
    -----
    RangeWarning
        Outside 200 to 2000 K.
    """
    T = positive("temperature", temperature, "K")
    p = positive("pressure", pressure, "Pa")
    warn_outside("air_density (ideal gas): temperature", T, *IDEAL_AIR_RANGE, "K")
    return plain(p / (AIR_GAS_CONSTANT * T))


def air_prandtl_number(temperature: ArrayLike) -> FloatArray:
    """Prandtl number of dry air at 101.325 kPa, from the fits of its three parts.

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    float or array
        Prandtl number.

    Raises
    ------
    ValueError
        If a temperature is not positive, or above 10,000 K.

    Warns
    -----
    RangeWarning
        Outside 200 to 2000 K.
    """
    return plain(air_viscosity(temperature) * air_specific_heat(temperature) / air_conductivity(temperature))


def air_properties(temperature: ArrayLike) -> GasProperties:
    """All properties of dry air at 101.325 kPa by the fits of this module; needs no extra.

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    GasProperties
        Conductivity and viscosity (Kadoya et al. 1985), specific heat (Lemmon et al. 2000), density (ideal
        gas).

    Raises
    ------
    ValueError
        If a temperature is not positive, or above 10,000 K.

    Warns
    -----
    RangeWarning
        Outside 200 to 2000 K.
    """
    T = positive("temperature", temperature, "K")
    return GasProperties(
        gas="air",
        source="Kadoya et al. 1985, Lemmon et al. 2000",
        temperature=plain(T),
        pressure=plain(np.full_like(T, ATMOSPHERE)),
        conductivity=air_conductivity(T),
        viscosity=air_viscosity(T),
        specific_heat=air_specific_heat(T),
        density=air_density(T),
    )


def properties(gas: str, temperature: ArrayLike, pressure: ArrayLike = ATMOSPHERE) -> GasProperties:
    """All properties of a gas from CoolProp: "N2", "He", "Ar", "CO2", "air" and the other pure fluids it knows.

    Parameters
    ----------
    gas : str
        Name or formula, in any case.
    temperature : float or array
        Temperature. [K]
    pressure : float or array
        Pressure, broadcast with the temperature. [Pa]

    Returns
    -------
    GasProperties
        From CoolProp's reference equations (for air Lemmon et al. 2000, Lemmon and Jacobsen 2004).

    Raises
    ------
    ImportError
        If CoolProp is not installed.
    ValueError
        If CoolProp does not know the gas or its transport properties, if it is not a gas in a state, or a
        temperature or pressure is not positive; above 10,000 K.

    Warns
    -----
    RangeWarning
        Outside the temperatures of CoolProp's equation.
    """
    T, p = np.broadcast_arrays(positive("temperature", temperature, "K"), positive("pressure", pressure, "Pa"))
    name, columns = gas_coolprop.evaluate(gas, T, p)
    return GasProperties(name, gas_coolprop.source(), plain(T), plain(p), *(plain(column) for column in columns))
