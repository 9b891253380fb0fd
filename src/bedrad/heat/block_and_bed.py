"""A hot block that a bed of particles is put on: closed forms of its temperature for a contact coefficient h.

Two limits of the experiment of Adepu et al. (Table 1): a block and a bed that are both half-spaces, which holds as
long as the cooling has not reached the far ends, and a block of one temperature on a half-space, which holds for a
block that conducts well. All are written with `erfcx(x) = exp(x^2) erfc(x)`, so that nothing overflows, and in forms
that keep the digits of a small drop.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = [
    "contact_flux",
    "effusivity",
    "half_space_drop",
    "lumped_block_drop",
    "lumped_block_flux",
]

_SMALL_STEP = 0.5
_DEEPEST = 40.0
_SMALL_ROOT = 1.0
_CLOSE_ROOTS = 1e-3
_SERIES_TERMS = 48
_FAR = 8.0
_FAR_TERMS = 24
_PANELS = np.array([0.0, 0.5, 1.5, 3.0, 6.0, 12.0, 24.0, 40.0])
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_POINTS = (0.5 * (_PANELS[1:] + _PANELS[:-1])[:, None] + 0.5 * np.diff(_PANELS)[:, None] * _NODES).ravel()
_POINT_WEIGHTS = (0.5 * np.diff(_PANELS)[:, None] * _WEIGHTS).ravel()


def effusivity(conductivity: ArrayLike, density: ArrayLike, specific_heat: ArrayLike) -> FloatArray:
    """Thermal effusivity, `sqrt(k rho c)`.

    Parameters
    ----------
    conductivity : float or array
        k; of a bed its effective conductivity. [W/(m K)]
    density : float or array
        rho; of a bed its bulk density. [kg/m3]
    specific_heat : float or array
        c. [J/(kg K)]

    Returns
    -------
    float or array
        Effusivity. [W s^0.5/(m2 K)]

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    k = positive("conductivity", conductivity, "W/(m K)")
    rho, c = positive("density", density, "kg/m3"), positive("specific_heat", specific_heat, "J/(kg K)")
    return plain(np.sqrt(k * rho * c))


def _transform(x: FloatArray, factor: int, step: FloatArray | None = None) -> FloatArray:
    """`2/sqrt(pi) int_0^inf (2u)^n exp(-u^2 - 2ux) du`, which is (-1)^n times the n-th derivative of erfcx at x.

    With a `step` b the integrand is also multiplied by `1 - exp(-2ub)`: for n = 0, erfcx(x) - erfcx(x + b). All
    terms are positive.
    """
    u = _POINTS / (1.0 + x[..., None])
    values = (2.0 * u) ** factor * np.exp(-u * u - 2.0 * u * x[..., None])
    if step is not None:
        values = values * -np.expm1(-2.0 * u * step[..., None])
    return np.asarray(2.0 / math.sqrt(math.pi) * np.sum(_POINT_WEIGHTS * values, axis=-1) / (1.0 + x))


