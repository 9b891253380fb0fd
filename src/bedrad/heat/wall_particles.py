"""Conductivity of the wall layer, particle by particle from measured gaps (Watkins 2018, eq. 24-34 and 81-87).

`wall_layer` takes all particles without contact at one distance. Here every particle that reaches into the layer has
its own conductivity and its own covered area, from its own gap and size; the sum is eq. 30. The layer is one mean
radius deep, so that in a bed of many sizes large particles are cut above their centre and small ones below it or
not at all; heat still runs straight from the wall to the inner surface of the layer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from bedrad.heat import cylinder, ranges, single_particle
from bedrad.heat.ranges import FloatArray, non_negative, positive

__all__ = ["MeanDistances", "ParticleLayer", "contributions", "mean_distances"]

IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class ParticleLayer:
    """The wall-layer conductivity of one bed (Watkins 2018, eq. 30), its shares, and their standard errors.

    Errors come from the scatter between blocks of the wall; they are nan where no blocks, or only one, were given.

    Attributes
    ----------
    conductivity, conductivity_error : float
        k_wa, the sum of the three shares. [W/(m K)]
    contact, contact_error : float
        Share of particles that touch the wall. [W/(m K)]
    no_contact, no_contact_error : float
        Share of particles in the layer that do not (NC). [W/(m K)]
    void, void_error : float
        Share of the wall that no particle covers; negative where the covered areas overlap. [W/(m K)]
    contacts_per_area, no_contact_per_area : float
        Particles of each kind per wall area. [1/m2]
    covered_share : float
        Wall area that particles cover over the whole; above 1 where the areas overlap.
    layer_thickness : float
        Depth of the layer. [m]
    overlapping : int
        Particles with a negative gap, as soft spheres that touch the wall have; counted as in contact at a point.
    """

    conductivity: float
    conductivity_error: float
    contact: float
    contact_error: float
    no_contact: float
    no_contact_error: float
    void: float
    void_error: float
    contacts_per_area: float
    no_contact_per_area: float
    covered_share: float
    layer_thickness: float
    overlapping: int

    def __str__(self) -> str:
        lines = []
        for name, label in (
            ("conductivity", "wall layer"),
            ("contact", "  in contact"),
            ("no_contact", "  no contact"),
            ("void", "  void"),
        ):
            value, error = getattr(self, name), getattr(self, name + "_error")
            scatter = "" if math.isnan(error) else f" +- {error:.2g}"
            lines.append(f"{label:<14}{value:.5g}{scatter} W/(m K)")
        lines.append(
            f"per m2 of wall: {self.contacts_per_area:.4g} in contact ({self.overlapping} of them overlap it), "
            f"{self.no_contact_per_area:.4g} without; {100 * self.covered_share:.1f} % of it covered"
        )
        return "\n".join(lines)


@dataclass(frozen=True)
class MeanDistances:
    """One distance for all no-contact particles: averages of the measured ones, and those that conserve something.

    Attributes
    ----------
    plain : float
        Mean of the gaps, as in Watkins 2018, fig. 3.8.
    area_weighted, volume_weighted : float
        Means weighted by the covered area, and by the volume within the layer, of each particle.
    closing : float
        The gap at which equally many particles would have the same volume within the layer (eq. 31).
    conducting : float
        The gap that gives the same k_wa from packing fraction and contacts (eq. 30-31); nan if none does.
    """

    plain: float
    area_weighted: float
    volume_weighted: float
    closing: float
    conducting: float

    def __str__(self) -> str:
        return (
            f"distance of no-contact particles in radii: plain mean {self.plain:.4f}, by area "
            f"{self.area_weighted:.4f}, by volume {self.volume_weighted:.4f}, closing eq. 31 {self.closing:.4f}, "
            f"same k_wa {self.conducting:.4f}"
        )


@dataclass(frozen=True)
class _Bed:
    """Checked inputs: gaps and layer depth in each particle's own radii, the rest in SI units."""

    gaps: FloatArray
    radii: FloatArray
    touching: NDArray[np.bool_]
    depth: float
    wall_area: float
    groups: IntArray
    group_areas: FloatArray
    overlapping: int


