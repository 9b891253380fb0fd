"""Files with bytes changed, lost, repeated or put in: a reader takes them or refuses them, and nothing else."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from hypothesis import strategies as st

from bedrad import BadFileError, Tube
from bedrad.packings.files import read_frames

_WORDS = (b"nan", b"1e999", b"9" * 25, "µ".encode(), b"\n\n", b" 2 0 ")
_BYTES = st.sampled_from([*b"0179-+.eE \t\n#\"'{}[]:=/xX", 0, 0xFF, 0x80])


@st.composite
def mutated(draw: st.DrawFn, samples: list[bytes]) -> bytes:
    """One of the samples after one to four changes."""
    data = bytearray(draw(st.sampled_from(samples)))
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(data)))
        length = draw(st.integers(1, 40))
        change = draw(st.sampled_from(["cut", "lose", "repeat", "replace", "insert", "word"]))
        if change == "cut":
            del data[at:]
        elif change == "lose":
            del data[at : at + length]
        elif change == "repeat":
            data[at:at] = data[at : at + length]
        elif change == "replace":
            data[at : at + 1] = bytes([draw(_BYTES)])
        elif change == "word":
            data[at : at + draw(st.integers(0, 12))] = draw(st.sampled_from(_WORDS))
        else:
            data[at:at] = bytes(draw(st.lists(_BYTES, min_size=1, max_size=5)))
    return bytes(data)


def takes_or_refuses(path: Path, data: bytes) -> None:
    """Read the data from a file at a path; any error but a `BadFileError` comes through."""
    path.write_bytes(data)
    with suppress(BadFileError):
        # nothing overlaps by more than two radii, and a wall far away is reached by few
        for packing in read_frames(path, Tube(1e3), max_overlap=2.0):
            assert len(packing) >= 0
