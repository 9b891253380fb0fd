"""Comma-separated spheres: a header with units, one sphere a row, bedrad's own facts in comment lines."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents, describe_wall, make_wall, plain_value
from bedrad.packings.files.text import numbers, open_text
from bedrad.packings.packing import Packing
from bedrad.walls import Wall

__all__ = ["looks_like_csv", "read_csv", "write_csv"]

_UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6}
_COLUMN = re.compile(r"(?P<name>[^\[\]()]+?)\s*[\[(](?P<unit>[^\[\]()]*)[\])]")
_FACT = re.compile(r"#\s*(?P<key>wall|period|max_overlap|provenance)\s*:\s*(?P<value>.*)")
_WALL = re.compile(r"(?P<kind>\w+)(?:\s+radius\s*=\s*(?P<radius>\S+)\s+m)?")
_EXPECTED = "a header such as 'x [m],y [m],z [m],radius [m]' (units m, mm or um; diameter in place of radius)"


def looks_like_csv(head: bytes) -> bool:
    """Whether the first line that is no comment is a header with an x column and its unit."""
    for line in head.decode("utf-8-sig", errors="replace").splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            return "," in line and any(_COLUMN.fullmatch(name) for name in _names(line))
    return False


def read_csv(path: Path) -> Contents:
    """Read spheres from a CSV file.

    The header names the columns and their units, in any order; columns other than x, y, z and radius (or
    diameter) are passed over. Comment lines like ``# wall: tube radius=0.003875 m`` and ``# period: 0.02 m``
    restore what `write_csv` wrote.

    Raises
    ------
    BadFileError
        If the header, a row or a comment cannot be understood; the message names the line.
    """
    facts: dict[str, tuple[int, str]] = {}
    header: list[str] | None = None
    columns: dict[str, tuple[int, float]] = {}
    rows: list[list[str]] = []
    lines: list[int] = []
    with open_text(path) as stream:
        for number, line in enumerate(stream, start=1):
            if not line.strip():
                continue
            if line.lstrip().startswith("#"):
                if fact := _FACT.fullmatch(line.strip()):
                    facts[fact["key"]] = (number, fact["value"])
            elif header is None:
                header = _names(line)
                columns = _columns(path, number, header)
            else:
                cells = _names(line)
                if len(cells) != len(header):
                    raise BadFileError(
                        f"{path}, line {number}: {len(cells)} fields; the header names {len(header)} columns"
                    )
                rows.append([cells[place] for place, _ in columns.values()])
                lines.append(number)
    if header is None:
        raise BadFileError(f"{path}: no header; expected {_EXPECTED}")
    # column by column in metres: a unit of m multiplies by one, and changes no bit
    values = numbers(path, rows, list(columns), lines) * np.array([unit for _, unit in columns.values()])
    found = dict(zip(columns, values.T, strict=True))
    radii = found["radius"] if "radius" in found else found["diameter"] / 2 if "diameter" in found else None
    return Contents(
        centers=np.stack([found["x"], found["y"], found["z"]], axis=1),
        radii=radii,
        lines=lines,
        **_facts(path, facts),  # type: ignore[arg-type]
    )


def write_csv(packing: Packing, path: Path) -> None:
    """Write a packing as CSV, overwriting `path`; `read_csv` gives it back bit for bit."""
    kind, radius = describe_wall(packing.wall)
    notes = {key: plain_value(key, value) for key, value in packing.provenance.items()}
    head = [f"# wall: {kind}" + ("" if radius is None else f" radius={radius!r} m")]
    if packing.period is not None:
        head.append(f"# period: {' '.join(repr(float(v)) for v in np.atleast_1d(packing.period))} m")
    head += [f"# max_overlap: {packing.max_overlap!r}", f"# provenance: {json.dumps(notes)}"]
    head.append("x [m],y [m],z [m],radius [m]")
    with path.open("w", encoding="utf-8", newline="\n") as stream:
        stream.writelines(f"{line}\n" for line in head)
        # repr of a Python float is the shortest text that reads back as the same number
        for (x, y, z), r in zip(packing.centers.tolist(), packing.radii.tolist(), strict=True):
            stream.write(f"{x!r},{y!r},{z!r},{r!r}\n")


def _names(line: str) -> list[str]:
    return [cell.strip().strip('"').strip() for cell in line.split(",")]


def _columns(path: Path, line: int, header: list[str]) -> dict[str, tuple[int, float]]:
    """Place and unit of the columns that are wanted."""
    found: dict[str, tuple[int, float]] = {}
    for place, text in enumerate(header):
        match = _COLUMN.fullmatch(text)
        name = (match["name"] if match else text).lower()
        if name not in ("x", "y", "z", "radius", "diameter"):
            continue
        unit = match["unit"].strip() if match else None
        if unit not in _UNITS:
            said = "has no unit" if unit is None else f"has the unit {unit!r}"
            raise BadFileError(f"{path}, line {line}: column {name!r} {said}; expected {_EXPECTED}")
        if name in found:
            raise BadFileError(f"{path}, line {line}: column {name!r} comes twice")
        found[name] = (place, _UNITS[unit])
    missing = [name for name in "xyz" if name not in found]
    if missing:
        raise BadFileError(
            f"{path}, line {line}: no column {', '.join(missing)}; the header has {', '.join(header)}; "
            f"expected {_EXPECTED}"
        )
    return found


def _facts(path: Path, facts: Mapping[str, tuple[int, str]]) -> dict[str, object]:
    """Wall, period, overlap limit and provenance from the comment lines."""
    understood: dict[str, object] = {"provenance": {"file": path.name, "format": "CSV"}}
    for key, (line, text) in facts.items():
        try:
            understood[key] = _FACT_READERS[key](text)
        except ValueError as error:
            raise BadFileError(f"{path}, line {line}: {key} {text!r} is not understood: {error}") from error
    return understood


def _read_wall(text: str) -> Wall:
    match = _WALL.fullmatch(text.strip())
    if not match:
        raise ValueError("expected 'tube radius=0.003875 m', 'rod radius=... m' or 'plate'")
    return make_wall(match["kind"], None if match["radius"] is None else float(match["radius"]))


def _read_period(text: str) -> float | tuple[float, float]:
    parts = text.split()
    if len(parts) not in (2, 3) or parts[-1] != "m":
        raise ValueError("expected one or two numbers and the unit m")
    values = [float(part) for part in parts[:-1]]
    return values[0] if len(values) == 1 else (values[0], values[1])


def _read_notes(text: str) -> dict[str, str | float | int]:
    notes = json.loads(text)
    if not isinstance(notes, dict):
        raise ValueError("expected names and values in braces")  # noqa: TRY004
    return {key: plain_value(key, value) for key, value in notes.items()}


_FACT_READERS: dict[str, Callable[[str], object]] = {
    "wall": _read_wall,
    "period": _read_period,
    "max_overlap": float,
    "provenance": _read_notes,
}
