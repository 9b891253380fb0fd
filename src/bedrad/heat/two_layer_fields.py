"""Temperatures in a flow by the two-layer model (Watkins 2018, eq. 69-72), in both layers and at any distance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import two_layer_evaluation as evaluation
from bedrad.heat.ranges import FloatArray, finite, non_negative, plain, positive, within
from bedrad.heat.two_layer_evaluation import IntArray
from bedrad.heat.two_layer_modes import Layers, Modes, checked
from bedrad.heat.two_layer_transform import CONTOUR_ERROR, field_rise, wall_excess

__all__ = ["FlowTemperatures", "developed_shape", "flow_temperatures", "largest_amplitude", "temperature_rise"]


@dataclass(frozen=True, eq=False)
class FlowTemperatures:
    """Temperatures of a flow at radii and distances from the inlet, with what was neglected.

    Parameters
    ----------
    temperature : float or array
        At the radii and distances, broadcast. [K]
    wall_temperature, mean_temperature : float or array
        At the distances. [K]
    terms : int or array
        Terms of the series that were added; 0 where none was needed or the transform was inverted.
    error_bound : float or array
        Bound of the error of `temperature` by terms left out, or by the inversion. [K]
    """

    temperature: FloatArray
    wall_temperature: FloatArray
    mean_temperature: FloatArray
    terms: IntArray
    error_bound: FloatArray

    def __str__(self) -> str:
        low, high = float(np.min(self.temperature)), float(np.max(self.temperature))
        return (
            f"{np.size(self.temperature)} temperatures from {low:.6g} to {high:.6g} K "
            f"({int(np.max(self.terms))} terms at most, error below {float(np.max(self.error_bound)):.1e} K)"
        )


def developed_shape(pairs: Layers, r: FloatArray) -> FloatArray:
    """Temperature of the developed flow less the mean, over q R/k_b, at radii r (n,) in tube radii (eq. 69-70)."""
    # (69), (70) less their value at the wall, so that thin layers keep their digits
    W, e, kappa = pairs.W, pairs.e, pairs.kappa
    bulk = 0.5 * (r - W) * (r + W) - 0.5 * kappa * e * (1.0 + W)
    layer = -0.5 * kappa * (1.0 - r) * (1.0 + r)
    return np.asarray(pairs.resistance + np.where(r <= W, bulk, layer))


def largest_amplitude(pairs: Layers, mu: FloatArray) -> FloatArray:
    """Bound of |phi_p| anywhere in the tube over its value at the wall, growing with the eigenvalue.

    phi^2 + (phi'/nu)^2 falls outwards in the wall layer, but by no more than W^2; the jump of conductivity adds no more
    than 1/kappa, and in the bulk `J0^2 + J1^2 > 0.63/(1 + x)`.
    """
    jump = np.maximum(1.0, 1.0 / np.sqrt(pairs.kappa))
    return np.asarray(jump / pairs.W * np.sqrt((1.0 + mu * pairs.W) / 0.63))


def _series(modes: Modes, t: FloatArray, r: FloatArray, tolerance: float) -> tuple[FloatArray, IntArray, FloatArray]:
    """Rise over q R/k_b, terms and bound of the rest, by the fewest terms that keep it below tolerance times 2 t."""
    pairs = modes.layers
    decays = evaluation.decays_of(modes, t)
    amplitude = largest_amplitude(Layers(pairs.W[:, None], pairs.e[:, None], pairs.kappa[:, None]), modes.mu)
    # amplitude times decay falls with the mode from mu^2 t = 1/4 on
    falls = modes.mu**2 * t[:, None] > 0.25
    rest = np.where(falls, evaluation.left_after(modes, decays) * amplitude, np.inf)
    # the wall warms faster than the mean
    terms = evaluation.fewest(rest, tolerance * 2.0 * t)
    kept = np.arange(modes.mu.shape[1])[None, :] < terms[:, None]
    decaying = np.sum(np.where(kept, modes.weights * decays * modes.shapes(r[:, None])[:, 0, :], 0.0), axis=1)
    rise = 2.0 * t + developed_shape(pairs, r) - decaying
    return rise, terms, np.take_along_axis(rest, terms[:, None], axis=1)[:, 0]


def _rise(pairs: Layers, t: FloatArray, r: FloatArray, tolerance: float) -> tuple[FloatArray, IntArray, FloatArray]:
    """Rise over q R/k_b, terms and bound of the error of n points."""
    rise, terms, bound = np.zeros(t.size), np.zeros(t.size, dtype=np.int64), np.zeros(t.size)
    heated = np.flatnonzero(t > 0.0)
    some = pairs.take(heated)
    # amplitude at a generous eigenvalue: it enters as a logarithm; no series is tried at the least of times
    time = np.maximum(t[heated], 1e-100)
    factor = largest_amplitude(some, 100.0 / np.sqrt(time)) * some.resistance / (2.0 * time)
    needed = evaluation.terms_needed(some, t[heated], tolerance, np.maximum(factor, 1.0))
    todo = np.ones(heated.size, dtype=bool)
    for which, modes in evaluation.batches(some, needed):
        found = _series(modes, t[heated[which]], r[heated[which]], tolerance)
        good = found[2] <= tolerance * 2.0 * t[heated[which]]
        done = heated[which[good]]
        todo[which[good]] = False
        rise[done], terms[done], bound[done] = found[0][good], found[1][good], found[2][good]
    rest = heated[todo]
    if rest.size:
        near = pairs.take(rest)
        rise[rest] = field_rise(near, t[rest], r[rest][:, None])[:, 0]
        bound[rest] = CONTOUR_ERROR * (2.0 * t[rest] + wall_excess(near, t[rest]))
    # no point is colder than the inlet: what is below is rounding
    return np.where(rise < 1e-250, 0.0, rise), terms, bound


def temperature_rise(
    radius_ratio: ArrayLike,
    diameter_ratio: ArrayLike,
    conductivity_ratio: ArrayLike,
    z_star: ArrayLike,
    *,
    tolerance: float = 1e-10,
) -> FloatArray:
    """Temperature above that of the inlet, without dimension (Watkins 2018, eq. 69-72).

    The mean is 4 z*, the value at the wall 4 z* + 1/Nu.

    Parameters
    ----------
    radius_ratio : float or array
        Distance from the axis over the inner radius of the tube, from 0 to 1.
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, above 1; may be infinite.
    conductivity_ratio : float or array
        Bulk over wall-layer conductivity, kappa = k_b/k_wa.
    z_star : float or array
        Inverse Graetz number, finite.
    tolerance : float
        Largest error from terms left out, over the temperature rise of the wall; from 1e-12 to 1e-2.

    Returns
    -------
    float or array
        (T - T_in) k_b/(q D).

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If a conductivity ratio lies outside 1e-6 to 1e6, where rounding was not measured.
    """
    A, kappa = checked(diameter_ratio, conductivity_ratio)
    r, z = within("radius_ratio", radius_ratio, 0.0, 1.0), evaluation.distances(z_star)
    shape, pairs, (radius, distance) = evaluation.flattened(A, kappa, r, z)
    rise, _, _ = _rise(pairs, 4.0 * distance, radius, evaluation.allowed(tolerance))
    return plain(0.5 * rise.reshape(shape))


def flow_temperatures(
    radius: ArrayLike,
    distance: ArrayLike,
    *,
    heat_flux: ArrayLike,
    tube_diameter: ArrayLike,
    particle_diameter: ArrayLike,
    velocity: ArrayLike,
    bulk_conductivity: ArrayLike,
    wall_layer_conductivity: ArrayLike,
    density: ArrayLike,
    specific_heat: ArrayLike,
    inlet_temperature: ArrayLike,
    tolerance: float = 1e-10,
) -> FlowTemperatures:
    """Temperatures of a flow with constant properties in a uniformly heated tube (Watkins 2018, eq. 15-20, 69-72).

    Parameters
    ----------
    radius : float or array
        Distance from the axis, up to half the tube diameter. [m]
    distance : float or array
        Distance from the inlet of the heated length. [m]
    heat_flux : float or array
        Heat flux into the flow at the wall, negative where it is cooled. [W/m2]
    tube_diameter, particle_diameter : float or array
        Inner diameter of the tube, diameter of the particles. [m]
    velocity : float or array
        Velocity of the plug. [m/s]
    bulk_conductivity, wall_layer_conductivity : float or array
        k_b and k_wa. [W/(m K)]
    density : float or array
        Bulk density, that of the particles times their solid fraction. [kg/m3]
    specific_heat : float or array
        c_p. [J/(kg K)]
    inlet_temperature : float or array
        T_in. [K]
    tolerance : float
        Largest error from terms left out, over the temperature rise of the wall; from 1e-12 to 1e-2.

    Returns
    -------
    FlowTemperatures
        Arrays of the shape broadcast from all the inputs.

    Raises
    ------
    ValueError
        If an input has no meaning, a radius lies outside the tube, or the flow would cool below absolute zero.

    Warns
    -----
    RangeWarning
        If k_b/k_wa lies outside 1e-6 to 1e6, where rounding was not measured.
    """
    D = positive("tube_diameter", tube_diameter, "m")
    k_b = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    k_wa = positive("wall_layer_conductivity", wall_layer_conductivity, "W/(m K)")
    r, z = non_negative("radius", radius, "m"), non_negative("distance", distance, "m")
    volumetric = positive("density", density, "kg/m3") * positive("specific_heat", specific_heat, "J/(kg K)")
    T_in = positive("inlet_temperature", inlet_temperature, "K")
    q = finite("heat_flux", heat_flux, "W/m2")
    z_star = evaluation.distances(z * k_b / (volumetric * positive("velocity", velocity, "m/s") * D**2))
    A, kappa = checked(D / positive("particle_diameter", particle_diameter, "m"), k_b / k_wa)
    ratio = np.asarray(2.0 * r / D)
    if np.any(ratio > 1.0 + 1e-12):
        raise ValueError(f"radius over half the tube_diameter is {float(np.max(ratio)):g}; expected at most 1")
    scale = q * D / k_b
    shape, pairs, (flat_r, flat_z, _) = evaluation.flattened(A, kappa, np.minimum(ratio, 1.0), z_star, scale + T_in)
    allowed = evaluation.allowed(tolerance)
    rise, terms, bound = _rise(pairs, 4.0 * flat_z, flat_r, allowed)
    wall = evaluation.excess(pairs, 4.0 * flat_z, allowed).value.reshape(shape)
    mean = np.broadcast_to(4.0 * z_star, shape)
    at_wall = T_in + scale * (mean + 0.5 * wall)
    if np.any(at_wall <= 0.0):
        raise ValueError(f"heat_flux is {float(np.min(q)):g} W/m2; expected one that leaves the wall above 0 K")
    return FlowTemperatures(
        temperature=plain(T_in + 0.5 * scale * rise.reshape(shape)),
        wall_temperature=plain(at_wall),
        mean_temperature=plain(T_in + scale * mean),
        terms=terms.reshape(shape)[()],
        error_bound=plain(0.5 * np.abs(scale) * bound.reshape(shape)),
    )
