"""Figures of the predicted heat transfer against the wall temperature."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bedrad.jobs.results import StageData
from bedrad.report import style
from bedrad.report.records import cases, celsius, is_published, own_and_published, radiation_gain, stated

__all__ = ["conductivity_figure", "heat_transfer_figure"]

_TEMPERATURE = "Wall temperature [°C]"


def heat_transfer_figure(prediction: StageData, name: str) -> Any:
    """Heat transfer coefficient against wall temperature with radiation and without; below it what radiation adds.

    Left the job's tube, right the published systems where there are any.

    Parameters
    ----------
    prediction : mapping
        The stage "prediction".
    name : str
        Title of the job.
    """
    found = cases(prediction)
    colours = dict(zip(found, zip(style.COLOURS, style.MARKERS, strict=True), strict=False))
    titles = (style.literal(name), "Published systems (Watkins 2018, Table 5.1)")
    groups = [(title, group) for title, group in zip(titles, own_and_published(found), strict=True) if group]
    figure = style.new_figure(5.2 * len(groups), 6.2)
    axes = figure.subplots(2, len(groups), sharex=True, sharey="row", height_ratios=(2.3, 1.0), squeeze=False)
    for column, (title, group) in enumerate(groups):
        _coefficients(axes[0, column], group, colours)
        _gains(axes[1, column], group, colours)
        axes[0, column].set_title(title)
        axes[1, column].set_xlabel(_TEMPERATURE)
    axes[0, 0].set_ylabel("Heat transfer coefficient $h$ [W/(m² K)]")
    axes[1, 0].set_ylabel("Added by radiation [%]")
    axes[0, 0].set_ylim(0, None)
    axes[1, 0].set_ylim(0, None)
    return figure


def conductivity_figure(prediction: StageData, name: str) -> Any:
    """Conductivity of the wall layer by conduction and by radiation, measured beside correlated.

    Parameters
    ----------
    prediction : mapping
        The stage "prediction".
    name : str
        Title of the job.
    """
    found, _ = own_and_published(cases(prediction))
    figure = style.new_figure(6.4, 4.6)
    axes = figure.subplots()
    banded = False
    for (key, case), color, marker in zip(found.items(), style.COLOURS, style.MARKERS, strict=False):
        T = np.atleast_1d(celsius(case["wall_temperature"]))
        for quantity, line in (("wall_layer_conductivity", "-"), ("radiative_conductivity", "--")):
            values = np.atleast_1d(case[quantity])
            banded |= style.band(axes, T, values, np.atleast_1d(stated(case[f"{quantity}_error"])), color)
            style.curve(axes, T, values, color, marker, line, _short(key, case) if line == "-" else None)
    style.explain_lines(
        axes, {"-": "conduction, $k_\\mathregular{wa}$", "--": "radiation, $k_\\mathregular{rad}$"}, banded=banded
    )
    axes.set(xlabel=_TEMPERATURE, ylabel="Conductivity of the wall layer [W/(m K)]", ylim=(0, None))
    axes.set_title(style.literal(name))
    return figure


def _coefficients(axes: Any, group: Mapping[str, StageData], colours: Mapping[str, tuple[str, str]]) -> None:
    banded = False
    for key, case in group.items():
        T = np.atleast_1d(celsius(case["wall_temperature"]))
        color, marker = colours[key]
        for suffix, line in (("", "-"), ("_without", "--")):
            quantity = f"heat_transfer_coefficient{suffix}"
            values = np.atleast_1d(case[quantity])
            banded |= style.band(axes, T, values, np.atleast_1d(stated(case[f"{quantity}_error"])), color)
            style.curve(axes, T, values, color, marker, line, _short(key, case) if line == "-" else None)
    style.explain_lines(axes, {"-": "with radiation", "--": "without radiation"}, banded=banded)


def _gains(axes: Any, group: Mapping[str, StageData], colours: Mapping[str, tuple[str, str]]) -> None:
    for key, case in group.items():
        color, marker = colours[key]
        gain = 100 * np.atleast_1d(radiation_gain(case))
        style.curve(axes, np.atleast_1d(celsius(case["wall_temperature"])), gain, color, marker, "-", None)


def _short(key: str, case: StageData) -> str:
    """Text of a case in a legend."""
    if not is_published(key):
        return style.literal(str(case["title"]))
    title = style.literal(str(case["title"])).removeprefix("Table 5.1, ")
    return (
        f"{title}: A {case['diameter_ratio']:.1f}, {1e6 * case['particle_diameter']:.0f} µm, {case['velocity']:.3f} m/s"
    )
