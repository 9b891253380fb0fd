"""First-law balance of a flow that is heated along a tube (Watkins 2018, eq. 12-14, section 2.3).

The mean temperature T of a flow of mass flow m that has taken up the heat Q since the inlet follows from
`m * integral of c_p from T_in to T = Q`. Everything else here says what Q is: the ohmic heat of a tube whose
resistance changes with temperature, the integral of a wall heat flux, or the heat of each of several sections.
"""

from __future__ import annotations

from collections.abc import Callable
from types import MethodType

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.materials import ZERO_CELSIUS, Material
from bedrad.heat.measured_flow_heating import cumulative_heat, ohmic_coefficients, ohmic_heat, power_law_heat
from bedrad.heat.ranges import FloatArray, finite, plain, positive, quiet

__all__ = [
    "SpecificHeat",
    "cumulative_heat",
    "heat_rate",
    "mean_temperature",
    "ohmic_coefficients",
    "ohmic_heat",
    "power_law_heat",
    "section_temperatures",
]

SpecificHeat = float | Material | Callable[..., ArrayLike]
"""A number [J/(kg K)], a material with its power law in degrees Celsius, or any function of temperature [K]."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_MOST_PANELS = 256
_TIGHT = 2e-15
"""Relative change of an integral below which more panels add rounding only."""

_STEPS = 32
"""Runge-Kutta steps from inlet to outlet; they only find the start of Newton's method."""


def _resolved(specific_heat: SpecificHeat) -> FloatArray | Material | Callable[..., ArrayLike]:
    """A number checked, a material, also for the method of one (its integral has a closed form), or a function."""
    if isinstance(specific_heat, MethodType) and isinstance(specific_heat.__self__, Material):
        return specific_heat.__self__
    if isinstance(specific_heat, Material) or callable(specific_heat):
        return specific_heat
    return positive("specific_heat", specific_heat, "J/(kg K)")


def _evaluate(specific_heat: Callable[..., ArrayLike], temperature: FloatArray) -> FloatArray:
    return positive("specific_heat", np.broadcast_to(specific_heat(temperature), temperature.shape), "J/(kg K)")


def _enthalpy(specific_heat: Callable[..., ArrayLike], start: FloatArray, end: FloatArray) -> FloatArray:
    """Integral of the specific heat from start to end, by Gauss' rule on panels halved until nothing changes."""
    before = np.full(start.shape, np.inf)
    panels = 1
    while True:
        width = (end - start) / panels
        middles = start[..., None] + width[..., None] * (np.arange(panels) + 0.5)
        nodes = middles[..., None] + 0.5 * width[..., None, None] * _NODES
        found = 0.5 * width * np.sum(_evaluate(specific_heat, nodes) @ _WEIGHTS, axis=-1)
        if panels >= _MOST_PANELS or np.all(np.abs(found - before) <= _TIGHT * np.abs(found)):
            return np.asarray(found)
        before, panels = found, 2 * panels


def _too_cold(rate: FloatArray) -> ValueError:
    return ValueError(
        f"heat_rate is {float(np.min(rate)):g} W; expected a heat loss that leaves the flow above absolute zero"
    )


def _solve(specific_heat: Callable[..., ArrayLike], inlet: FloatArray, gain: FloatArray) -> FloatArray:
    """Temperature at which the enthalpy above the inlet is `gain` [J/kg], for any positive specific heat.

    Steps along dT/dh = 1/c_p come so close that Newton's method needs a few iterations, and neither looks much
    beyond the answer, where a table of properties may end.
    """

    def slope(temperature: FloatArray) -> FloatArray:
        if np.any(temperature <= 0.0):
            raise _too_cold(gain)
        return np.asarray(1.0 / _evaluate(specific_heat, temperature))

    T, h = inlet.copy(), gain / _STEPS
    for _ in range(_STEPS):
        k1 = slope(T)
        k2 = slope(T + 0.5 * h * k1)
        k3 = slope(T + 0.5 * h * k2)
        k4 = slope(T + h * k3)
        T = T + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
    for _ in range(20):
        step = (gain - _enthalpy(specific_heat, inlet, T)) * slope(T)
        T = T + step
        if np.all(np.abs(step) <= 4.0 * np.spacing(T)):
            break
    return T


