"""Restart files of MercuryDPM: one state, most of it by keyword."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.lines import Lines, open_lines
from bedrad.packings.files.rows import PickedRows, numbers, read_rows
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown

__all__ = ["looks_like_mercury_restart", "read_mercury_restart"]

Pick = Callable[[str, int], Sequence[str]]

_SECTIONS = ("Species", "Walls", "Boundaries", "Particles")
_VERSIONS = ("1.0", "3")
"""What `restart_version` may say; from 2016 on the first line names the program instead."""
_POSITIONAL = "3"
"""The version whose particles have no keywords."""
_DISTANCES = (("distanceLeft", "distanceRight"), ("position_left", "position_right"))
_NOT_SPHERES = ("SuperQuadric", "Clump", "MultiParticle", "NonSpherical")
_MAXIMUM_TILT = 1e-9
"""Component of a unit normal that still counts as zero: the program rounds them to 15 digits."""


@dataclass
class _Head:
    """What comes before the particles."""

    version: str
    count: int = 0
    dimensions: str = "3"
    time: float | None = None
    periods: dict[int, float] = field(default_factory=dict)
    walls: Counter[str] = field(default_factory=Counter)
    unused: Counter[str] = field(default_factory=Counter)


def looks_like_mercury_restart(head: bytes) -> bool:
    """Whether a file begins as a restart file does, with its version or the name of the program."""
    return re.match(rb"\s*(restart_version\s+[0-9]|MercuryDPM\s+\S+\s+name\s)", head) is not None


def read_mercury_restart(path: Path) -> Contents:
    """Read the spheres of a restart file of MercuryDPM.

    Both forms are read: that of today (first line `MercuryDPM ...` or `restart_version 1.0`; particles by
    keyword, of which `id`, `position` and `radius` are used, in any place) and that of `restart_version 3`
    (rows `BP x y z vx vy vz radius ...`). A `PeriodicBoundary` whose planes are normal to an axis gives the period
    of that axis. Other boundaries and the walls are counted in the provenance and not used. Fixed particles are
    spheres like the others. Two-dimensional states, and particles that are not spheres, are refused. The file names
    no unit.

    Raises
    ------
    BadFileError
        If the file is damaged or is not such a file; the message names the line.
    """
    with open_lines(path) as lines:
        head = _read_head(lines)
        if head.version == _POSITIONAL:
            rows = PickedRows(path, ("x", "y", "z", "radius"), _pick_positional(path))
        else:
            rows = PickedRows(path, ("x", "y", "z", "radius", "id"), _pick_by_keyword(path))
        table = read_rows(lines, rows, head.count)
    if len(table) < head.count:
        raise BadFileError(
            f"{path}: cut off: {head.count} particles expected, {len(table)} found, "
            f"the file ends after line {lines.number}"
        )
    return table_spheres(path, table, _provenance(path, head), axis_periods=head.periods)


def _read_head(lines: Lines) -> _Head:
    head = _Head(_read_version(lines))
    section = ""
    while (line := lines.next()) is not None:
        fields = line.split()
        if not fields:
            continue
        if fields[0] in _SECTIONS:
            section = fields[0]
            if section == "Particles":
                head.count = _particle_count(lines, fields)
                if head.dimensions != "3":
                    raise BadFileError(
                        f"{lines.path}: a state in {head.dimensions[:40]} dimensions; only spheres in space are read"
                    )
                return head
        elif section == "Walls":
            head.walls[fields[0]] += 1
        elif section == "Boundaries":
            _read_boundary(lines, head, fields)
        elif not section:
            _read_setting(lines, head, fields)
    raise BadFileError(f"{lines.path}: no 'Particles' in the whole file, which ends after line {lines.number}")


def _read_version(lines: Lines) -> str:
    fields = (lines.next_filled() or "").split()
    if len(fields) >= 2 and fields[0] == "MercuryDPM":
        return fields[1]
    if len(fields) < 2 or fields[0] != "restart_version":
        raise lines.error("expected 'restart_version' or 'MercuryDPM' and a version, the first line of a restart file")
    if fields[1] not in _VERSIONS:
        raise lines.error(f"restart_version is {shown(fields[1])}; those that are read are {', '.join(_VERSIONS)}")
    return fields[1]


def _read_setting(lines: Lines, head: _Head, fields: list[str]) -> None:
    for keyword in ("systemDimensions", "dim"):
        if keyword in fields[:-1]:
            head.dimensions = fields[fields.index(keyword) + 1]
    for keyword in ("time", "t"):
        if keyword in fields[:-1]:
            head.time = float(_after(lines, fields, keyword, 1)[0])


def _particle_count(lines: Lines, fields: list[str]) -> int:
    if len(fields) < 2 or not re.fullmatch(r"[0-9]{1,18}", fields[1]):
        raise lines.error(f"the number of particles is {shown(' '.join(fields[1:]))}; expected an integer")
    return int(fields[1])


def _after(lines: Lines, fields: list[str], keyword: str, count: int) -> NDArray[np.float64]:
    """Return the numbers that follow a keyword."""
    if keyword not in fields:
        raise lines.error(f"{fields[0]} without {keyword!r}")
    place = fields.index(keyword) + 1
    found = fields[place : place + count]
    if len(found) < count:
        raise lines.error(f"{fields[0]}: {len(found)} numbers after {keyword!r}; expected {count}")
    row: NDArray[np.float64] = numbers(lines.path, [found], [keyword] * count, [lines.number])[0]
    return row


def _read_boundary(lines: Lines, head: _Head, fields: list[str]) -> None:
    if fields[0] != "PeriodicBoundary":
        head.unused[fields[0]] += 1
        return
    normal = _after(lines, fields, "normal", 3)
    length = math.hypot(*normal.tolist())
    if not (math.isfinite(length) and length > 0):
        raise lines.error(f"PeriodicBoundary: the normal is {normal.tolist()}; expected a direction")
    left_name, right_name = next((pair for pair in _DISTANCES if pair[0] in fields), _DISTANCES[0])
    left, right = (float(_after(lines, fields, name, 1)[0]) for name in (left_name, right_name))
    if not left < right:
        raise lines.error(f"PeriodicBoundary: {left_name} is {left} and {right_name} is {right}; expected left < right")
    axis = int(np.argmax(np.abs(normal)))
    across = float(np.abs(np.delete(normal, axis)).max()) / length
    if "shift" in fields:
        shift = _after(lines, fields, "shift", 3)
        across = max(across, float(np.abs(np.delete(shift, axis)).max()) / (right - left))
    if across > _MAXIMUM_TILT:
        # planes that are tilted, or shifted against each other, are no period of an axis
        head.unused["tilted PeriodicBoundary"] += 1
        return
    if axis in head.periods:
        raise lines.error(f"a second PeriodicBoundary normal to {'xyz'[axis]}")
    head.periods[axis] = (right - left) / length


def _pick_by_keyword(path: Path) -> Pick:
    places: list[int] = []

    def find(fields: list[str], line: int) -> list[int]:
        if not fields or fields[0].startswith(_NOT_SPHERES):
            kind = fields[0] if fields else "a blank line"
            raise BadFileError(f"{path}, line {line}: {kind}; expected a spherical particle")
        found = []
        for keyword, count in (("id", 1), ("position", 3), ("radius", 1)):
            if keyword not in fields or fields.index(keyword) + count >= len(fields):
                raise BadFileError(
                    f"{path}, line {line}: {shown(fields[0])}: no {keyword!r} with {count} numbers after it"
                )
            found.append(fields.index(keyword))
        return found

    def pick(text: str, line: int) -> tuple[str, str, str, str, str]:
        nonlocal places
        fields = text.split()
        # the rows of a file are alike: where the keywords stood last time they stand this time
        if not (
            places
            and len(fields) > max(places) + 3
            and fields[places[0]] == "id"
            and fields[places[1]] == "position"
            and fields[places[2]] == "radius"
            and not fields[0].startswith(_NOT_SPHERES)
        ):
            places = find(fields, line)
        number, position, radius = places
        return fields[position + 1], fields[position + 2], fields[position + 3], fields[radius + 1], fields[number + 1]

    return pick


def _pick_positional(path: Path) -> Pick:
    def pick(text: str, line: int) -> tuple[str, str, str, str]:
        fields = text.split()
        # one or two names, then position, velocity and radius
        start = next((place for place, text in enumerate(fields) if not text.isalpha()), len(fields))
        if start not in (1, 2) or len(fields) < start + 7:
            raise BadFileError(
                f"{path}, line {line}: expected a particle, such as 'BP' and then x y z vx vy vz radius, "
                f"found {shown(' '.join(fields))}"
            )
        return fields[start], fields[start + 1], fields[start + 2], fields[start + 6]

    return pick


def _provenance(path: Path, head: _Head) -> dict[str, str | float | int]:
    notes: dict[str, str | float | int] = {"file": path.name, "format": "MercuryDPM restart"}
    if head.time is not None:
        notes["time"] = head.time
    for name, counted in (("walls_not_used", head.walls), ("boundaries_not_used", head.unused)):
        if counted:
            notes[name] = ", ".join(f"{count} {kind}" for kind, count in sorted(counted.items()))
    return notes
