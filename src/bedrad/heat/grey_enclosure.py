"""Radiation between grey, diffuse surfaces that exchange by given factors: radiosities, net fluxes, total exchange.

An enclosure has n zones, each with one temperature, one emissivity and one radiosity over its whole area. Row i of
the exchange matrix holds the shares of the diffuse radiation of zone i that end at each zone; rows sum to one. Nothing
is subtracted on the way to the absorption factors: the elimination keeps every share of a ray apart (after Grassmann,
Taksar and Heyman 1985), so that each factor is right to rounding even where all surfaces are all but white and the
usual system of equations is singular.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.radiation import STEFAN_BOLTZMANN, fourth_power_difference
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within

__all__ = [
    "absorption_factors",
    "bed_emissivity",
    "net_heat_fluxes",
    "radiosities",
    "total_exchange_factors",
    "wall_exchange_factors",
    "with_cap",
]

ROW_SUM = 1e-9
"""Deviation of a row's sum from one that is taken for rounding."""


def _matrix(exchange_matrix: ArrayLike) -> FloatArray:
    F = within("exchange factor", exchange_matrix, 0.0, 1.0 + ROW_SUM)
    if F.ndim < 2 or F.shape[-1] != F.shape[-2] or F.shape[-1] == 0:
        raise ValueError(f"exchange_matrix has the shape {F.shape}; expected (..., zones, zones)")
    off = F.sum(axis=-1) - 1.0
    if np.any(np.abs(off) > ROW_SUM):
        worst = np.unravel_index(int(np.argmax(np.abs(off))), off.shape)
        raise ValueError(
            f"row {int(worst[-1])} of exchange_matrix sums to {1.0 + float(off[worst]):.9g}; expected 1 "
            "(close an open enclosure with with_cap)"
        )
    return F


def _per_zone(name: str, values: FloatArray, zones: int) -> FloatArray:
    """One value a zone along the last axis; a single number goes for all."""
    if values.ndim == 0:
        return np.broadcast_to(values, (zones,))
    if values.shape[-1] != zones:
        raise ValueError(f"{name} has the shape {values.shape}; expected {zones} zones along the last axis")
    return values


def absorption_factors(exchange_matrix: ArrayLike, emissivities: ArrayLike) -> FloatArray:
    """Share of what each zone emits that each zone absorbs in the end (Gebhart 1961).

    `B = F (I - (1 - eps) F)^-1 eps`, reflections without end. For black zones it is the exchange matrix itself. A
    zone of emissivity 0 reflects all that arrives (reradiates): it absorbs nothing, and its row says what becomes of
    radiation that leaves it.

    Parameters
    ----------
    exchange_matrix : (..., zones, zones) array
        Share of the diffuse radiation of each zone (row) that ends at each zone (column); rows sum to one.
    emissivities : float or (..., zones) array
        Emissivity of each zone, or one for all, 0 to 1; any leading axes broadcast with those of the matrix.

    Returns
    -------
    (..., zones, zones) array
        Absorption factors; rows sum to one.

    Raises
    ------
    ValueError
        If a factor or an emissivity is not from 0 to 1, a row does not sum to one, shapes do not fit, or some zones see
        only each other and none of them absorbs, so that what they emit stays on its way for ever.
    """
    F = _matrix(exchange_matrix)
    zones = F.shape[-1]
    eps = _per_zone("emissivities", within("emissivity", emissivities, 0.0, 1.0), zones)
    F, eps = np.broadcast_arrays(F, eps[..., None, :])
    eps = eps[..., 0, :]
    return np.asarray(F @ _absorbed(F, eps))


def _absorbed(F: FloatArray, eps: FloatArray) -> FloatArray:
    """Share of what arrives at each zone that each zone absorbs in the end, (..., zones, zones).

    Gaussian elimination of `(I - (1 - eps) F) x = eps` where each pivot is taken as the sum of what leaves its zone,
    for zones still to come (`passed`) or for good (`kept`), in place of a difference from one.
    """
    zones = F.shape[-1]
    passed = (1.0 - eps)[..., None] * F
    kept = eps.copy()
    absorbed = eps[..., None] * np.eye(zones)
    pivots = np.empty_like(eps)
    for k in range(zones):
        pivots[..., k] = kept[..., k] + passed[..., k, k + 1 :].sum(axis=-1)
        if np.any(pivots[..., k] == 0.0):
            raise ValueError(
                "emissivity is 0 for zones that see only each other: where their radiation is absorbed is undefined; "
                "expected at least one zone that absorbs among all that see each other"
            )
        share = passed[..., k + 1 :, k] / pivots[..., k, None]
        passed[..., k + 1 :, k + 1 :] += share[..., None] * passed[..., k, None, k + 1 :]
        kept[..., k + 1 :] += share * kept[..., k, None]
        absorbed[..., k + 1 :, :] += share[..., None] * absorbed[..., k, None, :]
    for k in range(zones - 1, -1, -1):
        after = (passed[..., k, k + 1 :, None] * absorbed[..., k + 1 :, :]).sum(axis=-2)
        absorbed[..., k, :] = (absorbed[..., k, :] + after) / pivots[..., k, None]
    return absorbed


