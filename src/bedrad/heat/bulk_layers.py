"""Conductivity of a bed of spheres in a stagnant gas by the models of Yagi and Kunii and of Kunii and Smith.

Particles conduct in series with the gas films at their contacts; radiation crosses films and voids.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.bulk_models import conductivity_ratio, logarithm_rest, void_fraction
from bedrad.heat.radiation import STEFAN_BOLTZMANN
from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside, within

__all__ = ["KUNII_SMITH_POROSITIES", "kunii_smith", "kunii_smith_gas_film", "yagi_kunii"]

KUNII_SMITH_POROSITIES = (0.26, 0.476)
"""Porosities of the closest and the loosest packing between which Kunii and Smith (1960) interpolate."""


def _film_of_packing(K: FloatArray, contacts: float) -> FloatArray:
    """Gas film of one packing over the diameter; `contacts` is n, a contact's share of a half sphere is 1/n.

    The printed form, `((K-1)/K)^2 sin^2/2 / [ln(K - (K-1) cos) - (K-1)/K (1 - cos)] - 2/(3K)` with sin^2 = 1/n,
    is 0/0 at K = 1; there the logarithm is replaced by its series.
    """
    cap = (1.0 / contacts) / (1.0 + math.sqrt(1.0 - 1.0 / contacts))  # 1 - cos
    y = (K - 1.0) * cap
    near = np.abs(y) < 0.5
    # (y - ln(1+y))/y^2 = 1/2 - y ((ln(1+y) - y + y^2/2)/y^3)
    series = 1.0 - K * cap * (0.5 - np.where(near, y, 0.0) * logarithm_rest(np.where(near, y, 0.0)))
    far = np.where(near, 1.0, y)
    direct = cap / far * (K * np.log1p(far) / far - 1.0)
    return np.asarray((0.5 * (2.0 - cap) / np.where(near, series, direct) - 2.0 / 3.0) / K)


def kunii_smith_gas_film(ratio: ArrayLike, porosity: ArrayLike) -> FloatArray:
    """Effective thickness of the gas film at the contacts over the diameter, phi (Kunii and Smith 1960).

    `phi = phi_2 + (phi_1 - phi_2) (eps - 0.26)/(0.476 - 0.26)`, with phi_1 of the loosest packing (n = 1.5
    contacts on a half sphere) and phi_2 of the closest (n = 4 sqrt(3)); phi_1 above and phi_2 below these
    porosities. At K = 1 it is 1/3 for any porosity.

    Parameters
    ----------
    ratio : float or array
        K, conductivity of the solid over that of the gas.
    porosity : float or array
        Void fraction of the bed, between 0 and 1.

    Returns
    -------
    float or array
        phi.

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If the porosity is outside 0.26 to 0.476.
    """
    K = positive("ratio", ratio)
    eps = void_fraction(porosity)
    closest, loosest = KUNII_SMITH_POROSITIES
    warn_outside("gas film at the contacts (Kunii and Smith 1960): porosity", eps, closest, loosest)
    share = np.clip((eps - closest) / (loosest - closest), 0.0, 1.0)
    return plain((1.0 - share) * _film_of_packing(K, 4.0 * math.sqrt(3.0)) + share * _film_of_packing(K, 1.5))


def _layers(
    gas: FloatArray, K: FloatArray, eps: FloatArray, film: FloatArray, radiation: tuple[FloatArray, FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Conductivities over that of the gas: radiation across the voids, and spheres in series with their films."""
    across_voids, across_contacts = radiation
    spheres = (1.0 - eps) / (1.0 / (1.0 / film + across_contacts / gas) + 2.0 / (3.0 * K))
    return np.asarray(eps * across_voids / gas), np.asarray(spheres)


