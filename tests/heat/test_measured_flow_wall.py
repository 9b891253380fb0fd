"""Losses, wall heat flux and wall temperatures against conduction solved independently, random draws and mpmath."""

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_bvp

from bedrad.heat.measured_flow import (
    Insulation,
    Measured,
    electrical_power,
    regressed_wall_temperature,
    wall_heat_flux,
    wall_temperature_drop,
)

R_O, R_CER, R_WOOL = 4.765e-3, 29.8e-3, 99.8e-3
INSULATION = Insulation(R_O, [R_CER, R_WOOL], [0.09, 0.05])
LENGTH = 0.62


def literal_equation_2(T_w, T_wool):
    resistance = np.log(R_CER / R_O) / 0.09 + np.log(R_WOOL / R_CER) / 0.05
    return 2 * np.pi * LENGTH * (T_w - T_wool) / resistance


def test_loss_is_equation_2():
    assert INSULATION.loss(LENGTH, 400.0, 305.0).value == pytest.approx(literal_equation_2(400.0, 305.0), rel=1e-14)
    assert INSULATION.loss(LENGTH, 300.0, 305.0).value < 0.0
    assert INSULATION.loss([0.3, 0.62], 400.0, [305.0, 306.0]).value.shape == (2,)


def test_loss_with_changing_conductivity_agrees_with_conduction_in_one_layer():
    """Linear k taken at the average temperature is exact for one layer: its integral over temperature is the same."""

    def k(T):
        return 0.05 + 2e-4 * (T - 300.0)

    found = Insulation(R_O, [R_WOOL], [k]).loss(1.0, 500.0, 310.0)

    # q r = const = Q/(2 pi): Kirchhoff's transform
    exact = 2 * np.pi * (0.05 * 190.0 + 1e-4 * (200.0**2 - 10.0**2)) / np.log(R_WOOL / R_O)
    assert found.value == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("k", [0.06, lambda T: 0.03 * (T / 300.0) ** 1.5])
def test_error_of_the_loss_agrees_with_random_draws(k):
    layers = Insulation(R_O, [R_CER, R_WOOL], [k, 0.05])
    found = layers.loss(LENGTH, Measured(420.0, 2.0), Measured(310.0, 3.0))
    rng = np.random.default_rng(2)
    drawn = layers.loss(LENGTH, rng.normal(420.0, 2.0, 200_000), rng.normal(310.0, 3.0, 200_000)).value
    assert found.error == pytest.approx(drawn.std(), rel=8e-3)


def test_flux_and_its_error_are_equation_55():
    V, amperes, T_w, T_wool = 2.66, 42.0, 380.0, 303.0
    sigma_V, sigma_I, sigma_w, sigma_wool = 0.005, 0.1, 0.8, 1.0
    power = electrical_power(Measured(V, sigma_V), Measured(amperes, sigma_I))
    loss = INSULATION.loss(LENGTH, Measured(T_w, sigma_w), Measured(T_wool, sigma_wool))
    found = wall_heat_flux(power, loss, 3.807e-3, LENGTH)
    bracket = np.log(R_CER / R_O) / 0.09 + np.log(R_WOOL / R_CER) / 0.05
    net = V * amperes - 2 * np.pi * LENGTH * (T_w - T_wool) / bracket
    square = (amperes**2 * sigma_V**2 + V**2 * sigma_I**2) / net**2
    square += (2 * np.pi * LENGTH / (V * amperes * bracket - 2 * np.pi * LENGTH * (T_w - T_wool))) ** 2 * (
        sigma_w**2 + sigma_wool**2
    )
    assert found.value == pytest.approx(net / (2 * np.pi * 3.807e-3 * LENGTH), rel=1e-14)
    assert found.relative_error == pytest.approx(np.sqrt(square), rel=1e-12)


def test_error_of_the_flux_agrees_with_random_draws():
    rng, n = np.random.default_rng(4), 200_000
    given = [(2.66, 0.02), (42.0, 0.3), (380.0, 2.0), (303.0, 4.0)]
    V, amperes, wall, wool = (Measured(*pair) for pair in given)
    found = wall_heat_flux(electrical_power(V, amperes), INSULATION.loss(LENGTH, wall, wool), 3.807e-3, LENGTH)
    v, i, w, s = (rng.normal(*pair, n) for pair in given)
    drawn = (v * i - literal_equation_2(w, s)) / (2 * np.pi * 3.807e-3 * LENGTH)
    assert found.error == pytest.approx(drawn.std(), rel=8e-3)


