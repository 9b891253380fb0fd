"""h, Nu, z* and the first-law check: equations, random draws, and the published uncertainties."""

import numpy as np
import pytest

from bedrad.heat import RangeWarning, two_layer
from bedrad.heat.energy_balance import heat_rate, mean_temperature
from bedrad.heat.materials import ZIRCONIA_SILICA
from bedrad.heat.measured_flow import (
    Measured,
    first_law_check,
    heat_transfer_coefficient,
    inverse_graetz,
    nusselt,
    propagated,
    two_layer_values,
)
from bedrad.heat.systems import System

D, FLOW = 7.614e-3, 1.63e-3
Q, T_W, T_M, K_B = Measured(3000.0, 20.0), Measured(365.0, 0.4), Measured(353.0, 0.3), Measured(0.307, 0.015)


def test_h_and_nu_are_equations_1_5_56_and_57():
    h = heat_transfer_coefficient(Q, T_W, T_M)
    nu = nusselt(h, D, K_B)
    assert h.value == pytest.approx(250.0)
    assert nu.value == pytest.approx(250.0 * D / 0.307)
    S_h = np.sqrt((20.0 / 3000.0) ** 2 + (0.4**2 + 0.3**2) / 12.0**2)
    assert h.relative_error == pytest.approx(S_h, rel=1e-12)
    assert nu.relative_error == pytest.approx(np.hypot(S_h, 0.015 / 0.307), rel=1e-12)


def test_errors_agree_with_random_draws_and_with_differences():
    rng, n = np.random.default_rng(8), 300_000
    q, w, m, k = (rng.normal(x.value, x.error, n) for x in (Q, T_W, T_M, K_B))
    h = heat_transfer_coefficient(Q, T_W, T_M)
    nu = nusselt(h, D, K_B)
    # second order: 0.3 % here
    assert h.error == pytest.approx((q / (w - m)).std(), rel=1e-2)
    assert nu.error == pytest.approx((q / (w - m) * D / k).std(), rel=1e-2)
    differences = propagated(lambda q, w, m, k: q / (w - m) * D / k, Q, T_W, T_M, K_B)
    assert differences.error == pytest.approx(nu.error, rel=1e-5)


def test_first_term_of_equation_57_is_a_pure_number():
    """The printed sigma_h/h^2 changes with the unit of h, and would leave Nu no error but that of k_b."""
    h = heat_transfer_coefficient(Q, T_W, T_M)
    printed = np.hypot(h.error / h.value**2, K_B.relative_error)
    assert printed == pytest.approx(K_B.relative_error, rel=1e-4)
    # errors of 15 % in h and 9 to 11 % in k_b cannot make the published 17 % with the printed term, and do without
    assert np.hypot(0.15 / 400.0, 0.11) < 0.1101
    assert np.hypot(0.15, 0.09) == pytest.approx(0.17, abs=0.006)
    assert np.hypot(0.14, 0.09) == pytest.approx(0.16, abs=0.007)
    # the same in units of kW leaves the right term alone
    assert Measured(h.value / 1e3, h.error / 1e3).relative_error == pytest.approx(h.relative_error)


def test_inverse_graetz_number_is_that_of_the_two_layer_model():
    z, k, c, rho = 0.64, 0.307, 577.0, 2386.0
    U = FLOW / (rho * 0.25 * np.pi * D**2)
    assert inverse_graetz(z, D, FLOW, k, c) == pytest.approx(z * (k / (rho * c)) / (U * D**2), rel=1e-14)
    # the diameter cancels
    assert inverse_graetz(z, 2 * D, FLOW, k, c) == pytest.approx(inverse_graetz(z, D, FLOW, k, c), rel=1e-14)


@pytest.mark.parametrize("c_p", [600.0, ZIRCONIA_SILICA, lambda T: 400.0 + 0.6 * T])
def test_error_of_the_balance_agrees_with_random_draws(c_p):
    inlet, heat, flow = Measured(330.0, 0.5), Measured(40.0, 0.8), Measured(FLOW, 2e-5)
    law = first_law_check(inlet, heat, flow, c_p, 370.0)
    rng, n = np.random.default_rng(9), 40_000
    drawn = mean_temperature(*(rng.normal(x.value, x.error, n) for x in (inlet, heat, flow)), c_p)
    assert law.balance.error == pytest.approx(drawn.std(), rel=2e-2)
    assert law.balance.value == pytest.approx(mean_temperature(330.0, 40.0, FLOW, c_p))


def test_a_flow_that_keeps_the_balance_deviates_by_nothing():
    heats = np.array([20.0, 44.0])
    T = mean_temperature(330.0, heats, FLOW, ZIRCONIA_SILICA)
    law = first_law_check(330.0, heats, FLOW, ZIRCONIA_SILICA, Measured(T, 0.3))
    np.testing.assert_allclose(law.deviation, 0.0, atol=1e-9)
    np.testing.assert_allclose(law.closure, 1.0, rtol=1e-12)
    assert "100.0 % of the heat found" in str(law)


def test_deviations_are_in_standard_errors():
    law = first_law_check(330.0, 10.0, 1e-3, 500.0, Measured(351.0, 0.5))
    assert law.balance.value == 350.0
    assert law.deviation == pytest.approx(2.0)
    assert law.closure == pytest.approx(21.0 / 20.0)
    exact = first_law_check(330.0, 10.0, 1e-3, 500.0, [350.0, 349.0])
    assert exact.deviation.tolist() == [0.0, -np.inf]
    assert np.isnan(first_law_check(330.0, 0.0, 1e-3, 500.0, 330.0).closure)


