"""All models of a prediction put together, as one function of every input that may be uncertain."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.heat import correlations, cylinder, flow_correlations, wall_layer
from bedrad.heat.bulk import BulkFit
from bedrad.heat.bulk_choice import Bulk, with_and_without_radiation
from bedrad.heat.particle_wall_layer import ParticleWallLayer
from bedrad.heat.property_temperatures import PropertyTemperature, PropertyTemperatures, search
from bedrad.heat.radiation import STEFAN_BOLTZMANN
from bedrad.heat.ranges import FloatArray, quiet
from bedrad.heat.systems import Correlation, System, ViewFactors, WallLayer
from bedrad.heat.two_layer import nusselt_developed

__all__ = ["Evaluation"]

Inputs = Mapping[str, FloatArray]

_POSITIVE = ("particle_diameter", "solid_conductivity", "gas_conductivity", "bulk_conductivity", "wall_temperature")


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What does not vary in a prediction, and the function of what may.

    Parameters
    ----------
    system : System
        Tube and particles.
    layer : WallLayer or ParticleWallLayer
        The wall layer at these values.
    layer_correlation, factor_correlation : {"watkins", "bedrad"} or None
        By which correlation the layer and the view factors follow diameters and velocity; None where they are
        measured and do not.
    factors : ViewFactors
        The view factors at these values.
    bulk : Bulk, BulkFit or None
        Given conductivities, a fit, or None for the model of Zehner, Bauer and Schluender.
    gas_conductivity : callable
        Conductivity [W/(m K)] of the gas at temperatures [K].
    property_temperature : {"wall", "mean", "layers"}
        At which temperature the properties are taken.
    wall_temperature : (n,) array
        [K]
    heat_flux : (n,) array or None
        Heat flux from the wall, positive into the flow. [W/m2]
    """

    system: System
    layer: WallLayer | ParticleWallLayer
    layer_correlation: Correlation | None
    factors: ViewFactors
    factor_correlation: Correlation | None
    bulk: Bulk | BulkFit | None
    gas_conductivity: Callable[[FloatArray], FloatArray]
    property_temperature: PropertyTemperature
    wall_temperature: FloatArray
    heat_flux: FloatArray | None

    def inputs(self) -> dict[str, FloatArray]:
        """Every input by name, as it stands; conductivities of gas, bulk and a layer of particles as factors, 1."""
        names = ("tube_diameter", "particle_diameter", "velocity", "solid_conductivity", "porosity", "emissivity")
        values = {name: getattr(self.system, name) for name in names}
        if isinstance(self.layer, ParticleWallLayer):
            values["wall_layer_conductivity"] = 1.0
        else:
            values |= {name: getattr(self.layer, name) for name in ("packing_fraction", "contacts_per_area")}
            if self.layer.form != "simplified":
                values["nc_distance"] = self.layer.nc_distance
        values |= {f"view_factor_{k}": F for k, F in enumerate(self.factors.to_layers, start=1)}
        values |= {"gas_conductivity": 1.0, "bulk_conductivity": 1.0, "wall_temperature": self.wall_temperature}
        if self.heat_flux is not None:
            values["heat_flux"] = self.heat_flux
        return {name: np.asarray(value, dtype=np.float64) for name, value in values.items()}

    def possible(self, x: Inputs) -> NDArray[np.bool_]:
        """Whether inputs have a meaning: what must be positive is, and the contacts fit into the wall layer."""
        full = self._with_correlations(x)
        good = np.asarray(True)
        for name in _POSITIVE:
            good = good & (full[name] > 0.0)
        good = good & (full["velocity"] >= 0.0) & (full["porosity"] > 0.0) & (full["porosity"] < 1.0)
        good = good & (full["emissivity"] > 0.0) & (full["emissivity"] <= 1.0)
        layers = range(1, len(self.factors.to_layers) + 1)
        penetration = sum((k * full[f"view_factor_{k}"] for k in layers), start=np.zeros(1))
        good = good & (penetration >= 0.0) & (penetration <= len(layers))
        A = full["tube_diameter"] / full["particle_diameter"]
        if isinstance(self.layer, ParticleWallLayer):
            return np.asarray(good & (A > 1.0) & (full["wall_layer_conductivity"] > 0.0))
        phi = full["packing_fraction"]
        distance = full.get("nc_distance", np.asarray(wall_layer.NC_DISTANCE))
        least = cylinder.SMALLEST_DIAMETER_RATIO if self.layer.form == "cylinder" else 1.0
        good = good & (least < A) & (phi > 0.0) & (phi <= 1.0) & (full["contacts_per_area"] >= 0.0)
        good = good & (distance >= 0.0) & (distance < 1.0)
        size = np.asarray(2.0 * math.pi / 3.0)
        if self.layer.form == "cylinder":
            size = cylinder.particle_volume(np.maximum(A, least))
        contacts = size * full["contacts_per_area"] * (0.5 * full["particle_diameter"]) ** 2
        return np.asarray(good & (contacts <= phi * (1.0 - 0.5 / np.maximum(A, 1.0))))

    def _with_correlations(self, x: Inputs) -> dict[str, FloatArray]:
        """Move wall layer and view factors as their correlations move with diameters and velocity."""
        full = dict(x)
        # a draw below zero is refused by `possible`; until then the correlations shall see something
        diameter = np.maximum(x["particle_diameter"], 1e-12)
        new = (np.maximum(x["tube_diameter"] / diameter, 1.0 + 1e-9), np.maximum(x["velocity"], 0.0), diameter)
        system = self.system
        old = tuple(np.asarray(v) for v in (system.diameter_ratio, system.velocity, system.particle_diameter))
        if self.layer_correlation is not None:
            for name, function in _LAYER[self.layer_correlation].items():
                if name in x:
                    full[name] = x[name] + function(*new) - function(*old)
        if self.factor_correlation == "bedrad":
            for k in range(1, len(self.factors.to_layers) + 1):
                name = f"view_factor_{k}"
                full[name] = x[name] + _fitted(name, *new) - _fitted(name, *old)
        return full

    def evaluate(self, x: Inputs, *, partial: bool = False) -> dict[str, FloatArray]:
        """Evaluate all models: conductivities, Nusselt numbers and coefficients, with radiation and without.

        Parameters
        ----------
        x : mapping
            Inputs by name, see `inputs`.
        partial : bool
            Give nan, and do not refuse, where the heat flux needs a flow below absolute zero.

        Raises
        ------
        ValueError
            If an input has no meaning, or the heat flux needs a flow below absolute zero.

        Warns
        -----
        RangeWarning
            Outside the range of a model.
        """
        full = self._with_correlations(x)
        # the search passes through temperatures that are not the answer
        with quiet():
            temperatures = self._temperatures(full)
        results = self._at(full, temperatures)
        if "heat_flux" not in full:
            return results
        good = temperatures.found & (results["mean_temperature"] > 0.0)
        if not partial and not np.all(good):
            raise ValueError(
                f"heat_flux is {float(np.max(np.abs(full['heat_flux']))):g} W/m2; expected less: no flow above "
                f"absolute zero takes it from a wall of {float(np.min(full['wall_temperature'])):.2f} K"
            )
        return {name: np.where(good, values, np.nan) for name, values in results.items()}

    def _temperatures(self, x: Inputs) -> PropertyTemperatures:
        """Find the temperatures that the properties are taken at, from the heat flux where they need it."""
        wall = x["wall_temperature"]
        if self.property_temperature == "wall":
            return PropertyTemperatures(wall, wall, None, np.ones(1, dtype=bool))
        return search(
            self.property_temperature,
            wall,
            x["heat_flux"],
            x["particle_diameter"],
            x["tube_diameter"],
            len(self.factors.to_layers),
            lambda temperatures: self._at(x, temperatures),
        )

    def _at(self, x: Inputs, temperatures: PropertyTemperatures) -> dict[str, FloatArray]:
        A = x["tube_diameter"] / x["particle_diameter"]
        k_wa = self._conductive(x, x["gas_conductivity"] * self.gas_conductivity(temperatures.wall_layer))
        k_rad = self._radiative(x, temperatures)
        k_b, k_b_without = self._bulk(x, temperatures.bulk)
        nusselt = nusselt_developed(A, k_b / (k_wa + k_rad))
        nusselt_without = nusselt_developed(A, k_b_without / k_wa)
        h, h_without = nusselt * k_b / x["tube_diameter"], nusselt_without * k_b_without / x["tube_diameter"]
        wall = x["wall_temperature"]
        found = {
            "wall_layer_conductivity": k_wa,
            "radiative_conductivity": k_rad,
            "bulk_conductivity": k_b,
            "bulk_conductivity_without": k_b_without,
            "nusselt": nusselt,
            "nusselt_without": nusselt_without,
            "heat_transfer_coefficient": h,
            "heat_transfer_coefficient_without": h_without,
            "wall_layer_temperature": temperatures.wall_layer,
            "bulk_temperature": temperatures.bulk,
            "mean_temperature": wall - x["heat_flux"] / h if "heat_flux" in x else np.full(np.shape(wall), np.nan),
        }
        return dict(zip(found, np.broadcast_arrays(*found.values()), strict=True))

    def _conductive(self, x: Inputs, gas: FloatArray) -> FloatArray:
        if isinstance(self.layer, ParticleWallLayer):
            return np.asarray(x["wall_layer_conductivity"] * self.layer.conductivity(x["solid_conductivity"], gas))
        return wall_layer.conductivity(
            gas,
            x["solid_conductivity"],
            x["tube_diameter"] / x["particle_diameter"],
            x["particle_diameter"],
            x["contacts_per_area"],
            x["packing_fraction"],
            x.get("nc_distance", wall_layer.NC_DISTANCE),
            self.layer.form,
        )

    def _radiative(self, x: Inputs, temperatures: PropertyTemperatures) -> FloatArray:
        """Radiative conductivity: eq. 50, or from eq. 48 with the same equal steps but every fourth power."""
        factors = [x[f"view_factor_{k}"] for k in range(1, len(self.factors.to_layers) + 1)]
        wall = x["wall_temperature"] if self.property_temperature != "mean" else temperatures.wall_layer
        cubes = np.zeros(1)
        for k, F in enumerate(factors, start=1):
            T = wall if temperatures.step is None else wall - k * temperatures.step
            cubes = cubes + k * F * (wall + T) * (wall * wall + T * T)
        return np.asarray(0.5 * x["particle_diameter"] * STEFAN_BOLTZMANN * cubes)

    def _bulk(self, x: Inputs, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        if isinstance(self.bulk, Bulk):
            found = np.asarray(self.bulk.with_radiation), np.asarray(self.bulk.without_radiation)
        else:
            found = with_and_without_radiation(
                self.bulk,
                x["gas_conductivity"] * self.gas_conductivity(temperature),
                x["solid_conductivity"],
                x["porosity"],
                x["particle_diameter"],
                temperature,
                x["emissivity"],
            )
        return x["bulk_conductivity"] * found[0], x["bulk_conductivity"] * found[1]


def _fitted(name: str, A: FloatArray, velocity: FloatArray, diameter: FloatArray) -> FloatArray:
    """A quantity by bedrad's correlation."""
    return flow_correlations.estimate(name, A, velocity, diameter, warn=False)[0]  # type: ignore[arg-type]


def _contacts(ratio: FloatArray, A: FloatArray, diameter: FloatArray) -> FloatArray:
    return np.asarray(ratio * correlations.maximum_contacts(A, diameter))


_LAYER: Mapping[str, Mapping[str, Callable[..., FloatArray]]] = {
    "watkins": {
        "packing_fraction": correlations.unchecked_packing_fraction,
        "contacts_per_area": lambda A, U, d: _contacts(correlations.unchecked_contact_ratio(A, U, d), A, d),
    },
    "bedrad": {
        "packing_fraction": lambda A, U, d: _fitted("packing_fraction", A, U, d),
        "contacts_per_area": lambda A, U, d: _contacts(_fitted("contact_ratio", A, U, d), A, d),
        "nc_distance": lambda A, U, d: _fitted("nc_distance", A, U, d),
    },
}
