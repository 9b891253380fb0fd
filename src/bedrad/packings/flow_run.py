"""Running a flow in a folder: from the start, or on from the last restart file of a run that was cut off."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path

from bedrad.atomic import atomic_path
from bedrad.errors import EngineFailedError
from bedrad.packings.flow_frames import read_frame, read_rest
from bedrad.packings.flow_plan import FlowPlan
from bedrad.packings.flow_script import DATA, REST, RESTART, fill_data, flow_script, frame_name
from bedrad.packings.lammps import LammpsRun, run_lammps

__all__ = ["MARK", "Progress", "run_flow"]

Progress = Callable[[float, str], None]

MARK = "flow.sha256"
"""File that names the run that a folder holds: the checksum of its input."""

_RESUMED = "flow.resumed"
"""File that says at which step a run was gone on with, for whoever reads the finished frames later."""

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

    A folder that holds the same run, cut off half-way, is gone on with from its last whole restart file before which
    nothing is missing.

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
        Step that the run, or the earlier one that made the frames, went on from; None for a run from the start.

    Raises
    ------
    ValueError
        If the folder holds another run.
    EngineFailedError
        If LAMMPS fails; its log stays in the folder.
    """
    data = fill_data(plan, seed)
    _claim(folder, hashlib.sha256((flow_script(plan) + data).encode()).hexdigest())
    restarts = _restarts(folder)
    if not restarts and _whole(plan, folder, plan.steps + 1):
        return None, _resumed_at(folder)
    for step in reversed(restarts):
        if not _whole(plan, folder, step):
            continue
        watch = _Watch(plan, folder, progress, [other for other in restarts if other > step])
        (folder / _RESUMED).write_text(f"{step}\n", encoding="ascii")
        try:
            run = run_lammps(flow_script(plan, step), folder, ranks=ranks, executable=executable, watch=watch)
        except EngineFailedError:
            if watch.rows:
                raise
            # it ended before its first step: the restart file was cut off while it was written, or LAMMPS cannot run
            # at all; in case of the latter all restart files stay
        else:
            _remove(folder, _restarts(folder))
            return run, step
    (folder / _RESUMED).unlink(missing_ok=True)
    (folder / DATA).write_text(data, encoding="utf-8")
    watch = _Watch(plan, folder, progress, restarts)
    run = run_lammps(flow_script(plan), folder, ranks=ranks, executable=executable, watch=watch)
    _remove(folder, _restarts(folder))
    return run, None


def _whole(plan: FlowPlan, folder: Path, step: int) -> bool:
    """Whether all that a run has written for good before a step is there, to the last line."""
    try:
        if step >= plan.fill_steps:
            read_rest(folder / REST)
        for number in plan.frame_numbers:
            if number < step:
                read_frame(folder / frame_name(number))
    except EngineFailedError:
        return False
    return True


def _claim(folder: Path, checksum: str) -> None:
    """Mark the folder as this run's, or refuse one that is another's."""
    mark = folder / MARK
    if not mark.exists():
        with atomic_path(mark) as temporary:
            temporary.write_text(checksum + "\n", encoding="ascii")
    elif mark.read_text(encoding="ascii", errors="replace").strip() != checksum:
        raise ValueError(f"{folder} holds a flow with other parameters; give another folder, or empty this one")


def _resumed_at(folder: Path) -> int | None:
    """Step at which the run of these frames was gone on with; None for one that ran from start to end."""
    try:
        text = (folder / _RESUMED).read_text(encoding="ascii", errors="replace").strip()
    except FileNotFoundError:
        return None
    # a file that was cut off while it was written says that much
    return int(text) if text.isdecimal() and len(text) < 20 else 0


def _restarts(folder: Path) -> list[int]:
    """Steps of the restart files, rising."""
    ends = (path.name.removeprefix(f"{RESTART}.") for path in folder.glob(f"{RESTART}.*"))
    return sorted(int(end) for end in ends if end.isdigit())


def _remove(folder: Path, steps: list[int]) -> None:
    for step in steps:
        (folder / f"{RESTART}.{step}").unlink(missing_ok=True)


class _Watch:
    """Turns rows of the log into a share done, and removes restart files that later ones replace.

    When the run has made its first step, the restart files that it passed over go too: what they hold is broken, or
    lies ahead in what is now another run.
    """

    def __init__(self, plan: FlowPlan, folder: Path, progress: Progress | None, passed_over: list[int]) -> None:
        self._plan, self._folder, self._progress, self._passed_over = plan, folder, progress, passed_over
        self.rows = 0

    def __call__(self, row: dict[str, float]) -> None:
        self.rows += 1
        if self.rows == 1:
            _remove(self._folder, self._passed_over)
        _remove(self._folder, _restarts(self._folder)[:-_KEPT_RESTARTS])
        if self._progress is None:
            return
        step, plan = row["Step"], self._plan
        stage = "filling"
        if step >= plan.fill_steps + plan.flush_steps:
            stage = "sampling"
        elif step >= plan.fill_steps:
            stage = "flushing"
        self._progress(step / plan.steps, f"{stage}: {-row['v_velocity']:.4g} m/s in the window")
