"""The pipeline: which stages a job needs, and only those; each is computed once and kept in the results file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from bedrad import __version__
from bedrad.errors import BadFileError
from bedrad.jobs import stages
from bedrad.jobs.job import Job
from bedrad.jobs.locking import results_lock
from bedrad.jobs.results import ENSEMBLE, Results, check_writable, sha256_of

__all__ = ["Plan", "Stage", "lammps_version", "make_plan", "run_job", "stage_digests", "stage_parameters"]

_UPSTREAM: Mapping[str, tuple[str, ...]] = {
    "packing": (),
    "flow": ("packing",),
    "statistics": ("packing",),
    "view_factors": ("packing",),
    "convergence": ("packing",),
    "prediction": ("packing", "flow", "statistics", "view_factors"),
}
"""Stages to the earlier stages that they build on."""

Progress = Callable[[str, float, str], None]
"""Called with the name of a stage, the share of it that is done, and a text."""


@dataclass(frozen=True)
class Stage:
    """A stage of a job.

    Parameters
    ----------
    name : str
        Name of the stage and of its group in the results file.
    digest : str
        SHA-256 of everything that its result depends on.
    summary : str
        What it does, for a dry run.
    done : bool
        Whether the results file holds it already.
    """

    name: str
    digest: str
    summary: str
    done: bool


@dataclass(frozen=True)
class Plan:
    """What a job will do.

    Parameters
    ----------
    stages : tuple of Stage
        Stages in the order of their running.
    left_out : tuple of (str, str)
        Stages that are not needed, and why.
    inputs : mapping
        SHA-256 of every input file.
    """

    stages: tuple[Stage, ...]
    left_out: tuple[tuple[str, str], ...]
    inputs: Mapping[str, str]


def make_plan(job: Job, results: Results) -> Plan:
    """Decide which stages a job needs and which of them are finished.

    Parameters
    ----------
    job : Job
        The job.
    results : Results
        Its results file, which need not exist.

    Raises
    ------
    BadFileError
        If an input file is missing, or the results file is something else.
    """
    if job.packing is not None and job.packing.file is not None:
        bed = job.packing.file.only_path
        if bed.resolve() == results.path.resolve():
            raise BadFileError(f"{results.path}: is the bed of this job; name another results file")
    finished = results.digests()
    if ENSEMBLE in finished:
        raise BadFileError(
            f"{results.path}: holds the results of many beds; name another results file for a job of one"
        )
    inputs = _input_digests(job)
    wanted = _wanted(job, inputs)
    digests = stage_digests({name: parameters for name, (parameters, _) in wanted.items()})
    planned = [
        Stage(name, digests[name], summary, finished.get(name) == digests[name])
        for name, (_, summary) in wanted.items()
    ]
    left_out = [
        (n, f"the job has no [{n}]" + ("; the results file keeps its earlier one" if n in finished else ""))
        for n in stages.BY_SECTION
        if n not in wanted
    ]
    return Plan(tuple(planned), tuple(left_out), inputs)


def run_job(job: Job, path: Path, progress: Progress | None = None) -> Results:
    """Run the stages of a job that are not finished yet.

    Parameters
    ----------
    job : Job
        The job.
    path : Path
        The results file; every finished stage is in it even if a later one fails.
    progress : callable, optional
        Called with the name of a stage, the share done and a text.

    Returns
    -------
    Results
        The results file.

    Raises
    ------
    BadFileError
        If an input file cannot be read, or `path` holds something else.
    EngineFailedError
        If LAMMPS fails.
    OSError
        If the results file cannot be written, or another process is writing it.
    """
    results = Results(path)
    if all(stage.done for stage in make_plan(job, results).stages):
        return _run(job, results, progress)
    check_writable(path)
    with results_lock(path):
        return _run(job, results, progress)


def _run(job: Job, results: Results, progress: Progress | None) -> Results:
    plan = make_plan(job, results)
    stale = {stage.name for stage in plan.stages if not stage.done}
    # what the job has no longer is kept too, as long as it was computed from what is kept
    keep = [name for name in results.digests() if name not in stale and stale.isdisjoint(_UPSTREAM.get(name, ()))]
    attributes = {"job": job.resolved(), "inputs": json.dumps(dict(plan.inputs), sort_keys=True)}
    for stage in plan.stages:
        if stage.done:
            _report(progress, stage.name, 1.0, "kept from an earlier run")
            continue
        fill = stages.RUNNERS[stage.name](job, results, _for_stage(progress, stage.name))
        results.write_stage(stage.name, stage.digest, fill, keep=keep, attributes=attributes)
        keep.append(stage.name)
        _report(progress, stage.name, 1.0, "done")
    results.update_attributes(attributes)
    return results


def _report(progress: Progress | None, stage: str, share: float, text: str) -> None:
    if progress is not None:
        progress(stage, share, text)


def _for_stage(progress: Progress | None, stage: str) -> Callable[[float, str], None]:
    return lambda share, text: _report(progress, stage, share, text)


def stage_digests(parameters: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """SHA-256 of all that the stages' results depend on, from what each depends on beside earlier stages."""
    digests: dict[str, str] = {}
    for name, own in parameters.items():
        content = [
            name,
            __version__,
            stages.REVISIONS[name],
            own,
            [digests[u] for u in _UPSTREAM[name] if u in digests],
        ]
        digests[name] = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
    return digests


