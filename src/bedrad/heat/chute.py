"""Dense flow past one heated wall of a chute, at constant wall temperature (Watkins 2018, section 4.2).

The flow is a plug, as deep as the heat ever reaches, with the conductivity of the bulk up to the wall. What the wall
layer resists more than the bulk would is a contact resistance: a layer of gas `chi` particle diameters thick
(Sullivan and Sabersky 1975). Everything depends on one number besides the contact coefficient
`h_c = k_g/(chi d)`, namely `B = h_c sqrt(alpha_b t)/k_b` with the time of contact `t = L/U`.

Two forms are offered: the exact solution of the half-space with a contact resistance, and the resistances of gas layer
and bulk put in series (eq. 43), which is what the source uses; `in_series_error` is the difference.
"""

from __future__ import annotations

import math
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import correlations, wall_layer
from bedrad.heat.half_space import (
    gain_over_series,
    in_series_error,
    local_half_space,
    local_in_series,
    mean_half_space,
    mean_in_series,
)
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = [
    "SULLIVAN_SABERSKY_GAP",
    "Shape",
    "contact_number",
    "gap_ratio",
    "in_series_error",
    "local_half_space",
    "local_in_series",
    "mean_half_space",
    "mean_in_series",
    "modified_diameter_ratio",
    "nusselt_half_space",
    "nusselt_in_series",
    "peclet_number",
    "wall_layer_conductivity",
    "wall_layer_of_gap",
]

SULLIVAN_SABERSKY_GAP: Final = 0.085
"""Thickness of the gas layer in particle diameters that Sullivan and Sabersky (1975) fitted to their vertical chutes;
inclined chutes were fitted by 0.025 (Watkins 2018, section 1.2)."""

Shape = Literal["chute", "cylinder"]

_SHAPE_FACTOR: Final = {"chute": 4.0, "cylinder": math.pi}

_C: Final = 0.5 * math.sqrt(math.pi)

_LONG_CONTACT: Final = 1e10
"""From here on the wall layer does not matter: sqrt(pi) B exp(B^2) erfc(B) is 1 to 5e-21."""


