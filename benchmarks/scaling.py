"""What a ray, the set-up and a sphere cost as beds grow from 10^3 to 10^6 spheres, beside a plate and in tubes.

    python benchmarks/scaling.py [--most N] [--repeats N]

Wider plates and longer tubes repeat one small bed, so that their view factors are the same and only the size differs;
wide tubes are lined ever more widely. Each bed is traced with one number of rays for all beds, with one number for each
area of a sphere's shadow, and to one tolerance: the first leaves fewer and fewer rays to each patch of wall, the second
does not, and the third is what users ask for. Times are processor times on one thread without set-up; each size is
measured in a process of its own, so that the growth of its memory is its own.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import beds
import numpy as np

import bedrad
from bedrad.packings.layers import layer_edges
from bedrad.raytrace.patches import PatchTracer
from bedrad.walls import Tube, Window

RAYS = 2**23
RAYS_PER_SPHERE = 256
"""Rays from an area of 4 r^2 of wall."""

TOLERANCE = 3e-4
SMALLEST = 1000
MOST_GROWTH = 1.5
MOST_BYTES = 200.0
PEAK_FROM = 900
"""Multiple of `SMALLEST` from which the growth of the process is that of the spheres."""

FAMILIES = ("plate", "long tube", "wide tube")


def family_bed(family: str, factor: int) -> bedrad.Packing:
    """A bed of about `SMALLEST` times `factor` spheres; the factor is a square for a plate."""
    if family == "plate":
        return beds.repeated(beds.layer_bed(SMALLEST), math.isqrt(factor))
    if family == "long tube":
        return beds.repeated(beds.random_bed(Tube(12.0), SMALLEST, 12.0), factor)
    # as long as one of 10 radii with a thousand spheres
    return beds.random_bed(Tube(12.0 * factor), SMALLEST * factor, 10.0)


def wall_area(packing: bedrad.Packing, window: Window) -> float:
    """Area of the window. [m2]"""
    if window.lateral is not None:
        return window.length * (window.lateral[1] - window.lateral[0])
    assert isinstance(packing.wall, Tube)
    return 2.0 * math.pi * packing.wall.radius * window.length


def measure(family: str, factor: int, repeats: int) -> dict[str, float]:
    """Costs of one bed."""
    small = family_bed(family, 1)
    bedrad.view_factors(small, rays=2**16, threads=1)  # compile
    packing = family_bed(family, factor) if factor > 1 else small
    window = packing.window()
    _forget_peak()
    before = _memory("VmRSS")
    begin = time.process_time()
    tracer = PatchTracer(packing, layer_edges(packing), window)
    tracer.compile()
    setup = time.process_time() - begin
    kept = sum(np.asarray(part).nbytes for part in tracer.bins)
    near = tracer.grid.near
    kept += near.starts.nbytes + near.columns.nbytes
    found = {"spheres": float(len(packing)), "setup": setup, "kept": kept / len(packing)}
    by_area = round(RAYS_PER_SPHERE * wall_area(packing, window) / (4.0 * float(packing.radii.max()) ** 2))
    for name, effort in (
        ("in all", {"rays": RAYS}),
        ("by area", {"rays": by_area}),
        ("to tolerance", {"tolerance": TOLERANCE}),
    ):
        runs = [_time_and_rays(packing, effort) for _ in range(repeats)]
        found[name] = min(seconds / rays for seconds, rays in runs)
        found[f"seconds {name}"] = min(seconds for seconds, _ in runs)
    found["grown"] = (_memory("VmHWM") - before) / len(packing)
    return found


def _time_and_rays(packing: bedrad.Packing, effort: dict[str, Any]) -> tuple[float, float]:
    """Processor time of a run without set-up, and its rays; means over half a second of runs, a seed each. [s]"""
    seconds, rays, seed = 0.0, 0, 0
    while seconds < 0.5:
        begin = time.process_time()
        found = bedrad.view_factors(packing, threads=1, seed=seed, **effort)
        seconds += (time.process_time() - begin) * (1.0 - found.setup_seconds / found.seconds)
        rays += found.rays
        seed += 1
    return seconds / seed, rays / seed


def _memory(name: str) -> float:
    """Memory of this process by Linux's account of it: "VmRSS" now, "VmHWM" at its peak; nan elsewhere. [bytes]"""
    status = Path("/proc/self/status")
    if not status.exists():
        return math.nan
    found = re.search(rf"{name}:\s*(\d+) kB", status.read_text(encoding="ascii"))
    return 1024.0 * int(found[1]) if found else math.nan


def _forget_peak() -> None:
    """Let the peak begin anew, as making a bed takes more memory than tracing it."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=int, default=10**6, help="largest number of spheres, about")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--one", nargs=2, metavar=("FAMILY", "FACTOR"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one[0], int(arguments.one[1]), arguments.repeats)))
        return
    worst = dict.fromkeys(("in all", "by area", "to tolerance", "kept", "at the peak"), math.nan)
    for family in FAMILIES:
        print(
            f"\n{family}\n{'spheres':>10}{'set-up s':>10}  ns a ray: {RAYS:,} in all, "
            f"{RAYS_PER_SPHERE} for 4 r2 of wall, to {TOLERANCE:g} (in s)      bytes a sphere: kept, grown by"
        )
        first: dict[str, float] = {}
        for factor in (1, 9, 100, 961):
            if factor * SMALLEST > arguments.most:
                break
            done = subprocess.run(
                [sys.executable, Path(__file__), "--one", family, str(factor), "--repeats", str(arguments.repeats)],
                stdout=subprocess.PIPE, check=True,
            )  # fmt: skip
            found = json.loads(done.stdout)
            first = first or found
            growths = {name: found[name] / first[name] for name in ("in all", "by area", "to tolerance")}
            cells = "".join(f"{found[name] * 1e9:12.1f} ({growth:4.2f})" for name, growth in growths.items())
            print(
                f"{found['spheres']:>10,.0f}{found['setup']:>10.3f}{cells}{found['seconds to tolerance']:>9.3f}"
                f"{found['kept']:>12.0f}{found['grown']:>8.0f}",
                flush=True,
            )
            # in small beds the peak is that of the compiler and of the buffers for rays
            peak = found["grown"] if factor >= PEAK_FROM else math.nan
            for name, value in (growths | {"kept": found["kept"], "at the peak": peak}).items():
                worst[name] = float(np.fmax(worst[name], value))
    print(f"\n{'claim':<52}{'below':>10}{'measured':>10}")
    for name, value in worst.items():
        memory = name in ("kept", "at the peak")
        text = f"bytes a sphere, {name}" if memory else f"growth of the time of a ray, rays {name}"
        limit = MOST_BYTES if memory else MOST_GROWTH
        verdict = "not measured" if math.isnan(value) else "holds" if value < limit else "falls short"
        print(f"{text:<52}{limit:>10g}{value:>10.2f}  {verdict}")


if __name__ == "__main__":
    main()
