"""A measured value with its standard error, and how errors propagate (Watkins 2018, eq. 51-52)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = ["LEVEL", "Measured", "as_measured", "combined", "coverage_factor", "propagated"]

LEVEL = 0.95
"""Confidence level of the intervals that Watkins (2018) reports."""


def coverage_factor(degrees_of_freedom: ArrayLike = np.inf, level: float = LEVEL) -> FloatArray:
    """Half width of a confidence interval over the standard error, by Student's t distribution.

    Parameters
    ----------
    degrees_of_freedom : float or array
        Of the standard error; infinite if it is known and not estimated from a few residuals.
    level : float
        Confidence level, between 0 and 1.

    Returns
    -------
    float or array
        1.96 for infinitely many degrees of freedom at 0.95.

    Raises
    ------
    ValueError
        If the degrees of freedom are not positive, or the level is not between 0 and 1.
    """
    dof = positive("degrees_of_freedom", degrees_of_freedom, infinite=True)
    if not 0.0 < level < 1.0:
        raise ValueError(f"level is {level:g}; expected a number between 0 and 1")
    normal = special.ndtri(0.5 + 0.5 * level)
    # the function of SciPy wants finite numbers; from 1e10 on there is no difference
    student = special.stdtrit(np.minimum(dof, 1e10), 0.5 + 0.5 * level)
    return plain(np.where(dof > 1e10, normal, student))


@dataclass(frozen=True, eq=False)
class Measured:
    """A value and its standard error.

    Parameters
    ----------
    value : float or array
        The value, in SI units.
    error : float or array
        Its standard error, in the same unit; 0 for what is exact.
    degrees_of_freedom : float or array
        Of the standard error, infinite if it is known.

    Raises
    ------
    ValueError
        If an error is negative or not finite.
    """

    value: FloatArray
    error: FloatArray
    degrees_of_freedom: FloatArray

    def __init__(self, value: ArrayLike, error: ArrayLike = 0.0, degrees_of_freedom: ArrayLike = np.inf) -> None:
        values = np.asarray(value, dtype=np.float64)
        errors, dof = non_negative("error", error), positive("degrees_of_freedom", degrees_of_freedom, infinite=True)
        value_, error_, dof_ = (plain(x) for x in np.broadcast_arrays(values, errors, dof))
        object.__setattr__(self, "value", value_)
        object.__setattr__(self, "error", error_)
        object.__setattr__(self, "degrees_of_freedom", dof_)

    @property
    def relative_error(self) -> FloatArray:
        """S = sigma/|value| (Watkins 2018, eq. 51); infinite at zero, unless the error is zero too."""
        size = np.abs(self.value)
        empty = np.where(np.asarray(self.error) > 0.0, np.inf, 0.0)
        return plain(np.divide(self.error, size, out=empty, where=np.asarray(size > 0.0)))

    def half_width(self, level: float = LEVEL) -> FloatArray:
        """Half width of the confidence interval, by default of 95 % as in the source."""
        return plain(coverage_factor(self.degrees_of_freedom, level) * self.error)

    def __str__(self) -> str:
        rows = zip(np.ravel(self.value), np.ravel(self.half_width()), np.ravel(self.relative_error), strict=True)
        return "\n".join(f"{v:.6g} ± {w:.2g} (95 %; standard error {100 * s:.2g} %)" for v, w, s in rows)


def as_measured(name: str, given: ArrayLike | Measured, unit: str, *, sign: bool = False) -> Measured:
    """A number, taken as exact, or a value with error; refused unless positive, or finite where it has a `sign`."""
    found = given if isinstance(given, Measured) else Measured(given)
    if sign:
        values = np.asarray(found.value)
        if not np.all(np.isfinite(values)):
            raise ValueError(f"{name} is {float(values[~np.isfinite(values)].flat[0]):g} {unit}; expected a number")
    else:
        positive(name, found.value, unit)
    return found


def combined(value: ArrayLike, terms: Sequence[tuple[ArrayLike, Measured]]) -> Measured:
    """A result of independent measured inputs (Watkins 2018, eq. 52).

    Parameters
    ----------
    value : float or array
        The result.
    terms : sequence of (float or array, Measured)
        For each input, the derivative of the result to it, and the input.

    Returns
    -------
    Measured
        With the degrees of freedom of Welch and Satterthwaite.
    """
    parts = [np.abs(np.asarray(slope) * given.error) for slope, given in terms]
    shape = np.broadcast_shapes(np.shape(value), *(part.shape for part in parts))
    # the largest first, so that no square overflows or vanishes
    largest = np.max([np.broadcast_to(part, shape) for part in parts], axis=0)
    scale = np.where(largest > 0.0, largest, 1.0)
    error = scale * np.sqrt(sum((part / scale) ** 2 for part in parts))
    weight = np.where(error > 0.0, error, 1.0)
    spread = sum((part / weight) ** 4 / given.degrees_of_freedom for part, (_, given) in zip(parts, terms, strict=True))
    dof = np.divide(1.0, spread, out=np.full(shape, np.inf), where=np.broadcast_to(np.asarray(spread) > 0.0, shape))
    return Measured(value, error, dof)


def propagated(function: Callable[..., ArrayLike], *inputs: ArrayLike | Measured) -> Measured:
    """A function of independent measured inputs, its derivatives by central differences (Watkins 2018, eq. 52).

    Parameters
    ----------
    function : callable
        Takes as many arrays as there are inputs, and broadcasts.
    *inputs : float, array or Measured
        The inputs; numbers are exact.

    Returns
    -------
    Measured
        The result to first order in the errors.

    Raises
    ------
    ValueError
        If an input or its error is not finite.
    """
    given = [as_measured(f"input {number}", x, "", sign=True) for number, x in enumerate(inputs, start=1)]
    values = [np.asarray(x.value) for x in given]
    terms: list[tuple[ArrayLike, Measured]] = []
    for place, x in enumerate(given):
        step = np.where(np.asarray(x.error) > 0.0, 1e-2 * np.asarray(x.error), 1.0)
        ends = [function(*(v + sign * step if k == place else v for k, v in enumerate(values))) for sign in (1.0, -1.0)]
        terms.append(((np.asarray(ends[0]) - np.asarray(ends[1])) / (2.0 * step) * (x.error > 0.0), x))
    return combined(function(*values), terms)
