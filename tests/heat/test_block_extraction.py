import math
from dataclasses import replace

import numpy as np
import pytest

from bedrad.heat import block_and_bed
from bedrad.heat.block_extraction import BlockOnBed, coefficient_from_drop, solve_coefficient, temperature

# aluminium block of Adepu et al. (Table 2) at 70 C, a bed of glass of 20 C with the conductivity of Zehner and Bauer
ALUMINIUM = BlockOnBed(
    block_length=0.08,
    block_conductivity=167.0,
    block_density=2700.0,
    block_specific_heat=896.0,
    bed_depth=0.05,
    bed_conductivity=0.184,
    bed_density=0.58 * 2500.0,
    bed_specific_heat=795.0,
    base_temperature=343.15,
    face_temperature=343.15,
    bed_temperature=293.15,
)
TIMES = np.array([0.05, 0.2, 1.0, 3.0])


def half_spaces(system, h, time, depth):
    block = block_and_bed.effusivity(system.block_conductivity, system.block_density, system.block_specific_heat)
    bed = block_and_bed.effusivity(system.bed_conductivity, system.bed_density, system.bed_specific_heat)
    diffusivity = system.block_conductivity / (system.block_density * system.block_specific_heat)
    fall = block_and_bed.half_space_drop(time, depth, h, block, bed, diffusivity)
    return system.face_temperature - (system.face_temperature - system.bed_temperature) * fall


@pytest.mark.parametrize("h", [1.0, 1e3, 1e7])
def test_short_times_are_those_of_half_spaces(h):
    for depth in (0.0, 2e-3, 5e-3):
        found = temperature(ALUMINIUM, h, TIMES, depth, cells=300)
        assert found == pytest.approx(half_spaces(ALUMINIUM, h, TIMES, depth), abs=4e-5)


def test_second_order_in_the_cells():
    # the bed is deep and the block long enough that half-spaces are exact to rounding after 0.1 s
    exact = float(half_spaces(ALUMINIUM, 1e3, 0.1, 2e-3))
    errors = np.array([abs(float(temperature(ALUMINIUM, 1e3, 0.1, 2e-3, cells=n)) - exact) for n in (40, 80, 160)])
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < 1e-3


def test_long_times_reach_the_steady_profile():
    system = replace(ALUMINIUM, face_temperature=330.0)
    h = 200.0
    flux = 50.0 / (0.08 / 167.0 + 1 / h + 0.05 / 0.184)
    for depth in (0.0, 1e-6, 0.03, 0.0799, 0.08):
        steady = 343.15 - flux * (0.08 - depth) / 167.0
        assert temperature(system, h, 1e7, depth) == pytest.approx(steady, abs=1e-9)


def test_the_start_is_a_straight_line():
    system = replace(ALUMINIUM, face_temperature=330.0)
    for depth in (1e-3, 0.04, 0.079):
        assert temperature(system, 1e-9, 0.0, depth) == pytest.approx(330.0 + 13.15 * depth / 0.08, abs=1e-9)


def test_a_block_that_conducts_well_hands_on_the_heat_of_its_base():
    system = replace(ALUMINIUM, block_length=5e-3, block_conductivity=2000.0)
    bed = block_and_bed.effusivity(0.184, 0.58 * 2500.0, 795.0)
    h, t = 500.0, 5.0
    flux = 50.0 * h * float(block_and_bed.contact_flux(t, h, math.inf, bed))
    # its profile follows the flux after L^2/alpha = 0.03 s
    assert 343.15 - temperature(system, h, t) == pytest.approx(flux * 5e-3 / 2000.0, rel=5e-3)


def test_refuses_a_block_in_which_rounding_would_show():
    with pytest.raises(ValueError, match="cells is 100; expected fewer, or a block that conducts less"):
        temperature(replace(ALUMINIUM, block_length=1e-3, block_conductivity=1e6), 500.0, 1.0)


@pytest.mark.parametrize("h", [50.0, 1000.0, 20000.0])
def test_extraction_returns_what_made_the_drop(h):
    drop = 343.15 - float(temperature(ALUMINIUM, h, 0.2, 2e-3))
    found = coefficient_from_drop(ALUMINIUM, drop, 0.2, 2e-3)
    assert found.coefficient == pytest.approx(h, rel=1e-7)
    assert found.standard_error == 0.0


