"""Data files of LAMMPS and LIGGGHTS (`read_data`, `write_data`) with spheres of atom_style sphere."""

from __future__ import annotations

import math
import re
from pathlib import Path

from bedrad import __version__
from bedrad.errors import BadFileError
from bedrad.packings.files.boxes import surrounding_box
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.facts import Facts, fact_comments
from bedrad.packings.files.lines import Lines, open_lines
from bedrad.packings.files.rows import RegularRows, Table, read_rows
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown
from bedrad.packings.packing import Packing

__all__ = ["looks_like_lammps_data", "read_lammps_data", "write_lammps_data"]

_SPHERE = ("id", "type", "diameter", "density", "x", "y", "z")
_STYLES = {
    "sphere": _SPHERE,
    "granular": _SPHERE,
    "bpm/sphere": ("id", "molecule", "type", "diameter", "density", "x", "y", "z"),
}
"""Columns of the styles whose atoms are spheres; three image flags may follow."""

_YADE = ("id", "type", "radius", "density", "x", "y", "z")
_YADE_TITLE = "LIGGGHTS Description"
"""How YADE's export in the form `liggghts_in` begins, which writes the radius where LIGGGHTS has the diameter."""

_METRES = {"si": 1.0, "cgs": 1e-2, "micro": 1e-6, "nano": 1e-9}
_UNITS = re.compile(r"\bunits = (\w+)")
_ATOMS = re.compile(r"Atoms\s*(#|$)")
_SECTION = re.compile(r"[A-Z][A-Za-z]*(?: [A-Za-z]+){0,2}(?:\s*#.*)?")
_COUNT = re.compile(r"(?P<count>\S+)\s+atoms\s*(?:#.*)?")
_TILT = re.compile(r"(?P<tilts>\S+\s+\S+\s+\S+)\s+xy\s+xz\s+yz\s*(?:#.*)?")
_EDGES = re.compile(r".*\b[abc]vec\b.*")
_BOUNDS = re.compile(rb"^\s*\S+\s+\S+\s+xlo\s+xhi\b", re.MULTILINE)
_ATOM_COUNT = re.compile(rb"^\s*\d+\s+atoms\b", re.MULTILINE)

_LINE = 200
"""LIGGGHTS takes a line of 256 characters or more for two. [characters]"""

_DENSITY_KEY = "density_kg_per_m3"
_DENSITY = 1000.0


def looks_like_lammps_data(head: bytes) -> bool:
    """Whether the header of a data file comes after a title: a number of atoms and the bounds of a box."""
    title, _, rest = head.partition(b"\n")
    if title.startswith(b"LAMMPS data file") or title.strip() == _YADE_TITLE.encode():
        return True
    return bool(_ATOM_COUNT.search(rest) and _BOUNDS.search(rest))


def read_lammps_data(path: Path) -> Contents:
    """Read the spheres of a data file, in the order of their ids.

    The section `Atoms` must be of atom_style sphere (`granular`, `bpm/sphere`): ``Atoms # sphere`` says so, and where
    no style is named, 7 columns (10 with image flags) whose third is no integer do. A data file does not say which
    faces of its box are periodic, so there is no period but the one `write_lammps_data` notes.

    Raises
    ------
    BadFileError
        If the box is triclinic, the style is another or unclear, or the file is cut off or not understood; the message
        names the line.
    """
    facts = Facts(path)
    with open_lines(path) as lines:
        title = (lines.next() or "").strip()
        metre = _metre(lines, title)
        count, style = _header(lines, facts)
        table = _atoms(lines, count, _YADE if style is not None and title == _YADE_TITLE else style)
    return table_spheres(
        path,
        table,
        {"file": path.name, "format": "LAMMPS data"},
        facts,
        metre=metre or 1.0,
        states_unit=metre is not None or "wall" in facts,
    )


def write_lammps_data(packing: Packing, path: Path) -> None:
    """Write a packing for LAMMPS' `read_data`, overwriting `path`; `read_lammps_data` gives it back bit for bit.

    Units are SI. The density, which LAMMPS needs, is `density_kg_per_m3` of the provenance, or that of water.

    Raises
    ------
    ValueError
        If that is no positive number.
    """
    density = packing.provenance.get(_DENSITY_KEY, _DENSITY)
    if isinstance(density, str) or not 0 < density < math.inf:
        raise ValueError(f"the provenance {_DENSITY_KEY!r} is {density!r}; expected a positive number of kg/m^3")
    why = "from the provenance" if _DENSITY_KEY in packing.provenance else "which LAMMPS needs and the packing lacks"
    box = zip("xyz", surrounding_box(packing), strict=True)
    head = [
        f"LAMMPS data file written by bedrad {__version__}, units = si",
        "",
        f"# density: {float(density)!r} kg/m^3, {why}",
        *fact_comments(packing, _LINE),
        "",
        f"{len(packing)} atoms",
        "1 atom types",
        "",
        *(f"{float(low)!r} {float(high)!r} {axis}lo {axis}hi" for axis, (low, high) in box),
        # LAMMPS refuses a section without rows
        *(["", "Atoms # sphere", ""] if len(packing) else []),
    ]
    with path.open("w", encoding="utf-8", newline="\n") as stream:
        stream.writelines(f"{line}\n" for line in head)
        # repr of a Python float is the shortest text that reads back as the same number
        rows = zip(packing.centers.tolist(), packing.radii.tolist(), strict=True)
        for number, ((x, y, z), r) in enumerate(rows, start=1):
            stream.write(f"{number} 1 {2 * r!r} {float(density)!r} {x!r} {y!r} {z!r}\n")


