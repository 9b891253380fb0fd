"""Conduction from a flat wall through the gas into particles: the fluid lens of Rong and Horio (1999).

A particle is wrapped in a shell of still gas, the lens, `lens_radius` particle radii about its centre. Where the
lens meets the wall, heat runs straight through the gas, over the local gap `l(x)` but over no less than the height
`s` of the asperities; the particle has one temperature. Written as Adepu et al. (A) give it in their eq. 1; the
integral has a closed form. Lengths are in particle radii inside this module, `u = sqrt(1 - x^2)` is the height of the
particle's surface below its centre.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within

__all__ = [
    "LENS_RADIUS",
    "Overlap",
    "areal_coefficient",
    "biot_number",
    "conductance",
    "conductance_by_quadrature",
    "lens_area",
    "lens_integral",
]

LENS_RADIUS = 1.4
"""Radius of the fluid lens in particle radii: just below sqrt(2), where the lens of a particle in contact covers its
whole radius."""

Overlap = Literal["contact", "printed", "ring"]

_SERIES_BELOW = 0.1
_SERIES_TERMS = 18
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


@dataclass(frozen=True)
class _Lens:
    """Where the lens begins and ends, all in particle radii and broadcast.

    `narrowest` is the gap (with the jump distance of the gas) where the straight part begins, `depth` how far the
    particle's surface drops within it, `flat` the depth of the cap that stands at the asperity height, `inner` and
    `outer` the squared radii x_in^2 and x_out^2, `cap` what of the first conducts at the asperity height.
    """

    radius: FloatArray
    gap: FloatArray
    asperity: FloatArray
    free_path: FloatArray
    narrowest: FloatArray
    flat: FloatArray
    depth: FloatArray
    inner: FloatArray
    outer: FloatArray
    cap: FloatArray


def _lens(
    particle_diameter: ArrayLike,
    gap: ArrayLike,
    asperity: ArrayLike,
    lens_radius: ArrayLike,
    free_path: ArrayLike,
    overlap: Overlap,
) -> _Lens:
    if overlap not in get_args(Overlap):
        raise ValueError(f"overlap is {overlap!r}; expected one of {', '.join(get_args(Overlap))}")
    radius = 0.5 * positive("particle_diameter", particle_diameter, "m")
    ratio = np.asarray(gap, dtype=np.float64) / radius
    delta = within("gap over particle radius", ratio, -1.0, math.inf, open_above=True)
    s = non_negative("asperity", asperity, "m") / radius
    jump = non_negative("free_path", free_path, "m") / radius
    lens = positive("lens_radius", lens_radius)
    if np.any(lens <= 1.0):
        raise ValueError(f"lens_radius is {float(np.min(lens)):g}; expected more than 1 particle radius")
    if overlap == "contact":
        delta = np.maximum(delta, 0.0)
    narrowest = np.maximum(delta, s) + jump
    if np.any(narrowest <= 0.0):
        raise ValueError("asperity and free_path are both 0 for a particle in contact; expected one of them above 0 m")
    narrowest = np.maximum(narrowest, np.finfo(np.float64).tiny)
    # x_out^2 = L^2 - (1 + delta)^2 as a product: nothing cancels at the edge of the lens
    outer = np.clip((lens - 1.0 - np.minimum(delta, lens)) * (lens + 1.0 + np.minimum(delta, lens)), 0.0, 1.0)
    drop = outer / (1.0 + np.sqrt(1.0 - outer))
    flat = np.clip(s - delta, 0.0, drop)
    inside = np.maximum(-delta, 0.0) if overlap == "ring" else 0.0
    cap = (flat - inside) * (2.0 - flat - inside)
    lens_of = (radius, delta, s, jump, narrowest, flat, drop - flat, flat * (2.0 - flat), outer, cap)
    return _Lens(*(np.asarray(x) for x in np.broadcast_arrays(*lens_of)))


def _log1p_rest(y: FloatArray) -> FloatArray:
    """The rest `y - ln(1 + y)` without loss of digits for small y."""
    small = y < _SERIES_BELOW
    near = np.where(small, y, 0.0)
    series = np.zeros_like(y)
    for n in range(_SERIES_TERMS + 1, 1, -1):
        series = 1.0 / n - near * series
    return np.asarray(np.where(small, near * near * series, y - np.log1p(y)))


def _closed_form(lens: _Lens) -> FloatArray:
    """H/(k_g r): the cap at the asperity height, and the integral of `2 pi u du/(1 + delta - u)` beyond it."""
    y = np.asarray(lens.depth / lens.narrowest)
    straight = (1.0 - lens.flat) * np.log1p(y) - lens.narrowest * _log1p_rest(y)
    return np.asarray(math.pi * (lens.cap / lens.narrowest) + 2.0 * math.pi * straight)


def conductance(
    gas_conductivity: ArrayLike,
    particle_diameter: ArrayLike,
    gap: ArrayLike,
    asperity: ArrayLike,
    lens_radius: ArrayLike = LENS_RADIUS,
    free_path: ArrayLike = 0.0,
    overlap: Overlap = "contact",
) -> FloatArray:
    """Conductance from a flat wall through the fluid lens into one particle, H (Adepu et al., eq. 1).

    `H/(k_g r) = pi x_in^2/s + 2 pi [(u_o - u_i) + (1 + delta) ln((1 + delta - u_o)/(1 + delta - u_i))]` with
    lengths in radii; theory of Rong and Horio (1999). The heat rate is `H (T_wall - T_particle)`.

    Parameters
    ----------
    gas_conductivity : float or array
        Conductivity of the interstitial gas. [W/(m K)]
    particle_diameter : float or array
        Particle diameter. [m]
    gap : float or array
        Distance from the wall to the nearest point of the particle, delta; negative where they overlap. [m]
    asperity : float or array
        Height of the asperities, s: heat conducts over no less. May be 0 where the gap or the free path is not.
        [m]
    lens_radius : float or array
        Radius of the lens in particle radii, above 1. A particle more than `lens_radius - 1` radii from the wall
        takes up nothing.
    free_path : float or array
        Temperature jump distance of the gas (`bulk.modified_free_path`), added to every local gap (Smoluchowski
        effect). Not part of eq. 1, which puts s in its place; 0 leaves it out. [m]
    overlap : {"contact", "printed", "ring"}
        Overlapping particles: "contact" counts them as just touching, since the overlap of a simulation with
        softened contacts is no real flattening; "printed" takes eq. 1 as it stands, with the cap that overlaps
        at the gap s; "ring" leaves that cap to the conduction from solid to solid, as MFiX does, and counts the
        gas around it.

    Returns
    -------
    float or array
        H. [W/K]

    Raises
    ------
    ValueError
        If an input has no meaning, an overlap is deeper than a radius, or asperity and free path are both 0 for
        a particle in contact.
    """
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    lens = _lens(particle_diameter, gap, asperity, lens_radius, free_path, overlap)
    return plain(gas * lens.radius * _closed_form(lens))


def lens_area(
    particle_diameter: ArrayLike,
    gap: ArrayLike,
    asperity: ArrayLike,
    lens_radius: ArrayLike = LENS_RADIUS,
    overlap: Overlap = "contact",
) -> FloatArray:
    """Area of wall of a fluid lens, `pi (x_out^2 - x_in^2)` (Adepu et al., eq. 3).

    The cap at the asperity height, inside x_in, is left out as in the source; a lens that is all cap has area 0.

    Parameters
    ----------
    particle_diameter, gap, asperity, lens_radius, overlap
        As for `conductance`.

    Returns
    -------
    float or array
        Area. [m2]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    # the area knows nothing of the free path; any keeps a smooth particle in contact from being refused
    lens = _lens(particle_diameter, gap, asperity, lens_radius, particle_diameter, overlap)
    return plain(math.pi * lens.radius**2 * np.maximum(lens.outer - lens.inner, 0.0))


