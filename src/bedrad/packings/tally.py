"""What one frame contributes to the statistics: sums over blocks along the axis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.coordination import RATTLER_CONTACTS, sphere_contacts
from bedrad.packings.layers import ROUNDING, layer_sums, whole_volumes
from bedrad.packings.packing import Packing
from bedrad.packings.wall_contacts import wall_gaps
from bedrad.packings.wall_order import wall_order
from bedrad.walls import Wall, Window

__all__ = ["MOST_CONTACTS", "Measure", "Tally", "blocks_of", "tally"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

MOST_CONTACTS = 12
"""Number of contacts that is counted as itself; more, as large spheres among small ones have, come in one class."""


@dataclass(frozen=True)
class Measure:
    """What is measured; `radius` is the mean radius, `chosen` where `tolerances` has the contact gap."""

    wall: Wall
    window: Window
    radius: float
    edges: FloatArray
    profile_edges: FloatArray
    centre_edges: FloatArray
    gap_edges: FloatArray
    tolerances: FloatArray
    chosen: int

    def volumes(self, edges: FloatArray) -> FloatArray:
        """Volumes between depths, over the window. [m3]"""
        pairs = zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)
        return np.array([self.wall.layer_volume(inner, outer, self.window) for inner, outer in pairs])


@dataclass(frozen=True)
class Tally:
    """Sums by block: every array has the blocks first, or not at all once they are added up.

    Attributes
    ----------
    layers, profile : (blocks, layers), (blocks, bins) arrays
        Solid volumes. [m3]
    wall_contacts, apart : (blocks, tolerances) arrays
        Particles that touch the wall within each tolerance, and those with volume in the wall layer that do not.
    no_contact : (blocks, 4) array
        For the particles without contact (NC): number, and the sums of their gaps, of their volumes in the wall
        layer, and of the gaps times these volumes.
    nc_gaps : (blocks, bins + 1) array
        NC particles by gap, the last class for those beyond the bins.
    solid : (blocks,) array
        Volume in the wall layer of the particles counted in a block, each whole: what their numbers are balanced
        against, as the ends of a block cut volumes but not numbers. [m3]
    centres, contact_points : (blocks, bins) arrays
        Centres, and contacts between spheres, by depth. A contact counts half with each of its spheres.
    spheres : (blocks, layers) array
        Spheres by layer, each in that of its near side: its point nearest to the wall.
    contacts : (blocks, layers, tolerances) array
        Contacts that these have with other spheres, summed.
    numbers : (blocks, MOST_CONTACTS + 2) array
        These spheres by their number of contacts, the last class for more than `MOST_CONTACTS`.
    rattlers : (blocks,) array
        These spheres with fewer than `RATTLER_CONTACTS` contacts, the wall counted.
    order : (blocks, 3) array
        For the particles that touch the wall: their number, and the sums of |psi_6| and of their neighbours.
    """

    layers: FloatArray
    profile: FloatArray
    wall_contacts: FloatArray
    apart: FloatArray
    no_contact: FloatArray
    nc_gaps: FloatArray
    solid: FloatArray
    centres: FloatArray
    contact_points: FloatArray
    spheres: FloatArray
    contacts: FloatArray
    numbers: FloatArray
    rattlers: FloatArray
    order: FloatArray

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return len(self.layers)

    def each(self, change: Callable[..., FloatArray], *others: Tally) -> Tally:
        """Apply a function to every array, together with those of other tallies."""
        tallies = (self, *others)
        return Tally(*(change(*(getattr(t, field.name) for t in tallies)) for field in fields(Tally)))

    def without(self, block: int | None) -> Tally:
        """Totals over all blocks but one, or over all."""
        kept = np.arange(self.blocks) != (-1 if block is None else block)
        return self.each(lambda sums: sums[kept].sum(axis=0))


def blocks_of(packing: Packing, window: Window, blocks: int) -> IntArray:
    """Block that every sphere's centre lies in, -1 outside the window; the intervals are half open."""
    offset, inside = _offsets(packing, packing.wall.axial, window.axial)
    block = np.searchsorted(np.linspace(0.0, window.length, blocks + 1)[1:-1], offset, side="right")
    if window.lateral is not None:
        inside &= _offsets(packing, 1, window.lateral)[1]
    return np.where(inside, block, -1).astype(np.int64)


def _offsets(packing: Packing, axis: int, interval: tuple[float, float]) -> tuple[FloatArray, BoolArray]:
    """Coordinates from the start of an interval, wrapped along a period, and which lie in the interval."""
    offset = packing.centers[:, axis] - interval[0]
    length, period = interval[1] - interval[0], packing.box[axis]
    if period:
        offset = np.mod(offset, period)
        if length >= period * (1.0 - ROUNDING):
            return offset, np.ones(len(offset), dtype=bool)
    return offset, (offset >= 0.0) & (offset < length)


