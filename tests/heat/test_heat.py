import math
import subprocess
import sys

import pytest

from bedrad import heat
from bedrad.heat import RangeWarning, ranges


def test_every_submodule_is_reached_by_attribute():
    for name in heat.__all__:
        assert getattr(heat, name) is not None
    assert set(dir(heat)) == set(heat.__all__)
    with pytest.raises(AttributeError, match="no attribute 'phlogiston'"):
        _ = heat.phlogiston


def test_equations_load_neither_statistics_nor_compiler_nor_packings():
    code = (
        "import sys; from bedrad import heat; heat.prediction.predict; heat.wall_layer.conductivity;"
        "print([m for m in sys.modules if m.startswith(('scipy.stats', 'numba', 'h5py', 'bedrad.'))"
        " and not m.startswith('bedrad.heat')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_range_warning_is_a_user_warning_and_forgives_rounding():
    assert issubclass(RangeWarning, UserWarning)
    ranges.warn_outside("x", [1.0 - 1e-12, 2.0 + 1e-12], 1.0, 2.0)
    with pytest.warns(RangeWarning, match=r"^x is 2.1 m, outside the fitted range 1 to 2 m: an extrapolation$"):
        ranges.warn_outside("x", [[1.5, 2.1], [3.0, 1.0]], 1.0, 2.0, "m")


def test_refusals_count_the_bad_values():
    with pytest.raises(ValueError, match=r"^x is -1 K \(2 such values\); expected a positive, finite number$"):
        ranges.positive("x", [1.0, -1.0, 0.0], "K")


def test_a_range_without_an_upper_end_has_a_lower_one():
    ranges.warn_outside("x", [0.7 - 1e-12, 1e300], 0.7, math.inf)
    with pytest.warns(RangeWarning, match=r"^x is 0.6, outside the fitted range from 0.7: an extrapolation$"):
        ranges.warn_outside("x", [0.8, 0.6], 0.7, math.inf)


def test_nothing_is_told_while_quiet():
    with ranges.quiet():
        ranges.warn("not the answer")
    with pytest.warns(RangeWarning, match="the answer"):
        ranges.warn("the answer")


def test_a_prediction_is_told_about_once_however_many_there_are():
    """In a fresh process with Python's own filters; a library that catches warnings would make it forget."""
    code = (
        "from bedrad.heat import prediction as p\n"
        "for _ in range(3): p.predict(p.System(7.75e-3, 100e-6, 0.05), 900.0, heat_flux=1e4, "
        "property_temperature='layers')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.count("RangeWarning") == 1
