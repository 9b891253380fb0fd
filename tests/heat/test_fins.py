import math

import mpmath
import numpy as np
import pytest
from mpmath import besseli, besselk
from scipy.integrate import solve_bvp

from bedrad.heat.fins import FinnedTube, annular_fin_efficiency, corrected_radius, fin_parameter

# m r_1 and r_2c/r_1 - 1
X = (1e-30, 1e-6, 1e-3, 0.1, 1.0, 19.0, 300.0, 1e4)
S = (1e-15, 1e-12, 1e-6, 1e-3, 0.0999, 0.1001, 0.11, 1.0, 10.0, 1e4)


def literal(x, s):
    """Eq. 6-14 with its misprints put right, with 45 digits."""
    with mpmath.workdps(45):
        x = mpmath.mpf(x)
        y = x * (1 + mpmath.mpf(s))
        upper = besselk(1, x) * besseli(1, y) - besseli(1, x) * besselk(1, y)
        return 2 * x / (y * y - x * x) * upper / (besseli(0, x) * besselk(1, y) + besselk(0, x) * besseli(1, y))


def test_against_mpmath_at_extremes():
    worst = 0.0
    for x in X:
        for s in S:
            outer = 1.0 + s
            if x * outer > 1e6:
                continue
            wanted = literal(x, outer - 1.0)
            got = annular_fin_efficiency(1.0, outer, x)
            worst = max(worst, abs(float((mpmath.mpf(float(got)) - wanted) / wanted)))
    assert worst < 1e-13


@pytest.mark.parametrize("outer", [1.0, 1.0 + 2.3e-16, 1.5, 1e300])
@pytest.mark.parametrize("m", [0.0, 1e-300, 1e-100])
def test_a_perfect_conductor_has_efficiency_one(outer, m):
    if m * outer < 1e-50:
        assert annular_fin_efficiency(1.0, outer, m) == 1.0


def test_no_fin_and_endless_fin():
    m = np.array([1e-6, 1.0, 1e4, 1e8])
    assert np.all(annular_fin_efficiency(1.0, 1.0, m) == 1.0)
    # all heat leaves within 1/m of the tube: 2 x/((y^2 - x^2) m r_1) K1/K0
    far = annular_fin_efficiency(1.0, 50.0, m[1:3])
    ratio = [float(mpmath.besselk(1, x) / mpmath.besselk(0, x)) for x in m[1:3]]
    assert far == pytest.approx(2.0 / m[1:3] / (50.0**2 - 1.0) * np.array(ratio), rel=1e-12)


def test_largest_fins():
    # a straight wall: 2/(x s (2 + s)) (1 + 1/(2 x))
    x = 1e7
    assert annular_fin_efficiency(1.0, 2.0, x) == pytest.approx(2.0 / (3.0 * x) * (1.0 + 0.5 / x), rel=1e-13)
    # x = 1e-195 and y = 1e5: 2/(x s^2) K1/K0 with K1 = 1/x and K0 = ln(2/x) - gamma
    expected = 2e-205 * 1e195 / (math.log(2e195) - np.euler_gamma)
    assert annular_fin_efficiency(1.0, 1e200, 1e-195) == pytest.approx(expected, rel=1e-12)


def test_a_thin_ring_is_a_straight_fin_to_first_order():
    # tanh(m L)/(m L) with m L = 2 fixed while the radius grows
    rings = np.array([1e-2, 1e-3, 1e-4])
    off = 1.0 - annular_fin_efficiency(1.0, 1.0 + rings, 2.0 / rings) / (math.tanh(2.0) / 2.0)
    assert np.log10(off[:-1] / off[1:]) == pytest.approx([1.0, 1.0], abs=0.02)
    assert off[2] < 1e-4


