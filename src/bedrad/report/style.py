"""How the figures look: colours, sizes, axes in two units, and writing them; matplotlib loads with the first figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.atomic import atomic_path
from bedrad.errors import MissingExtraError, visible

__all__ = [
    "COLOURS",
    "GREY",
    "MARKERS",
    "band",
    "curve",
    "depth_axis",
    "explain_lines",
    "layer_bands",
    "literal",
    "new_figure",
    "save",
    "save_beside",
    "spread",
    "styled",
]

FloatArray = NDArray[np.float64]

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#8A6F00", "#56B4E9")
"""Colours that readers with any colour vision tell apart (after Okabe and Ito 2008, the yellow darkened)."""

MARKERS = ("o", "s", "^", "D", "v", "P")
"""A marker for each colour, so that a print in grey still tells the curves apart."""

GREY = "#666666"

RESOLUTION = 150
"""Dots per inch."""

_SETTINGS = {
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "axes.labelsize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": "#E3E3E3",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.6,
    "lines.markersize": 5.0,
    "mathtext.default": "it",
    "svg.hashsalt": "bedrad",
}


@contextmanager
def styled() -> Iterator[None]:
    """Draw with bedrad's settings; matplotlib's own are as before when the block ends.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    try:
        import matplotlib as mpl
    except ImportError:
        raise MissingExtraError("matplotlib", "view") from None
    with mpl.rc_context(_SETTINGS):
        yield


def new_figure(width: float, height: float) -> Any:
    """An empty figure of a size in inches, without any window or global state behind it."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), dpi=RESOLUTION, layout="constrained")


def literal(text: str) -> str:
    """A text that matplotlib takes as it is: a dollar sign would start a formula, and no font has signs of control."""
    return visible(text).replace("$", r"\$")


def save(figure: Any, path: Path, title: str) -> None:
    """Write a figure as PNG, whole or not at all.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    with atomic_path(path) as temporary, temporary.open("wb") as stream:
        FigureCanvasAgg(figure).print_png(stream, metadata={"Title": title, "Software": "bedrad"})


def save_beside(figures: Mapping[str, Any], stem: Path, title: str) -> list[Path]:
    """Write figures as ``<stem>_<name>.png``, titled with their names, and return the files; OSError as `save`."""
    files = []
    for name, figure in figures.items():
        files.append(stem.with_name(f"{stem.name}_{name}.png"))
        save(figure, files[-1], f"{title}: {name.replace('_', ' ')}")
    return files


def band(axes: Any, x: FloatArray, y: FloatArray, error: FloatArray, color: str) -> bool:
    """Shade two standard errors to both sides of a curve; whether there was any error to shade."""
    if not np.isfinite(error).any():
        return False
    axes.fill_between(x, y - 2 * error, y + 2 * error, color=color, alpha=0.25, linewidth=0)
    return True


def curve(axes: Any, x: FloatArray, y: FloatArray, color: str, marker: str, line: str, label: str | None) -> None:
    """Draw a curve with about six markers, full on a solid line and hollow on any other."""
    axes.plot(
        x,
        y,
        line,
        color=color,
        marker=marker,
        markevery=max(1, (len(x) - 1) // 5),
        markerfacecolor=color if line == "-" else "white",
        label=label,
    )


def explain_lines(axes: Any, lines: Mapping[str, str], *, banded: bool = False) -> None:
    """Make the legend: what has a label by colour, then the lines by kind, and the bands where there are any."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles, labels = axes.get_legend_handles_labels()
    for line, text in lines.items():
        handles.append(Line2D([], [], color=GREY, linestyle=line))
        labels.append(text)
    if banded:
        handles.append(Patch(color=GREY, alpha=0.25, linewidth=0))
        labels.append("± 2 standard errors of what is measured")
    axes.legend(handles, labels, loc="best")


def layer_bands(axes: Any, edges: FloatArray, notes: Sequence[str], color: str) -> None:
    """Shade every other layer, and name them along the top.

    Parameters
    ----------
    axes : matplotlib Axes
        Axes with the depth in mm along x.
    edges : (layers + 1,) array
        Depths that part the layers. [m]
    notes : sequence of str
        A text for each layer, below its name.
    color : str
        Colour of the notes.
    """
    mm = 1e3 * np.asarray(edges)
    for k, (near, far, note) in enumerate(zip(mm[:-1], mm[1:], notes, strict=True)):
        if k % 2 == 0:
            axes.axvspan(near, far, color="#F0F2F5", zorder=0, linewidth=0)
        texts = (("wall layer" if k == 0 else f"layer {k + 1}", GREY, -5), (note, color, -18))
        for text, colour, down in texts:
            axes.annotate(
                text,
                (0.5 * (near + far), 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(0, down),
                textcoords="offset points",
                ha="center",
                va="top",
                fontsize=8.5,
                color=colour,
            )
    for edge in mm[1:-1]:
        axes.axvline(edge, color="#B8BEC6", linewidth=0.8, zorder=0.5)


def depth_axis(axes: Any, radius: float) -> None:
    """Label the x axis as depth in mm, and add a second one above it in particle radii.

    Parameters
    ----------
    axes : matplotlib Axes
        Axes with the depth in mm along x.
    radius : float
        Mean particle radius. [m]
    """
    mm = 1e3 * radius
    axes.set_xlabel("Depth below the wall [mm]")
    above = axes.secondary_xaxis("top", functions=(lambda x: x / mm, lambda x: x * mm))
    above.set_xlabel("Depth [particle radii]")
    above.spines["top"].set_visible(True)
    axes.grid(False, axis="x")


def spread(positions: FloatArray, least: float) -> list[int]:
    """Indices of positions to label so that neighbours are at least `least` apart, from the last backwards."""
    kept: list[int] = []
    for k in range(len(positions) - 1, -1, -1):
        if all(abs(positions[k] - positions[j]) >= least for j in kept):
            kept.append(k)
    return kept[::-1]
