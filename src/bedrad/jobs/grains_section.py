"""What the sections of beds that are made share: the spheres, and how they meet."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from bedrad.jobs.section import BelowOne, NotNegative, Positive, PositiveInt, PositiveLength, Section
from bedrad.jobs.units import Density, Stiffness

__all__ = ["GrainsSection"]


class Size(Section):
    """One size of a size distribution."""

    diameter: PositiveLength
    share: Positive


class GrainsSection(Section):
    """Spheres, their contacts, and the processes that compute them."""

    diameter: PositiveLength | None = None
    sizes: Annotated[tuple[Size, ...], Field(max_length=100)] | None = None
    density: Annotated[Density, Field(gt=0)] = 3800.0
    friction: NotNegative = 0.4
    wall_friction: NotNegative | None = None
    restitution: BelowOne = 0.85
    stiffness: Annotated[Stiffness, Field(gt=0)] | None = None
    ranks: PositiveInt = 1

    @model_validator(mode="after")
    def _check_sizes(self) -> Self:
        if (self.diameter is None) == (self.sizes is None) or self.sizes == ():
            raise ValueError("give a diameter or sizes, one of the two")
        return self

    def grains(self) -> dict[str, Any]:
        """What `bedrad.settle` and `bedrad.flow` are both given of them, beside the ranks."""
        alike = ("diameter", "density", "friction", "wall_friction", "restitution", "stiffness")
        sizes = None if self.sizes is None else [(size.diameter, size.share) for size in self.sizes]
        return {name: getattr(self, name) for name in alike} | {"sizes": sizes}
