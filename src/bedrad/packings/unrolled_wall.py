"""The wall unrolled into a plane: where the particles beside it lie, and which of them touch it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.layers import check_edges, check_window
from bedrad.packings.packing import END_MARGIN, Packing
from bedrad.packings.tally import blocks_of
from bedrad.packings.wall_contacts import wall_gaps
from bedrad.walls import Plate, Tube, Wall, Window

__all__ = ["UnrolledWall", "unrolled_wall"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class UnrolledWall:
    """The particles of the wall layer, projected onto the wall along its normal.

    Attributes
    ----------
    spheres : (n,) array
        Numbers of the spheres in the packing.
    height : (n,) array
        Position along the axis (z of a tube or rod, x of a plate). [m]
    angle : (n,) array
        Angle around the axis, from x towards y, in [0, 2 pi); nan at a plate. [rad]
    across : (n,) array
        Position across the axis: the arc on the wall at this angle, or y of a plate. [m]
    radius : (n,) array
        Sphere radius. [m]
    gap : (n,) array
        Gap to the wall, in the sphere's own radii.
    inside : (n,) array of bool
        Whether the centre lies in the window; all do unless an overhang was asked for.
    contact : (n,) array of bool
        Whether the sphere touches the wall; all others have volume in the wall layer without contact (NC).
    half_height, half_width : (n,) arrays
        Half axes along and across of the projection of what lies in the wall layer. [m]
    wall : Tube, Rod or Plate
        The wall.
    window : Window
        The piece of wall.
    period : (float, float)
        Lengths along and across after which everything repeats, 0 where it does not. [m]
    thickness : float
        Thickness of the wall layer. [m]
    contact_gap : float
        Gap, in particle radii, up to which a particle touches the wall.
    """

    spheres: IntArray
    height: FloatArray
    angle: FloatArray
    across: FloatArray
    radius: FloatArray
    gap: FloatArray
    inside: BoolArray
    contact: BoolArray
    half_height: FloatArray
    half_width: FloatArray
    wall: Wall
    window: Window
    period: tuple[float, float]
    thickness: float
    contact_gap: float


def unrolled_wall(
    packing: Packing,
    contact_gap: float = 1e-2,
    thickness: float | None = None,
    window: Window | None = None,
    margin: float = END_MARGIN,
    overhang: float = 0.0,
) -> UnrolledWall:
    """Project the particles of the wall layer onto the wall (as in Watkins 2018, fig. 3.3).

    Parameters
    ----------
    packing : Packing
        The spheres and their wall.
    contact_gap : float
        Gap, in a particle's own radii, up to which it touches the wall.
    thickness : float, optional
        Thickness of the wall layer; half the number-mean diameter where not given. [m]
    window : Window, optional
        The piece of wall; spheres belong to it by their centre. `packing.window(margin)` where not given.
    margin : float
        What that window leaves out at each open end, in mean particle diameters.
    overhang : float
        How far beyond the ends of the window, where the bed does not repeat, spheres are included too: those that
        reach into a picture. [m]

    Returns
    -------
    UnrolledWall
        Positions, sizes and contacts, in the order of the spheres.

    Raises
    ------
    ValueError
        If the packing is empty, a number is out of its range, or the window does not fit.
    """
    if not len(packing):
        raise ValueError("the packing is empty; there is nothing to unroll")
    if not (math.isfinite(contact_gap) and contact_gap >= 0.0):
        raise ValueError(f"contact_gap is {contact_gap}; expected a number of radii, zero or more")
    wall = packing.wall
    if not (math.isfinite(overhang) and overhang >= 0.0):
        raise ValueError(f"overhang is {overhang} m; expected a length, zero or more")
    near = float(check_edges([0.0, 0.5 * packing.mean_diameter if thickness is None else thickness], wall)[1])
    piece = check_window(packing, window, margin)
    gaps, depths = wall_gaps(packing), packing.depths
    belongs = (depths - packing.radii < near) | (gaps <= contact_gap)
    inside = blocks_of(packing, piece, 1) >= 0
    spheres = np.flatnonzero((blocks_of(packing, _wider(packing, piece, overhang), 1) >= 0) & belongs)
    centers, radius, depth = packing.centers[spheres], packing.radii[spheres], depths[spheres]
    # the widest section within the layer: at the centre, or where a sphere deeper than that leaves the layer
    half_height = np.sqrt(np.maximum(radius**2 - np.maximum(depth - near, 0.0) ** 2, 0.0))
    if isinstance(wall, Plate):
        angle, across, half_width = np.full(len(spheres), math.nan), centers[:, 1], half_height
        if piece.lateral is not None:
            across = _in_window(across, piece.lateral[0], packing.box[1])
    else:
        angle = np.mod(np.arctan2(centers[:, 1], centers[:, 0]), 2.0 * math.pi)
        across = wall.radius * angle
        # seen from the axis, a section of this half width at this distance covers this arc of the wall
        radial = wall.radius + np.minimum(depth, near) * (-1.0 if isinstance(wall, Tube) else 1.0)
        half_width = wall.radius * np.arctan2(half_height, radial)
    columns = {
        "spheres": spheres,
        "height": _in_window(centers[:, wall.axial], piece.axial[0], packing.box[wall.axial]),
        "angle": angle,
        "across": across,
        "radius": radius,
        "gap": gaps[spheres],
        "inside": inside[spheres],
        "contact": gaps[spheres] <= contact_gap,
        "half_height": half_height,
        "half_width": half_width,
    }
    for column in columns.values():
        column.setflags(write=False)
    around = packing.box[1] if isinstance(wall, Plate) else 2.0 * math.pi * wall.radius
    period = (packing.box[wall.axial], around)
    return UnrolledWall(
        **columns, wall=wall, window=piece, period=period, thickness=near, contact_gap=float(contact_gap)
    )


def _wider(packing: Packing, window: Window, overhang: float) -> Window:
    """The window with an overhang at the ends where the bed does not repeat."""
    low, high = window.axial
    beyond = 0.0 if packing.box[packing.wall.axial] else overhang
    lateral = window.lateral
    if lateral is not None and not packing.box[1]:
        lateral = (lateral[0] - overhang, lateral[1] + overhang)
    return Window((low - beyond, high + beyond), lateral)


def _in_window(x: FloatArray, low: float, period: float) -> FloatArray:
    """Positions in the window, which may lie anywhere along a period."""
    return low + np.mod(x - low, period) if period else np.array(x)
