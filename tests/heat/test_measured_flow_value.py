"""Values with errors: intervals, and the propagation of eq. 52 against random draws and mpmath."""

import mpmath
import numpy as np
import pytest

from bedrad.heat.measured_flow import Measured, coverage_factor, propagated
from bedrad.heat.measured_flow_value import combined

DRAWS = 400_000


def test_coverage_factors_are_those_of_the_normal_and_of_student():
    assert coverage_factor() == pytest.approx(1.959963984540054, rel=1e-12)
    # quantiles of Student's t at 0.975, from tables
    np.testing.assert_allclose(coverage_factor([1, 2, 5, 10, 30]), [12.7062, 4.30265, 2.57058, 2.22814, 2.04227],
                               rtol=2e-6)  # fmt: skip
    # and from the integral of the density, by mpmath
    with mpmath.workdps(30):
        nu = mpmath.mpf("3.7")
        norm = mpmath.gamma((nu + 1) / 2) / (mpmath.sqrt(nu * mpmath.pi) * mpmath.gamma(nu / 2))
        t = mpmath.mpf(float(coverage_factor(3.7, 0.9)))
        share = 2 * mpmath.quad(lambda x: norm * (1 + x * x / nu) ** (-(nu + 1) / 2), [0, t])
    assert float(share) == pytest.approx(0.9, abs=1e-12)
    assert coverage_factor(1e11) == coverage_factor(np.inf)
    assert coverage_factor(9.9e9) == pytest.approx(float(coverage_factor()), rel=1e-9)


def test_relative_errors_and_intervals():
    found = Measured([200.0, -50.0], [10.0, 1.0], [np.inf, 4])
    np.testing.assert_allclose(found.relative_error, [0.05, 0.02])
    np.testing.assert_allclose(found.half_width(), [19.59964, 2.776445], rtol=1e-6)
    assert Measured(0.0, 1.0).relative_error == np.inf
    assert Measured(0.0).relative_error == 0.0
    assert str(Measured(200.0, 10.0)) == "200 ± 20 (95 %; standard error 5 %)"


def test_independent_errors_add_in_squares_at_any_size():
    for size in (1e-200, 1.0, 1e200):
        found = combined(0.0, [(1.0, Measured(0.0, 3.0 * size)), (-2.0, Measured(0.0, 2.0 * size))])
        assert found.error == pytest.approx(5.0 * size, rel=1e-15)


def test_degrees_of_freedom_are_those_of_welch_and_satterthwaite():
    found = combined(0.0, [(1.0, Measured(0.0, 3.0, 5)), (1.0, Measured(0.0, 4.0, 8))])
    assert found.degrees_of_freedom == pytest.approx(5.0**4 / (3.0**4 / 5 + 4.0**4 / 8))
    assert combined(0.0, [(1.0, Measured(0.0, 3.0)), (1.0, Measured(0.0, 0.0, 3))]).degrees_of_freedom == np.inf


def test_propagation_agrees_with_random_draws():
    def function(x, y):
        return x**2 / y

    inputs = Measured(3.0, 0.02), Measured(2.0, 0.01)
    found = propagated(function, *inputs)
    rng = np.random.default_rng(1)
    drawn = function(*(rng.normal(m.value, m.error, DRAWS) for m in inputs))
    assert found.value == 4.5
    # the standard deviation of n draws is known to 1/sqrt(2 n), 0.1 %
    assert found.error == pytest.approx(drawn.std(), rel=5e-3)
    exact = 4.5 * np.hypot(2 * 0.02 / 3.0, 0.01 / 2.0)
    assert found.error == pytest.approx(exact, rel=1e-5)


def test_exact_inputs_are_left_alone():
    found = propagated(lambda x, y: np.sqrt(x) * y, Measured([4.0, 9.0], [0.4, 0.0]), 3.0)
    np.testing.assert_allclose(found.value, [6.0, 9.0])
    np.testing.assert_allclose(found.error, [0.3, 0.0], rtol=1e-4)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: Measured(1.0, -0.1), "error is -0.1"),
        (lambda: Measured(1.0, np.nan), "error is nan"),
        (lambda: Measured(1.0, 0.1, 0), "degrees_of_freedom is 0"),
        (lambda: coverage_factor(5, 1.0), "level is 1; expected a number between 0 and 1"),
        (lambda: propagated(np.sqrt, np.nan), "input 1 is nan"),
    ],
)
def test_refusals(call, match):
    with pytest.raises(ValueError, match=match):
        call()
