import math

import numpy as np
import pytest

from bedrad.heat.fins import FinnedTube
from bedrad.heat.kopp_neumann import ID50_K, QUARTZ_SAND, mixture_specific_heat
from bedrad.heat.tube_bank_reduction import (
    Measurement,
    reduce_bare_tubes,
    reduce_finned_tubes,
    surface_coefficient,
    tube_area,
    tube_temperature,
)
from bedrad.heat.tube_bank_uncertainty import budget_from_sensitivities, sensitivity_budget
from oracles.nguyen import budget

KELVIN = 273.15
TEMPERATURES = ("T1", "T2", "T3", "T4", "T5", "T6", "inlet", "outlet", "ambient")


def values(name):
    """Printed inputs, temperatures in kelvin."""
    return {key: row["value"] + (KELVIN if key in TEMPERATURES else 0.0) for key, row in budget(name).items()}


def column(name, which):
    return {key: row[which] for key, row in budget(name).items()}


def bare(**x):
    flow = np.mean([x[f"mass_{i}"] / x[f"time_{i}"] for i in (1, 2, 3)])
    row = Measurement(
        x["heat"],
        8,
        tube_temperature(x["T1"], x["T2"], x["T3"], side_weight=1.0),
        tube_temperature(x["T4"], x["T5"], x["T6"], side_weight=1.0),
        x["inlet"],
        flow,
        lambda T: x["specific_heat_factor"] * mixture_specific_heat(ID50_K, T),
        x["loss_conductance"],
        x["ambient"],
    )
    return reduce_bare_tubes(row, x["diameter"], x["length"]).coefficient


def test_figure_21():
    # 17 sensitivities and the result, from the inputs printed and the specific heat by Kopp and Neumann
    inputs = values("figure_21") | {"diameter": 0.015875}  # printed as 0.01588
    found = sensitivity_budget(bare, inputs, column("figure_21", "uncertainty"))
    assert found.result == pytest.approx(117.9, abs=0.05)
    assert found.uncertainty == pytest.approx(1.565, abs=0.003)
    for name, slope, share in zip(found.names, found.sensitivities, found.shares, strict=True):
        printed = budget("figure_21")[name]
        assert slope == pytest.approx(printed["sensitivity"], rel=3e-3 if name == "specific_heat_factor" else 7e-4)
        assert 100.0 * share == pytest.approx(printed["share_percent"], abs=0.06)
    lines = str(found).splitlines()
    assert lines[0] == "117.899 +- 1.56"
    assert lines[2].split()[0] == "heat"


def air(**x):
    # as the source evaluates it: lengths in inches, the power of all eight tubes
    area = tube_area(0.0254 * x["diameter"], 0.0254 * x["length"])
    top, bottom = (tube_temperature(x[a], x[b], x[c]) for a, b, c in (("T1", "T2", "T3"), ("T4", "T5", "T6")))
    first, second = bottom - x["inlet"], top - x["outlet"]
    return surface_coefficient(x["heat"] / 8.0, area, (first - second) / math.log(first / second))


def test_figure_22_and_table_7():
    found = sensitivity_budget(air, values("figure_22"), column("figure_22", "uncertainty"))
    assert found.uncertainty == pytest.approx(0.344, abs=0.003)  # 0.34 in Table 7
    for name, slope, share in zip(found.names, found.sensitivities, found.shares, strict=True):
        assert slope == pytest.approx(budget("figure_22")[name]["sensitivity"], rel=5e-4)
        assert 100.0 * share == pytest.approx(budget("figure_22")[name]["share_percent"], abs=0.02)
        # Table 7 has the sizes of the same sensitivities, to two digits
        assert abs(slope) == pytest.approx(budget("table_7")[name]["sensitivity"], abs=0.021)


