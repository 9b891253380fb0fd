"""A figure of predictions: h with radiation and without, Nu, the conductivities, and what makes the uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.heat.budget import LABELS
from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.prediction import Prediction
from bedrad.report import style

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
        h = np.atleast_1d(one.heat_transfer_coefficient)
        style.band(axes[0, 0], T[order], h[order], np.atleast_1d(one.heat_transfer_coefficient_error)[order], color)
        style.band(
            axes[1, 0], T[order], np.atleast_1d(one.nusselt)[order], np.atleast_1d(one.nusselt_error)[order], color
        )
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
            hollow = color if line == "-" else "white"
            where.plot(
                T[order], np.atleast_1d(values)[order], line, color=color, marker=marker, label=label,
                markerfacecolor=hollow, markevery=max(1, (T.size - 1) // 5),
            )  # fmt: skip
    for where, label in (
        (axes[0, 0], "Heat transfer coefficient $h$ [W/(m² K)]"),
        (axes[1, 0], "Nusselt number $hD/k_\\mathregular{b}$"),
        (axes[0, 1], "Conductivity [W/(m K)]"),
    ):
        where.set(xlabel="Wall temperature [°C]", ylabel=label)
        where.set_ylim(0, None)
    axes[0, 0].legend(loc="best")
    _explain(axes[0, 1], {"-": "wall layer, conduction", "--": "wall layer, radiation", ":": "bulk"})
    _explain(axes[1, 0], {"-": "with radiation", "--": "without"})
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


def _explain(axes: Any, lines: dict[str, str]) -> None:
    from matplotlib.lines import Line2D

    axes.legend([Line2D([], [], color=style.GREY, linestyle=line) for line in lines], list(lines.values()), loc="best")


def _budget(axes: Any, found: Sequence[Prediction]) -> None:
    """Bars: by how much one per cent of an input changes h, or the error it makes where errors are given."""
    stated = bool(np.any([one.budget.total for one in found[:MOST_CURVES]]))
    drawn = found[:MOST_CURVES]
    hottest = [int(np.argmax(one.budget.wall_temperature)) for one in drawn]

    def sizes(one: Prediction, column: int) -> Any:
        if stated:
            return 100.0 * one.budget.contributions[:, column] / one.budget.heat_transfer_coefficient[column]
        return one.budget.elasticities[:, column]

    names = drawn[0].budget.names
    found_sizes = np.array([sizes(one, column) for one, column in zip(drawn, hottest, strict=True)])
    largest = np.abs(found_sizes).max(axis=0)
    order = np.argsort(-largest, kind="stable")[: min(_INPUTS, np.count_nonzero(largest))][::-1]
    height = 0.8 / len(drawn)
    for k, row in enumerate(found_sizes):
        places = np.arange(order.size) + 0.4 - (k + 0.5) * height
        axes.barh(places, row[order], height=0.9 * height, color=style.COLOURS[k])
    axes.set_yticks(np.arange(order.size), [LABELS[names[i]][0] for i in order], fontsize=8.5)
    axes.axvline(0.0, color=style.GREY, linewidth=0.8)
    axes.grid(False, axis="y")
    T = max(float(one.budget.wall_temperature.max()) for one in drawn) - ZERO_CELSIUS
    axes.set_xlabel("Standard error of $h$ from the input [%]" if stated else "Change of $h$ by 1 % of the input [%]")
    axes.set_title(f"What matters at {T:.0f} °C")
