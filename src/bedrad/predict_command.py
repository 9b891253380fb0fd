"""The command that predicts heat transfer: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from bedrad.command_options import (
    Conductivity,
    HeatFlux,
    Length,
    Output,
    PerArea,
    Seed,
    Temperature,
    Velocity,
    list_files,
    say,
)

if TYPE_CHECKING:
    from bedrad.heat.prediction import Prediction

__all__ = ["predict"]

_SYSTEM = ("tube_diameter", "particle_diameter", "velocity", "solid_conductivity", "porosity", "emissivity")


def predict(
    *,
    tube: Annotated[tuple[Length, ...], Parameter(name="--tube", negative=())],
    diameter: Annotated[tuple[Length, ...], Parameter(negative=())],
    velocity: Annotated[tuple[Velocity, ...], Parameter(negative=())],
    temperature: Annotated[tuple[Temperature, ...], Parameter(negative=())],
    solid_conductivity: Conductivity = 2.1,
    packing_fraction: float | None = None,
    contacts_per_area: PerArea | None = None,
    nc_distance: float | None = None,
    view_factor: Annotated[tuple[float, ...], Parameter(negative=())] = (),
    correlation: Literal["watkins", "bedrad"] = "watkins",
    bulk: Literal["auto", "table 5.2", "zbs"] = "auto",
    bulk_packing_fraction: float = 0.63,
    emissivity: float = 0.8,
    properties: Literal["wall", "mean", "layers"] = "wall",
    heat_flux: HeatFlux | None = None,
    error: Annotated[tuple[str, ...], Parameter(negative=())] = (),
    published_errors: Annotated[bool, Parameter(negative=())] = False,
    budget: Annotated[bool, Parameter(negative=())] = False,
    samples: int = 0,
    seed: Seed = 0,
    output: Output = None,
) -> None:
    """Predict the heat transfer of dense flows in hot tubes by the two-layer model (Watkins 2018).

    Several tubes, diameters, velocities and temperatures make a table of all their combinations.

    Parameters
    ----------
    tube
        Inner diameter of the tube; once for each.
    diameter
        Particle diameter; once for each.
    velocity
        Mean flow velocity, once for each; enters through the correlations of the wall layer.
    temperature
        Wall temperature, such as 850degC; once for each.
    solid_conductivity
        Conductivity of the particles. [default: 2.1 W/(m K), zirconia-silica]
    packing_fraction
        Measured solid fraction of the wall layer, in place of the correlation; with --contacts-per-area.
    contacts_per_area
        Measured wall contacts per wall area, such as "1.9 mm^-2", in place of the correlation; with --packing-fraction.
    nc_distance
        Measured distance of the no-contact particles from the wall, in radii, with the two above; 0.22 if not given.
    view_factor
        View factor to a layer, once for each layer from the wall; by --correlation if not given.
    correlation
        Whose flows are taken for wall layer and view factors that are not given: Watkins' (0.80, 0.18, 0.02 at any
        velocity, no errors) or bedrad's own, with errors (docs/flow_study.md).
    bulk
        Bulk conductivity: the measured fits where there is one for the particles, or a model.
    bulk_packing_fraction
        Solid fraction of the bulk.
    emissivity
        Emissivity of the particles in the bulk; in the wall layer all surfaces are black.
    properties
        Temperature of the properties: the wall's, the mean of the flow, or each layer's own; the last two need
        --heat-flux.
    heat_flux
        Heat flux from wall to flow, such as 50kW/m^2; gives the mean temperature too.
    error
        Standard error of an input, once for each: "bulk_conductivity=5%", "particle_diameter=10um",
        "wall_temperature=5K", "porosity=0.01". A percentage of the input, or a size with its unit; gas and bulk
        conductivity, view factors and correlated wall layers are relative to their values.
    published_errors
        Take the uncertainties that the source states: 11 % (95 %) of the bulk conductivity, 5 % and 16 % at most of the
        wall layer's correlations.
    budget
        Print which input makes how much of the uncertainty, at the hottest wall.
    samples
        Draws of a Monte Carlo propagation beside the first-order one; 0 for none.
    seed
        Seed of the draws.
    output
        Write all numbers as a table (CSV), with the budget of uncertainty and a figure (PNG, extra view) beside it.
    """
    from dataclasses import replace

    import numpy as np

    from bedrad.heat import prediction

    if not 0.0 < bulk_packing_fraction < 1.0:
        raise ValueError(f"--bulk-packing-fraction is {bulk_packing_fraction:g}; expected a number between 0 and 1")
    measured = packing_fraction is not None and contacts_per_area is not None
    if not measured and (packing_fraction, contacts_per_area, nc_distance) != (None, None, None):
        raise ValueError("give --packing-fraction and --contacts-per-area together, and --nc-distance with them only")
    if measured and len(tube) * len(diameter) * len(velocity) > 1:
        raise ValueError("a measured wall layer belongs to one flow: give one --tube, --diameter and --velocity")
    if output is not None:
        _check_output(output)
    layer_values = (packing_fraction, contacts_per_area, 0.22 if nc_distance is None else nc_distance)
    found = []
    for D, d, U in product(tube, diameter, velocity):
        system = prediction.System(
            D, d, U, solid_conductivity=solid_conductivity, porosity=1 - bulk_packing_fraction, emissivity=emissivity
        )
        of_layer = dict(zip(("packing_fraction", "contacts_per_area", "nc_distance"), layer_values, strict=True))
        wholes = {name: getattr(system, name) for name in _SYSTEM} | {
            "wall_temperature": max(temperature), "heat_flux": abs(heat_flux or 0.0),
            "gas_conductivity": 1.0, "bulk_conductivity": 1.0, "view_factors": 1.0,
        } | {name: value if measured else 1.0 for name, value in of_layer.items()}  # fmt: skip
        errors = _errors(error, wholes, measured=measured, traced=bool(view_factor), flux=heat_flux is not None)
        own = {f"{name}_error": errors.pop(name, 0.0) for name in of_layer} if measured else {}
        layer = prediction.WallLayer(*layer_values, **own) if measured else None  # type: ignore[arg-type]
        share = errors.pop("view_factors", 0.0)
        factors = prediction.ViewFactors(np.array(view_factor), share * np.array(view_factor)) if view_factor else None
        base = prediction.Uncertainties.published() if published_errors else prediction.Uncertainties()
        found.append(
            prediction.predict(
                system, list(temperature), layer, factors, bulk, correlation,
                property_temperature=properties, heat_flux=heat_flux, uncertainties=replace(base, **errors),
                samples=samples, seed=seed,
            )
        )  # fmt: skip
    for one in found:
        say(str(one))
        if one.monte_carlo is not None:
            say(str(one.monte_carlo))
        if budget:
            say(str(one.budget))
    if output is not None:
        _write(found, output)


_UNITS = {
    "tube_diameter": "m",
    "particle_diameter": "m",
    "velocity": "m/s",
    "solid_conductivity": "W/(m K)",
    "heat_flux": "W/m^2",
    "contacts_per_area": "1/m^2",
}
"""Units of the inputs' standard errors; the others are numbers, or have a reader of their own."""


