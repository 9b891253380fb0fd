"""Frames of a flow run: spheres, velocities and the force of the tube's wall, and what moved between two of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import EngineFailedError
from bedrad.packings.flow_script import COLUMNS, REST_COLUMNS

__all__ = ["FlowFrame", "Motion", "motion_between", "read_frame", "read_rest"]

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
    step, rows = _read_dump(path, COLUMNS)
    return FlowFrame(
        step=step,
        numbers=rows[:, 0].astype(np.int64),
        centers=np.ascontiguousarray(rows[:, 1:4]),
        radii=np.ascontiguousarray(rows[:, 4]),
        velocities=np.ascontiguousarray(rows[:, 5:8]),
        wall_forces=np.ascontiguousarray(rows[:, 8:11]),
    )


def read_rest(path: Path) -> tuple[FloatArray, FloatArray]:
    """Read centres and radii [m] of the spheres at rest in the filled tube.

    Raises
    ------
    EngineFailedError
        If the file is missing or cut off.
    """
    _, rows = _read_dump(path, REST_COLUMNS)
    return rows[:, 1:4], rows[:, 4]


def _read_dump(path: Path, columns: str) -> tuple[int, FloatArray]:
    """Step and rows of a dump with these columns."""
    names = columns.split()
    try:
        with path.open(encoding="ascii") as stream:
            head = [stream.readline() for _ in range(_HEADER)]
            text = stream.read()
        if head[-1].split()[2:] != names:
            raise ValueError(f"columns {head[-1].strip()!r}")
        rows = np.loadtxt(text.splitlines(), ndmin=2) if text else np.empty((0, len(names)))
        # the last line is whole only with its end: a number that was cut off is still a number
        if rows.shape != (int(head[3]), len(names)) or (text and not text.endswith("\n")):
            raise ValueError(f"{len(rows)} rows; {head[3].strip()} whole ones were announced")
        return int(head[1]), rows
    except (OSError, ValueError, IndexError) as error:
        raise EngineFailedError(f"LAMMPS left no whole frame in {path.name}: {error}") from error


def motion_between(first: FlowFrame, second: FlowFrame, time_step: float) -> Motion:
    """Mean speeds of the spheres between two frames, free of the jitter of momentary velocities."""
    _, before, after = np.intersect1d(first.numbers, second.numbers, assume_unique=True, return_indices=True)
    start, end = first.centers[before], second.centers[after]
    down = (start[:, 2] - end[:, 2]) / ((second.step - first.step) * time_step)
    return Motion(0.5 * (start + end), down)