def tally(packing: Packing, measure: Measure, block: IntArray, blocks: int) -> Tally:
    """Sum by block what the estimates need; `block` is where every sphere's centre lies."""
    gaps = wall_gaps(packing)
    inside = block >= 0
    near_side = packing.depths - packing.radii
    near = np.flatnonzero(inside & (near_side < measure.edges[1]))
    volume = whole_volumes(packing.wall, packing.centers[near], packing.radii[near], measure.edges[:2])[:, 0]
    lies, gap = block[near], gaps[near]
    apart = gap > measure.tolerances[measure.chosen]
    nc_gap, nc_volume = gap[apart], volume[apart]
    nc = _Summed(lies[apart], blocks)
    return Tally(
        layers=layer_sums(packing, measure.edges, measure.window, blocks),
        profile=layer_sums(packing, measure.profile_edges, measure.window, blocks),
        wall_contacts=np.stack(
            [_Summed(block[inside & (gaps <= g)], blocks).number() for g in measure.tolerances], axis=1
        ),
        apart=np.stack([_Summed(lies[gap > g], blocks).number() for g in measure.tolerances], axis=1),
        no_contact=np.stack([nc.number(), nc.sum(nc_gap), nc.sum(nc_volume), nc.sum(nc_gap * nc_volume)], axis=1),
        nc_gaps=nc.classes(np.searchsorted(measure.gap_edges[1:], nc_gap, side="right"), len(measure.gap_edges)),
        solid=_Summed(lies, blocks).sum(volume),
        order=_order(packing, measure, block, blocks),
        **_spheres(packing, measure, block, blocks),
    )


def _spheres(packing: Packing, measure: Measure, block: IntArray, blocks: int) -> dict[str, FloatArray]:
    """Sums over the spheres and their contacts with each other."""
    near_side = packing.depths - packing.radii
    looked_at = (block >= 0) & (near_side < max(measure.edges[-1], measure.centre_edges[-1]))
    spheres = np.flatnonzero(looked_at)
    found = sphere_contacts(packing, looked_at, measure.tolerances, measure.chosen)
    bins = len(measure.centre_edges)
    centre_bin = np.searchsorted(measure.centre_edges[1:], packing.depths[spheres], side="right")
    point_bin = np.searchsorted(measure.centre_edges[1:], found.depths, side="right")
    layered = near_side[spheres] < measure.edges[-1]
    layer = np.searchsorted(measure.edges[1:], near_side[spheres[layered]], side="right")
    counts, layers = found.counts[layered], len(measure.edges) - 1
    numbers = counts[:, measure.chosen]
    held = numbers + (wall_gaps(packing)[spheres[layered]] <= measure.tolerances[measure.chosen])
    counted = _Summed(block[spheres[layered]], blocks)
    return {
        # the last class is for what lies deeper than the bins
        "centres": _Summed(block[spheres], blocks).classes(centre_bin, bins)[:, :-1],
        "contact_points": 0.5 * _Summed(block[spheres[found.first]], blocks).classes(point_bin, bins)[:, :-1],
        "spheres": counted.classes(layer, layers),
        "contacts": np.stack([counted.classes(layer, layers, n) for n in counts.T], axis=2),
        "numbers": counted.classes(np.minimum(numbers, MOST_CONTACTS + 1), MOST_CONTACTS + 2),
        "rattlers": counted.sum(held < RATTLER_CONTACTS),
    }


def _order(packing: Packing, measure: Measure, block: IntArray, blocks: int) -> FloatArray:
    """Sums over the order of the particles that touch the wall."""
    touching = wall_gaps(packing) <= measure.tolerances[measure.chosen]
    found = wall_order(packing, touching)
    counted = np.flatnonzero((block >= 0) & touching)
    wall = _Summed(block[counted], blocks)
    return np.stack([wall.number(), wall.sum(found.order[counted]), wall.sum(found.neighbours[counted])], axis=1)


@dataclass(frozen=True)
class _Summed:
    """Things that each lie in a block, to be summed by it."""

    block: IntArray
    blocks: int

    def number(self) -> FloatArray:
        """How many: (blocks,)."""
        return np.bincount(self.block, minlength=self.blocks).astype(float)

    def sum(self, values: NDArray[np.generic]) -> FloatArray:
        """Sum of a value: (blocks,)."""
        return np.bincount(self.block, weights=values, minlength=self.blocks).astype(float)

    def classes(self, of: IntArray, count: int, values: NDArray[np.generic] | None = None) -> FloatArray:
        """How many, or the sum of a value, by class too: (blocks, count)."""
        flat = np.bincount(self.block * count + of, weights=values, minlength=self.blocks * count)
        return flat.reshape(self.blocks, count).astype(float)
