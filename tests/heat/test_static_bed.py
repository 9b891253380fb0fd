import math

import mpmath
import numpy as np
import pytest

from bedrad.heat import RangeWarning, bulk, chute, correlations, static_bed
from bedrad.heat.gas import air_conductivity

D, K_WA, K_B = 0.27e-3, 0.12, 0.30


def series_of_slabs(t, d, k_wa, k_b):
    """Two layers of half a diameter and the rest, slab by slab in 40 digits."""
    with mpmath.workdps(40):
        t, d, k_wa, k_b = (mpmath.mpf(float(x)) for x in (t, d, k_wa, k_b))
        return d / 2 / k_wa + (t - d) / k_b + d / 2 / k_wa


def test_both_equations_are_the_slabs_in_series():
    for t in (D, 1.0001 * D, 3e-3, 1.0, 1e6):
        exact = series_of_slabs(t, D, K_WA, K_B)
        assert static_bed.total_resistance(t, D, K_WA, K_B) == pytest.approx(float(exact), rel=1e-15)
        assert static_bed.total_conductivity(t, D, K_WA, K_B) == pytest.approx(float(t / exact), rel=1e-15)
        # eq. 11 as it is printed
        printed = t / K_B + D * (1 / K_WA - 1 / K_B)
        assert static_bed.total_resistance(t, D, K_WA, K_B) == pytest.approx(printed, rel=1e-14)


def test_from_the_wall_layer_alone_to_the_bulk():
    assert static_bed.total_conductivity(D, D, K_WA, K_B) == pytest.approx(K_WA, rel=1e-15)
    assert static_bed.total_conductivity(1e9, D, K_WA, K_B) == pytest.approx(K_B, rel=1e-12)
    t = np.linspace(1, 30, 30)[:, None] * 1e-3
    values = static_bed.total_conductivity(t, D, np.array([0.1, 0.2]), K_B)
    assert values.shape == (30, 2)
    assert np.all(np.diff(values, axis=0) > 0)
    # far from the plates it comes in as 1/t
    thick = np.array([1.0, 10.0, 100.0])
    lack = 1 / static_bed.total_conductivity(thick, D, K_WA, K_B) - 1 / K_B
    assert np.log10(lack[:-1] / lack[1:]) == pytest.approx([1.0, 1.0], abs=1e-6)


def test_plate_cell_gives_back_what_it_was_made_of():
    t = np.array([3e-3, 6e-3, 12e-3])
    k = static_bed.total_conductivity(t, D, K_WA, K_B)
    for errors in (None, 0.01, np.array([0.01, 0.02, 0.03])):
        fit = static_bed.fit_plate_cell(t, k, D, errors)
        assert fit.bulk_conductivity == pytest.approx(K_B, rel=1e-13)
        assert fit.wall_layer_conductivity == pytest.approx(K_WA, rel=1e-11)
        assert fit.degrees_of_freedom == 1
    assert fit.chi_squared < 1e-20
    two = static_bed.fit_plate_cell(t[:2], k[:2], D, 0.01)
    assert (two.bulk_conductivity, two.degrees_of_freedom) == (pytest.approx(K_B, rel=1e-13), 0)


def test_plate_cell_errors_against_the_spread_of_simulated_measurements():
    t, d = np.array([3e-3, 6e-3, 12e-3, 20e-3]), 1e-3
    truth = static_bed.total_conductivity(t, d, K_WA, K_B)
    error = 0.01 * truth
    rng = np.random.default_rng(5)
    count = 2000
    fits = [static_bed.fit_plate_cell(t, truth + error * rng.standard_normal(4), d, error) for _ in range(count)]
    bulk_values = np.array([fit.bulk_conductivity for fit in fits])
    walls = np.array([fit.wall_layer_resistivity for fit in fits])
    exact = static_bed.fit_plate_cell(t, truth, d, error)
    # a standard deviation of 2000 has an error of 1.6 %; four of them, and the curvature
    assert bulk_values.std() == pytest.approx(exact.bulk_error, rel=0.07)
    assert walls.std() == pytest.approx(exact.wall_layer_resistivity_error, rel=0.07)
    assert np.corrcoef(bulk_values, walls)[0, 1] == pytest.approx(exact.correlation, abs=0.04)
    assert np.mean([fit.chi_squared for fit in fits]) == pytest.approx(2.0, abs=0.2)
    # without errors the resistances count as equally good
    noisy = t / (t / truth + 3e-4 * rng.standard_normal((500, 4)))
    scatter = [static_bed.fit_plate_cell(t, k, d) for k in noisy]
    assert {round(fit.chi_squared, 9) for fit in scatter} == {2.0}
    unknown = np.sqrt(np.mean([fit.bulk_error**2 for fit in scatter]))
    assert unknown == pytest.approx(np.std([fit.bulk_conductivity for fit in scatter]), rel=0.15)


