"""The stages of a job: each takes the job and the results so far and returns how to fill its group."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import h5py
import numpy as np

from bedrad import heat
from bedrad.jobs.fields import (
    BUDGET,
    CONVERGENCE,
    HISTORY,
    INPUT_UNITS,
    PREDICTION,
    STATISTICS,
    SYSTEM,
    VIEW_FACTORS,
    WALL_LAYER,
)
from bedrad.jobs.job import Job
from bedrad.jobs.prediction_section import PredictionSection
from bedrad.jobs.results import StageData, save_fields
from bedrad.packings.files import read, save_packing
from bedrad.packings.files.contents import describe_wall
from bedrad.packings.layers import layer_edges
from bedrad.packings.packing import Packing
from bedrad.packings.settle import settle
from bedrad.packings.statistics import Statistics, TrajectoryStatistics, statistics
from bedrad.raytrace.convergence import convergence
from bedrad.raytrace.factors import ViewFactors, covariance_of_mean
from bedrad.raytrace.view_factors import view_factors
from bedrad.walls import Tube, Window

__all__ = ["ORDER", "REVISIONS", "RUNNERS", "Earlier", "fill_statistics", "fill_view_factors", "make_bed"]


class Earlier(Protocol):
    """What a stage builds on: the bed, and the stages before; a results file, or a unit of work in memory."""

    @property
    def threads(self) -> int | None:
        """Threads of the stages that can have several; None for all processors."""

    def bed(self) -> Packing:
        """The bed."""

    def read(self, stage: str) -> StageData:
        """What an earlier stage holds."""


Fill = Callable[[h5py.Group], None]
Progress = Callable[[float, str], None]
Runner = Callable[[Job, Earlier, Progress], Fill]

LARGEST_MISSING = 0.05
"""Share of the radiative conductivity that may pass the last layer without a warning."""

_NC_DISTANCES = {"mean": "nc_distance", "weighted": "nc_distance_weighted", "closing": "nc_distance_closing"}


def run_packing(job: Job, results: Earlier, progress: Progress) -> Fill:  # noqa: ARG001 - one signature for all stages
    """Settle the bed, or read it."""
    bed = make_bed(job, progress)
    return lambda group: save_packing(group, bed)


def make_bed(job: Job, progress: Progress) -> Packing:
    """Settle the bed of a job, or read it; errors as `bedrad.settle` and `bedrad.read`."""
    source = job.packing
    assert source is not None  # noqa: S101 - the plan has this stage only with the section
    wall = None if job.wall is None else job.wall.build()
    if source.file is not None:
        return read(source.file.only_path, source.file.wall if wall is None else wall, **source.file.options())
    assert source.settle is not None  # noqa: S101 - checked with the job
    assert wall is not None  # noqa: S101 - checked with the job
    how = source.settle
    return settle(
        wall,
        how.diameter,
        how.height,
        job.seed,
        sizes=None if how.sizes is None else [(s.diameter, s.share) for s in how.sizes],
        density=how.density,
        friction=how.friction,
        wall_friction=how.wall_friction,
        restitution=how.restitution,
        stiffness=how.stiffness,
        ranks=how.ranks,
        progress=progress,
    )


def run_statistics(job: Job, results: Earlier, progress: Progress) -> Fill:
    """Measure the packing."""
    assert job.statistics is not None  # noqa: S101 - the plan has this stage only with the section
    bed, edges = _bed(job, results)
    progress(0.0, f"{len(bed):,} spheres")
    found = statistics(bed, edges, job.statistics.contact_gap, margin=job.layers.margin)

    return lambda group: fill_statistics(group, found)


def fill_statistics(group: h5py.Group, found: Statistics) -> None:
    """Write statistics into an HDF5 group."""
    save_fields(group, found, STATISTICS)
    if isinstance(found, TrajectoryStatistics):
        behind = {
            f"{name}_structures": ("1", f"independent structures behind: {STATISTICS[name][1]}")
            for name in found.structures
        }
        save_fields(group, {f"{name}_structures": number for name, number in found.structures.items()}, behind)
    kind, radius = describe_wall(found.wall)
    group.attrs["wall"] = kind
    if radius is not None:
        group.attrs["wall_radius"] = radius
    _fill_window(group, found.window)
    for name, count in found.left_out.items():
        group.attrs[f"left_out_{name}"] = count


def _fill_window(group: h5py.Group, window: Window) -> None:
    group.attrs["window"] = window.axial
    if window.lateral is not None:
        group.attrs["window_lateral"] = window.lateral


def run_view_factors(job: Job, results: Earlier, progress: Progress) -> Fill:
    """Trace the view factors."""
    section = job.view_factors
    assert section is not None  # noqa: S101 - the plan has this stage only with the section
    bed, edges = _bed(job, results)
    found = view_factors(
        bed,
        edges,
        tolerance=section.tolerance,
        rays=section.rays,
        seed=job.seed,
        window=bed.window(job.layers.margin),
        threads=results.threads,
        progress=progress,
    )

    return lambda group: fill_view_factors(group, found)


def fill_view_factors(group: h5py.Group, found: ViewFactors) -> None:
    """Write view factors into an HDF5 group."""
    save_fields(group, found, VIEW_FACTORS)
    history = {
        "history_rays": [s.rays for s in found.history],
        "history_seconds": [s.seconds for s in found.history],
        "history_estimates": np.array([s.estimates for s in found.history]),
        "history_errors": np.array([s.errors for s in found.history]),
    }
    save_fields(group, history, HISTORY)
    _fill_window(group, found.window)
    group.attrs["left_out"] = str(found.left_out)
    group.attrs["seed"] = found.seed
    group.attrs["normalisation"] = found.normalisation


def run_convergence(job: Job, results: Earlier, progress: Progress) -> Fill:
    """Measure error against run time."""
    section = job.convergence
    assert section is not None  # noqa: S101 - the plan has this stage only with the section
    bed, edges = _bed(job, results)
    found = convergence(
        bed,
        edges,
        section.rays,
        section.reference_rays,
        seeds=section.seeds,
        seed=job.seed,
        window=bed.window(job.layers.margin),
        progress=progress,
    )

    def fill(group: h5py.Group) -> None:
        save_fields(group, found, CONVERGENCE)
        group.attrs["names"] = list(found.names)

    return fill


def run_prediction(job: Job, results: Earlier, progress: Progress) -> Fill:
    """Predict heat transfer: by measurement where there is one, by correlation beside it, and the published systems."""
    section = job.prediction
    assert section is not None  # noqa: S101 - the plan has this stage only with the section
    T = np.array(section.temperatures())
    errors = section.errors.uncertainties() if section.errors else None
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
            known = heat.prediction.Uncertainties.published() if errors else None
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


RUNNERS: Mapping[str, Runner] = {
    "packing": run_packing,
    "statistics": run_statistics,
    "view_factors": run_view_factors,
    "convergence": run_convergence,
    "prediction": run_prediction,
}

ORDER = tuple(RUNNERS)

REVISIONS: Mapping[str, int] = dict.fromkeys(RUNNERS, 1) | {
    "statistics": 2,
    "view_factors": 2,
    "convergence": 2,
    "prediction": 2,
}
"""Raised where a correction changes what a stage gives, so that earlier results of it are not kept."""


def _bed(job: Job, results: Earlier) -> tuple[Packing, np.ndarray[Any, np.dtype[np.float64]]]:
    bed = results.bed()
    return bed, layer_edges(bed, job.layers.count)


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
        section.velocity,
        solid_conductivity=section.solid_conductivity,
        porosity=1 - section.bulk_packing_fraction,
        emissivity=section.emissivity,
        name=job.name,
    )


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
    """The traced view factors, with the errors of rays and bed together, where the job traces them."""
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
        covariance = covariance + covariance_of_mean(found["block_shares"])[:n, :n]
    return heat.prediction.ViewFactors(layers, covariance=covariance)
