"""Which input makes how much of a prediction's uncertainty: the budget of errors of the heat transfer coefficient."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bedrad.heat.evaluation import Evaluation
from bedrad.heat.particle_wall_layer import ParticleWallLayer
from bedrad.heat.ranges import FloatArray, quiet
from bedrad.heat.uncertainties import Uncertainties, derivatives, draw

__all__ = ["Budget", "MonteCarlo", "monte_carlo", "propagate", "standard_errors"]

LABELS: Mapping[str, tuple[str, str, float]] = {
    "tube_diameter": ("tube diameter D", "mm", 1e3),
    "particle_diameter": ("particle diameter d", "um", 1e6),
    "velocity": ("velocity U", "m/s", 1.0),
    "solid_conductivity": ("conductivity of the particles k_s", "W/(m K)", 1.0),
    "porosity": ("porosity of the bulk", "", 1.0),
    "emissivity": ("emissivity in the bulk", "", 1.0),
    "packing_fraction": ("packing fraction of the wall layer", "", 1.0),
    "contacts_per_area": ("wall contacts", "1/mm2", 1e-6),
    "wall_layer_conductivity": ("wall-layer conductivity", "x", 1.0),
    "nc_distance": ("distance of no-contact particles", "radii", 1.0),
    "view_factors": ("view factors, penetration", "layers", 1.0),
    "gas_conductivity": ("conductivity of the gas", "x", 1.0),
    "bulk_conductivity": ("bulk conductivity", "x", 1.0),
    "wall_temperature": ("wall temperature", "K", 1.0),
    "heat_flux": ("heat flux", "kW/m2", 1e-3),
}
"""Text, unit and scale of an input in tables."""

_REDRAWS = 100


@dataclass(frozen=True, eq=False)
class Budget:
    """The uncertainty of h by input, to first order, against wall temperature.

    Parameters
    ----------
    names : tuple of str
        The m inputs; the view factors count as one, by what they let through (`radiation.penetration`).
    values, errors : (m, n) arrays
        Inputs and their standard errors; gas and bulk conductivity are relative to their models.
    elasticities : (m, n) array
        By how many percent h changes when the input changes by one: d ln h/d ln x; 0 where the input is 0.
    contributions : (m, n) array
        Standard error of h that comes from the input. [W/(m2 K)]
    total : (n,) array
        All of them together. [W/(m2 K)]
    heat_transfer_coefficient, wall_temperature : (n,) arrays
        [W/(m2 K)], [K]
    """

    names: tuple[str, ...]
    values: FloatArray
    errors: FloatArray
    elasticities: FloatArray
    contributions: FloatArray
    total: FloatArray
    heat_transfer_coefficient: FloatArray
    wall_temperature: FloatArray

    @property
    def shares(self) -> FloatArray:
        """(m, n) array: part of the variance of h that each input makes; 0 where nothing is uncertain."""
        variance = self.total**2
        shares = np.zeros_like(self.contributions)
        np.divide(self.contributions**2, variance, out=shares, where=np.broadcast_to(variance > 0.0, shares.shape))
        return shares

    def table(self, index: int | None = None) -> str:
        """Table of the inputs at one wall temperature, those that matter most first.

        Parameters
        ----------
        index : int, optional
            Which wall temperature; the hottest if left out.
        """
        index = int(np.argmax(self.wall_temperature)) if index is None else index
        h, total = float(self.heat_transfer_coefficient[index]), float(self.total[index])
        lines = [
            f"h {h:.1f} +- {total:.2g} W/(m2 K) ({100 * total / h:.2g} %) at {self.wall_temperature[index]:.2f} K",
            f"{'input':<36}{'value':>11} {'+-':>9} {'unit':<9}{'elasticity':>10}{'% of h':>9}{'share':>8}",
        ]
        order = sorted(
            range(len(self.names)),
            key=lambda i: (-self.contributions[i, index], -abs(self.elasticities[i, index]), self.names[i]),
        )
        for i in order:
            label, unit, scale = LABELS[self.names[i]]
            value, error = scale * self.values[i, index], scale * self.errors[i, index]
            lines.append(
                f"{label:<36}{value:>11.5g} {error:>9.2g} {unit:<9}{self.elasticities[i, index]:>+10.3f}"
                f"{100 * self.contributions[i, index] / h:>9.3f}{100 * self.shares[i, index]:>7.1f}%"
            )
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.table()


@dataclass(frozen=True, eq=False)
class MonteCarlo:
    """The uncertainty of h and Nu by drawing every input from its distribution, against wall temperature.

    Parameters
    ----------
    samples, seed : int
        Draws, and where they start.
    rejected : float
        Share of draws without a meaning, such as more contacts than the wall layer has solid; they were drawn again.
    seconds : float
        Run time. [s]
    mean, standard_deviation : dict of (n,) arrays
        By name of the result: "heat_transfer_coefficient", "nusselt" and the others of a prediction.
    interval : dict of (2, n) arrays
        Quantiles 2.5 % and 97.5 %.
    """

    samples: int
    seed: int
    rejected: float
    seconds: float
    mean: Mapping[str, FloatArray]
    standard_deviation: Mapping[str, FloatArray]
    interval: Mapping[str, FloatArray]

    def __str__(self) -> str:
        name = "heat_transfer_coefficient"
        lines = [
            f"{self.samples} draws from seed {self.seed}, {100 * self.rejected:.2g} % drawn again, {self.seconds:.2g} s"
        ]
        for mean, sigma, low, high in zip(
            self.mean[name], self.standard_deviation[name], *self.interval[name], strict=True
        ):
            error = sigma / math.sqrt(2.0 * self.samples)
            lines.append(
                f"h {mean:.1f} +- {sigma:.2f} W/(m2 K), itself +- {error:.1g}; 95 % from {low:.1f} to {high:.1f}"
            )
        return "\n".join(lines)


def standard_errors(evaluation: Evaluation, given: Uncertainties) -> dict[str, FloatArray]:
    """Standard errors of the inputs by name; under "view_factors" a square root of their covariance."""
    layer = evaluation.layer
    own: dict[str, FloatArray] = {}
    if isinstance(layer, ParticleWallLayer):
        gas = evaluation.gas_conductivity(evaluation.wall_temperature)
        own["wall_layer_conductivity"] = layer.error(evaluation.system.solid_conductivity, gas)
    else:
        for name in ("packing_fraction", "contacts_per_area", "nc_distance"):
            own[name] = np.asarray(getattr(layer, f"{name}_error"), dtype=np.float64)
    errors = {}
    for name, value in evaluation.inputs().items():
        if name.startswith("view_factor_"):
            continue
        error = np.asarray(getattr(given, name, 0.0), dtype=np.float64)
        if name in own:
            # measured layers and bedrad's correlations have errors of their own; the others are those of Watkins'
            relative = float(error) if evaluation.layer_correlation == "watkins" else 0.0
            error = np.hypot(own[name], relative * value)
        errors[name] = error
    covariance = evaluation.factors.covariance
    values, vectors = np.linalg.eigh(np.asarray(covariance))
    errors["view_factors"] = vectors * np.sqrt(np.maximum(values, 0.0))
    return errors


def propagate(
    evaluation: Evaluation, found: Mapping[str, FloatArray], errors: Mapping[str, FloatArray]
) -> tuple[Budget, dict[str, FloatArray]]:
    """Propagate standard errors to first order.

    Parameters
    ----------
    evaluation : Evaluation
        The models and their inputs.
    found : mapping
        Results for the inputs as they stand.
    errors : mapping
        From `standard_errors`.

    Returns
    -------
    Budget
        Of the heat transfer coefficient.
    dict
        Standard errors of every result by name, arrays along the wall temperatures.
    """
    inputs = evaluation.inputs()
    results = tuple(found)
    coefficient = results.index("heat_transfer_coefficient")
    n = evaluation.wall_temperature.size
    names = [name for name in inputs if not name.startswith("view_factor_")] + ["view_factors"]
    slopes = derivatives(lambda x: np.stack(list(_quiet(evaluation, x).values())), inputs, evaluation.possible, errors)
    values, sigmas, elasticities, parts = [], [], [], []
    for name in names:
        if name == "view_factors":
            factors = [key for key in inputs if key.startswith("view_factor_")]
            steps = np.arange(1.0, len(factors) + 1.0)
            value = float(steps @ evaluation.factors.to_layers)
            sigma = float(np.linalg.norm(steps @ errors["view_factors"]))
            gradient = np.stack([slopes[key] for key in factors])
            part = np.linalg.norm(np.einsum("frn,fk->krn", gradient, errors["view_factors"]), axis=0)
            scaled = np.einsum("f,fn->n", evaluation.factors.to_layers, gradient[:, coefficient])
        else:
            value, sigma = inputs[name], errors[name]  # type: ignore[assignment]
            part = np.abs(slopes[name] * sigma)
            scaled = slopes[name][coefficient] * value
        values.append(np.broadcast_to(value, n))
        sigmas.append(np.broadcast_to(sigma, n))
        elasticities.append(scaled / found["heat_transfer_coefficient"])
        parts.append(part)
    total = np.sqrt(np.sum(np.square(parts), axis=0))
    budget = Budget(
        names=tuple(names),
        values=np.array(values),
        errors=np.array(sigmas),
        elasticities=np.array(elasticities),
        contributions=np.array([part[coefficient] for part in parts]),
        total=total[coefficient],
        heat_transfer_coefficient=found["heat_transfer_coefficient"],
        wall_temperature=evaluation.wall_temperature,
    )
    return budget, dict(zip(results, total, strict=True))


def _quiet(evaluation: Evaluation, x: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Results without the warnings, which the values themselves have given already."""
    with quiet():
        return evaluation.evaluate(x, partial=True)


