"""Statistics of a packing or a trajectory beside its wall: solid fractions, contacts, distances, order, with errors."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.packings.estimates import Estimates, estimates_over_frames, estimates_with_errors
from bedrad.packings.files import read_frames
from bedrad.packings.layers import block_count, check_edges, check_window, layer_edges
from bedrad.packings.packing import END_MARGIN, Packing
from bedrad.packings.sizes import mean_diameters
from bedrad.packings.statistics_results import Statistics, TrajectoryStatistics
from bedrad.packings.tally import Measure, Tally, blocks_of, tally
from bedrad.packings.trajectory import check_frame
from bedrad.packings.wall_contacts import overlap_share
from bedrad.walls import Window

__all__ = ["GAP_TOLERANCES", "Statistics", "TrajectoryStatistics", "statistics"]

FloatArray = NDArray[np.float64]

GAP_TOLERANCES = (0.0, 1e-4, 1e-3, 1e-2, 5e-2)
"""Gaps, in particle radii, at which contacts are always counted."""

PROFILE_WIDTH = 0.1
"""Width of the default profile's bins, in mean radii."""

GAP_WIDTH = 0.05
"""Width of the bins of the NC particles' gaps, in radii; they end at one, where equal spheres leave the layer."""


def statistics(
    packing: Packing | str | os.PathLike[str] | Iterable[Packing],
    edges: ArrayLike | None = None,
    contact_gap: float = 1e-2,
    window: Window | None = None,
    blocks: int | None = None,
    margin: float = END_MARGIN,
    profile_depths: ArrayLike | float | None = None,
) -> Statistics:
    """Measure a packing beside its wall, or the mean over the frames of a trajectory (Watkins 2018, section 3.2).

    Volumes are cut exactly by the layers and by the ends of the window; particles are counted where their
    centre lies in the window (its upper end excluded), and their neighbours wherever they are. Spheres that overlap
    are counted whole each. Standard errors of one packing are jackknife errors over blocks of equal length along
    the axis: they hold where a block is longer than what its spheres have in common with the next. For spheres that
    ignore each other and blocks of 2.5 diameters, the error of the solid fraction comes out 6 % too small, as
    neighbours share the spheres they cut; the other errors hold within 3 %.

    Frames of a trajectory resemble each other. Their errors come from block averages in time, from the error of one
    frame and the time in which the bed renews itself, and from the blocks along the axis averaged over all frames;
    `time_averages.errors_of_mean` says how, and what each of these is blind to. So frames that are all alike have
    the error of one. One frame is in memory at a time.

    Parameters
    ----------
    packing : Packing, path, or iterable of Packing
        The spheres and their wall; or a file, of which all frames are read with `read_frames`; or frames, such as
        `read_frames` gives. Layers, bins, window and the wall's area are those of the first frame; the wall's radius
        may differ between frames by a hundredth of a mean radius, as one does that is fitted to each.
    edges : (layers + 1,) array, optional
        Depths that bound the layers, from 0; the first layer is the wall layer. `layer_edges(packing)`, or as
        many of its layers as the wall has room for, where not given. [m]
    contact_gap : float
        Gap up to which particles count as touching: in a particle's own radii at the wall, in those of the smaller
        one between two.
    window : Window, optional
        The piece of wall to measure; `packing.window(margin)` where not given.
    blocks : int, optional
        Number of blocks for the standard errors; as many as `layers.block_count` says if not given. With 1, the
        errors of one packing are nan.
    margin : float
        What the window leaves out at each open end, in mean particle diameters.
    profile_depths : (bins + 1,) array or float, optional
        Depths that bound the bins of the profiles. With one depth in place of them, or the last edge where nothing is
        given, the bins of the solid fraction are a tenth of a mean radius wide down to there, and those of centres
        and contacts lie half a bin further, so that the particles that touch the wall come into the middle of
        one. [m]

    Returns
    -------
    Statistics
        Values, standard errors, counts, and what was left out; of several frames a `TrajectoryStatistics`, which
        has the same and the number of independent structures behind each value.

    Raises
    ------
    BadFileError
        If a file cannot be read.
    ValueError
        If a packing is empty, no sphere has its centre in the window, a number is out of its range, the edges or
        the window do not fit, there are no frames, or a frame has another wall or does not reach over the window.
        The message names the frame, counted from 0.
    TypeError
        If a frame is not a packing.
    """
    start = time.perf_counter()
    if not (math.isfinite(contact_gap) and contact_gap >= 0.0):
        raise ValueError(f"contact_gap is {contact_gap}; expected a number of radii, zero or more")
    if blocks is not None and blocks < 1:
        raise ValueError(f"blocks is {blocks}; expected at least 1")
    if isinstance(packing, Packing):
        first = _First.of(packing, edges, contact_gap, window, blocks, margin, profile_depths)
        return _result(first, [_frame(packing, first)], contact_gap, start)
    held: _First | None = None
    frames: list[_Frame] = []
    for number, bed in enumerate(read_frames(packing) if isinstance(packing, (str, os.PathLike)) else packing):
        if not isinstance(bed, Packing):
            raise TypeError(f"frame {number} is a {type(bed).__name__}; expected a bedrad.Packing")
        try:
            if held is None:
                held = _First.of(bed, edges, contact_gap, window, blocks, margin, profile_depths)
            check_frame(bed, held.measure.wall, held.measure.window, held.measure.radius)
            frames.append(_frame(bed, held))
        except ValueError as error:
            raise ValueError(f"frame {number}: {error}") from None
    if held is None:
        raise ValueError("there are no frames; there is nothing to measure")
    return _result(held, frames, contact_gap, start)


