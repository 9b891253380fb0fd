"""What rays from the wall can reach: the spheres near enough to it, in a grid of cells."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.packing import Packing
from bedrad.raytrace.kernels import fill_cells
from bedrad.walls import Plate, Rod, Tube, Window

__all__ = ["PADDING", "Scene", "bounds", "build_scene"]

FloatArray = NDArray[np.float64]

SPHERES_PER_CELL = 8.0
"""Mean number of spheres a cell, counted by centres, that the grid aims for."""

MOST_CELLS_PER_SPHERE = 4.0
"""Bound on the grid's memory where most of its volume is empty."""

PADDING = 1.0 + 1e-6
"""The grid is this much wider than the wall or the reach, so that rounding never takes a ray out there."""


@dataclass(frozen=True)
class Scene:
    """A wall, the spheres that rays from it can reach, and the grid that finds them.

    Parameters
    ----------
    packing : Packing
        The bed.
    reach : float
        Depth down to which spheres are in the grid. [m]
    low, size : (3,) arrays
        Lower corner of the grid and size of a cell. [m]
    cells : (3,) array
        Number of cells along each axis.
    starts : (cells + 1,) array
        Where the spheres of each cell begin in `columns`.
    columns : (4, m) array
        Centres [m] and squared radii [m2] of the spheres of each cell, cell by cell, so that a ray reads one run of
        memory a cell; images across periodic faces included.
    reached : int
        Number of the packing's spheres that are in the grid.
    """

    packing: Packing
    reach: float
    low: FloatArray
    size: FloatArray
    cells: NDArray[np.int64]
    starts: NDArray[np.int64]
    columns: FloatArray
    reached: int

    @property
    def left_out(self) -> int:
        """Number of the packing's spheres that are too deep to matter."""
        return len(self.packing) - self.reached

    @property
    def most_in_a_cell(self) -> int:
        """Largest number of spheres of one cell."""
        return int(np.diff(self.starts).max())


def build_scene(packing: Packing, window: Window, reach: float) -> Scene:
    """Put the spheres that reach less deep than `reach` into a grid.

    Parameters
    ----------
    packing : Packing
        The bed.
    window : Window
        The piece of wall that emits; it must lie within the bed.
    reach : float
        Depth down to which the scene is complete. [m]

    Raises
    ------
    ValueError
        If the window reaches beyond the ends of the bed.
    """
    low, high = bounds(packing, window, reach)
    near = np.flatnonzero(packing.depths - packing.radii < reach)
    spheres = _with_images(packing, near)
    # a sphere that only reaches out of the box (beyond a clipped face) is harmless: no cell takes it
    cells = _cell_counts(high - low, spheres[:, 3])
    size = (high - low) / cells
    starts = np.zeros(int(cells.prod()) + 1, np.int64)
    fill_cells(spheres, low, size, cells, starts, np.empty(0, np.int32))
    np.cumsum(starts, out=starts)
    members = np.empty(int(starts[-1]), np.int32)
    if members.size:
        fill_cells(spheres, low, size, cells, starts, members)
        starts[1:] = starts[:-1].copy()
        starts[0] = 0
    columns = np.empty((4, members.size))
    for row, values in zip(columns, spheres.T, strict=True):
        np.take(values, members, out=row, mode="clip")  # the default mode would go through a buffer
    columns[3] **= 2
    return Scene(packing, reach, low, size, cells, starts, columns, len(near))


def bounds(packing: Packing, window: Window, reach: float) -> tuple[FloatArray, FloatArray]:
    """Corners of the box that holds everything a ray can meet down to `reach`."""
    wall = packing.wall
    low, high = np.zeros(3), np.zeros(3)
    axes: tuple[tuple[int, tuple[float, float] | None], ...]
    match wall:
        case Plate():
            high[2] = reach * PADDING
            axes = ((0, window.axial), (1, window.lateral))
        case Tube() | Rod():
            across = PADDING * (wall.radius if isinstance(wall, Tube) else wall.radius + reach)
            low[:2], high[:2] = -across, across
            axes = ((2, window.axial),)
    for axis, measured in axes:
        if measured is None:
            raise ValueError("the window of a plate needs a lateral range; it is None")
        low[axis], high[axis] = packing.extent(axis)
        if measured[0] < low[axis] or measured[1] > high[axis]:
            raise ValueError(
                f"the window {measured} m along {'xyz'[axis]} reaches beyond the bed, "
                f"which lies between {low[axis]:.6g} and {high[axis]:.6g} m"
            )
    return low, high


def _with_images(packing: Packing, near: NDArray[np.int64]) -> FloatArray:
    """Centres and radii of some spheres, and of their images that reach across a periodic face."""
    images = np.empty((0, 4))
    for axis, period in enumerate(packing.box):
        if not period:
            continue
        shift = np.zeros(4)
        shift[axis] = period
        x, r = packing.centers[near, axis], packing.radii[near]
        below, above = near[x - r < 0.0], near[x + r > period]
        images = np.concatenate([
            images,
            np.column_stack([packing.centers[below], packing.radii[below]]) + shift,
            np.column_stack([packing.centers[above], packing.radii[above]]) - shift,
            images[images[:, axis] - images[:, 3] < 0.0] + shift,
            images[images[:, axis] + images[:, 3] > period] - shift,
        ])  # fmt: skip
    spheres = np.empty((len(near) + len(images), 4))
    spheres[: len(near), :3], spheres[: len(near), 3] = packing.centers[near], packing.radii[near]
    spheres[len(near) :] = images
    return spheres


def _cell_counts(extent: FloatArray, radii: FloatArray) -> NDArray[np.int64]:
    """Number of cells along each axis: near-cubic cells with about `SPHERES_PER_CELL` centres in each filled one."""
    count = max(len(radii), 1)
    volume = float(extent.prod())
    filled = min(1.0, 4.0 / 3.0 * math.pi * float((radii**3).sum()) / 0.6 / volume)
    wanted = count * min(1.0 / (SPHERES_PER_CELL * max(filled, 1e-12)), MOST_CELLS_PER_SPHERE)
    side = math.cbrt(volume / wanted)
    cells = np.maximum(1, np.round(extent / side)).astype(np.int64)
    # flat or needle-like boxes: rounding up to one cell along an axis must not multiply the others
    while cells.prod() > max(2.0 * wanted, 8.0):
        longest = int(np.argmax(cells))
        cells[longest] = (cells[longest] + 1) // 2
    return cells
