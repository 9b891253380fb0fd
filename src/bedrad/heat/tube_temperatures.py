"""Wall and mean temperature along a heated tube with properties that change with temperature.

The mean temperature follows from the heat taken up (Watkins 2018, eq. 12-14), the wall temperature from the local
heat flux and the Nusselt number of the complete two-layer model (eq. 73) with properties and inverse Graetz number of
the place. The model knows neither of properties that change along the tube nor of a flux that does: both enter as if
they had been the local ones from the inlet on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import elementwise

from bedrad.heat import two_layer
from bedrad.heat.energy_balance import SpecificHeat, cumulative_heat, mean_temperature
from bedrad.heat.materials import Material
from bedrad.heat.ranges import FloatArray, finite, positive, quiet

__all__ = ["Property", "PropertyTemperature", "TubeTemperatures", "tube_temperatures"]

Property = float | Callable[..., ArrayLike]
"""A number, or a function that takes an array of temperatures [K]."""

PropertyTemperature = Literal["mean", "film", "wall", "layers"]
"""Where the conductivities are taken: at the mean temperature, the wall's, halfway between ("film"), or the bulk's at
the mean and the wall layer's at the wall ("layers")."""

_HOTTEST = 1e4
"""Wall temperature beyond which the search ends. [K]"""

_GROWTH = 1.3
"""Steps of the search grow slowly, so that it does not ask for properties far beyond the solution."""


@dataclass(frozen=True, eq=False)
class TubeTemperatures:
    """Temperatures of a flow and of the wall along a heated tube.

    Parameters
    ----------
    position : (n,) array
        Positions along the tube; the first is the inlet of the heated length. [m]
    heat_flux : (n,) array
        Flux into the flow. [W/m2]
    heat_rate : (n,) array
        Heat taken up since the inlet. [W]
    mean_temperature, wall_temperature : (n,) arrays
        [K]
    nusselt : (n,) array
        Nu = h D/k_b by the complete two-layer model; infinite at the inlet.
    heat_transfer_coefficient : (n,) array
        h on the difference of wall and mean temperature; infinite at the inlet. [W/(m2 K)]
    z_star, conductivity_ratio : (n,) arrays
        Inverse Graetz number and k_b/k_wa of the place.
    property_temperature : str
        Where the conductivities were taken.
    terms : (n,) array of int
        Terms of the series behind each Nu; 0 where none was needed or the transform was inverted.
    error_bound : (n,) array
        Bound of the relative error of each Nu by what was neglected.
    """

    position: FloatArray
    heat_flux: FloatArray
    heat_rate: FloatArray
    mean_temperature: FloatArray
    wall_temperature: FloatArray
    nusselt: FloatArray
    heat_transfer_coefficient: FloatArray
    z_star: FloatArray
    conductivity_ratio: FloatArray
    property_temperature: PropertyTemperature
    terms: NDArray[np.int64]
    error_bound: FloatArray

    def __str__(self) -> str:
        T, wall = self.mean_temperature, self.wall_temperature
        return (
            f"flow from {T[0]:.2f} to {T[-1]:.2f} K over {self.position[-1] - self.position[0]:g} m, "
            f"{self.heat_rate[-1]:.4g} W; at the outlet wall {wall[-1]:.2f} K, Nu {self.nusselt[-1]:.4g}, "
            f"h {self.heat_transfer_coefficient[-1]:.4g} W/(m2 K), z* {self.z_star[-1]:.3g} "
            f"(conductivities at: {self.property_temperature})"
        )


@dataclass(frozen=True, eq=False)
class _Tube:
    """What Nu depends on besides temperature."""

    diameter: float
    diameter_ratio: float
    mass_flux: float
    bulk: Property
    wall_layer: Property
    choice: PropertyTemperature
    tolerance: float

    def conductivities(self, T_mean: FloatArray, T_wall: FloatArray) -> tuple[FloatArray, FloatArray]:
        film = 0.5 * (T_mean + T_wall)
        choices = {"mean": (T_mean, T_mean), "film": (film, film), "wall": (T_wall, T_wall), "layers": (T_mean, T_wall)}
        at_bulk, at_wall = choices[self.choice]
        return (
            _values("bulk_conductivity", self.bulk, at_bulk),
            _values("wall_layer_conductivity", self.wall_layer, at_wall),
        )

    def z_star(self, distance: FloatArray, k_b: FloatArray, c_p: FloatArray) -> FloatArray:
        return np.asarray(two_layer.inverse_graetz(distance, k_b, self.mass_flux, c_p, self.diameter))

    def difference(
        self, T_wall: FloatArray, T_mean: FloatArray, distance: FloatArray, c_p: FloatArray, q: FloatArray
    ) -> FloatArray:
        """Wall less mean temperature for properties that go with a wall temperature. [K]"""
        k_b, k_wa = self.conductivities(T_mean, T_wall)
        z = self.z_star(distance, k_b, c_p)
        Nu = two_layer.nusselt(self.diameter_ratio, k_b / k_wa, z, tolerance=self.tolerance)
        return np.asarray(q * self.diameter / (Nu * k_b))


