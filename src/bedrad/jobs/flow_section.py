"""The section [packing.flow] of a job: frames of a flow at a set velocity, measured as one bed that renews itself."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from bedrad.jobs.grains_section import GrainsSection
from bedrad.jobs.layers_section import LayersSection
from bedrad.jobs.section import (
    FieldError,
    NotNegative,
    Positive,
    PositiveLength,
    PositiveVelocity,
    Section,
)
from bedrad.jobs.units import Pressure
from bedrad.packings.flow import plan_flow
from bedrad.packings.flow_plan import Channel, FlowPlan
from bedrad.walls import Tube, Wall

__all__ = ["FlowSection"]

LONGEST_TUBE = 10_000.0
"""Tubes longer than this are refused, in mean diameters."""

MOST_SPHERES = 1_000_000
"""Spheres in the channel: a flow of so many takes weeks."""

MOST_FRAMES = 10_000
"""Frames of a flow that a job may ask for: all of them are in memory at once."""


class ChannelSection(Section):
    """The channel; lengths in mean particle diameters, those of the hopper in tube diameters."""

    tube_length: Annotated[Positive, Field(le=LONGEST_TUBE)] = 30.0
    belt: Positive = 3.0
    window: tuple[NotNegative, NotNegative] = (10.0, 22.0)
    hopper_width: Annotated[Positive, Field(ge=1, le=5)] = 1.5
    hopper_angle: Annotated[Positive, Field(ge=10, le=160)] = 60.0
    hopper_level: Annotated[Positive, Field(le=100)] = 0.2
    orifice: PositiveLength | None = None


class FlowSection(GrainsSection):
    """Frames of a dense flow down a tube, by the discrete-element method."""

    velocity: PositiveVelocity | None = None
    frames: Annotated[int, Field(ge=2, le=MOST_FRAMES, strict=True)] = 50
    spacing: Positive = 0.5
    flush: NotNegative | None = None
    youngs_modulus: Annotated[Pressure, Field(gt=0)] | None = None
    poisson_ratio: Annotated[NotNegative, Field(lt=0.5)] = 0.3
    channel: ChannelSection = ChannelSection()

    def arguments(self) -> dict[str, Any]:
        """What `bedrad.flow` and `plan_flow` are given beside the wall; ValueError where no channel is meant."""
        own = ("velocity", "frames", "spacing", "flush", "youngs_modulus", "poisson_ratio")
        channel = Channel(**self.channel.model_dump())
        return self.grains() | {name: getattr(self, name) for name in own} | {"channel": channel}

    def plan(self, wall: Wall) -> FlowPlan:
        """The numbers of the run; ValueError where none can be made of them."""
        return plan_flow(wall, **self.arguments())

    def check_room(self, wall: Wall, layers: LayersSection, *, measured: bool) -> None:
        """Refuse a flow that cannot be planned, and layers that the tube has no room for."""
        try:
            plan = self.plan(wall)
            if plan.spheres > MOST_SPHERES:
                raise ValueError(f"the channel holds {plan.spheres:,} spheres; expected at most {MOST_SPHERES:,}")
        except ValueError as error:
            raise FieldError("packing.flow", str(error)) from None
        if measured and isinstance(wall, Tube):
            layers.check_depth(plan.mean, wall)
