"""The only place that knows CoolProp (extra `gas`)."""

from __future__ import annotations

import contextlib
from types import ModuleType

import numpy as np

from bedrad.heat.ranges import FloatArray, warn_outside, within

__all__ = ["HOTTEST", "evaluate", "source"]

HOTTEST = 1e4
"""Temperature beyond which no property is given: molecules have come apart long before, and atoms begin to lose their
electrons. Series of powers of T go on without limit; that of the specific heat of air is below zero at 5e4 K. [K]"""


def _coolprop() -> ModuleType:
    try:
        import CoolProp
    except ImportError:
        raise ImportError(
            'CoolProp is not installed; install it with: pip install "bedrad[gas]" '
            "(for air alone, bedrad.heat.gas.air_properties needs no extra)"
        ) from None
    found: ModuleType = CoolProp
    return found


def source() -> str:
    """Name and version of what `evaluate` asks."""
    return f"CoolProp {_coolprop().__version__}"


def evaluate(gas: str, temperature: FloatArray, pressure: FloatArray) -> tuple[str, tuple[FloatArray, ...]]:
    """Properties of a pure gas, state by state.

    Parameters
    ----------
    gas : str
        A name that CoolProp knows.
    temperature : array
        Temperature. [K]
    pressure : array
        Pressure, of the same shape. [Pa]

    Returns
    -------
    str
        CoolProp's name of the gas.
    tuple of four arrays
        Conductivity [W/(m K)], viscosity [Pa s], specific heat [J/(kg K)], density [kg/m3].

    Raises
    ------
    ImportError
        If CoolProp is not installed.
    ValueError
        If CoolProp does not know the gas, or cannot give its properties as a gas; above 10,000 K.

    Warns
    -----
    RangeWarning
        Outside the temperatures of CoolProp's equation.
    """
    within("temperature", temperature, 0.0, HOTTEST, "K")
    CoolProp = _coolprop()
    unknown = f"gas is {gas!r}; expected a pure fluid that CoolProp knows, such as 'N2', 'He', 'Ar', 'CO2' or 'air'"
    if not isinstance(gas, str) or any(mark in gas for mark in "&[:"):
        raise ValueError(unknown)
    state = None
    for spelled in (gas, gas.upper(), gas.capitalize()):
        with contextlib.suppress(ValueError):
            state = state or CoolProp.AbstractState("HEOS", spelled)
    if state is None:
        raise ValueError(unknown)
    name = str(state.name())
    warn_outside(f"{name} (CoolProp): temperature", temperature, state.Tmin(), state.Tmax(), "K")
    gaseous = (CoolProp.iphase_gas, CoolProp.iphase_supercritical_gas, CoolProp.iphase_supercritical)
    columns = tuple(np.empty_like(temperature) for _ in range(4))
    for where in np.ndindex(temperature.shape):
        T, p = float(temperature[where]), float(pressure[where])
        what = f"{name} at {T:g} K and {p:g} Pa"
        try:
            state.update(CoolProp.PT_INPUTS, p, T)
            values = (state.conductivity(), state.viscosity(), state.cpmass(), state.rhomass())
        except ValueError as error:
            # CoolProp's messages may run over several lines
            raise ValueError(f"CoolProp has no properties of {what}: {' '.join(str(error).split())}") from None
        if state.phase() not in gaseous:
            raise ValueError(f"{what} is not a gas; expected a temperature above its boiling point")
        for column, value in zip(columns, values, strict=True):
            column[where] = value
    return name, columns
