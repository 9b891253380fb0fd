"""The numbers of a settling run and the LAMMPS input that carries it out."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bedrad.packings.contact import (
    STEPS_PER_CONTACT,
    contact_duration,
    effective_mass,
    softened_stiffness,
    softening_rule,
    sphere_mass,
)
from bedrad.packings.contact_commands import SKIN, linear_contacts
from bedrad.packings.grains import Grains, check_number
from bedrad.packings.pouring import Column
from bedrad.walls import Tube

__all__ = ["AT_REST", "DATA", "DUMP", "SOLID_FRACTION", "SettlePlan", "plan_settling", "settle_script"]

AT_REST = 1e-6
"""Kinetic energy of translation per sphere, in ``m g d``, below which a bed is at rest.

Even if one sphere in five thousand held all of it, it could not climb by a hundredth of its diameter. The
energy of rotation is left out: a sphere that spins or rolls to and fro in place meets no resistance and may
go on for ever.
"""

SOLID_FRACTION = 0.6
"""Solid fraction from which the number of spheres follows; seldom reached beside a wall."""

DATA = "column.data"
DUMP = "settled.dump"

_SAMPLES = 10
"""Samples of the energy in the mean that is compared with `AT_REST`, so that a moment of still is no rest."""


@dataclass(frozen=True)
class SettlePlan:
    """The numbers of a settling run, all in SI units.

    Parameters
    ----------
    tube_radius : float
        Inner radius of the tube. [m]
    spheres : int
        Number of spheres.
    column_height : float
        Height of the loose column that falls. [m]
    smallest, largest, mean : float
        Smallest, largest and number-mean diameter. [m]
    density : float
        Density of the spheres. [kg/m3]
    friction, wall_friction : float
        Coefficient of friction between spheres, and between spheres and wall.
    restitution : float
        Coefficient of restitution of head-on collisions.
    stiffness : float
        Stiffness of the normal spring. [N/m]
    stiffness_rule : str
        Where the stiffness comes from, in words.
    gravity : float
        Acceleration of gravity. [m/s2]
    energy_unit : float
        Sum of ``m g d`` over the spheres. [J]
    fall_time, time_limit : float
        How long the highest sphere falls freely, and when to give up. [s]
    """

    tube_radius: float
    spheres: int
    column_height: float
    smallest: float
    largest: float
    mean: float
    density: float
    friction: float
    wall_friction: float
    restitution: float
    stiffness: float
    stiffness_rule: str
    gravity: float
    energy_unit: float
    fall_time: float
    time_limit: float

    def __str__(self) -> str:
        sizes = f"{self.mean:.6g} m"
        if self.smallest != self.largest:
            sizes = f"{self.smallest:.6g} to {self.largest:.6g} m, {sizes} in the mean"
        rows = {
            "spheres": f"{self.spheres}, {sizes}, {self.density:g} kg/m3",
            "tube": f"{2.0 * self.tube_radius:.6g} m inner diameter, floor at z = 0",
            "loose column": f"{self.column_height:.4g} m tall, falls under {self.gravity:g} m/s2",
            "friction": f"{self.friction:g}, with the wall {self.wall_friction:g}",
            "restitution": f"{self.restitution:g}",
            "normal stiffness": f"{self.stiffness:.6g} N/m, {self.stiffness_rule}",
            "time step": f"{self.time_step:.4g} s, {STEPS_PER_CONTACT} in a contact of {self.contact_duration:.4g} s",
            "steps": f"{self.fall_steps} of the fall, then until at rest, at most {self.settle_steps} more",
            "at rest": f"kinetic energy below {AT_REST:g} m g d a sphere",
        }
        return "\n".join(f"{name:<17} {text}" for name, text in rows.items())

    @property
    def contact_duration(self) -> float:
        """Duration of the shortest contact, between two of the smallest spheres. [s]."""
        mass = sphere_mass(self.smallest, self.density)
        return contact_duration(self.stiffness, effective_mass(mass, mass), self.restitution)

    @property
    def time_step(self) -> float:
        """Time step. [s]."""
        return self.contact_duration / STEPS_PER_CONTACT

    @property
    def check_every(self) -> int:
        """Steps between two looks at the energy: about half of sqrt(d/g), the time scale of the fall."""
        interval = 0.5 * math.sqrt(self.smallest / self.gravity)
        return _SAMPLES * math.ceil(interval / self.time_step / _SAMPLES)

    @property
    def fall_steps(self) -> int:
        """Steps of the fall, a multiple of `check_every`."""
        return self.check_every * math.ceil(self.fall_time / self.time_step / self.check_every)

    @property
    def settle_steps(self) -> int:
        """Most steps after the fall, a multiple of `check_every`."""
        left = self.time_limit / self.time_step - self.fall_steps
        return self.check_every * max(1, math.ceil(left / self.check_every))


def plan_settling(tube: Tube, column: Column, grains: Grains, time_limit: float | None = None) -> SettlePlan:
    """Work out stiffness, times and energies of the fall of a loose column.

    Parameters
    ----------
    tube : Tube
        The tube.
    column : Column
        The loose column.
    grains : Grains
        Density, contacts and gravity.
    time_limit : float, optional
        Simulated time after which to give up; None takes ten times the fall plus a hundred times sqrt(d/g). [s]

    Raises
    ------
    ValueError
        If the time limit is not positive.
    """
    check_number("time_limit", time_limit, time_limit is None or time_limit > 0, "a positive number of seconds")
    d = column.diameters
    settled = float((d**3).sum()) / (6.0 * SOLID_FRACTION * tube.radius**2)
    fall = max(column.height - settled, float(d.max()))
    fall_time = math.sqrt(2.0 * fall / grains.gravity)
    stiffness, rule = grains.stiffness, "given"
    if stiffness is None:
        rule = softening_rule()
        stiffness = softened_stiffness(float(d.max()), grains.density, grains.gravity, 2.0 * tube.radius, fall)
    patience = 10.0 * fall_time + 100.0 * math.sqrt(float(d.max()) / grains.gravity)
    return SettlePlan(
        tube_radius=tube.radius,
        spheres=len(d),
        column_height=column.height,
        smallest=float(d.min()),
        largest=float(d.max()),
        mean=float(d.mean()),
        density=float(grains.density),
        friction=float(grains.friction),
        wall_friction=grains.friction_with_wall,
        restitution=float(grains.restitution),
        stiffness=float(stiffness),
        stiffness_rule=rule,
        gravity=float(grains.gravity),
        energy_unit=float(sphere_mass(1.0, grains.density) * grains.gravity * (d**4).sum()),
        fall_time=fall_time,
        time_limit=patience if time_limit is None else float(time_limit),
    )


def settle_script(plan: SettlePlan) -> str:
    """Write the LAMMPS input: fall, then go on until at rest, then one dump in full precision.

    Parameters
    ----------
    plan : SettlePlan
        The numbers.

    Returns
    -------
    str
        The input; it reads the file `DATA` and writes the file `DUMP`.
    """
    equal = plan.mean if plan.smallest == plan.largest else None
    pair, wall = linear_contacts(
        plan.stiffness, plan.restitution, plan.friction, plan.wall_friction, plan.density, equal
    )
    every, sample = plan.check_every, plan.check_every // _SAMPLES
    return f"""\
