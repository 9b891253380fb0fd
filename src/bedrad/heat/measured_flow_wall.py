"""What enters the flow through the wall of a heated tube, and how hot the wall is (Watkins 2018, eq. 2, 55)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.measured_flow_value import Measured, as_measured, combined
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = [
    "INCONEL_CONDUCTIVITY",
    "Insulation",
    "WallHeating",
    "electrical_power",
    "regressed_wall_temperature",
    "wall_heat_flux",
    "wall_temperature_drop",
]

INCONEL_CONDUCTIVITY = 14.5
"""Conductivity of the tube wall in Watkins (2018), section 2.1.3.2. [W/(m K)]"""

WallHeating = Literal["generated", "conducted"]
"""Heat made within the wall by a current, or all of it conducted through the wall from outside."""

Conductivity = float | Callable[..., ArrayLike]


@dataclass(frozen=True)
class Insulation:
    """Layers of insulation around a tube, from inside.

    Parameters
    ----------
    tube_radius : float
        Outer radius of the tube, R_o. [m]
    radii : sequence of float
        Outer radius of each layer, increasing. [m]
    conductivities : sequence of float or callable
        Conductivity of each layer, a number or a function of temperature [K]. [W/(m K)]

    Raises
    ------
    ValueError
        If the radii do not increase from the tube's, or a conductivity is missing or not positive.
    """

    tube_radius: float
    radii: Sequence[float]
    conductivities: Sequence[Conductivity]

    def __post_init__(self) -> None:
        positive("tube_radius", self.tube_radius, "m")
        radii = positive("radii", self.radii, "m")
        if radii.ndim != 1 or radii.size == 0 or len(self.conductivities) != radii.size:
            raise ValueError(
                f"insulation has {radii.size} radii and {len(self.conductivities)} conductivities; expected one of "
                "each for every layer"
            )
        steps = np.diff([self.tube_radius, *radii.tolist()])
        if np.any(steps <= 0.0):
            raise ValueError(f"radii are {radii.tolist()} m; expected them to increase from {self.tube_radius:g} m")
        for k in self.conductivities:
            if not callable(k):
                positive("conductivities", k, "W/(m K)")

    def resistance(self, temperature: ArrayLike) -> FloatArray:
        """Resistance of a length of one metre. [K m/W]

        Parameters
        ----------
        temperature : float or array
            Average temperature of the insulation, at which all its conductivities are taken, as in the source. [K]

        Returns
        -------
        float or array
            `sum of ln(r_outer/r_inner)/(2 pi k)`, the denominator of eq. 2 over 2 pi.
        """
        T = positive("temperature", temperature, "K")
        inner, total = self.tube_radius, np.zeros_like(T)
        for outer, k in zip(self.radii, self.conductivities, strict=True):
            value = positive("conductivities", k(T) if callable(k) else k, "W/(m K)")
            total = total + np.log(outer / inner) / (2.0 * np.pi * value)
            inner = outer
        return plain(total)

    def loss(
        self,
        length: ArrayLike,
        wall_temperature: ArrayLike | Measured,
        surface_temperature: ArrayLike | Measured,
    ) -> Measured:
        """Heat lost through the insulation of a length of tube (Watkins 2018, eq. 2).

        Parameters
        ----------
        length : float or array
            Length of tube, exact. [m]
        wall_temperature : float, array or Measured
            Temperature of the tube's outside, T_w,o. [K]
        surface_temperature : float, array or Measured
            Temperature of the insulation's outside, T_wool. [K]

        Returns
        -------
        Measured
            Q_loss, negative where the surface is the warmer. Its error is the numerator of the second term of eq.
            55, with the change of the conductivities with temperature if they are functions. [W]

        Raises
        ------
        ValueError
            If an input is not positive.
        """
        L = positive("length", length, "m")
        wall = as_measured("wall_temperature", wall_temperature, "K")
        surface = as_measured("surface_temperature", surface_temperature, "K")
        middle, difference = np.asarray(0.5 * (wall.value + surface.value)), wall.value - surface.value
        resistance = self.resistance(middle)
        bend = 0.0 * middle
        if any(callable(k) for k in self.conductivities):
            step = 1e-4 * middle
            bend = (self.resistance(middle + step) - self.resistance(middle - step)) / (2.0 * step)
        # both temperatures move the average by half of their own change
        drift = 0.5 * difference * bend / resistance
        slope = L / resistance
        return combined(slope * difference, [(slope * (1.0 - drift), wall), (slope * (1.0 + drift), surface)])


def electrical_power(voltage: ArrayLike | Measured, current: ArrayLike | Measured) -> Measured:
    """Heating power of a current, V I, with its error (Watkins 2018, first term of eq. 55).

    Parameters
    ----------
    voltage : float, array or Measured
        Voltage drop over the heated length. [V]
    current : float, array or Measured
        Current. [A]

    Returns
    -------
    Measured
        Power. [W]

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    V, amperes = as_measured("voltage", voltage, "V"), as_measured("current", current, "A")
    return combined(V.value * amperes.value, [(amperes.value, V), (V.value, amperes)])


