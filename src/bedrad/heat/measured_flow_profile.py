"""Mean temperature of a flow from temperatures across the tube (Watkins 2018, eq. 3-4, 54)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from bedrad.heat import ranges
from bedrad.heat.measured_flow_value import Measured
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = ["ProfileForm", "ProfileMean", "mean_from_profile", "quadratic_mean"]

ProfileForm = Literal["quadratic", "even", "spline"]
"""A quadratic regression, as in the source; one without linear term, symmetric about the axis; a spline."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_PANELS = 16
_LARGEST_GAP = 0.3
"""Share of the cross-section beyond the outermost reading above which the profile is more guess than measurement."""


@dataclass(frozen=True, eq=False)
class ProfileMean:
    """What a radial temperature profile says.

    Parameters
    ----------
    mean : Measured
        Mean temperature T_m. [K]
    edge : Measured
        Temperature of the profile at the tube's inner radius, without the jump to the wall. [K]
    coefficients : (3,) array or None
        C1 [K/m2], C2 [K/m], C3 [K] of `T = C1 r^2 + C2 r + C3`; None for a spline.
    covariance : (3, 3) array or None
        Their covariance.
    tube_radius : float
        Inner radius. [m]
    scatter : float
        Standard deviation of the readings about the profile; 0 for a spline. [K]
    determination : float
        Coefficient of determination R2; 1 for a spline.
    """

    mean: Measured
    edge: Measured
    coefficients: FloatArray | None
    covariance: FloatArray | None
    tube_radius: float
    scatter: float
    determination: float

    @property
    def error_without_covariance(self) -> float:
        """Standard error of T_m as eq. 54 (Watkins 2018) has it, without the covariances of the coefficients. [K]

        The coefficients of a regression are strongly anticorrelated, so that this is several times too large; for a
        spline there is none, and it is that of `mean`.
        """
        if self.covariance is None:
            return float(self.mean.error)
        R = self.tube_radius
        return float(np.sqrt(np.diag(self.covariance) @ (np.array([R**2 / 2.0, 2.0 * R / 3.0, 1.0]) ** 2)))

    def __str__(self) -> str:
        return (
            f"mean temperature {self.mean.value:.2f} ± {self.mean.half_width():.2f} K (95 %), at the tube's radius "
            f"{self.edge.value:.2f} K; scatter {self.scatter:.2g} K, R2 {self.determination:.4f}"
        )


def quadratic_mean(coefficients: ArrayLike, tube_radius: ArrayLike) -> FloatArray:
    """Mean temperature of a plug flow with a quadratic profile (Watkins 2018, eq. 4).

    Parameters
    ----------
    coefficients : (..., 3) array
        C1 [K/m2], C2 [K/m], C3 [K] of `T = C1 r^2 + C2 r + C3`.
    tube_radius : float or (...) array
        Inner radius R. [m]

    Returns
    -------
    float or (...) array
        `C1 R^2/2 + 2 C2 R/3 + C3`. [K]

    Raises
    ------
    ValueError
        If there are not three coefficients, or the radius is not positive.
    """
    C = np.asarray(coefficients, dtype=np.float64)
    if C.ndim == 0 or C.shape[-1] != 3:
        raise ValueError(f"coefficients have the shape {C.shape}; expected C1, C2, C3 along the last axis")
    R = positive("tube_radius", tube_radius, "m")
    return plain(C[..., 0] * R**2 / 2.0 + 2.0 * C[..., 1] * R / 3.0 + C[..., 2])


