from __future__ import annotations

import hashlib
import json
import shutil

import h5py
import numpy as np
import pytest

from bedrad.errors import BadFileError, EngineFailedError
from bedrad.jobs import prediction_stage, stages
from bedrad.jobs.job import load_job
from bedrad.jobs.pipeline import make_plan, run_job
from bedrad.jobs.results import Results
from jobs.small_job import JOB, STAGES, write_job

PUBLISHED = "[prediction]\npublished_systems = false"
"""The published systems warn about their range; the tests of the order of things do without them."""


@pytest.fixture
def calls(monkeypatch):
    """Names of the stages that are computed, in their order; each leaves only a trace of its inputs."""
    called = []

    def stub(name):
        def run(job, results, progress):
            called.append(name)
            progress(0.5, "half")
            return lambda group: group.create_dataset("count", data=len(called))

        return run

    monkeypatch.setattr(stages, "RUNNERS", {name: stub(name) for name in STAGES})
    return called


@pytest.fixture
def no_stage(monkeypatch):
    def fail(*_):
        pytest.fail("a stage was computed")

    monkeypatch.setattr(stages, "RUNNERS", dict.fromkeys(STAGES, fail))


@pytest.fixture
def job_file(tmp_path):
    return write_job(tmp_path, JOB)


def run(job_file, name="results.h5"):
    return run_job(load_job(job_file), job_file.parent / name)


def rewrite(job_file, *changes):
    text = job_file.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    job_file.write_text(text)


def contents(path, without=("seconds",)):
    """Digest of every dataset and attribute of a results file, without run times."""
    found = {}

    def add(name, item):
        found[name] = dict(item.attrs)
        if isinstance(item, h5py.Dataset) and not any(word in name for word in without):
            found[name]["value"] = hashlib.sha256(np.asarray(item[()]).tobytes()).hexdigest()

    with h5py.File(path) as file:
        file.visititems(add)
    return json.dumps(found, sort_keys=True, default=str)


# A real run


def test_the_same_job_and_seed_give_the_same_numbers(finished):
    rewrite(finished / "job.toml", ("[prediction]", PUBLISHED))
    once, twice = (run(finished / "job.toml", name) for name in ("once.h5", "twice.h5"))
    assert contents(once.path) == contents(twice.path)
    # another seed gives other rays, so that the comparison can fail
    rewrite(finished / "job.toml", ("seed = 3", "seed = 4"))
    assert contents(run(finished / "job.toml", "other.h5").path) != contents(once.path)


def test_a_finished_job_is_not_computed_again(finished, no_stage):
    path = finished / "results.h5"
    before = contents(path, without=())
    run(finished / "job.toml")
    assert contents(path, without=()) == before
    # the first time the list of inputs was brought up to date, as this copy of the bed lies elsewhere
    whole = path.read_bytes()
    run(finished / "job.toml")
    assert path.read_bytes() == whole


# Which stages


def test_all_stages_run_in_order_and_then_none(job_file, calls):
    results = run(job_file)
    assert calls == list(STAGES)
    before = results.path.read_bytes()
    calls.clear()
    run(job_file)
    assert calls == []
    assert results.path.read_bytes() == before


@pytest.mark.parametrize(
    ("old", "new", "again"),
    [
        ('name = "rings"', 'name = "others"', ()),
        ("figures = false", "figures = true", ()),
        ("seed = 3", "seed = 4", ("view_factors", "convergence", "prediction")),
        ("[statistics]", "[statistics]\ncontact_gap = 0.02", ("statistics", "prediction")),
        ("rays = 4096", "rays = 8192", ("view_factors", "prediction")),
        ("rays = 4096", "tolerance = 0.1", ("view_factors", "prediction")),
        ("seeds = 2", "seeds = 3", ("convergence",)),
        ("0.016 m/s", "0.017 m/s", ("prediction",)),
        ("850 degC", "900 degC", ("prediction",)),
        ("[prediction]", '[prediction]\ncorrelation = "bedrad"', ("prediction",)),
        ("[prediction]", '[prediction]\nheat_flux = "5 kW/m^2"\nproperties = "mean"', ("prediction",)),
        ("[prediction]", "[prediction]\nerrors = { published = true }", ("prediction",)),
        ("[output]", "[layers]\ncount = 2\n[output]", ("statistics", "view_factors", "convergence", "prediction")),
        ("[packing.file]", '[wall]\ndiameter = "7.75 mm"\n[packing.file]', STAGES),
        ('path = "bed.h5"', 'path = "bed.h5"\nperiod = "8 mm"', STAGES),
        # the same in other words
        ("0.016 m/s", "16 mm/s", ()),
        ("850 degC", "1123.15 K", ()),
        ("[statistics]", "[statistics]\ncontact_gap = 0.01", ()),
    ],
)
def test_a_change_reruns_what_depends_on_it_and_nothing_else(job_file, calls, old, new, again):
    run(job_file)
    calls.clear()
    rewrite(job_file, (old, new))
    results = run(job_file)
    assert calls == list(again)
    assert set(results.digests()) == set(STAGES)
    # the file tells of the job as it is now
    assert results.attributes()["job"] == load_job(job_file).resolved()


