"""Bulk conductivity: the fits of Watkins (2018), and by name the models of `bulk_models` and `bulk_layers`."""

from __future__ import annotations

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

from bedrad.heat.bulk_layers import KUNII_SMITH_POROSITIES, kunii_smith, kunii_smith_gas_film, yagi_kunii
from bedrad.heat.bulk_models import deformation, modified_free_path, zehner_bauer_schluender, zehner_schluender
from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside

__all__ = [
    "FIT_UNCERTAINTY",
    "KUNII_SMITH_POROSITIES",
    "MEASUREMENT_UNCERTAINTY",
    "TABLE_2_4",
    "TABLE_5_2",
    "BulkFit",
    "deformation",
    "find_fit",
    "kunii_smith",
    "kunii_smith_gas_film",
    "measured",
    "modified_free_path",
    "yagi_kunii",
    "zehner_bauer_schluender",
    "zehner_schluender",
]

MEASUREMENT_UNCERTAINTY = 0.09
"""Largest relative uncertainty, 95 % confidence, of a conductivity measured with the concentric tubes (Watkins
2018, Appendix A)."""

FIT_UNCERTAINTY = 0.11
"""The same for a conductivity taken from a fit of Table 2.4 (Watkins 2018, Appendix A)."""


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
    """Find the fit of Watkins (2018), Table 2.4 or 5.2, for a particle diameter and material.

    Parameters
    ----------
    particle_diameter : float
        Particle diameter, met to 1 %. [m]
    material : str
        Particle material.
    table : {"5.2", "2.4"}
        Which table.

    Returns
    -------
    BulkFit or None
        The fit; None where the table has none for these particles.

    Raises
    ------
    ValueError
        If there is no such table.
    """
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
