"""The box around a bed, for formats that need one."""

from __future__ import annotations

from bedrad.packings.packing import Packing
from bedrad.walls import Tube

__all__ = ["surrounding_box"]


def surrounding_box(packing: Packing) -> list[tuple[float, float]]:
    """Lowest and highest coordinate of a box along x, y and z.

    Parameters
    ----------
    packing : Packing
        The packing.

    Returns
    -------
    list of (float, float)
        (0, period) where the packing is periodic; elsewhere what the spheres reach, and a tube around them. One metre
        where there is nothing to go round. [m]
    """
    ranges = []
    for axis, period in enumerate(packing.box):
        if period:
            ranges.append((0.0, period))
            continue
        spans = [packing.extent(axis)] if len(packing) else []
        if isinstance(packing.wall, Tube) and axis != packing.wall.axial:
            spans.append((-packing.wall.radius, packing.wall.radius))
        low, high = (min(low for low, _ in spans), max(high for _, high in spans)) if spans else (-0.5, 0.5)
        ranges.append((low, high))
    return ranges