def _readings(
    radius: ArrayLike, temperature: ArrayLike, error: ArrayLike | None, R: float, form: ProfileForm
) -> tuple[FloatArray, FloatArray, FloatArray | None]:
    """Checked readings as radii over R in increasing order, temperatures and errors."""
    if form not in get_args(ProfileForm):
        raise ValueError(f"form is {form!r}; expected one of {', '.join(get_args(ProfileForm))}")
    r, T = ranges.within("radius", radius, 0.0, R * (1.0 + 1e-9), "m"), positive("temperature", temperature, "K")
    if r.ndim != 1 or T.shape != r.shape:
        raise ValueError(f"temperature has the shape {T.shape}; expected one for each of the radii, {r.shape}")
    distinct = np.unique(r).size
    needed = {"quadratic": 3, "even": 2, "spline": 3}[form] + (form != "spline" and error is None)
    if distinct < needed - (form != "spline" and error is None) or r.size < needed:
        raise ValueError(
            f"radius has {r.size} readings at {distinct} radii; expected at least {needed} for a profile of the form "
            f"{form!r} {'without' if error is None else 'with'} temperature_error"
        )
    if error is None:
        if form == "spline":
            raise ValueError("temperature_error is missing; a spline has no residuals to tell it from")
        sigma = None
    else:
        sigma = np.array(np.broadcast_to(non_negative("temperature_error", error, "K"), r.shape))
        if form == "spline" and distinct < r.size:
            raise ValueError(f"radius has {r.size} readings at {distinct} radii; expected them all different")
        if np.any(sigma == 0.0) and np.any(sigma > 0.0):
            raise ValueError("temperature_error is 0 K for some readings; expected all of them, or none")
    order = np.argsort(r)
    beyond = 1.0 - (float(r[order[-1]]) / R) ** 2
    if beyond > _LARGEST_GAP:
        ranges.warn(
            f"radial profile: {100 * beyond:.0f} % of the cross-section lie beyond the outermost reading, at "
            f"{r[order[-1]]:g} m of {R:g} m: the mean temperature is an extrapolation"
        )
    return r[order] / R, T[order], None if sigma is None else sigma[order]


def _powers(x: FloatArray, form: ProfileForm) -> FloatArray:
    """Columns of the regression: x^2, x and 1."""
    return np.stack([x**2, x, np.ones_like(x)] if form == "quadratic" else [x**2, np.ones_like(x)], axis=-1)


def _spline(x: FloatArray, at: FloatArray) -> FloatArray:
    """Matrix from readings to the spline through them and their mirror images beyond the axis."""
    identity = np.eye(x.size)
    apart = x > 0.0
    places = np.concatenate([-x[apart][::-1], x])
    return np.asarray(CubicSpline(places, np.concatenate([identity[apart][::-1], identity]), axis=0)(at))


def _quadrature(x: FloatArray, form: ProfileForm) -> tuple[FloatArray, FloatArray]:
    """Nodes from axis to wall, and weights of an integral over the cross-section, 2 x dx."""
    steps = np.linspace(0.0, 1.0, _PANELS + 1)
    edges = np.unique(np.concatenate([steps, x[x < 1.0]])) if form == "spline" else steps
    half = 0.5 * np.diff(edges)[:, None]
    nodes = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * _NODES).ravel()
    return nodes, 2.0 * nodes * (half * _WEIGHTS).ravel()


def _flow_weights(
    nodes: FloatArray, weights: FloatArray, R: float, velocity: Callable[..., ArrayLike] | None
) -> FloatArray:
    if velocity is None:
        return weights
    speed = np.broadcast_to(non_negative("velocity", velocity(nodes * R), "m/s"), nodes.shape)
    if not np.any(speed > 0.0):
        raise ValueError("velocity is 0 m/s everywhere; expected a flow")
    return np.asarray(weights * speed)


