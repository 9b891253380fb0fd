import mpmath
import numpy as np
import pytest

from bedrad.heat import radiation

SIGMA = 5.670374419e-8
T = np.array([373.15, 873.15, 1373.15])


def test_published_factors_at_1100_degrees():
    # eq. 50 written out for 270 um: 4 sigma r T^3 (0.80 + 2 0.18 + 3 0.02)
    value = radiation.conductivity(radiation.WATKINS_FACTORS, 270e-6, 1373.15)
    assert value == pytest.approx(4 * 5.670374419e-8 * 135e-6 * 1373.15**3 * 1.22, rel=1e-14)
    assert value == pytest.approx(0.0967207, rel=1e-6)
    assert sum(radiation.WATKINS_FACTORS) == pytest.approx(1.0, abs=1e-15)


def test_any_number_of_layers_weighs_1_2_3_and_so_on():
    assert radiation.penetration([0.1, 0.2, 0.3, 0.4]) == pytest.approx(3.0, rel=1e-15)
    assert radiation.penetration([1.0]) == 1.0
    # layers split differently but nothing beyond the third: padding changes nothing
    padded = radiation.conductivity([0.80, 0.18, 0.02, 0.0], 270e-6, T)
    assert np.array_equal(padded, radiation.conductivity(radiation.WATKINS_FACTORS, 270e-6, T))


def test_broadcast_with_layers_on_the_last_axis():
    factors = np.full((5, 1, 3), 0.3)
    assert radiation.conductivity(factors, 3e-4, T).shape == (5, 3)
    assert radiation.heat_flux(factors, T, np.full((3, 3), 300.0)).shape == (5, 3)
    assert np.ndim(radiation.conductivity([0.8, 0.2], 3e-4, 900.0)) == 0


def test_flux_of_a_single_black_layer_and_of_an_isothermal_bed():
    assert radiation.heat_flux([1.0], 1000.0, [500.0]) == pytest.approx(SIGMA * (1000.0**4 - 500.0**4), rel=1e-14)
    assert radiation.heat_flux([0.8, 0.18, 0.02], 1000.0, [1000.0] * 3) == 0.0
    hot = radiation.heat_flux([0.8, 0.2], 600.0, [900.0, 1200.0])
    assert hot == pytest.approx(-SIGMA * (0.8 * (900.0**4 - 600.0**4) + 0.2 * (1200.0**4 - 600.0**4)), rel=1e-14)


def test_linearised_flux_is_conduction_with_k_rad_across_the_wall_layer():
    # eq. 50 from eq. 49: q = k_rad dT/r
    flux = radiation.linearised_heat_flux(radiation.WATKINS_FACTORS, T, 7.0)
    assert flux == pytest.approx(radiation.conductivity(radiation.WATKINS_FACTORS, 3e-4, T) * 7.0 / 150e-6, rel=1e-14)


def test_linearisation_error_is_of_first_order_in_the_step():
    F, steps = np.array(radiation.WATKINS_FACTORS), np.array([0.01, 0.1, 1.0])
    error = radiation.linearisation_error(F, 1373.15, steps)
    j = np.arange(1, 4)
    # expansion of eq. 48: T_w^4 - (T_w - x)^4 = 4 T_w^3 x (1 - 3x/(2 T_w) + ...)
    leading = 1.5 * (F @ j**2) / (F @ j) * steps / 1373.15
    assert error == pytest.approx(leading, rel=2e-3)
    assert np.all(error > 0)


def test_condition_is_the_exact_error_at_the_mean_temperature():
    hot, cold = 1373.15, np.array([300.0, 1000.0, 1370.0])
    mean = 0.5 * (hot + cold)
    exact = (hot**4 - cold**4) / (4 * mean**3 * (hot - cold)) - 1
    assert radiation.linearisation_condition(hot, cold) == pytest.approx(exact, rel=1e-9)
    assert radiation.linearisation_condition(hot, hot) == 0.0


def test_largest_effect_bounds_every_set_of_factors():
    rng = np.random.default_rng(7)
    shares = rng.dirichlet(np.ones(5), 500)[:, :3]  # three layers, and two places where rays are lost
    k_wa, k_b, k_b0, A, d = 0.27, 0.61, 0.52, 28.2, 270e-6
    k_rad = radiation.conductivity(shares, d, 1373.15)
    resistance = (1 - 1 / A) ** 4 / k_b + (1 - (1 - 1 / A) ** 4) / (k_wa + k_rad)
    without = (1 - 1 / A) ** 4 / k_b0 + (1 - (1 - 1 / A) ** 4) / k_wa
    bound = radiation.largest_effect(A, d, 1373.15, k_wa, k_b, k_b0)
    assert np.all(without / resistance - 1 < bound)
    everything_to_the_third = radiation.conductivity([0.0, 0.0, 1.0], d, 1373.15)
    worst = (1 - 1 / A) ** 4 / k_b + (1 - (1 - 1 / A) ** 4) / (k_wa + everything_to_the_third)
    assert without / worst - 1 == pytest.approx(bound, rel=1e-12)
    assert radiation.largest_effect(A, d, 1373.15, k_wa, k_b) < bound
    assert radiation.largest_effect(A, d, 1.0, k_wa, k_b) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("fall", [1e-12, 1e-3, 0.5, 2.999999, -1e-9, -1e4])
def test_difference_of_fourth_powers_keeps_its_digits(fall):
    with mpmath.workdps(60):
        exact = mpmath.mpf(3) ** 4 - (mpmath.mpf(3) - mpmath.mpf(fall)) ** 4
        assert abs(radiation.fourth_power_difference(3.0, fall) / exact - 1) < 1e-15


def test_linearisation_error_of_a_tiny_step_is_zero_to_rounding():
    assert radiation.linearisation_error(radiation.WATKINS_FACTORS, 1373.15, 1e-14) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("factors", "message"),
    [
        ([0.9, 0.2], "view factors sum to 1.1; expected at most 1"),
        ([0.5, -0.1], "view factor is -0.1"),
        ([np.nan], "view factor is nan"),
        (0.5, "expected the layers along the last axis"),
        ([], "expected the layers along the last axis"),
    ],
)
def test_refuses_factors_without_meaning(factors, message):
    with pytest.raises(ValueError, match=message):
        radiation.conductivity(factors, 3e-4, 900.0)


def test_refuses_temperatures_without_meaning():
    with pytest.raises(ValueError, match="wall_temperature is 0 K"):
        radiation.conductivity([0.8], 3e-4, 0.0)
    with pytest.raises(ValueError, match="layer_temperatures is -10 K"):
        radiation.linearisation_error([0.5, 0.5], 100.0, 55.0)
    with pytest.raises(ValueError, match="temperature_step is 0 K"):
        radiation.linearisation_error([0.5, 0.5], 100.0, 0.0)
