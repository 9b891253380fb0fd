"""Tables of points between white space, as packing generators write them: `x y z r`, `x y z d` or `x y z`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.format import Columns
from bedrad.packings.files.lines import Lines, open_lines
from bedrad.packings.files.rows import RegularRows, is_number, read_rows
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown
from bedrad.packings.files.units import LENGTH_UNITS, metres

__all__ = ["looks_like_points", "read_points"]

Header = tuple[int, list[str]]
"""The line of a header, and its words."""

_COMMENTS = ("#", "%", "!", "//", ";")
_NAMES = {
    "x": "x",
    "y": "y",
    "z": "z",
    "r": "radius",
    "rad": "radius",
    "radius": "radius",
    "radii": "radius",
    "d": "diameter",
    "diam": "diameter",
    "diameter": "diameter",
    "diameters": "diameter",
    "id": "id",
}
"""How headers name the quantities, in small letters, and bedrad's names."""

_WITH_UNIT = re.compile(r"(?P<name>[^\[\]()]+)[\[(](?P<unit>[^\[\]()]*)[\])]")
_BY_PLACE = ("x", "y", "z", "radius")
_ROWS_LOOKED_AT = 50
_RUNNING = 3
"""From how many rows on 1, 2, 3, ... (or 0, 1, 2, ...) is taken for a number of the sphere, not for its x."""


def looks_like_points(head: bytes) -> bool:
    """Whether a file begins with rows of equally many numbers, three at least, after comments or a header."""
    text = head.decode("utf-8-sig", errors="replace")
    lines = text.splitlines()
    # the last line of a long file is cut off
    if len(lines) > 1 and not text.endswith(("\n", "\r")):
        lines.pop()
    rows = [line.split() for line in lines if line.strip() and not line.lstrip().startswith(_COMMENTS)]
    width = len(rows[0]) if rows else 0
    rows = rows[1 if rows and _only_words(rows[0]) else 0 :][:_ROWS_LOOKED_AT]
    return width >= 3 and bool(rows) and all(len(row) == width and all(map(is_number, row)) for row in rows)


def read_points(path: Path, columns: Columns | None = None) -> Contents:
    """Read spheres from a table between white space.

    A header, the first line or the last comment before the rows, names the columns: x, y, z and r, radius, d or
    diameter, each with its unit behind it if it has one (``x[mm]``); columns of other names are passed over, and an
    `id` gives the order. Without one, three columns are x, y, z and four are x, y, z, radius.

    Parameters
    ----------
    path : pathlib.Path
        The table, plain or gzip.
    columns : mapping, optional
        Columns of x, y, z, radius and diameter by their names in the header or their numbers from 1, for tables in
        which they are others.

    Raises
    ------
    BadFileError
        If it is not clear which column is which, or a row cannot be understood; the message names the line.
    """
    asked = {name: str(column) for name, column in (columns or {}).items()}
    with open_lines(path) as lines:
        first, header = _before_the_rows(lines, asked)
        line = lines.number + 1
        places, unit = _places(path, line, len(first), header, asked)
        said = f"the first row, line {line}, has {len(first)}"
        table = read_rows(lines, RegularRows(path, places, len(first), said, _cells))
    x = table.columns["x"]
    if not (header or asked) and len(x) >= _RUNNING and x[0] in (0, 1) and (np.diff(x) == 1).all():
        raise BadFileError(
            f"{path}, line {line}: the first column only counts the rows; say which columns are x, y and z"
        )
    return table_spheres(
        path,
        table,
        {"file": path.name, "format": "table of points"},
        metre=1.0 if unit is None else metres(unit),
        states_unit=unit is not None,
    )


def _before_the_rows(lines: Lines, asked: Columns) -> tuple[list[str], Header | None]:
    """Read up to the first row, and return its fields and the header, if there is one."""
    comment: Header | None = None
    header: Header | None = None
    while (text := lines.peek_filled()) is not None:
        text = text.strip()
        if text.startswith(_COMMENTS):
            words = text.lstrip("#%!/; \t").split()
            comment = (lines.number + 1, words[1:] if words and words[0].endswith(":") else words)
        else:
            cells = text.split()
            if header is not None or not _only_words(cells):
                if header is None and comment and len(comment[1]) == len(cells) and _names(comment[1], asked):
                    header = comment
                return cells, header
            header = (lines.number + 1, cells)
        lines.next()
    found = f" after the header {shown(' '.join(header[1]))} in line {header[0]}" if header else ""
    raise BadFileError(f"{lines.path}: no row of numbers{found}; expected x y z and, where it is known, the radius")