def mean_from_profile(
    radius: ArrayLike,
    temperature: ArrayLike,
    tube_radius: float,
    temperature_error: ArrayLike | None = None,
    *,
    form: ProfileForm = "quadratic",
    velocity: Callable[..., ArrayLike] | None = None,
    specific_heat: Callable[..., ArrayLike] | None = None,
    instrument_error: float = 0.0,
) -> ProfileMean:
    """Mean temperature of a flow from readings across the tube (Watkins 2018, eq. 3-4).

    Parameters
    ----------
    radius : (n,) array
        Distance of each reading from the axis. [m]
    temperature : (n,) array
        Readings. [K]
    tube_radius : float
        Inner radius of the tube. [m]
    temperature_error : float or (n,) array, optional
        Standard errors of the readings, independent of each other; if not given, taken from their scatter about the
        regression. Readings with smaller errors weigh more. [K]
    form : {"quadratic", "even", "spline"}
        Profile: a quadratic regression, as in the source; one without linear term; a cubic spline through the
        readings and their mirror images.
    velocity : callable, optional
        Velocity at an array of radii [m], in any unit; plug flow if not given.
    specific_heat : callable, optional
        c_p at an array of temperatures [K]; constant if not given, as in the source.
    instrument_error : float
        Standard error common to all readings, as of one thermocouple that is moved across the tube; it does not
        average out. [K]

    Returns
    -------
    ProfileMean
        The mean with its standard error, with all covariances of the regression.

    Raises
    ------
    ValueError
        If an input has no meaning, or there are too few readings.

    Warns
    -----
    RangeWarning
        If more than 30 % of the cross-section lie beyond the outermost reading.
    """
    R = float(positive("tube_radius", tube_radius, "m"))
    common = float(non_negative("instrument_error", instrument_error, "K"))
    x, T, sigma = _readings(radius, temperature, temperature_error, R, form)
    nodes, weights = _quadrature(x, form)
    weights = _flow_weights(nodes, weights, R, velocity)
    dof, scatter, determination = np.inf, 0.0, 1.0
    coefficients = covariance = None
    if form == "spline":
        profile, spread = _spline(x, np.append(nodes, 1.0)), np.diag(np.asarray(sigma) ** 2)
    else:
        columns = _powers(x, form)
        scale = np.ones_like(x) if sigma is None or not np.any(sigma) else 1.0 / sigma
        solve = np.linalg.pinv(columns * scale[:, None]) * scale
        residual = T - columns @ (solve @ T)
        left = x.size - columns.shape[1]
        scatter = float(np.sqrt(residual @ residual / left)) if left else 0.0
        total = float(np.sum((T - T.mean()) ** 2))
        determination = 1.0 - float(residual @ residual) / total if total > 0.0 else 1.0
        spread = np.diag(np.full(x.size, scatter**2) if sigma is None else sigma**2)
        dof = float(left) if sigma is None else np.inf
        profile = _powers(np.append(nodes, 1.0), form) @ solve
        coefficients, covariance = _in_metres(solve @ T, solve @ spread @ solve.T, R, form, common)
    across = profile[:-1] @ T
    heat, slope = _heat_capacity(specific_heat, across)
    share = weights * heat / (weights @ heat)
    mean = float(share @ across)
    # warmer readings also weigh more, where the specific heat rises
    gradient = (share + weights * slope * (across - mean) / (weights @ heat)) @ profile[:-1]
    return ProfileMean(
        _with_common(mean, gradient, spread, dof, common),
        _with_common(float(profile[-1] @ T), profile[-1], spread, dof, common),
        coefficients,
        covariance,
        R,
        scatter,
        determination,
    )


def _heat_capacity(
    specific_heat: Callable[..., ArrayLike] | None, temperature: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Specific heat and its slope; relative ones will do."""
    if specific_heat is None:
        return np.ones_like(temperature), np.zeros_like(temperature)
    here = np.broadcast_to(positive("specific_heat", specific_heat(temperature), "J/(kg K)"), temperature.shape)
    step = 1e-3
    rise = np.asarray(specific_heat(temperature + step)) - np.asarray(specific_heat(temperature - step))
    return np.asarray(here), np.asarray(rise / (2.0 * step))


def _with_common(
    value: float, gradient: FloatArray, spread: FloatArray, degrees_of_freedom: float, common: float
) -> Measured:
    """Value with the errors of the readings, and the one that shifts them all."""
    own = float(gradient @ spread @ gradient)
    shared = (common * float(gradient.sum())) ** 2
    dof = np.inf if own == 0.0 else degrees_of_freedom * ((own + shared) / own) ** 2
    return Measured(value, np.sqrt(own + shared), dof)


def _in_metres(
    scaled: FloatArray, covariance: FloatArray, R: float, form: ProfileForm, common: float
) -> tuple[FloatArray, FloatArray]:
    """Coefficients C1, C2, C3 with their covariance from those of powers of r/R."""
    place = [0, 1, 2] if form == "quadratic" else [0, 2]
    into = np.zeros((3, len(place)))
    into[place, range(len(place))] = np.array([R**-2.0, 1.0 / R, 1.0])[place]
    whole = into @ covariance @ into.T
    whole[2, 2] += common**2
    return into @ scaled, whole
