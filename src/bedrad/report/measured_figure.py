"""The figure of measured flows: Nusselt numbers beside the curves of the two-layer model."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.heat.measured_flow import ModelRun, ReducedRun
from bedrad.report import style

__all__ = ["measured_figure", "write_measured_figure"]

_TICKS = [digit * 10.0**power for power in range(-8, 5) for digit in (1, 2, 5)]


def write_measured_figure(path: Path, runs: Sequence[ReducedRun], model: Sequence[ModelRun] | None, title: str) -> None:
    """Draw Nu against z* and write it as PNG.

    Parameters
    ----------
    path : Path
        The file.
    runs : sequence of ReducedRun
        What was measured.
    model : sequence of ModelRun or None
        The model beside each run, if there is one.
    title : str
        Title.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    OSError
        If it cannot be written.
    """
    with style.styled():
        style.save(measured_figure(runs, model, title), path, title)


def measured_figure(runs: Sequence[ReducedRun], model: Sequence[ModelRun] | None, title: str) -> Any:
    """Nu against the inverse Graetz number: points with 95 % intervals, the model's curves in the same colours."""
    figure = style.new_figure(7.2, 4.8)
    axes = figure.subplots()
    looks = [(style.COLOURS[k % len(style.COLOURS)], style.MARKERS[k % len(style.MARKERS)]) for k in range(len(runs))]
    for k, (run, (color, marker)) in enumerate(zip(runs, looks, strict=True)):
        nu = run.nusselt
        label = style.literal(f"run {run.run.name}")
        if model is not None:
            label += f", {model[k].velocity:.3g} m/s"
            axes.plot(model[k].z_star, model[k].curve.complete, color=color)
            axes.axhline(float(np.mean(model[k].curve.developed)), color=color, linestyle=(0, (4, 3)), linewidth=1.0)
        axes.errorbar(
            run.z_star, nu.value, yerr=nu.half_width(), fmt=marker, color=color, capsize=3, elinewidth=1.2, label=label
        )
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    axes.set_xticks([x for x in _TICKS if low <= x <= high], labels=[f"{x:g}" for x in _TICKS if low <= x <= high])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("Inverse Graetz number $z^*$ [–]")
    axes.set_ylabel("Nusselt number $h D/k_b$ [–]")
    axes.set_title(style.literal(title))
    points = np.concatenate([run.nusselt.value + run.nusselt.half_width() for run in runs])
    axes.set_ylim(0.0, 1.25 * float(points.max()))
    if model is not None:
        axes.plot([], [], color=style.GREY, label="two-layer model (eq. 73)")
        axes.plot([], [], color=style.GREY, linestyle=(0, (4, 3)), linewidth=1.0, label="developed (eq. 22)")
    axes.legend(loc="lower right", title="points: ± 95 %", ncols=1 if len(runs) <= 4 else 2)
    return figure
