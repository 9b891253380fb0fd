"""CSV tables beside a results file, with units in the column names."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.atomic import atomic_path
from bedrad.jobs.fields import CONVERGENCE, PREDICTION, STATISTICS, SYSTEM, WALL_LAYER, Field
from bedrad.jobs.results import Results, StageData
from bedrad.report.records import Record, cases, celsius, load, radiation_gain, stated, targets

__all__ = ["Table", "write_table", "write_tables"]

Table = dict[str, list[Any]]
"""Names of columns, units included, to their values."""


def write_tables(results: Results, folder: Path) -> list[Path]:
    """Write a CSV table for every kind of result that a results file holds.

    The files are named after the results file: ``<stem>_prediction.csv`` and so on. Numbers have all their digits;
    a cell is empty where there is no number, such as the error of an input that states none.

    Parameters
    ----------
    results : Results
        The results file.
    folder : Path
        Where the tables go.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    BadFileError
        If the results file is missing or is something else.
    OSError
        If a table cannot be written; no half-written file stays behind.
    """
    record = load(results)
    written = []
    for name, table in _tables(record).items():
        path = Path(folder) / f"{results.path.stem}_{name}.csv"
        write_table(path, table)
        written.append(path)
    return written


def _tables(record: Record) -> dict[str, Table]:
    stages = record.stages
    tables: dict[str, Table] = {}
    if "prediction" in stages:
        found = cases(stages["prediction"])
        tables |= {"prediction": _prediction(found), "prediction_inputs": _prediction_inputs(found)}
    if "view_factors" in stages:
        tables["view_factors"] = _view_factors(stages["view_factors"])
    if "statistics" in stages:
        data = stages["statistics"]
        tables |= {
            "statistics": _statistics(data),
            "layers": _layers(data),
            "contacts": _contacts(data),
            "profile": _profile(data),
        }
    if "convergence" in stages:
        data = stages["convergence"]
        tables |= {"convergence": _convergence(data), "convergence_rates": _convergence_rates(data)}
    return tables


def write_table(path: Path, table: Table) -> None:
    """Write one table as CSV, whole or not at all; OSError if it cannot be written."""
    with atomic_path(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(table)
        writer.writerows([_cell(value) for value in row] for row in zip(*table.values(), strict=True))


def _cell(value: Any) -> str:
    """Shortest text that reads back as the same number; empty for none."""
    if value is None:
        return ""
    if isinstance(value, (float, np.floating)):
        return "" if math.isnan(value) else repr(float(value))
    return str(value)


_RADII = ("nc_distance", "nc_distance_weighted", "nc_distance_closing", "contact_gap", "gap_tolerances")
"""Numbers without unit in the results file that are lengths in particle radii."""

_WORDS = {"_": " ", "nusselt": "Nusselt number", "without": "without radiation", "nc ": "no-contact "}


def _heading(name: str, fields: Mapping[str, Field]) -> str:
    """Name of a column for a field of the results file, with its unit."""
    field = name.removesuffix("_error")
    words = name
    for short, long in _WORDS.items():
        words = words.replace(short, long)
    return f"{words} [{'particle radii' if field in _RADII else fields[field][0]}]"


def _extend(table: Table, columns: Iterable[tuple[str, Iterable[Any]]]) -> None:
    for heading, values in columns:
        table.setdefault(heading, []).extend(values)


_AGAINST_TEMPERATURE = (
    "heat_transfer_coefficient",
    "heat_transfer_coefficient_error",
    "heat_transfer_coefficient_without",
    "heat_transfer_coefficient_without_error",
    "nusselt",
    "nusselt_error",
    "nusselt_without",
    "nusselt_without_error",
    "wall_layer_conductivity",
    "wall_layer_conductivity_error",
    "radiative_conductivity",
    "radiative_conductivity_error",
    "bulk_conductivity",
    "bulk_conductivity_without",
    "gas_conductivity",
    "radiation_bound",
)


def _prediction(found: Mapping[str, StageData]) -> Table:
    """Every case and wall temperature a row."""
    table: Table = {}
    for key, case in found.items():
        T = np.atleast_1d(case["wall_temperature"])
        n = len(T)
        columns: list[tuple[str, Iterable[Any]]] = [
            ("case", [key] * n),
            ("title", [case["title"]] * n),
            ("bulk model", [case["bulk_model"]] * n),
            *((_heading(name, SYSTEM), [case[name]] * n) for name in SYSTEM),
            (_heading("wall_temperature", PREDICTION), T),
            ("wall temperature [degC]", celsius(T)),
        ]
        for name in _AGAINST_TEMPERATURE:
            values = np.atleast_1d(case[name])
            columns.append((_heading(name, PREDICTION), stated(values) if name.endswith("_error") else values))
        columns.append(("radiation gain [1]", np.atleast_1d(radiation_gain(case))))
        _extend(table, columns)
    return table


def _prediction_inputs(found: Mapping[str, StageData]) -> Table:
    """What each case takes for the wall layer: a case a row."""
    table: Table = {}
    layers = max(len(case["view_factors"]) for case in found.values())
    for key, case in found.items():
        columns: list[tuple[str, Iterable[Any]]] = [("case", [key]), ("title", [case["title"]])]
        for name in WALL_LAYER:
            columns.append((_heading(name, WALL_LAYER), [case[name]]))
            columns.append((_heading(f"{name}_error", WALL_LAYER), [float(stated(case[f"{name}_error"]))]))
        for k in range(layers):
            factor, error = (
                float(case[name][k]) if k < len(case[name]) else math.nan
                for name in ("view_factors", "view_factors_error")
            )
            columns.append((f"view factor to layer {k + 1} [1]", [factor]))
            columns.append((f"view factor to layer {k + 1} error [1]", [float(stated(error))]))
        _extend(table, columns)
    return table


_VIEW_FACTOR_COLUMNS = {
    "name": "target",
    "near": "depth from [m]",
    "far": "depth to [m]",
    "factor": "view factor [1]",
    "ray_error": "ray error [1]",
    "bed_error": "bed error [1]",
    "watkins": "view factor normalised as Watkins (2018) [1]",
    "watkins_ray_error": "ray error normalised as Watkins (2018) [1]",
    "watkins_bed_error": "bed error normalised as Watkins (2018) [1]",
    "published": "published by Watkins (2018) Table 5.3 [1]",
}


def _view_factors(data: StageData) -> Table:
    """Every target a row, and the sums in the last."""
    rows = list(targets(data))
    table: Table = {}
    for name, heading in _VIEW_FACTOR_COLUMNS.items():
        column = [getattr(row, name) for row in rows]
        total: Any = math.nan
        if name == "name":
            total = "sum"
        elif name in ("factor", "watkins", "published") and not np.isnan(column).all():
            total = math.fsum(value for value in column if not math.isnan(value))
        table[heading] = [*column, total]
    return table


_WALL_LAYER_STATISTICS = (
    "packing_fraction",
    "contacts_per_area",
    "contact_ratio",
    "nc_share",
    "nc_distance",
    "nc_distance_weighted",
    "nc_distance_closing",
)

_COUNTS = ("contact_gap", "mean_diameter", "spheres", "contacts", "no_contacts", "overlap_share", "seconds")


def _statistics(data: StageData) -> Table:
    """The wall layer in one row."""
    names = [f"{name}{suffix}" for name in _WALL_LAYER_STATISTICS for suffix in ("", "_error")]
    return {_heading(name, STATISTICS): [data[name]] for name in (*names, *_COUNTS)}


def _layers(data: StageData) -> Table:
    edges = data["edges"]
    return {
        "layer": list(range(1, len(edges))),
        "depth from [m]": list(edges[:-1]),
        "depth to [m]": list(edges[1:]),
        "solid fraction [1]": list(data["packing_fractions"]),
        "solid fraction error [1]": list(data["packing_fractions_error"]),
    }


def _contacts(data: StageData) -> Table:
    table: Table = {"gap tolerance [particle radii]": list(data["gap_tolerances"])}
    for name in ("contacts_per_area", "contact_ratio"):
        for suffix in ("", "_error"):
            table[_heading(f"{name}{suffix}", STATISTICS)] = list(data[f"{name}_by_gap{suffix}"])
    return table


def _profile(data: StageData) -> Table:
    depths, radius = data["profile_depths"], 0.5 * data["mean_diameter"]
    middle = 0.5 * (depths[:-1] + depths[1:])
    return {
        "depth from [m]": list(depths[:-1]),
        "depth to [m]": list(depths[1:]),
        "mean depth [particle radii]": list(middle / radius),
        "solid fraction [1]": list(data["profile"]),
        "solid fraction error [1]": list(data["profile_error"]),
    }


def _convergence(data: StageData) -> Table:
    """Every number of rays a row."""
    table: Table = {
        _heading("rays", CONVERGENCE): list(data["rays"]),
        "run time [s]": list(data["seconds"]),
    }
    for kind in ("true_error", "stated_error"):
        for k, name in enumerate(data["names"]):
            table[f"{kind.replace('_', ' ')} of {name} [1]"] = list(data[kind][:, k])
    return table


def _convergence_rates(data: StageData) -> Table:
    """Every target a row: how fast its error falls, and what it was held against."""
    n = len(data["names"])
    return {
        "target": list(data["names"]),
        "exponent of rays [1]": list(data["exponent"]),
        "exponent of rays error [1]": list(data["exponent_error"]),
        "reference view factor [1]": list(data["reference"]),
        "reference view factor error [1]": list(data["reference_error"]),
        "reference rays [1]": [data["reference_rays"]] * n,
        _heading("seeds", CONVERGENCE): [data["seeds"]] * n,
    }
