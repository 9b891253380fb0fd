"""The points of the flow study: the matrix of Watkins 2018, Table 3.1, and what is varied around one of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from bedrad.packings.contact import STEPS_PER_CONTACT
from bedrad.packings.flow_plan import FLUSH, START_UP, Channel

__all__ = ["FRAMES", "MATRIX", "POINTS", "REFERENCE", "VARIATIONS", "Point"]

CONFIGURATIONS = [(tube, diameter) for tube in (7.75e-3, 10.92e-3) for diameter in (600e-6, 450e-6, 300e-6)]
"""Tube and particle diameter. [m]"""

SPACINGS = {0.02: 0.5, 0.0356: 0.5, 0.0632: 0.67, 0.1125: 0.83, 0.2: 1.0}
"""Velocity of the belt, in equal steps of its logarithm [m/s], and displacement between frames, in diameters."""

FRAMES = 31

SEEDS = (1, 2)

REFERENCE = (7.75e-3, 600e-6)
"""The configuration around which contacts, feed and sampling are varied."""

VARIATION_VELOCITY = 0.1125


@dataclass(frozen=True)
class Point:
    """One run.

    Parameters
    ----------
    tube, diameter, velocity : float
        Tube and particle diameter [m] and velocity of the belt [m/s].
    seed : int
        Seed of the start.
    variation : str
        What differs from the matrix; "" for a point of the matrix.
    options : mapping
        Arguments of `bedrad.flow` that differ, and `steps_per_contact`, which it does not leave to its callers.
    """

    tube: float
    diameter: float
    velocity: float
    seed: int
    variation: str = ""
    options: dict[str, Any] = field(default_factory=dict)

    @property
    def steps_per_contact(self) -> int:
        """Time steps in a contact."""
        return int(self.options.get("steps_per_contact", STEPS_PER_CONTACT))

    @property
    def name(self) -> str:
        """Name of the point and of the folder that it runs in."""
        parts = [f"D{1e3 * self.tube:.4g}", f"d{1e6 * self.diameter:.4g}", f"U{self.velocity:.4g}", f"s{self.seed}"]
        return "_".join([*parts, *([self.variation.replace(",", "").replace(" ", "-")] if self.variation else [])])

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of `bedrad.flow` besides the wall."""
        channel = {k: v for k, v in self.options.items() if k in _OF_CHANNEL}
        others = {k: v for k, v in self.options.items() if k not in {*_OF_CHANNEL, "steps_per_contact"}}
        return {
            "diameter": self.diameter, "velocity": self.velocity, "frames": FRAMES, "seed": self.seed,
            "spacing": SPACINGS[self.velocity], "channel": Channel(**channel), **others,
        }  # fmt: skip

    @property
    def cost(self) -> float:
        """Sphere-steps, up to a factor."""
        ratio = self.tube / self.diameter
        d, length = 1e3 * self.diameter, self.options.get("tube_length", 30.0)
        flush = self.options.get("flush", FLUSH + _start_up(self.velocity, self.diameter))
        displacement = flush + 30.0 * SPACINGS[self.velocity]
        steps = (10.0 / d**0.5 + displacement / self.velocity / 40.0) * self.steps_per_contact / STEPS_PER_CONTACT
        return ratio**2 * (length + 1.14 * ratio) * steps * (self.options.get("stiffness", 100.0) / 100.0) ** 0.5


def _start_up(velocity: float, diameter: float) -> float:
    """What `bedrad.flow` flushes beyond its 20 diameters, in diameters."""
    return START_UP * velocity**2 / (9.81 * diameter)


_OF_CHANNEL = {"tube_length", "window", "hopper_width", "hopper_angle", "hopper_level"}

VARIED = (
    ("stiffness x 4", {"stiffness": 400.0}),
    ("stiffness x 16", {"stiffness": 1600.0}),
    ("Hertz contacts, 10 MPa", {"youngs_modulus": 1e7}),
    ("half the time step", {"steps_per_contact": 2 * STEPS_PER_CONTACT}),
    ("restitution 0.5", {"restitution": 0.5}),
    ("wall friction 0", {"wall_friction": 0.0}),
    ("wall friction 0.1", {"wall_friction": 0.1}),
    ("wall friction 0.2", {"wall_friction": 0.2}),
    ("wall friction 0.6", {"wall_friction": 0.6}),
    ("friction 0.2", {"friction": 0.2}),
    ("friction 0.6", {"friction": 0.6}),
    ("no hopper", {"hopper_width": 1.0, "hopper_level": 1.0}),
    ("hopper 1.25 D", {"hopper_width": 1.25}),
    ("hopper 2 D", {"hopper_width": 2.0}),
    ("hopper level 0.6 D", {"hopper_level": 0.6}),
    ("hopper angle 120", {"hopper_angle": 120.0}),
    ("tube 60 d, near the hopper", {"tube_length": 60.0, "window": (40.0, 52.0)}),
    ("tube 60 d, near the belt", {"tube_length": 60.0}),
    ("flush 40 d", {"flush": 2.0 * FLUSH + _start_up(VARIATION_VELOCITY, REFERENCE[1])}),
)
"""What is varied around the reference, one thing at a time."""

MATRIX = [
    Point(tube, diameter, velocity, seed)
    for tube, diameter in CONFIGURATIONS
    for velocity in SPACINGS
    for seed in SEEDS
]

VARIATIONS = [
    *(
        Point(*REFERENCE, VARIATION_VELOCITY, seed, variation, options)
        for variation, options in VARIED
        for seed in SEEDS
    ),
    *(
        Point(*REFERENCE, velocity, 1, f"wall friction {friction:g}", {"wall_friction": friction})
        for friction in (0.1, 0.2)
        for velocity in (0.0356, 0.2)
    ),
]

POINTS = sorted([*MATRIX, *VARIATIONS], key=lambda point: point.cost * (1.0 if point.seed == 1 else 3.0))
"""All points, the cheapest first and second seeds later, so that a study that is cut short spans most of the matrix."""