def test_table_7_takes_a_tenth_of_the_uncertainty_of_the_air_temperatures():
    printed = budget("table_7")
    found = budget_from_sensitivities(column("table_7", "sensitivity"), column("table_7", "uncertainty"))
    for name, square in zip(found.names, found.variances, strict=True):
        # the share of the tube's middle thermocouple is printed with the sensitivity of the others in one place
        assert square == pytest.approx(printed[name]["squared"], rel=0.15)
    # 0.00425 K, where Figure 22 has a tenth of 0.3 + 0.005 t at 25 degrees Celsius, to which the shares printed belong
    tenth = (0.3 + 0.005 * 25.0) / 10.0
    assert tenth == pytest.approx(budget("figure_22")["inlet"]["uncertainty"])
    corrected = column("table_7", "uncertainty") | {"inlet": tenth, "outlet": tenth}
    shares = budget_from_sensitivities(column("table_7", "sensitivity"), corrected).shares
    for name, share in zip(found.names, shares, strict=True):
        assert 100.0 * share == pytest.approx(printed[name]["share_percent"], abs=0.08)
    i = found.names.index("inlet")
    assert 100.0 * found.shares[i] < 0.01


def test_table_11_holds_two_budgets():
    printed = budget("table_11")
    uncertainties = column("table_11", "uncertainty")
    found = budget_from_sensitivities(column("table_11", "sensitivity"), uncertainties)
    for name, square in zip(found.names, found.variances, strict=True):
        if name == "ambient":
            assert square == pytest.approx((5 * 0.01) ** 2)  # 0.0144 for the square printed
        elif name == "fin_thickness":
            # a zero is lost: 102000 per metre and the thickness printed give the square printed
            assert square == pytest.approx(printed[name]["squared"] / 100, rel=0.02)
        else:
            assert square == pytest.approx(printed[name]["squared"], rel=0.03)
    # the squares add up to the sum printed, 38.04, but for 0.2, and to 6.17 W/(m2 K)
    total = sum(row["squared"] for row in printed.values())
    assert total == pytest.approx(38.24, abs=0.01)
    assert math.sqrt(38.04) == pytest.approx(6.17, abs=0.005)
    # the shares belong to another sum: 10 % of the specific heat, as the text says, for the 0.024 kJ/(kg K), 3 %, of
    # the table (52.37 is the sensitivity to a factor 1 +- 0.1), and 0.02425 for 0.2425 W/(m K) of the wall
    squares = {name: row["squared"] for name, row in printed.items()}
    squares |= {"specific_heat": (0.1 * 52.37) ** 2, "wall_conductivity": (0.02425 * 3.44) ** 2}
    total = sum(squares.values())
    for name, square in squares.items():
        assert 100.0 * square / total == pytest.approx(printed[name]["share_percent"], abs=0.06)
    assert math.sqrt(total) == pytest.approx(7.96, abs=0.01)
    # section 6.3: systematic and statistical part together
    assert math.hypot(6.57, 0.79) == pytest.approx(6.62, abs=0.005)


def finned(**x):
    tube = FinnedTube(0.5 * x["diameter"], x["fin_radius"], x["fin_thickness"], 32, x["length"], x["fin_conductivity"])

    def specific_heat(T):
        return x["specific_heat"] * mixture_specific_heat(QUARTZ_SAND, T)

    row = Measurement(
        x["heat"],
        8,
        tube_temperature(x["T1"], x["T2"], x["T3"], side_weight=1.0),
        tube_temperature(x["T4"], x["T5"], x["T6"], side_weight=1.0),
        x["inlet"],
        x["mass_flow"],
        specific_heat,
        0.2934,
        x["ambient"],
    )
    return reduce_finned_tubes(row, tube).coefficient


