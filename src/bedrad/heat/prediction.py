"""Heat transfer to a dense flow in a hot tube, all models put together (Watkins 2018, section 5.3)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import radiation
from bedrad.heat.budget import Budget, MonteCarlo, monte_carlo, propagate, standard_errors
from bedrad.heat.bulk_choice import Bulk, BulkModel, bulk_conductivity, fit_for
from bedrad.heat.evaluation import Evaluation
from bedrad.heat.gas import air_conductivity
from bedrad.heat.particle_wall_layer import ParticleWallLayer
from bedrad.heat.property_temperatures import PropertyTemperature, check_property_temperature
from bedrad.heat.ranges import FloatArray, plain, positive
from bedrad.heat.systems import TABLE_5_1, Correlation, System, ViewFactors, WallLayer
from bedrad.heat.uncertainties import Uncertainties

__all__ = [
    "TABLE_5_1",
    "Budget",
    "Bulk",
    "BulkModel",
    "Correlation",
    "MonteCarlo",
    "ParticleWallLayer",
    "Prediction",
    "PropertyTemperature",
    "System",
    "Uncertainties",
    "ViewFactors",
    "WallLayer",
    "bulk_conductivity",
    "largest_wall_radiation_effect",
    "predict",
]

_RESULTS = (
    "wall_layer_conductivity",
    "radiative_conductivity",
    "nusselt",
    "nusselt_without",
    "heat_transfer_coefficient",
    "heat_transfer_coefficient_without",
)
"""Results that carry a standard error."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """Predicted heat transfer against wall temperature; `<name>_without` is without radiation in both layers.

    Parameters
    ----------
    system : System
        Tube and particles.
    wall_layer : WallLayer or ParticleWallLayer
        What was taken for the wall layer.
    view_factors : ViewFactors
        What was taken for the view factors.
    bulk_model : str
        Where the bulk conductivity comes from.
    wall_temperature : (n,) array
        [K]
    property_temperature : str
        At which temperature the properties were taken: "wall", "mean" or "layers".
    wall_layer_temperature, bulk_temperature : (n,) arrays
        Those temperatures, for the wall layer and for the bulk. [K]
    mean_temperature : (n,) array
        Mean temperature of the flow, T_w - q/h; nan without a heat flux. [K]
    gas_conductivity : (n,) array
        k_g at the temperature of the wall layer. [W/(m K)]
    wall_layer_conductivity, radiative_conductivity : (n,) arrays
        k_wa by conduction, k_rad. [W/(m K)]
    bulk_conductivity, bulk_conductivity_without : (n,) arrays
        k_b. [W/(m K)]
    conductivity_ratio, conductivity_ratio_without : (n,) arrays
        kappa = k_b/(k_wa + k_rad), and k_b/k_wa without radiation.
    nusselt, nusselt_without : (n,) arrays
        Nu = h D/k_b, each with its own k_b.
    heat_transfer_coefficient, heat_transfer_coefficient_without : (n,) arrays
        h. [W/(m2 K)]
    <name>_error : (n,) arrays
        Standard errors, to first order, from those of the wall layer, of the view factors with their covariance, and
        of the given `Uncertainties`.
    budget : Budget
        Which input makes how much of the uncertainty of h, and how h answers to every input.
    monte_carlo : MonteCarlo or None
        The same uncertainty by drawing the inputs, if samples were asked for.
    """

    system: System
    wall_layer: WallLayer | ParticleWallLayer
    view_factors: ViewFactors
    bulk_model: str
    wall_temperature: FloatArray
    property_temperature: PropertyTemperature
    wall_layer_temperature: FloatArray
    bulk_temperature: FloatArray
    mean_temperature: FloatArray
    gas_conductivity: FloatArray
    wall_layer_conductivity: FloatArray
    radiative_conductivity: FloatArray
    bulk_conductivity: FloatArray
    bulk_conductivity_without: FloatArray
    conductivity_ratio: FloatArray
    conductivity_ratio_without: FloatArray
    nusselt: FloatArray
    nusselt_without: FloatArray
    heat_transfer_coefficient: FloatArray
    heat_transfer_coefficient_without: FloatArray
    wall_layer_conductivity_error: FloatArray
    radiative_conductivity_error: FloatArray
    nusselt_error: FloatArray
    nusselt_without_error: FloatArray
    heat_transfer_coefficient_error: FloatArray
    heat_transfer_coefficient_without_error: FloatArray
    budget: Budget
    monte_carlo: MonteCarlo | None

    @property
    def radiation_gain(self) -> FloatArray:
        """What radiation adds to h: h with radiation over h without, less 1."""
        return plain(self.heat_transfer_coefficient / self.heat_transfer_coefficient_without - 1.0)

    @property
    def radiation_share(self) -> FloatArray:
        """What part of h radiation makes: 1 less h without radiation over h with it."""
        return plain(1.0 - self.heat_transfer_coefficient_without / self.heat_transfer_coefficient)

    def __str__(self) -> str:
        s = self.system
        fluxed = bool(np.isfinite(self.mean_temperature).any())
        lines = [
            f"{s.name or 'tube'}: D {s.tube_diameter * 1e3:.4g} mm, d {s.particle_diameter * 1e6:.4g} um, "
            f"A {s.diameter_ratio:.4g}, U {s.velocity:g} m/s, bulk by {self.bulk_model}",
            "  T_w [K]    k_wa   k_rad     k_b      Nu  h [W/(m2 K)]  without radiation" + "  T_m [K]" * fluxed,
        ]
        columns = (
            self.wall_temperature,
            self.wall_layer_conductivity,
            self.radiative_conductivity,
            self.bulk_conductivity,
            self.nusselt,
            self.heat_transfer_coefficient,
            self.heat_transfer_coefficient_without,
            self.mean_temperature,
        )
        for T, k_wa, k_rad, k_b, nu, h, h0, T_m in zip(*(np.atleast_1d(c) for c in columns), strict=True):
            line = f"{T:9.2f}  {k_wa:.4f}  {k_rad:.4f}  {k_b:.4f}  {nu:6.3f}  {h:12.1f}  {h0:17.1f}"
            lines.append(line + (f"  {T_m:7.2f}" if fluxed else ""))
        return "\n".join(lines)


def _matched(bulk: Bulk, temperature: FloatArray) -> Bulk:
    """Check given bulk conductivities and spread them over the temperatures."""
    spread = []
    for name in ("with_radiation", "without_radiation"):
        values = positive(f"bulk.{name}", getattr(bulk, name), "W/(m K)")
        if values.ndim and values.shape != temperature.shape:
            raise ValueError(
                f"bulk.{name} has the shape {values.shape}; expected one number or the shape of "
                f"wall_temperature, {temperature.shape}"
            )
        spread.append(plain(np.broadcast_to(values, temperature.shape)))
    return Bulk(spread[0], spread[1], bulk.model)


def predict(
    system: System,
    wall_temperature: ArrayLike,
    wall_layer: WallLayer | ParticleWallLayer | None = None,
    view_factors: ViewFactors | None = None,
    bulk: Bulk | BulkModel = "auto",
    correlation: Correlation = "watkins",
    *,
    property_temperature: PropertyTemperature = "wall",
    heat_flux: ArrayLike | None = None,
    gas_conductivity: Callable[[FloatArray], FloatArray] = air_conductivity,
    uncertainties: Uncertainties | None = None,
    samples: int = 0,
    seed: int = 0,
) -> Prediction:
    """Heat transfer coefficient and Nusselt number of the developed flow, with radiation and without.

    `h = Nu k_b/D` with Nu of Watkins (2018), eq. 22; the wall layer conducts by eq. 35 or 41 and radiates by
    eq. 50. "Without" leaves radiation out of bulk and wall layer, at the same property temperatures.

    At which temperature the properties are taken is a choice. "wall" is that of the source for hot walls (section
    5.3), for a design by the wall's limit; it overstates both conductivities. "mean" is the mean temperature of the
    flow, that of the source for its cold measurements (section 4.1); it understates them, and radiation most. "layers"
    takes each where it is, such that what depends linearly on temperature is right to first order in the heat flux: the
    wall layer in its middle, the bulk a third of the way from its mean to its edge, and radiation by the fourth
    powers of eq. 48 over equal steps, the step being the fall of temperature across the wall layer. The last two need
    the heat flux, which parts mean and wall temperature.

    Parameters
    ----------
    system : System
        Tube and particles.
    wall_temperature : float or (n,) array
        Wall temperatures. [K]
    wall_layer : WallLayer or ParticleWallLayer, optional
        What fills the wall layer, by its means or particle by particle; by correlation if left out.
    view_factors : ViewFactors, optional
        View factors from the wall; the published ones (Table 5.3), or by bedrad's correlation, if left out.
    bulk : Bulk or {"auto", "table 5.2", "zbs"}
        Bulk conductivity at the wall temperatures, or how to get it, see `bulk_conductivity`.
    correlation : {"watkins", "bedrad"}
        Whose flows are taken for what is left out: the publication's, without errors, or bedrad's own, with errors
        (`flow_correlations.estimate`).
    property_temperature : {"wall", "mean", "layers"}
        At which temperature the properties are taken.
    heat_flux : float or (n,) array, optional
        Heat flux from wall to flow, negative where the flow heats the wall. [W/m2]
    gas_conductivity : callable
        Conductivity [W/(m K)] of the gas at temperatures [K].
    uncertainties : Uncertainties, optional
        Standard errors of diameters, properties, temperatures and correlations; none if left out.
    samples : int
        Draws of a Monte Carlo propagation; 0 for none.
    seed : int
        Seed of the draws.

    Returns
    -------
    Prediction
        Arrays of the shape of `wall_temperature`.

    Raises
    ------
    ValueError
        If an input has no meaning, packing fraction and contacts do not fit together, or the heat flux would need a
        flow below absolute zero.

    Warns
    -----
    RangeWarning
        Outside the range of the correlations or of Table 5.2, and where the void share of k_wa is negative.
    """
    T = positive("wall_temperature", wall_temperature, "K")
    if T.ndim > 1 or T.size == 0:
        raise ValueError(f"wall_temperature has the shape {T.shape}; expected one number or a row of them")
    _check_kinds(wall_layer, view_factors, bulk, uncertainties, samples)
    if uncertainties is not None and uncertainties.heat_flux > 0.0 and heat_flux is None:
        raise ValueError(
            f"the standard error of heat_flux is {uncertainties.heat_flux:g} W/m2, but there is no heat_flux"
        )
    if isinstance(wall_layer, ParticleWallLayer):
        wall_layer.check(system)
    check_property_temperature(property_temperature, has_flux=heat_flux is not None)
    evaluation = Evaluation(
        system=system,
        layer=WallLayer.from_correlations(system, correlation) if wall_layer is None else wall_layer,
        layer_correlation=correlation if wall_layer is None else None,
        factors=ViewFactors.from_correlations(system, correlation) if view_factors is None else view_factors,
        factor_correlation=correlation if view_factors is None else None,
        bulk=fit_for(system, bulk) if isinstance(bulk, str) else _matched(bulk, T),
        gas_conductivity=lambda temperature: np.broadcast_to(gas_conductivity(temperature), np.shape(temperature)),
        property_temperature=property_temperature,
        wall_temperature=np.atleast_1d(T),
        heat_flux=None if heat_flux is None else _flux(heat_flux, T),
    )
    return _result(evaluation, T.shape, uncertainties or Uncertainties(), samples, seed)


def _check_kinds(
    wall_layer: object, view_factors: object, bulk: object, uncertainties: object, samples: object
) -> None:
    """Refuse numbers where records are meant: none of them would say what it was."""
    for name, given, kinds in (
        ("wall_layer", wall_layer, (WallLayer, ParticleWallLayer, type(None))),
        ("view_factors", view_factors, (ViewFactors, type(None))),
        ("bulk", bulk, (Bulk, str)),
        ("uncertainties", uncertainties, (Uncertainties, type(None))),
        ("samples", samples, (int,)),
    ):
        if not isinstance(given, kinds):
            wanted = " or ".join(kind.__name__ for kind in kinds if kind is not type(None))
            raise ValueError(f"{name} is {given!r}; expected {wanted}")  # noqa: TRY004 - as for every other input


def _flux(heat_flux: ArrayLike, temperature: FloatArray) -> FloatArray:
    q = np.asarray(heat_flux, dtype=np.float64)
    if not np.isfinite(q).all() or q.shape not in ((), temperature.shape):
        raise ValueError(
            f"heat_flux is {heat_flux!r}; expected one finite number, or one for each of {temperature.size} wall "
            "temperatures"
        )
    return np.atleast_1d(np.broadcast_to(q, temperature.shape))


def _result(
    evaluation: Evaluation, shape: tuple[int, ...], uncertainties: Uncertainties, samples: int, seed: int
) -> Prediction:
    """Evaluate once with warnings, then propagate the errors."""
    found = evaluation.evaluate(evaluation.inputs())
    errors = standard_errors(evaluation, uncertainties)
    budget, propagated = propagate(evaluation, found, errors)
    bulk = evaluation.bulk
    model = bulk.model if isinstance(bulk, Bulk) else "zbs" if bulk is None else "table 5.2"
    values = {name: plain(value.reshape(shape)) for name, value in found.items()}
    total = found["wall_layer_conductivity"] + found["radiative_conductivity"]
    return Prediction(
        system=evaluation.system,
        wall_layer=evaluation.layer,
        view_factors=evaluation.factors,
        bulk_model=model,
        wall_temperature=plain(evaluation.wall_temperature.reshape(shape)),
        property_temperature=evaluation.property_temperature,
        gas_conductivity=plain(evaluation.gas_conductivity(found["wall_layer_temperature"]).reshape(shape)),
        conductivity_ratio=plain((found["bulk_conductivity"] / total).reshape(shape)),
        conductivity_ratio_without=plain(
            (found["bulk_conductivity_without"] / found["wall_layer_conductivity"]).reshape(shape)
        ),
        **values,
        **{f"{name}_error": plain(propagated[name].reshape(shape)) for name in _RESULTS},
        budget=budget,
        monte_carlo=monte_carlo(evaluation, errors, samples, seed) if samples else None,
    )


def largest_wall_radiation_effect(
    system: System,
    wall_temperature: ArrayLike,
    wall_layer: WallLayer | ParticleWallLayer | None = None,
    bulk: Bulk | BulkModel = "auto",
    layers: int = 3,
) -> FloatArray:
    """Upper bound on what radiation in the wall layer adds to h, known before any ray is traced.

    The bulk keeps its radiation: this is what the view factors, and the effort of tracing them, can matter at
    most.

    Parameters
    ----------
    system : System
        Tube and particles.
    wall_temperature : float or (n,) array
        Wall temperatures. [K]
    wall_layer : WallLayer or ParticleWallLayer, optional
        What fills the wall layer; by correlation if left out.
    bulk : Bulk or {"auto", "table 5.2", "zbs"}
        Bulk conductivity at the wall temperatures, or how to get it.
    layers : int
        Number of the last layer that radiation from the wall reaches.

    Returns
    -------
    float or (n,) array
        Largest possible h over h without radiation in the wall layer, less 1.

    Raises
    ------
    ValueError
        As `predict`.
    """
    T = positive("wall_temperature", wall_temperature, "K")
    layer = WallLayer.from_correlations(system) if wall_layer is None else wall_layer
    k_b = bulk_conductivity(system, T, bulk) if isinstance(bulk, str) else _matched(bulk, T)
    gas = air_conductivity(T)
    if isinstance(layer, ParticleWallLayer):
        k_wa = layer.conductivity(system.solid_conductivity, gas)
    else:
        k_wa = layer.conductivity(system, gas)
    return radiation.largest_effect(
        system.diameter_ratio, system.particle_diameter, T, k_wa, k_b.with_radiation, reach=float(layers)
    )
