"""Temperature beside a wall that heats a bed by conduction and radiation, and what the linearised radiation misses.

Watkins (2018, section 5.3) takes equal steps of temperature from the wall to the layers and `4 T_w^3 (T_w - T_j)` for
the difference of fourth powers. Here the fourth powers stay, and the temperature follows from the heat flux: the
wall-adjacent layer, one particle radius thick, conducts with k_wa beside the radiation, and the bulk behind it carries
the whole flux with k_b, which holds its own radiation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import radiation
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within

__all__ = [
    "LinearisationErrors",
    "WallTemperatureProfile",
    "layer_depths",
    "linearisation_errors",
    "wall_temperature_profile",
]

Depths = Literal["far edge", "middle"]

ITERATIONS = 200
"""Newton steps at most; each one far from the root takes at least a quarter off, and near it they square the error."""


def layer_depths(layers: int, at: Depths = "far edge") -> FloatArray:
    """Depths at which the temperature of the layers is taken, in particle radii.

    Parameters
    ----------
    layers : int
        Number of layers, the wall-adjacent one, a radius thick, included; each other is a diameter thick.
    at : {"far edge", "middle"}
        "far edge": 1, 3, 5, ..., where the steps of Watkins (2018), eq. 49, put it: the centre of a particle that
        touches the wall, for a particle of one temperature. "middle": 0.5, 2, 4, ..., which is also the mean over a
        surface that is spread evenly over the layer's depth, as that of spheres is.

    Returns
    -------
    (layers,) array
        Depths. [particle radii]

    Raises
    ------
    ValueError
        If there is no layer or no such place.
    """
    if layers < 1:
        raise ValueError(f"layers is {layers!r}; expected at least 1")
    far = 2.0 * np.arange(layers, dtype=np.float64) + 1.0
    if at == "far edge":
        return np.asarray(far, dtype=np.float64)
    if at == "middle":
        return np.asarray(0.5 * (far + np.concatenate([[0.0], far[:-1]])))
    raise ValueError(f"depths is {at!r}; expected 'far edge', 'middle' or an array of depths")


def _depths(depths: Depths | ArrayLike, layers: int) -> FloatArray:
    if isinstance(depths, str):
        return layer_depths(layers, depths)  # type: ignore[arg-type]
    x = non_negative("depth", depths, "particle radii")
    if x.shape != (layers,):
        raise ValueError(f"depths have the shape {x.shape}; expected one a layer, ({layers},)")
    return x


@dataclass(frozen=True, eq=False)
class WallTemperatureProfile:
    """Temperature beside a wall, with conduction and radiation that together carry the heat flux.

    Parameters
    ----------
    wall_temperature, heat_flux : float or (...) array
        As given. [K], [W/m2]
    conductive_flux, radiative_flux : float or (...) array
        What the wall layer conducts, and what the wall radiates (eq. 48); their sum is the heat flux. [W/m2]
    wall_layer_step : float or (...) array
        Fall of the temperature across the wall layer, one radius. [K]
    bulk_step : float or (...) array
        Fall of the temperature across one particle diameter of bulk. [K]
    layer_temperatures : (..., layers) array
        Temperature of each layer at its depth. [K]
    depths : (layers,) array
        These depths. [particle radii]
    radiative_conductivity : float or (...) array
        k_rad so that `q = (k_wa + k_rad) wall_layer_step/r`; its limit where there is no flux. [W/(m K)]
    """

    wall_temperature: FloatArray
    heat_flux: FloatArray
    conductive_flux: FloatArray
    radiative_flux: FloatArray
    wall_layer_step: FloatArray
    bulk_step: FloatArray
    layer_temperatures: FloatArray
    depths: FloatArray
    radiative_conductivity: FloatArray

    def at(self, depth: ArrayLike) -> FloatArray:
        """Temperature [K] at a depth [particle radii], (...) for a number and (..., n) for (n,) depths."""
        x = non_negative("depth", depth, "particle radii")
        T, D, B = (
            v[..., None] if x.ndim else v
            for v in (np.asarray(self.wall_temperature), np.asarray(self.wall_layer_step), np.asarray(self.bulk_step))
        )
        return plain(T - D * np.minimum(x, 1.0) - B * 0.5 * np.maximum(x - 1.0, 0.0))

    def __str__(self) -> str:
        shape = np.broadcast_shapes(np.shape(self.wall_temperature), np.shape(self.heat_flux))
        if shape:
            return f"temperature profiles beside {int(np.prod(shape)):,} walls, {self.depths.size} layers each"
        lines = [
            f"wall {float(self.wall_temperature):.2f} K, heat flux {float(self.heat_flux):.4g} W/m2, "
            f"of which radiation {float(self.radiative_flux):.4g}",
            f"falls by {float(self.wall_layer_step):.4g} K across the wall layer, "
            f"{float(self.bulk_step):.4g} K across each diameter behind it; k_rad "
            f"{float(self.radiative_conductivity):.4g} W/(m K)",
        ]
        lines += [
            f"layer {k + 1}: {T:.2f} K at {x:g} radii"
            for k, (T, x) in enumerate(zip(self.layer_temperatures, self.depths, strict=True))
        ]
        return "\n".join(lines)


def wall_temperature_profile(
    factors_to_layers: ArrayLike,
    particle_diameter: ArrayLike,
    wall_temperature: ArrayLike,
    heat_flux: ArrayLike,
    wall_layer_conductivity: ArrayLike,
    bulk_conductivity: ArrayLike,
    depths: Depths | ArrayLike = "far edge",
) -> WallTemperatureProfile:
    """Temperature beside a wall by eq. 48 (Watkins 2018) in full, solved together with the conduction.

    `q = k_wa D/r + sum_j F_j sigma (T_w^4 - T_j^4)` with `T_j = T_w - D min(x_j, 1) - (q r/k_b) max(x_j - 1, 0)`: D is
    the fall across the wall layer, x_j the depth of layer j in radii. The right side rises with D ever less steeply,
    so that Newton's steps from the left cannot miss the only root.

    Parameters
    ----------
    factors_to_layers : (..., layers) array
        View factors from the wall to the layers, or total exchange factors of grey surfaces; the wall-adjacent first.
    particle_diameter : float or array
        Particle diameter. [m]
    wall_temperature : float or array
        Wall temperature. [K]
    heat_flux : float or array
        Heat flux from the wall into the bed; negative where the bed heats the wall. [W/m2]
    wall_layer_conductivity : float or array
        k_wa of the wall layer by conduction alone. [W/(m K)]
    bulk_conductivity : float or array
        k_b of the bulk with its radiation. [W/(m K)]
    depths : {"far edge", "middle"} or (layers,) array
        Where the temperature of each layer is taken, see `layer_depths`; or depths in particle radii.

    Returns
    -------
    WallTemperatureProfile
        Arrays of the shape that the inputs broadcast to, the factors without their last axis.

    Raises
    ------
    ValueError
        If an input has no meaning, the flux would take a layer to absolute zero, or the bulk conducts so badly that the
        radiation to the layers carries more than the whole flux.
    """
    F, radius, T, q, k_wa, k_b, x = _inputs(
        factors_to_layers, particle_diameter, wall_temperature, heat_flux, wall_layer_conductivity, bulk_conductivity,
        depths,
    )  # fmt: skip
    near, behind = np.minimum(x, 1.0), np.maximum(x - 1.0, 0.0)
    limit = _conductivity_without_flux(F, radius, T, k_wa, k_b, near, behind)
    step = _wall_layer_step(F, radius, T, q, k_wa, k_b, near, behind)
    if np.any(step * q < 0.0):
        raise _too_little_bulk(k_b[step * q < 0.0])
    falls = _falls(step, q, radius, k_b, near, behind)
    temperatures = T[..., None] - falls
    if np.any(temperatures <= 0.0):
        bad = np.any(temperatures <= 0.0, axis=-1)
        raise ValueError(
            f"heat_flux is {float(q[bad][0]):g} W/m2, which would take a layer below absolute zero beside a wall of "
            f"{float(T[bad][0]):g} K"
        )
    radiative = _radiated(F, T, falls)
    still = step == 0.0
    return WallTemperatureProfile(
        wall_temperature=plain(T),
        heat_flux=plain(q),
        conductive_flux=plain(k_wa * step / radius),
        radiative_flux=plain(radiative),
        wall_layer_step=plain(step),
        bulk_step=plain(2.0 * q * radius / k_b),
        layer_temperatures=temperatures,
        depths=x,
        radiative_conductivity=plain(np.where(still, limit, radiative * radius / np.where(still, 1.0, step))),
    )


def _inputs(
    factors: ArrayLike,
    diameter: ArrayLike,
    temperature: ArrayLike,
    flux: ArrayLike,
    k_wa: ArrayLike,
    k_b: ArrayLike,
    depths: Depths | ArrayLike,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Checked inputs, broadcast but for the depths."""
    radiation.penetration(factors)
    F = np.asarray(factors, dtype=np.float64)
    limit = np.finfo(float).max
    given = (
        0.5 * positive("particle_diameter", diameter, "m"),
        positive("wall_temperature", temperature, "K"),
        within("heat_flux", flux, -limit, limit, "W/m2"),
        positive("wall_layer_conductivity", k_wa, "W/(m K)"),
        positive("bulk_conductivity", k_b, "W/(m K)"),
    )
    shape = np.broadcast_shapes(F.shape[:-1], *(v.shape for v in given))
    radius, T, q, k_wa, k_b = (np.broadcast_to(v, shape) for v in given)
    return np.broadcast_to(F, (*shape, F.shape[-1])), radius, T, q, k_wa, k_b, _depths(depths, F.shape[-1])


