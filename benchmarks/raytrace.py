"""Rays a second and time to 1e-4 in the view factor to the first layer, F_w1: bedrad, meshes and Mitsuba side by side.

    python benchmarks/raytrace.py [DEMO_BED] [--quick] [--beds demo,large,wide,mixed]
                                  [--engines bedrad,grid,open3d,embree,mitsuba] [--csv PATH]

DEMO_BED is a packing; without it, a bed like that of the demo is settled first (needs the extra dem). All times are
processor times on one thread but for the gain of a second one, so that other work on the machine matters little; the
ratios are what counts. bedrad's time to 1e-4 is that of runs with as many rays as that takes; a run whose tolerance is
1e-4 in every share is stated beside it. For the others it is what the scatter of 32 scrambled Sobol sequences says,
with the law by which the error of the exact grid walk falls, and the facet bias, from the same rays through facets and
spheres, added in quadrature: "never" where the bias alone is more.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import beds
import mitsuba_spheres
import numpy as np

import bedrad
from bedrad.packings.layers import layer_edges
from bedrad.raytrace.convergence import shares_and_errors
from bedrad.raytrace.engine_comparison import BYTES_PER_FACET, MESH_BATCH, SUBDIVISIONS, free_memory, mesh_libraries
from bedrad.raytrace.engine_errors import EngineRuns, Reference
from bedrad.raytrace.engine_runs import measure_tracer, timed_build
from bedrad.raytrace.mesh_engines import ENGINES
from bedrad.raytrace.meshes import EXTRA_REACH, IMAGES, SCALINGS, MeshTracer
from bedrad.raytrace.tracer import GridTracer
from bedrad.raytrace.view_factors import EXPONENT, available_processors
from bedrad.walls import Tube

TARGET = 1e-4
DIRECT = ("bedrad", "grid", *ENGINES, "mitsuba")
SEEDS = 2


@dataclass(frozen=True)
class Effort:
    """How long things are measured: rays and repeats of bedrad, seconds of the others, finest mesh."""

    rays: int = 2**25
    reference: int = 2**28
    repeats: int = 5
    walk_seconds: float = 20.0
    bias_seconds: float = 12.0
    seconds: float = 4.0
    finest: int = max(SUBDIVISIONS)


QUICK = Effort(rays=2**22, reference=2**26, repeats=3, walk_seconds=4.0, bias_seconds=3.0, seconds=1.5, finest=2)


@dataclass(frozen=True)
class Row:
    """One line of a table: rays in a second, facet bias and its error, seconds to the target and of the set-up."""

    bed: str
    engine: str
    variant: str
    rate: float
    bias: float
    bias_error: float
    seconds: float
    setup: float
    facets: int = 0


@dataclass(frozen=True)
class Own:
    """What is asked of bedrad alone.

    Gain of a second thread, and the processors that two threads got; a run to the target in every share, its seconds
    and its error of F_w1, and how many times as many plain random rays that error takes; set-up by the clock on the
    wall.
    """

    threads_gain: float
    processors: float
    seconds: float
    error: float
    random_rays: float
    wall_setup: float


class Bench:
    """One bed, and the engines on it."""

    def __init__(self, name: str, packing: bedrad.Packing, effort: Effort) -> None:
        self.name, self.effort = name, effort
        self.scene = (packing, layer_edges(packing), packing.window())
        bedrad.view_factors(packing, rays=2**14, threads=2)  # compile
        self.exact = GridTracer(*self.scene)
        # a seed of no other run
        found = bedrad.view_factors(packing, rays=effort.reference, seed=10**6)
        self.reference = Reference(*shares_and_errors(found), rays=found.rays, seconds=found.seconds)
        self.walk: EngineRuns | None = None

    def bedrad(self) -> tuple[Row, Own]:
        """Measure view_factors as its users run it."""
        packing, repeats = self.scene[0], range(self.effort.repeats)
        rates, setups, gains = [], [], []
        for seed in repeats:
            cost, found = _timed(packing, rays=self.effort.rays, seed=seed)
            rates.append(found.rays / cost)
            setups.append(found.setup_seconds)
        busy = []
        if available_processors() > 1:
            for seed in repeats:
                one = bedrad.view_factors(packing, rays=4 * self.effort.rays, seed=seed, threads=1)
                begin = time.process_time()
                two = bedrad.view_factors(packing, rays=4 * self.effort.rays, seed=seed, threads=2)
                busy.append((time.process_time() - begin) / two.seconds)
                gains.append((one.seconds - one.setup_seconds) / (two.seconds - two.setup_seconds))
        in_all = [_timed(packing, tolerance=TARGET, seed=seed) for seed in repeats]
        error, rays = _error_and_rays(in_all)
        needed = round(rays * (error / TARGET) ** (1.0 / EXPONENT))
        in_first = [_timed(packing, rays=needed, seed=seed) for seed in repeats]
        off = _error_and_rays(in_first)[0] / TARGET
        share = self.reference.estimates[0]
        own = Own(
            threads_gain=float(np.median(gains)) if gains else math.nan,
            processors=float(np.median(busy)) if busy else math.nan,
            seconds=float(np.median([cost for cost, _ in in_all])),
            error=error,
            random_rays=float(share * (1.0 - share) / error**2 / rays),
            wall_setup=float(np.median(setups)),
        )
        seconds = float(np.median([cost for cost, _ in in_first])) * off ** (1.0 / EXPONENT)
        variant = f"exact, {min(rates) / 1e6:.1f} to {max(rates) / 1e6:.1f} M/s"
        return Row(self.name, "bedrad", variant, float(np.median(rates)), 0.0, 0.0, seconds, own.wall_setup), own

    def grid(self) -> Row:
        """Measure the exact walk through a grid, whose law all others follow."""
        tracer, setup = timed_build(lambda: GridTracer(*self.scene))
        self.walk = self._measured(tracer, setup, self.effort.walk_seconds, batch=2**13)
        return self._row(self.walk, "grid walk", "exact")

    def mitsuba(self) -> Iterator[Row | str]:
        """Measure Mitsuba's spheres, unsorted and sorted."""
        if reason := mitsuba_spheres.why_not():
            yield f"mitsuba: {reason}"
            return
        begin = time.process_time()
        tracer = mitsuba_spheres.MitsubaTracer(*self.scene)
        setup = time.process_time() - begin
        for tracer.sort in (False, True):
            runs, more = self._settled(tracer, setup, self.effort.seconds)
            setup += more
            yield self._row(dataclasses.replace(runs, setup_seconds=setup), "mitsuba", f"spheres, {_order(tracer)}")

    def meshes(self, engines: list[str]) -> Iterator[Row | str]:
        """Measure every mesh; those that have the same facets share the bias, found with the first."""
        for subdivision in SUBDIVISIONS:
            facets = self._facets(subdivision)
            if subdivision > self.effort.finest:
                yield f"subdivision {subdivision}: left out by --quick"
                continue
            if facets * BYTES_PER_FACET > free_memory():
                yield (
                    f"subdivision {subdivision}: left out, {facets / 1e6:,.0f} million facets would take up to "
                    f"{facets * BYTES_PER_FACET / 1e9:.0f} GB, and {free_memory() / 1e9:.0f} GB are free"
                )
                continue
            for scaling in SCALINGS:
                bias: dict[str, Any] = {}
                for engine in engines:
                    tracer, setup = timed_build(lambda: MeshTracer(*self.scene, engine, subdivision, scaling))  # noqa: B023
                    for tracer.sort in (True, False):
                        exact = None if bias else self.exact
                        seconds = self.effort.seconds if bias else self.effort.bias_seconds
                        runs, more = self._settled(tracer, setup, seconds, exact)
                        setup += more
                        bias = bias or {"bias": runs.bias, "bias_error": runs.bias_error, "facets": True}
                        runs = dataclasses.replace(runs, setup_seconds=setup, **bias)
                        variant = f"subdivision {subdivision}, {scaling}, {_order(tracer)}"
                        yield self._row(runs, engine, variant, tracer.triangles)
                    # before the next one needs its memory
                    del tracer

    def _facets(self, subdivision: int) -> int:
        """Number of facets of a mesh of the bed, images included, before it is made."""
        packing, edges, _ = self.scene
        reach = edges[-1] + (EXTRA_REACH * packing.mean_diameter / 2 if isinstance(packing.wall, Tube) else 0.0)
        near = float((packing.depths - packing.radii < reach).sum())
        for period in packing.box:
            near *= 1.0 + (IMAGES + 1.0) * packing.mean_diameter / period if period else 1.0
        return round(near * 20 * 4**subdivision)

    def _settled(self, tracer: Any, setup: float, seconds: float, exact: Any = None) -> tuple[EngineRuns, float]:
        """Measure an engine that may need a second, deeper scene on the way; what that took belongs to the set-up."""
        bare, begin = tracer.deep is None, time.process_time()
        runs = self._measured(tracer, setup, seconds, exact)
        middle = time.process_time()
        if not (bare and tracer.deep is not None):
            return runs, 0.0
        runs = self._measured(tracer, setup, seconds, exact)
        return runs, max(0.0, 2.0 * middle - begin - time.process_time())

    def _measured(
        self, tracer: Any, setup: float, seconds: float, exact: Any = None, batch: int = MESH_BATCH
    ) -> EngineRuns:
        tracer.fates(np.full((1, 4), 0.5))
        return measure_tracer(
            "", "", "", tracer, setup, self.reference, exact=exact, like=self.walk, batch=batch,
            seeds=SEEDS, seed=0, seconds=seconds,
        )  # fmt: skip

    def _row(self, runs: EngineRuns, engine: str, variant: str, facets: int = 0) -> Row:
        return Row(
            self.name, engine, variant, runs.rate, float(runs.bias[0]), float(runs.bias_error[0]),
            runs.seconds_to(TARGET), runs.setup_seconds, facets,
        )  # fmt: skip


