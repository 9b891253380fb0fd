"""Every engine at hand on the user's own bed: error of the view factors against run time.

The reference is an independent, longer run of the exact grid walk. The bias of meshes comes from the same rays through
the facets and through the exact spheres, so that it is known far better than either result; their noise is what is
left. Meshes get the scaling with the least bias, and sorted rays where these are faster.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.errors import EngineFailedError, MissingExtraError
from bedrad.packings.layers import check_edges, check_window, layer_edges
from bedrad.packings.packing import Packing
from bedrad.raytrace.engine_errors import EngineRuns, Reference
from bedrad.raytrace.engine_runs import (
    measure_method,
    measure_tracer,
    timed_build,
    trace_reference,
)
from bedrad.raytrace.mesh_engines import ENGINES, engine_maker
from bedrad.raytrace.meshes import SCALINGS, MeshTracer
from bedrad.raytrace.tracer import GridTracer
from bedrad.raytrace.view_factors import available_processors, view_factors
from bedrad.walls import Window

__all__ = ["METHODS", "SUBDIVISIONS", "EngineComparison", "Trial", "compare_engines", "mesh_libraries"]

FloatArray = NDArray[np.float64]
Progress = Callable[[float, str], None]

METHODS: dict[str, Mapping[str, Any]] = {"bedrad": {}}
"""bedrad's own methods: names to arguments of `view_factors`."""

SUBDIVISIONS = {2: 1, 3: 2, 4: 4}
"""Icospheres of 320, 1,280 and 5,120 facets, and the parts of the time that each gets."""

COARSEST = min(SUBDIVISIONS)

FACETS_GROW = 4
"""Each subdivision has so many times the facets of the one before, and takes so many times the set-up."""

BYTES_PER_FACET = 300
"""Memory that a mesh and its tree take while they are made, 136 bytes as measured, twice where rays cross a tube."""

MESH_BATCH = 2**18
"""Rays given to a mesh engine at a time: many, as sorting them pays then."""

REFERENCE_SHARE = 0.25
"""Share of the time that goes into the reference."""

TRIAL_RAYS = 2**20
"""Rays that a scaling is tried with, if time allows."""

EXACT_PARTS = 4
"""Parts of the time that an exact engine gets; it needs long runs, as its own error is all there is to see."""

TRIAL_PARTS = 2
"""Parts of the time that go into trials of a mesh engine."""


@dataclass(frozen=True)
class Trial:
    """A mesh engine tried at the coarsest subdivision, to choose how to run it.

    Parameters
    ----------
    engine, scaling : str
        The engine and the scaling of its meshes.
    sort : bool
        Whether the rays were sorted.
    bias, bias_error : float
        Facet bias of the view factor to the first layer, and its standard error.
    rate : float
        Rays in a second of processor time. [1/s]
    """

    engine: str
    scaling: str
    sort: bool
    bias: float
    bias_error: float
    rate: float


@dataclass(frozen=True)
class EngineComparison:
    """Error of the view factors against run time, engine by engine.

    Parameters
    ----------
    names : tuple of str
        What the columns stand for: the layers, beyond, wall, escaped.
    engines : tuple of EngineRuns
        What was measured.
    left_out : tuple of (str, str)
        Engines that were not measured, and why.
    trials : tuple of Trial
        Scalings and orders of rays that the meshes were chosen from.
    reference : Reference
        The independent, longer run.
    budget, total_seconds : float
        Time allowed and time taken. [s]
    """

    names: tuple[str, ...]
    engines: tuple[EngineRuns, ...]
    left_out: tuple[tuple[str, str], ...]
    trials: tuple[Trial, ...]
    reference: Reference
    budget: float
    total_seconds: float


def compare_engines(
    packing: Packing,
    edges: ArrayLike | None = None,
    *,
    budget: float = 120.0,
    seeds: int = 8,
    seed: int = 0,
    window: Window | None = None,
    progress: Progress | None = None,
) -> EngineComparison:
    """Measure the error of every available engine against its run time.

    Parameters
    ----------
    packing : Packing
        The bed.
    edges : (layers + 1,) array, optional
        Depths that part the layers, from 0; three layers by `layer_edges` if not given. [m]
    budget : float
        Time for the whole study, shared between the engines; every engine gets a few short runs even so. [s]
    seeds : int
        Repetitions with other seeds, over which the errors are averaged.
    seed : int
        First seed.
    window : Window, optional
        The piece of wall that emits.
    progress : callable, optional
        Called with the share done and a text.

    Raises
    ------
    ValueError
        If the budget is not positive, there are fewer than two seeds, or the edges or the window do not fit the bed.
    """
    if not (budget > 0.0 and np.isfinite(budget)):
        raise ValueError(f"budget is {budget!r} s; expected a positive number of seconds")
    if seeds < 2:
        raise ValueError(f"seeds is {seeds}; expected at least 2")
    depths = layer_edges(packing) if edges is None else check_edges(edges, packing.wall)
    study = _Study(packing, depths, check_window(packing, window), budget, seeds, seed, progress)
    return study.run()