def test_table_11_from_a_state_that_its_own_sensitivities_give():
    # Table 11 prints neither temperatures nor the radius of the fins. Five numbers were found from six of its
    # sensitivities: the two surfaces above the inlet, the mass flow, radius and thickness of the fins
    # (the inlet is taken as 60 degrees Celsius, and matters little)
    inlet = 60.0 + KELVIN
    top, bottom, flow, radius, thickness = 19.658, 24.075, 0.12350, 18.917e-3, 0.5677e-3
    inputs = {
        "diameter": 0.01905,
        "fin_radius": radius,
        "fin_thickness": thickness,
        "length": 0.1016,
        "fin_conductivity": 51.92,
        "heat": 891.0,
        **dict.fromkeys(("T1", "T2", "T3"), inlet + top),
        **dict.fromkeys(("T4", "T5", "T6"), inlet + bottom),
        "inlet": inlet,
        "mass_flow": flow,
        "specific_heat": 1.0,
        "ambient": 20.0 + KELVIN,
    }
    known = ("fin_conductivity", "length", "heat", "T1", "T4", "specific_heat", "inlet")
    uncertainties = {name: budget("table_11")[name]["uncertainty"] for name in known}
    found = sensitivity_budget(finned, inputs, uncertainties)
    slopes = dict(zip(found.names, found.sensitivities, strict=True))
    # signs by physics: a better fin, a longer or hotter tube means a smaller coefficient; sizes from the squares
    # printed where those have more digits
    wanted = {
        "fin_conductivity": -math.sqrt(21.9) / 5.192,
        "length": -255.90,
        "heat": math.sqrt(0.243) / 1.8,
        "T1": -1.685,
        "T4": -math.sqrt(4.34e-5) / 0.0033,
        "specific_heat": -52.37,
    }
    for name, slope in wanted.items():
        assert slopes[name] == pytest.approx(slope, rel=1e-3)
    # what was not used agrees: the inlet, the average of all readings, the fins 2.6 mm apart at 8 an inch (section
    # 3.3), their diameter just within the tubes' pitch of 38.1 mm, and a mass flow near sqrt(5.42e-4)/0.01/19.74
    assert slopes["inlet"] == pytest.approx(10.93, rel=1e-3)
    assert found.result == pytest.approx(142.0, rel=0.015)
    assert 25.4e-3 / 8 - thickness == pytest.approx(2.6e-3, abs=0.02e-3)
    assert 37.0e-3 < 2.0 * radius < 38.1e-3
    assert flow == pytest.approx(2.33 / 19.74, rel=0.06)
    # which is 6 mm/s in the empty box, not the 10 mm/s of the caption
    assert flow / 1561.0 / 0.1143**2 == pytest.approx(6.05e-3, abs=0.05e-3)


def test_derivatives_of_known_functions():
    found = sensitivity_budget(
        lambda a, b, c: a**3 * math.exp(b) + math.sin(c),
        {"a": 2.0, "b": -1.0, "c": 0.0},
        {"a": 0.1, "b": 1e-9, "c": 0.01},
    )
    exact = [12.0 * math.exp(-1.0), 8.0 * math.exp(-1.0), 1.0]
    assert found.sensitivities == pytest.approx(exact, rel=1e-9)
    assert found.uncertainty == pytest.approx(math.hypot(exact[0] * 0.1, exact[1] * 1e-9, 0.01), rel=1e-9)
    assert found.shares.sum() == pytest.approx(1.0, rel=1e-15)


def test_first_order_against_sampling():
    rng = np.random.default_rng(11)
    inputs, errors = values("figure_22"), column("figure_22", "uncertainty")
    draws = [air(**{name: rng.normal(value, errors[name]) for name, value in inputs.items()}) for _ in range(4000)]
    found = sensitivity_budget(air, inputs, errors)
    # the standard deviation of 4000 draws has a standard error of 1.1 %; a false alarm once in 30000
    assert np.std(draws) == pytest.approx(found.uncertainty, rel=0.045)


def test_nothing_uncertain():
    found = sensitivity_budget(lambda a, b: a * b, {"a": 2.0, "b": 0.0}, {"a": 0.0, "b": 0.0})
    assert found.uncertainty == 0.0
    assert np.array_equal(found.shares, [0.0, 0.0])
    assert found.sensitivities == pytest.approx([0.0, 2.0], abs=1e-12)
    assert "0 +- 0" in str(found)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sensitivity_budget(lambda a: a, {"a": 1.0}, {"b": 1.0}), "uncertainties has 'b'"),
        (lambda: sensitivity_budget(lambda a: a, {"a": 1.0}, {"a": -1.0}), "uncertainty of a is -1"),
        (lambda: sensitivity_budget(lambda a: math.nan * a, {"a": 1.0}, {"a": 1.0}), "sensitivity to a is nan"),
        (lambda: budget_from_sensitivities({"a": 1.0}, {"a": 1.0, "b": 2.0}), "than sensitivities: b"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
