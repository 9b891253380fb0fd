"""Mean temperatures from radial profiles: closed forms, random draws, mpmath, and what eq. 54 leaves out."""

import warnings

import mpmath
import numpy as np
import pytest

from bedrad.heat import RangeWarning
from bedrad.heat.materials import ZIRCONIA_SILICA
from bedrad.heat.measured_flow import mean_from_profile, quadratic_mean

R = 3.807e-3
RADII = np.linspace(0.0, 3.5e-3, 8)
C = np.array([4.0e5, 300.0, 350.0])
"""Coefficients of a profile that rises by 7 K."""


def quadratic(r):
    return C[0] * r**2 + C[1] * r + C[2]


def drawn_means(errors, draws=20_000, **options):
    """Means of the regression on random readings, by a literal evaluation of eq. 4 with its own least squares."""
    rng = np.random.default_rng(7)
    readings = quadratic(RADII) + rng.normal(size=(draws, RADII.size)) * errors
    columns = np.stack([RADII**2, RADII, np.ones_like(RADII)], axis=1)
    weight = 1.0 / np.broadcast_to(errors, RADII.shape)
    fits = np.linalg.lstsq(columns * weight[:, None], (readings * weight).T, rcond=None)[0]
    return fits[0] * R**2 / 2 + 2 * fits[1] * R / 3 + fits[2]


@pytest.mark.parametrize("form", ["quadratic", "spline"])
def test_a_quadratic_profile_gives_equation_4(form):
    even = C * [1, 0, 1] if form == "spline" else C
    T = even[0] * RADII**2 + even[1] * RADII + even[2]
    found = mean_from_profile(RADII, T, R, 0.1, form=form)
    assert found.mean.value == pytest.approx(quadratic_mean(even, R), rel=1e-13)
    assert found.edge.value == pytest.approx(even @ [R**2, R, 1.0], rel=1e-12)


def test_equation_4_is_the_integral_of_equation_3():
    with mpmath.workdps(30):
        c = [mpmath.mpf(x) for x in C]
        expected = mpmath.quad(lambda r: (c[0] * r * r + c[1] * r + c[2]) * 2 * r / mpmath.mpf(R) ** 2, [0, R])
    assert quadratic_mean(C, R) == pytest.approx(float(expected), rel=1e-15)


def test_coefficients_are_those_of_the_regression():
    rng = np.random.default_rng(3)
    T = quadratic(RADII) + rng.normal(size=RADII.size) * 0.2
    found = mean_from_profile(RADII, T, R)
    expected, covariance = np.polyfit(RADII, T, 2, cov=True)
    np.testing.assert_allclose(found.coefficients, expected, rtol=1e-9)
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-9)
    assert found.mean.degrees_of_freedom == RADII.size - 3
    assert 0.97 < found.determination < 1.0


def test_standard_error_agrees_with_random_draws():
    errors = np.linspace(0.1, 0.3, RADII.size)
    found = mean_from_profile(RADII, quadratic(RADII), R, errors)
    # known to 1/sqrt(2 n), 0.5 %
    assert found.mean.error == pytest.approx(drawn_means(errors).std(), rel=0.02)


def test_equation_54_without_covariances_is_several_times_too_large():
    """The coefficients are anticorrelated; the draws side with the full covariance."""
    found = mean_from_profile(RADII, quadratic(RADII), R, 0.2)
    spread = drawn_means(0.2).std()
    assert found.mean.error == pytest.approx(spread, rel=0.02)
    C1, C2, C3 = np.diag(found.covariance)
    literal = np.sqrt(0.25 * R**4 * C1 + 4 / 9 * R**2 * C2 + C3)
    assert found.error_without_covariance == pytest.approx(literal, rel=1e-12)
    assert found.error_without_covariance / spread == pytest.approx(8.64, rel=0.02)


def test_error_from_scatter_covers_as_often_as_it_says():
    rng = np.random.default_rng(5)
    truth, inside, runs = quadratic_mean(C, R), 0, 2000
    for _ in range(runs):
        found = mean_from_profile(RADII, quadratic(RADII) + rng.normal(size=RADII.size) * 0.3, R).mean
        inside += abs(found.value - truth) < found.half_width()
    # binomial: 95 % within 3.5 standard errors of 0.49 %, a false alarm once in two thousand changes of the code
    assert abs(inside / runs - 0.95) < 3.5 * np.sqrt(0.95 * 0.05 / runs)