def areal_coefficient(
    gas_conductivity: ArrayLike,
    particle_diameter: ArrayLike,
    gap: ArrayLike,
    asperity: ArrayLike,
    lens_radius: ArrayLike = LENS_RADIUS,
    free_path: ArrayLike = 0.0,
    overlap: Overlap = "contact",
) -> FloatArray:
    """Heat transfer coefficient of one fluid lens, h = H over its area (Adepu et al., eq. 3).

    Parameters
    ----------
    gas_conductivity, particle_diameter, gap, asperity, lens_radius, free_path, overlap
        As for `conductance`.

    Returns
    -------
    float or array
        h, 0 for a particle out of the reach of the wall. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input has no meaning, or an asperity is so high that all of a lens stands at it and eq. 3 has no
        area left.
    """
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    lens = _lens(particle_diameter, gap, asperity, lens_radius, free_path, overlap)
    area = np.asarray(lens.outer - lens.inner)
    reached = lens.outer > 0.0
    if np.any(reached & (area <= 0.0)):
        s = float((lens.asperity * lens.radius)[reached & (area <= 0.0)].flat[0])
        raise ValueError(f"asperity is {s:g} m; expected less than the gap at the edge of the lens")
    value = gas / lens.radius * _closed_form(lens) / (math.pi * np.where(reached, area, 1.0))
    return plain(np.where(reached, value, 0.0))


def biot_number(
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    particle_diameter: ArrayLike,
    gap: ArrayLike,
    asperity: ArrayLike,
    lens_radius: ArrayLike = LENS_RADIUS,
    free_path: ArrayLike = 0.0,
    overlap: Overlap = "contact",
) -> FloatArray:
    """Biot number of a particle heated through its fluid lens, `h r/k_s` with h of eq. 3 (Adepu et al.).

    Parameters
    ----------
    solid_conductivity : float or array
        Conductivity of the particle. [W/(m K)]
    gas_conductivity, particle_diameter, gap, asperity, lens_radius, free_path, overlap
        As for `conductance`.

    Returns
    -------
    float or array
        Bi.

    Raises
    ------
    ValueError
        As `areal_coefficient` does.
    """
    solid = positive("solid_conductivity", solid_conductivity, "W/(m K)")
    radius = 0.5 * positive("particle_diameter", particle_diameter, "m")
    h = areal_coefficient(gas_conductivity, particle_diameter, gap, asperity, lens_radius, free_path, overlap)
    return plain(h * radius / solid)


