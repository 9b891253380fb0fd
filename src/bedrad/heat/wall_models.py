"""The wall layer as others model it: Yagi and Kunii (1960), Ofuchi and Kunii (1965), Schluender (1971).

All take a resting or slowly moving bed, all particles touching the wall. Each gives a heat transfer coefficient or a
conductivity of the layer half a particle diameter deep; `layer_coefficient` and `layer_conductivity` turn one into
the other. Conduction only: the radiative terms of the originals are left to `radiation`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within
from bedrad.heat.single_particle import contact_factor

__all__ = [
    "WALL_COVERAGE",
    "layer_coefficient",
    "layer_conductivity",
    "ofuchi_kunii_conductivity",
    "ofuchi_kunii_film_thickness",
    "schluender_coefficient",
    "schluender_particle_coefficient",
    "yagi_kunii_coefficient",
]

WALL_COVERAGE = 0.8
"""Share of the wall that particles cover in Schluender's model, phi_A (VDI Heat Atlas, M6)."""

_SERIES_BELOW = 0.25
_SERIES_TERMS = 28


def _layer_resistance_length(particle_diameter: ArrayLike, diameter_ratio: ArrayLike) -> FloatArray:
    """Thickness of the plane layer that resists as the wall layer of a tube does: R ln(R/(R - d/2)). [m]"""
    d = positive("particle_diameter", particle_diameter, "m")
    A = positive("diameter_ratio", diameter_ratio, infinite=True)
    if np.any(A <= 1.0):
        raise ValueError(f"diameter_ratio is {float(np.min(A)):g}; expected more than 1")
    inverse = 1.0 / A
    curvature = np.divide(-np.log1p(-inverse), inverse, out=np.ones_like(inverse), where=inverse > 0.0)
    return np.asarray(0.5 * d * curvature)


def layer_coefficient(
    conductivity: ArrayLike, particle_diameter: ArrayLike, diameter_ratio: ArrayLike = math.inf
) -> FloatArray:
    """Heat transfer coefficient, on the area of the wall, of a layer half a particle deep (Watkins 2018, eq. 25).

    Parameters
    ----------
    conductivity : float or array
        Effective conductivity of the layer, k_wa. [W/(m K)]
    particle_diameter : float or array
        Particle diameter. [m]
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, above 1; infinite for a flat wall.

    Returns
    -------
    float or array
        h; `2 k/d` at a flat wall. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    k = non_negative("conductivity", conductivity, "W/(m K)")
    return plain(k / _layer_resistance_length(particle_diameter, diameter_ratio))


def layer_conductivity(
    coefficient: ArrayLike, particle_diameter: ArrayLike, diameter_ratio: ArrayLike = math.inf
) -> FloatArray:
    """Conductivity of a layer half a particle deep that resists as a heat transfer coefficient does.

    The inverse of `layer_coefficient`.

    Parameters
    ----------
    coefficient : float or array
        Heat transfer coefficient between the wall and the plane half a particle away. [W/(m2 K)]
    particle_diameter : float or array
        Particle diameter. [m]
    diameter_ratio : float or array
        Tube inner diameter over particle diameter; infinite for a flat wall.

    Returns
    -------
    float or array
        k_wa; `h d/2` at a flat wall. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    h = non_negative("coefficient", coefficient, "W/(m2 K)")
    return plain(h * _layer_resistance_length(particle_diameter, diameter_ratio))


def ofuchi_kunii_film_thickness(K: ArrayLike) -> FloatArray:
    """Thickness of the gas film at the wall over the particle diameter, phi_w (Ofuchi and Kunii 1965).

    The film that, in series with the mean thickness d/3 of the half sphere, conducts as that half sphere on a flat
    wall does: `phi_w = 1/(4 Phi_C) - 1/(3 K)`, with Phi_C of Watkins 2018, eq. 36. This is half of Kunii and Smith's
    film of two spheres in contact, taken over the whole half sphere.

    Parameters
    ----------
    K : float or array
        Solid over gas conductivity, k_s/k_g.

    Returns
    -------
    float or array
        phi_w, from 1/6 at K = 1 falling like 1/(4 ln K).

    Raises
    ------
    ValueError
        If K is below 1, for which the film has no meaning, or not finite.
    """
    ratio = within("K (solid over gas conductivity)", positive("K", K), 1.0, math.inf)
    return plain(0.25 / contact_factor(ratio) - 1.0 / (3.0 * ratio))