def _values(name: str, given: Property, temperature: FloatArray, unit: str = "W/(m K)") -> FloatArray:
    values = positive(name, given(temperature) if callable(given) else given, unit)
    if values.shape not in ((), temperature.shape):
        raise ValueError(
            f"{name} gives the shape {values.shape} for {temperature.size} temperatures; expected one number, "
            "or a function that gives one for each"
        )
    return np.broadcast_to(values, temperature.shape)


def _number(name: str, value: ArrayLike, unit: str) -> float:
    x = positive(name, value, unit)
    if x.ndim:
        raise ValueError(f"{name} has the shape {x.shape}; expected one number")
    return float(x)


def _wall_temperature(
    tube: _Tube, T_mean: FloatArray, distance: FloatArray, c_p: FloatArray, q: FloatArray
) -> FloatArray:
    """Wall temperature nearest to the mean one at which both sides of T_w - T_m = q/h(T_w) agree."""
    start = tube.difference(T_mean, T_mean, distance, c_p, q)
    if tube.choice == "mean":
        return np.asarray(T_mean + start)
    sign = np.sign(q)

    def beyond(T_wall: FloatArray, *place: FloatArray) -> FloatArray:
        return np.asarray(np.sign(place[3]) * (T_wall - place[0] - tube.difference(T_wall, *place)))

    near, far = T_mean.copy(), np.clip(T_mean + start, 1e-3 * T_mean, _HOTTEST)
    for power in range(1, 60):
        short = beyond(far, T_mean, distance, c_p, q) < 0.0
        if not np.any(short):
            break
        _refuse_ends(far, T_mean, short, distance, q)
        near = np.where(short, far, near)
        further = np.clip(T_mean + start * _GROWTH**power, 1e-3 * T_mean, _HOTTEST)
        far = np.where(short, further, far)
    low, high = np.where(sign > 0, near, far), np.where(sign > 0, far, near)
    found = elementwise.find_root(
        beyond, (low, high), args=(T_mean, distance, c_p, q), tolerances={"xrtol": 1e-14, "fatol": 0.0}
    )
    if not np.all(found.success):
        raise ArithmeticError("the wall temperature was not found between its bounds")
    return np.asarray(found.x)


def _refuse_ends(
    far: FloatArray, T_mean: FloatArray, short: NDArray[np.bool_], distance: FloatArray, q: FloatArray
) -> None:
    stuck = short & ((far >= _HOTTEST) | (far <= 1e-3 * T_mean))
    if np.any(stuck):
        i = int(np.flatnonzero(stuck)[0])
        limit = f"below {_HOTTEST:g} K" if q[i] > 0.0 else "above 0 K"
        raise ValueError(
            f"heat_flux is {q[i]:g} W/m2 at {distance[i]:g} m from the inlet, mean temperature {T_mean[i]:.1f} K; "
            f"expected one that a wall {limit} can carry with these conductivities"
        )


