"""Sections of the page on heat transfer: the key numbers, every case against wall temperature, what makes the error."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bedrad.heat.budget import LABELS
from bedrad.jobs.results import StageData
from bedrad.report.page_html import Html, element, given, joined, measured, number, table
from bedrad.report.records import (
    Record,
    cases,
    celsius,
    evenly,
    is_published,
    own_and_published,
    radiation_gain,
    stated,
    targets,
)

__all__ = ["budget_tables", "budgets", "glance", "prediction_tables"]

_BULK = {"zbs": "Zehner, Bauer and Schlünder", "table 5.2": "Table 5.2 (Watkins 2018)"}

_COLUMNS = (
    ("h\n[W/(m² K)]", "heat_transfer_coefficient", 1.0),
    ("h without\nradiation", "heat_transfer_coefficient_without", 1.0),
    ("Nu [–]", "nusselt", 1.0),
    ("k wall layer,\nconduction\n[mW/(m K)]", "wall_layer_conductivity", 1e3),
    ("k wall layer,\nradiation\n[mW/(m K)]", "radiative_conductivity", 1e3),
    ("k bulk\n[mW/(m K)]", "bulk_conductivity", 1e3),
)


def glance(record: Record) -> Html:
    """The numbers that a reader looks for first."""
    items = []
    stages = record.stages
    if "prediction" in stages:
        own, _ = own_and_published(cases(stages["prediction"]))
        for key, case in own.items():
            T = float(np.atleast_1d(celsius(case["wall_temperature"]))[-1])
            h = _value(case, "heat_transfer_coefficient", -1)
            gain = 100 * float(np.atleast_1d(radiation_gain(case))[-1])
            items.append(
                (f"heat transfer at {given(T)} °C, {_case(key)}", h, f"W/(m² K); radiation adds {number(gain, 2)} %")
            )
    if "view_factors" in stages:
        first = next(targets(stages["view_factors"]))
        items.append(("view factor to the wall layer", measured(first.factor, first.error), ""))
    if "statistics" in stages:
        data = stages["statistics"]
        text = measured(float(data["packing_fraction"]), float(data["packing_fraction_error"]))
        items.append(("solid fraction of the wall layer", text, ""))
    pairs = [
        element("div", element("dt", what), element("dd", value, " ", element("small", unit)))
        for what, value, unit in items
    ]
    return element("dl", *pairs, class_="glance") if pairs else Html("")


def _case(key: str) -> str:
    return {"measured": "from the bed", "correlations": "by correlation"}.get(key, key)


def _value(case: StageData, name: str, k: int, scale: float = 1.0) -> str:
    value = scale * float(np.atleast_1d(case[name])[k])
    error = case.get(f"{name}_error")
    return measured(value, math.nan if error is None else scale * float(np.atleast_1d(stated(error))[k]))


def prediction_tables(prediction: StageData) -> Html:
    """Each case of the job against wall temperature, what went into it, and the published systems."""
    found = cases(prediction)
    own, published = own_and_published(found)
    parts: list[str] = []
    for key, case in own.items():
        parts.append(_against_temperature(f"Heat transfer, {_case(key)}: {case['title']}", case))
    if found:
        parts.append(_inputs(found))
    if published:
        parts.append(_published(published))
    return joined(parts)


def _against_temperature(caption: str, case: StageData) -> Html:
    T = np.atleast_1d(celsius(case["wall_temperature"]))
    gain = 100 * np.atleast_1d(radiation_gain(case))
    columns = [column for column in _COLUMNS if column[1] in case]
    rows = [
        [given(float(t)), *(_value(case, name, k, scale) for _, name, scale in columns), number(float(gain[k]), 3)]
        for k, t in enumerate(T)
    ]
    bulk = str(case["bulk_model"])
    notes = [f"Bulk conductivity by {_BULK.get(bulk, bulk)}."]
    if np.isfinite(stated(case["heat_transfer_coefficient_error"])).any():
        notes.append("±: standard error from the inputs that state one.")
    if "radiation_bound" in case:
        bound = 100 * float(np.max(case["radiation_bound"]))
        notes.append(
            f"Radiation from the wall alone, without that inside the bulk, adds at most {number(bound, 3)} % to h: a "
            "bound known before any tracing."
        )
    headings = ["T of wall\n[°C]", *(heading for heading, _, _ in columns), "added by\nradiation\n[%]"]
    return table(caption, headings, rows, notes)


def _inputs(found: Mapping[str, StageData]) -> Html:
    """What each case is about, a case a column."""
    lines = (
        ("tube diameter D [mm]", "tube_diameter", 1e3),
        ("particle diameter d [µm]", "particle_diameter", 1e6),
        ("velocity U [m/s]", "velocity", 1.0),
        ("A = D/d [–]", "diameter_ratio", 1.0),
        ("conductivity of the particles [W/(m K)]", "solid_conductivity", 1.0),
        ("porosity of the bulk [–]", "porosity", 1.0),
        ("emissivity in the bulk [–]", "emissivity", 1.0),
        ("solid fraction of the wall layer [–]", "packing_fraction", 1.0),
        ("wall contacts [1/mm²]", "contacts_per_area", 1e-6),
        ("distance of NC particles [radii]", "nc_distance", 1.0),
    )
    rows = [
        [text, *(_scalar(case, name, scale) for case in found.values())]
        for text, name, scale in lines
        if all(name in case for case in found.values())
    ]
    deepest = max(len(case["view_factors"]) for case in found.values())
    rows += [
        [
            f"view factor to {'the wall layer' if k == 0 else f'layer {k + 1}'} [–]",
            *(_value(case, "view_factors", k) if k < len(case["view_factors"]) else "" for case in found.values()),
        ]
        for k in range(deepest)
    ]
    heads = [_case(key) if not is_published(key) else key.replace("_", " ") for key in found]
    return table("What went in", ["", *heads], rows)


def _scalar(case: StageData, name: str, scale: float) -> str:
    error = case.get(f"{name}_error", math.nan)
    return measured(scale * float(case[name]), scale * float(stated(error)))


def _published(published: Mapping[str, StageData]) -> Html:
    """What radiation adds in the published systems."""
    rows = []
    chosen: NDArray[np.int64] = np.array([0], dtype=np.int64)
    for case in published.values():
        T = np.atleast_1d(celsius(case["wall_temperature"]))
        chosen = evenly(len(T), 6)
        gain = 100 * np.atleast_1d(radiation_gain(case))
        rows.append([str(case["title"]), *(number(float(gain[k]), 3) for k in chosen),
                     _value(case, "heat_transfer_coefficient", -1)])  # fmt: skip
    heads = [f"{given(float(T[k]))} °C" for k in chosen]
    columns = ["system", *(f"added at\n{head} [%]" for head in heads), f"h at {heads[-1]}\n[W/(m² K)]"]
    return table("What radiation adds in the published systems", columns, rows,
                 ["Watkins 2018, Table 5.1; up to 29 % was published."])  # fmt: skip


def budgets(prediction: StageData) -> dict[str, StageData]:
    """Cases of the job's own tube that hold a budget of uncertainty."""
    own, _ = own_and_published(cases(prediction))
    return {
        key: case for key, case in own.items()
        if isinstance(case.get("budget"), dict) and "elasticities" in case["budget"]
    }  # fmt: skip


