"""The printed tables of Nguyen (2015) in tests/references."""

from __future__ import annotations

import csv
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "references"


def rows(name):
    """Rows of a table as dictionaries of strings."""
    with (FOLDER / f"nguyen_{name}.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def budget(name):
    """One budget of uncertainties: by input, its numbers, None where nothing is printed."""
    columns = ("value", "uncertainty", "sensitivity", "squared", "share_percent")
    return {
        row["input"]: {column: float(row[column]) if row[column] else None for column in columns}
        for row in rows("uncertainties")
        if row["budget"] == name
    }