def _falls(
    step: FloatArray, q: FloatArray, radius: FloatArray, k_b: FloatArray, near: FloatArray, behind: FloatArray
) -> FloatArray:
    """Fall of the temperature from the wall to each layer, (..., layers)."""
    return np.asarray(step[..., None] * near + (q * radius / k_b)[..., None] * behind)


def _radiated(F: FloatArray, T: FloatArray, falls: FloatArray) -> FloatArray:
    """Flux by eq. 48 for given falls of the temperature; a layer cannot be colder than absolute zero."""
    difference = radiation.fourth_power_difference(T[..., None], np.minimum(falls, T[..., None]))
    return np.asarray(radiation.STEFAN_BOLTZMANN * (F * difference).sum(axis=-1))


def _wall_layer_step(
    F: FloatArray,
    radius: FloatArray,
    T: FloatArray,
    q: FloatArray,
    k_wa: FloatArray,
    k_b: FloatArray,
    near: FloatArray,
    behind: FloatArray,
) -> FloatArray:
    """Fall of the temperature across the wall layer, by Newton's method from its left side."""
    # a start where no layer is colder than the wall and conduction carries at most the flux: left of the root
    deepest = (q * radius / k_b)[..., None] * behind / np.where(near > 0.0, near, 1.0)
    step = -np.maximum(deepest.max(axis=-1), 0.0) + np.minimum(q, 0.0) * radius / k_wa
    for _ in range(ITERATIONS):
        falls = _falls(step, q, radius, k_b, near, behind)
        colder = np.maximum(T[..., None] - falls, 0.0)
        slope = k_wa / radius + 4.0 * radiation.STEFAN_BOLTZMANN * (F * near * colder**3).sum(axis=-1)
        change = (q - k_wa * step / radius - _radiated(F, T, falls)) / slope
        step = step + change
        if np.all(np.abs(change) <= 1e-14 * np.abs(step)):
            break
    return np.asarray(step)


