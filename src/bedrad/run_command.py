"""The command that runs a job: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import cyclopts
from cyclopts import Parameter

from bedrad.command_options import (
    OUTPUT,
    DryRun,
    Output,
    compiling_told,
    fail,
    list_files,
    progress_bars,
    say,
)
from bedrad.errors import visible

if TYPE_CHECKING:
    from bedrad.jobs.crew import Crew
    from bedrad.jobs.job import Job
    from bedrad.jobs.results import Results

__all__ = ["run"]

SHOWN_FAILURES = 5
"""Failed units that are told on the screen; the table has all."""


def run(
    job_file: Path,
    /,
    *,
    output: Output = None,
    workers: Annotated[int | None, Parameter(validator=cyclopts.validators.Number(gte=1, lte=4096))] = None,
    cluster: str | None = None,
    dry_run: DryRun = False,
) -> int:
    """Run a job: the whole way from a bed, or from many, to a heat-transfer prediction.

    What the results file already holds is not computed again: stages of one bed, beds of many.

    Parameters
    ----------
    job_file
        The job, a TOML file.
    output
        The results file (HDF5); the job file's name with .h5 in this folder if not given. Tables and figures go
        beside it.
    workers
        For a job on many beds: processes that each measure one bed at a time. [default: 1]
    cluster
        For a job on many beds: measure them on a Dask cluster (extra cluster); the address of its scheduler, such as
        tcp://host:8786, or its scheduler file.
    dry_run
        Say what would run, what is left out, and why; run nothing.
    """
    from bedrad.jobs.job import load_job

    if workers is not None and cluster is not None:
        raise ValueError("give --workers or --cluster, not both")
    job = load_job(job_file)
    path = output or Path(f"{job_file.stem}.h5")
    if job.is_ensemble:
        return _plan_many(job, path) if dry_run else _run_many(job, path, workers, cluster)
    if workers is not None or cluster is not None:
        raise ValueError(f"{job_file}: names one bed; --workers and --cluster are for a job on many")
    return _plan_one(job, path) if dry_run else _run_one(job, path)


def _plan_one(job: Job, path: Path) -> int:
    from bedrad.jobs.pipeline import make_plan
    from bedrad.jobs.results import Results

    plan = make_plan(job, Results(path))
    for stage in plan.stages:
        say(f"{'kept' if stage.done else 'run':<9} {stage.name:<13} {stage.summary}")
    for name, reason in plan.left_out:
        say(f"{'left out':<9} {name:<13} {reason}")
    say(f"results   {path}")
    return 0


def _run_one(job: Job, path: Path) -> int:
    from bedrad.jobs.pipeline import run_job
    from bedrad.report.tables import write_tables
    from bedrad.report.terminal import summary

    if job.output.figures:
        _check_figures()
    with compiling_told(), progress_bars() as report:
        results = run_job(job, path, report)
    OUTPUT.print(summary(results))
    written = write_tables(results, path.parent) if job.output.tables else []
    if job.output.figures:
        from bedrad.report.figures import write_figures

        written += write_figures(results, path.parent)
    list_files([path, *written])
    return 0


def _plan_many(job: Job, path: Path) -> int:
    from bedrad.jobs.ensemble import plan_ensemble
    from bedrad.jobs.members import beds_of

    plan = plan_ensemble(job, path)
    say(f"{'kept':<9} {beds_of(len(plan.done))} measured before")
    what = ", ".join(_stages(job)) or "settled, nothing measured"
    say(f"{'run':<9} {beds_of(len(plan.members) - len(plan.done))}: {what}")
    for failure in plan.unread:
        say(visible(f"{'failed':<9} {failure.label}: {failure.error}"))
    for failure in plan.repeated:
        say(visible(f"{'left out':<9} {failure.label}: {failure.error}"))
    if job.convergence is not None:
        say(f"{'left out':<9} convergence: it is about one bed")
    say(f"results   {path}")
    return 0


def _stages(job: Job) -> list[str]:
    flow = ["flow"] if job.packing is not None and job.packing.flow is not None else []
    return flow + [name for name in ("statistics", "view_factors", "prediction") if getattr(job, name) is not None]


def _check_figures() -> None:
    """Let a missing library show before the computing, not after."""
    from bedrad.report.style import styled

    with styled():
        pass


def _has_figure(job: Job) -> bool:
    """Whether a job on many beds has something beside seeds to draw its means against."""
    swept = {} if job.sweep is None else job.sweep.values()
    return job.output.figures and any(len(values) > 1 for name, values in swept.items() if name != "seed")


def _run_many(job: Job, path: Path, workers: int | None, cluster: str | None) -> int:
    if _has_figure(job):
        _check_figures()
    with _crew(workers, cluster) as crew:
        # the workers load what they need at the same time
        from bedrad.jobs.ensemble import run_ensemble
        from bedrad.jobs.members import beds_of
        from bedrad.report.ensemble_screen import summary
        from bedrad.report.ensemble_tables import write_tables

        with compiling_told(), progress_bars() as report:
            outcome = run_ensemble(job, path, crew, report)
    OUTPUT.print(summary(outcome.results))
    for failure in outcome.repeated:
        say(visible(f"left out: {failure.label} is {failure.error}"))
    written = write_tables(outcome.results, path.parent) if job.output.tables else []
    if _has_figure(job):
        written += _sweep_figure(outcome.results, path)
    list_files([path, *written])
    if not outcome.failed:
        return 0
    for failure in outcome.failed[:SHOWN_FAILURES]:
        fail(f"{failure.label}: {failure.error.removeprefix(f'{failure.label}: ')}", 1)
    count, whole = len(outcome.failed), outcome.kept + outcome.done + len(outcome.failed)
    return fail(f"{count:,} of {beds_of(whole)} failed, the others are kept; the same command tries them again", 1)


def _sweep_figure(results: Results, path: Path) -> list[Path]:
    """Draw the sweep, where two beds of it at least are there."""
    from bedrad.report.ensemble_records import load_ensemble
    from bedrad.report.style import save_beside, styled
    from bedrad.report.sweep_figure import sweep_figure

    record = load_ensemble(results)
    with styled():
        figure = sweep_figure(record)
        return [] if figure is None else save_beside({"sweep": figure}, path.with_suffix(""), record.name)


@contextmanager
def _crew(workers: int | None, cluster: str | None) -> Iterator[Crew]:
    """Who measures the beds."""
    from bedrad.jobs.crew import Alone, LocalCrew

    if cluster is not None:
        from bedrad.jobs.cluster import ClusterCrew

        with ClusterCrew(cluster) as crew:
            yield crew
    elif workers is not None and workers > 1:
        with LocalCrew(workers, load="bedrad.jobs.unit_work") as local:
            yield local
    else:
        yield Alone()
