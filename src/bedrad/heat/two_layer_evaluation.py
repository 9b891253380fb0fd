"""Wall less mean temperature of the two-layer model for any z*, and how it was found.

The series (Watkins 2018, eq. 73) where few terms do, the inverted transform elsewhere. Both are exact solutions, so the
place of the switch is a matter of cost alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.heat.ranges import FloatArray, non_negative, within
from bedrad.heat.two_layer_modes import Layers, Modes, count_below, find_modes, layers
from bedrad.heat.two_layer_transform import CONTOUR_ERROR, wall_excess

__all__ = [
    "MOST_TERMS",
    "Excess",
    "IntArray",
    "allowed",
    "batches",
    "decays_of",
    "distances",
    "excess",
    "fewest",
    "flattened",
    "left_after",
    "modes_of",
    "terms_needed",
    "truncated",
]

IntArray = NDArray[np.int64]

MOST_TERMS = 32
"""The series is used up to this many terms; beyond them the transform costs less."""

_BATCHES = (2, 8, MOST_TERMS)

_BLOCK = 1 << 18
"""Modes found at once, which bounds the memory of large arrays."""

_NEAREST = 1e-290

_SHORTFALL = math.log(1e3)
"""Allows for a wall less mean temperature far below the developed one; what is left is checked after the sum."""


@dataclass(frozen=True, eq=False)
class Excess:
    """Wall less mean temperature over q R/k_b of n flows.

    Parameters
    ----------
    value : (n,) array
        Wall less mean temperature.
    missing : (n,) array
        The developed value less this one, summed by itself and so without loss of digits far downstream.
    terms : (n,) array of int
        Terms of the series that were added; 0 where none was needed, or where the transform was inverted instead.
    bound : (n,) array
        Bound of the relative error of `value`: what the terms left out can add, or that of the inversion.
    """

    value: FloatArray
    missing: FloatArray
    terms: IntArray
    bound: FloatArray


def distances(z_star: ArrayLike, *, infinite: bool = False) -> FloatArray:
    """Inverse Graetz numbers as floats: 0, or at least 1e-290 so that 1/z* is a number, to infinity if `infinite`."""
    z = np.asarray(z_star, dtype=np.float64)
    endless = np.isposinf(z) & infinite
    finite = non_negative("z_star", np.where(endless, 0.0, z))
    if np.any((finite > 0.0) & (finite < _NEAREST)):
        raise ValueError(f"z_star is {float(finite[finite > 0.0].min()):g}; expected 0 or at least {_NEAREST:g}")
    return np.asarray(np.where(endless, np.inf, finite))


def allowed(tolerance: float) -> float:
    """A tolerance, refused below what the inversion holds."""
    return float(within("tolerance", tolerance, CONTOUR_ERROR, 1e-2))


def flattened(A: FloatArray, kappa: FloatArray, *more: FloatArray) -> tuple[tuple[int, ...], Layers, list[FloatArray]]:
    """Broadcast shape, one pair of layers for each element, and the other arrays as long."""
    arrays = np.broadcast_arrays(A, kappa, *more)
    flat = [np.asarray(x.ravel(), dtype=np.float64) for x in arrays]
    return arrays[0].shape, layers(flat[0], flat[1]), flat[2:]


def terms_needed(pairs: Layers, t: FloatArray, tolerance: float, factor: FloatArray | float = 1.0) -> FloatArray:
    """How many terms hold exp(-mu^2 t) factor > tolerance, with a reserve, for n flows."""
    reach = np.sqrt((_SHORTFALL - math.log(tolerance) + np.log(factor)) / t)
    return np.asarray(count_below(pairs, reach) + 1.0)


def modes_of(pairs: Layers, number: int) -> Modes:
    """The first modes of n flows; each pair of layers among them is solved once."""
    unique, inverse = np.unique(np.stack([pairs.e, pairs.W, pairs.kappa]), axis=1, return_inverse=True)
    found, row = find_modes(Layers(unique[1], unique[0], unique[2]), number), np.asarray(inverse).ravel()
    return Modes(pairs, found.mu[row], found.weights[row], found.bulk[row])


def batches(pairs: Layers, needed: FloatArray) -> Iterator[tuple[IntArray, Modes]]:
    """Blocks of flows that need about as many terms, with their modes."""
    least = 0
    for most in _BATCHES:
        flows = np.flatnonzero((needed > least) & (needed <= most))
        least, at_once = most, max(1, _BLOCK // (most + 1))
        for start in range(0, flows.size, at_once):
            which = flows[start : start + at_once]
            yield which, modes_of(pairs.take(which), most + 1)


def decays_of(modes: Modes, t: FloatArray) -> FloatArray:
    """exp(-mu^2 t), from 1e-260 on without a difference to the sums, so that nothing underflows."""
    return np.asarray(np.exp(-np.minimum(modes.mu**2 * t[:, None], 600.0)))


def left_after(modes: Modes, decays: FloatArray) -> FloatArray:
    """Bounds (n, m) of what the series leaves out after 0 to m - 1 terms.

    All weights are positive and add up to a known sum, and exp(-mu^2 t) falls with the mode: what is left out is at
    most the decay of the first mode left out times the weight of all of them.
    """
    developed = modes.layers.resistance[:, None]
    kept = np.concatenate([np.zeros_like(developed), np.cumsum(modes.weights, axis=1)[:, :-1]], axis=1)
    return np.asarray(np.maximum(developed - kept, 0.0) * decays)


def fewest(left: FloatArray, allowed_rest: FloatArray) -> IntArray:
    """The fewest terms (n,) whose rest is allowed; as many as there are bounds for where none is."""
    good = left <= allowed_rest[:, None]
    return np.asarray(np.where(good.any(axis=1), np.argmax(good, axis=1), left.shape[1] - 1), dtype=np.int64)


def truncated(modes: Modes, t: FloatArray, terms: IntArray) -> Excess:
    """The series with a given number of terms (n,), at least one mode fewer than there are."""
    decays, developed = decays_of(modes, t), modes.layers.resistance
    kept = np.arange(modes.mu.shape[1])[None, :] < terms[:, None]
    missing = np.sum(np.where(kept, modes.weights * decays, 0.0), axis=1)
    left = np.take_along_axis(left_after(modes, decays), terms[:, None], axis=1)[:, 0]
    value = developed - missing
    # the true value lies between value - left and value
    bound = np.divide(left, value - left, out=np.full_like(value, np.inf), where=value > left)
    return Excess(value, missing, terms, bound)


def _chosen(modes: Modes, t: FloatArray, tolerance: float) -> Excess:
    """The series with the fewest terms that hold the tolerance, or all modes but one."""
    decays = decays_of(modes, t)
    least = modes.layers.resistance - np.sum(modes.weights[:, :-1] * decays[:, :-1], axis=1)
    # a little less than the tolerance: the bound is relative to the least value that the rest allows
    return truncated(modes, t, fewest(left_after(modes, decays), 0.99 * tolerance * least))


def excess(pairs: Layers, t: FloatArray, tolerance: float) -> Excess:
    """Wall less mean temperature of n flows at times t = 4 z*, from 0 to infinity."""
    developed = pairs.resistance
    value, missing = np.zeros_like(developed), developed.copy()
    terms, bound = np.zeros(t.size, dtype=np.int64), np.zeros(t.size)
    value[np.isinf(t)], missing[np.isinf(t)] = developed[np.isinf(t)], 0.0
    between = np.flatnonzero(np.isfinite(t) & (t > 0.0))
    needed = terms_needed(pairs.take(between), t[between], tolerance)
    todo = np.ones(between.size, dtype=bool)
    for which, modes in batches(pairs.take(between), needed):
        found = _chosen(modes, t[between[which]], tolerance)
        good = found.bound <= tolerance
        done = between[which[good]]
        todo[which[good]] = False
        value[done], missing[done] = found.value[good], found.missing[good]
        terms[done], bound[done] = found.terms[good], found.bound[good]
    rest = between[todo]
    if rest.size:
        value[rest] = wall_excess(pairs.take(rest), t[rest])
        missing[rest] = developed[rest] - value[rest]
        bound[rest] = CONTOUR_ERROR
    return Excess(value, missing, terms, bound)
