"""Which bulk conductivity a prediction takes: a measured fit where there is one for the particles, or a model."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import bulk as bulk_models
from bedrad.heat.bulk import BulkFit
from bedrad.heat.gas import air_conductivity
from bedrad.heat.materials import ZIRCONIA_SILICA
from bedrad.heat.ranges import FloatArray, RangeWarning, plain, positive
from bedrad.heat.systems import System

__all__ = ["Bulk", "BulkModel", "bulk_conductivity", "fit_for", "with_and_without_radiation"]

BulkModel = Literal["auto", "table 5.2", "zbs"]


@dataclass(frozen=True, eq=False)
class Bulk:
    """Conductivity of the bulk with and without radiation at given temperatures.

    Parameters
    ----------
    with_radiation, without_radiation : float or (n,) array
        k_b. [W/(m K)]
    model : str
        Where the values come from.
    """

    with_radiation: FloatArray
    without_radiation: FloatArray
    model: str = "given"


def bulk_conductivity(
    system: System,
    temperature: ArrayLike,
    model: BulkModel = "auto",
    gas_conductivity: Callable[[FloatArray], FloatArray] = air_conductivity,
) -> Bulk:
    """Bulk conductivity of a system with and without radiation.

    "zbs" is the model of Zehner, Bauer and Schluender with and without its radiation term. "table 5.2" are
    the fits of Watkins (2018), which hold radiation; without radiation, the radiative part of the former
    model is subtracted. It is the difference that is subtracted, not the ratio applied: the difference hardly
    depends on the conductivity of the solid, the ratio does.

    Parameters
    ----------
    system : System
        Tube and particles.
    temperature : float or (n,) array
        Temperature. [K]
    model : {"auto", "table 5.2", "zbs"}
        "auto" takes Table 5.2 where it has the particles, zirconia-silica of that diameter in a bed of its porosity,
        else the model.
    gas_conductivity : callable
        Conductivity [W/(m K)] of the gas at temperatures [K]; air if left out.

    Returns
    -------
    Bulk
        Values at the temperatures, and the model used.

    Raises
    ------
    ValueError
        If the model is unknown, Table 5.2 lacks the particles, or the subtraction leaves nothing.

    Warns
    -----
    RangeWarning
        If Table 5.2 is used outside its temperatures.
    """
    fit = fit_for(system, model)
    T = positive("temperature", temperature, "K")
    pair = with_and_without_radiation(
        fit,
        gas_conductivity(T),
        system.solid_conductivity,
        system.porosity,
        system.particle_diameter,
        T,
        system.emissivity,
    )
    return Bulk(*pair, "zbs" if fit is None else "table 5.2")


def fit_for(system: System, model: BulkModel) -> BulkFit | None:
    """Find the fit of Table 5.2 that a bulk model takes for a system; None for the model of Zehner et al.

    Raises
    ------
    ValueError
        If the model is unknown or Table 5.2 lacks the particles.

    Warns
    -----
    RangeWarning
        If Table 5.2 is asked for and the system's particles are others than its zirconia-silica.
    """
    if model not in get_args(BulkModel):
        raise ValueError(f"bulk model is {model!r}; expected 'auto', 'table 5.2' or 'zbs'")
    fit = bulk_models.find_fit(system.particle_diameter)
    if model == "zbs" or (model == "auto" and (fit is None or not _is_tabulated(system))):
        return None
    if not _is_tabulated(system):
        warnings.warn(
            "Table 5.2 (Watkins 2018) is for zirconia-silica: the given "
            f"solid_conductivity {system.solid_conductivity:g} W/(m K), porosity {system.porosity:g} and "
            f"emissivity {system.emissivity:g} do not enter the bulk conductivity",
            RangeWarning,
            stacklevel=3,
        )
    if fit is None:
        have = " and ".join(f"{one.particle_diameter * 1e6:.0f} um" for one in bulk_models.TABLE_5_2)
        raise ValueError(
            f"particle_diameter is {system.particle_diameter * 1e6:g} um; Table 5.2 has zirconia-silica of {have} "
            "only: choose the bulk model 'zbs'"
        )
    return fit


def with_and_without_radiation(
    fit: BulkFit | None,
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    porosity: ArrayLike,
    particle_diameter: ArrayLike,
    temperature: ArrayLike,
    emissivity: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Bulk conductivity with radiation and without, by a fit or, where that is None, by Zehner et al.

    Takes what `bulk.zehner_bauer_schluender` takes, after the fit.

    Returns
    -------
    with_radiation, without_radiation : float or array
        [W/(m K)]
    """
    inputs = (gas_conductivity, solid_conductivity, porosity, particle_diameter, temperature, emissivity)
    with_radiation = bulk_models.zehner_bauer_schluender(*inputs)
    without = bulk_models.zehner_bauer_schluender(*inputs, radiation=False)
    if fit is None:
        return with_radiation, without
    fitted = fit.conductivity(temperature)
    rest = positive("bulk conductivity without radiation", fitted - (with_radiation - without), "W/(m K)")
    return plain(np.broadcast_to(fitted, rest.shape)), plain(rest)


def _is_tabulated(system: System) -> bool:
    """Whether the particles and their bed are those of the tables."""
    given = (system.solid_conductivity, system.porosity, system.emissivity)
    material = ZIRCONIA_SILICA
    return bool(np.allclose(given, (material.solid_conductivity, 1.0 - material.packing_fraction, material.emissivity)))
