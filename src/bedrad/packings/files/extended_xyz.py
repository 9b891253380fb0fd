"""Extended xyz of OVITO and ASE, several frames a file, and plain xyz: a count, a comment, one sphere a row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bedrad.errors import BadFileError
from bedrad.packings.files.boxes import surrounding_box
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.facts import FACTS, Facts, fact_texts
from bedrad.packings.files.lines import LineReader, read_rows
from bedrad.packings.files.rows import rounding_notes, sorted_by_id
from bedrad.packings.files.text import numbers, open_text
from bedrad.packings.packing import Packing

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


@dataclass(frozen=True)
class _Frame:
    """What stands before the rows of a frame."""

    index: int
    count: int
    comment: str
    comment_line: int


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
    """Read one frame.

    Parameters
    ----------
    path : pathlib.Path
        The file, plain or gzip.
    frame : int
        Which frame, counted from 0, or from the end if negative.

    Raises
    ------
    BadFileError
        If the frame does not exist, or what is read up to it is not extended xyz; the message names the line.
    """
    wanted = frame
    if frame < 0:
        # only the end tells which frame that is: the file is gone through once, and nothing is kept
        with open_text(path) as stream:
            lines, count = LineReader(path, stream), 0
            while (found := _next_frame(lines, count)) is not None:
                _skip(lines, found)
                count += 1
        wanted = count + frame
        if wanted < 0:
            raise _no_frame(path, frame, count)
    with open_text(path) as stream:
        lines, index = LineReader(path, stream), 0
        while (found := _next_frame(lines, index)) is not None:
            if index == wanted:
                return _contents(lines, found)
            _skip(lines, found)
            index += 1
    raise _no_frame(path, frame, index)


def iterate_xyz(path: Path) -> Iterator[Contents]:
    """Yield the frames one after the other, keeping one in memory."""
    with open_text(path) as stream:
        lines, index = LineReader(path, stream), 0
        while (found := _next_frame(lines, index)) is not None:
            yield _contents(lines, found)
            index += 1
    if not index:
        raise _no_frame(path, 0, 0)


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


def _next_frame(lines: LineReader, index: int) -> _Frame | None:
    """Read what stands before the rows of a frame; None at the end of the file."""
    text = lines.next_filled()
    if text is None:
        return None
    text = text.strip()
    if not (text.isascii() and text.isdigit() and len(text) < 20):
        raise lines.error(f"expected the number of spheres of frame {index}, found {text[:60]!r}")
    comment = lines.next()
    if comment is None:
        raise _cut_off(lines, index, "its comment is missing")
    return _Frame(index, int(text), comment, lines.number)


def _skip(lines: LineReader, frame: _Frame) -> None:
    passed = lines.skip(frame.count)
    if passed < frame.count:
        raise _cut_off(lines, frame.index, f"{frame.count} rows expected, {passed} found")


def _cut_off(lines: LineReader, index: int, what: str) -> BadFileError:
    whole = f"; {index} whole frames come before it" if index else ""
    return BadFileError(
        f"{lines.path}: frame {index} is cut off: {what}, the file ends after line {lines.number}{whole}"
    )


def _no_frame(path: Path, frame: int, count: int) -> BadFileError:
    return BadFileError(f"{path}: frame {frame} was asked for; the file has {count}, counted from 0")


def _contents(lines: LineReader, frame: _Frame) -> Contents:
    """Read the rows of a frame, in the order of their ids where there are any."""
    path, where = lines.path, f"{lines.path}, line {frame.comment_line}"
    extended = "Properties=" in frame.comment or "Lattice=" in frame.comment
    pairs = _pairs(where, frame.comment) if extended else {}
    places, width = _columns(where, pairs.get("Properties", "species:S:1:pos:R:3"))
    # other columns may follow in plain xyz, which names none
    open_end = "Properties" not in pairs
    said = f"at least {width}" if open_end else f"{width}"

    def pick(cells: list[str], line: int) -> list[str]:
        if len(cells) < width or (len(cells) > width and not open_end):
            raise BadFileError(f"{path}, line {line}: {len(cells)} fields; a row of frame {frame.index} has {said}")
        return [cells[place] for place in places.values()]

    first = lines.number + 1
    values = read_rows(lines, frame.count, pick, list(places))
    if len(values) < frame.count:
        raise _cut_off(lines, frame.index, f"{frame.count} rows expected, {len(values)} found")
    found = dict(zip(places, values.T, strict=True))
    numbers_of_lines: Sequence[int] = range(first, first + frame.count)
    centers = np.stack([found["x"], found["y"], found["z"]], axis=1)
    radii = found["radius"] if "radius" in found else found["diameter"] / 2 if "diameter" in found else None
    ids = None
    if "id" in found:
        order, numbers_of_lines, ids = sorted_by_id(path, found["id"], numbers_of_lines)
        centers = centers[order]
        radii = None if radii is None else radii[order]
    facts = Facts(path)
    for key in FACTS:
        if _PREFIX + key in pairs:
            facts.keep(key, frame.comment_line, pairs[_PREFIX + key].replace("'", '"'))
    origin = {"file": path.name, "format": "xyz", "frame": frame.index, **rounding_notes(centers, radii)}
    return Contents(
        centers=centers,
        radii=radii,
        axis_periods=_periods(path, frame.comment_line, pairs),
        lines=numbers_of_lines,
        ids=ids,
        states_unit="wall" in facts,
        **facts.understood(origin),  # type: ignore[arg-type]
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
            raise BadFileError(f"{where}: the value of {match['key'][:60]!r} begins with {opening} and does not end")
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
            f"{where}: Properties={properties[:80]!r}; expected a name, a type and a number of columns each"
        )
    for name, kind, text in zip(parts[::3], parts[1::3], parts[2::3], strict=True):
        if kind not in ("S", "R", "I", "L"):
            raise BadFileError(f"{where}: property {name!r} has the type {kind!r}; expected S, R, I or L")
        many = int(text) if text.isascii() and text.isdigit() and len(text) < 6 else 0
        if not 1 <= many <= _MOST_COLUMNS:
            raise BadFileError(f"{where}: property {name!r} has {text!r} columns; expected 1 to {_MOST_COLUMNS}")
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
        raise BadFileError(f"{where}: Properties={properties[:80]!r} has no pos:R:3")
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
            f"{where}: the box of Lattice {pairs['Lattice'][:120]!r} is triclinic or turned; "
            "only boxes with right angles along x, y and z are read"
        )
    flags = [_FLAGS.get(word.upper()) for word in _split(pairs.get("pbc", "T T T"))]
    if len(flags) != 3 or None in flags:
        raise BadFileError(f"{where}: pbc is {pairs.get('pbc', '')[:60]!r}; expected three of T and F")
    for axis, (flag, length) in enumerate(zip(flags, lengths.tolist(), strict=True)):
        if flag and not length > 0:
            raise BadFileError(
                f"{where}: the box is periodic along {'xyz'[axis]} and {length} long; expected more than 0"
            )
    return {axis: float(lengths[axis]) for axis in range(3) if flags[axis]}


def _split(text: str) -> list[str]:
    return text.replace(",", " ").split()
