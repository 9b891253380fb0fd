"""Where an ensemble keeps what is finished: a journal while it runs, the one results file when it ends."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from bedrad.atomic import atomic_path
from bedrad.errors import BadFileError
from bedrad.jobs.ensemble_summary import Summary, summarise
from bedrad.jobs.fields import UNITS
from bedrad.jobs.journal import Journal
from bedrad.jobs.locking import remove_leftovers
from bedrad.jobs.members import Failure, Member
from bedrad.jobs.results import ENSEMBLE, Results
from bedrad.jobs.unit_columns import (
    Column,
    field_of,
    read_columns,
    record_of_row,
    stack,
    texts,
    write_columns,
    write_values,
)
from bedrad.jobs.unit_record import UnitRecord, key_of, pack, unpack

__all__ = ["EnsembleStore"]

UNITS_GROUP, FAILURES_GROUP = "units", "failures"

_REVISION = 1
"""Raised where what the results file holds of an ensemble changes."""


class EnsembleStore:
    """The finished units of an ensemble, in the journal and in the results file.

    Parameters
    ----------
    path : Path
        The results file.

    Raises
    ------
    BadFileError
        If it, or the journal, is something else, or it holds the results of one bed.
    """

    def __init__(self, path: Path) -> None:
        self.results = Results(path)
        self.beds = path.with_name(f"{path.stem}_beds")
        self._journal = Journal(path.with_name(f"{path.name}.journal"))
        self._held: dict[str, bytes] = {}
        self._rows: dict[str, int] = {}
        self._row_digests: dict[str, list[str]] = {}
        self._columns: tuple[dict[str, dict[str, Column]], list[str], list[float]] | None = None
        finished = self.results.digests()
        if finished and ENSEMBLE not in finished:
            raise BadFileError(f"{path}: holds the results of one bed; name another file for those of many")
        if finished:
            self._read_index()
        for entry in self._journal.entries():
            try:
                self._held[key_of(entry)] = entry
            except ValueError as error:
                raise BadFileError(f"{self._journal.path}: {error}; remove it") from None

    def _read_index(self) -> None:
        with self.results.open() as file:
            units = file[UNITS_GROUP]
            self._rows = {key: row for row, key in enumerate(texts(units["key"]))}
            self._row_digests = {
                name: texts(item["digest"]) for name, item in units.items() if isinstance(item, h5py.Group)
            }

    def keys(self) -> set[str]:
        """Keys of all units of which something is finished."""
        return self._held.keys() | self._rows.keys()

    def finished(self, key: str) -> Mapping[str, str] | None:
        """Digests of the finished stages of a unit; None if nothing is known of it."""
        if key in self._held:
            return {name: stage.digest for name, stage in unpack(self._held[key]).stages.items()}
        row = self._rows.get(key)
        return None if row is None else {name: held[row] for name, held in self._row_digests.items()}

    def record(self, key: str) -> UnitRecord:
        """What is finished of a unit."""
        if key in self._held:
            return unpack(self._held[key])
        if self._columns is None:
            with self.results.open() as file:
                units = file[UNITS_GROUP]
                self._columns = read_columns(units), texts(units["warnings"]), units["seconds"][()].tolist()
        columns, told, seconds = self._columns
        row = self._rows[key]
        return record_of_row(key, columns, row, tuple(told[row].splitlines()), seconds[row])

    def add(self, record: bytes) -> None:
        """Keep a finished unit; OSError if it cannot be."""
        self._journal.append(record)
        self._held[key_of(record)] = record

    def bed(self, key: str) -> Path:
        """Where the bed of a unit is kept, if it was settled."""
        return self.beds / f"bed_{key[:16]}.h5"

    def flow_folder(self, key: str) -> Path:
        """Where the flow of a unit runs and keeps its frames; a whole path."""
        return (self.beds / f"flow_{key[:16]}").absolute()

    def add_bed(self, key: str, content: bytes) -> None:
        """Keep a settled bed; OSError if it cannot be."""
        self.beds.mkdir(exist_ok=True)
        remove_leftovers(self.bed(key))
        with atomic_path(self.bed(key)) as temporary:
            temporary.write_bytes(content)

    def close(self) -> None:
        """Close the journal, which stays."""
        self._journal.close()

    def merge(self, members: Sequence[Member], left_out: Sequence[Failure], attributes: Mapping[str, str]) -> None:
        """Write the results file from all that is finished, and remove the journal.

        Parameters
        ----------
        members : sequence of Member
            The units that are finished, in the order of the job.
        left_out : sequence of Failure
            Those that are not, and why.
        attributes : mapping
            Attributes of the whole file.

        Raises
        ------
        OSError
            If the file cannot be written: it is as it was, and the journal stays.
        """
        digest = _digest(members, left_out)
        if self.results.digests().get(ENSEMBLE) != digest:
            wanted = {name for member in members for name in member.digests}
            columns, told, seconds = stack(self._packed(members), self._packed(members), len(members), wanted)
            own = _of_units(members, told, seconds)
            self.results.write_all(lambda file: _fill(file, digest, members, left_out, columns, own), attributes)
        else:
            self.results.update_attributes(attributes)
        self._journal.remove()

    def _packed(self, members: Sequence[Member]) -> Iterator[bytes]:
        """The records of units one after the other."""
        for member in members:
            yield self._held[member.key] if member.key in self._held else pack(self.record(member.key))


def _digest(members: Sequence[Member], left_out: Sequence[Failure]) -> str:
    """Digest of all that the results file of an ensemble says."""
    content = [
        _REVISION,
        [[m.label, m.key, dict(m.digests), dict(m.values or {}), m.series] for m in members],
        [[failure.label, failure.error] for failure in left_out],
    ]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _of_units(members: Sequence[Member], told: Sequence[tuple[str, ...]], seconds: Sequence[float]) -> dict[str, Any]:
    """What the file says of each unit beside what was found."""
    own: dict[str, Any] = {
        "label": [m.label for m in members],
        "key": [m.key for m in members],
        "path": ["" if m.path is None else str(m.path) for m in members],
        "content": [m.content for m in members],
        "series": [m.series for m in members],
        "frame": np.array([m.frame for m in members], dtype=np.int64),
        "seed": np.array([m.seed for m in members], dtype=np.int64),
        "warnings": ["\n".join(texts) for texts in told],
        "seconds": np.array(seconds, dtype=float),
    }
    for name in members[0].values or {} if members else {}:
        swept = [(m.values or {})[name] for m in members]
        own["bed_seed" if name == "seed" else name] = np.array(swept, dtype=np.int64 if name == "seed" else float)
    return own


def _fill(
    file: h5py.File,
    digest: str,
    members: Sequence[Member],
    left_out: Sequence[Failure],
    columns: Mapping[str, Mapping[str, Column]],
    own: Mapping[str, Any],
) -> None:
    units = file.create_group(UNITS_GROUP)
    for name, values in own.items():
        write_values(units, name, values, UNITS[name])
    write_columns(units, columns)
    failures = file.create_group(FAILURES_GROUP)
    write_values(failures, "label", [failure.label for failure in left_out], UNITS["label"])
    write_values(failures, "error", [failure.error for failure in left_out], UNITS["error"])
    ensemble = file.create_group(ENSEMBLE)
    ensemble.attrs["digest"] = digest
    _fill_summary(ensemble, summarise(members, columns), len(left_out))


def _fill_summary(group: h5py.Group, summary: Summary, failed: int) -> None:
    group.attrs["failed"] = failed
    for name, values in summary.groups.items():
        write_values(group, name, values, UNITS[name])
    write_values(group, "units", summary.units, ("1", "beds behind the means"))
    for stage, means in summary.means.items():
        inside = group.create_group(stage)
        for name, axis in summary.axes[stage].items():
            write_values(inside, name, axis, field_of(stage, name))
        for name, mean in means.items():
            units, long_name = field_of(stage, name)
            for ending, found, text in (
                ("", mean.mean, "mean over the beds: "),
                ("_packing_error", mean.packing_error, "standard error of the mean, from bed to bed: "),
                ("_ray_error", mean.ray_error, "of this, the part of the rays: "),
                ("_scatter", mean.scatter, "standard deviation from bed to bed: "),
                ("_unit_error", mean.unit_error, "standard error that one bed states, root mean square: "),
            ):
                if found is not None:
                    write_values(inside, f"{name}{ending}", found, (units, text + long_name))