def test_deviations_of_honest_errors_are_normal():
    """The pull of many random runs has mean 0 and standard deviation 1."""
    rng, n = np.random.default_rng(10), 4000
    truth = mean_temperature(330.0, 40.0, FLOW, ZIRCONIA_SILICA)
    law = first_law_check(
        Measured(rng.normal(330.0, 0.5, n), 0.5),
        Measured(rng.normal(40.0, 0.8, n), 0.8),
        Measured(rng.normal(FLOW, 2e-5, n), 2e-5),
        ZIRCONIA_SILICA,
        Measured(rng.normal(truth, 0.4, n), 0.4),
    )
    assert abs(law.deviation.mean()) < 3.5 / np.sqrt(n)
    assert abs(law.deviation.std() - 1.0) < 3.5 / np.sqrt(2 * n)


def test_published_uncertainties_follow_from_one_percent_of_degrees_celsius():
    """Appendix A: wall and mean temperatures within 1 %, flux within 1.5 %, h within 15 % and 14 % at the slowest flow.

    The slowest published flow, 0.015 m/s in the 9.53 mm tube, from 80 to 125 degC between the probes 0.62 m apart.
    """
    system = System(D, 270e-6, 0.015)
    flow = 2386.0 * 0.015 * 0.25 * np.pi * D**2
    heat = heat_rate(353.15, 398.15, flow, ZIRCONIA_SILICA)
    flux = heat / (np.pi * D * 0.62)
    largest = []
    for T in (353.15, 398.15):
        k_b, share = 0.000248 * (T - 273.15) + 0.287, 0.01 * (T - 273.15)
        model = two_layer_values(system, T + 11.0, T, k_b, np.inf)
        jump = flux * D / (model.developed * k_b)
        h = heat_transfer_coefficient(
            Measured(flux, 0.015 * flux / 1.96), Measured(T + jump, share / 1.96), Measured(T, share / 1.96)
        )
        largest.append(1.96 * h.relative_error)
        # of kelvin, 1 % would be four times as much: the percentages are of degrees Celsius
        assert 0.01 * np.sqrt(2) * T / jump > 0.4
    # "less than 1 %" makes less than 17 % here; the published 14 % at the slowest flow are 0.8 % of degrees Celsius
    np.testing.assert_allclose(largest, [0.104, 0.169], atol=0.004)
    assert 0.8 < 0.14 / largest[1] < 1.0


def test_which_published_probes_lie_in_the_developed_part():
    """Developed from z* = 0.08 on (section 4.1), with 270 um zirconia-silica at the stated mean temperatures."""

    def z_star(position, celsius, flow):
        k_b, c_p = 0.000248 * celsius + 0.287, 271.5 * celsius**0.1719
        return inverse_graetz(position, D, flow, k_b, c_p)

    # Figure 2.14: the wall temperature becomes linear at 0.34 m for 0.015 m/s; the flow is at some 58 degC there
    assert z_star(0.34, 58.0, 1.63e-3) == pytest.approx(0.09, abs=0.003)
    # the probe at 0.64 m is in the developed part up to 3.35 g/s, of flows from 1.5 to 9.5 g/s
    assert z_star(0.64, 80.0, 3.35e-3) == pytest.approx(0.08, rel=5e-3)
    fastest = z_star(0.64, 80.0, 9.5e-3), z_star(1.26, 125.0, 9.5e-3)
    np.testing.assert_allclose(fastest, [0.0282, 0.0532], atol=2e-4)
    excess = two_layer.nusselt(28.2, 2.45, fastest) / two_layer.nusselt_developed(28.2, 2.45) - 1.0
    np.testing.assert_allclose(excess, [0.099, 0.021], atol=2e-3)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: heat_transfer_coefficient(1000.0, 350.0, 360.0), "is -10 K for a heat_flux of 1000 W/m2"),
        (lambda: heat_transfer_coefficient(1000.0, 350.0, 350.0), "is 0 K"),
        (lambda: heat_transfer_coefficient([1.0, -1.0], 350.0, 340.0), "heat_flux of -1"),
        (lambda: heat_transfer_coefficient(np.nan, 350.0, 340.0), "heat_flux is nan W/m2"),
        (lambda: nusselt(-1.0, D, 0.3), "heat_transfer_coefficient is -1"),
        (lambda: nusselt(100.0, D, 0.0), "bulk_conductivity is 0"),
        (lambda: inverse_graetz(-1.0, D, FLOW, 0.3, 600.0), "position is -1 m"),
        (lambda: first_law_check(330.0, np.inf, FLOW, 600.0, 350.0), "heat is inf W"),
        (lambda: first_law_check(330.0, 1.0, FLOW, 600.0, -350.0), "measured_temperature is -350 K"),
    ],
)
def test_refusals(call, match):
    with pytest.raises(ValueError, match=match):
        call()


def test_cooling_has_the_same_h():
    heated, cooled = (heat_transfer_coefficient(s * 3000.0, 359.0 + s * 6.0, 359.0 - s * 6.0) for s in (1.0, -1.0))
    assert heated.value == cooled.value == 250.0


def test_outside_the_range_of_the_specific_heat_warns():
    with pytest.warns(RangeWarning, match="313.15 to 773.15"):
        first_law_check(300.0, 10.0, FLOW, ZIRCONIA_SILICA, 310.0)
