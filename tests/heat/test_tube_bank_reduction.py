import math

import mpmath
import numpy as np
import pytest
from mpmath import besseli, besselk

from bedrad.heat.fins import FinnedTube
from bedrad.heat.kopp_neumann import ID50_K, mixture_specific_heat
from bedrad.heat.tube_bank_reduction import (
    BareTubeResult,
    Measurement,
    fin_effectiveness,
    reduce_bare_tubes,
    reduce_finned_tubes,
    surface_coefficient,
    tube_area,
    tube_temperature,
)
from oracles.nguyen import budget, rows

KELVIN = 273.15
TUBE = FinnedTube(9.525e-3, 18.9e-3, 0.57e-3, 32, 0.1016, 51.92)


def measured(**changed):
    """A row of finned tubes near that of Table 11."""
    row = {
        "heat_rate": 891.0,
        "tubes": 8,
        "upstream_temperature": 353.0,
        "downstream_temperature": 357.0,
        "inlet_temperature": 333.0,
        "mass_flow": 0.124,
        "specific_heat": 805.0,
        "loss_conductance": 0.2934,
    }
    return Measurement(**(row | changed))


def test_figure_21():
    # all inputs are printed but the specific heat, which is that of the maker's composition by Kopp and Neumann
    x = {name: row["value"] for name, row in budget("figure_21").items()}
    flow = np.mean([x[f"mass_{i}"] / x[f"time_{i}"] for i in (1, 2, 3)])
    result = reduce_bare_tubes(
        Measurement(
            x["heat"],
            8,
            tube_temperature(*(x[f"T{i}"] + KELVIN for i in (1, 2, 3)), side_weight=1.0),
            tube_temperature(*(x[f"T{i}"] + KELVIN for i in (4, 5, 6)), side_weight=1.0),
            x["inlet"] + KELVIN,
            flow,
            lambda T: mixture_specific_heat(ID50_K, T),
            x["loss_conductance"],
            x["ambient"] + KELVIN,
        ),
        0.015875,
        x["length"],
    )
    assert result.coefficient == pytest.approx(117.9, abs=0.05)
    # section 6.1: about 6 W are lost
    assert result.heat_loss == pytest.approx(5.66, abs=0.01)
    assert str(result).startswith("h 117.9 W/(m2 K), log-mean difference 36.87 K, outlet 314.02 K, loss 5.7 W")
    # that is 18 % above Table 14 at the same speed, 2.86 mm/s
    speed = flow / 1823.0 / 0.1143**2
    assert speed == pytest.approx(2.86e-3, abs=0.01e-3)
    table = [
        float(r["coefficient"]) for r in rows("coefficients") if (r["material"], r["speed_mm_s"]) == ("ID50-K", "3")
    ]
    assert result.coefficient / max(table[:2]) == pytest.approx(1.175, abs=0.005)


def air_check():
    """Figure 22: heat, area, surface temperatures of the upstream and downstream tube, inlet and outlet."""
    x = {name: row["value"] for name, row in budget("figure_22").items()}
    area = tube_area(0.0254 * x["diameter"], 0.0254 * x["length"])
    top, bottom = (tube_temperature(*(x[f"T{i}"] + KELVIN for i in triple)) for triple in ((1, 2, 3), (4, 5, 6)))
    # air flows upwards: the bottom tube is upstream
    return x["heat"] / 8, area, bottom, top, x["inlet"] + KELVIN, x["outlet"] + KELVIN


def test_figure_22_and_table_8():
    heat, area, upstream, downstream, inlet, outlet = air_check()
    first, second = upstream - inlet, downstream - outlet
    difference = (first - second) / math.log(first / second)
    # the sensitivity to Q, 0.5474, times Q
    assert surface_coefficient(heat, area, difference) == pytest.approx(0.5474 * 97.33, rel=2e-4)
    # one reading of the third run without insulation: with the mean air temperature both tubes are within 0.25 %,
    # but under each other's heading
    row = {
        r["column"]: float(r["value"])
        for r in rows("air_check")
        if (r["table"], r["run"]) == ("8", "non insulated run 3")
    }
    air = 0.5 * (inlet + outlet)
    assert surface_coefficient(heat, area, difference) == pytest.approx(row["bank"], rel=2.5e-3)
    assert surface_coefficient(heat, area, upstream - air) == pytest.approx(row["heater_downstream"], rel=2.5e-3)
    assert surface_coefficient(heat, area, downstream - air) == pytest.approx(row["heater_upstream"], rel=2.5e-3)
    # nine tubes, as chapters 1 and 3 say in passing, would be 11 % off
    assert surface_coefficient(heat * 8 / 9, area, difference) < 0.9 * row["bank"]


def test_energy_balance_of_figure_22_does_not_close():
    # 817.1 ft/min through the anemometer of 4 in, air of 1.19 kg/m3: 124 W for 97.33 W of power
    flow = 1.19 * 817.1 * 0.3048 / 60 * math.pi / 4 * 0.1016**2
    _, _, _, _, inlet, outlet = air_check()
    assert flow * 1006.0 * (outlet - inlet) / 97.33 == pytest.approx(1.28, abs=0.02)


def test_bare_tubes_without_loss_close_the_energy_balance():
    heat = np.array([[50.0], [180.0]])
    flow = np.array([0.05, 0.1, 0.2])
    row = Measurement(heat, 8, 360.0, 358.0, 310.0, flow, 780.0)
    result = reduce_bare_tubes(row, 0.015875, 0.1016)
    assert result.coefficient.shape == (2, 3)
    assert result.outlet_temperature == pytest.approx(310.0 + heat / (flow * 780.0), rel=1e-15)
    area = 8 * math.pi * 0.015875 * 0.1016
    assert result.coefficient * area * result.log_mean_difference == pytest.approx(
        np.broadcast_to(heat, (2, 3)), rel=1e-14
    )
    assert len(str(result).splitlines()) == 6