def _timed(packing: bedrad.Packing, **options: Any) -> tuple[float, bedrad.ViewFactors]:
    """Processor time of a run on one thread, without its set-up."""
    begin = time.process_time()
    found = bedrad.view_factors(packing, threads=1, **options)
    return (time.process_time() - begin) * (1.0 - found.setup_seconds / found.seconds), found


def _error_and_rays(runs: list[tuple[float, bedrad.ViewFactors]]) -> tuple[float, float]:
    """Stated error of F_w1 and number of rays, over some runs."""
    errors = np.array([found.layers_error[0] for _, found in runs])
    return float(np.sqrt(np.mean(errors**2))), float(np.mean([found.rays for _, found in runs]))


def _order(tracer: Any) -> str:
    return "sorted" if tracer.sort else "unsorted"


def print_row(row: Row, own: Row | None) -> None:
    bias = f"{row.bias:+.1e} ± {row.bias_error:.0e}" if row.bias_error else "none"
    seconds = f"{row.seconds:10.3g}" if math.isfinite(row.seconds) else "     never"
    ratio = f"{row.seconds / own.seconds:10.1f}" if own and math.isfinite(row.seconds) else " " * 10
    facets = f"{row.facets / 1e6:10.2f}" if row.facets else " " * 10
    print(
        f"  {row.engine:<10}{row.variant:<38}{row.rate / 1e6:8.2f}{bias:>19}{seconds}{ratio}{row.setup:10.3f}{facets}",
        flush=True,
    )


