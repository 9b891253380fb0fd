"""Tables of spheres with a separator: a header that names columns and units, one sphere a row, facts in comments."""

from __future__ import annotations

import csv
from array import array
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.byte_lines import ByteLines
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.csv_header import EXPECTED, Column, find_columns, names_positions
from bedrad.packings.files.facts import Facts, fact_comments
from bedrad.packings.files.format import Columns
from bedrad.packings.files.number_rows import ROWS_AT_ONCE, NumberRows
from bedrad.packings.files.text import open_text
from bedrad.packings.files.units import LENGTH_UNITS, metres
from bedrad.packings.packing import Packing

__all__ = ["looks_like_csv", "read_csv", "write_csv"]

_SEPARATORS = ",;\t"


def looks_like_csv(head: bytes) -> bool:
    """Whether the first line that is no comment is a header with a column x, y or z."""
    for line in head.decode("utf-8-sig", errors="replace").splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            separator = _separator(line)
            return separator is not None and names_positions(_cells(line, separator))
    return False


def read_csv(path: Path, columns: Columns | None = None) -> Contents:
    """Read spheres from a table with commas, semicolons or tabs between the fields.

    The header names the columns and their units, in any order and in many forms (``x [mm]``, ``Position[X] (m)``,
    ``Particle X-Coordinate: (m)``); columns other than positions and radius (or diameter) are passed over. Comment
    lines like ``# wall: tube radius=0.003875 m`` and ``# period: 0.02 m`` restore what `write_csv` wrote.

    Parameters
    ----------
    path : pathlib.Path
        The table, plain or gzip.
    columns : mapping, optional
        Columns of x, y, z, radius and diameter by their titles or their numbers from 1, where the titles do not tell;
        with numbers there need not be a header.

    Raises
    ------
    BadFileError
        If the header, a row or a comment cannot be understood; the message names the line.
    """
    facts = Facts(path)
    with open_text(path) as stream:
        lines = ByteLines(path, stream)
        table = _header(lines, facts, columns or {})
        values, numbered = _rows(lines, facts, table)
    # column by column in metres: a unit of m multiplies by one, and changes no bit
    found = {name: values[:, place] * table.metre(name) for place, name in enumerate(table.columns)}
    del values
    size = found["radius"] if "radius" in found else found["diameter"] / 2 if "diameter" in found else None
    return Contents(
        centers=np.stack([found["x"], found["y"], found["z"]], axis=1),
        radii=size,
        lines=array("q", numbered.tobytes()),
        states_unit=not table.no_unit,
        no_unit=table.no_unit,
        **facts.understood({"file": path.name, "format": "CSV"}),  # type: ignore[arg-type]
    )


def write_csv(packing: Packing, path: Path) -> None:
    """Write a packing as CSV, overwriting `path`; `read_csv` gives it back bit for bit."""
    head = [*fact_comments(packing), "x [m],y [m],z [m],radius [m]"]
    with path.open("w", encoding="utf-8", newline="\n") as stream:
        stream.writelines(f"{line}\n" for line in head)
        # repr of a Python float is the shortest text that reads back as the same number
        for (x, y, z), r in zip(packing.centers.tolist(), packing.radii.tolist(), strict=True):
            stream.write(f"{x!r},{y!r},{z!r},{r!r}\n")


@dataclass(frozen=True)
class _Table:
    """What the header says."""

    separator: str
    width: int
    columns: dict[str, Column]
    no_unit: str
    first_row: bytes | None

    def metre(self, name: str) -> float:
        """Metres in the unit of a column; 1 where there is none."""
        unit = self.columns[name].unit
        return 1.0 if unit is None else metres(unit)


def _header(lines: ByteLines, facts: Facts, columns: Columns) -> _Table:
    """Read up to the first row."""
    while (line := lines.next()) is not None:
        if line.lstrip().startswith("#"):
            facts.see_comment(lines.number, line)
        elif line.strip():
            break
    else:
        raise BadFileError(f"{lines.path}: no header; expected {EXPECTED}")
    separator = _separator(line) or ","
    titles = _cells(line, separator)
    try:
        found = find_columns(titles, columns)
    except ValueError as error:
        raise lines.error(str(error)) from None
    missing = [axis for axis in "xyz" if axis not in found]
    if missing:
        raise lines.error(
            f"no column {', '.join(missing)}; the header has {', '.join(titles)[:200]}; expected {EXPECTED}"
        )
    is_row = all(map(_is_number, titles))
    return _Table(separator, len(titles), found, _no_unit(lines, found), line.encode() if is_row else None)


def _no_unit(lines: ByteLines, found: dict[str, Column]) -> str:
    """Say that no column has a unit, if none has; where some have, all must."""
    for name, column in found.items():
        if column.unit is not None and column.unit not in LENGTH_UNITS:
            raise lines.error(f"column {name!r} has the unit {column.unit!r}; expected {EXPECTED}")
    bare = [name for name, column in found.items() if column.unit is None]
    if bare and len(bare) < len(found):
        raise lines.error(f"column {bare[0]!r} has no unit; expected {EXPECTED}")
    return f"line {lines.number}: the columns have no unit" if bare else ""


def _rows(lines: ByteLines, facts: Facts, table: _Table) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The wanted columns of all rows, and the line of each."""

    def split(line: str, number: int) -> list[str] | None:
        if not line.strip():
            return None
        if line.lstrip().startswith("#"):
            facts.see_comment(number, line)
            return None
        return _cells(line, table.separator)

    said = f"the header names {table.width} columns"
    places = [column.place for column in table.columns.values()]
    rows = NumberRows(lines.path, list(table.columns), places, table.width, said, split, table.separator)
    parts = [(np.empty((0, len(places))), np.empty(0, np.int64))]
    if table.first_row is not None:
        parts.append(rows.parse([table.first_row], lines.number))
    first = lines.number + 1
    while taken := lines.take(ROWS_AT_ONCE):
        parts.append(rows.parse(taken, first))
        first = lines.number + 1
    values, numbered = zip(*parts, strict=True)
    return np.concatenate(values), np.concatenate(numbered)


def _separator(line: str) -> str | None:
    """What stands between the fields of a header; None if nothing does."""
    best = max(_SEPARATORS, key=lambda separator: len(_cells(line, separator)))
    return best if len(_cells(line, best)) > 1 else None


def _cells(line: str, separator: str) -> list[str]:
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]
    except csv.Error:
        # a field beyond all measure: whatever is read next says that this is no table
        return [line]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
