"""The units in which files give lengths."""

from __future__ import annotations

__all__ = ["LENGTH_UNITS", "metres"]

LENGTH_UNITS = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "µm": 1e-6,
    "μm": 1e-6,
    "nm": 1e-9,
    "in": 0.0254,
    "ft": 0.3048,
}
"""Metres in a unit of length; the sign of micro has two places in Unicode."""


def metres(unit: str) -> float:
    """Metres in a unit of length.

    Raises
    ------
    ValueError
        If the unit is not one of `LENGTH_UNITS`.
    """
    if not isinstance(unit, str) or unit.strip() not in LENGTH_UNITS:
        known = ", ".join(dict.fromkeys(name.replace("µ", "u").replace("μ", "u") for name in LENGTH_UNITS))
        raise ValueError(f"the unit of length is {unit!r}; expected one of {known}")
    return LENGTH_UNITS[unit.strip()]
