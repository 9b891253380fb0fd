import math

import mpmath
import numpy as np
import pytest

from bedrad.heat import RangeWarning, bulk, chute, correlations, wall_layer

AIR, GLASS = 0.026, 1.0
POROSITIES = (0.37, 0.40)
"""Dense and usual beds of glass beads; the source gives neither these nor the conductivities nor the chutes."""


def glass_bed(porosity):
    """Bulk conductivity as the source takes it, by Zehner and Schluender."""
    return bulk.zehner_bauer_schluender(AIR, GLASS, porosity, 1e-3, 300.0, radiation=False)


def predicted_gap(diameter_ratio, particle_diameter, velocity, porosity):
    k_wa = chute.wall_layer_conductivity(AIR, GLASS, diameter_ratio, particle_diameter, velocity, warn=False)
    return chute.gap_ratio(AIR, k_wa, glass_bed(porosity))


def exact_nusselt(peclet, gap, d, L, k_b, k_g, local=False):
    with mpmath.workdps(80):
        inputs = [mpmath.mpf(float(x)) for x in (peclet, gap, d, L, k_b, k_g)]
        Pe, chi, d, L, k_b, k_g = inputs
        contact = k_g * L / (chi * d * k_b)
        B = contact / mpmath.sqrt(Pe)
        e = mpmath.exp(B * B) * mpmath.erfc(B)
        return float(contact * (e if local else (e - 1 + 2 * B / mpmath.sqrt(mpmath.pi)) / B**2))


@pytest.mark.parametrize("local", [False, True])
@pytest.mark.parametrize("peclet", [1e-6, 1.0, 1e3, 1e6, 1e12])
@pytest.mark.parametrize("gap", [1e-4, 0.085, 0.5])
def test_exact_form_against_80_digits(peclet, gap, local):
    inputs = peclet, gap, 1.35e-3, 0.0254, 0.18, 0.026
    assert chute.nusselt_half_space(*inputs, local=local) == pytest.approx(
        exact_nusselt(*inputs, local=local), rel=1e-13
    )


def test_corrected_eq_43_is_a_number_between_its_two_limits():
    d, L, k_b, k_g = 0.33e-3, 0.0254, 0.18, 0.026
    # without a gas layer, the plug of a continuum
    assert chute.nusselt_in_series(1e4, 0.0, d, L, k_b, k_g) == pytest.approx(2 / math.sqrt(math.pi) * 100, rel=1e-14)
    assert chute.nusselt_half_space(1e4, 0.0, d, L, k_b, k_g) == pytest.approx(2 / math.sqrt(math.pi) * 100, rel=1e-14)
    # a flow so fast that only the gas layer resists
    contact = k_g / (0.085 * d) * L / k_b
    assert chute.nusselt_in_series(1e30, 0.085, d, L, k_b, k_g) == pytest.approx(contact, rel=1e-12)
    # the same in other units of length: the printed form, k_g L over the two terms, would be a thousand times as large
    for nusselt in (chute.nusselt_in_series, chute.nusselt_half_space):
        in_mm = nusselt(1e4, 0.085, 1e3 * d, 1e3 * L, k_b, k_g)
        assert in_mm == pytest.approx(nusselt(1e4, 0.085, d, L, k_b, k_g), rel=1e-14)

    def printed(d, L):
        return k_g * L / (0.085 * d * k_b + 0.5 * math.sqrt(math.pi) / 100)

    assert printed(1e3 * d, 1e3 * L) / printed(d, L) > 600


def test_forms_part_as_the_half_space_says():
    inputs = np.logspace(0, 8, 50), 0.085, 1.35e-3, 0.0254, 0.18, 0.026
    B = chute.contact_number(*inputs)
    ratio = chute.nusselt_in_series(*inputs) / chute.nusselt_half_space(*inputs)
    assert ratio - 1 == pytest.approx(chute.in_series_error(B), rel=1e-10)
    assert pytest.approx(0.026 / (0.085 * 1.35e-3) * math.sqrt(1e-7 * 0.0254 / 0.3) / 0.18, rel=1e-13) == (
        chute.contact_number(chute.peclet_number(0.3, 0.0254, 1e-7), *inputs[1:])
    )


