"""The energy balance along a heated tube against closed forms, mpmath and rates of convergence."""

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bedrad.heat import RangeWarning, energy_balance
from bedrad.heat.energy_balance import (
    cumulative_heat,
    heat_rate,
    mean_temperature,
    ohmic_coefficients,
    ohmic_heat,
    power_law_heat,
    section_temperatures,
)
from bedrad.heat.materials import ALUMINA_SILICATE, ZERO_CELSIUS, ZIRCONIA_SILICA

FLOW = 1.6e-3


def own_power_law(T):
    """The power law of zirconia-silica as any function, so that nothing of its closed form is known."""
    return 271.5 * (T - ZERO_CELSIUS) ** 0.1719


def mp_balance(inlet, heat, flow):
    """Equation 14 in 40 digits, temperatures in degrees Celsius."""
    with mpmath.workdps(40):
        H1, H2 = mpmath.mpf("271.5"), mpmath.mpf("0.1719")
        C = mpmath.mpf(inlet) - mpmath.mpf(ZERO_CELSIUS)
        return float(((H2 + 1) * mpmath.mpf(heat) / (mpmath.mpf(flow) * H1) + C ** (H2 + 1)) ** (1 / (H2 + 1))
                     + mpmath.mpf(ZERO_CELSIUS))  # fmt: skip


def test_constant_specific_heat_is_a_division():
    found = mean_temperature(300.0, [0.0, 10.0, -20.0], 1e-2, 800.0)
    np.testing.assert_allclose(found, [300.0, 301.25, 297.5], rtol=1e-15)
    assert isinstance(mean_temperature(300.0, 10.0, 1e-2, 800.0), float)


@pytest.mark.parametrize("given", [ZIRCONIA_SILICA, ZIRCONIA_SILICA.specific_heat, own_power_law])
def test_power_law_is_equation_14(given):
    heats = np.array([0.0, 1e-6, 10.0, 100.0, 300.0, -20.0])
    found = mean_temperature(340.0, heats, FLOW, given)
    np.testing.assert_allclose(found, [mp_balance(340.0, Q, FLOW) for Q in heats], rtol=1e-14)


def test_power_law_from_just_above_its_end_up_to_a_thousand_degrees():
    with pytest.warns(RangeWarning, match=r"273\.15"):
        found = mean_temperature(273.15 + 1e-9, 900.0, FLOW, ZIRCONIA_SILICA)
    assert found == pytest.approx(mp_balance(273.15 + 1e-9, 900.0, FLOW), rel=1e-13)


def test_any_function_is_solved_to_rounding():
    def c_p(T):
        return 400.0 + 0.8 * T + 150.0 * np.sin(T / 40.0)

    inlet, heats = 300.0, np.array([1.0, 50.0, 400.0, 2000.0, -150.0])
    found = mean_temperature(inlet, heats, FLOW, c_p)

    def enthalpy(T):
        return 400.0 * T + 0.4 * T**2 - 6000.0 * np.cos(T / 40.0)

    np.testing.assert_allclose(FLOW * (enthalpy(found) - enthalpy(inlet)), heats, rtol=2e-11)


def test_a_table_with_kinks_closes_its_own_balance():
    def c_p(T):
        return np.interp(T, [280.0, 400.0, 401.0, 900.0], [500.0, 600.0, 900.0, 950.0])

    heats = np.array([10.0, 160.0, 400.0])
    found = mean_temperature(300.0, heats, FLOW, c_p)
    areas = []
    for T in found:
        z = np.unique([300.0, T, *(k for k in (400.0, 401.0) if k < T)])
        areas.append(np.trapezoid(c_p(z), z))
    np.testing.assert_allclose(FLOW * np.array(areas), heats, rtol=1e-5)


def test_a_function_is_not_asked_beyond_the_answer():
    highest = []

    def c_p(T):
        highest.append(np.max(T))
        return 300.0 + (T / 100.0) ** 3

    found = mean_temperature(300.0, 1500.0, FLOW, c_p)
    assert max(highest) <= found * (1.0 + 1e-3)


