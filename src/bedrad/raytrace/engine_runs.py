"""One engine measured: its error against its run time, with bias, noise and set-up apart.

Run times are processor times of all threads together: what a run takes on one core, whatever else the machine does.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.packing import Packing
from bedrad.raytrace.convergence import fitted_exponents, shares_and_errors
from bedrad.raytrace.engine_errors import EngineRuns, Reference, power_law
from bedrad.raytrace.factors import standard_error
from bedrad.raytrace.sampling import BATCH, MOST_POINTS, SCRAMBLINGS, SobolStreams
from bedrad.raytrace.view_factors import view_factors
from bedrad.walls import Window

__all__ = ["Tracer", "measure_method", "measure_tracer", "timed_build", "trace_reference"]

FloatArray = NDArray[np.float64]
Note = Callable[[str], None]
Rung = list[tuple[float, FloatArray, FloatArray]]
"""Runs of one length, a seed each: processor time [s], estimates, standard errors."""

FIRST_RAYS = 2**13
"""Rays of the shortest run: 256 a scrambling."""

LEAST_REFERENCE = 2**20
"""Rays of the reference, however short the time: 32 times the longest of the runs that every engine gets."""

FEWEST_RUNS = 3
"""Lengths that every engine is measured at, so that its error has a slope."""

LONGER = 3.0
"""How many times smaller the standard error of the reference must be than that of a run held against it."""


class Tracer(Protocol):
    """Anything that says where rays end: the layers, beyond, wall, escaped, numbered from 0."""

    def fates(self, points: FloatArray, /) -> NDArray[Any]:
        """Where the rays of (n, 4) points of the unit hypercube end."""
        ...


Made = TypeVar("Made", bound=Tracer)


def timed_build(build: Callable[[], Made]) -> tuple[Made, float]:
    """An engine made ready, with all that its first rays set off, and the processor time that took. [s]"""
    points = np.concatenate(list(SobolStreams(0, 1).draw(0, FIRST_RAYS)))
    times = [time.process_time()]
    tracer = build()
    for _ in range(2):
        tracer.fates(points)
        times.append(time.process_time())
    # the same rays a second time cost what rays cost
    return tracer, max(0.0, 2 * times[1] - times[0] - times[2])


def trace_reference(
    tracer: Tracer, names: int, seed: int, seconds: float, threads: int, note: Note = lambda _: None
) -> Reference:
    """Trace as many rays as a time allows, `LEAST_REFERENCE` at least, in doubling rounds on all threads.

    Parameters
    ----------
    tracer : Tracer
        An exact engine.
    names : int
        Number of different ends of a ray.
    seed : int
        Seed, of no other run.
    seconds : float
        Time allowed. [s]
    threads : int
        Number of threads.
    note : callable
        Called with a text now and then.
    """
    begin = time.perf_counter()
    streams = SobolStreams(seed, SCRAMBLINGS)
    counts = np.zeros((SCRAMBLINGS, names), np.int64)
    stop = threading.Event()

    def trace_stream(stream: int, points: int) -> None:
        for batch in streams.draw(stream, points):
            if stop.is_set():
                return
            counts[stream] += np.bincount(tracer.fates(batch), minlength=names)

    done, following = 0, FIRST_RAYS // SCRAMBLINGS
    pool = ThreadPoolExecutor(threads)
    try:
        while True:
            before = time.perf_counter()
            for future in [pool.submit(trace_stream, s, following - done) for s in range(SCRAMBLINGS)]:
                future.result()
                note(f"reference, {following * SCRAMBLINGS:,} rays")
            done = following
            following = 2 * done
            # every further round traces as many rays as all before it, twice the last
            ahead = 2.0 * (time.perf_counter() - before)
            too_long = time.perf_counter() + ahead > begin + seconds and done * SCRAMBLINGS >= LEAST_REFERENCE
            if too_long or following > MOST_POINTS:
                break
    finally:
        # an interrupt must not wait for the rays that were still to come
        stop.set()
        pool.shutdown(wait=True, cancel_futures=True)
    shares = counts / done
    return Reference(
        estimates=shares.mean(axis=0),
        errors=standard_error(shares),
        rays=done * SCRAMBLINGS,
        seconds=time.perf_counter() - begin,
    )


def measure_method(
    name: str,
    options: Mapping[str, Any],
    packing: Packing,
    edges: FloatArray,
    window: Window,
    reference: Reference,
    *,
    seeds: int,
    seed: int,
    seconds: float,
    note: Note = lambda _: None,
) -> EngineRuns:
    """Measure one of bedrad's own methods as its users run it, by `view_factors` on one thread.

    Parameters
    ----------
    name : str
        The method.
    options : mapping
        Further arguments of `view_factors`.
    packing, edges, window
        The scene.
    reference : Reference
        What the runs are held against.
    seeds, seed : int
        Number of repetitions, and the first seed.
    seconds : float
        Time allowed. [s]
    note : callable
        Called with a text now and then.
    """
    rungs: list[Rung] = []
    rays: list[int] = []
    setups: list[float] = []
    for count in _lengths(reference, seconds, rungs):
        found, traced = [], []
        for s in range(seeds):
            note(f"{name}, {count:,} rays")
            begin = time.process_time()
            factors = view_factors(packing, edges, rays=count, seed=seed + s, window=window, threads=1, **options)
            cost = time.process_time() - begin
            setups.append(cost * factors.setup_seconds / factors.seconds)
            found.append((cost - setups[-1], *shares_and_errors(factors)))
            traced.append(factors.rays)
        # a method may trace some more than it is asked for
        rays.append(round(float(np.mean(traced))))
        rungs.append(found)
    nothing = np.zeros(len(reference.estimates))
    return _summary(name, "bedrad", "one thread", False, float(np.median(setups)), rays, rungs,
                    reference, nothing, nothing)  # fmt: skip


def measure_tracer(
    name: str,
    family: str,
    details: str,
    tracer: Tracer,
    setup_seconds: float,
    reference: Reference,
    *,
    exact: Tracer | None = None,
    like: EngineRuns | None = None,
    batch: int = BATCH,
    most_rays: int = MOST_POINTS * SCRAMBLINGS,
    seeds: int,
    seed: int,
    seconds: float,
    note: Note = lambda _: None,
) -> EngineRuns:
    """Measure an engine that says where given rays end.

    Parameters
    ----------
    name, family, details : str
        See `EngineRuns`.
    tracer : Tracer
        The engine, made ready.
    setup_seconds : float
        What that took. [s]
    reference : Reference
        What the runs are held against.
    exact : Tracer, optional
        An exact engine that the same rays are given to, for the bias of one that traces facets.
    like : EngineRuns, optional
        An engine that traced the same rays, see `power_law`.
    batch : int
        Rays given to the engine at a time.
    most_rays : int
        Rays of the longest run, if time allows.
    seeds, seed : int
        Number of repetitions, and the first seed.
    seconds : float
        Time allowed. [s]
    note : callable
        Called with a text now and then.
    """
    names = len(reference.estimates)
    begin = time.process_time()
    streams = [SobolStreams(seed + s, SCRAMBLINGS) for s in range(seeds)]
    cost = np.full(seeds, (time.process_time() - begin) / seeds)
    counts = np.zeros((seeds, SCRAMBLINGS, names), np.int64)
    paired = np.zeros_like(counts)
    rungs: list[Rung] = []
    rays: list[int] = []
    for count in _lengths(reference, seconds, rungs, most_rays):
        for s in range(seeds):
            note(f"{name}, {count:,} rays")
            more = (count - (rays[-1] if rays else 0)) // SCRAMBLINGS
            cost[s] += _extend(streams[s], more, batch, tracer, counts[s], exact, paired[s])
        rays.append(count)
        shares = counts * SCRAMBLINGS / count
        rungs.append([(cost[s], shares[s].mean(axis=0), standard_error(shares[s])) for s in range(seeds)])
    bias = bias_error = np.zeros(names)
    if exact is not None:
        pairs = ((counts - paired) * SCRAMBLINGS / rays[-1]).reshape(-1, names)
        bias, bias_error = pairs.mean(axis=0), standard_error(pairs)
    return _summary(name, family, details, exact is not None, setup_seconds, rays, rungs, reference, bias,
                    bias_error, like)  # fmt: skip


def _lengths(
    reference: Reference, seconds: float, rungs: list[Rung], most: int = MOST_POINTS * SCRAMBLINGS
) -> Iterator[int]:
    """Doubling numbers of rays, as far as time and reference allow; `rungs` grows with every length measured."""
    begin = before = time.perf_counter()
    count = FIRST_RAYS
    while True:
        yield count
        now = time.perf_counter()
        count *= 2
        stated = math.sqrt(float(np.mean([found[2][0] ** 2 for found in rungs[-1]])))
        too_sharp = 0.0 < stated / math.sqrt(2.0) < LONGER * float(reference.errors[0])
        # the next run is about twice as long as the last
        too_long = now + 2.0 * (now - before) > begin + seconds
        if count > most or (len(rungs) >= FEWEST_RUNS and (too_long or too_sharp)):
            return
        before = now


def _extend(
    streams: SobolStreams,
    points: int,
    batch: int,
    tracer: Tracer,
    counts: NDArray[np.int64],
    exact: Tracer | None,
    paired: NDArray[np.int64],
) -> float:
    """Trace more points of every scrambling; the processor time of drawing and tracing, the exact engine's apart."""
    chunk = min(points, batch)
    together = max(1, batch // chunk)
    seconds = 0.0
    for first in range(0, len(streams), together):
        group = range(first, min(first + together, len(streams)))
        for start in range(0, points, chunk):
            begin = time.process_time()
            drawn = [part for s in group for part in streams.draw(s, min(chunk, points - start))]
            rays = drawn[0] if len(drawn) == 1 else np.concatenate(drawn)
            ends = tracer.fates(rays)
            seconds += time.process_time() - begin
            _count(ends, group, counts)
            if exact is not None:
                _count(exact.fates(rays), group, paired)
    return seconds


def _count(fates: NDArray[Any], group: range, counts: NDArray[np.int64]) -> None:
    """Add the ends of rays that belong to some scramblings, as many to each."""
    names = counts.shape[1]
    row = np.repeat(np.arange(len(group)), len(fates) // len(group))
    flat = np.bincount(row * names + fates, minlength=len(group) * names)
    counts[group.start : group.stop] += flat.reshape(len(group), names)


def _summary(
    name: str,
    family: str,
    details: str,
    facets: bool,
    setup_seconds: float,
    rays: list[int],
    rungs: list[Rung],
    reference: Reference,
    bias: FloatArray,
    bias_error: FloatArray,
    like: EngineRuns | None = None,
) -> EngineRuns:
    seconds = np.array([[cost for cost, _, _ in found] for found in rungs])
    distance = np.array([[estimates for _, estimates, _ in found] for found in rungs]) - reference.estimates
    stated = np.array([[errors for _, _, errors in found] for found in rungs])
    noise = np.sqrt(((distance - bias) ** 2).mean(axis=1))
    stated_error = np.sqrt((stated**2).mean(axis=1))
    exponent, exponent_error = fitted_exponents(np.array(rays), noise)
    stated_exponent, stated_exponent_error = fitted_exponents(np.array(rays), stated_error)
    law_level, law_exponent = power_law(np.array(rays), stated_error, like)
    return EngineRuns(
        name=name,
        family=family,
        details=details,
        facets=facets,
        setup_seconds=setup_seconds,
        rays=np.array(rays),
        seconds=np.median(seconds, axis=1),
        true_error=np.sqrt((distance**2).mean(axis=1)),
        noise=noise,
        stated_error=stated_error,
        bias=bias,
        bias_error=bias_error,
        exponent=exponent,
        exponent_error=exponent_error,
        stated_exponent=stated_exponent,
        stated_exponent_error=stated_exponent_error,
        law_level=law_level,
        law_exponent=law_exponent,
        seeds=seconds.shape[1],
    )
