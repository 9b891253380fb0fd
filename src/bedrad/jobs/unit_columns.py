"""Records of many units side by side: one array a field, a row a unit, in the results file and in memory."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from bedrad.jobs.fields import FLOW, HISTORY, PREDICTION, STATISTICS, SYSTEM, UNITS, VIEW_FACTORS, WALL_LAYER, Field
from bedrad.jobs.unit_record import Place, StageRecord, UnitRecord, Value, places_of, take_apart

__all__ = ["Column", "field_of", "read_columns", "record_of_row", "stack", "texts", "write_columns"]

_FIELDS: Mapping[str, Mapping[str, Field]] = {
    "flow": FLOW,
    "statistics": STATISTICS,
    "view_factors": {**VIEW_FACTORS, **HISTORY},
    "prediction": {**PREDICTION, **SYSTEM, **WALL_LAYER},
}
_DIGEST = "digest"
_AT_ONCE = 512
"""Records that are put into the columns at once."""

_OF = "of"
"""Attribute of a dataset that only says how to read another one: its name."""


@dataclass(frozen=True)
class Column:
    """A field of all units.

    Parameters
    ----------
    values : (units, ...) array or list of str
        The values; where units differ in shape, each fills the beginning of its row, and the rest is nan or zero.
    shapes : (units, n) int array or None
        Shapes of the rows, where they differ.
    present : (units,) bool array or None
        Which units have the field, where some lack it.
    """

    values: NDArray[Any] | list[str]
    shapes: NDArray[np.int64] | None = None
    present: NDArray[np.bool_] | None = None

    def row(self, number: int) -> Value | None:
        """The value of a unit; None where it has none."""
        if self.present is not None and not self.present[number]:
            return None
        if isinstance(self.values, list):
            return self.values[number]
        row = np.asarray(self.values[number])
        return row if self.shapes is None else row[tuple(map(slice, self.shapes[number]))]


def field_of(stage: str, name: str) -> Field:
    """Units and long name of a field of a stage."""
    last = name.rpartition("/")[2]
    for ending, prefix in (("_error", "standard error: "), ("", "")):
        field = last.removesuffix(ending) if last.endswith(ending) else last
        for table in (_FIELDS.get(stage, {}), UNITS):
            if field in table:
                return table[field][0], prefix * (field != last) + table[field][1]
    return "1" if last.startswith("left_out_") else "", last.replace("_", " ")


def stack(
    records: Iterable[bytes], again: Iterable[bytes], count: int, stages: Container[str]
) -> tuple[dict[str, dict[str, Column]], list[tuple[str, ...]], list[float]]:
    """Put records side by side, many at a time where they are laid out alike, as nearly all units of an ensemble are.

    Parameters
    ----------
    records, again : iterable of bytes
        The same packed records twice, as they need not be in memory at once: the first time for the shapes.
    count : int
        Their number.
    stages : container of str
        The stages that are wanted.

    Returns
    -------
    columns : dict
        Fields by name by stage, with the digests of the stages among them.
    warnings, seconds : list
        What was warned about, and the run times.
    """
    frames: dict[tuple[str, str], _Frame] = {}
    told: list[tuple[str, ...]] = []
    seconds: list[float] = []
    alike: dict[bytes, list[int]] = {}
    for number, content in enumerate(records):
        parts = take_apart(content)
        told.append(parts.about["warnings"])
        seconds.append(parts.about["seconds"])
        alike.setdefault(parts.layout, []).append(number)
        digests = ((stage, _DIGEST, digest) for stage, digest in parts.about["digests"].items())
        for stage, name, text in (*digests, *parts.about["texts"]):
            if stage in stages:
                frame = frames.get((stage, name)) or frames.setdefault((stage, name), _Frame("", (), count))
                frame.put_text(number, text)
    for layout, numbers in alike.items():
        for place in places_of(layout):
            if place.stage in stages:
                which = place.stage, place.name
                frame = frames.get(which) or frames.setdefault(which, _Frame(place.dtype, place.shape, count))
                frame.see(numbers, place)
    _fill_frames(frames, again, alike)
    columns: dict[str, dict[str, Column]] = {}
    for (stage, name), frame in frames.items():
        columns.setdefault(stage, {})[name] = frame.column()
    return columns, told, seconds


def _fill_frames(frames: Mapping[tuple[str, str], _Frame], records: Iterable[bytes], layouts: Iterable[bytes]) -> None:
    """Put the numbers of all records into the columns."""
    blocks: dict[bytes, list[tuple[int, bytes]]] = {layout: [] for layout in layouts}
    for number, content in enumerate(records):
        parts = take_apart(content)
        blocks[parts.layout].append((number, parts.numbers))
        if len(blocks[parts.layout]) == _AT_ONCE:
            _put(blocks[parts.layout], parts.layout, frames)
            blocks[parts.layout] = []
    for layout, block in blocks.items():
        if block:
            _put(block, layout, frames)


def _put(block: Sequence[tuple[int, bytes]], layout: bytes, frames: Mapping[tuple[str, str], _Frame]) -> None:
    """Put the numbers of records that are laid out alike into the columns."""
    rows = np.array([number for number, _ in block])
    table = np.frombuffer(b"".join(numbers for _, numbers in block), np.uint8).reshape(len(block), -1)
    for place in places_of(layout):
        frame = frames.get((place.stage, place.name))
        if frame is not None:
            part = np.ascontiguousarray(table[:, place.start : place.stop]).reshape(-1)
            frame.put(rows, part.view(place.dtype).reshape(len(block), *place.shape))


class _Frame:
    """A column that is being filled."""

    def __init__(self, kind: Any, shape: tuple[int, ...], count: int) -> None:
        self._present = np.zeros(count, dtype=bool)
        self._texts: list[str] = [""] * count if isinstance(kind, str) else []
        self._values: NDArray[Any] | None = None
        self._dtype = np.dtype(kind or np.float64)
        self._shapes = np.zeros((count, len(shape)), dtype=np.int64)

    def put_text(self, number: int, text: str) -> None:
        self._present[number] = True
        self._texts[number] = text

    def see(self, numbers: Sequence[int], place: Place) -> None:
        self._present[numbers] = True
        self._shapes[numbers] = place.shape
        self._dtype = np.result_type(self._dtype, place.dtype)

    def put(self, rows: NDArray[np.int64], values: NDArray[Any]) -> None:
        if self._values is None:
            filling = np.nan if self._dtype.kind == "f" else 0
            self._values = np.full((len(self._present), *self._shapes.max(axis=0)), filling, self._dtype)
        part: Any = (rows, *(slice(length) for length in values.shape[1:]))
        self._values[part] = values

    def column(self) -> Column:
        present = None if self._present.all() else self._present
        if self._values is None:
            return Column(self._texts, None, present)
        alike = (self._shapes[self._present] == self._values.shape[1:]).all()
        return Column(self._values, None if alike else self._shapes, present)


def write_columns(group: h5py.Group, columns: Mapping[str, Mapping[str, Column]]) -> None:
    """Write columns into an HDF5 group: a group a stage, a dataset a field."""
    for stage, held in columns.items():
        inside = group.create_group(stage)
        for name, column in held.items():
            write_values(inside, name, column.values, field_of(stage, name))
            for ending, more in (("shape", column.shapes), ("present", column.present)):
                if more is not None:
                    extra = inside.create_dataset(f"{name}_{ending}", data=more)
                    extra.attrs[_OF] = name
                    extra.attrs["units"], extra.attrs["long_name"] = "1", f"{ending} of each row of {name}"


def write_values(group: h5py.Group, name: str, values: NDArray[Any] | Sequence[str], field: Field) -> None:
    """Write an array or texts, with units and long name."""
    if isinstance(values, np.ndarray):
        made = group.create_dataset(name, data=values)
    else:
        made = group.create_dataset(name, data=np.array(values, dtype=object), dtype=h5py.string_dtype())
    made.attrs["units"], made.attrs["long_name"] = field


def read_columns(group: h5py.Group) -> dict[str, dict[str, Column]]:
    """The columns in an HDF5 group, as `write_columns` writes them."""
    found: dict[str, dict[str, Column]] = {}
    for stage, inside in group.items():
        if not isinstance(inside, h5py.Group):
            continue
        datasets: dict[str, Any] = {}
        inside.visititems(
            lambda name, item, held=datasets: held.update({name: item}) if hasattr(item, "dtype") else None
        )
        found[stage] = {
            name: Column(
                texts(item) if h5py.check_string_dtype(item.dtype) else item[()],
                datasets[f"{name}_shape"][()] if f"{name}_shape" in datasets else None,
                datasets[f"{name}_present"][()] if f"{name}_present" in datasets else None,
            )
            for name, item in datasets.items()
            if _OF not in item.attrs
        }
    return found


def _datasets(group: h5py.Group, prefix: str = "") -> Iterator[tuple[str, h5py.Dataset]]:
    for name, item in group.items():
        if isinstance(item, h5py.Group):
            yield from _datasets(item, f"{prefix}{name}/")
        else:
            yield f"{prefix}{name}", item


def texts(dataset: h5py.Dataset) -> list[str]:
    """The texts in a dataset."""
    return [value.decode() for value in dataset[()].tolist()]


def record_of_row(
    key: str, columns: Mapping[str, Mapping[str, Column]], number: int, told: tuple[str, ...], seconds: float
) -> UnitRecord:
    """The record that a row was made from."""
    stages: dict[str, StageRecord] = {}
    for stage, held in columns.items():
        values = {name: value for name, column in held.items() if (value := column.row(number)) is not None}
        if digest := str(values.pop(_DIGEST, "")):
            stages[stage] = StageRecord(digest, values)
    return UnitRecord(key, stages, told, seconds)
