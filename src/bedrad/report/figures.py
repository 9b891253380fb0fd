"""Figures beside a results file: heat transfer, view factors, solid fraction, error against run time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.jobs.results import Results, StageData
from bedrad.report import style
from bedrad.report.convergence_figure import convergence_figure
from bedrad.report.heat_figures import conductivity_figure, heat_transfer_figure
from bedrad.report.records import Record, Target, correlated_layer, load, targets, with_error

__all__ = [
    "conductivity_figure",
    "convergence_figure",
    "draw",
    "heat_transfer_figure",
    "solid_fraction_figure",
    "view_factor_figure",
    "write_figures",
]

FloatArray = NDArray[np.float64]

ROOM_FOR_ERRORS = 3
"""Number of layers up to which there is room to print errors beside the values."""


def write_figures(results: Results, folder: Path) -> list[Path]:
    """Draw what a results file holds.

    The files are named after the results file: ``<stem>_heat_transfer.png`` and so on, 150 dots per inch.

    Parameters
    ----------
    results : Results
        The results file.
    folder : Path
        Where the figures go.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    BadFileError
        If the results file is missing or is something else.
    OSError
        If a figure cannot be written; no half-written file stays behind.
    """
    record = load(results)
    with style.styled():
        return style.save_beside(draw(record), Path(folder) / results.path.stem, record.name)


def draw(record: Record) -> dict[str, Any]:
    """All figures that the finished stages allow, as matplotlib Figures by name; within `style.styled`."""
    stages = record.stages
    figures: dict[str, Any] = {}
    if "prediction" in stages:
        figures["heat_transfer"] = heat_transfer_figure(stages["prediction"], record.name)
        figures["conductivities"] = conductivity_figure(stages["prediction"], record.name)
    if "view_factors" in stages:
        figures["view_factors"] = view_factor_figure(stages["view_factors"], record.name)
    if "statistics" in stages:
        figures["solid_fraction"] = solid_fraction_figure(stages["statistics"], record.name, stages.get("prediction"))
    if "convergence" in stages:
        figures["convergence"] = convergence_figure(stages["convergence"], record.name)
    return figures


def view_factor_figure(data: StageData, name: str) -> Any:
    """View factors to the layers at their depths, traced and published; beside them where the rest goes.

    Parameters
    ----------
    data : mapping
        The stage "view_factors".
    name : str
        Title of the job.
    """
    rows = list(targets(data))
    n = len(data["layers"])
    figure = style.new_figure(8.6, 4.8)
    main, side = figure.subplots(1, 2, sharey=True, width_ratios=(3.0, 1.6))
    traced, published = style.COLOURS[:2]
    style.layer_bands(main, data["edges"], [""] * n, traced)
    for row in rows[:n]:
        _level(main, row, traced, published, errors=n <= ROOM_FOR_ERRORS)
    _others(side, rows[n:], traced)
    main.set(yscale="log", xlim=(0, 1e3 * data["edges"][-1]), ylabel="View factor from the wall [–]")
    smallest = min((row.factor for row in rows if row.factor > 0), default=1e-3)
    main.set_ylim(10.0 ** np.floor(np.log10(smallest) - 0.3), 6.0)
    main.set_title(style.literal(name))
    figure.legend(*_last_of_each_label(main), loc="outside lower center", ncols=2)
    # the wall layer is one radius thick
    style.depth_axis(main, data["edges"][1] - data["edges"][0])
    return figure


def _level(axes: Any, row: Target, traced: str, published: str, *, errors: bool) -> None:
    """One layer: a line over its thickness for each source, and the numbers beside it, the larger one above."""
    depths = 1e3 * np.array([row.near, row.far])
    middle = depths.mean()
    traced_is_larger = not row.factor < row.published
    if row.factor > 0:
        axes.plot(depths, [row.factor] * 2, color=traced, linewidth=2.2, label="_")
        axes.errorbar(
            [middle],
            [row.factor],
            yerr=[2 * row.error],
            fmt="o-",
            color=traced,
            capsize=3,
            label="traced, ± 2 standard errors of rays and bed",
        )
        text = with_error(row.factor, row.error) if errors else f"{row.factor:.3g}"
        _number(axes, middle, row.factor, text, traced, above=traced_is_larger)
    else:
        _none(axes, middle, traced)
    if np.isfinite(row.published):
        # the point stands aside, so that it does not hide the traced one
        axes.plot(
            [depths[0], depths[0] + 0.85 * np.ptp(depths), depths[1]],
            [row.published] * 3,
            "--D",
            color=published,
            linewidth=1.3,
            markerfacecolor="white",
            markevery=[1],
            label="published for a flow at 0.016 m/s (Watkins 2018, Table 5.3)",
        )
        _number(axes, middle, row.published, f"{row.published:.2f}", published, above=not traced_is_larger)


def _others(axes: Any, rows: Sequence[Target], color: str) -> None:
    """Shares that meet no layer."""
    for k, row in enumerate(rows):
        if row.factor > 0:
            axes.errorbar([k], [row.factor], yerr=[2 * row.error], fmt="o", color=color, capsize=3, label=row.name)
            text = f"{row.factor:.3g}"
            if row.factor < 1e-4:
                mantissa, power = f"{row.factor:.1e}".split("e")
                text = rf"{mantissa}$\times\mathregular{{10^{{{int(power)}}}}}$"
            _number(axes, k, row.factor + 2 * row.error, text, color, above=True)
        else:
            _none(axes, k, color)
    texts = {"beyond": "beyond the\nlast layer", "wall": "back to\nthe wall", "escaped": "out at the\nopen ends"}
    axes.set_xticks(range(len(rows)), [texts[row.name] for row in rows], fontsize=8.5)
    axes.set_xlim(-0.7, len(rows) - 0.3)
    axes.grid(False, axis="x")
    axes.set_title("Radiation that meets no layer", fontsize=9.5, color=style.GREY)


def _number(axes: Any, x: float, y: float, text: str, color: str, *, above: bool) -> None:
    """A number above or below a point."""
    axes.annotate(
        text,
        (x, y),
        (0, 6 if above else -7),
        textcoords="offset points",
        ha="center",
        va="bottom" if above else "top",
        color=color,
        fontsize=8.5,
    )


def _none(axes: Any, x: float, color: str) -> None:
    """Zero, which has no place on a logarithmic axis."""
    axes.annotate("none", (x, 0.02), xycoords=("data", "axes fraction"), ha="center", color=color, fontsize=8.5)


def _last_of_each_label(axes: Any) -> tuple[list[Any], list[str]]:
    """Handles and labels of a legend in which every label stands once."""
    handles, labels = axes.get_legend_handles_labels()
    # sorted: matplotlib lists lines before error bars
    once = dict(sorted(zip(labels, handles, strict=True), key=lambda item: not item[0].startswith("traced")))
    return list(once.values()), list(once)


def solid_fraction_figure(data: StageData, name: str, prediction: StageData | None = None) -> Any:
    """Solid fraction against depth: the fine profile and the means of the layers.

    Parameters
    ----------
    data : mapping
        The stage "statistics".
    name : str
        Title of the job.
    prediction : mapping, optional
        The stage "prediction", for the wall layer by correlation.
    """
    figure = style.new_figure(7.6, 5.0)
    axes = figure.subplots()
    profile_colour, mean_colour, correlation_colour = style.COLOURS[:3]
    edges, depths = 1e3 * np.asarray(data["edges"]), 1e3 * np.asarray(data["profile_depths"])
    means = np.asarray(data["packing_fractions"], dtype=float)
    given = data["packing_fractions_error"] if len(means) <= ROOM_FOR_ERRORS else np.full(len(means), np.nan)
    notes = [with_error(m, e, 3) for m, e in zip(means, given, strict=True)]
    style.layer_bands(axes, data["edges"], notes, mean_colour)
    profile = np.asarray(data["profile"], dtype=float)
    errors = np.nan_to_num(np.asarray(data["profile_error"], dtype=float))
    axes.stairs(profile, depths, baseline=None, color=profile_colour, linewidth=1.6, label="profile")
    if errors.any():
        axes.stairs(
            profile + 2 * errors,
            depths,
            baseline=profile - 2 * errors,
            fill=True,
            color=profile_colour,
            alpha=0.25,
            linewidth=0,
            label="± 2 standard errors of the bed",
        )
    for k, mean in enumerate(means):
        axes.plot(edges[k : k + 2], [mean] * 2, color=mean_colour, linewidth=2.2, label="mean of each layer")
    correlated = correlated_layer(prediction)
    if correlated is not None:
        fraction = correlated.packing_fraction
        label = f"wall layer by correlation (Watkins 2018, eq. 38): {fraction:.3f}"
        axes.plot(edges[:2], [fraction] * 2, ":", color=correlation_colour, linewidth=2.4, label=label)
    highest = max(means.max(), profile.max())
    axes.set(xlim=(0, max(depths[-1], edges[-1])), ylabel="Solid fraction [–]", ylim=(0, 1.18 * highest))
    axes.set_title(style.literal(name))
    figure.legend(*_last_of_each_label(axes), loc="outside lower center", ncols=2)
    style.depth_axis(axes, 0.5 * data["mean_diameter"])
    return figure
