"""Whole runs reduced: flows whose answer is known in closed form, random draws of all readings, refusals."""

from dataclasses import replace

import numpy as np
import pytest

from bedrad.heat import RangeWarning, two_layer
from bedrad.heat.measured_flow import (
    Insulation,
    Measured,
    Profile,
    Properties,
    Row,
    Run,
    Tube,
    beside_model,
    reduce_run,
    two_layer_values,
    wall_temperature_drop,
)
from bedrad.heat.systems import System

D, OUTER, FLOW, C_P, K_B, INLET = 7.614e-3, 9.53e-3, 1.63e-3, 600.0, 0.31, 320.0
R = D / 2
POWER, LENGTH = 120.0, 1.5
RADII = np.linspace(0.0, 3.5e-3, 8)
STATIONS = (0.6, 1.2)
PROPERTIES = Properties(C_P, K_B)


def continuum(position, conductivity=K_B):
    """Mean, wall and radial temperatures of a continuum plug flow, whose Nu is 8."""
    q = POWER / LENGTH / (np.pi * D)
    mean = INLET + POWER / LENGTH * position / (FLOW * C_P)
    return mean, mean + q * R / (4 * conductivity), mean + q / (2 * conductivity * R) * (RADII**2 - R**2 / 2)


def continuum_run(error=None, total=True, power_error=0.0, wall_error=0.0):
    rows = []
    for z in STATIONS:
        _, wall, across = continuum(z)
        section = None if total else Measured(POWER / LENGTH * 0.6, power_error)
        profile = Profile(RADII, across, None if error is None else np.full(RADII.size, error))
        rows.append(Row(z, Measured(wall, wall_error), profile, power=section))
    whole = (Measured(POWER, power_error), LENGTH) if total else (None, None)
    return Run("one", Measured(FLOW, 0.0), rows, Measured(INLET), *whole)


@pytest.mark.parametrize("total", [True, False])
def test_a_continuum_has_a_nusselt_number_of_eight(total):
    found = reduce_run(continuum_run(0.0, total), Tube(D), PROPERTIES)
    np.testing.assert_allclose(found.nusselt.value, 8.0, rtol=1e-10)
    np.testing.assert_allclose(found.nusselt.error, 0.0, atol=1e-9)
    np.testing.assert_allclose(found.first_law.closure, 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.z_star, np.pi * np.array(STATIONS) * K_B / (4 * FLOW * C_P), rtol=1e-14)
    assert found.mass_flux == pytest.approx(FLOW / (np.pi * R**2))
    assert "Nu 8.00 ± 0.00" in str(found)


def test_losses_and_the_wall_are_taken_off():
    """The flow gets what it got, the power is larger by the losses, and the outside of the wall is the hotter."""
    insulation = Insulation(OUTER / 2, [0.03, 0.1], [0.09, 0.05])
    inside = np.array([continuum(z)[1] for z in STATIONS])
    outside = inside
    for _ in range(30):
        means = np.array([outside[0], outside.mean()])
        lost = insulation.loss(0.6, means, 300.0).value
        outside = inside + wall_temperature_drop(POWER / LENGTH / (np.pi * D), R, OUTER / 2, loss_per_length=lost / 0.6)
    power = POWER / LENGTH * 0.6 + lost
    rows = [
        Row(z, Measured(outside[k]), Profile(RADII, continuum(z)[2]), None, Measured(power[k]), None, Measured(300.0))
        for k, z in enumerate(STATIONS)
    ]
    run = Run("one", Measured(FLOW), rows, Measured(INLET))
    insulated = Tube(D, OUTER, insulation=insulation)
    found = reduce_run(run, insulated, PROPERTIES, flux="section")
    np.testing.assert_allclose(found.nusselt.value, 8.0, rtol=1e-10)
    np.testing.assert_allclose(found.loss.value, lost, rtol=1e-12)
    np.testing.assert_allclose(found.first_law.closure, 1.0, rtol=1e-12)
    # just at the stations the wall of the second section is hotter than on the mean, and loses more
    local = reduce_run(run, insulated, PROPERTIES)
    flux = (power / 0.6 - insulation.loss(1.0, outside, 300.0).value) / (np.pi * D)
    np.testing.assert_allclose(local.heat_flux.value, flux, rtol=1e-12)
    assert local.heat_flux.value[1] < 0.98 * found.heat_flux.value[1]
    np.testing.assert_allclose(local.first_law.closure, 1.0, rtol=1e-12)
    # losses stated in the table count in place of the insulation
    stated = [replace(row, loss=Measured(lost[k])) for k, row in enumerate(rows)]
    again = reduce_run(replace(run, rows=stated), Tube(D, OUTER), PROPERTIES)
    np.testing.assert_allclose(again.nusselt.value, 8.0, rtol=1e-10)


