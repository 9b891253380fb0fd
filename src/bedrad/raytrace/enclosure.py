"""Exchange factors between wall and layers of a bed, whose spheres emit too, by ray tracing on exact spheres.

`exchange_factors` gives the whole matrix between wall and layers; with it `bedrad.heat.grey_enclosure` solves for grey
surfaces, under the assumption that each layer's radiosity is uniform. `reflected_factors` makes no such assumption: its
rays are absorbed with the probability of the emissivity wherever they end, and else go on from that point.
"""

from __future__ import annotations

import threading
import time

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.packings.layers import check_window
from bedrad.packings.packing import Packing
from bedrad.raytrace.enclosure_kernels import follow_once, follow_reflections
from bedrad.raytrace.enclosure_results import ExchangeFactors, ReflectedFactors
from bedrad.raytrace.enclosure_scene import (
    SPHERE_DIMENSIONS,
    WALL_DIMENSIONS,
    EnclosureScene,
    run_streams,
    sobol,
    stream_size,
)
from bedrad.raytrace.factors import LeftOut
from bedrad.raytrace.view_factors import edges_from_wall
from bedrad.walls import Window

__all__ = ["MOST_REFLECTIONS", "exchange_factors", "reflected_factors"]

IntArray = NDArray[np.int64]

SPHERE_PARTS = 4
"""Points on the spheres for each one on the wall, a power of two: the spheres have several times the wall's area."""

MOST_REFLECTIONS = 100_000
"""Reflections after which a ray ends where it is; what closed pockets of nearly white surfaces need."""

LEAST_EMISSIVITY = 1e-3
"""Least emissivity of the spheres for which rays are followed from reflection to reflection."""


def exchange_factors(
    packing: Packing,
    edges: ArrayLike | None = None,
    rays: int = 2**20,
    seed: int = 0,
    *,
    orientations: int = 1,
    window: Window | None = None,
    threads: int | None = None,
) -> ExchangeFactors:
    """Share of the diffuse radiation of wall and layers that ends at the wall and at each layer.

    The zones are the wall and the spheres' surface in each layer. Rays leave every zone uniformly over its area within
    the window, by the cosine law, and end at the first surface, which may lie outside the window; the depth of that
    point says which layer it belongs to. What ends deeper than the last edge is beyond (beside a rod or plate: what
    passes that depth, as it cannot come back), what leaves through open ends has escaped. Where a ray starts inside
    another sphere that overlaps its own, or the wall, it ends there.

    Parameters
    ----------
    packing : Packing
        The bed.
    edges : (layers + 1,) array, optional
        Depths that part the layers, from 0; three layers by `layer_edges` if not given. [m]
    rays : int
        Number of points from which rays start, or up to twice as many; a fifth on the wall. Points on spheres that
        reach out of the window or the layers start no ray there.
    seed : int
        Seed of the rays.
    orientations : int
        Part the surface in each layer by its angle to the wall too, into so many ranges of equal area on a whole
        sphere, that which faces the wall first.
    window : Window, optional
        The piece of wall that emits; `Packing.window` if not given, which leaves out open ends.
    threads : int, optional
        Number of threads; all processors if not given. The result does not depend on it.

    Returns
    -------
    ExchangeFactors
        The matrix, its standard errors, the zones' areas, and what it cost.

    Raises
    ------
    ValueError
        If the edges do not ascend from 0 or are deeper than the wall allows, a number is not positive, the window
        reaches beyond the bed, or so few rays start that a layer with surface has none.
    """
    begin = time.perf_counter()
    depths = edges_from_wall(packing, edges)
    if orientations < 1:
        raise ValueError(f"orientations is {orientations!r}; expected at least 1")
    size = stream_size(rays, 1 + SPHERE_PARTS)
    scene = EnclosureScene(packing, depths, check_window(packing, window), orientations)
    place = (scene.kind, scene.wall_radius, scene.edges, orientations, scene.reach, scene.grid)

    def trace(child: np.random.SeedSequence, stop: threading.Event) -> IntArray:
        counts, room = np.zeros((scene.zones, scene.zones + 2), np.int64), scene.room()
        on_wall, on_spheres = child.spawn(2)
        for points in sobol(on_wall, WALL_DIMENSIONS, size, stop):
            follow_once(scene.wall_rays(points), np.zeros(len(points), np.int64), *place, room, counts)
        if scene.emits:
            for points in sobol(on_spheres, SPHERE_DIMENSIONS, SPHERE_PARTS * size, stop):
                follow_once(*scene.sphere_rays(points), *place, room, counts)
        return counts

    counts = np.array(run_streams(trace, seed, threads))
    return ExchangeFactors.from_counts(
        counts,
        wall_area=scene.wall_area,
        layer_areas=scene.layer_areas,
        edges=depths,
        orientations=orientations,
        window=scene.window,
        seconds=time.perf_counter() - begin,
        setup_seconds=scene.setup_seconds,
        seed=seed,
        left_out=LeftOut(spheres=scene.left_out, deep_rays=0, reach=scene.reach),
    )


