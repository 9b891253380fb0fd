"""What a measured engine is: its error against its run time, and how long it takes to an error that is wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.raytrace.convergence import fitted_exponents

__all__ = ["EngineRuns", "Reference", "power_law"]

FloatArray = NDArray[np.float64]

CLEARLY = 3.0
"""Standard errors by which the true noise must exceed the stated one before an engine counts as understating it."""

EXPECTED_EXPONENT = -0.5
"""Power of the number of rays by which the error falls, where too few runs say."""


@dataclass(frozen=True)
class Reference:
    """An independent, longer run to hold the others against.

    Parameters
    ----------
    estimates, errors : (names,) arrays
        Shares of the layers, beyond, wall, escaped, and their standard errors.
    rays : int
        Number of rays.
    seconds : float
        What it took, on all threads. [s]
    """

    estimates: FloatArray
    errors: FloatArray
    rays: int
    seconds: float


@dataclass(frozen=True)
class EngineRuns:
    """Error of one engine against its run time.

    The columns of the two-dimensional arrays are the layers, beyond, wall, escaped.

    Parameters
    ----------
    name, family : str
        The engine, and what it is a variant of.
    details : str
        What was chosen for it, such as the scaling of its meshes.
    facets : bool
        Whether it traces facets in place of spheres.
    setup_seconds : float
        Processor time before the first ray. [s]
    rays : (m,) array
        Number of rays of each run.
    seconds : (m,) array
        Processor time of each run without set-up, median over the seeds. [s]
    true_error : (m, names) array
        Root mean square distance to the reference, over the seeds.
    noise : (m, names) array
        The same to the reference shifted by the facet bias: what more rays would remove. Over n seeds it is known to
        one part in the root of 2 n.
    stated_error : (m, names) array
        Standard error that the runs state, from the scatter within each, root mean square over the seeds: what `noise`
        should be, and much better known.
    bias, bias_error : (names,) arrays
        Facet bias and its standard error, from the same rays through the facets and the exact spheres; zero for
        engines that trace spheres.
    exponent, exponent_error : (names,) arrays
        Slope of log(noise) against log(rays), by least squares, and its standard error.
    stated_exponent, stated_exponent_error : (names,) arrays
        The same of the stated error.
    law_level, law_exponent : (names,) arrays
        The stated error follows level * rays**exponent; see `power_law`.
    seeds : int
        Number of repetitions.
    """

    name: str
    family: str
    details: str
    facets: bool
    setup_seconds: float
    rays: NDArray[np.int64]
    seconds: FloatArray
    true_error: FloatArray
    noise: FloatArray
    stated_error: FloatArray
    bias: FloatArray
    bias_error: FloatArray
    exponent: FloatArray
    exponent_error: FloatArray
    stated_exponent: FloatArray
    stated_exponent_error: FloatArray
    law_level: FloatArray
    law_exponent: FloatArray
    seeds: int

    @property
    def rate(self) -> float:
        """Rays in a second of processor time, in the longest run. [1/s]"""
        return float(self.rays[-1] / self.seconds[-1])

    def least_error(self, target: int = 0) -> float:
        """Error that no number of rays removes: the facet bias, less what its own standard error adds on average."""
        return math.sqrt(max(0.0, float(self.bias[target] ** 2 - self.bias_error[target] ** 2)))

    def error_after(self, seconds: float, target: int = 0) -> float:
        """Bias and noise together after a run time, by the power law fitted to the stated error.

        Parameters
        ----------
        seconds : float
            Processor time without set-up. [s]
        target : int
            Column: 0 for the first layer.
        """
        noise = self._level(target) * self._rays_in(seconds) ** float(self.law_exponent[target])
        return math.hypot(self.least_error(target), noise)

    def seconds_to(self, error: float, target: int = 0) -> float:
        """Run time until bias and noise together are down to an error; infinite where the bias alone exceeds it.

        Parameters
        ----------
        error : float
            The error wanted.
        target : int
            Column: 0 for the first layer.

        Returns
        -------
        float
            Processor time without set-up; at least that of the shortest run. [s]
        """
        floor = self.least_error(target)
        if floor >= error:
            return math.inf
        level = self._level(target)
        if level == 0.0:
            return float(self.seconds[0])
        rays = (math.sqrt(error**2 - floor**2) / level) ** (1.0 / float(self.law_exponent[target]))
        return self._seconds_for(rays)

    def calibration(self, target: int = 0) -> tuple[float, float]:
        """True over stated noise, root mean square over the runs, and a standard error that is rather too large.

        Nan where nothing was stated.
        """
        stated = self.stated_error[:, target]
        if not (stated > 0.0).all():
            return math.nan, math.nan
        ratio = float(np.sqrt(np.mean((self.noise[:, target] / stated) ** 2)))
        # longer runs hold the rays of shorter ones, so that all together may say no more than one of them
        return ratio, ratio / math.sqrt(2 * self.seeds)

    def _rays_in(self, seconds: float) -> float:
        """Number of rays after a run time, between the measured runs, and beyond the longest at its rate."""
        # short runs are not in proportion: drawing and calling cost something too
        clock = np.maximum.accumulate(self.seconds)
        beyond = max(1.0, seconds / float(clock[-1]))
        return beyond * math.exp(float(np.interp(math.log(seconds), np.log(clock), np.log(self.rays))))

    def _seconds_for(self, rays: float) -> float:
        """Run time for a number of rays: the reverse of `_rays_in`."""
        beyond = max(1.0, rays / float(self.rays[-1]))
        clock = np.maximum.accumulate(self.seconds)
        return beyond * math.exp(float(np.interp(math.log(rays), np.log(self.rays), np.log(clock))))

    def true_error_scatter(self, target: int = 0) -> FloatArray:
        """Standard errors of the true errors, from the number of seeds and normal noise about the bias. (m,)"""
        noise, true = self.noise[:, target], self.true_error[:, target]
        spread = np.sqrt((noise**4 / 2 + (self.bias[target] * noise) ** 2) / self.seeds)
        return np.asarray(np.divide(spread, true, out=np.zeros_like(true), where=true > 0.0))

    def _level(self, target: int) -> float:
        """Noise of a single ray by the power law; an engine that clearly understates its noise is taken by the true."""
        ratio, _ = self.calibration(target)
        understated = ratio > 1.0 + CLEARLY / math.sqrt(2 * self.seeds)
        return float(self.law_level[target]) * (ratio if understated else 1.0)


def power_law(
    rays: NDArray[np.int64], stated_error: FloatArray, like: EngineRuns | None = None
) -> tuple[FloatArray, FloatArray]:
    """Level and exponent of the power law that each column of the stated errors follows.

    Parameters
    ----------
    rays : (m,) array
        Number of rays of each run.
    stated_error : (m, names) array
        Standard errors.
    like : EngineRuns, optional
        An engine that traced the same rays and more of them: then its law, with the mean ratio of the errors.

    Returns
    -------
    level, exponent : (names,) arrays
        The level is zero where no error was stated.
    """
    if like is not None and len(like.rays) >= len(rays) and (like.rays[: len(rays)] == rays).all():
        ours, theirs = stated_error, like.stated_error[: len(rays)]
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.exp(np.log(ours / theirs).mean(axis=0))
        sure = np.isfinite(ratio) & (ratio > 0.0)
    else:
        ratio, sure = np.ones(stated_error.shape[1]), np.zeros(stated_error.shape[1], bool)
    exponent, _ = fitted_exponents(rays, stated_error)
    fitted = np.isfinite(exponent) & (exponent < 0.0)
    exponent[~fitted] = EXPECTED_EXPONENT
    # through the mean of the logarithms, or through the last error where there is no fit
    with np.errstate(divide="ignore"):
        logs = np.where(fitted, np.log(stated_error).mean(axis=0) - exponent * np.log(rays).mean(),
                        np.log(stated_error[-1]) - exponent * math.log(rays[-1]))  # fmt: skip
    level = np.exp(logs)
    if like is not None:
        level = np.where(sure, ratio * like.law_level, level)
        exponent = np.where(sure, like.law_exponent, exponent)
    return level, exponent
