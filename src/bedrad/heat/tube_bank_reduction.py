"""From a row of measurements on heated tubes to heat transfer coefficients (Nguyen 2015, chapters 5 and 6)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.fins import FinnedTube
from bedrad.heat.heat_exchanger import bracketed_root, log_mean_temperature_difference, outlet_temperature
from bedrad.heat.ranges import FloatArray, plain, positive

__all__ = [
    "BareTubeResult",
    "FinnedTubeResult",
    "Measurement",
    "fin_effectiveness",
    "reduce_bare_tubes",
    "reduce_finned_tubes",
    "surface_coefficient",
    "tube_area",
    "tube_temperature",
]


def tube_area(diameter: ArrayLike, length: ArrayLike) -> FloatArray:
    """Outer area of a bare tube, pi D L (Nguyen 2015, eq. 5-1 and 6-1).

    Parameters
    ----------
    diameter, length : float or array
        Outer diameter and length. [m]

    Returns
    -------
    float or array
        Area. [m2]

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    return plain(math.pi * positive("diameter", diameter, "m") * positive("length", length, "m"))


def tube_temperature(top: ArrayLike, side: ArrayLike, bottom: ArrayLike, side_weight: float = 2.0) -> FloatArray:
    """Mean surface temperature of a tube from three thermocouples (Nguyen 2015, sections 5.3 and 6.1).

    Parameters
    ----------
    top, side, bottom : float or array
        Temperatures. [K]
    side_weight : float
        Weight of the side over that of top and bottom: 2 as it stands for both sides, which the text of the source
        says and its air tests have; its particle tests are evaluated with 1.

    Returns
    -------
    float or array
        Mean temperature. [K]

    Raises
    ------
    ValueError
        If a temperature or the weight is not positive.
    """
    weight = float(positive("side_weight", side_weight))
    ends = positive("top", top, "K") + positive("bottom", bottom, "K")
    return plain((ends + weight * positive("side", side, "K")) / (2.0 + weight))


def surface_coefficient(heat_per_tube: ArrayLike, area: ArrayLike, temperature_difference: ArrayLike) -> FloatArray:
    """Heat transfer coefficient Q/(A dT) (Nguyen 2015, eq. 5-3, 6-8 and 6-16).

    Parameters
    ----------
    heat_per_tube : float or array
        Heat that leaves a tube. [W]
    area : float or array
        Surface of the tube. [m2]
    temperature_difference : float or array
        Log-mean temperature difference between surface and fluid. [K]

    Returns
    -------
    float or array
        Coefficient. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    heat, A = positive("heat_per_tube", heat_per_tube, "W"), positive("area", area, "m2")
    return plain(heat / A / positive("temperature_difference", temperature_difference, "K"))


def fin_effectiveness(apparent_coefficient: ArrayLike, bare_coefficient: ArrayLike) -> FloatArray:
    """Heat of a finned tube over that of a bare one at the same temperatures (Nguyen 2015, eq. 6-17 put right).

    The equation divides the effective coefficient by that of bare tubes, which gives 0.8 to 1.2 with Tables 14 and
    15; the 7 to 8 that the text reports are the apparent coefficient over that of bare tubes.

    Parameters
    ----------
    apparent_coefficient : float or array
        Coefficient of the finned tubes if they had no fins, Q/(A_bare dT) (eq. 6-16). [W/(m2 K)]
    bare_coefficient : float or array
        Coefficient of bare tubes (eq. 6-8). [W/(m2 K)]

    Returns
    -------
    float or array
        Ratio.

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    apparent = positive("apparent_coefficient", apparent_coefficient, "W/(m2 K)")
    return plain(apparent / positive("bare_coefficient", bare_coefficient, "W/(m2 K)"))


@dataclass(frozen=True, eq=False)
class Measurement:
    """A row of measurements, or arrays of them: particles, or air, that flow across heated tubes.

    Parameters
    ----------
    heat_rate : float or array
        Power of all tubes together. [W]
    tubes : float or array
        Number of tubes.
    upstream_temperature, downstream_temperature : float or array
        Mean surface temperatures of a tube in the first and the last row (see `tube_temperature`). [K]
    inlet_temperature : float or array
        Temperature of the particles at the inlet. [K]
    mass_flow : float or array
        Mass flow. [kg/s]
    specific_heat : float, array or function
        Specific heat, or a function of temperature [K] that gives it, evaluated at the mean of inlet and outlet.
        [J/(kg K)]
    loss_conductance : float or array
        U A between the particles and the surroundings. [W/K]
    ambient_temperature : float or array
        Temperature of the surroundings. [K]
    """

    heat_rate: ArrayLike
    tubes: ArrayLike
    upstream_temperature: ArrayLike
    downstream_temperature: ArrayLike
    inlet_temperature: ArrayLike
    mass_flow: ArrayLike
    specific_heat: ArrayLike | Callable[[FloatArray], ArrayLike]
    loss_conductance: ArrayLike = 0.0
    ambient_temperature: ArrayLike = 293.15