def _yagi_kunii_radiation(
    eps: FloatArray, particle_diameter: ArrayLike, temperature: ArrayLike, emissivity: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Radiation from void to void and from solid to solid, each times the diameter [W/(m K)] (Yagi, Kunii 1957)."""
    d = positive("particle_diameter", particle_diameter, "m")
    black = 4.0 * STEFAN_BOLTZMANN * positive("temperature", temperature, "K") ** 3 * d
    e = within("emissivity", emissivity, 0.0, 1.0)
    # e/(e + (1 - e) eps/(2 (1 - eps))), without dividing by an emissivity or by 1 - eps
    across_voids = 2.0 * (1.0 - eps) * e / (2.0 * (1.0 - eps) * e + eps * (1.0 - e))
    return np.asarray(black * across_voids), np.asarray(black * e / (2.0 - e))


def kunii_smith(
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    porosity: ArrayLike,
    particle_diameter: ArrayLike,
    temperature: ArrayLike,
    emissivity: ArrayLike = 0.8,
    spacing: ArrayLike = 0.9,
) -> FloatArray:
    """Conductivity of a bed of spheres with stagnant gas (Kunii and Smith 1960).

    AIChE J. 6, 71-78:
    `k_e/k_g = eps (1 + beta h_rv d/k_g) + beta (1 - eps)/[1/(1/phi + h_rs d/k_g) + 2/(3K)]`, with phi from
    `kunii_smith_gas_film` and the radiation of Yagi and Kunii (1957): `h_rs = 4 sigma T^3/(2/e - 1)`,
    `h_rv = 4 sigma T^3/[1 + eps (1 - e)/(2 (1 - eps) e)]`. With beta = 1 and no radiation a bed of K = 1
    conducts like the gas; with 0.9 it conducts 6 % less at a porosity of 0.4.

    Parameters
    ----------
    gas_conductivity, solid_conductivity : float or array
        Conductivities of gas and solid. [W/(m K)]
    porosity : float or array
        Void fraction of the bed, between 0 and 1.
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.
    spacing : float or array
        beta, length between the centres of neighbouring particles along the flux over the diameter: 0.895
        in the closest packing, 1 in the loosest.

    Returns
    -------
    float or array
        Bulk conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If the porosity is outside 0.26 to 0.476.
    """
    gas, K = conductivity_ratio(gas_conductivity, solid_conductivity)
    eps = void_fraction(porosity)
    beta = positive("spacing", spacing)
    film = np.asarray(kunii_smith_gas_film(K, eps))
    across_voids, spheres = _layers(
        gas, K, eps, film, _yagi_kunii_radiation(eps, particle_diameter, temperature, emissivity)
    )
    return plain(gas * (eps + beta * (across_voids + spheres)))


def yagi_kunii(
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    porosity: ArrayLike,
    particle_diameter: ArrayLike,
    temperature: ArrayLike,
    emissivity: ArrayLike = 0.8,
    spacing: ArrayLike = 0.9,
    gas_film: ArrayLike | None = None,
) -> FloatArray:
    """Conductivity of a bed of spheres with stagnant gas (Yagi and Kunii 1957).

    AIChE J. 3, 373-381: `k_e/k_g = beta (1 - eps)/[1/(1/phi + h_rs d/k_g) + 2/(3K)] + beta eps h_rv d/k_g`,
    symbols as in `kunii_smith`. The gas in the voids conducts nothing, so the model is made for solids that
    conduct much better than the gas; it lies eps k_g below Kunii and Smith's. Its authors read phi off
    measurements; here it is Kunii and Smith's unless given.

    Parameters
    ----------
    gas_conductivity, solid_conductivity : float or array
        Conductivities of gas and solid. [W/(m K)]
    porosity : float or array
        Void fraction of the bed, between 0 and 1.
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.
    spacing : float or array
        beta, length between the centres of neighbouring particles along the flux over the diameter.
    gas_film : float or array, optional
        phi, effective thickness of the gas film at the contacts over the diameter; default
        `kunii_smith_gas_film`.

    Returns
    -------
    float or array
        Bulk conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If no gas film is given and the porosity is outside 0.26 to 0.476.
    """
    gas, K = conductivity_ratio(gas_conductivity, solid_conductivity)
    eps = void_fraction(porosity)
    beta = positive("spacing", spacing)
    film = np.asarray(kunii_smith_gas_film(K, eps)) if gas_film is None else positive("gas_film", gas_film)
    across_voids, spheres = _layers(
        gas, K, eps, film, _yagi_kunii_radiation(eps, particle_diameter, temperature, emissivity)
    )
    return plain(gas * beta * (across_voids + spheres))
