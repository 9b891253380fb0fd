"""Hostile files for every reader: no crash, no hang, no bomb, no code run, no way out of the folder.

    python benchmarks/fuzz.py [--cases N] [--target NAME] [--seed N] [--workers N] [--state PATH] [--findings PATH]
    python benchmarks/fuzz.py --again "NAME:NUMBER" [--seed N]

Every case is made from the seed, its target and its number alone, so that it can be made again (--again does, and shows
what happens); a run goes on where the one before ended. Files are made from the tests' files and from bedrad's own by
changes of bytes, numbers, words, lines and structure. A case is right if it gives what the file holds or one line of
`BadFileError`, `ValueError` or `OSError`. Everything else is a finding: another error, a warning, more than 5 s of the
processor, more than 1 GB of memory, the end of the process, a file opened or made outside the folder, code run. Its
files are kept in the folder of findings, at most five for each place in the code.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import re
import shutil
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.sharedctypes import SynchronizedArray
from pathlib import Path
from random import Random
from typing import Any

import fuzz_guard
import numpy as np
from fuzz_guard import Guard, TooLongError
from fuzz_targets import CANARY, CANARY_RADIUS, Target, UnwantedError, make, targets

import bedrad

ROOT = Path(__file__).resolve().parents[1]
BATCH = 5000
"""Cases of one process; a new one has no memory of what came before."""

LONGEST_WAIT = 90.0
"""What a case may take by the clock before its process is ended: the machine has other work too. [s]"""

ROUNDS = 10
"""How often all targets have their turn."""

KEPT = 5
"""Findings of one kind whose files are kept."""


@dataclass
class Record:
    """What is known of a target.

    Parameters
    ----------
    done : int
        Cases that were run; the number of the next.
    outcomes : mapping of str to int
        How often each end was met.
    seconds : float
        Time for all. [s]
    """

    done: int = 0
    outcomes: dict[str, int] = field(default_factory=dict)
    seconds: float = 0.0


def run_case(target: Target, seed: int, number: int, folder: Path, guard: Guard) -> tuple[str, str]:
    """Run one case in an empty folder; what it was, and for a finding where and what."""
    rng = Random(f"{seed}:{target.name}:{number}")
    inside = folder / "inside"
    inside.mkdir()
    path = make(target, rng, inside, folder / "outside")
    outcome, told = "read", ""
    try:
        with guard.watching():
            target.call(path, rng)
    except TooLongError:
        return f"more than {fuzz_guard.LONGEST:g} s", _place()
    except (ValueError, OSError) as error:
        outcome, told = type(error).__name__, str(error)
        problems = told.split("\n") if target.name == "job file" else [told]
        if not told or any(not line.isprintable() for line in problems):
            return f"{outcome}: no line that can be shown", f"{told[:300]!r} at {_place()}"
        if any(len(line) > 2000 for line in problems):
            return f"{outcome}: a line too long to be read", f"{len(told)} characters at {_place()}"
    except Exception as error:
        return f"{type(error).__name__}", f"{error!s:.200} at {_place()}"
    if _DIED.search(told):
        return _SURVIVED, told
    if guard.seen:
        return "opened or ran what it should not", guard.seen[0]
    if (folder / "outside" / "ran").exists():
        return "code was run", ""
    if (held := guard.memory()) > fuzz_guard.LARGEST_MEMORY:
        return "memory", f"{held >> 20} MiB"
    return outcome if outcome in ("read", "BadFileError") else "other ValueError or OSError", ""


def _place() -> str:
    """Where in the code the error came from: the last line of bedrad, and the last of all."""
    frames = traceback.extract_tb(sys.exc_info()[2])
    own = [frame for frame in frames if "/bedrad/" in frame.filename]
    told = [f"{Path(frame.filename).name}:{frame.lineno} {frame.name}" for frame in (frames[-1], *own[:-3:-1])]
    return " <- ".join(dict.fromkeys(told))


def outside(folder: Path) -> None:
    """Put a bed that no reader should reach outside the folder of the case."""
    place = folder / "outside"
    place.mkdir(exist_ok=True)
    centers = np.c_[np.zeros((CANARY, 2)), np.arange(CANARY)]
    bed = bedrad.Packing(centers, CANARY_RADIUS, bedrad.Tube(5.0))
    for suffix in (".vtp", ".h5", ".csv"):
        bedrad.write(bed, place / f"canary{suffix}")


def work(target: Target, seed: int, numbers: range, folder: Path, shared: SynchronizedArray[Any], pipe: Any) -> None:
    """Run cases one after the other and send what each was."""
    sys.stderr = (folder / "stderr").open("w")
    outside(folder)
    inside = folder / "inside"
    guard = Guard(inside)
    warnings.simplefilter("error")
    counts: Counter[str] = Counter()
    for number in numbers:
        shared[0], shared[1] = number, time.monotonic()
        shutil.rmtree(inside, ignore_errors=True)
        what, told = run_case(target, seed, number, folder, guard)
        counts[what] += 1
        if told or what.startswith(("more", "code")):
            pipe.send((number, what, told))
            if what == "memory":
                break
    pipe.send((shared[0] + 1, None, dict(counts)))


class Campaign:
    """Runs targets in processes of their own, and keeps what they find."""

    def __init__(self, seed: int, state: Path, findings: Path) -> None:
        self.seed, self._state, self._findings = seed, state, findings
        held = json.loads(state.read_text()) if state.exists() else {}
        self.records = {name: Record(**record) for name, record in held.get(str(seed), {}).items()}
        self._all = held
        self._kept: Counter[str] = Counter()
        self._context = multiprocessing.get_context("fork")

    def run_target(self, target: Target, cases: int) -> None:
        """Run the next cases of a target."""
        record = self.records.setdefault(target.name, Record())
        end, began = record.done + cases, time.monotonic()
        while record.done < end:
            with tempfile.TemporaryDirectory(dir=_memory_disk(), prefix="bedrad-fuzz-") as folder:
                self._batch(target, record, range(record.done, min(record.done + BATCH, end)), Path(folder))
            self._save()
        record.seconds += time.monotonic() - began
        self._save()

    def _batch(self, target: Target, record: Record, numbers: range, folder: Path) -> None:
        """Run some cases in a process of their own, as many as it survives."""
        shared: SynchronizedArray[Any] = self._context.Array("d", [float(numbers.start), time.monotonic()])
        ours, theirs = self._context.Pipe(duplex=False)
        process = self._context.Process(target=work, args=(target, self.seed, numbers, folder, shared, theirs))
        process.start()
        theirs.close()
        counted = False
        while True:
            if ours.poll(1.0):
                try:
                    number, what, told = ours.recv()
                except EOFError:
                    break
                if what is None:
                    counted, record.done = True, int(number)
                    for name, count in told.items():
                        record.outcomes[name] = record.outcomes.get(name, 0) + count
                else:
                    self._keep(target, number, what, told, folder)
            elif time.monotonic() - shared[1] > LONGEST_WAIT:
                process.kill()
                break
        process.join()
        if not counted:
            self._died(target, record, numbers, int(shared[0]), process.exitcode, folder)

    def _died(
        self, target: Target, record: Record, numbers: range, number: int, code: int | None, folder: Path
    ) -> None:
        """Tell of a process that ended in the middle of a case; what it counted is lost with it."""
        what = f"the process ended ({code})"
        told = (folder / "stderr").read_text(errors="replace")[-1500:] if (folder / "stderr").exists() else ""
        self._keep(target, number, what, told, folder)
        record.outcomes[what] = record.outcomes.get(what, 0) + 1
        name = "before the process ended"
        record.outcomes[name] = record.outcomes.get(name, 0) + number - numbers.start
        record.done = number + 1

    def _keep(self, target: Target, number: int, what: str, told: str, folder: Path) -> None:
        """Keep the files of a finding, which are made again, and say what it was."""
        kind = f"{target.name} {what} {told.rpartition(' at ')[2][:200]}"
        self._kept[kind] += 1
        if self._kept[kind] > KEPT:
            return
        print(f"{target.name}:{number}: {what}: {told}", flush=True)
        place = self._findings / f"{target.name.replace(' ', '_')}_{self.seed}_{number}"
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        rng = Random(f"{self.seed}:{target.name}:{number}")
        make(target, rng, place, folder / "outside")
        (place / "finding.txt").write_text(f"{target.name}:{number}, seed {self.seed}\n{what}\n{told}\n")

    def _save(self) -> None:
        self._state.parent.mkdir(parents=True, exist_ok=True)
        self._all[str(self.seed)] = {name: vars(record) for name, record in self.records.items()}
        self._state.write_text(json.dumps(self._all, indent=1, ensure_ascii=False))

    def table(self) -> str:
        """Cases and ends of every target, as a table."""
        lines = ["| target | cases | read | refused | findings | ms a case |", "|---|---:|---:|---:|---:|---:|"]
        for name, record in sorted(self.records.items()):
            fine = {k: record.outcomes.get(k, 0) for k in _FINE}
            refused = fine["BadFileError"] + fine["other ValueError or OSError"] + fine[_SURVIVED]
            found = sum(record.outcomes.values()) - sum(fine.values())
            each = 1e3 * record.seconds / max(record.done, 1)
            lines.append(f"| {name} | {record.done:,} | {fine['read']:,} | {refused:,} | {found:,} | {each:.2f} |")
        return "\n".join(lines)


_SURVIVED = "the HDF5 library died of it"
"""A file that was refused because the process that reads these files died: told, but right."""

_DIED = re.compile(r"HDF5 library ended with|reading took far longer|HDF5 files was ended with")

_FINE = ("read", "BadFileError", "other ValueError or OSError", "before the process ended", _SURVIVED)


def _memory_disk() -> str | None:
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


def warm(target: Target) -> None:
    """Load what a target loads when it is first used, once for all its processes."""
    for sample in target.samples[:20]:
        with tempfile.TemporaryDirectory() as folder, suppress(ValueError, OSError, UnwantedError):
            for name, data in sample.files.items():
                path = Path(folder) / name
                path.parent.mkdir(exist_ok=True)
                path.write_bytes(data)
            target.call(Path(folder) / sample.name, Random(0))


def again(target: Target, seed: int, number: int) -> None:
    """Run one case in this process, and let its error through."""
    folder = Path(tempfile.mkdtemp(prefix="bedrad-fuzz-"))
    outside(folder)
    (folder / "inside").mkdir()
    rng = Random(f"{seed}:{target.name}:{number}")
    path = make(target, rng, folder / "inside", folder / "outside")
    print(path)
    warnings.simplefilter("error")
    began = time.process_time()
    try:
        target.call(path, rng)
    finally:
        print(f"{time.process_time() - began:.3f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", type=int, default=20_000, help="beside those already run; 0 shows these")
    parser.add_argument("--target", action="append", help="only this one; several times for several")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", help="TARGET:NUMBER, a case to be run in this process")
    parser.add_argument("--state", type=Path, default=ROOT / "results" / "fuzz.json")
    parser.add_argument("--findings", type=Path, default=ROOT / "results" / "fuzz")
    options = parser.parse_args()
    known = targets()
    if options.again:
        name, _, number = options.again.rpartition(":")
        again(known[name], options.seed, int(number))
        return
    chosen = [known[name] for name in options.target or known]
    campaign = Campaign(options.seed, options.state, options.findings)
    whole = sum(target.weight for target in chosen)
    for target in chosen:
        warm(target)
    for _ in range(ROUNDS if options.cases else 0):
        for target in chosen:
            campaign.run_target(target, max(1, round(options.cases * target.weight / whole / ROUNDS)))
    print(campaign.table())


if __name__ == "__main__":
    main()
