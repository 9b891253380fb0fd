"""The report: one HTML page with all that a results file says, that loads nothing from anywhere."""

from __future__ import annotations

import json
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any, TypeVar

from bedrad.errors import BadFileError
from bedrad.jobs.results import Results
from bedrad.jobs.stages import ORDER
from bedrad.packings.files import read
from bedrad.packings.packing import Packing
from bedrad.packings.unrolled_wall import unrolled_wall
from bedrad.report import style
from bedrad.report.figures import draw
from bedrad.report.page_document import document, write_document
from bedrad.report.page_ensemble import GROUPS, ensemble_section
from bedrad.report.page_figures import budget_figure, embedded, history_figure
from bedrad.report.page_html import Html, element, joined, page_section
from bedrad.report.page_prediction import budget_tables, budgets, glance, prediction_tables
from bedrad.report.page_provenance import groups, other_stages, provenance
from bedrad.report.page_sections import bed_facts, computed, convergence_tables, statistics_tables, view_factor_tables
from bedrad.report.pictures import make_scene
from bedrad.report.pictures_viewer import LARGEST_PAGE, viewer, viewer_script
from bedrad.report.records import Record, load
from bedrad.report.statistics_figures import profile_figure, unrolled_wall_figure

__all__ = ["make_page", "write_page"]

T = TypeVar("T")

_DAMAGE = (KeyError, IndexError, TypeError, AttributeError, ValueError, ArithmeticError)
"""What a stage raises that holds something else than bedrad writes."""

_MOST_OUTLINES = 400
"""Particles at the unrolled wall up to which it is drawn with lines."""

_ROOM_FOR_TEXT = 200_000
"""Bytes of a page for what comes after the picture of the bed is weighed."""


def write_page(results: Results, path: Path) -> Path:
    """Write the report of a results file.

    Parameters
    ----------
    results : Results
        The results file.
    path : Path
        The HTML file.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    BadFileError
        If the results file is missing, is something else, or holds a stage that bedrad did not write.
    MissingExtraError
        If matplotlib is not installed.
    OSError
        If the page cannot be written; no half-written file stays behind.
    """
    write_document(make_page(results), path)
    return path


def make_page(results: Results) -> str:
    """The report of a results file, as HTML.

    Raises
    ------
    BadFileError, MissingExtraError
        As `write_page`.
    """
    if not results.path.is_file():
        raise BadFileError(f"{results.path}: no such results file")
    record = _checked(results.path, "job", lambda: load(results))
    job = json.loads(record.attributes["job"])
    held = groups(results.path)
    bed = read(results.path) if "packing" in record.stages else None
    with style.styled():
        sections = _sections(record, job, held, bed, results.path)
    if bed is not None:
        # weighed last, as the spheres take what room is left
        used = sum(len(section.encode("utf-8", "replace")) for section in sections.values())
        edges = next((record.stages[s]["edges"] for s in ("view_factors", "statistics") if s in record.stages), None)
        scene = _checked(results.path, "packing", lambda: make_scene(bed, edges, record.name))
        picture = viewer(scene, LARGEST_PAGE - used - _ROOM_FOR_TEXT)
        sections["bed"] = page_section("bed", "The bed", bed_facts(record), picture)
    order = tuple(_TITLES)
    shown = [sections[anchor] for anchor in order if anchor in sections]
    body = joined(
        [
            element("a", "To the content", href="#content", class_="skip"),
            _checked(results.path, "results", lambda: _header(record, [a for a in order if a in sections])),
            element("main", *shown, id="content"),
            element("footer", element("p", f"Made by bedrad from {results.path.name}. This page loads nothing.")),
        ]
    )
    return document(f"{record.name}: report", body, viewer_script() if bed is not None else "")


_TITLES = {
    "computed": "What was computed",
    "bed": "The bed",
    "wall-layer": "Wall layer",
    "view-factors": "View factors",
    "convergence": "Error against run time",
    "heat": "Heat transfer",
    "budget": "Uncertainty",
    "ensemble": "Many beds",
    "other": "Also in the file",
    "provenance": "Where it comes from",
}


def _header(record: Record, anchors: list[str]) -> Html:
    links = [element("li", element("a", _TITLES[anchor], href=f"#{anchor}")) for anchor in anchors]
    return element(
        "header",
        element("h1", record.name),
        element("p", f"Results of {_time(record)}", class_="lead"),
        glance(record),
        element("nav", element("ul", *links), aria_label="sections"),
    )


def _time(record: Record) -> str:
    """When the results were written, as people write it."""
    text = str(record.attributes.get("created", "an unknown time"))
    try:
        written = datetime.fromisoformat(text)
    except ValueError:
        return text
    return f"{written:%d %B %Y, %H:%M} {written.tzname() or ''}".rstrip()