@dataclass(frozen=True)
class _First:
    """What the first frame decides for all."""

    measure: Measure
    blocks: int
    radii: FloatArray

    @classmethod
    def of(
        cls,
        packing: Packing,
        edges: ArrayLike | None,
        contact_gap: float,
        window: Window | None,
        blocks: int | None,
        margin: float,
        profile_depths: ArrayLike | None,
    ) -> _First:
        """Check and complete what is to be measured."""
        if not len(packing):
            raise ValueError("the packing is empty; there is nothing to measure")
        measure = _measure(packing, edges, contact_gap, check_window(packing, window, margin), profile_depths)
        parts = block_count(packing, measure.window) if blocks is None else blocks
        return cls(measure, parts, packing.radii)


@dataclass(frozen=True)
class _Frame:
    """What is kept of a frame."""

    sums: Tally
    spheres: int
    outside: int
    deeper: int
    overlap: float


def _frame(packing: Packing, first: _First) -> _Frame:
    measure = first.measure
    block = blocks_of(packing, measure.window, first.blocks)
    inside = block >= 0
    if not inside.any():
        raise ValueError(f"no sphere has its centre in the window {measure.window}")
    reaches = packing.depths - packing.radii < measure.edges[-1]
    return _Frame(
        sums=tally(packing, measure, block, first.blocks),
        spheres=int(inside.sum()),
        outside=int((~inside).sum()),
        deeper=int((inside & ~reaches).sum()),
        overlap=overlap_share(packing, inside & reaches, reaches),
    )


def _result(first: _First, frames: Sequence[_Frame], contact_gap: float, start: float) -> Statistics:
    measure, sizes = first.measure, mean_diameters(first.radii)
    more: dict[str, Any] = {}
    if len(frames) == 1:
        values, errors = estimates_with_errors(measure, frames[0].sums)
    else:
        values, errors, structures = estimates_over_frames(measure, [frame.sums for frame in frames])
        more = {"frames": len(frames), "structures": _named(structures, measure.chosen, "")}
    return (TrajectoryStatistics if more else Statistics)(
        **_named(values, measure.chosen, ""),
        **_named(errors, measure.chosen, "_error"),
        edges=measure.edges,
        gap_tolerances=measure.tolerances,
        profile_depths=measure.profile_edges,
        nc_gap_edges=measure.gap_edges,
        centre_depths=measure.centre_edges,
        spheres=sum(frame.spheres for frame in frames),
        contacts=sum(int(frame.sums.wall_contacts[:, measure.chosen].sum()) for frame in frames),
        no_contacts=sum(int(frame.sums.no_contact[:, 0].sum()) for frame in frames),
        wall=measure.wall,
        mean_diameter=sizes.number,
        sauter_diameter=sizes.sauter,
        volume_mean_diameter=sizes.volume_weighted,
        window=measure.window,
        contact_gap=float(contact_gap),
        blocks=first.blocks,
        overlap_share=math.fsum(frame.overlap for frame in frames) / len(frames),
        left_out={
            "outside_window": sum(frame.outside for frame in frames),
            "deeper": sum(frame.deeper for frame in frames),
        },
        seconds=time.perf_counter() - start,
        **more,
    )


def _measure(
    packing: Packing,
    edges: ArrayLike | None,
    contact_gap: float,
    window: Window,
    profile_depths: ArrayLike | None,
) -> Measure:
    radius = 0.5 * packing.mean_diameter
    if edges is None:
        fit = packing.wall.largest_depth / packing.mean_diameter + 0.5
        e = layer_edges(packing, layers=max(1, int(min(3.0, fit * (1.0 + 1e-12)))))
    else:
        e = check_edges(edges, packing.wall)
    if e[0] != 0.0:
        raise ValueError(f"the first edge is {e[0]} m; expected 0, where the wall layer starts")
    depths = np.asarray(e[-1] if profile_depths is None else profile_depths, dtype=float)
    centre_depths = depths
    if depths.ndim == 0:
        last = check_edges([0.0, float(depths)], packing.wall)[-1]
        bins = math.ceil(last / (PROFILE_WIDTH * radius) - 1e-9)
        depths = np.linspace(0.0, last, bins + 1)
        centre_depths = np.r_[0.0, depths[:-1] + 0.5 * last / bins, last]
    tolerances = np.unique([*GAP_TOLERANCES, contact_gap])
    gap_edges = np.linspace(0.0, 1.0, round(1.0 / GAP_WIDTH) + 1)
    for array in (tolerances, gap_edges):
        array.setflags(write=False)
    return Measure(
        wall=packing.wall,
        window=window,
        radius=radius,
        edges=e,
        profile_edges=check_edges(depths, packing.wall),
        centre_edges=check_edges(centre_depths, packing.wall),
        gap_edges=gap_edges,
        tolerances=tolerances,
        chosen=int(np.searchsorted(tolerances, contact_gap)),
    )


def _named(estimates: Estimates, chosen: int, suffix: str) -> dict[str, Any]:
    """Estimates (or errors) under the names of `Statistics`, the wall layer and contact_gap picked out."""
    named: dict[str, Any] = {name + suffix: v if v.ndim else float(v) for name, v in estimates.items()}
    named["packing_fraction" + suffix] = float(estimates["packing_fractions"][0])
    for name in ("contacts_per_area", "contact_ratio", "nc_share"):
        named[name + suffix] = float(estimates[name + "_by_gap"][chosen])
    named["coordination" + suffix] = _frozen(estimates["coordination_by_gap"][:, chosen].copy())
    return named


def _frozen(array: FloatArray) -> FloatArray:
    array.setflags(write=False)
    return array