def test_shapes_broadcast():
    found = mean_temperature(np.array([[310.0], [320.0]]), np.array([0.0, 5.0, 10.0]), FLOW, own_power_law)
    assert found.shape == (2, 3)
    assert found[1, 2] == pytest.approx(mean_temperature(320.0, 10.0, FLOW, own_power_law), rel=1e-14)


@pytest.mark.parametrize("given", [700.0, ZIRCONIA_SILICA, own_power_law])
def test_heat_rate_is_the_inverse(given):
    heats = np.array([1e-9, 1.0, 30.0, 200.0, -25.0])
    back = heat_rate(350.0, mean_temperature(350.0, heats, FLOW, given), FLOW, given)
    # the smallest rise has few digits left of a temperature of 350 K
    np.testing.assert_allclose(back, heats, rtol=1e-12, atol=1e-12)


def test_heat_rate_of_nearly_equal_temperatures_keeps_its_digits():
    low, high = 350.0, 350.0 * (1.0 + 2.0**-40)
    with mpmath.workdps(40):
        H, n = mpmath.mpf(271.5), mpmath.mpf(0.1719) + 1
        C = [mpmath.mpf(T) - mpmath.mpf(ZERO_CELSIUS) for T in (low, high)]
        expected = float(mpmath.mpf(FLOW) * H * (C[1] ** n - C[0] ** n) / n)
    assert heat_rate(low, high, FLOW, ZIRCONIA_SILICA) == pytest.approx(expected, rel=1e-13)


def test_differential_equation_along_a_tube():
    """Eq. 14 with eq. 13 against dT/dz = Q'(z)/(m c_p), integrated step by step."""
    G, d, length = (40.0, 6.0, 70.0), 0.6, 1.26
    z = np.linspace(0.0, length, 7)

    def slope(z, T):
        return (G[0] * (d + 1) * z**d + 2 * G[1] * z + G[2]) / (FLOW * own_power_law(T))

    reference = solve_ivp(slope, (0.0, length), [315.0], t_eval=z, rtol=1e-10, atol=1e-10).y[0]
    found = mean_temperature(315.0, power_law_heat(z, G, d), FLOW, ZIRCONIA_SILICA)
    np.testing.assert_allclose(found, reference, rtol=1e-8)


def test_ohmic_heat_converges_to_its_power_law_form():
    """Eq. 12 summed up over readings goes to eq. 13 with the square of their distance."""
    current, area, T0, c, e, d = 60.0, 2.6e-5, 330.0, 25.0, 60.0, 1.5
    rho, slope = 1.03e-6, 1.2e-10
    G = ohmic_coefficients(current, area, rho, slope, c, e, d)
    errors = []
    for n in (16, 32, 64, 128):
        z = np.linspace(0.0, 1.3, n + 1)
        wall = T0 + c * z**d + e * z
        found = ohmic_heat(z, wall, current, area, lambda T: rho + slope * (T - T0))
        errors.append(found[-1] - power_law_heat(1.3, G, d))
    rates = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert np.all((rates > 1.7) & (rates < 2.2))
    # all but G3 comes from the change of the resistance; without it V = I R
    assert ohmic_heat([0.0, 1.3], 400.0, current, area, rho)[-1] == pytest.approx(current**2 * rho * 1.3 / area)


def test_cumulative_heat_is_exact_for_a_linear_flux():
    z = np.array([0.0, 0.3, 0.31, 1.2])
    found = cumulative_heat(z, 3000.0 + 500.0 * z, 0.024)
    np.testing.assert_allclose(found, 0.024 * (3000.0 * z + 250.0 * z**2), rtol=1e-14)
    np.testing.assert_allclose(cumulative_heat(z, 3000.0, 0.024), 0.024 * 3000.0 * z, rtol=1e-14)


def test_sections_approach_the_balance_with_their_square():
    total, inlet = 120.0, 320.0
    exact = mean_temperature(inlet, total, FLOW, ZIRCONIA_SILICA)
    errors = [
        section_temperatures(inlet, np.full(n, total / n), FLOW, ZIRCONIA_SILICA)[-1] - exact for n in (4, 8, 16, 32)
    ]
    rates = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert np.all(np.abs(rates - 2.0) < 0.1)


