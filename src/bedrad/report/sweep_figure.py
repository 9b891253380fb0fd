"""Figure of a sweep: wall layer, view factor and heat transfer against what is swept, with errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bedrad.report import style
from bedrad.report.ensemble_records import (
    EnsembleRecord,
    MeanRow,
    doubtful_groups,
    group_title,
    mean_rows,
    without_second_case,
)

__all__ = ["sweep_figure"]

MOST_SERIES = 6
"""Combinations of what else is swept, or wall temperatures, that are drawn; the tables have all."""

_PANELS = {
    ("statistics", "packing_fraction"): "Solid fraction of the wall layer [–]",
    ("statistics", "contact_ratio"): "Wall contacts over the hexagonal maximum [–]",
    ("view_factors", "layers"): "View factor to the wall layer [–]",
    ("prediction", "measured/heat_transfer_coefficient"): "Heat transfer coefficient [W/(m² K)]",
    ("prediction", "correlations/heat_transfer_coefficient"): "Heat transfer coefficient, by correlation [W/(m² K)]",
}
_AXES = {
    "velocity": ("Velocity asked for [m/s]", 1.0),
    "particle_diameter": ("Particle diameter [mm]", 1e3),
    "tube_diameter": ("Tube diameter [mm]", 1e3),
}


def sweep_figure(record: EnsembleRecord) -> Any:
    """Means with two standard errors against the quantity that takes most values; None where nothing is swept.

    Flows stand at the velocity that was measured; those that are jammed, thinned or not steady have open markers.

    Parameters
    ----------
    record : EnsembleRecord
        The results of many beds.

    Returns
    -------
    matplotlib Figure or None
        Within `style.styled`.
    """
    groups = record.groups
    values = {name: {group[name] for group in groups} for name in groups[0]} if groups else {}
    across = max(values, key=lambda name: (len(values[name]), name == "velocity"), default="")
    if not across or len(values[across]) < 2:
        return None
    rows: dict[tuple[str, str], list[MeanRow]] = {}
    for row in without_second_case(mean_rows(record)):
        if (row.stage, row.name) in _PANELS and (row.celsius is not None or row.where in ("", "layer 1")):
            rows.setdefault((row.stage, row.name), []).append(row)
    if not rows:
        return None
    places, doubtful = _places(record, groups, across), doubtful_groups(record)
    columns = min(2, len(rows))
    figure = style.new_figure(4.6 * columns, 3.7 * -(-len(rows) // columns))
    panels = np.atleast_1d(figure.subplots(-(-len(rows) // columns), columns, sharex=True, squeeze=False)).ravel()
    for axes, key in zip(panels, [key for key in _PANELS if key in rows], strict=False):
        _panel(axes, rows[key], groups, across, places, doubtful)
        axes.set_ylabel(_PANELS[key])
    for axes in panels[len(rows) :]:
        axes.set_axis_off()
    title, _ = _AXES[across]
    for axes in panels[max(0, len(rows) - columns) : len(rows)]:
        axes.set_xlabel("Velocity [m/s]" if _has_velocity(record, across) else title)
        axes.tick_params(labelbottom=True)
    figure.suptitle(style.literal(record.name), x=0.01, ha="left", fontsize=10.5)
    return figure


def _has_velocity(record: EnsembleRecord, across: str) -> bool:
    return across == "velocity" and "velocity" in record.ensemble.get("flow", {})


def _places(record: EnsembleRecord, groups: Sequence[Mapping[str, float]], across: str) -> list[float]:
    """Where each group stands on the axis."""
    if _has_velocity(record, across):
        return [float(velocity) for velocity in record.ensemble["flow"]["velocity"]]
    return [_AXES[across][1] * group[across] for group in groups]


def _panel(
    axes: Any,
    rows: Sequence[MeanRow],
    groups: Sequence[Mapping[str, float]],
    across: str,
    places: Sequence[float],
    doubtful: set[int],
) -> None:
    series: dict[str, list[MeanRow]] = {}
    for row in rows:
        others = group_title({name: value for name, value in groups[row.group].items() if name != across})
        at = "" if row.celsius is None else f"{row.celsius:.4g} °C"
        series.setdefault(", ".join(text for text in (at, others) if text), []).append(row)
    shown = list(series)
    if len(shown) > MOST_SERIES:
        shown = [shown[k] for k in np.linspace(0, len(shown) - 1, MOST_SERIES).round().astype(int)]
    for number, label in enumerate(shown):
        own = sorted((row for row in series[label] if np.isfinite(row.mean)), key=lambda row: places[row.group])
        x = [places[row.group] for row in own]
        y, errors = [row.mean for row in own], [2.0 * np.nan_to_num(row.error) for row in own]
        color, marker = style.COLOURS[number], style.MARKERS[number]
        axes.errorbar(x, y, yerr=errors, color=color, marker=marker, linewidth=1.0, elinewidth=0.9, capsize=2.5,
                      label=label or None)  # fmt: skip
        open_ones = [row for row in own if row.group in doubtful]
        axes.plot([places[row.group] for row in open_ones], [row.mean for row in open_ones], marker, color=color,
                  markerfacecolor="white", zorder=3)  # fmt: skip
    if any(shown):
        axes.legend(fontsize=7.5)
