"""Measured flows as screen, table and figure: every number is that of the reduction."""

import csv
import io

import numpy as np
import pytest
from rich.console import Console

from bedrad.heat.measured_flow import Measured, Properties, Row, Run, Tube, beside_model, reduce_run
from bedrad.report.measured_figure import measured_figure
from bedrad.report.measured_screen import measured_screen
from bedrad.report.measured_tables import write_measured_table
from bedrad.report.style import styled

D = 7.614e-3


def run(name="one [bold]", inlet=True):
    rows = [
        Row(0.6, Measured(365.0, 0.3), mean_temperature=Measured(353.0, 0.3), power=Measured(50.0, 0.2)),
        Row(1.2, Measured(405.0, 0.3), mean_temperature=Measured(393.0, 0.3), power=Measured(48.0, 0.2)),
    ]
    given = Run(name, Measured(1.63e-3, 1e-5), rows, Measured(305.0, 0.2) if inlet else None)
    return reduce_run(given, Tube(D), Properties(600.0, 0.31, 0.05))


@pytest.fixture
def runs():
    return [run(), run("two", inlet=False)]


@pytest.fixture
def model(runs):
    return beside_model(runs, D, 270e-6, 2386.0, 2.1)


def printed(*given):
    console = Console(width=100, record=True, file=io.StringIO())
    console.print(measured_screen(*given))
    return console.export_text()


def test_the_screen_has_every_station_with_its_numbers(runs, model):
    text = printed(runs, model, ["a note"])
    h, nu = runs[0].heat_transfer_coefficient, runs[0].nusselt
    assert text.count("one [bold], 0.6") == 3
    assert f"{h.value[0]:.0f} ± {h.half_width()[0]:.0f}" in text
    assert f"{nu.value[0]:.2f} ± {nu.half_width()[0]:.2f}" in text
    assert f"{model[0].stations.complete[0]:.2f}" in text
    assert f"{runs[0].first_law.deviation[1]:+.1f} σ" in text
    assert "79.85 ± 0.30" in text  # T_mean in degrees Celsius
    assert text.rstrip().endswith("a note")
    # without an inlet the balance of the second run starts at its first station
    assert text.count("two, 0.6") == 2
    assert text.count("two, 1.2") == 3


def test_the_screen_without_a_model(runs):
    text = printed(runs, None, [])
    assert "model" not in text
    assert "U [m/s]" not in text


def test_the_table_reads_back_to_the_last_digit(runs, model, tmp_path):
    write_measured_table(tmp_path / "x.csv", runs, model)
    with (tmp_path / "x.csv").open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["run"] for row in rows] == ["one [bold]", "one [bold]", "two", "two"]
    assert float(rows[0]["heat transfer coefficient [W/(m2 K)]"]) == runs[0].heat_transfer_coefficient.value[0]
    assert float(rows[1]["heat transfer coefficient error [W/(m2 K)]"]) == runs[0].heat_transfer_coefficient.error[1]
    assert float(rows[1]["Nusselt number 95 % [1]"]) == runs[0].nusselt.half_width()[1]
    assert float(rows[1]["model Nusselt number at z* [1]"]) == model[0].stations.complete[1]
    assert float(rows[0]["first-law temperature [K]"]) == runs[0].first_law.balance.value[0]
    assert rows[2]["first-law temperature [K]"] == ""
    assert float(rows[3]["heat found over heat given [1]"]) == runs[1].first_law.closure[0]
    assert all("[" in name for name in rows[0] if name != "run")
    write_measured_table(tmp_path / "y.csv", runs, None)
    assert "model" not in (tmp_path / "y.csv").read_text(encoding="utf-8")


def test_the_figure_has_points_intervals_and_curves(runs, model):
    with styled():
        axes = measured_figure(runs, model, "a $title").axes[0]
        bare = measured_figure(runs, None, "bare").axes[0]
    points = [container for container in axes.containers if container.has_yerr]
    assert len(points) == len(runs)
    np.testing.assert_allclose(points[0].lines[0].get_xydata(), np.stack([runs[0].z_star, runs[0].nusselt.value], 1))
    (segments,) = points[0].lines[2]
    ends = np.array(segments.get_segments())[:, :, 1]
    np.testing.assert_allclose(np.diff(ends)[:, 0], 2 * runs[0].nusselt.half_width())
    curves = [line for line in axes.lines if len(line.get_xdata()) == model[0].z_star.size]
    np.testing.assert_allclose(curves[0].get_ydata(), model[0].curve.complete)
    assert axes.get_title(loc="left") == r"a \$title"
    assert len(bare.lines) < len(axes.lines)
