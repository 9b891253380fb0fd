"""Many beds: each measured once and rightly, whatever becomes of the others and of the run."""

from __future__ import annotations

import errno
import json
import os
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

import bedrad
from bedrad.errors import BadFileError, EngineFailedError
from bedrad.jobs import stages
from bedrad.jobs.ensemble import plan_ensemble
from bedrad.jobs.ensemble_store import EnsembleStore
from bedrad.jobs.equality import differences
from bedrad.jobs.job import load_job
from bedrad.jobs.journal import Journal
from bedrad.jobs.locking import results_lock
from bedrad.jobs.pipeline import run_job
from bedrad.jobs.results import sha256_of
from jobs.ensemble_job import BEDS, JOB, Backwards, Killed, StopsAfter, column, count_runs, run, write_ensemble
from jobs.small_job import ring_bed

STAGES = ("statistics", "view_factors", "prediction")


@pytest.fixture(scope="module")
def _whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    run(write_ensemble(folder))
    return folder


@pytest.fixture
def whole(_whole, tmp_path):
    """A folder with beds, job and results of an undisturbed run; its results file."""
    shutil.copytree(_whole, tmp_path, dirs_exist_ok=True)
    return tmp_path / "r.h5"


@pytest.fixture
def job_file(_whole, tmp_path):
    """A job that has not run."""
    shutil.copytree(_whole / "beds", tmp_path / "new" / "beds")
    return shutil.copy(_whole / "job.toml", tmp_path / "new" / "job.toml")


def unlike(one, two):
    """What differs in two results files beside the folders they were made in."""
    return [name for name in differences(one, two) if name.partition("@")[0] not in ("units/label", "units/path")
            and not name.startswith("/@") and name != "ensemble@digest"]  # fmt: skip


def tidy(folder):
    """Whether nothing but what is wanted is there."""
    return {file.name for file in folder.iterdir()} == {"beds", "job.toml", "r.h5"}


# What is measured


def test_every_bed_is_measured_as_it_would_be_alone(whole):
    seeds = column(whole, "seed")
    for k in range(BEDS):
        bed = bedrad.read(whole.parent / "beds" / f"bed_{k}.h5")
        edges = bedrad.layer_edges(bed, 3)
        found = bedrad.statistics(bed, edges, 1e-2)
        factors = bedrad.view_factors(bed, edges, rays=4096, seed=int(seeds[k]))
        assert column(whole, "statistics/packing_fraction")[k] == found.packing_fraction
        np.testing.assert_array_equal(column(whole, "statistics/profile")[k], found.profile)
        np.testing.assert_array_equal(column(whole, "view_factors/layers")[k], factors.layers)
        np.testing.assert_array_equal(column(whole, "view_factors/covariance")[k], factors.covariance)
    assert len(set(seeds.tolist())) == BEDS


def test_a_prediction_is_that_of_a_job_on_the_one_bed(whole, tmp_path):
    seed = int(column(whole, "seed")[2])
    text = JOB.replace("beds/bed_*.h5", "beds/bed_2.h5").replace("seed = 3", f"seed = {seed}")
    (tmp_path / "one.toml").write_text(text.replace("[prediction]", "[prediction]\npublished_systems = false"))
    alone = run_job(load_job(tmp_path / "one.toml"), tmp_path / "one.h5").read("prediction")
    for case in ("measured", "correlations"):
        for name in ("heat_transfer_coefficient", "heat_transfer_coefficient_error", "nusselt"):
            np.testing.assert_array_equal(column(whole, f"prediction/{case}/{name}")[2], alone[case][name])