def test_an_error_common_to_all_readings_does_not_average_out():
    found = mean_from_profile(RADII, quadratic(RADII), R, 0.1, instrument_error=0.5)
    own = mean_from_profile(RADII, quadratic(RADII), R, 0.1)
    assert found.mean.error == pytest.approx(np.hypot(own.mean.error, 0.5), rel=1e-12)
    assert found.edge.error == pytest.approx(np.hypot(own.edge.error, 0.5), rel=1e-12)
    assert np.sqrt(found.covariance[2, 2]) == pytest.approx(np.hypot(np.sqrt(own.covariance[2, 2]), 0.5))


def test_the_even_form_has_the_smaller_error():
    T = C[0] * RADII**2 + C[2]
    even, full = (mean_from_profile(RADII, T, R, 0.2, form=form) for form in ("even", "quadratic"))
    assert even.mean.value == pytest.approx(full.mean.value, rel=1e-12)
    assert even.coefficients[1] == 0.0
    assert np.all(even.covariance[1] == 0.0)
    assert even.mean.error < full.mean.error


def test_a_spline_converges_with_the_fourth_power_of_the_step():
    def profile(r):
        return 350.0 + 20.0 * np.cosh(2.0 * r / R)

    with mpmath.workdps(30):
        exact = 350 + 40 * mpmath.quad(lambda x: mpmath.cosh(2 * x) * x, [0, 1])
    errors = []
    for n in (5, 9, 17, 33):
        r = np.linspace(0.0, R, n)
        errors.append(mean_from_profile(r, profile(r), R, 0.0, form="spline").mean.value - float(exact))
    rates = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert np.all(rates > 3.7)


def test_spline_error_agrees_with_random_draws():
    rng = np.random.default_rng(11)
    found = mean_from_profile(RADII, quadratic(RADII), R, 0.2, form="spline")
    means = [
        mean_from_profile(RADII, quadratic(RADII) + rng.normal(size=RADII.size) * 0.2, R, 0.2, form="spline").mean.value
        for _ in range(2000)
    ]
    assert found.mean.error == pytest.approx(np.std(means), rel=0.06)
    assert found.error_without_covariance == found.mean.error


def test_velocity_and_specific_heat_weigh_as_equation_3_says():
    """Against mpmath, with the Gaussian velocity of a shear layer at the wall and a power law in degrees Celsius."""
    width = 0.6 * R

    def velocity(r):
        return 0.02 * np.exp(-((r / width) ** 4)) + 0.005

    found = mean_from_profile(RADII, quadratic(RADII), R, 0.1, velocity=velocity,
                              specific_heat=ZIRCONIA_SILICA.specific_heat)  # fmt: skip
    with mpmath.workdps(25):
        c, radius = [mpmath.mpf(x) for x in C], mpmath.mpf(R)

        def temperature(r):
            return c[0] * r * r + c[1] * r + c[2]

        def weight(r):
            u = mpmath.mpf("0.02") * mpmath.exp(-((r / mpmath.mpf(width)) ** 4)) + mpmath.mpf("0.005")
            return (temperature(r) - mpmath.mpf("273.15")) ** mpmath.mpf("0.1719") * u * r

        ends = mpmath.linspace(0, radius, 9)
        expected = mpmath.quad(lambda r: weight(r) * temperature(r), ends) / mpmath.quad(weight, ends)
    assert found.mean.value == pytest.approx(float(expected), rel=1e-13)


def test_error_with_weights_agrees_with_differences():
    options = {"specific_heat": lambda T: (T - 273.15) ** 3, "form": "spline"}
    T = 330.0 + 60.0 * (RADII / R) ** 2
    found = mean_from_profile(RADII, T, R, 0.5, **options)
    slopes = [
        (mean_from_profile(RADII, T + step, R, 0.5, **options).mean.value
         - mean_from_profile(RADII, T - step, R, 0.5, **options).mean.value) / 2e-2
        for step in 1e-2 * np.eye(RADII.size)
    ]  # fmt: skip
    assert found.mean.error == pytest.approx(0.5 * np.linalg.norm(slopes), rel=1e-5)


