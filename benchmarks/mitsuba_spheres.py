"""Mitsuba 3 as an engine: its sphere shapes, traced by the compiled variant on one thread. No part of bedrad.

`pip install mitsuba`; the variant needs the shared library of LLVM (on Debian and Ubuntu: apt-get install libllvm15).
"""

from __future__ import annotations

import importlib.util
import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from bedrad.packings.packing import Packing
from bedrad.raytrace.kernels import OPTIONS, UNSETTLED, start_rays
from bedrad.raytrace.mesh_kernels import GOING_ON, end_ray, ray_keys
from bedrad.raytrace.meshes import EXTRA_REACH, IMAGES, _with_images
from bedrad.raytrace.scene import bounds
from bedrad.raytrace.tracer import emitting_wall
from bedrad.walls import Tube, Window

__all__ = ["MitsubaTracer", "why_not"]

FloatArray = NDArray[np.float64]

VARIANT = "llvm_ad_mono"


def why_not() -> str:
    """Say why Mitsuba cannot be used; empty if it can."""
    if importlib.util.find_spec("mitsuba") is None:
        return "not installed (pip install mitsuba)"
    try:
        _mitsuba()
    except (ImportError, OSError, RuntimeError) as error:
        return f"{VARIANT} does not start: {str(error).splitlines()[0]}"
    return ""


def _mitsuba() -> Any:
    import drjit
    import mitsuba

    mitsuba.set_variant(VARIANT)
    # the calling thread alone
    drjit.set_thread_count(1)
    return mitsuba


class _Scene:
    """The spheres down to a depth, images included, in units of their mean radius."""

    def __init__(self, mitsuba: Any, packing: Packing, window: Window, reach: float) -> None:
        self.mitsuba, self.reach = mitsuba, reach
        self.low, self.high = bounds(packing, window, reach)
        near = packing.depths - packing.radii < reach
        spheres = np.column_stack([packing.centers[near], packing.radii[near]])
        self.scale = float(spheres[:, 3].mean())
        for axis, period in enumerate(packing.box):
            if period:
                self.low[axis] -= IMAGES * self.scale
                self.high[axis] += IMAGES * self.scale
                spheres = _with_images(spheres, axis, period, self.low[axis], self.high[axis])
        self.spheres = spheres
        self.middle = (self.low + self.high) / 2.0
        small = np.column_stack([(spheres[:, :3] - self.middle) / self.scale, spheres[:, 3] / self.scale])
        matter = mitsuba.load_dict({"type": "diffuse"})
        shapes = {
            f"sphere{k}": {"type": "sphere", "center": s[:3], "radius": s[3], "bsdf": matter}
            for k, s in enumerate(small.tolist())
        }
        self._scene = mitsuba.load_dict({"type": "scene"} | shapes)

    def first(self, rays: FloatArray) -> NDArray[np.uint32]:
        """Number of the sphere that each ray meets first, the largest number of 32 bits for none."""
        mi = self.mitsuba
        origins = ((rays[:3] - self.middle[:, None]) / self.scale).astype(np.float32)
        ray = mi.Ray3f(mi.Point3f(origins), mi.Vector3f(rays[3:6].astype(np.float32)))
        # spheres are in the scene in the order in which they were named
        return np.asarray(self._scene.ray_intersect_preliminary(ray, coherent=False).shape_index.numpy())


class MitsubaTracer:
    """Traces rays through exact spheres by Mitsuba.

    Parameters
    ----------
    packing : Packing
        The bed, not empty.
    edges : (layers + 1,) array
        Depths that part the layers. [m]
    window : Window
        The piece of wall that emits.
    sort : bool
        Trace the rays of one place and direction after each other.
    """

    def __init__(self, packing: Packing, edges: FloatArray, window: Window, sort: bool = False) -> None:
        self.packing, self.edges, self.measured, self.sort = packing, edges, window, sort
        self.kind, self.wall_radius, self.window = emitting_wall(packing, window)
        reach = float(edges[-1])
        if isinstance(packing.wall, Tube):
            reach = min(reach + EXTRA_REACH * packing.mean_diameter / 2, packing.wall.radius)
        self.near = _Scene(_mitsuba(), packing, window, reach)
        self.deep: _Scene | None = None

    def fates(self, points: FloatArray) -> NDArray[np.int16]:
        """Where the rays of (n, 4) points of the unit hypercube end, numbered as those of bedrad's engines."""
        fates = np.empty(len(points), np.int16)
        order = np.arange(len(points))
        if self.sort:
            keys = np.empty(len(points), np.uint16)
            ray_keys(np.ascontiguousarray(points), keys)
            order = np.argsort(keys, kind="stable")
        fates[order] = self._trace(self.near, points[order])
        unsettled = np.flatnonzero(fates == UNSETTLED)
        if len(unsettled):
            if self.deep is None:
                self.deep = _Scene(self.near.mitsuba, self.packing, self.measured, self.wall_radius)
            fates[unsettled] = self._trace(self.deep, points[unsettled])
        return fates

    def _trace(self, scene: _Scene, points: FloatArray) -> NDArray[np.int16]:
        rays, gone = np.empty((7, len(points))), np.zeros(len(points))
        start_rays(points, self.kind, self.wall_radius, self.window, rays)
        fates, order = np.empty(len(points), np.int16), np.arange(len(points))
        while len(order):
            found = np.empty(len(order), np.int16)
            going_on = end_at_spheres(
                scene.first(rays), rays, gone, self.kind, self.wall_radius, self.edges, scene.reach,
                scene.low, scene.high, np.array(self.packing.box), scene.spheres, found,
            )  # fmt: skip
            fates[order] = found
            if not going_on:
                break
            on = found == GOING_ON
            order, rays, gone = order[on], np.ascontiguousarray(rays[:, on]), gone[on]
        return fates


@njit(**OPTIONS)
def end_at_spheres(met, rays, gone, kind, wall_radius, edges, reach, low, high, period, spheres, fates):
    """Say where rays end, given the spheres that they meet first; as `bedrad.raytrace.mesh_kernels.end_rays`.

    Distances are in double precision. A ray from inside the sphere that it meets ends where it starts.
    """
    going_on = 0
    for i in range(met.size):
        ox, oy, oz, dx, dy, dz = rays[0, i], rays[1, i], rays[2, i], rays[3, i], rays[4, i], rays[5, i]
        t = math.inf
        if met[i] < len(spheres):
            s = spheres[met[i]]
            x, y, z = s[0] - ox, s[1] - oy, s[2] - oz
            along = x * dx + y * dy + z * dz
            x, y, z = x - along * dx, y - along * dy, z - along * dz
            # the sphere was met in single precision, perhaps by a hair's breadth
            half = math.sqrt(max(s[3] * s[3] - (x * x + y * y + z * z), 0.0))
            t = max(along - half, 0.0)
        fates[i] = end_ray(i, t, rays, gone, kind, wall_radius, edges, reach, low, high, period)
        going_on += fates[i] == GOING_ON
    return going_on
