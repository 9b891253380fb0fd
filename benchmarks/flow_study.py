"""The flow study: wall layers and view factors of flows against diameter ratio and velocity (`make study-flow`).

Every point of `flow_points.py` runs in a folder of its own and becomes a row of a table; a point that has its row is
not run again, and one that was cut off goes on. The study takes some 13 hours on two cores.

    python benchmarks/flow_study.py [--csv docs/flow_study.csv] [--only TEXT] [--workers 2] [--minutes M]
"""

from __future__ import annotations

import argparse
import csv
import errno
import math
import shutil
import time
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from flow_points import POINTS, Point

import bedrad
from bedrad.atomic import atomic_path
from bedrad.jobs.locking import results_lock
from bedrad.packings import flow_plan
from bedrad.packings.flow import Flow
from bedrad.packings.layers import layer_sums
from bedrad.packings.time_averages import errors_of_mean
from bedrad.walls import Window

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "results" / "flow_study"

LAYERS = 4
PIECES = 4
"""Pieces of the window, three diameters high, whose scatter and renewal give the errors."""

RAY_TOLERANCE = 3e-3
"""Standard error of the rays of one piece of one frame; 124 of them make 3e-4, a tenth of the beds' own."""

LONGEST_WAIT = 60.0
"""Time that a row waits for its place in a table that another study writes, which takes it milliseconds. [s]"""

GAPS = {0.0: "0", 1e-3: "0.001", 1e-2: "0.01", 5e-2: "0.05"}


def measure(point: Point) -> dict[str, Any]:
    """Run a point, or go on with it, and measure it: a row of the table."""
    wall, start = bedrad.Tube(point.tube / 2), time.perf_counter()
    finer = patch.object(flow_plan, "STEPS_PER_CONTACT", point.steps_per_contact)
    with warnings.catch_warnings(), finer:
        warnings.simplefilter("ignore", UserWarning)  # the problems of a flow have a column
        found = bedrad.flow(wall, **point.arguments, work_dir=FOLDER / point.name)
    row = _flow_columns(point, found) | _statistics_columns(found) | _view_factor_columns(found)
    return row | {"frames": len(found), "problems": "; ".join(found.measures.problems),
                  "seconds": time.perf_counter() - start}  # fmt: skip


def _flow_columns(point: Point, found: Flow) -> dict[str, Any]:
    m, d = found.measures, point.diameter
    overlaps = [packing.provenance for packing in found]
    return {
        "point": point.name,
        "variation": point.variation,
        "tube diameter [m]": point.tube,
        "particle diameter [m]": d,
        "A [1]": point.tube / d,
        "seed": point.seed,
        "spheres": found.plan.spheres,
        "normal stiffness [N/m]": found.plan.stiffness,
        "set velocity [m/s]": point.velocity,
        "U [m/s]": m.velocity,
        "U error [m/s]": m.velocity_error,
        "U* [1]": m.velocity / math.sqrt(9.81 * d),
        "U fluctuation [m/s]": m.velocity_fluctuation,
        "solid fraction [1]": m.solid_fraction,
        "solid fraction error [1]": m.solid_fraction_error,
        "solid fraction at rest [1]": m.rest_solid_fraction,
        "wall pressure [Pa]": m.wall_pressure,
        "wall pressure error [Pa]": m.wall_pressure_error,
        "wall shear [Pa]": m.wall_shear,
        "Janssen pressure [Pa]": m.janssen_pressure,
        "mean pair overlap [d]": float(np.mean([float(o["mean_pair_overlap_d"]) for o in overlaps])),
        "largest pair overlap [d]": max(float(o["largest_pair_overlap_d"]) for o in overlaps),
        "largest wall overlap [d]": max(float(o["largest_wall_overlap_d"]) for o in overlaps),
        "windows seen [1]": m.independent_structures,
    }


def _statistics_columns(found: Flow) -> dict[str, Any]:
    stats = bedrad.statistics(found, bedrad.layer_edges(found[0], LAYERS), window=found.window, blocks=PIECES)
    row: dict[str, Any] = {}
    names = {
        "phi_wa": "packing_fraction", "NC share": "nc_share", "a plain": "nc_distance",
        "a weighted": "nc_distance_weighted", "a closing": "nc_distance_closing", "psi_6": "hexagonal_order",
    }  # fmt: skip
    for name, field in names.items():
        unit = "r" if name.startswith("a ") else "1"
        row[f"{name} [{unit}]"] = getattr(stats, field)
        row[f"{name} error [{unit}]"] = getattr(stats, f"{field}_error")
    for gap, text in GAPS.items():
        k = int(np.flatnonzero(stats.gap_tolerances == gap)[0])
        row[f"n_C/n_C,max at {text} r [1]"] = stats.contact_ratio_by_gap[k]
        row[f"n_C/n_C,max at {text} r error [1]"] = stats.contact_ratio_by_gap_error[k]
    # the scatter along the tube is in the errors; whether it is a trend shows here, from the belt upwards
    wall_layer = bedrad.layer_edges(found[0], 1)
    volume = found[0].wall.layer_volume(*wall_layer, found.window) / PIECES
    pieces = np.mean([layer_sums(packing, wall_layer, found.window, PIECES)[:, 0] for packing in found], axis=0)
    return row | {f"phi_wa of piece {k + 1} [1]": value for k, value in enumerate(pieces / volume)}


