"""The section [prediction] of a job."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from bedrad.heat.uncertainties import Uncertainties
from bedrad.jobs.section import (
    BelowOne,
    Count,
    NotNegative,
    PositiveLength,
    PositiveTemperature,
    Section,
    UpToOne,
    YesNo,
)
from bedrad.jobs.units import Conductivity, HeatFlux, Length, TemperatureDifference, Velocity

__all__ = ["PredictionSection"]


class TemperatureRange(Section):
    """Evenly spaced wall temperatures."""

    lowest: PositiveTemperature
    highest: PositiveTemperature
    count: Count = 21

    def values(self) -> list[float]:
        """The temperatures. [K]"""
        if self.count == 1:
            return [self.lowest]
        step = (self.highest - self.lowest) / (self.count - 1)
        return [self.lowest + k * step for k in range(self.count)]


class ErrorsSection(Section):
    """Standard errors of what the prediction takes as given.

    Those of measured layers and traced factors come by themselves. Gas and bulk conductivity, and the correlations'
    packing fraction and contacts, are relative.
    """

    published: YesNo = False
    tube_diameter: Annotated[Length, Field(ge=0)] = 0.0
    particle_diameter: Annotated[Length, Field(ge=0)] = 0.0
    velocity: Annotated[Velocity, Field(ge=0)] = 0.0
    solid_conductivity: Annotated[Conductivity, Field(ge=0)] = 0.0
    porosity: NotNegative = 0.0
    emissivity: NotNegative = 0.0
    wall_temperature: Annotated[TemperatureDifference, Field(ge=0)] = 0.0
    heat_flux: Annotated[HeatFlux, Field(ge=0)] = 0.0
    gas_conductivity: NotNegative = 0.0
    bulk_conductivity: NotNegative = 0.0
    packing_fraction: NotNegative = 0.0
    contacts_per_area: NotNegative = 0.0

    def uncertainties(self) -> Uncertainties:
        """As the prediction takes them: what is given, over the published ones where those are asked for."""
        given = {name: getattr(self, name) for name in self.model_fields_set - {"published"}}
        return replace(Uncertainties.published() if self.published else Uncertainties(), **given)


class PredictionSection(Section):
    """Heat transfer by the two-layer model, against the wall temperature."""

    wall_temperatures: Annotated[
        Annotated[TemperatureRange, Tag("<one>")]
        | Annotated[tuple[PositiveTemperature, ...], Field(max_length=1000), Tag("<list>")],
        Discriminator(lambda value: "<one>" if isinstance(value, (dict, TemperatureRange)) else "<list>"),
    ]
    velocity: Annotated[Velocity, Field(ge=0)] | None = None
    particle_diameter: PositiveLength | None = None
    nc_distance: Literal["mean", "weighted", "closing"] = "closing"
    solid_conductivity: Annotated[Conductivity, Field(gt=0)] = 2.1
    bulk: Literal["auto", "table 5.2", "zbs"] = "auto"
    bulk_packing_fraction: BelowOne = 0.63
    emissivity: UpToOne = 0.8
    correlation: Literal["watkins", "bedrad"] = "watkins"
    properties: Literal["wall", "mean", "layers"] = "wall"
    heat_flux: HeatFlux | None = None
    errors: ErrorsSection | None = None
    published_systems: YesNo = True

    @model_validator(mode="after")
    def _check(self) -> PredictionSection:
        if self.wall_temperatures == ():
            raise ValueError("wall_temperatures is an empty list; give a temperature, such as '850 degC'")
        if self.properties != "wall" and self.heat_flux is None:
            raise ValueError(f"properties {self.properties!r} needs a heat_flux, which parts mean and wall temperature")
        return self

    def temperatures(self) -> list[float]:
        """The wall temperatures. [K]"""
        given = self.wall_temperatures
        return given.values() if isinstance(given, TemperatureRange) else list(given)