def test_drop_in_a_wall_that_makes_the_heat_agrees_with_a_numerical_solution():
    """The conduction equation with a source, solved on a grid; flux inside and loss outside as given."""
    inner, outer, k, q, lost = 3.8e-3, 4.8e-3, 14.5, 4.6e4, 90.0
    source = (q * 2 * np.pi * inner + lost) / (np.pi * (outer**2 - inner**2))

    def equations(r, y):
        return np.stack([y[1], -source / k - y[1] / r])

    def ends(a, b):
        return np.array([a[0] - 600.0, b[1] + lost / (2 * np.pi * outer * k)])

    r = np.linspace(inner, outer, 50)
    solution = solve_bvp(equations, ends, r, np.stack([np.full(50, 600.0), np.zeros(50)]), tol=1e-10)
    assert k * solution.y[1, 0] == pytest.approx(q, rel=1e-8)
    found = wall_temperature_drop(q, inner, outer, k, lost)
    assert found == pytest.approx(solution.y[0, -1] - 600.0, rel=1e-7)
    # all of it through the wall, as the source has it, would cause nearly twice as much
    through = wall_temperature_drop(q, inner, outer, k, heating="conducted")
    assert through / wall_temperature_drop(q, inner, outer, k) == pytest.approx(1.856, rel=1e-3)


@pytest.mark.parametrize("ratio", [1e-12, 1e-8, 1e-4, 0.02, 0.051, 0.3, 3.0, 1e4])
def test_drop_keeps_its_digits_for_any_wall(ratio):
    inner = 3.8e-3
    outer = inner * (1.0 + ratio)
    with mpmath.workdps(60):
        a, b = mpmath.mpf(inner), mpmath.mpf(outer)
        log = mpmath.log(b / a)
        generated = 1000 * a / mpmath.mpf("14.5") * (b * b * log / (b * b - a * a) - mpmath.mpf(1) / 2)
        conducted = 1000 * a / mpmath.mpf("14.5") * log
    assert wall_temperature_drop(1000.0, inner, outer) == pytest.approx(float(generated), rel=1e-12)
    assert wall_temperature_drop(1000.0, inner, outer, heating="conducted") == pytest.approx(
        float(conducted), rel=1e-12
    )


def test_no_wall_no_drop():
    assert wall_temperature_drop(1000.0, 3.8e-3, 3.8e-3) == 0.0


def test_regressed_wall_temperature_is_a_straight_line_with_the_prediction_error():
    z = np.array([0.4, 0.6, 0.8, 1.0, 1.2])
    np.testing.assert_allclose(regressed_wall_temperature(z, 350.0 + 60.0 * z, [0.5, 1.26], 0.3).value, [380.0, 425.6])
    assert regressed_wall_temperature(z, 350.0 + 60.0 * z, 0.5, 0.3).error == pytest.approx(0.3)
    rng, scatter = np.random.default_rng(6), 0.4
    misses, stated = [], []
    for _ in range(4000):
        found = regressed_wall_temperature(z, 350.0 + 60.0 * z + rng.normal(size=5) * scatter, 1.1)
        misses.append(found.value - (416.0 + rng.normal() * scatter))
        stated.append(found.error**2)
    assert np.mean(np.square(misses)) == pytest.approx(np.mean(stated), rel=0.08)
    assert found.degrees_of_freedom == 3


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: Insulation(R_O, [R_CER, R_O], [0.1, 0.1]), "expected them to increase"),
        (lambda: Insulation(R_O, [R_CER], [0.1, 0.1]), "expected one of each for every layer"),
        (lambda: Insulation(R_O, [R_CER], [0.0]), "conductivities is 0"),
        (lambda: INSULATION.loss(0.0, 400.0, 300.0), "length is 0 m"),
        (lambda: INSULATION.loss(1.0, 400.0, -1.0), "surface_temperature is -1 K"),
        (lambda: wall_heat_flux(10.0, 12.0, 1e-3, 1.0), "loss is 12 W of a power of 10 W"),
        (lambda: wall_heat_flux([10.0, 5.0], [1.0, 12.0], 1e-3, 1.0), "loss is 12 W of a power of 5 W"),
        (lambda: electrical_power(-1.0, 2.0), "voltage is -1 V"),
        (lambda: wall_temperature_drop(1.0, 2e-3, 1e-3), "outer_radius is 0.001 m"),
        (lambda: wall_temperature_drop(1.0, 1e-3, 2e-3, heating="magic"), "heating is 'magic'"),
        (lambda: wall_temperature_drop(np.nan, 1e-3, 2e-3), "heat_flux is nan"),
        (lambda: regressed_wall_temperature([0.1, 0.2], [300.0, 301.0], 0.3), "three or more positions"),
    ],
)
def test_refusals(call, match):
    with pytest.raises(ValueError, match=match):
        call()