def peclet_number(velocity: ArrayLike, heated_length: ArrayLike, bulk_diffusivity: ArrayLike) -> FloatArray:
    """Peclet number of the heated length, `Pe_L = U L/alpha_b` (Watkins 2018, below eq. 43).

    Parameters
    ----------
    velocity : float or array
        Velocity of the plug. [m/s]
    heated_length : float or array
        Length of the heated wall along the flow. [m]
    bulk_diffusivity : float or array
        Thermal diffusivity of the bulk, k_b/(rho c_p). [m2/s]

    Returns
    -------
    float or array
        Pe_L.

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    speed = positive("velocity", velocity, "m/s")
    length = positive("heated_length", heated_length, "m")
    return plain(speed * length / positive("bulk_diffusivity", bulk_diffusivity, "m2/s"))


def modified_diameter_ratio(perimeter: ArrayLike, particle_diameter: ArrayLike, shape: Shape = "chute") -> FloatArray:
    """Diameter ratio that stands for that of a tube in the correlations of the wall layer (Watkins 2018, eq. 46).

    Parameters
    ----------
    perimeter : float or array
        Perimeter of the cross-section. [m]
    particle_diameter : float or array
        Particle diameter. [m]
    shape : {"chute", "cylinder"}
        Rectangular cross-section, `A_m = P/(4 d)`, or circular, `P/(pi d)`, which is D/d.

    Returns
    -------
    float or array
        A_m.

    Raises
    ------
    ValueError
        If a length is not positive or the shape is unknown.
    """
    if shape not in _SHAPE_FACTOR:
        raise ValueError(f"shape is {shape!r}; expected 'chute' or 'cylinder'")
    around = positive("perimeter", perimeter, "m")
    return plain(around / (_SHAPE_FACTOR[shape] * positive("particle_diameter", particle_diameter, "m")))


def wall_layer_conductivity(
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    diameter_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    velocity: ArrayLike,
    *,
    warn: bool = True,
) -> FloatArray:
    """Conductivity of the wall-adjacent layer of a chute (Watkins 2018, eq. 45 with B_C = B_NC = 1).

    The packing fraction and the contacts come from the correlations for tubes (eq. 38-40) at the modified diameter
    ratio, the particles see a flat wall. Eq. 45 as printed rounds two factors; this is its unrounded form, 1e-4 apart.
    For measured counts use `bedrad.heat.wall_layer.conductivity` with form "flat".

    Parameters
    ----------
    gas_conductivity, solid_conductivity : float or array
        Conductivities of the interstitial gas and of the particles. [W/(m K)]
    diameter_ratio : float or array
        Modified diameter ratio, see `modified_diameter_ratio`.
    particle_diameter : float or array
        Particle diameter. [m]
    velocity : float or array
        Mean flow velocity; 0 for a static bed. [m/s]
    warn : bool
        Warn outside the range of the correlations.

    Returns
    -------
    float or array
        k_wa. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning, or the correlations give a negative number of no-contact particles, as below a
        diameter ratio of 6.79 at rest.

    Warns
    -----
    RangeWarning
        Outside diameter ratios 12.9 to 36.4 or velocities 0.002 to 0.25 m/s.
    """
    A, U, d = diameter_ratio, velocity, particle_diameter
    most = correlations.maximum_contacts(A, d)
    if warn:
        correlations.warn_outside_fit("wall layer of a chute (Watkins 2018, eq. 38, 40)", A, U)
    contacts = correlations.contact_ratio(A, U, d, warn=False) * most
    fraction = correlations.packing_fraction(A, U, d, warn=False)
    return wall_layer.conductivity(gas_conductivity, solid_conductivity, A, d, contacts, fraction, form="flat")


def gap_ratio(
    gas_conductivity: ArrayLike, wall_layer_conductivity: ArrayLike, bulk_conductivity: ArrayLike
) -> FloatArray:
    """Thickness of the gas layer that resists as the wall-adjacent layer does (Watkins 2018, eq. 44).

    `chi = 0.5 (k_b/k_wa - 1)/(k_b/k_g - 1)`: half a particle diameter of k_wa is `chi` diameters of gas and the rest
    bulk.

    Parameters
    ----------
    gas_conductivity, wall_layer_conductivity, bulk_conductivity : float or array
        k_g, k_wa and k_b, in rising order. [W/(m K)]

    Returns
    -------
    float or array
        chi, from 0 (k_wa = k_b) to 0.5 (k_wa = k_g). [particle diameters]

    Raises
    ------
    ValueError
        If k_b is not above k_g, or k_wa not between the two.
    """
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    wall = positive("wall_layer_conductivity", wall_layer_conductivity, "W/(m K)")
    bulk = _bulk(gas, bulk_conductivity)
    outside = (wall < gas) | (wall > bulk)
    if np.any(outside):
        k_wa, k_g, k_b = (values[outside].flat[0] for values in np.broadcast_arrays(wall, gas, bulk))
        raise ValueError(
            f"wall_layer_conductivity is {k_wa:g} W/(m K); expected a value from gas_conductivity, {k_g:g}, to "
            f"bulk_conductivity, {k_b:g}: no layer of gas stands for it (Watkins 2018, eq. 44)"
        )
    return plain(0.5 * (bulk - wall) / (bulk - gas) * (gas / wall))


def wall_layer_of_gap(gap_ratio: ArrayLike, gas_conductivity: ArrayLike, bulk_conductivity: ArrayLike) -> FloatArray:
    """Conductivity of the wall-adjacent layer that a gas layer stands for, eq. 44 the other way round.

    Parameters
    ----------
    gap_ratio : float or array
        Thickness of the gas layer, chi, from 0 to 0.5. [particle diameters]
    gas_conductivity, bulk_conductivity : float or array
        k_g and k_b, the first the smaller. [W/(m K)]

    Returns
    -------
    float or array
        k_wa. [W/(m K)]

    Raises
    ------
    ValueError
        If k_b is not above k_g, or the gas layer thicker than half a particle diameter.
    """
    chi = non_negative("gap_ratio", gap_ratio)
    if np.any(chi > 0.5):
        raise ValueError(f"gap_ratio is {float(np.max(chi)):g}; expected at most 0.5, the whole wall-adjacent layer")
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    bulk = _bulk(gas, bulk_conductivity)
    return plain(bulk / (1.0 + 2.0 * chi * (bulk / gas - 1.0)))


def _bulk(gas: FloatArray, bulk_conductivity: ArrayLike) -> FloatArray:
    bulk = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    if np.any(bulk <= gas):
        k_g, k_b = (values[bulk <= gas].flat[0] for values in np.broadcast_arrays(gas, bulk))
        raise ValueError(f"bulk_conductivity is {k_b:g} W/(m K); expected more than gas_conductivity, {k_g:g}")
    return bulk


def contact_number(
    peclet: ArrayLike,
    gap_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    heated_length: ArrayLike,
    bulk_conductivity: ArrayLike,
    gas_conductivity: ArrayLike,
) -> FloatArray:
    """Ratio that decides how much the wall layer matters, `B = h_c sqrt(alpha_b L/U)/k_b`, h_c = k_g/(chi d).

    Small where the wall layer resists nearly alone, large where it does not matter.

    Parameters
    ----------
    peclet, gap_ratio, particle_diameter, heated_length, bulk_conductivity, gas_conductivity : float or array
        As for `nusselt_half_space`.

    Returns
    -------
    float or array
        B, infinite without a gas layer.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    gap, root = _resistance(gap_ratio, particle_diameter, heated_length, bulk_conductivity, gas_conductivity, peclet)
    return plain(_contact_number(gap, root))


