import math
import warnings

import numpy as np
import pytest

from bedrad.heat import RangeWarning, half_space, slurry
from bedrad.heat.slurry import POLYSTYRENE, WATER

PIPE, PARTICLE = 0.03, 0.85e-3
SLOWEST, FASTEST = (Re * 1e-3 / (999.0 * PIPE) for Re in (4500.0, 14000.0))


@pytest.fixture(autouse=True)
def _below_dittus_boelter():
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Dittus and Boelter: reynolds", RangeWarning)
        yield


def model(velocity, alpha, **options):
    return slurry.cluster_model(velocity, PIPE, PARTICLE, alpha, POLYSTYRENE, WATER, **options)


def test_the_slower_half_of_the_experiments_is_below_dittus_and_boelter():
    with pytest.warns(RangeWarning, match="reynolds is 4500, outside the fitted range 10000 to 120000") as caught:
        model(SLOWEST, 0.05)
    assert len(caught) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model(FASTEST, 0.05)


def test_coverage_stays_within_0_and_1_and_is_continuous():
    alpha = np.linspace(0, 1, 100001)
    f = slurry.wall_coverage(alpha)
    assert (f.min(), f.max()) == (0.0, 1.0)
    assert np.all(np.diff(f) >= 0)
    assert np.all(f[alpha > slurry.FULL_COVERAGE] == 1.0)
    assert pytest.approx(0.0338, abs=5e-5) == slurry.FULL_COVERAGE
    assert slurry.wall_coverage(slurry.FULL_COVERAGE * (1 - 1e-6)) < 1.0
    # as printed, up to 0.1
    assert pytest.approx(1.493, abs=5e-4) == 3.5 * 0.1**0.37
    assert slurry.wall_coverage(0.01) == pytest.approx(3.5 * 0.01**0.37, rel=1e-14)


def test_printed_residence_time_is_diameter_over_velocity():
    assert slurry.contact_time(SLOWEST, PIPE) == pytest.approx(0.2, rel=2e-3)
    assert 1 / SLOWEST > 6  # as printed


def test_packet_is_a_half_space_without_contact_resistance():
    k, rho, c, t = 0.63, 1005.0, 3900.0, 0.2
    h = slurry.packet_coefficient(t, k, rho, c)
    # mean flux into a half-space by quadrature of k/sqrt(pi alpha t'), with t' = t x^2
    nodes, weights = np.polynomial.legendre.leggauss(10)
    x = 0.5 * (nodes + 1)
    flux = k / np.sqrt(math.pi * k / (rho * c) * t * x**2)
    assert h == pytest.approx(float(np.sum(weights * x * flux)), rel=1e-13)
    # a film in series is the form of half_space.mean_in_series
    film, k_l = 1e-4, 0.6
    number = k_l / film * math.sqrt(k / (rho * c) * t) / k
    assert slurry.packet_coefficient(t, k, rho, c, film, k_l) == pytest.approx(
        k_l / film * half_space.mean_in_series(number), rel=1e-13
    )


def test_root_of_the_print_changes_with_the_unit_of_heat():
    # measuring heat in kJ instead of J scales k and c and h by 1000 together; without c under the root it cannot
    k, rho, c, t = 0.63, 1005.0, 3900.0, 0.2
    assert slurry.packet_coefficient(t, k / 1e3, rho, c / 1e3) == pytest.approx(
        slurry.packet_coefficient(t, k, rho, c) / 1e3, rel=1e-13
    )

    def printed(k):
        return 1 / math.sqrt(math.pi * t / (4 * k * rho))

    assert printed(k / 1e3) / (printed(k) / 1e3) == pytest.approx(math.sqrt(1000))
    # the packets play the minor part that the text says with the printed root only
    stream = slurry.stream_coefficient(slurry.nusselt_dittus_boelter(4500, WATER.prandtl, warn=False), 0.6, PIPE)
    assert printed(k) == pytest.approx(63.5, abs=0.1)
    assert printed(k) < 0.1 * stream
    assert slurry.packet_coefficient(t, k, rho, c) > 4 * stream


