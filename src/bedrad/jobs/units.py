"""Quantities as text with a unit (``"600 um"``, ``"850 degC"``) to SI floats; used at the edges only."""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Annotated, Any

import pint
from pydantic import BeforeValidator

__all__ = [
    "Conductivity",
    "Density",
    "HeatFlux",
    "Length",
    "Pressure",
    "Stiffness",
    "Temperature",
    "TemperatureDifference",
    "Velocity",
    "quantity",
    "shortened",
    "temperature_difference",
]

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-zµμ°][A-Za-z0-9µμ°/^*() -]*)")
_POWER = re.compile(r"(?<=[A-Za-z)])(?:\^|\*\*)-?[1-9](?![0-9])")

_LONGEST = 60
"""Characters that a quantity may have, and that a message shows of something else."""

_EXAMPLES = {
    "m": "600 um",
    "m/s": "0.05 m/s",
    "K": "850 degC",
    "kg/m^3": "3800 kg/m^3",
    "N/m": "100 N/m",
    "Pa": "70 GPa",
    "W/(m K)": "2.1 W/(m K)",
    "1/m^2": "1.9 mm^-2",
    "W/m^2": "50 kW/m^2",
}


@cache
def _registry() -> pint.UnitRegistry[Any]:
    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def quantity(text: object, unit: str) -> float:
    """Number in the SI unit `unit` from a text such as ``"600 um"``.

    Parameters
    ----------
    text : str
        A number and a unit; a blank between them is optional.
    unit : str
        The SI unit wanted.

    Raises
    ------
    ValueError
        If there is no number, no unit, an unknown one, or one of another dimension. The message gives an example.
    """
    expected = f"expected a number with a unit, such as {_EXAMPLES.get(unit, f'1 {unit}')!r}"
    shown = shortened(text)
    match = _QUANTITY.fullmatch(text) if isinstance(text, str) and len(text) <= _LONGEST else None
    if match is None:
        raise ValueError(f"{shown} is not a quantity; {expected}")
    number, given = match[1], match[2].strip()
    registry = _registry()
    # W/(m K): a blank between units means a product
    written = re.sub(r"(?<=[A-Za-z0-9)])\s+(?=[A-Za-z(])", " * ", re.sub("[µμ]", "u", given).replace("°C", "degC"))
    try:
        # pint works out numbers too: a tower of powers such as 9^9^9 would never end
        if re.search("[0-9]", _POWER.sub("", written)):
            raise ValueError
        value = float(registry.Quantity(float(number), written).to(unit.replace(" ", " * ")).magnitude)
    except pint.DimensionalityError:
        raise ValueError(f"{shown} has the wrong kind of unit; {expected}") from None
    except Exception:
        raise ValueError(f"{shown} has an unknown unit {given!r}; {expected}") from None
    if not math.isfinite(value):
        raise ValueError(f"{shown} is not a finite quantity; {expected}")
    return value


def temperature_difference(text: object) -> float:
    """Difference of temperatures [K] from a text such as ``"5 K"``; ValueError for a temperature, in degC or degF."""
    value = quantity(text, "K")
    if quantity(f"0 {_QUANTITY.fullmatch(str(text))[2]}", "K") != 0.0:  # type: ignore[index]
        raise ValueError(f"{shortened(text)} is a temperature; expected a difference of temperatures, such as '5 K'")
    return value


def shortened(value: object) -> str:
    """Value as Python writes it, cut off where it is too long for a message."""
    written = repr(value)
    return written if len(written) <= _LONGEST + 2 else f"{written[:_LONGEST]}..."


def _reader(unit: str) -> BeforeValidator:
    return BeforeValidator(lambda text: quantity(text, unit), json_schema_input_type=str)


Length = Annotated[float, _reader("m")]
Velocity = Annotated[float, _reader("m/s")]
Temperature = Annotated[float, _reader("K")]
Density = Annotated[float, _reader("kg/m^3")]
Stiffness = Annotated[float, _reader("N/m")]
Pressure = Annotated[float, _reader("Pa")]
Conductivity = Annotated[float, _reader("W/(m K)")]
HeatFlux = Annotated[float, _reader("W/m^2")]
TemperatureDifference = Annotated[float, BeforeValidator(temperature_difference, json_schema_input_type=str)]
