"""Section of the page on many beds: means over them, their errors and scatter, and which beds failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from bedrad.jobs.members import beds_of
from bedrad.jobs.results import Results
from bedrad.report.ensemble_records import EnsembleRecord, MeanRow, group_title, load_ensemble, mean_rows
from bedrad.report.page_figures import embedded
from bedrad.report.page_html import Html, element, given, measured, number, page_section, table
from bedrad.report.page_sections import TITLES, seconds
from bedrad.report.sweep_figure import sweep_figure

__all__ = ["GROUPS", "ensemble_section"]

GROUPS = ("ensemble", "units", "failures")
"""Groups of a results file that the section tells of."""

MOST_GROUPS, MOST_FAILURES = 40, 100
"""Combinations of what is swept, and failed beds, that have a place on the page."""

_CASES = {"": "", "measured": ", from the beds", "correlations": ", by correlation"}


def ensemble_section(results: Results) -> Html:
    """Means, errors and failures of the beds of a results file.

    Raises
    ------
    BadFileError
        If the file holds no such groups.
    """
    record = load_ensemble(results)
    rows = list(mean_rows(record))
    parts: list[str] = []
    swept = record.groups
    for group, sizes in enumerate(swept[:MOST_GROUPS]):
        beds = int(record.ensemble["units"][group])
        title = beds_of(beds)
        if sizes:
            title += f", {group_title(sizes)}"
        parts.append(element("h3", title))
        # "measured/nusselt" is of the case "measured"
        tables: dict[str, list[MeanRow]] = {}
        for row in rows:
            if row.group == group:
                case = row.name.rpartition("/")[0]
                tables.setdefault(TITLES.get(row.stage, row.stage) + _CASES.get(case, f", {case}"), []).append(row)
        parts += [_means(text, own) for text, own in tables.items()]
    if len(swept) > MOST_GROUPS:
        parts.append(element("p", f"{len(swept) - MOST_GROUPS:,} more combinations are in the tables beside the file."))
    note = (
        "±: standard error of the mean, from bed to bed, of few beds not below what they state of themselves. Error of "
        "rays: what of it comes from the rays. Scatter: standard deviation from bed to bed."
    )
    return page_section(
        "ensemble",
        "Many beds",
        element("p", note, class_="note"),
        *_sweep(record),
        *parts,
        *_warnings(record),
        *_failures(record),
        *_units(record),
    )


def _sweep(record: EnsembleRecord) -> list[Html]:
    """The figure of a sweep, where there is one."""
    drawn = sweep_figure(record)
    if drawn is None:
        return []
    text = "solid fraction, contacts, view factor and heat transfer against what is swept, with error bars"
    caption = (
        "Means against what is swept; bars: two standard errors; open: flows that are jammed, thinned or not steady."
    )
    return [embedded(drawn, text, caption)]


def _means(title: str, rows: Sequence[MeanRow]) -> Html:
    return table(
        title[0].upper() + title[1:],
        ["", "where", "unit", "mean", "error of rays", "scatter"],
        [
            [
                row.title,
                _where(row),
                "–" if row.units == "1" else row.units.replace("m2", "m²"),
                measured(row.mean, row.error),
                number(row.ray_error, 2),
                number(row.scatter, 2),
            ]
            for row in rows
        ],
    )


def _where(row: MeanRow) -> str:
    return row.where if row.celsius is None else f"{given(row.celsius)} °C"


def _warnings(record: EnsembleRecord) -> list[Html]:
    told = Counter(line for text in record.units.get("warnings", ()) for line in str(text).splitlines())
    if not told:
        return []
    rows = [[text, f"{count:,}"] for text, count in told.most_common(MOST_FAILURES)]
    return [table("Warnings", ["what", "beds"], rows)]


def _failures(record: EnsembleRecord) -> list[Html]:
    labels = list(record.failures.get("label", ()))
    if not labels:
        return []
    errors = record.failures["error"]
    rows = [[str(label), str(error)] for label, error in zip(labels, errors, strict=True)][:MOST_FAILURES]
    more = len(labels) - len(rows)
    notes = [f"{more:,} more are in the tables beside the file."] if more else []
    return [table(f"Left out: {beds_of(len(labels))} that failed", ["bed", "error"], rows, notes, words=[1])]


def _units(record: EnsembleRecord) -> list[Html]:
    """Which beds are behind the means, with their seeds, run times and contents."""
    units = record.units
    if not {"label", "seed", "seconds", "content"} <= units.keys():
        return []
    columns = (units["label"], units["seed"], units["seconds"], units["content"])
    rows = [
        [str(label), str(seed), seconds(float(spent)), element("code", str(content))]
        for label, seed, spent, content in zip(*columns, strict=True)
    ]
    more = len(rows) - MOST_FAILURES
    notes = [f"{more:,} more are in the tables beside the file."] if more > 0 else []
    heads = ["bed", "seed", "run time", "SHA-256 of the file"]
    return [table("Beds behind the means", heads, rows[:MOST_FAILURES], notes, words=[3])]