def test_loss_follows_the_wall_temperature_along_the_section():
    """Linear readings between positions, constant outside: the mean over a section by hand."""
    insulation = Insulation(OUTER / 2, [0.1], [0.06])
    rows = [
        Row(0.2, Measured(340.0, 1.0), surface_temperature=Measured(300.0)),
        Row(0.6, Measured(380.0, 2.0), mean_temperature=Measured(345.0), power=Measured(50.0)),
    ]
    found = reduce_run(Run("one", Measured(FLOW), rows), Tube(D, OUTER, insulation=insulation), PROPERTIES)
    weights = np.array([0.2 + 0.2, 0.2]) / 0.6
    mean = Measured(weights @ [340.0, 380.0], np.linalg.norm(weights * [1.0, 2.0]))
    expected = insulation.loss(0.6, mean, 300.0)
    assert found.loss.value[0] == pytest.approx(expected.value, rel=1e-12)
    assert found.loss.error[0] == pytest.approx(expected.error, rel=1e-12)
    assert found.first_law is None


def test_heat_conducted_through_the_wall_drops_by_its_resistance():
    run = continuum_run(0.1)
    one, two = (reduce_run(run, Tube(D, OUTER, heating=heating), PROPERTIES) for heating in ("generated", "conducted"))
    q = POWER / LENGTH / (np.pi * D)
    lower = continuum(0.6)[1] - two.wall_temperature.value[0]
    assert lower == pytest.approx(q * R * np.log(OUTER / D) / 14.5, rel=1e-9)
    assert one.heat_transfer_coefficient.value[0] < two.heat_transfer_coefficient.value[0]


def test_stated_errors_agree_with_random_draws_of_all_readings():
    sigma, wall_error, power_error, flow_error, inlet_error, tolerance, k_error = 0.2, 0.3, 0.9, 1e-5, 0.2, 2e-3, 0.03
    run = continuum_run(sigma, power_error=power_error, wall_error=wall_error)
    run = replace(run, mass_flow=Measured(FLOW, flow_error), inlet_temperature=Measured(INLET, inlet_error))
    stated = reduce_run(run, Tube(D), Properties(C_P, K_B, k_error), instrument_tolerance=tolerance)
    rng = np.random.default_rng(12)

    def thermocouple(T):
        return T + (np.mean(T) - 273.15) * tolerance * rng.normal()

    h, nu, deviation = [], [], []
    for _ in range(500):
        rows = []
        for z in STATIONS:
            _, wall, across = continuum(z)
            profile = Profile(RADII, thermocouple(across) + rng.normal(size=8) * sigma, np.full(8, sigma))
            rows.append(Row(z, Measured(thermocouple(wall) + rng.normal() * wall_error, wall_error), profile))
        drawn = Run("one", Measured(rng.normal(FLOW, flow_error), flow_error), rows,
                    Measured(thermocouple(INLET) + rng.normal() * inlet_error, inlet_error),
                    Measured(rng.normal(POWER, power_error), power_error), LENGTH)  # fmt: skip
        k_b = K_B * (1 + k_error * rng.normal())
        found = reduce_run(drawn, Tube(D), Properties(C_P, k_b, k_error), instrument_tolerance=tolerance)
        h.append(found.heat_transfer_coefficient.value)
        nu.append(found.nusselt.value)
        deviation.append(found.first_law.deviation)
    # 500 draws tell a standard deviation to 3.2 %; errors of 5 % in h are not quite linear
    np.testing.assert_allclose(stated.heat_transfer_coefficient.error, np.std(h, axis=0), rtol=0.12)
    np.testing.assert_allclose(stated.nusselt.error, np.std(nu, axis=0), rtol=0.12)
    np.testing.assert_allclose(np.std(deviation, axis=0), 1.0, rtol=0.12)


