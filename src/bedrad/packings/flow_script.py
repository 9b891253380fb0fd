"""The LAMMPS input of a flow run: fill, flush, frames; from the start or from where an earlier run was cut off."""

from __future__ import annotations

import numpy as np

from bedrad.packings.contact import sphere_mass
from bedrad.packings.contact_commands import SKIN, hertz_contacts, linear_contacts
from bedrad.packings.flow_plan import BELT_RATE, JITTER, FlowPlan
from bedrad.packings.pouring import Column

__all__ = [
    "COLUMNS",
    "DATA",
    "NEAR",
    "REFRESH",
    "REST",
    "RESTART",
    "REST_COLUMNS",
    "fill_data",
    "flow_script",
    "frame_name",
    "restart_every",
]

DATA = "lattice.data"
REST = "rest.dump"
RESTART = "flow.restart"

COLUMNS = "id x y z radius vx vy vz f_tube[2] f_tube[3] f_tube[4]"
"""Columns of a frame; the last three are the force of the tube's wall on the sphere. [m, m/s, N]"""

REST_COLUMNS = "id x y z radius"
"""Columns of the spheres at rest. [m]"""

_RESTARTS = 20
"""Restart files that a run writes at least, so that one cut off loses a twentieth at most."""

REFRESH = 50
"""Steps between two looks at which spheres are near a wall or the belt, the only ones that it is computed for.

Computing every wall for every sphere takes up to half of a run. Dynamic groups would do the same, but fix wall/gran
refuses them.
"""

NEAR = 0.7
"""What counts as near beyond touching, in largest diameters; none goes that far in `REFRESH` steps."""


def frame_name(step: int | str) -> str:
    """Name of the file of a frame."""
    return f"frame.{step}.dump"


