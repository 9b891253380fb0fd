"""Heat exchangers in general: log-mean temperature differences, effectiveness and transfer units, outlet with losses.

Every form is written so that its limits are exact: equal temperature differences at both ends, equal capacity
rates, a capacity ratio of zero. The relations are those of Kays and London (1984).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy import special
from scipy.optimize import elementwise

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, quiet, within

__all__ = [
    "Arrangement",
    "Outlet",
    "bracketed_root",
    "effectiveness",
    "log_mean_temperature_difference",
    "logarithmic_mean",
    "loss_conductance",
    "outlet_temperature",
    "transfer_units",
]

Arrangement = Literal["counter", "parallel", "cross", "cross_max_mixed", "cross_min_mixed"]

_MOST_UNITS = 1e4
"""Largest number of transfer units of the cross flow series, which needs a term for each."""

_DOUBLINGS = 64
"""Widenings of the interval in which the outlet temperature is looked for."""


def logarithmic_mean(first: ArrayLike, second: ArrayLike) -> FloatArray:
    """Logarithmic mean of two positive numbers, (a - b)/ln(a/b), and a where they are equal.

    Parameters
    ----------
    first, second : float or array
        The numbers a and b, in any unit.

    Returns
    -------
    float or array
        Between the geometric and the arithmetic mean, in their unit.

    Raises
    ------
    ValueError
        If a number is not positive.
    """
    a, b = np.broadcast_arrays(positive("first", first), positive("second", second))
    low, high = np.minimum(a, b), np.maximum(a, b)
    # the difference of close numbers is exact, and so is its logarithm by log1p; a ratio that underflows has
    # a logarithm so large that the difference of logarithms is good enough
    gap = np.asarray((high - low) / high)
    near = gap < 0.5
    ratio = np.asarray(low / high)
    far = np.where(ratio > 1e-300, -np.log(np.maximum(ratio, 1e-300)), np.log(high) - np.log(low))
    logarithm = np.where(near, -np.log1p(-np.where(near, gap, 0.0)), far)
    return plain(high * np.divide(gap, logarithm, out=np.ones_like(gap), where=logarithm > 0.0))


def log_mean_temperature_difference(
    hot_inlet: ArrayLike,
    hot_outlet: ArrayLike,
    cold_inlet: ArrayLike,
    cold_outlet: ArrayLike,
    arrangement: Literal["counter", "parallel"] = "counter",
) -> FloatArray:
    """Log-mean temperature difference of two streams (Nguyen 2015, eq. 5-2 and 6-2, its sum put right as a difference).

    Tubes with a known surface temperature along a stream that passes them are "parallel": the surface at the
    stream's inlet is the hot inlet, that at its outlet the hot outlet. In cross flow the difference of "counter"
    is multiplied by a factor below one; `effectiveness` needs none.

    Parameters
    ----------
    hot_inlet, hot_outlet, cold_inlet, cold_outlet : float or array
        Temperatures. [K]
    arrangement : {"counter", "parallel"}
        In counter flow the hot inlet faces the cold outlet, in parallel flow the cold inlet.

    Returns
    -------
    float or array
        Log-mean temperature difference. [K]

    Raises
    ------
    ValueError
        If a temperature is not positive, or the hot stream is not the hotter one at both ends.
    """
    if arrangement not in ("counter", "parallel"):
        raise ValueError(f"arrangement is {arrangement!r}; expected 'counter' or 'parallel'")
    hot_in, hot_out = positive("hot_inlet", hot_inlet, "K"), positive("hot_outlet", hot_outlet, "K")
    cold_in, cold_out = positive("cold_inlet", cold_inlet, "K"), positive("cold_outlet", cold_outlet, "K")
    facing_in, facing_out = (cold_out, cold_in) if arrangement == "counter" else (cold_in, cold_out)
    first, second = np.asarray(hot_in - facing_in), np.asarray(hot_out - facing_out)
    for end, difference in (("inlet", first), ("outlet", second)):
        if np.any(difference <= 0.0):
            raise ValueError(
                f"the hot stream is {float(np.min(difference)):g} K hotter than the cold one at the hot {end} "
                f"({arrangement} flow); expected more than 0 K at both ends"
            )
    return logarithmic_mean(first, second)


def effectiveness(units: ArrayLike, capacity_ratio: ArrayLike, arrangement: Arrangement = "counter") -> FloatArray:
    """Effectiveness of a heat exchanger by its number of transfer units (Kays and London 1984).

    Heat transferred over the heat that an endless counter flow exchanger would transfer. A wall at one temperature,
    as a condenser, has a capacity ratio of 0. Cross flow with both streams unmixed is the complete series of Mason
    (1955), each of whose terms is a product of two incomplete gamma functions, and not the usual fit to it.

    Parameters
    ----------
    units : float or array
        Number of transfer units, U A/C_min.
    capacity_ratio : float or array
        C_min/C_max, the smaller heat capacity rate over the larger, from 0 to 1.
    arrangement : {"counter", "parallel", "cross", "cross_max_mixed", "cross_min_mixed"}
        Direction of the streams; "cross" has both unmixed, else the stream with the larger or the smaller capacity
        rate is mixed.

    Returns
    -------
    float or array
        Effectiveness, from 0 to 1.

    Raises
    ------
    ValueError
        If the units are negative (or above 10000 in unmixed cross flow), the ratio is outside 0 to 1, or the
        arrangement is unknown.
    """
    if arrangement not in get_args(Arrangement):
        raise ValueError(f"arrangement is {arrangement!r}; expected one of {', '.join(get_args(Arrangement))}")
    N, C = np.broadcast_arrays(non_negative("units", units), within("capacity_ratio", capacity_ratio, 0.0, 1.0))
    if arrangement == "counter":
        # (1 - e^-y)/(1 - C e^-y) with y = N (1 - C), divided by 1 - C above and below
        w = N * special.exprel(-N * (1.0 - C))
        return plain(w / (1.0 + C * w))
    if arrangement == "parallel":
        return plain(-np.expm1(-N * (1.0 + C)) / (1.0 + C))
    if arrangement == "cross_max_mixed":
        passed = -np.expm1(-N)
        return plain(passed * special.exprel(-C * passed))
    if arrangement == "cross_min_mixed":
        return plain(-np.expm1(-N * special.exprel(-C * N)))
    return plain(_unmixed(within("units", N, 0.0, _MOST_UNITS), C))


def _unmixed(N: FloatArray, C: FloatArray) -> FloatArray:
    """Mason's series, sum over n of P(n+1, N) P(n+1, C N)/(C N); the terms vanish for n beyond C N."""
    x = np.asarray(C * N)
    # the first term over x is exprel, which has no 0/0 at C N = 0; the others vanish there
    total = special.gammainc(1.0, N) * special.exprel(-x)
    largest = float(np.max(x, initial=0.0))
    divisor = np.where(x > 0.0, x, 1.0)
    for n in range(1, int(largest + 12.0 * np.sqrt(largest)) + 24):
        total = total + special.gammainc(n + 1.0, N) * (special.gammainc(n + 1.0, x) / divisor)
    return np.asarray(np.minimum(total, 1.0))


