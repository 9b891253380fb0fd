"""The results file: HDF5, a group a stage, written whole or not at all."""

from __future__ import annotations

import errno
import hashlib
import io
import json
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from bedrad import __version__
from bedrad.atomic import atomic_path
from bedrad.errors import BadFileError
from bedrad.jobs.fields import Field
from bedrad.packings.files import read
from bedrad.packings.files.hdf5_access import holds
from bedrad.packings.files.hdf5_reader import ask, check_survives, note_written
from bedrad.packings.files.hdf5_survey import DEEPEST, MOST_A_BYTE
from bedrad.packings.files.text import is_ordinary
from bedrad.packings.packing import Packing

__all__ = [
    "ENSEMBLE",
    "SCHEMA_VERSION",
    "Results",
    "StageData",
    "check_record_file",
    "check_writable",
    "save_fields",
    "save_record",
    "sha256_of",
]

SCHEMA_VERSION = 1

ENSEMBLE = "ensemble"
"""Name of the group that only the results of many beds have."""

StageData = dict[str, Any]
"""A stage as it stands in the file: names to arrays, floats, texts, or to such mappings again."""


def save_fields(group: h5py.Group, values: Mapping[str, Any] | object, fields: Mapping[str, Field]) -> None:
    """Write the named fields of a record, each with its units and long name, and its ``<name>_error`` if there is one.

    Parameters
    ----------
    group : h5py.Group
        Receives a dataset a field.
    values : mapping or object
        What holds the fields, as items or attributes.
    fields : mapping
        Names to units and long names.
    """

    def value_of(name: str) -> Any:
        return values.get(name) if isinstance(values, Mapping) else getattr(values, name, None)

    for name, (units, long_name) in fields.items():
        for key, text in ((name, long_name), (f"{name}_error", f"standard error: {long_name}")):
            value = value_of(key)
            if value is None or key in group:
                continue
            dataset = group.create_dataset(key, data=value)
            dataset.attrs["units"] = units
            dataset.attrs["long_name"] = text


