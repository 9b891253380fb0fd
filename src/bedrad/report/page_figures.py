"""Figures of the page: those of other modules as pictures within it, and two that are drawn for it."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from bedrad.jobs.results import StageData
from bedrad.report import style
from bedrad.report.budget_bars import draw_bars, hottest_wall, input_bars
from bedrad.report.page_document import data_uri
from bedrad.report.page_html import Html, figure
from bedrad.report.page_prediction import budgets
from bedrad.report.records import celsius

__all__ = ["budget_figure", "embedded", "history_figure"]

LARGEST_SVG = 300_000
"""A drawing with more than this is a picture of dots. [bytes]"""

_INPUTS = 8
"""Inputs drawn in the budget."""

_WIDE = 7.9
"""Figures wider than this scroll on a phone. [inch]"""


def embedded(drawn: Any, text: str, caption: str, *, dots: bool = False) -> Html:
    """A matplotlib Figure as part of the page: lines and letters where they are few, else dots.

    Its paper is left out, so that it takes the colour of the page.

    Parameters
    ----------
    drawn : matplotlib Figure
        The figure; within `style.styled`.
    text : str
        What it shows, for those who do not see it.
    caption : str
        Text below it.
    dots : bool
        Make it of dots at once, where so much is drawn that lines would only be thrown away.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    drawn.patch.set_alpha(0.0)
    stream, kind = io.BytesIO(), "image/svg+xml"
    if not dots:
        FigureCanvasSVG(drawn).print_svg(stream, metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    if dots or stream.tell() > LARGEST_SVG:
        stream, kind = io.BytesIO(), "image/png"
        # the drawing of lines leaves its own number of dots behind
        drawn.set_dpi(style.RESOLUTION)
        FigureCanvasAgg(drawn).print_png(stream)
    return figure(data_uri(stream.getvalue(), kind), text, caption, wide=drawn.get_size_inches()[0] > _WIDE)


def history_figure(data: StageData, name: str) -> Any:
    """Stated standard errors of the view factors against run time, round by round; None for a single round.

    Parameters
    ----------
    data : mapping
        The stage "view_factors".
    name : str
        Title of the job.
    """
    rays = np.atleast_1d(data.get("history_rays", []))
    if len(rays) < 2:
        return None
    seconds = np.asarray(data["history_seconds"], dtype=float)
    errors = np.asarray(data["history_errors"], dtype=float)
    layers = len(data["layers"])
    names = [*("wall layer" if k == 0 else f"layer {k + 1}" for k in range(layers)), "beyond", "wall", "escaped"]
    drawn = style.new_figure(7.0, 4.4)
    axes = drawn.subplots()
    places = [k for k in range(errors.shape[1]) if (errors[:, k] > 0).any()]
    for k, color, marker in zip(places, style.COLOURS, style.MARKERS, strict=False):
        axes.plot(
            seconds, np.where(errors[:, k] > 0, errors[:, k], np.nan), "-", color=color, marker=marker, label=names[k]
        )
    largest = float(np.nanmax(errors * np.sqrt(rays)[:, None]))
    axes.plot(seconds, 1.6 * largest / np.sqrt(rays), ":", color=style.GREY, label=r"rays$^\mathregular{-1/2}$")
    axes.set(xscale="log", yscale="log", xlabel="Run time [s]", ylabel="Standard error from the rays [–]")
    axes.set_title(style.literal(name))
    drawn.legend(loc="outside lower center", ncols=4)
    return drawn


def budget_figure(prediction: StageData) -> Any:
    """Bars: what each input does to h at the hottest wall; None where the results hold no budget.

    The error it makes where errors are given, else by how much one per cent of it changes h.

    Parameters
    ----------
    prediction : mapping
        The stage "prediction".
    """
    found = budgets(prediction)
    if not found:
        return None
    walls = []
    for key, case in found.items():
        budget, names = case["budget"], [str(text) for text in case["budget"]["inputs"]]
        # the columns of a budget are in the job's order of temperatures
        T, h = prediction[key]["wall_temperature"], prediction[key]["heat_transfer_coefficient"]
        walls.append(hottest_wall(names, T, budget["contributions"], budget["elasticities"], h))
    bars = input_bars(walls, _INPUTS)
    drawn = style.new_figure(7.0, 1.6 + 0.36 * len(bars.inputs))
    axes = drawn.subplots()
    draw_bars(axes, bars, 9.5, [str(case["title"]) for case in found.values()])
    T = float(celsius(np.max(prediction[next(iter(found))]["wall_temperature"])))
    axes.set_title(f"What matters at {T:.6g} °C")
    drawn.legend(loc="outside lower center", ncols=1)
    return drawn