def test_one_section_is_too_cold_midway_and_two_are_not():
    """What the source shows in Figure 2.15: c_p of the whole tube is too large for its first half."""
    half = 60.0
    middle = mean_temperature(315.0, half, FLOW, ZIRCONIA_SILICA)
    one = section_temperatures(315.0, [2 * half], FLOW, ZIRCONIA_SILICA)
    two = section_temperatures(315.0, [half, half], FLOW, ZIRCONIA_SILICA)
    too_cold = middle - 0.5 * one.sum()
    assert too_cold > 1.5
    assert abs(middle - two[1]) < 0.2 * too_cold
    # a constant specific heat makes no difference
    np.testing.assert_allclose(section_temperatures(315.0, [2.0, 3.0], FLOW, 700.0),
                               [315.0, 315.0 + 2.0 / (FLOW * 700.0), 315.0 + 5.0 / (FLOW * 700.0)])  # fmt: skip


def test_outside_the_measured_range_warns_once_with_the_range():
    with pytest.warns(RangeWarning, match="313.15 to 773.15") as told:
        mean_temperature(320.0, 600.0, FLOW, ZIRCONIA_SILICA)
    assert len(told) == 1

    def c_p(T):
        return ALUMINA_SILICATE.specific_heat(T)

    with pytest.warns(RangeWarning, match="313.15 to 773.15") as told:
        mean_temperature(320.0, 1000.0, FLOW, c_p)
    assert len(told) == 1


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: mean_temperature(-1.0, 1.0, FLOW, 700.0), "inlet_temperature is -1 K"),
        (lambda: mean_temperature(300.0, np.nan, FLOW, 700.0), "heat_rate is nan W; expected a finite"),
        (lambda: mean_temperature(300.0, 1.0, 0.0, 700.0), "mass_flow is 0 kg/s"),
        (lambda: mean_temperature(300.0, 1.0, FLOW, -2.0), "specific_heat is -2 J"),
        (lambda: mean_temperature(300.0, 1.0, FLOW, lambda T: 0.0 * T), "specific_heat is 0 J"),
        (lambda: mean_temperature(300.0, -1e4, FLOW, 700.0), "above absolute zero"),
        (lambda: mean_temperature(300.0, -1e4, FLOW, lambda T: 700.0), "above absolute zero"),
        (lambda: mean_temperature(340.0, -1e3, FLOW, ZIRCONIA_SILICA), "above 273.15 K"),
        (lambda: mean_temperature(270.0, 1.0, FLOW, ZIRCONIA_SILICA), "more than 273.15 K"),
        (lambda: section_temperatures(300.0, [1.0, np.inf], FLOW, 700.0), "section_heats is inf W"),
        (lambda: section_temperatures(300.0, [-1e4], FLOW, 700.0), "above absolute zero"),
        (lambda: cumulative_heat([0.0, 0.0], 1.0, 1.0), "increasing positions"),
        (lambda: cumulative_heat([0.0, 1.0], np.nan, 1.0), "wall_heat_flux is nan"),
        (lambda: ohmic_heat([0.0, 1.0], 300.0, 1.0, 1e-5, -1.0), "resistivity is -1 ohm m"),
        (lambda: power_law_heat(1.0, (1.0, 1.0, 1.0), -1.0), "exponent is -1; expected more than -1"),
        (lambda: ohmic_coefficients(1.0, 1e-5, 1e-6, 0.0, 1.0, 1.0, -2.0), "exponent is -2"),
    ],
)
def test_refusals_name_field_value_and_expectation(call, match):
    with pytest.raises(ValueError, match=match):
        call()


def test_everything_public_is_listed():
    assert set(energy_balance.__all__) == {
        "SpecificHeat", "cumulative_heat", "heat_rate", "mean_temperature", "ohmic_coefficients", "ohmic_heat",
        "power_law_heat", "section_temperatures",
    }  # fmt: skip
