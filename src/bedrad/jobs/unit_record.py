"""What a unit of work found, as arrays in memory and as bytes that travel and are kept."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.jobs.results import StageData

__all__ = [
    "Place",
    "StageRecord",
    "UnitRecord",
    "Unpacked",
    "gather",
    "key_of",
    "pack",
    "places_of",
    "take_apart",
    "unpack",
]

Value = NDArray[Any] | str

_COMPRESSION = 3
_LONGEST_KEY = 100
_LARGEST = 1 << 28
"""Bytes of a record beyond which it is taken for damaged."""


@dataclass(frozen=True)
class StageRecord:
    """A finished stage of a unit.

    Parameters
    ----------
    digest : str
        SHA-256 of all that went into it.
    values : mapping
        Arrays and texts by name; those of a group inside the stage as ``group/name``.
    """

    digest: str
    values: Mapping[str, Value]

    def data(self) -> StageData:
        """As `Results.read` gives a stage: nested mappings, plain numbers."""
        found: StageData = {}
        for name, value in self.values.items():
            *groups, last = name.split("/")
            place = found
            for group in groups:
                place = place.setdefault(group, {})
            place[last] = value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value
        return found


@dataclass(frozen=True)
class UnitRecord:
    """A finished unit.

    Parameters
    ----------
    key : str
        Digest of the bed: of the file's content and how it is read, or of what it is settled from.
    stages : mapping
        Its stages by name.
    warnings : tuple of str
        What was warned about.
    seconds : float
        Run time. [s]
    """

    key: str
    stages: Mapping[str, StageRecord]
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0


class _Attributes(dict[str, Any]):
    """The attributes of a group or dataset."""


@dataclass
class _Dataset:
    value: Any
    attrs: _Attributes = field(default_factory=_Attributes)


class _Group:
    """Takes what a stage writes into an HDF5 group, without HDF5: ten times as fast for so many small arrays."""

    def __init__(self) -> None:
        self.attrs = _Attributes()
        self._held: dict[str, _Dataset | _Group] = {}

    def __contains__(self, name: str) -> bool:
        return name in self._held

    def create_dataset(self, name: str, data: Any) -> _Dataset:
        self._held[name] = made = _Dataset(data)
        return made

    def create_group(self, name: str) -> _Group:
        self._held[name] = made = _Group()
        return made

    def values(self) -> Iterator[tuple[str, Value]]:
        """Everything inside, attributes of groups included; a text that is missing is none."""
        for name, value in self.attrs.items():
            yield name, value if isinstance(value, str) else np.asarray(value)
        for name, item in self._held.items():
            if isinstance(item, _Dataset):
                yield name, np.asarray(item.value)
            else:
                yield from ((f"{name}/{inner}", value) for inner, value in item.values())


def gather(digest: str, fill: Callable[[Any], None], leave_out: str = "") -> StageRecord:
    """What a stage writes into its group, but for the groups of the name `leave_out` and all texts in lists."""
    group = _Group()
    fill(group)
    return StageRecord(
        digest,
        {
            name: value
            for name, value in group.values()
            if leave_out not in name.split("/")[:-1] and (isinstance(value, str) or value.dtype.kind in "fiub")
        },
    )


@dataclass(frozen=True)
class Place:
    """Where an array lies in the numbers of a record: from which byte on, and as what."""

    stage: str
    name: str
    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    start: int

    @property
    def stop(self) -> int:
        """The byte after its last."""
        return self.start + self.dtype.itemsize * math.prod(self.shape)


@dataclass(frozen=True)
class Unpacked:
    """A record taken apart, its numbers as they lie.

    Parameters
    ----------
    key : str
        As of the record.
    layout : bytes
        What `places_of` reads the places of the arrays from; the same for most units of an ensemble.
    about : mapping
        Digests of the stages by name, texts by stage and name, warnings, run time.
    numbers : bytes
        The arrays one after the other.
    """

    key: str
    layout: bytes
    about: Mapping[str, Any]
    numbers: bytes


def pack(record: UnitRecord) -> bytes:
    """A record as bytes: its key, then, compressed, two tables of contents in JSON, and the numbers as they are."""
    places: list[list[Any]] = []
    texts: list[list[str]] = []
    arrays: list[bytes] = []
    for stage, held in record.stages.items():
        for name, value in held.values.items():
            if isinstance(value, str):
                texts.append([stage, name, value])
                continue
            # little-endian, so that the machines of a cluster may differ
            plain = np.asarray(value, dtype=value.dtype.newbyteorder("<"))
            places.append([stage, name, plain.dtype.str, plain.shape])
            arrays.append(plain.tobytes())
    about = {
        "digests": {stage: held.digest for stage, held in record.stages.items()},
        "texts": texts,
        "warnings": record.warnings,
        "seconds": record.seconds,
    }
    tables = [json.dumps(table).encode() for table in (places, about)]
    lengths = b"".join(len(table).to_bytes(4, "little") for table in tables)
    content = zlib.compress(b"".join([lengths, *tables, *arrays]), _COMPRESSION)
    return record.key.encode() + b"\n" + content


def key_of(content: bytes) -> str:
    """Key of a record, without unpacking it; ValueError if it has none."""
    key, end, _ = content[:_LONGEST_KEY].partition(b"\n")
    if not end or not key.isalnum():
        raise ValueError("not a record of a unit")
    return key.decode("ascii")


def take_apart(content: bytes) -> Unpacked:
    """Take a record apart; ValueError if it is none."""
    key = key_of(content)
    try:
        whole = zlib.decompressobj().decompress(content[len(key) + 1 :], _LARGEST)
        middle = 8 + int.from_bytes(whole[:4], "little")
        end = middle + int.from_bytes(whole[4:8], "little")
        about = json.loads(whole[middle:end])
        about = {
            "digests": {str(stage): str(digest) for stage, digest in about["digests"].items()},
            "texts": [(str(stage), str(name), str(text)) for stage, name, text in about["texts"]],
            "warnings": tuple(map(str, about["warnings"])),
            "seconds": float(about["seconds"]),
        }
    except (zlib.error, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"not a record of a unit: {error}") from None
    return Unpacked(key, whole[8:middle], about, whole[end:])


@lru_cache(maxsize=512)
def places_of(layout: bytes) -> tuple[Place, ...]:
    """Where the arrays of a record lie; ValueError if it does not say so."""
    try:
        found: list[Place] = []
        start = 0
        for stage, name, dtype, shape in json.loads(layout):
            place = Place(str(stage), str(name), np.dtype(str(dtype)), tuple(map(int, shape)), start)
            if place.dtype.kind not in "fiub" or min(place.shape, default=0) < 0:
                raise ValueError(f"{name} is of the kind {dtype} and shape {shape}")
            start = place.stop
            found.append(place)
    except (TypeError, RecursionError, OverflowError) as error:
        raise ValueError(f"not a record of a unit: {error}") from None
    return tuple(found)


def unpack(content: bytes) -> UnitRecord:
    """A record from its bytes.

    Raises
    ------
    ValueError
        If they are none.
    """
    parts = take_apart(content)
    values: dict[str, dict[str, Value]] = {stage: {} for stage in parts.about["digests"]}
    try:
        for place in places_of(parts.layout):
            array = np.frombuffer(parts.numbers, place.dtype, math.prod(place.shape), place.start)
            values[place.stage][place.name] = array.reshape(place.shape)
        for stage, name, text in parts.about["texts"]:
            values[stage][name] = text
    except KeyError as error:
        raise ValueError(f"not a record of a unit: no stage {error}") from None
    stages = {stage: StageRecord(digest, values[stage]) for stage, digest in parts.about["digests"].items()}
    return UnitRecord(parts.key, stages, parts.about["warnings"], parts.about["seconds"])