def test_another_bed_of_the_same_name_reruns_everything(job_file, calls):
    run(job_file)
    calls.clear()
    write_job(job_file.parent, JOB, seed=2)
    run(job_file)
    assert calls == list(STAGES)


def test_the_same_bed_elsewhere_reruns_nothing(job_file, calls):
    run(job_file)
    calls.clear()
    shutil.move(job_file.parent / "bed.h5", job_file.parent / "moved.h5")
    rewrite(job_file, ("bed.h5", "moved.h5"))
    results = run(job_file)
    assert calls == []
    (path,) = json.loads(results.attributes()["inputs"])
    assert path.endswith("moved.h5")


def test_another_version_reruns_everything(job_file, calls, monkeypatch):
    run(job_file)
    calls.clear()
    monkeypatch.setattr("bedrad.jobs.pipeline.__version__", "999")
    run(job_file)
    assert calls == list(STAGES)


def test_a_prediction_without_a_bed_depends_on_its_wall(tmp_path, calls):
    job_file = tmp_path / "job.toml"
    job_file.write_text(
        '[wall]\ndiameter = "7.75 mm"\n[prediction]\nvelocity = "0.016 m/s"\nparticle_diameter = "0.3 mm"\n'
        'wall_temperatures = ["850 degC"]\n'
    )
    for changes, expected in (
        ((), 1),
        ((), 0),
        ((("7.75 mm", "8 mm"),), 1),
        ((("[prediction]", "[layers]\ncount = 2\n[prediction]"),), 1),
    ):
        rewrite(job_file, *changes)
        calls.clear()
        run(job_file)
        assert calls == ["prediction"] * expected


def test_a_section_taken_out_and_put_back_is_not_computed_again(job_file, calls):
    run(job_file)
    rewrite(job_file, ("[convergence]\nrays = 2048\nreference_rays = 32768\nseeds = 2\n", ""), ("0.016", "0.017"))
    results = run(job_file)
    assert "convergence" in results.digests()
    calls.clear()
    rewrite(job_file, ("[output]", "[convergence]\nrays = 2048\nreference_rays = 32768\nseeds = 2\n[output]"))
    run(job_file)
    assert calls == []


def test_a_section_taken_out_goes_when_what_it_was_computed_from_does(job_file, calls):
    run(job_file)
    rewrite(job_file, ("[convergence]\nrays = 2048\nreference_rays = 32768\nseeds = 2\n", ""))
    write_job(job_file.parent, job_file.read_text(), seed=2)
    assert set(run(job_file).digests()) == set(STAGES) - {"convergence"}


def test_what_is_not_asked_for_is_left_out(job_file, calls):
    job_file.write_text("\n".join(["[packing.file]", 'path = "bed.h5"', "[statistics]"]))
    results = run(job_file)
    assert calls == ["packing", "statistics"]
    plan = make_plan(load_job(job_file), results)
    assert [(stage.name, stage.done) for stage in plan.stages] == [("packing", True), ("statistics", True)]
    assert dict(plan.left_out) == {
        name: f"the job has no [{name}]" for name in ("view_factors", "convergence", "prediction")
    }


def test_a_plan_says_what_the_file_keeps_of_a_section_taken_out(job_file, calls):
    run(job_file)
    rewrite(job_file, ("[convergence]\nrays = 2048\nreference_rays = 32768\nseeds = 2\n", ""))
    plan = make_plan(load_job(job_file), Results(job_file.parent / "results.h5"))
    assert plan.left_out == (("convergence", "the job has no [convergence]; the results file keeps its earlier one"),)


def test_a_plan_reads_and_writes_nothing_else(job_file, no_stage):
    before = sorted(job_file.parent.iterdir())
    plan = make_plan(load_job(job_file), Results(job_file.parent / "results.h5"))
    assert [stage.name for stage in plan.stages] == list(STAGES)
    assert not any(stage.done for stage in plan.stages)
    assert all(len(stage.digest) == 64 and stage.summary for stage in plan.stages)
    assert sorted(job_file.parent.iterdir()) == before


def test_progress_names_every_stage_and_ends_each(job_file, calls):
    seen = []
    job = load_job(job_file)
    for _ in range(2):
        run_job(job, job_file.parent / "results.h5", lambda *told: seen.append(told))
    expected = [told for name in STAGES for told in ((name, 0.5, "half"), (name, 1.0, "done"))]
    assert seen == expected + [(name, 1.0, "kept from an earlier run") for name in STAGES]