def test_a_regression_misses_the_steep_profile_of_the_wall_layer():
    """Readings in the bulk only: h comes out too low by Nu (kappa - 1)(1 - W^2)^2/8, to first order."""
    A, kappa = 28.2, 2.4
    W = 1 - 1 / A
    q = POWER / LENGTH / (np.pi * D)
    nu = float(two_layer.nusselt_developed(A, kappa))
    excess = q * R / (2 * K_B) * (0.5 * W**4 + W**2 * (1 - W**2) + kappa * 0.5 * (1 - W**2) ** 2)
    rows = []
    for z in STATIONS:
        mean = continuum(z)[0]
        across = mean - excess + q / (2 * K_B * R) * RADII**2
        rows.append(Row(z, Measured(mean + q * D / (nu * K_B)), Profile(RADII, across)))
    run = Run("one", Measured(FLOW), rows, Measured(INLET), Measured(POWER), LENGTH)
    found = reduce_run(run, Tube(D), PROPERTIES)
    bias = nu * (kappa - 1) * (1 - W**2) ** 2 / 8
    assert bias == pytest.approx(0.0057, abs=2e-4)
    np.testing.assert_allclose(found.nusselt.value, nu / (1 + bias), rtol=1e-9)


def test_without_an_inlet_the_balance_starts_at_the_first_station():
    run = replace(continuum_run(0.1), inlet_temperature=None)
    found = reduce_run(run, Tube(D), PROPERTIES)
    assert found.first_law.deviation.shape == (1,)
    assert found.first_law.closure == pytest.approx(1.0)
    whole = reduce_run(continuum_run(0.1), Tube(D), PROPERTIES).first_law
    assert found.first_law.balance.error[0] > whole.balance.error[1]


def test_errors_of_one_power_add_up_and_those_of_sections_in_squares():
    one = reduce_run(continuum_run(0.1, power_error=2.5), Tube(D), PROPERTIES).first_law.heat
    np.testing.assert_allclose(one.error, 2.5 * np.array(STATIONS) / LENGTH)
    two = reduce_run(continuum_run(0.1, total=False, power_error=1.0), Tube(D), PROPERTIES).first_law.heat
    np.testing.assert_allclose(two.error, [1.0, np.sqrt(2.0)])


def test_a_missing_wall_temperature_comes_from_a_straight_line():
    walls = [Row(z, Measured(continuum(z)[1], 0.2)) for z in (0.3, 0.5, 0.9)]
    run = continuum_run(0.1)
    rows = sorted([*walls, replace(run.rows[0], wall_temperature=None), run.rows[1]], key=lambda row: row.position)
    found = reduce_run(replace(run, rows=rows), Tube(D), PROPERTIES)
    np.testing.assert_allclose(found.nusselt.value, 8.0, rtol=1e-9)
    with pytest.raises(ValueError, match=r"no wall temperature at 0.6 m, and 2 from 0.8 m on; expected three"):
        reduce_run(replace(run, rows=rows), Tube(D), PROPERTIES, developed_from=0.8)


