"""What the commands share: the notice that kernels are compiled, and what is left out of a bed."""

import os
import re
import subprocess
import sys

import numba
import numpy as np
import pytest

import bedrad
from bedrad.command_options import BedOptions, compiling_told

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
