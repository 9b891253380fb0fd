"""What a prediction needs to know: tube, wall layer and view factors, each a small record."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import correlations, flow_correlations, radiation, wall_layer
from bedrad.heat.flow_correlations import Quantity
from bedrad.heat.materials import ZIRCONIA_SILICA
from bedrad.heat.ranges import FloatArray, non_negative, positive, within

__all__ = [
    "TABLE_5_1",
    "Correlation",
    "System",
    "ViewFactors",
    "WallLayer",
    "check_correlation",
]

Correlation = Literal["watkins", "bedrad"]
"""Whose flows the wall layer and the view factors are taken from where they were not measured."""


def check_correlation(correlation: str) -> str:
    """Return the name of a correlation; ValueError if there is none of that name."""
    if correlation not in ("watkins", "bedrad"):
        raise ValueError(f"correlation is {correlation!r}; expected 'watkins' or 'bedrad'")
    return correlation


def _one_number(name: str, value: object) -> float:
    """Refuse what is no single number."""
    if isinstance(value, (bool, str)) or np.ndim(value) != 0 or value is None:  # type: ignore[arg-type]
        raise ValueError(f"{name} is {value!r}; expected one number")
    return float(value)  # type: ignore[arg-type]


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
        for name in ("tube_diameter", "particle_diameter", "velocity", "solid_conductivity", "porosity", "emissivity"):
            _one_number(name, getattr(self, name))
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
        for name in ("packing_fraction", "contacts_per_area", "nc_distance"):
            _one_number(name, getattr(self, name))
            non_negative(f"{name}_error", _one_number(f"{name}_error", getattr(self, f"{name}_error")))
        within("packing_fraction", self.packing_fraction, 0.0, 1.0)
        non_negative("contacts_per_area", self.contacts_per_area, "1/m2")
        within("nc_distance", self.nc_distance, 0.0, 1.0, "particle radii", open_above=True)
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


def _covariance(given: ArrayLike, layers: int) -> FloatArray:
    """Check a covariance of view factors: its shape, symmetry, and that no combination has a negative variance."""
    covariance = np.array(given, dtype=np.float64)
    if covariance.shape != (layers, layers):
        raise ValueError(f"view factor covariance has the shape {covariance.shape}; expected ({layers}, {layers})")
    if not np.isfinite(covariance).all() or not np.allclose(covariance, covariance.T, rtol=1e-9, atol=0.0):
        raise ValueError("view factor covariance is not symmetric and finite")
    least = float(np.linalg.eigvalsh(covariance)[0])
    if least < -1e-9 * float(np.trace(covariance)):
        raise ValueError(f"view factor covariance has the negative eigenvalue {least:g}; expected none below 0")
    return covariance


@dataclass(frozen=True, eq=False)
class ViewFactors:
    """View factors from the wall to the layers, with standard errors.

    Parameters
    ----------
    to_layers : (layers,) array
        The wall-adjacent layer first. What returns to the wall or escapes is left out.
    errors : (layers,) array, optional
        Standard errors; zero if left out, or those of the covariance.
    covariance : (layers, layers) array, optional
        Covariance of the factors, where it is known: rays that one layer takes from another make one factor fall as
        the other rises. Independent, with the standard errors, if left out.

    Raises
    ------
    ValueError
        If a factor is not from 0 to 1, they sum to more than 1, or errors and covariance do not fit.
    """

    to_layers: FloatArray
    errors: FloatArray = field(default_factory=lambda: np.zeros(1))
    covariance: FloatArray | None = None

    def __post_init__(self) -> None:
        factors = np.array(self.to_layers, dtype=np.float64)
        if factors.ndim != 1:
            raise ValueError(f"view factors have the shape {factors.shape}; expected (layers,)")
        radiation.penetration(factors)
        errors = non_negative("view factor error", self.errors)
        if errors.shape not in ((1,), (), factors.shape):
            raise ValueError(f"view factor errors have the shape {errors.shape}; expected {factors.shape}")
        errors = np.broadcast_to(errors, factors.shape).copy()
        covariance = np.diag(errors**2)
        if self.covariance is not None:
            covariance = _covariance(self.covariance, factors.size)
            if not errors.any():
                errors = np.sqrt(np.diag(covariance))
            elif not np.allclose(errors**2, np.diag(covariance), rtol=1e-6, atol=0.0):
                raise ValueError("view factor errors differ from the diagonal of their covariance; give one of them")
        for name, values in (("to_layers", factors), ("errors", errors), ("covariance", covariance)):
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
        inputs = system.diameter_ratio, system.velocity, system.particle_diameter
        values, covariance = flow_correlations.view_factors(*inputs, warn=False)
        try:
            return cls(values, covariance=covariance)
        except ValueError as problem:
            raise ValueError(
                f"bedrad's correlation, far outside the flows that it was fitted to (A {inputs[0]:.3g}): {problem}"
            ) from None