# Ends before the end


@pytest.mark.parametrize("broken", STAGES)
@pytest.mark.parametrize(
    "failure", [KeyboardInterrupt(), EngineFailedError("LAMMPS"), ValueError("bad"), OSError(28, "x")]
)
def test_a_stage_that_fails_leaves_the_earlier_ones(job_file, calls, monkeypatch, broken, failure):
    working = dict(stages.RUNNERS)

    def fail(*_):
        raise failure

    monkeypatch.setitem(stages.RUNNERS, broken, fail)
    with pytest.raises(type(failure)):
        run(job_file)
    before = STAGES[: STAGES.index(broken)]
    path = job_file.parent / "results.h5"
    assert tuple(Results(path).digests()) == tuple(sorted(before))
    assert path.exists() == bool(before)
    assert {file.name for file in job_file.parent.iterdir()} <= {"bed.h5", "job.toml", "results.h5"}
    calls.clear()
    monkeypatch.setattr(stages, "RUNNERS", working)
    run(job_file)
    assert calls == list(STAGES[STAGES.index(broken) :])


def test_an_old_file_stays_bit_for_bit_when_its_first_stage_fails_anew(job_file, calls, monkeypatch):
    path = run(job_file).path
    before = path.read_bytes()

    def fail(*_):
        raise KeyboardInterrupt

    monkeypatch.setitem(stages.RUNNERS, "packing", fail)
    write_job(job_file.parent, JOB, seed=2)
    with pytest.raises(KeyboardInterrupt):
        run(job_file)
    assert path.read_bytes() == before


def test_a_bed_that_is_not_there_is_named_before_anything_runs(job_file, no_stage):
    (job_file.parent / "bed.h5").unlink()
    with pytest.raises(BadFileError, match=r"bed\.h5: cannot be read: No such file or directory$"):
        run(job_file)


def test_a_place_that_cannot_be_written_shows_before_anything_runs(job_file, no_stage):
    with pytest.raises(NotADirectoryError, match=r"cannot write: .*job\.toml/results\.h5"):
        run(job_file, "job.toml/results.h5")


def test_the_folder_of_the_results_is_made(job_file, calls):
    assert run(job_file, "new/deep/results.h5").path.exists()


def test_results_that_are_something_else_are_left_alone(job_file, no_stage):
    other = job_file.parent / "results.h5"
    other.write_text("precious")
    with pytest.raises(BadFileError, match="not a bedrad results file"):
        run(job_file)
    assert other.read_text() == "precious"


def test_a_distance_that_cannot_be_measured_is_replaced_and_told():
    found = {"no_contacts": 5, "nc_distance_closing": np.nan, "nc_distance": 0.4}
    assert prediction_stage._nc_distance(found, "mean") == "nc_distance"
    with pytest.warns(UserWarning, match="no nc_distance_closing for this bed"):
        assert prediction_stage._nc_distance(found, "closing") == "nc_distance_weighted"
    # without such particles any distance is as good
    assert prediction_stage._nc_distance(found | {"no_contacts": 0}, "closing") is None


def test_an_unknown_error_is_told_not_taken_for_certainty():
    with pytest.warns(UserWarning, match="no standard error of packing_fraction"):
        assert prediction_stage._known(np.nan, "packing_fraction") == 0.0
    assert prediction_stage._known(0.25, "packing_fraction") == 0.25


def test_the_budget_of_uncertainty_stays_with_the_prediction(job_file):
    """Errors of bed, rays and of what the job states; each row an input, and all of them together h's error."""
    rewrite(job_file, ("[prediction]", PUBLISHED + '\nerrors = { published = true, wall_temperature = "5 K" }'))
    results = run(job_file)
    case = results.read("prediction")["measured"]
    budget = case["budget"]
    names = list(budget["inputs"])
    assert budget["contributions"].shape == (len(names), 2)
    total = np.sqrt((budget["contributions"] ** 2).sum(axis=0))
    np.testing.assert_allclose(total, case["heat_transfer_coefficient_error"], rtol=1e-12)
    errors = dict(zip(names, budget["errors"][:, 0], strict=True))
    assert errors["wall_temperature"] == 5.0
    assert errors["bulk_conductivity"] == pytest.approx(0.11 / 1.96)
    # the measured layer has its own errors, and what one layer loses of the rays another wins
    statistics, factors = results.read("statistics"), results.read("view_factors")
    assert errors["packing_fraction"] == statistics["packing_fraction_error"]
    steps = np.arange(1, 4)
    independent = np.linalg.norm(steps * np.hypot(factors["layers_error"], factors["layers_bed_error"]))
    assert 0 < errors["view_factors"] < independent
