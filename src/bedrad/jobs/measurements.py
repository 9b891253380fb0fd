"""Tables of measured flows: a CSV file to runs of readings, and the runs reduced beside the two-layer model."""

from __future__ import annotations

import csv
import difflib
import io
import itertools
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.heat.measured_flow import (
    FluxChoice,
    Measured,
    Profile,
    ProfileForm,
    Properties,
    ReducedRun,
    Row,
    Run,
    Tube,
    electrical_power,
    reduce_run,
)
from bedrad.heat.ranges import FloatArray, positive
from bedrad.jobs.units import quantity
from bedrad.packings.files.text import open_bytes, shown

__all__ = ["COLUMNS", "read_measurements", "reduce_measurements"]

COLUMNS = {
    "position": "m",
    "wall temperature": "K",
    "mean temperature": "K",
    "inlet temperature": "K",
    "surface temperature": "K",
    "mass flow": "kg/s",
    "power": "W",
    "voltage": "V",
    "current": "A",
    "loss": "W",
}
"""Columns of a table and their SI units; ``T at r = 1.5 mm`` for readings across the tube and ``run`` come beside."""

_ERRORS = {f"{name} error": unit for name, unit in COLUMNS.items() if name != "position"} | {"T error": "K"}
_TITLE = re.compile(r"(?P<name>[^\[]*)(?:\[(?P<unit>[^\]]*)\])?")
_RADIAL = re.compile(r"t\s*(?:at|@)?\s*\(?\s*r\s*=\s*(?P<radius>[^()]+?)\s*\)?", re.IGNORECASE)
_MOST_ROWS = 100_000
_MOST_BYTES = 1 << 26


@dataclass(frozen=True)
class _Column:
    """A column: what it holds, and how its numbers become SI units, `zero + scale x`."""

    name: str
    title: str
    radius: float
    zero: float
    scale: float


@dataclass(frozen=True)
class _Line:
    """A row of the file: where it stands, its run, and its values by the names of columns and by radius."""

    number: int
    run: str
    values: dict[str, float]
    radial: dict[float, float]


def _column(title: str, path: Path, line: int) -> _Column | None:
    """What a title says; None for a note."""
    match = _TITLE.fullmatch(title.strip())
    name = " ".join(match["name"].lower().split()) if match else ""
    if name == "run":
        return _Column("run", title, math.nan, 0.0, 1.0)
    if name.startswith("note"):
        return None
    where = f"{path}, line {line}: column {shown(title)}"
    known = COLUMNS | {key.lower(): unit for key, unit in _ERRORS.items()}
    radial = _RADIAL.fullmatch(name)
    if match is None or (name not in known and radial is None):
        near = difflib.get_close_matches(name, [*known, "run", "note"], 1)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        raise BadFileError(
            f"{where} is not known{hint}; expected run, {', '.join(COLUMNS)}, each with its unit and, but for "
            "position, a column '... error' beside it, 'T at r = 1.5 mm [degC]', 'T error [K]', or notes"
        )
    if not match["unit"]:
        raise BadFileError(f"{where} has no unit; expected one in brackets, such as 'position [m]'")
    unit = match["unit"].strip()
    try:
        radius = quantity(match["name"].partition("=")[2].strip(" )"), "m") if radial else math.nan
        si = "K" if radial else known[name]
        zero = quantity(f"0 {unit}", si)
        scale = quantity(f"1 {unit}", si) - zero
    except ValueError as error:
        raise BadFileError(f"{where}: {error}") from None
    if radial and radius < 0.0:
        raise BadFileError(f"{where}: the radius is {radius:g} m; expected at least 0")
    # an error is a difference: 0.5 degC are 0.5 K
    return _Column("T" if radial else name, title, radius, 0.0 if name.endswith("error") else zero, scale)


