"""Figure of the error of the view factors against run time and number of rays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.jobs.results import StageData
from bedrad.report import style
from bedrad.report.records import with_error

__all__ = ["convergence_figure"]

FloatArray = NDArray[np.float64]

FEWEST_RAYS = 100
"""A target that the longest run meets with fewer rays has no error worth a curve."""

LONG_AXIS = 2.5
"""Decades above which only powers of ten get a number."""

SHORTEST_AXIS = 1.0
"""Decades that an axis has at least, so that one run has a place on it, and three numbers stand along it."""

MARGIN = 0.05
"""Share of an axis that is left free at either end."""


def convergence_figure(data: StageData, name: str) -> Any:
    """True and stated error of the view factors against run time (left) and number of rays (right).

    Parameters
    ----------
    data : mapping
        The stage "convergence".
    name : str
        Title of the job.
    """
    figure = style.new_figure(10.4, 6.2)
    by_time, by_rays = figure.subplots(1, 2, sharey=True)
    rays, seconds = np.asarray(data["rays"], dtype=float), _positive(data["seconds"])
    shown, left_out = _chosen(data)
    for axes, x in ((by_time, seconds), (by_rays, rays)):
        axes.set(xscale="log", yscale="log")
        for (k, target), color, marker in zip(shown, style.COLOURS, style.MARKERS, strict=False):
            _target(axes, x, data, k, color, marker, _described(data, k, target))
        _guide(axes, x, rays, data, [k for k, _ in shown])
    by_time.set(xlabel="Run time, without set-up of the grid [s]", ylabel="Error of the view factors [–]")
    by_rays.set_xlabel("Number of rays [–]")
    _plain_numbers(by_time, seconds, "{:g}".format)
    _plain_numbers(by_rays, rays, _short)
    _rays_above(by_time, seconds, data["rays"])
    by_time.set_title(style.literal(name))
    _legend(figure, by_rays, data, left_out)
    return figure


def _chosen(data: StageData) -> tuple[list[tuple[int, str]], list[str]]:
    """Targets with a curve, and those that too few rays meet."""
    longest = float(np.max(data["rays"]))
    shown: list[tuple[int, str]] = []
    left_out: list[str] = []
    for k, target in enumerate(data["names"]):
        if data["reference"][k] * longest >= FEWEST_RAYS and k - len(left_out) < len(style.COLOURS):
            shown.append((k, str(target)))
        else:
            left_out.append(str(target))
    return shown, left_out


def _described(data: StageData, k: int, target: str) -> str:
    """A target in the legend: what it is, and how fast its error falls."""
    places = {"layer 1": "wall layer", "wall": "back to the wall", "beyond": "beyond the last layer"}
    text = places.get(target, target)
    exponent, error = float(data["exponent"][k]), float(data["exponent_error"][k])
    return f"{text}: exponent {with_error(exponent, error, 2)}".replace("-", "−") if np.isfinite(exponent) else text


def _target(axes: Any, x: FloatArray, data: StageData, k: int, color: str, marker: str, label: str) -> None:
    """One target: points for the true error, a line for the stated one."""
    order = np.argsort(x, kind="stable")
    true, said = _positive(data["true_error"][order, k]), _positive(data["stated_error"][order, k])
    # a root mean square over n normal deviates scatters by 1/sqrt(2 n)
    scatter = true / np.sqrt(2 * data["seeds"])
    axes.errorbar(x[order], true, yerr=scatter, fmt=marker, color=color, elinewidth=0.8, label=label)
    # a single point has no line; its mark is as flat as one
    axes.plot(x[order], said, "-", marker="_" if len(x) == 1 else "", markersize=12, color=color, linewidth=1.3)


def _positive(values: FloatArray) -> FloatArray:
    """Nan in place of zero, which has no place on a logarithmic axis."""
    v = np.asarray(values, dtype=float)
    return np.where(v > 0.0, v, np.nan)


def _guide(axes: Any, x: FloatArray, rays: FloatArray, data: StageData, shown: list[int]) -> None:
    """One over the root of the number of rays, above all points."""
    errors = _positive(data["true_error"][:, shown]) * np.sqrt(rays)[:, None]
    if not np.isfinite(errors).any():
        return
    order = np.argsort(x, kind="stable")
    axes.plot(x[order], (2.5 * np.nanmax(errors) / np.sqrt(rays))[order], ":", color=style.GREY, linewidth=1.4)


def _plain_numbers(axes: Any, values: FloatArray, written: Callable[[float], str]) -> None:
    """Limits around the values, and ticks such as 0.02 and 0.05 where the axis is short, and no powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    places = np.log10(values[np.isfinite(values)])
    decades = max(float(np.ptp(places)), SHORTEST_AXIS) if places.size else SHORTEST_AXIS
    middle = 0.5 * (places.min() + places.max()) if places.size else 0.0
    half = (0.5 + MARGIN) * decades
    axes.set_xlim(10.0 ** (middle - half), 10.0 ** (middle + half))
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0,) if decades > LONG_AXIS else (1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: written(value)))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _rays_above(axes: Any, seconds: FloatArray, rays: FloatArray) -> None:
    """A second axis above the run time, with the number of rays that took it."""
    from matplotlib.ticker import NullLocator

    above = axes.twiny()
    above.set(xscale="log", xlim=axes.get_xlim())
    timed = np.flatnonzero(np.isfinite(seconds))
    kept = timed[style.spread(np.log10(seconds[timed]), 0.11 * float(np.ptp(np.log10(axes.get_xlim()))))]
    above.set_xticks(seconds[kept], [_short(rays[k]) for k in kept])
    above.xaxis.set_minor_locator(NullLocator())
    above.set_xlabel("Number of rays [–]")
    above.spines["top"].set_visible(True)
    above.grid(False)


def _short(count: float) -> str:
    """Two or three digits and a unit: 21.5 k, 1.38 M."""
    for size, unit in ((1e9, " G"), (1e6, " M"), (1e3, " k")):
        if count >= size:
            return f"{float(f'{count / size:.3g}'):g}{unit}"
    return f"{count:g}"


def _legend(figure: Any, axes: Any, data: StageData, left_out: list[str]) -> None:
    """The targets by colour, then what points and lines are."""
    from matplotlib.lines import Line2D

    handles, labels = axes.get_legend_handles_labels()
    million = data["reference_rays"] / 1e6
    kinds: dict[str, dict[str, Any]] = {
        f"true error: rms distance of {data['seeds']} runs to one of {million:.3g} million rays\n"
        "(bars: ± its standard error)": {"marker": "o", "linestyle": ""},
        "stated standard error": {"linestyle": "-"},
        r"in proportion to rays$^\mathregular{-1/2}$": {"linestyle": ":"},
    }
    if left_out:
        text = f"not shown, met by fewer than {FEWEST_RAYS} rays of the longest run: {', '.join(left_out)}"
        kinds[text] = {"linestyle": ""}
    handles += [Line2D([], [], color=style.GREY, **look) for look in kinds.values()]
    figure.legend(handles, [*labels, *kinds], loc="outside lower center", ncols=2)