def test_the_specific_heat_matters_as_its_variance_does():
    """To first order T_m rises by n Var(T)/(T - 0 degC) for c_p ~ T^n, the source's "less than 1.5 %"."""
    T = 353.15 - 10.0 + 20.0 * (RADII / R) ** 2
    plain = mean_from_profile(RADII, T, R, 0.1).mean.value
    weighed = mean_from_profile(RADII, T, R, 0.1, specific_heat=ZIRCONIA_SILICA.specific_heat).mean.value
    assert weighed - plain == pytest.approx(0.1719 * 20.0**2 / 12.0 / 80.0, rel=0.02)


@pytest.mark.parametrize(("flow", "share"), [(1.5e-3, 0.0006), (7.4e-3, 0.0151), (9.5e-3, 0.026)])
def test_the_published_bound_on_the_specific_heat_holds_up_to_seven_grams_a_second(flow, share):
    """Section 2.1.3.1: less than 1.5 % (of degrees Celsius); developed profiles at 80 degC, 45 K in 0.62 m."""
    flux = flow * ZIRCONIA_SILICA.specific_heat(353.15) * 45.0 / 0.62 / (2 * np.pi * R)
    rise = flux * R / (2 * 0.3068)
    r = np.linspace(0.0, R, 40)
    T = 353.15 - rise / 2 + rise * (r / R) ** 2
    plain = mean_from_profile(r, T, R, 0.1).mean.value
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RangeWarning)
        weighed = mean_from_profile(r, T, R, 0.1, specific_heat=ZIRCONIA_SILICA.specific_heat).mean.value
    assert (weighed - plain) / 80.0 == pytest.approx(share, rel=0.04)


def test_order_and_repeated_radii_do_not_matter():
    r, T = np.concatenate([RADII, RADII]), np.concatenate([quadratic(RADII) + 0.1, quadratic(RADII) - 0.1])
    order = np.random.default_rng(0).permutation(r.size)
    one, two = mean_from_profile(r, T, R), mean_from_profile(r[order], T[order], R)
    assert one.mean.value == pytest.approx(two.mean.value, rel=1e-14)
    assert one.mean.value == pytest.approx(quadratic_mean(C, R), rel=1e-12)


def test_a_profile_that_ends_far_from_the_wall_warns():
    with pytest.warns(RangeWarning, match="34 % of the cross-section lie beyond the outermost reading"):
        mean_from_profile(RADII[:7] * R / 3.692e-3, quadratic(RADII[:7]), R, 0.1)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"radius": RADII[:3], "temperature": [300.0, 301.0, 302.0]}, "3 readings at 3 radii; expected at least 4"),
        ({"radius": [0, 0, 1e-3], "temperature": [300.0] * 3, "temperature_error": 0.1}, "expected at least 3"),
        ({"temperature": [300.0, 301.0]}, "temperature has the shape"),
        ({"radius": RADII + R}, "radius is 0.0043\\d* m .*; expected at least 0 and at most 0.003807"),
        ({"form": "cubic"}, "form is 'cubic'; expected one of quadratic, even, spline"),
        ({"form": "spline"}, "temperature_error is missing"),
        ({"temperature_error": [0.0] + [0.1] * 7}, "0 K for some readings"),
        ({"velocity": lambda r: 0.0 * r}, "expected a flow"),
        ({"tube_radius": 0.0}, "tube_radius is 0 m"),
        ({"temperature": quadratic(RADII) - 400.0}, "temperature is -50 K"),
    ],
)
def test_refusals(change, match):
    given = {"radius": RADII, "temperature": quadratic(RADII), "tube_radius": R} | change
    with pytest.raises(ValueError, match=match):
        mean_from_profile(**given)
    with pytest.raises(ValueError, match="expected C1, C2, C3"):
        quadratic_mean([1.0, 2.0], R)
