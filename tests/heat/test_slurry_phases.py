import mpmath
import numpy as np
import pytest

from bedrad.heat import RangeWarning, slurry
from bedrad.heat.slurry import POLYSTYRENE, WATER


def test_definitions_against_the_printed_properties():
    # Table 3: beta is rho_p/rho_l, and Pr is c_p mu/k although Table 2 prints C_p k/mu, which would be 2.5 million
    assert POLYSTYRENE.density / WATER.density == pytest.approx(1.0511, abs=5e-5)
    assert WATER.prandtl == pytest.approx(4186 * 0.001 / 0.6, rel=1e-14)
    assert WATER.prandtl < 7.0  # the upper end of the range of eq. 16
    # eq. 10: rho_l/rho = 1/(1 + (beta - 1) alpha)
    for alpha in (0.0, 0.01, 0.07, 1.0):
        density = slurry.mixture_density(alpha, POLYSTYRENE.density, WATER.density)
        assert WATER.density / density == pytest.approx(1 / (1 + (1050 / 999 - 1) * alpha), rel=1e-14)


def test_heat_of_the_mixture_is_that_of_its_phases():
    alpha = np.linspace(0, 1, 11)
    density = slurry.mixture_density(alpha, POLYSTYRENE.density, WATER.density)
    by_volume = alpha * 1050 * 1339 + (1 - alpha) * 999 * 4186
    assert density * slurry.mixture_specific_heat(alpha, POLYSTYRENE, WATER) == pytest.approx(by_volume, rel=1e-14)


def test_conductivity_of_the_mixture():
    # Maxwell's spheres: both ends, no contrast, and for few particles 3 (K - 1)/(K + 2) each
    assert slurry.mixture_conductivity([0.0, 1.0], 1.33, 0.6) == pytest.approx([0.6, 1.33], rel=1e-14)
    assert slurry.mixture_conductivity(0.3, 0.6, 0.6) == pytest.approx(0.6, rel=1e-14)
    K = 1.33 / 0.6
    few = slurry.mixture_conductivity(1e-6, 1.33, 0.6) / 0.6 - 1
    assert few == pytest.approx(1e-6 * 3 * (K - 1) / (K + 2), rel=1e-5)
    # the lower bound of Hashin and Shtrikman never leaves the bounds of Wiener
    alpha = np.linspace(0.01, 0.99, 50)
    k = slurry.mixture_conductivity(alpha, 1e3, 0.6)
    assert np.all((k > 1 / (alpha / 1e3 + (1 - alpha) / 0.6)) & (k < alpha * 1e3 + (1 - alpha) * 0.6))


def test_viscosity_of_the_mixture():
    assert slurry.mixture_viscosity(0.0, 1e-3) == pytest.approx(1.00273e-3, rel=1e-14)
    slope = (slurry.mixture_viscosity(1e-6, 1.0) - slurry.mixture_viscosity(0.0, 1.0)) / 1e-6
    assert slope == pytest.approx(2.5 + 0.00273 * 16.6, rel=1e-5)  # Einstein's 2.5 and the published rest
    with pytest.warns(RangeWarning, match="0 to 0.6"):
        slurry.mixture_viscosity(0.7, 1e-3)


@pytest.mark.parametrize("diameter", [1e-9, 1e-6, 0.35e-3, 0.85e-3, 3e-3])
def test_settling_velocity_against_its_equation(diameter):
    v = slurry.settling_velocity(diameter, 1050.0, WATER)
    with mpmath.workdps(30):
        Re = 999 * mpmath.mpf(float(v)) * diameter / mpmath.mpf(1e-3)
        weight = mpmath.mpf(9.81) * diameter**3 * 999 * 51 / (18 * mpmath.mpf(1e-3) ** 2)
        assert float(Re * (1 + 0.15 * Re ** mpmath.mpf(0.687)) / weight) == pytest.approx(1.0, rel=1e-13)


def test_settling_velocity_by_size():
    # Stokes for dust; for the spheres of the experiments neither that nor the proportionality that the text names
    dust = slurry.settling_velocity(1e-7, 1050.0, WATER)
    assert dust == pytest.approx(9.81 * 51 * 1e-14 / (18 * 1e-3), rel=1e-6)
    small, large = slurry.settling_velocity([0.35e-3, 0.85e-3], 1050.0, WATER)
    assert (small, large) == (pytest.approx(2.95e-3, rel=2e-3), pytest.approx(11.65e-3, rel=2e-3))
    assert np.log(large / small) / np.log(0.85 / 0.35) == pytest.approx(1.547, abs=1e-3)


def test_light_particles_rise_and_equal_ones_stay():
    down, up, still = slurry.settling_velocity(1e-3, [1050.0, 948.0, 999.0], WATER)
    assert (up, still) == (pytest.approx(-down, rel=1e-14), 0.0)
    with pytest.warns(RangeWarning, match="0 to 800"):
        slurry.settling_velocity(0.02, 7800.0, WATER)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: slurry.mixture_density(1.1, 1050.0, 999.0), "volume_fraction is 1.1"),
        (lambda: slurry.mixture_specific_heat(-0.1, POLYSTYRENE, WATER), "volume_fraction is -0.1"),
        (lambda: slurry.mixture_conductivity(0.1, 0.0, 0.6), "particle_conductivity is 0 W"),
        (lambda: slurry.mixture_viscosity(0.1, -1.0), "liquid_viscosity is -1 Pa s"),
        (lambda: slurry.settling_velocity(0.0, 1050.0, WATER), "particle_diameter is 0 m"),
        (lambda: slurry.Liquid(999.0, 0.0, 0.6, 4186.0), "viscosity is 0 Pa s"),
        (lambda: slurry.Particles(1050.0, 1.3, -1.0), "specific_heat is -1"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
