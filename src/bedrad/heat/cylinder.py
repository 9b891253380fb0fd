"""One particle at the wall of a tube, exactly (Watkins 2018, appendix C, eq. 81-88).

Lengths are in particle radii. The tube has the inner radius A, the wall layer reaches to the radius A - 1,
the particle centre lies at c = A - 1 - a. The heat is taken to run radially.

The printed integrals over angle and height have square roots at their ends. Here the particle surface is
described by its own spherical coordinates about the pole that faces the wall, with v = 1 - cos(polar angle):
the integrand is then smooth but for a logarithmic peak at v = 0 (large K) or at the other end (small K),
which double-exponential nodes resolve. Two corrections of the print: eq. 88 lacks dr, and its arccos has the
denominator 2 (r/r_p) (A - 1 - a).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, within

__all__ = [
    "SMALLEST_DIAMETER_RATIO",
    "covered_area",
    "cut_particle",
    "particle_conductivity",
    "particle_volume",
]

SMALLEST_DIAMETER_RATIO = 2.0
"""Below 2 the core inside the wall layer is thinner than a particle, and a particle at the distance a = 1 would
have its centre beyond the axis: there is neither a bulk nor eq. 84-88 for every distance."""

_AZIMUTHS = 32
_AXIS_AZIMUTHS = 96
_NEAR_AXIS = 0.25
_CHUNK_NODES = 2**19


def _double_exponential(count: int, reach: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes x on (0, 1), 1 - x to full relative accuracy, and weights."""
    t = np.linspace(-reach, reach, 2 * count + 1)
    exponent = math.pi * np.sinh(t)
    x = 1.0 / (1.0 + np.exp(-exponent))
    rest = 1.0 / (1.0 + np.exp(exponent))
    return x, rest, (reach / count) * math.pi * np.cosh(t) * x * rest


# a reach of 3.4 leaves out 1e-20 of the interval at each end; the finer rule has nodes close enough for a peak of
# the width 1e-13 of the interval
_RULE = _double_exponential(60, 3.4)
_FINE_RULE = _double_exponential(250, 3.8)
_RULE_HOLDS = (1e-3, 1e6)
"""Ratios K for which `_RULE` is enough."""


