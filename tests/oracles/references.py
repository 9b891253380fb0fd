"""The reference view factors of tests/references."""

from __future__ import annotations

import csv
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "references"


def _rows(name):
    with (FOLDER / name).open(newline="") as file:
        return list(csv.DictReader(file))


def closed_form(case, parameters):
    """One view factor of the table of closed forms."""
    values = [float(r["view_factor"]) for r in _rows("view_factors_closed_form.csv")
              if (r["case"], r["parameters"]) == (case, parameters)]  # fmt: skip
    if len(values) != 1:
        raise LookupError(f"{len(values)} rows for {case!r}, {parameters!r}; expected one")
    return values[0]


def lattice_shells(lattice):
    """Rows (distance, neighbours, share, standard error) of one lattice, near to far."""
    fields = ("distance", "neighbours", "share", "standard_error")
    return [tuple(float(r[f]) for f in fields) for r in _rows("lattice_view_factors.csv") if r["lattice"] == lattice]