def _resistance(
    gap_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    heated_length: ArrayLike,
    bulk_conductivity: ArrayLike,
    gas_conductivity: ArrayLike,
    peclet: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Resistance of the gas layer in units of L/k_b, and the root of the Peclet number."""
    chi = non_negative("gap_ratio", gap_ratio, "particle diameters")
    d = positive("particle_diameter", particle_diameter, "m")
    L = positive("heated_length", heated_length, "m")
    k_b = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    k_g = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    return np.asarray(chi * (d / L) * (k_b / k_g)), np.sqrt(positive("peclet", peclet))


def _contact_number(gap: FloatArray, root_peclet: FloatArray) -> FloatArray:
    with np.errstate(divide="ignore", over="ignore"):
        return np.asarray(1.0 / (gap * root_peclet))


def nusselt_in_series(
    peclet: ArrayLike,
    gap_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    heated_length: ArrayLike,
    bulk_conductivity: ArrayLike,
    gas_conductivity: ArrayLike,
    *,
    local: bool = False,
) -> FloatArray:
    """Nusselt number of a heated wall with gas layer and bulk in series (Watkins 2018, eq. 43, corrected).

    `Nu_L = 1/(chi (d/L) (k_b/k_g) + (sqrt(pi)/2)/sqrt(Pe_L))`, after Sullivan and Sabersky (1975). The print has the
    whole denominator over k_g L, which is no dimensionless number; docs/heat_chute.md gives the evidence.

    Parameters
    ----------
    peclet : float or array
        Pe_L = U L/alpha_b, see `peclet_number`.
    gap_ratio : float or array
        Thickness of the gas layer, chi, see `gap_ratio`; 0 for none. [particle diameters]
    particle_diameter : float or array
        Particle diameter. [m]
    heated_length : float or array
        Length of the heated wall along the flow. [m]
    bulk_conductivity, gas_conductivity : float or array
        k_b and k_g. [W/(m K)]
    local : bool
        Nusselt number of the end of the heated length rather than its mean.

    Returns
    -------
    float or array
        h L/k_b with h the mean coefficient over the heated length or the local one at its end, both with the
        difference between wall and entering flow.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    gap, root = _resistance(gap_ratio, particle_diameter, heated_length, bulk_conductivity, gas_conductivity, peclet)
    whole = gap + _C / root
    if local:
        return plain((gap + 0.5 * _C / root) / whole / whole)
    return plain(1.0 / whole)


def nusselt_half_space(
    peclet: ArrayLike,
    gap_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    heated_length: ArrayLike,
    bulk_conductivity: ArrayLike,
    gas_conductivity: ArrayLike,
    *,
    local: bool = False,
) -> FloatArray:
    """Nusselt number of a heated wall, exact for the plug with a contact resistance (see `mean_half_space`).

    Parameters
    ----------
    peclet, gap_ratio, particle_diameter, heated_length, bulk_conductivity, gas_conductivity : float or array
        As for `nusselt_in_series`.
    local : bool
        Nusselt number of the end of the heated length rather than its mean.

    Returns
    -------
    float or array
        h L/k_b, as for `nusselt_in_series`.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    gap, root = _resistance(gap_ratio, particle_diameter, heated_length, bulk_conductivity, gas_conductivity, peclet)
    B = _contact_number(gap, root)
    if local:
        finite = np.minimum(B, _LONG_CONTACT)
        return plain(root * finite * local_half_space(finite))
    return plain((1.0 + gain_over_series(B)) / (gap + _C / root))
