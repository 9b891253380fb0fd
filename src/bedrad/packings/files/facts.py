"""What bedrad knows beside the spheres (wall, period, overlap limit, provenance), as texts inside other formats."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.errors import BadFileError, visible
from bedrad.packings.files.contents import describe_wall, make_wall, plain_value
from bedrad.packings.files.text import shown
from bedrad.packings.packing import Packing, Provenance
from bedrad.walls import Wall

__all__ = ["FACTS", "Facts", "fact_comments", "fact_texts"]

_FACT = re.compile(r"#\s*(?P<key>wall|period|max_overlap|provenance)\s*:\s*(?P<value>.*)")
_WALL = re.compile(r"(?P<kind>\w+)(?:\s+radius\s*=\s*(?P<radius>\S+)\s+m)?")

_BREAK, _GOES_ON = "\\", "#+"
"""How a comment line ends that goes on in the next, and how that begins."""

_LONGEST = 500_000
"""What the line of the provenance may have; readers refuse lines that are too long for any table. [characters]"""


@dataclass
class Facts:
    """The facts that were met while a file was read, not understood yet.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    """

    path: Path
    _found: dict[str, tuple[int, list[str]]] = field(default_factory=dict, init=False)
    _last: str = field(default="", init=False)

    def __contains__(self, key: str) -> bool:
        return key in self._found

    def see_comment(self, line: int, text: str) -> None:
        """Keep the fact that a comment line such as ``# wall: tube radius=0.01 m`` holds, if it holds one.

        A line that ends in a backslash goes on in the next, which begins with ``#+``.
        """
        text = text.strip()
        if fact := _FACT.fullmatch(text):
            self._last = fact["key"]
            self.keep(fact["key"], line, fact["value"])
        elif text.startswith(_GOES_ON) and self._last in self._found:
            parts = self._found[self._last][1]
            parts[-1] = parts[-1].removesuffix(_BREAK)
            parts.append(text.removeprefix(_GOES_ON))

    def keep(self, key: str, line: int, text: str) -> None:
        """Keep the text of a fact and the line it stands in."""
        self._found[key] = (line, [text])

    def understood(self, origin: Provenance) -> dict[str, Any]:
        """Return the facts as arguments of `Contents`.

        Parameters
        ----------
        origin : mapping
            The provenance of a file that holds none.

        Raises
        ------
        BadFileError
            If a fact cannot be understood; the message names the line.
        """
        read: dict[str, Any] = {"provenance": dict(origin)}
        for key, (line, parts) in self._found.items():
            text = "".join(parts)
            try:
                read[key] = FACTS[key](text)
            except (ValueError, RecursionError) as error:
                reason = visible(str(error))[:200]
                raise BadFileError(
                    f"{self.path}, line {line}: {key} {shown(text)} is not understood: {reason}"
                ) from error
        return read


def fact_texts(packing: Packing) -> dict[str, str]:
    """Return wall, period (if there is one), overlap limit and provenance of a packing as texts in metres.

    Raises
    ------
    ValueError
        If a provenance value is not a text, a float or a 64-bit integer, or all are too long for a line.
    """
    kind, radius = describe_wall(packing.wall)
    texts = {"wall": kind + ("" if radius is None else f" radius={radius!r} m")}
    if packing.period is not None:
        texts["period"] = f"{' '.join(repr(float(v)) for v in np.atleast_1d(packing.period))} m"
    texts["max_overlap"] = repr(packing.max_overlap)
    notes = json.dumps({key: plain_value(key, value) for key, value in packing.provenance.items()})
    if len(notes) > _LONGEST:
        raise ValueError(f"the provenance takes {len(notes)} characters; text formats hold {_LONGEST}")
    return texts | {"provenance": notes}


def fact_comments(packing: Packing, width: int | None = None) -> list[str]:
    """Return the facts as comment lines, which `Facts.see_comment` understands; errors as for `fact_texts`.

    Parameters
    ----------
    packing : Packing
        The packing.
    width : int, optional
        Characters that a line may have, for programs that take a longer one for several.
    """
    lines = []
    for key, text in fact_texts(packing).items():
        line = f"# {key}: {text}"
        while width is not None and len(line) > width:
            end = width - len(_BREAK)
            lines.append(line[:end] + _BREAK)
            line = _GOES_ON + line[end:]
        lines.append(line)
    return lines


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


FACTS: dict[str, Callable[[str], object]] = {
    "wall": _read_wall,
    "period": _read_period,
    "max_overlap": float,
    "provenance": _read_notes,
}
"""The facts by name, and what turns their texts into values."""