def test_mean_of_three_thermocouples():
    assert tube_temperature(300.0, 310.0, 304.0) == pytest.approx((300.0 + 2 * 310.0 + 304.0) / 4, rel=1e-15)
    assert tube_temperature(300.0, 310.0, 304.0, 1.0) == pytest.approx(914.0 / 3, rel=1e-15)


def test_equal_ends():
    # the downstream tube as much hotter as the particles: the difference is that of the inlet
    row = Measurement(78.0, 8, 350.0, 351.0, 310.0, 0.1, 780.0)
    assert reduce_bare_tubes(row, 0.016, 0.1).log_mean_difference == pytest.approx(40.0, rel=1e-15)


def test_finned_tubes_against_mpmath():
    result = reduce_finned_tubes(measured(), TUBE)
    with mpmath.workdps(30):
        r1, r2, t = (mpmath.mpf(v) for v in (TUBE.base_radius, TUBE.corrected_radius, TUBE.fin_thickness))
        conductance = mpmath.mpf(float(result.log_mean_difference))

        def excess(h):
            m = mpmath.sqrt(2 * h / (mpmath.mpf(TUBE.conductivity) * t))
            x, y = m * r1, m * r2
            fin = (
                (besselk(1, x) * besseli(1, y) - besseli(1, x) * besselk(1, y))
                / (besseli(0, x) * besselk(1, y) + besselk(0, x) * besseli(1, y))
                * 2
                * x
                / (y * y - x * x)
            )
            return h * conductance * (TUBE.base_area + 32 * TUBE.fin_area * fin) - mpmath.mpf(891) / 8

        h = mpmath.findroot(excess, 140)
    assert result.coefficient == pytest.approx(float(h), rel=1e-13)
    assert result.apparent_coefficient == pytest.approx(
        891 / 8 / TUBE.bare_area / result.log_mean_difference, rel=1e-14
    )


def test_finned_tubes_from_poor_to_perfect_fins():
    poor = reduce_finned_tubes(measured(), FinnedTube(9.525e-3, 18.9e-3, 0.57e-3, 32, 0.1016, 1e-6))
    perfect = reduce_finned_tubes(measured(), FinnedTube(9.525e-3, 18.9e-3, 0.57e-3, 32, 0.1016, 1e12))
    per_kelvin = 891 / 8 / poor.log_mean_difference
    assert poor.coefficient == pytest.approx(per_kelvin / TUBE.base_area, rel=2e-3)
    assert perfect.coefficient == pytest.approx(per_kelvin / TUBE.total_area, rel=1e-8)
    none = reduce_finned_tubes(measured(), FinnedTube(9.525e-3, 18.9e-3, 0.57e-3, 0, 0.1016, 50.0))
    assert none.coefficient == pytest.approx(none.apparent_coefficient, rel=1e-14)
    assert "fin efficiency 0." in str(reduce_finned_tubes(measured(), TUBE))


def test_finned_tubes_over_arrays():
    result = reduce_finned_tubes(measured(heat_rate=np.array([100.0, 500.0, 891.0])), TUBE)
    assert result.coefficient.shape == (3,)
    assert result.coefficient[2] == pytest.approx(float(reduce_finned_tubes(measured(), TUBE).coefficient), rel=1e-14)
    assert np.all(np.diff(result.fin_efficiency) < 0.0)


def test_fin_effectiveness_needs_the_apparent_coefficient():
    table = {}
    for row in rows("coefficients"):
        table[row["table"], row["material"], row["speed_mm_s"], row["power"]] = float(row["coefficient"])
    printed = [table["15", *key[1:]] / value for key, value in table.items() if key[0] == "14"]
    # eq. 6-17 as printed; the text has 7 to 8
    assert min(printed) > 0.75
    assert max(printed) < 1.2
    # the tube of Table 11 without fins carries h_effective times the effective area over the bare one
    h = 142.0
    apparent = h * TUBE.effective_area(h) / TUBE.bare_area
    assert 7.0 < fin_effectiveness(apparent, table["14", "Riyadh", "10", "high"]) < 9.5


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: reduce_bare_tubes(measured(heat_rate=0.0), 0.016, 0.1), "heat_rate is 0 W"),
        (lambda: reduce_bare_tubes(measured(tubes=0), 0.016, 0.1), "tubes is 0"),
        (lambda: reduce_bare_tubes(measured(), 0.0, 0.1), "diameter is 0 m"),
        (lambda: reduce_bare_tubes(measured(upstream_temperature=330.0), 0.016, 0.1), "-3 K hotter"),
        (lambda: reduce_finned_tubes(measured(downstream_temperature=338.0), TUBE), "hot outlet"),
        (lambda: tube_temperature(300.0, 300.0, -1.0), "bottom is -1 K"),
        (lambda: tube_temperature(300.0, 300.0, 300.0, 0.0), "side_weight is 0"),
        (lambda: surface_coefficient(10.0, 1.0, 0.0), "temperature_difference is 0 K"),
        (lambda: fin_effectiveness(10.0, 0.0), "bare_coefficient is 0"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_results_are_frozen():
    result = reduce_bare_tubes(measured(), 0.016, 0.1)
    assert isinstance(result, BareTubeResult)
    with pytest.raises(AttributeError):
        result.coefficient = 1.0
