"""Heat conduction inside one sphere that is heated through its fluid lens (Adepu et al., eq. 12-14).

The temperature is expanded in Legendre polynomials of the polar angle and, along the radius, in the polynomials
`r^l P_k^(0, l+1/2)(2 r^2 - 1)`, orthogonal over the ball. Galerkin's equations are then `M da/dt = -(K + C) a`
with M diagonal, K (conduction inside) in closed form, and C (the lens) by quadrature; all are symmetric. Their
eigenvectors give the course of time exactly, however stiff: no step size, any Biot number. Energy is conserved to
rounding, because the constant is one of the functions.

Lengths are in particle radii, times are Fourier numbers `alpha t/r^2`, temperatures `(T - T_0)/(T_wall - T_0)`, heat
rates are over `k_s r (T_wall - T_0)`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg, optimize, special

from bedrad.heat import fluid_lens
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within

__all__ = [
    "ErrorMeasure",
    "ParticleTransient",
    "critical_biot",
    "heated_through_lens",
    "heated_uniformly",
    "isothermal_error",
]

ErrorMeasure = Literal["rate", "heat", "resistance"]

MODES = 120
"""Legendre polynomials: they resolve lenses with asperities down to about 1e-4 radii."""

RADIAL = 10
"""Radial polynomials of the lowest Legendre mode; higher modes, which live near the surface, get fewer."""

_LARGEST_MODES, _LARGEST_RADIAL, _FEWEST_RADIAL = 1000, 200, 2
_VOLUME = 4.0 * math.pi / 3.0


@dataclass(frozen=True, eq=False)
class ParticleTransient:
    """How one sphere takes up heat from a wall whose temperature steps up at time 0.

    Parameters
    ----------
    biot : float
        Biot number, with the radius as length and the area of the lens (or of the sphere) as area.
    conductance : float
        H/(k_s r), of the whole lens with the particle at one temperature.
    decay_rates : (n,) array
        Rates at which the parts of the temperature decay, ascending, over `alpha/r^2`.
    weights : (n,) array
        Share of each part in the mean temperature at the start; their sum is 1.
    legendre, radial : (n,) array of int
        l and k of the functions of the expansion.
    vectors : (n, n) array
        Coefficient of function i (first index) in part j, at the start.
    """

    biot: float
    conductance: float
    decay_rates: FloatArray
    weights: FloatArray
    legendre: NDArray[np.int64]
    radial: NDArray[np.int64]
    vectors: FloatArray

    @property
    def time_constant(self) -> float:
        """Fourier number in which an isothermal particle comes within 1/e of the wall, `rho c V/H`."""
        return _VOLUME / self.conductance

    @property
    def lasting_conductance(self) -> float:
        """H/(k_s r) of the particle once its inner profile has settled, resistance inside included."""
        return _VOLUME * float(self.decay_rates[0])

    def mean_temperature(self, fourier: ArrayLike) -> FloatArray:
        """Mean temperature of the particle, `(T - T_0)/(T_wall - T_0)`, at a Fourier number."""
        t = non_negative("fourier", fourier)
        return plain(-np.expm1(np.multiply.outer(-t, self.decay_rates)) @ self.weights)

    def heat_rate(self, fourier: ArrayLike) -> FloatArray:
        """Heat rate into the particle over `k_s r (T_wall - T_0)`, at a Fourier number."""
        t = non_negative("fourier", fourier)
        return plain(_VOLUME * (np.exp(np.multiply.outer(-t, self.decay_rates)) @ (self.weights * self.decay_rates)))

    def isothermal_heat_rate(self, fourier: ArrayLike) -> FloatArray:
        """Heat rate of a particle with one temperature throughout, `H exp(-t/time_constant)`."""
        t = non_negative("fourier", fourier)
        return plain(self.conductance * np.exp(-t / self.time_constant))

    def temperature(self, fourier: float, radius: ArrayLike, cosine: ArrayLike) -> FloatArray:
        """Temperature inside the particle, `(T - T_0)/(T_wall - T_0)`.

        Parameters
        ----------
        fourier : float
            Fourier number.
        radius : float or array
            Distance from the centre, in particle radii, from 0 to 1.
        cosine : float or array
            Cosine of the angle from the point nearest to the wall, from -1 to 1.

        Returns
        -------
        float or array
            Temperature, of the broadcast shape.

        Raises
        ------
        ValueError
            If a point lies outside the particle, or the time is not one number or negative.
        """
        t = non_negative("fourier", fourier)
        if t.ndim:
            raise ValueError(f"fourier has shape {t.shape}; expected one number")
        r, mu = np.broadcast_arrays(within("radius", radius, 0.0, 1.0), within("cosine", cosine, -1.0, 1.0))
        amplitudes = self.vectors @ np.exp(-t * self.decay_rates)
        total = np.zeros(r.shape)
        for l in np.unique(self.legendre):  # noqa: E741
            k = self.radial[self.legendre == l]
            shape = special.eval_jacobi(k, 0.0, l + 0.5, (2.0 * r * r - 1.0)[..., None])
            total += (shape @ amplitudes[self.legendre == l]) * r**l * special.eval_legendre(l, mu)
        return plain(1.0 - total)

    def __str__(self) -> str:
        """One screen."""
        return (
            f"sphere heated at Bi {self.biot:.4g}: isothermal H/(k_s r) {self.conductance:.5g}, lasting "
            f"{self.lasting_conductance:.5g} ({self.lasting_conductance / self.conductance:.1%})\n"
            f"  isothermal particle overstates the heat rate by {isothermal_error(self):.2%} on average over one "
            f"time constant, alpha t/r^2 = {self.time_constant:.4g}\n"
            f"  {self.legendre[-1] + 1} Legendre modes, {self.legendre.size} functions"
        )


@dataclass(frozen=True, eq=False)
class _Expansion:
    """Functions of the expansion, with mass and stiffness; the trace of every function at the surface is P_l."""

    legendre: NDArray[np.int64]
    radial: NDArray[np.int64]
    mass: FloatArray
    stiffness: FloatArray
    step: FloatArray


def _expansion(modes: int, radial: int) -> _Expansion:
    degrees = np.arange(modes)
    counts = np.maximum(np.ceil(radial / (1.0 + degrees / 8.0)), min(radial, _FEWEST_RADIAL)).astype(np.int64)
    l = np.repeat(degrees, counts)  # noqa: E741
    k = np.concatenate([np.arange(count) for count in counts])
    angular = 2.0 / (2.0 * l + 1.0)
    # The smoother of two functions is orthogonal to the Laplacian of the other, so that their product of gradients
    # is the radial derivative of the smoother one at the surface, l + k (2k + 2l + 3).
    slope = l + k * (2.0 * k + 2.0 * l + 3.0)
    stiffness = np.where(l[:, None] == l, angular * np.minimum.outer(slope, slope), 0.0)
    step = angular * np.where(k == 0, l, 4.0 * k + 2.0 * l + 1.0)
    return _Expansion(l, k, angular / (4.0 * k + 2.0 * l + 3.0), stiffness, np.asarray(step, dtype=np.float64))


def _decay(functions: _Expansion, surface: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rates and orthonormal vectors of `M da/dt = -(K + C) a`, with `surface` = C between Legendre modes.

    Rounding in the eigenvalues is that of the fastest; the slowest, which vanishes with the Biot number, is refined
    by inverse iteration on a Cholesky factor scaled to a unit diagonal, and summed without cancellation.
    """
    l, root = functions.legendre, np.sqrt(functions.mass)  # noqa: E741
    coupling = surface[np.ix_(l, l)]
    system = (functions.stiffness + coupling) / np.outer(root, root)
    rates, vectors = linalg.eigh(system, driver="evd", check_finite=False)
    scale = 1.0 / np.sqrt(np.diag(system))
    factor = linalg.cho_factor(system * np.outer(scale, scale), check_finite=False)
    slow = vectors[:, 0]
    for _ in range(2):
        slow = scale * linalg.cho_solve(factor, scale * slow, check_finite=False)
        slow = slow / np.linalg.norm(slow)
    a = slow / root
    # K sums the squares of the tails of a within each Legendre mode, so that nothing cancels
    tails = np.cumsum(a[::-1])[::-1]
    ends = np.append(np.flatnonzero(np.diff(l)) + 1, l.size)
    tails = tails - np.append(tails, 0.0)[ends][np.searchsorted(ends, np.arange(l.size), side="right")]
    rates[0] = functions.step @ tails**2 + a @ coupling @ a
    vectors[:, 0] = slow
    return rates, vectors


