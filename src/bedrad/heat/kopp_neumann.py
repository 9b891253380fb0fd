"""Specific heat of solid oxides and, by the rule of Kopp and Neumann, of their mixtures.

The molar heat capacities are the Shomate equations of the NIST Chemistry WebBook (Chase 1998, the JANAF tables), to
which Nguyen (2015) refers for quartz, corundum, hematite and rutile.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, warn_outside

__all__ = ["CARBOHSP", "ID50_K", "OXIDES", "QUARTZ_SAND", "Oxide", "mixture_specific_heat"]


@dataclass(frozen=True)
class Oxide:
    """A solid oxide and its heat capacity.

    Parameters
    ----------
    name : str
        Name of the mineral.
    molar_mass : float
        Molar mass. [kg/mol]
    limits : tuple of float
        Temperatures between which each set of coefficients holds, one more than sets. [K]
    coefficients : tuple of tuples of float
        A, B, C, D, E of C_p = A + B t + C t^2 + D t^3 + E/t^2 with t = T/1000 K. [J/(mol K)]
    """

    name: str
    molar_mass: float
    limits: tuple[float, ...]
    coefficients: tuple[tuple[float, float, float, float, float], ...]

    def molar_heat_capacity(self, temperature: ArrayLike) -> FloatArray:
        """Molar heat capacity at constant pressure (Shomate equation, Chase 1998).

        Parameters
        ----------
        temperature : float or array
            Temperature. [K]

        Returns
        -------
        float or array
            C_p. [J/(mol K)]

        Raises
        ------
        ValueError
            If a temperature is not positive.

        Warns
        -----
        RangeWarning
            Outside the temperatures of the coefficients.
        """
        T = positive("temperature", temperature, "K")
        warn_outside(f"heat capacity of {self.name} (Chase 1998): temperature", T, self.limits[0], self.limits[-1], "K")
        # a temperature between two sets belongs to the upper one
        segment = np.searchsorted(self.limits[1:-1], T, side="right")
        A, B, C, D, E = np.moveaxis(np.asarray(self.coefficients)[segment], -1, 0)
        t = T / 1000.0
        return plain(A + B * t + C * t**2 + D * t**3 + E / t**2)

    def specific_heat(self, temperature: ArrayLike) -> FloatArray:
        """Specific heat: the molar heat capacity over the molar mass; raises and warns as that does. [J/(kg K)]"""
        return plain(self.molar_heat_capacity(temperature) / self.molar_mass)


OXIDES: Mapping[str, Oxide] = {
    "SiO2": Oxide(
        "quartz",
        60.0843e-3,
        (298.0, 847.0, 1996.0),
        (
            (-6.076591, 251.6755, -324.7964, 168.5604, 0.002548),
            (58.75340, 10.27925, -0.131384, 0.025210, 0.025601),
        ),
    ),
    "Al2O3": Oxide(
        "corundum",
        101.9613e-3,
        (298.0, 2327.0),
        ((102.4290, 38.74980, -15.91090, 2.628181, -3.007551),),
    ),
    "Fe2O3": Oxide(
        "hematite",
        159.688e-3,
        (298.0, 950.0, 1050.0, 2500.0),
        (
            (93.43834, 108.3577, -50.86447, 25.58683, -1.611330),
            (150.6240, 0.0, 0.0, 0.0, 0.0),
            (110.9362, 32.04714, -9.192333, 0.901506, 5.433677),
        ),
    ),
    "TiO2": Oxide(
        "rutile",
        79.866e-3,
        (298.0, 2000.0),
        ((67.29830, 18.70940, -11.57900, 2.449561, -1.485471),),
    ),
}
"""Oxides by formula."""

QUARTZ_SAND: Mapping[str, float] = {"SiO2": 1.0}
"""Mass fractions of silica sand, for which Nguyen (2015) takes quartz."""

ID50_K: Mapping[str, float] = {"Al2O3": 0.75, "SiO2": 0.11, "Fe2O3": 0.09, "TiO2": 0.03}
"""Mass fractions of Accucast ID50-K by its maker, as Siegel et al. (2015) print them; 2 % is not named."""

CARBOHSP: Mapping[str, float] = {"Al2O3": 0.83, "SiO2": 0.05, "Fe2O3": 0.07, "TiO2": 0.035}
"""Mass fractions of CarboHSP by its maker, as Siegel et al. (2015) print them; 1.5 % is not named."""


def mixture_specific_heat(mass_fractions: Mapping[str, float], temperature: ArrayLike) -> FloatArray:
    """Specific heat of a mixture of oxides by the rule of Kopp and Neumann: the mean by mass of the parts.

    The rule is 3 % wrong near room temperature and 4 to 6 % near 2000 K (Leitner et al., after Nguyen 2015, section
    2.6).

    Parameters
    ----------
    mass_fractions : mapping
        Mass fraction of each oxide by its formula (see `OXIDES`), in any unit: the mean is taken over what is given.
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    float or array
        Specific heat. [J/(kg K)]

    Raises
    ------
    ValueError
        If an oxide is unknown, a fraction is negative or all are zero, or a temperature is not positive.

    Warns
    -----
    RangeWarning
        Outside the temperatures of an oxide.
    """
    for formula in mass_fractions:
        if formula not in OXIDES:
            raise ValueError(f"mass_fractions has {formula!r}; expected some of {', '.join(OXIDES)}")
    fractions = {formula: float(non_negative(formula, share)) for formula, share in mass_fractions.items()}
    total = float(positive("sum of mass_fractions", sum(fractions.values())))
    T = positive("temperature", temperature, "K")
    parts = [share * OXIDES[formula].specific_heat(T) for formula, share in fractions.items() if share > 0.0]
    return plain(np.sum(parts, axis=0) / total)