def contact_flux(
    time: ArrayLike, coefficient: ArrayLike, block_effusivity: ArrayLike, bed_effusivity: ArrayLike
) -> FloatArray:
    """Heat flux between two half-spaces joined by a contact coefficient, over `h (T_block - T_bed)`.

    `exp(B^2) erfc(B)` with `B = h sqrt(t) (1/e_block + 1/e_bed)` (Carslaw and Jaeger 1959, section 2.7; Sullivan and
    Sabersky's wall resistance).

    Parameters
    ----------
    time : float or array
        Time since the bed met the block. [s]
    coefficient : float or array
        h between block and bed. [W/(m2 K)]
    block_effusivity, bed_effusivity : float or array
        Effusivities; an infinite one stands for a body that keeps its temperature. [W s^0.5/(m2 K)]

    Returns
    -------
    float or array
        Flux over its value at time 0, from 1 down to 0.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    B = _contact_number(time, coefficient, block_effusivity, bed_effusivity)
    return plain(special.erfcx(B))


def _contact_number(time: ArrayLike, h: ArrayLike, block: ArrayLike, bed: ArrayLike) -> FloatArray:
    t = non_negative("time", time, "s")
    e_block = positive("block_effusivity", block, "W s^0.5/(m2 K)", infinite=True)
    e_bed = positive("bed_effusivity", bed, "W s^0.5/(m2 K)", infinite=True)
    return np.asarray(positive("coefficient", h, "W/(m2 K)") * np.sqrt(t) * (1.0 / e_block + 1.0 / e_bed))


def half_space_drop(
    time: ArrayLike,
    depth: ArrayLike,
    coefficient: ArrayLike,
    block_effusivity: ArrayLike,
    bed_effusivity: ArrayLike,
    block_diffusivity: ArrayLike,
) -> FloatArray:
    """Temperature drop in a half-space block on a half-space bed, over `T_block - T_bed` at the start.

    `e_bed/(e_block + e_bed) [erfc(xi) - exp(-xi^2) erfcx(xi + B)]` with `xi = depth/(2 sqrt(alpha_block t))` and B
    of `contact_flux` (Carslaw and Jaeger 1959, section 2.7).

    Parameters
    ----------
    time : float or array
        Time since the bed met the block. [s]
    depth : float or array
        Depth of the thermometer below the surface of the block. [m]
    coefficient : float or array
        h between block and bed. [W/(m2 K)]
    block_effusivity, bed_effusivity : float or array
        Effusivities; the block's must be finite. [W s^0.5/(m2 K)]
    block_diffusivity : float or array
        k/(rho c) of the block. [m2/s]

    Returns
    -------
    float or array
        Drop, from 0 to `e_bed/(e_block + e_bed)`.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    B = _contact_number(time, coefficient, positive("block_effusivity", block_effusivity), bed_effusivity)
    z, alpha = non_negative("depth", depth, "m"), positive("block_diffusivity", block_diffusivity, "m2/s")
    t = np.asarray(time, dtype=np.float64)
    ratio = 1.0 / (1.0 + np.asarray(block_effusivity) / np.asarray(bed_effusivity, dtype=np.float64))
    started = t > 0.0
    xi = np.where(started, z / (2.0 * np.sqrt(alpha * np.where(started, t, 1.0))), 0.0)
    # beyond this depth nothing is left in floating point
    xi, B, ratio = np.broadcast_arrays(np.minimum(xi, _DEEPEST), B, ratio)
    difference = special.erfcx(xi) - special.erfcx(xi + B)
    small = _SMALL_STEP * (1.0 + xi) > B
    # what two nearly equal values of erfcx leave is taken as one integral
    near = _transform(np.where(small, xi, 0.0), 0, np.where(small, B, 0.0))
    return plain(ratio * np.exp(-xi * xi) * np.where(small, near, difference))