@pytest.mark.parametrize("nusselt", [chute.nusselt_in_series, chute.nusselt_half_space])
def test_local_number_is_the_slope_of_the_heat_taken_up(nusselt):
    def heat(L):
        return nusselt(1e4 * L / 0.02, 0.085, 1e-3, L, 0.18, 0.026)  # h L/k_b, the heat from 0 to L

    step = 1e-5
    slope = (heat(0.02 * (1 + step)) - heat(0.02 * (1 - step))) / (2 * step)
    assert nusselt(1e4, 0.085, 1e-3, 0.02, 0.18, 0.026, local=True) == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize("local", [False, True])
@pytest.mark.parametrize("nusselt", [chute.nusselt_in_series, chute.nusselt_half_space])
def test_extremes_without_warning(nusselt, local):
    peclet = np.array([5e-324, 1e-300, 1.0, 1e300])[:, None]
    gap = np.array([0.0, 1e-300, 0.085, 1e6])
    values = nusselt(peclet, gap, 1e-3, 0.1, 0.18, 0.026, local=local)
    assert values.shape == (4, 4)
    assert np.all(np.isfinite(values) & (values > 0))
    ends = 1.0 / math.sqrt(math.pi) * np.sqrt(peclet[:, 0]) * (1.0 if local else 2.0)
    assert values[:, 0] == pytest.approx(ends, rel=1e-14)


def test_modified_diameter_ratio():
    assert chute.modified_diameter_ratio(math.pi * 7.75e-3, 3e-4, "cylinder") == pytest.approx(7.75 / 0.3, rel=1e-14)
    assert chute.modified_diameter_ratio([0.12, 0.24], 3e-3) == pytest.approx([10, 20], rel=1e-14)
    with pytest.raises(ValueError, match="shape is 'slot'"):
        chute.modified_diameter_ratio(0.1, 1e-3, "slot")


def test_gas_layer_and_rest_of_bulk_resist_as_half_a_diameter_of_wall_layer():
    gas, wall, bed = 0.026, np.array([0.026, 0.05, 0.1, 0.18]), 0.18
    gap = chute.gap_ratio(gas, wall, bed)
    assert gap / gas + (0.5 - gap) / bed == pytest.approx(0.5 / wall, rel=1e-14)
    assert chute.wall_layer_of_gap(gap, gas, bed) == pytest.approx(wall, rel=1e-14)
    assert gap[[0, -1]] == pytest.approx([0.5, 0.0], abs=1e-16)


def test_chute_layer_is_eq_45_but_for_its_rounding():
    d, A, U = 1.35e-3, 25.0, 0.05
    contacts = correlations.contact_ratio(A, U, d) * correlations.maximum_contacts(A, d)
    area = math.pi * (d / 2) ** 2 * contacts
    bracket = 3 * (1 - 0.5 / A) * correlations.packing_fraction(A, U, d) - 2 * area
    K = GLASS / AIR
    factors = 2 * wall_layer.contact_factor(K) - 1, 2 * wall_layer.no_contact_factor(K) - 0.95
    printed = AIR * (1 + area * factors[0] + 0.74 * bracket * factors[1])
    assert chute.wall_layer_conductivity(AIR, GLASS, A, d, U) == pytest.approx(printed, rel=2e-4)


# figures 4.4 and 4.5: the text says neither what the chutes measure nor what the glass conducts. If both sizes of beads
# ran in one chute, 1.35 mm inside the range of the correlations means a perimeter of 70 to 197 mm.
PERIMETERS = np.linspace(4 * 12.9 * 1.35e-3, 4 * 36.4 * 1.35e-3, 9)


def test_figure_4_4_small_beads_lie_well_outside_the_correlations():
    ratio = chute.modified_diameter_ratio(PERIMETERS, 0.33e-3)
    assert np.all(ratio > 1.4 * 36.4)
    with pytest.warns(RangeWarning, match="12.9 to 36.4"):
        chute.wall_layer_conductivity(AIR, GLASS, ratio, 0.33e-3, 0.02)


@pytest.mark.parametrize("porosity", POROSITIES)
def test_figure_4_4_gas_layer_of_1_35_mm_beads_is_the_fitted_one(porosity):
    gap = predicted_gap(PERIMETERS[:, None] / (4 * 1.35e-3), 1.35e-3, np.array([0.002, 0.02, 0.05]), porosity)
    assert gap == pytest.approx(chute.SULLIVAN_SABERSKY_GAP, rel=0.2)
    assert gap.mean() == pytest.approx(chute.SULLIVAN_SABERSKY_GAP, rel=0.12)


