"""Tables as CSV: columns with units in their names, numbers with all their digits."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.atomic import atomic_path
from bedrad.jobs.fields import Field

__all__ = ["Table", "heading", "write_table", "write_tables_beside"]

Table = dict[str, list[Any]]
"""Names of columns, units included, to their values."""

_RADII = ("nc_distance", "nc_distance_weighted", "nc_distance_closing", "contact_gap", "gap_tolerances")
"""Numbers without unit in the results file that are lengths in particle radii."""

_WORDS = {"_": " ", "nusselt": "Nusselt number", "without": "without radiation", "nc ": "no-contact "}


def write_table(path: Path, table: Table) -> None:
    """Write one table as CSV, whole or not at all; OSError if it cannot be written."""
    with atomic_path(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(table)
        writer.writerows([_cell(value) for value in row] for row in zip(*table.values(), strict=True))


def write_tables_beside(stem: Path, tables: Mapping[str, Table]) -> list[Path]:
    """Write tables as ``<stem>_<name>.csv`` and return the files; OSError as `write_table`."""
    files = [stem.with_name(f"{stem.name}_{name}.csv") for name in tables]
    for file, table in zip(files, tables.values(), strict=True):
        write_table(file, table)
    return files


def _cell(value: Any) -> str:
    """Shortest text that reads back as the same number; empty for none."""
    if value is None:
        return ""
    if isinstance(value, (float, np.floating)):
        return "" if math.isnan(value) else repr(float(value))
    return str(value)


def heading(name: str, fields: Mapping[str, Field]) -> str:
    """Name of a column for a field of the results file, with its unit where it is a number."""
    field = name.removesuffix("_error")
    words = name
    for short, long in _WORDS.items():
        words = words.replace(short, long)
    unit = "particle radii" if field in _RADII else fields[field][0]
    return f"{words} [{unit}]" if unit else words
