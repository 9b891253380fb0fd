"""The end of a run on many beds in the terminal: means with errors, and what failed or was warned about."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bedrad.errors import visible
from bedrad.jobs.members import beds_of
from bedrad.jobs.results import Results
from bedrad.report.ensemble_records import (
    EnsembleRecord,
    MeanRow,
    group_title,
    load_ensemble,
    mean_rows,
    without_second_case,
)
from bedrad.report.records import error_text, value_text
from bedrad.report.terminal import add_row, new_table

__all__ = ["summary"]

SHOWN_GROUPS = 12
"""Combinations of a sweep that are shown; the table has all."""

SHOWN_WARNINGS = 3

_NAMES = {
    "velocity": "mean velocity U [m/s]",
    "froude": "U* = U/(g d)^0.5",
    "solid_fraction": "solid fraction, whole section",
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
    "correlations/heat_transfer_coefficient": "h, by correlation [W/(m² K)]",
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
    rows = without_second_case(row for row in mean_rows(record) if row.name in _NAMES)
    parts: list[RenderableType] = [Text(visible(record.name), style="bold")]
    groups = record.groups
    for number, group in enumerate(groups[:SHOWN_GROUPS]):
        own = [row for row in rows if row.group == number]
        beds = int(record.ensemble["units"][number])
        title = beds_of(beds)
        if group:
            title += f": {group_title(group)}"
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
        value = value_text(scale * row.mean, scale * row.error, 4)
        add_row(table, text, value, error_text(scale * row.ray_error), error_text(scale * row.scatter))
    table.caption = Text(
        "±: standard error of the mean, from bed to bed, of few beds not below what they state; the rays' share in it; "
        "scatter: standard deviation of beds"
    )
    return table


def _where(row: MeanRow) -> str:
    return row.where if row.celsius is None else f"at {row.celsius:g} °C"


def _notes(record: EnsembleRecord) -> list[RenderableType]:
    """What failed, and what was warned about, by how many beds."""
    notes: list[RenderableType] = []
    failed = len(record.failures["label"])
    if failed:
        notes.append(Text(f"{beds_of(failed)} failed: see the table of failures"))
    told = Counter(line for text in record.units["warnings"] for line in text.splitlines())
    for text, count in told.most_common(SHOWN_WARNINGS):
        notes.append(Text(f"{beds_of(count)} {'warns' if count == 1 else 'warn'}: {visible(text)}"))
    if len(told) > SHOWN_WARNINGS:
        notes.append(Text(f"and {len(told) - SHOWN_WARNINGS:,} other warnings: units/warnings in the results file"))
    return [Text(), *notes] if notes else []
