"""Text of YADE's export module: `#format x_y_z_r` and its variants, one sphere a row."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.facts import Facts, fact_comments
from bedrad.packings.files.lines import Lines, open_lines
from bedrad.packings.files.rows import RegularRows, read_rows
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown
from bedrad.packings.packing import Packing

__all__ = ["looks_like_yade", "read_yade", "write_yade"]

Split = Callable[[str, int], list[str] | None]

_MARK = "#format"
_DEFAULT = "x_y_z_r"
_REQUIRED = ("x", "y", "z", "r")
_COLUMNS = {"x": "x", "y": "y", "z": "z", "r": "radius", "id": "id"}
"""The names of the format that are read, and bedrad's."""

_OPEN_END = "attrs"
"""Last word of a format whose rows end in any number of further quantities."""


def looks_like_yade(head: bytes) -> bool:
    """Whether a file begins with YADE's line that names the columns."""
    return head.decode("utf-8-sig", errors="replace").lstrip().startswith(_MARK)


def read_yade(path: Path) -> Contents:
    """Read the spheres of a text that YADE's `export.textExt`, `export.text` or `export.textClumps` wrote.

    The first line names the columns, joined by underscores: x, y, z and r must be among them, `attrs` at the end
    stands for any number of further columns, and rows with an `id` are put in the order of these. YADE prints six
    digits; the provenance says so (`rounding_notes`). Comments like ``# wall: tube radius=0.003875 m`` restore what
    `write_yade` wrote.

    Raises
    ------
    BadFileError
        If the format has no x, y, z or r, or a row or a comment cannot be understood; the message names the line.
    """
    facts = Facts(path)
    with open_lines(path) as lines:
        table = read_rows(lines, _rows(lines, facts))
    origin = {"file": path.name, "format": "YADE text"}
    return table_spheres(path, table, origin, facts, states_unit="wall" in facts)


def write_yade(packing: Packing, path: Path) -> None:
    """Write a packing for YADE's `ymport.textExt`, overwriting `path`; `read_yade` gives it back bit for bit."""
    with path.open("w", encoding="utf-8", newline="\n") as stream:
        stream.writelines(f"{line}\n" for line in (f"{_MARK} {_DEFAULT}", *fact_comments(packing)))
        # repr of a Python float is the shortest text that reads back as the same number
        for (x, y, z), r in zip(packing.centers.tolist(), packing.radii.tolist(), strict=True):
            stream.write(f"{x!r}\t{y!r}\t{z!r}\t{r!r}\n")


def _rows(lines: Lines, facts: Facts) -> RegularRows:
    """Read up to the first row, and make the table that the name of the format describes."""
    form, form_line = _DEFAULT, 0
    first: list[str] = []

    def split(text: str, line: int) -> list[str] | None:
        nonlocal form, form_line
        text = text.strip()
        if text.startswith(_MARK):
            if form_line or first:
                before = f"line {form_line} names one" if form_line else "rows stand before it"
                raise BadFileError(f"{lines.path}, line {line}: a second format; {before}")
            form, form_line = text.removeprefix(_MARK).strip(), line
            return None
        if text.startswith("#"):
            facts.see_comment(line, text)
            return None
        return text.split() or None

    while (text := lines.peek_filled()) is not None:
        if cells := split(text, lines.number + 1):
            first = cells
            break
        lines.next()
    return _named_rows(lines, form, form_line or lines.number + 1, first, split)


def _named_rows(lines: Lines, form: str, form_line: int, first: list[str], split: Split) -> RegularRows:
    """Make the table that a format describes; `first` is the first row, empty if there is none."""
    names = form.split("_")
    open_end = names[-1] == _OPEN_END
    if open_end:
        names.pop()
    places = {_COLUMNS[name]: names.index(name) for name in _COLUMNS if name in names}
    lacking = [name for name in _REQUIRED if name not in names]
    if lacking:
        raise BadFileError(
            f"{lines.path}, line {form_line}: the format {shown(form)} has no {', '.join(lacking)}; "
            f"expected names joined by underscores, such as {_DEFAULT}"
        )
    width, said = len(names), f"the format {shown(form)} has {len(names)}"
    if open_end and first:
        if len(first) < width:
            raise BadFileError(
                f"{lines.path}, line {lines.number + 1}: {len(first)} fields; the format {shown(form)} has at least "
                f"{width}"
            )
        width, said = len(first), f"the first row, line {lines.number + 1}, has {len(first)}"
    return RegularRows(lines.path, places, width, said, split)
