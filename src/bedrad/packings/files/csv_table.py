"""Tables of spheres with a separator: a header that names columns and units, one sphere a row, facts in comments."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.csv_header import EXPECTED, Column, find_columns, names_positions
from bedrad.packings.files.facts import Facts, fact_comments
from bedrad.packings.files.format import Columns
from bedrad.packings.files.lines import Lines, open_lines
from bedrad.packings.files.rows import RegularRows, is_number, read_rows
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown
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
    with open_lines(path) as lines:
        header = _read_header(lines, facts, columns or {})
        table = read_rows(lines, _rows(lines, facts, header))
    units = {name: header.metre(name) for name in header.columns}
    metre = units["x"]
    if set(units.values()) != {metre}:
        metre = 1.0
        for name, factor in units.items():
            table.columns[name] = table.columns[name] * factor
    return table_spheres(
        path,
        table,
        {"file": path.name, "format": "CSV"},
        facts,
        metre=metre,
        states_unit=not header.no_unit,
        no_unit=header.no_unit,
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
class _Header:
    """What the header says."""

    separator: str
    width: int
    columns: dict[str, Column]
    no_unit: str

    def metre(self, name: str) -> float:
        """Metres in the unit of a column; 1 where there is none."""
        unit = self.columns[name].unit
        return 1.0 if unit is None else metres(unit)


def _read_header(lines: Lines, facts: Facts, columns: Columns) -> _Header:
    """Read up to the first row."""
    start = lines.mark()
    while (line := lines.next_filled()) is not None:
        if not line.lstrip().startswith("#"):
            break
        facts.see_comment(lines.number, line)
        start = lines.mark()
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
    header = _Header(separator, len(titles), found, _no_unit(lines, found))
    if all(map(is_number, titles)):
        # the columns were given by their numbers, and the first row is no header
        lines.go_to(start)
    return header


def _no_unit(lines: Lines, found: dict[str, Column]) -> str:
    """Say that no column has a unit, if none has; where some have, all must."""
    for name, column in found.items():
        if column.unit is not None and column.unit not in LENGTH_UNITS:
            raise lines.error(f"column {name!r} has the unit {shown(column.unit)}; expected {EXPECTED}")
    bare = [name for name, column in found.items() if column.unit is None]
    if bare and len(bare) < len(found):
        raise lines.error(f"column {bare[0]!r} has no unit; expected {EXPECTED}")
    return f"line {lines.number}: the columns have no unit" if bare else ""


def _rows(lines: Lines, facts: Facts, header: _Header) -> RegularRows:
    """What the rows look like, and the comments between them."""

    def split(line: str, number: int) -> list[str] | None:
        if not line.strip():
            return None
        if line.lstrip().startswith("#"):
            facts.see_comment(number, line)
            return None
        return _cells(line, header.separator)

    places = {name: column.place for name, column in header.columns.items()}
    said = f"the header names {header.width} columns"
    return RegularRows(lines.path, places, header.width, said, split, header.separator)


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
