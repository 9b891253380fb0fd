"""Kills runs on an ensemble at random moments, and compares what they leave with an undisturbed run.

    python benchmarks/ensemble_kills.py                         # kill -9 of the run itself, 20 times
    python benchmarks/ensemble_kills.py --workers 2             # the same with local processes
    python benchmarks/ensemble_kills.py --dask                  # kill -9 of one of two Dask workers, 20 times

Each time: a new results file, a run that is killed at a moment drawn at random, and the same run again until its end.
The moment is after the first unit has been finished, over the time that an undisturbed run takes from there to its end;
for every fifth kill it is over the whole of the run, start-up included. Then the results must equal those of the
undisturbed run bit for bit but for run times, no unit may have been measured twice that was told as finished, and
no other file may be there.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import bedrad
from bedrad.jobs.equality import differences

BEDS, SPHERES = 50, 600
JOB = """
name = "ensemble to be killed"
seed = 5

[packing.file]
path = "beds/bed_*.h5"

[statistics]

[view_factors]
rays = 16384

[prediction]
wall_temperatures = ["100 degC", "850 degC"]
velocity = "0.016 m/s"

[output]
figures = false
"""
TABLES = {"r_means.csv", "r_beds.csv"}


def scattered_bed(seed: int) -> bedrad.Packing:
    """Spheres in a tube that do not touch: a lattice shaken at random."""
    rng = np.random.default_rng(seed)
    radius, tube, spacing = 300e-6, 12.9 * 300e-6, 2.3 * 300e-6
    lateral = np.arange(-6, 7) * spacing
    x, y = (each.ravel() for each in np.meshgrid(lateral, lateral))
    inside = np.hypot(x, y) < tube - 1.2 * radius
    layers = -(-SPHERES // int(inside.sum()))
    z = np.repeat(np.arange(layers) * spacing, inside.sum())
    centers = np.c_[np.tile(x[inside], layers), np.tile(y[inside], layers), z]
    centers += rng.uniform(-0.08, 0.08, centers.shape) * radius
    return bedrad.Packing(centers, radius, bedrad.Tube(tube), period=layers * spacing)


def command(folder: Path, *options: str) -> list[str]:
    code = "import sys; from bedrad.cli import main; sys.exit(main())"
    return [sys.executable, "-c", code, "run", "job.toml", "-o", str(folder / "r.h5"), *options]


def run(home: Path, folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Run to the end, and say what went wrong if something did."""
    done = subprocess.run(command(folder, *options), cwd=home, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"exit code {done.returncode}:\n{done.stderr}")
    return done


def finished_before(folder: Path) -> int:
    """Units that the journal or the results file holds."""
    from bedrad.jobs.ensemble_store import EnsembleStore

    store = EnsembleStore(folder / "r.h5")
    return len(store.keys())


def measured_now(screen: str) -> int:
    """Units that a run says it measured."""
    lines = [line for line in screen.splitlines() if line.startswith("units")]
    return int(lines[-1].split(" measured")[0].split()[-1].replace(",", "")) if lines else 0


def check(home: Path, folder: Path, whole: Path, options: tuple[str, ...], what: str) -> list[str]:
    """Run again after a kill; whatever is wrong."""
    before = finished_before(folder)
    again = run(home, folder, *options)
    wrong = differences(whole / "r.h5", folder / "r.h5")
    if measured_now(again.stderr) != BEDS - before:
        wrong.append(f"{measured_now(again.stderr)} measured, {BEDS - before} were left")
    strays = {file.name for file in folder.iterdir()} - {"r.h5"} - TABLES
    wrong += sorted(strays)
    print(
        f"{what}: {before:2d} finished before, {BEDS - before:2d} after; {'; '.join(wrong) or 'the same'}", flush=True
    )
    return wrong


def until(true: Callable[[], object], process: subprocess.Popen[bytes]) -> None:
    """Wait until something is true or a process has ended."""
    while process.poll() is None and not true():
        time.sleep(0.005)


