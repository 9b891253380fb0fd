"""Effective thermal conductivity of the wall-adjacent layer of a dense flow (Watkins 2018, section 3.2).

The layer is one particle radius thick. Its heat runs in parallel through particles in contact with the wall,
through particles that reach into the layer without contact (all taken at the same distance `a` radii), and
through the gas in the voids (eq. 24-30). How many particles have no contact follows from the packing fraction
(eq. 31).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import cylinder, ranges
from bedrad.heat.correlations import contact_ratio, maximum_contacts, packing_fraction
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within
from bedrad.heat.single_particle import NC_DISTANCE, contact_factor, no_contact_factor, particle_conductivity

__all__ = [
    "NC_DISTANCE",
    "Contributions",
    "Form",
    "closing_nc_distance",
    "conductivity",
    "contact_factor",
    "contact_ratio",
    "contributions",
    "maximum_contacts",
    "no_contact_factor",
    "packing_fraction",
    "particle_conductivity",
]

Form = Literal["simplified", "general", "flat", "cylinder"]

_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Contributions:
    """The shares of the wall-layer conductivity (Watkins 2018, eq. 30), and the counts behind them.

    Parameters
    ----------
    conductivity : float or array
        k_wa, the sum of the three shares. [W/(m K)]
    contact, no_contact, void : float or array
        Shares of contact particles, no-contact particles and voids. The void share is negative where the
        covered areas overlap. [W/(m K)]
    no_contact_per_area : float or array
        No-contact particles per wall area, by eq. 31 with the particle volumes of the chosen form. [1/m2]
    covered_share : float or array
        Wall area that particles cover over the whole; above 1 where the areas overlap.
    """

    conductivity: FloatArray
    contact: FloatArray
    no_contact: FloatArray
    void: FloatArray
    no_contact_per_area: FloatArray
    covered_share: FloatArray


@dataclass(frozen=True)
class _Layer:
    """The checked inputs, all broadcast: conductivities [W/(m K)] and lengths in particle radii."""

    gas: FloatArray
    K: FloatArray
    A: FloatArray
    radius: FloatArray
    contacts: FloatArray
    fraction: FloatArray
    distance: FloatArray


def _checked(
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    diameter_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    contacts_per_area: ArrayLike,
    packing_fraction: ArrayLike,
    nc_distance: ArrayLike,
    form: Form,
) -> _Layer:
    if form not in get_args(Form):
        raise ValueError(f"form is {form!r}; expected one of {', '.join(get_args(Form))}")
    gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
    solid = positive("solid_conductivity", solid_conductivity, "W/(m K)")
    A = positive("diameter_ratio", diameter_ratio, infinite=form == "flat")
    if np.any(A <= 1.0):
        raise ValueError(f"diameter_ratio is {float(np.min(A)):g}; expected more than 1")
    radius = 0.5 * positive("particle_diameter", particle_diameter, "m")
    count = non_negative("contacts_per_area", contacts_per_area, "1/m2")
    fraction = within("packing_fraction", packing_fraction, 0.0, 1.0)
    distance = within("nc_distance", nc_distance, 0.0, 1.0, "particle radii", open_above=True)
    if form == "simplified" and np.any(distance != NC_DISTANCE):
        raise ValueError(
            f"nc_distance is {float(distance[distance != NC_DISTANCE].flat[0]):g}, but the simplified form "
            f'(Watkins 2018, eq. 41) holds for {NC_DISTANCE:g} only; choose form="general" or "cylinder"'
        )
    contacts = np.asarray(count * radius * radius)
    return _Layer(*np.broadcast_arrays(gas, solid / gas, A, radius, contacts, fraction, distance))


def _remaining(solid_volume: FloatArray, contact_volume: FloatArray, layer: _Layer) -> FloatArray:
    """Solid volume left for no-contact particles, per wall area and in particle radii; not negative."""
    rest = np.asarray(solid_volume - contact_volume)
    bad = rest < -_ROUNDING * np.maximum(solid_volume, contact_volume)
    if np.any(bad):
        i = int(np.flatnonzero(bad)[0])
        contacts = (layer.contacts / layer.radius**2).flat[i]
        filled = contact_volume.flat[i] / _layer_depth(layer.A).flat[i]
        raise ValueError(
            f"packing_fraction {layer.fraction.flat[i]:g} is too small for contacts_per_area {contacts:g} "
            f"1/m2 at diameter_ratio {layer.A.flat[i]:g}: the contact particles alone fill {filled:g} of the "
            "layer, and eq. 31 (Watkins 2018) gives a negative number of no-contact particles"
        )
    return np.maximum(rest, 0.0)


def _layer_depth(diameter_ratio: ArrayLike) -> FloatArray:
    """Volume of the wall layer of a tube per wall area, in particle radii: 1 - 1/(2A), 1 for a flat wall."""
    return np.asarray(1.0 - 0.5 / np.asarray(diameter_ratio, dtype=np.float64))


def _flat_volume(a: FloatArray) -> FloatArray:
    """Volume of a particle within one radius of a flat wall, in particle radii cubed."""
    return np.asarray((math.pi / 3.0) * (1.0 - a) ** 2 * (2.0 + a))


def _shares(layer: _Layer, form: Form) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Covered areas of contact and no-contact particles, their k over k_g, and n_NC in 1/radii squared."""
    K, A, a = layer.K, layer.A, layer.distance
    solid = np.asarray(layer.fraction * _layer_depth(A))
    if form == "cylinder":
        rest = _remaining(solid, np.asarray(cylinder.particle_volume(A) * layer.contacts), layer)
        count = np.asarray(rest / cylinder.particle_volume(A, a))
        contact_area = np.asarray(layer.contacts * cylinder.covered_area(A))
        area = np.asarray(count * cylinder.covered_area(A, a))
        touching = cylinder.particle_conductivity(K, A)
        return contact_area, area, touching, cylinder.particle_conductivity(K, A, a), count
    rest = _remaining(solid, np.asarray(2.0 * math.pi / 3.0 * layer.contacts), layer)
    count = np.asarray(rest / _flat_volume(a))
    touching = particle_conductivity(K)
    if form == "flat":
        return (
            math.pi * layer.contacts,
            math.pi * (1.0 - a * a) * count,
            touching,
            particle_conductivity(K, a),
            count,
        )
    contact_area = np.asarray(math.pi * layer.contacts * (1.0 + 1.0 / A))
    if form == "general":
        area = np.asarray(math.pi * (1.0 - a * a) * count * (1.0 + 1.35 / A))
        return contact_area, area, touching, particle_conductivity(K, a), count
    # eq. 41 rounds 1/((1-a)^2 (2+a)) to 0.74 and 1 - a^2 to 0.95
    area = np.asarray((0.74 + 1.0 / A) * 3.0 * rest * 0.95)
    return contact_area, area, touching, np.asarray(2.0 * no_contact_factor(K, a) / 0.95), count


