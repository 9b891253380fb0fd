"""Sums over blocks along the axis, and the estimates and jackknife standard errors that follow from them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.layers import ROUNDING, layer_sums, whole_volumes
from bedrad.packings.packing import Packing
from bedrad.packings.wall_contacts import closing_distance, hexagonal_maximum, wall_gaps
from bedrad.walls import Wall, Window

__all__ = ["Estimates", "Measure", "Tally", "blocks_of", "estimates_with_errors", "tally"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Estimates = dict[str, FloatArray]


@dataclass(frozen=True)
class Measure:
    """What is measured; `radius` is the mean radius, `chosen` where `tolerances` has the contact gap."""

    wall: Wall
    window: Window
    radius: float
    edges: FloatArray
    profile_edges: FloatArray
    tolerances: FloatArray
    chosen: int


@dataclass(frozen=True)
class Tally:
    """Sums by block.

    Solid volumes `layers` (blocks, layers) and `profile` (blocks, bins), `contacts` (blocks, tolerances), and
    `no_contact` (blocks, 4): for the particles without contact their number, the sums of their gaps, of their
    volumes in the wall layer, and of the gaps times these volumes. `solid` (blocks,) is the volume in the
    wall layer of the particles counted in a block, each whole: what their numbers are balanced against, as
    the ends of a block cut volumes but not numbers.
    """

    layers: FloatArray
    profile: FloatArray
    contacts: FloatArray
    no_contact: FloatArray
    solid: FloatArray

    def without(self, block: int | None) -> Tally:
        """Totals over all blocks but one, or over all."""
        kept = np.arange(len(self.layers)) != (-1 if block is None else block)
        columns = (self.layers, self.profile, self.contacts, self.no_contact, self.solid)
        return Tally(*(c[kept].sum(axis=0) for c in columns))


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
    contacts = [np.bincount(block[inside & (gaps <= g)], minlength=blocks) for g in measure.tolerances]
    near = np.flatnonzero(inside & (packing.depths - packing.radii < measure.edges[1]))
    volume = whole_volumes(packing.wall, packing.centers[near], packing.radii[near], measure.edges[:2])[:, 0]
    solid: FloatArray = np.bincount(block[near], weights=volume, minlength=blocks).astype(float)
    apart = gaps[near] > measure.tolerances[measure.chosen]
    nc, gap, volume = block[near][apart], gaps[near][apart], volume[apart]
    columns = (np.ones(len(nc)), gap, volume, gap * volume)
    return Tally(
        layers=layer_sums(packing, measure.edges, measure.window, blocks),
        profile=layer_sums(packing, measure.profile_edges, measure.window, blocks),
        contacts=np.stack(contacts, axis=1).astype(float),
        no_contact=np.stack([np.bincount(nc, weights=c, minlength=blocks) for c in columns], axis=1),
        solid=solid,
    )


def estimates_with_errors(measure: Measure, sums: Tally) -> tuple[Estimates, Estimates]:
    """Estimates over the whole window, and their standard errors by the jackknife (Efron 1982).

    The jackknife leaves out one block at a time; for a plain mean over blocks it is their scatter over the
    root of their number, and it holds as well for ratios and for the closing distance. With one block the
    errors are nan.
    """
    blocks = len(sums.layers)
    values = _estimates(measure, sums.without(None), 1.0)
    if blocks == 1:
        return values, {name: _frozen(np.full_like(value, math.nan)) for name, value in values.items()}
    left = [_estimates(measure, sums.without(j), (blocks - 1) / blocks) for j in range(blocks)]
    errors = {}
    for name in values:
        replicates = np.array([estimates[name] for estimates in left])
        errors[name] = _frozen(np.sqrt((blocks - 1) * replicates.var(axis=0)))
    return values, errors


def _estimates(measure: Measure, totals: Tally, share: float) -> Estimates:
    """All estimates, from totals over a share of the window."""
    area = share * measure.wall.area(measure.window)
    per_area = totals.contacts / area
    number, gaps, volumes, weighted = totals.no_contact
    touching = totals.contacts[measure.chosen]
    closing = closing_distance(
        measure.wall,
        measure.radius,
        float(measure.edges[1]),
        float(totals.solid) / area,
        float(touching) / area,
        float(number) / area,
    )
    estimates = {
        "packing_fractions": totals.layers / (share * _layer_volumes(measure, measure.edges)),
        "profile": totals.profile / (share * _layer_volumes(measure, measure.profile_edges)),
        "contacts_per_area_by_gap": per_area,
        "contact_ratio_by_gap": per_area / hexagonal_maximum(measure.wall, measure.radius),
        "nc_share": _ratio(number, number + touching),
        "nc_distance": _ratio(gaps, number),
        "nc_distance_weighted": _ratio(weighted, volumes),
        "nc_distance_closing": np.asarray(closing),
    }
    return {name: _frozen(value) for name, value in estimates.items()}


def _layer_volumes(measure: Measure, edges: FloatArray) -> FloatArray:
    pairs = zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)
    return np.array([measure.wall.layer_volume(inner, outer, measure.window) for inner, outer in pairs])


def _ratio(part: float, whole: float) -> FloatArray:
    return np.asarray(part / whole if whole > 0.0 else math.nan)


def _frozen(array: FloatArray) -> FloatArray:
    a = np.asarray(array)
    a.setflags(write=False)
    return a