def _resistance(
    angle: FloatArray, delta: FloatArray, s: FloatArray, jump: FloatArray, conductivity_ratio: FloatArray
) -> FloatArray:
    """Local resistance over r/k_g: the gap, the jump of the gas, and the solid below it."""
    local = delta + 2.0 * np.sin(0.5 * angle) ** 2
    return np.asarray(np.maximum(local, s) + jump + (1.0 - local) / conductivity_ratio)


def lens_integral(
    gap: ArrayLike,
    asperity: ArrayLike,
    outer: ArrayLike,
    free_path: ArrayLike = 0.0,
    conductivity_ratio: ArrayLike = math.inf,
) -> FloatArray:
    """Quadrature of `2 pi x dx/(local resistance)` over a lens, all lengths in particle radii: H/(k_g r).

    The local resistance is `max(l, s) + free_path + (1 - l)/K`: gas, jump, and the way straight down through the
    solid to one radius from the wall. With K infinite this is eq. 1 of Adepu et al.; with s = 0 eq. 33 of Watkins
    (2018). Gauss-Legendre in the polar angle over panels that grow geometrically from the narrowest gap, so that it
    holds to rounding for any s.

    Parameters
    ----------
    gap, asperity, free_path : float or array
        Gap delta, height s and jump distance, in particle radii; not all may be 0 if K is infinite.
    outer : float or array
        x_out, from 0 to 1: how far the lens reaches along the wall, in particle radii.
    conductivity_ratio : float or array
        K, solid over gas conductivity; infinite for an isothermal particle.

    Returns
    -------
    float or array
        H over k_g and radius.

    Raises
    ------
    ValueError
        If an input has no meaning, or the integral diverges.
    """
    reach = within("outer", outer, 0.0, 1.0)
    s, jump = non_negative("asperity", asperity), non_negative("free_path", free_path)
    K = positive("conductivity_ratio", conductivity_ratio, infinite=True)
    delta = within("gap", gap, -1.0, math.inf, open_above=True)
    delta, s, jump, reach, K = (np.asarray(x)[..., None, None] for x in np.broadcast_arrays(delta, s, jump, reach, K))
    narrowest = np.maximum(delta, s) + jump + np.maximum(1.0 - np.maximum(delta, s), 0.0) / K
    if np.any(narrowest <= 0.0):
        raise ValueError("gap, asperity and free_path leave no resistance where they meet; expected one above 0")
    end = np.arcsin(reach)
    begin = np.minimum(2.0 * np.arcsin(np.sqrt(np.clip(0.5 * (s - delta), 0.0, 0.5))), end)
    span = end - begin
    # along the wall, from where the asperities end to where the gap has doubled
    doubling = 2.0 * narrowest / (begin + np.sqrt(begin**2 + 2.0 * narrowest))
    first = np.minimum(0.5 * doubling, np.where(span > 0.0, span, 1.0))
    growth = np.maximum(span / first, 1.0)
    panels = 1 + math.ceil(math.log2(float(np.max(growth))))
    edges = begin + np.where(span > 0.0, first, 0.0) * growth ** (np.arange(panels)[:, None] / max(panels - 1, 1))
    edges = np.concatenate([np.zeros_like(begin), begin, edges], axis=-2)
    middle, half = 0.5 * (edges[..., 1:, :] + edges[..., :-1, :]), 0.5 * np.diff(edges, axis=-2)
    angle = middle + half * _NODES
    values = np.sin(angle) * np.cos(angle) / _resistance(angle, delta, s, jump, K)
    return plain(2.0 * math.pi * np.sum(half * _WEIGHTS * values, axis=(-2, -1)))


def conductance_by_quadrature(
    gas_conductivity: ArrayLike,
    particle_diameter: ArrayLike,
    gap: ArrayLike,
    asperity: ArrayLike,
    lens_radius: ArrayLike = LENS_RADIUS,
    free_path: ArrayLike = 0.0,
    overlap: Overlap = "contact",
) -> FloatArray:
    """`conductance` by numerical integration of the local gap instead of the closed form: a check, and slower.

    Takes what `conductance` takes and refuses what it refuses.

    Returns
    -------
    float or array
        H. [W/K]
    """
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    lens = _lens(particle_diameter, gap, asperity, lens_radius, free_path, overlap)
    integral = lens_integral(lens.gap, lens.asperity, np.sqrt(lens.outer), lens.free_path)
    left_out = math.pi * (lens.inner - lens.cap) / lens.narrowest
    return plain(gas * lens.radius * (integral - left_out))
