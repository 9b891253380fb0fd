"""Runs on disks that are too small, for real, and looks at what they say and leave (`make study-full-disk`).

    python benchmarks/full_disk.py [--sizes 12]

A file system in memory (tmpfs) of so many bytes takes the place of the disk. For every command there are sizes from
nothing to what it needs. Each time: the command must end with an exit code of its own, one line that names a file and
says that no space is left, and no traceback; the results file must be absent or hold whole stages; no other file may
stay but the journal, which holds finished units. Then the disk grows, the command is given again, and what it leaves
must equal an undisturbed run bit for bit.

Mounting takes the root user, or a kernel that lets users have name spaces of their own (`unshare`).
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import h5py
from ensemble_kills import JOB, scattered_bed

import bedrad
from bedrad.jobs.equality import differences

BEDS = 12
ALONE = JOB.replace("beds/bed_*.h5", "beds/bed_0.h5")
NAMELESS = "BEDRAD_FULL_DISK_INSIDE"


@dataclass(frozen=True)
class Case:
    """A command, in whose words DISK stands for the small disk, and what it leaves there.

    Parameters
    ----------
    name : str
        For the table.
    words : tuple of str
        After ``bedrad``.
    keeps : tuple of str
        Files that may be left when it ends for want of room, beside those that an undisturbed run leaves.
    results : str
        The file that is compared.
    """

    name: str
    words: tuple[str, ...]
    results: str
    keeps: tuple[str, ...] = ()


CASES = (
    Case("an ensemble", ("run", "many.toml", "-o", "DISK/r.h5"), "r.h5", ("r.h5.journal",)),
    Case("an ensemble, two workers", ("run", "many.toml", "-o", "DISK/r.h5", "--workers", "2"), "r.h5",
         ("r.h5.journal",)),
    Case("a job on one bed", ("run", "alone.toml", "-o", "DISK/r.h5"), "r.h5"),
    Case("a bed converted", ("convert", "beds/bed_0.h5", "DISK/r.h5"), "r.h5"),
    Case("a report", ("report", "whole/r.h5", "-o", "DISK/r.html"), "r.html"),
    Case("view factors kept", ("view-factors", "beds/bed_0.h5", "--rays", "16384", "-o", "DISK/r.h5"), "r.h5"),
)  # fmt: skip


@contextmanager
def small_disk(place: Path, size: int) -> Iterator[None]:
    """A file system of so many bytes at a folder."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(place)], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", str(place)], check=True)


def grow(place: Path, size: int) -> None:
    subprocess.run(["mount", "-o", f"remount,size={size}", str(place)], check=True)


def run(case: Case, home: Path, place: Path) -> subprocess.CompletedProcess[str]:
    code = "import sys; from bedrad.cli import main; sys.exit(main())"
    words = [word.replace("DISK", str(place)) for word in case.words]
    return subprocess.run([sys.executable, "-c", code, *words], cwd=home, capture_output=True, text=True, check=False)


def used(place: Path) -> int:
    """Bytes that a file system of pages of 4 KiB takes for the files in a folder, and some for each name."""
    return sum(-(-file.stat().st_size // 4096) * 4096 + 4096 for file in place.rglob("*"))


def equal(first: Path, second: Path, *, so_far: bool = False) -> list[str]:
    """Where two files differ but for run times; `so_far` for stages that the second has finished."""
    if first.suffix == ".h5":
        with h5py.File(second, "r") as file:
            held = set(file)
        return [name for name in differences(first, second) if not so_far or name.split("/")[0] in held]
    # a page says when it was written
    return [] if abs(first.stat().st_size - second.stat().st_size) < 200 else [f"{first.name} differs in size"]


def files(place: Path) -> set[str]:
    return {str(file.relative_to(place)) for file in place.rglob("*") if file.is_file()}


def told(done: subprocess.CompletedProcess[str], place: Path) -> list[str]:
    """What is wrong with how a command ended that had no room."""
    wrong = []
    lines = [line for line in done.stderr.splitlines() if "No space left" in line]
    if done.returncode == 0:
        wrong.append("exit code 0")
    if "Traceback" in done.stderr:
        wrong.append("a traceback")
    if done.returncode and len(lines) != 1:
        wrong.append(f"{len(lines)} lines say why: {done.stderr[-300:]!r}")
    elif done.returncode and str(place) not in lines[0]:
        wrong.append(f"names no file: {lines[0]!r}")
    return wrong


def one_size(case: Case, home: Path, place: Path, whole: Path, size: int) -> tuple[str, list[str]]:
    """Run on a disk of one size, and again when it has grown; how it ended, and what is wrong."""
    with small_disk(place, size):
        first = run(case, home, place)
        ended = "done" if first.returncode == 0 else "no room"
        wrong = [] if first.returncode == 0 else told(first, place)
        expected = files(whole)
        strays = files(place) - expected - set(case.keeps)
        wrong += [f"left behind: {name}" for name in sorted(strays)]
        held = place / case.results
        if held.exists():
            wrong += equal(whole / case.results, held, so_far=True)
        grow(place, 1 << 28)
        again = run(case, home, place)
        if again.returncode:
            wrong.append(f"with room: exit code {again.returncode}: {again.stderr[-300:]!r}")
        else:
            wrong += [f"with room: {text}" for text in equal(whole / case.results, held)]
            wrong += [f"with room: {name}" for name in sorted(files(place) ^ expected)]
    return ended, wrong


def study(case: Case, home: Path, count: int) -> int:
    """All sizes for one command; the number of those at which something is wrong."""
    whole, place = home / f"{case.results}_{CASES.index(case)}", home / "disk"
    whole.mkdir()
    place.mkdir(exist_ok=True)
    undisturbed = run(case, home, whole)
    if undisturbed.returncode:
        sys.exit(f"{case.name}: exit code {undisturbed.returncode}:\n{undisturbed.stderr}")
    needed, bad, ends = used(whole), 0, []
    for k in range(count):
        size = max(4096, int(needed * 1.6 * k / (count - 1)) // 4096 * 4096)
        ended, wrong = one_size(case, home, place, whole, size)
        ends.append(ended)
        bad += bool(wrong)
        print(f"{case.name}, {size >> 10} KiB of {needed >> 10}: {ended}; {'; '.join(wrong) or 'as it should be'}",
              flush=True)  # fmt: skip
    if "no room" not in ends:
        print(f"{case.name}: no size was too small; nothing was seen")
        bad += 1
    return bad


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, default=12, help="disks a command")
    options = parser.parse_args(arguments)
    if os.geteuid() != 0 and NAMELESS not in os.environ:
        # a name space in which this user may mount
        os.environ[NAMELESS] = "1"
        os.execvp("unshare", ["unshare", "-rm", sys.executable, *sys.argv])
    home = Path(tempfile.mkdtemp(prefix="bedrad-disk-"))
    try:
        (home / "beds").mkdir()
        for seed in range(BEDS):
            bedrad.write(scattered_bed(seed), home / "beds" / f"bed_{seed}.h5")
        (home / "many.toml").write_text(JOB)
        (home / "alone.toml").write_text(ALONE)
        (home / "whole").mkdir()
        first = run(CASES[2], home, home / "whole")
        if first.returncode:
            sys.exit(first.stderr)
        bad = sum(study(case, home, options.sizes) for case in CASES)
    finally:
        shutil.rmtree(home, ignore_errors=True)
    print("all as it should be" if not bad else f"{bad} were not as they should be")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
