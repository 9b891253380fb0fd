"""Error of the view factors against run time, measured on the user's own bed.

The error is the distance to an independent, longer run with another seed; what the runs state about themselves is kept
beside it, so that the two can be compared.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.packings.packing import Packing
from bedrad.raytrace.factors import ViewFactors
from bedrad.raytrace.view_factors import view_factors
from bedrad.walls import Window

__all__ = ["Convergence", "convergence", "fitted_exponents", "shares_and_errors"]

FloatArray = NDArray[np.float64]

FEWEST_RAYS = 2**13
"""Rays of the shortest run."""


@dataclass(frozen=True)
class Convergence:
    """Error of the view factors against rays and run time.

    Parameters
    ----------
    names : tuple of str
        What the columns of the arrays below stand for: the layers, beyond, wall, escaped.
    rays : (m,) array
        Number of rays of each run.
    seconds : (m,) array
        Run time, median over the seeds, without the set-up of the grid. [s]
    true_error : (m, names) array
        Root mean square distance to the reference, over the seeds.
    stated_error : (m, names) array
        Standard error that the runs state, root mean square over the seeds.
    exponent, exponent_error : (names,) arrays
        Slope of log(true_error) against log(rays), by least squares, and its standard error; nan where a share was
        never met. Plain Monte Carlo has -0.5.
    reference, reference_error : (names,) arrays
        The independent run and its standard errors.
    reference_rays : int
        Its number of rays.
    setup_seconds : float
        Time to build the grid. [s]
    seeds : int
        Number of repetitions behind each error.
    total_seconds : float
        Time of the whole study. [s]
    """

    names: tuple[str, ...]
    rays: NDArray[np.int64]
    seconds: FloatArray
    true_error: FloatArray
    stated_error: FloatArray
    exponent: FloatArray
    exponent_error: FloatArray
    reference: FloatArray
    reference_error: FloatArray
    reference_rays: int
    setup_seconds: float
    seeds: int
    total_seconds: float


def convergence(
    packing: Packing,
    edges: ArrayLike | None = None,
    rays: int = 2**20,
    reference_rays: int = 2**25,
    *,
    seeds: int = 8,
    seed: int = 0,
    window: Window | None = None,
    threads: int | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> Convergence:
    """Measure the error of the view factors against run time.

    Parameters
    ----------
    packing : Packing
        The bed.
    edges : (layers + 1,) array, optional
        Depths that part the layers. [m]
    rays : int
        Number of rays of the longest run; the others have half, a quarter, and so on down to `FEWEST_RAYS`.
    reference_rays : int
        Number of rays of the independent reference.
    seeds : int
        Repetitions with other seeds, over which the error is averaged.
    seed : int
        First seed.
    window : Window, optional
        The piece of wall that emits.
    threads : int, optional
        Number of threads.
    progress : callable, optional
        Called with the share done and a text.

    Raises
    ------
    ValueError
        If the reference is not at least 16 times as long as the longest run, so that its own error would count.
    """
    if reference_rays < 16 * rays:
        raise ValueError(f"reference_rays is {reference_rays}; expected at least 16 times rays, {16 * rays}")
    if seeds < 2:
        raise ValueError(f"seeds is {seeds}; expected at least 2")
    begin = time.perf_counter()
    steps = [n for n in (rays >> k for k in range(64)) if n >= FEWEST_RAYS][::-1] or [rays]
    work = steps[0] + reference_rays + seeds * sum(steps)
    done = 0

    def report(text: str) -> None:
        if progress is not None:
            progress(done / work, text)

    def run(count: int, run_seed: int, text: str) -> ViewFactors:
        nonlocal done

        def within(share: float, _: str) -> None:
            if progress is not None:
                progress((done + share * count) / work, text)

        factors = view_factors(
            packing, edges, rays=count, seed=run_seed, window=window, threads=threads, progress=within
        )
        done += count
        report(text)
        return factors

    run(steps[0], seed, "compiling")
    reference = run(reference_rays, seed + seeds, "reference")
    mean, mean_error = shares_and_errors(reference)
    found = [[run(n, seed + s, f"{n:,} rays") for n in steps] for s in range(seeds)]
    seconds = np.array([[f.seconds - f.setup_seconds for f in runs] for runs in found])
    estimates = np.array([[shares_and_errors(f)[0] for f in runs] for runs in found])
    stated = np.array([[shares_and_errors(f)[1] for f in runs] for runs in found])
    true_error = np.sqrt(((estimates - mean) ** 2).mean(axis=0))
    exponent, exponent_error = fitted_exponents(np.array([f.rays for f in found[0]]), true_error)
    return Convergence(
        names=(*(f"layer {k + 1}" for k in range(len(reference.layers))), "beyond", "wall", "escaped"),
        rays=np.array([f.rays for f in found[0]]),
        seconds=np.median(seconds, axis=0),
        true_error=true_error,
        stated_error=np.sqrt((stated**2).mean(axis=0)),
        exponent=exponent,
        exponent_error=exponent_error,
        reference=mean,
        reference_error=mean_error,
        reference_rays=reference.rays,
        setup_seconds=reference.setup_seconds,
        seeds=seeds,
        total_seconds=time.perf_counter() - begin,
    )


def shares_and_errors(factors: ViewFactors) -> tuple[FloatArray, FloatArray]:
    """Estimates and standard errors in the order layers, beyond, wall, escaped."""
    return (
        np.array([*factors.layers, factors.beyond, factors.wall, factors.escaped]),
        np.array([*factors.layers_error, factors.beyond_error, factors.wall_error, factors.escaped_error]),
    )


def fitted_exponents(rays: NDArray[np.int64], error: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Slope of log(error) against log(rays) in each column, and its standard error; nan where an error is zero."""
    slopes, slope_errors = np.full(error.shape[1], np.nan), np.full(error.shape[1], np.nan)
    x = np.log(rays) - np.log(rays).mean()
    for k, column in enumerate(error.T):
        if len(rays) < 3 or not (column > 0).all():
            continue
        y = np.log(column)
        slopes[k] = (x * y).sum() / (x * x).sum()
        rest = y - y.mean() - slopes[k] * x
        slope_errors[k] = np.sqrt((rest**2).sum() / (len(x) - 2) / (x * x).sum())
    return slopes, slope_errors
