import mpmath
import numpy as np
import pytest

from bedrad.heat import RangeWarning, slurry
from bedrad.heat.slurry import POLYSTYRENE, WATER

PIPE, LENGTH = 0.03, 2.5
BETA = POLYSTYRENE.density / WATER.density


def velocity(reynolds):
    return reynolds * WATER.viscosity / (WATER.density * PIPE)


def test_eq_16_as_printed():
    for Re, Pr, d_D, alpha, beta in ((4500, 7.0, 0.35 / 30, 0.01, 1.051), (14e3, 6.0, 0.85 / 30, 0.07, 1.051)):
        with mpmath.workdps(30):
            exponents = ("0.71", "0.68", "0.12", "-0.07", "-1.2")
            printed = mpmath.mpf("0.077")
            for base, exponent in zip((Re, Pr, d_D, alpha, beta), exponents, strict=True):
                printed *= mpmath.mpf(base) ** mpmath.mpf(exponent)
        assert slurry.nusselt_scelzo(Re, Pr, 1 / d_D, alpha, beta) == pytest.approx(float(printed), rel=1e-14)


@pytest.mark.parametrize(
    ("change", "range_"),
    [
        ({"reynolds": 2900.0}, "3000 to 140000"),
        ({"reynolds": 150e3}, "3000 to 140000"),
        ({"prandtl": 2.0}, "2.1 to 7"),
        ({"prandtl": 7.1}, "2.1 to 7"),
        ({"diameter_ratio": 13.0}, "14 to 1050"),
        ({"diameter_ratio": 1100.0}, "14 to 1050"),
        ({"volume_fraction": 0.11}, "0 to 0.1"),
    ],
)
def test_ranges_of_eq_16(change, range_):
    inside = {"reynolds": 1e4, "prandtl": 6.0, "diameter_ratio": 85.7, "volume_fraction": 0.03, "density_ratio": BETA}
    slurry.nusselt_scelzo(**inside)
    with pytest.warns(RangeWarning, match=range_):
        slurry.nusselt_scelzo(**(inside | change))


def test_what_eq_16_says_of_the_experiments():
    Re = np.array([4500.0, 9000.0, 14000.0])[:, None]
    alpha = np.array([0.01, 0.03, 0.07])
    clear = slurry.nusselt_dittus_boelter(Re, WATER.prandtl, warn=False)
    for d in (0.35e-3, 0.85e-3):
        gain = slurry.nusselt_scelzo(Re, WATER.prandtl, PIPE / d, alpha, BETA) / clear
        # always above the liquid; but less so with more particles, by 7^-0.07
        assert np.all((gain > 1.6) & (gain < 2.4))
        assert gain[:, -1] / gain[:, 0] == pytest.approx(7**-0.07, rel=1e-12)
    # heavy particles at the same alpha: below the liquid, which no experiment here says
    assert slurry.nusselt_scelzo(1e4, WATER.prandtl, 85.7, 0.03, 2.5) < 0.7 * clear[1, 0]


# figure 5: Re about 10000, alpha, particle diameter [mm], a number "N_e" in the caption, and what was seen
FIGURE_5 = [
    (0.01, 0.85, 130, "heterogeneous"),
    (0.05, 0.85, 60, "moving bed"),
    (0.01, 0.35, 410, "homogeneous"),
    (0.05, 0.35, 200, "homogeneous"),
]


def test_modified_froude_number_of_figure_5():
    froude = [slurry.modified_froude(velocity(1e4), 1e-3 * d, alpha, BETA) for alpha, d, _, _ in FIGURE_5]
    assert froude == pytest.approx([13.34, 13.32, 32.41, 32.34], abs=0.01)
    # a tenth of the number in the caption is Fr* of a flow within a third of that velocity
    for (_, _, number, _), value in zip(FIGURE_5, froude, strict=True):
        assert np.sqrt(number / 10 / value) == pytest.approx(1.0, abs=0.34)
    assert FIGURE_5[0][2] / 10 == pytest.approx(froude[0], rel=0.03)


def test_regimes_of_figure_5_by_a_tenth_of_its_numbers():
    suspended = slurry.fully_suspended([number / 10 for _, _, number, _ in FIGURE_5])
    assert list(suspended) == [regime != "moving bed" for _, _, _, regime in FIGURE_5]
    # the numbers as they stand would call the moving bed suspended
    assert slurry.fully_suspended(60.0)


def test_velocity_and_size_matter_most_in_the_froude_number():
    base = slurry.modified_froude(0.3, 0.5e-3, 0.03, BETA)
    assert slurry.modified_froude(0.6, 0.5e-3, 0.03, BETA) == pytest.approx(4 * base, rel=1e-14)
    assert slurry.modified_froude(0.3, 0.25e-3, 0.03, BETA) == pytest.approx(2 * base, rel=1e-14)
    assert slurry.modified_froude(0.3, 0.5e-3, 0.07, BETA) == pytest.approx(base, rel=0.003)
    for d in (0.35e-3, 0.85e-3):
        U = slurry.suspension_velocity(d, 0.03, BETA)
        assert slurry.modified_froude(U, d, 0.03, BETA) == pytest.approx(slurry.SUSPENSION_FROUDE, rel=1e-14)
        assert not slurry.fully_suspended(slurry.modified_froude(0.999 * U, d, 0.03, BETA))
    assert slurry.modified_froude(0.0, 1e-3, 0.0, BETA) == 0.0


