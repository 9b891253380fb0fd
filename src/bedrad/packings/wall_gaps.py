"""The gap between the wall and every particle beside it, as plain arrays for models that take them one by one."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.layers import block_count, check_edges, check_window
from bedrad.packings.packing import END_MARGIN, Packing
from bedrad.packings.tally import blocks_of
from bedrad.packings.wall_contacts import wall_gaps
from bedrad.walls import Plate, Tube, Wall, Window

__all__ = ["ParticlesAtWall", "particles_at_wall"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ParticlesAtWall:
    """The particles that reach into the wall layer, and the piece of wall that they belong to.

    Attributes
    ----------
    spheres : (n,) array
        Numbers of the particles in the packing.
    gaps : (n,) array
        Gap between wall and surface, in the particle's own radii; negative where it overlaps the wall.
    diameters : (n,) array
        Particle diameters. [m]
    groups : (n,) array
        Block along the axis that the centre lies in, from 0.
    wall_area : float
        Area of the wall in the window. [m2]
    group_areas : (blocks,) array
        Area of each block, all equal. [m2]
    layer_thickness : float
        Depth of the wall layer. [m]
    wall_diameter : float
        Inner diameter of a tube; infinite for a plate; nan for a rod, for which no heat model of the wall layer is
        known. [m]
    wall : Tube, Rod or Plate
        The wall.
    window : Window
        The piece of wall.
    """

    spheres: IntArray
    gaps: FloatArray
    diameters: FloatArray
    groups: IntArray
    wall_area: float
    group_areas: FloatArray
    layer_thickness: float
    wall_diameter: float
    wall: Wall
    window: Window

    def __len__(self) -> int:
        return len(self.gaps)

    def __str__(self) -> str:
        return (
            f"{len(self)} particles within {self.layer_thickness * 1e6:.4g} um of {self.wall_area * 1e6:.5g} mm2 of "
            f"wall ({self.wall.kind}), in {len(self.group_areas)} blocks"
        )


def particles_at_wall(
    packing: Packing,
    window: Window | None = None,
    layer_thickness: float | None = None,
    blocks: int | None = None,
    margin: float = END_MARGIN,
) -> ParticlesAtWall:
    """Gaps, sizes and blocks of the particles that reach into the wall layer.

    Particles belong to the window and to a block by their centre, the upper end excluded, as in `statistics`: counts
    and the area they belong to fit each other, whatever the ends of the window cut.

    Parameters
    ----------
    packing : Packing
        The spheres and their wall.
    window : Window, optional
        The piece of wall; `packing.window(margin)` where not given.
    layer_thickness : float, optional
        Depth of the wall layer; half the number-mean diameter where not given. [m]
    blocks : int, optional
        Number of blocks of equal length along the axis; as many as `layers.block_count` says where not given.
    margin : float
        What that window leaves out at each open end, in mean particle diameters.

    Returns
    -------
    ParticlesAtWall
        Plain arrays, in the order of the spheres.

    Raises
    ------
    ValueError
        If the packing is empty, no particle of the window reaches into the layer, a number is out of its range, or the
        window does not fit.
    """
    if not len(packing):
        raise ValueError("the packing is empty; there are no particles at its wall")
    if blocks is not None and blocks < 1:
        raise ValueError(f"blocks is {blocks}; expected at least 1")
    wall = packing.wall
    thickness = 0.5 * packing.mean_diameter if layer_thickness is None else layer_thickness
    near = float(check_edges([0.0, thickness], wall)[1])
    piece = check_window(packing, window, margin)
    parts = block_count(packing, piece) if blocks is None else blocks
    block = blocks_of(packing, piece, parts)
    spheres = np.flatnonzero((block >= 0) & (packing.depths - packing.radii < near))
    if not spheres.size:
        raise ValueError(f"no sphere with its centre in {piece} reaches within {near:g} m of the wall")
    area = wall.area(piece)
    diameter = 2.0 * wall.radius if isinstance(wall, Tube) else math.inf if isinstance(wall, Plate) else math.nan
    found = ParticlesAtWall(
        spheres=spheres,
        gaps=wall_gaps(packing)[spheres],
        diameters=2.0 * packing.radii[spheres],
        groups=block[spheres],
        wall_area=area,
        group_areas=np.full(parts, area / parts),
        layer_thickness=near,
        wall_diameter=diameter,
        wall=wall,
        window=piece,
    )
    for array in (found.spheres, found.gaps, found.diameters, found.groups, found.group_areas):
        array.setflags(write=False)
    return found
