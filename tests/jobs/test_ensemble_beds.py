"""Many beds of one file, and of a sweep."""

from __future__ import annotations

import h5py
import numpy as np
import pytest

import bedrad
from bedrad.jobs import stages
from bedrad.packings.time_averages import block_averaged_variance
from jobs.ensemble_job import SWEEP, column, run
from jobs.small_job import ring_bed

# Trajectories


def dump(beds):
    texts = []
    for number, bed in enumerate(beds):
        rows = "\n".join(f"{k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(bed.centers.tolist()))
        texts.append(
            f"ITEM: TIMESTEP\n{number}\nITEM: NUMBER OF ATOMS\n{len(bed)}\nITEM: BOX BOUNDS ff ff pp\n-1 1\n-1 1\n"
            f"0 {bed.period!r}\nITEM: ATOMS id x y z\n{rows}\n"
        )
    return "".join(texts)


TRAJECTORY = """
[wall]
diameter = "7.74 mm"
[packing.file]
path = "flow.dump"
diameter = "0.6 mm"
frames = "all"
[statistics]
"""


@pytest.mark.parametrize(
    ("frames", "expected"), [('"all"', [0, 1, 2, 3]), ('"1:"', [1, 2, 3]), ('"::2"', [0, 2]), ("[-1, 1]", [3, 1])]
)
def test_frames_of_a_trajectory_are_beds(tmp_path, frames, expected):
    beds = [ring_bed(seed=k) for k in range(4)]
    (tmp_path / "flow.dump").write_text(dump(beds))
    (tmp_path / "job.toml").write_text(TRAJECTORY.replace('"all"', frames))
    assert run(tmp_path / "job.toml").done == len(expected)
    assert column(tmp_path / "r.h5", "frame").tolist() == expected
    found = column(tmp_path / "r.h5", "statistics/packing_fraction")
    assert found == pytest.approx([bedrad.statistics(beds[k]).packing_fraction for k in expected], rel=1e-9)
    # frames resemble each other: blocks in time, not their scatter as such
    with h5py.File(tmp_path / "r.h5") as file:
        error = file["ensemble/statistics/packing_fraction_packing_error"][0]
    assert error == pytest.approx(block_averaged_variance(found[:, None])[0] ** 0.5, rel=1e-9)


def test_a_frame_that_is_not_there_fails_its_file(tmp_path):
    (tmp_path / "flow.dump").write_text(dump([ring_bed()]))
    (tmp_path / "job.toml").write_text(TRAJECTORY.replace('"all"', "[0, 5]"))
    (failure,) = run(tmp_path / "job.toml").failed
    assert failure.error.endswith("flow.dump: frame 5 was asked for; the file has 1, counted from 0")


# Sweeps


@pytest.fixture
def settled(monkeypatch):
    """Beds without LAMMPS, and the seeds that were asked for."""
    asked = []

    def settle(wall, diameter, height, seed, **_):
        asked.append((diameter, seed))
        bed = ring_bed(seed=seed, rings=9)
        scale = diameter / 600e-6
        return bedrad.Packing(
            bed.centers * scale, bed.radii * scale, bedrad.Tube(wall.radius * scale), bed.period * scale
        )

    monkeypatch.setattr(stages, "settle", settle)
    return asked


def test_a_sweep_settles_every_combination_once_and_keeps_the_beds(tmp_path, settled):
    job_file = tmp_path / "job.toml"
    job_file.write_text(SWEEP)
    outcome = run(job_file)
    assert settled == [(d, s) for d in (0.5e-3, 0.6e-3) for s in (1, 2, 3)]
    assert outcome.done == 6
    beds = sorted((tmp_path / "r_beds").iterdir())
    assert len(beds) == 6
    keys = [key.decode() for key in column(tmp_path / "r.h5", "key")]
    assert {file.name for file in beds} == {f"bed_{key[:16]}.h5" for key in keys}
    assert column(tmp_path / "r.h5", "bed_seed").tolist() == [1, 2, 3, 1, 2, 3]
    with h5py.File(tmp_path / "r.h5") as file:
        np.testing.assert_allclose(file["ensemble/particle_diameter"][()], [0.5e-3, 0.6e-3])
        assert file["ensemble/units"][()].tolist() == [3, 3]
        x = file["units/statistics/packing_fraction"][()]
        np.testing.assert_allclose(file["ensemble/statistics/packing_fraction"][()], x.reshape(2, 3).mean(axis=1))
    # what is measured anew needs no settling
    settled.clear()
    job_file.write_text(SWEEP.replace("[statistics]", "[statistics]\ncontact_gap = 0.02"))
    assert run(job_file).done == 6
    assert settled == []
    # a bed that was lost is settled again, and measured from what is known
    beds[0].unlink()
    assert run(job_file).done == 1
    assert len(settled) == 1


def test_a_bed_outlives_a_failure_to_measure_it(tmp_path, settled, monkeypatch):
    job_file = tmp_path / "job.toml"
    job_file.write_text(SWEEP)

    def fail(*_):
        raise ValueError("no")

    with monkeypatch.context() as patch:
        patch.setitem(stages.RUNNERS, "statistics", fail)
        assert len(run(job_file).failed) == 6
    assert len(list((tmp_path / "r_beds").iterdir())) == 6
    settled.clear()
    assert run(job_file).done == 6
    assert settled == []
