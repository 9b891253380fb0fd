"""What a flow does: its velocity, its pressure on the wall, its solid fraction; and what is wrong with it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.drift import significant_drifts
from bedrad.packings.flow_formulas import beverloo_discharge, janssen_pressure
from bedrad.packings.flow_frames import FlowFrame, motion_between
from bedrad.packings.flow_plan import FlowPlan
from bedrad.packings.time_averages import errors_of_mean
from bedrad.packings.velocity_profile import VelocityProfile, velocity_profile

__all__ = ["FlowMeasures", "measure_flow"]

FloatArray = NDArray[np.float64]

PIECE = 3.0
"""Height of the pieces of the window whose scatter tells the errors, in mean diameters."""

JAMMED = 0.1
"""A flow is jammed when it has less than this share of the velocity that was asked for."""

THINNED = 0.9
"""A flow is thinned when its solid fraction is below this share of what it was at rest."""

UNSTEADY = 0.02
"""Drift between the halves of the sample, in shares of the mean, from which on it counts, if it is more than chance."""

FEWEST_STRUCTURES = 3.0
"""Independent structures, lengths of bed that passed the window over the window's own, below which it is said."""


@dataclass(frozen=True, eq=False)
class FlowMeasures:
    """What was measured in the sampling window; errors are standard errors from `time_averages.errors_of_mean`.

    Parameters
    ----------
    velocity, velocity_error : float
        Mean speed of the spheres downwards, U. [m/s]
    velocity_fluctuation : float
        Standard deviation in time of the window's mean speed between two frames: surging, stick and slip. [m/s]
    granular_temperature : float
        Mean square of a velocity component about the mean profile, over g d.
    profile : VelocityProfile
        Speed against the distance from the axis.
    solid_fraction, solid_fraction_error : float
        Solid fraction over the whole cross-section.
    rest_solid_fraction : float
        The same in the filled channel before it moved.
    wall_pressure, wall_pressure_error : float
        Normal force of the spheres on the tube's wall per area. [Pa]
    wall_shear, wall_shear_error : float
        Force of the wall that holds the spheres up, per area. [Pa]
    janssen_pressure : float
        Janssen's asymptote for this solid fraction, the friction fully mobilised. [Pa]
    discharge : float
        Mass flow, as if all sizes of a mixture moved at one mean speed. [kg/s]
    beverloo_discharge : float
        Mass flow by Beverloo's law; nan without an orifice. [kg/s]
    independent_structures : float
        Length of bed that was seen, over the height of the window.
    problems : tuple of str
        What is wrong with the flow: not steady, thinned, jammed, or short of independent structures.
    """

    velocity: float
    velocity_error: float
    velocity_fluctuation: float
    granular_temperature: float
    profile: VelocityProfile
    solid_fraction: float
    solid_fraction_error: float
    rest_solid_fraction: float
    wall_pressure: float
    wall_pressure_error: float
    wall_shear: float
    wall_shear_error: float
    janssen_pressure: float
    discharge: float
    beverloo_discharge: float
    independent_structures: float
    problems: tuple[str, ...]

    @property
    def friction_mobilised(self) -> float:
        """Wall shear over wall pressure: how much of the wall's friction is used."""
        return self.wall_shear / self.wall_pressure if self.wall_pressure > 0.0 else math.nan


def measure_flow(plan: FlowPlan, frames: Sequence[FlowFrame], rest: tuple[FloatArray, FloatArray]) -> FlowMeasures:
    """Measure a flow from its frames.

    Parameters
    ----------
    plan : FlowPlan
        The numbers of the run.
    frames : sequence of FlowFrame
        The frames, at least two.
    rest : (n, 3) array, (n,) array
        Centres and radii of the filled channel at rest. [m]
    """
    low, high = plan.window
    pieces = max(1, round((high - low) / (PIECE * plan.mean)))
    planes = np.linspace(low, high, pieces + 1)
    area = 2.0 * math.pi * plan.tube_radius * (high - low) / pieces
    motions = [motion_between(a, b, plan.time_step) for a, b in itertools.pairwise(frames)]
    speeds = np.array([_mean_by_piece(m.places[:, 2], m.speeds, planes) for m in motions])
    volume = math.pi * plan.tube_radius**2 * (high - low) / pieces
    states = np.array([_state_by_piece(frame, planes, area, volume) for frame in frames])
    velocity, velocity_error = _mean(speeds[:, :, None])
    (solid, normal, shear), (solid_error, normal_error, shear_error) = _means(states)
    resting = _solid_by_piece(*rest, np.array([low, high]), volume * pieces)[0]
    profile = velocity_profile(motions, plan.window, plan.tube_radius, plan.mean)
    bulk, gravity = solid * plan.grains.density, plan.grains.gravity
    orifice = plan.channel.orifice
    structures = 1.0 + velocity * (frames[-1].step - frames[0].step) * plan.time_step / (high - low)
    in_time = speeds.mean(axis=1)
    return FlowMeasures(
        velocity=velocity,
        velocity_error=velocity_error,
        velocity_fluctuation=float(in_time.std(ddof=1)) if len(in_time) > 1 else math.nan,
        granular_temperature=_temperature(frames, profile, plan.window) / (gravity * plan.mean),
        profile=profile,
        solid_fraction=solid,
        solid_fraction_error=solid_error,
        rest_solid_fraction=resting,
        wall_pressure=normal,
        wall_pressure_error=normal_error,
        wall_shear=shear,
        wall_shear_error=shear_error,
        janssen_pressure=janssen_pressure(bulk, gravity, 2.0 * plan.tube_radius, plan.grains.friction_with_wall),
        discharge=bulk * velocity * math.pi * plan.tube_radius**2,
        beverloo_discharge=math.nan if orifice is None else beverloo_discharge(orifice, plan.mean, bulk, gravity),
        independent_structures=structures,
        problems=tuple(_problems(plan, velocity, speeds, states[:, :, 0], resting, structures)),
    )


