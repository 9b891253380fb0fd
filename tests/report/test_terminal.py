"""The summary in the terminal: its numbers are the results', and it fits."""

import io
import re

import numpy as np
import pytest
from rich.console import Console

from bedrad.errors import BadFileError
from bedrad.jobs.results import Results
from bedrad.report.terminal import summary


def show(results, width=80):
    stream = io.StringIO()
    Console(file=stream, width=width, no_color=True).print(summary(results))
    return stream.getvalue()


@pytest.fixture(scope="module")
def text(whole):
    return show(whole.results)


def row(text, start):
    """Cells of the line that starts with a text."""
    line = next(line for line in text.splitlines() if line.strip().startswith(start))
    return re.split(r"\s{2,}", line.strip())


def block(text, title):
    """Lines of the table with a title."""
    return text[text.index(title) :].split("\n\n")[0]


def test_fits_in_a_hundred_columns_and_loses_nothing(text):
    assert max(len(line) for line in text.splitlines()) <= 100
    assert "…" not in text


def test_plain_without_a_terminal(text):
    assert "\x1b" not in text


def test_name_of_the_job_is_text_and_no_markup(text):
    assert text.splitlines()[0].strip() == r"0.6 mm [bold]zirconia[/bold], $\no_formula$"
    assert "[particle radii]" in text
    assert "[W/(m² K)]" in text


def test_statistics_beside_the_correlations(text):
    assert row(text, "solid fraction phi_wa")[1:] == ["0.4501 ± 0.0029", "0.420"]
    assert row(text, "wall contacts per area n_C [1/mm²]")[1:] == ["2.059 ± 0.017", "1.850"]
    ratio = 1.85e6 * 2 * np.sqrt(3) * (3e-4) ** 2 / (1 - 1 / 12.9)
    assert row(text, "contacts over hexagonal maximum")[1:] == ["0.6959 ± 0.0058", f"{ratio:.3f}"]
    assert row(text, "share of no-contact (NC) particles")[1] == "0.1773 ± 0.0089"
    assert row(text, "NC distance a")[1:] == ["0.465 ± 0.021", "0.220"]
    assert row(text, "weighted by volume")[1:] == ["0.194 ± 0.012"]
    assert row(text, "the one that closes")[1:] == ["none"]
    assert "a flow at 0.016 m/s" in text


def test_view_factors(text, whole):
    data = whole.data["view_factors"]
    lines = block(text, "View factors from the wall")
    assert "from 2.4 to 16.8 mm along the axis; the wall outside is left out" in lines
    met = data["layers"].sum()
    for k, start in enumerate(("layer 1", "layer 2", "layer 3")):
        assert row(lines, start) == [
            start,
            ("0 to 0.3", "0.3 to 0.9", "0.9 to 1.5")[k],
            f"{data['layers'][k]:.5f}",
            f"{data['layers_error'][k]:.1e}",
            f"{data['layers_bed_error'][k]:.1e}",
            f"{data['layers'][k] / met:.5f}",
            ("0.80", "0.18", "0.02")[k],
        ]
    assert row(lines, "back to wall")[1:3] == ["0.01020", f"{data['wall_error']:.1e}"]
    assert row(lines, "beyond layers")[1:3] == ["> 1.5", "0.00066"]
    assert row(lines, "sum")[1] == "1.00000"


def test_heat_transfer(text, whole):
    lines = block(text, "Heat transfer coefficient in the tube")
    measured, correlated = (whole.data["prediction"][key][2] for key in ("measured", "correlations"))
    for degrees, k in ((100, 0), (300, 2), (500, 4), (700, 6), (900, 8), (1100, 10)):
        cells = row(lines, f"{degrees} ")
        expected = []
        for name in ("heat_transfer_coefficient", "heat_transfer_coefficient_without"):
            expected.append(f"{measured[name][k]:.1f} ± {measured[f'{name}_error'][k]:.1f}")
            expected.append(f"{correlated[name][k]:.1f}")
        gain = 20.0 * (measured["wall_temperature"][k] / 1000) ** 3  # percent, as made up
        expected += [f"+{gain:.1f}"] * 2
        assert cells == [str(degrees), *expected]
    assert "measured: measured packing, traced view factors;" in lines
    assert "k_b by Zehner-Bauer-Schluender" in lines


