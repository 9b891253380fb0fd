"""Jobs on flows: what they refuse, and that flows are made once and measured as trajectories."""

from __future__ import annotations

import math
import os
import warnings
from pathlib import Path

import h5py
import numpy as np
import pytest

import bedrad
from bedrad.errors import BadFileError
from bedrad.jobs.ensemble import plan_ensemble, run_ensemble
from bedrad.jobs.job import load_job, parse_job
from bedrad.packings import flow_run
from bedrad.packings.flow_plan import Channel

FLOW = """
name = "small flow"
seed = 4

[wall]
diameter = "3 mm"

[packing.flow]
diameter = "0.6 mm"
velocity = "0.1 m/s"
frames = 6
flush = 4.0

[packing.flow.channel]
tube_length = 14
window = [4, 9]
"""

MEASURED = """
[layers]
count = 2

[statistics]

[view_factors]
rays = 60000

[prediction]
wall_temperatures = ["100 degC", "850 degC"]
"""


def parsed(text):
    return parse_job(text, Path("a.toml"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (FLOW.replace('velocity = "0.1 m/s"', ""), "packing.flow: velocity and orifice: neither was given"),
        (FLOW.replace("[wall]", "[walls]"), "walls: unknown key"),
        (FLOW.replace('[wall]\ndiameter = "3 mm"\n', ""), "[packing.flow] needs a [wall]"),
        (FLOW.replace('diameter = "3 mm"', 'shape = "rod"\ndiameter = "3 mm"'), "for a tube; the wall is a rod"),
        (FLOW.replace("frames = 6", "frames = 1"), "packing.flow.frames"),
        (FLOW.replace("frames = 6", "frame = 6"), "packing.flow.frame: unknown key; did you mean 'frames'?"),
        (FLOW.replace("window = [4, 9]", "window = [4, 19]"), "packing.flow: window is 4 to 19 diameters above"),
        (FLOW.replace("tube_length = 14", "tube_length = 1e9"), "packing.flow.channel.tube_length"),
        (FLOW.replace('"0.1 m/s"', '"500 m/s"'), "packing.flow: at 500 m/s a sphere goes"),
        (FLOW.replace('"3 mm"', '"70 mm"'), "spheres; expected at most 1,000,000"),
        (FLOW + "[packing.settle]\n", "packing.settle.height: required"),
        (FLOW + '[packing.settle]\nheight = "2 mm"\ndiameter = "1 mm"\n', "packing: give one source of the bed"),
        (FLOW + MEASURED + 'velocity = "0.1 m/s"\n', "prediction.velocity: a [packing.flow] has its own"),
        (FLOW + MEASURED.replace("count = 2", "count = 4"), "the last layer would end"),
        (FLOW + '[sweep]\nvelocity = ["0.1 m/s", "900 m/s"]\n', "packing.flow: at 900 m/s a sphere goes"),
        (FLOW + '[sweep]\nvelocity = ["1 mm"]\n', "sweep.velocity.0: '1 mm' has the wrong kind of unit"),
        (FLOW + '[sweep]\nvelocity = ["0 m/s"]\n', "sweep.velocity.0"),
    ],
)
def test_what_cannot_flow_is_refused_before_it_runs(text, message):
    with pytest.raises(BadFileError) as caught:
        parsed(text)
    assert message in str(caught.value)


def test_a_settled_bed_has_no_velocity_to_sweep():
    text = '[wall]\ndiameter = "7 mm"\n[packing.settle]\ndiameter = "0.6 mm"\nheight = "18 mm"\n'
    with pytest.raises(BadFileError, match="a settled bed does not move"):
        parsed(text + '[sweep]\nvelocity = ["0.1 m/s"]\n')


def test_a_job_takes_what_the_call_takes():
    job = parsed(
        FLOW + '[sweep]\nvelocity = ["0.05 m/s", "0.1 m/s"]\ntube_diameter = ["3 mm", "4 mm"]\nseed = [1, 2]\n'
    )
    one = job.swept({"velocity": 0.05, "tube_diameter": 4e-3, "seed": 2})
    assert (one.packing.flow.velocity, one.wall.diameter, one.seed) == (0.05, 4e-3, 2)
    plan = one.packing.flow.plan(one.wall.build())
    assert plan == bedrad.packings.flow.plan_flow(
        bedrad.Tube(2e-3), 6e-4, 0.05, 6, flush=4.0, channel=Channel(tube_length=14.0, window=(4.0, 9.0))
    )
    assert len(list(job.sweep.combinations())) == 8
    assert job.is_ensemble


