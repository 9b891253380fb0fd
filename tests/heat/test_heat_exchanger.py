import math

import mpmath
import numpy as np
import pytest

from bedrad.heat import RangeWarning
from bedrad.heat.heat_exchanger import (
    effectiveness,
    log_mean_temperature_difference,
    logarithmic_mean,
    loss_conductance,
    outlet_temperature,
    transfer_units,
)
from bedrad.heat.kopp_neumann import OXIDES

ARRANGEMENTS = ("counter", "parallel", "cross", "cross_max_mixed", "cross_min_mixed")


def deviation(got, wanted):
    return abs(float((mpmath.mpf(float(got)) - wanted) / wanted))


@pytest.mark.parametrize(
    "ratio", [0.0, 1e-15, 1e-12, 1e-8, 1e-4, 0.1, 0.9, 0.9999999, 1.0, 1.0000001, 3.0, 1e3, 1e12, 1e300]
)
@pytest.mark.parametrize("size", [1e-300, 1e-3, 17.3, 1e5])
def test_logarithmic_mean_against_mpmath(ratio, size):
    first, second = size, size * (1.0 + ratio)
    if not math.isfinite(second):
        pytest.skip("no float")
    with mpmath.workdps(60):
        a, b = mpmath.mpf(first), mpmath.mpf(second)
        wanted = a if a == b else (a - b) / mpmath.log(a / b)
    assert deviation(logarithmic_mean(first, second), wanted) < 4e-16 * 4
    assert logarithmic_mean(second, first) == logarithmic_mean(first, second)


def test_logarithmic_mean_of_equals_is_exact_and_lies_between_the_other_means():
    x = np.array([1e-300, 0.1, 1 / 3, 7.0, 1e300])
    assert np.array_equal(logarithmic_mean(x, x), x)
    a, b = np.random.default_rng(1).uniform(0.1, 10.0, (2, 100))
    mean = logarithmic_mean(a, b)
    assert np.all((np.sqrt(a * b) <= mean * (1 + 1e-15)) & (mean <= 0.5 * (a + b) * (1 + 1e-15)))


def test_logarithmic_mean_near_equal_ends_is_the_arithmetic_mean_less_a_twelfth_of_the_square():
    gaps = np.array([1e-2, 1e-3, 1e-4])
    short = 1.0 + 0.5 * gaps - logarithmic_mean(1.0, 1.0 + gaps)
    assert short / gaps**2 == pytest.approx([1 / 12] * 3, rel=1e-2)


def test_difference_of_two_streams():
    # counter flow 100 -> 60 against 20 -> 50: 50 and 40; parallel: 80 and 10
    K = 273.15
    counter = log_mean_temperature_difference(100 + K, 60 + K, 20 + K, 50 + K)
    parallel = log_mean_temperature_difference(100 + K, 60 + K, 20 + K, 50 + K, "parallel")
    assert counter == pytest.approx(10 / math.log(50 / 40), rel=1e-14)
    assert parallel == pytest.approx(70 / math.log(80 / 10), rel=1e-14)


@pytest.mark.parametrize("arrangement", ["counter", "parallel"])
def test_difference_agrees_with_effectiveness(arrangement):
    units, ratio, hot, cold = np.array([0.1, 1.0, 5.0]), 0.7, 500.0, 300.0
    share = effectiveness(units, ratio, arrangement)
    # the hot stream has the smaller capacity rate, 1 W/K
    hot_out, cold_out = hot - share * (hot - cold), cold + ratio * share * (hot - cold)
    difference = log_mean_temperature_difference(hot, hot_out, cold, cold_out, arrangement)
    assert units * difference == pytest.approx(hot - hot_out, rel=1e-11)


def test_sum_in_the_numerator_as_printed_would_break_the_balance():
    first, second = 40.0, 33.0
    assert logarithmic_mean(first, second) == pytest.approx(36.4, rel=1e-2)
    assert (first + second) / math.log(first / second) > 370.0


@pytest.mark.parametrize("units", [0.0, 1e-12, 1e-6, 0.3, 1.0, 7.0, 60.0, 1e4])
@pytest.mark.parametrize("ratio", [0.0, 1e-300, 1e-9, 0.25, 1 - 1e-9, 1.0])
def test_effectiveness_against_mpmath(units, ratio):
    with mpmath.workdps(60):
        N, C = mpmath.mpf(units), mpmath.mpf(ratio)
        e = mpmath.exp
        wall = 1 - e(-N)
        wanted = {
            "counter": N / (1 + N) if C == 1 else (1 - e(-N * (1 - C))) / (1 - C * e(-N * (1 - C))),
            "parallel": (1 - e(-N * (1 + C))) / (1 + C),
            "cross_max_mixed": wall if C == 0 else -mpmath.expm1(-C * wall) / C,
            "cross_min_mixed": wall if C == 0 else 1 - e(mpmath.expm1(-C * N) / C),
        }
    for arrangement, value in wanted.items():
        got = effectiveness(units, ratio, arrangement)
        assert got == 0.0 if value == 0 else deviation(got, value) < 2e-15


