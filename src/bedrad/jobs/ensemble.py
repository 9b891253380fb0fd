"""Ensembles: a job on many beds, each a unit of work that is done once, whatever becomes of the others."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from bedrad.errors import BadFileError
from bedrad.jobs.crew import Alone, Crew, Lost
from bedrad.jobs.ensemble_store import EnsembleStore
from bedrad.jobs.file_section import FileSection
from bedrad.jobs.job import Job
from bedrad.jobs.locking import results_lock
from bedrad.jobs.members import Failure, FileIdentity, Member, beds_of, file_members, identify, job_files, made_members
from bedrad.jobs.results import Results, check_writable, sha256_of
from bedrad.jobs.unit_record import UnitRecord, pack
from bedrad.jobs.unit_work import Found, Task, Work, measure

__all__ = ["EnsemblePlan", "Outcome", "plan_ensemble", "run_ensemble"]

Progress = Callable[[str, float, str], None]

_FILES_AT_ONCE = 32
"""Files that a worker identifies at a time."""


@dataclass(frozen=True)
class EnsemblePlan:
    """What a job on many beds will do.

    Parameters
    ----------
    members : tuple of Member
        The beds, each once.
    done : frozenset of str
        Keys of those that are finished.
    unread : tuple of Failure
        Files that cannot be read, and why.
    repeated : tuple of Failure
        Beds that are the same as one before them; they are left out.
    """

    members: tuple[Member, ...]
    done: frozenset[str]
    unread: tuple[Failure, ...]
    repeated: tuple[Failure, ...]


@dataclass(frozen=True)
class Outcome:
    """What a job on many beds has done.

    Parameters
    ----------
    results : Results
        The results file.
    kept, done : int
        Units from earlier runs, and of this one.
    failed : tuple of Failure
        Units that failed, and why; they are tried again by the next run.
    repeated : tuple of Failure
        Beds that were left out, as each is the same as one before it.
    """

    results: Results
    kept: int
    done: int
    failed: tuple[Failure, ...]
    repeated: tuple[Failure, ...]


def plan_ensemble(job: Job, path: Path, crew: Crew | None = None) -> EnsemblePlan:
    """Find the beds of a job, and which of them are finished.

    Parameters
    ----------
    job : Job
        A job that names many beds.
    path : Path
        Its results file, which need not exist.
    crew : Crew, optional
        Who reads the files for what tells them apart; this process if not given.

    Raises
    ------
    BadFileError
        If there are no beds, or the results file is something else or one of the beds.
    """
    store = EnsembleStore(path)
    try:
        return _plan(_anywhere(job), store, crew or Alone())
    finally:
        store.close()


def run_ensemble(job: Job, path: Path, crew: Crew | None = None, progress: Progress | None = None) -> Outcome:
    """Measure the beds of a job that are not measured yet.

    Every finished unit is kept at once, so that a run that is killed loses none. One that fails is told in the
    outcome and in the results; the others go on.

    Parameters
    ----------
    job : Job
        A job that names many beds.
    path : Path
        The results file.
    crew : Crew, optional
        Who does the work; this process if not given. What is found does not depend on it.
    progress : callable, optional
        Called with a name, the share done and a text.

    Raises
    ------
    BadFileError
        If there are no beds, or `path` holds something else or is one of them.
    OSError
        If the results cannot be written, or another process is writing them.
    """
    check_writable(path)
    with results_lock(path):
        return _run(_anywhere(job), EnsembleStore(path), crew or Alone(), progress or (lambda *_: None))


def _anywhere(job: Job) -> Job:
    """The job with whole paths: workers may run in other folders."""
    if job.packing is None or job.packing.file is None:
        return job
    file = job.packing.file.in_folder(Path.cwd())
    return job.model_copy(update={"packing": job.packing.model_copy(update={"file": file})})


def _run(job: Job, store: EnsembleStore, crew: Crew, progress: Progress) -> Outcome:
    failed: dict[str, Failure] = {}
    done: set[str] = set()
    try:
        progress("beds", 0.0, "finding the beds")
        plan = _plan(job, store, crew)
        progress("beds", 1.0, f"{beds_of(len(plan.members))}, {len(plan.done):,} measured before")
        waiting = [member for member in plan.members if member.key not in plan.done]
        attributes = {"job": job.resolved(), "inputs": json.dumps(_inputs(job), sort_keys=True)}

        def told_failures() -> list[Failure]:
            return [*plan.unread, *(failed[m.key] for m in waiting if m.key in failed)]

        def merge() -> None:
            finished = [m for m in plan.members if m.key in plan.done or m.key in done]
            store.merge(finished, told_failures(), attributes)

        try:
            tasks = (_task(member, store) for member in waiting)
            # how far a bed is can be seen only where it is made here
            watch = (lambda share, text: progress("bed", share, text)) if isinstance(crew, Alone) else None
            for number, answer in crew.run(measure, Work.of(job, crew.threads, watch), tasks):
                member = waiting[number]
                _keep(store, member, answer, done, failed)
                told = f"{len(done):,} measured" + (f", {len(failed):,} failed" if failed else "")
                progress("units", (len(done) + len(failed)) / len(waiting), told)
        except KeyboardInterrupt:
            # what is there is put where it can be looked at; the rest is for the next run
            merge()
            raise
        progress("merge", 0.0, "writing the results file")
        merge()
        progress("merge", 1.0, "done")
    finally:
        store.close()
    return Outcome(store.results, len(plan.done), len(done), tuple(told_failures()), plan.repeated)


def _keep(
    store: EnsembleStore, member: Member, answer: Found | Lost, done: set[str], failed: dict[str, Failure]
) -> None:
    """Keep what a worker found, or why it found nothing."""
    if isinstance(answer, Found) and answer.bed is not None:
        store.add_bed(member.key, answer.bed)
    if isinstance(answer, Found) and answer.record is not None:
        store.add(answer.record)
        done.add(member.key)
    else:
        failed[member.key] = Failure(member.label, answer.error)


def _task(member: Member, store: EnsembleStore) -> Task:
    """What a worker needs to know of a unit: what is finished of it goes along."""
    finished = store.finished(member.key) or {}
    right = [name for name, digest in member.digests.items() if finished.get(name) == digest]
    earlier = None
    if right:
        record = store.record(member.key)
        earlier = pack(UnitRecord(record.key, {name: record.stages[name] for name in right}, record.warnings))
    if member.is_flow:
        return Task(member, earlier, folder=store.flow_folder(member.key))
    bed = store.bed(member.key)
    return Task(member, earlier, bed.read_bytes() if member.values is not None and bed.exists() else None)


def _plan(job: Job, store: EnsembleStore, crew: Crew) -> EnsemblePlan:
    found: Iterable[Member | Failure]
    assert job.packing is not None  # noqa: S101 - a job of many beds says where they come from
    if job.packing.file is None:
        found = made_members(job)
    else:
        found = file_members(job, _identified(job.packing.file, store.results.path, crew))
    members: dict[str, Member] = {}
    unread: list[Failure] = []
    repeated: list[Failure] = []
    for each in found:
        if isinstance(each, Failure):
            unread.append(each)
        elif each.key in members:
            repeated.append(Failure(each.label, f"the same bed as {members[each.key].label}"))
        else:
            members[each.key] = each
    done = frozenset(key for key, member in members.items() if _is_done(member, store))
    return EnsemblePlan(tuple(members.values()), done, tuple(unread), tuple(repeated))


def _is_done(member: Member, store: EnsembleStore) -> bool:
    finished = store.finished(member.key)
    # the frames of a flow are many; what was measured stays when they are gone
    if member.values is not None and not member.is_flow and not store.bed(member.key).exists():
        return False
    return finished is not None and all(finished.get(name) == digest for name, digest in member.digests.items())


def _identified(section: FileSection, results: Path, crew: Crew) -> Iterator[tuple[Path, FileIdentity | str]]:
    """The files of a job, in order, and what tells each from others: read where the workers are."""
    files = job_files(section)
    if results.resolve() in {file.resolve() for file in files}:
        raise BadFileError(f"{results}: is one of the beds of this job; name another results file")
    parts = [tuple(files[k : k + _FILES_AT_ONCE]) for k in range(0, len(files), _FILES_AT_ONCE)]
    answers: dict[int, Sequence[FileIdentity | str]] = {}
    for number, answer in crew.run(identify, section, parts):
        answers[number] = [answer.error] * len(parts[number]) if isinstance(answer, Lost) else answer
    return zip(files, itertools.chain.from_iterable(answers[k] for k in range(len(parts))), strict=True)


def _inputs(job: Job) -> dict[str, str]:
    """SHA-256 of the files that all beds share; those of the beds stand with the units."""
    wall = None if job.packing is None or job.packing.file is None else job.packing.file.wall_file
    return {} if wall is None else {str(wall): sha256_of(wall)}