def test_wall_layer_that_noise_hides_is_not_made_up():
    # 1/k_wa below zero: the bulk stays, the layer is refused by name
    fit = static_bed.fit_plate_cell([3e-3, 6e-3, 9e-3], [0.40, 0.33, 0.31], 0.1e-3, 0.05)
    assert fit.wall_layer_resistivity < 0
    with pytest.raises(ValueError, match="do not show a wall layer"):
        _ = fit.wall_layer_conductivity
    assert "k_wa not seen" in str(fit)
    good = static_bed.fit_plate_cell([3e-3, 9e-3], static_bed.total_conductivity([3e-3, 9e-3], D, K_WA, K_B), D, 0.01)
    assert "k_b  0.3 +-" in str(good)
    assert "k_wa 0.12 +-" in str(good)


def test_cell_on_edge_is_a_rectangle_of_thickness_and_average_chord():
    x = np.linspace(-1, 1, 200001)
    chord = np.trapezoid(2 * np.sqrt(1 - x**2), x) / 2  # of a disc of radius 1
    ratio = static_bed.cell_diameter_ratio(10e-3, 50e-3, 0.27e-3)
    assert ratio == pytest.approx(2 * (10e-3 + 25e-3 * chord) / (4 * 0.27e-3), rel=1e-6)


# figure 4.6: neither the thicknesses nor the measured values nor the plates are given in the text
FITS = bulk.TABLE_2_4
SOLID = {"zirconia-silica": 2.1, "alumina-silicate": 1.76}
TEMPERATURE = 323.15


def figure_4_6(fit, thickness, plate=50e-3):
    d = fit.particle_diameter
    ratio = static_bed.cell_diameter_ratio(thickness, plate, d)
    gas = air_conductivity(TEMPERATURE)
    k_wa = chute.wall_layer_conductivity(gas, SOLID[fit.material], ratio, d, 0.0, warn=False)
    return k_wa, static_bed.total_conductivity(thickness, d, k_wa, fit.conductivity(TEMPERATURE))


@pytest.mark.parametrize("fit", FITS, ids=lambda fit: f"{fit.particle_diameter * 1e6:.0f} um")
def test_figure_4_6_total_rises_to_the_bulk_from_below(fit):
    t = np.linspace(2e-3, 30e-3, 57)
    k_wa, total = figure_4_6(fit, t)
    k_b = fit.conductivity(TEMPERATURE)
    assert np.all(np.diff(total) > 0)
    assert np.all((k_wa < 0.5 * k_b) & (total > k_wa) & (total < k_b))
    # the plates, which the text does not measure, hardly matter
    assert figure_4_6(fit, t, plate=100e-3)[1] == pytest.approx(total, rel=0.03)


def test_figure_4_6_the_correlations_are_extrapolated():
    ratio = static_bed.cell_diameter_ratio(np.array([3e-3, 10e-3, 20e-3]), 50e-3, 0.34e-3)
    assert np.all(ratio > 36.4)
    with pytest.warns(RangeWarning) as caught:
        chute.wall_layer_conductivity(0.028, 2.1, ratio, 0.34e-3, 0.0)
    assert ["diameter_ratio is" in str(caught[0].message), "velocity is 0" in str(caught[1].message)] == [True, True]
    # for a static bed phi_wa rises with A to a plateau, n_C/n_C,max falls
    A = np.linspace(7, 300, 200)
    fraction = correlations.packing_fraction(A, 0.0, 3e-4, warn=False)
    contacts = correlations.contact_ratio(A, 0.0, 3e-4, warn=False)
    assert np.all(np.diff(fraction) > 0)
    assert fraction[-1] == pytest.approx(0.43, rel=1e-4)
    assert np.all(np.diff(contacts) < 0)


