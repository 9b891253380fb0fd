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

__all__ = ["SMALLEST_DIAMETER_RATIO", "covered_area", "particle_conductivity", "particle_volume"]

SMALLEST_DIAMETER_RATIO = 2.2
"""At 2 the wall layers of opposite walls meet on the axis; from 2.2 on the quadrature below holds for every
distance."""

_AZIMUTHS = 32
_CHUNK = 128


def _double_exponential(count: int, reach: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes x on (0, 1), 1 - x to full relative accuracy, and weights."""
    t = np.linspace(-reach, reach, 2 * count + 1)
    exponent = math.pi * np.sinh(t)
    x = 1.0 / (1.0 + np.exp(-exponent))
    rest = 1.0 / (1.0 + np.exp(exponent))
    return x, rest, (reach / count) * math.pi * np.cosh(t) * x * rest


# a reach of 3.4 leaves out 1e-20 of the interval at each end
_X, _REST, _WEIGHT = _double_exponential(60, 3.4)


def _arguments(diameter_ratio: ArrayLike, nc_distance: ArrayLike) -> tuple[FloatArray, FloatArray]:
    A = positive("diameter_ratio", diameter_ratio)
    within("diameter_ratio", A, SMALLEST_DIAMETER_RATIO, math.inf)
    return A, within("nc_distance", nc_distance, 0.0, 1.0)


def _integrals(K: FloatArray, A: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Covered angle-height area over (1 - a), and the heat through it, for vectors of equal length."""
    K, A, a = K[:, None, None], A[:, None, None], a[:, None, None]
    c = A - 1.0 - a
    azimuth = (np.arange(_AZIMUTHS) + 0.5) * (0.5 * math.pi / _AZIMUTHS)
    sine2 = (np.sin(azimuth) ** 2)[None, :, None]
    cosine2 = (np.cos(azimuth) ** 2)[None, :, None]
    # v at the inner surface of the layer: sine2 v^2 - 2 (sine2 + c) v + (1-a)(1+a+2c) = 0
    sum_ = sine2 + c
    last = 1.0 + a + 2.0 * c
    width = last / (sum_ + np.sqrt(sum_ * sum_ - sine2 * (1.0 - a) * last))
    v = (1.0 - a) * width * _X
    u = 1.0 - v
    u_last = 1.0 - (1.0 - a) * width
    to_wall = 2.0 * c * v + v * (2.0 - v) * sine2 + a * (2.0 * (c + 1.0) + a)
    to_layer = (1.0 - a) * width * _REST * (sine2 * (u + u_last) + 2.0 * c)
    inner2 = (A - 1.0) ** 2
    area = width * _WEIGHT * ((c + u) * u + v * (2.0 - v) * cosine2) / (inner2 + to_layer)
    gas = -0.5 * np.log1p(-to_wall / (A * A))
    solid = 0.5 * np.log1p(to_layer / inner2)
    through = -np.log1p(-1.0 / A) * K / (K * gas + solid)
    step = 2.0 * math.pi / _AZIMUTHS
    return step * area.sum(axis=(1, 2)), step * (area * through).sum(axis=(1, 2))


def _over_all(K: ArrayLike, A: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """`_integrals` in chunks over arrays of any shape; also the broadcast `a`."""
    shape = np.broadcast_shapes(np.shape(K), A.shape, a.shape)
    flat = [np.broadcast_to(np.asarray(x, dtype=np.float64), shape).reshape(-1) for x in (K, A, a)]
    area, heat = np.empty(flat[0].size), np.empty(flat[0].size)
    for start in range(0, area.size, _CHUNK):
        part = slice(start, start + _CHUNK)
        area[part], heat[part] = _integrals(*(x[part] for x in flat))
    return area.reshape(shape), heat.reshape(shape), flat[2].reshape(shape)


def covered_area(diameter_ratio: ArrayLike, nc_distance: ArrayLike = 0.0) -> FloatArray:
    """Wall area covered by the part of a particle inside the wall layer (Watkins 2018, eq. 87).

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, at least 2.2.
    nc_distance : float or array
        Gap between wall and particle surface, in particle radii, from 0 (contact) to 1.

    Returns
    -------
    float or array
        Area, in particle radii squared.

    Raises
    ------
    ValueError
        If the diameter ratio is below 2.2 or the distance not from 0 to 1.
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
        Tube inner diameter over particle diameter, at least 2.2.
    nc_distance : float or array
        Gap between wall and particle surface, in particle radii, from 0 (contact) to 1.

    Returns
    -------
    float or array
        k_particle/k_g, averaged over `covered_area`. Relative error below 1e-11 for 1e-3 < K < 1e6.

    Raises
    ------
    ValueError
        If K is not positive, the diameter ratio below 2.2 or the distance not from 0 to 1.
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
        Tube inner diameter over particle diameter, at least 2.2.
    nc_distance : float or array
        Gap between wall and particle surface, in particle radii, from 0 (contact) to 1.

    Returns
    -------
    float or array
        Volume, in particle radii cubed; 2 pi/3 for a contact particle at a flat wall.

    Raises
    ------
    ValueError
        If the diameter ratio is below 2.2 or the distance not from 0 to 1.
    """
    A, a = np.broadcast_arrays(*_arguments(diameter_ratio, nc_distance))
    A, a = A[..., None], a[..., None]
    c = A - 1.0 - a
    rho = a + (1.0 - a) * _X
    # cosine law, as the sine of the half angle: no cancellation where the angle goes to 0
    half_sine2 = (1.0 - a) * _X * (2.0 * c + rho + a) / (4.0 * c * rho)
    angle = 4.0 * np.arcsin(np.sqrt(np.minimum(half_sine2, 1.0)))
    height = 2.0 * np.sqrt((1.0 - a) * _REST * (1.0 + rho))
    return plain((1.0 - a[..., 0]) * (_WEIGHT * rho * height * angle).sum(axis=-1))
