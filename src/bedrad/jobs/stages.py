"""The stages of a job: each takes the job and the results so far and returns how to fill its group."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import h5py
import numpy as np

from bedrad.jobs.fields import (
    CONVERGENCE,
    FLOW,
    HISTORY,
    STATISTICS,
    VIEW_FACTORS,
)
from bedrad.jobs.job import Job
from bedrad.jobs.prediction_stage import run_prediction
from bedrad.jobs.results import save_fields
from bedrad.jobs.stage_types import Earlier, Fill, FloatArray, Progress, Runner
from bedrad.packings.files import read, save_packing
from bedrad.packings.files.contents import describe_wall
from bedrad.packings.flow import Flow, flow
from bedrad.packings.layers import layer_edges
from bedrad.packings.packing import Packing
from bedrad.packings.settle import settle
from bedrad.packings.statistics import Statistics, TrajectoryStatistics, statistics
from bedrad.raytrace.convergence import convergence
from bedrad.raytrace.factors import ViewFactors
from bedrad.raytrace.view_factors import view_factors
from bedrad.walls import Window

__all__ = [
    "BY_SECTION",
    "ORDER",
    "REVISIONS",
    "RUNNERS",
    "Earlier",
    "fill_statistics",
    "fill_view_factors",
    "make_bed",
    "make_flow",
]


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
    assert source.settle is not None  # noqa: S101 - checked with the job; a flow is made by `make_flow`
    assert wall is not None  # noqa: S101 - checked with the job
    how = source.settle
    return settle(wall, height=how.height, seed=job.seed, **how.grains(), ranks=how.ranks, progress=progress)


def make_flow(job: Job, folder: Path, progress: Progress) -> Flow:
    """Let the spheres of a job flow in a folder, or go on with what is there; errors as `bedrad.flow`."""
    assert job.packing is not None  # noqa: S101 - the caller has seen it
    assert job.packing.flow is not None  # noqa: S101 - the same
    assert job.wall is not None  # noqa: S101 - checked with the job
    how = job.packing.flow
    return flow(job.wall.build(), **how.arguments(), seed=job.seed, ranks=how.ranks, work_dir=folder, progress=progress)


def run_flow(job: Job, results: Earlier, progress: Progress) -> Fill:  # noqa: ARG001 - one signature for all stages
    """Write down what the flow did."""
    flow = results.flow()
    assert flow is not None  # noqa: S101 - the stage is one of flows only
    profile, measures = flow.measures.profile, flow.measures
    of_profile = {"core_velocity": profile.core, "wall_velocity": profile.wall, "shear_width": profile.shear_width}
    unit = math.sqrt(flow.plan.grains.gravity * flow.plan.mean)
    own = {
        "froude": measures.velocity / unit,
        "froude_error": measures.velocity_error / unit,
        "set_velocity": flow.plan.velocity,
        "profile_radii": profile.radii,
        "profile_speeds": profile.speeds,
        "profile_speeds_error": profile.speeds_error,
        "frames": len(flow),
        "resumed": int("resumed_at_step" in flow[0].provenance),
    }

    def fill(group: h5py.Group) -> None:
        save_fields(group, {**vars(measures), **of_profile, **own}, FLOW)
        group.attrs["problems"] = "; ".join(measures.problems)

    return fill


def run_statistics(job: Job, results: Earlier, progress: Progress) -> Fill:
    """Measure the packing."""
    assert job.statistics is not None  # noqa: S101 - the plan has this stage only with the section
    bed, edges, window = _sample(job, results)
    progress(0.0, f"{len(results.bed()):,} spheres")
    found = statistics(bed, edges, job.statistics.contact_gap, window)

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
    bed, edges, window = _sample(job, results)
    found = view_factors(
        bed,
        edges,
        tolerance=section.tolerance,
        rays=section.rays,
        seed=job.seed,
        window=window,
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
    bed = results.bed()
    found = convergence(
        bed,
        layer_edges(bed, job.layers.count),
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


RUNNERS: Mapping[str, Runner] = {
    "packing": run_packing,
    "flow": run_flow,
    "statistics": run_statistics,
    "view_factors": run_view_factors,
    "convergence": run_convergence,
    "prediction": run_prediction,
}

ORDER = tuple(RUNNERS)

BY_SECTION = tuple(name for name in ORDER if name != "flow")
"""Those that a job asks for by a section of their name; what a flow does is told of every flow."""

REVISIONS: Mapping[str, int] = dict.fromkeys(RUNNERS, 1) | {
    "statistics": 2,
    "view_factors": 2,
    "convergence": 2,
    "prediction": 2,
}
"""Raised where a correction changes what a stage gives, so that earlier results of it are not kept."""


def _sample(job: Job, results: Earlier) -> tuple[Packing | Flow, FloatArray, Window]:
    """What is measured, the edges of its layers, and where: a flow in its window, a bed without its open ends."""
    bed, flow = results.bed(), results.flow()
    edges = layer_edges(bed, job.layers.count)
    return (bed, edges, bed.window(job.layers.margin)) if flow is None else (flow, edges, flow.window)