_effectiveness = effectiveness  # its name is that of the parameter below


def transfer_units(
    effectiveness: ArrayLike, capacity_ratio: ArrayLike, arrangement: Arrangement = "counter"
) -> FloatArray:
    """Number of transfer units at which an exchanger has the given effectiveness, the inverse of `effectiveness`.

    Parameters
    ----------
    effectiveness : float or array
        Effectiveness, from 0 to below the largest of the arrangement.
    capacity_ratio : float or array
        C_min/C_max, from 0 to 1.
    arrangement : str
        As in `effectiveness`.

    Returns
    -------
    float or array
        U A/C_min.

    Raises
    ------
    ValueError
        If no finite number of transfer units (up to 10000) gives the effectiveness, or an input has no meaning.
    """
    wanted, C = np.broadcast_arrays(
        within("effectiveness", effectiveness, 0.0, 1.0, open_above=True),
        within("capacity_ratio", capacity_ratio, 0.0, 1.0),
    )
    reached = _effectiveness(np.full(wanted.shape, _MOST_UNITS), C, arrangement)
    if np.any(wanted >= reached):
        i = int(np.argmax(wanted - reached))
        raise ValueError(
            f"effectiveness is {wanted.flat[i]:g} at capacity_ratio {C.flat[i]:g}; expected less than "
            f"{np.asarray(reached).flat[i]:.6g}, which {arrangement} flow reaches with {_MOST_UNITS:g} transfer units"
        )
    # never fewer units than a wall at one temperature needs, and the root lies within some doublings of that
    low = np.asarray(-np.log1p(-wanted))
    high = np.minimum(2.0 * low, _MOST_UNITS)
    while np.any(short := _effectiveness(high, C, arrangement) < wanted):
        low, high = np.where(short, high, low), np.where(short, np.minimum(2.0 * high, _MOST_UNITS), high)

    def excess(units: FloatArray, ratio: FloatArray, target: FloatArray) -> FloatArray:
        return np.asarray(_effectiveness(units, ratio, arrangement) - target)

    return plain(bracketed_root(excess, low, high, C, wanted))


