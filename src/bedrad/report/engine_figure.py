"""Figure of the comparison of engines: error against run time, with set-up and facet bias apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.raytrace.engine_comparison import EngineComparison
from bedrad.raytrace.engine_errors import EngineRuns
from bedrad.report import style

__all__ = ["comparison_figure", "write_comparison_figure"]

FloatArray = NDArray[np.float64]

LINES = ("-", "--", ":")
"""Lines of the variants of one engine, from coarse to fine."""

BEYOND = 3.0
"""How far below the tolerance the axis of the error goes."""


def write_comparison_figure(found: EngineComparison, tolerance: float, path: Path, name: str) -> None:
    """Draw the comparison and write it as PNG, whole or not at all.

    Parameters
    ----------
    found : EngineComparison
        What was measured.
    tolerance : float
        Error of the view factor to the first layer that the run times are given for.
    path : Path
        The file.
    name : str
        Title.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    OSError
        If the file cannot be written.
    """
    with style.styled():
        style.save(comparison_figure(found, tolerance, name), path, name)


def comparison_figure(found: EngineComparison, tolerance: float, name: str) -> Any:
    """Error of F_w1 against run time (above); set-up, facet bias and time to the tolerance of each engine (below)."""
    figure = style.new_figure(9.6, 8.4)
    grid = figure.add_gridspec(2, 3, height_ratios=(2.1, 1.0))
    above = figure.add_subplot(grid[0, :])
    looks = _looks(found.engines)
    _curves(above, found, tolerance, looks)
    above.set_title(style.literal(name))
    below = [figure.add_subplot(grid[1, 0])]
    below += [figure.add_subplot(grid[1, k], sharey=below[0]) for k in (1, 2)]
    setup = np.array([runs.setup_seconds for runs in found.engines])
    _dots(below[0], setup, looks)
    below[0].set(xlabel="Set-up [s]", yticks=range(len(looks)), yticklabels=[runs.name for runs in found.engines])
    below[0].invert_yaxis()
    _biases(below[1], found.engines, looks, tolerance)
    below[1].set_xlabel(r"Facet bias of $F_{\mathrm{w1}}$ [–]")
    seconds = np.array([runs.seconds_to(tolerance) for runs in found.engines])
    _dots(below[2], seconds, looks, "never")
    _dots(below[2], seconds + setup, looks, hollow=True)
    below[2].set_xlabel(f"Run time to {tolerance:g} [s]\n(hollow: with set-up)")
    for axes in below[1:]:
        axes.tick_params(labelleft=False)
    for axes in below:
        axes.grid(False, axis="y")
    return figure


def _looks(engines: Sequence[EngineRuns]) -> list[dict[str, str]]:
    """A colour for each family, a line and marker for each variant in it."""
    families = list(dict.fromkeys(runs.family for runs in engines))
    looks = []
    for k, runs in enumerate(engines):
        variant = [other.family for other in engines[:k]].count(runs.family)
        looks.append(
            {
                "color": style.COLOURS[families.index(runs.family) % len(style.COLOURS)],
                "linestyle": LINES[variant % len(LINES)],
                "marker": style.MARKERS[variant % len(style.MARKERS)],
            }
        )
    return looks


def _curves(axes: Any, found: EngineComparison, tolerance: float, looks: Sequence[dict[str, str]]) -> None:
    from matplotlib.lines import Line2D

    low = tolerance / BEYOND
    times = [1.5 * t for runs in found.engines if math.isfinite(t := runs.seconds_to(tolerance))]
    end = max([*times, *(runs.seconds[-1] for runs in found.engines)])
    for runs, look in zip(found.engines, looks, strict=True):
        line = np.geomspace(runs.seconds[0], end, 200)
        said = np.array([runs.error_after(t) for t in line])
        axes.plot(line, _positive(said), linestyle=look["linestyle"], color=look["color"], linewidth=1.2)
        true = _positive(runs.true_error[:, 0])
        axes.errorbar(runs.seconds, true, yerr=runs.true_error_scatter(), fmt=look["marker"], color=look["color"],
                      elinewidth=0.8, label=runs.name)  # fmt: skip
    axes.axhline(tolerance, color=style.GREY, linewidth=0.9, linestyle="-.")
    axes.set(xscale="log", yscale="log", xlabel="Run time on one core, without set-up [s]")
    axes.set_ylabel(r"Error of the view factor to the first layer, $F_{\mathrm{w1}}$ [–]")
    largest = max(float(runs.true_error[:, 0].max()) for runs in found.engines)
    axes.set_ylim(low, 3.0 * max(largest, tolerance))
    axes.set_xlim(0.7 * min(runs.seconds[0] for runs in found.engines), 1.5 * end)
    handles, labels = axes.get_legend_handles_labels()
    million = found.reference.rays / 1e6
    seeds = found.engines[0].seeds
    kinds: dict[str, dict[str, Any]] = {
        f"true error: rms distance of {seeds} runs\nto {million:.3g} million independent rays": {
            "marker": "o",
            "linestyle": "",
        },
        "facet bias and stated noise together": {"linestyle": "-"},
        f"the error asked for, {tolerance:g}": {"linestyle": "-."},
    }
    handles += [Line2D([], [], color=style.GREY, **look) for look in kinds.values()]
    axes.legend(handles, [*labels, *kinds], loc="center left", bbox_to_anchor=(1.0, 0.5))


def _biases(axes: Any, engines: Sequence[EngineRuns], looks: Sequence[dict[str, str]], tolerance: float) -> None:
    """Size of the facet bias with two standard errors, beside the tolerance; none for exact spheres."""
    sizes = [tolerance, *(size for runs in engines if (size := abs(float(runs.bias[0]))) > 0.0)]
    axes.set(xscale="log", xlim=(min(sizes) / 4.0, 4.0 * max(sizes)))
    axes.axvline(tolerance, color=style.GREY, linewidth=0.9, linestyle="-.")
    for k, (runs, look) in enumerate(zip(engines, looks, strict=True)):
        if not runs.facets:
            axes.annotate("none", (0.98, k), xycoords=("axes fraction", "data"), va="center",
                          ha="right", fontsize=8, color=style.GREY)  # fmt: skip
            continue
        size, error = abs(float(runs.bias[0])), 2.0 * float(runs.bias_error[0])
        if size > 0.0:
            axes.errorbar(size, k, xerr=[[min(error, 0.999 * size)], [error]], fmt=look["marker"], color=look["color"],
                          elinewidth=1.0)  # fmt: skip


def _dots(
    axes: Any, values: FloatArray, looks: Sequence[dict[str, str]], missing: str = "", *, hollow: bool = False
) -> None:
    """A marker for each engine; a word where its value is infinite."""
    axes.set_xscale("log")
    for k, (value, look) in enumerate(zip(values, looks, strict=True)):
        if math.isfinite(value) and value > 0.0:
            face = "none" if hollow else look["color"]
            axes.plot(value, k, look["marker"], color=look["color"], markerfacecolor=face)
        elif missing and math.isinf(value):
            axes.annotate(missing, (0.98, k), xycoords=("axes fraction", "data"), va="center", ha="right", fontsize=8,
                          color=style.GREY)  # fmt: skip


def _positive(values: FloatArray) -> FloatArray:
    """Nan in place of zero, which has no place on a logarithmic axis."""
    return np.where(values > 0.0, values, np.nan)
