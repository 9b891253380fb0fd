"""Modes of the two-layer model (Watkins 2018, appendix B): all of them, in order, by counting phase.

Lengths in tube radii, conductivities in k_b. A mode is `a J0(mu r)` in the bulk (r < W) and, in the wall layer with
`nu = sqrt(kappa) mu`, the solution u(r) with the value 1 and no slope at the wall. Written with that normalisation
the eigencondition (79), the coefficients (75)-(76) and the norm (78) need no division that could fail:

    u(r)  = (pi nu/2) [J1(nu) Y0(nu r) - Y1(nu) J0(nu r)]
    psi   = u'(W)/nu = -(pi nu/2) [J1(nu) Y1(nu W) - Y1(nu) J1(nu W)]
    norm  = integral of r phi^2 = [1 + W^2 (1 - kappa) (a J1(mu W))^2]/2
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special
from scipy.optimize import elementwise

from bedrad.heat import ranges
from bedrad.heat.ranges import FloatArray, positive

__all__ = ["Layers", "Modes", "checked", "count_below", "diameter_ratios", "find_modes", "layers"]

_VERIFIED = 1e-6, 1e6
"""Conductivity ratios between which series and transform were held against each other; rounding grows outwards."""

_SLACK = 4
"""Half turns by which the total phase can differ from `mu (W + sqrt(kappa) (1 - W))`; in truth under two."""


@dataclass(frozen=True, eq=False)
class Layers:
    """Geometry and conductivities of n pairs of layers.

    Parameters
    ----------
    W : (n,) array
        Radius of the bulk in tube radii (Watkins 2018, eq. 23).
    e : (n,) array
        Thickness of the wall layer in tube radii, kept beside W for the digits of thin layers.
    kappa : (n,) array
        Bulk over wall-layer conductivity.
    """

    W: FloatArray
    e: FloatArray
    kappa: FloatArray

    @property
    def resistance(self) -> FloatArray:
        """Wall less mean temperature of the developed flow over q R/k_b, (n,): [W^4 + kappa (1 - W^4)]/4."""
        wall_share = self.e * (4.0 + self.e * (-6.0 + self.e * (4.0 - self.e)))
        return np.asarray(0.25 * (self.W**4 + self.kappa * wall_share))

    @property
    def depth(self) -> FloatArray:
        """Thickness of both layers in diffusion lengths of the bulk, (n,): W + sqrt(kappa) (1 - W)."""
        return np.asarray(self.W + np.sqrt(self.kappa) * self.e)

    def take(self, which: NDArray[np.int64] | slice) -> Layers:
        """Some of the pairs, by numpy's rules of indexing."""
        return Layers(self.W[which], self.e[which], self.kappa[which])