def contributions(
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    diameter_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    contacts_per_area: ArrayLike,
    packing_fraction: ArrayLike,
    nc_distance: ArrayLike = NC_DISTANCE,
    form: Form = "simplified",
    *,
    warn: bool = True,
) -> Contributions:
    """Wall-layer conductivity with the shares of particles and voids in it (Watkins 2018, eq. 30).

    Parameters
    ----------
    gas_conductivity : float or array
        Conductivity of the interstitial gas. [W/(m K)]
    solid_conductivity : float or array
        Conductivity of the particles. [W/(m K)]
    diameter_ratio : float or array
        Tube inner diameter over particle diameter; for form "flat" the modified ratio P/(4 d) of a chute with
        the perimeter P (eq. 46), or infinity for a plate.
    particle_diameter : float or array
        Particle diameter. [m]
    contacts_per_area : float or array
        Particles in contact per wall area, n_C. [1/m2]
    packing_fraction : float or array
        Solid fraction of the wall layer, phi_wa.
    nc_distance : float or array
        Mean gap between the no-contact particles and the wall, in particle radii, from 0 to below 1.
    form : {"simplified", "general", "flat", "cylinder"}
        "simplified" is eq. 41, for nc_distance 0.22 only; "general" eq. 35; "flat" eq. 35 without curvature
        factors, of which eq. 45 with B = 1 is the rounded form; "cylinder" the exact integrals of appendix C.
    warn : bool
        Warn where the covered areas overlap.

    Returns
    -------
    Contributions
        Arrays of the broadcast shape.

    Raises
    ------
    ValueError
        If an input has no meaning, or the packing fraction leaves a negative number of no-contact particles.

    Warns
    -----
    RangeWarning
        If the covered areas overlap, so that the void share is negative (about a > 0.6 at usual packing
        fractions).
    """
    layer = _checked(
        gas_conductivity,
        solid_conductivity,
        diameter_ratio,
        particle_diameter,
        contacts_per_area,
        packing_fraction,
        nc_distance,
        form,
    )
    contact_area, area, touching, apart, count = _shares(layer, form)
    covered = np.asarray(contact_area + area)
    if warn and np.any(covered > 1.0):
        ranges.warn(
            f"wall layer: particles cover {float(np.max(covered)):.3f} of the wall area, so that "
            "the void share of k_wa is negative (Watkins 2018, eq. 29-30); nc_distance "
            f"{float(layer.distance.flat[int(np.argmax(covered))]):g} is large for this packing fraction"
        )
    shares = layer.gas * contact_area * touching, layer.gas * area * apart, layer.gas * (1.0 - covered)
    return Contributions(
        conductivity=plain(shares[0] + shares[1] + shares[2]),
        contact=plain(shares[0]),
        no_contact=plain(shares[1]),
        void=plain(shares[2]),
        no_contact_per_area=plain(count / layer.radius**2),
        covered_share=plain(covered),
    )