def _azimuths(c: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Azimuths about the pole over a quarter turn, and weights, for particles with their centres at c.

    The integrands repeat and are smooth, so that equal steps converge fast; but for particles near the axis they
    have a peak of the width sqrt(c) at 0, which the substitution by the hyperbolic sine spreads out.
    """
    if c.min() >= _NEAR_AXIS:
        step = 0.5 * math.pi / _AZIMUTHS
        return np.asarray((np.arange(_AZIMUTHS) + 0.5)[None, :] * step), np.full((1, _AZIMUTHS), step)
    x, weight = np.polynomial.legendre.leggauss(_AXIS_AZIMUTHS)
    width = np.sqrt(np.maximum(c, 1e-16))[:, None]
    reach = np.arcsinh(0.5 * math.pi / width)
    s = 0.5 * reach * (x + 1.0)
    return np.asarray(width * np.sinh(s)), np.asarray(0.5 * reach * weight * width * np.cosh(s))


def _arguments(diameter_ratio: ArrayLike, nc_distance: ArrayLike) -> tuple[FloatArray, FloatArray]:
    A = positive("diameter_ratio", diameter_ratio)
    within("diameter_ratio", A, SMALLEST_DIAMETER_RATIO, math.inf)
    return A, within("nc_distance", nc_distance, 0.0, 1.0)


def _integrals(
    K: FloatArray, A: FloatArray, a: FloatArray, rule: tuple[FloatArray, FloatArray, FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Covered angle-height area over (1 - a), and the heat through it, for vectors of equal length."""
    x, rest, weight = rule
    azimuth, step = (array[:, :, None] for array in _azimuths(A - 1.0 - a))
    K, A, a = K[:, None, None], A[:, None, None], a[:, None, None]
    c = A - 1.0 - a
    sine2, cosine2 = np.sin(azimuth) ** 2, np.cos(azimuth) ** 2
    # v at the inner surface of the layer: sine2 v^2 - 2 (sine2 + c) v + (1-a)(1+a+2c) = 0
    sum_ = sine2 + c
    last = 1.0 + a + 2.0 * c
    width = last / (sum_ + np.sqrt(sum_ * sum_ - sine2 * (1.0 - a) * last))
    v = (1.0 - a) * width * x
    u = 1.0 - v
    u_last = 1.0 - (1.0 - a) * width
    to_wall = 2.0 * c * v + v * (2.0 - v) * sine2 + a * (2.0 * (c + 1.0) + a)
    to_layer = (1.0 - a) * width * rest * (sine2 * (u + u_last) + 2.0 * c)
    inner2 = (A - 1.0) ** 2
    area = step * width * weight * ((c + u) * u + v * (2.0 - v) * cosine2) / (inner2 + to_layer)
    gas = -0.5 * np.log1p(-to_wall / (A * A))
    solid = 0.5 * np.log1p(to_layer / inner2)
    through = -np.log1p(-1.0 / A) * K / (K * gas + solid)
    return 4.0 * area.sum(axis=(1, 2)), 4.0 * (area * through).sum(axis=(1, 2))


def _over_all(K: ArrayLike, A: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """`_integrals` in chunks over arrays of any shape; also the broadcast `a`."""
    shape = np.broadcast_shapes(np.shape(K), A.shape, a.shape)
    flat = [np.broadcast_to(np.asarray(x, dtype=np.float64), shape).reshape(-1) for x in (K, A, a)]
    area, heat = np.empty(flat[0].size), np.empty(flat[0].size)
    coarse = (flat[0] >= _RULE_HOLDS[0]) & (flat[0] <= _RULE_HOLDS[1])
    near_axis = flat[1] - 1.0 - flat[2] < _NEAR_AXIS
    for rule, uses in ((_RULE, coarse), (_FINE_RULE, ~coarse)):
        for azimuths, lies in ((_AZIMUTHS, ~near_axis), (_AXIS_AZIMUTHS, near_axis)):
            these = np.flatnonzero(uses & lies)
            count = max(1, _CHUNK_NODES // (rule[0].size * azimuths))
            for start in range(0, these.size, count):
                part = these[start : start + count]
                area[part], heat[part] = _integrals(flat[0][part], flat[1][part], flat[2][part], rule)
    return area.reshape(shape), heat.reshape(shape), flat[2].reshape(shape)


def covered_area(diameter_ratio: ArrayLike, nc_distance: ArrayLike = 0.0) -> FloatArray:
    """Wall area covered by the part of a particle inside the wall layer (Watkins 2018, eq. 87).

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, at least 2.
    nc_distance : float or array
        Gap between wall and particle surface, in particle radii, from 0 (contact) to 1.

    Returns
    -------
    float or array
        Area, in particle radii squared.

    Raises
    ------
    ValueError
        If the diameter ratio is below 2 or the distance not from 0 to 1.
    """
    A, a = _arguments(diameter_ratio, nc_distance)
    area, _, distance = _over_all(1.0, A, a)
    return plain(A * (1.0 - distance) * area)


def particle_conductivity(K: ArrayLike, diameter_ratio: ArrayLike, nc_distance: ArrayLike = 0.0) -> FloatArray:
    """Conductivity of gas and particle in the wall layer of a tube over k_g (Watkins 2018, eq. 84-86).

    Parameters
    ----------
    K : float or array
        Solid over gas conductivity, k_s/k_g.
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, at least 2.
    nc_distance : float or array
        Gap between wall and particle surface, in particle radii, from 0 (contact) to 1.

    Returns
    -------
    float or array
        k_particle/k_g, averaged over `covered_area`. Relative error below 1e-11 for 1e-12 < K < 1e12.

    Raises
    ------
    ValueError
        If K is not positive, the diameter ratio below 2 or the distance not from 0 to 1.
    """
    ratio = positive("K (solid over gas conductivity)", K)
    A, a = _arguments(diameter_ratio, nc_distance)
    area, heat, _ = _over_all(ratio, A, a)
    return plain(heat / area)


def particle_volume(diameter_ratio: ArrayLike, nc_distance: ArrayLike = 0.0) -> FloatArray:
    """Volume of the part of a particle inside the wall layer of a tube (Watkins 2018, eq. 88, corrected).

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, at least 2.
    nc_distance : float or array
        Gap between wall and particle surface, in particle radii, from 0 (contact) to 1.

    Returns
    -------
    float or array
        Volume, in particle radii cubed; 2 pi/3 for a contact particle at a flat wall.

    Raises
    ------
    ValueError
        If the diameter ratio is below 2 or the distance not from 0 to 1.
    """
    A, a = np.broadcast_arrays(*_arguments(diameter_ratio, nc_distance))
    A, a = A[..., None], a[..., None]
    x, rest, weight = _RULE
    c = A - 1.0 - a
    rho = a + (1.0 - a) * x
    # cosine law, as the sine of the half angle: no cancellation where the angle goes to 0
    half_sine2 = (1.0 - a) * x * (2.0 * c + rho + a) / (4.0 * np.maximum(c, 1e-300) * rho)
    angle = 4.0 * np.arcsin(np.sqrt(np.minimum(half_sine2, 1.0)))
    height = 2.0 * np.sqrt((1.0 - a) * rest * (1.0 + rho))
    return plain((1.0 - a[..., 0]) * (weight * rho * height * angle).sum(axis=-1))


def _last_polar(c: FloatArray, sine2: FloatArray, top: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where the front of a sphere ends, as v: at its outline seen from the axis, or at the layer's inner surface.

    Returns the outline, the place on the inner surface (infinite where the front does not reach it), and the first
    of both. `top` is the square of the pole's distance from the axis, less that of the inner surface.
    """
    # at the outline sine2 u^2 + c u + (1 - sine2) = 0, on the inner surface sine2 v^2 - 2 (sine2 + c) v + top = 0
    outline = 1.0 + 2.0 * (1.0 - sine2) / (c + np.sqrt(np.maximum(c * c - 4.0 * sine2 * (1.0 - sine2), 0.0)))
    sum_ = sine2 + c
    root = sum_ * sum_ - sine2 * top
    edge = np.where(root >= 0.0, top / (sum_ + np.sqrt(np.maximum(root, 0.0))), np.inf)
    return outline, edge, np.minimum(outline, edge)


def _back_reaches_layer(
    c: FloatArray, sine2: FloatArray, inner: FloatArray, outline: FloatArray, last: FloatArray
) -> FloatArray:
    """The v from which on the sphere ends before the inner surface of the layer, by bisection."""
    low, high = np.zeros_like(last), np.array(last)
    for _ in range(60):
        v = 0.5 * (low + high)
        front = np.sqrt((c + 1.0) ** 2 - 2.0 * (c + sine2) * v + sine2 * v * v)
        cut = c * c - 1.0 + sine2 * v * (2.0 - v) < inner * front
        low, high = np.where(cut, v, low), np.where(cut, high, v)
    return np.where(last < outline, last, 0.5 * (low + high))


def _cut_integrals(
    K: FloatArray,
    A: FloatArray,
    a: FloatArray,
    depth: FloatArray,
    *,
    rule: tuple[FloatArray, FloatArray, FloatArray],
) -> tuple[FloatArray, FloatArray]:
    """Covered angle-height area and the heat through it for vectors of equal length and any depth of the layer."""
    x, rest, weight = rule
    azimuth, step = (array[:, :, None] for array in _azimuths(A - 1.0 - a))
    K, A, a, depth = (array[:, None, None] for array in (K, A, a, depth))
    c, inner = A - 1.0 - a, A - depth
    sine2 = np.sin(azimuth) ** 2
    outline, edge, last = _last_polar(c, sine2, (depth - a) * (2.0 * A - a - depth))
    turn = _back_reaches_layer(c, sine2, inner, outline, last)
    area, heat = np.zeros(K.shape[0]), np.zeros(K.shape[0])
    for low, high, cut in ((np.zeros_like(turn), turn, True), (turn, last, False)):
        v = low + (high - low) * x
        left = (high - low) * rest
        # the Jacobian vanishes at the outline, and with it the chord
        jacobian = (outline - high + left) * (sine2 * (2.0 - v - outline) + c)
        back2 = c * c - 1.0 + sine2 * v * (2.0 - v)
        front2 = back2 + 2.0 * jacobian
        gas = -0.5 * np.log1p(-np.minimum((2.0 * c * v + v * (2.0 - v) * sine2 + a * (2.0 * A - a)) / A**2, 1.0))
        if cut:
            at_edge = last < outline
            safe_edge = np.where(at_edge, edge, 0.0)
            to_layer = np.where(
                at_edge,
                (safe_edge - high + left) * (2.0 * (sine2 + c) - sine2 * (v + safe_edge)),
                np.maximum(front2 - inner**2, 0.0),
            )
            solid = 0.5 * np.log1p(to_layer / inner**2)
        else:
            solid = np.log1p(2.0 * jacobian / back2)
            gas = gas + np.maximum(np.log(back2 / (inner * np.sqrt(front2))), 0.0)
        part = 4.0 * step * (high - low) * weight * jacobian / front2
        area += part.sum(axis=(1, 2))
        heat += (part * -np.log1p(-depth / A) * K / (K * gas + solid)).sum(axis=(1, 2))
    return area, heat


def cut_particle(
    K: ArrayLike, diameter_ratio: ArrayLike, nc_distance: ArrayLike = 0.0, layer_depth: ArrayLike = 1.0
) -> tuple[FloatArray, FloatArray]:
    """Covered area and conductivity of a particle in a wall layer of any depth (Watkins 2018, eq. 81-87).

    In a bed of many sizes the layer is one *mean* radius deep: large particles are cut above their centre, small ones
    below it or not at all, with gas behind them. Their heat still runs radially through gas, solid and gas.

    Parameters
    ----------
    K : float or array
        Solid over gas conductivity, k_s/k_g.
    diameter_ratio : float or array
        Tube inner diameter over the diameter of this particle; at least 2, and at least 2 + layer_depth where
        the depth is not 1, so that no particle reaches over the axis.
    nc_distance : float or array
        Gap between wall and particle surface, in radii of this particle, from 0 to the depth of the layer.
    layer_depth : float or array
        Depth of the wall layer, in radii of this particle.

    Returns
    -------
    (area, conductivity) : floats or arrays
        Area in particle radii squared, and k_particle/k_g averaged over it. For a depth of 1 they are
        `covered_area` and `particle_conductivity`; otherwise their relative error is below 1e-7.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    ratio = positive("K (solid over gas conductivity)", K)
    depth = positive("layer_depth", layer_depth, "particle radii")
    A = positive("diameter_ratio", diameter_ratio)
    a = np.asarray(nc_distance, dtype=np.float64)
    ratio, A, a, depth = np.broadcast_arrays(ratio, A, a, depth)
    whole = depth == 1.0
    if np.any((A < 2.0) | (~whole & (2.0 + depth > A))):
        raise ValueError(
            f"diameter_ratio is {float(A.min()):g} with a layer_depth of {float(depth.flat[int(A.argmin())]):g} "
            "particle radii; expected at least 2 and at least 2 + layer_depth"
        )
    if not np.all((a >= 0.0) & (a <= depth)):
        bad = a[~((a >= 0.0) & (a <= depth))].flat[0]
        raise ValueError(f"nc_distance is {bad:g} particle radii; expected at least 0 and at most layer_depth")
    area, heat = np.empty(A.shape), np.empty(A.shape)
    if whole.any():
        flat_area, flat_heat, _ = _over_all(ratio[whole], A[whole], a[whole])
        area[whole], heat[whole] = (1.0 - a[whole]) * flat_area, (1.0 - a[whole]) * flat_heat
    flat = [array.reshape(-1) for array in (ratio, A, a, depth)]
    coarse = (flat[0] >= _RULE_HOLDS[0]) & (flat[0] <= _RULE_HOLDS[1])
    for rule, uses in ((_RULE, coarse), (_FINE_RULE, ~coarse)):
        these = np.flatnonzero(uses & ~whole.reshape(-1))
        count = max(1, _CHUNK_NODES // (rule[0].size * _AZIMUTHS))
        for start in range(0, these.size, count):
            part = these[start : start + count]
            area.flat[part], heat.flat[part] = _cut_integrals(*(x[part] for x in flat), rule=rule)
    # at the edge of the layer nothing is covered, and gas is all there is
    conductivity = np.divide(heat, area, out=np.ones_like(area), where=area > 0.0)
    return plain(A * area), plain(conductivity)
