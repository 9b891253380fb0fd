"""Putting the numbers of a flow run together, and refusing those that no run can be made of."""

from __future__ import annotations

import math

from bedrad.packings.flow_formulas import beverloo_discharge
from bedrad.packings.flow_plan import SITE_MARGIN, SOLID_FRACTION, Channel, FlowPlan, Protocol
from bedrad.packings.grains import Grains, Mixture, check_number
from bedrad.walls import Tube

__all__ = ["plan_flowing"]

MOST_SPHERES = 10_000_000
"""Spheres that a run may have: their start is a text of a gigabyte, and a core moves all of them once in 2 s."""

MOST_STEPS = 2**31 - 1
"""Steps that LAMMPS takes in one run."""

LONGEST_WAY = 0.25
"""Way of a sphere at the mean velocity in the shortest contact, in diameters of the largest: in the 50 steps between
two looks at which spheres are near a wall it then goes 0.63, and what is near begins 0.7 from touching."""


def plan_flowing(
    tube: Tube, mixture: Mixture, velocity: float | None, grains: Grains, channel: Channel, protocol: Protocol
) -> FlowPlan:
    """Put the numbers of a flow run together.

    Raises
    ------
    ValueError
        If not just one of a velocity and an orifice is given, the velocity is not positive, the orifice is as wide as
        the tube or too narrow for the spheres to pass, the window ends above the tube or so close to an end that
        spheres pass it between two frames, or the run would be too large, too long or too fast for its contacts.
    """
    if (velocity is None) == (channel.orifice is None):
        both = "both were given" if velocity is not None else "neither was given"
        raise ValueError(f"velocity and orifice: {both}; expected one of them")
    if velocity is not None:
        check_number("velocity", velocity, velocity > 0, "a positive number of m/s")
    try:
        if velocity is None:
            velocity = _orifice_velocity(tube, mixture, grains, channel)
        plan = FlowPlan(tube.radius, float(velocity), tuple(mixture), grains, channel, protocol)
        _check_window(plan)
        _check_size(plan)
    except (OverflowError, ZeroDivisionError) as error:
        raise ValueError(
            f"a flow cannot be planned with lengths, velocities or contacts of such magnitude: {error}"
        ) from error
    return plan


def _check_window(plan: FlowPlan) -> None:
    """Refuse a window that leaves the tube, or that the frames do not follow all spheres through."""
    channel, spacing = plan.channel, plan.protocol.spacing
    if plan.window[1] > plan.tube_top:
        raise ValueError(
            f"window ends {channel.window[1]:g} diameters above a funnel that is {plan.foot_top / plan.mean:.3g} high; "
            f"expected an end within the tube of {channel.tube_length:g} diameters"
        )
    # a sphere's speed counts where it is half-way between two frames, if both hold it: were the way out of the tube
    # shorter than half of its way, the fast ones would be missed; so much room does for twice the velocity planned
    room = min(plan.window[0], plan.tube_top - plan.window[1]) / plan.mean
    if spacing > room * (1.0 + 1e-9):
        raise ValueError(
            f"spacing is {spacing:g} diameters, and the window ends {room:.4g} from an end of the tube; expected a "
            "spacing that is no longer, so that no sphere passes unseen between two frames"
        )


def _check_size(plan: FlowPlan) -> None:
    """Refuse a run without room for its spheres, too large, too long, or too fast for its contacts."""
    if plan.hopper_radius < SITE_MARGIN * plan.largest:
        raise ValueError(
            f"a channel of {2.0 * plan.hopper_radius:.6g} m is too narrow to fill with spheres of "
            f"{plan.largest:.6g} m; expected at least {2.0 * SITE_MARGIN * plan.largest:.6g} m"
        )
    if plan.spheres > MOST_SPHERES:
        raise ValueError(f"the channel holds {plan.spheres:.3g} spheres; expected at most {MOST_SPHERES}")
    way = plan.velocity * plan.contact_duration / plan.largest
    if way > LONGEST_WAY:
        raise ValueError(
            f"at {plan.velocity:.4g} m/s a sphere goes {way:.3g} diameters in a contact of "
            f"{plan.contact_duration:.3g} s; expected at most {LONGEST_WAY:g}: stiffer contacts are shorter"
        )
    if plan.steps > MOST_STEPS:
        raise ValueError(
            f"the run takes {float(plan.steps):.3g} steps; expected at most {MOST_STEPS}: fewer frames, a smaller "
            "spacing or flush, or softer contacts take fewer"
        )


def _orifice_velocity(tube: Tube, mixture: Mixture, grains: Grains, channel: Channel) -> float:
    """Mean velocity in the tube that Beverloo's law expects. [m/s]."""
    hole, mean = float(channel.orifice or 0.0), sum(d * share for d, share in mixture)
    largest = max(d for d, _ in mixture)
    if not 2.0 * largest < hole < 2.0 * tube.radius:
        raise ValueError(
            f"orifice is {hole!r} m; expected more than two of the largest diameters ({2.0 * largest:.6g} m) and less "
            f"than the tube's {2.0 * tube.radius:.6g} m"
        )
    bulk = SOLID_FRACTION * grains.density
    return beverloo_discharge(hole, mean, bulk, grains.gravity) / (bulk * math.pi * tube.radius**2)