def _size(text: str, whole: float) -> tuple[str, float]:
    """Name and standard error from a text such as ``"particle_diameter=10um"`` or ``"bulk_conductivity=5%"``."""
    from bedrad.jobs.units import quantity, temperature_difference

    name, size = (part.strip() for part in text.split("=", 1))
    if size.endswith("%"):
        return name, float(size[:-1]) / 100 * whole
    if name == "wall_temperature":
        return name, temperature_difference(size)
    return name, quantity(size, _UNITS[name]) if name in _UNITS else float(size)


def _errors(
    texts: Sequence[str], wholes: Mapping[str, float], *, measured: bool, traced: bool, flux: bool
) -> dict[str, float]:
    """Standard errors by name, in SI units; percentages of what the inputs are.

    Parameters
    ----------
    texts : sequence of str
        What was given after ``--error``.
    wholes : mapping
        Inputs by name, of which percentages are taken; 1 for those relative to a model or a correlation.
    measured, traced, flux : bool
        Whether a wall layer, view factors and a heat flux were given, without which their errors mean nothing.
    """
    found: dict[str, float] = {}
    needs = {"nc_distance": (measured, "--packing-fraction and --contacts-per-area"),
             "view_factors": (traced, "--view-factor"), "heat_flux": (flux, "--heat-flux")}  # fmt: skip
    for text in texts:
        name = text.partition("=")[0].strip()
        if "=" not in text or name not in wholes:
            raise ValueError(f'--error {text!r}: expected "NAME=SIZE" with a name of {", ".join(wholes)}')
        there, what = needs.get(name, (True, ""))
        if not there:
            raise ValueError(f"--error {text!r}: there is no such input without {what}")
        try:
            found |= [_size(text, wholes[name])]
        except ValueError as problem:
            raise ValueError(f"--error {text!r}: {problem}") from None
        if not 0.0 <= found[name] < float("inf"):
            raise ValueError(f"--error {text!r}: standard error of {name} is {found[name]:g}; expected none below 0")
    return found


def _check_output(output: Path) -> None:
    from bedrad.jobs.results import check_writable
    from bedrad.report.style import styled

    if output.suffix.lower() != ".csv":
        raise ValueError(f"--output {str(output)!r}: expected a file that ends in .csv")
    check_writable(output)
    # a missing library shows before the computing, not after
    with styled():
        pass


def _write(found: Sequence[Prediction], output: Path) -> None:
    from bedrad.report.prediction_figures import write_prediction_figure
    from bedrad.report.prediction_tables import write_prediction_tables

    written = write_prediction_tables(found, output)
    figure = output.with_suffix(".png")
    write_prediction_figure(found, figure)
    list_files([*written, figure])
