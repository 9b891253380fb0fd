"""The section [packing.settle] of a job."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from bedrad.jobs.layers_section import LayersSection
from bedrad.jobs.section import BelowOne, NotNegative, Positive, PositiveInt, PositiveLength, Section
from bedrad.jobs.units import Density, Stiffness
from bedrad.walls import Tube, Wall

__all__ = ["SettleSection", "Size"]


class Size(Section):
    """One size of a size distribution."""

    diameter: PositiveLength
    share: Positive


class SettleSection(Section):
    """A bed settled by the discrete-element method."""

    height: PositiveLength
    diameter: PositiveLength | None = None
    sizes: Annotated[tuple[Size, ...], Field(max_length=100)] | None = None
    density: Annotated[Density, Field(gt=0)] = 3800.0
    friction: NotNegative = 0.4
    wall_friction: NotNegative | None = None
    restitution: BelowOne = 0.85
    stiffness: Annotated[Stiffness, Field(gt=0)] | None = None
    ranks: PositiveInt = 1

    @model_validator(mode="after")
    def _check_sizes(self) -> SettleSection:
        if (self.diameter is None) == (self.sizes is None) or self.sizes == ():
            raise ValueError("give a diameter or sizes, one of the two")
        return self

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