def wall_heat_flux(
    power: ArrayLike | Measured, loss: ArrayLike | Measured, tube_radius: ArrayLike, length: ArrayLike
) -> Measured:
    """Heat flux into the flow, on the inner surface of the tube (Watkins 2018, section 2.1.3, eq. 55).

    Parameters
    ----------
    power : float, array or Measured
        Heating power of a length of tube. [W]
    loss : float, array or Measured
        What of it is lost through the insulation. [W]
    tube_radius : float or array
        Inner radius of the tube, exact. [m]
    length : float or array
        Length of tube, exact. [m]

    Returns
    -------
    Measured
        `q = (power - loss)/(2 pi R L)`. [W/m2]

    Raises
    ------
    ValueError
        If an input has no meaning, or more is lost than the power.
    """
    P, lost = as_measured("power", power, "W"), as_measured("loss", loss, "W", sign=True)
    net = np.asarray(P.value - lost.value)
    if np.any(net <= 0.0):
        where = int(np.argmin(net))
        share = np.broadcast_to(lost.value, net.shape).flat[where]
        raise ValueError(
            f"loss is {share:g} W of a power of {np.broadcast_to(P.value, net.shape).flat[where]:g} W; "
            "expected less than the power"
        )
    area = 2.0 * np.pi * positive("tube_radius", tube_radius, "m") * positive("length", length, "m")
    return combined(net / area, [(1.0 / area, P), (-1.0 / area, lost)])


def wall_temperature_drop(
    heat_flux: ArrayLike,
    inner_radius: ArrayLike,
    outer_radius: ArrayLike,
    wall_conductivity: ArrayLike = INCONEL_CONDUCTIVITY,
    loss_per_length: ArrayLike = 0.0,
    heating: WallHeating = "generated",
) -> FloatArray:
    """Temperature of a tube's outside less that of its inside (Watkins 2018, section 2.1.3.2).

    The source takes the resistance of the wall times the heat that enters the flow, which is right for heat that
    comes from outside ("conducted"). A current makes the heat within the wall ("generated"); the drop is then about
    half of it, less what the loss to the outside takes off.

    Parameters
    ----------
    heat_flux : float or array
        Flux into the flow at the inner surface. [W/m2]
    inner_radius, outer_radius : float or array
        Radii of the tube. [m]
    wall_conductivity : float or array
        Conductivity of the wall. [W/(m K)]
    loss_per_length : float or array
        Heat lost to the outside per length of tube; used for heat that is generated within the wall. [W/m]
    heating : {"generated", "conducted"}
        Where the heat comes from.

    Returns
    -------
    float or array
        Temperature drop from outside to inside. [K]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    if heating not in ("generated", "conducted"):
        raise ValueError(f"heating is {heating!r}; expected 'generated' or 'conducted'")
    q = as_measured("heat_flux", heat_flux, "W/m2", sign=True).value
    inner, outer = positive("inner_radius", inner_radius, "m"), positive("outer_radius", outer_radius, "m")
    if np.any(outer < inner):
        raise ValueError(f"outer_radius is {float(np.min(outer)):g} m; expected at least the inner_radius")
    k = positive("wall_conductivity", wall_conductivity, "W/(m K)")
    lost = as_measured("loss_per_length", loss_per_length, "W/m", sign=True).value
    x = np.log1p((outer - inner) / inner)
    if heating == "conducted":
        return plain(q * inner * x / k)
    inward = 2.0 * np.pi * inner * q
    # R_o^2 ln(R_o/R_i)/(R_o^2 - R_i^2) - 1/2 for what all of the generated heat would cause, less ln(R_o/R_i) for
    # what leaves through the outside
    shape = 0.5 * (x + _coth_rest(x))
    return plain(((inward + lost) * shape - lost * x) / (2.0 * np.pi * k))


def _coth_rest(x: ArrayLike) -> FloatArray:
    """Return x coth x - 1, without cancellation for small x."""
    y = np.asarray(x, dtype=np.float64)
    square = y * y
    series = square * (1.0 / 3.0 - square * (1.0 / 45.0 - square * (2.0 / 945.0 - square / 4725.0)))
    large = np.where(y > 0.05, y, 1.0)
    return np.where(y > 0.05, large / np.tanh(large) - 1.0, series)


def regressed_wall_temperature(
    position: ArrayLike, wall_temperature: ArrayLike, at: ArrayLike, wall_temperature_error: ArrayLike = 0.0
) -> Measured:
    """Wall temperature by a straight line through readings elsewhere (Watkins 2018, section 2.1.3.2, appendix A).

    Parameters
    ----------
    position : (n,) array
        Positions of readings in the thermally developed part, at least three. [m]
    wall_temperature : (n,) array
        Readings. [K]
    at : float or array
        Where the wall temperature is wanted. [m]
    wall_temperature_error : float or (n,) array
        Standard errors of the readings. [K]

    Returns
    -------
    Measured
        Wall temperature. As in the source its error joins the mean error of the readings to that of a further
        reading predicted from the regression, which counts the random part of the readings twice. [K]

    Raises
    ------
    ValueError
        If an input has no meaning or there are fewer than three positions.
    """
    z, T = non_negative("position", position, "m"), positive("wall_temperature", wall_temperature, "K")
    if z.ndim != 1 or T.shape != z.shape or np.unique(z).size < 3:
        raise ValueError(f"wall_temperature has the shape {T.shape}; expected readings at three or more positions")
    sigma = np.broadcast_to(non_negative("wall_temperature_error", wall_temperature_error, "K"), z.shape)
    where = non_negative("at", at, "m")
    offset = z - z.mean()
    square = float(offset @ offset)
    slope = float(offset @ T) / square
    residual = T - T.mean() - slope * offset
    scatter = float(np.sqrt(residual @ residual / (z.size - 2)))
    apart = where - z.mean()
    line = Measured(T.mean() + slope * apart, scatter * np.sqrt(1.0 + 1.0 / z.size + apart**2 / square), z.size - 2)
    return combined(line.value, [(1.0, line), (1.0, Measured(0.0, float(np.sqrt(np.mean(sigma**2)))))])
