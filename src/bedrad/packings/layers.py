"""Cutting a packing into layers beside its wall: depths, exact volumes and surfaces of every sphere.

Each sphere is cut by the two surfaces that bound a layer (coaxial cylinders, or planes over a plate) and by
the ends of the measuring window, to rounding error. Spheres that overlap are counted whole each. What lies
beyond the wall (depth < 0) does not count. Along a period, a sphere counts once wherever its images lie in
the window.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.packings.layer_kernels import cut_by_cylinders, cut_by_planes
from bedrad.packings.packing import END_MARGIN, Packing
from bedrad.walls import Plate, Tube, Wall, Window

__all__ = [
    "block_count",
    "check_edges",
    "check_window",
    "layer_areas",
    "layer_edges",
    "layer_sums",
    "layer_volumes",
    "whole_volumes",
]

FloatArray = NDArray[np.float64]

SHORTEST_BLOCK = 2.0
"""Shortest axial block, in mean diameters; shorter ones would share their particles with the next."""
IntArray = NDArray[np.int64]

ROUNDING = 1e-12
"""Relative excess over the largest depth or the period that is taken for rounding."""


def layer_edges(packing: Packing, layers: int = 3, diameter: float | None = None) -> FloatArray:
    """Return the depths that bound the layers: 0, r, 3 r, 5 r, ... (Watkins 2018, section 3.2).

    r is half the number-mean diameter: the wall-adjacent layer is a radius thick and each other a diameter.

    Parameters
    ----------
    packing : Packing
        The spheres and their wall.
    layers : int
        Number of layers, the wall-adjacent one (half a diameter thick) included.
    diameter : float, optional
        Layer spacing to use in place of the number-mean diameter. [m]

    Returns
    -------
    (layers + 1,) array
        Depths, read-only. [m]

    Raises
    ------
    ValueError
        If `layers` is less than one, the last edge lies deeper than the wall allows, or the packing is empty
        and no diameter is given.
    """
    if layers < 1:
        raise ValueError(f"layers is {layers}; expected at least 1")
    if diameter is None:
        diameter = packing.mean_diameter
    if not (math.isfinite(diameter) and diameter > 0):
        raise ValueError(f"diameter is {diameter} m; expected a positive, finite length")
    edges = 0.5 * diameter * np.concatenate(([0.0], 2.0 * np.arange(layers) + 1.0))
    deepest = packing.wall.largest_depth
    if edges[-1] > deepest * (1.0 + ROUNDING):
        raise ValueError(
            f"layers is {layers}: the last edge would lie at {edges[-1]:.6g} m, deeper than the deepest "
            f"point below the {packing.wall.kind} wall ({deepest:.6g} m); at most "
            f"{int(deepest / diameter + 0.5)} fit"
        )
    return check_edges(edges, packing.wall)


def check_edges(edges: ArrayLike, wall: Wall) -> FloatArray:
    """Layer edges as a read-only array, or a ValueError that says what is wrong with them.

    Raises
    ------
    ValueError
        If there are fewer than two, they do not rise from a depth >= 0, or the last lies deeper than the wall
        allows.
    """
    e = np.array(edges, dtype=np.float64)
    if e.ndim != 1 or len(e) < 2:
        raise ValueError(f"edges has the shape {e.shape}; expected (layers + 1,) depths, at least two")
    if not np.isfinite(e).all() or e[0] < 0.0 or (np.diff(e) <= 0.0).any():
        raise ValueError(f"edges are {e.tolist()} m; expected finite depths that rise from 0 or more")
    if e[-1] > wall.largest_depth * (1.0 + ROUNDING):
        raise ValueError(
            f"the last edge is {e[-1]:.6g} m; the deepest point below the {wall.kind} wall is "
            f"{wall.largest_depth:.6g} m"
        )
    e[-1] = min(e[-1], wall.largest_depth)
    e.setflags(write=False)
    return e


def check_window(packing: Packing, window: Window | None = None, margin: float = END_MARGIN) -> Window:
    """Return the measuring window: the given one, checked against wall and period, or the packing's own.

    Raises
    ------
    ValueError
        If the window is longer than the period, or has a lateral range where the wall has none, or none where
        the wall (a plate) needs one.
    """
    if window is None:
        return packing.window(margin)
    if (window.lateral is None) == isinstance(packing.wall, Plate):
        needs = "needs a lateral range" if window.lateral is None else "takes no lateral range"
        raise ValueError(f"the window of a {packing.wall.kind} {needs}; it is {window.lateral}")
    for name, axis, interval in _ranges(packing.wall, window):
        period = packing.box[axis]
        if period and interval[1] - interval[0] > period * (1.0 + ROUNDING):
            raise ValueError(f"the {name} window {interval} m is longer than the period of {period:.6g} m")
    return window


def block_count(packing: Packing, window: Window, most: int = 8) -> int:
    """Number of axial blocks for errors: at most `most`, each at least `SHORTEST_BLOCK` mean diameters long."""
    if not len(packing):
        return 1
    # a window of just so many blocks has as many in every frame, whatever the rounding of its ends
    room = window.length / (SHORTEST_BLOCK * packing.mean_diameter) * (1.0 + 1e-9)
    return int(min(most, max(1.0, room)))


def layer_volumes(
    packing: Packing, edges: ArrayLike, window: Window | None = None, margin: float = END_MARGIN
) -> FloatArray:
    """Exact volume of every sphere in every layer inside the window.

    Parameters
    ----------
    packing : Packing
        The spheres and their wall.
    edges : (layers + 1,) array
        Depths that bound the layers, rising. [m]
    window : Window, optional
        The piece of wall to measure; `packing.window(margin)` where not given.
    margin : float
        What that window leaves out at each open end, in mean particle diameters.

    Returns
    -------
    (n, layers) array
        Volumes; zero for spheres that reach neither window nor layers. [m3]

    Raises
    ------
    ValueError
        If the edges or the window do not fit the wall or the period.
    """
    return _per_sphere(packing, edges, window, margin)[0]


def layer_areas(
    packing: Packing, edges: ArrayLike, window: Window | None = None, margin: float = END_MARGIN
) -> FloatArray:
    """Exact area of every sphere's surface in every layer inside the window.

    Arguments and errors as for `layer_volumes`.

    Returns
    -------
    (n, layers) array
        Areas; zero for spheres that reach neither window nor layers. [m2]
    """
    return _per_sphere(packing, edges, window, margin)[1]


def layer_sums(
    packing: Packing,
    edges: ArrayLike,
    window: Window | None = None,
    blocks: int = 1,
    margin: float = END_MARGIN,
) -> FloatArray:
    """Solid volume in every layer, in blocks of equal length along the window; nothing is stored per sphere.

    Parameters
    ----------
    packing, edges, window, margin
        As for `layer_volumes`.
    blocks : int
        Number of blocks.

    Returns
    -------
    (blocks, layers) array
        Volumes, summed over the spheres. [m3]

    Raises
    ------
    ValueError
        If `blocks` is less than one, or the edges or the window do not fit.
    """
    if blocks < 1:
        raise ValueError(f"blocks is {blocks}; expected at least 1")
    e = check_edges(edges, packing.wall)
    w = check_window(packing, window, margin)
    images = _images(packing, float(e[-1]), w)
    rows = np.zeros(len(images.radii), dtype=np.int64)
    planes = np.linspace(*w.axial, blocks + 1)
    return _cut(packing.wall, images.centers, images.radii, rows, e, planes, w.lateral, blocks)[0]


def whole_volumes(wall: Wall, centers: FloatArray, radii: FloatArray, edges: FloatArray) -> FloatArray:
    """Exact volumes (n, layers) of whole spheres in every layer, not cut by any window. [m3]"""
    everywhere = np.array([-math.inf, math.inf])
    rows = np.arange(len(radii), dtype=np.int64)
    lateral = (-math.inf, math.inf)
    return _cut(wall, centers, radii, rows, edges, everywhere, lateral, len(radii))[0]


@dataclass(frozen=True)
class _Images:
    """Spheres and periodic images that reach both the window and the layers, with the spheres' numbers."""

    centers: FloatArray
    radii: FloatArray
    spheres: IntArray


