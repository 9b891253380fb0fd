"""Draws what benchmarks/structure_of_settled_beds.py found beside the published curves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.porosity_correlations import de_klerk_profile
from bedrad.report.style import COLOURS, GREY, MARKERS, new_figure, save, styled

FloatArray = NDArray[np.float64]

SHOWN = ((5.0, 0.4), (8.0, 0.4), (12.9, 0.4), (25.0, 0.4), (25.0, 0.1))
"""A and friction of the beds whose profiles are drawn."""

BULK = 0.41
"""Porosity far from the wall of the wide beds with friction 0.4, which the published profile leaves open."""

DEPTH = 6.0
"""Depth that is drawn, in diameters."""


def draw(
    path: Path,
    profiles: Mapping[tuple[float, float], tuple[FloatArray, FloatArray]],
    means: Sequence[tuple[float, float, float, float]],
    published: Mapping[str, Callable[[Any], Any]],
) -> None:
    """Porosity against depth on the left, mean porosity against A on the right."""
    with styled():
        figure = new_figure(10.5, 4.3)
        left, right = figure.subplots(1, 2)
        _profiles(left, profiles)
        _means(right, means, published)
        save(figure, path, "Near-wall structure of settled beds")


def _profiles(axes: Any, profiles: Mapping[tuple[float, float], tuple[FloatArray, FloatArray]]) -> None:
    for number, (ratio, friction) in enumerate(SHOWN):
        depths, porosity = profiles[ratio, friction]
        shown = depths < min(DEPTH, 0.5 * ratio - 0.3)
        label = f"A = {ratio:g}, friction {friction:g}"
        axes.plot(depths[shown], porosity[shown], color=COLOURS[number], linewidth=1.4, label=label)
    z = np.linspace(0.0, DEPTH, 1200)
    published = f"de Klerk 2003, bulk {BULK:g}"
    axes.plot(z, de_klerk_profile(z, BULK), color="black", linewidth=1.1, linestyle=(0, (4, 2)), label=published)
    axes.set(xlim=(0.0, DEPTH), ylim=(0.15, 1.0), xlabel="Depth below the wall [d]", ylabel="Porosity")
    axes.set_title("Porosity against depth")
    axes.legend(loc="upper right")


def _means(
    axes: Any, means: Sequence[tuple[float, float, float, float]], published: Mapping[str, Callable[[Any], Any]]
) -> None:
    A = np.geomspace(2.3, 30.0, 300)
    curves = {name: np.asarray(curve(A)) for name, curve in published.items()}
    stack = np.array(list(curves.values()))
    axes.fill_between(A, stack.min(axis=0), stack.max(axis=0), color="#E4E8EE", linewidth=0, zorder=0.5)
    dashes = ("-", (0, (5, 1.5)), (0, (1, 1)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2)))
    for dash, (name, curve) in zip(dashes, curves.items(), strict=True):
        axes.plot(A, curve, color=GREY, linewidth=1.0, linestyle=dash, label=name)
    for number, friction in enumerate(sorted({m[1] for m in means}, reverse=True)):
        points = np.array([(a, eps, error) for a, f, eps, error in means if f == friction])
        axes.errorbar(
            points[:, 0], points[:, 1], 2.0 * points[:, 2], color=COLOURS[number], marker=MARKERS[number],
            linestyle="none", capsize=2.0, elinewidth=1.0, label=f"settled, friction {friction:g}", zorder=3,
        )  # fmt: skip
    axes.set_xscale("log")
    ticks = (2.5, 3, 4, 5, 6.5, 8, 10, 12.9, 17.2, 25)
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axes.minorticks_off()
    axes.set(xlim=(2.3, 30.0), ylim=(0.37, 0.56))
    axes.set(xlabel="Tube over sphere diameter A", ylabel="Mean porosity of the tube")
    axes.set_title("Mean porosity against the width of the tube")
    axes.legend(loc="upper right")
