"""CSV tables of the results of many beds: means, beds, and what failed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.jobs.fields import UNITS
from bedrad.jobs.locking import remove_leftovers
from bedrad.jobs.results import Results
from bedrad.jobs.unit_columns import field_of
from bedrad.report.csv_tables import Table, heading, write_tables_beside
from bedrad.report.ensemble_records import EnsembleRecord, flat, load_ensemble, mean_rows

__all__ = ["write_tables"]

_OF_UNITS = (
    "label",
    "key",
    "path",
    "frame",
    "content",
    "seed",
    "tube_diameter",
    "particle_diameter",
    "velocity",
    "bed_seed",
)


def write_tables(results: Results, folder: Path) -> list[Path]:
    """Write ``<stem>_means.csv`` (a quantity a row), ``<stem>_beds.csv`` (a bed a row) and ``<stem>_failures.csv``.

    The last only if beds failed; if none did, a table of failures that an earlier run of the same beds left is removed.

    Parameters
    ----------
    results : Results
        The results file of many beds.
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
    record = load_ensemble(results)
    stem = Path(folder) / results.path.stem
    tables = {"means": _means(record), "beds": _beds(record), "failures": _failures(record)}
    for name in tables:
        remove_leftovers(stem.with_name(f"{stem.name}_{name}.csv"))
    failures = tables["failures"]
    if not failures["label"]:
        del tables["failures"]
        _remove_stale(stem.with_name(f"{stem.name}_failures.csv"), failures)
    return write_tables_beside(stem, tables)


def _remove_stale(path: Path, table: Table) -> None:
    """Remove a table that is true no longer; a file of that name with other columns is not ours, and stays."""
    heading = ",".join(table).encode() + b"\n"
    if path.is_file():
        with path.open("rb") as stream:
            ours = stream.read(len(heading)) == heading
        if ours:
            path.unlink()


def _means(record: EnsembleRecord) -> Table:
    rows, groups = list(mean_rows(record)), record.groups
    table: Table = {heading(name, UNITS): [groups[row.group][name] for row in rows] for name in (groups or [{}])[0]}
    return table | {
        "beds": [row.beds for row in rows],
        "stage": [row.stage for row in rows],
        "quantity": [row.name for row in rows],
        "where": [row.where for row in rows],
        "units": [row.units for row in rows],
        "mean": [row.mean for row in rows],
        "standard error from bed to bed": [row.packing_error for row in rows],
        "of this from the rays": [row.ray_error for row in rows],
        "standard deviation from bed to bed": [row.scatter for row in rows],
        "standard error that one bed states": [row.unit_error for row in rows],
        "what it is": [row.title for row in rows],
    }


def _beds(record: EnsembleRecord) -> Table:
    """Every bed a row, with each quantity whose mean is taken, and its error."""
    units = record.units
    table: Table = {heading(name, UNITS): list(units[name]) for name in _OF_UNITS if name in units}
    if "problems" in units.get("flow", {}):
        table["flow/problems"] = list(units["flow"]["problems"])
    for stage, name in dict.fromkeys((row.stage, row.name) for row in mean_rows(record)):
        for key in (name, f"{name}_error"):
            values = flat(units.get(stage, {})).get(key)
            if values is None:
                continue
            label = field_of(stage, key)[0]
            for index in np.ndindex(values.shape[1:]):
                place = f" {index[0] + 1}" if index else ""
                table[f"{stage}/{key}{place} [{label}]"] = values[(slice(None), *index)].tolist()
    return table


def _failures(record: EnsembleRecord) -> Table:
    return {"label": list(record.failures["label"]), "error": list(record.failures["error"])}
