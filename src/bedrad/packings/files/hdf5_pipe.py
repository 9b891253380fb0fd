"""What goes through the pipe to the process that reads HDF5 files: JSON for what is small, bare bytes for arrays."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Sequence
from typing import Any, BinaryIO, cast

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.files.contents import Contents, describe_wall, make_wall

__all__ = ["contents_of_message", "message_of_contents", "receive", "send"]

Arrays = Sequence[NDArray[Any]]

_LENGTH = struct.Struct("<Q")
_KINDS = (np.dtype("f8").str, np.dtype("i8").str)
"""The numbers that are sent; others are refused at the other end."""


def send(stream: BinaryIO, message: dict[str, Any], arrays: Arrays = ()) -> None:
    """Send a message and the arrays that belong to it, of which only the bytes go through the pipe."""
    held = [np.ascontiguousarray(array) for array in arrays]
    told = message | {"arrays": [[array.dtype.str, array.shape] for array in held]}
    text = json.dumps(told).encode("ascii")
    _write(stream, _LENGTH.pack(len(text)) + text)
    for array in held:
        if array.size:
            _write(stream, array.reshape(-1).data.cast("B"))
    stream.flush()


def receive(stream: BinaryIO) -> tuple[dict[str, Any], list[NDArray[Any]]]:
    """Take a message and its arrays; EOFError where the other end is gone."""
    (length,) = _LENGTH.unpack(_filled(stream, bytearray(_LENGTH.size)))
    message = json.loads(bytes(_filled(stream, bytearray(length))))
    arrays = []
    for kind, shape in message.pop("arrays"):
        if kind not in _KINDS:
            raise ValueError(f"an array of {kind}; expected {' or '.join(_KINDS)}")
        array = np.empty(shape, kind)
        if math.prod(shape):
            _filled(stream, array.reshape(-1).data.cast("B"))
        arrays.append(array)
    return message, arrays


def _write(stream: BinaryIO, data: bytes | memoryview) -> None:
    view = memoryview(data)
    while view:
        # bare streams may take less than they were given, where a signal comes between
        view = view[stream.write(view) :]


def _filled(stream: BinaryIO, buffer: bytearray | memoryview) -> bytearray | memoryview:
    place, view = 0, memoryview(buffer)
    while place < len(view):
        # bare streams may give less than was asked for
        count = cast(Any, stream).readinto(view[place:])
        if not count:
            raise EOFError
        place += count
    return buffer


def message_of_contents(held: Contents) -> tuple[dict[str, Any], list[NDArray[Any]]]:
    """Return what a file holds as a message and arrays; for what HDF5 files hold, not for other formats."""
    named = {"centers": held.centers, "radii": held.radii, "ids": held.ids}
    there = {name: array for name, array in named.items() if array is not None}
    message = {
        "names": list(there),
        "wall": None if held.wall is None else describe_wall(held.wall),
        "period": held.period,
        "provenance": dict(held.provenance),
        "max_overlap": held.max_overlap,
        "states_unit": held.states_unit,
    }
    return message, list(there.values())


def contents_of_message(message: dict[str, Any], arrays: Arrays) -> Contents:
    """Return what `message_of_contents` was given, bit for bit."""
    named = dict(zip(message["names"], arrays, strict=True))
    period = message["period"]
    return Contents(
        centers=named["centers"],
        radii=named.get("radii"),
        ids=named.get("ids"),
        wall=None if message["wall"] is None else make_wall(*message["wall"]),
        period=(period[0], period[1]) if isinstance(period, list) else period,
        provenance=message["provenance"],
        max_overlap=message["max_overlap"],
        states_unit=message["states_unit"],
    )