def test_conductivities_side_by_side(text, whole):
    lines = block(text, "Wall layer (k_wa + k_rad) and bulk (k_b) [mW/(m K)]")
    measured, correlated = (whole.data["prediction"][key][2] for key in ("measured", "correlations"))
    expected = ["1100"]
    for name, digits in (("wall_layer_conductivity", 1), ("radiative_conductivity", 2)):
        value, error = 1e3 * measured[name][-1], 1e3 * measured[f"{name}_error"][-1]
        expected += [f"{value:.{digits}f} ± {error:.{digits}f}", f"{1e3 * correlated[name][-1]:.{digits}f}"]
    expected.append(f"{1e3 * measured['bulk_conductivity'][-1]:.0f}")
    expected += [f"{case['nusselt'][-1]:.2f}" for case in (measured, correlated)]
    assert row(lines, "1100") == expected


def test_published_systems_and_their_gain(text, whole):
    case = whole.data["prediction"]["configuration_2"][2]
    gains = [f"+{20 * (T / 1000) ** 3:.1f}" for T in (373.15, 573.15, 773.15, 973.15, 1173.15, 1373.15)]
    h = f"{case['heat_transfer_coefficient'][-1]:.1f}"
    assert row(block(text, "Gain of h by radiation"), "config. 2")[1:] == ["28.2", "270", "0.020", *gains, h]


def test_cost_and_what_was_left_out(text):
    lines = " ".join(block(text, "Cost").split())
    assert "1,048,576 rays, 2.1 million a second; left out: 17 spheres that no ray reached" in lines
    assert "3,477 spheres; left out: 1,028 outside the window, 1,038 too deep" in lines
    assert f"{2**24 + 8 * 1024 * 63:,} rays; error of F_w1 ~ rays^n, n = -0.485 ± 0.031" in lines


@pytest.mark.parametrize("stage", ["statistics", "view_factors", "convergence", "prediction"])
def test_what_did_not_run_is_left_out(fabricate, stage):
    text = show(fabricate(stage).results)
    titles = {
        "statistics": "solid fraction phi_wa",
        "view_factors": "View factors from the wall",
        "convergence": "convergence",
        "prediction": "Heat transfer coefficient in the tube",
    }
    assert {name for name, title in titles.items() if title in text} == {stage}
    assert ("by correlation" in text) is False
    assert ("Cost" in text) is (stage != "prediction")


def test_without_a_measurement_there_are_the_correlations_alone(fabricate):
    def change(prediction):
        del prediction["measured"], prediction["configuration_2"]

    text = show(fabricate().add("prediction", change).results)
    assert "measured" not in text
    assert "±" not in text
    assert "Gain of h" not in text
    # 200 W/(m2 K) without radiation, of which it adds 0.2 (373.15/1000)^3
    assert row(block(text, "Heat transfer"), "100 ")[1:3] == ["202.1", "200.0"]


def test_few_wall_temperatures_all_shown_and_large_coefficients_fit(fabricate):
    def change(prediction):
        for _, _, case in prediction.values():
            for name, value in case.items():
                if isinstance(value, np.ndarray) and len(value) == 11:
                    case[name] = value[:2] * (10.0 if name.startswith("heat") else 1.0)

    text = show(fabricate().add("prediction", change).results)
    lines = block(text, "Heat transfer coefficient in the tube")
    assert [line.split()[0] for line in lines.splitlines() if re.match(r"\s+\d+ ", line)] == ["100", "200"]
    assert row(lines, "100 ")[1] == "2122 ± 4"
    assert "…" not in text


def test_no_results_file(tmp_path):
    with pytest.raises(BadFileError, match="gone"):
        summary(Results(tmp_path / "gone.h5"))
