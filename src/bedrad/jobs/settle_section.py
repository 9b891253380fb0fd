"""The section [packing.settle] of a job."""

from __future__ import annotations

from bedrad.jobs.grains_section import GrainsSection
from bedrad.jobs.layers_section import LayersSection
from bedrad.jobs.section import PositiveLength
from bedrad.walls import Tube, Wall

__all__ = ["SettleSection"]


class SettleSection(GrainsSection):
    """A bed settled by the discrete-element method."""

    height: PositiveLength

    def check_room(self, wall: Wall, layers: LayersSection, *, measured: bool) -> None:
        """Refuse what could only fail after the settling: layers or margins that the bed has no room for."""
        if not measured or not isinstance(wall, Tube):
            return
        sizes = self.sizes or ()
        mean = self.diameter or sum(s.diameter * s.share for s in sizes) / sum(s.share for s in sizes)
        layers.check_depth(mean, wall)
        ends = 2 * layers.margin * mean
        if ends >= self.height:
            raise ValueError(
                f"layers.margin is {layers.margin:g}: leaving out {ends:.4g} m of a bed {self.height:.4g} m "
                "high leaves nothing to measure"
            )