@pytest.mark.parametrize("fit", FITS, ids=lambda fit: f"{fit.particle_diameter * 1e6:.0f} um")
def test_a_wall_layer_that_changes_with_the_thickness_hardly_biases_the_regression(fit):
    # eq. 11 takes k_wa as one number, the correlations let it fall with the perimeter of the cell
    t = np.array([3e-3, 8e-3, 15e-3])
    k_wa, total = figure_4_6(fit, t)
    found = static_bed.fit_plate_cell(t, total, fit.particle_diameter)
    assert found.bulk_conductivity == pytest.approx(fit.conductivity(TEMPERATURE), rel=0.01)
    assert found.wall_layer_conductivity == pytest.approx(k_wa[0], rel=0.04)


HEATER, TUBE, LENGTH = 6.35e-3, 29.0e-3, 0.2032  # the tube's wall is not given: inner radius assumed


def test_corrected_eq_9_solves_the_conduction_equation():
    r = np.linspace(HEATER, TUBE, 50)
    T = static_bed.annulus_temperature(r, 60.0, LENGTH, 0.3, TUBE, 600.0)
    assert T[-1] == 600.0
    assert np.all(np.diff(T) < 0)  # the heater is inside
    step = 1e-6 * r[1:-1]
    there = [static_bed.annulus_temperature(r[1:-1] + s * step, 60.0, LENGTH, 0.3, TUBE, 600.0) for s in (-1, 1)]
    flow = -0.3 * 2 * math.pi * r[1:-1] * LENGTH * (there[1] - there[0]) / (2 * step)
    assert flow == pytest.approx(60.0, rel=1e-6)
    # as printed, T = VI/(2 pi L k) ln(r/R_in) + T_out rises outwards, to other than T_out
    printed = 60.0 / (2 * math.pi * LENGTH * 0.3) * np.log(r / HEATER) + 600.0
    assert np.all(np.diff(printed) > 0)
    assert printed[-1] > 800


@pytest.mark.parametrize("slope", [-4e-4, 0.0, 1e-12, 3.71e-4, 1e-2])
def test_changing_conductivity_against_the_integral_of_kirchhoff(slope):
    T_out, k_out = 600.0, 0.39
    T = float(static_bed.annulus_temperature(HEATER, 60.0, LENGTH, k_out, TUBE, T_out, slope))
    with mpmath.workdps(30):
        carried = mpmath.quad(lambda x: k_out + slope * (x - T_out), [T_out, mpmath.mpf(T)])
        assert float(carried) == pytest.approx(60.0 / (2 * math.pi * LENGTH) * math.log(TUBE / HEATER), rel=1e-12)


def test_regression_gives_back_the_conductivity():
    r = np.array([9e-3, 13e-3, 18e-3, 24e-3])
    T = static_bed.annulus_temperature(r, 60.0, LENGTH, 0.3, TUBE, 600.0)
    for errors in (None, 1.0, np.array([1.0, 2.0, 2.0, 1.0])):
        fit = static_bed.fit_concentric_tube(r, T, 60.0, LENGTH, errors)
        assert fit.conductivity == pytest.approx(0.3, rel=1e-12)
    assert fit.error / fit.conductivity == pytest.approx(fit.coefficient_error / fit.coefficient, rel=1e-14)  # eq. 53
    assert fit.mean_temperature == pytest.approx(T.mean())
    assert str(fit).startswith("k_b 0.3 +-")


