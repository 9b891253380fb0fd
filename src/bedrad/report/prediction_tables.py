"""Tables of predictions: a row a flow and wall temperature, and a row an input of its uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bedrad.heat.prediction import Prediction
from bedrad.report.csv_tables import Table, write_table, write_tables_beside

__all__ = ["budget_table", "prediction_table", "write_prediction_tables"]

_SYSTEM = {
    "tube diameter [m]": "tube_diameter",
    "particle diameter [m]": "particle_diameter",
    "velocity [m/s]": "velocity",
}

_COLUMNS = {
    "wall temperature [K]": "wall_temperature",
    "mean temperature [K]": "mean_temperature",
    "temperature of the wall layer's properties [K]": "wall_layer_temperature",
    "temperature of the bulk's properties [K]": "bulk_temperature",
    "heat transfer coefficient [W/(m2 K)]": "heat_transfer_coefficient",
    "its standard error [W/(m2 K)]": "heat_transfer_coefficient_error",
    "heat transfer coefficient without radiation [W/(m2 K)]": "heat_transfer_coefficient_without",
    "its standard error without radiation [W/(m2 K)]": "heat_transfer_coefficient_without_error",
    "share of radiation [1]": "radiation_share",
    "Nusselt number [1]": "nusselt",
    "Nusselt number, standard error [1]": "nusselt_error",
    "wall-layer conductivity [W/(m K)]": "wall_layer_conductivity",
    "wall-layer conductivity, standard error [W/(m K)]": "wall_layer_conductivity_error",
    "radiative conductivity [W/(m K)]": "radiative_conductivity",
    "radiative conductivity, standard error [W/(m K)]": "radiative_conductivity_error",
    "bulk conductivity [W/(m K)]": "bulk_conductivity",
    "bulk conductivity without radiation [W/(m K)]": "bulk_conductivity_without",
    "gas conductivity [W/(m K)]": "gas_conductivity",
}


_DRAWN = (
    "heat transfer coefficient, mean of draws [W/(m2 K)]",
    "heat transfer coefficient, standard deviation of draws [W/(m2 K)]",
    "heat transfer coefficient, 2.5 % of draws below [W/(m2 K)]",
    "heat transfer coefficient, 97.5 % of draws below [W/(m2 K)]",
)
"""Columns of a Monte Carlo propagation; empty without one."""


def write_prediction_tables(found: Sequence[Prediction], path: Path) -> list[Path]:
    """Write the predictions to a path and their budgets beside it, as ``<stem>_budget.csv``.

    Raises
    ------
    OSError
        If a table cannot be written.
    """
    write_table(path, prediction_table(found))
    return [path, *write_tables_beside(path.with_suffix(""), {"budget": budget_table(found)})]


def prediction_table(found: Sequence[Prediction]) -> Table:
    """All predicted numbers, a row a flow and wall temperature; empty where there is none."""
    names = (*_SYSTEM, *_COLUMNS, *_DRAWN, "bulk model", "temperature of properties")
    table: Table = {name: [] for name in names}
    for one in found:
        count = np.size(one.wall_temperature)
        for heading, name in _SYSTEM.items():
            table[heading] += [getattr(one.system, name)] * count
        for heading, name in _COLUMNS.items():
            table[heading] += list(np.atleast_1d(getattr(one, name)))
        many = one.monte_carlo
        h = "heat_transfer_coefficient"
        drawn = [None] * 4 if many is None else [many.mean[h], many.standard_deviation[h], *many.interval[h]]
        for heading, values in zip(_DRAWN, drawn, strict=True):
            table[heading] += [None] * count if values is None else list(values)
        table["bulk model"] += [one.bulk_model] * count
        table["temperature of properties"] += [one.property_temperature] * count
    return table


def budget_table(found: Sequence[Prediction]) -> Table:
    """What every input does to h: a row a flow, wall temperature and input.

    Values are in SI units, the conductivities of gas and bulk relative to their models.
    """
    inputs = (
        "input",
        "value",
        "standard error",
        "elasticity of h [1]",
        "error of h [W/(m2 K)]",
        "share of variance [1]",
    )
    table: Table = {name: [] for name in (*_SYSTEM, "wall temperature [K]", *inputs)}
    for one in found:
        budget = one.budget
        for column, T in enumerate(budget.wall_temperature):
            columns = (budget.values, budget.errors, budget.elasticities, budget.contributions, budget.shares)
            for row, name in enumerate(budget.names):
                for heading, attribute in _SYSTEM.items():
                    table[heading].append(getattr(one.system, attribute))
                table["wall temperature [K]"].append(T)
                table["input"].append(name.replace("_", " "))
                for heading, array in zip(inputs[1:], columns, strict=True):
                    table[heading].append(array[row, column])
    return table
