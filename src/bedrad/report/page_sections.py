"""Sections of the page on a bed: what was computed, the measured wall layer, view factors and their convergence."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from bedrad.jobs.results import StageData
from bedrad.jobs.stages import BY_SECTION, ORDER
from bedrad.report.page_html import Html, element, joined, measured, number, page_section, table
from bedrad.report.records import Record, correlated_layer, targets

__all__ = [
    "TITLES",
    "bed_facts",
    "computed",
    "convergence_tables",
    "seconds",
    "statistics_tables",
    "view_factor_tables",
]

TITLES: Mapping[str, str] = {
    "packing": "bed",
    "flow": "flow",
    "statistics": "packing statistics",
    "view_factors": "view factors",
    "convergence": "convergence",
    "prediction": "heat transfer",
}
"""What the stages are called on the page."""


def computed(record: Record, job: StageData, held: set[str]) -> Html:
    """What was computed and how long it took, and what was left out and why.

    Parameters
    ----------
    record : Record
        The results.
    job : mapping
        The job, as resolved.
    held : set of str
        Groups of the file.
    """
    rows = [[TITLES[stage], _what(stage, data), _run_time(stage, data)] for stage, data in _in_order(record)]
    if "ensemble" in held:
        rows.append(["many beds", "each measured as the job says; their means below", "–"])
    parts: list[str] = [table("Stages", ["stage", "what", "run time"], rows, words=[1])]
    reasons = _left_out(record, job, held)
    if reasons:
        parts.append(element("h3", "Left out"))
        parts.append(element("ul", *(element("li", reason) for reason in reasons)))
    return page_section("computed", "What was computed, and what was left out", *parts)


def _in_order(record: Record) -> list[tuple[str, StageData]]:
    return [(stage, record.stages[stage]) for stage in ORDER if stage in record.stages]


def _what(stage: str, data: StageData) -> str:
    if stage == "packing":
        return f"{len(data['radii']):,} spheres"
    if stage == "statistics":
        return (
            f"{data['spheres']:,} spheres in the window, a gap up to {data['contact_gap']:g} radii counting as contact"
        )
    if stage == "view_factors":
        return f"{len(data['layers'])} layers, {data['rays']:,} rays, seed {data.get('seed', 'not known')}"
    if stage == "convergence":
        return f"{len(data['rays'])} numbers of rays up to {max(data['rays']):,}, {data['seeds']} seeds each"
    found = [case for case in data.values() if isinstance(case, dict)]
    temperatures = {np.size(case["wall_temperature"]) for case in found}
    return f"{len(found)} cases at {' or '.join(map(str, sorted(temperatures)))} wall temperatures"


def _run_time(stage: str, data: StageData) -> str:
    if stage == "packing":
        spent = data.get("provenance", {}).get("run_seconds")
        return "–" if spent is None else seconds(float(spent))
    name = "total_seconds" if stage == "convergence" else "seconds"
    return seconds(float(data[name])) if name in data else "–"


def seconds(time: float) -> str:
    """A run time with its unit."""
    return f"{number(time, 3)} s" if time < 600 else f"{number(time / 60, 3)} min"


def _left_out(record: Record, job: StageData, held: set[str]) -> list[str]:
    reasons = []
    for stage in BY_SECTION:
        if stage in record.stages or ("ensemble" in held and job.get(stage) is not None):
            continue
        if job.get(stage) is not None:
            reasons.append(f"{TITLES[stage]}: asked for, and not finished")
        elif stage in held:
            reasons.append(f"{TITLES[stage]}: the job has no [{stage}]; what the file keeps is from an earlier job")
        else:
            reasons.append(f"{TITLES[stage]}: the job has no [{stage}]")
    if "statistics" in record.stages:
        data = record.stages["statistics"]
        for key, text in (("outside_window", "outside the window, where the open ends disturb the bed"),
                          ("deeper", "deeper than the layers")):  # fmt: skip
            if data.get(f"left_out_{key}"):
                reasons.append(f"packing statistics: {data[f'left_out_{key}']:,} spheres {text}")
    traced = record.stages.get("view_factors", {}).get("left_out", "no spheres")
    if traced != "no spheres":
        reasons.append(f"view factors: {traced}")
    return reasons


def bed_facts(record: Record) -> Html:
    """The wall, the spheres and where the bed comes from."""
    data = record.stages["packing"]
    radii = np.asarray(data["radii"], dtype=float)
    diameters = 2e6 * radii
    size = f"{number(float(diameters.mean()))} µm"
    if np.ptp(diameters) > 1e-6 * diameters.mean():
        size += f" in the mean, {number(float(diameters.min()))} to {number(float(diameters.max()))} µm"
    wall = str(data["wall"])
    if "wall_radius" in data:
        wall += f", {number(2e3 * float(data['wall_radius']))} mm in diameter"
    rows = [["wall", wall], ["spheres", f"{len(radii):,}"], ["particle diameter", size]]
    if "period" in data:
        periods = ", ".join(number(1e3 * float(length)) for length in np.atleast_1d(data["period"]))
        rows.append(["repeats after", f"{periods} mm"])
    return table("Wall and spheres", ["", "value"], rows, words=[1])


_WALL_LAYER = (
    ("solid fraction [–]", "packing_fraction", 1.0),
    ("wall contacts per area [1/mm²]", "contacts_per_area", 1e-6),
    ("wall contacts over their hexagonal maximum [–]", "contact_ratio", 1.0),
    ("share of particles without contact (NC) [–]", "nc_share", 1.0),
    ("distance of NC particles from the wall, mean [radii]", "nc_distance", 1.0),
    ("the same, weighted by volume in the layer [radii]", "nc_distance_weighted", 1.0),
    ("the same, as the one that closes the solid volume [radii]", "nc_distance_closing", 1.0),
    ("particles with fewer than four contacts [–]", "rattler_share", 1.0),
    ("bond order |ψ₆| of particles at the wall [–]", "hexagonal_order", 1.0),
)


def statistics_tables(data: StageData, prediction: StageData | None) -> Html:
    """The wall layer beside its correlations, the layers, and contacts against the gap that counts as one."""
    correlated = correlated_layer(prediction)
    rows = []
    for text, name, scale in _WALL_LAYER:
        if name not in data:
            continue
        given = getattr(correlated, name, None)
        correlation = "" if given is None else number(scale * given)
        rows.append([text, measured(scale * float(data[name]), scale * float(data[f"{name}_error"])), correlation])
    columns = ["", "measured"] if correlated is None else ["", "measured", "by correlation"]
    notes = ["±: standard error from block to block of the bed."]
    if correlated is not None:
        notes.append(f"By correlation: a flow at {correlated.velocity:g} m/s (Watkins 2018, eq. 31 and 38 to 40).")
    first = table(
        "Measured and by correlation" if correlated else "Measured",
        columns,
        [row[: len(columns)] for row in rows],
        notes,
    )
    edges = 1e3 * np.asarray(data["edges"], dtype=float)
    layers = [
        [
            "wall layer" if k == 0 else f"layer {k + 1}",
            f"{number(edges[k], 3)} to {number(edges[k + 1], 3)}",
            _with_error(data, "packing_fractions", k),
            _with_error(data, "coordination", k),
        ]
        for k in range(len(edges) - 1)
    ]
    second = table("Layers", ["layer", "depth [mm]", "solid fraction [–]", "contacts of a sphere [–]"], layers)
    gaps = [
        [
            f"{float(gap):g}",
            *(
                _with_error(data, f"{name}_by_gap", k, scale)
                for name, scale in (("contacts_per_area", 1e-6), ("contact_ratio", 1.0), ("nc_share", 1.0))
            ),
        ]
        for k, gap in enumerate(data["gap_tolerances"])
    ]
    headings = ["gap that counts [radii]", "wall contacts [1/mm²]", "over hexagonal maximum [–]", "NC share [–]"]
    return joined([first, second, table("Wall contacts against the gap that counts as contact", headings, gaps)])


def _with_error(data: StageData, name: str, k: int, scale: float = 1.0) -> str:
    if name not in data:
        return "–"
    return measured(scale * float(data[name][k]), scale * float(data[f"{name}_error"][k]))


_PLACES = {"beyond": "beyond the layers", "wall": "back to the wall", "escaped": "out at open ends"}


def view_factor_tables(data: StageData) -> Html:
    """View factors with the errors of rays and bed, and beside published ones."""
    found = list(targets(data))
    rows = []
    for row in found:
        depth = f"{number(1e3 * row.near, 3)} to {number(1e3 * row.far, 3)}" if row.name.startswith("layer") else ""
        rows.append(
            [
                {"layer 1": "wall layer"}.get(row.name, _PLACES.get(row.name, row.name)),
                depth,
                measured(row.factor, row.error),
                number(row.ray_error, 2),
                number(row.bed_error, 2),
                "" if math.isnan(row.watkins) else measured(
                    row.watkins, math.hypot(*np.nan_to_num((row.watkins_ray_error, row.watkins_bed_error)))),
                "" if math.isnan(row.published) else f"{row.published:.2f}",
            ]
        )  # fmt: skip
    total = math.fsum(row.factor for row in found)
    rows.append(["sum", "", number(total, 6), "", "", "", ""])
    low, high = (1e3 * float(x) for x in data["window"])
    notes = [
        "View factor [–] with the standard error of rays and bed together; then each of the two alone.",
        "Normalised: what meets no layer is spread over the layers, as in the published factors (Watkins 2018, Table "
        "5.3: 0.6 mm in a 7.75 mm tube, flow at 0.016 m/s).",
        f"Measured from {number(low)} to {number(high)} mm along the wall; {data['rays']:,} rays in "
        f"{seconds(float(data['seconds']))}.",
    ]
    columns = ["to", "depth [mm]", "view factor", "error of rays", "error of bed", "normalised", "published"]
    return table("View factors from the wall", columns, rows, notes)


def convergence_tables(data: StageData) -> Html:
    """How fast the error falls for each target, and the error of the wall layer's factor for each run."""
    names = [str(name) for name in data["names"]]
    rows = [
        [
            {"layer 1": "wall layer"}.get(name, _PLACES.get(name, name)),
            measured(float(data["reference"][k]), float(data["reference_error"][k])),
            measured(float(data["exponent"][k]), float(data["exponent_error"][k])),
        ]
        for k, name in enumerate(names)
    ]
    notes = [
        f"Reference: an independent run of {data['reference_rays']:,} rays. The error falls in proportion to the "
        "number of rays to the power given; −1/2 is that of independent rays."
    ]
    first = table("How fast the error falls", ["to", "reference [–]", "exponent [–]"], rows, notes)
    runs: list[list[str]] = []
    for i in np.argsort(data["rays"], kind="stable"):
        true, said = float(data["true_error"][i, 0]), float(data["stated_error"][i, 0])
        # a root mean square over n normal deviates scatters by 1/sqrt(2 n)
        scatter = true / math.sqrt(2 * float(data["seeds"]))
        runs.append(
            [f"{data['rays'][i]:,}", seconds(float(data["seconds"][i])), measured(true, scatter), number(said, 2)]
        )
    headings = ["rays", "run time", "true error [–]", "stated error [–]"]
    return joined([first, table(f"Error of the view factor to {names[0]}", headings, runs)])
