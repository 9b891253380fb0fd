"""An ensemble of small beds, and what its tests do with it."""

from __future__ import annotations

import warnings
from pathlib import Path

import h5py

import bedrad
from bedrad.heat import RangeWarning
from bedrad.jobs import stages
from bedrad.jobs.crew import Alone
from bedrad.jobs.ensemble import run_ensemble
from bedrad.jobs.job import load_job
from jobs.small_job import ring_bed

BEDS = 4

JOB = """
name = "four beds"
seed = 3

[packing.file]
path = "beds/bed_*.h5"

[statistics]

[view_factors]
rays = 4096

[prediction]
wall_temperatures = ["100 degC", "850 degC"]
velocity = "0.016 m/s"

[output]
figures = false
"""

SWEEP = """
seed = 7

[wall]
diameter = "7.74 mm"

[packing.settle]
diameter = "0.6 mm"
height = "6 mm"

[sweep]
particle_diameter = ["0.5 mm", "0.6 mm"]
seed = [1, 2, 3]

[layers]
margin = 2.0

[statistics]

[view_factors]
rays = 4096
"""


def write_ensemble(folder: Path, text: str = JOB, beds: int = BEDS) -> Path:
    """Write beds of different heights and the job into a folder; the job's path."""
    folder.joinpath("beds").mkdir(parents=True, exist_ok=True)
    for k in range(beds):
        bedrad.write(ring_bed(seed=k + 1, rings=6 + k), folder / "beds" / f"bed_{k}.h5")
    path = folder / "job.toml"
    path.write_text(text, encoding="utf-8")
    return path


def run(job_file: Path, name: str = "r.h5", crew=None):
    """Run the ensemble; its outcome."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RangeWarning)
        return run_ensemble(load_job(job_file), job_file.parent / name, crew)


def column(path, name):
    """What a results file says of every unit."""
    with h5py.File(path) as file:
        return file[f"units/{name}"][()]


class StopsAfter(Alone):
    """A crew whose run is ended by an exception after so many units; the files have been identified before."""

    def __init__(self, count, how):
        self.count, self.how = count, how

    def run(self, function, common, tasks):
        for number, answer in super().run(function, common, tasks):
            yield number, answer
            if function.__name__ == "measure" and number + 1 == self.count:
                raise self.how


class Backwards(Alone):
    """A crew that takes the last task first."""

    def run(self, function, common, tasks):
        for number, task in reversed(list(enumerate(tasks))):
            yield number, function(common, task)


class Killed(BaseException):
    """In place of SIGKILL: nothing is tidied up but what `finally` does."""


def count_runs(monkeypatch, calls):
    """Write down every stage that runs."""

    def counted(name, runner):
        def run_stage(*given):
            calls.append(name)
            return runner(*given)

        return run_stage

    monkeypatch.setattr(stages, "RUNNERS", {n: counted(n, runner) for n, runner in stages.RUNNERS.items()})
