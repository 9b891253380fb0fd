"""How many parts the keys of a TOML text have, before a parser takes time with them."""

from __future__ import annotations

import re

__all__ = ["MOST_PARTS", "longest_key"]

MOST_PARTS = 32
"""Parts of a dotted key. The time that the parser takes grows with their square, to 24 s for a key of 60 kB; with so
many parts, however often they come, a text of 64 KiB takes less than half a second."""

# what is open to the end of its line or of the text is taken to there, so that nothing is looked at twice
_STRING_OR_COMMENT = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+(?:"{3,5})?'
    r"|'''(?:[^']|'(?!''))*+(?:'{3,5})?"
    r'|"(?:[^"\\\n]|\\[^\n])*+"?'
    r"|'[^'\n]*+'?"
    r"|#[^\n]*+",
    re.DOTALL,
)

_BETWEEN_KEYS = re.compile(r"[\n=,\[\]{}]")


def longest_key(text: str) -> tuple[int, int]:
    """Parts of the key with the most dots, and the line where it stands.

    Strings and comments are taken out first, so that paths and prose may have any number of dots. What is left has dots
    in keys and in numbers, and nothing that parts those from each other stands within a key.

    Parameters
    ----------
    text : str
        A text in TOML, or one that should be.

    Returns
    -------
    parts, line : int
        The largest number of parts, 1 without a dot; the line from 1.
    """
    bare = _STRING_OR_COMMENT.sub(lambda found: "\n" * found[0].count("\n"), text)
    most, place, start = 1, 0, 0
    for end in (*(sign.start() for sign in _BETWEEN_KEYS.finditer(bare)), len(bare)):
        parts = bare.count(".", start, end) + 1
        if parts > most:
            most, place = parts, start
        start = end + 1
    return most, bare.count("\n", 0, place) + 1