@pytest.mark.parametrize("porosity", POROSITIES)
def test_figure_4_4_gas_layer_of_0_33_mm_beads_is_slightly_thicker_and_constant(porosity):
    large = predicted_gap(PERIMETERS / (4 * 1.35e-3), 1.35e-3, 0.02, porosity)
    small = predicted_gap(PERIMETERS / (4 * 0.33e-3), 0.33e-3, 0.02, porosity)
    assert np.all((small > 1.05 * large) & (small < 1.35 * large))
    assert 1.0 < small.mean() / chute.SULLIVAN_SABERSKY_GAP < 1.2
    slow = predicted_gap(PERIMETERS / (4 * 0.33e-3), 0.33e-3, 0.002, porosity)
    assert small == pytest.approx(slow, rel=0.03)


def beads_of_3_mm(velocity, diameter_ratio, gap=None):
    k_b = glass_bed(0.40)
    diffusivity = k_b / (0.60 * 2500.0 * 800.0)
    peclet = chute.peclet_number(velocity, 1.0, diffusivity)
    if gap is None:
        gap = predicted_gap(diameter_ratio, 3e-3, velocity, 0.40)
    return chute.nusselt_in_series(peclet, gap, 3e-3, 1.0, k_b, AIR)


def test_figure_4_5_fitted_gap_rises_forever_and_the_predicted_one_turns():
    U = np.linspace(0.01, 0.25, 241)
    assert np.all(np.diff(beads_of_3_mm(U, 20.0, gap=chute.SULLIVAN_SABERSKY_GAP)) > 0)
    for ratio in (9.0, 11.0):
        curve = beads_of_3_mm(U, ratio)
        peak = U[np.argmax(curve)]
        assert 0.07 < peak < 0.16
        assert curve[-1] < 0.96 * curve.max()


def test_figure_4_5_both_agree_below_9_cm_s():
    U = np.array([0.01, 0.03, 0.06, 0.09])
    for ratio in (10.0, 12.9, 20.0, 36.4):
        fixed = beads_of_3_mm(U, ratio, gap=chute.SULLIVAN_SABERSKY_GAP)
        assert beads_of_3_mm(U, ratio) == pytest.approx(fixed, rel=0.08)


def test_hydraulic_diameter_can_give_a_negative_number_of_particles():
    # a slot of 10 mm x 70 mm: by the perimeter inside the limit of 6.79 for beads of 3 mm, by 4 area/perimeter not
    perimeter, hydraulic = 0.16, 4 * 0.7e-3 / 0.16
    assert chute.wall_layer_conductivity(AIR, GLASS, perimeter / (4 * 3e-3), 3e-3, 0.0, warn=False) > AIR
    assert hydraulic / 3e-3 < 6.79
    with pytest.raises(ValueError, match="negative number of no-contact particles"):
        chute.wall_layer_conductivity(AIR, GLASS, hydraulic / 3e-3, 3e-3, 0.0, warn=False)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: chute.nusselt_half_space(-1.0, 0.085, 1e-3, 0.1, 0.2, 0.03), "peclet is -1"),
        (lambda: chute.nusselt_in_series(10.0, -0.1, 1e-3, 0.1, 0.2, 0.03), "gap_ratio is -0.1"),
        (lambda: chute.nusselt_in_series(10.0, 0.1, 0.0, 0.1, 0.2, 0.03), "particle_diameter is 0 m"),
        (lambda: chute.peclet_number(0.1, 0.1, 0.0), "bulk_diffusivity is 0 m2/s"),
        (lambda: chute.gap_ratio(0.03, 0.02, 0.2), "wall_layer_conductivity is 0.02 .* expected a value from"),
        (lambda: chute.gap_ratio(0.03, [0.1, 0.3], 0.2), "wall_layer_conductivity is 0.3 .* to bulk_conductivity, 0.2"),
        (lambda: chute.gap_ratio(0.03, 0.03, 0.03), "bulk_conductivity is 0.03 .* more than gas_conductivity"),
        (lambda: chute.wall_layer_of_gap(0.6, 0.03, 0.2), "gap_ratio is 0.6; expected at most 0.5"),
        (lambda: chute.wall_layer_of_gap(0.1, 0.3, 0.2), "bulk_conductivity is 0.2"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
