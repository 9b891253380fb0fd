"""The numbers of a flow run: the channel, the times, the steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.contact import (
    STEPS_PER_CONTACT,
    contact_duration,
    effective_mass,
    hertz_duration,
    softened_stiffness,
    softening_rule,
    sphere_mass,
)
from bedrad.packings.grains import Grains, check_number
from bedrad.packings.pouring import count_spheres

__all__ = ["BELT_RATE", "JITTER", "SITE_MARGIN", "SOLID_FRACTION", "Channel", "FlowPlan", "Protocol"]

FloatArray = NDArray[np.float64]

SOLID_FRACTION = 0.6
"""Solid fraction from which the number of spheres follows."""

FUNNEL_ANGLE = 120.0
"""Full angle of the funnel that ends in an orifice: so blunt that spheres slide on spheres, as over a flat floor. The
edge of a flat floor is more than LAMMPS offers: spheres that pass it are thrown. [degree]"""

LATTICE_SPACING = 1.12
"""Spacing of the lattice that the spheres fall from, in diameters of the largest."""

JITTER = 0.05
"""Largest random displacement from the lattice along each axis, in diameters of the largest; they cannot touch."""

SITE_MARGIN = 0.5 + math.sqrt(2.0) * JITTER
"""Distance of a lattice site from the wall at least, in diameters of the largest."""

FLUSH = 20.0
"""Displacement before the first frame, in mean diameters: what the default window then holds came from the hopper."""

START_UP = 6.0
"""Displacement after which the start of the belt is forgotten, in U^2/g: at 0.2 m/s the solid fraction beside a wall
at A = 12.9 rose from 0.28 to 0.41 in 25 mm and stayed there; at 0.11 m/s it took some 8 mm."""

MOST_FRAMES = 1_000_000
"""Frames that a run may have: each is a file."""

BELT_RATE = 0.4
"""Drag of the belt: the share of its velocity error that a sphere loses in a step."""


@dataclass(frozen=True)
class Channel:
    """The channel of a flow: a hopper over a tube; what leaves the tube below falls into the hopper again.

    All lengths are in mean particle diameters but for the hopper's width and level, which are in tube diameters.

    Parameters
    ----------
    tube_length : float
        Length of the tube, the belt included.
    belt : float
        Height of the belt, the lowest piece of the tube, where spheres are dragged at the chosen velocity.
    window : (float, float)
        Range above the belt (or the funnel) in which the flow is measured.
    hopper_width : float
        Diameter of the hopper, in tube diameters; 1 leaves the hopper out.
    hopper_angle : float
        Full angle of the cone between hopper and tube. [degree]
    hopper_level : float
        Height of the spheres in the hopper above the cone, in tube diameters.
    orifice : float or None
        Diameter of the outlet of a blunt funnel at the foot of the tube, in place of the belt. [m]

    Raises
    ------
    ValueError
        If a number is out of range, or the window does not lie in the tube.
    """

    tube_length: float = 30.0
    belt: float = 3.0
    window: tuple[float, float] = (10.0, 22.0)
    hopper_width: float = 1.5
    hopper_angle: float = 60.0
    hopper_level: float = 0.2
    orifice: float | None = None

    def __post_init__(self) -> None:
        for name in ("tube_length", "belt"):
            value = getattr(self, name)
            check_number(name, value, value > 0, "a positive number of diameters")
        for value in self.window:
            check_number("window", value, value >= 0, "numbers of diameters that are not negative")
        low, high = self.window
        if not low < high <= self.tube_length - self.belt:
            raise ValueError(
                f"window is {low:g} to {high:g} diameters above the belt; expected a range within the tube, "
                f"0 to {self.tube_length - self.belt:g}"
            )
        check_number("hopper_width", self.hopper_width, 1 <= self.hopper_width <= 5, "1 to 5 tube diameters")
        check_number("hopper_angle", self.hopper_angle, 10 <= self.hopper_angle <= 160, "10 to 160 degrees")
        check_number("hopper_level", self.hopper_level, self.hopper_level > 0, "a positive number of tube diameters")
        check_number("orifice", self.orifice, self.orifice is None or self.orifice > 0, "a positive number of metres")


@dataclass(frozen=True)
class Protocol:
    """How long a flow runs and what is kept of it.

    Parameters
    ----------
    frames : int
        Number of frames.
    flush : float or None
        Displacement at the chosen velocity before the first frame, in mean diameters; None takes `FLUSH` and
        `START_UP` times U^2/g more, the length over which a fast start dies away.
    spacing : float
        Displacement between two frames, in mean diameters.

    Raises
    ------
    ValueError
        If a number is out of range.
    """

    frames: int = 50
    flush: float | None = None
    spacing: float = 0.5

    def __post_init__(self) -> None:
        whole = isinstance(self.frames, int) and not isinstance(self.frames, bool)
        if not (whole and 2 <= self.frames <= MOST_FRAMES):
            raise ValueError(f"frames is {self.frames!r}; expected an integer from 2 to {MOST_FRAMES}")
        check_number(
            "flush", self.flush, self.flush is None or self.flush >= 0, "a number of diameters that is not negative"
        )
        check_number("spacing", self.spacing, self.spacing > 0, "a positive number of diameters")


@dataclass(frozen=True)
class FlowPlan:
    """The numbers of a flow run, all in SI units.

    Parameters
    ----------
    tube_radius : float
        Inner radius of the tube. [m]
    velocity : float
        Velocity of the belt, or the one Beverloo's law expects of the orifice. [m/s]
    mixture : sequence of (float, float)
        Diameter [m] and number fraction of each size.
    grains : Grains
        Density, contacts and gravity.
    channel : Channel
        The channel.
    protocol : Protocol
        Flush and frames.
    """

    tube_radius: float
    velocity: float
    mixture: tuple[tuple[float, float], ...]
    grains: Grains
    channel: Channel
    protocol: Protocol

    def __str__(self) -> str:
        d, channel, grains = self.mean, self.channel, self.grains
        low, high = self.window
        sizes = (
            f"{d:.6g} m" if len(self.mixture) == 1 else f"{self.smallest:.6g} to {self.largest:.6g} m, mean {d:.6g} m"
        )
        driven = (
            f"belt over the lowest {channel.belt:g} d at {self.velocity:.6g} m/s"
            if channel.orifice is None
            else f"orifice of {channel.orifice:.6g} m; Beverloo's law expects {self.velocity:.4g} m/s in the tube"
        )
        stiffness = (
            f"Young's modulus {grains.youngs_modulus:.4g} Pa, Poisson's ratio {grains.poisson_ratio:g}"
            if grains.youngs_modulus is not None
            else f"springs of {self.stiffness:.6g} N/m, {self.stiffness_rule}"
        )
        rows = {
            "spheres": f"{self.spheres}, {sizes}, {grains.density:g} kg/m3",
            "tube": f"{2.0 * self.tube_radius:.6g} m inner diameter (A = {2.0 * self.tube_radius / d:.4g}), "
            f"{channel.tube_length:g} d long",
            "hopper": "none"
            if channel.hopper_width == 1
            else f"{channel.hopper_width:g} tube diameters wide, cone of {channel.hopper_angle:g} degrees",
            "driven by": driven,
            "measured": f"{1e3 * low:.4g} to {1e3 * high:.4g} mm above the foot of the tube",
            "friction": f"{grains.friction:g}, with the wall {grains.friction_with_wall:g}",
            "contacts": stiffness,
            "time step": f"{self.time_step:.4g} s, {STEPS_PER_CONTACT} in a contact of {self.contact_duration:.4g} s",
            "steps": f"{self.fill_steps} to fill, {self.flush_steps} to flush {self.flush:.3g} d, "
            f"{self.sample_steps} for {self.protocol.frames} frames",
            "work": f"{self.spheres * self.steps / 1e9:.2g}e9 sphere-steps; a core does some 5e6 a second",
        }
        return "\n".join(f"{name:<10} {text}" for name, text in rows.items())

    @property
    def smallest(self) -> float:
        """Smallest diameter. [m]."""
        return min(d for d, _ in self.mixture)

    @property
    def largest(self) -> float:
        """Largest diameter. [m]."""
        return max(d for d, _ in self.mixture)

    @cached_property
    def mean(self) -> float:
        """Number-mean diameter. [m]."""
        return sum(d * share for d, share in self.mixture)

    @property
    def tube_top(self) -> float:
        """Height of the upper end of the tube. [m]."""
        return self.channel.tube_length * self.mean

    @property
    def foot_top(self) -> float:
        """Height of what drives the flow: the upper end of the belt, or of the funnel over an orifice. [m]."""
        if self.channel.orifice is None:
            return self.channel.belt * self.mean
        return (self.tube_radius - self.channel.orifice / 2.0) / math.tan(math.radians(FUNNEL_ANGLE / 2.0))

    @property
    def window(self) -> tuple[float, float]:
        """Heights between which the flow is measured. [m]."""
        low, high = self.channel.window
        foot = self.channel.belt if self.channel.orifice is None else self.foot_top / self.mean
        return (foot + low) * self.mean, (foot + high) * self.mean

    @property
    def hopper_radius(self) -> float:
        """Radius of the hopper. [m]."""
        return self.channel.hopper_width * self.tube_radius

    @property
    def cone_top(self) -> float:
        """Height at which the cone ends and the hopper begins. [m]."""
        half = math.radians(self.channel.hopper_angle / 2.0)
        return self.tube_top + (self.hopper_radius - self.tube_radius) / math.tan(half)

    @property
    def level(self) -> float:
        """Height of the spheres at rest, at a solid fraction of 0.6. [m]."""
        return self.cone_top + self.channel.hopper_level * 2.0 * self.tube_radius

    def radius_at(self, height: float) -> float:
        """Radius of the channel at a height. [m]."""
        if height <= self.tube_top:
            return self.tube_radius
        if height >= self.cone_top:
            return self.hopper_radius
        share = (height - self.tube_top) / (self.cone_top - self.tube_top)
        return self.tube_radius + share * (self.hopper_radius - self.tube_radius)

    @property
    def volume(self) -> float:
        """Volume of the channel up to the level. [m3]."""
        tube, hopper = self.tube_radius, self.hopper_radius
        cone = (self.cone_top - self.tube_top) / 3.0 * (tube * tube + tube * hopper + hopper * hopper)
        return math.pi * (tube * tube * self.tube_top + cone + hopper * hopper * (self.level - self.cone_top))

    @cached_property
    def counts(self) -> list[int]:
        """Number of spheres of each size."""
        return count_spheres(self.mixture, SOLID_FRACTION * self.volume)

    @property
    def spheres(self) -> int:
        """Number of spheres."""
        return sum(self.counts)

    @cached_property
    def sites(self) -> FloatArray:
        """Where the spheres start, (n, 3): a square lattice without contacts, as high as it takes. [m]."""
        spacing = LATTICE_SPACING * self.largest
        reach = math.ceil(self.hopper_radius / spacing)
        steps = spacing * np.arange(-reach, reach + 1)
        across = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        out = np.hypot(across[:, 0], across[:, 1])
        layers, count, height = [], 0, self.largest
        while count < self.spheres:
            inside = across[out <= self.radius_at(height) - SITE_MARGIN * self.largest]
            layers.append(np.column_stack([inside, np.full(len(inside), height)]))
            count += len(inside)
            height += spacing
        return np.concatenate(layers)[: self.spheres]

    @cached_property
    def box_top(self) -> float:
        """Height of the periodic box: room for the lattice that the spheres fall from. [m]."""
        return float(self.sites[-1, 2]) + 2.0 * self.largest

    @property
    def fall(self) -> float:
        """How far a sphere falls that leaves the foot of the tube, onto those in the hopper. [m]."""
        return max(self.box_top - self.level, self.largest)

    @property
    def stiffness(self) -> float:
        """Stiffness of the normal spring; nan for Hertz contacts. [N/m]."""
        grains = self.grains
        if grains.youngs_modulus is not None:
            return math.nan
        if grains.stiffness is not None:
            return float(grains.stiffness)
        return softened_stiffness(self.largest, grains.density, grains.gravity, 2.0 * self.tube_radius, self.fall)

    @property
    def stiffness_rule(self) -> str:
        """Where the stiffness comes from, in words."""
        return "given" if self.grains.stiffness is not None else softening_rule()

    @property
    def contact_duration(self) -> float:
        """Duration of the shortest contact, between two of the smallest spheres. [s]."""
        grains = self.grains
        if grains.youngs_modulus is not None:
            speed = math.sqrt(2.0 * grains.gravity * self.fall)
            return hertz_duration(grains.youngs_modulus, grains.poisson_ratio, self.smallest, grains.density, speed)
        mass = sphere_mass(self.smallest, grains.density)
        return contact_duration(self.stiffness, effective_mass(mass, mass), grains.restitution)

    @property
    def time_step(self) -> float:
        """Time step. [s]."""
        return self.contact_duration / STEPS_PER_CONTACT

    @property
    def frame_steps(self) -> int:
        """Steps between two frames."""
        return max(1, round(self.protocol.spacing * self.mean / self.velocity / self.time_step))

    @property
    def fill_steps(self) -> int:
        """Steps in which the spheres fall from the lattice and come to rest, a multiple of `frame_steps`."""
        # the fall of the highest, and about as long again for the energy to go
        time = 1.5 * math.sqrt(2.0 * self.fall / self.grains.gravity) + 5.0 * math.sqrt(
            self.largest / self.grains.gravity
        )
        return self.frame_steps * math.ceil(time / self.time_step / self.frame_steps)

    @property
    def flush(self) -> float:
        """Displacement before the first frame, in mean diameters."""
        if self.protocol.flush is not None:
            return self.protocol.flush
        return FLUSH + START_UP * self.velocity**2 / (self.grains.gravity * self.mean)

    @property
    def flush_steps(self) -> int:
        """Steps of the flush, a multiple of `frame_steps`."""
        return self.frame_steps * math.ceil(self.flush / self.protocol.spacing - 1e-9)

    @property
    def sample_steps(self) -> int:
        """Steps from the first frame to the last."""
        return self.frame_steps * (self.protocol.frames - 1)

    @property
    def steps(self) -> int:
        """All steps."""
        return self.fill_steps + self.flush_steps + self.sample_steps

    @property
    def frame_numbers(self) -> list[int]:
        """Steps at which a frame is kept."""
        first = self.fill_steps + self.flush_steps
        return [first + k * self.frame_steps for k in range(self.protocol.frames)]
