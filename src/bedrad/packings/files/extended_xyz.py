"""Extended xyz of OVITO and ASE, several frames a file, and plain xyz: a count, a comment, one sphere a row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.boxes import surrounding_box
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.facts import FACTS, Facts, fact_texts
from bedrad.packings.files.frames import Frame, FrameFile, frame_rows
from bedrad.packings.files.lines import Lines
from bedrad.packings.files.rows import RegularRows, numbers
from bedrad.packings.files.table_spheres import table_spheres
from bedrad.packings.files.text import shown
from bedrad.packings.packing import Packing, Provenance

__all__ = ["iterate_xyz", "looks_like_xyz", "read_xyz", "write_xyz"]

_COLUMNS = {
    "pos": "pos",
    "position": "pos",
    "positions": "pos",
    "radius": "radius",
    "radii": "radius",
    "diameter": "diameter",
    "diameters": "diameter",
    "id": "id",
}
"""Properties that matter, in small letters, and what they are called here."""

_PREFIX = "bedrad_"
_KEY = re.compile(r"\s*(?P<key>[^\s=]+)\s*(?P<equals>=\s*)?")
_WORD = re.compile(r"(\S*)")
_DELIMITED = {
    '"': re.compile(r'"((?:[^"\\]|\\.)*)"'),
    "'": re.compile(r"'((?:[^'\\]|\\.)*)'"),
    "{": re.compile(r"\{([^}]*)\}"),
    "[": re.compile(r"\[([^\]]*)\]"),
}
_FLAGS = {"T": True, "F": False, "TRUE": True, "FALSE": False, "1": True, "0": False}
_MOST_COLUMNS = 10_000
_TILT = 1e-12
"""Share of the longest edge that an edge may lean by, as roundings of a turned box do."""


def looks_like_xyz(head: bytes) -> bool:
    """Whether a file begins with a count, a comment, and a row that begins with a word, or says its Properties."""
    lines = head.decode("utf-8-sig", errors="replace").splitlines()
    if len(lines) < 2 or not (lines[0].strip().isascii() and lines[0].strip().isdigit()):
        return False
    if "Properties=" in lines[1]:
        return True
    row = lines[2].split() if len(lines) > 2 else []
    return len(row) >= 4 and row[0][0].isalpha()


def read_xyz(path: Path, frame: int = -1) -> Contents:
    """Read one frame, plain or gzip; parameters and errors as for `FrameFile.read`."""
    return _XYZ.read(path, frame)


def iterate_xyz(path: Path) -> Iterator[Contents]:
    """Yield the frames one after the other, keeping one in memory."""
    return _XYZ.iterate(path)


def write_xyz(packing: Packing, path: Path) -> None:
    """Write a packing as one frame of extended xyz, overwriting `path`; `read_xyz` gives it back bit for bit.

    Lattice and pbc hold the box, so that other programs see the period; bedrad's own facts are further keys.
    """
    box = surrounding_box(packing)
    edges = np.diag([high - low for low, high in box]).ravel().tolist()
    pairs = {
        "Lattice": " ".join(map(repr, edges)),
        "Origin": " ".join(repr(float(low)) for low, _ in box),
        "pbc": " ".join("T" if period else "F" for period in packing.box),
        **{_PREFIX + key: _plain_quotes(text) for key, text in fact_texts(packing).items()},
    }
    comment = " ".join(f'{key}="{value}"' for key, value in pairs.items())
    with path.open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(f"{len(packing)}\nProperties=species:S:1:pos:R:3:radius:R:1 {comment}\n")
        # X stands for no element; repr of a Python float is the shortest text that reads back as the same number
        for (x, y, z), r in zip(packing.centers.tolist(), packing.radii.tolist(), strict=True):
            stream.write(f"X {x!r} {y!r} {z!r} {r!r}\n")


def _plain_quotes(json_text: str) -> str:
    """Write a JSON text without double quotes, which end a value in the comment of extended xyz."""
    return json_text.replace("'", "\\u0027").replace('"', "'")


def _read_header(lines: Lines, index: int, _: Frame[str] | None) -> tuple[str, int] | None:
    """Read the count and the comment of the next frame; None at the end of the file."""
    text = lines.next_filled()
    if text is None:
        return None
    text = text.strip()
    if not re.fullmatch("[0-9]{1,18}", text):
        raise lines.error(f"expected the number of spheres of frame {index}, found {shown(text)}")
    comment = lines.next()
    if comment is None:
        raise BadFileError(f"{lines.path}: cut off after line {lines.number}; expected the comment of frame {index}")
    return comment, int(text)


def _contents(lines: Lines, frame: Frame[str]) -> Contents:
    """Read the rows of a frame."""
    path, comment, line = lines.path, frame.header, lines.number
    extended = "Properties=" in comment or "Lattice=" in comment
    pairs = _pairs(f"{path}, line {line}", comment) if extended else {}
    places, width = _columns(f"{path}, line {line}", pairs.get("Properties", "species:S:1:pos:R:3"))
    # other columns may follow in plain xyz, which names none
    open_end = "Properties" not in pairs
    said = f"a row of frame {frame.index} has {'at least ' if open_end else ''}{width}"
    table = frame_rows(lines, frame, RegularRows(path, places, width, said, open_end=open_end))
    facts = Facts(path)
    for key in FACTS:
        if _PREFIX + key in pairs:
            facts.keep(key, line, pairs[_PREFIX + key].replace("'", '"'))
    origin: Provenance = {"file": path.name, "format": "xyz", "frame": frame.index}
    return table_spheres(
        path, table, origin, facts, axis_periods=_periods(path, line, pairs), states_unit="wall" in facts
    )


def _pairs(where: str, comment: str) -> dict[str, str]:
    """Split a comment into keys and values; a value may stand between quotes or brackets."""
    pairs: dict[str, str] = {}
    at = 0
    while match := _KEY.match(comment, at):
        at = match.end()
        if not match["equals"]:
            continue
        opening = comment[at : at + 1]
        value = _DELIMITED.get(opening, _WORD).match(comment, at)
        if value is None:
            raise BadFileError(f"{where}: the value of {shown(match['key'])} begins with {opening} and does not end")
        pairs[match["key"]] = value[1]
        at = value.end()
    return pairs


def _columns(where: str, properties: str) -> tuple[dict[str, int], int]:
    """Places of the wanted columns, and how many there are altogether."""
    parts = properties.split(":")
    places: dict[str, int] = {}
    width = 0
    if len(parts) % 3:
        raise BadFileError(
            f"{where}: Properties={shown(properties)}; expected a name, a type and a number of columns each"
        )
    for name, kind, text in zip(parts[::3], parts[1::3], parts[2::3], strict=True):
        if kind not in ("S", "R", "I", "L"):
            raise BadFileError(f"{where}: property {shown(name)} has the type {shown(kind)}; expected S, R, I or L")
        many = int(text) if text.isascii() and text.isdigit() and len(text) < 6 else 0
        if not 1 <= many <= _MOST_COLUMNS:
            raise BadFileError(
                f"{where}: property {shown(name)} has {shown(text)} columns; expected 1 to {_MOST_COLUMNS}"
            )
        wanted = _COLUMNS.get(name.lower())
        if wanted is not None:
            if many != (3 if wanted == "pos" else 1) or kind not in ("R", "I"):
                raise BadFileError(
                    f"{where}: property {name!r} is {kind}:{many}; expected R:{3 if wanted == 'pos' else 1}"
                )
            names = ("x", "y", "z") if wanted == "pos" else (wanted,)
            if names[0] in places:
                raise BadFileError(f"{where}: property {name!r} comes twice")
            places |= {axis: width + place for place, axis in enumerate(names)}
        width += many
    if "x" not in places:
        raise BadFileError(f"{where}: Properties={shown(properties)} has no pos:R:3")
    if "radius" in places:
        places.pop("diameter", None)
    return places, width


def _periods(path: Path, line: int, pairs: Mapping[str, str]) -> dict[int, float]:
    """Periods of the axes, from the edges of the box and the flags; without flags, a box is periodic throughout."""
    if "Lattice" not in pairs:
        return {}
    where = f"{path}, line {line}"
    parts = _split(pairs["Lattice"])
    if len(parts) not in (3, 9):
        raise BadFileError(f"{where}: Lattice has {len(parts)} numbers; expected 9")
    edges = numbers(path, [parts], ["Lattice"] * len(parts), [line])[0]
    lattice = np.diag(edges) if len(parts) == 3 else edges.reshape(3, 3)
    lengths = np.diag(lattice)
    if np.abs(lattice - np.diag(lengths)).max() > _TILT * np.abs(lengths).max():
        raise BadFileError(
            f"{where}: the box of Lattice {shown(pairs['Lattice'])} is triclinic or turned; "
            "only boxes with right angles along x, y and z are read"
        )
    flags = [_FLAGS.get(word.upper()) for word in _split(pairs.get("pbc", "T T T"))]
    if len(flags) != 3 or None in flags:
        raise BadFileError(f"{where}: pbc is {shown(pairs.get('pbc', ''))}; expected three of T and F")
    for axis, (flag, length) in enumerate(zip(flags, lengths.tolist(), strict=True)):
        if flag and not length > 0:
            raise BadFileError(
                f"{where}: the box is periodic along {'xyz'[axis]} and {length} long; expected more than 0"
            )
    return {axis: float(lengths[axis]) for axis in range(3) if flags[axis]}


def _split(text: str) -> list[str]:
    return text.replace(",", " ").split()


_XYZ = FrameFile(_read_header, _contents, "no frame in the whole file; expected the number of spheres first")
