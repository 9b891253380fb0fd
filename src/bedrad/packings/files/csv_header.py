"""The header of a CSV table: which column is which, and what it is in."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from bedrad.packings.files.format import Columns
from bedrad.packings.files.text import shown
from bedrad.packings.files.units import LENGTH_UNITS

__all__ = ["EXPECTED", "Column", "find_columns", "names_positions"]

EXPECTED = (
    "a header such as 'x [m],y [m],z [m],radius [m]' (units m, cm, mm, um, nm, in or ft; diameter in place of radius)"
)

_LONGEST = 200
"""What the title of a column may have to be looked at. [characters]"""

_COMPONENTS = ("x", "y", "z", "0", "1", "2")

_PLACE = "(?:position|pos|coordinates?|coords?|cent(?:er|re)s?|centroid|points?)"
_LETTER = r"[\[(]?(?P<axis>[xyz012])[\])]?"
_POSITIONS = (
    # in the order in which they are taken where a table has several
    re.compile(r"(?P<axis>[xyz])"),
    re.compile(rf"(?:(?:particle|sphere)s?[\s_]+)?{_PLACE}[\s_:.-]*{_LETTER}"),
    re.compile(rf"(?:(?:particle|sphere)s?[\s_]+)?(?P<axis>[xyz])(?:[\s_-]*{_PLACE})?"),
)
_SIZES = (
    ("radius", re.compile(r"(?:(?:particle|sphere)s?[\s_]+)?(?:radius|radii|rad|r)")),
    # the size of a spherical particle in Rocky is its diameter
    ("diameter", re.compile(r"(?:(?:particle|sphere)s?[\s_]+)?(?:diameters?|diam|dia|d|size)")),
)
_AXIS = dict(zip("xyz012", "xyzxyz", strict=True))
_Meaning = tuple[str, int]


@dataclass(frozen=True)
class Column:
    """A column that is wanted.

    Parameters
    ----------
    place : int
        Its place in a row, from 0.
    title : str
        What the header calls it.
    unit : str or None
        The unit that the header gives it.
    """

    place: int
    title: str
    unit: str | None


def names_positions(header: Sequence[str]) -> bool:
    """Whether a row has a title of x, y or z."""
    meanings = [_meaning(_split(title)[0]) for title in header]
    return any(meaning is not None and meaning[0] in "xyz" for meaning in meanings)


def find_columns(header: Sequence[str], columns: Columns) -> dict[str, Column]:
    """Find x, y, z and radius or diameter in a header.

    Parameters
    ----------
    header : sequence of str
        Titles of the columns.
    columns : mapping
        Titles, with or without the unit, or numbers from 1 of the columns that the user named; the others are known
        by their titles.

    Returns
    -------
    dict
        The columns that were found, by bedrad's names. Where a table has several positions (``X (m)`` beside
        ``Position[X] (m)``), the plainest that has all three components.

    Raises
    ------
    ValueError
        If a column that the user named is not there, or two columns are the same.
    """
    split = [_split(title) for title in header]
    named = {name: _named(name, title, header, split) for name, title in columns.items()}
    known: dict[_Meaning, list[Column]] = {}
    for place, (name, unit) in enumerate(split):
        if meaning := _meaning(name):
            known.setdefault(meaning, []).append(Column(place, header[place], unit))
    wanted = {axis for axis in "xyz" if axis not in columns}
    whole = [form for form in range(len(_POSITIONS)) if all((axis, form) in known for axis in wanted)]
    chosen: dict[str, list[Column]] = {}
    for (name, form), found in known.items():
        size = name in ("radius", "diameter") and not {"radius", "diameter"} & {*columns}
        if size or (name in wanted and (not whole or form == whole[0])):
            chosen.setdefault(name, []).extend(found)
    for name, found in chosen.items():
        if len(found) > 1:
            raise ValueError(f"column {name!r} comes twice: {shown(found[0].title)} and {shown(found[1].title)}")
    return {name: found[0] for name, found in chosen.items()} | named


def _split(title: str) -> tuple[str, str | None]:
    """Name and unit of a title such as ``Track: Position[X] (m)``, ``Particle X-Coordinate: (m)`` or ``x_mm``."""
    if len(title) > _LONGEST:
        return title, None
    name, unit = title, None
    opened = max(title.rfind("["), title.rfind("("))
    inside = title[opened + 1 : -1].strip()
    if opened >= 0 and title.endswith(("]", ")")) and not (inside.lower() in _COMPONENTS and title[:opened].strip()):
        name, unit = title[:opened], inside
    else:
        for border in "_/":
            before, _, after = title.rpartition(border)
            if before and after.strip() in LENGTH_UNITS:
                name, unit = before, after.strip()
    # what STAR-CCM+ writes before a colon says where the values come from
    return name.rstrip(": _/").rpartition(": ")[2].strip().lower(), unit


def _meaning(name: str) -> _Meaning | None:
    """What a column of this name holds: an axis and the form of its name, or a size."""
    if len(name) > _LONGEST:
        return None
    for form, pattern in enumerate(_POSITIONS):
        if match := pattern.fullmatch(name):
            return _AXIS[match["axis"]], form
    return next(((size, 0) for size, pattern in _SIZES if pattern.fullmatch(name)), None)


def _named(name: str, wanted: str, header: Sequence[str], split: Sequence[tuple[str, str | None]]) -> Column:
    """The column that the user named."""
    low = wanted.strip().lower()
    whole = [place for place, title in enumerate(header) if title.lower() == low]
    fits = whole or [place for place, (title, _) in enumerate(split) if title == low]
    if not fits and low.isdecimal() and 1 <= int(low) <= len(header):
        fits = [int(low) - 1]
    if len(fits) != 1:
        said = f"comes {len(fits)} times" if fits else f"is not there; the header has {', '.join(header)[:200]}"
        raise ValueError(f"column {shown(wanted)} for {name} {said}")
    return Column(fits[0], header[fits[0]], split[fits[0]][1])