def bracketed_root(
    function: Callable[..., FloatArray], low: ArrayLike, high: ArrayLike, *args: ArrayLike
) -> FloatArray:
    """Find the root of a function between two bounds, element by element and to rounding (Chandrupatla 1997).

    Parameters
    ----------
    function : callable
        Takes an array of arguments and the parts of `args` that belong to them.
    low, high : float or array
        Bounds at which the function has different signs, or is 0.
    *args : float or array
        Broadcast with the bounds.

    Returns
    -------
    float or array
        The roots.

    Raises
    ------
    ArithmeticError
        If the function has the same sign at both bounds, or is NaN.
    """
    tolerances = {"xrtol": 4e-16, "xatol": 0.0, "frtol": 0.0, "fatol": 0.0}
    found = elementwise.find_root(function, (low, high), args=args, tolerances=tolerances, maxiter=200)
    if np.any(np.isnan(found.x)):
        raise ArithmeticError("no root between the bounds; expected a function that changes its sign there")
    return np.asarray(found.x)


def loss_conductance(area: ArrayLike, *resistances: ArrayLike) -> FloatArray:
    """Conductance of a wall from its layers in series (Nguyen 2015, eq. 6-4): U A = A/(R_wall + R_part + R_air).

    Parameters
    ----------
    area : float or array
        Area of the wall. [m2]
    *resistances : float or array
        Resistance of each layer: thickness over conductivity of stagnant particles and wall, one over the
        coefficient of the air outside. [m2 K/W]

    Returns
    -------
    float or array
        U A. [W/K]

    Raises
    ------
    ValueError
        If the area is not positive, a resistance is negative, or all of them are zero.
    """
    total = np.asarray(sum(non_negative("resistance", resistance, "m2 K/W") for resistance in resistances))
    return plain(positive("area", area, "m2") / positive("sum of the resistances", total, "m2 K/W"))


@dataclass(frozen=True, eq=False)
class Outlet:
    """Where a heated stream ends up (see `outlet_temperature`).

    Parameters
    ----------
    temperature : float or array
        Mixed outlet temperature. [K]
    heat_loss : float or array
        Heat lost to the surroundings; negative where they are warmer. [W]
    specific_heat : float or array
        Specific heat used, at the mean of inlet and outlet. [J/(kg K)]
    """

    temperature: FloatArray
    heat_loss: FloatArray
    specific_heat: FloatArray

    def __str__(self) -> str:
        rows = np.broadcast(self.temperature, self.heat_loss, self.specific_heat)
        return "\n".join(f"outlet {T:.2f} K, loss {q:.3g} W, specific heat {c:.1f} J/(kg K)" for T, q, c in rows)