def run_bed(name: str, packing: bedrad.Packing, engines: list[str], effort: Effort) -> tuple[list[Row], Own]:
    """Measure the engines on a bed and print the table."""
    begin = time.perf_counter()
    print(f"\n{name}: {(beds.BEDS[name].__doc__ or '').splitlines()[0]}", flush=True)
    bench = Bench(name, packing, effort)
    shares = ", ".join(f"{x:.5f}" for x in bench.reference.estimates)
    print(f"  {packing!r}\n  shares of the layers, beyond, wall, escaped: {shares}")
    print(
        f"  {'engine':<48}{'M/s':>8}{'bias of F_w1':>19}{'s to 1e-4':>10}{'/ bedrad':>10}{'set-up s':>10}"
        f"{'M facets':>10}"
    )
    first, own = bench.bedrad()
    rows = [first]
    print_row(first, first)
    # the law of the others follows that of the walk, so that it is measured whether it is shown or not
    others: list[Callable[[], Iterator[Row | str]]] = [lambda: iter([bench.grid()])]
    if "mitsuba" in engines:
        others.append(bench.mitsuba)
    usable, missing = mesh_libraries()
    for engine, reason in missing:
        if engine in engines:
            print(f"  {engine}: left out, {reason}")
    if usable := [e for e in usable if e in engines]:
        others.append(lambda: bench.meshes(usable))
    if len(engines) > 1 or "bedrad" not in engines:
        for found in (row for other in others for row in other()):
            if isinstance(found, str):
                print(f"  {found}", flush=True)
            else:
                rows.append(found)
                print_row(found, first)
    print(
        f"  bedrad to 1e-4 in every share: {own.seconds:.3g} s, {own.error:.1e} in F_w1, for which it takes "
        f"{own.random_rays:.1f} times as many plain random rays; two threads over one: {own.threads_gain:.2f}, on "
        f"{own.processors:.2f} processors that they got\n"
        f"  {time.perf_counter() - begin:.0f} s in all"
    )
    return rows, own