def layers(diameter_ratio: FloatArray, conductivity_ratio: FloatArray) -> Layers:
    """Layers of n tubes; W as (A - 1)/A, which keeps its digits down to A = 1."""
    A = np.asarray(diameter_ratio, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        W = np.where(np.isinf(A), 1.0, (A - 1.0) / A)
    return Layers(W, np.asarray(1.0 / A), np.asarray(conductivity_ratio, dtype=np.float64))


def diameter_ratios(values: ArrayLike) -> FloatArray:
    """A as floats, infinity allowed, refused unless above 1."""
    A = positive("diameter_ratio", values, infinite=True)
    if np.any(A <= 1.0):
        raise ValueError(f"diameter_ratio is {float(np.min(A)):g}; expected more than 1")
    return A


def checked(diameter_ratio: ArrayLike, conductivity_ratio: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """A and kappa as floats, refused where they have no meaning; warns of a kappa beyond the verified ones."""
    A = diameter_ratios(diameter_ratio)
    kappa = positive("conductivity_ratio", conductivity_ratio)
    low, high = _VERIFIED
    if np.any((kappa < low) | (kappa > high)):
        worst = float(kappa.flat[int(np.argmax(np.abs(np.log(kappa))))])
        ranges.warn(
            f"two-layer model: conductivity_ratio is {worst:g}, outside {low:g} to {high:g} where digits were verified"
        )
    return A, kappa


@dataclass(frozen=True, eq=False)
class Modes:
    """The first m modes of n pairs of layers, with the value 1 at the wall.

    Parameters
    ----------
    layers : Layers
        The n pairs.
    mu : (n, m) array
        Eigenvalues lambda_b R.
    weights : (n, m) array
        Shares of the modes in wall less mean temperature, all positive: `phi(R)^2/(norm mu^2)`, in q R/k_b. All modes
        together add up to `layers.resistance`.
    bulk : (n, m) array
        Amplitudes a of J0 in the bulk.
    """

    layers: Layers
    mu: FloatArray
    weights: FloatArray
    bulk: FloatArray

    def shapes(self, r: FloatArray) -> FloatArray:
        """Values (n, k, m) of the modes at radii r (n, k), in tube radii."""
        mu, bulk, radius = self.mu[:, None, :], self.bulk[:, None, :], r[:, :, None]
        nu = np.sqrt(self.layers.kappa)[:, None, None] * mu
        in_bulk = radius <= self.layers.W[:, None, None]
        # the other layer's formula is evaluated at the wall, where it is finite
        outer = np.where(in_bulk, 1.0, radius)
        wall = _wall_value(nu, special.j1(nu), special.y1(nu), nu * outer)
        return np.asarray(np.where(in_bulk, bulk * special.j0(mu * np.where(in_bulk, radius, 0.0)), wall))


def _wall_value(nu: FloatArray, J1: FloatArray, Y1: FloatArray, x: FloatArray) -> FloatArray:
    return np.asarray(0.5 * math.pi * nu * (J1 * special.y0(x) - Y1 * special.j0(x)))


def _wall_layer(nu: FloatArray, W: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """u(W), psi(W), and the turn of the phase of (J1, Y1) from W to the wall."""
    J1, Y1, x = special.j1(nu), special.y1(nu), nu * W
    J1_W, Y1_W = special.j1(x), special.y1(x)
    u = _wall_value(nu, J1, Y1, x)
    psi = np.asarray(-0.5 * math.pi * nu * (J1 * Y1_W - Y1 * J1_W))
    return u, psi, _bessel_phase(nu, J1, Y1) - _bessel_phase(x, J1_W, Y1_W)


def _bessel_phase(x: FloatArray, J1: FloatArray, Y1: FloatArray) -> FloatArray:
    """Continuous phase of J1 + i Y1; it stays within pi/4 of x - 3 pi/4."""
    angle = np.arctan2(Y1, J1)
    return np.asarray(angle + 2.0 * math.pi * np.round((x - 0.75 * math.pi - angle) / (2.0 * math.pi)))


def _phase(mu: FloatArray, W: FloatArray, kappa: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Total phase as an angle and a whole number of half turns.

    In the bulk the phase turns with `tan = sqrt(kappa) J1/J0`, in the wall layer, from the wall inwards, with
    `tan = psi/u`; value and flux agree at W where the sum is a multiple of pi. By Sturm's theorem each of the two grows
    with mu whenever it passes such a multiple, so that the sum passes every multiple once: at mode number n.
    """
    root, x = np.sqrt(kappa), mu * W
    J0, J1 = special.j0(x), special.j1(x)
    sign = np.where(J0 < 0.0, -1.0, 1.0)
    # J1/J0 = tan(phase) and its stretched form share their half turn; the phase stays within pi/4 of x - pi/4
    half_turns = np.round((x - 0.25 * math.pi - np.arctan2(sign * J1, np.abs(J0))) / math.pi)
    bulk = np.arctan2(root * sign * J1, np.abs(J0))
    u, psi, turn = _wall_layer(root * mu, W)
    # psi and the turn of (J1, Y1) vanish together, so that the two phases are less than half a turn apart
    wall = np.arctan2(psi, u)
    half_turns = half_turns + 2.0 * np.round((turn - wall) / (2.0 * math.pi))
    return np.asarray(bulk + wall), np.asarray(half_turns)


def count_below(pairs: Layers, mu: FloatArray) -> FloatArray:
    """How many modes of each pair have an eigenvalue below mu (n,), exactly but for a tie."""
    angle, half_turns = _phase(mu, pairs.W, pairs.kappa)
    return np.asarray(np.maximum(np.ceil(angle / math.pi + half_turns) - 1.0, 0.0))


def find_modes(pairs: Layers, number: int) -> Modes:
    """The first `number` modes of each pair, none left out.

    Raises
    ------
    ArithmeticError
        If a mode is not found, which would be a fault of this module.
    """
    W, kappa, unit = pairs.W[:, None], pairs.kappa[:, None], math.pi / pairs.depth[:, None]
    n = np.arange(1.0, number + 1.0)[None, :]
    low, high = np.maximum(n - _SLACK, 1e-6) * unit, (n + _SLACK) * unit

    def beyond(mu: FloatArray, W: FloatArray, kappa: FloatArray, n: FloatArray) -> FloatArray:
        angle, half_turns = _phase(mu, W, kappa)
        return np.asarray(angle + (half_turns - n) * math.pi)

    found = elementwise.find_root(beyond, (low, high), args=(W, kappa, n), tolerances={"xrtol": 4e-16, "xatol": 0.0})
    if not np.all(found.success):
        raise ArithmeticError("a mode of the two-layer model was not found")
    mu: FloatArray = found.x
    u, psi, _ = _wall_layer(np.sqrt(kappa) * mu, W)
    J0, J1 = special.j0(mu * W), special.j1(mu * W)
    # u = a J0 and psi = -sqrt(kappa) a J1, weighed so that neither is divided by its zeros
    bulk = (u * J0 - psi * np.sqrt(kappa) * J1) / (J0**2 + kappa * J1**2)
    slope = np.where(kappa > 1.0, psi**2 / kappa, (bulk * J1) ** 2)
    weights = 2.0 / (mu**2 * (1.0 + W**2 * (1.0 - kappa) * slope))
    return Modes(pairs, mu, weights, np.asarray(bulk))