def _transient(biot: float, conductance: float, functions: _Expansion, surface: FloatArray) -> ParticleTransient:
    rates, vectors = _decay(functions, surface)
    start = vectors[0]
    return ParticleTransient(
        biot=biot,
        conductance=conductance,
        decay_rates=rates,
        weights=start**2 / np.sum(start**2),
        legendre=functions.legendre,
        radial=functions.radial,
        vectors=vectors / np.sqrt(functions.mass)[:, None] * (start * math.sqrt(functions.mass[0])),
    )


def _checked_size(name: str, value: int, largest: int) -> int:
    if value != int(value) or not 1 <= value <= largest:
        raise ValueError(f"{name} is {value}; expected a whole number from 1 to {largest}")
    return int(value)


def heated_uniformly(biot: float, radial: int = 40) -> ParticleTransient:
    """Sphere heated through one coefficient h all over its surface (the classical case).

    Parameters
    ----------
    biot : float
        `h r/k_s`.
    radial : int
        Radial polynomials. 40 hold 1e-10 for Fourier numbers from 1e-3 on, at any Biot number.

    Returns
    -------
    ParticleTransient

    Raises
    ------
    ValueError
        If the Biot number is not positive and finite, or the number of polynomials has no meaning.
    """
    Bi = float(positive("biot", biot))
    functions = _expansion(1, _checked_size("radial", radial, _LARGEST_RADIAL))
    return _transient(Bi, 4.0 * math.pi * Bi, functions, np.array([[2.0 * Bi]]))


