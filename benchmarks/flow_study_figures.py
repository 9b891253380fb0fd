"""Figures of the flow study: the matrix beside Watkins' correlations, and what the wall layer depends on.

python benchmarks/flow_study_figures.py [--csv docs/flow_study.csv] [--folder docs/images]
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

import numpy as np
from flow_points import REFERENCE, SPACINGS, VARIATION_VELOCITY, VARIED
from flow_study import ROOT, read_rows

from bedrad.heat import correlations
from bedrad.report import style

PANELS = (
    ("phi_wa", "Solid fraction of the wall layer"),
    ("n_C/n_C,max at 0.01 r", "Contact ratio, gaps up to 0.01 r"),
    ("a plain", "Mean distance of NC particles [radii]"),
    ("F_w1", "View factor to the wall layer"),
    ("F_w2", "View factor to layer 2"),
    ("F_w3", "View factor to layer 3"),
)
"""Columns of the table that are drawn against the velocity, and the labels of their axes."""

VARIED_PANELS = (
    ("phi_wa", "Solid fraction of\nthe wall layer"),
    ("n_C/n_C,max at 0 r", "Contacts over maximum\ngap ≤ 0"),
    ("n_C/n_C,max at 0.01 r", "Contacts over maximum\ngap ≤ 0.01 r"),
    ("F_w1", "View factor to\nthe wall layer"),
)

TICKS = (0.3, 0.5, 1.0, 2.0, 3.0)

Rows = list[dict[str, str]]


def value(row: dict[str, str], name: str) -> tuple[float, float]:
    """Value and standard error of a quantity of a row."""
    unit = "r" if name.startswith("a ") else "1"
    return float(row[f"{name} [{unit}]"]), float(row[f"{name} error [{unit}]"])


def mean_of_seeds(rows: Rows, name: str) -> tuple[float, float]:
    """Mean over the seeds; its error is the larger of those stated and of the scatter between the seeds."""
    values, errors = np.array([value(row, name) for row in rows]).T
    stated = math.sqrt(float((errors**2).sum())) / len(values)
    scatter = float(values.std(ddof=1)) / math.sqrt(len(values)) if len(values) > 1 else 0.0
    return float(values.mean()), max(stated, scatter)


def matrix_figure(rows: Rows, path: Path) -> None:
    """Draw the points of the matrix against the dimensionless velocity, a colour each diameter ratio."""
    points = [row for row in rows if not row["variation"]]
    ratios = sorted({float(row["A [1]"]) for row in points})
    with style.styled():
        figure = style.new_figure(10.5, 6.4)
        for axes, (name, label) in zip(figure.subplots(2, 3, sharex=True).ravel(), PANELS, strict=True):
            for ratio, colour, marker in zip(ratios, style.COLOURS, style.MARKERS, strict=False):
                own = [row for row in points if float(row["A [1]"]) == ratio]
                _curve(axes, own, name, colour, marker, f"A = {ratio:.1f}")
                _correlation(axes, own, name, colour)
            axes.set_ylabel(label)
            axes.set_xscale("log")
            axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
            axes.set_xticks([], minor=True)
        for axes in figure.axes[3:]:
            axes.set_xlabel("U/sqrt(g d)")
        figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=6)
        title = "Markers: bedrad's flows, bars of one standard error. Lines: Watkins 2018, eq. 38 and 40, a = 0.22"
        figure.suptitle(title, fontsize=9.5, x=0.01, ha="left")
        style.save(figure, path, "Wall layer and view factors of flows")


def _curve(axes: Any, rows: Rows, name: str, colour: str, marker: str, label: str) -> None:
    sets = sorted({row["set velocity [m/s]"] for row in rows}, key=float)
    groups = [[row for row in rows if row["set velocity [m/s]"] == velocity] for velocity in sets]
    x = [float(np.mean([float(row["U* [1]"]) for row in group])) for group in groups]
    y, errors = np.array([mean_of_seeds(group, name) for group in groups]).T
    axes.errorbar(x, y, errors, fmt=marker, color=colour, label=label, capsize=2, linewidth=1.0)


def _correlation(axes: Any, rows: Rows, name: str, colour: str) -> None:
    """Draw Watkins' correlation over the velocities of the rows, where there is one."""
    ratio, d = float(rows[0]["A [1]"]), float(rows[0]["particle diameter [m]"])
    velocity = np.geomspace(min(SPACINGS), max(SPACINGS), 60)
    x = velocity / math.sqrt(correlations.STANDARD_GRAVITY * d)
    if name == "phi_wa":
        axes.plot(x, correlations.packing_fraction(ratio, velocity, d, warn=False), color=colour, linewidth=1.1)
    elif name.startswith("n_C"):
        axes.plot(x, correlations.contact_ratio(ratio, velocity, d, warn=False), color=colour, linewidth=1.1)
    elif name == "a plain":
        axes.axhline(0.22, color=style.GREY, linewidth=1.1)


def variations_figure(rows: Rows, path: Path) -> None:
    """Draw what changes when one thing is changed at the reference point."""
    own = [
        row for row in rows
        if (float(row["tube diameter [m]"]), float(row["particle diameter [m]"])) == REFERENCE
        and float(row["set velocity [m/s]"]) == VARIATION_VELOCITY
    ]  # fmt: skip
    names = ["", *(variation for variation, _ in VARIED if any(row["variation"] == variation for row in own))]
    ratio, d = REFERENCE[0] / REFERENCE[1], REFERENCE[1]
    published = {
        "phi_wa": float(correlations.packing_fraction(ratio, VARIATION_VELOCITY, d, warn=False)),
        "n_C": float(correlations.contact_ratio(ratio, VARIATION_VELOCITY, d, warn=False)),
    }
    with style.styled():
        figure = style.new_figure(10.5, 0.6 + 0.29 * len(names))
        panels = figure.subplots(1, len(VARIED_PANELS), sharey=True)
        for axes, (name, label) in zip(panels, VARIED_PANELS, strict=True):
            for k, variation in enumerate(names):
                mean, error = mean_of_seeds([row for row in own if row["variation"] == variation], name)
                colour = style.COLOURS[0] if variation else style.COLOURS[1]
                axes.errorbar(mean, -k, xerr=error, fmt="o", color=colour, capsize=2, linewidth=1.0)
                if not variation:
                    axes.axvspan(mean - error, mean + error, color=colour, alpha=0.15, linewidth=0)
            line = published.get(name.split("/", maxsplit=1)[0])
            if line is not None:
                axes.axvline(line, color=style.GREY, linestyle=":", linewidth=1.4)
            axes.set_title(label, fontsize=9)
        panels[0].set_yticks([-k for k in range(len(names))], ["reference", *names[1:]])
        style.save(figure, path, "What the wall layer of a flow depends on")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, default=ROOT / "docs" / "flow_study.csv", help="the table")
    parser.add_argument("--folder", type=Path, default=ROOT / "docs" / "images", help="where the figures go")
    options = parser.parse_args()
    rows = read_rows(options.csv)
    matrix_figure(rows, options.folder / "flow_study.png")
    variations_figure(rows, options.folder / "flow_variations.png")


if __name__ == "__main__":
    main()