def _mean_by_piece(heights: FloatArray, values: FloatArray, planes: FloatArray) -> FloatArray:
    count = np.histogram(heights, planes)[0]
    # an empty piece has no speed; it is as thin as can be, and said so by the solid fraction
    return np.asarray(np.histogram(heights, planes, weights=values)[0] / np.maximum(count, 1))


def _solid_by_piece(centers: FloatArray, radii: FloatArray, planes: FloatArray, volume: float) -> FloatArray:
    whole = 4.0 / 3.0 * math.pi * radii**3
    return np.asarray(np.histogram(centers[:, 2], planes, weights=whole)[0] / volume)


def _state_by_piece(frame: FlowFrame, planes: FloatArray, area: float, volume: float) -> FloatArray:
    """Solid fraction, normal and shear stress on the wall of every piece of the window, (pieces, 3)."""
    x, y, z = frame.centers.T
    inward = -(frame.wall_forces[:, 0] * x + frame.wall_forces[:, 1] * y) / np.maximum(np.hypot(x, y), 1e-300)
    normal = np.histogram(z, planes, weights=inward)[0] / area
    shear = np.histogram(z, planes, weights=frame.wall_forces[:, 2])[0] / area
    return np.stack([_solid_by_piece(frame.centers, frame.radii, planes, volume), normal, shear], axis=1)


def _mean(cells: FloatArray) -> tuple[float, float]:
    means, errors = _means(cells)
    return means[0], errors[0]


def _means(cells: FloatArray) -> tuple[list[float], list[float]]:
    errors, _ = errors_of_mean(cells)
    return cells.mean(axis=(0, 1)).tolist(), errors.tolist()


def _temperature(frames: Sequence[FlowFrame], profile: VelocityProfile, window: tuple[float, float]) -> float:
    """Mean square of a velocity component about the mean profile. [m2/s2]."""
    total, count = 0.0, 0
    for frame in frames:
        inside = (frame.centers[:, 2] >= window[0]) & (frame.centers[:, 2] < window[1])
        out = np.hypot(frame.centers[inside, 0], frame.centers[inside, 1])
        place = np.clip(np.searchsorted(profile.radii, out) - 1, 0, len(profile.speeds) - 1)
        about = frame.velocities[inside] + np.outer(np.nan_to_num(profile.speeds[place]), [0.0, 0.0, 1.0])
        total, count = total + float((about**2).sum()), count + 3 * len(about)
    return total / count if count else math.nan


def _problems(
    plan: FlowPlan, velocity: float, speeds: FloatArray, solid: FloatArray, resting: float, structures: float
) -> list[str]:
    found = []
    if velocity < JAMMED * plan.velocity:
        found.append(f"jammed: {velocity:.3g} m/s where {plan.velocity:.3g} m/s were expected")
    if solid.mean() < THINNED * resting:
        found.append(f"thinned: the solid fraction is {solid.mean():.3g}; at rest it was {resting:.3g}")
    for name, cells in (("velocity", speeds), ("solid fraction", solid)):
        drift, mean = float(significant_drifts(cells[:, :, None])[0]), float(cells.mean())
        if abs(drift) > UNSTEADY * abs(mean):
            share = f"{drift / mean:+.1%}" if mean else "all there is"
            found.append(f"not steady: the {name} drifts by {share} within the sample")
    if structures < FEWEST_STRUCTURES:
        found.append(
            f"short of independent structures: {structures:.2g} windows of bed were seen; more frames or a wider "
            "spacing give more"
        )
    return found
