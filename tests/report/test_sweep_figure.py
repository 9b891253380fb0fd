"""The figure of a sweep: what stands where, with which error, and when there is none."""

from __future__ import annotations

import numpy as np
import pytest

from bedrad.report import style
from bedrad.report.ensemble_records import EnsembleRecord
from bedrad.report.sweep_figure import sweep_figure

pytest.importorskip("matplotlib")


def record(**changes):
    """Two diameters at three velocities, two beds each."""
    velocities = np.tile([0.05, 0.1, 0.2], 2)
    k = np.arange(6.0)
    ensemble = {
        "units": np.full(6, 2),
        "velocity": velocities,
        "particle_diameter": np.repeat([5e-4, 6e-4], 3),
        "flow": {"velocity": velocities * 0.9, "velocity_packing_error": 0.001 + 0.0 * k},
        "statistics": {"packing_fraction": 0.5 - 0.1 * k / 6, "packing_fraction_packing_error": 0.01 * (k + 1)},
        "view_factors": {"layers": np.c_[0.8 - 0.01 * k, 0.1 + 0.0 * k], "layers_packing_error": np.full((6, 2), 0.02)},
        "prediction": {
            "measured": {
                "heat_transfer_coefficient": np.c_[400.0 + k, 900.0 + k],
                "heat_transfer_coefficient_packing_error": np.full((6, 2), 5.0),
                "wall_temperature": np.tile([373.15, 1123.15], (6, 1)),
            }
        },
    }
    ensemble.update(changes)
    return EnsembleRecord("a sweep", {name: value for name, value in ensemble.items() if value is not None}, {}, {})


def lines(axes):
    """Places, values and half lengths of the bars of each series, by label."""
    found = {}
    for container in axes.containers:
        x, y = container.lines[0].get_data()
        bars = container.lines[2][0].get_segments()
        found[container.get_label()] = (x, y, [0.5 * (bar[1][1] - bar[0][1]) for bar in bars])
    return found


def panel(figure, label):
    (axes,) = [axes for axes in figure.axes if axes.get_ylabel().startswith(label)]
    return axes


def test_means_stand_at_the_measured_velocity_with_two_standard_errors():
    with style.styled():
        figure = sweep_figure(record())
    shown = lines(panel(figure, "Solid fraction"))
    assert set(shown) == {"particle diameter 0.5 mm", "particle diameter 0.6 mm"}
    x, y, bars = shown["particle diameter 0.6 mm"]
    assert x == pytest.approx([0.045, 0.09, 0.18])
    assert y == pytest.approx([0.5 - 0.1 * k / 6 for k in (3, 4, 5)])
    assert bars == pytest.approx([0.08, 0.10, 0.12])
    # the wall layer alone, and each wall temperature
    x, y, bars = lines(panel(figure, "View factor"))["particle diameter 0.5 mm"]
    assert y == pytest.approx([0.8, 0.79, 0.78])
    assert set(lines(panel(figure, "Heat"))) == {
        f"{t} °C, particle diameter {d} mm" for t in (100, 850) for d in (0.5, 0.6)
    }
    assert [axes.get_xlabel() for axes in figure.axes if axes.get_xlabel()] == ["Velocity [m/s]"] * 2


def test_a_group_of_one_bed_has_the_error_that_the_bed_states():
    fraction = {"packing_fraction": np.full(6, 0.5), "packing_fraction_unit_error": np.full(6, 0.004),
                "packing_fraction_packing_error": np.full(6, np.nan)}  # fmt: skip
    with style.styled():
        figure = sweep_figure(record(units=np.ones(6, dtype=int), statistics=fraction))
    _, _, bars = lines(panel(figure, "Solid fraction"))["particle diameter 0.5 mm"]
    assert bars == pytest.approx([0.008] * 3)


def test_heat_transfer_by_correlation_is_drawn_where_nothing_else_is_known():
    case = record().ensemble["prediction"]["measured"]
    with style.styled():
        alone = sweep_figure(record(statistics=None, view_factors=None, prediction={"correlations": case}))
        both = sweep_figure(record(prediction={"measured": case, "correlations": case}))
    _, y, _ = lines(panel(alone, "Heat transfer coefficient, by correlation"))["100 °C, particle diameter 0.5 mm"]
    assert y == pytest.approx([400.0, 401.0, 402.0])
    assert "by correlation" not in " ".join(axes.get_ylabel() for axes in both.axes)


def test_settled_beds_stand_at_what_was_swept():
    with style.styled():
        figure = sweep_figure(record(velocity=None, flow=None))
    # three groups at one diameter are the scatter there
    (shown,) = lines(panel(figure, "Solid fraction")).values()
    x, _, _ = shown
    assert x == pytest.approx([0.5] * 3 + [0.6] * 3)


def test_flows_that_went_wrong_have_open_markers():
    made = record()
    problems = ["", "short of independent structures: 1", "", "", "x; thinned: 0.4", ""]
    units = {name: made.ensemble[name] for name in ("velocity", "particle_diameter")} | {"flow": {"problems": problems}}
    with style.styled():
        figure = sweep_figure(EnsembleRecord("a sweep", made.ensemble, units, {}))
    shown = [
        line.get_data()
        for line in panel(figure, "Solid fraction").lines
        if line.get_markerfacecolor() == "white" and len(line.get_xdata())
    ]
    ((x, y),) = shown
    assert [*x, *y] == pytest.approx([0.09, 0.5 - 0.1 * 4 / 6])


def test_what_was_not_swept_has_no_figure():
    with style.styled():
        assert sweep_figure(record(velocity=None, flow=None, particle_diameter=None)) is None
        assert sweep_figure(record(statistics=None, view_factors=None, prediction=None)) is None
        assert sweep_figure(record(velocity=np.full(6, 0.1), particle_diameter=np.full(6, 1e-3))) is None
