"""The end of a run on many beds in the terminal: means with errors, and what failed or was warned about."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bedrad.jobs.results import Results
from bedrad.report.ensemble_records import EnsembleRecord, MeanRow, load_ensemble, mean_rows
from bedrad.report.records import celsius, with_error
from bedrad.report.terminal import add_row, new_table

__all__ = ["summary"]

SHOWN_GROUPS = 12
"""Combinations of a sweep that are shown; the table has all."""

SHOWN_WARNINGS = 3

_NAMES = {
    "packing_fraction": "solid fraction phi_wa",
    "contacts_per_area": "wall contacts n_C [1/mm²]",
    "contact_ratio": "n_C/n_C,max",
    "nc_distance": "NC distance a [radii], plain",
    "nc_distance_closing": "  closing the solid volume",
    "layers": "view factor to",
    "beyond": "  beyond layers",
    "wall": "  back to wall",
    "escaped": "  open ends",
    "measured/heat_transfer_coefficient": "h [W/(m² K)]",
}
"""The quantities of the screen, in order, and what they are called there."""


def summary(results: Results) -> RenderableType:
    """What the results file of many beds holds, as tables for a terminal of 80 columns or more.

    Parameters
    ----------
    results : Results
        The results file.

    Returns
    -------
    rich renderable
        For ``rich.console.Console.print``.

    Raises
    ------
    BadFileError
        If the results file is missing or is something else.
    """
    record = load_ensemble(results)
    rows = [row for row in mean_rows(record) if row.name in _NAMES]
    parts: list[RenderableType] = [Text(record.name, style="bold")]
    groups = record.groups
    for number, group in enumerate(groups[:SHOWN_GROUPS]):
        own = [row for row in rows if row.group == number]
        title = f"{record.ensemble['units'][number]:,} beds"
        if group:
            title += ": " + ", ".join(f"{name.replace('_', ' ')} {1e3 * value:.4g} mm" for name, value in group.items())
        if own:
            parts += [Text(), _table(title, own)]
        else:
            parts += [Text(), Text(title)]
    if len(groups) > SHOWN_GROUPS:
        parts += [Text(), Text(f"and {len(groups) - SHOWN_GROUPS} more combinations in the table of means")]
    parts += _notes(record)
    return Group(*parts)


def _table(title: str, rows: Sequence[MeanRow]) -> Table:
    table = new_table(title, "", "mean ± error", "± rays", "scatter")
    order = list(_NAMES)
    for row in sorted(rows, key=lambda row: order.index(row.name)):
        scale = 1e-6 if row.name == "contacts_per_area" else 1.0
        text = f"{_NAMES[row.name]} {_where(row)}".rstrip()
        value = "none" if math.isnan(row.mean) else with_error(scale * row.mean, scale * row.packing_error)
        add_row(table, text, value, _small(scale * row.ray_error), _small(scale * row.scatter))
    table.caption = Text(
        "± from bed to bed: standard error of the mean, the rays' share in it; one bed ±: scatter of beds"
    )
    return table


def _where(row: MeanRow) -> str:
    if not row.where.endswith(" K"):
        return row.where
    return f"at {float(celsius(float(row.where.removesuffix(' K')))):g} °C"


def _small(error: float) -> str:
    return "" if math.isnan(error) else f"{error:.1e}"


def _notes(record: EnsembleRecord) -> list[RenderableType]:
    """What failed, and what was warned about, by how many beds."""
    notes: list[RenderableType] = []
    failed = len(record.failures["label"])
    if failed:
        notes.append(Text(f"{failed:,} beds failed: see the table of failures"))
    told = Counter(line for text in record.units["warnings"] for line in text.splitlines())
    for text, count in told.most_common(SHOWN_WARNINGS):
        notes.append(Text(f"{count:,} beds warn: {text}"))
    if len(told) > SHOWN_WARNINGS:
        notes.append(Text(f"and {len(told) - SHOWN_WARNINGS:,} other warnings: units/warnings in the results file"))
    return [Text(), *notes] if notes else []
