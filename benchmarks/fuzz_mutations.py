"""Changes of files that nobody means well: bytes, numbers, words, lines, and pieces of other files of the kind."""

from __future__ import annotations

import gzip
import re
import struct
from collections.abc import Callable, Sequence
from random import Random

__all__ = ["NUMBERS", "WORDS", "mutated", "packed"]

NUMBERS = tuple(
    text.encode()
    for text in (
        *("nan", "-nan", "inf", "-inf", "Infinity", "1e308", "-1e308", "1e999", "1.7976931348623157e308", "1e154"),
        *("1e-308", "5e-324", "1e-200", "1e200", "-0", "-0.0", "0", "1", "-1", "2", "3", "255", "256", "65536"),
        *("2147483647", "2147483648", "4294967295", "9007199254740993", "9223372036854775807", "9223372036854775808"),
        *("-9223372036854775808", "18446744073709551615", "18446744073709551616", "9" * 25, "9" * 400, "9" * 5000),
        *("1e1000000000", "1_0", "0x10", "1e", "1d3", "+", "1,5", "1j", "True", "None", "null", "١٢", "１", "²", "½"),
    )
)
"""Numbers, and what is nearly one."""

WORDS = tuple(
    text.encode("utf-8", "surrogateescape")
    for text in (
        *("", " ", "\t", "\n", "\n\n", "\r\n", "\r", "\0", "\x1b[31m", "\ufeff", "\u2028", "\x85", "\udcff\udcfe", "µ"),
        *(
            '"',
            "'",
            '"""',
            "#",
            "# ",
            "#+",
            "\\",
            "{",
            "}",
            "[",
            "]",
            "(",
            ")",
            "<",
            ">",
            "/>",
            "&amp;",
            "&x;",
            "=",
            ":",
        ),
        *(
            "..",
            "../",
            "/etc/passwd",
            "/dev/zero",
            "C:\\",
            "file:///etc/passwd",
            "%00",
            "${HOME}",
            "$(id)",
            "__import__",
        ),
        *("m", "mm", "km", "degC", "K", "m^9^9^9", "plate", "tube", "rod", "radius", "diameter", "id", "x", "y", "z"),
        *("ITEM: ATOMS", "POINTS", "DATASET", "Atoms", "Particles", "Version 2.0", "#format x_y_z_r", "Properties="),
    )
)
"""Words that some reader knows, or should not stumble over."""

_NUMBER = re.compile(rb"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_WORD = re.compile(rb"[A-Za-z_]{1,30}")
_INTEGERS = (0, 1, 2, 3, 0x7F, 0x80, 0xFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 2**63 - 1, 2**63, 2**64 - 1)
_FORMS = ("<H", ">H", "<I", ">I", "<Q", ">Q")
_LONG = 100_000


def mutated(rng: Random, data: bytes, others: Sequence[bytes], *, binary: bool) -> bytes:
    """A file after one to six changes.

    Parameters
    ----------
    rng : random.Random
        Where chance comes from.
    data : bytes
        The file.
    others : sequence of bytes
        Files of the same kind, pieces of which are put in.
    binary : bool
        Whether numbers are bytes rather than text, mostly.
    """
    changes = _BINARY if binary else _TEXT
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4, 6))):
        data = rng.choice(changes)(rng, data, others)
    if rng.random() < 0.004:
        data = _longer(rng, data)
    return data


def packed(rng: Random, data: bytes) -> bytes:
    """The file packed with gzip, whole, damaged, doubled, or with a bomb behind it."""
    kind = rng.randrange(5)
    whole = gzip.compress(data, 1, mtime=0)
    if kind == 0:
        return mutated(rng, whole, [], binary=True)
    if kind == 1:
        return whole[: rng.randrange(len(whole) + 1)]
    if kind == 2:
        return whole + gzip.compress(data, 1, mtime=0)
    if kind == 3 and rng.random() < 0.02:
        return gzip.compress(data + rng.choice((b"\0", b" ", b"\n", b"0 ", data[-40:])) * (1 << 19), 6, mtime=0)
    return whole


def _place(rng: Random, data: bytes) -> int:
    # the beginning of a file says the most about it
    most = len(data) if rng.random() < 0.7 else min(len(data), 200)
    return rng.randint(0, most)