def _roots(t: FloatArray, h: FloatArray, capacity: FloatArray, e: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sum and product of the roots a, b, times sqrt(t): (sqrt(p) + a)(sqrt(p) + b) = p + (h/e) sqrt(p) + h/m."""
    return np.asarray(h / e * np.sqrt(t)), np.asarray(h / capacity * t)


def _slope(z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Minus the derivative of erfcx, `2/sqrt(pi) - 2 z erfcx(z)`, for complex z in the right half-plane."""
    far = np.abs(z) > _FAR
    w = special.wofz(1j * np.where(far, 1.0, z))
    near = 2.0 / math.sqrt(math.pi) - 2.0 * z * w
    x = 1.0 / np.where(far, z, 1.0) ** 2
    series = np.zeros_like(z)
    for n in range(_FAR_TERMS, 0, -1):
        series = -(n + 0.5) * x * (1.0 + series)
    return np.asarray(np.where(far, (1.0 + series) * x / math.sqrt(math.pi), near))


def _fall(z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """`(1 - erfcx(z))/z`, for z in the right half-plane; complex ones not near 0."""
    near = (z.imag == 0.0) & (z.real < _SMALL_STEP)
    x = np.where(near, z.real, 1.0)
    integral = _transform(np.zeros_like(x), 0, x) / np.where(x == 0.0, 1.0, x)
    safe = np.where(near, 1.0, z)
    return np.asarray(np.where(near, integral, (1.0 - special.wofz(1j * safe)) / safe))


def _divided(total: FloatArray, product: FloatArray, drop: bool) -> FloatArray:
    """`[b erfcx(a) - a erfcx(b)]/(b - a)` less 1 if `drop`, else `[b erfcx(b) - a erfcx(a)]/(b - a)`.

    The first is written as `a b [f(a) - f(b)]/(a - b)` with f of `_fall`, the second with the slopes of erfcx.

    The roots are real, double or a conjugate pair; `a` is the larger of two real ones.
    """
    half = 0.5 * total
    # of the size of the sum, and of the product, whichever is the larger: neither may overflow when squared
    size = np.maximum(half, np.sqrt(product))
    difference = np.asarray((half / size) ** 2 - product / size / size)
    root = size * np.sqrt(difference.astype(np.complex128))
    a = half + root
    b = np.where(difference >= 0.0, product / a, np.conj(a))
    apart = np.abs(root) > _CLOSE_ROOTS * half
    # around a double root m, in the square of half the distance, which is of either sign
    m, d2 = np.where(apart, 1.0, half), np.where(apart, 0.0, difference) * np.where(apart, 1.0, size) ** 2
    w = [_transform(m, n) for n in range(5)]
    if drop:
        general = product * (_fall(a) - _fall(b)) / np.where(apart, a - b, 1.0)
        close = w[0] + m * w[1] + d2 * (0.5 * w[2] + m * w[3] / 6.0) - 1.0
    else:
        # x erfcx(x) is 1/sqrt(pi) less half of its slope, and the slope of that half the second derivative
        general = 0.5 * (_slope(a) - _slope(b)) / np.where(apart, b - a, 1.0)
        close = 0.5 * (w[2] + d2 * w[4] / 6.0)
    return np.asarray(np.where(apart, general.real, close))


def _series(total: FloatArray, product: FloatArray, drop: bool) -> FloatArray:
    """The same for small roots, by powers: `S_n = a S_(n-1) + b^n` needs the sum and product of the roots only."""
    result = np.zeros_like(total)
    before, now = np.zeros_like(total), np.ones_like(total)
    for n in range(_SERIES_TERMS):
        power = n + 2 if drop else n
        result = result + (-1.0) ** n / math.gamma(0.5 * power + 1.0) * now
        before, now = now, total * now - product * before
    return np.asarray(-product * result if drop else result)


def _block(time: ArrayLike, h: ArrayLike, capacity: ArrayLike, bed: ArrayLike, drop: bool) -> FloatArray:
    t, coefficient = non_negative("time", time, "s"), positive("coefficient", h, "W/(m2 K)")
    m = positive("heat_capacity", capacity, "J/(m2 K)", infinite=True)
    e = positive("bed_effusivity", bed, "W s^0.5/(m2 K)", infinite=True)
    total, product = np.broadcast_arrays(*_roots(t, coefficient, m, e))
    small = np.maximum(total, np.sqrt(product)) < _SMALL_ROOT
    none = np.zeros_like(total)
    near = _series(np.where(small, total, none), np.where(small, product, none), drop)
    far = _divided(np.where(small, 3.0, total), np.where(small, 1.0, product), drop)
    return np.asarray(np.where(small, near, far))


def lumped_block_flux(
    time: ArrayLike, coefficient: ArrayLike, heat_capacity: ArrayLike, bed_effusivity: ArrayLike
) -> FloatArray:
    """Heat flux from a block of one temperature into a half-space bed, over `h (T_block - T_bed)` at the start.

    The Laplace transform is `1/(p + (h/e) sqrt(p) + h/m) = 1/[(sqrt(p) + a)(sqrt(p) + b)]`, hence
    `[b erfcx(b sqrt(t)) - a erfcx(a sqrt(t))]/(b - a)`; a and b are real or a conjugate pair.

    Parameters
    ----------
    time : float or array
        Time since the bed met the block. [s]
    coefficient : float or array
        h between block and bed. [W/(m2 K)]
    heat_capacity : float or array
        Mass times specific heat of the block over the area of its face, m; infinite for a block that keeps its
        temperature. [J/(m2 K)]
    bed_effusivity : float or array
        Effusivity of the bed; infinite for a bed that keeps its temperature. [W s^0.5/(m2 K)]

    Returns
    -------
    float or array
        Flux over its value at time 0, from 1 down to 0.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    return plain(_block(time, coefficient, heat_capacity, bed_effusivity, drop=False))


def lumped_block_drop(
    time: ArrayLike, coefficient: ArrayLike, heat_capacity: ArrayLike, bed_effusivity: ArrayLike
) -> FloatArray:
    """Temperature drop of a block of one temperature on a half-space bed, over `T_block - T_bed` at the start.

    `1 - [b erfcx(a sqrt(t)) - a erfcx(b sqrt(t))]/(b - a)` with a + b = h/e, a b = h/m.

    Parameters
    ----------
    time, coefficient, heat_capacity, bed_effusivity
        As for `lumped_block_flux`.

    Returns
    -------
    float or array
        Drop, from 0 up to 1.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    # 1 may come out as 1 and a rounding
    return plain(np.clip(0.0 - _block(time, coefficient, heat_capacity, bed_effusivity, drop=True), 0.0, 1.0))