def mesh_libraries() -> tuple[list[str], list[tuple[str, str]]]:
    """Load the mesh engines: those that can be used, and the others with what would make them usable."""
    found, missing = [], []
    for engine in ENGINES:
        try:
            engine_maker(engine)
        except (MissingExtraError, EngineFailedError) as error:
            missing.append((engine, str(error)))
        else:
            found.append(engine)
    return found, missing


class _Study:
    """The budget, and what is measured with it."""

    def __init__(
        self, packing: Packing, edges: FloatArray, window: Window, budget: float, seeds: int, seed: int,
        progress: Progress | None,
    ) -> None:  # fmt: skip
        self.scene = (packing, edges, window)
        self.budget, self.seeds, self.seed = budget, seeds, seed
        self.progress = progress
        self.begin = time.perf_counter()
        self.engines: list[EngineRuns] = []
        self.trials: list[Trial] = []
        self.left_out: list[tuple[str, str]] = []
        self.cost: dict[str, tuple[float, int]] = {}
        self.ahead = 0

    def run(self) -> EngineComparison:
        packing, edges, window = self.scene
        self.note("compiling")
        view_factors(packing, edges, rays=1, window=window)
        self.exact, _ = timed_build(lambda: GridTracer(*self.scene))
        # a seed beyond all the others, so that the reference shares no ray with them
        self.reference = trace_reference(
            self.exact,
            len(edges) + 2,
            self.seed + self.seeds,
            REFERENCE_SHARE * self.budget,
            available_processors(),
            self.note,
        )
        libraries, missing = mesh_libraries()
        self.left_out += missing
        self.ahead = (len(METHODS) + 1) * EXACT_PARTS + len(libraries) * (TRIAL_PARTS + sum(SUBDIVISIONS.values()))
        for name, options in METHODS.items():
            self.engines.append(
                measure_method(name, options, *self.scene, self.reference, seeds=self.seeds, seed=self.seed,
                               seconds=self.share(EXACT_PARTS), note=self.note)
            )  # fmt: skip
        self._measure_grid_walk(self.share(EXACT_PARTS))
        self._meshes(libraries)
        self.note("done", 1.0)
        return EngineComparison(
            names=(*(f"layer {k + 1}" for k in range(len(edges) - 1)), "beyond", "wall", "escaped"),
            engines=tuple(self.engines),
            left_out=tuple(self.left_out),
            trials=tuple(self.trials),
            reference=self.reference,
            budget=self.budget,
            total_seconds=time.perf_counter() - self.begin,
        )

    def note(self, text: str, share: float | None = None) -> None:
        """Tell how much of the time is gone, and what is being done."""
        if self.progress is not None:
            gone = (time.perf_counter() - self.begin) / self.budget
            self.progress(min(gone, 0.99) if share is None else share, text)

    def share(self, parts: int) -> float:
        """Some of the parts that the time left is divided into; they are not ahead any more. [s]"""
        left = max(0.0, self.begin + self.budget - time.perf_counter())
        share = left * parts / max(self.ahead, parts)
        self.ahead -= parts
        return share

    def _measure_grid_walk(self, seconds: float) -> None:
        tracer, setup = timed_build(lambda: GridTracer(*self.scene))
        self.grid_walk = measure_tracer(
            "grid walk", "grid walk", "exact spheres, one thread", tracer, setup, self.reference,
            seeds=self.seeds, seed=self.seed, seconds=seconds, note=self.note,
        )  # fmt: skip
        self.engines.append(self.grid_walk)

    def _meshes(self, libraries: list[str]) -> None:
        """Coarse meshes first, so that what they cost says what finer ones will."""
        chosen: dict[str, tuple[str, bool]] = {}
        scaling = None
        for engine in libraries:
            scaling, sort = self._chosen(engine, scaling)
            chosen[engine] = scaling, sort
        planned = [(subdivision, engine) for subdivision in SUBDIVISIONS for engine in chosen]
        while planned:
            planned = [mesh for mesh in planned if self._affordable(*mesh)]
            if planned:
                subdivision, engine = planned.pop(0)
                self._measure_mesh(engine, subdivision, *chosen[engine])

    def _affordable(self, subdivision: int, engine: str) -> bool:
        """Whether there is time and memory for a mesh; if not, it is left out and its time is for the others."""
        setup, facets = self.cost[engine]
        growth = FACETS_GROW ** (subdivision - COARSEST)
        reason = _too_costly(growth * setup, growth * facets, self.begin + self.budget - time.perf_counter())
        # the coarsest were tried already
        if not reason or subdivision == COARSEST:
            return True
        self.left_out.append((f"{engine}, subdivision {subdivision}", reason))
        self.ahead -= SUBDIVISIONS[subdivision]
        return False

    def _mesh(self, engine: str, subdivision: int, scaling: str, sort: bool) -> MeshTracer:
        return MeshTracer(*self.scene, engine=engine, subdivision=subdivision, scaling=scaling, sort=sort)

    def _chosen(self, engine: str, scaling: str | None) -> tuple[str, bool]:
        """The scaling with the least bias, and whether sorting the rays pays."""
        scalings = SCALINGS if scaling is None else (scaling,)
        # one more trial than scalings: the best one again with unsorted rays
        each = self.share(TRIAL_PARTS) / (len(scalings) + 1)
        tried = [self._tried(engine, name, True, each) for name in scalings]
        best = min(tried, key=lambda trial: abs(trial.bias))
        unsorted = self._tried(engine, best.scaling, False, each)
        self.trials += [*tried, unsorted]
        return best.scaling, best.rate >= unsorted.rate

    def _tried(self, engine: str, scaling: str, sort: bool, seconds: float) -> Trial:
        # rays of their own, so that the choice favours none of the biases reported
        begin = time.perf_counter()
        name = f"{engine}, trying {scaling}"
        self.note(name)
        tracer, setup = timed_build(lambda: self._mesh(engine, COARSEST, scaling, sort))
        taken = time.perf_counter() - begin
        self.cost[engine] = taken, tracer.triangles
        runs = measure_tracer(
            name, engine, scaling, tracer, setup, self.reference, exact=self.exact, batch=MESH_BATCH,
            most_rays=TRIAL_RAYS // self.seeds, seeds=self.seeds, seed=self.seed + self.seeds + 1,
            seconds=seconds - taken, note=self.note,
        )  # fmt: skip
        return Trial(engine, scaling, sort, float(runs.bias[0]), float(runs.bias_error[0]), runs.rate)

    def _measure_mesh(self, engine: str, subdivision: int, scaling: str, sort: bool) -> None:
        seconds = self.share(SUBDIVISIONS[subdivision])
        name = f"{engine}, subdivision {subdivision}"
        self.note(f"{name}, set-up")
        begin = time.perf_counter()
        try:
            tracer, setup = timed_build(lambda: self._mesh(engine, subdivision, scaling, sort))
        except MemoryError:
            self.left_out.append((name, "out of memory"))
            return
        taken = time.perf_counter() - begin
        growth = FACETS_GROW ** (subdivision - COARSEST)
        self.cost[engine] = taken / growth, tracer.triangles // growth
        details = f"{scaling}, {'sorted' if sort else 'unsorted'} rays, {tracer.triangles:,} facets"
        self.engines.append(
            measure_tracer(name, engine, details, tracer, setup, self.reference, exact=self.exact,
                           like=self.grid_walk, batch=MESH_BATCH, seeds=self.seeds, seed=self.seed,
                           seconds=seconds - taken, note=self.note)
        )  # fmt: skip


def _too_costly(setup: float, facets: int, seconds: float) -> str:
    """Why a mesh is not made: its memory or its set-up; empty if it can be."""
    needed, free = facets * BYTES_PER_FACET, free_memory()
    if needed > free:
        return f"{facets:,} facets would take about {needed / 1e9:.1f} GB, and {free / 1e9:.1f} GB are free"
    if setup > seconds:
        return f"set-up would take about {setup:.2g} s, and {seconds:.2g} s of the budget are left"
    return ""


def free_memory() -> float:
    """Memory that this process may still take, infinite where the system does not tell. [bytes]"""
    free = [math.inf]
    with suppress(OSError):
        available = re.search(r"MemAvailable:\s*(\d+) kB", Path("/proc/meminfo").read_text(encoding="ascii"))
        free.append(1024.0 * int(available[1]) if available else math.inf)
    with suppress(OSError, ValueError):
        # a container has a limit of its own; without one the file says "max"
        group = Path("/sys/fs/cgroup")
        limit, used = (int((group / f"memory.{name}").read_text(encoding="ascii")) for name in ("max", "current"))
        free.append(float(limit - used))
    return min(free)
