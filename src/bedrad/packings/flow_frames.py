"""Frames of a flow run: spheres, velocities and the force of the tube's wall, and what moved between two of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import EngineFailedError
from bedrad.packings.flow_script import COLUMNS

__all__ = ["FlowFrame", "Motion", "motion_between", "read_frame"]

FloatArray = NDArray[np.float64]

_HEADER = 9
"""Lines of a LAMMPS dump before its rows."""


@dataclass(frozen=True)
class FlowFrame:
    """The spheres inside the tube at one step, sorted by number.

    Parameters
    ----------
    step : int
        Time step.
    numbers : (n,) array of int
        Numbers of the spheres.
    centers : (n, 3) array
        Centres. [m]
    radii : (n,) array
        Radii. [m]
    velocities : (n, 3) array
        Velocities. [m/s]
    wall_forces : (n, 3) array
        Force of the tube's wall on each. [N]
    """

    step: int
    numbers: NDArray[np.int64]
    centers: FloatArray
    radii: FloatArray
    velocities: FloatArray
    wall_forces: FloatArray


@dataclass(frozen=True)
class Motion:
    """What moved between two frames.

    Parameters
    ----------
    places : (n, 3) array
        Middle of the way of every sphere that both frames hold. [m]
    speeds : (n,) array
        Its mean speed downwards in between. [m/s]
    """

    places: FloatArray
    speeds: FloatArray


def read_frame(path: Path) -> FlowFrame:
    """Read a frame that `flow_script` had LAMMPS write.

    Raises
    ------
    EngineFailedError
        If it is missing or cut off.
    """
    try:
        with path.open(encoding="ascii") as stream:
            head = [stream.readline() for _ in range(_HEADER)]
            rows = np.loadtxt(stream, ndmin=2) if int(head[3]) else np.empty((0, len(COLUMNS.split())))
        if head[-1].split()[2:] != COLUMNS.split() or len(rows) != int(head[3]):
            raise ValueError(f"{len(rows)} rows after {head[-1].strip()!r}; {head[3].strip()} were announced")
    except (OSError, ValueError, IndexError) as error:
        raise EngineFailedError(f"LAMMPS left no whole frame in {path.name}: {error}") from error
    return FlowFrame(
        step=int(head[1]),
        numbers=rows[:, 0].astype(np.int64),
        centers=np.ascontiguousarray(rows[:, 1:4]),
        radii=np.ascontiguousarray(rows[:, 4]),
        velocities=np.ascontiguousarray(rows[:, 5:8]),
        wall_forces=np.ascontiguousarray(rows[:, 8:11]),
    )


def motion_between(first: FlowFrame, second: FlowFrame, time_step: float) -> Motion:
    """Mean speeds of the spheres between two frames, free of the jitter of momentary velocities."""
    _, before, after = np.intersect1d(first.numbers, second.numbers, assume_unique=True, return_indices=True)
    start, end = first.centers[before], second.centers[after]
    down = (start[:, 2] - end[:, 2]) / ((second.step - first.step) * time_step)
    return Motion(0.5 * (start + end), down)
