"""The work on a unit, wherever it is done: make or read the bed, measure it, hand back what was found as bytes."""

from __future__ import annotations

import tempfile
import threading
import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bedrad import __version__
from bedrad.errors import BadFileError
from bedrad.jobs import stages
from bedrad.jobs.job import Job
from bedrad.jobs.members import Member, one_line, unit_job
from bedrad.jobs.pipeline import lammps_version
from bedrad.jobs.results import StageData, sha256_of
from bedrad.jobs.stage_types import Progress
from bedrad.jobs.unit_record import StageRecord, UnitRecord, gather, pack, unpack
from bedrad.packings.files import read, write
from bedrad.packings.flow import Flow
from bedrad.packings.flow_script import frame_name
from bedrad.packings.packing import Packing

__all__ = ["Found", "Task", "Work", "measure"]

_BUDGET = "budget"
"""What a prediction holds for every temperature and input; too much to keep of every unit."""

_ONE_AT_A_TIME = threading.Lock()
"""A process catches the warnings of one unit only; workers of a cluster may be threads."""


@dataclass(frozen=True)
class Work:
    """What all units of an ensemble share.

    Parameters
    ----------
    job : Job
        The job.
    threads : int or None
        Threads of a unit; None for all processors.
    version, lammps : str
        Versions that the keys of the units tell of.
    watch : callable or None
        Called with the share done and a text while a bed is made; None where nobody sees it, as from other processes.
    """

    job: Job
    threads: int | None
    version: str
    lammps: str
    watch: Progress | None = None

    @classmethod
    def of(cls, job: Job, threads: int | None, watch: Progress | None = None) -> Work:
        """With the versions here."""
        return cls(job, threads, __version__, lammps_version(), watch)


@dataclass(frozen=True)
class Task:
    """A unit to be done.

    Parameters
    ----------
    member : Member
        The bed.
    earlier : bytes or None
        Record of the stages that are finished.
    bed : bytes or None
        The settled bed, as a file of bedrad, where it is there.
    folder : Path or None
        Where a flow runs and keeps its frames.
    """

    member: Member
    earlier: bytes | None = None
    bed: bytes | None = None
    folder: Path | None = None


@dataclass(frozen=True)
class Found:
    """What became of a unit.

    Parameters
    ----------
    record : bytes or None
        Its record; None if it failed.
    bed : bytes or None
        The bed that was settled, as a file of bedrad.
    error : str
        What went wrong, in one line.
    """

    record: bytes | None = None
    bed: bytes | None = None
    error: str = ""


class _Unit:
    """A unit in memory, as its stages see it."""

    def __init__(self, threads: int | None, made: Packing | Flow, finished: Mapping[str, StageRecord]) -> None:
        self.threads = threads
        self.stages = dict(finished)
        self._made = made

    def bed(self) -> Packing:
        return self._made if isinstance(self._made, Packing) else self._made[0]

    def flow(self) -> Flow | None:
        return None if isinstance(self._made, Packing) else self._made

    def read(self, stage: str) -> StageData:
        return self.stages[stage].data()


def measure(work: Work, task: Task) -> Found:
    """Do what is left of a unit; whatever goes wrong with it, but for an interrupt, is in what is handed back."""
    settled: list[bytes] = []
    try:
        _check_versions(work, task.member)
        with _ONE_AT_A_TIME:
            record = _measured(work, task, settled)
        return Found(record, settled[0] if settled else None)
    except Exception as error:
        return Found(None, settled[0] if settled else None, one_line(error))


def _check_versions(work: Work, member: Member) -> None:
    """Refuse to give under a key what another version would not."""
    here = {"bedrad": (__version__, work.version)}
    if member.values is not None:
        here["lammps"] = (lammps_version(), work.lammps)
    for name, (own, wanted) in here.items():
        if own != wanted:
            raise ValueError(f"the worker has {name} {own}, the job was started with {wanted}; install the same")


def _measured(work: Work, task: Task, settled: list[bytes]) -> bytes:
    begin = time.perf_counter()
    member = task.member
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        job = unit_job(work.job, member)
        earlier = None if task.earlier is None else unpack(task.earlier)
        made = _bed(job, task, settled, work.watch or _silent)
        unit = _Unit(work.threads, made, {} if earlier is None else earlier.stages)
        # the bed was made with the seed of its own
        job = job.model_copy(update={"seed": member.seed})
        for name, digest in member.digests.items():
            if name not in unit.stages:
                fill = stages.RUNNERS[name](job, unit, _silent)
                unit.stages[name] = gather(digest, fill, leave_out=_BUDGET)
    texts = dict.fromkeys([*(earlier.warnings if earlier else ()), *(" ".join(str(w.message).split()) for w in told)])
    seconds = time.perf_counter() - begin
    return pack(UnitRecord(member.key, {n: unit.stages[n] for n in member.digests}, tuple(texts), seconds))


def _bed(job: Job, task: Task, settled: list[bytes], watch: Progress) -> Packing | Flow:
    member = task.member
    if task.folder is not None:
        flow = stages.make_flow(job, task.folder, watch)
        _keep_frames(flow, task.folder)
        return flow
    if member.path is not None:
        if sha256_of(member.path) != member.content:
            raise BadFileError(f"{member.path}: changed while the job ran; run it again")
        return stages.make_bed(job, _silent)
    with tempfile.TemporaryDirectory(prefix="bedrad-") as folder:
        file = Path(folder) / "bed.h5"
        if task.bed is not None:
            file.write_bytes(task.bed)
            return read(file)
        bed = stages.make_bed(job, watch)
        write(bed, file)
        settled.append(file.read_bytes())
        return bed


def _keep_frames(flow: Flow, folder: Path) -> None:
    """Write the frames as packings beside what LAMMPS left: its own hold the whole periodic box."""
    for number, (bed, step) in enumerate(zip(flow, flow.plan.frame_numbers, strict=True)):
        file = folder / f"frame_{number:04d}.h5"
        # LAMMPS may have run again, from a restart file even to other places
        if not file.exists() or file.stat().st_mtime < (folder / frame_name(step)).stat().st_mtime:
            write(bed, file)


def _silent(share: float, text: str) -> None:
    """Progress that nobody sees."""