def outlet_temperature(
    inlet_temperature: ArrayLike,
    heat_rate: ArrayLike,
    mass_flow: ArrayLike,
    specific_heat: ArrayLike | Callable[[FloatArray], ArrayLike],
    loss_conductance: ArrayLike = 0.0,
    ambient_temperature: ArrayLike = 293.15,
) -> Outlet:
    """Mixed outlet temperature of a heated stream that loses heat, and the loss (Nguyen 2015, eq. 6-3 to 6-7).

    Loss and specific heat are those at the mean of inlet and outlet: a bracketed root if the latter is a function.

    Parameters
    ----------
    inlet_temperature : float or array
        Inlet temperature. [K]
    heat_rate : float or array
        Heat supplied to the stream; negative if it is cooled. [W]
    mass_flow : float or array
        Mass flow. [kg/s]
    specific_heat : float, array or function
        Specific heat at the mean of inlet and outlet, or a function that takes that temperature [K]. [J/(kg K)]
    loss_conductance : float or array
        U A between the stream and its surroundings. [W/K]
    ambient_temperature : float or array
        Temperature of the surroundings. [K]

    Returns
    -------
    Outlet

    Raises
    ------
    ValueError
        If an input has no meaning, or no outlet temperature above 0 K closes the balance.
    """
    inlet = positive("inlet_temperature", inlet_temperature, "K")
    heat = np.asarray(heat_rate, dtype=np.float64)
    if not np.all(np.isfinite(heat)):
        raise ValueError(f"heat_rate is {heat[~np.isfinite(heat)].flat[0]:g} W; expected a finite number")
    flow = positive("mass_flow", mass_flow, "kg/s")
    conductance = non_negative("loss_conductance", loss_conductance, "W/K")
    ambient = positive("ambient_temperature", ambient_temperature, "K")
    gained = np.asarray(heat - conductance * (inlet - ambient))
    if callable(specific_heat):
        gained, inlet, flow, conductance = np.broadcast_arrays(gained, inlet, flow, conductance)
        with quiet():  # of trial temperatures; the result's own is given below
            x = _variable_rise(specific_heat, inlet, gained, flow, conductance)
        c = positive("specific_heat", specific_heat(plain(inlet + 0.5 * x)), "J/(kg K)")
    else:
        c = positive("specific_heat", specific_heat, "J/(kg K)")
        x = np.asarray(gained / (flow * c + 0.5 * conductance))
    outlet = np.asarray(inlet + x)
    if np.any(outlet <= 0.0):
        raise ValueError(
            f"the energy balance gives an outlet temperature of {float(np.min(outlet)):g} K; expected more than 0 K: "
            "heat_rate takes more heat than the stream has"
        )
    return Outlet(plain(outlet), plain(conductance * (inlet + 0.5 * x - ambient)), plain(c))


def _variable_rise(
    specific_heat: Callable[[FloatArray], ArrayLike],
    inlet: FloatArray,
    gained: FloatArray,
    flow: FloatArray,
    conductance: FloatArray,
) -> FloatArray:
    """Temperature rise with a specific heat that depends on the mean temperature."""

    def capacity(x: FloatArray, inlet: FloatArray, flow: FloatArray, conductance: FloatArray) -> FloatArray:
        c = positive("specific_heat", specific_heat(inlet + 0.5 * x), "J/(kg K)")
        return np.asarray(flow * c + 0.5 * conductance)

    def excess(x: FloatArray, gained: FloatArray, *stream: FloatArray) -> FloatArray:
        return np.asarray(x * capacity(x, *stream) - gained)

    stream = inlet, flow, conductance
    far = np.asarray(gained / capacity(np.zeros_like(inlet), *stream))
    for _ in range(_DOUBLINGS):
        far = np.maximum(far, -inlet)
        short = np.abs(far * capacity(far, *stream)) < np.abs(gained)
        if not np.any(short & (far > -inlet)):
            break
        far = np.where(short, 2.0 * far, far)
    if np.any(short):
        i = int(np.argmax(short))
        raise ValueError(
            f"no outlet temperature takes up the {gained.flat[i]:g} W left to the stream that enters at "
            f"{inlet.flat[i]:g} K; expected a smaller heat_rate, or a specific heat that does not fall so fast"
        )
    return bracketed_root(excess, np.zeros_like(far), far, gained, *stream)
