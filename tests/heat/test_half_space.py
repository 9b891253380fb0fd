import csv
from pathlib import Path

import mpmath
import numpy as np
import pytest

from bedrad.heat import half_space

TABLE = Path(__file__).parents[1] / "references" / "sullivan_sabersky_exact.csv"
ROWS = [tuple(map(float, row)) for row in list(csv.reader(TABLE.read_text().splitlines()))[1:]]
NUMBERS = np.concatenate([[1e-300, 1e-30], np.logspace(-12, 8, 81), [0.999999, 1.0, 1.000001, 1e30, 1e300]])


def exact_local(B):
    B = mpmath.mpf(float(B))
    return mpmath.exp(B * B) * mpmath.erfc(B)


def asymptotic_local(B):
    """1/(sqrt(pi) B) [1 - 1/(2 B^2) + 3/(4 B^4)], good to 2e-30 for B above 1e5."""
    B = mpmath.mpf(float(B))
    return (1 - 1 / (2 * B**2) + 3 / (4 * B**4)) / (mpmath.sqrt(mpmath.pi) * B)


def references(B):
    """Local and mean in as many digits as the cancellation at small B takes; exp(B^2) is out of reach above 1e5."""
    with mpmath.workdps(60 + int(4 * abs(np.log10(B)))):
        local = exact_local(B) if B < 1e5 else asymptotic_local(B)
        B = mpmath.mpf(float(B))
        mean = (local - 1 + 2 * B / mpmath.sqrt(mpmath.pi)) / B**2
        series = 1 / (1 + mpmath.sqrt(mpmath.pi) / 2 * B)
        return local, mean, series, series / mean - 1, mean / series - 1


def test_from_no_contact_to_all_contact_against_60_digits():
    worst = {}
    for B in NUMBERS:
        local, mean, series, error, gain = references(B)
        pairs = {
            "local": (half_space.local_half_space(B), local),
            "mean": (half_space.mean_half_space(B), mean),
            "in series": (half_space.mean_in_series(B), series),
            "error": (half_space.in_series_error(B), error),
            "gain": (half_space.gain_over_series(B), gain),
        }
        for name, (value, reference) in pairs.items():
            deviation = abs(float((mpmath.mpf(float(value)) - reference) / reference))
            worst[name] = max(worst.get(name, 0.0), deviation)
    assert worst["local"] < 1e-14, worst
    assert worst["mean"] < 1e-15, worst
    assert worst["in series"] < 1e-15, worst
    assert worst["error"] < 1e-13, worst
    assert worst["gain"] < 1e-13, worst


@pytest.mark.parametrize(("B", "mean", "series", "error"), ROWS)
def test_reference_table(B, mean, series, error):
    assert half_space.mean_half_space(B) == pytest.approx(mean, abs=5.1e-11)
    assert half_space.mean_in_series(B) == pytest.approx(series, abs=5.1e-11)
    assert half_space.in_series_error(B) == pytest.approx(error, abs=5.1e-6)


@pytest.mark.parametrize("time", [0.01, 0.3, 1.0, 5.0, 40.0])
def test_the_equation_of_conduction_itself(time):
    # with k rho c = h_c = 1 the flux into the half-space has the transform 1/(s (1 + 1/sqrt(s))), and B^2 is the time
    def flux(s):
        return 1 / (s * (1 + 1 / mpmath.sqrt(s)))

    local = mpmath.invertlaplace(flux, time, method="talbot")
    mean = mpmath.invertlaplace(lambda s: flux(s) / s, time, method="talbot") / time
    assert half_space.local_half_space(time**0.5) == pytest.approx(float(local), rel=1e-10)
    assert half_space.mean_half_space(time**0.5) == pytest.approx(float(mean), rel=1e-10)


@pytest.mark.parametrize(
    ("mean", "local"),
    [
        (half_space.mean_half_space, half_space.local_half_space),
        (half_space.mean_in_series, half_space.local_in_series),
    ],
)
def test_mean_is_the_average_of_the_local_coefficient_over_the_time(mean, local):
    nodes, weights = np.polynomial.legendre.leggauss(40)
    share = 0.5 * (nodes + 1)  # sqrt(t'/t)
    for B in (0.2, 1.0, 6.0):
        assert mean(B) == pytest.approx(float(np.sum(weights * share * local(B * share))), rel=1e-13)


def test_both_forms_agree_at_both_ends_and_part_by_5_percent_between():
    B = np.logspace(-2, 3, 20001)
    error = half_space.in_series_error(B)
    assert np.all(error < 0)
    assert B[np.argmin(error)] == pytest.approx(1.3714, rel=1e-3)
    assert error.min() == pytest.approx(-0.0476437467, rel=1e-7)
    assert half_space.gain_over_series(B).max() == pytest.approx(0.0500272315, rel=1e-7)
    assert half_space.in_series_error([0.0, np.inf]) == pytest.approx([0.0, 0.0], abs=0)


def test_exact_ends():
    functions = (
        half_space.mean_half_space,
        half_space.local_half_space,
        half_space.mean_in_series,
        half_space.local_in_series,
    )
    for function in functions:
        assert list(function([0.0, np.inf])) == [1.0, 0.0]
        assert function(2.0).shape == ()
        assert function(np.ones((2, 3))).shape == (2, 3)


@pytest.mark.parametrize("bad", [-1.0, np.nan, -np.inf, [1.0, -2.0]])
def test_refuses_what_is_no_contact_number(bad):
    with pytest.raises(ValueError, match="contact_number is"):
        half_space.mean_half_space(bad)
