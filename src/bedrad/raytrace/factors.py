"""`ViewFactors`: what a run of the ray tracer found, how sure it is and what it cost."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.walls import Window

__all__ = ["LeftOut", "Step", "ViewFactors", "by_target", "covariance_of_mean", "fold_leakage", "standard_error"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class LeftOut:
    """What the scene did not need.

    Parameters
    ----------
    spheres : int
        Spheres too deep for any of the traced rays; they were never put into a grid.
    deep_rays : int
        Rays of a tube that passed `reach` and were followed through the whole bed.
    reach : float
        Depth of the grid that all other rays were settled in. [m]
    """

    spheres: int
    deep_rays: int
    reach: float

    def __str__(self) -> str:
        parts = [f"{self.spheres:,} spheres that no ray reached"] if self.spheres else ["no spheres"]
        if self.deep_rays:
            parts.append(f"{self.deep_rays:,} rays followed through the whole bed")
        return "; ".join(parts)


@dataclass(frozen=True)
class Step:
    """Estimates after a round of rays: the layers, beyond, wall, escaped, and their standard errors."""

    rays: int
    seconds: float
    estimates: FloatArray
    errors: FloatArray

    @property
    def largest_error(self) -> float:
        """Largest of the standard errors."""
        return float(self.errors.max())


@dataclass(frozen=True)
class ViewFactors:
    """View factors from the wall; `layers`, `beyond`, `wall` and `escaped` sum to one.

    The standard errors ``<name>_error`` are those of the ray tracing, from the scatter within patches of the wall. The
    scatter of the bed itself, from block to block along the axis, is in ``<name>_bed_error``: how far another piece of
    the same bed would differ.

    Parameters
    ----------
    layers, layers_error, layers_bed_error : (layers,) arrays
        Share of the wall's radiation that first meets a sphere in each layer.
    wall, wall_error, wall_bed_error : float
        Share that meets the wall again.
    beyond, beyond_error, beyond_bed_error : float
        Share that passes the last layer.
    escaped, escaped_error, escaped_bed_error : float
        Share that leaves through open ends.
    edges : (layers + 1,) array
        Depths that part the layers. [m]
    window : Window
        The piece of wall that emits.
    rays : int
        Number of rays.
    seconds, setup_seconds : float
        Run time in all, and what of it went into the grid and, on first use, into compiling. [s]
    seed : int
        Seed of the rays.
    left_out : LeftOut
        What the scene did not need.
    history : tuple of Step
        Estimates, errors and run time after every round.
    covariance : (layers + 3, layers + 3) array
        Covariance of the shares by the ray tracing: the layers, beyond, wall, escaped.
    block_shares : (blocks, layers + 3) array
        The same of each axial block.
    normalisation : str
        "none", or the convention that `normalised` applied.
    """

    layers: FloatArray
    layers_error: FloatArray
    layers_bed_error: FloatArray
    wall: float
    wall_error: float
    wall_bed_error: float
    beyond: float
    beyond_error: float
    beyond_bed_error: float
    escaped: float
    escaped_error: float
    escaped_bed_error: float
    edges: FloatArray
    window: Window
    rays: int
    seconds: float
    setup_seconds: float
    seed: int
    left_out: LeftOut
    history: tuple[Step, ...]
    covariance: FloatArray
    block_shares: FloatArray
    normalisation: str = "none"

    @classmethod
    def from_sample(
        cls,
        counts: IntArray,
        covariance: FloatArray,
        *,
        edges: FloatArray,
        window: Window,
        history: tuple[Step, ...],
        seconds: float,
        setup_seconds: float,
        seed: int,
        left_out: LeftOut,
    ) -> ViewFactors:
        """Shares and standard errors from counts of rays, (blocks, layers + 3), and the shares' covariance."""
        in_block = counts.sum(axis=1, keepdims=True)
        filled = in_block[:, 0] > 0
        block_shares = counts[filled] / in_block[filled]
        bed = standard_error(block_shares)
        mean, error = counts.sum(axis=0) / counts.sum(), np.sqrt(np.diag(covariance))
        return cls(
            **by_target(mean, error, bed),
            edges=edges,
            window=window,
            rays=int(counts.sum()),
            seconds=seconds,
            setup_seconds=setup_seconds,
            seed=seed,
            left_out=left_out,
            history=history,
            covariance=covariance,
            block_shares=block_shares,
        )

    def covariance_of_bed(self) -> FloatArray:
        """Covariance of the shares by the scatter of the bed, (layers + 3, layers + 3); nan with a single block."""
        return covariance_of_mean(self.block_shares)

    def normalised(self, convention: str) -> ViewFactors:
        """The same result in another convention.

        Parameters
        ----------
        convention : str
            "watkins": the layers alone sum to one; what went back to the wall, beyond the last layer or out at the ends
            is spread over them in proportion (Watkins 2018, section 5.3: leakage folded into the primary factors).

        Raises
        ------
        ValueError
            If the convention is not known, or no ray met a layer.
        """
        if convention != "watkins":
            raise ValueError(f"convention is {convention!r}; expected 'watkins'")
        count = len(self.layers)
        mean = self.history[-1].estimates
        ratio, error = fold_leakage(mean, self.covariance, count)
        _, bed_error = fold_leakage(mean, self.covariance_of_bed(), count)
        return replace(
            self,
            layers=ratio,
            layers_error=error,
            layers_bed_error=bed_error,
            beyond=0.0,
            beyond_error=0.0,
            beyond_bed_error=0.0,
            wall=0.0,
            wall_error=0.0,
            wall_bed_error=0.0,
            escaped=0.0,
            escaped_error=0.0,
            escaped_bed_error=0.0,
            normalisation=convention,
        )

    def __str__(self) -> str:
        rows = [(f"layer {k + 1}", f, e, b) for k, (f, e, b) in enumerate(
            zip(self.layers, self.layers_error, self.layers_bed_error, strict=True))]  # fmt: skip
        rows += [(n, getattr(self, n), getattr(self, f"{n}_error"), getattr(self, f"{n}_bed_error"))
                 for n in ("beyond", "wall", "escaped")]  # fmt: skip
        lines = [f"{'from the wall to':<18}{'view factor':>14}{'± rays':>12}{'± bed':>12}"]
        for name, f, e, b in rows:
            # no hit is not no error: with 95 % confidence the share is below three over the number of rays
            rays = f"< {3 / self.rays:.0e}" if f == 0.0 and self.normalisation == "none" else f"{e:.1e}"
            lines.append(f"{name:<18}{f:>14.6f}{rays:>12}{b:>12.1e}")
        rate = self.rays / max(self.seconds - self.setup_seconds, 1e-9)
        lines.append(f"{self.rays:,} rays in {self.seconds:.2f} s ({rate / 1e6:.1f} million a second)")
        lines.append(f"left out: {self.left_out}")
        return "\n".join(lines)