def undisturbed(home: Path, folder: Path, options: tuple[str, ...]) -> tuple[float, float]:
    """Run to the end; when the first unit was finished, and how long it took in all. [s]"""
    folder.mkdir()
    begin = time.monotonic()
    process = subprocess.Popen(command(folder, *options), cwd=home, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    until((folder / "r.h5.journal").exists, process)
    first = time.monotonic() - begin
    _, screen = process.communicate()
    if process.returncode:
        sys.exit(f"the undisturbed run failed:\n{screen.decode()}")
    return first, time.monotonic() - begin


def kill_runs(home: Path, whole: Path, times: tuple[float, float], count: int, options: tuple[str, ...]) -> int:
    rng, bad = random.Random(1), 0
    for number in range(count):
        folder = home / f"killed_{number}"
        folder.mkdir()
        process = subprocess.Popen(
            command(folder, *options), cwd=home, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        begin = time.monotonic()
        if number % 5:
            until((folder / "r.h5.journal").exists, process)
            time.sleep(rng.uniform(0.0, times[1] - times[0]))
        else:
            time.sleep(rng.uniform(0.0, times[1]))
        process.send_signal(signal.SIGKILL)
        moment = time.monotonic() - begin
        process.wait()
        time.sleep(1.0)  # workers see that their parent is gone
        bad += bool(check(home, folder, whole, options, f"kill -9 after {moment:5.1f} s"))
        shutil.rmtree(folder)
    return bad


def start(*words: str) -> subprocess.Popen[bytes]:
    """A process of Dask's own command line."""
    where = Path(sys.executable).with_name(words[0])
    return subprocess.Popen([where, *words[1:]], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def kill_dask_workers(home: Path, whole: Path, count: int) -> int:
    rng, bad = random.Random(2), 0
    address = "tcp://127.0.0.1:18786"
    dask = [start("dask", "scheduler", "--host", "127.0.0.1", "--port", "18786", "--no-dashboard")]

    def worker() -> subprocess.Popen[bytes]:
        return start("dask", "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard")

    try:
        while socket.socket().connect_ex(("127.0.0.1", 18786)):
            time.sleep(0.1)
        workers = [worker(), worker()]
        dask += workers
        times = undisturbed(home, home / "first", ("--cluster", address))
        bad += bool(differences(whole / "r.h5", home / "first" / "r.h5"))
        print(f"undisturbed on two Dask workers: {times[1]:.1f} s; {'differs' if bad else 'the same'}", flush=True)
        for number in range(count):
            folder = home / f"dask_{number}"
            folder.mkdir()
            process = subprocess.Popen(
                command(folder, "--cluster", address), cwd=home, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
            )
            until((folder / "r.h5.journal").exists, process)
            moment = rng.uniform(0.0, times[1] - times[0])
            time.sleep(moment)
            workers[number % 2].send_signal(signal.SIGKILL)
            workers[number % 2].wait()
            workers[number % 2] = worker()
            dask.append(workers[number % 2])
            _, screen = process.communicate()
            wrong = differences(whole / "r.h5", folder / "r.h5") if process.returncode == 0 else [screen.decode()]
            wrong += sorted({file.name for file in folder.iterdir()} - {"r.h5"} - TABLES)
            print(f"a worker killed {moment:4.1f} s after the first unit: {'; '.join(wrong) or 'the same'}", flush=True)
            bad += bool(wrong)
            shutil.rmtree(folder)
    finally:
        for process in dask:
            process.kill()
            process.wait()
    return bad


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=20, help="kills")
    parser.add_argument("--workers", type=int, help="local processes")
    parser.add_argument("--dask", action="store_true", help="kill Dask workers, not the run")
    given = parser.parse_args()
    options = () if given.workers is None else ("--workers", str(given.workers))
    os.environ["COLUMNS"] = "160"
    with tempfile.TemporaryDirectory(prefix="bedrad-kills-") as name:
        home = Path(name)
        (home / "beds").mkdir()
        (home / "job.toml").write_text(JOB)
        for seed in range(BEDS):
            bedrad.write(scattered_bed(seed), home / "beds" / f"bed_{seed}.h5")
        whole = home / "undisturbed"
        # the first run compiles the kernels
        undisturbed(home, home / "first_of_all", options)
        times = undisturbed(home, whole, options)
        print(f"undisturbed: first of {BEDS} beds after {times[0]:.1f} s, all after {times[1]:.1f} s", flush=True)
        if given.dask:
            bad = kill_dask_workers(home, whole, given.count)
        else:
            bad = kill_runs(home, whole, times, given.count, options)
        print(f"{given.count} kills, {bad} of them with something wrong")
        sys.exit(bool(bad))


if __name__ == "__main__":
    main()
