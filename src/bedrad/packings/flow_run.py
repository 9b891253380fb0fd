"""Running a flow in a folder: from the start, or on from the last restart file of a run that was cut off."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path

from bedrad.errors import EngineFailedError
from bedrad.packings.flow_plan import FlowPlan
from bedrad.packings.flow_script import DATA, REST, RESTART, fill_data, flow_script, frame_name
from bedrad.packings.lammps import LammpsRun, run_lammps

__all__ = ["Progress", "run_flow"]

Progress = Callable[[float, str], None]

_PLAN = "flow.sha256"
"""File that names the run that a folder holds: the checksum of its input."""

_KEPT_RESTARTS = 2
"""Restart files that are kept: the last may have been cut off while it was written."""


def run_flow(
    plan: FlowPlan,
    seed: int,
    folder: Path,
    *,
    ranks: int = 1,
    executable: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> tuple[LammpsRun | None, int | None]:
    """Run LAMMPS until all frames of a flow lie in a folder.

    A folder that holds the same run, cut off half-way, is gone on with from its last whole restart file.

    Parameters
    ----------
    plan : FlowPlan
        The numbers.
    seed : int
        Seed of the places that the spheres fall from.
    folder : pathlib.Path
        Where LAMMPS runs and leaves what it writes.
    ranks : int
        MPI ranks.
    executable : path, optional
        The LAMMPS executable; None looks for it.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    run : LammpsRun or None
        The run; None where all frames were there.
    resumed_at : int or None
        Step that the run went on from; None for a run from the start.

    Raises
    ------
    ValueError
        If the folder holds another run.
    EngineFailedError
        If LAMMPS fails; its log stays in the folder.
    """
    data = fill_data(plan, seed)
    _claim(folder, hashlib.sha256((flow_script(plan) + data).encode()).hexdigest())
    names = [REST, *map(frame_name, plan.frame_numbers)]
    if all((folder / name).exists() for name in names) and not _restarts(folder):
        return None, None
    watch = _Watch(plan, folder, progress)
    for step in reversed(_restarts(folder)):
        try:
            run = run_lammps(flow_script(plan, step), folder, ranks=ranks, executable=executable, watch=watch)
        except EngineFailedError:
            if watch.rows:
                raise
            # it ended before its first step: the restart file was cut off while it was written
            (folder / f"{RESTART}.{step}").unlink()
        else:
            _prune(folder, 0)
            return run, step
    (folder / DATA).write_text(data, encoding="utf-8")
    run = run_lammps(flow_script(plan), folder, ranks=ranks, executable=executable, watch=watch)
    _prune(folder, 0)
    return run, None


def _claim(folder: Path, checksum: str) -> None:
    """Mark the folder as this run's, or refuse one that is another's."""
    mark = folder / _PLAN
    if not mark.exists():
        mark.write_text(checksum + "\n", encoding="ascii")
    elif mark.read_text(encoding="ascii", errors="replace").strip() != checksum:
        raise ValueError(f"{folder} holds a flow with other parameters; give another folder, or empty this one")


def _restarts(folder: Path) -> list[int]:
    """Steps of the restart files, rising."""
    ends = (path.name.removeprefix(f"{RESTART}.") for path in folder.glob(f"{RESTART}.*"))
    return sorted(int(end) for end in ends if end.isdigit())


def _prune(folder: Path, keep: int) -> None:
    steps = _restarts(folder)
    for step in steps[: len(steps) - keep]:
        (folder / f"{RESTART}.{step}").unlink(missing_ok=True)


class _Watch:
    """Turns rows of the log into a share done, and removes restart files that later ones replace."""

    def __init__(self, plan: FlowPlan, folder: Path, progress: Progress | None) -> None:
        self._plan, self._folder, self._progress = plan, folder, progress
        self.rows = 0

    def __call__(self, row: dict[str, float]) -> None:
        self.rows += 1
        _prune(self._folder, _KEPT_RESTARTS)
        if self._progress is None:
            return
        step, plan = row["Step"], self._plan
        stage = "filling"
        if step >= plan.fill_steps + plan.flush_steps:
            stage = "sampling"
        elif step >= plan.fill_steps:
            stage = "flushing"
        self._progress(step / plan.steps, f"{stage}: {-row['v_velocity']:.4g} m/s in the window")
