"""The stage that predicts heat transfer, from what the stages before it measured or from correlations."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from bedrad import heat
from bedrad.jobs.fields import BUDGET, INPUT_UNITS, PREDICTION, SYSTEM, WALL_LAYER
from bedrad.jobs.job import Job
from bedrad.jobs.prediction_section import PredictionSection
from bedrad.jobs.results import save_fields
from bedrad.jobs.stage_types import Earlier, Fill, Progress
from bedrad.raytrace.factors import covariance_of_mean
from bedrad.walls import Tube

__all__ = ["LARGEST_MISSING", "run_prediction"]

LARGEST_MISSING = 0.05
"""Share of the radiative conductivity that may pass the last layer without a warning."""

_NC_DISTANCES = {"mean": "nc_distance", "weighted": "nc_distance_weighted", "closing": "nc_distance_closing"}


def run_prediction(job: Job, results: Earlier, progress: Progress) -> Fill:
    """Predict heat transfer: by measurement where there is one, by correlation beside it, and the published systems."""
    section = job.prediction
    assert section is not None  # noqa: S101 - the plan has this stage only with the section
    T = np.array(section.temperatures())
    errors = _errors(results, section)
    system = _system(job, results, section)
    cases: dict[str, tuple[str, Any, Any, Any]] = {}
    measured, traced = _measured(job, results, section), _traced(job, results)
    by_correlation = "published" if section.correlation == "watkins" else "correlated"
    if measured is not None or traced is not None:
        texts = (
            "measured packing" if measured else "correlated packing",
            "traced" if traced else by_correlation,
        )
        cases["measured"] = (f"{texts[0]}, {texts[1]} view factors", system, measured, traced)
    cases["correlations"] = (f"correlations, {by_correlation} view factors", system, None, None)
    if section.published_systems:
        for published in heat.prediction.TABLE_5_1:
            cases[published.name.replace(" ", "_")] = (f"Table 5.1, {published.name}", published, None, None)
    found = {}
    for number, (key, (title, what, layer, factors)) in enumerate(cases.items()):
        progress(number / len(cases), title)
        model = section.bulk if what is system else "auto"
        if what is system:
            prediction = heat.prediction.predict(
                what, T, layer, factors, model, section.correlation, property_temperature=section.properties,
                heat_flux=section.heat_flux, uncertainties=errors,
            )  # fmt: skip
        else:
            # as published: a heat flux and errors of the job's own tube mean nothing to another
            known = heat.prediction.Uncertainties.published() if section.errors else None
            prediction = heat.prediction.predict(what, T, uncertainties=known)
        reach = len(prediction.view_factors.to_layers)
        with warnings.catch_warnings():
            # the same inputs once more: the warnings about them have been given
            warnings.simplefilter("ignore", heat.RangeWarning)
            bound = heat.prediction.largest_wall_radiation_effect(what, T, prediction.wall_layer, model, reach)
        found[key] = (title, prediction, bound)

    def fill(group: h5py.Group) -> None:
        for key, (title, prediction, bound) in found.items():
            case = group.create_group(key)
            case.attrs["title"] = title
            case.attrs["bulk_model"] = prediction.bulk_model
            case.attrs["property_temperature"] = prediction.property_temperature
            save_fields(case, prediction, PREDICTION)
            budget = case.create_group("budget")
            budget.attrs["inputs"] = list(prediction.budget.names)
            budget.attrs["input_units"] = [INPUT_UNITS.get(name, "1") for name in prediction.budget.names]
            save_fields(budget, prediction.budget, BUDGET)
            save_fields(case, {"radiation_bound": bound}, {"radiation_bound": PREDICTION["radiation_bound"]})
            save_fields(case, prediction.system, SYSTEM)
            save_fields(case, prediction.wall_layer, WALL_LAYER)
            save_fields(
                case,
                {
                    "view_factors": prediction.view_factors.to_layers,
                    "view_factors_error": prediction.view_factors.errors,
                },
                {"view_factors": ("1", "view factors from the wall to the layers")},
            )

    return fill


def _system(job: Job, results: Earlier, section: PredictionSection) -> Any:
    if job.packing is None:
        wall, diameter = None if job.wall is None else job.wall.build(), section.particle_diameter
    else:
        bed = results.bed()
        wall, diameter = bed.wall, section.particle_diameter or bed.mean_diameter
        if np.ptp(bed.radii) > 0.02 * bed.radii.mean():
            warnings.warn(
                "the models of the wall layer are for equal spheres; they get the mean diameter", stacklevel=2
            )
    if not isinstance(wall, Tube) or diameter is None:
        raise ValueError(f"[prediction] is for flow in a tube; the wall is {wall!r}")
    return heat.prediction.System(
        2 * wall.radius,
        diameter,
        _velocity(results, section),
        solid_conductivity=section.solid_conductivity,
        porosity=1 - section.bulk_packing_fraction,
        emissivity=section.emissivity,
        name=job.name,
    )


def _velocity(results: Earlier, section: PredictionSection) -> float:
    """The velocity of the flow that was measured, or the one that is given. [m/s]"""
    if section.velocity is not None:
        return section.velocity
    flow = results.flow()
    assert flow is not None  # noqa: S101 - checked with the job
    return flow.measures.velocity


def _errors(results: Earlier, section: PredictionSection) -> heat.prediction.Uncertainties | None:
    """Errors of what is given, and of a velocity that was measured."""
    errors = section.errors.uncertainties() if section.errors else None
    flow = results.flow()
    if flow is None or (section.errors is not None and "velocity" in section.errors.model_fields_set):
        return errors
    error = _known(flow.measures.velocity_error, "the velocity")
    return dataclasses.replace(errors or heat.prediction.Uncertainties(), velocity=error)


def _measured(job: Job, results: Earlier, section: PredictionSection) -> Any:
    """The measured wall layer, where the job measures one."""
    if job.statistics is None:
        return None
    found = results.read("statistics")
    name = _nc_distance(found, section.nc_distance)
    inputs = {"packing_fraction": "packing_fraction", "contacts_per_area": "contacts_per_area"}
    if name is not None:
        inputs["nc_distance"] = name
    values = {key: found[source] for key, source in inputs.items()}
    errors = {f"{key}_error": _known(found[f"{source}_error"], source) for key, source in inputs.items()}
    return heat.prediction.WallLayer(**values, **errors, form="general")


def _nc_distance(found: Mapping[str, Any], wanted: str) -> str | None:
    """Name of the distance to use; None where there are no such particles, so that any distance is as good."""
    if not found["no_contacts"]:
        return None
    name = _NC_DISTANCES[wanted]
    if np.isnan(found[name]):
        warnings.warn(
            f"the statistics give no {name} for this bed (spheres of several sizes, or too few without contact); "
            "the prediction takes nc_distance_weighted",
            stacklevel=2,
        )
        return "nc_distance_weighted"
    return name


def _known(error: float, name: str) -> float:
    """A standard error, or a warning and zero where the bed is too short to have one."""
    if not np.isnan(error):
        return float(error)
    warnings.warn(f"no standard error of {name}: the errors of the prediction leave it out", stacklevel=3)
    return 0.0


def _traced(job: Job, results: Earlier) -> Any:
    """The traced view factors, with the errors of rays and bed together, where the job traces them.

    The scatter of the bed is seen through rays, so that it has their part in it already: the sum is on the safe side,
    by a root of two where the rays decide.
    """
    if job.view_factors is None:
        return None
    found = results.read("view_factors")
    layers, beyond = found["layers"], found["beyond"]
    missing = beyond * (len(layers) + 1)
    if missing > LARGEST_MISSING * float(layers @ np.arange(1, len(layers) + 1)):
        warnings.warn(
            f"{beyond:.3g} of the radiation passes the last of {len(layers)} layers and is missing from the radiative "
            "conductivity; give [layers] a larger count",
            stacklevel=2,
        )
    for k, error in enumerate(found["layers_bed_error"]):
        _known(error, f"the bed's scatter of F_w{k + 1}")
    n = len(layers)
    covariance = found["covariance"][:n, :n]
    if np.isfinite(found["layers_bed_error"]).all():
        of_bed = found["bed_covariance"] if "bed_covariance" in found else covariance_of_mean(found["block_shares"])
        covariance = covariance + of_bed[:n, :n]
    return heat.prediction.ViewFactors(layers, covariance=covariance)
