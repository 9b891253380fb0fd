"""Uncertainty of a reduced measurement by sensitivities, to first order (Kline and McClintock 1953)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from bedrad.heat.ranges import FloatArray, non_negative

__all__ = ["SensitivityBudget", "budget_from_sensitivities", "sensitivity_budget"]

_STEP = 1e-3
"""Largest step of the differences over the value; their error goes with its fourth power."""

_SMALLEST_STEP = 1e-6
"""Smallest step over the value; below it rounding would show."""


@dataclass(frozen=True, eq=False)
class SensitivityBudget:
    """Which measured input makes how much of a result's uncertainty (Nguyen 2015, Tables 7 and 11).

    Parameters
    ----------
    names : tuple of str
        The n inputs.
    uncertainties : (n,) array
        U_xi, each in the unit of its input.
    sensitivities : (n,) array
        Derivatives of the result by the inputs.
    result : float
        The result itself; NaN where only sensitivities are known.
    """

    names: tuple[str, ...]
    uncertainties: FloatArray
    sensitivities: FloatArray
    result: float

    @property
    def variances(self) -> FloatArray:
        """(n,) array: U_i^2, the squares of sensitivity times uncertainty."""
        return np.asarray(np.square(self.sensitivities * self.uncertainties))

    @property
    def uncertainty(self) -> float:
        """U_B, the root of the sum of the squares."""
        return math.sqrt(float(np.sum(self.variances)))

    @property
    def shares(self) -> FloatArray:
        """(n,) array: part of the sum that each input makes; 0 where nothing is uncertain."""
        total = float(np.sum(self.variances))
        return np.asarray(self.variances / total) if total > 0.0 else np.zeros_like(self.variances)

    def __str__(self) -> str:
        lines = [f"{self.result:.6g} +- {self.uncertainty:.3g}"]
        lines.append(f"{'input':<28}{'U':>12}{'sensitivity':>14}{'U_i^2':>12}{'share':>9}")
        lines.extend(
            f"{self.names[i]:<28}{self.uncertainties[i]:>12.4g}{self.sensitivities[i]:>14.5g}"
            f"{self.variances[i]:>12.3g}{100.0 * self.shares[i]:>8.2f}%"
            for i in np.argsort(-self.variances, kind="stable")
        )
        return "\n".join(lines)


def budget_from_sensitivities(
    sensitivities: Mapping[str, float], uncertainties: Mapping[str, float], result: float = math.nan
) -> SensitivityBudget:
    """Make a budget of sensitivities that are known.

    Parameters
    ----------
    sensitivities : mapping
        Derivative of the result by each input.
    uncertainties : mapping
        Uncertainty of each input, in its unit.
    result : float
        The result, for the record.

    Returns
    -------
    SensitivityBudget
        In the order of `sensitivities`.

    Raises
    ------
    ValueError
        If the names differ, a sensitivity is not finite, or an uncertainty is negative.
    """
    if set(sensitivities) != set(uncertainties):
        odd = sorted(set(sensitivities) ^ set(uncertainties))
        raise ValueError(f"uncertainties are given for other inputs than sensitivities: {', '.join(odd)}")
    slopes = np.array([float(value) for value in sensitivities.values()])
    if not np.all(np.isfinite(slopes)):
        name = tuple(sensitivities)[int(np.argmin(np.isfinite(slopes)))]
        raise ValueError(f"the sensitivity to {name} is {sensitivities[name]}; expected a finite number")
    errors = np.array([float(non_negative(f"uncertainty of {name}", uncertainties[name])) for name in sensitivities])
    return SensitivityBudget(tuple(sensitivities), errors, slopes, float(result))


def sensitivity_budget(
    function: Callable[..., float], inputs: Mapping[str, float], uncertainties: Mapping[str, float]
) -> SensitivityBudget:
    """Find the sensitivities of a result and what the uncertainties of its inputs make of it.

    The derivatives are central differences of the fourth order. Their step is the uncertainty of the input, between a
    millionth and a thousandth of its value.

    Parameters
    ----------
    function : callable
        Takes the inputs by name and returns the result, a number.
    inputs : mapping
        Values of the inputs.
    uncertainties : mapping
        Uncertainties of the inputs that have one, in the unit of each.

    Returns
    -------
    SensitivityBudget
        Of the inputs with an uncertainty.

    Raises
    ------
    ValueError
        If an uncertainty names no input or is negative, or the function is not finite about the inputs.
    """
    for name in uncertainties:
        if name not in inputs:
            raise ValueError(f"uncertainties has {name!r}; expected some of {', '.join(inputs)}")
    sensitivities = {}
    for name in uncertainties:
        error = float(non_negative(f"uncertainty of {name}", uncertainties[name]))
        size = abs(float(inputs[name]))
        step = min(max(error, _SMALLEST_STEP * size), _STEP * size) if size > 0.0 else error or _SMALLEST_STEP
        sensitivities[name] = _derivative(function, inputs, name, step)
    return budget_from_sensitivities(sensitivities, uncertainties, float(function(**inputs)))


def _derivative(function: Callable[..., float], inputs: Mapping[str, float], name: str, step: float) -> float:
    """Central difference of the fourth order."""

    def difference(width: float) -> float:
        above, below = inputs[name] + width, inputs[name] - width
        # over the distance of the two numbers as they are rounded
        rise = float(function(**{**inputs, name: above})) - float(function(**{**inputs, name: below}))
        return rise / (above - below)

    return (4.0 * difference(step) - difference(2.0 * step)) / 3.0