def reflected_factors(
    packing: Packing,
    wall_emissivity: float,
    particle_emissivity: float,
    edges: ArrayLike | None = None,
    rays: int = 2**18,
    seed: int = 0,
    *,
    window: Window | None = None,
    threads: int | None = None,
) -> ReflectedFactors:
    """Share of what a grey wall emits that wall and layers absorb, by rays that are reflected where they end.

    Rays leave the wall by the cosine law. Where one ends it is absorbed with the probability of the emissivity, else
    it goes on from that very point by the cosine law about the surface's normal. What lies beyond the last layer
    absorbs all, as black surfaces do, and so do open ends.

    Parameters
    ----------
    packing : Packing
        The bed.
    wall_emissivity : float
        Of the wall, 0 to 1; it absorbs by it what comes back to it.
    particle_emissivity : float
        Of the spheres, 0.001 to 1.
    edges, seed, window, threads
        As for `exchange_factors`.
    rays : int
        Number of rays, or up to twice as many; each takes up to 1/emissivity flights.

    Returns
    -------
    ReflectedFactors
        Shares that sum to one, their standard errors, and what they cost.

    Raises
    ------
    ValueError
        As for `exchange_factors`, or if an emissivity is outside its range.
    """
    begin = time.perf_counter()
    depths = edges_from_wall(packing, edges)
    for name, value, least in (("wall", wall_emissivity, 0.0), ("particle", particle_emissivity, LEAST_EMISSIVITY)):
        if not least <= value <= 1.0:
            raise ValueError(f"{name}_emissivity is {value!r}; expected a number from {least:g} to 1")
    size = stream_size(rays, 1)
    scene = EnclosureScene(packing, depths, check_window(packing, window))
    emissivities = np.array([wall_emissivity, particle_emissivity], dtype=float)
    place = (scene.kind, scene.wall_radius, scene.edges, scene.reach, scene.grid)

    def trace(child: np.random.SeedSequence, stop: threading.Event) -> tuple[IntArray, int, int]:
        counts, room = np.zeros(scene.zones + 2, np.int64), scene.room()
        on_wall, on_the_way = child.spawn(2)
        keys = np.random.default_rng(on_the_way)
        reflections = ended = 0
        for points in sobol(on_wall, WALL_DIMENSIONS, size, stop):
            key = keys.integers(2**64, dtype=np.uint64)
            more, cut = follow_reflections(
                scene.wall_rays(points), key, emissivities, MOST_REFLECTIONS, *place, room, counts
            )
            reflections, ended = reflections + int(more), ended + int(cut)
        return counts, reflections, ended

    found = run_streams(trace, seed, threads)
    return ReflectedFactors.from_counts(
        np.array([counts for counts, _, _ in found]),
        wall_emissivity=float(wall_emissivity),
        particle_emissivity=float(particle_emissivity),
        edges=depths,
        window=scene.window,
        reflections=sum(more for _, more, _ in found),
        ended=sum(cut for _, _, cut in found),
        seconds=time.perf_counter() - begin,
        setup_seconds=scene.setup_seconds,
        seed=seed,
        left_out=LeftOut(spheres=scene.left_out, deep_rays=0, reach=scene.reach),
    )
