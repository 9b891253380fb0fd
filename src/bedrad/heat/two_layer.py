"""Two-layer model of a plug flow in a tube with uniform wall heat flux (Watkins 2018, section 3.1, appendix B).

A bulk of conductivity k_b fills the tube up to one particle radius from the wall; the wall-adjacent layer
there has the conductivity k_wa. Both move with the same uniform velocity and store as much heat per volume.

With A = D/d (tube inner over particle diameter), kappa = k_b/k_wa and the inverse Graetz number
z* = z alpha_b/(U D^2) the Nusselt number Nu = h D/k_b is a function of these three alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import two_layer_evaluation as evaluation
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive
from bedrad.heat.two_layer_development import developed_z_star
from bedrad.heat.two_layer_fields import FlowTemperatures, flow_temperatures, temperature_rise
from bedrad.heat.two_layer_modes import checked, diameter_ratios, layers

__all__ = [
    "FlowTemperatures",
    "NusseltSolution",
    "developed_z_star",
    "flow_temperatures",
    "inverse_graetz",
    "nusselt",
    "nusselt_developed",
    "nusselt_series",
    "nusselt_solution",
    "temperature_rise",
]


@dataclass(frozen=True, eq=False)
class NusseltSolution:
    """Nusselt numbers of the complete two-layer model, with what was neglected.

    Parameters
    ----------
    nusselt : float or array
        Nu = h D/k_b, with h on the difference of wall and mean temperature.
    terms : int or array
        Terms of the series (73) that were added: 0 where none was needed, or where the transform was inverted.
    error_bound : float or array
        Bound of the relative error: of all the terms left out together, or of the inversion. Rounding comes on top,
        some 1e-13 (1e-12 for conductivity ratios of 1e-4 and 1e4).
    """

    nusselt: FloatArray
    terms: evaluation.IntArray
    error_bound: FloatArray

    def __str__(self) -> str:
        Nu, terms, bound = (np.asarray(x) for x in (self.nusselt, self.terms, self.error_bound))
        if Nu.size == 0:
            return "no Nusselt numbers"
        values = f"{float(Nu.min()):.8g}" if Nu.size == 1 else f"{float(Nu.min()):.6g} to {float(Nu.max()):.6g}"
        return f"Nu = {values} ({int(terms.max())} terms at most, relative error below {float(bound.max()):.1e})"


def nusselt_developed(diameter_ratio: ArrayLike, conductivity_ratio: ArrayLike) -> FloatArray:
    """Nusselt number of the thermally developed flow (Watkins 2018, eq. 22-23).

    The two terms of its denominator are the resistances of bulk and wall layer in series, so the heat
    transfer coefficient `h = Nu k_b/D` rises with either conductivity.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, above 1; may be infinite.
    conductivity_ratio : float or array
        Bulk over wall-layer conductivity, kappa = k_b/k_wa.

    Returns
    -------
    float or array
        Nu = h D/k_b, with h on the difference of wall and mean temperature.

    Raises
    ------
    ValueError
        If the diameter ratio is not above 1 or the conductivity ratio not positive.
    """
    kappa = positive("conductivity_ratio", conductivity_ratio)
    return plain(2.0 / layers(diameter_ratios(diameter_ratio), kappa).resistance)


def nusselt_solution(
    diameter_ratio: ArrayLike, conductivity_ratio: ArrayLike, z_star: ArrayLike, *, tolerance: float = 1e-10
) -> NusseltSolution:
    """Nusselt number at any distance from the inlet, with its error bound (Watkins 2018, eq. 73-80).

    The series with as many terms as the tolerance asks for; where these would be more than 32, near the inlet, the
    Laplace transform of the same problem, inverted along a contour.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, above 1; may be infinite.
    conductivity_ratio : float or array
        Bulk over wall-layer conductivity, kappa = k_b/k_wa.
    z_star : float or array
        Inverse Graetz number, z k_b/(m'' D^2 c_p) with the mass flux m'' (see `inverse_graetz`), from 0 to infinity.
    tolerance : float
        Largest relative error from terms left out, from 1e-12 to 1e-2.

    Returns
    -------
    NusseltSolution
        Arrays of the broadcast shape. Nu is infinite at z* = 0 and that of `nusselt_developed` at infinity.

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If a conductivity ratio lies outside 1e-6 to 1e6, where rounding was not measured.
    """
    A, kappa = checked(diameter_ratio, conductivity_ratio)
    shape, pairs, (z,) = evaluation.flattened(A, kappa, evaluation.distances(z_star, infinite=True))
    return _solution(evaluation.excess(pairs, 4.0 * z, evaluation.allowed(tolerance)), shape)


def nusselt(
    diameter_ratio: ArrayLike, conductivity_ratio: ArrayLike, z_star: ArrayLike, *, tolerance: float = 1e-10
) -> FloatArray:
    """Nusselt number at any distance from the inlet (Watkins 2018, eq. 73-80).

    Takes what `nusselt_solution` takes, refuses and warns as it does, and returns the numbers alone.

    Returns
    -------
    float or array
        Nu = h D/k_b, with h on the difference of wall and mean temperature.
    """
    return nusselt_solution(diameter_ratio, conductivity_ratio, z_star, tolerance=tolerance).nusselt


def nusselt_series(
    diameter_ratio: ArrayLike, conductivity_ratio: ArrayLike, z_star: ArrayLike, terms: int
) -> NusseltSolution:
    """Nusselt number by the series cut after a given number of terms (Watkins 2018, eq. 73-80).

    For the study of its convergence; `nusselt` chooses the terms by itself.

    Parameters
    ----------
    diameter_ratio, conductivity_ratio, z_star : float or array
        As for `nusselt_solution`; z* above 0.
    terms : int
        Terms to add, from 0 (the developed flow) to 2000.

    Returns
    -------
    NusseltSolution
        Arrays of the broadcast shape. The error bound grows without limit where the terms left out could make up for
        the whole difference of wall and mean temperature.

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If a conductivity ratio lies outside 1e-6 to 1e6, where rounding was not measured.
    """
    if not 0 <= terms <= 2000 or int(terms) != terms:
        raise ValueError(f"terms is {terms}; expected a whole number from 0 to 2000")
    A, kappa = checked(diameter_ratio, conductivity_ratio)
    shape, pairs, (z,) = evaluation.flattened(A, kappa, positive("z_star", z_star, infinite=True))
    modes = evaluation.modes_of(pairs, int(terms) + 1)
    return _solution(evaluation.truncated(modes, 4.0 * z, np.full(z.size, int(terms), dtype=np.int64)), shape)


def inverse_graetz(
    distance: ArrayLike,
    bulk_conductivity: ArrayLike,
    mass_flux: ArrayLike,
    specific_heat: ArrayLike,
    tube_diameter: ArrayLike,
) -> FloatArray:
    """Inverse Graetz number of a position in a tube (Watkins 2018, eq. 7).

    Parameters
    ----------
    distance : float or array
        Distance from the inlet of the heated length. [m]
    bulk_conductivity : float or array
        k_b. [W/(m K)]
    mass_flux : float or array
        Mass flow over the cross-section of the tube, rho U. [kg/(m2 s)]
    specific_heat : float or array
        c_p. [J/(kg K)]
    tube_diameter : float or array
        Inner diameter D. [m]

    Returns
    -------
    float or array
        z* = z k_b/(m'' D^2 c_p).

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    z = non_negative("distance", distance, "m")
    k_b = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    flux = positive("mass_flux", mass_flux, "kg/(m2 s)")
    c_p = positive("specific_heat", specific_heat, "J/(kg K)")
    return plain(z * k_b / (flux * c_p * positive("tube_diameter", tube_diameter, "m") ** 2))


def _solution(found: evaluation.Excess, shape: tuple[int, ...]) -> NusseltSolution:
    Nu = np.divide(2.0, found.value, out=np.full_like(found.value, np.inf), where=found.value > 0.0)
    return NusseltSolution(plain(Nu.reshape(shape)), found.terms.reshape(shape)[()], plain(found.bound.reshape(shape)))