def test_constant_conductivity_is_a_fair_reading_of_a_changing_one():
    # 200 K across the bed, the strongest slope of Table 2.4: k_b at the mean temperature of the thermocouples
    slope, k_out, T_out = 3.71e-4, 0.281 + 3.71e-4 * 150, 423.15
    r = np.geomspace(HEATER, TUBE, 6)[1:-1]
    T = static_bed.annulus_temperature(r, 56.0, LENGTH, k_out, TUBE, T_out, slope)
    assert static_bed.annulus_temperature(HEATER, 56.0, LENGTH, k_out, TUBE, T_out, slope) - T_out > 160
    fit = static_bed.fit_concentric_tube(r, T, 56.0, LENGTH)
    assert fit.conductivity == pytest.approx(k_out + slope * (fit.mean_temperature - T_out), rel=1e-3)
    # two points: exact, the mean of a linear conductivity is the one in the middle
    two = static_bed.fit_concentric_tube(r[:2], T[:2], 56.0, LENGTH, 1.0)
    assert two.conductivity == pytest.approx(k_out + slope * (two.mean_temperature - T_out), rel=1e-12)


def test_concentric_tube_errors_against_simulated_measurements_and_the_published_bound():
    r = np.geomspace(HEATER, TUBE, 6)[1:-1]
    T = static_bed.annulus_temperature(r, 80.0, LENGTH, 0.40, TUBE, 700.0)
    error = 0.004 * (T - 273.15)  # type K, 0.4 % of the temperature; taken as a standard error
    rng = np.random.default_rng(2)
    values = [
        static_bed.fit_concentric_tube(r, T + error * rng.standard_normal(4), 80.0, LENGTH, error).conductivity
        for _ in range(2000)
    ]
    fit = static_bed.fit_concentric_tube(r, T, 80.0, LENGTH, error)
    assert np.std(values) == pytest.approx(fit.error, rel=0.07)
    # "less than 9 %" at 95 % confidence
    assert 0.02 < 2 * fit.error / fit.conductivity < 0.09


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: static_bed.total_conductivity(1e-4, D, K_WA, K_B), "thickness is 0.0001 m; expected the particle"),
        (lambda: static_bed.total_resistance(1e-2, D, 0.0, K_B), "wall_layer_conductivity is 0 W"),
        (lambda: static_bed.fit_plate_cell([3e-3, 6e-3], [0.2, 0.3], D), "2 thicknesses and conductivities are given"),
        (lambda: static_bed.fit_plate_cell([3e-3, 3e-3], [0.2, 0.3], D, 0.1), "in two places at least"),
        (lambda: static_bed.fit_plate_cell([3e-3, 6e-3], [0.2], D, 0.1), "have the shapes"),
        (lambda: static_bed.fit_plate_cell([3e-3, 6e-3], [0.2, 0.3], D, [0.1] * 3), r"shapes \(2,\), \(2,\), \(3,\)"),
        (lambda: static_bed.fit_plate_cell([3e-3, 6e-3], [0.2, 0.5], D, 0.1), "expected a positive slope, 1/k_b"),
        (lambda: static_bed.fit_plate_cell([3e-3, 6e-3], [0.2, 0.3], D, -0.1), "conductivity_error is -0.1"),
        (lambda: static_bed.cell_diameter_ratio(1e-2, 0.0, D), "plate_diameter is 0 m"),
        (
            lambda: static_bed.annulus_temperature(0.05, 1.0, 0.2, 0.3, 0.03, 300.0),
            "radius is 0.05 m; expected at most",
        ),
        (lambda: static_bed.annulus_temperature(0.01, 99.0, 0.2, 0.3, 0.03, 300.0, -1.0), "falls to 0 within the bed"),
        (lambda: static_bed.annulus_temperature(0.01, 1.0, 0.2, 0.3, 0.03, 300.0, np.nan), "conductivity_slope is nan"),
        (lambda: static_bed.fit_concentric_tube([0.01, 0.02], [300.0, 310.0], 1.0, 0.2, 1.0), "expected a fall away"),
        (lambda: static_bed.fit_concentric_tube([0.01, 0.02], [310.0, 300.0], -1.0, 0.2, 1.0), "power is -1 W"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