def _flip(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    changed = bytearray(data)
    for _each in range(rng.choice((1, 1, 2, 8))):
        if changed:
            at = rng.randrange(len(changed))
            changed[at] = rng.choice((changed[at] ^ (1 << rng.randrange(8)), rng.randrange(256), 0, 0xFF))
    return bytes(changed)


def _integer(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    form = rng.choice(_FORMS)
    size = struct.calcsize(form)
    if len(data) < size:
        return data
    at = _place(rng, data[: len(data) - size])
    value = rng.choice(_INTEGERS) & ((1 << 8 * size) - 1)
    return data[:at] + struct.pack(form, value) + data[at + size :]


def _float(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    form = rng.choice(("<d", ">d", "<f", ">f"))
    at = _place(rng, data)
    value = rng.choice((float("nan"), float("inf"), -1.0, 0.0, 1e38, -1e-38))
    return data[:at] + struct.pack(form, value) + data[at + struct.calcsize(form) :]


def _cut(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    return data[: _place(rng, data)]


def _lose(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    at = _place(rng, data)
    return data[:at] + data[at + rng.choice((1, 2, 4, 8, 20, 100, 1000)) :]


def _repeat(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    at = _place(rng, data)
    piece = data[at : at + rng.choice((1, 4, 8, 30, 200))]
    return data[:at] + piece * rng.choice((2, 2, 3, 10)) + data[at + len(piece) :]


def _splice(rng: Random, data: bytes, others: Sequence[bytes]) -> bytes:
    if not others:
        return data
    other = rng.choice(others)
    if rng.random() < 0.5:
        # the head of one on the body of another
        return other[: _place(rng, other)] + data[_place(rng, data) :]
    at, start = _place(rng, data), _place(rng, other)
    return data[:at] + other[start : start + rng.choice((4, 20, 100, 400))] + data[at:]


def _random(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    at = _place(rng, data)
    return data[:at] + rng.randbytes(rng.choice((1, 2, 4, 16))) + data[at + rng.choice((0, 1, 4)) :]


def _found(rng: Random, data: bytes, pattern: re.Pattern[bytes]) -> re.Match[bytes] | None:
    start = _place(rng, data)
    return pattern.search(data, start) or pattern.search(data)


def _number(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    match = _found(rng, data, _NUMBER)
    if match is None:
        return data
    return data[: match.start()] + rng.choice(NUMBERS) + data[match.end() :]


def _word(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    match = _found(rng, data, _WORD)
    if match is None or rng.random() < 0.3:
        at = _place(rng, data)
        return data[:at] + rng.choice(WORDS) + data[at:]
    other = _found(rng, data, _WORD)
    new = rng.choice((rng.choice(WORDS), match.group().swapcase(), other.group() if other else b"", b""))
    return data[: match.start()] + new + data[match.end() :]


def _line(rng: Random, data: bytes, others: Sequence[bytes]) -> bytes:
    lines = data.split(b"\n")
    a, b = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(6)
    if kind == 0:
        lines[a], lines[b] = lines[b], lines[a]
    elif kind == 1:
        del lines[a]
    elif kind == 2:
        lines[a:a] = [lines[b]] * rng.choice((1, 1, 2, 50))
    elif kind == 3:
        words = lines[a].split()
        rng.shuffle(words)
        lines[a] = b" ".join(words)
    elif kind == 4 and others:
        lines[a] = rng.choice(rng.choice(others).split(b"\n"))
    else:
        lines[a] = lines[a].replace(rng.choice((b" ", b",", b";", b"\t")), rng.choice((b" ", b",", b";", b"\t", b"")))
    return b"\n".join(lines)


def _ends(rng: Random, data: bytes, _: Sequence[bytes]) -> bytes:
    kind = rng.randrange(5)
    if kind == 0:
        return data.replace(b"\n", rng.choice((b"\r\n", b"\r", b"\n\n")))
    if kind == 1:
        return b"\xef\xbb\xbf" + data
    if kind == 2:
        return data.decode("latin-1").encode(rng.choice(("utf-16", "utf-16-le", "utf-32")))
    return data.rstrip() if kind == 3 else data + data


def _longer(rng: Random, data: bytes) -> bytes:
    """Something far too long: what takes the square of its length shows itself."""
    at = _place(rng, data)
    unit = rng.choice(
        (b" ", b"\n", b"0 ", b"(", b"[", b"{", b"<a>", b"-", b"a=", b'"', b"\\", b"\t", b",", b"a,", b"9")
    )
    if rng.random() < 0.3:
        lines = data.split(b"\n")
        unit = rng.choice(lines)[:200] + b"\n"
        at = len(data)
    return data[:at] + unit * (rng.choice((1000, 20_000, _LONG)) // len(unit)) + data[at:]


Change = Callable[[Random, bytes, Sequence[bytes]], bytes]

_BINARY: tuple[Change, ...] = (
    *(
        _flip,
        _flip,
        _flip,
        _integer,
        _integer,
        _integer,
        _float,
        _cut,
        _lose,
        _repeat,
        _splice,
        _random,
        _number,
        _word,
    ),
)
_TEXT: tuple[Change, ...] = (
    *(_number, _number, _number, _word, _word, _line, _line, _line, _flip, _cut, _lose, _repeat, _splice, _random),
    *(_ends,),
)
