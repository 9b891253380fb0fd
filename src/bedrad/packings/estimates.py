"""The estimates that follow from the sums of one frame or many, and their standard errors."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.tally import Measure, Tally
from bedrad.packings.time_averages import errors_of_mean
from bedrad.packings.wall_contacts import closing_distance, hexagonal_maximum

__all__ = ["Estimates", "estimates_over_frames", "estimates_with_errors"]

FloatArray = NDArray[np.float64]
Estimates = dict[str, FloatArray]


def estimates_with_errors(measure: Measure, sums: Tally) -> tuple[Estimates, Estimates]:
    """Estimates over the whole window, and their standard errors by the jackknife (Efron 1982).

    The jackknife leaves out one block at a time; for a plain mean over blocks it is their scatter over the
    root of their number, and it holds as well for ratios and for the closing distance. With one block the
    errors are nan.
    """
    blocks = sums.blocks
    values = _Estimator(measure).estimates(sums.without(None), 1.0)
    if blocks == 1:
        return values, {name: _frozen(np.full_like(value, math.nan)) for name, value in values.items()}
    estimator = _Estimator(measure)
    left = [estimator.estimates(sums.without(j), (blocks - 1) / blocks) for j in range(blocks)]
    errors = {}
    for name in values:
        replicates = np.array([estimates[name] for estimates in left])
        errors[name] = _frozen(np.sqrt((blocks - 1) * replicates.var(axis=0)))
    return values, errors


def estimates_over_frames(measure: Measure, frames: Sequence[Tally]) -> tuple[Estimates, Estimates, Estimates]:
    """Estimates from the sums over all frames, their standard errors, and the number of independent structures.

    Every block of every frame is left out in turn, which gives what it alone says of each estimate (its
    pseudo-value); `time_averages.errors_of_mean` makes the errors from these.
    """
    estimator = _Estimator(measure)
    whole = frames[0]
    for frame in frames[1:]:
        whole = whole.each(np.add, frame)
    total = whole.without(None)
    values = estimator.estimates(total, float(len(frames)))
    blocks = whole.blocks
    if blocks == 1 and len(frames) == 1:
        nothing = {name: np.full_like(value, math.nan) for name, value in values.items()}
        return values, nothing, nothing
    cells = len(frames) * blocks
    flat = _flat(values)
    pseudo = np.empty((len(frames), blocks, len(flat)))
    share = len(frames) - 1.0 / blocks
    for t, frame in enumerate(frames):
        for b in range(blocks):
            left = estimator.estimates(total.each(lambda all_, one, b=b: all_ - one[b], frame), share)
            pseudo[t, b] = cells * flat - (cells - 1) * _flat(left)
    errors, structures = errors_of_mean(pseudo)
    return values, _shaped(errors, values), _shaped(structures, values)


def _flat(estimates: Estimates) -> FloatArray:
    return np.concatenate([value.ravel() for value in estimates.values()])


def _shaped(flat: FloatArray, like: Estimates) -> Estimates:
    parts = np.split(flat, np.cumsum([value.size for value in like.values()])[:-1])
    return {name: _frozen(part.reshape(value.shape)) for (name, value), part in zip(like.items(), parts, strict=True)}


class _Estimator:
    """Estimates from totals; keeps the volumes that all of them need."""

    def __init__(self, measure: Measure) -> None:
        self.measure = measure
        self.area = measure.wall.area(measure.window)
        self.layers = measure.volumes(measure.edges)
        self.profile = measure.volumes(measure.profile_edges)
        self.centres = measure.volumes(measure.centre_edges)
        self.widths = np.diff(measure.gap_edges)

    def estimates(self, totals: Tally, share: float) -> Estimates:
        """All estimates, from totals over a share of the window, which is above 1 for several frames."""
        per_area = totals.wall_contacts / (share * self.area)
        most = hexagonal_maximum(self.measure.wall, self.measure.radius)
        number, gaps, volumes, weighted = totals.no_contact
        spheres = totals.spheres
        estimates = {
            "packing_fractions": totals.layers / (share * self.layers),
            "profile": totals.profile / (share * self.profile),
            "contacts_per_area_by_gap": per_area,
            # a tube as wide as its spheres has no room for a layer, so that the maximum is zero
            "contact_ratio_by_gap": per_area / most if most > 0.0 else np.full_like(per_area, math.nan),
            "nc_share_by_gap": _ratio(totals.apart, totals.apart + totals.wall_contacts),
            "nc_distance": _ratio(gaps, number),
            "nc_distance_weighted": _ratio(weighted, volumes),
            "nc_distance_closing": self._closing(totals, share),
            "nc_gap_density": _ratio(totals.nc_gaps[:-1], number * self.widths),
            "nc_gap_beyond": _ratio(totals.nc_gaps[-1], number),
            "centre_density": totals.centres / (share * self.centres),
            "contact_density": totals.contact_points / (share * self.centres),
            "coordination_by_gap": _ratio(totals.contacts, spheres[:, None]),
            "contact_number_shares": _ratio(totals.numbers, spheres.sum()),
            "rattler_share": _ratio(totals.rattlers, spheres.sum()),
            "hexagonal_order": _ratio(totals.order[1], totals.order[0]),
            "wall_neighbours": _ratio(totals.order[2], totals.order[0]),
        }
        return {name: _frozen(value) for name, value in estimates.items()}

    def _closing(self, totals: Tally, share: float) -> FloatArray:
        area = share * self.area
        closing = closing_distance(
            self.measure.wall,
            self.measure.radius,
            float(self.measure.edges[1]),
            float(totals.solid) / area,
            float(totals.wall_contacts[self.measure.chosen]) / area,
            float(totals.no_contact[0]) / area,
        )
        return np.asarray(closing)


def _ratio(part: FloatArray | float, whole: FloatArray | float) -> FloatArray:
    """Quotient, nan where there is nothing to divide by."""
    of = np.asarray(whole, dtype=float)
    return np.asarray(np.divide(part, np.where(of > 0.0, of, math.nan)))


def _frozen(array: FloatArray) -> FloatArray:
    a = np.asarray(array)
    a.setflags(write=False)
    return a