def _bed(
    gaps: ArrayLike,
    particle_diameters: ArrayLike,
    wall_area: float,
    contact_gap: float,
    layer_thickness: float | None,
    groups: ArrayLike | None,
    group_areas: ArrayLike | None,
) -> _Bed:
    gap = np.atleast_1d(np.asarray(gaps, dtype=np.float64))
    if gap.ndim != 1 or not np.all(np.isfinite(gap)):
        raise ValueError("gaps are not a list of finite numbers; expected one gap a particle, in its own radii")
    if gap.size and gap.min() <= -1.0:
        raise ValueError(
            f"gaps has {gap.min():g} particle radii; expected more than -1: a centre this side of the wall"
        )
    radius = 0.5 * positive("particle_diameters", particle_diameters, "m")
    if radius.shape not in ((), gap.shape):
        raise ValueError(f"particle_diameters has {radius.size} values for {gap.size} gaps; expected as many, or one")
    area = float(positive("wall_area", wall_area, "m2"))
    tolerance = float(non_negative("contact_gap", contact_gap, "particle radii"))
    if layer_thickness is None:
        if not radius.size:
            raise ValueError("layer_thickness is missing; expected one where there are no particles")
        depth = float(radius.mean())
    else:
        depth = float(positive("layer_thickness", layer_thickness, "m"))
    radii = np.broadcast_to(radius, gap.shape)
    touching = gap <= tolerance
    reaches = touching | (gap * radii < depth)
    group, areas = _blocks(groups, group_areas, gap.size, area)
    return _Bed(
        gaps=np.where(touching, 0.0, gap)[reaches],
        radii=radii[reaches],
        touching=touching[reaches],
        depth=depth,
        wall_area=area,
        groups=group[reaches],
        group_areas=areas,
        overlapping=int((gap < 0.0).sum()),
    )


def _blocks(
    groups: ArrayLike | None, group_areas: ArrayLike | None, count: int, wall_area: float
) -> tuple[IntArray, FloatArray]:
    if (groups is None) != (group_areas is None):
        raise ValueError("groups and group_areas belong together; one of them is missing")
    if groups is None or group_areas is None:
        return np.zeros(count, dtype=np.int64), np.array([wall_area])
    areas = np.atleast_1d(positive("group_areas", group_areas, "m2"))
    group = np.atleast_1d(np.asarray(groups))
    if group.shape != (count,) or not (np.issubdtype(group.dtype, np.integer) or group.size == 0):
        raise ValueError(f"groups has {group.size} values of type {group.dtype}; expected {count} integers")
    if group.size and not (group.min() >= 0 and group.max() < areas.size):
        raise ValueError(f"groups reach from {group.min()} to {group.max()}; expected 0 to {areas.size - 1}")
    if not math.isclose(areas.sum(), wall_area, rel_tol=1e-9):
        raise ValueError(f"group_areas add up to {areas.sum():g} m2; expected the wall_area, {wall_area:g} m2")
    return group.astype(np.int64), areas


def _covered_and_heat(K: float, bed: _Bed, wall_diameter: float) -> tuple[FloatArray, FloatArray]:
    """Covered area of every particle [m2], and that area times its conductivity over k_g."""
    depth = bed.depth / bed.radii
    # beds of one size are cut at exactly one radius, whatever rounding the mean has
    depth = np.where(np.abs(depth - 1.0) < 1e-12, 1.0, depth)
    a = np.minimum(bed.gaps, depth)
    # particles that touch are alike in a bed of one size
    ratios, index = np.unique(np.stack([a, depth, bed.radii]), axis=1, return_inverse=True)
    if math.isinf(wall_diameter):
        area, ratio = single_particle.cut_particle(K, ratios[0], ratios[1])
    else:
        area, ratio = cylinder.cut_particle(K, 0.5 * wall_diameter / ratios[2], ratios[0], ratios[1])
    index = index.reshape(-1)
    covered = np.atleast_1d(area)[index] * bed.radii**2
    return covered, covered * np.atleast_1d(ratio)[index]


