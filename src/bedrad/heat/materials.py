"""Materials of particles and walls, as the publications state them: beds, and solids by themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside

__all__ = [
    "ALUMINA_SILICATE",
    "MATERIALS",
    "MEASURED_BEDS",
    "SOLIDS",
    "SPECIFIC_HEAT_RANGE",
    "ZERO_CELSIUS",
    "ZIRCONIA_SILICA",
    "Material",
    "MeasuredBed",
    "Solid",
]

ZERO_CELSIUS = 273.15
"""0 degrees Celsius. [K]"""

SPECIFIC_HEAT_RANGE = (313.15, 773.15)
"""Temperatures of the calorimeter runs behind Table 2.3 (Watkins 2018, section 2.2.2). [K]"""


@dataclass(frozen=True)
class Material:
    """A particle material and the static bed it makes.

    Parameters
    ----------
    name : str
        Name.
    particle_density, bulk_density : float
        Densities of particle and bed. [kg/m3]
    packing_fraction : float
        Solid fraction of the static bed.
    solid_conductivity : float
        Conductivity of the solid at room temperature. [W/(m K)]
    emissivity : float
        Emissivity where the source uses one.
    specific_heat_coefficient, specific_heat_exponent : float
        c_p = coefficient T^exponent with T in degrees Celsius. [J/(kg K)]
    particle_diameters : tuple of float
        Mean diameters of the batches. [m]
    """

    name: str
    particle_density: float
    bulk_density: float
    packing_fraction: float
    solid_conductivity: float
    emissivity: float
    specific_heat_coefficient: float
    specific_heat_exponent: float
    particle_diameters: tuple[float, ...] = ()

    def specific_heat(self, temperature: ArrayLike) -> FloatArray:
        """Specific heat of the bed (Watkins 2018, Table 2.3).

        Parameters
        ----------
        temperature : float or array
            Temperature. [K]

        Returns
        -------
        float or array
            Specific heat. [J/(kg K)]

        Raises
        ------
        ValueError
            If a temperature is not above 273.15 K, where the power law ends.

        Warns
        -----
        RangeWarning
            Outside the measured 313.15 to 773.15 K.
        """
        T = positive("temperature", temperature, "K")
        if np.any(T <= ZERO_CELSIUS):
            raise ValueError(
                f"temperature is {float(np.min(T)):g} K; expected more than 273.15 K: the specific heat of "
                f"{self.name} is a power law in degrees Celsius"
            )
        warn_outside(
            f"specific heat of {self.name} (Watkins 2018, Table 2.3): temperature",
            T,
            *SPECIFIC_HEAT_RANGE,
            "K",
        )
        return plain(self.specific_heat_coefficient * (T - ZERO_CELSIUS) ** self.specific_heat_exponent)


ZIRCONIA_SILICA = Material("zirconia-silica", 3801.0, 2386.0, 0.63, 2.1, 0.8, 271.5, 0.1719, (140e-6, 270e-6, 320e-6))
"""Saint-Gobain ER-120 (Watkins 2018, Tables 2.2 and 2.3). Solid conductivity that of zirconium silicate at room
temperature; the emissivity is assumed in the source."""

ALUMINA_SILICATE = Material("alumina-silicate", 3237.0, 2006.0, 0.62, 1.76, 0.8, 403.0, 0.1762, (340e-6,))
"""Carbo ID50, 75 % Al2O3, 11 % SiO2, 9 % Fe2O3 (Watkins 2018, Tables 2.2 and 2.3). Solid conductivity that of
sillimanite at room temperature; the emissivity is assumed in the source."""

MATERIALS = {material.name: material for material in (ZIRCONIA_SILICA, ALUMINA_SILICATE)}
"""Materials by name."""


@dataclass(frozen=True)
class Solid:
    """A solid by itself, at room temperature.

    Parameters
    ----------
    name : str
        Name.
    density : float
        Density. [kg/m3]
    conductivity : float
        Thermal conductivity. [W/(m K)]
    specific_heat : float
        Specific heat. [J/(kg K)]
    source : str
        Publication and table.
    """

    name: str
    density: float
    conductivity: float
    specific_heat: float
    source: str

    @property
    def diffusivity(self) -> float:
        """Thermal diffusivity. [m2/s]"""
        return self.conductivity / (self.density * self.specific_heat)


_ADEPU = "Adepu et al., Table 2"
SOLIDS = {
    solid.name: solid
    for solid in (
        Solid("soda lime glass", 2500.0, 1.1, 795.0, _ADEPU),
        Solid("steel AISI 52100", 7810.0, 46.6, 502.0, _ADEPU),
        Solid("aluminium", 2700.0, 167.0, 896.0, _ADEPU),
    )
}
"""Solids by name: the particles of Adepu et al. and the block that heats them."""


@dataclass(frozen=True)
class MeasuredBed:
    """A bed at rest whose bulk properties were measured at room temperature, nothing said of its solid.

    Parameters
    ----------
    name : str
        Name.
    conductivity : float
        Bulk conductivity. [W/(m K)]
    volumetric_heat_capacity : float
        Heat capacity of the bed. [J/(m3 K)]
    bulk_density : float
        Density of the bed. [kg/m3]
    source : str
        Publication and table.
    """

    name: str
    conductivity: float
    volumetric_heat_capacity: float
    bulk_density: float
    source: str

    @property
    def specific_heat(self) -> float:
        """Specific heat that the other two numbers give [J/(kg K)]; too high, see `MEASURED_BEDS`."""
        return self.volumetric_heat_capacity / self.bulk_density


_NGUYEN = "Nguyen 2015, Table 4"
MEASURED_BEDS = {
    bed.name: bed
    for bed in (
        MeasuredBed("Atlanta industrial sand", 0.226, 1.124e6, 1364.0, _NGUYEN),
        MeasuredBed("Arizona fracking sand", 0.250, 1.232e6, 1581.0, _NGUYEN),
        MeasuredBed("construction sand", 0.224, 1.178e6, 1524.0, _NGUYEN),
        MeasuredBed("CarboHSP proppant", 0.263, 1.839e6, 2152.0, _NGUYEN),
        MeasuredBed("Accucast ID50-K", 0.220, 1.613e6, 1823.0, _NGUYEN),
        MeasuredBed("Riyadh white sand", 0.290, 1.320e6, 1561.0, _NGUYEN),
    )
}
"""Beds by name. Their heat capacities come from a needle probe, which the source found too high against
calorimeters (ID50-K: 885 against some 750 J/(kg K)) and did not use."""
