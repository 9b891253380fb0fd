"""A figure of predictions: h with radiation and without, Nu, the conductivities, and what makes the uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.prediction import Prediction
from bedrad.report import style
from bedrad.report.budget_bars import draw_bars, hottest_wall, input_bars
from bedrad.report.records import stated

__all__ = ["prediction_figure", "write_prediction_figure"]

MOST_CURVES = 6
"""Flows drawn; more could not be told apart."""

_INPUTS = 7


def write_prediction_figure(found: Sequence[Prediction], path: Path) -> None:
    """Draw predictions into a PNG.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    OSError
        If the file cannot be written.
    """
    with style.styled():
        style.save(prediction_figure(found), path, "Predicted heat transfer")


def prediction_figure(found: Sequence[Prediction]) -> Any:
    """Against wall temperature: h, its share of radiation, Nu and conductivities; the budget at the hottest wall.

    The first six flows are drawn.
    """
    figure = style.new_figure(10.4, 7.4)
    # rows of their own: the names of the inputs shall not push the curves above them apart
    axes = np.array([row.subplots(1, 2) for row in figure.subfigures(2, 1)])
    for one, color, marker in zip(found[:MOST_CURVES], style.COLOURS, style.MARKERS, strict=False):
        T = np.atleast_1d(one.wall_temperature) - ZERO_CELSIUS
        order = np.argsort(T)
        for where, values, errors in (
            (axes[0, 0], one.heat_transfer_coefficient, one.heat_transfer_coefficient_error),
            (axes[1, 0], one.nusselt, one.nusselt_error),
        ):
            error = np.atleast_1d(stated(errors))[order]
            style.band(where, T[order], np.atleast_1d(values)[order], error, color)
        curves = (
            (axes[0, 0], one.heat_transfer_coefficient, "-", _label(one, found)),
            (axes[0, 0], one.heat_transfer_coefficient_without, "--", None),
            (axes[1, 0], one.nusselt, "-", None),
            (axes[1, 0], one.nusselt_without, "--", None),
            (axes[0, 1], one.wall_layer_conductivity, "-", None),
            (axes[0, 1], one.radiative_conductivity, "--", None),
            (axes[0, 1], one.bulk_conductivity, ":", None),
        )
        for where, values, line, label in curves:
            style.curve(where, T[order], np.atleast_1d(values)[order], color, marker, line, label)
    for where, label in (
        (axes[0, 0], "Heat transfer coefficient $h$ [W/(m² K)]"),
        (axes[1, 0], "Nusselt number $hD/k_\\mathregular{b}$"),
        (axes[0, 1], "Conductivity [W/(m K)]"),
    ):
        where.set(xlabel="Wall temperature [°C]", ylabel=label)
        where.set_ylim(0, None)
    axes[0, 0].legend(loc="best")
    style.explain_lines(axes[0, 1], {"-": "wall layer, conduction", "--": "wall layer, radiation", ":": "bulk"})
    style.explain_lines(axes[1, 0], {"-": "with radiation", "--": "without"})
    _budget(axes[1, 1], found)
    return figure


def _label(one: Prediction, found: Sequence[Prediction]) -> str:
    """What tells a flow from the others, or all of it where it is the only one."""
    parts = {
        "tube_diameter": f"$D$ {1e3 * one.system.tube_diameter:.4g} mm",
        "particle_diameter": f"$d$ {1e6 * one.system.particle_diameter:.4g} µm",
        "velocity": f"$U$ {one.system.velocity:.4g} m/s",
    }
    differ = [name for name in parts if len({getattr(other.system, name) for other in found}) > 1]
    return ", ".join(parts[name] for name in differ or parts)


def _budget(axes: Any, found: Sequence[Prediction]) -> None:
    """Bars: by how much one per cent of an input changes h, or the error it makes where errors are given."""
    drawn = [one.budget for one in found[:MOST_CURVES]]
    walls = [
        hottest_wall(b.names, b.wall_temperature, b.contributions, b.elasticities, b.heat_transfer_coefficient)
        for b in drawn
    ]
    draw_bars(axes, input_bars(walls, _INPUTS), 8.5)
    T = max(float(budget.wall_temperature.max()) for budget in drawn) - ZERO_CELSIUS
    axes.set_title(f"What matters at {T:.0f} °C")