def _errors(shares: FloatArray, areas: FloatArray) -> FloatArray:
    """Standard errors of area-weighted means from the scatter between blocks: (quantities, blocks) -> (quantities,)."""
    blocks = areas.size
    if blocks < 2:
        return np.full(shares.shape[0], math.nan)
    weight = areas / areas.sum()
    mean = shares @ weight
    scatter = (weight**2 * (shares - mean[:, None]) ** 2).sum(axis=1)
    return np.asarray(np.sqrt(scatter * blocks / (blocks - 1)))


def contributions(
    gas_conductivity: float,
    solid_conductivity: float,
    gaps: ArrayLike,
    particle_diameters: ArrayLike,
    wall_area: float,
    wall_diameter: float = math.inf,
    contact_gap: float = 1e-2,
    layer_thickness: float | None = None,
    groups: ArrayLike | None = None,
    group_areas: ArrayLike | None = None,
    *,
    warn: bool = True,
) -> ParticleLayer:
    """Wall-layer conductivity of one bed from the gap of every particle (Watkins 2018, eq. 30, 34, 84-87).

    Parameters
    ----------
    gas_conductivity, solid_conductivity : float
        Conductivities of the interstitial gas and of the particles. [W/(m K)]
    gaps : (n,) array
        Gap between the wall and the surface of each particle, in its own radii (a gap in metres over the radius).
        Particles too deep for the layer may be among them; negative gaps are overlaps and count as contact.
    particle_diameters : (n,) array or float
        Particle diameters. [m]
    wall_area : float
        Area of the piece of wall that these particles belong to. [m2]
    wall_diameter : float
        Inner diameter of the tube; infinite for a flat wall. [m]
    contact_gap : float
        Gap, in particle radii, up to which a particle touches the wall; it is then taken to touch it at a point.
    layer_thickness : float, optional
        Depth of the layer; half the mean of `particle_diameters` where not given. [m]
    groups : (n,) array of int, optional
        Block of the wall that each particle belongs to, from 0, for standard errors.
    group_areas : (blocks,) array, optional
        Wall area of each block; together `wall_area`. [m2]
    warn : bool
        Warn where the covered areas overlap.

    Returns
    -------
    ParticleLayer
        Conductivity, shares and their standard errors.

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If the covered areas overlap, so that the void share is negative.
    """
    gas = float(positive("gas_conductivity", gas_conductivity, "W/(m K)"))
    solid = float(positive("solid_conductivity", solid_conductivity, "W/(m K)"))
    tube = float(positive("wall_diameter", wall_diameter, "m", infinite=True))
    bed = _bed(gaps, particle_diameters, wall_area, contact_gap, layer_thickness, groups, group_areas)
    covered, heat = _covered_and_heat(solid / gas, bed, tube)
    blocks = bed.group_areas.size

    def per_area(weights: FloatArray, of: NDArray[np.bool_] | None = None) -> FloatArray:
        chosen = slice(None) if of is None else of
        return np.bincount(bed.groups[chosen], weights=weights[chosen], minlength=blocks) / bed.group_areas

    contact, apart = gas * per_area(heat, bed.touching), gas * per_area(heat, ~bed.touching)
    void = gas * (1.0 - per_area(covered))
    share = float(covered.sum() / bed.wall_area)
    if warn and share > 1.0:
        ranges.warn(
            f"wall layer: particles cover {share:.3f} of the wall area, so that the void share of k_wa is negative "
            "(Watkins 2018, eq. 29-30)"
        )
    shares = np.stack([contact + apart + void, contact, apart, void])
    values = shares @ (bed.group_areas / bed.group_areas.sum())
    errors = _errors(shares, bed.group_areas)
    return ParticleLayer(
        conductivity=float(values[0]),
        conductivity_error=float(errors[0]),
        contact=float(values[1]),
        contact_error=float(errors[1]),
        no_contact=float(values[2]),
        no_contact_error=float(errors[2]),
        void=float(values[3]),
        void_error=float(errors[3]),
        contacts_per_area=float(bed.touching.sum() / bed.wall_area),
        no_contact_per_area=float((~bed.touching).sum() / bed.wall_area),
        covered_share=share,
        layer_thickness=bed.depth,
        overlapping=bed.overlapping,
    )


