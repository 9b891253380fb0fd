"""Measured values of Nguyen (2015): particles, and their heat transfer coefficients across heated tubes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside

__all__ = [
    "MATERIALS",
    "SPEED_RANGE",
    "TABLE_12",
    "TABLE_13",
    "TABLE_14",
    "TABLE_15",
    "ParticleMaterial",
    "QuadraticFit",
]

SPEED_RANGE = (0.003, 0.010)
"""Superficial speeds of the measurements: nominally 3, 5 and 10 mm/s. [m/s]"""


@dataclass(frozen=True)
class ParticleMaterial:
    """A particle material as measured at room temperature (Nguyen 2015, Tables 3 and 4).

    Parameters
    ----------
    name : str
        Name.
    sauter_diameter : float
        Sauter mean diameter. [m]
    bed_conductivity : float
        Apparent conductivity of the bed. [W/(m K)]
    volumetric_heat_capacity : float
        Of the bed, by the hot-wire probe that the source finds to read too high. [J/(m3 K)]
    bulk_density : float
        Bulk density. [kg/m3]
    """

    name: str
    sauter_diameter: float
    bed_conductivity: float
    volumetric_heat_capacity: float
    bulk_density: float


@dataclass(frozen=True)
class QuadraticFit:
    """Heat transfer coefficient against superficial speed, h = a + b1 V + b2 V^2 with V in mm/s.

    Parameters
    ----------
    material : str
        Key of `MATERIALS`.
    tubes : {"bare", "finned"}
        Which tubes; for finned ones h is the effective coefficient over tube and fins.
    a, b1, b2 : float
        Constants. [W/(m2 K)], [W/(m2 K) s/mm], [W/(m2 K) s2/mm2]
    r_squared : float
        Coefficient of determination that the source gives.
    """

    material: str
    tubes: str
    a: float
    b1: float
    b2: float
    r_squared: float

    def coefficient(self, speed: ArrayLike) -> FloatArray:
        """Heat transfer coefficient (Nguyen 2015, Tables 12 and 13), for particles below 150 degrees Celsius.

        Parameters
        ----------
        speed : float or array
            Superficial speed, of the box without tubes. [m/s]

        Returns
        -------
        float or array
            h. [W/(m2 K)]

        Raises
        ------
        ValueError
            If a speed is not positive.

        Warns
        -----
        RangeWarning
            Outside the measured 0.003 to 0.010 m/s.
        """
        V = 1000.0 * positive("speed", speed, "m/s")
        what = f"coefficient of {self.material} at {self.tubes} tubes (Nguyen 2015, Tables 12 and 13): speed"
        warn_outside(what, V / 1000.0, *SPEED_RANGE, "m/s")
        return plain(self.a + self.b1 * V + self.b2 * V**2)


MATERIALS: Mapping[str, ParticleMaterial] = MappingProxyType(
    {
        "ID50-K": ParticleMaterial("Accucast ID50-K", 0.268e-3, 0.220, 1.613e6, 1823.0),
        "Atlanta": ParticleMaterial("Atlanta industrial sand", 0.301e-3, 0.226, 1.124e6, 1364.0),
        "Arizona": ParticleMaterial("Arizona fracking sand", 0.229e-3, 0.250, 1.232e6, 1581.0),
        "CarboHSP": ParticleMaterial("CarboHSP", 0.758e-3, 0.263, 1.839e6, 2152.0),
        "Riyadh": ParticleMaterial("Riyadh white sand", 0.343e-3, 0.290, 1.320e6, 1561.0),
    }
)
"""The five materials; ID50-K and CarboHSP are the small and the large proppants of Table 3."""


def _fits(tubes: str, rows: dict[str, tuple[float, float, float, float]]) -> Mapping[str, QuadraticFit]:
    return MappingProxyType({material: QuadraticFit(material, tubes, *row) for material, row in rows.items()})


# The materials of both tables are printed in another order than their rows, and the columns of Table 12 under
# headings in reverse; put right by Tables 14 and 15, whose order of materials the rows are in.
TABLE_12 = _fits(
    "bare",
    {
        "ID50-K": (90.78, 3.58, -0.12, 1.00),
        "Atlanta": (80.38, 5.29, -0.27, 0.94),
        "Arizona": (79.86, 5.80, -0.27, 0.98),
        "CarboHSP": (88.03, 2.94, -0.11, 0.95),
        "Riyadh": (100.22, 2.36, -0.05, 0.99),
    },
)
"""Fits for bare tubes by material, with materials and columns put right."""

TABLE_13 = _fits(
    "finned",
    {
        "ID50-K": (66.54, 12.06, -0.69, 0.88),
        "Atlanta": (96.38, -2.57, 0.32, 0.81),
        "Arizona": (74.04, 7.66, -0.35, 0.96),
        "CarboHSP": (73.51, 3.06, -0.11, 0.70),
        "Riyadh": (50.88, 17.43, -0.83, 0.99),
    },
)
"""Fits for finned tubes (effective coefficient) by material, with materials put right."""

_Speeds = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]

TABLE_14: Mapping[str, _Speeds] = MappingProxyType(
    {
        "ID50-K": ((100.34, 100.14), (104.85, 106.01), (114.17, 114.31)),
        "Atlanta": ((92.31, 92.43), (102.08, 99.04), (107.28, 104.25)),
        "Arizona": ((96.70, 95.60), (103.00, 103.60), (110.20, 110.80)),
        "CarboHSP": ((94.18, 96.74), (98.84, 100.69), (105.09, 107.10)),
        "Riyadh": ((106.72, 105.36), (110.21, 111.61), (118.87, 119.52)),
    }
)
"""Measured coefficients of bare tubes by material: at about 3, 5 and 10 mm/s, each at the lower (70 to 100 W) and the
higher power (150 to 180 W). [W/(m2 K)]"""

TABLE_15: Mapping[str, _Speeds] = MappingProxyType(
    {
        "ID50-K": ((93.77, 94.69), (107.25, 113.26), (112.90, 123.03)),
        "Arizona": ((96.35, 89.13), (102.75, 102.27), (114.67, 117.31)),
        "Atlanta": ((89.68, 93.48), (88.00, 95.54), (101.05, 110.85)),
        "CarboHSP": ((78.67, 82.90), (84.56, 88.87), (88.75, 95.55)),
        "Riyadh": ((94.17, 96.85), (110.85, 121.10), (141.91, 141.82)),
    }
)
"""Measured effective coefficients of finned tubes, arranged as `TABLE_14`. [W/(m2 K)]"""
