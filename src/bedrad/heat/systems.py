"""What a prediction needs to know: tube, wall layer, view factors and bulk, each a small record."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import bulk as bulk_models
from bedrad.heat import correlations, flow_correlations, radiation, wall_layer
from bedrad.heat.flow_correlations import Quantity
from bedrad.heat.gas import air_conductivity
from bedrad.heat.materials import ZIRCONIA_SILICA
from bedrad.heat.ranges import FloatArray, RangeWarning, non_negative, plain, positive, within

__all__ = [
    "TABLE_5_1",
    "Bulk",
    "BulkModel",
    "Correlation",
    "System",
    "ViewFactors",
    "WallLayer",
    "bulk_conductivity",
    "check_correlation",
]

BulkModel = Literal["auto", "table 5.2", "zbs"]

Correlation = Literal["watkins", "bedrad"]
"""Whose flows the wall layer and the view factors are taken from where they were not measured."""


def check_correlation(correlation: str) -> str:
    """Return the name of a correlation; ValueError if there is none of that name."""
    if correlation not in ("watkins", "bedrad"):
        raise ValueError(f"correlation is {correlation!r}; expected 'watkins' or 'bedrad'")
    return correlation


@dataclass(frozen=True)
class System:
    """A tube and the particles that flow in it.

    Parameters
    ----------
    tube_diameter : float
        Inner diameter. [m]
    particle_diameter : float
        Particle diameter. [m]
    velocity : float
        Mean flow velocity; enters through the correlations of the wall layer only. [m/s]
    solid_conductivity : float
        Conductivity of the particles, taken as constant over the temperature. [W/(m K)]
    porosity : float
        Void fraction of the bulk.
    emissivity : float
        Emissivity of the particles in the bulk; in the wall layer all surfaces are black (Watkins 2018, eq.
        48).
    name : str
        Name for tables.

    Raises
    ------
    ValueError
        If a value has no meaning.
    """

    tube_diameter: float
    particle_diameter: float
    velocity: float
    solid_conductivity: float = ZIRCONIA_SILICA.solid_conductivity
    porosity: float = 1.0 - ZIRCONIA_SILICA.packing_fraction
    emissivity: float = ZIRCONIA_SILICA.emissivity
    name: str = ""

    def __post_init__(self) -> None:
        positive("tube_diameter", self.tube_diameter, "m")
        positive("particle_diameter", self.particle_diameter, "m")
        non_negative("velocity", self.velocity, "m/s")
        positive("solid_conductivity", self.solid_conductivity, "W/(m K)")
        within("porosity", positive("porosity", self.porosity), 0.0, 1.0, open_above=True)
        within("emissivity", positive("emissivity", self.emissivity), 0.0, 1.0)
        if not self.tube_diameter > self.particle_diameter:
            raise ValueError(
                f"tube_diameter is {self.tube_diameter:g} m; expected more than the particle_diameter, "
                f"{self.particle_diameter:g} m"
            )

    @property
    def diameter_ratio(self) -> float:
        """Tube inner diameter over particle diameter."""
        return self.tube_diameter / self.particle_diameter


TABLE_5_1 = (
    System(28.2 * 270e-6, 270e-6, 0.020, name="configuration 2"),
    System(40.1 * 270e-6, 270e-6, 0.014, name="configuration 5"),
    System(33.8 * 320e-6, 320e-6, 0.014, name="configuration 6"),
)
"""The systems measured at high temperature (Watkins 2018, Table 5.1). The table has outer tube diameters and
the diameter ratios; the inner diameters are ratio times particle diameter."""


@dataclass(frozen=True)
class WallLayer:
    """What fills the wall-adjacent layer, measured or by correlation, with standard errors.

    Parameters
    ----------
    packing_fraction : float
        Solid fraction, phi_wa.
    contacts_per_area : float
        Particle-wall contacts per wall area, n_C. [1/m2]
    nc_distance : float
        Gap of the no-contact particles, a. [particle radii]
    packing_fraction_error, contacts_per_area_error, nc_distance_error : float
        Standard errors, in the same units.
    form : str
        Form of the conductivity, see `bedrad.heat.wall_layer.contributions`; "simplified" allows a = 0.22
        only.
    """

    packing_fraction: float
    contacts_per_area: float
    nc_distance: float = wall_layer.NC_DISTANCE
    packing_fraction_error: float = 0.0
    contacts_per_area_error: float = 0.0
    nc_distance_error: float = 0.0
    form: wall_layer.Form = "general"

    def __post_init__(self) -> None:
        for name in ("packing_fraction_error", "contacts_per_area_error", "nc_distance_error"):
            non_negative(name, getattr(self, name))
        if self.form == "simplified" and self.nc_distance_error > 0.0:
            raise ValueError(
                f"nc_distance_error is {self.nc_distance_error:g}, but the simplified form takes nc_distance "
                f'as exactly {wall_layer.NC_DISTANCE:g}; choose form="general" or "cylinder"'
            )

    @classmethod
    def from_correlations(cls, system: System, correlation: Correlation = "watkins") -> WallLayer:
        """Fill the layer by correlations; warns once outside their range.

        Parameters
        ----------
        system : System
            Tube and particles.
        correlation : {"watkins", "bedrad"}
            Watkins (2018), eq. 38-41, or the fits to bedrad's own flows, `flow_correlations.estimate`. The first leave
            the standard errors at zero: their source gives largest deviations (5 % for phi_wa, 16 % for n_C, together
            less than 7 % of k_wa), not standard errors.

        Raises
        ------
        ValueError
            If the correlation is unknown.
        """
        A, d, U = system.diameter_ratio, system.particle_diameter, system.velocity
        most = float(correlations.maximum_contacts(A, d))
        if check_correlation(correlation) == "bedrad":
            flow_correlations.warn_outside_fit(A, U, d)
            names: tuple[Quantity, ...] = ("packing_fraction", "contact_ratio", "nc_distance")
            solid, contacts, gap = (flow_correlations.estimate(name, A, U, d, warn=False) for name in names)
            return cls(
                packing_fraction=float(solid[0]),
                contacts_per_area=float(contacts[0]) * most,
                nc_distance=float(gap[0]),
                packing_fraction_error=float(solid[1]),
                contacts_per_area_error=float(contacts[1]) * most,
                nc_distance_error=float(gap[1]),
            )
        correlations.warn_outside_fit("wall-layer correlations (Watkins 2018, eq. 38, 40)", A, U)
        return cls(
            packing_fraction=float(correlations.packing_fraction(A, U, d, warn=False)),
            contacts_per_area=float(correlations.contact_ratio(A, U, d, warn=False)) * most,
            form="simplified",
        )

    def conductivity(self, system: System, gas_conductivity: ArrayLike, *, warn: bool = True) -> FloatArray:
        """Conductivity k_wa [W/(m K)] of this layer in a system, for gas conductivities [W/(m K)]."""
        return wall_layer.conductivity(
            gas_conductivity,
            system.solid_conductivity,
            system.diameter_ratio,
            system.particle_diameter,
            self.contacts_per_area,
            self.packing_fraction,
            self.nc_distance,
            self.form,
            warn=warn,
        )


@dataclass(frozen=True, eq=False)
class ViewFactors:
    """View factors from the wall to the layers, with standard errors.

    Parameters
    ----------
    to_layers : (layers,) array
        The wall-adjacent layer first. What returns to the wall or escapes is left out.
    errors : (layers,) array, optional
        Standard errors; zero if left out.
    """

    to_layers: FloatArray
    errors: FloatArray = field(default_factory=lambda: np.zeros(1))

    def __post_init__(self) -> None:
        factors = np.array(self.to_layers, dtype=np.float64)
        if factors.ndim != 1:
            raise ValueError(f"view factors have the shape {factors.shape}; expected (layers,)")
        radiation.penetration(factors)
        errors = non_negative("view factor error", self.errors)
        if errors.shape not in ((1,), (), factors.shape):
            raise ValueError(f"view factor errors have the shape {errors.shape}; expected {factors.shape}")
        errors = np.broadcast_to(errors, factors.shape).copy()
        for name, values in (("to_layers", factors), ("errors", errors)):
            values.setflags(write=False)
            object.__setattr__(self, name, values)

    @classmethod
    def watkins(cls) -> ViewFactors:
        """Take the published factors 0.80, 0.18, 0.02 (Watkins 2018, Table 5.3), without errors."""
        return cls(np.array(radiation.WATKINS_FACTORS))

    @classmethod
    def from_correlations(cls, system: System, correlation: Correlation = "watkins") -> ViewFactors:
        """Take the published factors, or those of bedrad's own flows against diameter ratio and velocity.

        Raises
        ------
        ValueError
            If the correlation is unknown.
        """
        if check_correlation(correlation) == "watkins":
            return cls.watkins()
        names: tuple[Quantity, ...] = ("view_factor_1", "view_factor_2", "view_factor_3")
        inputs = system.diameter_ratio, system.velocity, system.particle_diameter
        found = [flow_correlations.estimate(name, *inputs, warn=False) for name in names]
        return cls(*(np.array([float(pair[k]) for pair in found]) for k in (0, 1)))


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


def bulk_conductivity(system: System, temperature: ArrayLike, model: BulkModel = "auto") -> Bulk:
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
    if model not in ("auto", "table 5.2", "zbs"):
        raise ValueError(f"bulk model is {model!r}; expected 'auto', 'table 5.2' or 'zbs'")
    T = positive("temperature", temperature, "K")
    gas = air_conductivity(T)
    inputs = (gas, system.solid_conductivity, system.porosity, system.particle_diameter, T, system.emissivity)
    with_radiation = bulk_models.zehner_bauer_schluender(*inputs)
    without = bulk_models.zehner_bauer_schluender(*inputs, radiation=False)
    tabulated = bulk_models.find_fit(system.particle_diameter) is not None and _is_tabulated(system)
    if model == "zbs" or (model == "auto" and not tabulated):
        return Bulk(with_radiation, without, "zbs")
    if not _is_tabulated(system):
        warnings.warn(
            "Table 5.2 (Watkins 2018) is for zirconia-silica: the given "
            f"solid_conductivity {system.solid_conductivity:g} W/(m K), porosity {system.porosity:g} and "
            f"emissivity {system.emissivity:g} do not enter the bulk conductivity",
            RangeWarning,
            stacklevel=2,
        )
    fitted = bulk_models.measured(T, system.particle_diameter)
    rest = positive("bulk conductivity without radiation", fitted - (with_radiation - without), "W/(m K)")
    return Bulk(fitted, plain(rest), "table 5.2")


def _is_tabulated(system: System) -> bool:
    """Whether the particles and their bed are those of the tables."""
    given = (system.solid_conductivity, system.porosity, system.emissivity)
    material = ZIRCONIA_SILICA
    return bool(np.allclose(given, (material.solid_conductivity, 1.0 - material.packing_fraction, material.emissivity)))
