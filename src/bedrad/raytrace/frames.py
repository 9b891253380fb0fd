"""View factors averaged over the frames of a flow, with the errors of frames that resemble each other."""

from __future__ import annotations

import hashlib
import math
import operator
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bedrad.packings.packing import Packing
from bedrad.packings.time_averages import errors_of_mean
from bedrad.packings.trajectory import check_frame
from bedrad.raytrace.factors import FloatArray, LeftOut, Step, ViewFactors, by_target
from bedrad.walls import Wall

__all__ = ["TrajectoryViewFactors", "mean_over_frames"]


@dataclass(frozen=True)
class TrajectoryViewFactors(ViewFactors):
    """Mean view factors over frames of a flow.

    As `ViewFactors`, but that the ``<name>_bed_error`` are standard errors of the mean over frames and blocks, by
    `bedrad.packings.time_averages.errors_of_mean`; `block_shares` are means over the frames, `rays` and `left_out`
    sums, and `history` has a step a frame.

    Parameters
    ----------
    frames : int
        Number of frames.
    bed_covariance : (layers + 3, layers + 3) array
        Covariance of the means by the scatter of the bed: correlations between the cells, blocks of frames, with the
        standard errors above; nan where these are.
    structures : (layers + 3,) array
        Number of independent frames that would have these errors.
    """

    frames: int = 1
    bed_covariance: FloatArray | None = None
    structures: FloatArray | None = None

    def covariance_of_bed(self) -> FloatArray:
        """Covariance of the shares by the scatter of the bed, (layers + 3, layers + 3)."""
        assert self.bed_covariance is not None  # noqa: S101 - given wherever one is made
        return self.bed_covariance

    def __str__(self) -> str:
        lines = super().__str__().splitlines()
        return "\n".join([*lines[:-1], f"mean over {self.frames:,} frames", lines[-1]])


class _Trace(Protocol):
    def __call__(
        self, packing: Packing, first: ViewFactors | None, tolerance: float | None, rays: int | None, seed: int, /
    ) -> ViewFactors: ...


def mean_over_frames(
    frames: Iterable[Packing],
    trace: _Trace,
    tolerance: float | None,
    rays: int | None,
    seed: int,
    progress: Callable[[float, str], None] | None = None,
) -> TrajectoryViewFactors:
    """Trace every frame and take the mean.

    Parameters
    ----------
    frames : iterable of Packing
        The frames. One is in memory at a time, if they come so.
    trace : callable
        Traces a frame, given what was found for the first one, which decides edges, window and blocks.
    tolerance : float or None
        Standard error of the mean by the rays: a frame of n may have the square root of n times as much, one of frames
        whose number is not known beforehand no more than this.
    rays : int or None
        Rays in all, in place of a tolerance; each frame has its share, or this many where their number is not known.
    seed : int
        From which each frame has a seed of its own.
    progress : callable, optional
        Called with the share done and a text.

    Raises
    ------
    ValueError
        If there are no frames, or one has another wall; the message names the frame, counted from 0.
    TypeError
        If one is not a packing.
    """
    begin = time.perf_counter()
    count = operator.length_hint(frames, 1) or 1
    one_tolerance = None if tolerance is None else tolerance * math.sqrt(count)
    one_rays = None if rays is None else math.ceil(rays / count)
    found: list[ViewFactors] = []
    history: list[Step] = []
    like: tuple[Wall, float] | None = None
    for number, packing in enumerate(frames):
        if not isinstance(packing, Packing):
            raise TypeError(f"frame {number} is a {type(packing).__name__}; expected a bedrad.Packing")
        try:
            if not len(packing):
                raise ValueError("the packing is empty; there is nothing to trace")
            if like is None:
                like = packing.wall, 0.5 * packing.mean_diameter
            else:
                check_frame(packing, like[0], found[0].window, like[1])
            found.append(trace(packing, found[0] if found else None, one_tolerance, one_rays, frame_seed(seed, number)))
        except ValueError as error:
            raise ValueError(f"frame {number}: {error}") from None
        history.append(_step(found[-1], history[-1] if history else None, number, time.perf_counter() - begin))
        if progress is not None:
            progress(min(1.0, (number + 1) / count), f"{number + 1:,} frames")
    if not found:
        raise ValueError("there are no frames; there is nothing to trace")
    return _mean(found, tuple(history), seed)


def frame_seed(seed: int, frame: int) -> int:
    """Seed of a frame's rays, which shares none with other frames or other seeds."""
    return int.from_bytes(hashlib.sha256(f"bedrad frame {seed} {frame}".encode()).digest()[:8], "big") >> 1


def _step(last: ViewFactors, before: Step | None, number: int, seconds: float) -> Step:
    """Means and errors with a frame more than before; `number` counts frames from 0."""
    shares, variances, n = last.history[-1].estimates, last.covariance.diagonal(), number + 1
    if before is None:
        return Step(last.rays, seconds, shares, np.sqrt(variances))
    mean = before.estimates + (shares - before.estimates) / n
    return Step(before.rays + last.rays, seconds, mean, np.sqrt((number * before.errors) ** 2 + variances) / n)


def _mean(found: list[ViewFactors], history: tuple[Step, ...], seed: int) -> TrajectoryViewFactors:
    first = found[0]
    cells = np.array([each.block_shares for each in found])
    # frames have few rays each: without this, their noise would pass for a bed that renews itself
    by_rays = np.mean([each.covariance.diagonal() for each in found], axis=0)
    bed, structures = errors_of_mean(cells, by_rays)
    mean, error = history[-1].estimates, history[-1].errors
    return TrajectoryViewFactors(
        **by_target(mean, error, bed),
        edges=first.edges,
        window=first.window,
        rays=history[-1].rays,
        seconds=history[-1].seconds,
        setup_seconds=math.fsum(each.setup_seconds for each in found),
        seed=seed,
        left_out=LeftOut(
            spheres=sum(each.left_out.spheres for each in found),
            deep_rays=sum(each.left_out.deep_rays for each in found),
            reach=max(each.left_out.reach for each in found),
        ),
        history=history,
        covariance=np.sum([each.covariance for each in found], axis=0) / len(found) ** 2,
        block_shares=cells.mean(axis=0),
        frames=len(found),
        bed_covariance=_covariance(cells, bed),
        structures=structures,
    )


def _covariance(cells: FloatArray, errors: FloatArray) -> FloatArray:
    """Covariance of means with these errors, correlated as the cells are."""
    deviations = cells.reshape(-1, cells.shape[-1]) - cells.mean(axis=(0, 1))
    products = deviations.T @ deviations
    scale = np.sqrt(products.diagonal())
    # a share that never differs has no correlation, and no error either
    scale = np.where(scale > 0.0, scale, 1.0)
    return np.asarray(products / np.outer(scale, scale) * np.outer(errors, errors))
