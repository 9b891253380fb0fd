from __future__ import annotations

import shutil
import warnings

import pytest

from bedrad.heat import RangeWarning
from bedrad.jobs.job import load_job
from bedrad.jobs.pipeline import run_job
from jobs.small_job import JOB, write_job


@pytest.fixture(scope="session")
def _finished_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished")
    job = write_job(folder, JOB)
    with warnings.catch_warnings():
        # one of the published systems lies outside the range of its own correlations
        warnings.simplefilter("ignore", RangeWarning)
        run_job(load_job(job), folder / "results.h5")
    return folder


@pytest.fixture
def finished(_finished_run, tmp_path):
    """A folder with bed.h5, job.toml and the results.h5 of a finished run."""
    for file in _finished_run.iterdir():
        shutil.copy(file, tmp_path)
    return tmp_path