def ofuchi_kunii_conductivity(
    gas_conductivity: ArrayLike, solid_conductivity: ArrayLike, porosity: ArrayLike
) -> FloatArray:
    """Conductivity of the layer half a particle deep at the wall of a resting bed, k_w (Ofuchi and Kunii 1965).

    Gas beside columns of film and solid: `k_w/k_g = eps_w + (1 - eps_w)/(2 phi_w + 2/(3 K))`, the second term being
    `(1 - eps_w) 2 Phi_C`. With the share of the wall that particles cover, 1.5 times the packing fraction, in place
    of 1 - eps_w, it is the flat form of `wall_layer` with every particle in contact.

    Parameters
    ----------
    gas_conductivity, solid_conductivity : float or array
        Conductivities of gas and solid. [W/(m K)]
    porosity : float or array
        Void fraction of the layer, eps_w.

    Returns
    -------
    float or array
        k_w. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    K = positive("solid_conductivity", solid_conductivity, "W/(m K)") / gas
    eps = within("porosity", porosity, 0.0, 1.0)
    return plain(gas * (eps + (1.0 - eps) * 2.0 * contact_factor(K)))


def yagi_kunii_coefficient(
    layer_conductivity: ArrayLike, bulk_conductivity: ArrayLike, particle_diameter: ArrayLike
) -> FloatArray:
    """Wall heat transfer coefficient that adds to a bulk reaching to the wall, h_w (Yagi and Kunii 1960).

    The bed is taken to conduct as the bulk does up to the wall; what the layer half a particle deep resists beyond
    that is put into the wall: `h_w d = 2/(1/k_w - 1/k_e)`. It is not the coefficient of the layer itself, which is
    `layer_coefficient`; without flow of the gas.

    Parameters
    ----------
    layer_conductivity : float or array
        Conductivity of the layer at the wall, k_w; `ofuchi_kunii_conductivity` or a k_wa of `wall_layer`. [W/(m K)]
    bulk_conductivity : float or array
        Conductivity of the bulk, k_e; not below that of the layer. [W/(m K)]
    particle_diameter : float or array
        Particle diameter. [m]

    Returns
    -------
    float or array
        h_w, infinite where layer and bulk conduct alike. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input is not positive, or the layer conducts better than the bulk.
    """
    layer = positive("layer_conductivity", layer_conductivity, "W/(m K)")
    bulk = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    d = positive("particle_diameter", particle_diameter, "m")
    layer, bulk, d = np.broadcast_arrays(layer, bulk, d)
    excess = bulk - layer
    if np.any(excess < 0.0):
        i = int(np.argmin(excess))
        raise ValueError(
            f"layer_conductivity is {layer.flat[i]:g} W/(m K), above the bulk's {bulk.flat[i]:g}; expected at most "
            "that of the bulk: the wall would have a negative resistance"
        )
    return plain(np.divide(2.0 * layer / d * bulk, excess, out=np.full(d.shape, math.inf), where=excess > 0.0))


def _sphere_on_plane(q: FloatArray) -> FloatArray:
    """(1 + q) ln(1 + 1/q) - 1, which goes like -ln q for small and 1/(2q) for large q."""
    t = 1.0 / np.maximum(q, 1.0)
    # ((1 + t) ln(1 + t) - t)/t = t/2 - t^2/6 + t^3/12 - ...
    series = np.zeros_like(t)
    for n in range(_SERIES_TERMS, 0, -1):
        series = 1.0 / (n * (n + 1.0)) - t * series
    near = np.minimum(q, 1.0 / _SERIES_BELOW)
    return np.where(q > 1.0 / _SERIES_BELOW, t * series, (1.0 + near) * (np.log1p(near) - np.log(near)) - 1.0)


def schluender_particle_coefficient(
    gas_conductivity: ArrayLike, particle_diameter: ArrayLike, free_path: ArrayLike, roughness: ArrayLike = 0.0
) -> FloatArray:
    """Heat transfer coefficient from a wall to a sphere that touches it, alpha_WP (Schluender 1971, 1984).

    `alpha_WP = (4 k_g/d) [(1 + q) ln(1 + 1/q) - 1]`, `q = 2 (l + delta)/d`: the mean over the projected sphere of
    k_g over the gap, to which the modified free path of the gas and the roughness are added. The sphere itself is
    isothermal. Written by k_s, `k_C/k_g` of `single_particle` is `K/(K - 1)` times the same bracket, doubled, with
    q = 1/(K - 1): the solid resists as a gap does.

    Parameters
    ----------
    gas_conductivity : float or array
        Conductivity of the gas, k_g. [W/(m K)]
    particle_diameter : float or array
        Particle diameter, d. [m]
    free_path : float or array
        Modified mean free path of the gas, l (`bulk.modified_free_path`). [m]
    roughness : float or array
        Height of the roughness, delta. [m]

    Returns
    -------
    float or array
        alpha_WP, on the projected area of the particle. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input has no meaning, or free path and roughness are both 0: a point contact would conduct without
        limit.
    """
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    d = positive("particle_diameter", particle_diameter, "m")
    gap = non_negative("free_path", free_path, "m") + non_negative("roughness", roughness, "m")
    q = positive("2 (free_path + roughness)/particle_diameter", 2.0 * gap / d)
    return plain(4.0 * gas / d * _sphere_on_plane(q))


def schluender_coefficient(
    gas_conductivity: ArrayLike,
    particle_diameter: ArrayLike,
    free_path: ArrayLike,
    roughness: ArrayLike = 0.0,
    coverage: ArrayLike = WALL_COVERAGE,
) -> FloatArray:
    """Heat transfer coefficient from a wall to a bed without radiation, phi_A alpha_WP (Schluender 1984).

    Parameters
    ----------
    gas_conductivity, particle_diameter, free_path, roughness : float or array
        As for `schluender_particle_coefficient`.
    coverage : float or array
        Share of the wall that particles cover, phi_A.

    Returns
    -------
    float or array
        alpha_WS on the area of the wall; what the gas conducts between the particles is neglected. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    share = within("coverage", coverage, 0.0, 1.0)
    return plain(share * schluender_particle_coefficient(gas_conductivity, particle_diameter, free_path, roughness))
