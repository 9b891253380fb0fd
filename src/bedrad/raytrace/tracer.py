"""Rays through the grid of a scene: first the part near the wall, then, for the few that need it, the whole bed."""

from __future__ import annotations

import math
import threading
import time

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.packing import Packing
from bedrad.raytrace.kernels import PLATE, ROD, TUBE, UNSETTLED, start_rays, trace
from bedrad.raytrace.scene import PADDING, Scene, build_scene
from bedrad.walls import Plate, Tube, Window

__all__ = ["EXTRA_REACH", "KINDS", "GridTracer", "compile_kernels", "emitting_wall"]

FloatArray = NDArray[np.float64]
FateArray = NDArray[np.int16]

EXTRA_REACH = 4.0
"""How far beyond the last edge the first grid of a tube reaches, in mean radii."""

KINDS = {"tube": TUBE, "rod": ROD, "plate": PLATE}


def compile_kernels() -> None:
    """Follow no ray through no grid, so that the kernels are compiled on their first use."""
    none, flat = np.empty((7, 0)), np.ones(3, np.int64)
    start_rays(np.empty((0, 4)), TUBE, 1.0, np.zeros(4), none)
    trace(
        none, TUBE, 1.0, np.array([0.0, 1.0]), 1.0, math.inf, np.zeros(3), np.ones(3), flat, np.zeros(3),
        np.zeros(2, np.int64), np.empty((4, 0)), np.empty(0), np.empty(0, np.int16),
    )  # fmt: skip


def emitting_wall(packing: Packing, window: Window) -> tuple[int, float, FloatArray]:
    """Kind and radius of the wall, and axial start and length, lateral start and length of the window, for kernels."""
    lateral = window.lateral or (0.0, 0.0)
    return (
        KINDS[packing.wall.kind],
        0.0 if isinstance(packing.wall, Plate) else packing.wall.radius,
        np.array([window.axial[0], window.length, lateral[0], lateral[1] - lateral[0]], dtype=float),
    )


class GridTracer:
    """Traces rays by a walk through a grid.

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
        self.packing, self.edges, self.measured = packing, np.array(edges, dtype=float), window
        self.kind, self.wall_radius, self.window = emitting_wall(packing, window)
        self.near_depth = self.reach = float(edges[-1])
        self.hollow = math.inf
        if isinstance(packing.wall, Tube):
            # a ray may pass the last layer and come back to it on the far side, but very few get much deeper
            extra = EXTRA_REACH * packing.mean_diameter / 2 if len(packing) else math.inf
            self.near_depth = self.reach = min(self.reach + extra, packing.wall.radius)
            surface = packing.depths - packing.radii
            if 2 * np.count_nonzero(surface < self.reach) >= len(packing):
                # a second grid would cost more than the rest of the spheres in the first
                self.reach = packing.wall.radius
            if len(packing):
                self.hollow = float((packing.depths + packing.radii).max()) * PADDING
        self._near: Scene | None = None
        self.deep: Scene | None = None
        self.deep_rays = 0
        self.build_seconds = 0.0
        self._lock = threading.Lock()

    @property
    def reached(self) -> float:
        """Depth down to which spheres are in a grid, 0 if none was needed."""
        return self.wall_radius if self.deep is not None else self.reach if self._near is not None else 0.0

    @property
    def near(self) -> Scene:
        """The grid near the wall, built when it is first needed."""
        with self._lock:
            if self._near is None:
                self._near = self._build(self.reach)
        return self._near

    def fates(self, points: FloatArray) -> FateArray:
        """Where the rays of some points end.

        Parameters
        ----------
        points : (n, 4) array
            Points of the unit hypercube, see `bedrad.raytrace.kernels.start_ray`.

        Returns
        -------
        (n,) int array
            The number of the layer, and from there on beyond the last, back to the wall, escaped.
        """
        rays = np.empty((7, len(points)))
        start_rays(points, self.kind, self.wall_radius, self.window, rays)
        return self.follow(rays)

    def follow(self, rays: FloatArray) -> FateArray:
        """Where some rays end.

        Parameters
        ----------
        rays : (7, n) array
            Origins on the wall [m], unit directions, cosines of the angle to the wall's normal.

        Returns
        -------
        (n,) int array
            As `fates`.
        """
        rays = np.ascontiguousarray(rays)
        fates = np.empty(rays.shape[1], np.int16)
        left = self._trace(self.near, rays, fates)
        if left:
            with self._lock:
                self.deep_rays += left
                if self.deep is None:
                    self.deep = self._build(self.wall_radius)
            deeper = np.flatnonzero(fates == UNSETTLED)
            rest = np.empty(len(deeper), np.int16)
            self._trace(self.deep, np.ascontiguousarray(rays[:, deeper]), rest)
            fates[deeper] = rest
        return fates

    def _build(self, reach: float) -> Scene:
        begin = time.perf_counter()
        scene = build_scene(self.packing, self.measured, reach)
        self.build_seconds += time.perf_counter() - begin
        return scene

    def _trace(self, scene: Scene, rays: FloatArray, fates: FateArray) -> int:
        return int(
            trace(
                rays, self.kind, self.wall_radius, self.edges, scene.reach, self.hollow,
                scene.low, scene.size, scene.cells, np.array(self.packing.box),
                scene.starts, scene.columns, np.empty(scene.most_in_a_cell), fates,
            )
        )  # fmt: skip
