"""The CSV table of measured flows reduced, with the model beside them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bedrad.heat.measured_flow import Measured, ModelRun, ReducedRun
from bedrad.report.csv_tables import Table, write_table

__all__ = ["write_measured_table"]

_MEASURED = (
    ("wall temperature inside [K]", "wall_temperature"),
    ("mean temperature [K]", "mean_temperature"),
    ("power [W]", "power"),
    ("loss [W]", "loss"),
    ("wall heat flux [W/m2]", "heat_flux"),
    ("heat transfer coefficient [W/(m2 K)]", "heat_transfer_coefficient"),
    ("bulk conductivity [W/(m K)]", "bulk_conductivity"),
    ("Nusselt number [1]", "nusselt"),
)


def write_measured_table(path: Path, runs: Sequence[ReducedRun], model: Sequence[ModelRun] | None) -> None:
    """Write one row for each station of each run, with standard errors, and half widths of 95 % for h and Nu.

    Parameters
    ----------
    path : Path
        The file.
    runs : sequence of ReducedRun
        What was measured.
    model : sequence of ModelRun or None
        The model beside each run, if there is one.

    Raises
    ------
    OSError
        If it cannot be written; no half-written file stays behind.
    """
    parts = [_rows(run, None if model is None else model[k]) for k, run in enumerate(runs)]
    write_table(path, {name: [value for part in parts for value in part[name]] for name in parts[0]})


def _rows(run: ReducedRun, model: ModelRun | None) -> Table:
    count = run.position.size
    table: Table = {"run": [run.run.name] * count, "position [m]": run.position.tolist()}
    table["inverse Graetz number [1]"] = run.z_star.tolist()
    table["mass flow [kg/s]"] = [float(run.run.mass_flow.value)] * count
    for title, name in _MEASURED:
        values: Measured = getattr(run, name)
        quantity, _, unit = title.partition(" [")
        table[title] = values.value.tolist()
        table[f"{quantity} error [{unit}"] = values.error.tolist()
        if name in ("heat_transfer_coefficient", "nusselt"):
            table[f"{quantity} 95 % [{unit}"] = values.half_width().tolist()
    law, blank = run.first_law, [float("nan")] * count
    columns = {
        "first-law temperature [K]": None if law is None else law.balance.value,
        "first-law temperature error [K]": None if law is None else law.balance.error,
        "measured less first law [standard errors]": None if law is None else law.deviation,
        "heat found over heat given [1]": None if law is None else law.closure,
    }
    for title, found in columns.items():
        # without an inlet the balance starts at the first station
        table[title] = blank if found is None else blank[: count - found.size] + np.ravel(found).tolist()
    if model is not None:
        table["velocity [m/s]"] = [model.velocity] * count
        table["model Nusselt number developed [1]"] = np.ravel(model.stations.developed).tolist()
        table["model Nusselt number at z* [1]"] = np.ravel(model.stations.complete).tolist()
    return table
