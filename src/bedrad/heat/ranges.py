"""Checks that every model shares: refuse what has no meaning, warn where a fit is left behind."""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "FloatArray",
    "RangeWarning",
    "finite",
    "non_negative",
    "plain",
    "positive",
    "quiet",
    "warn",
    "warn_outside",
    "within",
]

FloatArray = NDArray[np.float64]


class RangeWarning(UserWarning):
    """A correlation is used outside the range it was fitted in; the result is an extrapolation."""


def plain(values: ArrayLike) -> FloatArray:
    """Return a number for numbers and an array for arrays, as the caller gave the inputs."""
    result: FloatArray = np.asarray(values, dtype=np.float64)[()]
    return result


def _refuse(name: str, values: FloatArray, good: NDArray[np.bool_], unit: str, expected: str) -> None:
    if np.all(good):
        return
    bad = np.atleast_1d(values)[~np.atleast_1d(good)]
    more = f" ({bad.size} such values)" if bad.size > 1 else ""
    raise ValueError(f"{name} is {float(bad[0]):g}{' ' + unit if unit else ''}{more}; expected {expected}")


def positive(name: str, values: ArrayLike, unit: str = "", *, infinite: bool = False) -> FloatArray:
    """`values` as floats, refused unless all are positive (and finite, unless `infinite`)."""
    x = np.asarray(values, dtype=np.float64)
    good = (x > 0.0) & (np.isfinite(x) | infinite)
    _refuse(name, x, good, unit, "a positive number" if infinite else "a positive, finite number")
    return x


def finite(name: str, values: ArrayLike, unit: str = "") -> FloatArray:
    """`values` as floats, refused unless all are finite."""
    x = np.asarray(values, dtype=np.float64)
    _refuse(name, x, np.isfinite(x), unit, "a finite number")
    return x


def non_negative(name: str, values: ArrayLike, unit: str = "") -> FloatArray:
    """`values` as floats, refused unless all are finite and none is negative."""
    x = np.asarray(values, dtype=np.float64)
    _refuse(name, x, np.isfinite(x) & (x >= 0.0), unit, "a finite number that is not negative")
    return x


def within(
    name: str, values: ArrayLike, low: float, high: float, unit: str = "", *, open_above: bool = False
) -> FloatArray:
    """`values` as floats, refused unless all lie in [low, high], or in [low, high) if `open_above`."""
    x = np.asarray(values, dtype=np.float64)
    good = (x >= low) & ((x < high) if open_above else (x <= high))
    limit = f"less than {high:g}" if open_above else f"at most {high:g}"
    _refuse(name, x, good, unit, f"at least {low:g} and {limit}")
    return x


_silent: ContextVar[bool] = ContextVar("silent", default=False)


@contextmanager
def quiet() -> Iterator[None]:
    """Issue no `RangeWarning` inside the block, for values that are tried on the way to an answer.

    Unlike `warnings.catch_warnings` it works in threads and leaves alone which warnings Python has shown.
    """
    token = _silent.set(True)
    try:
        yield
    finally:
        _silent.reset(token)


def warn(message: str) -> None:
    """Issue a `RangeWarning` that points at the first line outside `bedrad.heat`; none inside `quiet`."""
    if _silent.get():
        return
    level, frame = 1, sys._getframe(0)
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).startswith("bedrad.heat"):
        level, frame = level + 1, frame.f_back
    warnings.warn(message, RangeWarning, stacklevel=level)


def warn_outside(what: str, values: ArrayLike, low: float, high: float, unit: str = "") -> None:
    """Warn once if any value lies outside the fitted range [low, high] (rounding forgiven).

    Parameters
    ----------
    what : str
        What was fitted and over what, e.g. "packing_fraction (Watkins 2018, eq. 38): diameter_ratio".
    values : array_like
        The values used.
    low, high : float
        The fitted range; infinite where it has no end.
    unit : str
        Unit of the range, may be empty.
    """
    x = np.asarray(values, dtype=np.float64)
    slack = 1e-9 * max((abs(limit) for limit in (low, high) if math.isfinite(limit)), default=0.0)
    outside = (x < low - slack) | (x > high + slack)
    if not np.any(outside):
        return
    first = float(np.atleast_1d(x)[np.atleast_1d(outside)][0])
    suffix = f" {unit}" if unit else ""
    limits = f"{low:g} to {high:g}" if math.isfinite(high) else f"from {low:g}"
    warn(f"{what} is {first:g}{suffix}, outside the fitted range {limits}{suffix}: an extrapolation")
