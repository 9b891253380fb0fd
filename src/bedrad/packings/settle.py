"""A bed settled under gravity in a tube, by soft-sphere DEM in LAMMPS."""

from __future__ import annotations

import hashlib
import math
import os
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import EngineFailedError
from bedrad.packings.contact import STEPS_PER_CONTACT, TANGENTIAL_SHARE
from bedrad.packings.files.lammps_dump import read_dump
from bedrad.packings.grains import Grains, check_number, check_seed, mixture_of, tube_for
from bedrad.packings.lammps import LammpsRun, run_lammps, working_folder
from bedrad.packings.overlaps import overlap_facts
from bedrad.packings.packing import LARGEST_OVERLAP, Packing
from bedrad.packings.pouring import Column, count_spheres, loose_column
from bedrad.packings.settle_plan import (
    AT_REST,
    DATA,
    DUMP,
    SOLID_FRACTION,
    SettlePlan,
    plan_settling,
    settle_script,
)
from bedrad.walls import Tube, Wall

__all__ = ["AT_REST", "SettlePlan", "plan_settle", "settle", "settle_script"]

FloatArray = NDArray[np.float64]
Facts = dict[str, str | float | int]
Progress = Callable[[float, str], None]

_FALL_SHARE = 0.25
"""Share of the run time that the fall takes, for the progress; the contacts come after it."""


