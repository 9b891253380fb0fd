"""What the exchange of wall and spheres needs: zones and their areas, where rays start, the grid they cross."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from bedrad.packings.layers import layer_areas
from bedrad.packings.packing import Packing
from bedrad.raytrace.enclosure_kernels import start_on_spheres
from bedrad.raytrace.kernels import start_rays
from bedrad.raytrace.sampling import BATCH, DIMENSIONS, SCRAMBLINGS
from bedrad.raytrace.scene import build_scene
from bedrad.raytrace.tracer import emitting_wall
from bedrad.raytrace.view_factors import available_processors
from bedrad.walls import Tube, Window

__all__ = ["MOST_RAYS", "EnclosureScene", "run_streams", "sobol", "stream_size"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Result = TypeVar("Result")

MOST_RAYS = 2**35
"""More rays than this are refused: hours of work, and more points than a Sobol sequence of 30 bits has."""


class EnclosureScene:
    """A bed, its zones, and the grid through which rays go from each zone to the others.

    Parameters
    ----------
    packing : Packing
        The bed.
    edges : (layers + 1,) array
        Depths that part the layers, from 0. [m]
    window : Window
        The piece of wall that emits; the spheres' surface emits over the same length.
    orientations : int
        Into how many ranges of angles to the wall the surface in a layer is parted.
    """

    def __init__(self, packing: Packing, edges: FloatArray, window: Window, orientations: int = 1) -> None:
        begin = time.perf_counter()
        self.packing, self.edges, self.window, self.orientations = packing, np.array(edges), window, orientations
        self.kind, self.wall_radius, self.wall_window = emitting_wall(packing, window)
        # a ray in a tube may come back from any depth; beside a rod or plate none comes back from beyond the last edge
        self.reach = self.wall_radius if isinstance(packing.wall, Tube) else float(edges[-1])
        scene = build_scene(packing, window, self.reach)
        self.left_out = scene.left_out
        self.period = np.array(packing.box)
        self.grid = (scene.low, scene.size, scene.cells, self.period, scene.starts, scene.columns)
        self.room_size = scene.most_in_a_cell
        areas = layer_areas(packing, self.edges, window)
        self.wall_area = packing.wall.area(window)
        self.layer_areas: FloatArray = areas.sum(axis=0)
        emitters = np.flatnonzero(areas.sum(axis=1) > 0.0)
        # neighbours in depth lie beside each other in the first dimension of the points, which the points fill evenly
        emitters = emitters[np.argsort(packing.depths[emitters], kind="stable")]
        self.spheres = np.ascontiguousarray(np.column_stack([packing.centers[emitters], packing.radii[emitters]]).T)
        shares = np.cumsum(self.spheres[3] ** 2)
        self.shares = shares / shares[-1] if len(shares) else shares
        self.setup_seconds = time.perf_counter() - begin

    @property
    def zones(self) -> int:
        """Number of zones: the wall, and the ranges of angles in the layers."""
        return 1 + (len(self.edges) - 1) * self.orientations

    @property
    def emits(self) -> bool:
        """Whether any sphere has surface in the layers."""
        return bool(self.spheres.size)

    def room(self) -> FloatArray:
        """Room for the distances to the spheres of one cell."""
        return np.empty(self.room_size)

    def wall_rays(self, points: FloatArray) -> FloatArray:
        """Rays (6, n) from the wall, from (n, 4) points of the unit hypercube."""
        rays = np.empty((7, len(points)))
        start_rays(points, self.kind, self.wall_radius, self.wall_window, rays)
        for axis in np.flatnonzero(self.period):
            rays[axis] = np.mod(rays[axis], self.period[axis])
        return rays[:6]

    def sphere_rays(self, points: FloatArray) -> tuple[FloatArray, IntArray]:
        """Rays (6, n) from the spheres and the zones where they start, -1 for none, from (n, 5) points."""
        rays, zones = np.empty((6, len(points))), np.empty(len(points), np.int64)
        start_on_spheres(
            points, self.spheres, self.shares, self.kind, self.wall_radius, self.wall_window, self.period,
            self.edges, self.orientations, rays, zones,
        )  # fmt: skip
        return rays, zones


def sobol(seed: np.random.SeedSequence, dimensions: int, count: int, stop: threading.Event) -> Iterator[FloatArray]:
    """Scrambled Sobol points (m, dimensions), in batches, until `stop` is set."""
    engine = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed))
    while count > 0 and not stop.is_set():
        batch = min(count, BATCH)
        yield np.ascontiguousarray(engine.random(batch))
        count -= batch


WALL_DIMENSIONS, SPHERE_DIMENSIONS = DIMENSIONS, 5
"""Position on the wall (2) and direction (2); sphere, position on it (2) and direction (2)."""


def stream_size(rays: int, parts: int) -> int:
    """Points of one scrambling, a power of two as Sobol points want it, so that `parts` of them are `rays` or more.

    Raises
    ------
    ValueError
        If `rays` is not positive or too large.
    """
    if not 1 <= rays <= MOST_RAYS:
        raise ValueError(f"rays is {rays!r}; expected a whole number from 1 to {MOST_RAYS}")
    return 1 << max(math.ceil(math.log2(rays / (SCRAMBLINGS * parts))), 0)


def run_streams(
    work: Callable[[np.random.SeedSequence, threading.Event], Result], seed: int, threads: int | None
) -> list[Result]:
    """Give each independent scrambling its seed and do its work, several at a time; results in their own order.

    The event is set when an interrupt ends the whole: then the work is to end at once, whatever it gives.

    Raises
    ------
    ValueError
        If `threads` is not positive.
    """
    if threads is not None and threads < 1:
        raise ValueError(f"threads is {threads!r}; expected at least 1")
    seeds = np.random.SeedSequence(seed).spawn(SCRAMBLINGS)
    count = threads or available_processors()
    stop = threading.Event()
    if count == 1:
        return [work(child, stop) for child in seeds]
    pool = ThreadPoolExecutor(count)
    try:
        return list(pool.map(work, seeds, [stop] * len(seeds)))
    finally:
        # an interrupt must not wait for the rays that were still to come
        stop.set()
        pool.shutdown(wait=True, cancel_futures=True)