def tube_temperatures(
    position: ArrayLike,
    heat_flux: ArrayLike,
    *,
    tube_diameter: float,
    particle_diameter: float,
    mass_flow: float,
    inlet_temperature: float,
    specific_heat: SpecificHeat,
    bulk_conductivity: Property,
    wall_layer_conductivity: Property,
    property_temperature: PropertyTemperature = "mean",
    tolerance: float = 1e-10,
) -> TubeTemperatures:
    """Wall and mean temperature of a flow along a heated tube (Watkins 2018, eq. 12-14 and 73).

    Parameters
    ----------
    position : (n,) array
        Increasing positions along the tube, the first at the inlet of the heated length. [m]
    heat_flux : float or (n,) array
        Heat flux into the flow at the positions, taken as linear between them; negative where it is cooled. [W/m2]
    tube_diameter, particle_diameter : float
        Inner diameter of the tube, diameter of the particles. [m]
    mass_flow : float
        [kg/s]
    inlet_temperature : float
        [K]
    specific_heat : float, Material or callable
        c_p, a number or a function of temperature [K]; taken at the mean temperature. [J/(kg K)]
    bulk_conductivity, wall_layer_conductivity : float or callable
        k_b and k_wa (with radiation, if any), numbers or functions of temperature [K]. [W/(m K)]
    property_temperature : {"mean", "film", "wall", "layers"}
        Where the conductivities are taken: at the mean temperature (the source's chapter 4), halfway to the wall's, at
        the wall's, or the bulk's at the mean and the wall layer's at the wall. All but the first make the
        wall temperature the root of `T_w = T_m + q/h(T_w)`; of several roots the nearest to T_m is taken.
    tolerance : float
        Largest relative error of Nu from terms left out, from 1e-12 to 1e-2.

    Returns
    -------
    TubeTemperatures
        Arrays over the positions.

    Raises
    ------
    ValueError
        If an input or a property has no meaning, positions do not increase, cooling reaches absolute zero, or no wall
        below 10000 K carries the flux.

    Warns
    -----
    RangeWarning
        As the properties warn, or for k_b/k_wa outside 1e-6 to 1e6.
    """
    if property_temperature not in get_args(PropertyTemperature):
        names = ", ".join(get_args(PropertyTemperature))
        raise ValueError(f"property_temperature is {property_temperature!r}; expected one of {names}")
    D = _number("tube_diameter", tube_diameter, "m")
    ratio = D / _number("particle_diameter", particle_diameter, "m")
    flow, T_in = _number("mass_flow", mass_flow, "kg/s"), _number("inlet_temperature", inlet_temperature, "K")
    z, q = np.asarray(position, dtype=np.float64), finite("heat_flux", heat_flux, "W/m2")
    if q.shape not in ((), z.shape):
        raise ValueError(f"heat_flux has the shape {q.shape}; expected a number, or one for each of {z.size} positions")
    q = np.array(np.broadcast_to(q, z.shape))
    rate = cumulative_heat(z, q, math.pi * D)
    T_mean = np.asarray(mean_temperature(T_in, rate, flow, specific_heat))
    c_p = _specific_heats(specific_heat, T_mean)
    mass_flux = flow / (0.25 * math.pi * D**2)
    tube = _Tube(D, ratio, mass_flux, bulk_conductivity, wall_layer_conductivity, property_temperature, tolerance)
    distance, T_wall = z - z[0], T_mean.copy()
    moved = np.flatnonzero((distance > 0.0) & (q != 0.0))
    with quiet():
        # told once, of the final temperatures
        T_wall[moved] = _wall_temperature(tube, *(x[moved] for x in (T_mean, distance, c_p, q)))
    if np.any(T_wall <= 0.0):
        i = int(np.argmin(T_wall))
        raise ValueError(f"heat_flux is {q[i]:g} W/m2 at {distance[i]:g} m from the inlet; expected a wall above 0 K")
    k_b, k_wa = tube.conductivities(T_mean, T_wall)
    z_star = tube.z_star(distance, k_b, c_p)
    found = two_layer.nusselt_solution(ratio, k_b / k_wa, z_star, tolerance=tolerance)
    return TubeTemperatures(
        position=z,
        heat_flux=q,
        heat_rate=rate,
        mean_temperature=T_mean,
        wall_temperature=T_wall,
        nusselt=found.nusselt,
        heat_transfer_coefficient=np.asarray(found.nusselt * k_b / D),
        z_star=z_star,
        conductivity_ratio=np.asarray(k_b / k_wa),
        property_temperature=property_temperature,
        terms=found.terms,
        error_bound=found.error_bound,
    )


def _specific_heats(specific_heat: SpecificHeat, T: FloatArray) -> FloatArray:
    if isinstance(specific_heat, Material):
        with quiet():
            # the energy balance has told of an extrapolation
            return np.asarray(specific_heat.specific_heat(T))
    return _values("specific_heat", specific_heat, T, "J/(kg K)")