# spheres settling in a tube; SI units
units           si
atom_style      sphere
boundary        f f f
newton          off
comm_modify     vel yes
processors      * * 1
read_data       {DATA}

{pair}
neighbor        {SKIN * plan.mean!r} bin
neigh_modify    delay 0 every 1 check yes
timestep        {plan.time_step!r}

region          tube cylinder z 0 0 {plan.tube_radius!r} 0 1e6 open 2
fix             motion all nve/sphere
fix             gravity all gravity {plan.gravity!r} vector 0 0 -1
fix             wall all wall/gran/region {wall} region tube

compute         translation all ke
compute         rotation all erotate/sphere
variable        moving equal c_translation/{plan.energy_unit!r}
variable        spinning equal c_rotation/{plan.energy_unit!r}
thermo          {every}
thermo_style    custom step v_moving v_spinning
thermo_modify   norm no flush yes lost error
run             {plan.fall_steps}

fix             average all ave/time {sample} {_SAMPLES} {every} v_moving
variable        rest equal f_average
fix             halt all halt {every} v_rest < {AT_REST!r} error continue
thermo_style    custom step v_moving v_spinning v_rest
thermo_modify   norm no flush yes lost error
run             {plan.settle_steps}

write_dump      all custom {DUMP} id x y z radius modify sort id format float %.17g
"""
