"""CSV tables beside a results file, with units in the column names."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.jobs.fields import CONVERGENCE, PREDICTION, SYSTEM, WALL_LAYER
from bedrad.jobs.results import Results, StageData
from bedrad.report.csv_tables import Table, heading, write_tables_beside
from bedrad.report.records import Record, cases, celsius, load, radiation_gain, stated, targets
from bedrad.report.statistics_tables import statistics_tables

__all__ = ["write_tables"]


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
    return write_tables_beside(Path(folder) / results.path.stem, _tables(record))


def _tables(record: Record) -> dict[str, Table]:
    stages = record.stages
    tables: dict[str, Table] = {}
    if "prediction" in stages:
        found = cases(stages["prediction"])
        tables |= {"prediction": _prediction(found), "prediction_inputs": _prediction_inputs(found)}
    if "view_factors" in stages:
        tables["view_factors"] = _view_factors(stages["view_factors"])
    if "statistics" in stages:
        tables |= statistics_tables(stages["statistics"])
    if "convergence" in stages:
        data = stages["convergence"]
        tables |= {"convergence": _convergence(data), "convergence_rates": _convergence_rates(data)}
    return tables


def _extend(table: Table, columns: Iterable[tuple[str, Iterable[Any]]]) -> None:
    for title, values in columns:
        table.setdefault(title, []).extend(values)


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
            *((heading(name, SYSTEM), [case[name]] * n) for name in SYSTEM),
            (heading("wall_temperature", PREDICTION), T),
            ("wall temperature [degC]", celsius(T)),
        ]
        for name in _AGAINST_TEMPERATURE:
            values = np.atleast_1d(case[name])
            columns.append((heading(name, PREDICTION), stated(values) if name.endswith("_error") else values))
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
            columns.append((heading(name, WALL_LAYER), [case[name]]))
            columns.append((heading(f"{name}_error", WALL_LAYER), [float(stated(case[f"{name}_error"]))]))
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
    for name, title in _VIEW_FACTOR_COLUMNS.items():
        column = [getattr(row, name) for row in rows]
        total: Any = math.nan
        if name == "name":
            total = "sum"
        elif name in ("factor", "watkins", "published") and not np.isnan(column).all():
            total = math.fsum(value for value in column if not math.isnan(value))
        table[title] = [*column, total]
    return table


def _convergence(data: StageData) -> Table:
    """Every number of rays a row."""
    table: Table = {
        heading("rays", CONVERGENCE): list(data["rays"]),
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
        heading("seeds", CONVERGENCE): [data["seeds"]] * n,
    }