def settle(
    wall: Wall,
    diameter: float | None = None,
    height: float = 18e-3,
    seed: int = 1,
    *,
    sizes: Sequence[tuple[float, float]] | None = None,
    density: float = 3800.0,
    friction: float = 0.4,
    wall_friction: float | None = None,
    restitution: float = 0.85,
    stiffness: float | None = None,
    gravity: float = 9.81,
    time_limit: float | None = None,
    max_overlap: float = LARGEST_OVERLAP,
    ranks: int = 1,
    executable: str | os.PathLike[str] | None = None,
    work_dir: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Packing:
    """Let spheres fall into a tube with a floor at z = 0 and wait until they are at rest.

    Soft spheres with linear springs, dashpots and Coulomb friction (Cundall and Strack 1979), computed by
    LAMMPS in a process of its own. A loose random column (solid fraction 0.3) falls until the kinetic energy
    of translation is below `AT_REST`. The same arguments give the same packing bit for bit on the same
    machine.

    Parameters
    ----------
    wall : Tube
        The tube.
    diameter : float, optional
        Sphere diameter; 600 um if `sizes` is not given either. [m]
    height : float
        Height of the settled bed. The number of spheres follows from it with a solid fraction of 0.6, which
        is seldom reached beside a wall, so that the bed comes out a little taller. [m]
    seed : int
        Seed of the random column.
    sizes : sequence of (float, float), optional
        In place of `diameter`: diameter [m] and number fraction of each size.
    density : float
        Density of the spheres. [kg/m3]
    friction : float
        Coefficient of friction between spheres.
    wall_friction : float, optional
        Coefficient of friction between spheres and wall; None takes `friction`.
    restitution : float
        Coefficient of restitution, between 0 and 1.
    stiffness : float, optional
        Stiffness of the normal spring; None takes `bedrad.packings.contact.softened_stiffness`. [N/m]
    gravity : float
        Acceleration of gravity, along -z. [m/s2]
    time_limit : float, optional
        Simulated time after which to give up; None takes ten times the fall plus a hundred times sqrt(d/g).
        [s]
    max_overlap : float
        Overlap that the settled bed may have, in radii.
    ranks : int
        MPI ranks.
    executable : path, optional
        The LAMMPS executable; None looks for the installed one.
    work_dir : path, optional
        Folder that keeps the input, log and dump of the run; None uses a temporary one.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    Packing
        The bed. Its provenance holds the contact parameters, the softening and time step rules, the overlaps,
        the kinetic energy left, and what was run.

    Raises
    ------
    ValueError
        If an argument is out of range, or the wall is no tube.
    MissingExtraError
        If LAMMPS is not installed.
    EngineFailedError
        If LAMMPS fails, the bed is not at rest at the time limit, or overlaps more than `max_overlap`.

    Warns
    -----
    UserWarning
        If the bed is lower than `height`.
    """
    grains = Grains(density, friction, wall_friction, restitution, stiffness, gravity)
    tube, mixture, column = _prepare(wall, diameter, height, seed, sizes)
    plan = plan_settling(tube, column, grains, time_limit)
    script, data = settle_script(plan), column.data_file(plan.density, 5.0 * plan.largest)
    with working_folder(work_dir, "bedrad-settle-") as folder:
        (folder / DATA).write_text(data, encoding="utf-8")
        watch = _Watch(plan, progress) if progress else None
        run = run_lammps(script, folder, ranks=ranks, executable=executable, watch=watch)
        _check_rest(plan, run)
        centers, radii = _read_back(folder / DUMP, len(column.diameters))
    facts: Facts = {"seed": int(seed), "spheres": len(radii), "ranks": ranks}
    facts["sizes"] = "; ".join(f"{d!r} m: {share!r}" for d, share in mixture)
    facts |= _facts(plan, run)
    facts["input_sha256"] = hashlib.sha256((script + data).encode()).hexdigest()
    facts |= _measured(centers, radii, tube)
    packing = _packing(centers, radii, tube, facts, max_overlap)
    reached = float(facts["height_m"])
    if reached < height:
        warnings.warn(f"the bed is {reached:.4g} m tall, lower than the {height:.4g} m asked for", stacklevel=2)
    if progress:
        progress(1.0, f"at rest: {len(packing)} spheres, {reached * 1e3:.4g} mm tall")
    return packing


def plan_settle(
    wall: Wall,
    diameter: float | None = None,
    height: float = 18e-3,
    seed: int = 1,
    *,
    sizes: Sequence[tuple[float, float]] | None = None,
    density: float = 3800.0,
    friction: float = 0.4,
    wall_friction: float | None = None,
    restitution: float = 0.85,
    stiffness: float | None = None,
    gravity: float = 9.81,
    time_limit: float | None = None,
) -> SettlePlan:
    """Work out what `settle` would give LAMMPS, without running it; parameters and refusals as for `settle`.

    Returns
    -------
    SettlePlan
        Number of spheres, stiffness, time step and steps; printable.
    """
    grains = Grains(density, friction, wall_friction, restitution, stiffness, gravity)
    tube, _, column = _prepare(wall, diameter, height, seed, sizes)
    return plan_settling(tube, column, grains, time_limit)


def _prepare(
    wall: Wall,
    diameter: float | None,
    height: float,
    seed: int,
    sizes: Sequence[tuple[float, float]] | None,
) -> tuple[Tube, list[tuple[float, float]], Column]:
    """Check the arguments and place the spheres."""
    mixture = mixture_of(diameter, sizes)
    tube = tube_for(wall, mixture, "settled")
    return tube, mixture, _column(tube, mixture, height, seed)


def _column(tube: Tube, mixture: list[tuple[float, float]], height: float, seed: int) -> Column:
    check_number("height", height, height > 0, "a positive number of metres")
    check_seed(seed)
    counts = count_spheres(mixture, SOLID_FRACTION * math.pi * tube.radius**2 * height)
    return loose_column(tube.radius, mixture, counts, np.random.default_rng(seed))


class _Watch:
    """Turns rows of the log into a share done: steps of the fall, then decades of the energy."""

    def __init__(self, plan: SettlePlan, progress: Progress) -> None:
        self._plan = plan
        self._progress = progress
        self._start = 0.0
        self._share = 0.0

    def __call__(self, row: dict[str, float]) -> None:
        step, energy = row["Step"], row["v_moving"]
        if step < self._plan.fall_steps:
            share = _FALL_SHARE * step / self._plan.fall_steps
            text = "falling"
        else:
            self._start = max(self._start, energy, 10.0 * AT_REST)
            decay = math.log(self._start / max(energy, AT_REST)) / math.log(self._start / AT_REST)
            share = _FALL_SHARE + (1.0 - _FALL_SHARE) * decay
            text = f"settling: kinetic energy {energy:.1e} m g d a sphere, at rest below {AT_REST:g}"
        # the energy goes up now and then; what is done stays done
        self._share = max(self._share, min(share, 1.0))
        self._progress(self._share, text)


def _check_rest(plan: SettlePlan, run: LammpsRun) -> None:
    energy = run.last.get("v_rest", math.nan)
    if not energy < AT_REST:
        reached = run.last.get("Step", 0.0) * plan.time_step
        raise EngineFailedError(
            f"the bed is not at rest after {reached:.4g} s of simulated time: its kinetic energy is "
            f"{energy:.3g} m g d a sphere; less than {AT_REST:g} is accepted "
            "(give a longer time_limit, or a lower restitution)"
        )


def _read_back(dump: Path, count: int) -> tuple[FloatArray, FloatArray]:
    settled = read_dump(dump)
    if settled.radii is None or len(settled.radii) != count:
        raise EngineFailedError(f"LAMMPS left {len(settled.centers)} of {count} spheres in {dump.name}")
    return settled.centers, settled.radii


def _facts(plan: SettlePlan, run: LammpsRun) -> Facts:
    """Say what was run and with which numbers."""
    return {
        "engine": "LAMMPS",
        "engine_version": run.version,
        "protocol": "a loose random column falls under gravity and comes to rest on a floor at z = 0",
        "density_kg_per_m3": plan.density,
        "gravity_m_per_s2": plan.gravity,
        "friction": plan.friction,
        "wall_friction": plan.wall_friction,
        "restitution": plan.restitution,
        "normal_stiffness_N_per_m": plan.stiffness,
        "normal_stiffness_rule": plan.stiffness_rule,
        "tangential_stiffness_N_per_m": TANGENTIAL_SHARE * plan.stiffness,
        "contact_duration_s": plan.contact_duration,
        "time_step_s": plan.time_step,
        "time_step_rule": f"the contact of two of the smallest spheres in {STEPS_PER_CONTACT} steps",
        "steps": int(run.last["Step"]),
        "kinetic_energy_mgd": run.last["v_rest"],
        "rotation_energy_mgd": run.last["v_spinning"],
        "kinetic_energy_limit_mgd": AT_REST,
        "run_seconds": run.seconds,
    }


def _measured(centers: FloatArray, radii: FloatArray, tube: Tube) -> Facts:
    """Overlaps in mean diameters, and the height: twice that of the centre of mass, whatever the top."""
    mean = 2.0 * float(radii.mean())
    volume = radii**3
    height = 2.0 * float((volume * centers[:, 2]).sum() / volume.sum())
    solid = 4.0 / 3.0 * float(volume.sum()) / (tube.radius**2 * height)
    return overlap_facts(centers, radii, tube) | {
        "height_m": height,
        "height_d": height / mean,
        "solid_fraction": solid,
    }


def _packing(centers: FloatArray, radii: FloatArray, tube: Tube, facts: Facts, max_overlap: float) -> Packing:
    """Check what a packing does not know (the floor) and what it does."""
    into_floor = (radii - centers[:, 2]) / radii
    deepest = int(into_floor.argmax())
    try:
        if into_floor[deepest] > max_overlap:
            raise ValueError(f"sphere {deepest} reaches {into_floor[deepest]:.4g} of its radius through the floor")
        return Packing(centers, radii, tube, None, facts, max_overlap)
    except ValueError as error:
        raise EngineFailedError(
            f"the settled spheres are no valid packing: {error}; "
            f"a larger stiffness than {facts['normal_stiffness_N_per_m']:.4g} N/m makes overlaps smaller"
        ) from error
