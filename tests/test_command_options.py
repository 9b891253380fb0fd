"""What the commands share: the notice that kernels are compiled, and what is left out of a bed."""

import os
import re
import subprocess
import sys

import numba
import numpy as np
import pytest

import bedrad
from bedrad.bed_options import BedOptions, parse_axis, parse_columns
from bedrad.command_options import compiling_told

compiled = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")


@compiled
def test_compiling_is_told_once_and_only_when_something_compiles(capsys):
    inner = numba.njit(lambda x: x + 1)
    outer = numba.njit(lambda x: inner(x) + inner(2 * x))
    with compiling_told():
        pass
    assert capsys.readouterr() == ("", "")
    with compiling_told():
        assert outer(1) == 5
        assert outer(1.0) == 5.0
    out, err = capsys.readouterr()
    assert out == ""
    first, last = err.splitlines()
    assert first == "compiling the kernels: once after installation, some ten seconds"
    assert re.fullmatch(r"compiled the kernels in \d+\.\d s; the next run finds them", last)
    with compiling_told():
        assert outer(2) == 8
    assert capsys.readouterr() == ("", "")


@compiled
def test_how_long_compiling_took_is_told_after_a_failure_too(capsys):
    def fail():
        raise KeyError(numba.njit(lambda x: x - 1)(1))

    with pytest.raises(KeyError), compiling_told():
        fail()
    assert "compiled the kernels in" in capsys.readouterr().err


@compiled
def test_the_first_view_factors_tell_of_compiling_and_the_next_do_not(bed, tmp_path):
    def told():
        code = "import sys; from bedrad.cli import main; sys.exit(main())"
        done = subprocess.run(
            [sys.executable, "-c", code, "view-factors", str(bed), "--rays", "4096"],
            env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "COLUMNS": "120"},
            capture_output=True,
            text=True,
            check=True,
        )
        assert "left out: " in done.stdout
        return [line for line in done.stderr.splitlines() if "compil" in line]

    assert len(told()) == 2
    assert told() == []


def test_what_is_left_out_at_open_ends_is_told_and_nothing_where_the_bed_repeats():
    radii = np.array([0.5e-3, 1.0e-3, 1.5e-3, 1.0e-3])
    centers = np.column_stack([4e-3 - radii, np.zeros(4), [1e-3, 7e-3, 13e-3, 19e-3]])
    wall = bedrad.Tube(4e-3)
    # the lower end of the bed is at 0.5 mm; a mean diameter is 2 mm
    told = BedOptions(margin=1.25).ends_left_out(bedrad.Packing(centers, radii, wall))
    assert told == "3 mm of wall at either end, 1.25 mean diameters, as the bed is loose and open there"
    assert BedOptions().ends_left_out(bedrad.Packing(centers, radii, wall, period=20e-3)) is None


def test_a_table_of_another_program_is_measured_as_the_bed_that_it_is(call, bed, tmp_path):
    packing = bedrad.read(bed)
    turned = packing.centers[:, [2, 0, 1]] + np.array([5e-3, 1e-3, -2e-3])
    rows = zip((turned * 1e3).tolist(), (packing.radii * 2e3).tolist(), strict=True)
    text = "".join(f"{d!r};{x!r};{y!r};{z!r}\n" for (x, y, z), d in rows)
    table = tmp_path / "bed.csv"
    table.write_text("grain;east;north;up\n" + text)
    options = ["--unit", "mm", "--axis", "x", "--origin", "5mm", "1mm", "-2mm"]
    columns = [word for text in ("diameter=grain", "x=east", "y=3", "z=up") for word in ("--column", text)]
    words = ["--tube", f"{2 * packing.wall.radius!r} m", "--period", f"{packing.period or 1.0!r} m", "--dry-run"]
    code, out, err = call("view-factors", table, *words, *options, *columns)
    assert (code, err) == (0, [])
    assert out == call("view-factors", bed, *words)[1]
    assert "layers" in out


def test_options_with_a_minus_are_values(call, bed, tmp_path):
    packing = bedrad.read(bed)
    rows = "".join(f"{-x!r},{y!r},{-z!r},{r!r}\n" for (x, y, z), r in zip(
        packing.centers.tolist(), packing.radii.tolist(), strict=True))  # fmt: skip
    (tmp_path / "a.csv").write_text("x [m],y [m],z [m],radius [m]\n" + rows)
    for axis in (["--axis", "-0,0,-1"], ["--axis=0 0 -2"]):
        code, *_ = call(
            "convert", tmp_path / "a.csv", tmp_path / "b.h5", "--tube", f"{2 * packing.wall.radius!r} m", *axis
        )
        assert code == 0
        np.testing.assert_allclose(bedrad.read(tmp_path / "b.h5").centers[:, 2], packing.centers[:, 2])


def test_texts_of_axes_and_columns():
    assert parse_axis("x") == "x"
    assert parse_axis("0.1, 0 -1e0") == (0.1, 0.0, -1.0)
    assert parse_columns(["x=Position[X] (m)", " radius = 4"]) == {"x": "Position[X] (m)", "radius": "4"}