def test_means_and_errors_are_those_of_the_columns(whole):
    x = column(whole, "statistics/packing_fraction")
    rays = column(whole, "view_factors/layers_error")
    with h5py.File(whole) as file:
        ensemble = file["ensemble"]
        assert ensemble["units"][()].tolist() == [BEDS]
        assert ensemble["statistics/packing_fraction"][0] == pytest.approx(np.mean(x), rel=1e-14)
        assert ensemble["statistics/packing_fraction_scatter"][0] == pytest.approx(np.std(x, ddof=1), rel=1e-12)
        error = ensemble["statistics/packing_fraction_packing_error"][0]
        assert error == pytest.approx(np.std(x, ddof=1) / np.sqrt(BEDS), rel=1e-12)
        np.testing.assert_allclose(
            ensemble["view_factors/layers_ray_error"][0], np.linalg.norm(rays, axis=0) / BEDS, rtol=1e-12
        )
        stated = column(whole, "prediction/measured/heat_transfer_coefficient_error")
        np.testing.assert_allclose(
            ensemble["prediction/measured/heat_transfer_coefficient_unit_error"][0],
            np.sqrt(np.mean(stated**2, axis=0)), rtol=1e-12,
        )  # fmt: skip
        # every number has its unit
        datasets = []
        file.visititems(lambda _, item: datasets.append(item) if isinstance(item, h5py.Dataset) else None)
        assert all({"units", "long_name"} <= set(item.attrs) for item in datasets)
        assert ensemble["statistics/contacts_per_area"].attrs["units"] == "1/m2"


def test_the_file_tells_of_job_and_inputs(whole):
    with h5py.File(whole) as file:
        assert json.loads(file.attrs["job"])["name"] == "four beds"
        contents = [value.decode() for value in file["units/content"][()]]
    digest = sha256_of(whole.parent / "beds" / "bed_3.h5")
    assert contents[3] == digest


def test_neither_order_nor_crew_changes_anything(whole, job_file):
    run(job_file, crew=Backwards())
    assert unlike(whole, job_file.parent / "r.h5") == []


def test_a_bed_keeps_its_numbers_in_another_company_and_under_another_name(whole, tmp_path):
    shutil.move(tmp_path / "beds" / "bed_3.h5", tmp_path / "beds" / "a_first.h5")
    other = tmp_path / "other.toml"
    other.write_text(JOB.replace('"beds/bed_*.h5"', '["beds/a_first.h5", "beds/bed_1.h5"]'))
    run(other, "other.h5")
    for name in ("key", "seed", "view_factors/layers", "prediction/measured/nusselt"):
        np.testing.assert_array_equal(column(tmp_path / "other.h5", name), column(whole, name)[[3, 1]])


def test_workers_find_the_beds_from_any_folder(job_file, monkeypatch, tmp_path):
    class Elsewhere(StopsAfter):
        def run(self, function, common, tasks):
            monkeypatch.chdir(tmp_path)
            return super().run(function, common, tasks)

    monkeypatch.chdir(job_file.parent)
    outcome = run(Path("job.toml"), job_file.parent / "r.h5", Elsewhere(99, Killed()))
    assert (outcome.done, outcome.failed) == (BEDS, ())
    assert column(job_file.parent / "r.h5", "path")[0].decode() == str(job_file.parent / "beds" / "bed_0.h5")


# Once, and no more


def test_the_same_job_again_measures_nothing_and_leaves_the_file_as_it_is(whole, monkeypatch):
    # the file tells where its beds lie, which is elsewhere in this copy
    run(whole.parent / "job.toml")
    monkeypatch.setattr(stages, "RUNNERS", {})
    before = whole.read_bytes()
    outcome = run(whole.parent / "job.toml")
    assert (outcome.kept, outcome.done, outcome.failed) == (BEDS, 0, ())
    assert whole.read_bytes() == before
    assert tidy(whole.parent)


@pytest.mark.parametrize("how", [KeyboardInterrupt(), Killed()])
@pytest.mark.parametrize("count", [2, BEDS])
def test_a_run_cut_off_at_any_unit_goes_on_from_there(whole, job_file, how, count, monkeypatch):
    path = job_file.parent / "r.h5"
    with pytest.raises(type(how)):
        run(job_file, crew=StopsAfter(count, how))
    # an interrupt leaves a results file, a kill the journal alone
    assert path.exists() == isinstance(how, KeyboardInterrupt)
    calls = []
    count_runs(monkeypatch, calls)
    outcome = run(job_file)
    assert (outcome.kept, outcome.done) == (count, BEDS - count)
    assert calls == list(STAGES) * (BEDS - count)
    assert unlike(whole, path) == []
    assert tidy(job_file.parent)


def test_an_entry_cut_off_by_a_kill_is_measured_again(job_file):
    folder = job_file.parent
    with pytest.raises(Killed):
        run(job_file, crew=StopsAfter(3, Killed()))
    journal = folder / "r.h5.journal"
    journal.write_bytes(journal.read_bytes()[:-7])
    (folder / ".r.h5.0123abcd.part").write_text("half a results file")
    (folder / ".other.h5.0123abcd.part").write_text("of another run")
    outcome = run(job_file)
    assert (outcome.kept, outcome.done) == (2, BEDS - 2)
    (folder / ".other.h5.0123abcd.part").unlink()
    assert tidy(folder)