def test_time_to_settle_over_time_in_the_pipe():
    v = slurry.settling_velocity([0.35e-3, 0.85e-3], POLYSTYRENE.density, WATER)
    ratio = slurry.settling_time_ratio(velocity(1e4), PIPE, LENGTH, v)
    assert ratio == pytest.approx((PIPE / (2 * v)) / (LENGTH / velocity(1e4)), rel=1e-14)
    # in still water both would reach the bottom on the way; the small ones are seen all over the pipe
    assert 0.5 < ratio[0] < 1.0
    assert ratio[1] < 0.2


def test_energy_balance_conserves_energy():
    mass, alpha = 0.2356, np.array([0.01, 0.05, 0.07])
    c = slurry.mixture_specific_heat(alpha, POLYSTYRENE, WATER)
    power = 4000.0
    flux = power / (np.pi * PIPE * LENGTH)
    gain = slurry.outlet_temperature_gain(flux, PIPE, LENGTH, mass, c, WATER.specific_heat)
    assert gain == pytest.approx(power / (mass * c) - power / (mass * WATER.specific_heat), rel=1e-11)
    # eq. 6 with the area that its print lacks gives the flux back, for slurry and liquid
    assert slurry.wall_heat_flux(mass, c, power / (mass * c), PIPE, LENGTH) == pytest.approx(flux, rel=1e-14)
    assert slurry.outlet_temperature_gain(flux, PIPE, LENGTH, mass, 4186.0, 4186.0) == 0.0
    # a hair of particles: no digits lost to the difference of two specific heats
    tiny = slurry.outlet_temperature_gain(flux, PIPE, LENGTH, mass, 4186.0 * (1 - 2.0**-40), 4186.0)
    assert tiny == pytest.approx(power / mass / 4186.0 * 2.0**-40, rel=1e-11)


def test_gain_of_the_experiments_is_a_fraction_of_a_kelvin():
    c = slurry.mixture_specific_heat(0.07, POLYSTYRENE, WATER)
    for Re, power in ((4500, 2300.0), (14000, 9400.0)):
        mass = Re * np.pi * PIPE * WATER.viscosity / 4
        gain = slurry.outlet_temperature_gain(power / (np.pi * PIPE * LENGTH), PIPE, LENGTH, mass, c, 4186.0)
        assert 0.2 < gain < 0.4


def test_printed_powers_and_fluxes_do_not_belong_to_the_heated_area():
    # 2.3 to 9.4 kW on 2.5 m of 30 mm are 9.8 to 39.9 kW/m2; the text has 12 to 60
    fluxes = np.array([2300.0, 9400.0]) / (np.pi * PIPE * LENGTH)
    assert fluxes == pytest.approx([9761.5, 39894.8], abs=0.1)
    assert fluxes[1] < 0.7 * 60e3


def test_uncertainty_of_the_coefficient():
    assert slurry.coefficient_uncertainty(9.0, 0.9, 4.0, 0.4) == pytest.approx(np.sqrt(0.02), rel=1e-14)
    # 20 % at 9 K by the wall alone is 1.8 K, which at 16 K is 11 %
    assert slurry.coefficient_uncertainty([9.0, 16.0], 1.8, 4.0, 0.0) == pytest.approx([0.2, 0.1125], rel=1e-14)
    # the mass flow, 0.5 %, is rightly left out
    assert slurry.coefficient_uncertainty(9.0, 1.8, 4.0, 0.1, 0.005) / slurry.coefficient_uncertainty(
        9.0, 1.8, 4.0, 0.1
    ) - 1 == pytest.approx(0.0, abs=4e-4)
    assert slurry.coefficient_uncertainty(1e200, 1e200, 1.0, 0.0) == 1.0


def test_uncertainty_against_simulated_measurements():
    rng = np.random.default_rng(3)
    wall = 9.0 + 0.3 * rng.standard_normal(200_000)
    rise = 5.0 + 0.1 * rng.standard_normal(200_000)
    h = slurry.wall_heat_flux(0.2, 4186.0, rise, PIPE, LENGTH) / wall
    # first order: the curvature of 1/wall adds 0.1 %
    assert np.std(h) / np.mean(h) == pytest.approx(slurry.coefficient_uncertainty(9.0, 0.3, 5.0, 0.1), rel=0.01)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: slurry.nusselt_scelzo(1e4, 6.0, 85.0, 0.0, 1.05), "volume_fraction is 0"),
        (lambda: slurry.nusselt_scelzo(1e4, 6.0, 85.0, 1.5, 1.05), "volume_fraction is 1.5"),
        (lambda: slurry.modified_froude(-0.1, 1e-3, 0.1, 1.05), "velocity is -0.1 m/s"),
        (lambda: slurry.fully_suspended(-1.0), "modified_froude is -1"),
        (lambda: slurry.suspension_velocity(0.0, 0.1, 1.05), "particle_diameter is 0 m"),
        (lambda: slurry.settling_time_ratio(0.1, 0.03, 2.5, 0.0), "settling_velocity is 0 m/s"),
        (lambda: slurry.wall_heat_flux(0.0, 4186.0, 1.0, 0.03, 2.5), "mass_flow is 0 kg/s"),
        (lambda: slurry.wall_heat_flux(0.1, 4186.0, np.nan, 0.03, 2.5), "rise is nan"),
        (lambda: slurry.outlet_temperature_gain(1.0, 0.03, 2.5, 0.1, -1.0, 4186.0), "specific_heat is -1"),
        (lambda: slurry.coefficient_uncertainty(0.0, 1.0, 4.0, 0.1), "wall_difference is 0 K"),
        (lambda: slurry.coefficient_uncertainty(9.0, -1.0, 4.0, 0.1), "wall_difference_error is -1 K"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
