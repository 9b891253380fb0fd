"""The section [layers] of a job."""

from __future__ import annotations

from bedrad.jobs.section import Count, NotNegative, Section
from bedrad.walls import Tube

__all__ = ["LayersSection"]


class LayersSection(Section):
    """How the bed is cut: a wall layer one radius deep, the others one diameter deep."""

    count: Count = 3
    margin: NotNegative = 4.0

    def check_depth(self, diameter: float, wall: Tube) -> None:
        """Refuse layers of spheres of this diameter [m] that end beyond the axis."""
        deepest = (self.count - 0.5) * diameter
        if deepest > wall.radius:
            raise ValueError(
                f"layers.count is {self.count}: the last layer would end {deepest:.4g} m deep, beyond the axis "
                f"of the tube at {wall.radius:.4g} m"
            )
