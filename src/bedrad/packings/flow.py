"""Packings of a dense flow through a vertical tube at a chosen mean velocity, by soft-sphere DEM in LAMMPS."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from bedrad.errors import EngineFailedError
from bedrad.packings.flow_frames import FlowFrame, read_frame, read_rest
from bedrad.packings.flow_measures import FlowMeasures, measure_flow
from bedrad.packings.flow_plan import Channel, FlowPlan, Protocol
from bedrad.packings.flow_planning import plan_flowing
from bedrad.packings.flow_run import Progress, run_flow
from bedrad.packings.flow_script import REST, frame_name
from bedrad.packings.grains import Grains, check_seed, mixture_of, tube_for
from bedrad.packings.lammps import LOG, ThermoReader, working_folder
from bedrad.packings.overlaps import overlap_facts
from bedrad.packings.packing import LARGEST_OVERLAP, Packing
from bedrad.walls import Tube, Wall, Window

__all__ = ["Flow", "flow", "plan_flow"]

Facts = dict[str, str | float | int]


@dataclass(frozen=True, eq=False)
class Flow:
    """Packings of a flow, and what the flow did. Iterates over the packings.

    Attributes
    ----------
    packings : tuple of Packing
        The spheres in the tube above the belt or funnel, one packing a frame; z counts from the foot of the tube.
    window : Window
        The piece of wall in which the flow was measured, and in which to measure the packings.
    measures : FlowMeasures
        Velocity, profile, wall pressure, solid fraction, with errors, and what is wrong with the flow.
    plan : FlowPlan
        The numbers of the run.
    seconds : float
        Run time, without what an earlier run that was cut off had done. [s]
    """

    packings: tuple[Packing, ...]
    window: Window
    measures: FlowMeasures
    plan: FlowPlan
    seconds: float

    def __iter__(self) -> Iterator[Packing]:
        return iter(self.packings)

    def __len__(self) -> int:
        return len(self.packings)

    def __getitem__(self, frame: int) -> Packing:
        return self.packings[frame]

    def __str__(self) -> str:
        m, plan = self.measures, self.plan
        g, p = m.profile.gaussian, m.profile
        first = self.packings[0].provenance
        rows = {
            "velocity": f"{m.velocity:.5g} ± {m.velocity_error:.1g} m/s, {plan.velocity:.5g} set; "
            f"it fluctuates by {m.velocity_fluctuation:.2g} m/s from frame to frame",
            "profile": f"plug core {p.core:.4g} m/s, at the wall {p.wall:.4g} m/s, "
            f"shear layer {p.shear_width / plan.mean:.3g} d",
            "Gaussian form": f"A {g.amplitude:.4g} m/s, B {1e3 * g.center:.4g} mm, Y {1e3 * g.width:.4g} mm, "
            f"Z {g.offset:.4g} m/s; misses {g.residual:.1%} of the mean",
            "solid fraction": f"{m.solid_fraction:.4f} ± {m.solid_fraction_error:.1g}, "
            f"at rest {m.rest_solid_fraction:.4f}",
            "wall pressure": f"{m.wall_pressure:.4g} ± {m.wall_pressure_error:.2g} Pa, "
            f"Janssen's asymptote {m.janssen_pressure:.4g} Pa; {m.friction_mobilised:.2g} of it is shear",
            "discharge": f"{1e3 * m.discharge:.4g} g/s"
            + ("" if plan.channel.orifice is None else f", Beverloo's law {1e3 * m.beverloo_discharge:.4g} g/s"),
            "agitation": f"mean square of a velocity component {m.granular_temperature:.2g} g d",
            "overlaps": f"mean {first['mean_pair_overlap_d']:.2g} d, largest {first['largest_pair_overlap_d']:.2g} d "
            "in the first frame",
            "structures": f"{m.independent_structures:.3g} windows of bed in {len(self)} frames",
        }
        lines = [f"{name:<15} {text}" for name, text in rows.items()]
        return "\n".join([*lines, *(f"{'problem':<15} {text}" for text in m.problems)])


def flow(
    wall: Wall,
    diameter: float | None = None,
    velocity: float | None = None,
    frames: int = 50,
    seed: int = 1,
    *,
    sizes: Sequence[tuple[float, float]] | None = None,
    density: float = 3800.0,
    friction: float = 0.4,
    wall_friction: float | None = None,
    restitution: float = 0.85,
    stiffness: float | None = None,
    youngs_modulus: float | None = None,
    poisson_ratio: float = 0.3,
    gravity: float = 9.81,
    channel: Channel | None = None,
    flush: float | None = None,
    spacing: float = 0.5,
    max_overlap: float = LARGEST_OVERLAP,
    ranks: int = 1,
    executable: str | os.PathLike[str] | None = None,
    work_dir: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Flow:
    """Let spheres flow down a tube at a chosen mean velocity and keep frames of them.

    A hopper feeds a tube; in the lowest piece of the tube, the belt, spheres are dragged at the chosen velocity; what
    leaves below falls into the hopper again (the box is periodic along the axis). Above the belt nothing but gravity,
    contacts and the wall acts. The belt slips a little: what counts is the measured velocity. Soft spheres with linear
    springs, dashpots and Coulomb friction (Cundall and Strack 1979), or Hertz contacts, computed by LAMMPS in a
    process of its own.

    Parameters
    ----------
    wall : Tube
        The tube.
    diameter : float, optional
        Sphere diameter; 600 um if `sizes` is not given either. [m]
    velocity : float, optional
        Mean velocity of the flow, to be left out where `channel` has an orifice. [m/s]
    frames : int
        Number of packings.
    seed : int
        Seed of the random start.
    sizes : sequence of (float, float), optional
        In place of `diameter`: diameter [m] and number fraction of each size.
    density : float
        Density of the spheres. [kg/m3]
    friction, wall_friction : float
        Coefficient of friction between spheres, and with the wall (None: the same).
    restitution : float
        Coefficient of restitution, between 0 and 1.
    stiffness : float, optional
        Stiffness of the normal spring; None takes `bedrad.packings.contact.softened_stiffness`. [N/m]
    youngs_modulus, poisson_ratio : float, optional
        In place of `stiffness`: Hertz contacts of this Young's modulus [Pa] and Poisson's ratio.
    gravity : float
        Acceleration of gravity, along -z. [m/s2]
    channel : Channel, optional
        Lengths of tube, belt, sampling window and hopper, or an orifice in place of the belt.
    flush : float, optional
        Displacement before the first frame, in mean diameters; None takes 20 and 6 U^2/g more.
    spacing : float
        Displacement between two frames, in mean diameters.
    max_overlap : float
        Overlap that the packings may have, in radii.
    ranks : int
        MPI ranks.
    executable : path, optional
        The LAMMPS executable; None looks for the installed one.
    work_dir : path, optional
        Folder that keeps the input, log, frames and restart files; a run that was cut off there is gone on with. None
        uses a temporary one.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    Flow
        The packings and what was measured.

    Raises
    ------
    ValueError
        If an argument is out of range, the wall is no tube, or `work_dir` holds another run.
    MissingExtraError
        If LAMMPS is not installed.
    EngineFailedError
        If LAMMPS fails, or the spheres overlap more than `max_overlap`.

    Warns
    -----
    UserWarning
        For every one of `FlowMeasures.problems`: a flow that is not steady, thinned, jammed, or short of independent
        structures.
    """
    start = time.perf_counter()
    check_seed(seed)
    plan = plan_flow(
        wall, diameter, velocity, frames, sizes=sizes, density=density, friction=friction, wall_friction=wall_friction,
        restitution=restitution, stiffness=stiffness, youngs_modulus=youngs_modulus, poisson_ratio=poisson_ratio,
        gravity=gravity, channel=channel, flush=flush, spacing=spacing,
    )  # fmt: skip
    with working_folder(work_dir, "bedrad-flow-") as folder:
        run, resumed_at = run_flow(plan, seed, folder, ranks=ranks, executable=executable, progress=progress)
        kept = [read_frame(folder / frame_name(step)) for step in plan.frame_numbers]
        measures = measure_flow(plan, kept, read_rest(folder / REST))
        version = run.version if run is not None else _version(folder / LOG)
    facts = _facts(plan, measures, seed, version)
    if resumed_at is not None:
        facts["resumed_at_step"] = resumed_at
    packings = tuple(_packing(plan, frame, facts, max_overlap) for frame in kept)
    for problem in measures.problems:
        warnings.warn(f"the flow is {problem}", stacklevel=2)
    if progress:
        progress(1.0, f"{len(packings)} frames at {measures.velocity:.4g} m/s")
    return Flow(packings, Window(plan.window), measures, plan, time.perf_counter() - start)


def plan_flow(
    wall: Wall,
    diameter: float | None = None,
    velocity: float | None = None,
    frames: int = 50,
    *,
    sizes: Sequence[tuple[float, float]] | None = None,
    density: float = 3800.0,
    friction: float = 0.4,
    wall_friction: float | None = None,
    restitution: float = 0.85,
    stiffness: float | None = None,
    youngs_modulus: float | None = None,
    poisson_ratio: float = 0.3,
    gravity: float = 9.81,
    channel: Channel | None = None,
    flush: float | None = None,
    spacing: float = 0.5,
) -> FlowPlan:
    """Work out what `flow` would give LAMMPS, without running it; parameters and refusals as for `flow`.

    Returns
    -------
    FlowPlan
        Number of spheres, channel, time step, steps and work; printable.
    """
    grains = Grains(density, friction, wall_friction, restitution, stiffness, gravity, youngs_modulus, poisson_ratio)
    mixture = mixture_of(diameter, sizes)
    tube = tube_for(wall, mixture, "let flow")
    return plan_flowing(tube, mixture, velocity, grains, channel or Channel(), Protocol(frames, flush, spacing))


def _version(log: Path) -> str:
    """Version of LAMMPS from the log of a run that has ended."""
    reader = ThermoReader()
    if log.exists():
        reader.feed(log.read_text(encoding="utf-8", errors="replace")[:4096])
    return reader.version


def _facts(plan: FlowPlan, measures: FlowMeasures, seed: int, version: str) -> Facts:
    """What all packings of the flow have in common, for their provenance."""
    grains, channel = plan.grains, plan.channel
    facts: Facts = {
        "engine": "LAMMPS",
        "engine_version": version,
        "protocol": "a hopper feeds a tube; a belt in its lowest piece sets the velocity; what leaves falls back"
        if channel.orifice is None
        else "a hopper feeds a tube that an orifice empties; what leaves falls back",
        "seed": int(seed),
        "spheres_in_the_channel": plan.spheres,
        "sizes": "; ".join(f"{d!r} m: {share!r}" for d, share in plan.mixture),
        "density_kg_per_m3": grains.density,
        "gravity_m_per_s2": grains.gravity,
        "friction": grains.friction,
        "wall_friction": grains.friction_with_wall,
        "restitution": grains.restitution,
        "contact_duration_s": plan.contact_duration,
        "time_step_s": plan.time_step,
        "tube_length_d": channel.tube_length,
        "belt_d": channel.belt,
        "window_low_m": plan.window[0],
        "window_high_m": plan.window[1],
        "hopper_width_D": channel.hopper_width,
        "hopper_angle_degrees": channel.hopper_angle,
        "flush_d": plan.flush,
        "set_velocity_m_per_s": plan.velocity,
        "mean_velocity_m_per_s": measures.velocity,
        "mean_velocity_error_m_per_s": measures.velocity_error,
        "problems": "; ".join(measures.problems),
    }
    if grains.youngs_modulus is not None:
        return facts | {"youngs_modulus_Pa": grains.youngs_modulus, "poisson_ratio": grains.poisson_ratio}
    return facts | {"normal_stiffness_N_per_m": plan.stiffness, "normal_stiffness_rule": plan.stiffness_rule}


def _packing(plan: FlowPlan, frame: FlowFrame, facts: Facts, max_overlap: float) -> Packing:
    """The spheres above the belt or funnel as a packing with open ends."""
    tube, above = Tube(plan.tube_radius), frame.centers[:, 2] >= plan.foot_top
    centers, radii = frame.centers[above], frame.radii[above]
    notes = facts | {"timestep": frame.step}
    try:
        return Packing(centers, radii, tube, None, notes | overlap_facts(centers, radii, tube), max_overlap)
    except ValueError as error:
        raise EngineFailedError(
            f"the spheres at step {frame.step} are no valid packing: {error}; stiffer contacts make overlaps smaller"
        ) from error
