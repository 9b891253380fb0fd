"""Standard errors of what a prediction takes as given, and what they make of its results."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from bedrad.heat.ranges import FloatArray, non_negative

__all__ = ["Uncertainties", "derivatives", "draw"]

_STEP = 1e-4
"""Step of the differences over the size of the input: their error is its square, that of rounding 1e-12."""


@dataclass(frozen=True)
class Uncertainties:
    """Standard errors of tube, particles, properties and correlations; those of measured layers travel with them.

    Parameters
    ----------
    tube_diameter, particle_diameter : float
        [m]
    velocity : float
        [m/s]
    solid_conductivity : float
        [W/(m K)]
    porosity, emissivity : float
        Of the bulk.
    wall_temperature : float
        [K]
    heat_flux : float
        [W/m2]
    gas_conductivity : float
        Relative: of the gas property, over its value.
    bulk_conductivity : float
        Relative: of the bulk's fit or model, over its value.
    packing_fraction, contacts_per_area : float
        Relative: of the correlations for the wall layer, over their values; not used for a measured layer.

    Raises
    ------
    ValueError
        If one is negative or not finite.
    """

    tube_diameter: float = 0.0
    particle_diameter: float = 0.0
    velocity: float = 0.0
    solid_conductivity: float = 0.0
    porosity: float = 0.0
    emissivity: float = 0.0
    wall_temperature: float = 0.0
    heat_flux: float = 0.0
    gas_conductivity: float = 0.0
    bulk_conductivity: float = 0.0
    packing_fraction: float = 0.0
    contacts_per_area: float = 0.0

    def __post_init__(self) -> None:
        for entry in fields(self):
            non_negative(f"standard error of {entry.name}", getattr(self, entry.name))

    @classmethod
    def published(cls) -> Uncertainties:
        """Take what Watkins (2018) states for his own systems.

        Bulk conductivity within 11 % (95 % confidence, appendix A); the packing fraction of eq. 38 within 5 % and the
        contacts of eq. 40 within 16 %, which are largest deviations and count here as half widths of uniform
        distributions.
        """
        return cls(
            bulk_conductivity=0.11 / 1.96,
            packing_fraction=0.05 / math.sqrt(3.0),
            contacts_per_area=0.16 / math.sqrt(3.0),
        )


def derivatives(
    function: Callable[[Mapping[str, FloatArray]], FloatArray],
    inputs: Mapping[str, FloatArray],
    possible: Callable[[Mapping[str, FloatArray]], NDArray[np.bool_]],
    errors: Mapping[str, FloatArray],
) -> dict[str, FloatArray]:
    """Derivatives by every input, from values at both sides of it, or at one side where the other has no meaning.

    Parameters
    ----------
    function : callable
        Takes inputs by name, one set a row, and returns an array (results, rows, n).
    inputs : mapping
        Where the derivatives are taken, each a number or an array (n,).
    possible : callable
        Takes inputs, one set a row, and returns whether they have a meaning, as an array that broadcasts to (rows, n).
    errors : mapping
        Standard errors: the size of the step where an input is 0.

    Returns
    -------
    dict
        An array (results, n) for each input; 0 where the input cannot be moved at all.
    """
    names = list(inputs)
    steps = {name: _step(inputs[name], errors.get(name, np.asarray(0.0))) for name in names}
    sides = np.zeros((len(names), 2 * len(names), 1))
    for k in range(len(names)):
        sides[k, 2 * k : 2 * k + 2, 0] = (1.0, -1.0)
    moved = {name: inputs[name] + steps[name] * sides[k] for k, name in enumerate(names)}
    shape = (2 * len(names), max(np.size(value) for value in inputs.values()))
    sides = sides * np.all(np.broadcast_to(possible(moved), shape), axis=-1, keepdims=True)
    found = function({name: inputs[name] + steps[name] * sides[k] for k, name in enumerate(names)})
    slopes = {}
    for k, name in enumerate(names):
        width = steps[name] * (sides[k, 2 * k] - sides[k, 2 * k + 1])
        rise = found[:, 2 * k] - found[:, 2 * k + 1]
        slopes[name] = np.divide(rise, width, out=np.zeros_like(rise), where=np.broadcast_to(width, rise.shape) > 0.0)
    return slopes


def _step(value: FloatArray, error: FloatArray) -> FloatArray:
    """Step of the differences by an input: a share of its size, or of its error where it is 0."""
    size = np.where(value != 0.0, np.abs(value), float(np.max(error)) or 1.0)
    return np.asarray(_STEP * size)


def draw(
    inputs: Mapping[str, FloatArray], errors: Mapping[str, FloatArray], count: int, rng: np.random.Generator
) -> dict[str, FloatArray]:
    """Draw inputs from normal distributions about their values, one set a row.

    Parameters
    ----------
    inputs : mapping
        Values, each a number or an array along the wall temperatures.
    errors : mapping
        Standard errors, or matrices whose square by the transpose is the covariance of all view factors, under the
        name "view_factors"; inputs without one stay as they are.
    count : int
        Sets.
    rng : numpy.random.Generator
        The source of the numbers.

    Returns
    -------
    dict
        Arrays of `count` rows for what varies.
    """
    drawn = dict(inputs)
    for name, error in errors.items():
        if name == "view_factors":
            names = [key for key in inputs if key.startswith("view_factor_")]
            moved = rng.standard_normal((count, len(names))) @ error.T
            drawn |= {key: inputs[key] + moved[:, [k]] for k, key in enumerate(names)}
        else:
            drawn[name] = inputs[name] + error * rng.standard_normal((count, 1))
    return drawn