def test_a_change_measures_again_what_depends_on_it(whole, monkeypatch):
    job_file, calls = whole.parent / "job.toml", []
    count_runs(monkeypatch, calls)
    layers = column(whole, "view_factors/layers")
    job_file.write_text(JOB.replace("0.016 m/s", "0.02 m/s"))
    run(job_file)
    assert calls == ["prediction"] * BEDS
    np.testing.assert_array_equal(column(whole, "view_factors/layers"), layers)
    calls.clear()
    bedrad.write(ring_bed(seed=50), whole.parent / "beds" / "bed_1.h5")
    run(job_file)
    assert calls == list(STAGES)
    calls.clear()
    job_file.write_text(JOB.replace("rays = 4096", "rays = 8192"))
    run(job_file)
    assert calls == ["view_factors", "prediction"] * BEDS


def test_the_same_bed_twice_counts_once(whole):
    shutil.copy(whole.parent / "beds" / "bed_2.h5", whole.parent / "beds" / "bed_9.h5")
    outcome = run(whole.parent / "job.toml")
    assert (outcome.kept, outcome.done) == (BEDS, 0)
    assert [failure.error.rpartition("/")[2] for failure in outcome.repeated] == ["bed_2.h5"]
    assert len(column(whole, "key")) == BEDS


# What goes wrong


def test_a_bed_that_fails_is_told_and_tried_again(job_file):
    folder = job_file.parent
    bad = folder / "beds" / "bed_2.h5"
    good = bad.read_bytes()
    bad.write_bytes(good[:1000])
    outcome = run(job_file)
    assert (outcome.done, len(outcome.failed)) == (BEDS - 1, 1)
    assert outcome.failed[0].label == str(bad)
    assert "bed_2.h5" in outcome.failed[0].error
    assert "\n" not in outcome.failed[0].error
    with h5py.File(folder / "r.h5") as file:
        assert file["failures/label"][0].decode() == str(bad)
        assert file["ensemble"].attrs["failed"] == 1
    bad.write_bytes(good)
    outcome = run(job_file)
    assert (outcome.kept, outcome.done, outcome.failed) == (BEDS - 1, 1, ())
    assert column(folder / "r.h5", "statistics/packing_fraction").shape == (BEDS,)


@pytest.mark.parametrize("failure", [EngineFailedError("LAMMPS"), ValueError("two\nlines"), ZeroDivisionError("bug")])
def test_whatever_a_stage_raises_the_others_go_on(job_file, monkeypatch, failure):
    working = stages.RUNNERS["view_factors"]

    def fail_once(job, unit, progress):
        if len(unit.bed()) == len(ring_bed(rings=8)):
            raise failure
        return working(job, unit, progress)

    monkeypatch.setitem(stages.RUNNERS, "view_factors", fail_once)
    outcome = run(job_file)
    assert (outcome.done, len(outcome.failed)) == (BEDS - 1, 1)
    expected = {"LAMMPS": "LAMMPS", "bug": "ZeroDivisionError: bug"}.get(str(failure), "two lines")
    assert outcome.failed[0].error == expected


def test_all_beds_bad_is_told_and_leaves_a_readable_file(tmp_path):
    (tmp_path / "beds").mkdir()
    (tmp_path / "beds" / "bed_0.h5").write_text("none")
    (tmp_path / "job.toml").write_text(JOB)
    outcome = run(tmp_path / "job.toml")
    assert (outcome.done, len(outcome.failed)) == (0, 1)
    assert run(tmp_path / "job.toml").kept == 0


def test_no_beds_is_refused(tmp_path):
    (tmp_path / "job.toml").write_text(JOB)
    with pytest.raises(BadFileError, match="cannot be read: No such file"):
        run(tmp_path / "job.toml")
    assert {file.name for file in tmp_path.iterdir()} == {"job.toml"}


