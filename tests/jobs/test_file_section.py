from __future__ import annotations

import inspect
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import bedrad
from bedrad.jobs.file_section import ColumnsSection, FileSection, Unit
from bedrad.jobs.job import load_job, parse_job
from bedrad.jobs.pipeline import make_plan, run_job
from bedrad.jobs.results import Results, sha256_of
from bedrad.packings.files.format import COLUMN_NAMES
from bedrad.packings.files.units import LENGTH_UNITS
from jobs.small_job import DIAMETER, ring_bed

FILE = '[packing.file]\npath = "bed.h5"\n'


def section(text, before=""):
    return parse_job(before + FILE + text, Path("jobs/a.toml")).packing.file


def test_a_file_takes_the_options_of_reading():
    bed = section(
        'diameter = "1 mm"\nperiod = "0 m"\nframe = 3\nmax_overlap = 0.2\nunit = "mm"\n'
        'axis = [0, 0.6, -0.8]\norigin = ["1 mm", "-2 mm", "0 m"]\ncolumns = { x = "Position X", y = 2 }\n',
        before='[wall]\nshape = "plate"\n',
    )
    assert bed.options() == {
        "diameter": 1e-3,
        "period": 0.0,
        "frame": 3,
        "max_overlap": 0.2,
        "unit": "mm",
        "axis": (0.0, 0.6, -0.8),
        "origin": (1e-3, -2e-3, 0.0),
        "wall_unit": None,
        "columns": {"x": "Position X", "y": "2"},
    }
    assert bed.wall is None
    assert bed.inputs == (Path("jobs/bed.h5"),)
    assert section('wall = "rod"\naxis = "y"\n').axis == "y"


def test_a_file_takes_every_option_that_reading_takes():
    # one that is added to `bedrad.read` has to be added to the job
    options = section("").options()
    assert set(options) | {"path", "wall"} == set(inspect.signature(bedrad.read).parameters)
    about_many = {"frames", "independent"}
    assert set(FileSection.model_fields) - about_many == set(inspect.signature(bedrad.read).parameters)
    assert set(get_args(Unit)) == set(LENGTH_UNITS)
    assert set(ColumnsSection.model_fields) == set(COLUMN_NAMES)


def test_what_a_job_leaves_open_is_what_reading_takes_by_itself():
    defaults = {name: p.default for name, p in inspect.signature(bedrad.read).parameters.items() if name != "path"}
    assert section("").options() | {"wall": None} == defaults


def test_a_wall_from_a_file_lies_in_the_folder_of_the_job_too():
    bed = section('wall = "walls/tube.STL"\nwall_unit = "mm"\n')
    assert bed.wall_file == Path("jobs/walls/tube.STL")
    assert bed.inputs == (Path("jobs/bed.h5"), Path("jobs/walls/tube.STL"))
    assert section('wall = "/data/tube.stl"\n').wall == "/data/tube.stl"


def write_turned(folder, bed):
    """The bed as a table of a program that measures in millimetres and has the axis along x, away from 0."""
    x, y, z = 1e3 * bed.centers.T
    rows = np.c_[np.arange(len(bed)), z, x + 5.0, y - 2.0, np.full(len(bed), 1e3 * DIAMETER)]
    np.savetxt(folder / "bed.csv", rows, fmt="%.17g", delimiter=",", header="id,along,p,q,size", comments="")


TURNED = """
[packing.file]
path = "bed.csv"
unit = "mm"
columns = { x = "along", y = "p", z = 4, diameter = "size" }
"""


def test_a_job_reads_a_bed_that_its_file_says_little_about(tmp_path):
    bed = ring_bed()
    write_turned(tmp_path, bed)
    (tmp_path / "job.toml").write_text(
        f'[wall]\ndiameter = "{2e3 * bed.wall.radius!r} mm"\n{TURNED}axis = "x"\n'
        f'origin = ["0 mm", "5 mm", "-2 mm"]\nperiod = "{1e3 * bed.period!r} mm"\nmax_overlap = 0.05\n'
    )
    path = run_job(load_job(tmp_path / "job.toml"), tmp_path / "results.h5").path
    read = bedrad.read(path)
    assert read.wall.radius == pytest.approx(bed.wall.radius, rel=1e-14)
    assert read.period == pytest.approx(bed.period, rel=1e-14)
    assert read.max_overlap == 0.05
    np.testing.assert_allclose(read.radii, bed.radii, rtol=1e-14)
    np.testing.assert_allclose(read.centers, bed.centers, atol=1e-15)


def test_a_job_fits_the_wall_that_it_names(tmp_path):
    bed = ring_bed()
    write_turned(tmp_path, bed)
    (tmp_path / "job.toml").write_text(f'{TURNED}wall = "tube"\naxis = "x"\n')
    read = bedrad.read(run_job(load_job(tmp_path / "job.toml"), tmp_path / "results.h5").path)
    # the rings touch the wall all round
    assert read.wall.radius == pytest.approx(bed.wall.radius, rel=1e-6)
    assert read.provenance["wall_fit_residual_radii"] < 1e-6


def test_a_job_takes_the_wall_from_an_stl_file(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    bed = ring_bed()
    write_turned(tmp_path, bed)
    mesh = trimesh.creation.cylinder(radius=1e3 * bed.wall.radius, height=30.0, sections=256, cap=False)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0)))
    mesh.apply_translation((0.0, 5.0, -2.0))
    mesh.export(tmp_path / "wall.stl")
    (tmp_path / "job.toml").write_text(f'{TURNED}wall = "wall.stl"\n')
    job = load_job(tmp_path / "job.toml")
    results = run_job(job, tmp_path / "results.h5")
    read = bedrad.read(results.path)
    # STL has single precision
    assert read.wall.radius == pytest.approx(bed.wall.radius, rel=1e-5)
    assert np.ptp(read.depths - bed.depths) < 1e-4 * DIAMETER
    # the wall is an input like the bed: another one makes another packing
    assert dict(make_plan(job, Results(results.path)).inputs) == {
        str(tmp_path / name): sha256_of(tmp_path / name) for name in ("bed.csv", "wall.stl")
    }
    assert make_plan(job, Results(results.path)).stages[0].done
    mesh.apply_scale(1.0001)
    mesh.export(tmp_path / "wall.stl")
    assert not make_plan(job, Results(results.path)).stages[0].done
