"""The two-layer model at short times: its Laplace transform along z, inverted by quadrature.

Where the series needs too many modes the transform needs none. With `s` for the time `t = 4 z*` (in units of
R^2/alpha_b), p = sqrt(s) and q = sqrt(kappa s), bulk and wall layer are combinations of I0 and K0, and the inversion
is a sum of few terms along a hyperbola around the negative axis, where all the poles are (contour of Weideman and
Trefethen 2007, Math. Comput. 76, 1341). The Bessel functions enter scaled by their exponentials, for large arguments
as their asymptotic series: as t falls the wall layer turns into a slab on a half space, and then into a half space,
without overflow or cancellation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy import special

from bedrad.heat.ranges import FloatArray
from bedrad.heat.two_layer_modes import Layers

__all__ = ["CONTOUR_ERROR", "field_rise", "wall_excess"]

ComplexArray = NDArray[np.complex128]

CONTOUR_ERROR = 1e-12
"""Largest relative error of the inversion, as tested against 17 digits: its rounding, and what 16 points leave."""

_BLOCK = 1 << 18
"""Points inverted at once, which bounds the memory of large arrays."""

_NODES = 16
"""Points on each half of the contour; another leaves a tenth of the error and multiplies the rounding by 1.4."""

_ALPHA, _STEP, _STRETCH = 1.172104229, 1.081792140 / _NODES, 4.492075287 * _NODES
"""Opening, step and size of the hyperbola by Weideman and Trefethen."""

_FAR = 100.0
"""Argument beyond which e^-2q on the contour is below rounding, and the asymptotic series has its digits in 9 terms."""

_TERMS = 9


def _contour() -> tuple[ComplexArray, ComplexArray]:
    """Points s t and weights, upper half: f(t) = real part of sum of weights F(s)/t."""
    u = (np.arange(_NODES) + 0.5) * _STEP
    angle = 1j * u - _ALPHA
    points = _STRETCH * (1.0 + np.sin(angle))
    slope = _STRETCH * 1j * np.cos(angle)
    return points, np.exp(points) * slope * _STEP / (1j * math.pi)


def _hankel_coefficients(order: int) -> FloatArray:
    values = [1.0]
    for k in range(1, _TERMS):
        values.append(values[-1] * (4 * order**2 - (2 * k - 1) ** 2) / (8.0 * k))
    return np.array(values)


_HANKEL = (_hankel_coefficients(0), _hankel_coefficients(1))


def _far(order: int, x: ComplexArray, sign: float) -> ComplexArray:
    """Asymptotic series of sqrt(2 pi x) e^-x I (sign -1) or sqrt(2 x/pi) e^x K (sign 1)."""
    return np.asarray(np.polynomial.polynomial.polyval(sign / x, _HANKEL[order]))


def _grow(order: int, x: ComplexArray) -> ComplexArray:
    """I(x) e^-x for arguments on the contour, whose real part is at least a fifth of their size."""
    far = np.abs(x) > _FAR
    near = np.where(far, 1.0, x)
    large = np.where(far, x, _FAR)
    small = special.ive(order, near) * np.exp(-1j * near.imag)
    return np.asarray(np.where(far, _far(order, large, -1.0) / np.sqrt(2.0 * math.pi * large), small))


def _decay(order: int, x: ComplexArray) -> ComplexArray:
    """K(x) e^x."""
    far = np.abs(x) > _FAR
    large = np.where(far, x, _FAR)
    small = special.kve(order, np.where(far, 1.0, x))
    return np.asarray(np.where(far, _far(order, large, 1.0) * np.sqrt(0.5 * math.pi / large), small))


class _Waves:
    """Solution at points s (n, 1, nodes) of n pairs of layers, regular at the axis."""

    def __init__(self, pairs: Layers, s: ComplexArray) -> None:
        self.W, self.e, self.kappa = pairs.W[:, None, None], pairs.e[:, None, None], pairs.kappa[:, None, None]
        self.p: ComplexArray = np.sqrt(s)
        self.q: ComplexArray = self.p * np.sqrt(self.kappa)
        x, bulk = self.q * self.W, self.p * self.W
        self._grow_W = _grow(0, x), _grow(1, x)
        self._decay_W = _decay(0, x), _decay(1, x)
        self.bulk_W = _grow(0, bulk)
        # slope over q at W that carries the flux of the bulk, for the value 1 there
        self._slope_W = np.sqrt(self.kappa) * _grow(1, bulk) / self.bulk_W
        at_wall = np.zeros((1, 1, 1))
        self._wall = self._in_layer(0, at_wall)
        self.impedance: ComplexArray = self.kappa / self.q * self._wall / self._in_layer(1, at_wall)

    def _in_layer(self, order: int, depth: FloatArray) -> ComplexArray:
        """Value (order 0) or slope over q (order 1) `depth` below the wall for the value 1 at W, over e^(q (r - W))."""
        x, sign = self.q * (1.0 - depth), 1.0 - 2.0 * order
        grow = _grow(order, x)
        decay = sign * np.exp(-2.0 * self.q * (self.e - depth)) * _decay(order, x)
        value = grow * self._decay_W[1] + decay * self._grow_W[1]
        slope = grow * self._decay_W[0] - decay * self._grow_W[0]
        return np.asarray(self.q * self.W * (value + self._slope_W * slope))

    def relative(self, r: FloatArray) -> ComplexArray:
        """Value at radii r (n, k, 1) over that at the wall, (n, k, nodes)."""
        in_bulk = r <= self.W
        depth = np.where(in_bulk, 0.0, 1.0 - r)
        layer = self._in_layer(0, depth) * np.exp(-self.q * depth)
        inner = np.where(in_bulk, r, 0.0)
        bulk = _grow(0, self.p * inner) / self.bulk_W * np.exp(-self.p * (self.W - inner) - self.q * self.e)
        return np.asarray(np.where(in_bulk, bulk, layer) / self._wall)


def _blocks(number: int, width: int) -> Iterator[slice]:
    """Slices of n flows with `width` radii each."""
    at_once = max(1, _BLOCK // (_NODES * width))
    return (slice(start, start + at_once) for start in range(0, number, at_once))


# what has faded below 1e-308 is nothing beside the rest
@np.errstate(under="ignore")
def wall_excess(pairs: Layers, t: FloatArray) -> FloatArray:
    """Wall less mean temperature over q R/k_b at times t (n,) of n pairs of layers."""
    points, weights = _contour()
    value = np.empty(t.size)
    for some in _blocks(t.size, 1):
        s = points / t[some, None]
        impedance = _Waves(pairs.take(some), s[:, None, :]).impedance[:, 0, :]
        value[some] = (weights / points * (impedance - 2.0 / s)).real.sum(axis=1)
    return value


@np.errstate(under="ignore")
def field_rise(pairs: Layers, t: FloatArray, r: FloatArray) -> FloatArray:
    """Temperature above the inlet's over q R/k_b, (n, k), at times t (n,) and radii r (n, k) in tube radii."""
    points, weights = _contour()
    value = np.empty(r.shape)
    for some in _blocks(t.size, r.shape[1]):
        waves = _Waves(pairs.take(some), (points / t[some, None])[:, None, :])
        value[some] = (weights / points * waves.impedance * waves.relative(r[some, :, None])).real.sum(axis=2)
    return value
