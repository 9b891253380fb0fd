"""The temperature beside a radiating wall, against extended precision, limits, and its own balance."""

import mpmath
import numpy as np
import pytest

from bedrad.heat import radiation
from bedrad.heat.wall_temperature_profile import layer_depths, linearisation_errors, wall_temperature_profile

SIGMA = 5.670374419e-8
F = np.array(radiation.WATKINS_FACTORS)


def exact_step(F, d, T, q, k_wa, k_b, x):
    """Fall across the wall layer by bisection in 60 digits: the balance of the fluxes, written out."""
    with mpmath.workdps(60):
        r, T, q, k_wa, k_b = (mpmath.mpf(v) for v in (d / 2, T, q, k_wa, k_b))

        def missing(D):
            radiated = sum(
                mpmath.mpf(Fj) * mpmath.mpf(SIGMA)
                * (T**4 - (T - D * min(mpmath.mpf(xj), 1) - q * r / k_b * max(mpmath.mpf(xj) - 1, 0)) ** 4)
                for Fj, xj in zip(F, x, strict=True)
            )  # fmt: skip
            return k_wa * D / r + radiated - q

        # no colder than absolute zero: beyond it the fourth power rises again
        low, high = (mpmath.mpf(0), min(q * r / k_wa, T)) if q > 0 else (q * r / k_wa, mpmath.mpf(0))
        for _ in range(190):
            middle = (low + high) / 2
            low, high = (middle, high) if missing(middle) < 0 else (low, middle)
        return float(low)