def _lens_coupling(gap: float, asperity: float, lens_radius: float, free_path: float, modes: int) -> FloatArray:
    """`int mu P_l P_m/(local gap) dmu` over the lens: C for k_g = k_s."""
    height = 1.0 + gap
    outer = min((lens_radius - height) * (lens_radius + height), 1.0)
    drop = outer / (1.0 + math.sqrt(1.0 - outer))
    flat = min(max(asperity - gap, 0.0), drop)
    narrow = max(gap, asperity) + free_path
    nodes, weights = np.polynomial.legendre.leggauss(modes // 2 + 32)
    # equal steps in the logarithm of the gap: as many in the throat as outside
    panels = max(1, math.ceil(math.log2(1.0 + (drop - flat) / narrow)))
    edges = narrow * (1.0 + (drop - flat) / narrow) ** (np.arange(panels + 1) / panels)
    local = 0.5 * ((edges[1:] + edges[:-1])[:, None] + np.diff(edges)[:, None] * nodes)
    local_weights = 0.5 * np.diff(edges)[:, None] * weights / local
    cap = 1.0 - 0.5 * flat * (1.0 - nodes)
    mu = np.concatenate([cap, (1.0 - flat - (local - narrow)).ravel()])
    weight = mu * np.concatenate([0.5 * flat * weights / narrow, local_weights.ravel()])
    P = np.ones((modes, mu.size))
    for n in range(1, modes):
        P[n] = ((2 * n - 1) * mu * P[n - 1] - (n - 1) * P[n - 2]) / n
    return np.asarray((P * weight) @ P.T)


def _lens_problem(
    gap: float, asperity: float, lens_radius: float, free_path: float, modes: int, radial: int
) -> tuple[_Expansion, FloatArray, float]:
    """Expansion, coupling and conductance at Bi = 1."""
    modes = _checked_size("modes", modes, _LARGEST_MODES)
    radial = _checked_size("radial", radial, _LARGEST_RADIAL)
    delta, s = float(non_negative("gap", gap)), float(non_negative("asperity", asperity))
    # a lens of a particle of radius 1 in a gas of conductivity 1
    H = float(fluid_lens.conductance(1.0, 2.0, delta, s, lens_radius, free_path))
    if H <= 0.0:
        raise ValueError(f"gap is {delta:g} particle radii; expected less than lens_radius - 1 = {lens_radius - 1.0:g}")
    gas = 1.0 / float(fluid_lens.areal_coefficient(1.0, 2.0, delta, s, lens_radius, free_path))
    coupling = gas * _lens_coupling(delta, s, float(lens_radius), float(free_path), modes)
    return _expansion(modes, radial), coupling, gas * H


def heated_through_lens(
    biot: float,
    gap: float,
    asperity: float,
    lens_radius: float = fluid_lens.LENS_RADIUS,
    free_path: float = 0.0,
    modes: int = MODES,
    radial: int = RADIAL,
) -> ParticleTransient:
    """Sphere heated from a flat wall through its fluid lens (Adepu et al., eq. 12 and 13).

    Over the lens the flux into the surface is that of eq. 1 at the local surface temperature,
    `k_g (T_wall - T)/max(l, s)` for each area of *wall*, hence times the cosine of the polar angle for each area of
    surface; the rest of the sphere is adiabatic.

    Parameters
    ----------
    biot : float
        `h r/k_s` with h of eq. 3, as `fluid_lens.biot_number` gives it.
    gap : float
        Gap between wall and particle, in particle radii.
    asperity : float
        Height of the asperities, in particle radii.
    lens_radius : float
        Radius of the lens, in particle radii.
    free_path : float
        Temperature jump distance of the gas, in particle radii.
    modes : int
        Legendre polynomials. 120 hold the heat rate to 1e-5 for asperities of 5e-4 radii or more.
    radial : int
        Radial polynomials of the lowest mode.

    Returns
    -------
    ParticleTransient

    Raises
    ------
    ValueError
        If an input has no meaning, or the wall is out of the reach of the lens.
    """
    Bi = float(positive("biot", biot))
    functions, coupling, conductance = _lens_problem(gap, asperity, lens_radius, free_path, modes, radial)
    return _transient(Bi, Bi * conductance, functions, Bi * coupling)


def isothermal_error(transient: ParticleTransient, measure: ErrorMeasure = "rate") -> float:
    """Relative error of taking a particle as isothermal (Adepu et al., eq. 14).

    Parameters
    ----------
    transient : ParticleTransient
        The particle with the temperature inside it resolved.
    measure : {"rate", "heat", "resistance"}
        "rate" is eq. 14: `1 - q/q_isothermal`, averaged over the first time constant of the isothermal particle.
        "heat" compares the heat taken up by then. "resistance" compares the conductances between wall and mean
        particle temperature once the inner profile has settled; it is twice "rate" at small Biot numbers, where
        the particle that resists more also stays colder for longer.

    Returns
    -------
    float
        Error; positive where the isothermal particle takes up too much heat.

    Raises
    ------
    ValueError
        If `measure` is none of the three.
    """
    if measure not in get_args(ErrorMeasure):
        raise ValueError(f"measure is {measure!r}; expected one of {', '.join(get_args(ErrorMeasure))}")
    if measure == "resistance":
        return 1.0 - transient.lasting_conductance / transient.conductance
    tau = transient.time_constant
    if measure == "heat":
        return 1.0 + float(transient.mean_temperature(tau)) / math.expm1(-1.0)
    # q_isothermal falls with exp(-t/tau), so that each part of the mean is an exponential integral
    parts = tau * transient.decay_rates * transient.weights
    return 1.0 - float(parts @ special.exprel(1.0 - tau * transient.decay_rates))


def critical_biot(
    error: float,
    gap: float,
    asperity: float,
    measure: ErrorMeasure = "rate",
    lens_radius: float = fluid_lens.LENS_RADIUS,
    free_path: float = 0.0,
    modes: int = MODES,
    radial: int = RADIAL,
) -> float:
    """Biot number at which the isothermal particle errs by a given share.

    Parameters
    ----------
    error : float
        Share, between 1e-6 and 0.9.
    gap, asperity, lens_radius, free_path, modes, radial
        As for `heated_through_lens`.
    measure : {"rate", "heat", "resistance"}
        As for `isothermal_error`.

    Returns
    -------
    float
        Biot number.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    wanted = float(within("error", error, 1e-6, 0.9))
    functions, coupling, conductance = _lens_problem(gap, asperity, lens_radius, free_path, modes, radial)

    def excess(logarithm: float) -> float:
        Bi = math.exp(logarithm)
        found = isothermal_error(_transient(Bi, Bi * conductance, functions, Bi * coupling), measure)
        # close to a straight line from end to end
        return math.log(found / (1.0 - found)) - math.log(wanted / (1.0 - wanted))

    return math.exp(optimize.brentq(excess, math.log(1e-8), math.log(1e4), xtol=1e-6))
