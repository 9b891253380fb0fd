"""Stratified rays: the window is cut into patches; the rays of a patch are traced against the few spheres near it.

Each stratum, a patch or a few of them, emits two halves of equally many rays, from independently shifted Sobol points.
The halves' mean is the stratum's estimate, their difference measures its error; strata are independent, so that the
variances add up to that of the whole, with as many degrees of freedom as there are strata.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from bedrad.packings.packing import Packing
from bedrad.raytrace.candidate_kernels import Bins
from bedrad.raytrace.patch_kernels import Strata, Surroundings, make_room, trace_groups
from bedrad.raytrace.tracer import KINDS, GridTracer, compile_kernels
from bedrad.walls import Plate, Tube, Window

__all__ = ["PatchTracer", "Sample"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SPHERES_PER_BIN = 4.0
"""Mean number of spheres of one size class in a bin of the wall's surface."""

SMALLEST_PATCH, LARGE_PATCH, LARGEST_PATCH = 0.5, 6.0, 7.0
"""Sides of a patch in effective radii: smaller ones see hardly fewer spheres; larger ones see too many, but a stratum
is rather one large patch than several of which each half draws one."""

LEAST_POINTS, GOOD_POINTS, MOST_POINTS = 32, 256, 2**14
"""Rays of one half of a stratum: at least, as many as make the search for spheres cheap, at most."""

FEWEST_STRATA = 64
"""Strata of a round of 4,096 rays or more, so that the scatter of their halves knows the standard errors to a tenth."""

MOST_ANGLE = 0.6
"""Widest patch beside a tube or rod. [rad]"""

TILE = 2.2
"""Side of a group of patches that share one search for spheres, in effective radii."""

BATCH_RAYS = 2**16
"""Rays of the groups that are traced at a time."""


@dataclass(frozen=True)
class Sample:
    """What some rays found.

    Parameters
    ----------
    counts : (blocks, fates) int array
        Number of rays by axial block of the origin and by fate.
    scatter : (fates, fates) int array
        Sum over the strata of the products of the differences between their two halves.
    """

    counts: IntArray
    scatter: IntArray

    @classmethod
    def empty(cls, blocks: int, fates: int) -> Sample:
        """No rays yet."""
        return cls(np.zeros((blocks, fates), np.int64), np.zeros((fates, fates), np.int64))

    def __add__(self, other: Sample) -> Sample:
        """Both together, each ray with the same weight."""
        return Sample(self.counts + other.counts, self.scatter + other.scatter)

    @property
    def rays(self) -> int:
        """Number of rays."""
        return int(self.counts.sum())

    @property
    def shares(self) -> FloatArray:
        """Share of each fate."""
        return np.asarray(self.counts.sum(axis=0) / self.rays)

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the shares."""
        return self.scatter / float(self.rays) ** 2


def build_bins(packing: Packing, depth: float) -> Bins:
    """Sort the spheres that reach less deep than `depth` into bins of the wall's surface."""
    wall = packing.wall
    flat = isinstance(wall, Plate)
    periods = np.array([packing.box[wall.axial], packing.box[1] if flat else 0.0])
    near = np.flatnonzero(packing.depths - packing.radii < depth)
    sizes = np.zeros(len(near), np.int8)
    if len(near):
        # a size class spans a factor of two, so that the search around a patch is not wide for the small ones
        np.minimum(np.log2(packing.radii[near].max() / packing.radii[near]), 15.0, out=sizes, casting="unsafe")
    spheres = np.empty((4, len(near)))
    classes, shapes, starts = [], [], [np.zeros(0, np.int64)]
    bins = placed = 0
    for size in np.unique(sizes):
        member = near[sizes == size]
        surface, key, count = _surface_bins(packing, member, periods)
        member = member[np.argsort(key, kind="stable")]
        spheres[:3, placed : placed + len(member)] = packing.centers[member].T
        spheres[3, placed : placed + len(member)] = packing.radii[member]
        classes.append([float(packing.radii[member].max()), *surface])
        shapes.append([*count, bins])
        filled = np.bincount(key, minlength=count[0] * count[1])
        starts.append(placed + np.cumsum(filled) - filled)
        bins, placed = bins + len(filled), placed + len(member)
    return Bins(
        classes=np.array(classes, dtype=float).reshape(-1, 5),
        shapes=np.array(shapes, np.int64).reshape(-1, 3),
        starts=np.concatenate([*starts, [placed]]),
        spheres=spheres,
        periods=periods,
        # beside a rod or plate no ray gets deeper
        depth=depth if isinstance(wall, Tube) and len(near) < len(packing) else math.inf,
    )


