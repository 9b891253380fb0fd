"""View factors from the wall to the layers of a bed, by ray tracing on exact spheres."""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed

from numpy.typing import ArrayLike

from bedrad.packings.layers import block_count, check_edges, check_window, layer_edges
from bedrad.packings.packing import Packing
from bedrad.raytrace.factors import FloatArray, LeftOut, Step, ViewFactors
from bedrad.raytrace.frames import mean_over_frames
from bedrad.raytrace.patches import PatchTracer, Sample
from bedrad.walls import Window

__all__ = ["MOST_RAYS", "edges_from_wall", "view_factors"]

Progress = Callable[[float, str], None]

FIRST_RAYS = 2**14
"""Rays of the first round."""

FIRST_STEP, LONGEST_STEP = 16.0, 128.0
"""Largest ratio of the rays of the second round to the first, and of later ones to all before."""

SHORTEST_STEP = 0.2
"""Least ratio of the rays of a round to all before."""

SMALL_STEP = 1.5
"""Ratio of error to tolerance below which the rest is an addition to what is there rather than a denser sample."""

MARGIN = 1.1
"""Rays of a round over those that the tolerance seems to take, so that a further round is rarely needed."""

EXPONENT = 0.56
"""Power of the number of rays with which the error falls, as measured on settled beds."""

MOST_RAYS = 2**38
"""More rays than this are refused: days of work."""