def _view_factor_columns(found: Flow) -> dict[str, Any]:
    """View factors of every piece of every frame, and their means."""
    planes = np.linspace(*found.window.axial, PIECES + 1)
    edges = bedrad.layer_edges(found[0], LAYERS)
    cells = np.empty((len(found), PIECES, LAYERS + 2))
    for i, packing in enumerate(found):
        for j in range(PIECES):
            window = Window((planes[j], planes[j + 1]))
            factors = bedrad.view_factors(packing, edges, RAY_TOLERANCE, seed=i * PIECES + j, window=window, threads=1)
            cells[i, j] = [*factors.layers, factors.wall, factors.beyond]
    errors, _ = errors_of_mean(cells)
    names = [*(f"F_w{k}" for k in range(1, LAYERS + 1)), "F_ww", "F_beyond"]
    row: dict[str, Any] = {}
    for name, value, error in zip(names, cells.mean(axis=(0, 1)), errors, strict=True):
        row |= {f"{name} [1]": value, f"{name} error [1]": error}
    return row


def read_rows(path: Path) -> list[dict[str, str]]:
    """Rows of the table, none where it is not there yet."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def add_row(path: Path, row: dict[str, Any]) -> None:
    """Put a row into the table, in place of an older one of its point; it stays sorted as the points are.

    Studies that run at the same time wait for each other.
    """
    order = {point.name: k for k, point in enumerate(POINTS)}
    with _held(path):
        others = [each for each in read_rows(path) if each["point"] != row["point"]]
        rows = [*others, {name: _text(value) for name, value in row.items()}]
        rows.sort(key=lambda each: order.get(each["point"], len(order)))
        with atomic_path(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, list(row), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


@contextmanager
def _held(path: Path) -> Iterator[None]:
    """Hold the table from reading to writing, once no other study does; TimeoutError if one does for too long."""
    end = time.monotonic() + LONGEST_WAIT
    with ExitStack() as stack:
        while True:
            try:
                stack.enter_context(results_lock(path))
                break
            except OSError as error:
                if error.errno != errno.EBUSY:
                    raise
                if time.monotonic() > end:
                    raise TimeoutError(f"{path}: another study has held it for {LONGEST_WAIT:g} s") from None
                time.sleep(0.05)
        yield


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, default=ROOT / "docs" / "flow_study.csv", help="the table")
    parser.add_argument("--only", default="", help="points whose name contains this")
    parser.add_argument("--workers", type=int, default=2, help="points that run side by side")
    parser.add_argument("--minutes", type=float, default=math.inf, help="start no point after so long")
    parser.add_argument("--keep", action="store_true", help="keep the frames of points that have their row")
    options = parser.parse_args()
    done, start = {row["point"] for row in read_rows(options.csv)}, time.monotonic()
    left = [point for point in POINTS if point.name not in done and options.only in point.name]
    print(f"{len(done)} points have their row, {len(left)} are left", flush=True)
    with ProcessPoolExecutor(options.workers) as pool:
        waiting, running = list(left), {}
        while waiting or running:
            late = time.monotonic() - start > 60.0 * options.minutes
            while waiting and len(running) < options.workers and not late:
                point = waiting.pop(0)
                running[pool.submit(measure, point)] = point
            if not running:
                break
            ended = next(as_completed(running))
            point = running.pop(ended)
            try:
                row = ended.result()
            except (bedrad.EngineFailedError, OSError) as error:
                print(f"{point.name} has failed and is left for the next call: {error}", flush=True)
                continue
            add_row(options.csv, row)
            if not options.keep:
                shutil.rmtree(FOLDER / point.name)
            told = ", ".join(f"{name} {row[name]:.4f}" for name in ("U [m/s]", "phi_wa [1]", "F_w1 [1]"))
            print(f"{time.strftime('%H:%M:%S')} {point.name}: {told}, {row['seconds']:.0f} s", flush=True)


if __name__ == "__main__":
    main()
