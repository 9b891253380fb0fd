"""The heat that a tube wall gives to a flow, from its inlet to each position (Watkins 2018, eq. 12-13)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, finite, non_negative, plain, positive

__all__ = ["cumulative_heat", "ohmic_coefficients", "ohmic_heat", "power_law_heat"]


def _positions(position: ArrayLike) -> FloatArray:
    z = non_negative("position", position, "m")
    if z.ndim != 1 or z.size == 0:
        raise ValueError(f"position has the shape {z.shape}; expected one axis of positions along the tube")
    if np.any(np.diff(z) <= 0.0):
        i = int(np.argmax(np.diff(z) <= 0.0))
        raise ValueError(f"position is {z[i + 1]:g} m after {z[i]:g} m; expected increasing positions")
    return z


def _integrated(z: FloatArray, density: FloatArray) -> FloatArray:
    """Integral from the first position to each, along the last axis, of what is linear between positions."""
    steps = 0.5 * (density[..., 1:] + density[..., :-1]) * np.diff(z)
    return np.concatenate([np.zeros_like(density[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)


def cumulative_heat(position: ArrayLike, wall_heat_flux: ArrayLike, perimeter: ArrayLike) -> FloatArray:
    """Heat that a flow takes up from the first position to each, from the wall heat flux there.

    Parameters
    ----------
    position : (n,) array
        Increasing positions along the tube. [m]
    wall_heat_flux : (..., n) array or float
        Flux into the flow at the positions; taken as linear between them. [W/m2]
    perimeter : float
        Heated perimeter, pi D for a tube. [m]

    Returns
    -------
    (..., n) array
        Heat, zero at the first position. [W]

    Raises
    ------
    ValueError
        If an input has no meaning or positions do not increase.
    """
    z = _positions(position)
    flux = finite("wall_heat_flux", wall_heat_flux, "W/m2")
    flux = np.broadcast_to(flux, np.broadcast_shapes(flux.shape, z.shape))
    return _integrated(z, np.asarray(flux * positive("perimeter", perimeter, "m")))


def ohmic_heat(
    position: ArrayLike,
    wall_temperature: ArrayLike,
    current: ArrayLike,
    wall_area: ArrayLike,
    resistivity: float | Callable[..., ArrayLike],
) -> FloatArray:
    """Heat that a current makes in a tube wall from the first position to each (Watkins 2018, eq. 12).

    Parameters
    ----------
    position : (n,) array
        Increasing positions along the tube. [m]
    wall_temperature : (..., n) array or float
        Wall temperature at the positions. [K]
    current : float
        Current. [A]
    wall_area : float
        Cross-section of the tube wall, A_tw. [m2]
    resistivity : float or callable
        Electrical resistivity, a number or a function of temperature [K]; taken as linear between positions. [ohm m]

    Returns
    -------
    (..., n) array
        `I^2 * integral of resistivity dz / A_tw`, losses not subtracted. [W]

    Raises
    ------
    ValueError
        If an input has no meaning or positions do not increase.
    """
    z = _positions(position)
    T = positive("wall_temperature", wall_temperature, "K")
    T = np.array(np.broadcast_to(T, np.broadcast_shapes(T.shape, z.shape)))
    rho = np.broadcast_to(positive("resistivity", resistivity(T) if callable(resistivity) else resistivity, "ohm m"),
                          T.shape)  # fmt: skip
    amperes = finite("current", current, "A")
    return _integrated(z, np.asarray(amperes**2 * rho / positive("wall_area", wall_area, "m2")))


def ohmic_coefficients(
    current: float,
    wall_area: float,
    resistivity: float,
    resistivity_slope: float,
    wall_rise: float,
    wall_slope: float,
    exponent: float,
) -> tuple[float, float, float]:
    """Coefficients G1, G2, G3 of the heat along a tube (Watkins 2018, eq. 13), from what eq. 12 integrates.

    The wall temperature is `T_w(z) = T_w(0) + c z^d + e z`, the resistivity linear in temperature. The source leaves
    T_w(0) out of its wall temperature; a constant there only changes G3.

    Parameters
    ----------
    current : float
        Current. [A]
    wall_area : float
        Cross-section of the tube wall. [m2]
    resistivity : float
        Electrical resistivity at the wall temperature of z = 0. [ohm m]
    resistivity_slope : float
        Its change with temperature. [ohm m/K]
    wall_rise, wall_slope, exponent : float
        c [K/m^d], e [K/m] and d of the wall temperature; d above -1.

    Returns
    -------
    (float, float, float)
        G1 [W/m^(d+1)], G2 [W/m2], G3 [W/m].

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    d = float(finite("exponent", exponent, ""))
    if d <= -1.0:
        raise ValueError(f"exponent is {d:g}; expected more than -1, so that the heat stays finite")
    scale = float(finite("current", current, "A")) ** 2 / float(positive("wall_area", wall_area, "m2"))
    slope = float(finite("resistivity_slope", resistivity_slope, "ohm m/K"))
    c, e = float(finite("wall_rise", wall_rise, "K/m^d")), float(finite("wall_slope", wall_slope, "K/m"))
    rho = float(positive("resistivity", resistivity, "ohm m"))
    return scale * slope * c / (d + 1.0), 0.5 * scale * slope * e, scale * rho


def power_law_heat(position: ArrayLike, coefficients: tuple[float, float, float], exponent: float) -> FloatArray:
    """Heat along a tube, `Q(z) = G1 z^(d+1) + G2 z^2 + G3 z` (Watkins 2018, eq. 13).

    Parameters
    ----------
    position : float or array
        Position from the start of heating. [m]
    coefficients : (float, float, float)
        G1 [W/m^(d+1)], G2 [W/m2], G3 [W/m], from `ohmic_coefficients` or fitted.
    exponent : float
        d, above -1.

    Returns
    -------
    float or array
        Heat from z = 0 to each position. [W]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    z = non_negative("position", position, "m")
    G1, G2, G3 = (float(finite("coefficients", G, "")) for G in coefficients)
    d = float(finite("exponent", exponent, ""))
    if d <= -1.0:
        raise ValueError(f"exponent is {d:g}; expected more than -1, so that the heat stays finite")
    return plain(G1 * z ** (d + 1.0) + G2 * z**2 + G3 * z)
