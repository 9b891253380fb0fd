"""The same scene as triangles, traced by a mesh engine: what exact spheres are compared with.

Every sphere becomes an icosphere: an icosahedron whose triangles were parted in four a number of times, with the
corners on a sphere. Rays start, end and are named as those of the exact engine; what differs are the facets and the
single precision of the engine.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from bedrad.packings.packing import Packing
from bedrad.raytrace.kernels import UNSETTLED, start_rays
from bedrad.raytrace.mesh_engines import ENGINES, Engine, Maker, available_engines, engine_maker
from bedrad.raytrace.mesh_kernels import GOING_ON, end_rays, ray_keys, scale_rays
from bedrad.raytrace.sampling import DIMENSIONS
from bedrad.raytrace.scene import bounds
from bedrad.raytrace.tracer import emitting_wall
from bedrad.walls import Tube, Window

__all__ = ["ENGINES", "SCALINGS", "MeshTracer", "available_engines", "icosphere"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
FateArray = NDArray[np.int16]

SCALINGS = ("inscribed", "equal area", "equal volume")
"""How large an icosphere is: with its corners on the sphere, or with the sphere's area or volume. The mean shadow of a
convex body is a quarter of its area, so that equal area also means an equal mean shadow."""

MOST_SUBDIVISIONS = 6
"""81,920 triangles a sphere; more fit into the memory of a computer for the smallest beds only."""

EXTRA_REACH = 8.0
"""How far beyond the last edge the first mesh of a tube reaches, in mean radii. That is twice as far as the exact
engine's first grid, which one ray in 100,000 passes in a settled bed: a second mesh costs much more than a grid."""

IMAGES = 4.0
"""How far the images of a periodic bed reach beyond its box, in mean radii; rays that go further start again inside."""

CHUNK = 2**18
"""Rays sorted and traced together; more need more memory and gain little."""


@dataclass(frozen=True)
class Icosphere:
    """An icosphere of radius one: (v, 3) vertices, (f, 3) triangles, (f, 4) facets (normal, plane's distance)."""

    vertices: FloatArray
    triangles: NDArray[np.uint32]
    facets: FloatArray
    factor: float


@dataclass(frozen=True)
class MeshScene:
    """The triangles that rays can reach, and what tells where the rays end; see `mesh_kernels.end_rays`."""

    reach: float
    low: FloatArray
    high: FloatArray
    spheres: FloatArray
    starts: IntArray
    members: IntArray
    middle: FloatArray
    scale: float
    engine: Engine | None


class MeshTracer:
    """Traces rays through a bed whose spheres are icospheres, on one thread.

    Parameters
    ----------
    packing : Packing
        The bed.
    edges : (layers + 1,) array
        Depths that part the layers. [m]
    window : Window
        The piece of wall that emits.
    engine : str
        One of `ENGINES`.
    subdivision : int
        How often the 20 triangles of the icosahedron are parted in four.
    scaling : str
        One of `SCALINGS`.
    sort : bool
        Trace the rays of one place and direction after each other; they meet the same triangles. It pays from some
        hundred thousand rays at a time, `CHUNK` or more.

    Attributes
    ----------
    name : str
        What sets the tracer apart.
    setup_seconds : float
        Time to load the engine, and to make the triangles and the engine's tree over them. [s]

    Raises
    ------
    ValueError
        If there is no such engine, subdivision or scaling, or the window reaches beyond the ends of the bed.
    MissingExtraError
        If the engine is not installed.
    EngineFailedError
        If the engine lacks a library of the system.
    """

    def __init__(
        self,
        packing: Packing,
        edges: FloatArray,
        window: Window,
        engine: str = "open3d",
        subdivision: int = 3,
        scaling: str = "equal volume",
        sort: bool = True,
    ) -> None:
        begin = time.perf_counter()
        if scaling not in SCALINGS:
            raise ValueError(f"scaling is {scaling!r}; expected one of {', '.join(SCALINGS)}")
        if subdivision not in range(MOST_SUBDIVISIONS + 1):
            raise ValueError(f"subdivision is {subdivision!r}; expected a whole number from 0 to {MOST_SUBDIVISIONS}")
        self._make = engine_maker(engine)
        self._ball = icosphere(int(subdivision), scaling)
        self.name = f"{engine}, subdivision {subdivision}, {scaling}{', sorted' if sort else ''}"
        self.packing, self.edges, self.measured, self.sort = packing, edges, window, sort
        self.kind, self.wall_radius, self.window = emitting_wall(packing, window)
        reach = float(edges[-1])
        if isinstance(packing.wall, Tube):
            reach = reach + EXTRA_REACH * packing.mean_diameter / 2 if len(packing) else packing.wall.radius
            reach = min(reach, packing.wall.radius)
        self.near = build_mesh_scene(packing, window, reach, self._ball, self._make)
        self.deep: MeshScene | None = None
        # compiles the kernels on their first use, so that the time of the rays is theirs alone
        self._trace(self.near, np.full((1, DIMENSIONS), 0.5))
        self.setup_seconds = time.perf_counter() - begin

    @property
    def triangles(self) -> int:
        """Number of triangles of the mesh that nearly all rays are traced in, periodic images included."""
        return len(self.near.spheres) * len(self._ball.facets)

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
        fates = np.empty(len(points), np.int16)
        points = np.ascontiguousarray(points)
        for first in range(0, len(points), CHUNK):
            chunk = slice(first, first + CHUNK)
            fates[chunk] = self._trace(self.near, points[chunk])
        unsettled = np.flatnonzero(fates == UNSETTLED)
        if len(unsettled):
            # as the exact engine does: the few rays of a tube that get deeper need the whole bed
            if self.deep is None:
                self.deep = build_mesh_scene(self.packing, self.measured, self.wall_radius, self._ball, self._make)
            fates[unsettled] = self._trace(self.deep, points[unsettled])
        return fates

    def _trace(self, scene: MeshScene, points: FloatArray) -> FateArray:
        order = np.arange(len(points))
        if self.sort:
            keys = np.empty(len(points), np.uint16)
            ray_keys(points, keys)
            order = np.argsort(keys, kind="stable")
        rays, gone = np.empty((7, len(points))), np.zeros(len(points))
        start_rays(points[order], self.kind, self.wall_radius, self.window, rays)
        fates = np.empty(len(points), np.int16)
        while len(order):
            scaled = np.empty((len(order), 6), np.float32)
            scale_rays(rays, scene.middle, scene.scale, scaled)
            met = np.full(len(order), -1, np.int32) if scene.engine is None else scene.engine.first(scaled)
            found = np.empty(len(order), np.int16)
            going_on = end_rays(
                met, rays, gone, self.kind, self.wall_radius, self.edges, scene.reach, scene.low, scene.high,
                np.array(self.packing.box), scene.spheres, self._ball.facets, self._ball.factor,
                scene.starts, scene.members, found,
            )  # fmt: skip
            fates[order] = found
            if not going_on:
                break
            on = found == GOING_ON
            order, rays, gone = order[on], np.ascontiguousarray(rays[:, on]), gone[on]
        return fates