def monte_carlo(evaluation: Evaluation, errors: Mapping[str, FloatArray], samples: int, seed: int) -> MonteCarlo:
    """Draw the inputs from normal distributions and evaluate all models for each draw.

    Parameters
    ----------
    evaluation : Evaluation
        The models and their inputs.
    errors : mapping
        From `standard_errors`.
    samples : int
        Draws, at least 2.
    seed : int
        Seed of the draws.

    Raises
    ------
    ValueError
        If there are fewer than two samples, or hardly a draw has a meaning.
    """
    if samples < 2:
        raise ValueError(f"samples is {samples}; expected at least 2")
    started = time.perf_counter()
    rng = np.random.default_rng(seed)
    inputs = evaluation.inputs()
    uncertain = {name: error for name, error in errors.items() if np.any(error)}
    kept, drawn, parts = 0, 0, []
    while kept < samples:
        count = min(samples - kept, 2000)
        x = draw(inputs, uncertain, count, rng)
        shape = (count, evaluation.wall_temperature.size)
        good = np.broadcast_to(evaluation.possible(x), shape).all(axis=-1)
        drawn += count
        if drawn > _REDRAWS * samples:
            raise ValueError(f"only {kept} of {drawn} draws have a meaning; the standard errors are too large")
        rows = {name: value[good] if value.ndim == 2 else value for name, value in x.items()}
        if good.any():
            found = _quiet(evaluation, rows)
            many = {name: np.broadcast_to(value, (int(good.sum()), shape[1])) for name, value in found.items()}
            # a draw whose heat flux no flow can take has no coefficient
            whole = np.isfinite(many["heat_transfer_coefficient"]).all(axis=1)
            parts.append({name: value[whole] for name, value in many.items()})
            kept += int(whole.sum())
    results = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return MonteCarlo(
        samples=samples,
        seed=seed,
        rejected=1.0 - kept / drawn,
        seconds=time.perf_counter() - started,
        mean={name: value.mean(axis=0) for name, value in results.items()},
        standard_deviation={name: value.std(axis=0, ddof=1) for name, value in results.items()},
        interval={name: np.quantile(value, (0.025, 0.975), axis=0) for name, value in results.items()},
    )