def check_writable(path: Path) -> None:
    """Make the folder of a file and try to write there, so that a wrong path shows before the computing, not after.

    Raises
    ------
    OSError
        If no file can be written there; the message names the file.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        # making a folder where a file lies is told as "File exists"
        number = errno.ENOTDIR if isinstance(error, FileExistsError) else error.errno or errno.EIO
        raise OSError(number, f"cannot write: {os.strerror(number)}", str(path)) from None


def check_record_file(path: Path, stage: str) -> None:
    """Check that `save_record` can write a file and destroys nothing but an older record of the same stage.

    Raises
    ------
    BadFileError
        If the file is there and holds something else.
    OSError
        If no file can be written there.
    """
    check_writable(path)
    if not path.exists():
        return
    try:
        held = ask("record_stages", path, SCHEMA_VERSION)
    except BadFileError:
        held = []
    if held != [stage]:
        raise BadFileError(
            f"{path}: holds something else than one {stage!r} record and is not overwritten; "
            "name another file, or remove this one"
        )


def save_record(path: Path, stage: str, fill: Callable[[h5py.Group], None], *sources: Path) -> None:
    """Write one record to an HDF5 file of its own, in a group of the stage's name.

    Parameters
    ----------
    path : Path
        The file.
    stage : str
        Name of the group.
    fill : callable
        Writes the record into the group it is given.
    *sources : Path
        The packing's file, or those of a trajectory; their names and SHA-256 are kept with the record.

    Raises
    ------
    BadFileError
        If the file is there and holds something else.
    OSError
        If the file cannot be written; an older one is then as it was.
    """
    check_record_file(path, stage)
    with _written(path) as new:
        fill(new.create_group(stage))
        _stamp(new, {"inputs": json.dumps({str(source): sha256_of(source) for source in sources})})


@contextmanager
def _written(path: Path, held: bytes = b"") -> Iterator[h5py.File]:
    """An HDF5 file to fill, empty or with what one holds; it takes the place of the old one when the block ends.

    It is made in memory, as HDF5 crashes where a disk is full.
    """
    buffer = io.BytesIO(held)
    with h5py.File(buffer, "r+" if held else "w") as file:
        yield file
    with atomic_path(path) as temporary:
        temporary.write_bytes(buffer.getbuffer())
        note_written(temporary)


def sha256_of(path: Path) -> str:
    """SHA-256 of a file.

    Raises
    ------
    BadFileError
        If it cannot be read.
    """
    try:
        if not is_ordinary(path):
            raise BadFileError(f"{path}: is a pipe or a device; expected a file")
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise BadFileError(f"{path}: cannot be read: {error.strerror or error}") from None


def _stamp(file: h5py.File, attributes: Mapping[str, str]) -> None:
    """Give a file its attributes: those of every file, and its own."""
    file.attrs["schema_version"] = SCHEMA_VERSION
    file.attrs["bedrad_version"] = __version__
    file.attrs["created"] = datetime.now(UTC).isoformat(timespec="seconds")
    file.attrs.update(attributes)


@dataclass(frozen=True)
class Results:
    """A results file on disk.

    Parameters
    ----------
    path : Path
        The file.
    """

    path: Path

    @property
    def threads(self) -> None:
        """Threads of the stages that can have several: all processors."""
        return

    def bed(self) -> Packing:
        """The bed that the stages are about.

        Raises
        ------
        BadFileError
            If there is none in the file.
        """
        return read(self.path)

    def flow(self) -> None:
        """The flow that the bed is of: none, as flows are kept with those of many beds."""
        return

    def digests(self) -> dict[str, str]:
        """Digest of what went into each finished stage; empty where there is no file yet.

        Raises
        ------
        BadFileError
            If the file is not a bedrad results file, so that writing over it would destroy something else.
        """
        if not self.path.exists():
            return {}
        with self.open() as file:
            # a link is no stage, wherever it leads
            own = {name: file[name] for name in file if isinstance(file.get(name, getlink=True), h5py.HardLink)}
            return {name: str(group.attrs["digest"]) for name, group in own.items() if "digest" in group.attrs}

    def read(self, stage: str) -> StageData:
        """Everything a finished stage holds.

        Raises
        ------
        BadFileError
            If there is no such stage in the file.
        """
        with self.open() as file:
            if not holds(file, stage):
                raise BadFileError(f"{self.path}: no stage {stage!r}; it holds {', '.join(file) or 'none'}")
            return _read_group(file, stage, self.path)

    def attributes(self) -> dict[str, Any]:
        """Attributes of the whole file: version, time, job, inputs."""
        with self.open() as file:
            return dict(file.attrs)

    def write_stage(
        self,
        stage: str,
        digest: str,
        fill: Callable[[h5py.Group], None],
        *,
        keep: Iterable[str],
        attributes: Mapping[str, str],
    ) -> None:
        """Add a finished stage: a new file with the stages to keep and this one takes the place of the old.

        Parameters
        ----------
        stage, digest : str
            Name of the stage and digest of all that went into it.
        fill : callable
            Writes the stage into the group it is given.
        keep : iterable of str
            Stages of the old file that are still right.
        attributes : mapping
            Attributes of the whole file.

        Raises
        ------
        OSError
            If the file cannot be written; the old one is then as it was.
        """

        def fill_file(new: h5py.File) -> None:
            if self.path.exists():
                with self.open() as old:
                    for name in keep:
                        if name in old and name != stage:
                            old.copy(name, new)
            group = new.create_group(stage)
            group.attrs["digest"] = digest
            fill(group)

        self.write_all(fill_file, attributes)

    def write_all(self, fill: Callable[[h5py.File], None], attributes: Mapping[str, str]) -> None:
        """Write the file anew.

        Parameters
        ----------
        fill : callable
            Writes all groups into the file it is given.
        attributes : mapping
            Attributes of the whole file.

        Raises
        ------
        OSError
            If the file cannot be written; the old one is then as it was.
        """
        with _written(self.path) as new:
            fill(new)
            _stamp(new, attributes)

    def update_attributes(self, attributes: Mapping[str, str]) -> None:
        """Replace attributes of the whole file where they differ; the stages stay.

        Raises
        ------
        OSError
            If the file cannot be written; the old one is then as it was.
        """
        held = self.attributes()
        if all(held.get(name) == value for name, value in attributes.items()):
            return
        with _written(self.path, self.path.read_bytes()) as file:
            file.attrs.update(attributes)

    @contextmanager
    def open(self) -> Iterator[h5py.File]:
        """Open the file to read from it; BadFileError if it is something else, or damaged where it is read.

        One that this process did not write is first read in a process that may die, as long as it stays as it is.
        """
        problem = check_survives(self.path)
        if problem is not None:
            raise BadFileError(
                f"{self.path}: not a bedrad results file, or a damaged one ({problem}); "
                "name another results file, or remove this one"
            )
        try:
            with h5py.File(self.path, "r") as file:
                version = file.attrs.get("schema_version")
                # anything may stand there, such as an array, which is neither equal nor unequal
                if not (isinstance(version, np.integer) and version == SCHEMA_VERSION and "job" in file.attrs):
                    raise BadFileError(
                        f"{self.path}: not a bedrad results file of schema version {SCHEMA_VERSION} "
                        f"(it has {version!r:.40}); name another results file, or remove this one"
                    )
                yield file
        # h5py tells of damage by any of these
        except (OSError, RuntimeError, KeyError, UnicodeDecodeError) as error:
            number = getattr(error, "errno", None)
            reason = str(error) if number is None else os.strerror(number)
            raise BadFileError(
                f"{self.path}: not a bedrad results file, or a damaged one ({reason}); "
                "name another results file, or remove this one"
            ) from None


def _read_group(parent: h5py.Group, name: str, path: Path, depth: int = 0) -> StageData:
    """Read a group of a file that anybody may have made: no links, no claims beyond the file's size."""
    where = f"{path}: {parent.name.rstrip('/')}/{name}"
    if depth > DEEPEST:
        raise BadFileError(f"{where}: groups lie deeper than {DEEPEST} in each other")
    group = _own(parent, name, where)
    if not isinstance(group, h5py.Group):
        raise BadFileError(f"{where}: is no group; expected what `bedrad run` writes")
    data: StageData = {}
    try:
        for key, value in group.attrs.items():
            data[key] = value.item() if isinstance(value, np.generic) else value
        for key in group:
            item = _own(group, key, f"{where}/{key}")
            if isinstance(item, h5py.Group):
                data[key] = _read_group(group, key, path, depth + 1)
                continue
            if not isinstance(item, h5py.Dataset) or item.shape is None:
                raise BadFileError(f"{where}/{key}: is neither a group nor a dataset with values")
            if item.nbytes > MOST_A_BYTE * path.stat().st_size:
                raise BadFileError(f"{where}/{key}: states {item.nbytes} bytes, far more than the file holds")
            data[key] = _plain(item[()])
    except (TypeError, AttributeError, UnicodeDecodeError) as problem:
        raise BadFileError(f"{where}: cannot be read: {problem}") from None
    return data


def _own(group: h5py.Group, name: str, where: str) -> Any:
    """An object that the file holds itself, not one that a link leads to."""
    if not isinstance(group.get(name, getlink=True), h5py.HardLink):
        raise BadFileError(f"{where}: is a link to elsewhere; expected what `bedrad run` writes")
    return group[name]


def _plain(value: Any) -> Any:
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray) and value.dtype == object:
        return np.array([v.decode() if isinstance(v, bytes) else v for v in value])
    return value