def total_exchange_factors(exchange_matrix: ArrayLike, emissivities: ArrayLike) -> FloatArray:
    """Total exchange factors (Hottel's script F): `eps_i B_ij` with the absorption factors B.

    `sigma (T_i^4 - T_j^4)` times the factor from i to j is the net heat that passes between the two zones on all ways,
    per area of zone i. If `A_i F_ij = A_j F_ji` holds for the matrix, it holds for these.

    Parameters
    ----------
    exchange_matrix, emissivities
        As for `absorption_factors`.

    Returns
    -------
    (..., zones, zones) array
        Total exchange factors; rows sum to the emissivities.

    Raises
    ------
    ValueError
        As for `absorption_factors`.
    """
    B = absorption_factors(exchange_matrix, emissivities)
    return np.asarray(_per_zone("emissivities", np.asarray(emissivities, float), B.shape[-1])[..., None] * B)


def _emissive_powers(temperatures: ArrayLike, zones: int) -> FloatArray:
    return STEFAN_BOLTZMANN * _per_zone("temperatures", positive("temperature", temperatures, "K"), zones) ** 4


def radiosities(exchange_matrix: ArrayLike, emissivities: ArrayLike, temperatures: ArrayLike) -> FloatArray:
    """What leaves each zone per area, emitted and reflected: `J = eps E + (1 - eps) F J`, `E = sigma T^4`.

    The net-radiation method for grey, diffuse zones of uniform radiosity (Hottel and Sarofim 1967).

    Parameters
    ----------
    exchange_matrix, emissivities
        As for `absorption_factors`; the matrix must be reciprocal for row i to tell what arrives at zone i.
    temperatures : (..., zones) array
        Temperature of each zone; that of a zone of emissivity 0 does not matter. [K]

    Returns
    -------
    (..., zones) array
        Radiosities. [W/m2]

    Raises
    ------
    ValueError
        As for `absorption_factors`, or if a temperature is not positive.
    """
    B = absorption_factors(exchange_matrix, emissivities)
    eps = _per_zone("emissivities", np.asarray(emissivities, dtype=np.float64), B.shape[-1])
    E = _emissive_powers(temperatures, B.shape[-1])
    return np.asarray(eps * E + (1.0 - eps) * (B * E[..., None, :]).sum(axis=-1))


def net_heat_fluxes(exchange_matrix: ArrayLike, emissivities: ArrayLike, temperatures: ArrayLike) -> FloatArray:
    """Net radiative heat that leaves each zone per area: `sum over j of eps_i B_ij sigma (T_i^4 - T_j^4)`.

    Parameters
    ----------
    exchange_matrix, emissivities, temperatures
        As for `radiosities`.

    Returns
    -------
    (..., zones) array
        Net heat fluxes; times the areas they sum to zero if the matrix is reciprocal. [W/m2]

    Raises
    ------
    ValueError
        As for `radiosities`.
    """
    factors = total_exchange_factors(exchange_matrix, emissivities)
    T = _per_zone("temperatures", positive("temperature", temperatures, "K"), factors.shape[-1])
    here, there = T[..., :, None], T[..., None, :]
    return np.asarray(STEFAN_BOLTZMANN * (factors * fourth_power_difference(here, here - there)).sum(axis=-1))


