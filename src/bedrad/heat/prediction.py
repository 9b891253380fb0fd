"""Heat transfer to a dense flow in a hot tube, all models put together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import radiation
from bedrad.heat.gas import air_conductivity
from bedrad.heat.ranges import FloatArray, plain, positive
from bedrad.heat.systems import (
    TABLE_5_1,
    Bulk,
    BulkModel,
    Correlation,
    System,
    ViewFactors,
    WallLayer,
    bulk_conductivity,
)
from bedrad.heat.two_layer import nusselt_developed

__all__ = [
    "TABLE_5_1",
    "Bulk",
    "BulkModel",
    "Correlation",
    "Prediction",
    "System",
    "ViewFactors",
    "WallLayer",
    "bulk_conductivity",
    "largest_wall_radiation_effect",
    "predict",
]

_STEP = 1e-3
"""Step of the central differences, in standard errors: small enough to be linear, large enough for the
digits."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """Predicted heat transfer against wall temperature; `<name>_without` is without radiation in both layers.

    Parameters
    ----------
    system : System
        Tube and particles.
    wall_layer : WallLayer
        What was taken for the wall layer.
    view_factors : ViewFactors
        What was taken for the view factors.
    bulk_model : str
        Where the bulk conductivity comes from.
    wall_temperature : (n,) array
        [K]
    gas_conductivity : (n,) array
        k_g at the wall temperature. [W/(m K)]
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
        Standard errors from those of wall layer and view factors, taken as independent; the view factors of
        one run fall where others rise, which makes this an upper estimate. The bulk counts as exact.
    """

    system: System
    wall_layer: WallLayer
    view_factors: ViewFactors
    bulk_model: str
    wall_temperature: FloatArray
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
        lines = [
            f"{s.name or 'tube'}: D {s.tube_diameter * 1e3:.4g} mm, d {s.particle_diameter * 1e6:.4g} um, "
            f"A {s.diameter_ratio:.4g}, U {s.velocity:g} m/s, bulk by {self.bulk_model}",
            "  T_w [K]    k_wa   k_rad     k_b      Nu  h [W/(m2 K)]  without radiation",
        ]
        columns = (
            self.wall_temperature,
            self.wall_layer_conductivity,
            self.radiative_conductivity,
            self.bulk_conductivity,
            self.nusselt,
            self.heat_transfer_coefficient,
            self.heat_transfer_coefficient_without,
        )
        for T, k_wa, k_rad, k_b, nu, h, h0 in zip(*(np.atleast_1d(c) for c in columns), strict=True):
            lines.append(f"{T:9.2f}  {k_wa:.4f}  {k_rad:.4f}  {k_b:.4f}  {nu:6.3f}  {h:12.1f}  {h0:17.1f}")
        return "\n".join(lines)


@dataclass(frozen=True, eq=False)
class _Fixed:
    """What does not change while the uncertain inputs are varied."""

    system: System
    layer: WallLayer
    temperature: FloatArray
    gas: FloatArray
    bulk: Bulk


def _evaluate(inputs: FloatArray, fixed: _Fixed, *, warn: bool) -> FloatArray:
    """(6, n) array: k_wa, k_rad, Nu, Nu without, h, h without, for phi_wa, n_C, a, F_1, F_2, ..."""
    system, bulk = fixed.system, fixed.bulk
    A, D = system.diameter_ratio, system.tube_diameter
    phi, contacts, distance = (float(x) for x in inputs[:3])
    layer = replace(fixed.layer, packing_fraction=phi, contacts_per_area=contacts, nc_distance=distance)
    k_wa = layer.conductivity(system, fixed.gas, warn=warn)
    steps = float(inputs[3:] @ np.arange(1.0, len(inputs) - 2.0))
    # not radiation.conductivity: a varied factor may pass 0 or 1 by a fraction of its error
    k_rad = 2.0 * radiation.STEFAN_BOLTZMANN * system.particle_diameter * fixed.temperature**3 * steps
    nu = nusselt_developed(A, bulk.with_radiation / (k_wa + k_rad))
    nu_without = nusselt_developed(A, bulk.without_radiation / k_wa)
    h, h_without = nu * bulk.with_radiation / D, nu_without * bulk.without_radiation / D
    return np.stack(np.broadcast_arrays(k_wa, k_rad, nu, nu_without, h, h_without))


def _errors(inputs: FloatArray, errors: FloatArray, fixed: _Fixed) -> FloatArray:
    """Propagate the standard errors through `_evaluate` by central differences, inputs independent."""
    variance = np.zeros((6, *fixed.temperature.shape))
    for i in np.flatnonzero(errors):
        above, below = inputs.copy(), inputs.copy()
        above[i] += _STEP * errors[i]
        # none of the inputs can be negative, so the difference is one-sided at zero
        below[i] = max(below[i] - _STEP * errors[i], 0.0)
        rise = _evaluate(above, fixed, warn=False) - _evaluate(below, fixed, warn=False)
        slope = rise / (above[i] - below[i])
        variance += (slope * errors[i]) ** 2
    return np.sqrt(variance)


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
    wall_layer: WallLayer | None = None,
    view_factors: ViewFactors | None = None,
    bulk: Bulk | BulkModel = "auto",
    correlation: Correlation = "watkins",
) -> Prediction:
    """Heat transfer coefficient and Nusselt number of the developed flow, with radiation and without.

    `h = Nu k_b/D` with Nu of Watkins (2018), eq. 22; the wall layer conducts by eq. 35 or 41 and radiates by
    eq. 50. As in the source (section 5.3), every property is taken at the wall temperature: right for the
    wall layer, which holds most of the resistance, and for the radiation, which the mean temperature would
    underestimate; it overstates the bulk conductivity a little. "Without" leaves radiation out of bulk and
    wall layer. The gas is air.

    Parameters
    ----------
    system : System
        Tube and particles.
    wall_temperature : float or (n,) array
        Wall temperatures. [K]
    wall_layer : WallLayer, optional
        What fills the wall layer; by correlation if left out.
    view_factors : ViewFactors, optional
        View factors from the wall; the published ones (Table 5.3), or by bedrad's correlation, if left out.
    bulk : Bulk or {"auto", "table 5.2", "zbs"}
        Bulk conductivity at the wall temperatures, or how to get it, see `bulk_conductivity`.
    correlation : {"watkins", "bedrad"}
        Whose flows are taken for what is left out: the publication's, without errors, or bedrad's own, with errors
        (`flow_correlations.estimate`).

    Returns
    -------
    Prediction
        Arrays of the shape of `wall_temperature`.

    Raises
    ------
    ValueError
        If an input has no meaning, or packing fraction and contacts do not fit together.

    Warns
    -----
    RangeWarning
        Outside the range of the correlations or of Table 5.2, and where the void share of k_wa is negative.
    """
    T = positive("wall_temperature", wall_temperature, "K")
    layer = WallLayer.from_correlations(system, correlation) if wall_layer is None else wall_layer
    factors = ViewFactors.from_correlations(system, correlation) if view_factors is None else view_factors
    k_b = bulk_conductivity(system, T, bulk) if isinstance(bulk, str) else _matched(bulk, T)
    fixed = _Fixed(system, layer, T, air_conductivity(T), k_b)
    inputs = np.array([layer.packing_fraction, layer.contacts_per_area, layer.nc_distance, *factors.to_layers])
    sigmas = np.array(
        [
            layer.packing_fraction_error,
            layer.contacts_per_area_error,
            layer.nc_distance_error,
            *factors.errors,
        ]
    )
    values = _evaluate(inputs, fixed, warn=True)
    errors = _errors(inputs, sigmas, fixed)
    k_wa, k_rad, nu, nu_without, h, h_without = (plain(row) for row in values)
    return Prediction(
        system=system,
        wall_layer=layer,
        view_factors=factors,
        bulk_model=k_b.model,
        wall_temperature=plain(T),
        gas_conductivity=fixed.gas,
        wall_layer_conductivity=k_wa,
        radiative_conductivity=k_rad,
        bulk_conductivity=k_b.with_radiation,
        bulk_conductivity_without=k_b.without_radiation,
        conductivity_ratio=plain(k_b.with_radiation / (k_wa + k_rad)),
        conductivity_ratio_without=plain(k_b.without_radiation / k_wa),
        nusselt=nu,
        nusselt_without=nu_without,
        heat_transfer_coefficient=h,
        heat_transfer_coefficient_without=h_without,
        wall_layer_conductivity_error=plain(errors[0]),
        radiative_conductivity_error=plain(errors[1]),
        nusselt_error=plain(errors[2]),
        nusselt_without_error=plain(errors[3]),
        heat_transfer_coefficient_error=plain(errors[4]),
        heat_transfer_coefficient_without_error=plain(errors[5]),
    )


def largest_wall_radiation_effect(
    system: System,
    wall_temperature: ArrayLike,
    wall_layer: WallLayer | None = None,
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
    wall_layer : WallLayer, optional
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
    k_wa = layer.conductivity(system, air_conductivity(T))
    return radiation.largest_effect(
        system.diameter_ratio, system.particle_diameter, T, k_wa, k_b.with_radiation, reach=float(layers)
    )