def _metre(lines: Lines, title: str) -> float | None:
    """Metres in the unit that the title names; None if it names none, or reduced ones."""
    match = _UNITS.search(title)
    if match is None or match[1] == "lj":
        return None
    if match[1] not in _METRES:
        raise lines.error(f"the units are {shown(match[1])}; expected one of {', '.join(_METRES)} or lj")
    return _METRES[match[1]]


def _header(lines: Lines, facts: Facts) -> tuple[int, str | None]:
    """Read up to `Atoms`: the number of atoms, and the style that it names, "" if none; None without the section."""
    count: int | None = None
    in_header = True
    while (line := lines.next_filled()) is not None:
        text = line.strip()
        if text.startswith("#"):
            facts.see_comment(lines.number, text)
        elif _ATOMS.match(text):
            if count is None:
                raise lines.error("'Atoms' comes before the number of atoms, such as '100 atoms'")
            return count, text.partition("#")[2].strip()
        elif _SECTION.fullmatch(text):
            in_header = False
        elif in_header:
            count = _header_line(lines, text, count)
    if count:
        raise BadFileError(f"{lines.path}: no section 'Atoms'; the header says {count} atoms")
    if count is None:
        raise BadFileError(f"{lines.path}: no number of atoms, such as '100 atoms', in the whole file")
    return count, None


def _header_line(lines: Lines, text: str, count: int | None) -> int | None:
    """Read a line of the header, and return the number of atoms known by then."""
    if match := _COUNT.fullmatch(text):
        number = match["count"]
        if not (number.isascii() and number.isdigit() and len(number) < 19):
            raise lines.error(f"the number of atoms is {shown(number)}; expected 0 or more")
        return int(number)
    tilts = _TILT.fullmatch(text)
    if _EDGES.fullmatch(text) or (tilts and tilts["tilts"].replace(".", "").strip("0 \t")):
        raise lines.error("a triclinic box; only boxes with right angles are read")
    return count


def _atoms(lines: Lines, count: int, style: str | tuple[str, ...] | None) -> Table:
    """Read the rows of `Atoms`; `style` is None where there is no such section."""
    atoms_line = lines.number
    columns = style if isinstance(style, tuple) else _STYLES.get(style or "")
    if style and columns is None:
        raise lines.error(f"the atom style is {shown(style)}; expected one of {', '.join(_STYLES)}")
    if style is not None and (lines.next() or "").strip():
        raise lines.error("expected a blank line after 'Atoms'")
    first = _cells(lines.peek() or "")
    if count == 0 or not first:
        columns = columns or _SPHERE
        width = len(columns)
    else:
        columns = columns or _unnamed(lines, first, atoms_line)
        width = len(first)
        if width not in (len(columns), len(columns) + 3):
            raise BadFileError(
                f"{lines.path}, line {lines.number + 1}: {width} fields; expected {len(columns)} "
                f"({' '.join(columns)}), or {len(columns) + 3} with image flags"
            )
    names = ("id", "radius" if "radius" in columns else "diameter", "x", "y", "z")
    places = {name: columns.index(name) for name in names}
    table = read_rows(lines, RegularRows(lines.path, places, width, f"the first row has {width}", _cells), count)
    if len(table) < count:
        raise BadFileError(
            f"{lines.path}: cut off: {count} rows of atoms expected, {len(table)} found, the file ends after line "
            f"{lines.number}"
        )
    after = None if style is None else lines.next_filled()
    if after is not None and not _SECTION.fullmatch(after.strip()):
        raise lines.error(f"expected the end or a section after {count} atoms, found {shown(after.strip())}")
    return table


def _cells(text: str, _: int = 0) -> list[str]:
    return text.partition("#")[0].split()


def _unnamed(lines: Lines, cells: list[str], atoms_line: int) -> tuple[str, ...]:
    """Columns where 'Atoms' names no style: other styles of as many columns have an integer in the third."""
    if len(cells) not in (len(_SPHERE), len(_SPHERE) + 3) or cells[2].lstrip("+-").isdigit():
        raise BadFileError(
            f"{lines.path}, line {atoms_line}: 'Atoms' names no style, and line {lines.number + 1} ({len(cells)} "
            f"fields, the third {shown(cells[2]) if len(cells) > 2 else 'missing'}) leaves it open; write "
            "'Atoms # sphere' if they are spheres"
        )
    return _SPHERE