def test_a_second_run_on_the_same_results_is_refused(whole):
    before = whole.read_bytes()
    told = f"another bedrad run .*process {os.getpid()} on "
    with results_lock(whole), pytest.raises(OSError, match=told) as caught:
        run(whole.parent / "job.toml")
    assert caught.value.errno == errno.EBUSY
    assert whole.read_bytes() == before
    assert run(whole.parent / "job.toml").kept == BEDS


def test_a_full_disk_leaves_what_was_there_and_what_is_finished(whole, monkeypatch):
    job_file = whole.parent / "job.toml"
    before = whole.read_bytes()
    bedrad.write(ring_bed(seed=50), whole.parent / "beds" / "bed_1.h5")
    bedrad.write(ring_bed(seed=51), whole.parent / "beds" / "bed_2.h5")
    written, real = [], Journal._write

    def run_full(self, stream, entry):
        if written:
            # what fits is written, as by the system
            os.pwrite(stream, entry[:100], self._end)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written.append(entry)
        real(self, stream, entry)

    monkeypatch.setattr(Journal, "_write", run_full)
    with pytest.raises(OSError, match=r"cannot write: No space left on device: '.*r\.h5\.journal'"):
        run(job_file)
    assert whole.read_bytes() == before
    monkeypatch.setattr(Journal, "_write", real)
    outcome = run(job_file)
    assert (outcome.kept, outcome.done) == (BEDS - 1, 1)
    assert tidy(whole.parent)


def test_results_that_cannot_be_written_at_the_end_lose_nothing(job_file, monkeypatch):
    folder = job_file.parent

    def refuse(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "r.h5")

    monkeypatch.setattr("bedrad.jobs.results.atomic_path", refuse)
    with pytest.raises(OSError, match="No space"):
        run(job_file)
    monkeypatch.undo()
    assert run(job_file).kept == BEDS
    assert tidy(folder)


def test_results_of_one_bed_and_of_many_are_not_mixed(whole, tmp_path):
    (tmp_path / "one.toml").write_text(JOB.replace("beds/bed_*.h5", "beds/bed_2.h5"))
    with pytest.raises(BadFileError, match="holds the results of many beds"):
        run_job(load_job(tmp_path / "one.toml"), whole)
    (tmp_path / "two.toml").write_text('[packing.file]\npath = "beds/bed_2.h5"\n[statistics]\n')
    run_job(load_job(tmp_path / "two.toml"), tmp_path / "two.h5")
    with pytest.raises(BadFileError, match="holds the results of one bed"):
        run(tmp_path / "job.toml", "two.h5")


def test_a_results_file_among_the_beds_is_refused(job_file):
    job_file.write_text(JOB.replace("bed_*.h5", "*.h5"))
    before = run(job_file, "beds/r.h5").results.path.read_bytes()
    with pytest.raises(BadFileError, match=r"r\.h5: is one of the beds of this job"):
        run(job_file, "beds/r.h5")
    assert (job_file.parent / "beds" / "r.h5").read_bytes() == before


def test_a_file_that_changes_while_the_job_runs_is_told(job_file):
    folder = job_file.parent

    class Changes(StopsAfter):
        def run(self, function, common, tasks):
            if function.__name__ == "measure":
                bedrad.write(ring_bed(seed=77), folder / "beds" / "bed_3.h5")
            yield from super().run(function, common, tasks)

    outcome = run(job_file, crew=Changes(99, Killed()))
    assert [failure.error.rpartition(": ")[2] for failure in outcome.failed] == [
        "changed while the job ran; run it again"
    ]


def test_a_plan_says_what_is_left_and_writes_nothing(whole):
    bedrad.write(ring_bed(seed=50), whole.parent / "beds" / "bed_1.h5")
    before = {file: file.stat().st_mtime_ns for file in whole.parent.iterdir()}
    plan = plan_ensemble(load_job(whole.parent / "job.toml"), whole)
    assert (len(plan.members), len(plan.done), plan.unread, plan.repeated) == (BEDS, BEDS - 1, (), ())
    assert {file: file.stat().st_mtime_ns for file in whole.parent.iterdir()} == before


def test_the_keys_of_a_store_are_those_of_its_units(whole):
    store = EnsembleStore(whole)
    keys = [key.decode() for key in column(whole, "key")]
    assert store.keys() == set(keys)
    assert store.finished("unknown") is None
    record = store.record(keys[0])
    assert set(record.stages) == set(STAGES)
    assert record.stages["statistics"].values["profile"].shape == (50,)