def conductivity(
    gas_conductivity: ArrayLike,
    solid_conductivity: ArrayLike,
    diameter_ratio: ArrayLike,
    particle_diameter: ArrayLike,
    contacts_per_area: ArrayLike,
    packing_fraction: ArrayLike,
    nc_distance: ArrayLike = NC_DISTANCE,
    form: Form = "simplified",
    *,
    warn: bool = True,
) -> FloatArray:
    """Effective thermal conductivity of the wall-adjacent layer, k_wa (Watkins 2018, eq. 30-42, 84-88).

    Takes what `contributions` takes, refuses and warns as it does, and returns the sum of its shares.

    Returns
    -------
    float or array
        k_wa. [W/(m K)]
    """
    return contributions(
        gas_conductivity,
        solid_conductivity,
        diameter_ratio,
        particle_diameter,
        contacts_per_area,
        packing_fraction,
        nc_distance,
        form,
        warn=warn,
    ).conductivity


def closing_nc_distance(
    packing_fraction: ArrayLike,
    contacts_per_area: ArrayLike,
    no_contact_per_area: ArrayLike,
    particle_diameter: ArrayLike,
    diameter_ratio: ArrayLike = math.inf,
    volumes: Literal["cylinder", "flat"] = "flat",
) -> FloatArray:
    """Find the distance `a` at which packing fraction and counts of a measured wall layer agree (eq. 31).

    Parameters
    ----------
    packing_fraction : float or array
        Measured solid fraction of the wall layer.
    contacts_per_area, no_contact_per_area : float or array
        Measured particles with and without contact per wall area. [1/m2]
    particle_diameter : float or array
        Particle diameter. [m]
    diameter_ratio : float or array
        Tube inner diameter over particle diameter; infinite for a plate, and taken so for a rod.
    volumes : {"flat", "cylinder"}
        Particle volumes within the layer: at a flat wall, or at the wall of a tube (eq. 88).

    Returns
    -------
    float or array
        a in particle radii, from 0 to 1; NaN where no distance closes eq. 31, as without no-contact
        particles.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    if volumes not in ("flat", "cylinder"):
        raise ValueError(f"volumes is {volumes!r}; expected 'flat' or 'cylinder'")
    fraction = within("packing_fraction", packing_fraction, 0.0, 1.0)
    radius = 0.5 * positive("particle_diameter", particle_diameter, "m")
    touching = non_negative("contacts_per_area", contacts_per_area, "1/m2") * radius**2
    apart = non_negative("no_contact_per_area", no_contact_per_area, "1/m2") * radius**2
    A = positive("diameter_ratio", diameter_ratio, infinite=volumes == "flat")
    touching_volume = cylinder.particle_volume(A) if volumes == "cylinder" else _flat_volume(np.asarray(0.0))
    rest = np.asarray(fraction * _layer_depth(A) - touching_volume * touching)
    target = np.divide(rest, apart, out=np.full(np.broadcast_shapes(rest.shape, apart.shape), np.nan), where=apart > 0)
    closes = (target >= -_ROUNDING) & (target <= touching_volume * (1.0 + _ROUNDING))
    wanted = np.clip(np.where(closes, target, 0.0), 0.0, touching_volume)
    # (1-a)^2 (2+a) = t is a cubic with three real roots; this is the one between 0 and 1
    cosine = np.clip(1.5 * wanted / math.pi - 1.0, -1.0, 1.0)
    distance = np.clip(2.0 * np.cos((2.0 * math.pi - np.arccos(cosine)) / 3.0), 0.0, 1.0)
    if volumes == "cylinder":
        low, high = np.zeros_like(wanted), np.ones_like(wanted)
        for _ in range(54):
            distance = 0.5 * (low + high)
            too_near = cylinder.particle_volume(A, distance) > wanted
            low, high = np.where(too_near, distance, low), np.where(too_near, high, distance)
    return plain(np.where(closes, distance, np.nan))