def view_factors(
    packing: Packing | Iterable[Packing],
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
    """View factors from the wall to the layers of a bed, or their means over the frames of a flow.

    Rays leave the wall by the cosine law (black or grey diffuse emission) and end at the first sphere, whose hit point
    belongs to the layer of its depth; in a tube they may end at the wall again. A ray that starts inside a sphere that
    overlaps the wall ends there, at depth 0. Beside a rod or plate a ray cannot come back, so that it is counted as
    beyond the last layer once it is deeper than the last edge. Rays that leave through an open end are escaped.

    Parameters
    ----------
    packing : Packing or iterable of Packing
        The bed; or frames, such as a flow or `read_frames` gives. Edges, window and blocks are those of the first.
    edges : (layers + 1,) array, optional
        Depths that part the layers, from 0; three layers by `layer_edges` if not given. [m]
    tolerance : float, optional
        Trace until every standard error is below this. 1e-3 if `rays` is not given either. Of frames, those of the
        means are, and each frame has fewer rays; where their number is not known beforehand, each frame's are.
    rays : int, optional
        Trace this many rays instead, or somewhat more, so that every piece of the wall emits as many. Frames share
        them; where their number is not known beforehand, each has as many.
    seed : int
        Seed of the rays.
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
        Shares that sum to one, their standard errors, and what they cost; of frames `TrajectoryViewFactors`.

    Raises
    ------
    ValueError
        If the edges do not ascend from 0, are deeper than the wall allows, `tolerance` and `rays` are both
        given or not positive, no number of rays meets the tolerance, the window reaches beyond the bed, there are no
        frames, or one has another wall than the first.
    TypeError
        If a frame is not a packing.
    """
    target, wanted = _check_effort(tolerance, rays)
    if isinstance(packing, Packing):
        return _of_bed(packing, edges, target, wanted, seed, window, blocks, threads, progress)

    def trace(
        bed: Packing, first: ViewFactors | None, tolerance: float | None, rays: int | None, seed: int
    ) -> ViewFactors:
        if first is None:
            return _of_bed(bed, edges, tolerance, rays, seed, window, blocks, threads, None)
        parts = len(first.block_shares)
        return _of_bed(bed, first.edges, tolerance, rays, seed, first.window, parts, threads, None)

    return mean_over_frames(packing, trace, target, wanted, seed, progress)


def _of_bed(
    packing: Packing,
    edges: ArrayLike | None,
    target: float | None,
    wanted: int | None,
    seed: int,
    window: Window | None,
    blocks: int | None,
    threads: int | None,
    progress: Progress | None,
) -> ViewFactors:
    """The view factors of one bed."""
    begin = time.perf_counter()
    depth_edges = edges_from_wall(packing, edges)
    measured = check_window(packing, window)
    parts = block_count(packing, measured) if blocks is None else blocks
    if parts < 1:
        raise ValueError(f"blocks is {blocks!r}; expected at least 1")
    crew = _Workers(threads)
    tracer = PatchTracer(packing, depth_edges, measured)
    tracer.compile()
    setup = time.perf_counter() - begin
    sample = Sample.empty(parts, len(depth_edges) + 2)
    history: list[Step] = []
    following = wanted or FIRST_RAYS
    with crew as workers:
        while True:
            span = _share(history, target)
            sample += workers.run(tracer, following, (seed, len(history)), parts, progress, span)
            history.append(
                Step(sample.rays, time.perf_counter() - begin, sample.shares, sample.covariance.diagonal() ** 0.5)
            )
            if target is None or (history[-1].largest_error <= target and 3.0 / sample.rays <= target):
                break
            following = _next_rays(history, target)
    return ViewFactors.from_sample(
        sample.counts,
        sample.covariance,
        edges=depth_edges,
        window=measured,
        history=tuple(history),
        seconds=time.perf_counter() - begin,
        setup_seconds=setup + tracer.grid.build_seconds,
        seed=seed,
        left_out=LeftOut(spheres=tracer.left_out, deep_rays=tracer.grid.deep_rays, reach=tracer.grid.reach),
    )


def edges_from_wall(packing: Packing, edges: ArrayLike | None) -> FloatArray:
    """Depths that part the layers, checked, the first of them 0; three layers by `layer_edges` if not given.

    Raises
    ------
    ValueError
        If they do not ascend from 0 or are deeper than the wall allows.
    """
    if edges is None:
        return layer_edges(packing)
    checked = check_edges(edges, packing.wall)
    if checked[0] != 0.0:
        raise ValueError(f"edges are {checked.tolist()} m; the first must be 0, the wall itself")
    return checked


def _check_effort(tolerance: float | None, rays: int | None) -> tuple[float | None, int | None]:
    if tolerance is not None and rays is not None:
        raise ValueError(f"give tolerance or rays, not both (tolerance={tolerance!r}, rays={rays!r})")
    if rays is not None:
        if not 1 <= rays <= MOST_RAYS:
            raise ValueError(f"rays is {rays!r}; expected a whole number from 1 to {MOST_RAYS}")
        return None, int(rays)
    target = 1e-3 if tolerance is None else float(tolerance)
    if not (math.isfinite(target) and target > 0):
        raise ValueError(f"tolerance is {tolerance!r}; expected a positive number")
    return target, None


def available_processors() -> int:
    """Number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _next_rays(history: list[Step], target: float) -> int:
    """Rays that the tolerance seems to take beyond those traced.

    Raises
    ------
    ValueError
        If they are more than `MOST_RAYS`.
    """
    last = history[-1]
    ratio = last.largest_error / target
    # rays of another round are independent of those before; only far more of them gain from lying closer together
    growth = max(ratio**2 if ratio < SMALL_STEP else ratio ** (1 / EXPONENT), 3.0 / (target * last.rays))
    # the first round says little about the error
    if growth * last.rays > MOST_RAYS and len(history) > 1:
        raise ValueError(
            f"tolerance {target:g} would take about {growth * last.rays:.0e} rays, more than {MOST_RAYS:.0e}; "
            f"after {last.rays:,} rays the largest standard error is {last.largest_error:.1e}"
        )
    step = FIRST_STEP if len(history) == 1 else LONGEST_STEP
    return int(last.rays * max(min(MARGIN * growth, step) - 1.0, SHORTEST_STEP))


def _share(history: list[Step], target: float | None) -> tuple[float, float]:
    """Share of the whole effort before and after the coming round, by the power law of the error."""
    if target is None:
        return 0.0, 1.0
    if not history:
        return 0.0, 0.0
    last = history[-1]
    needed = max((last.largest_error / target) ** (1 / EXPONENT), 1.0)
    return min(1.0 / needed, 1.0), min(LONGEST_STEP / needed, 1.0)


class _Workers:
    """Threads that each trace batches of patches; the kernels release the interpreter lock."""

    def __init__(self, threads: int | None) -> None:
        if threads is not None and threads < 1:
            raise ValueError(f"threads is {threads!r}; expected at least 1")
        self._count = threads or available_processors()
        self._stop = threading.Event()
        self._pool: ThreadPoolExecutor | None = None

    def __enter__(self) -> _Workers:
        return self

    def __exit__(self, *error: object) -> None:
        # an interrupt must not wait for the rays that were still to come
        self._stop.set()
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)

    def run(
        self,
        tracer: PatchTracer,
        rays: int,
        seed: tuple[int, int],
        blocks: int,
        progress: Progress | None,
        span: tuple[float, float],
    ) -> Sample:
        """Trace so many rays or more."""
        strata = tracer.strata(rays, seed, blocks)
        batches = tracer.batches(strata)
        total = Sample.empty(blocks, len(tracer.wall.edges) + 2)

        def trace(groups: tuple[int, int]) -> Sample:
            if self._stop.is_set():
                return Sample.empty(blocks, len(tracer.wall.edges) + 2)
            return tracer.trace(strata, groups, blocks)

        if self._count > 1 and len(batches) > 1 and self._pool is None:
            self._pool = ThreadPoolExecutor(self._count)
        found: Iterator[Sample]
        if self._pool is None:
            found = map(trace, batches)
        else:
            found = (f.result() for f in as_completed([self._pool.submit(trace, groups) for groups in batches]))
        # counts are whole numbers: their sum does not depend on the order
        for finished, part in enumerate(found, start=1):
            total += part
            if progress is not None:
                share = span[0] + (span[1] - span[0]) * finished / len(batches)
                progress(share, f"{total.rays:,} rays in this round")
        return total
