"""The beds that a job names: what each is, its key, its seed, and the job that measures it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bedrad.errors import BadFileError
from bedrad.jobs.file_section import FileSection, chosen_frames
from bedrad.jobs.job import Job
from bedrad.jobs.pipeline import stage_digests, stage_parameters
from bedrad.jobs.results import sha256_of
from bedrad.packings.files import count_frames, files_of

__all__ = [
    "Failure",
    "FileIdentity",
    "Member",
    "beds_of",
    "file_members",
    "identify",
    "job_files",
    "made_members",
    "one_line",
    "unit_job",
]

_MEASURED = ("flow", "statistics", "view_factors", "prediction")


@dataclass(frozen=True)
class Member:
    """A bed of an ensemble, a unit of work.

    Parameters
    ----------
    label : str
        The file and frame, or the values of the sweep.
    key : str
        Digest of the bed: of the file's content and how it is read, or of what it is settled from.
    digests : mapping
        Digests of the stages to measure, by name.
    seed : int
        Seed of its rays.
    path : Path or None
        Its file.
    frame : int
        Its frame in the file.
    content : str
        SHA-256 of the file.
    values : mapping
        Values of what is swept, by name, of a bed that is made. [m], [m/s], and seeds
    series : str
        What it has in common with others: "" where nothing.
    """

    label: str
    key: str
    digests: Mapping[str, str]
    seed: int
    path: Path | None = None
    frame: int = -1
    content: str = ""
    values: Mapping[str, float] | None = None
    series: str = ""

    @property
    def is_flow(self) -> bool:
        """Whether it is a flow, all frames of which are measured together."""
        return "flow" in self.digests


@dataclass(frozen=True)
class Failure:
    """A unit that could not be done.

    Parameters
    ----------
    label : str
        As of the member.
    error : str
        What went wrong, in one line.
    """

    label: str
    error: str


@dataclass(frozen=True)
class FileIdentity:
    """What tells a file from others: the SHA-256 of its content, and its number of frames where they are asked for."""

    content: str
    frames: int | None


def job_files(section: FileSection) -> list[Path]:
    """The files that a job names, each once; BadFileError where a pattern or folder has none."""
    given = section.path if isinstance(section.path, tuple) else (section.path,)
    found = [file for path in given for file in files_of(path)]
    return list(dict.fromkeys(found))


def identify(section: FileSection, paths: Iterable[Path]) -> list[FileIdentity | str]:
    """Read files for what tells them apart; a text in place of what cannot be read says why."""
    found: list[FileIdentity | str] = []
    for path in paths:
        try:
            columns = section.options()["columns"]
            counted = None if section.frames is None else count_frames(path, columns)
            found.append(FileIdentity(sha256_of(path), counted))
        except (ValueError, OSError, MemoryError) as error:
            found.append(one_line(error))
    return found


def beds_of(count: int) -> str:
    """So many beds, in words."""
    return f"{count:,} bed" if count == 1 else f"{count:,} beds"


def one_line(error: BaseException) -> str:
    """An error as a line of text."""
    text = " ".join(str(error).split())
    known = isinstance(error, (ValueError, OSError, ImportError, RuntimeError)) and text
    return (text if known else f"{type(error).__name__}: {text}")[:2000]


def file_members(job: Job, identified: Iterable[tuple[Path, FileIdentity | str]]) -> Iterator[Member | Failure]:
    """Yield the beds in files, or why there is none."""
    section = _file_section(job)
    together = section.independent is False
    walls = {} if section.wall_file is None else {str(section.wall_file): sha256_of(section.wall_file)}
    keys: _Keys | None = None
    for path, identity in identified:
        if isinstance(identity, str):
            yield Failure(str(path), identity)
            continue
        if keys is None:
            keys = _Keys(_file_job(job, path, -1), {str(path): "", **walls})
        try:
            frames = (section.frame,) if section.frames is None else chosen_frames(section.frames, identity.frames or 0)
        except ValueError as error:
            yield Failure(str(path), f"{path}: {error}")
            continue
        alone = section.frames is None or section.independent is True
        series = "all" if together else "" if alone else str(path)
        for frame in frames:
            label = str(path) if section.frames is None else f"{path} frame {frame}"
            key, digests, seed = keys.of(job, path=identity.content, frame=frame)
            yield Member(label, key, digests, seed, path, frame, identity.content, None, series)


def made_members(job: Job) -> Iterator[Member]:
    """Yield the beds that a job makes: those of its sweep, or the flow of a job without one."""
    for values in [{}] if job.sweep is None else job.sweep.combinations():
        one = job.swept(values)
        key, digests, seed = _Keys(_without_more(one), {}).of(job)
        label = ", ".join(
            f"{name} {value:.6g}" if name != "seed" else f"seed {value}" for name, value in values.items()
        )
        yield Member(label or "the flow", key, digests, seed, values=values)


class _Keys:
    """Keys and seeds of beds that differ in their file, its frame, and their seed only."""

    def __init__(self, job: Job, inputs: Mapping[str, str]) -> None:
        self._parameters = stage_parameters(job, inputs)

    def of(self, job: Job, **file: Any) -> tuple[str, dict[str, str], int]:
        """Key, digests of the stages to measure, and seed of the rays of a bed; `file` says which it is.

        The seed comes from the seed of the job and the key, so that it depends neither on the order of the beds nor
        on where and when they are measured, and that no two beds share their rays.
        """
        parameters = self._parameters
        if file:
            parameters["packing"]["source"]["file"].update(file)
        key = stage_digests({"packing": parameters["packing"]})["packing"]
        derived = hashlib.sha256(f"bedrad unit {job.seed} {key}".encode()).digest()
        seed = int.from_bytes(derived[:8], "big") >> 1
        if "view_factors" in parameters:
            parameters["view_factors"]["seed"] = seed
        digests = stage_digests(parameters)
        return key, {name: digests[name] for name in _MEASURED if name in digests}, seed


def unit_job(job: Job, member: Member) -> Job:
    """The job of one bed, with the seed that its bed is settled with."""
    if member.values is not None:
        return _without_more(job.swept(member.values))
    assert member.path is not None  # noqa: S101 - a bed is from a file or of a sweep
    return _file_job(job, member.path, member.frame)


def _file_job(job: Job, path: Path, frame: int) -> Job:
    section = _file_section(job).model_copy(update={"path": path, "frame": frame, "frames": None, "independent": None})
    assert job.packing is not None  # noqa: S101 - it has the section
    return _without_more(job.model_copy(update={"packing": job.packing.model_copy(update={"file": section})}))


def _without_more(job: Job) -> Job:
    """A job without what says nothing about its bed: errors against run time, published systems."""
    prediction = job.prediction and job.prediction.model_copy(update={"published_systems": False})
    return job.model_copy(update={"convergence": None, "prediction": prediction})


def _file_section(job: Job) -> FileSection:
    if job.packing is None or job.packing.file is None:
        raise BadFileError("the job reads no files")
    return job.packing.file
