"""The particle materials of Watkins (2018): Tables 2.2 and 2.3 and the conductivities of their solids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside

__all__ = [
    "ALUMINA_SILICATE",
    "MATERIALS",
    "SPECIFIC_HEAT_RANGE",
    "ZERO_CELSIUS",
    "ZIRCONIA_SILICA",
    "Material",
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
    """

    name: str
    particle_density: float
    bulk_density: float
    packing_fraction: float
    solid_conductivity: float
    emissivity: float
    specific_heat_coefficient: float
    specific_heat_exponent: float

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


ZIRCONIA_SILICA = Material("zirconia-silica", 3801.0, 2386.0, 0.63, 2.1, 0.8, 271.5, 0.1719)
"""Measured with 140, 270 and 320 um particles; solid conductivity of zirconium silicate."""

ALUMINA_SILICATE = Material("alumina-silicate", 3237.0, 2006.0, 0.62, 1.76, 0.8, 403.0, 0.1762)
"""Measured with 340 um particles; solid conductivity of sillimanite."""

MATERIALS = {material.name: material for material in (ZIRCONIA_SILICA, ALUMINA_SILICATE)}
"""Materials by name."""
