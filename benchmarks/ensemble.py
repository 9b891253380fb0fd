"""Throughput of an ensemble, and what 10^5 beds would take.

    python benchmarks/ensemble.py                   # 1,000 snapshots of 5,000 spheres to 1e-3 on two local workers
    python benchmarks/ensemble.py --study 100000    # nothing traced: copies of one record through journal and merging

The first settles nothing: every snapshot is one settled or scattered bed with other random displacements, written as
bedrad's HDF5 files. It shows what share start-up, reading, statistics, tracing, predicting and writing have.

The second sends the record of a measured bed, changed in its key, through the journal and into the results file, as
often as asked, and counts bytes, time and memory; and it hands as many tasks that do nothing to a Dask scheduler.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np

import bedrad
from bedrad.jobs.ensemble_store import EnsembleStore
from bedrad.jobs.job import Job, load_job
from bedrad.jobs.members import Member
from bedrad.jobs.unit_record import pack, unpack
from bedrad.jobs.unit_work import Task, Work, measure

JOB = """
name = "snapshots"
seed = 1

[packing.file]
path = "beds/bed_*.h5"

[statistics]

[view_factors]
tolerance = 1e-3

[prediction]
wall_temperatures = { lowest = "100 degC", highest = "1100 degC", count = 6 }
velocity = "0.016 m/s"