def test_film_of_the_source_is_negligible_and_as_printed_it_would_block():
    bare = slurry.packet_coefficient(0.2, 0.63, 1005.0, 3900.0)
    assert slurry.packet_coefficient(0.2, 0.63, 1005.0, 3900.0, 1e-9, 0.6) == pytest.approx(bare, rel=1e-4)
    assert 1e-5 * bare > 1 / (PARTICLE / (1e-9 * 0.6))  # d/(delta k_l), in whatever unit


def test_dispersed_coefficient_as_printed():
    v = 0.0116
    printed = 0.6 / PARTICLE * 0.97 * (999 / 1050) ** 0.3 * (v**2 / (9.81 * PARTICLE)) ** 0.21
    assert slurry.dispersed_coefficient(PARTICLE, 0.6, 0.97, 1050 / 999, v) == pytest.approx(printed, rel=1e-13)
    assert slurry.dispersed_coefficient(PARTICLE, 0.6, 0.97, 1050 / 999, -v) == pytest.approx(printed, rel=1e-13)
    assert slurry.dispersed_coefficient(PARTICLE, 0.6, 0.97, 1.0, 0.0) == 0.0


def test_shares_add_up_and_end_in_the_liquid():
    result = model(np.array([[SLOWEST], [FASTEST]]), np.array([0.0, 0.01, 0.05, 0.3]))
    assert result.total.shape == (2, 4)
    assert result.total == pytest.approx(result.packet + result.dispersed + result.stream, rel=1e-14)
    assert result.packet[:, 0] == pytest.approx(0.0, abs=0)
    assert np.all(result.dispersed[:, 2:] == 0.0)
    # no particles: the stream is the liquid, but for the 0.27 % of the viscosity's fit
    assert result.stream[:, 0] == pytest.approx(result.liquid[:, 0], rel=2e-3)
    # but the model itself does not end there: h_l and h_s, two coefficients of the bare liquid, add up
    bare = 0.6 / PARTICLE * (999 / 1050) ** 0.3 * (0.011648**2 / (9.81 * PARTICLE)) ** 0.21
    assert result.dispersed[:, 0] == pytest.approx(bare, rel=1e-4)
    assert result.enhancement[0, 0] == pytest.approx(1.35, abs=0.01)
    assert "coverage" in str(result)


def test_claims_of_figures_7_and_8():
    alpha = np.linspace(0.002, slurry.FULL_COVERAGE, 40)
    for time in (None, 2.0):
        slow, fast = model(SLOWEST, alpha, time=time), model(FASTEST, alpha, time=time)
        # more particles at the bottom, more heat; slower flows gain more; always above the liquid
        assert np.all(np.diff(slow.enhancement) > 0)
        assert np.all(slow.enhancement > fast.enhancement)
        assert np.all(fast.enhancement > 1.0)
    # with all of the wall covered the model has nothing left that rises with the particles
    beyond = model(SLOWEST, np.linspace(0.07, 0.4, 20)).enhancement
    assert np.all(np.diff(beyond) < 0)


def test_size_of_the_enhancement_rests_on_the_time_at_the_wall():
    # D/U, the 0.2 s of the text, and 1 m over U, its formula taken by number
    assert model(SLOWEST, 0.05).enhancement == pytest.approx(5.75, abs=0.01)
    assert model(SLOWEST, 0.05, time=1.0 / SLOWEST).enhancement == pytest.approx(1.79, abs=0.01)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: slurry.wall_coverage(-0.1), "volume_fraction is -0.1"),
        (lambda: slurry.contact_time(0.0, 0.03), "velocity is 0 m/s"),
        (lambda: slurry.packet_coefficient(0.0, 0.6, 1e3, 4e3), "contact_time is 0 s"),
        (lambda: slurry.packet_coefficient(1.0, 0.6, 1e3, 4e3, -1.0), "film_thickness is -1 m"),
        (lambda: slurry.dispersed_coefficient(1e-3, 0.6, 1.0, 1.0, np.nan), "settling_velocity is nan"),
        (lambda: slurry.stream_coefficient(-1.0, 0.6, 0.03), "nusselt is -1"),
        (lambda: slurry.cluster_model(0.3, 0.03, -1e-3, 0.01, POLYSTYRENE, WATER), "particle_diameter is -0.001 m"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