def stage_parameters(job: Job, inputs: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    """What the results of each stage of a job depend on beside earlier stages; `inputs` are SHA-256 by path."""
    return {name: parameters for name, (parameters, _) in _wanted(job, inputs).items()}


def _wanted(job: Job, inputs: Mapping[str, str]) -> dict[str, tuple[dict[str, Any], str]]:
    """Stages that the job asks for: what their results depend on beside earlier stages, and a summary."""
    wanted: dict[str, tuple[dict[str, Any], str]] = {}
    layers = job.layers.model_dump(mode="json")
    wall = None if job.wall is None else job.wall.model_dump(mode="json")
    if job.packing is not None:
        source = job.packing.model_dump(mode="json")
        # as it was before there were flows: digests and seeds stay what they were
        if job.packing.flow is None:
            del source["flow"]
        parameters: dict[str, Any] = {"wall": wall}
        if job.packing.file is not None:
            # the content counts, not the place
            source["file"]["path"] = inputs[str(job.packing.file.path)]
            # what is about many beds says nothing about one
            del source["file"]["frames"], source["file"]["independent"]
            if job.packing.file.wall_file is not None:
                source["file"]["wall"] = inputs[str(job.packing.file.wall_file)]
            summary = f"read {job.packing.file.path}"
        else:
            parameters["seed"] = job.seed
            parameters["lammps"] = lammps_version()
            settled = job.packing.settle
            summary = "make a flow" if settled is None else f"settle a bed {settled.height:g} m high with LAMMPS"
        wanted["packing"] = (parameters | {"source": source}, summary)
        if job.packing.flow is not None:
            wanted["flow"] = ({}, "what the flow does")
    if job.statistics is not None:
        wanted["statistics"] = (
            {"layers": layers, **job.statistics.model_dump(mode="json")},
            f"solid fractions, wall contacts within {job.statistics.contact_gap:g} r, no-contact particles",
        )
    if job.view_factors is not None:
        effort = f"{job.view_factors.rays} rays" if job.view_factors.rays else (
            f"a standard error of {job.view_factors.tolerance or 1e-3:g}")  # fmt: skip
        wanted["view_factors"] = (
            {"layers": layers, "seed": job.seed, **job.view_factors.model_dump(mode="json")},
            f"view factors from the wall to {job.layers.count} layers, to {effort}",
        )
    if job.convergence is not None:
        wanted["convergence"] = (
            {"layers": layers, "seed": job.seed, **job.convergence.model_dump(mode="json")},
            f"error of the view factors against run time, reference of {job.convergence.reference_rays} rays",
        )
    if job.prediction is not None:
        wanted["prediction"] = (
            {"wall": wall, "layers": layers, **job.prediction.model_dump(mode="json")},
            "heat transfer against wall temperature by the two-layer model",
        )
    return wanted


def lammps_version() -> str:
    """Version of the LAMMPS package; beds differ from one to the next."""
    try:
        return metadata.version("lammps")
    except metadata.PackageNotFoundError:
        return "none"


def _input_digests(job: Job) -> dict[str, str]:
    if job.packing is None or job.packing.file is None:
        return {}
    return {str(path): sha256_of(path) for path in job.packing.file.inputs}
