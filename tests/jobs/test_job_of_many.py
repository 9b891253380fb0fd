"""Jobs that name many beds: which do, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from bedrad.errors import BadFileError
from bedrad.jobs.job import parse_job

MANY = '[packing.file]\npath = "beds/*.h5"\n[statistics]\n'
SETTLED = '[wall]\ndiameter = "7 mm"\n[packing.settle]\ndiameter = "0.6 mm"\nheight = "18 mm"\n[statistics]\n'


def test_which_jobs_name_many_beds(tmp_path):
    (tmp_path / "beds").mkdir()
    (tmp_path / "odd[1].h5").touch()

    def many(text):
        return parse_job(text, tmp_path / "a.toml").is_ensemble

    assert many(MANY)
    assert many(MANY.replace('"beds/*.h5"', '["a.h5", "b.h5"]'))
    assert many(MANY.replace("beds/*.h5", "beds"))
    assert many(MANY.replace("beds/*.h5", "a.h5").replace("[stat", 'frames = "all"\n[stat'))
    assert many(SETTLED + "[sweep]\nseed = [1, 2]\n")
    assert not many(MANY.replace("beds/*.h5", "a.h5"))
    assert not many(MANY.replace("beds/*.h5", "odd[1].h5"))
    assert not many(SETTLED)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (MANY.replace("[stat", "frames = 3\n[stat"), "packing.file.frames: expected 'all', a list of frame numbers"),
        (MANY.replace("[stat", 'frames = "1:2:0"\n[stat'), "packing.file.frames: expected 'all'"),
        (MANY.replace("[stat", "frames = []\n[stat"), "packing.file.frames: expected 'all'"),
        (MANY.replace("[stat", "frames = [true]\n[stat"), "packing.file.frames: expected 'all'"),
        (
            MANY.replace("[stat", 'frames = "all"\nframe = 2\n[stat'),
            "packing.file: frame is for one bed, frames for many",
        ),
        (MANY.replace('"beds/*.h5"', "[]"), "packing.file.path"),
        (MANY + "[sweep]\nseed = [1]\n", "[sweep] needs a [packing.settle]"),
        (SETTLED + "[sweep]\n", "sweep: give a list of tube_diameter, particle_diameter, velocity or seed"),
        (SETTLED + "[sweep]\nseed = [1, 1]\n", "sweep: seed names a value twice"),
        (SETTLED + "[sweep]\nseed = [-1]\n", "sweep.seed.0"),
        (SETTLED + '[sweep]\ntube_diameter = ["2 mm"]\n', "the last layer would end"),
        (SETTLED + "[sweep]\nseed = { count = 1000001 }\n", "sweep.seed.count"),
        (SETTLED + "[sweep]\nheight = [1]\n", "sweep.height: unknown key"),
        (
            SETTLED.replace('diameter = "0.6 mm"', 'sizes = [{ diameter = "0.6 mm", share = 1.0 }]')
            + '[sweep]\nparticle_diameter = ["0.5 mm"]\n',
            "sweep.particle_diameter is for beds of one size",
        ),
    ],
)
def test_what_names_no_beds_is_refused(text, message):
    with pytest.raises(BadFileError) as caught:
        parse_job(text, Path("a.toml"))
    assert message in str(caught.value)


def test_a_sweep_is_every_combination():
    job = parse_job(SETTLED + '[sweep]\ntube_diameter = ["7 mm", "8 mm"]\nseed = { first = 5, count = 2 }\n', Path("a"))
    combinations = list(job.sweep.combinations())
    assert combinations == [
        {"tube_diameter": 7e-3, "seed": 5},
        {"tube_diameter": 7e-3, "seed": 6},
        {"tube_diameter": 8e-3, "seed": 5},
        {"tube_diameter": 8e-3, "seed": 6},
    ]
    one = job.swept(combinations[3])
    assert (one.wall.diameter, one.seed, one.sweep) == (8e-3, 6, None)
    assert one.packing.settle.diameter == 0.6e-3
