"""The stages of a job: each takes the job and the results so far and returns how to fill its group."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import h5py
import numpy as np

from bedrad import heat
from bedrad.jobs.fields import (
    CONVERGENCE,
    PREDICTION,
    STATISTICS,
    SYSTEM,
    VIEW_FACTORS,
    WALL_LAYER,
)
from bedrad.jobs.job import Job, PredictionSection, TemperatureRange
from bedrad.jobs.results import Results, save_fields
from bedrad.packings.files import read, save_packing
from bedrad.packings.layers import layer_edges
from bedrad.packings.packing import Packing
from bedrad.packings.settle import settle
from bedrad.packings.statistics import statistics
from bedrad.raytrace.convergence import convergence
from bedrad.raytrace.view_factors import view_factors
from bedrad.walls import Tube

__all__ = ["ORDER", "RUNNERS"]

Fill = Callable[[h5py.Group], None]
Progress = Callable[[float, str], None]
Runner = Callable[[Job, Results, Progress], Fill]

_NC_DISTANCES = {"mean": "nc_distance", "weighted": "nc_distance_weighted", "closing": "nc_distance_closing"}


def run_packing(job: Job, results: Results, progress: Progress) -> Fill:  # noqa: ARG001 - one signature for all stages
    """Settle the bed, or read it."""
    source = job.packing
    assert source is not None  # noqa: S101 - the plan has this stage only with the section
    wall = None if job.wall is None else job.wall.build()
    if source.file is not None:
        file = source.file
        bed = read(file.path, wall, diameter=file.diameter, period=file.period, frame=file.frame)
    else:
        assert source.settle is not None  # noqa: S101 - checked with the job
        assert wall is not None  # noqa: S101 - checked with the job
        how = source.settle
        bed = settle(
            wall,
            how.diameter,
            how.height,
            # LAMMPS takes no seed of zero
            job.seed + 1,
            sizes=None if how.sizes is None else [(s.diameter, s.share) for s in how.sizes],
            density=how.density,
            friction=how.friction,
            wall_friction=how.wall_friction,
            restitution=how.restitution,
            stiffness=how.stiffness,
            ranks=how.ranks,
            progress=progress,
        )
    return lambda group: save_packing(group, bed)


def run_statistics(job: Job, results: Results, progress: Progress) -> Fill:
    """Measure the packing."""
    assert job.statistics is not None  # noqa: S101 - the plan has this stage only with the section
    bed, edges = _bed(job, results)
    progress(0.0, f"{len(bed):,} spheres")
    found = statistics(bed, edges, job.statistics.contact_gap, margin=job.layers.margin)

    def fill(group: h5py.Group) -> None:
        save_fields(group, found, STATISTICS)
        group.attrs["window"] = found.window.axial
        for name, count in found.left_out.items():
            group.attrs[f"left_out_{name}"] = count

    return fill


def run_view_factors(job: Job, results: Results, progress: Progress) -> Fill:
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
        progress=progress,
    )

    def fill(group: h5py.Group) -> None:
        save_fields(group, found, VIEW_FACTORS)
        save_fields(
            group,
            {
                "history_rays": [s.rays for s in found.history],
                "history_seconds": [s.seconds for s in found.history],
                "history_estimates": np.array([s.estimates for s in found.history]),
                "history_errors": np.array([s.errors for s in found.history]),
            },
            {
                "history_rays": ("1", "rays after each round"),
                "history_seconds": ("s", "run time after each round"),
                "history_estimates": ("1", "view factors after each round: layers, beyond, wall, escaped"),
                "history_errors": ("1", "their standard errors"),
            },
        )
        group.attrs["window"] = found.window.axial
        group.attrs["left_out"] = str(found.left_out)
        group.attrs["seed"] = found.seed

    return fill


def run_convergence(job: Job, results: Results, progress: Progress) -> Fill:
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


def run_prediction(job: Job, results: Results, progress: Progress) -> Fill:
    """Predict heat transfer: by measurement where there is one, by correlation beside it, and the published systems."""
    section = job.prediction
    assert section is not None  # noqa: S101 - the plan has this stage only with the section
    temperatures = section.wall_temperatures
    T = np.array(temperatures.values() if isinstance(temperatures, TemperatureRange) else temperatures)
    system = _system(job, results, section)
    cases: dict[str, tuple[str, Any, Any, Any]] = {}
    measured, traced = _measured(job, results, section), _traced(job, results)
    if measured is not None or traced is not None:
        texts = (
            "measured packing" if measured else "correlated packing",
            "traced" if traced else "published",
        )
        cases["measured"] = (f"{texts[0]}, {texts[1]} view factors", system, measured, traced)
    cases["correlations"] = ("correlations, published view factors", system, None, None)
    if section.published_systems:
        for published in heat.prediction.TABLE_5_1:
            cases[published.name.replace(" ", "_")] = (f"Table 5.1, {published.name}", published, None, None)
    found = {}
    for number, (key, (title, what, layer, factors)) in enumerate(cases.items()):
        progress(number / len(cases), title)
        model = section.bulk if what is system else "auto"
        prediction = heat.prediction.predict(what, T, layer, factors, model)
        with warnings.catch_warnings():
            # the same inputs once more: the warnings about them have been given
            warnings.simplefilter("ignore", heat.RangeWarning)
            bound = heat.prediction.largest_wall_radiation_effect(what, T, layer, model, job.layers.count)
        found[key] = (title, prediction, bound)

    def fill(group: h5py.Group) -> None:
        for key, (title, prediction, bound) in found.items():
            case = group.create_group(key)
            case.attrs["title"] = title
            case.attrs["bulk_model"] = prediction.bulk_model
            save_fields(case, prediction, PREDICTION)
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


def _bed(job: Job, results: Results) -> tuple[Packing, np.ndarray[Any, np.dtype[np.float64]]]:
    bed = read(results.path)
    return bed, layer_edges(bed, job.layers.count)


def _system(job: Job, results: Results, section: PredictionSection) -> Any:
    if job.packing is None:
        wall, diameter = None if job.wall is None else job.wall.build(), section.particle_diameter
    else:
        bed = read(results.path)
        wall, diameter = bed.wall, section.particle_diameter or bed.mean_diameter
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


def _measured(job: Job, results: Results, section: PredictionSection) -> Any:
    """The measured wall layer, where the job measures one."""
    if job.statistics is None:
        return None
    found = results.read("statistics")
    distance = _NC_DISTANCES[section.nc_distance]
    inputs = {
        "packing_fraction": "packing_fraction",
        "contacts_per_area": "contacts_per_area",
        "nc_distance": distance,
    }
    values = {name: found[source] for name, source in inputs.items()}
    # one block gives no error (nan): carried as none
    errors = {f"{name}_error": float(np.nan_to_num(found[f"{source}_error"])) for name, source in inputs.items()}
    return heat.prediction.WallLayer(**values, **errors, form="general")


def _traced(job: Job, results: Results) -> Any:
    """The traced view factors, with the errors of rays and bed together, where the job traces them."""
    if job.view_factors is None:
        return None
    found = results.read("view_factors")
    errors = np.hypot(found["layers_error"], np.nan_to_num(found["layers_bed_error"]))
    return heat.prediction.ViewFactors(found["layers"], errors)