def standard_error(samples: FloatArray) -> FloatArray:
    """Standard error of the mean of independent samples along the first axis; nan where there is only one."""
    if len(samples) < 2:
        return np.full(samples.shape[1], np.nan)
    return np.asarray(samples.std(axis=0, ddof=1) / np.sqrt(len(samples)))


def by_target(mean: FloatArray, error: FloatArray, bed: FloatArray) -> dict[str, Any]:
    """Fields of `ViewFactors` from (layers + 3,) arrays of shares, their errors by rays, and by the bed."""
    n = len(mean) - 3
    found: dict[str, Any] = {}
    for ending, values in (("", mean), ("_error", error), ("_bed_error", bed)):
        found[f"layers{ending}"] = values[:n]
        found |= {f"{name}{ending}": float(values[n + k]) for k, name in enumerate(("beyond", "wall", "escaped"))}
    return found


def covariance_of_mean(samples: FloatArray) -> FloatArray:
    """Covariance of the mean of independent samples along the first axis; nan where there is only one."""
    count, names = samples.shape
    if count < 2:
        return np.full((names, names), np.nan)
    deviation = samples - samples.mean(axis=0)
    return np.asarray(deviation.T @ deviation / (count * (count - 1)))


def fold_leakage(shares: FloatArray, covariance: FloatArray, layers: int) -> tuple[FloatArray, FloatArray]:
    """Make the layers alone sum to one, the rest spread over them in proportion.

    Parameters
    ----------
    shares : (layers + 3,) array
        The layers, beyond, wall, escaped.
    covariance : (layers + 3, layers + 3) array
        Their covariance.
    layers : int
        Number of layers.

    Returns
    -------
    ratio : (layers,) array
        Share of each layer in what met a layer.
    error : (layers,) array
        Its standard error, linearised.

    Raises
    ------
    ValueError
        If no ray met a layer.
    """
    met = float(shares[:layers].sum())
    if met == 0.0:
        raise ValueError("no ray met a layer; the view factors cannot be made to sum to one over the layers")
    ratio = shares[:layers] / met
    slopes = (np.eye(layers) - ratio[:, None]) / met
    variance = (slopes @ covariance[:layers, :layers] @ slopes.T).diagonal()
    return ratio, np.sqrt(np.maximum(variance, 0.0))