@dataclass(frozen=True, eq=False)
class BareTubeResult:
    """What the measurements on bare tubes give.

    Parameters
    ----------
    coefficient : float or array
        Heat transfer coefficient from the tubes to the particles, h_average (eq. 6-8). [W/(m2 K)]
    log_mean_difference : float or array
        Log-mean temperature difference between tubes and particles (eq. 6-2). [K]
    outlet_temperature : float or array
        Mixed outlet temperature of the particles (eq. 6-7). [K]
    heat_loss : float or array
        Heat lost to the surroundings (eq. 6-6). [W]
    """

    coefficient: FloatArray
    log_mean_difference: FloatArray
    outlet_temperature: FloatArray
    heat_loss: FloatArray

    def __str__(self) -> str:
        return "\n".join(
            f"h {h:.1f} W/(m2 K), log-mean difference {d:.2f} K, outlet {T:.2f} K, loss {q:.1f} W"
            for h, d, T, q in _rows(self.coefficient, self.log_mean_difference, self.outlet_temperature, self.heat_loss)
        )


@dataclass(frozen=True, eq=False)
class FinnedTubeResult:
    """What the measurements on finned tubes give.

    Parameters
    ----------
    coefficient : float or array
        Heat transfer coefficient over tube and fins, h_effective (eq. 6-13). [W/(m2 K)]
    apparent_coefficient : float or array
        The same if the tube had no fins, h_apparent (eq. 6-16). [W/(m2 K)]
    fin_efficiency : float or array
        Efficiency of the fins (eq. 6-14).
    log_mean_difference : float or array
        Log-mean temperature difference between the base of the fins and the particles (eq. 6-2). [K]
    outlet_temperature : float or array
        Mixed outlet temperature of the particles (eq. 6-7). [K]
    heat_loss : float or array
        Heat lost to the surroundings (eq. 6-6). [W]
    """

    coefficient: FloatArray
    apparent_coefficient: FloatArray
    fin_efficiency: FloatArray
    log_mean_difference: FloatArray
    outlet_temperature: FloatArray
    heat_loss: FloatArray

    def __str__(self) -> str:
        return "\n".join(
            f"h {h:.1f} W/(m2 K), {a:.0f} as a bare tube, fin efficiency {e:.3f}, log-mean difference {d:.2f} K, "
            f"outlet {T:.2f} K, loss {q:.1f} W"
            for h, a, e, d, T, q in _rows(
                self.coefficient,
                self.apparent_coefficient,
                self.fin_efficiency,
                self.log_mean_difference,
                self.outlet_temperature,
                self.heat_loss,
            )
        )


def _rows(*values: FloatArray) -> list[tuple[float, ...]]:
    columns = np.broadcast_arrays(*(np.atleast_1d(value) for value in values))
    return list(zip(*(column.ravel().tolist() for column in columns), strict=True))


def _particle_side(measurement: Measurement) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Heat of a tube, log-mean difference, outlet temperature and heat loss."""
    heat = positive("heat_rate", measurement.heat_rate, "W")
    outlet = outlet_temperature(
        measurement.inlet_temperature,
        heat,
        measurement.mass_flow,
        measurement.specific_heat,
        measurement.loss_conductance,
        measurement.ambient_temperature,
    )
    difference = log_mean_temperature_difference(
        measurement.upstream_temperature,
        measurement.downstream_temperature,
        measurement.inlet_temperature,
        outlet.temperature,
        "parallel",
    )
    per_tube = np.asarray(heat / positive("tubes", measurement.tubes))
    return per_tube, difference, outlet.temperature, outlet.heat_loss


def reduce_bare_tubes(measurement: Measurement, diameter: ArrayLike, length: ArrayLike) -> BareTubeResult:
    """Heat transfer coefficient of bare tubes from measurements (Nguyen 2015, eq. 6-1 to 6-8).

    Parameters
    ----------
    measurement : Measurement
        A row of measurements, or arrays of them.
    diameter, length : float or array
        Outer diameter and length of a tube. [m]

    Returns
    -------
    BareTubeResult
        Arrays of the broadcast shape.

    Raises
    ------
    ValueError
        If an input has no meaning, or the tubes are not hotter than the particles at inlet and outlet.
    """
    heat, difference, outlet, loss = _particle_side(measurement)
    coefficient = surface_coefficient(heat, tube_area(diameter, length), difference)
    return BareTubeResult(coefficient, difference, outlet, loss)


def reduce_finned_tubes(measurement: Measurement, tube: FinnedTube) -> FinnedTubeResult:
    """Heat transfer coefficient of finned tubes from measurements (Nguyen 2015, eq. 6-9 to 6-16).

    The fin efficiency depends on the coefficient; eq. 6-13 is solved for it by a bracketed root.

    Parameters
    ----------
    measurement : Measurement
        A row of measurements, or arrays of them.
    tube : FinnedTube
        The tubes.

    Returns
    -------
    FinnedTubeResult
        Arrays of the broadcast shape.

    Raises
    ------
    ValueError
        If an input has no meaning, or the tubes are not hotter than the particles at inlet and outlet.
    """
    heat, difference, outlet, loss = _particle_side(measurement)
    conductance = np.asarray(heat / difference)

    def excess(logarithm: FloatArray, conductance: FloatArray) -> FloatArray:
        h = np.exp(logarithm)
        return np.asarray(h * tube.effective_area(h) / conductance - 1.0)

    # fins as hot as their base from below, no fins at all from above, both with room for rounding
    low, high = np.log(conductance / tube.total_area) - 1e-6, np.log(conductance / tube.base_area) + 1e-6
    h = plain(np.exp(bracketed_root(excess, low, high, conductance)))
    apparent = surface_coefficient(heat, tube.bare_area, difference)
    return FinnedTubeResult(h, apparent, tube.efficiency(h), difference, outlet, loss)