def test_against_the_conduction_equation():
    r1, r2, m = 0.0095, 0.019, 105.0

    def equation(r, y):
        return np.vstack([y[1], m * m * y[0] - y[1] / r])

    r = np.linspace(r1, r2, 40)
    found = solve_bvp(
        equation, lambda a, b: np.array([a[0] - 1.0, b[1]]), r, np.ones((2, 40)), tol=1e-10, max_nodes=20000
    )
    heat = -2.0 * math.pi * r1 * found.y[1, 0] / m**2
    assert annular_fin_efficiency(r1, r2, m) == pytest.approx(heat / (math.pi * (r2**2 - r1**2)), rel=1e-8)


def test_both_forms_meet():
    inside = annular_fin_efficiency(1.0, 1.1, np.array([1e-3, 1.0, 19.0, 20.0]))
    outside = annular_fin_efficiency(1.0, 1.1 + 1e-14, np.array([1e-3, 1.0, 19.0, 20.0 + 1e-12]))
    assert inside == pytest.approx(outside, rel=1e-12)


def test_equation_as_printed_is_no_efficiency():
    # its denominator, I0(x) K1(x) - K0(x) I1(y), even changes sign
    printed = []
    for x, y in ((1.0, 2.0), (1.0, 2.4)):
        upper = besselk(1, x) * besseli(1, y) - besseli(1, x) * besselk(1, y)
        printed.append(
            2 * x / (y * y - x * x) * upper / (besseli(0, x) * besselk(1, x) - besselk(0, x) * besseli(1, y))
        )
    assert printed[0] > 6.0
    assert printed[1] < -2.0


def test_scalars_broadcast_and_come_back():
    assert isinstance(annular_fin_efficiency(0.01, 0.02, 100.0), float)
    m = fin_parameter(np.array([50.0, 150.0]), 52.0, 0.5e-3)
    assert m == pytest.approx([math.sqrt(100 / 0.026), math.sqrt(300 / 0.026)], rel=1e-14)
    assert annular_fin_efficiency(0.01, np.array([[0.015], [0.02]]), m).shape == (2, 2)
    assert corrected_radius(0.02, 1e-3) == pytest.approx(0.0205, rel=1e-15)


def test_areas_of_a_tube():
    tube = FinnedTube(9.525e-3, 19.0e-3, 0.5e-3, 32, 0.1016, 51.9)
    assert tube.base_area == pytest.approx(2 * math.pi * 9.525e-3 * (0.1016 - 0.016), rel=1e-14)
    # faces and tip together, by eq. 6-10 and 6-11, to the square of the thickness
    faces, tip = 2 * math.pi * (0.019**2 - 9.525e-3**2), 2 * math.pi * 0.019 * 0.5e-3
    assert tube.fin_area == pytest.approx(faces + tip, rel=3e-4)
    assert tube.total_area == pytest.approx(tube.base_area + 32 * tube.fin_area, rel=1e-14)
    assert tube.effective_area(0.0) == pytest.approx(tube.total_area, rel=1e-14)
    assert tube.base_area < tube.effective_area(1e9) < 1.02 * tube.base_area
    assert tube.efficiency(np.array([10.0, 100.0])).shape == (2,)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: annular_fin_efficiency(0.02, 0.01, 1.0),
            "outer_radius is 0.01 m; expected at least inner_radius, 0.02 m",
        ),
        (lambda: annular_fin_efficiency(0.01, 0.02, -1.0), "fin_parameter is -1 1/m"),
        (lambda: annular_fin_efficiency(0.01, 0.02, 1e11), "at most 1e"),
        (lambda: annular_fin_efficiency(0.0, 0.02, 1.0), "inner_radius is 0 m"),
        (lambda: fin_parameter(1.0, 0.0, 1.0), "conductivity is 0"),
        (lambda: corrected_radius(0.1, -1.0), "thickness is -1"),
        (lambda: FinnedTube(0.02, 0.01, 1e-3, 10, 0.1, 50.0), "fin_radius is 0.01 m"),
        (lambda: FinnedTube(0.01, 0.02, 1e-3, 100, 0.1, 50.0), "cover the whole length"),
        (lambda: FinnedTube(0.01, 0.02, 1e-3, 10, 0.1, math.nan), "conductivity is nan"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