def _surface_bins(
    packing: Packing, member: IntArray, periods: FloatArray
) -> tuple[tuple[float, float, float, float], IntArray, tuple[int, int]]:
    """Lower ends and sizes of the bins along and around for one size class, each member's bin, numbers of bins."""
    wall = packing.wall
    to_length = 1.0 if isinstance(wall, Plate) else wall.radius
    along = packing.centers[member, wall.axial]
    if isinstance(wall, Plate):
        around = packing.centers[member, 1]
        y_low, y_high = (0.0, periods[1]) if periods[1] else (float(around.min()), float(around.max()))
    else:
        around = np.mod(np.arctan2(packing.centers[member, 1], packing.centers[member, 0]), 2 * math.pi)
        y_low, y_high = 0.0, 2 * math.pi
    z_low, z_high = (0.0, periods[0]) if periods[0] else (float(along.min()), float(along.max()))
    largest = float(packing.radii[member].max())
    # a period is parted exactly, however short; bins of an open range of no width would have no size
    length = periods[0] or max(z_high - z_low, largest)
    width = y_high - y_low if not isinstance(wall, Plate) or periods[1] else max(y_high - y_low, largest)
    side = math.sqrt(SPHERES_PER_BIN * length * width * to_length / len(member))
    nz, ny = max(1, int(length / side)), max(1, int(width * to_length / side))
    z_size, y_size = length / nz, width / ny
    key = np.clip(((around - y_low) / y_size).astype(np.int64), 0, ny - 1)
    key *= nz
    key += np.clip(((along - z_low) / z_size).astype(np.int64), 0, nz - 1)
    return (z_low, z_size, y_low, y_size), key, (nz, ny)


def _power_of_two(wanted: float, least: int, most: int) -> int:
    """The largest power of two that is not above `wanted`, within bounds."""
    return min(max(1 << math.floor(math.log2(max(wanted, 1.0))), least), most)