[output]
figures = false
"""
RADIUS, TUBE = 300e-6, 12.9 * 300e-6


def scattered_bed(spheres: int, seed: int) -> bedrad.Packing:
    """Spheres at a tube's wall, four rings deep, and a shaken lattice inside; none touch."""
    rng = np.random.default_rng(seed)
    spacing, rings = 2.2, [(11.85, 30), (9.6, 25), (7.35, 19), (5.1, 12), (2.8, 6)]
    height = -(-spheres // sum(count for _, count in rings))
    parts = []
    for radial, count in rings:
        angle = 2 * np.pi * np.arange(count) / count
        angles = angle + rng.random((height, 1)) * 2 * np.pi
        lifted = radial - rng.uniform(0.0, 0.1, (height, count)) - rng.uniform(0, 0.04, (height, count))
        level = spacing * np.arange(height)[:, None] + np.zeros((1, count))
        parts.append(np.stack([lifted * np.cos(angles), lifted * np.sin(angles), level], axis=-1).reshape(-1, 3))
    centers = np.concatenate(parts)[:spheres] * RADIUS
    return bedrad.Packing(centers, RADIUS, bedrad.Tube(TUBE), period=height * spacing * RADIUS)


def throughput(home: Path, count: int, spheres: int, workers: int) -> None:
    (home / "beds").mkdir()
    (home / "job.toml").write_text(JOB)
    begin = time.perf_counter()
    for seed in range(count):
        bedrad.write(scattered_bed(spheres, seed), home / "beds" / f"bed_{seed}.h5")
    print(f"wrote {count:,} beds of {spheres:,} spheres in {time.perf_counter() - begin:.0f} s", flush=True)
    code = "import sys; from bedrad.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "run", "job.toml", "-o", "r.h5", "--workers", str(workers)]

    def run(what: str) -> tuple[float, float]:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        start = time.perf_counter()
        done = subprocess.run(command, cwd=home, capture_output=True, text=True, check=False)
        wall = time.perf_counter() - start
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode:
            sys.exit(done.stderr)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        print(f"{what}: {wall:.1f} s, {cpu:.1f} s of processors", flush=True)
        return wall, cpu

    wall, cpu = run(f"{count:,} beds, {workers} workers")
    idle_wall, idle_cpu = run("the same again, nothing left to do: start-up, identifying, tables")
    with h5py.File(home / "r.h5") as file:
        units = file["units"]
        whole = units["seconds"][()].sum()
        statistics, rays = (units[f"{stage}/seconds"][()].sum() for stage in ("statistics", "view_factors"))
    merging = timed_merge(home)
    print(f"a bed: {whole / count * 1e3:.1f} ms: statistics {statistics / whole:.0%}, tracing {rays / whole:.0%}, "
          f"reading and predicting {(whole - statistics - rays) / whole:.0%}")  # fmt: skip
    print(f"of {wall:.1f} s: measuring {whole / workers / wall:.0%} of what {workers} workers have; "
          f"start-up, identifying, tables {idle_wall / wall:.1%}; results file {merging / wall:.1%}")  # fmt: skip
    print(f"of {cpu:.1f} s of processors: start-up, identifying, tables {idle_cpu / cpu:.1%}")
    size = (home / "r.h5").stat().st_size
    print(f"results file {size / 1e6:.1f} MB, {size / count:.0f} B a bed")


def timed_merge(home: Path) -> float:
    """Seconds that the results file takes, from records in memory as at the end of a run."""
    store = EnsembleStore(home / "r.h5")
    records = [pack(store.record(key)) for key in sorted(store.keys())]
    fresh = EnsembleStore(home / "again.h5")
    begin = time.perf_counter()
    for record in records:
        fresh.add(record)
    appended = time.perf_counter() - begin
    members = [Member(str(k), unpack(record).key, {n: s.digest for n, s in unpack(record).stages.items()}, k)
               for k, record in enumerate(records)]  # fmt: skip
    begin = time.perf_counter()
    fresh.merge(members, [], {"job": "{}", "inputs": "{}"})
    merged = time.perf_counter() - begin
    print(f"journal: {sum(map(len, records)) / len(records):.0f} B a bed, {appended / len(records) * 1e3:.2f} ms each; "
          f"merging {merged:.2f} s")  # fmt: skip
    return appended + merged


def study(home: Path, count: int) -> None:
    """Send so many records through journal and merging, and as many tasks through a Dask scheduler."""
    (home / "beds").mkdir()
    (home / "job.toml").write_text(JOB)
    bedrad.write(scattered_bed(5000, 1), home / "beds" / "bed_0.h5")
    job = load_job(home / "job.toml")
    from bedrad.jobs.ensemble import plan_ensemble

    (member,) = plan_ensemble(job, home / "none.h5").members
    found = measure(Work.of(job, 1), Task(member))
    if found.record is None:
        sys.exit(found.error)
    record = unpack(found.record)
    store = EnsembleStore(home / "many.h5")
    journal = home / "many.h5.journal"
    begin = time.perf_counter()
    members = []
    for k in range(count):
        key = f"{k:064x}"
        store.add(pack(replace(record, key=key)))
        members.append(replace(member, key=key, label=f"beds/bed_{k}.h5"))
    seconds = time.perf_counter() - begin
    print(f"{count:,} records: journal {journal.stat().st_size / 1e6:.0f} MB in {seconds:.0f} s, 1 file")
    store.close()
    begin = time.perf_counter()
    store = EnsembleStore(home / "many.h5")
    print(f"read again after a kill in {time.perf_counter() - begin:.0f} s; memory so far {peak():.0f} MB")
    begin = time.perf_counter()
    store.merge(members, [], {"job": job.resolved(), "inputs": "{}"})
    size = (home / "many.h5").stat().st_size
    print(f"merged in {time.perf_counter() - begin:.0f} s: results file {size / 1e6:.0f} MB; memory {peak():.0f} MB")
    begin = time.perf_counter()
    store = EnsembleStore(home / "many.h5")
    print(f"index of the results read in {time.perf_counter() - begin:.1f} s, {len(store.keys()):,} units")
    from bedrad.report.ensemble_tables import write_tables

    begin = time.perf_counter()
    write_tables(store.results, home)
    table = (home / "many_beds.csv").stat().st_size
    print(f"tables in {time.perf_counter() - begin:.0f} s: {table / 1e6:.0f} MB; memory {peak():.0f} MB")
    scheduler_load(job, member, count)


def peak() -> float:
    """Most memory that this process has had. [MB]"""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def nothing(_: Work, __: Task) -> bytes:
    """What a unit costs beside its measuring: an answer of the size of a record."""
    return bytes(7000)


def scheduler_load(job: Job, member: Member, count: int) -> None:
    import cloudpickle
    import distributed

    from bedrad.jobs.cluster import ClusterCrew

    work, task = Work.of(job, 1), Task(member)
    there = len(cloudpickle.dumps((work, [task])))
    print(f"a task is {there:,} B on its way there, {len(cloudpickle.dumps(task)):,} B each more in a batch")
    few = min(count, 20_000)
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=2, dashboard_address=":0") as cluster,
        ClusterCrew(cluster.scheduler_address) as crew,
    ):
        begin = time.perf_counter()
        done = sum(1 for _ in crew.run(nothing, work, (task for _ in range(few))))
        seconds = time.perf_counter() - begin
        print(
            f"{done:,} tasks that do nothing through a scheduler in {seconds:.1f} s: {seconds / done * 1e3:.2f} ms each"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--beds", type=int, default=1000)
    parser.add_argument("--spheres", type=int, default=5000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--study", type=int, help="send so many records through journal and merging")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="bedrad-ensemble-") as name:
        if given.study:
            study(Path(name), given.study)
        else:
            throughput(Path(name), given.beds, given.spheres, given.workers)


if __name__ == "__main__":
    main()
