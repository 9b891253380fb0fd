"""At which temperatures the properties of a prediction are taken, found from the heat flux."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from bedrad.heat.ranges import FloatArray

__all__ = ["PropertyTemperature", "PropertyTemperatures", "check_property_temperature", "search"]

PropertyTemperature = Literal["wall", "mean", "layers"]
"""Temperature at which the properties are taken, see `bedrad.heat.prediction.predict`."""

_ITERATIONS = 500
_CLOSE = 1e-12
_LEAST_STEP = 0.02


def check_property_temperature(choice: str, *, has_flux: bool) -> None:
    """Refuse an unknown choice, and one that needs a heat flux without one."""
    if choice not in get_args(PropertyTemperature):
        raise ValueError(f"property_temperature is {choice!r}; expected 'wall', 'mean' or 'layers'")
    if choice != "wall" and not has_flux:
        raise ValueError(f"property_temperature {choice!r} needs a heat_flux, which parts mean and wall temperature")


@dataclass(frozen=True, eq=False)
class PropertyTemperatures:
    """Where the properties are taken.

    Parameters
    ----------
    wall_layer, bulk : array
        Temperatures of the properties of both layers. [K]
    step : array or None
        Fall of the temperature across the wall layer; None where radiation is linearised about one temperature. [K]
    found : array of bool
        Whether there are such temperatures; where there are none, those of the wall stand in their place.
    """

    wall_layer: FloatArray
    bulk: FloatArray
    step: FloatArray | None
    found: NDArray[np.bool_]


def search(
    choice: PropertyTemperature,
    wall: FloatArray,
    heat_flux: FloatArray,
    particle_diameter: FloatArray,
    tube_diameter: FloatArray,
    reach: int,
    evaluate: Callable[[PropertyTemperatures], dict[str, FloatArray]],
) -> PropertyTemperatures:
    """Find the temperatures at which wall layer and bulk have the properties that lead back to them.

    The repetition starts from the wall. Where a flow is heated it falls towards the hottest solution, step by step
    without passing it; where it is cooled it swings about the only one, and shorter steps make it settle.

    Parameters
    ----------
    choice : {"mean", "layers"}
        See `bedrad.heat.prediction.predict`.
    wall, heat_flux, particle_diameter, tube_diameter : array
        Arrays that broadcast. [K], [W/m2], [m], [m]
    reach : int
        Number of the last layer that radiation reaches, whose temperature has to be above absolute zero.
    evaluate : callable
        All models at given temperatures.
    """
    shape = np.broadcast_shapes(wall.shape, heat_flux.shape, particle_diameter.shape, tube_diameter.shape)
    wall = np.broadcast_to(wall, shape)
    start = np.stack([wall, wall, np.zeros(shape)])
    now, last, last_image = start.copy(), start, start
    good, settled = np.ones(shape, dtype=bool), np.zeros(shape, dtype=bool)
    for iteration in range(_ITERATIONS):
        found = evaluate(_unpacked(choice, now, good))
        image = _image(choice, wall, heat_flux, particle_diameter, tube_diameter, found)
        change = image - now
        # the slope of the image, from this and the last step: negative where it swings
        moved = now - last
        slope = np.divide(image - last_image, moved, out=np.zeros_like(moved), where=moved != 0.0)
        length = np.maximum(1.0 / (1.0 - np.minimum(slope, 0.0)), _LEAST_STEP)
        last, last_image = now, image
        # the first step of a swing is shortened too, as its slope is not known yet
        now = now + change * (np.where(heat_flux < 0.0, 0.5, 1.0) if iteration == 0 else length)
        good = good & (np.min(now[:2], axis=0) > 0.0) & (wall - reach * now[2] > 0.0)
        now = np.where(good, now, start)
        settled = np.abs(change[:2]).max(axis=0) <= _CLOSE * wall
        if np.all(settled | ~good):
            break
    return _unpacked(choice, np.where(settled & good, now, start), settled & good)


def _unpacked(choice: PropertyTemperature, state: FloatArray, found: NDArray[np.bool_]) -> PropertyTemperatures:
    return PropertyTemperatures(state[0], state[1], state[2] if choice == "layers" else None, found)


def _image(
    choice: PropertyTemperature,
    wall: FloatArray,
    heat_flux: FloatArray,
    particle_diameter: FloatArray,
    tube_diameter: FloatArray,
    found: dict[str, FloatArray],
) -> FloatArray:
    """Temperatures of wall layer and bulk, and the fall across the wall layer, that the models lead to."""
    mean = wall - heat_flux / found["heat_transfer_coefficient"]
    if choice == "mean":
        return np.stack([mean, mean, np.zeros(mean.shape)])
    # the flux falls linearly with the radius in a developed plug flow: half the fall across the wall layer is its mean,
    # and two thirds of the bulk's fall from its edge to its mean are where a property that varies linearly has to be
    # taken for the same mean temperature
    ratio = particle_diameter / tube_diameter
    total = found["wall_layer_conductivity"] + found["radiative_conductivity"]
    step = heat_flux * 0.5 * particle_diameter * (1.0 - 0.5 * ratio) / total
    bulk_share = (1.0 - ratio) ** 2
    bulk_mean = (mean - (1.0 - bulk_share) * (wall - 0.5 * step)) / bulk_share
    edge = wall - step
    return np.stack(np.broadcast_arrays(wall - 0.5 * step, edge - 2.0 / 3.0 * (edge - bulk_mean), step))
