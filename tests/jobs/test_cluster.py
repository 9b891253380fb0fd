"""Units of work on a Dask cluster."""

from __future__ import annotations

import json
import sys

import pytest

from bedrad.errors import BadFileError, MissingExtraError
from bedrad.jobs.cluster import ClusterCrew
from bedrad.jobs.crew import Lost
from bedrad.jobs.equality import differences
from jobs import crew_tasks
from jobs.ensemble_job import BEDS, run, write_ensemble

dask, distributed = pytest.importorskip("dask"), pytest.importorskip("distributed")

# what Dask itself leaves open when its processes are killed
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(scope="module")
def cluster():
    """A scheduler in this process, and a worker in one of its own, which its nanny starts again when it is killed."""
    settings = {"distributed.scheduler.allowed-failures": 1}
    with (
        dask.config.set(settings),
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0") as made,
    ):
        yield made


def test_a_cluster_finds_what_one_process_finds(cluster, tmp_path):
    job_file = write_ensemble(tmp_path)
    alone = run(job_file).results.path
    scheduler_file = tmp_path / "scheduler.json"
    scheduler_file.write_text(json.dumps({"address": cluster.scheduler_address}))
    with ClusterCrew(str(scheduler_file)) as crew:
        assert (crew.size, crew.threads) == (1, 1)
        outcome = run(job_file, "cluster.h5", crew)
    assert (outcome.done, outcome.failed) == (BEDS, ())
    assert differences(alone, outcome.results.path) == []


def test_the_tasks_of_a_lost_worker_are_done_again_and_one_that_kills_is_given_up(cluster, tmp_path):
    with ClusterCrew(cluster.scheduler_address) as crew:
        assert dict(crew.run(crew_tasks.die_once, str(tmp_path), range(6))) == {k: k for k in range(6)}
        assert dict(crew.run(crew_tasks.fail, None, ["a"])) == {0: Lost("KeyError: 'a'")}
        found = dict(crew.run(crew_tasks.die_always, None, range(3)))
    assert (found[0], found[2]) == (0, 2)
    assert isinstance(found[1], Lost)
    assert found[1].error.startswith("the cluster gave up on it: KilledWorker")


def test_a_scheduler_that_is_not_there_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr("bedrad.jobs.cluster._CONNECT", 0.2)
    with pytest.raises(ConnectionRefusedError, match="no Dask scheduler answers"):
        ClusterCrew("tcp://127.0.0.1:9")
    with pytest.raises(BadFileError, match="no such scheduler file, and no address"):
        ClusterCrew(str(tmp_path / "scheduler.json"))
    for content in ("{", "[]", "{}"):
        (tmp_path / "broken.json").write_text(content)
        with pytest.raises(BadFileError, match=r"broken\.json: not a scheduler file of Dask"):
            ClusterCrew(str(tmp_path / "broken.json"))


def test_without_dask_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(MissingExtraError, match=r'pip install "bedrad\[cluster\]"'):
        ClusterCrew("tcp://127.0.0.1:9")