def test_the_model_beside_a_run_is_the_two_layer_model():
    found = reduce_run(continuum_run(0.1), Tube(D), PROPERTIES)
    (model,) = beside_model([found], D, 270e-6, 2386.0, 2.1)
    assert model.velocity == pytest.approx(FLOW / (2386.0 * np.pi * R**2))
    system = System(D, 270e-6, model.velocity, solid_conductivity=2.1)
    values = two_layer_values(system, found.wall_temperature.value, found.mean_temperature.value, K_B, found.z_star)
    np.testing.assert_allclose(model.stations.complete, values.complete)
    kappa = model.stations.conductivity_ratio
    np.testing.assert_allclose(model.stations.developed, two_layer.nusselt_developed(system.diameter_ratio, kappa))
    np.testing.assert_allclose(values.complete, two_layer.nusselt(system.diameter_ratio, kappa, found.z_star))
    # the conductivity of the wall layer of Watkins' systems is about 0.125 W/(m K) at 80 degC
    assert K_B / kappa[0] == pytest.approx(0.128, rel=0.03)
    assert np.all(np.diff(model.curve.complete) <= 0.0)
    assert model.z_star[0] < found.z_star[0]
    assert model.z_star[-1] > found.z_star[-1]
    with pytest.raises(ValueError, match="runs is empty"):
        beside_model([], D, 270e-6, 2386.0, 2.1)


@pytest.mark.filterwarnings("ignore::bedrad.heat.RangeWarning")
def test_radiation_counts_in_the_wall_layer_when_it_is_hot():
    system = System(D, 270e-6, 0.015)
    cold, hot = two_layer_values(system, [360.0, 1373.15], [350.0, 350.0], K_B, np.inf).developed
    assert hot > 1.05 * cold


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"rows": []}, "one: no temperature of the flow"),
        ({"rows": [Row(0.6, Measured(350.0))]}, "no temperature of the flow"),
        ({"rows": [Row(0.0, Measured(350.0), mean_temperature=Measured(340.0))]}, "station lies at 0 m"),
        ({"heated_length": 1.0}, "station lies at 1.2 m; expected it within the heated length, 1 m"),
        ({"total_power": None, "heated_length": None}, "no power is given for the section that ends at 0.6 m"),
        ({"total_power": None}, "one: heated_length is given alone"),
        ({"heated_length": None}, "one: total_power is given alone"),
    ],
)
def test_refusals_of_runs(change, match):
    with pytest.raises(ValueError, match=match):
        reduce_run(replace(continuum_run(0.1), **change), Tube(D), PROPERTIES)


def test_refusals_of_tube_and_properties():
    insulated = Tube(D, OUTER, insulation=Insulation(OUTER / 2, [0.1], [0.06]))
    with pytest.raises(ValueError, match="one: no surface temperature is given"):
        reduce_run(continuum_run(0.1), insulated, PROPERTIES)
    run = continuum_run(0.1)
    with pytest.raises(ValueError, match="expected them to increase"):
        reduce_run(replace(run, rows=run.rows[::-1]), Tube(D), PROPERTIES)
    with pytest.raises(ValueError, match=r"outer_diameter is 0\.001 m; expected more than the inner_diameter"):
        Tube(D, 1e-3)
    with pytest.raises(ValueError, match=r"bulk_conductivity_error is -0\.1"):
        Properties(C_P, K_B, -0.1)
    with pytest.raises(ValueError, match="bulk_conductivity is -1"):
        reduce_run(run, Tube(D), Properties(C_P, lambda T: 0.0 * T - 1.0))
    with pytest.raises(ValueError, match="flux is 'mean'; expected one of local, section"):
        reduce_run(run, Tube(D), PROPERTIES, flux="mean")
    with pytest.raises(ValueError, match="instrument_tolerance is -1"):
        reduce_run(run, Tube(D), PROPERTIES, instrument_tolerance=-1.0)


def test_correlations_outside_their_range_warn():
    found = reduce_run(continuum_run(0.1), Tube(D), PROPERTIES)
    with pytest.warns(RangeWarning, match="diameter_ratio is 54"):
        beside_model([found], D, 140e-6, 2386.0, 2.1)
