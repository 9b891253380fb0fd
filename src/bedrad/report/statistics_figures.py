"""Figures of a measured bed: solid fraction against depth, and the wall unrolled into a plane."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.jobs.results import StageData
from bedrad.packings.unrolled_wall import UnrolledWall
from bedrad.report import style
from bedrad.walls import Plate

__all__ = ["profile_figure", "unrolled_wall_figure", "write_statistics_figures"]

FloatArray = NDArray[np.float64]

CONTACT, NO_CONTACT, VOID = style.COLOURS[1], style.COLOURS[5], "#FBF3CF"
"""Touching particles, NC particles and void: apart for any colour vision, and in grey."""

WIDTH, TALLEST = 10.4, 8.5
"""Width of the picture of the wall, and the most height it may have. [inch]"""


def write_statistics_figures(data: StageData, unrolled: UnrolledWall, stem: Path, name: str) -> list[Path]:
    """Draw the profile and the unrolled wall: ``<stem>_profile.png`` and ``<stem>_unrolled_wall.png``.

    Parameters
    ----------
    data : mapping
        The statistics, as the results file holds them.
    unrolled : UnrolledWall
        The unrolled wall of one frame.
    stem : Path
        Beginning of the files' names.
    name : str
        Title.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    OSError
        If a figure cannot be written.
    """
    with style.styled():
        figures = {"profile": profile_figure(data, name), "unrolled_wall": unrolled_wall_figure(unrolled, name)}
        return style.save_beside(figures, stem, name)


def profile_figure(data: StageData, name: str) -> Any:
    """Solid fraction against depth with its errors, and below it where centres and contacts lie.

    Parameters
    ----------
    data : mapping
        The statistics, as the results file holds them.
    name : str
        Title.
    """
    figure = style.new_figure(8.2, 6.6)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.5, 1.0))
    first, second, third = style.COLOURS[:3]
    means = np.asarray(data["packing_fractions"])
    style.layer_bands(above, data["edges"], [f"{mean:.3f}" for mean in means], second)
    depths, profile = 1e3 * np.asarray(data["profile_depths"]), np.asarray(data["profile"], dtype=float)
    _steps(above, depths, profile, np.asarray(data["profile_error"]), first, "solid fraction")
    for k, mean in enumerate(means):
        ends = 1e3 * np.asarray(data["edges"][k : k + 2])
        above.plot(ends, [mean] * 2, color=second, linewidth=2.2, label="_" if k else "mean of each layer")
    above.set(xlim=(0.0, depths[-1]), ylim=(0.0, 1.25 * max(profile.max(), means.max())))
    above.set_ylabel("Solid fraction [–]")
    above.set_title(style.literal(name))
    above.legend(loc="lower right", ncols=3)
    edges, cube = 1e3 * np.asarray(data["centre_depths"]), float(data["mean_diameter"]) ** 3
    for key, color, text in (("centre_density", first, "sphere centres"), ("contact_density", third, "contacts")):
        values, error = cube * np.asarray(data[key]), cube * np.asarray(data[f"{key}_error"])
        # on a logarithmic axis nothing has no place
        _steps(below, edges, np.where(values > 0.0, values, np.nan), error, color, text, band=False)
    below.set(yscale="log", ylabel="Number per $d^3$ [–]")
    below.legend(loc="lower right", ncols=2)
    style.depth_axis(above, 0.5 * data["mean_diameter"])
    above.set_xlabel("")
    below.set_xlabel("Depth below the wall [mm]")
    below.grid(False, axis="x")
    return figure


def _steps(
    axes: Any, edges: FloatArray, values: FloatArray, error: FloatArray, color: str, text: str, *, band: bool = True
) -> None:
    """A profile as steps, with two standard errors to both sides."""
    axes.stairs(values, edges, baseline=None, color=color, linewidth=1.5, label=text)
    if band and np.isfinite(error).any():
        e = np.nan_to_num(error)
        axes.stairs(values + 2 * e, edges, baseline=values - 2 * e, fill=True, color=color, alpha=0.25, linewidth=0,
                    label="± 2 standard errors")  # fmt: skip


def unrolled_wall_figure(unrolled: UnrolledWall, name: str) -> Any:
    """The wall seen along its normal: particles that touch it, particles in its layer that do not, and void.

    Every particle is the outline of its widest section within the wall layer.

    Parameters
    ----------
    unrolled : UnrolledWall
        Particles of the wall layer.
    name : str
        Title.
    """
    from matplotlib.patches import Patch

    plate = isinstance(unrolled.wall, Plate)
    low, high = (1e3 * x for x in unrolled.window.axial)
    left, right = _sides(unrolled)
    figure = style.new_figure(WIDTH, min(TALLEST, 0.92 * WIDTH * (high - low) / (right - left) + 1.6))
    axes = figure.subplots()
    axes.set_facecolor(VOID)
    axes.grid(visible=False)
    for touches, color in ((False, NO_CONTACT), (True, CONTACT)):
        _outlines(axes, unrolled, unrolled.contact == touches, color)
    axes.set(xlim=(left, right), ylim=(low, high), aspect="equal")
    axes.set_ylabel("Position along x [mm]" if plate else "Height [mm]")
    axes.set_xlabel("Position along y [mm]" if plate else "Position around the wall [mm]")
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)
    if not plate:
        _angles(axes, right)
    # a title of the axes would leave the figure, with the angles above
    figure.suptitle(style.literal(name), x=0.01, ha="left", fontsize=10.5)
    count = int((unrolled.contact & unrolled.inside).sum())
    rest = int((~unrolled.contact & unrolled.inside).sum())
    looks = [(CONTACT, "black"), (NO_CONTACT, "black"), (VOID, style.GREY)]
    handles = [Patch(facecolor=face, edgecolor=edge, linewidth=0.4) for face, edge in looks]
    labels = [f"in contact (gap up to {unrolled.contact_gap:g} r): {count}", f"without contact (NC): {rest}", "void"]
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _sides(unrolled: UnrolledWall) -> tuple[float, float]:
    """Ends of the picture across the wall. [mm]"""
    if unrolled.window.lateral is not None:
        return 1e3 * unrolled.window.lateral[0], 1e3 * unrolled.window.lateral[1]
    assert not isinstance(unrolled.wall, Plate)  # noqa: S101 - a plate's window has a lateral range
    return 0.0, 2e3 * math.pi * unrolled.wall.radius


def _outlines(axes: Any, unrolled: UnrolledWall, chosen: NDArray[np.bool_], color: str) -> None:
    """Particles as ellipses, those across a seam on both sides of it."""
    from matplotlib.collections import EllipseCollection

    across, along = 1e3 * unrolled.across[chosen], 1e3 * unrolled.height[chosen]
    width, height = 2e3 * unrolled.half_width[chosen], 2e3 * unrolled.half_height[chosen]
    along_period, across_period = (1e3 * period for period in unrolled.period)
    for up, aside in itertools.product((-1, 0, 1), repeat=2):
        if (up and not along_period) or (aside and not across_period):
            continue
        axes.add_collection(
            EllipseCollection(
                width, height, np.zeros(len(width)), units="xy",
                offsets=np.c_[across + aside * across_period, along + up * along_period],
                offset_transform=axes.transData, facecolors=color, edgecolors="black", linewidths=0.4,
            )
        )  # fmt: skip


def _angles(axes: Any, circumference: float) -> None:
    """A second axis above, with the angle around the wall."""
    above = axes.secondary_xaxis(
        "top", functions=(lambda x: 360 * x / circumference, lambda a: a * circumference / 360)
    )
    above.set_xticks(range(0, 361, 60))
    above.set_xlabel("Angle [°]")