def test_uncertainty_is_the_scatter_of_extractions():
    rng = np.random.default_rng(2)
    capacity, bed, h, t = 0.01 * 2700 * 896, 460.0, 1000.0, 2.0

    def model(value, p):
        return float(block_and_bed.lumped_block_drop(p["time"], value, p["capacity"], p["bed"]))

    known = {"time": t, "capacity": capacity, "bed": bed}
    drop = model(h, known)
    errors = {"capacity": 0.01, "bed": 0.02}
    found = solve_coefficient(model, drop, 0.01 * drop, known, errors)
    assert found.coefficient == pytest.approx(h, rel=1e-9)
    assert found.standard_error == pytest.approx(math.hypot(*found.budget.values()), rel=1e-12)
    scattered = []
    for _ in range(200):
        changed = {**known, **{name: known[name] * (1 + e * rng.standard_normal()) for name, e in errors.items()}}
        seen = drop * (1 + 0.01 * rng.standard_normal())
        scattered.append(solve_coefficient(model, seen, 0.0, changed).coefficient)
    # 200 values give a standard deviation to 5 %
    assert np.std(scattered) == pytest.approx(found.standard_error, rel=0.2)
    assert "by bed" in str(found)


def test_a_drop_in_proportion_to_h_has_sensitivity_one():
    found = solve_coefficient(lambda h, p: h * p["c"], 5.0, 0.5, {"c": 0.01}, {"c": 0.1})
    assert found.coefficient == pytest.approx(500.0, rel=1e-9)
    assert found.sensitivity == pytest.approx(1.0, rel=1e-6)
    assert found.budget == pytest.approx({"measured": 50.0, "c": 50.0}, rel=1e-5)


def test_what_the_drop_after_one_second_knows_of_h():
    """With h of 1000 W/(m2 K) the bed resists more than the contact after 1 s: sensitivity 0.28, and 0.52 at 0.2 s."""
    late, early = (
        coefficient_from_drop(
            ALUMINIUM, 343.15 - float(temperature(ALUMINIUM, 1e3, t, 2e-3)), t, 2e-3, 0.05, {"bed_conductivity": 0.1}
        )
        for t in (1.0, 0.2)
    )
    assert late.sensitivity == pytest.approx(0.28, abs=0.01)
    assert early.sensitivity == pytest.approx(0.52, abs=0.01)
    assert late.budget["bed_conductivity"] > 2 * early.budget["bed_conductivity"]
    # 0.05 K on the drop is a quarter of h: the stated +-0.2 K of a thermistor tells nothing without repetition
    assert late.budget["measured"] / late.coefficient == pytest.approx(0.25, abs=0.02)


def test_errors_of_the_depth_and_of_properties():
    drop = 343.15 - float(temperature(ALUMINIUM, 500.0, 0.5, 5e-3))
    found = coefficient_from_drop(ALUMINIUM, drop, 0.5, 5e-3, 0.0, {"block_conductivity": 0.02}, depth_error=2e-4)
    assert set(found.budget) == {"measured", "block_conductivity", "depth"}
    moved = [coefficient_from_drop(ALUMINIUM, drop, 0.5, 5e-3 + x).coefficient for x in (-2e-4, 2e-4)]
    assert found.budget["depth"] == pytest.approx((moved[1] - moved[0]) / 2, rel=0.02)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: replace(ALUMINIUM, bed_depth=0.0), "bed_depth is 0"),
        (lambda: replace(ALUMINIUM, bed_depth=[1.0, 2.0]), r"bed_depth has shape \(2,\); expected one number"),
        (lambda: temperature(ALUMINIUM, 0.0, 1.0), "coefficient is 0"),
        (lambda: temperature(ALUMINIUM, 1.0, -1.0), "time is -1 s"),
        (lambda: temperature(ALUMINIUM, 1.0, 1.0, 0.1), r"depth is 0\.1 m"),
        (lambda: temperature(ALUMINIUM, 1.0, 1.0, cells=3), "cells is 3; expected a whole number from 8 to 2000"),
        (lambda: coefficient_from_drop(ALUMINIUM, 40.0, 1.0, 1e-3), "measured is 40; expected between"),
        (lambda: coefficient_from_drop(ALUMINIUM, -1.0, 1.0, 1e-3), "measured is -1"),
        (lambda: coefficient_from_drop(ALUMINIUM, 0.5, 0.0, 1e-3), "time is 0 s"),
        (lambda: coefficient_from_drop(ALUMINIUM, 0.5, 1.0, 1e-3, 0.0, {"bed": 0.1}), "relative_errors names 'bed'"),
        (
            lambda: coefficient_from_drop(ALUMINIUM, 0.5, 1.0, 1e-3, 0.0, {"bed_temperature": 0.1}),
            "expected a quantity that is no temperature",
        ),
        (lambda: coefficient_from_drop(ALUMINIUM, 0.5, 1.0, 0.0, 0.0, {}, 1e-3), "depth is 0 m"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