def _of_equal_particles(K: float, a: FloatArray, diameter_ratio: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Covered area, volume within the layer and k/k_g of particles of one size, in their radii."""
    if math.isinf(diameter_ratio):
        volume = np.asarray(math.pi / 3.0 * (1.0 - a) ** 2 * (2.0 + a))
        return np.asarray(math.pi * (1.0 - a * a)), volume, single_particle.particle_conductivity(K, a)
    return (
        cylinder.covered_area(diameter_ratio, a),
        cylinder.particle_volume(diameter_ratio, a),
        cylinder.particle_conductivity(K, diameter_ratio, a),
    )


def mean_distances(
    K: float, gaps: ArrayLike, diameter_ratio: float = math.inf, contact_gap: float = 1e-2
) -> MeanDistances:
    """The distances that could stand for all no-contact particles of a bed of one size (Watkins 2018, eq. 30-31).

    Taken with the measured packing fraction and contacts, a distance `a` stands for particles that add
    `area (k - 1)/volume` to k_wa/k_g for each unit of solid volume. This falls steeply and is convex in `a`, so that
    any mean that weights particles by their volume gives too low a conductivity, and the plain mean a lower one yet.

    Parameters
    ----------
    K : float
        Solid over gas conductivity, k_s/k_g.
    gaps : (n,) array
        Gaps of the particles, in particle radii; those above 1 lie outside the layer and do not count.
    diameter_ratio : float
        Tube inner diameter over particle diameter; infinite for a flat wall.
    contact_gap : float
        Gap up to which a particle touches the wall.

    Returns
    -------
    MeanDistances
        Averages, and the gaps that conserve the volume and the conductivity; all nan without such particles.

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    ratio = float(positive("K (solid over gas conductivity)", K))
    A = float(positive("diameter_ratio", diameter_ratio, infinite=True))
    tolerance = float(non_negative("contact_gap", contact_gap, "particle radii"))
    gap = np.atleast_1d(np.asarray(gaps, dtype=np.float64))
    if gap.ndim != 1 or not np.all(np.isfinite(gap)):
        raise ValueError("gaps are not a list of finite numbers; expected one gap a particle, in its own radii")
    a = gap[(gap > tolerance) & (gap < 1.0)]
    if not a.size:
        return MeanDistances(*[math.nan] * 5)
    area, volume, k = _of_equal_particles(ratio, a, A)

    def volume_excess(distance: float) -> float:
        return float(_of_equal_particles(ratio, np.asarray(distance), A)[1] - volume.mean())

    def heat_excess(distance: float) -> float:
        one = _of_equal_particles(ratio, np.asarray(distance), A)
        return float(one[0] * (one[2] - 1.0) / one[1] - (area * (k - 1.0)).sum() / volume.sum())

    low, high = float(a.min()), float(a.max())
    closing = low if low == high else brentq(volume_excess, low, high, xtol=1e-14)
    # particles like the gas conduct the same at any distance
    differs = low < high and heat_excess(low) * heat_excess(high) < 0.0
    conducting = brentq(heat_excess, low, high, xtol=1e-14) if differs else (low if low == high else math.nan)
    return MeanDistances(
        plain=float(a.mean()),
        area_weighted=float((a * area).sum() / area.sum()),
        volume_weighted=float((a * volume).sum() / volume.sum()),
        closing=float(closing),
        conducting=float(conducting),
    )