def restart_every(plan: FlowPlan) -> int:
    """Steps between two restart files, a multiple of the steps between two frames."""
    return plan.frame_steps * max(1, plan.steps // _RESTARTS // plan.frame_steps)


def fill_data(plan: FlowPlan, seed: int) -> str:
    """Text of the LAMMPS data file: spheres near a lattice, displaced and shuffled by a seed."""
    rng = np.random.default_rng(seed)
    diameters = np.repeat([d for d, _ in plan.mixture], plan.counts)
    rng.shuffle(diameters)
    jitter = JITTER * plan.largest * rng.uniform(-1.0, 1.0, (plan.spheres, 3))
    column = Column(plan.sites + jitter, diameters, plan.box_top)
    return column.data_file(plan.grains.density, plan.largest, plan.box_top)


def flow_script(plan: FlowPlan, resume_at: int | None = None) -> str:
    """Write the LAMMPS input.

    Parameters
    ----------
    plan : FlowPlan
        The numbers.
    resume_at : int, optional
        Step of the restart file to go on from; None starts with the fill.

    Returns
    -------
    str
        The input; it reads `DATA` or a restart file, and writes `REST`, restart files and a file for every frame.
    """
    return "".join((_head(plan, resume_at), _channel(plan), _runs(plan, resume_at or 0)))


def _head(plan: FlowPlan, resume_at: int | None) -> str:
    pair, _ = _contacts(plan)
    start = f"read_data       {DATA}\n" if resume_at is None else f"read_restart    {RESTART}.{resume_at}\n"
    atoms = "atom_style      sphere\nboundary        f f p\n" if resume_at is None else ""
    return f"""\
# dense flow in a tube under a hopper; SI units
units           si
{atoms}newton          off
comm_modify     vel yes
processors      1 1 *
{start}
{pair}
neighbor        {SKIN * plan.mean!r} bin
neigh_modify    delay 0 every 1 check yes
timestep        {plan.time_step!r}

"""


def _contacts(plan: FlowPlan) -> tuple[str, str]:
    """Commands of the contacts between spheres, and the style of those with the wall."""
    grains = plan.grains
    shared = grains.restitution, grains.friction, grains.friction_with_wall
    if grains.youngs_modulus is not None:
        return hertz_contacts(grains.youngs_modulus, grains.poisson_ratio, *shared)
    equal = plan.mean if len(plan.mixture) == 1 else None
    return linear_contacts(plan.stiffness, *shared, grains.density, equal)


def _channel(plan: FlowPlan) -> str:
    """Walls, gravity, motion, and what drives the flow."""
    beyond = 10.0 * plan.largest
    _, wall = _contacts(plan)
    tube, hopper, top, cone = plan.tube_radius, plan.hopper_radius, plan.tube_top, plan.cone_top
    end = f"{plan.box_top + beyond!r} open 1 open 2"
    parts = ""
    if plan.channel.hopper_width > 1.0:
        parts = f"""\
region          cone cone z 0 0 {tube!r} {hopper!r} {top!r} {cone!r} open 1 open 2
region          hopper cylinder z 0 0 {hopper!r} {cone!r} {end}
fix             cone near_cone wall/gran/region {wall} region cone
fix             hopper near_hopper wall/gran/region {wall} region hopper
"""
        end = f"{top!r} open 1 open 2"
    low, high = plan.window
    return f"""\
{_near(plan)}
fix             motion all nve/sphere
fix             gravity all gravity {plan.grains.gravity!r} vector 0 0 -1
region          tube cylinder z 0 0 {tube!r} {-beyond!r} {end}
fix             tube near_tube wall/gran/region {wall} region tube contacts
{parts}{_drive(plan, wall)}
region          inside cylinder z 0 0 {tube!r} 0 {top!r}
region          window cylinder z 0 0 {tube!r} {low!r} {high!r}
"""


def _groups(plan: FlowPlan) -> list[str]:
    """Names of the groups of spheres near a part of the channel; the regions are called the same."""
    names = ["near_tube", "near_foot"]
    return names if plan.channel.hopper_width == 1.0 else [*names, "near_cone", "near_hopper"]


def _near(plan: FlowPlan) -> str:
    """Regions near the parts of the channel, and the groups of spheres in them."""
    reach = NEAR * plan.largest
    inner, outer = plan.tube_radius - 0.5 * plan.largest - reach, plan.hopper_radius - 0.5 * plan.largest - reach
    top, cone, foot = plan.tube_top, plan.cone_top, plan.foot_top + 0.5 * plan.largest + reach
    hopper = plan.channel.hopper_width > 1.0
    text = "\n".join(
        f"region          {name}_side {shape}\n"
        f"region          {name}_range block EDGE EDGE EDGE EDGE {low} {high}\n"
        f"region          {name} intersect 2 {name}_side {name}_range"
        for name, shape, low, high in (
            ("near_tube", _outside(inner), "EDGE", f"{top + reach!r}" if hopper else "EDGE"),
            ("near_cone", _outside(inner), f"{top - reach!r}", f"{cone + reach!r}"),
            ("near_hopper", _outside(outer), f"{cone - reach!r}", "EDGE"),
        )
        if name in _groups(plan)
    )
    text += f"\nregion          near_foot block EDGE EDGE EDGE EDGE EDGE {foot!r}\n"
    return text + "".join(f"group           {name} region {name}\n" for name in _groups(plan))


def _outside(radius: float) -> str:
    """Region of what lies further from the axis than a radius; everything where that is not positive."""
    if radius <= 0.0:
        return "block EDGE EDGE EDGE EDGE EDGE EDGE"
    return f"cylinder z 0 0 {radius!r} EDGE EDGE side out"


def _drive(plan: FlowPlan, wall: str) -> str:
    """The belt, or a funnel over a floor that goes when the channel is full."""
    if plan.channel.orifice is None:
        return f"""\
region          belt cylinder z 0 0 {plan.tube_radius!r} 0 {plan.foot_top!r}
variable        speed equal 0.0
variable        drag atom -{BELT_RATE / plan.time_step!r}*mass*(vz+v_speed)
fix             belt near_foot addforce 0 0 v_drag region belt
"""
    far, tube, outlet = 2.0 * plan.hopper_radius, plan.tube_radius, plan.channel.orifice / 2.0
    # the other sides of the box that stands on the floor are out of reach; open sides would open the floor too
    return f"""\
region          above block {-far!r} {far!r} {-far!r} {far!r} 0 {plan.box_top + far!r}
region          funnel cone z 0 0 {outlet!r} {tube!r} 0 {plan.foot_top!r} open 1 open 2
fix             funnel near_foot wall/gran/region {wall} region funnel
fix             floor near_foot wall/gran/region {wall} region above
"""


def _runs(plan: FlowPlan, done: int) -> str:
    """Fill, flush and sample, each only as far as it is not done."""
    weight = sum(count * d**4 for count, (d, _) in zip(plan.counts, plan.mixture, strict=True))
    energy = sphere_mass(1.0, plan.grains.density) * plan.grains.gravity * weight
    text = f"""\
variable        velocity equal vcm(all,z,window)
variable        moving equal ke(all)/{energy!r}
thermo          {max(1, plan.steps // 400)}
thermo_style    custom step v_velocity v_moving
thermo_modify   norm no flush yes lost error
restart         {restart_every(plan)} {RESTART}.*
"""
    again = " ".join(f'"group {name} clear" "group {name} region {name}"' for name in _groups(plan))
    every = f"upto every {REFRESH} {again}"
    if done < plan.fill_steps:
        text += f"""
run             {plan.fill_steps} {every}
write_dump      all custom {REST} {REST_COLUMNS} modify region inside sort id format float %.17g
"""
    if plan.channel.orifice is None:
        text += f"\nvariable        speed equal {plan.velocity!r}\n"
    else:
        text += "\nunfix           floor\n"
    flushed = plan.fill_steps + plan.flush_steps
    if done < flushed:
        text += f"run             {flushed} {every}\n"
    return (
        text
        + f"""
dump            frames all custom {plan.frame_steps} {frame_name("*")} {COLUMNS}
dump_modify     frames region inside sort id format float %.17g
run             {plan.steps} {every}
"""
    )