def icosphere(subdivision: int, scaling: str) -> Icosphere:
    """The unit mesh, and its size for a sphere of radius one."""
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=subdivision)
    vertices = np.array(mesh.vertices, dtype=float)
    triangles = np.array(mesh.faces, dtype=np.uint32)
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    areas = np.cross(b - a, c - a) / 2.0
    sizes = np.linalg.norm(areas, axis=1)
    normals = areas / sizes[:, None]
    distances = (normals * (a + b + c)).sum(axis=1) / 3.0
    match scaling:
        case "equal area":
            factor = float(np.sqrt(4.0 * np.pi / sizes.sum()))
        case "equal volume":
            factor = float(np.cbrt(4.0 * np.pi / (sizes * distances).sum()))
        case _:
            factor = 1.0
    return Icosphere(vertices, triangles, np.column_stack([normals, distances]), factor)


def build_mesh_scene(packing: Packing, window: Window, reach: float, ball: Icosphere, make: Maker) -> MeshScene:
    """Turn the spheres that reach less deep than `reach`, and their images, into triangles.

    Parameters
    ----------
    packing : Packing
        The bed.
    window : Window
        The piece of wall that emits; it must lie within the bed.
    reach : float
        Depth down to which the mesh is complete. [m]
    ball : Icosphere
        The mesh of a sphere of radius one.
    make : callable
        See `engine_maker`.

    Raises
    ------
    ValueError
        If the window reaches beyond the ends of the bed.
    """
    low, high = bounds(packing, window, reach)
    near = packing.depths - packing.radii < reach
    spheres = np.column_stack([packing.centers[near], packing.radii[near]])
    scale = float(spheres[:, 3].mean()) if len(spheres) else 1.0
    for axis, period in enumerate(packing.box):
        if period:
            low[axis] -= IMAGES * scale
            high[axis] += IMAGES * scale
            spheres = _with_images(spheres, axis, period, low[axis], high[axis])
    starts, members = _overlaps(spheres, packing.wall.depth(spheres[:, :3]) < spheres[:, 3])
    middle = (low + high) / 2.0
    engine = None
    if len(spheres):
        small = (spheres[:, :3] - middle) / scale
        sizes = spheres[:, 3] / scale * ball.factor
        # sphere by sphere: subdivided meshes are large, and single precision is all that is kept
        vertices = np.empty((len(spheres), len(ball.vertices), 3), np.float32)
        for k in range(len(spheres)):
            vertices[k] = small[k] + sizes[k] * ball.vertices
        offsets = np.arange(len(spheres), dtype=np.uint32) * np.uint32(len(ball.vertices))
        triangles = ball.triangles[None] + offsets[:, None, None]
        engine = make(vertices.reshape(-1, 3), triangles.reshape(-1, 3))
    return MeshScene(reach, low, high, spheres, starts, members, middle, scale, engine)


def _with_images(spheres: FloatArray, axis: int, period: float, low: float, high: float) -> FloatArray:
    """The spheres and all their images along an axis that reach into a range."""
    x, r = spheres[:, axis], spheres[:, 3]
    largest = float(r.max(initial=0.0))
    images = []
    for k in range(math.floor((low - largest) / period), math.ceil((high + largest) / period) + 1):
        reaching = (x + k * period + r > low) & (x + k * period - r < high)
        image = spheres[reaching]
        image[:, axis] += k * period
        images.append(image)
    return np.concatenate(images)


def _overlaps(spheres: FloatArray, at_wall: NDArray[np.bool_]) -> tuple[IntArray, IntArray]:
    """Which of the spheres that overlap the wall each sphere overlaps, itself not among them; see `end_rays`."""
    starts = np.zeros(len(spheres) + 1, np.int64)
    through = np.flatnonzero(at_wall)
    if not len(through):
        return starts, np.empty(0, np.int64)
    pairs = KDTree(spheres[through, :3]).sparse_distance_matrix(
        KDTree(spheres[:, :3]), 2.0 * spheres[:, 3].max(), output_type="coo_matrix"
    )
    one, other = through[pairs.row], pairs.col
    over = (pairs.data < spheres[one, 3] + spheres[other, 3]) & (one != other)
    one, other = one[over], other[over]
    order = np.argsort(other, kind="stable")
    np.cumsum(np.bincount(other, minlength=len(spheres)), out=starts[1:])
    return starts, one[order].astype(np.int64)