def test_flows_have_keys_of_their_own(tmp_path):
    def keys(text):
        path = tmp_path / "job.toml"
        path.write_text(text)
        return {member.key for member in plan_ensemble(load_job(path), tmp_path / "r.h5").members}

    first = keys(FLOW + MEASURED)
    assert len(first) == 1
    # how it is measured is no part of how it is made
    assert keys(FLOW + MEASURED.replace("60000", "70000")) == first
    for change in (("frames = 6", "frames = 7"), ("seed = 4", "seed = 5"), ('"0.1 m/s"', '"0.11 m/s"'), ("14", "15")):
        assert keys(FLOW.replace(*change) + MEASURED).isdisjoint(first)
    both = keys(FLOW + MEASURED + '[sweep]\nvelocity = ["0.1 m/s", "0.2 m/s"]\n')
    assert len(both) == 2
    assert first < both


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A folder with the results of a flow, and of its sweep, that were run once."""
    folder = tmp_path_factory.mktemp("flows")
    (folder / "job.toml").write_text(FLOW + MEASURED)
    run(folder / "job.toml")
    return folder


def run(job):
    with warnings.catch_warnings():
        # A of 5 is no tube of the correlations
        warnings.simplefilter("ignore", UserWarning)
        return run_ensemble(load_job(job), job.parent / "r.h5")


def unit(path, name):
    with h5py.File(path) as file:
        return file[f"units/{name}"][0]


@pytest.mark.dem
def test_a_flow_is_measured_as_its_trajectory(finished):
    path = finished / "r.h5"
    (folder,) = (finished / "r_beds").iterdir()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        # all frames are there: nothing runs
        flow = bedrad.flow(
            bedrad.Tube(1.5e-3), 6e-4, 0.1, 6, 4, flush=4.0, channel=Channel(tube_length=14.0, window=(4.0, 9.0)),
            work_dir=folder, executable="/no/such/program",
        )  # fmt: skip
    # the frames stay as packings, without the hopper and what falls
    assert [file.name for file in sorted(folder.glob("*.h5"))] == [f"frame_{k:04d}.h5" for k in range(6)]
    kept = list(bedrad.read_frames(folder / "frame_*.h5"))
    assert all(np.array_equal(one.centers, other.centers) for one, other in zip(kept, flow, strict=True))
    edges = bedrad.layer_edges(flow[0], 2)
    for name in ("velocity", "velocity_error", "wall_pressure", "solid_fraction"):
        assert unit(path, f"flow/{name}") == getattr(flow.measures, name)
    assert unit(path, "flow/froude") == pytest.approx(flow.measures.velocity / math.sqrt(9.81 * 6e-4), rel=1e-12)
    assert unit(path, "flow/resumed") == 0
    stats = bedrad.statistics(flow, edges, window=flow.window)
    for name in ("packing_fraction", "packing_fraction_error", "contact_ratio", "nc_distance_closing_error"):
        assert unit(path, f"statistics/{name}") == getattr(stats, name)
    traced = bedrad.view_factors(flow, edges, rays=60000, seed=int(unit(path, "seed")), window=flow.window)
    assert np.array_equal(unit(path, "view_factors/layers"), traced.layers)
    assert np.array_equal(unit(path, "view_factors/bed_covariance"), traced.bed_covariance)
    # the velocity of the prediction is the one that was measured, with its error
    assert unit(path, "prediction/measured/velocity") == flow.measures.velocity
    with h5py.File(path) as file:
        assert file["ensemble/units"][()].tolist() == [1]
        mean = file["ensemble/flow/velocity"][0]
        error = file["ensemble/flow/velocity_unit_error"][0]
    assert (mean, error) == (flow.measures.velocity, flow.measures.velocity_error)


@pytest.mark.dem
def test_a_flow_runs_once_whatever_is_measured_of_it(finished, monkeypatch):
    def fails(*_, **__):
        raise AssertionError("LAMMPS was started")

    monkeypatch.setattr(flow_run, "run_lammps", fails)
    assert (run(finished / "job.toml").kept, run(finished / "job.toml").done) == (1, 0)
    before = unit(finished / "r.h5", "statistics/contact_ratio")
    (finished / "job.toml").write_text(FLOW + MEASURED.replace("[statistics]", "[statistics]\ncontact_gap = 0.05"))
    outcome = run(finished / "job.toml")
    assert (outcome.kept, outcome.done, outcome.failed) == (0, 1, ())
    assert unit(finished / "r.h5", "statistics/contact_ratio") > before
    # another flow is another run, which fails here and leaves this one
    (finished / "job.toml").write_text(FLOW + MEASURED + "[sweep]\nseed = [4, 5]\n")
    outcome = run(finished / "job.toml")
    assert [failure.label for failure in outcome.failed] == ["seed 5"]
    assert (outcome.kept, outcome.done) == (0, 1)
    (finished / "job.toml").write_text(FLOW + MEASURED)


@pytest.mark.dem
def test_frames_are_kept_anew_where_lammps_ran_again(finished):
    (old,) = (finished / "r_beds").glob("flow_*/frame_0000.h5")
    before = bedrad.read(old).centers
    old.write_bytes(b"of a run before")
    os.utime(old, (0, 0))
    untouched = old.with_name("frame_0001.h5").stat().st_mtime_ns
    (finished / "job.toml").write_text(FLOW + MEASURED.replace("60000", "50000"))
    run(finished / "job.toml")
    assert np.array_equal(bedrad.read(old).centers, before)
    assert old.with_name("frame_0001.h5").stat().st_mtime_ns == untouched
    # as the tests after this one expect it
    (finished / "job.toml").write_text(FLOW + MEASURED)
    run(finished / "job.toml")


@pytest.mark.dem
def test_the_same_flow_in_another_place_is_the_same(finished, tmp_path):
    (tmp_path / "job.toml").write_text(FLOW + MEASURED)
    run(tmp_path / "job.toml")
    for name in ("flow/velocity", "statistics/packing_fraction", "prediction/measured/heat_transfer_coefficient"):
        assert np.array_equal(unit(tmp_path / "r.h5", name), unit(finished / "r.h5", name))
