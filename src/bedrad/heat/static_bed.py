"""Static beds in the cells that measure their conductivity: two plates, and two concentric tubes (Watkins 2018).

Between plates each plate has a wall-adjacent layer, half a particle diameter thick, that conducts less than the bulk
(section 2.2.3.2, eq. 11; section 4.3, eq. 47); beds of several thicknesses tell the two apart. Between concentric tubes
the temperature falls with the logarithm of the radius (section 2.2.3.1, eq. 9-10), away from the walls in bulk alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.chute import modified_diameter_ratio
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = [
    "ConcentricTubeFit",
    "PlateCellFit",
    "annulus_temperature",
    "cell_diameter_ratio",
    "fit_concentric_tube",
    "fit_plate_cell",
    "total_conductivity",
    "total_resistance",
]


def total_resistance(
    thickness: ArrayLike, particle_diameter: ArrayLike, wall_layer_conductivity: ArrayLike, bulk_conductivity: ArrayLike
) -> FloatArray:
    """Resistance of a bed between two plates: `t/k_b + d (1/k_wa - 1/k_b)` (Watkins 2018, eq. 11).

    Parameters
    ----------
    thickness : float or array
        Thickness of the bed, t, one particle diameter at least. [m]
    particle_diameter : float or array
        Particle diameter, d. [m]
    wall_layer_conductivity, bulk_conductivity : float or array
        k_wa of both layers at the plates, d/2 thick, and k_b of what is between. [W/(m K)]

    Returns
    -------
    float or array
        Resistance of a unit of area. [m2 K/W]

    Raises
    ------
    ValueError
        If an input is not positive or the bed is thinner than a particle.
    """
    t = positive("thickness", thickness, "m")
    d = positive("particle_diameter", particle_diameter, "m")
    k_wa = positive("wall_layer_conductivity", wall_layer_conductivity, "W/(m K)")
    k_b = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    _refuse_thin(t, d)
    return plain(d / k_wa + (t - d) / k_b)


def total_conductivity(
    thickness: ArrayLike, particle_diameter: ArrayLike, wall_layer_conductivity: ArrayLike, bulk_conductivity: ArrayLike
) -> FloatArray:
    """Conductivity that a bed between two plates seems to have: `t/(d/k_wa + (t - d)/k_b)` (Watkins 2018, eq. 47).

    Parameters
    ----------
    thickness, particle_diameter, wall_layer_conductivity, bulk_conductivity : float or array
        As for `total_resistance`.

    Returns
    -------
    float or array
        k_total, from k_wa for one layer of particles to k_b for a thick bed. [W/(m K)]

    Raises
    ------
    ValueError
        If an input is not positive or the bed is thinner than a particle.
    """
    resistance = total_resistance(thickness, particle_diameter, wall_layer_conductivity, bulk_conductivity)
    return plain(np.asarray(thickness, dtype=np.float64) / resistance)


def cell_diameter_ratio(thickness: ArrayLike, plate_diameter: ArrayLike, particle_diameter: ArrayLike) -> FloatArray:
    """Modified diameter ratio of a bed between two discs that stands on edge (Watkins 2018, section 4.3, eq. 46).

    The source takes the cell as a rectangle, thickness by average width of the disc; the average chord of a disc is
    its area over its diameter, pi/4 of the diameter.

    Parameters
    ----------
    thickness : float or array
        Thickness of the bed. [m]
    plate_diameter : float or array
        Diameter of the discs. [m]
    particle_diameter : float or array
        Particle diameter. [m]

    Returns
    -------
    float or array
        A_m for the correlations of the wall layer.

    Raises
    ------
    ValueError
        If a length is not positive.
    """
    width = 0.25 * math.pi * positive("plate_diameter", plate_diameter, "m")
    return modified_diameter_ratio(2.0 * (positive("thickness", thickness, "m") + width), particle_diameter)


def _refuse_thin(thickness: FloatArray, diameter: FloatArray) -> None:
    thin = thickness < diameter
    if np.any(thin):
        t, d = (values[thin].flat[0] for values in np.broadcast_arrays(thickness, diameter))
        raise ValueError(f"thickness is {t:g} m; expected the particle_diameter, {d:g} m, at least")


class _Line(NamedTuple):
    slope: float
    intercept: float
    covariance: FloatArray
    chi_squared: float
    degrees_of_freedom: int


def _one_length(what: str, x: FloatArray, y: FloatArray, errors: ArrayLike | None) -> None:
    shape = np.shape(x if errors is None else errors)
    if x.ndim != 1 or x.shape != y.shape or shape not in ((), x.shape):
        raise ValueError(f"{what} have the shapes {x.shape}, {y.shape}, {shape}; expected rows of one length")


def _fit_line(x: FloatArray, y: FloatArray, errors: FloatArray | None, what: str) -> _Line:
    """Fit `y = slope x + intercept`; without errors of y the scatter about the line gives them."""
    least = 2 if errors is not None else 3
    if x.size < least or np.ptp(x) == 0.0:
        raise ValueError(f"{x.size} {what} are given; expected {least} or more, in two places at least")
    weight = np.ones_like(x) if errors is None else np.broadcast_to(errors, x.shape) ** -2.0
    centre = np.average(x, weights=weight)
    dx = x - centre
    spread, total = float(np.sum(weight * dx * dx)), float(np.sum(weight))
    middle = float(np.average(y, weights=weight))
    slope = float(np.sum(weight * dx * (y - middle))) / spread
    chi_squared = float(np.sum(weight * (y - middle - slope * dx) ** 2))
    freedom = x.size - 2
    scale = chi_squared / freedom if errors is None else 1.0
    both = -centre / spread
    covariance = scale * np.array([[1.0 / spread, both], [both, 1.0 / total - centre * both]])
    return _Line(slope, middle - slope * float(centre), covariance, chi_squared / scale if scale else 0.0, freedom)


@dataclass(frozen=True, eq=False)
class PlateCellFit:
    """Conductivities of bulk and wall layer out of beds of several thicknesses between plates.

    Parameters
    ----------
    bulk_conductivity, bulk_error : float
        k_b and its standard error. [W/(m K)]
    wall_layer_resistivity, wall_layer_resistivity_error : float
        1/k_wa and its standard error; noise may make it negative. [m K/W]
    correlation : float
        Correlation of the errors of bulk conductivity and wall-layer resistivity.
    chi_squared : float
        Squared deviations from the line over the standard errors given; the degrees of freedom where none were.
    degrees_of_freedom : int
        Thicknesses measured, less 2.
    """

    bulk_conductivity: float
    bulk_error: float
    wall_layer_resistivity: float
    wall_layer_resistivity_error: float
    correlation: float
    chi_squared: float
    degrees_of_freedom: int

    @property
    def wall_layer_conductivity(self) -> float:
        """k_wa [W/(m K)]; ValueError where the fitted resistivity is not positive."""
        if not self.wall_layer_resistivity > 0.0:
            raise ValueError(
                f"wall_layer_resistivity is {self.wall_layer_resistivity:g} +- {self.wall_layer_resistivity_error:g} "
                "m K/W; expected a positive value: the measurements do not show a wall layer"
            )
        return 1.0 / self.wall_layer_resistivity

    @property
    def wall_layer_error(self) -> float:
        """Standard error of k_wa [W/(m K)] to first order; ValueError as for k_wa."""
        return self.wall_layer_conductivity**2 * self.wall_layer_resistivity_error

    def __str__(self) -> str:
        known = self.wall_layer_resistivity > 0.0
        wall = f"{self.wall_layer_conductivity:.4g} +- {self.wall_layer_error:.2g} W/(m K)" if known else "not seen"
        return (
            f"k_b  {self.bulk_conductivity:.4g} +- {self.bulk_error:.2g} W/(m K)\nk_wa {wall}\n"
            f"chi squared {self.chi_squared:.3g} at {self.degrees_of_freedom} degrees of freedom"
        )


def fit_plate_cell(
    thicknesses: ArrayLike,
    total_conductivities: ArrayLike,
    particle_diameter: float,
    conductivity_errors: ArrayLike | None = None,
) -> PlateCellFit:
    """Find k_b and k_wa from the total conductivities of beds of several thicknesses (Watkins 2018, eq. 11).

    A straight line through the resistances t/k_total against the thickness: its slope is 1/k_b, what it leaves at t =
    d is d/k_wa. Both layers and the bulk are taken as the same in every bed.

    Parameters
    ----------
    thicknesses, total_conductivities : (n,) array
        Thicknesses of the beds [m] and the conductivities measured [W/(m K)].
    particle_diameter : float
        Particle diameter. [m]
    conductivity_errors : float or (n,) array, optional
        Their standard errors; left out, the scatter about the line gives them, all resistances taken as equally good,
        and three thicknesses are needed. [W/(m K)]

    Returns
    -------
    PlateCellFit
        Conductivities with standard errors.

    Raises
    ------
    ValueError
        If an input has no meaning, there are too few thicknesses, or the resistance does not rise with the thickness.
    """
    t = positive("thickness", thicknesses, "m")
    k = positive("total_conductivity", total_conductivities, "W/(m K)")
    d = float(positive("particle_diameter", particle_diameter, "m"))
    _refuse_thin(t, np.asarray(d))
    _one_length("thicknesses, conductivities and their errors", t, k, conductivity_errors)
    errors = None
    if conductivity_errors is not None:
        errors = np.asarray(t / k**2 * positive("conductivity_error", conductivity_errors, "W/(m K)"))
    # measured from t = d on, the intercept is the resistance of the two layers alone
    line = _fit_line(np.asarray(t - d), np.asarray(t / k), errors, "thicknesses and conductivities")
    if not line.slope > 0.0:
        raise ValueError(
            f"the resistances rise by {line.slope:g} m K/W with the thickness; expected a positive slope, 1/k_b"
        )
    variance_slope, variance_layers = np.diag(line.covariance)
    both = math.sqrt(variance_slope * variance_layers)
    return PlateCellFit(
        bulk_conductivity=1.0 / line.slope,
        bulk_error=math.sqrt(variance_slope) / line.slope**2,
        wall_layer_resistivity=line.intercept / d,
        wall_layer_resistivity_error=math.sqrt(variance_layers) / d,
        correlation=-float(line.covariance[0, 1]) / both if both > 0.0 else 0.0,
        chi_squared=line.chi_squared,
        degrees_of_freedom=line.degrees_of_freedom,
    )


def annulus_temperature(
    radius: ArrayLike,
    power: ArrayLike,
    heated_length: ArrayLike,
    conductivity: ArrayLike,
    outer_radius: ArrayLike,
    outer_temperature: ArrayLike,
    conductivity_slope: ArrayLike = 0.0,
) -> FloatArray:
    """Temperature in a bed between a heater and a tube around it (Watkins 2018, eq. 9, corrected).

    `T = T_out + P/(2 pi L k) ln(R_out/r)`. The print has ln(r/R_in), which is 0 at the heater and largest at the outer
    tube, where it has to give T_out. With a conductivity that changes linearly with the temperature, as the source
    checked its method with, `k = k_out + k' (T - T_out)`, the solution is exact too.

    Parameters
    ----------
    radius : float or array
        Where, r. [m]
    power, heated_length : float or array
        Power of the heater, voltage times current [W], and its length [m].
    conductivity : float or array
        Conductivity of the bed, at the outer temperature where it changes. [W/(m K)]
    outer_radius, outer_temperature : float or array
        Inner radius of the outer tube [m] and the temperature there [K].
    conductivity_slope : float or array
        Change of the conductivity with the temperature, k'. [W/(m K2)]

    Returns
    -------
    float or array
        Temperature. [K]

    Raises
    ------
    ValueError
        If an input has no meaning, or the conductivity falls to zero before the radius is reached.
    """
    r = positive("radius", radius, "m")
    outside = positive("outer_radius", outer_radius, "m")
    if np.any(r > outside):
        raise ValueError(f"radius is {float(np.max(r)):g} m; expected at most the outer_radius, {np.max(outside):g} m")
    k = positive("conductivity", conductivity, "W/(m K)")
    slope = np.asarray(conductivity_slope, dtype=np.float64)
    flow = non_negative("power", power, "W") / (2.0 * math.pi * positive("heated_length", heated_length, "m"))
    potential = flow * np.log(outside / r)
    square = np.asarray(k * k + 2.0 * slope * potential)
    if not np.all(square >= 0.0):
        raise ValueError(
            f"conductivity_slope is {float(np.min(slope)):g} W/(m K2): the conductivity falls to 0 within the bed"
        )
    return plain(positive("outer_temperature", outer_temperature, "K") + 2.0 * potential / (k + np.sqrt(square)))


@dataclass(frozen=True, eq=False)
class ConcentricTubeFit:
    """Conductivity out of temperatures between a heater and a tube around it.

    Parameters
    ----------
    conductivity, error : float
        k_b and its standard error. [W/(m K)]
    mean_temperature : float
        Mean of the measured temperatures, where the conductivity holds. [K]
    coefficient, coefficient_error : float
        Fall of the temperature with the logarithm of the radius, a_b, and its standard error. [K]
    chi_squared : float
        Squared deviations from the line over the standard errors given; the degrees of freedom where none were.
    degrees_of_freedom : int
        Temperatures measured, less 2.
    """

    conductivity: float
    error: float
    mean_temperature: float
    coefficient: float
    coefficient_error: float
    chi_squared: float
    degrees_of_freedom: int

    def __str__(self) -> str:
        return (
            f"k_b {self.conductivity:.4g} +- {self.error:.2g} W/(m K) at {self.mean_temperature:.1f} K\n"
            f"chi squared {self.chi_squared:.3g} at {self.degrees_of_freedom} degrees of freedom"
        )


def fit_concentric_tube(
    radii: ArrayLike,
    temperatures: ArrayLike,
    power: float,
    heated_length: float,
    temperature_errors: ArrayLike | None = None,
) -> ConcentricTubeFit:
    """Find k_b from temperatures against radius: `k_b = P/(2 pi L a_b)` (Watkins 2018, eq. 10, error by eq. 53).

    Parameters
    ----------
    radii, temperatures : (n,) array
        Where the temperatures were measured [m], and the temperatures [K].
    power, heated_length : float
        Power of the heater, voltage times current [W], and its length [m].
    temperature_errors : float or (n,) array, optional
        Standard errors of the temperatures; left out, the scatter about the line gives them, and three are needed. [K]

    Returns
    -------
    ConcentricTubeFit
        Conductivity with its standard error; power, length and radii are taken as exact, as in the source.

    Raises
    ------
    ValueError
        If an input has no meaning, there are too few temperatures, or they do not fall outwards.
    """
    r = positive("radius", radii, "m")
    T = positive("temperature", temperatures, "K")
    flow = float(positive("power", power, "W")) / (2.0 * math.pi * float(positive("heated_length", heated_length, "m")))
    _one_length("radii, temperatures and their errors", r, T, temperature_errors)
    errors = None if temperature_errors is None else positive("temperature_error", temperature_errors, "K")
    line = _fit_line(np.log(r), T, errors, "radii and temperatures")
    fall, error = -line.slope, math.sqrt(float(line.covariance[0, 0]))
    if not fall > 0.0:
        raise ValueError(
            f"the temperature changes by {-fall:g} K with ln(radius); expected a fall away from the heater"
        )
    return ConcentricTubeFit(
        conductivity=flow / fall,
        error=flow / fall * (error / fall),
        mean_temperature=float(np.mean(T)),
        coefficient=fall,
        coefficient_error=error,
        chi_squared=line.chi_squared,
        degrees_of_freedom=line.degrees_of_freedom,
    )