def _cells(text: str, _: int) -> list[str] | None:
    text = text.strip()
    return None if not text or text.startswith(_COMMENTS) else text.split()


def _places(
    path: Path, line: int, width: int, header: Header | None, columns: Columns
) -> tuple[dict[str, int], str | None]:
    """Find the place of every quantity, and the unit that the header gives for all of them."""
    names = header[1] if header else []
    if header and len(names) != width:
        raise BadFileError(f"{path}, line {line}: {width} fields; the header in line {header[0]} names {len(names)}")
    sizes = {"radius", "diameter"}
    places: dict[str, int] = {}
    for place, text in enumerate(names):
        name = _NAMES.get(_bare(text)[0])
        if name is None or name in columns or (name in sizes and sizes & set(columns)):
            continue
        if name in places:
            raise BadFileError(f"{path}, line {header[0] if header else line}: column {name!r} comes twice")
        places[name] = place
    if not header and not columns and width not in (3, 4):
        raise BadFileError(
            f"{path}, line {line}: {width} columns and no header; expected x y z or x y z radius, or to be told which "
            "columns they are"
        )
    wanted = {name: _place(path, line, width, names, name, asked) for name, asked in columns.items()}
    if not header and width in (3, 4):
        default = _BY_PLACE[: 3 if sizes & set(columns) else width]
        places = {name: place for place, name in enumerate(default) if place not in wanted.values()}
    places |= wanted
    _check(path, line, names, places)
    if "radius" in places:
        places.pop("diameter", None)
    return places, _unit(path, header, places)


def _place(path: Path, line: int, width: int, names: Sequence[str], name: str, asked: str) -> int:
    """Find the column that the user asked for."""
    if asked in names:
        return list(names).index(asked)
    if asked.isascii() and asked.isdigit() and 1 <= int(asked[:9]) <= width:
        return int(asked) - 1
    known = f" or one of {', '.join(names)[:200]}" if names else ", as no header names them"
    raise BadFileError(f"{path}, line {line}: {name} is asked from column {shown(asked)}; expected 1 to {width}{known}")


def _check(path: Path, line: int, names: Sequence[str], places: dict[str, int]) -> None:
    lacking = [name for name in "xyz" if name not in places]
    if lacking:
        there = f"; the header has {', '.join(names)[:200]}" if names else ""
        raise BadFileError(f"{path}, line {line}: no column {', '.join(lacking)}{there}; say which columns they are")
    taken: dict[int, str] = {}
    for name, place in places.items():
        if place in taken:
            raise BadFileError(f"{path}, line {line}: column {place + 1} is asked for both {taken[place]} and {name}")
        taken[place] = name


def _unit(path: Path, header: Header | None, places: dict[str, int]) -> str | None:
    if header is None:
        return None
    units = {name: _bare(header[1][place])[1] for name, place in places.items() if name != "id"}
    said = set(units.values())
    if len(said) != 1:
        each = ", ".join(f"{name} {(unit or 'none')[:20]}" for name, unit in units.items())
        raise BadFileError(f"{path}, line {header[0]}: units differ: {each}; expected one unit for all columns")
    unit = said.pop()
    if unit is not None and unit not in LENGTH_UNITS:
        raise BadFileError(
            f"{path}, line {header[0]}: the unit is {shown(unit)}; expected one of {', '.join(LENGTH_UNITS)}"
        )
    return unit


def _bare(text: str) -> tuple[str, str | None]:
    """Split a name in a header from its unit, which is None where it has none."""
    text = text.strip("\"',:;")
    match = _WITH_UNIT.fullmatch(text)
    return (match["name"].lower(), match["unit"].strip()) if match else (text.lower(), None)


def _names(words: Sequence[str], asked: Columns) -> bool:
    """Whether words name columns: x, y and z are among them, or what the user asks for."""
    return {"x", "y", "z"} <= {_bare(word)[0] for word in words} or bool({*asked.values()} & {*words})


def _only_words(cells: Sequence[str]) -> bool:
    return not any(map(is_number, cells))