class PatchTracer:
    """Traces stratified rays from the patches of a window.

    Parameters
    ----------
    packing : Packing
        The bed.
    edges : (layers + 1,) array
        Depths that part the layers. [m]
    window : Window
        The piece of wall that emits.
    """

    def __init__(self, packing: Packing, edges: FloatArray, window: Window) -> None:
        self.grid = GridTracer(packing, edges, window)
        wall = packing.wall
        flat = isinstance(wall, Plate)
        self.to_length = 1.0 if isinstance(wall, Plate) else wall.radius
        lateral = window.lateral if flat and window.lateral is not None else (0.0, 2 * math.pi)
        self.window = np.array([window.axial[0], window.length, lateral[0], lateral[1] - lateral[0]])
        self.bins = build_bins(packing, self.grid.near_depth)
        self.effective_radius = self._effective_radius(packing, float(edges[1]))
        ends = np.full((2, 2), (-math.inf, math.inf))
        for row, axis in enumerate((wall.axial, 1) if flat else (wall.axial,)):
            if not packing.box[axis]:
                ends[row] = packing.extent(axis)
        self.wall = Surroundings(
            kind=KINDS[wall.kind],
            wall_radius=0.0 if isinstance(wall, Plate) else wall.radius,
            edges=self.grid.edges,
            ends=ends,
            first_shell=1.3 * self.effective_radius if len(packing) else math.inf,
        )

    def _effective_radius(self, packing: Packing, first_edge: float) -> float:
        """Radius of equal spheres that would lie as densely near the wall."""
        near = packing.depths - packing.radii < first_edge
        if not near.any():
            return math.sqrt(self.window[1] * self.window[3] * self.to_length)
        radii = packing.radii[near]
        area = self.window[3] * self.to_length * (np.ptp(packing.centers[:, packing.wall.axial]) + 2 * radii.max())
        # a dense layer of spheres of radius r has about one in 4 r^2
        return float(min(math.sqrt(area / (4.0 * len(radii))), radii.max()))

    @property
    def left_out(self) -> int:
        """Number of spheres too deep for any of the rays so far."""
        packing, reached = self.grid.packing, max(self.grid.reached, self.grid.near_depth)
        return int(np.count_nonzero(packing.depths - packing.radii >= reached))

    def compile(self) -> None:
        """Trace no rays, so that the kernels are compiled on their first use and later times are those of rays."""
        self.trace(self.strata(1, (0, 0)), (0, 0), 1)
        compile_kernels()

    def strata(self, rays: int, seed: tuple[int, int], blocks: int = 1) -> Strata:
        """Cut the window, its axial blocks into whole strata, so that equal halves of all make so many rays or more."""
        r = self.effective_radius
        length, width = float(self.window[1]), float(self.window[3] * self.to_length)
        density = rays / (length * width)
        points = _power_of_two(0.5 * density * (LARGE_PATCH * r) ** 2, LEAST_POINTS, GOOD_POINTS)
        points = _power_of_two(0.5 * density * (SMALLEST_PATCH * r) ** 2, points, MOST_POINTS)
        points = min(points, _power_of_two(rays / (2 * FEWEST_STRATA), LEAST_POINTS, MOST_POINTS))
        if points > GOOD_POINTS and points.bit_length() % 2 == 0:
            points //= 2  # four-dimensional Sobol points are more even in powers of four
        side = math.sqrt(2 * points / density)
        most = min(LARGEST_PATCH * r, MOST_ANGLE * self.to_length if self.wall.kind != KINDS["plate"] else math.inf)
        total = math.ceil(rays / (2 * points))
        around = min(max(math.ceil(width / side), math.ceil(width / most)), max(1, total // blocks))
        along = blocks * math.ceil(total / around / blocks)
        of_net, of_strata = np.random.SeedSequence(seed).spawn(2)
        net = qmc.Sobol(4, scramble=True, bits=32, rng=np.random.default_rng(of_net)).random(points)
        return Strata(
            along=along,
            around=around,
            parts_along=max(1, math.ceil(length / along / (LARGEST_PATCH * r))),
            parts_around=max(1, math.ceil(width / around / most)),
            window=self.window,
            net=np.ascontiguousarray((net * 2.0**32).astype(np.uint32).T),
            seed=of_strata.generate_state(1, np.uint64)[0],
            tile=max(1, round(TILE * r / side)),
            wanted=7.0 + 2.6 * (min(side, most) / r) ** 2,
        )

    def batches(self, strata: Strata) -> list[tuple[int, int]]:
        """Ranges of groups to be traced at a time."""
        side = self.side(strata)
        groups = math.ceil(strata.along / side) * math.ceil(strata.around / side)
        step = max(1, BATCH_RAYS // (2 * strata.net.shape[1] * side**2))
        return [(first, min(first + step, groups)) for first in range(0, groups, step)]

    def trace(self, strata: Strata, groups: tuple[int, int], blocks: int) -> Sample:
        """Trace the rays of a range of groups."""
        most = (groups[1] - groups[0]) * self.side(strata) ** 2
        fates = len(self.wall.edges) + 2
        rows = np.full(most, -1)
        counts = np.zeros((most, 2, fates), np.int64)
        rays = most * 2 * strata.net.shape[1]
        left, slots = np.empty((7, rays)), np.empty((rays, 2), np.int64)
        unsettled = trace_groups(*groups, strata, self.wall, self.bins, *make_room(), rows, counts, left, slots)
        if unsettled:
            slots = slots[:unsettled]
            np.add.at(counts, (slots[:, 0], slots[:, 1], self.grid.follow(left[:, :unsettled])), 1)
        used = rows >= 0
        rows, counts = rows[used], counts[used]
        by_block = np.zeros((blocks, fates), np.int64)
        np.add.at(by_block, rows * blocks // strata.along, counts.sum(axis=1))
        difference = counts[:, 0] - counts[:, 1]
        return Sample(by_block, difference.T @ difference)

    @staticmethod
    def side(strata: Strata) -> int:
        """Strata along each side of a group."""
        return 1 if strata.parts_along * strata.parts_around > 1 else strata.tile