def _cells(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Lines of the table with their numbers, without comments and blank lines."""
    with open_bytes(path) as stream:
        content = stream.read(_MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise BadFileError(f"{path}: has more than {_MOST_BYTES >> 20} MiB; expected a table of measurements")
    reader = csv.reader(io.StringIO(content.decode("utf-8-sig", errors="replace"), newline=""))
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#"):
                yield reader.line_num, cells
    except csv.Error as error:
        raise BadFileError(f"{path}, line {reader.line_num}: {error}; expected comma-separated values") from None


def _header(path: Path, line: int, titles: Sequence[str]) -> list[_Column | None]:
    if len(titles) == 1:
        raise BadFileError(f"{path}, line {line}: one column, {shown(titles[0])}; expected several, parted by commas")
    columns = [_column(title, path, line) for title in titles]
    seen: dict[tuple[str, float], str] = {}
    for column in columns:
        if column is None:
            continue
        # NaN is no key: every one of them is different
        key = (column.name, column.radius if column.name == "T" else 0.0)
        if key in seen:
            raise BadFileError(
                f"{path}, line {line}: columns {shown(seen[key])} and {shown(column.title)} are the same"
            )
        seen[key] = column.title
    _check_names({name for name, _ in seen}, f"{path}, line {line}")
    return columns


def _check_names(names: set[str], where: str) -> None:
    """Refuse a header without what is needed, or with two of what is one."""
    for needed in ("position", "mass flow"):
        if needed not in names:
            raise BadFileError(f"{where}: no column {needed!r}; expected one, such as '{needed} [...]'")
    for name in names:
        if name.endswith(" error") and name != "t error" and name.removesuffix(" error") not in names:
            raise BadFileError(f"{where}: a column {name!r} without {name.removesuffix(' error')!r}; expected both")
    if "T" not in names and "mean temperature" not in names:
        raise BadFileError(
            f"{where}: no temperature of the flow; expected 'T at r = 0 mm [degC]' and more, or "
            "'mean temperature [degC]'"
        )
    if "power" in names and names & {"voltage", "current"}:
        raise BadFileError(f"{where}: power beside voltage or current; expected one of both")
    if ("voltage" in names) != ("current" in names):
        raise BadFileError(f"{where}: voltage or current alone; expected both, or power")
    if not names & {"power", "voltage"}:
        raise BadFileError(f"{where}: no column 'power', and none of 'voltage' and 'current'")


def _number(text: str, column: _Column, path: Path, line: int) -> float:
    """SI value of a cell."""
    try:
        value = column.zero + column.scale * float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise BadFileError(f"{path}, line {line}: {column.title} is {shown(text)}; expected a number")
    zero = column.name == "position" or column.name.endswith("error")
    if not (column.name == "loss" or value > 0.0 or (zero and value == 0.0)):
        least = "at least 0" if zero else "more than absolute zero" if column.zero else "more than 0"
        raise BadFileError(f"{path}, line {line}: {column.title} is {shown(text)}; expected {least}")
    return value


def _line(number: int, cells: Sequence[str], columns: Sequence[_Column | None], path: Path) -> _Line:
    """A row with its values in SI units."""
    found = _Line(number, path.stem, {}, {})
    for column, cell in zip(columns, cells, strict=True):
        if column is None or not cell.strip():
            continue
        if column.name == "run":
            found = replace(found, run=cell.strip())
        elif column.name == "T":
            found.radial[column.radius] = _number(cell, column, path, number)
        else:
            found.values[column.name] = _number(cell, column, path, number)
    if "position" not in found.values:
        raise BadFileError(f"{path}, line {number}: position is empty; expected a number")
    return found


def _lines(path: Path) -> list[_Line]:
    rows = _cells(path)
    first = next(rows, None)
    if first is None:
        raise BadFileError(f"{path}: is empty; expected a header such as 'position [m],wall temperature [degC],...'")
    columns = _header(path, *first)
    lines: list[_Line] = []
    for number, cells in rows:
        if len(cells) != len(columns):
            raise BadFileError(f"{path}, line {number}: {len(cells)} fields; the header names {len(columns)} columns")
        if len(lines) >= _MOST_ROWS:
            raise BadFileError(f"{path}, line {number}: more than {_MOST_ROWS} rows; expected a row for each position")
        lines.append(_line(number, cells, columns, path))
    if not lines:
        raise BadFileError(f"{path}: has a header and no rows")
    return lines


def _measured(values: dict[str, float], name: str) -> Measured | None:
    return Measured(values[name], values.get(f"{name} error", 0.0)) if name in values else None


def _power(line: _Line, path: Path) -> Measured | None:
    if "power" in line.values:
        return _measured(line.values, "power")
    V, current = _measured(line.values, "voltage"), _measured(line.values, "current")
    if V is None and current is None:
        return None
    if V is None or current is None:
        missing = "voltage" if V is None else "current"
        raise BadFileError(f"{path}, line {line.number}: {missing} is empty; expected voltage and current, or neither")
    return electrical_power(V, current)


def _row(line: _Line, path: Path) -> Row:
    values, radii = line.values, sorted(line.radial)
    if radii and "mean temperature" in values:
        raise BadFileError(
            f"{path}, line {line.number}: a mean temperature beside readings across the tube; expected one of both"
        )
    profile = None
    if radii:
        error = values.get("t error")
        profile = Profile(
            radius=_array(radii),
            temperature=_array([line.radial[r] for r in radii]),
            error=None if error is None else _array([error] * len(radii)),
        )
    return Row(
        position=values["position"],
        wall_temperature=_measured(values, "wall temperature"),
        profile=profile,
        mean_temperature=_measured(values, "mean temperature"),
        power=_power(line, path),
        loss=_measured(values, "loss"),
        surface_temperature=_measured(values, "surface temperature"),
    )


def _array(values: Sequence[float]) -> FloatArray:
    return np.array(values, dtype=np.float64)


def _common(lines: Sequence[_Line], name: str, given: Sequence[Measured | None], path: Path) -> Measured | None:
    """What all rows of a run share: the first value, blank or the same in the others."""
    found: Measured | None = None
    first = 0
    for line, value in zip(lines, given, strict=True):
        if value is None:
            continue
        if found is None:
            found, first = value, line.number
        elif (value.value, value.error) != (found.value, found.error):
            raise BadFileError(
                f"{path}, line {line.number}: {name} is not that of line {first}, {found.value:.6g} against "
                f"{value.value:.6g} in SI units; expected one for run {shown(line.run)}"
            )
    return found


def _run(name: str, lines: list[_Line], path: Path, heated_length: float | None) -> Run:
    lines.sort(key=lambda line: line.values["position"])
    for one, two in itertools.pairwise(lines):
        if one.values["position"] == two.values["position"]:
            raise BadFileError(
                f"{path}, line {two.number}: position is {two.values['position']:g} m again, as in line {one.number}; "
                f"expected one row for each position of run {shown(name)}"
            )
    rows = [_row(line, path) for line in lines]
    flow = _common(lines, "mass flow", [_measured(line.values, "mass flow") for line in lines], path)
    if flow is None:
        raise BadFileError(f"{path}, line {lines[0].number}: run {shown(name)} has no mass flow in any row")
    power = None
    if heated_length is not None:
        power = _common(lines, "power", [row.power for row in rows], path)
        if power is None:
            raise BadFileError(f"{path}, line {lines[0].number}: run {shown(name)} has no power in any row")
    return Run(
        name=name,
        mass_flow=flow,
        rows=rows,
        inlet_temperature=_common(
            lines, "inlet temperature", [_measured(line.values, "inlet temperature") for line in lines], path
        ),
        total_power=power,
        heated_length=heated_length,
    )


def read_measurements(path: Path, heated_length: float | None = None) -> list[Run]:
    """Read a table of measured flows (CSV), a row for each position of each run.

    Columns are known by their names, with the unit in brackets: those of `COLUMNS`, ``run`` (a name; all rows are one
    run without), readings across the tube as ``T at r = 1.5 mm [degC]``, for each but the position its standard error
    as ``wall temperature error [K]``, that of the readings across as ``T error [K]``. Cells may be empty. Lines that
    begin with # are comments, columns that begin with "note" are not read.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    heated_length : float, optional
        The power is that of this length of tube, the same in all rows of a run; if not given, it is that of the
        section that ends at the row's position. [m]

    Returns
    -------
    list of Run
        In the order in which they come first.

    Raises
    ------
    BadFileError
        If the table cannot be read or understood; the message names line and column.
    """
    if heated_length is not None:
        positive("heated_length", heated_length, "m")
    runs: dict[str, list[_Line]] = {}
    for line in _lines(path):
        runs.setdefault(line.run, []).append(line)
    return [_run(name, lines, path, heated_length) for name, lines in runs.items()]


def reduce_measurements(
    path: Path,
    tube: Tube,
    properties: Properties,
    *,
    heated_length: float | None = None,
    form: ProfileForm = "quadratic",
    instrument_tolerance: float = 0.0,
    developed_from: float = 0.0,
    flux: FluxChoice = "local",
) -> list[ReducedRun]:
    """Read a table and reduce all its runs.

    Parameters
    ----------
    path, heated_length
        As for `read_measurements`.
    tube, properties, form, instrument_tolerance, developed_from, flux
        As for `bedrad.heat.measured_flow.reduce_run`.

    Returns
    -------
    list of ReducedRun
        The runs.

    Raises
    ------
    BadFileError
        If the table cannot be understood, or its numbers have no meaning; the message names the file.
    """
    runs = read_measurements(path, heated_length)
    found = []
    for run in runs:
        try:
            found.append(
                reduce_run(
                    run,
                    tube,
                    properties,
                    form=form,
                    instrument_tolerance=instrument_tolerance,
                    developed_from=developed_from,
                    flux=flux,
                )
            )
        except ValueError as error:
            text = str(error)
            named = text if text.startswith(run.name) else f"{run.name}: {text}"
            raise BadFileError(f"{path}: run {named}") from None
    return found