@pytest.mark.parametrize(
    ("units", "ratio"), [(0.01, 0.5), (1.0, 1e-9), (1.0, 0.5), (3.0, 1.0), (25.0, 0.9), (200.0, 1.0)]
)
def test_unmixed_cross_flow_against_its_integral(units, ratio):
    # outlet of the stream with the smaller rate at y, per length of the other's path (Nusselt 1930):
    # e^-N + int_0^y e^-(N+u) sqrt(N/u) I1(2 sqrt(N u)) du, whose mean over y is integrated once by parts
    with mpmath.workdps(30):
        N, y = mpmath.mpf(units), mpmath.mpf(units) * mpmath.mpf(ratio)

        def part(u):
            return (y - u) * mpmath.exp(-N - u) * mpmath.sqrt(N / u) * mpmath.besseli(1, 2 * mpmath.sqrt(N * u))

        left = mpmath.exp(-N) * y + mpmath.quad(part, [y * k / 8 for k in range(9)])
        wanted = 1 - left / y
    assert deviation(effectiveness(units, ratio, "cross"), wanted) < 1e-12


def test_unmixed_cross_flow_against_finite_volumes_of_second_order():
    def marched(n, units=2.0, ratio=0.8):
        a, b = units / n, units * ratio / n
        cold, outlets = np.zeros(n), np.zeros(n)
        for column in range(n):
            warm = 1.0
            for row in range(n):
                # a cell with the mean of inlet and outlet of both streams
                difference = (warm - cold[row]) / (1.0 + 0.5 * (a + b))
                warm, cold[row] = warm - a * difference, cold[row] + b * difference
            outlets[column] = warm
        return 1.0 - outlets.mean()

    exact = effectiveness(2.0, 0.8, "cross")
    errors = [abs(marched(n) - exact) for n in (8, 16, 32)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)


def test_a_wall_at_one_temperature_knows_no_arrangement():
    units = np.array([0.0, 1e-9, 0.5, 3.0, 50.0])
    for arrangement in ARRANGEMENTS:
        assert effectiveness(units, 0.0, arrangement) == pytest.approx(-np.expm1(-units), rel=1e-14, abs=0.0)


def test_arrangements_are_in_the_known_order():
    N = np.linspace(0.1, 8.0, 20)[:, None]
    C = np.linspace(0.1, 1.0, 10)
    counter, cross, mixed, parallel = (
        effectiveness(N, C, a) for a in ("counter", "cross", "cross_max_mixed", "parallel")
    )
    assert np.all((counter > cross) & (cross > mixed) & (mixed > parallel))


@pytest.mark.parametrize("arrangement", ARRANGEMENTS)
def test_transfer_units_are_the_inverse(arrangement):
    units, ratio = np.array([0.0, 1e-9, 1e-3, 0.5, 2.5])[:, None], np.array([0.0, 0.3, 0.999])
    share = effectiveness(units, ratio, arrangement)
    assert transfer_units(share, ratio, arrangement) == pytest.approx(
        np.broadcast_to(units, (5, 3)), rel=1e-10, abs=0.0
    )
    assert transfer_units(0.5, 0.0, arrangement) == pytest.approx(math.log(2.0), rel=1e-14)
    assert isinstance(transfer_units(0.5, 0.0, arrangement), float)


def test_outlet_of_constant_specific_heat_against_mpmath():
    T, Q, m, c, ua, around = 310.83, 176.2, 0.068, 781.0, 0.2934, 293.15
    with mpmath.workdps(40):
        x = (mpmath.mpf(Q) - mpmath.mpf(ua) * (mpmath.mpf(T) - mpmath.mpf(around))) / (
            mpmath.mpf(m) * c + mpmath.mpf(ua) / 2
        )
    outlet = outlet_temperature(T, Q, m, c, ua, around)
    assert deviation(outlet.temperature, T + x) < 1e-15
    # both equations of the source hold
    assert outlet.heat_loss == pytest.approx(ua * (0.5 * (T + outlet.temperature) - around), rel=1e-14)
    assert outlet.temperature == pytest.approx(T + (Q - outlet.heat_loss) / (m * c), rel=1e-14)