def budget_tables(prediction: StageData) -> Html:
    """What every input does to h at the hottest wall, a table a case."""
    parts = []
    for key, case in budgets(prediction).items():
        held = case["budget"]
        # the columns of a budget are in the job's order of temperatures
        T = np.atleast_1d(prediction[key]["wall_temperature"])
        k = int(np.argmax(T))
        names = [str(name) for name in held["inputs"]]
        columns = {name: np.asarray(held[name], dtype=float).reshape(len(names), -1)[:, k] for name in
                   ("values", "errors", "elasticities", "contributions", "shares")}  # fmt: skip
        order = np.lexsort((-np.abs(columns["elasticities"]), -columns["contributions"]))
        rows = []
        for i in order:
            text, unit, scale = LABELS.get(names[i], (names[i].replace("_", " "), "SI", 1.0))
            value = measured(scale * columns["values"][i], scale * columns["errors"][i])
            error = columns["contributions"][i]
            rows.append(
                [
                    f"{text} [{_UNITS.get(unit, unit)}]",
                    value,
                    number(columns["elasticities"][i], 3),
                    number(error, 2) if error > 0 else "–",
                    number(100 * columns["shares"][i], 2) if error > 0 else "–",
                ]
            )
        caption = f"What matters at {given(float(celsius(T[k])))} °C, {_case(key)}"
        heads = [
            "input",
            "value",
            "h changes by [%]\nfor 1 % of it",
            "error of h\n[W/(m² K)]",
            "share of\nvariance [%]",
        ]
        parts.append(table(caption, heads, rows))
    note = "Conductivities of gas and bulk relative to their models (×). A dash: the input states no error."
    return joined([*parts, element("p", note, class_="note")])


_UNITS = {"": "–", "um": "µm", "1/mm2": "1/mm²", "kW/m2": "kW/m²", "x": "×"}