def with_cap(exchange_matrix: ArrayLike, lost: ArrayLike, areas: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Close an open enclosure by one more zone that takes what is lost from the others and does not see itself.

    Emissivity 1 makes the cap a black surface at its own temperature: what gets there does not come back. Emissivity 0
    makes it reradiate: all comes back, as if the bed were mirrored there. The truth of a deeper bed lies between.

    Parameters
    ----------
    exchange_matrix : (..., zones, zones) array
        What stays between the zones; reciprocal with the areas.
    lost : (..., zones) array
        What of each zone's radiation is lost; with the matrix's rows it sums to one.
    areas : (zones,) array
        Areas of the zones. [m2]

    Returns
    -------
    matrix : (..., zones + 1, zones + 1) array
        The closed enclosure, the cap last.
    areas : (..., zones + 1) array
        Areas; that of the cap is what just catches everything lost, and may be zero. [m2]

    Raises
    ------
    ValueError
        If shapes do not fit, a share or an area is negative, or a row with its loss does not sum to one.
    """
    F, gone = non_negative("exchange factor", exchange_matrix), non_negative("lost", lost)
    A = non_negative("areas", areas, "m2")
    if F.ndim < 2 or F.shape[-1] != F.shape[-2] or gone.shape != F.shape[:-1] or A.shape != F.shape[-1:]:
        raise ValueError(
            f"exchange_matrix, lost and areas have the shapes {F.shape}, {gone.shape} and {A.shape}; expected "
            "(..., zones, zones), (..., zones) and (zones,)"
        )
    area = (A * gone).sum(axis=-1)
    row = A * gone / np.where(area > 0.0, area, 1.0)[..., None]
    # nothing is lost: a cap without area, whose row may be any
    row[..., 0] = np.where(area > 0.0, row[..., 0], 1.0)
    below = np.concatenate([row, np.zeros((*area.shape, 1))], axis=-1)[..., None, :]
    closed = np.concatenate([np.concatenate([F, gone[..., None]], axis=-1), below], axis=-2)
    return _matrix(closed), np.concatenate([np.broadcast_to(A, gone.shape), area[..., None]], axis=-1)


def _by_kind(wall: ArrayLike, particle: ArrayLike, zones: int, cap: float | None) -> FloatArray:
    """Emissivities (..., zones) of the wall, the layers, and the cap if there is one."""
    eps_w = within("wall_emissivity", wall, 0.0, 1.0)
    eps_p = within("particle_emissivity", particle, 0.0, 1.0)
    eps_w, eps_p = np.broadcast_arrays(eps_w, eps_p)
    layers = zones - 1 if cap is None else zones - 2
    eps = np.repeat(eps_p[..., None], layers, axis=-1)
    rest = [] if cap is None else [np.full((*eps_p.shape, 1), within("cap_emissivity", cap, 0.0, 1.0))]
    return np.concatenate([eps_w[..., None], eps, *rest], axis=-1)


def wall_exchange_factors(
    exchange_matrix: ArrayLike,
    lost: ArrayLike,
    areas: ArrayLike,
    wall_emissivity: ArrayLike,
    particle_emissivity: ArrayLike,
    cap_emissivity: float = 1.0,
) -> FloatArray:
    """Total exchange factors from a grey wall to the layers of grey particles behind it, and to what lies beyond.

    They take the place of the view factors in `bedrad.heat.radiation`: the net heat between wall and layer j is the
    factor times `sigma (T_w^4 - T_j^4)` per area of wall, so that `radiation.conductivity` of the factors to layers
    gives k_rad of grey surfaces in the manner of Watkins (2018), eq. 50.

    Parameters
    ----------
    exchange_matrix : (zones, zones) array
        Exchange factors between the wall (first) and the layers.
    lost : (zones,) array
        What of each zone's radiation gets beyond the last layer.
    areas : (zones,) array
        Area of the wall, and of the particles' surface in each layer. [m2]
    wall_emissivity, particle_emissivity : float or (...) array
        Emissivities, 0 to 1; they broadcast with each other.
    cap_emissivity : float
        What lies beyond: 1, a black surface; 0, a surface that sends all back. How far the two results part says what
        the layers left out are worth.

    Returns
    -------
    (..., zones) array
        Total exchange factors from the wall to the layers and, last, to the cap.

    Raises
    ------
    ValueError
        As for `with_cap` and `absorption_factors`.
    """
    closed, _ = with_cap(exchange_matrix, lost, areas)
    eps = _by_kind(wall_emissivity, particle_emissivity, closed.shape[-1], cap_emissivity)
    return np.asarray(total_exchange_factors(closed, eps)[..., 0, 1:])


def bed_emissivity(
    exchange_matrix: ArrayLike,
    lost: ArrayLike,
    areas: ArrayLike,
    particle_emissivity: ArrayLike,
    cap_emissivity: float = 1.0,
) -> FloatArray:
    """Effective emissivity of a bed of one temperature as the wall sees it.

    The total exchange factor from a black wall to all that lies behind it, where the cap counts as bed. With a grey
    wall the factor follows from `1/F = 1/eps_wall + 1/eps_bed - 1`, as between two plates, since the wall has one
    radiosity. A concave wall sees itself, which lowers this number: it is per area of wall, not of opening.

    Parameters
    ----------
    exchange_matrix, lost, areas, cap_emissivity
        As for `wall_exchange_factors`.
    particle_emissivity : float or (...) array
        Emissivity of the particles, 0 to 1.

    Returns
    -------
    float or (...) array
        Effective emissivity.

    Raises
    ------
    ValueError
        As for `wall_exchange_factors`.
    """
    factors = wall_exchange_factors(exchange_matrix, lost, areas, 1.0, particle_emissivity, cap_emissivity)
    return plain(factors.sum(axis=-1))