def _too_little_bulk(k_b: FloatArray) -> ValueError:
    return ValueError(
        f"bulk_conductivity is {float(np.ravel(k_b)[0]):g} W/(m K): radiation from the wall to the layers would carry "
        "more than the bulk between them; expected the conductivity of the bulk with its radiation"
    )


def _conductivity_without_flux(
    F: FloatArray,
    radius: FloatArray,
    T: FloatArray,
    k_wa: FloatArray,
    k_b: FloatArray,
    near: FloatArray,
    behind: FloatArray,
) -> FloatArray:
    """k_rad in the limit of a small flux: `c sum F_j (near_j + (k_wa + k_rad)/k_b behind_j)`, c = 4 sigma r T^3."""
    c = 4.0 * radiation.STEFAN_BOLTZMANN * radius * T**3
    left = 1.0 - c / k_b * (F @ behind)
    if np.any(left <= 0.0):
        raise _too_little_bulk(k_b[left <= 0.0])
    return np.asarray(c * (F @ near + k_wa / k_b * (F @ behind)) / left)


@dataclass(frozen=True, eq=False)
class LinearisationErrors:
    """Relative errors of k_rad by eq. 50 (Watkins 2018) against eq. 48 in full; (1 + total) is the product of all.

    Parameters
    ----------
    fourth_power : float or (...) array
        From `4 T_w^3 (T_w - T_j)` in place of `T_w^4 - T_j^4`, with equal steps.
    equal_steps : float or (...) array
        From equal steps in place of those of the real profile at the far edges of the layers, with fourth powers.
    far_edge : float or (...) array
        From the temperature at the far edges in place of that at the given depths; 0 if these are the far edges.
    total : float or (...) array
        All together.
    linearised, full : float or (...) array
        k_rad by eq. 50, and in full. [W/(m K)]
    """

    fourth_power: FloatArray
    equal_steps: FloatArray
    far_edge: FloatArray
    total: FloatArray
    linearised: FloatArray
    full: FloatArray

    def __str__(self) -> str:
        names = ("fourth_power", "equal_steps", "far_edge", "total")
        return "\n".join(f"{name.replace('_', ' '):<14}{getattr(self, name)}" for name in names)