def _per_sphere(
    packing: Packing, edges: ArrayLike, window: Window | None, margin: float
) -> tuple[FloatArray, FloatArray]:
    e = check_edges(edges, packing.wall)
    w = check_window(packing, window, margin)
    images = _images(packing, float(e[-1]), w)
    planes = np.array(w.axial)
    return _cut(packing.wall, images.centers, images.radii, images.spheres, e, planes, w.lateral, len(packing))


def _ranges(wall: Wall, window: Window) -> list[tuple[str, int, tuple[float, float]]]:
    """Name, Cartesian axis and interval of each range of a window."""
    ranges = [("axial", wall.axial, window.axial)]
    if window.lateral is not None:
        ranges.append(("lateral", 1, window.lateral))
    return ranges


def _images(packing: Packing, deepest: float, window: Window) -> _Images:
    """Find the spheres, shifted by whole periods, that reach the window and the depth `deepest`."""
    spheres = np.flatnonzero(packing.depths - packing.radii < deepest)
    centers, radii = packing.centers[spheres], packing.radii[spheres]
    for _, axis, (low, high) in _ranges(packing.wall, window):
        x, period = centers[:, axis], packing.box[axis]
        if not period:
            keep = (x + radii > low) & (x - radii < high)
            centers, radii, spheres = centers[keep], radii[keep], spheres[keep]
            continue
        # the period holds a sphere's width but for a small overlap, yet several shifts may reach one window
        first = np.ceil((low - x - radii) / period).astype(np.int64)
        count = np.maximum(np.floor((high - x + radii) / period).astype(np.int64) - first + 1, 0)
        source = np.repeat(np.arange(len(x)), count)
        shift = np.arange(len(source)) - np.repeat(np.cumsum(count) - count, count) + first[source]
        centers, radii, spheres = centers[source], radii[source], spheres[source]
        centers[:, axis] += shift * period
    return _Images(centers, radii, spheres.astype(np.int64))


def _cut(
    wall: Wall,
    centers: FloatArray,
    radii: FloatArray,
    rows: IntArray,
    edges: FloatArray,
    planes: FloatArray,
    lateral: tuple[float, float] | None,
    height: int,
) -> tuple[FloatArray, FloatArray]:
    """Volumes and surfaces (height, layers), added up by row."""
    volumes = np.zeros((height, len(edges) - 1))
    surfaces = np.zeros_like(volumes)
    if isinstance(wall, Plate):
        if lateral is None:
            raise ValueError("the window of a plate needs a lateral range; it is None")
        cut_by_planes(centers, radii, rows, lateral, edges, planes, volumes, surfaces)
    else:
        outward = -1.0 if isinstance(wall, Tube) else 1.0
        cut_by_cylinders(centers, radii, rows, wall.radius, outward, edges, planes, volumes, surfaces)
    return volumes, surfaces