CASES = {
    "source": (270e-6, 1373.15, 1e5, 0.27, 0.61),
    "2 mm": (2e-3, 1373.15, 1e5, 0.27, 1.03),
    "3000 K": (270e-6, 3000.0, 1e6, 0.27, 3.0),
    "3000 K, hardly a flux": (270e-6, 3000.0, 1e-9, 0.27, 3.0),
    "3 K": (270e-6, 3.0, 0.1, 0.01, 0.02),
    "3 K, 1 mm, near absolute zero": (1e-3, 3.0, 6.0, 0.01, 0.02),
    "from the bed": (270e-6, 900.0, -1e5, 0.2, 0.5),
    "radiation alone, but for 1e-6": (270e-6, 1373.15, 1e4, 1e-6, 10.0),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("depths", ["far edge", "middle"])
def test_step_against_extended_precision(name, depths):
    d, T, q, k_wa, k_b = CASES[name]
    found = wall_temperature_profile(F, d, T, q, k_wa, k_b, depths)
    step = exact_step(F, d, T, q, k_wa, k_b, found.depths)
    assert found.wall_layer_step == pytest.approx(step, rel=1e-12)
    # the two ways that carry the flux
    assert found.conductive_flux + found.radiative_flux == pytest.approx(q, rel=1e-13)
    assert found.radiative_conductivity == pytest.approx((q - k_wa * step / (d / 2)) * d / 2 / step, rel=1e-9)


def test_radiation_is_equation_48_with_the_layers_of_the_profile():
    found = wall_temperature_profile(F, 270e-6, 1373.15, 1e5, 0.27, 0.61)
    flux = radiation.heat_flux(F, 1373.15, found.layer_temperatures)
    assert found.radiative_flux == pytest.approx(flux, rel=1e-13)
    np.testing.assert_allclose(found.at(found.depths), found.layer_temperatures, rtol=1e-15)
    # across the bulk the gradient is q/k_b
    assert (found.at(3.0) - found.at(5.0)) / 270e-6 == pytest.approx(1e5 / 0.61, rel=1e-10)
    assert found.at(0.0) == 1373.15
    assert np.shape(found.at([0.0, 0.5])) == (2,)


def test_small_fluxes_have_the_linear_limit_and_reach_it_in_first_order():
    inputs = (270e-6, 1373.15, np.array([1e2, 1e3, 1e4]), 0.27, 0.61)
    limit = wall_temperature_profile(F, 270e-6, 1373.15, 0.0, 0.27, 0.61).radiative_conductivity
    off = np.abs(wall_temperature_profile(F, *inputs).radiative_conductivity / limit - 1.0)
    np.testing.assert_allclose(np.log10(off[1:] / off[:-1]), 1.0, atol=0.02)
    # eq. 50 with the real steps, by fixed-point iteration
    k_rad = 0.0
    for _ in range(200):
        steps = 1.0 + 2.0 * np.arange(3) * (0.27 + k_rad) / 0.61
        k_rad = 4 * SIGMA * 135e-6 * 1373.15**3 * (F @ steps)
    assert limit == pytest.approx(k_rad, rel=1e-12)


def test_equal_steps_are_right_where_the_bulk_conducts_twice_as_well():
    k_rad = radiation.conductivity(F, 270e-6, 1000.0)
    errors = linearisation_errors(F, 270e-6, 1000.0, 1e-6, 0.2, 2.0 * (0.2 + k_rad))
    assert errors.equal_steps == pytest.approx(0.0, abs=1e-9)
    assert errors.total == pytest.approx(0.0, abs=1e-9)
    # and the closed form elsewhere
    j, q = np.arange(1, 4), 1e-6
    for k_b in (0.5, 1.5):
        found = linearisation_errors(F, 270e-6, 1000.0, q, 0.2, k_b)
        kappa = k_b / (0.2 + found.full)
        assert found.equal_steps == pytest.approx((F @ j) / (F @ (1 + 2 * (j - 1) / kappa)) - 1, rel=1e-8)


def test_causes_of_the_error_multiply_to_the_whole():
    T = np.array([[600.0], [1373.15]])
    for depths in ("far edge", "middle"):
        e = linearisation_errors(F, 270e-6, T, [1e3, 1e5], 0.27, 0.61, depths)
        assert e.total.shape == (2, 2)
        np.testing.assert_allclose(
            (1 + e.fourth_power) * (1 + e.equal_steps) * (1 + e.far_edge), 1 + e.total, rtol=1e-12
        )
        np.testing.assert_allclose(e.linearised / e.full - 1, e.total, rtol=1e-12)
    assert np.all(linearisation_errors(F, 270e-6, T, 1e3, 0.27, 0.61).far_edge == 0.0)


def test_where_the_temperature_of_a_layer_is_taken_matters_most():
    """0.27 mm particles at 1100 degC, 100 kW/m2: equal steps and fourth powers are 3 and 6 %, of opposite signs; the
    far edge in place of the middle is 71 %."""
    e = linearisation_errors(F, 270e-6, 1373.15, 1e5, 0.27, 0.61, "middle")
    assert e.equal_steps == pytest.approx(-0.030, abs=0.001)
    assert e.fourth_power == pytest.approx(0.058, abs=0.001)
    assert e.far_edge == pytest.approx(0.711, abs=0.001)


def test_depths():
    np.testing.assert_array_equal(layer_depths(3), [1, 3, 5])
    np.testing.assert_array_equal(layer_depths(3, "middle"), [0.5, 2, 4])
    own = wall_temperature_profile(F, 270e-6, 900.0, 1e4, 0.2, 0.5, [0.5, 2.0, 4.0])
    middle = wall_temperature_profile(F, 270e-6, 900.0, 1e4, 0.2, 0.5, "middle")
    assert np.array_equal(own.layer_temperatures, middle.layer_temperatures)


def test_prints_what_it_found():
    text = str(wall_temperature_profile(F, 270e-6, 1373.15, 1e5, 0.27, 0.61))
    assert "wall 1373.15 K, heat flux 1e+05 W/m2, of which radiation 2.587e+04" in text
    assert "layer 3: 1247.56 K at 5 radii" in text
    assert "2 walls, 3 layers" in str(wall_temperature_profile(F, 270e-6, [900.0, 1000.0], 1e4, 0.2, 0.5))
    assert "equal steps" in str(linearisation_errors(F, 270e-6, 1373.15, 1e5, 0.27, 0.61))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"heat_flux": 1e7}, r"heat_flux is 1e\+07 W/m2, which would take a layer below absolute zero"),
        ({"heat_flux": np.nan}, "heat_flux is nan"),
        ({"bulk_conductivity": 0.01}, "bulk_conductivity is 0.01 W/.m K.: radiation from the wall"),
        ({"wall_layer_conductivity": 0.0}, "wall_layer_conductivity is 0"),
        ({"depths": "centre"}, "depths is 'centre'; expected"),
        ({"depths": [1.0, 2.0]}, r"depths have the shape \(2,\); expected one a layer, \(3,\)"),
        ({"depths": [-1.0, 2.0, 3.0]}, "depth is -1 particle radii"),
        ({"factors_to_layers": [0.9, 0.2, 0.1]}, "view factors sum to 1.2"),
    ],
)
def test_refuses_what_has_no_meaning(change, message):
    good = {
        "factors_to_layers": F, "particle_diameter": 270e-6, "wall_temperature": 1373.15, "heat_flux": 1e5,
        "wall_layer_conductivity": 0.27, "bulk_conductivity": 0.61,
    }  # fmt: skip
    with pytest.raises(ValueError, match=message):
        wall_temperature_profile(**(good | change))


def test_refuses_to_compare_without_a_flux_or_without_a_layer():
    with pytest.raises(ValueError, match="heat_flux is 0 W/m2"):
        linearisation_errors(F, 270e-6, 1373.15, 0.0, 0.27, 0.61)
    with pytest.raises(ValueError, match="layers is 0"):
        layer_depths(0)
