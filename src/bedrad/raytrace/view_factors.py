"""View factors from the wall to the layers of a bed, by ray tracing on exact spheres."""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.packings.layers import block_count, check_edges, check_window, layer_edges
from bedrad.packings.packing import Packing
from bedrad.raytrace.factors import LeftOut, Step, ViewFactors, standard_error
from bedrad.raytrace.sampling import DIMENSIONS, MOST_POINTS, SobolStreams
from bedrad.raytrace.tracer import GridTracer
from bedrad.walls import Window

__all__ = ["SCRAMBLINGS", "view_factors"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Progress = Callable[[float, str], None]

SCRAMBLINGS = 32
"""Independent scramblings; their scatter gives the standard errors (31 degrees of freedom)."""

FIRST_POINTS = 2**10
"""Rays a scrambling in the first round; every further round doubles the total."""

EXPONENT = 0.56
"""Power of the number of rays with which the error falls, as measured on settled beds."""

SURE_ROUNDS = 4
"""Rounds after which the error is known well enough to say what a tolerance will take."""

def view_factors(
    packing: Packing,
    edges: ArrayLike | None = None,
    tolerance: float | None = None,
    rays: int | None = None,
    seed: int = 0,
    *,
    window: Window | None = None,
    blocks: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> ViewFactors:
    """View factors from the wall to the layers of a bed.

    Rays leave the wall by the cosine law (black or grey diffuse emission) and end at the first sphere, whose hit point
    belongs to the layer of its depth; in a tube they may end at the wall again. A ray that starts inside a sphere that
    overlaps the wall ends there, at depth 0. Beside a rod or plate a ray cannot come back, so that it is counted as
    beyond the last layer once it is deeper than the last edge. Rays that leave through an open end are escaped.

    Parameters
    ----------
    packing : Packing
        The bed.
    edges : (layers + 1,) array, optional
        Depths that part the layers, from 0; three layers by `layer_edges` if not given. [m]
    tolerance : float, optional
        Trace until every standard error is below this. 1e-3 if `rays` is not given either.
    rays : int, optional
        Trace this many rays instead, rounded up to a power of two.
    seed : int
        Seed of the scramblings.
    window : Window, optional
        The piece of wall that emits; `Packing.window` if not given, which leaves out open ends.
    blocks : int, optional
        Axial blocks by which the scatter of the bed itself is estimated; at most 8 blocks, each at least 2 mean
        diameters long, if not given. With one block there is no estimate (nan).
    threads : int, optional
        Number of threads; all processors if not given. The result does not depend on it.
    progress : callable, optional
        Called with the share done and a text.

    Returns
    -------
    ViewFactors
        Shares that sum to one, their standard errors, and what they cost.

    Raises
    ------
    ValueError
        If the edges do not ascend from 0, are deeper than the wall allows, `tolerance` and `rays` are both
        given or not positive, no number of rays meets the tolerance, or the window reaches beyond the bed.
    """
    begin = time.perf_counter()
    depth_edges = _check_edges(packing, edges)
    target, wanted = _check_effort(tolerance, rays)
    measured = check_window(packing, window)
    parts = block_count(packing, measured) if blocks is None else blocks
    if parts < 1:
        raise ValueError(f"blocks is {blocks!r}; expected at least 1")
    tracer = GridTracer(packing, depth_edges, measured)
    # no rays: compiles the kernels on their first use, so that the rate of the rays is theirs alone
    tracer.fates(np.empty((0, DIMENSIONS)))
    setup = time.perf_counter() - begin
    streams = SobolStreams(seed, SCRAMBLINGS)
    counts = np.zeros((SCRAMBLINGS, parts, len(depth_edges) + 2), np.int64)
    history: list[Step] = []
    done, following = 0, FIRST_POINTS if target is not None else wanted // SCRAMBLINGS
    with _Workers(threads) as workers:
        while True:
            workers.run(tracer, streams, counts, following - done, progress, _share(history, target))
            done = following
            history.append(_step(counts, done, time.perf_counter() - begin))
            if target is None or (history[-1].largest_error <= target and 3.0 / (done * SCRAMBLINGS) <= target):
                break
            _check_reach(history, target)
            following = 2 * done
    return ViewFactors.from_counts(
        counts,
        edges=depth_edges,
        window=measured,
        history=tuple(history),
        seconds=time.perf_counter() - begin,
        setup_seconds=setup,
        seed=seed,
        left_out=LeftOut(
            spheres=tracer.near.left_out if tracer.deep is None else 0,
            deep_rays=tracer.deep_rays,
            reach=tracer.near.reach,
        ),
    )


def _check_edges(packing: Packing, edges: ArrayLike | None) -> FloatArray:
    if edges is None:
        return layer_edges(packing)
    checked = check_edges(edges, packing.wall)
    if checked[0] != 0.0:
        raise ValueError(f"edges are {checked.tolist()} m; the first must be 0, the wall itself")
    return checked


def _check_effort(tolerance: float | None, rays: int | None) -> tuple[float | None, int]:
    if tolerance is not None and rays is not None:
        raise ValueError(f"give tolerance or rays, not both (tolerance={tolerance!r}, rays={rays!r})")
    if rays is not None:
        if not 1 <= rays <= MOST_POINTS * SCRAMBLINGS:
            raise ValueError(f"rays is {rays!r}; expected a whole number from 1 to {MOST_POINTS * SCRAMBLINGS}")
        return None, max(SCRAMBLINGS, 1 << (int(rays) - 1).bit_length())
    target = 1e-3 if tolerance is None else float(tolerance)
    if not (math.isfinite(target) and target > 0):
        raise ValueError(f"tolerance is {tolerance!r}; expected a positive number")
    return target, 0


def available_processors() -> int:
    """Number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _check_reach(history: list[Step], target: float) -> None:
    """Refuse a tolerance as soon as it is clear that it takes more rays than there are points."""
    last, most = history[-1], MOST_POINTS * SCRAMBLINGS
    needed = last.rays * max((last.largest_error / target) ** (1 / EXPONENT), 3.0 / (target * last.rays), 2.0)
    # the first rounds say little about the error
    if needed > most and (len(history) >= SURE_ROUNDS or 2 * last.rays > most):
        raise ValueError(
            f"tolerance {target:g} would take about {needed:.0e} rays, more than the {most:.0e} there are; "
            f"after {last.rays:,} rays the largest standard error is {last.largest_error:.1e}"
        )


class _Workers:
    """Threads that each trace whole scramblings; the kernels release the interpreter lock."""

    def __init__(self, threads: int | None) -> None:
        if threads is not None and threads < 1:
            raise ValueError(f"threads is {threads!r}; expected at least 1")
        self._count = threads or available_processors()
        self._stop = threading.Event()

    def __enter__(self) -> _Workers:
        self._pool = ThreadPoolExecutor(self._count)
        return self

    def __exit__(self, *error: object) -> None:
        # an interrupt must not wait for the rays that were still to come
        self._stop.set()
        self._pool.shutdown(wait=True, cancel_futures=True)

    def run(
        self,
        tracer: GridTracer,
        streams: SobolStreams,
        counts: IntArray,
        points: int,
        progress: Progress | None,
        span: tuple[float, float],
    ) -> None:
        """Trace `points` more rays of every scrambling."""

        def trace_stream(stream: int) -> None:
            for batch in streams.draw(stream, points):
                if self._stop.is_set():
                    return
                blocks, shares = counts.shape[1:]
                block = np.minimum((batch[:, 0] * blocks).astype(np.int64), blocks - 1)
                counts[stream] += np.bincount(
                    block * shares + tracer.fates(batch), minlength=blocks * shares
                ).reshape(blocks, shares)

        futures = [self._pool.submit(trace_stream, s) for s in range(len(streams))]
        for finished, future in enumerate(futures, start=1):
            future.result()
            if progress is not None:
                share = span[0] + (span[1] - span[0]) * finished / len(futures)
                progress(share, f"{len(streams) * points * finished // len(futures):,} rays in this round")


def _share(history: list[Step], target: float | None) -> tuple[float, float]:
    """Share of the whole effort before and after the coming round, by the power law of the error."""
    if target is None:
        return 0.0, 1.0
    if not history:
        return 0.0, 0.0
    needed = max((history[-1].largest_error / target) ** (1 / EXPONENT), 1.0)
    return min(1.0 / needed, 1.0), min(2.0 / needed, 1.0)


def _step(counts: IntArray, points: int, seconds: float) -> Step:
    shares = counts.sum(axis=1) / points
    errors = standard_error(shares)
    return Step(rays=points * len(shares), seconds=seconds, estimates=shares.mean(axis=0), errors=errors)
