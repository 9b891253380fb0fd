"""Text of YADE's export module: `#format x_y_z_r` and its variants, one sphere a row."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.facts import Facts, fact_comments
from bedrad.packings.files.rows import Rows, filled_lines, rounding_notes, sorted_by_id
from bedrad.packings.files.text import open_text
from bedrad.packings.packing import Packing

__all__ = ["looks_like_yade", "read_yade", "write_yade"]

_MARK = "#format"
_DEFAULT = "x_y_z_r"
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
    form = _DEFAULT
    form_line: int | None = None
    rows: Rows | None = None
    with open_text(path) as stream:
        for number, text in filled_lines(path, stream):
            if text.startswith(_MARK):
                if form_line is not None or rows is not None:
                    before = f"line {form_line} names one" if form_line is not None else "rows stand before it"
                    raise BadFileError(f"{path}, line {number}: a second format; {before}")
                form, form_line = text.removeprefix(_MARK).strip(), number
            elif text.startswith("#"):
                facts.see_comment(number, text)
            else:
                if rows is None:
                    rows = _rows(path, form, form_line or number, number, len(text.split()))
                rows.add(number, text)
    if rows is None:
        rows = _rows(path, form, form_line or 1, 1, None)
    found, lines = rows.finish()
    centers, radii = np.stack([found["x"], found["y"], found["z"]], axis=1), found["r"]
    ids = None
    if "id" in found:
        order, lines, ids = sorted_by_id(path, found["id"], lines)
        centers, radii = centers[order], radii[order]
    origin = {"file": path.name, "format": "YADE text", **rounding_notes(centers, radii)}
    return Contents(
        centers=centers,
        radii=radii,
        lines=lines,
        ids=ids,
        states_unit="wall" in facts,
        **facts.understood(origin),  # type: ignore[arg-type]
    )


def write_yade(packing: Packing, path: Path) -> None:
    """Write a packing for YADE's `ymport.textExt`, overwriting `path`; `read_yade` gives it back bit for bit."""
    with path.open("w", encoding="utf-8", newline="\n") as stream:
        stream.writelines(f"{line}\n" for line in (f"{_MARK} {_DEFAULT}", *fact_comments(packing)))
        # repr of a Python float is the shortest text that reads back as the same number
        for (x, y, z), r in zip(packing.centers.tolist(), packing.radii.tolist(), strict=True):
            stream.write(f"{x!r}\t{y!r}\t{z!r}\t{r!r}\n")


def _rows(path: Path, form: str, form_line: int, first_line: int, first_width: int | None) -> Rows:
    """Make the table that the name of the format describes; `first_width` counts the fields of the first row."""
    names = form.split("_")
    open_end = names[-1] == _OPEN_END
    if open_end:
        names.pop()
    places: dict[str, int] = {name: names.index(name) for name in ("x", "y", "z", "r", "id") if name in names}
    lacking = [name for name in ("x", "y", "z", "r") if name not in places]
    if lacking:
        raise BadFileError(
            f"{path}, line {form_line}: the format {form!r} has no {', '.join(lacking)}; "
            f"expected names joined by underscores, such as {_DEFAULT}"
        )
    if not open_end or first_width is None:
        return Rows(path, places, len(names), f"the format {form!r} has {len(names)}")
    if first_width < len(names):
        raise BadFileError(
            f"{path}, line {first_line}: {first_width} fields; the format {form!r} has at least {len(names)}"
        )
    return Rows(path, places, first_width, f"the first row, line {first_line}, has {first_width}")
