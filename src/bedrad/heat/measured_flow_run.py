"""What a run of a flow apparatus is: tube, particles, readings; and what it is reduced to (Watkins 2018, ch. 2)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.energy_balance import SpecificHeat
from bedrad.heat.materials import Material
from bedrad.heat.measured_flow_transfer import FirstLaw
from bedrad.heat.measured_flow_value import Measured
from bedrad.heat.measured_flow_wall import INCONEL_CONDUCTIVITY, Insulation, WallHeating
from bedrad.heat.ranges import FloatArray, non_negative, positive

__all__ = ["Profile", "Properties", "ReducedRun", "Row", "Run", "Tube"]


@dataclass(frozen=True)
class Tube:
    """The heated tube.

    Parameters
    ----------
    inner_diameter : float
        Inner diameter. [m]
    outer_diameter : float, optional
        Outer diameter; if not given, wall temperatures are those of the wall's inside. [m]
    wall_conductivity : float
        Conductivity of the tube. [W/(m K)]
    insulation : Insulation, optional
        What is around it; if not given, nothing is lost but what the readings state as losses.
    heating : {"generated", "conducted"}
        Whether heat is made within the wall or comes through it from outside.
    """

    inner_diameter: float
    outer_diameter: float | None = None
    wall_conductivity: float = INCONEL_CONDUCTIVITY
    insulation: Insulation | None = None
    heating: WallHeating = "generated"

    def __post_init__(self) -> None:
        positive("inner_diameter", self.inner_diameter, "m")
        positive("wall_conductivity", self.wall_conductivity, "W/(m K)")
        if self.outer_diameter is not None and not self.outer_diameter > self.inner_diameter:
            raise ValueError(
                f"outer_diameter is {self.outer_diameter:g} m; expected more than the inner_diameter, "
                f"{self.inner_diameter:g} m"
            )


@dataclass(frozen=True)
class Properties:
    """What is known of the particles.

    Parameters
    ----------
    specific_heat : float, Material or callable
        c_p as for `energy_balance.mean_temperature`. [J/(kg K)]
    bulk_conductivity : float or callable
        k_b, a number or a function of temperature [K]; taken at the mean temperature. [W/(m K)]
    bulk_conductivity_error : float
        Relative standard error of k_b.
    """

    specific_heat: SpecificHeat
    bulk_conductivity: float | Callable[..., ArrayLike]
    bulk_conductivity_error: float = 0.0

    def __post_init__(self) -> None:
        non_negative("bulk_conductivity_error", self.bulk_conductivity_error)

    def k_b(self, temperature: FloatArray) -> Measured:
        """Bulk conductivity at temperatures. [W/(m K)]"""
        k = self.bulk_conductivity
        value = np.broadcast_to(
            positive("bulk_conductivity", k(temperature) if callable(k) else k, "W/(m K)"), temperature.shape
        )
        return Measured(value, self.bulk_conductivity_error * value)

    def c_p(self, temperature: FloatArray) -> FloatArray:
        """Specific heat at temperatures. [J/(kg K)]"""
        c = self.specific_heat.specific_heat if isinstance(self.specific_heat, Material) else self.specific_heat
        value = positive("specific_heat", c(temperature) if callable(c) else c, "J/(kg K)")
        return np.asarray(np.broadcast_to(value, temperature.shape))


@dataclass(frozen=True, eq=False)
class Profile:
    """Readings across the tube: radii [m], temperatures [K], and their standard errors [K] if they are known."""

    radius: FloatArray
    temperature: FloatArray
    error: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Row:
    """The readings at one position; what was not measured there is None.

    Parameters
    ----------
    position : float
        Distance from the start of heating. [m]
    wall_temperature : Measured, optional
        Temperature of the tube's outside. [K]
    profile : Profile, optional
        Temperatures across the tube.
    mean_temperature : Measured, optional
        Mean temperature, in place of a profile. [K]
    power, loss : Measured, optional
        Heating power of the section that ends here, and what of it is lost. A section begins at the station before,
        the first one at z = 0. [W]
    surface_temperature : Measured, optional
        Temperature of the insulation's outside. [K]
    """

    position: float
    wall_temperature: Measured | None = None
    profile: Profile | None = None
    mean_temperature: Measured | None = None
    power: Measured | None = None
    loss: Measured | None = None
    surface_temperature: Measured | None = None

    @property
    def is_station(self) -> bool:
        """Whether the temperature of the flow was measured here."""
        return self.profile is not None or self.mean_temperature is not None


@dataclass(frozen=True, eq=False)
class Run:
    """The readings of a steady run.

    Parameters
    ----------
    name : str
        Name, for tables and messages.
    mass_flow : Measured
        Mass flow. [kg/s]
    rows : sequence of Row
        By position; those without a temperature of the flow give wall and surface temperatures between stations.
    inlet_temperature : Measured, optional
        Mean temperature at z = 0; if not given, the first law is checked from the first station on. [K]
    total_power : Measured, optional
        Power of the whole heated length, in place of that of each section; spread evenly. [W]
    heated_length : float, optional
        The length that belongs to it. [m]
    """

    name: str
    mass_flow: Measured
    rows: Sequence[Row]
    inlet_temperature: Measured | None = None
    total_power: Measured | None = None
    heated_length: float | None = None


@dataclass(frozen=True, eq=False)
class ReducedRun:
    """A run at its stations.

    Parameters
    ----------
    run : Run
        The readings.
    position : (n,) array
        Positions of the stations. [m]
    wall_temperature, mean_temperature : Measured
        Temperatures of the wall's inside and of the flow. [K]
    power, loss : Measured
        Heating power of the section before each station, and what of it is lost. [W]
    heat_flux : Measured
        Flux into the flow in that section. [W/m2]
    heat_transfer_coefficient, bulk_conductivity, nusselt : Measured
        h [W/(m2 K)], k_b at the mean temperature [W/(m K)], Nu.
    z_star : (n,) array
        Inverse Graetz number.
    mass_flux : float
        Mass flow over cross-section. [kg/(m2 s)]
    first_law : FirstLaw or None
        Measured mean temperatures against the balance, at the last stations; None with nothing to start from.
    """

    run: Run
    position: FloatArray
    wall_temperature: Measured
    mean_temperature: Measured
    power: Measured
    loss: Measured
    heat_flux: Measured
    heat_transfer_coefficient: Measured
    bulk_conductivity: Measured
    nusselt: Measured
    z_star: FloatArray
    mass_flux: float
    first_law: FirstLaw | None

    def __str__(self) -> str:
        lines = [f"{self.run.name}: mass flux {self.mass_flux:.4g} kg/(m2 s)"]
        h, nu = self.heat_transfer_coefficient, self.nusselt
        for k, z in enumerate(self.position):
            lines.append(
                f"z {z:.4g} m: T_w {self.wall_temperature.value[k]:.2f} K, T_m {self.mean_temperature.value[k]:.2f} K, "
                f"h {h.value[k]:.1f} ± {h.half_width()[k]:.1f} W/(m2 K), Nu {nu.value[k]:.2f} ± "
                f"{nu.half_width()[k]:.2f} (95 %)"
            )
        return "\n".join(lines + ([str(self.first_law)] if self.first_law is not None else []))