def print_claims(rows: list[Row], own: dict[str, Own]) -> None:
    """Say what was promised and what was measured."""

    def best(bed: str, engines: tuple[str, ...], setup: bool = False) -> float:
        own = first[bed].seconds + setup * first[bed].setup
        fastest = min((r.seconds + setup * r.setup for r in rows if r.bed == bed and r.engine in engines), default=0.0)
        return fastest / own if 0.0 < fastest < math.inf else math.nan

    first = {row.bed: row for row in rows if row.engine == "bedrad"}
    claims = []
    if "demo" in first:
        claims += [
            ("demo: million rays a second, one thread", first["demo"].rate / 1e6, 40.0),
            ("demo: times as fast to 1e-4 as the best mesh", best("demo", ENGINES), 100.0),
            ("demo: the same, set-up included", best("demo", ENGINES, setup=True), 100.0),
            ("demo: times as fast to 1e-4 as Mitsuba's spheres", best("demo", ("mitsuba",)), 10.0),
            (
                f"demo: times as fast on two cores ({own['demo'].processors:.2f} were free)",
                own["demo"].threads_gain,
                1.8,
            ),
        ]
    for bed in (name for name in first if name != "demo"):
        claims += [
            (f"{bed}: million rays a second, one thread", first[bed].rate / 1e6, 15.0),
            (f"{bed}: set-ups in a second", 1.0 / own[bed].wall_setup, 1.0),
        ]
    print(f"\n{'claim':<52}{'at least':>10}{'measured':>10}")
    for text, value, least in claims:
        verdict = "not measured" if math.isnan(value) else "holds" if value >= least else "falls short"
        print(f"{text:<52}{least:>10g}{value:>10.1f}  {verdict}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("demo_bed", nargs="?")
    parser.add_argument("--quick", action="store_true", help="shorter runs, coarse meshes only")
    parser.add_argument("--beds", default=",".join(beds.BEDS))
    parser.add_argument("--engines", default=",".join(DIRECT))
    parser.add_argument("--csv", type=Path)
    arguments = parser.parse_args()
    names, engines = arguments.beds.split(","), arguments.engines.split(",")
    for wanted, known in ((names, tuple(beds.BEDS)), (engines, DIRECT)):
        if unknown := [name for name in wanted if name not in known]:
            parser.error(f"{', '.join(unknown)}: expected some of {', '.join(known)}")
    rows: list[Row] = []
    own: dict[str, Own] = {}
    for name in names:
        packing = beds.demo_bed(arguments.demo_bed) if name == "demo" else beds.BEDS[name]()
        found, own[name] = run_bed(name, packing, engines, QUICK if arguments.quick else Effort())
        rows += found
    print_claims(rows, own)
    if arguments.csv:
        arguments.csv.parent.mkdir(parents=True, exist_ok=True)
        with arguments.csv.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(
                ["bed", "engine", "variant", "rays_per_second", "bias", "bias_error", "seconds_to_1e-4",
                 "setup_seconds", "facets"]
            )  # fmt: skip
            writer.writerows(dataclasses.astuple(row) for row in rows)


if __name__ == "__main__":
    main()