def linearisation_errors(
    factors_to_layers: ArrayLike,
    particle_diameter: ArrayLike,
    wall_temperature: ArrayLike,
    heat_flux: ArrayLike,
    wall_layer_conductivity: ArrayLike,
    bulk_conductivity: ArrayLike,
    depths: Depths | ArrayLike = "far edge",
) -> LinearisationErrors:
    """Errors of the linearised radiation (Watkins 2018, eq. 49-50), cause by cause.

    With a small flux the error of equal steps is `sum j F_j / sum F_j (1 + 2 (j - 1)/kappa) - 1`, kappa = k_b/(k_wa +
    k_rad): none where kappa is 2. That of the fourth power is `1.5 (sum j^2 F_j/sum j F_j) D/T_w` for a fall D across
    the wall layer.

    Parameters
    ----------
    factors_to_layers, particle_diameter, wall_temperature, heat_flux, wall_layer_conductivity
        As for `wall_temperature_profile`; the flux is not 0.
    bulk_conductivity, depths
        As there.

    Returns
    -------
    LinearisationErrors
        Arrays of the shape that the inputs broadcast to.

    Raises
    ------
    ValueError
        As for `wall_temperature_profile`, or if the flux is 0, or equal steps take a layer to absolute zero.
    """
    if np.any(np.asarray(heat_flux, dtype=np.float64) == 0.0):
        raise ValueError("heat_flux is 0 W/m2: there is no step of temperature to compare")
    inputs = (particle_diameter, wall_temperature, heat_flux, wall_layer_conductivity, bulk_conductivity)
    edge = wall_temperature_profile(factors_to_layers, *inputs)
    full = wall_temperature_profile(factors_to_layers, *inputs, depths)
    linearised = radiation.conductivity(factors_to_layers, particle_diameter, wall_temperature)
    # equal steps as large as that across the wall layer
    fourth = radiation.linearisation_error(factors_to_layers, wall_temperature, edge.wall_layer_step)
    steps = linearised / (1.0 + fourth) / edge.radiative_conductivity
    return LinearisationErrors(
        fourth_power=fourth,
        equal_steps=plain(steps - 1.0),
        far_edge=plain(edge.radiative_conductivity / full.radiative_conductivity - 1.0),
        total=plain(linearised / full.radiative_conductivity - 1.0),
        linearised=plain(np.broadcast_to(linearised, np.shape(full.radiative_conductivity))),
        full=full.radiative_conductivity,
    )