@pytest.mark.parametrize("heat", [-3000.0, -10.0, -1e-9, 0.0, 1e-9, 10.0, 3000.0, 1e6])
def test_outlet_of_variable_specific_heat_against_mpmath(heat):
    def c(T):
        return 271.5 + 1.3 * (T - 273.15) + 4e-4 * (T - 273.15) ** 2 + 300.0

    outlet = outlet_temperature(400.0, heat, 0.05, c, 0.3, 300.0)
    with mpmath.workdps(40):
        m, ua = mpmath.mpf(0.05), mpmath.mpf(0.3)

        def balance(x):
            d = 400 + x / 2 - mpmath.mpf(273.15)
            return (
                x * m * (mpmath.mpf(571.5) + mpmath.mpf(1.3) * d + mpmath.mpf(4e-4) * d**2)
                + ua * (100 + x / 2)
                - mpmath.mpf(heat)
            )

        x = mpmath.findroot(balance, float(outlet.temperature) - 400.0)
        assert abs(balance(x)) < mpmath.mpf(10) ** -30
        assert deviation(outlet.temperature, 400 + x) < 1e-15


def test_outlet_broadcasts_and_its_function_may_be_constant():
    heat = np.array([-5.0, 0.0, 100.0])[:, None]
    flow = np.array([0.01, 0.1])
    with_function = outlet_temperature(350.0, heat, flow, lambda T: 800.0 + 0.0 * T, 0.2, 350.0)
    without = outlet_temperature(350.0, heat, flow, 800.0, 0.2, 350.0)
    assert with_function.temperature.shape == (3, 2)
    assert str(without).splitlines()[2] == "outlet 350.00 K, loss 0 W, specific heat 800.0 J/(kg K)"
    assert with_function.temperature == pytest.approx(without.temperature, rel=1e-15)
    assert np.all(with_function.temperature[1] == 350.0)


def test_trial_temperatures_warn_of_nothing_but_the_result_does():
    quartz = OXIDES["SiO2"].specific_heat
    outlet_temperature(1990.0, 50.0, 0.1, quartz)  # trials at up to twice the rise pass 1996 K
    with pytest.warns(RangeWarning, match=r"298 to 1996 K"):
        outlet_temperature(1990.0, 5000.0, 0.1, quartz)


def test_conductance_of_layers_in_series():
    assert loss_conductance(2.0, 0.1, 0.3, 0.1) == pytest.approx(4.0)
    # a box of 0.114 m (source, section 3.2) whose walls have 5 mm of polycarbonate, 20 mm of sand, 5 W/(m2 K) outside
    assert 0.15 < loss_conductance(4 * 0.114**2, 5e-3 / 0.2, 20e-3 / 0.22, 1 / 5.0) < 0.35


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: logarithmic_mean(0.0, 1.0), "first is 0"),
        (lambda: logarithmic_mean(1.0, math.nan), "second is nan"),
        (lambda: log_mean_temperature_difference(300.0, 350.0, 310.0, 320.0, "parallel"), "-10 K hotter .* hot inlet"),
        (lambda: log_mean_temperature_difference(350.0, 310.0, 310.0, 320.0, "parallel"), "hot outlet"),
        (lambda: log_mean_temperature_difference(350.0, 310.0, 310.0, 320.0, "cross"), "arrangement is 'cross'"),
        (lambda: effectiveness(1.0, 1.2), "capacity_ratio is 1.2"),
        (lambda: effectiveness(-1.0, 0.2), "units is -1"),
        (lambda: effectiveness(2e4, 0.2, "cross"), "at most 10000"),
        (lambda: effectiveness(1.0, 0.2, "shell"), "arrangement is 'shell'"),
        (lambda: transfer_units(0.6, 1.0, "parallel"), "less than 0.5"),
        (lambda: transfer_units(1.0, 0.0, "counter"), "effectiveness is 1"),
        (lambda: outlet_temperature(300.0, -1e6, 0.1, 800.0), "takes more heat than the stream has"),
        (lambda: outlet_temperature(300.0, -1e6, 0.1, lambda T: 800.0 + 0 * T), "no outlet temperature"),
        (lambda: outlet_temperature(300.0, 1e6, 0.1, lambda T: 1e5 / T), "no outlet temperature"),
        (lambda: outlet_temperature(300.0, math.inf, 0.1, 800.0), "heat_rate is inf W"),
        (lambda: outlet_temperature(300.0, 1.0, 0.0, 800.0), "mass_flow is 0"),
        (lambda: outlet_temperature(300.0, 1.0, 0.1, lambda T: 0 * T), "specific_heat is 0"),
        (lambda: loss_conductance(1.0), "sum of the resistances is 0"),
        (lambda: loss_conductance(1.0, -0.1), "resistance is -0.1"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