def _sections(record: Record, job: dict[str, Any], held: set[str], bed: Packing | None, path: Path) -> dict[str, Html]:
    """All sections but that of the bed, by anchor; a stage that is not there has none."""
    stages = record.stages
    makers: dict[str, tuple[str, Callable[[], Html]]] = {
        "computed": ("job", lambda: computed(record, job, held)),
        "provenance": ("job", lambda: provenance(record, job, path)),
    }
    if "statistics" in stages:
        makers["wall-layer"] = ("statistics", lambda: _wall_layer(record, bed, job))
    if "view_factors" in stages:
        makers["view-factors"] = ("view_factors", lambda: _view_factors(record))
    if "convergence" in stages:
        makers["convergence"] = ("convergence", lambda: _convergence(record))
    if "prediction" in stages:
        makers["heat"] = ("prediction", lambda: _heat(record))
        if _checked(path, "prediction", lambda: budgets(stages["prediction"])):
            makers["budget"] = ("prediction", lambda: _budget(record))
    if "ensemble" in held:
        makers["ensemble"] = ("ensemble", lambda: ensemble_section(Results(path)))
    others = held - set(ORDER) - set(GROUPS)
    if others:
        makers["other"] = ("other groups", lambda: other_stages(path, others))
    return {anchor: _checked(path, stage, make) for anchor, (stage, make) in makers.items()}


def _checked(path: Path, stage: str, make: Callable[[], T]) -> T:
    """What a function makes of a stage; a stage that is no such thing is told as a bad file."""
    try:
        return make()
    except BadFileError:
        raise
    except _DAMAGE as error:
        reason = f"no {error}" if isinstance(error, KeyError) else str(error) or type(error).__name__
        raise BadFileError(
            f"{path}: {stage}: not as bedrad writes it ({reason}); run the job again, or with a new results file"
        ) from error


def _wall_layer(record: Record, bed: Packing | None, job: dict[str, Any]) -> Html:
    data = record.stages["statistics"]
    parts: list[str] = [statistics_tables(data, record.stages.get("prediction"))]
    parts.append(
        embedded(
            profile_figure(data, record.name),
            "Solid fraction against depth below the wall with the means of the layers; below it the number of sphere "
            "centres and of contacts per volume. The tables above have the means.",
            "Profiles of solid fraction, sphere centres and contacts below the wall.",
        )
    )
    if bed is not None:
        margin = float(job.get("layers", {}).get("margin", 4.0))
        unrolled = unrolled_wall(bed, float(data["contact_gap"]), margin=margin, overhang=bed.mean_diameter)
        touching = int((unrolled.contact & unrolled.inside).sum())
        apart = int((~unrolled.contact & unrolled.inside).sum())
        parts.append(
            embedded(
                unrolled_wall_figure(unrolled, record.name),
                f"The wall unrolled into a plane: {touching:,} particles touch it, {apart:,} have volume in its layer "
                "without contact, and the rest is void.",
                "The wall unrolled: particles that touch it, particles in its layer that do not, and void.",
                dots=len(unrolled.spheres) > _MOST_OUTLINES,
            )
        )
    return page_section("wall-layer", "Wall layer", *parts)


def _view_factors(record: Record) -> Html:
    data = record.stages["view_factors"]
    parts: list[str] = [
        view_factor_tables(data),
        embedded(
            draw(_only(record, "view_factors"))["view_factors"],
            "View factors from the wall against depth, traced and published; beside them what meets no layer. "
            "The table above has the numbers.",
            "View factors against depth below the wall.",
        ),
    ]
    history = history_figure(data, record.name)
    if history is not None:
        parts.append(
            embedded(
                history,
                "Standard errors of the view factors falling with run time, round by round of the run, against the "
                "reciprocal root of the number of rays.",
                "Error of this run against its run time.",
            )
        )
    return page_section("view-factors", "View factors", *parts)


def _convergence(record: Record) -> Html:
    picture = embedded(
        draw(_only(record, "convergence"))["convergence"],
        "True and stated error of the view factors against run time and against the number of rays. The tables above "
        "have the slopes and the numbers for the wall layer.",
        "Error against run time and number of rays, true and as stated.",
    )
    tables = convergence_tables(record.stages["convergence"])
    return page_section("convergence", "Error against run time", tables, picture)


def _heat(record: Record) -> Html:
    drawn = draw(_only(record, "prediction"))
    pictures = [
        embedded(
            drawn["heat_transfer"],
            "Heat transfer coefficient against wall temperature with radiation and without, and what radiation adds, "
            "for each case of the tables below.",
            "Heat transfer against wall temperature, with radiation and without.",
        ),
        embedded(
            drawn["conductivities"],
            "Conductivity of the wall layer against wall temperature by conduction and by radiation, for each case of "
            "the tables below.",
            "Conductivity of the wall layer, by conduction and by radiation.",
        ),
    ]
    return page_section("heat", "Heat transfer", *pictures, prediction_tables(record.stages["prediction"]))


def _budget(record: Record) -> Html:
    prediction = record.stages["prediction"]
    picture = embedded(
        budget_figure(prediction),
        "Bars for the inputs that matter most to the heat transfer coefficient at the hottest wall. The tables below "
        "have all of them.",
        "What each input does to the heat transfer coefficient.",
    )
    return page_section("budget", "What makes the uncertainty", picture, budget_tables(prediction))


def _only(record: Record, stage: str) -> Record:
    """The results with one stage, so that only its figures are drawn."""
    return Record(record.name, record.attributes, {stage: record.stages[stage]})
