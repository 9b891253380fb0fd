"""The statistics of a bed on one screen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from bedrad.jobs.comparison import COMPARED_TOLERANCES, Comparison
from bedrad.packings.coordination import RATTLER_CONTACTS
from bedrad.packings.statistics import Statistics, TrajectoryStatistics
from bedrad.report.records import value_text
from bedrad.report.terminal import WALL_LAYER_ROWS, add_row, new_table
from bedrad.walls import Plate, Wall

__all__ = ["statistics_screen"]

_ROWS = (*WALL_LAYER_ROWS, ("hexagonal order |psi_6| of what touches the wall", "hexagonal_order", 1.0))


def statistics_screen(found: Statistics, compared: Sequence[Comparison], velocity: float | None) -> RenderableType:
    """What was measured, on one screen of 80 columns.

    Parameters
    ----------
    found : Statistics
        What was measured.
    compared : sequence of Comparison
        The same beside the correlations, at the velocity.
    velocity : float or None
        Mean velocity of the flow. [m/s]

    Returns
    -------
    rich renderable
        For ``rich.console.Console.print``.
    """
    parts: list[RenderableType] = [Text(line) for line in _head(found)]
    parts += [_wall_layer(found), Text(), _by_gap(found), Text(), _layers(found)]
    share = value_text(found.rattler_share, found.rattler_share_error)
    parts.append(Text(f"rattlers, with fewer than {RATTLER_CONTACTS} contacts, the wall counted: {share}"))
    if compared:
        assert velocity is not None  # noqa: S101 - nothing is compared without
        parts += [Text(), _correlations(compared, velocity)]
    return Group(*parts)


def _head(found: Statistics) -> list[str]:
    low, high = (1e3 * x for x in found.window.axial)
    um = 1e6
    frames = f", mean over {found.frames} frames" if isinstance(found, TrajectoryStatistics) else ""
    lines = [f"{_describe(found.wall, found.mean_diameter)}; {found.spheres:,} spheres{frames}"]
    sizes = f"d {um * found.mean_diameter:.4g} um"
    if found.volume_mean_diameter > found.mean_diameter * 1.0005:
        sizes += f" (number mean; d32 {um * found.sauter_diameter:.4g}, d43 {um * found.volume_mean_diameter:.4g} um)"
    lines.append(f"{sizes}; from {low:.4g} to {high:.4g} mm along the axis")
    lines.append(
        f"left out: {found.left_out['outside_window']:,} spheres outside, {found.left_out['deeper']:,} too deep; "
        f"errors from {found.blocks} blocks; {found.seconds:.2f} s"
    )
    return lines


def _describe(wall: Wall, diameter: float) -> str:
    if isinstance(wall, Plate):
        return "plate"
    return f"{wall.kind} of {2e3 * wall.radius:.6g} mm, A = {2 * wall.radius / diameter:.4g}"


def _structures(found: Statistics, name: str) -> list[str]:
    """Cell for the number of independent structures, where there are several frames."""
    if not isinstance(found, TrajectoryStatistics):
        return []
    number = float(found.structures[name])
    return ["" if math.isnan(number) else f"{number:.1f}"]


def _wall_layer(found: Statistics) -> Any:
    several = isinstance(found, TrajectoryStatistics)
    title = f"Wall layer (contact: gap up to {found.contact_gap:g} radii)"
    table = new_table(title, "", "measured", *(["structures"] if several else []))
    for text, name, scale in _ROWS:
        value, error = scale * getattr(found, name), scale * getattr(found, f"{name}_error")
        add_row(table, text, value_text(value, error), *_structures(found, name))
    return table


def _by_gap(found: Statistics) -> Any:
    table = new_table("Against the gap that counts as contact", "gap [r]", "n_C [1/mm²]", "n_C/n_C,max", "NC share",
                      "contacts a sphere")  # fmt: skip
    for k, gap in enumerate(found.gap_tolerances.tolist()):
        if gap in (*COMPARED_TOLERANCES, found.contact_gap):
            add_row(
                table,
                f"{gap:g}",
                value_text(1e-6 * found.contacts_per_area_by_gap[k], 1e-6 * found.contacts_per_area_by_gap_error[k]),
                value_text(found.contact_ratio_by_gap[k], found.contact_ratio_by_gap_error[k]),
                value_text(found.nc_share_by_gap[k], found.nc_share_by_gap_error[k]),
                value_text(found.coordination_by_gap[0, k], found.coordination_by_gap_error[0, k]),
            )
    return table


def _layers(found: Statistics) -> Any:
    table = new_table("Layers", "depth [mm]", "solid fraction", "contacts a sphere")
    for k, near in enumerate(found.edges[:-1]):
        add_row(
            table,
            f"{1e3 * near:.3g} to {1e3 * found.edges[k + 1]:.3g}",
            value_text(found.packing_fractions[k], found.packing_fractions_error[k]),
            value_text(found.coordination[k], found.coordination_error[k]),
        )
    return table


def _correlations(compared: Sequence[Comparison], velocity: float) -> Any:
    title = f"Against Watkins (2018) for a flow at {velocity:.3g} m/s; ±: accuracy stated there"
    table = new_table(title, "", "measured", "eq. 38-40", "differs", "residual", "±")
    for row in compared:
        add_row(
            table,
            row.name,
            value_text(row.measured, row.error),
            f"{row.correlation:.3f}",
            f"{100 * row.difference:+.1f} %",
            "" if math.isnan(row.residual) else f"{row.residual:+.1f} SE",
            f"{100 * row.accuracy:.0f} %",
        )
    return table