def mean_temperature(
    inlet_temperature: ArrayLike, heat_rate: ArrayLike, mass_flow: ArrayLike, specific_heat: SpecificHeat
) -> FloatArray:
    """Mean temperature of a flow that has taken up a heat since the inlet (Watkins 2018, eq. 14).

    Solves `mass_flow * integral of c_p from T_in to T = heat_rate`. For a number and for a material's power law
    the solution is closed (the latter is eq. 14, whose temperatures are in degrees Celsius); any other function
    is integrated and solved to rounding where it is smooth.

    Parameters
    ----------
    inlet_temperature : float or array
        T_in. [K]
    heat_rate : float or array
        Heat taken up between the inlet and each position, negative where the flow is cooled. [W]
    mass_flow : float or array
        Mass flow. [kg/s]
    specific_heat : float, Material or callable
        c_p, as a number [J/(kg K)], a material of `bedrad.heat.materials`, or a function that takes an array of
        temperatures [K] and returns c_p [J/(kg K)].

    Returns
    -------
    float or array
        Mean temperature, broadcast over the first three inputs. [K]

    Raises
    ------
    ValueError
        If an input has no meaning, or the heat loss would cool the flow to absolute zero, or to 0 degrees Celsius,
        where the power law of a material ends.

    Warns
    -----
    RangeWarning
        If inlet or result lies outside the measured range of a material.
    """
    T_in = positive("inlet_temperature", inlet_temperature, "K")
    rate = finite("heat_rate", heat_rate, "W")
    flow = positive("mass_flow", mass_flow, "kg/s")
    gain = np.asarray(rate / flow)
    c_p = _resolved(specific_heat)
    if isinstance(c_p, Material):
        if np.any(T_in <= ZERO_CELSIUS):
            c_p.specific_heat(T_in)  # refuses it
        n = c_p.specific_heat_exponent + 1.0
        C = T_in - ZERO_CELSIUS
        power = np.asarray(C**n + n * gain / c_p.specific_heat_coefficient)
        if np.any(power <= 0.0):
            raise ValueError(
                f"heat_rate is {float(np.min(rate)):g} W; expected a heat loss that leaves the flow above 273.15 K, "
                f"where the specific heat of {c_p.name} ends"
            )
        T = np.asarray(ZERO_CELSIUS + power ** (1.0 / n))
        _evaluate(c_p.specific_heat, np.stack(np.broadcast_arrays(T_in, T)))  # warns once of what it extrapolates
        return plain(T)
    if not callable(c_p):
        T = np.asarray(T_in + gain / c_p)
        if np.any(T <= 0.0):
            raise _too_cold(rate)
        return plain(T)
    start, difference = (np.array(x) for x in np.broadcast_arrays(T_in, gain))
    with quiet():
        T = _solve(c_p, start, difference)
    _evaluate(c_p, np.stack([start, T]))  # warns once of what lies outside its range
    return plain(T)


def heat_rate(
    inlet_temperature: ArrayLike, outlet_temperature: ArrayLike, mass_flow: ArrayLike, specific_heat: SpecificHeat
) -> FloatArray:
    """Heat that brings a flow from one mean temperature to another, the inverse of `mean_temperature`.

    Parameters
    ----------
    inlet_temperature, outlet_temperature : float or array
        Mean temperatures. [K]
    mass_flow : float or array
        Mass flow. [kg/s]
    specific_heat : float, Material or callable
        c_p as for `mean_temperature`. [J/(kg K)]

    Returns
    -------
    float or array
        `mass_flow * integral of c_p from inlet to outlet`. [W]

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If a temperature lies outside the measured range of a material.
    """
    T_in = positive("inlet_temperature", inlet_temperature, "K")
    T_out = positive("outlet_temperature", outlet_temperature, "K")
    flow = positive("mass_flow", mass_flow, "kg/s")
    c_p = _resolved(specific_heat)
    if isinstance(c_p, Material):
        _evaluate(c_p.specific_heat, np.stack(np.broadcast_arrays(T_in, T_out)))
        n = c_p.specific_heat_exponent + 1.0
        C = T_in - ZERO_CELSIUS
        # C_out^n - C_in^n without cancellation for nearly equal temperatures
        rise = C**n * np.expm1(n * np.log1p((T_out - T_in) / C))
        return plain(flow * c_p.specific_heat_coefficient * rise / n)
    if not callable(c_p):
        return plain(flow * c_p * (T_out - T_in))
    start, end = (np.array(x) for x in np.broadcast_arrays(T_in, T_out))
    with quiet():
        enthalpy = _enthalpy(c_p, start, end)
    _evaluate(c_p, np.stack([start, end]))
    return plain(flow * enthalpy)


def section_temperatures(
    inlet_temperature: float, section_heats: ArrayLike, mass_flow: float, specific_heat: SpecificHeat
) -> FloatArray:
    """Mean temperatures between sections with a constant specific heat each (Watkins 2018, section 2.3).

    The specific heat of a section is that at the average of the temperatures at its ends, which is what the source
    does with one and with two sections for comparison with eq. 14. Within a section of constant wall heat flux the
    temperature is then linear.

    Parameters
    ----------
    inlet_temperature : float
        T_in. [K]
    section_heats : (sections,) array
        Heat taken up in each section. [W]
    mass_flow : float
        Mass flow. [kg/s]
    specific_heat : float, Material or callable
        c_p as for `mean_temperature`. [J/(kg K)]

    Returns
    -------
    (sections + 1,) array
        Temperatures at inlet and at the end of every section; they approach `mean_temperature` with the square of
        the length of a section. [K]

    Raises
    ------
    ValueError
        If an input has no meaning, or no temperature satisfies the balance.

    Warns
    -----
    RangeWarning
        If an average temperature lies outside the measured range of a material.
    """
    T = float(positive("inlet_temperature", inlet_temperature, "K"))
    heats = np.atleast_1d(finite("section_heats", section_heats, "W"))
    gains = heats / float(positive("mass_flow", mass_flow, "kg/s"))
    resolved = _resolved(specific_heat)
    if isinstance(resolved, Material):
        c_p: Callable[..., ArrayLike] = resolved.specific_heat
    elif callable(resolved):
        c_p = resolved
    else:
        number = resolved

        def c_p(_: FloatArray) -> FloatArray:
            return number

    temperatures = [T]
    for gain in gains.tolist():
        rise = gain / float(_evaluate(c_p, np.asarray(T)))
        with quiet():
            for _ in range(200):
                if T + rise <= 0.0:
                    raise _too_cold(heats)
                before, rise = rise, gain / float(_evaluate(c_p, np.asarray(T + 0.5 * rise)))
                if abs(rise - before) <= 4.0 * np.spacing(T):
                    break
            else:
                raise ValueError(f"section_heats holds {gain:g} J/kg; expected a heat with one average temperature")
        _evaluate(c_p, np.asarray(T + 0.5 * rise))
        T += rise
        temperatures.append(T)
    return np.asarray(temperatures)
