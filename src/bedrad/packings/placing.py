"""Turning and moving a bed, so that its wall lies where bedrad has it: the axis along z, through x = y = 0."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Placing", "direction_vector", "turn_to_z"]

FloatArray = NDArray[np.float64]

_NAMED = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class Placing:
    """A turn and a shift: the point `origin` becomes 0, 0, 0, and what surrounds it is turned about it.

    Parameters
    ----------
    origin : (float, float, float)
        The point that moves to 0, 0, 0. [m]
    turn : (3, 3) array
        The rotation; exact where it only exchanges axes.
    """

    origin: tuple[float, float, float]
    turn: FloatArray

    def place(self, centers: FloatArray) -> FloatArray:
        """Return (n, 3) points where they come to lie. [m]"""
        moved = centers - np.array(self.origin) if any(self.origin) else centers
        return moved if np.array_equal(self.turn, np.eye(3)) else np.ascontiguousarray(moved @ self.turn.T)

    def periods(self, periods: Mapping[int, float]) -> dict[int, float]:
        """Return the periods of the axes after the turn; none where the turn is not from axis to axis. [m]"""
        if set(np.abs(self.turn).ravel().tolist()) != {0.0, 1.0}:
            return {}
        place = np.argmax(np.abs(self.turn), axis=0).tolist()
        return {place[axis]: length for axis, length in periods.items()}


def direction_vector(axis: str | Sequence[float]) -> FloatArray:
    """Unit vector of a direction given as ``"x"``, ``"y"``, ``"z"`` or three numbers.

    Raises
    ------
    ValueError
        If it is neither, or the three numbers are all zero or not finite.
    """
    try:
        values = np.array(_NAMED[axis.strip().lower()] if isinstance(axis, str) else axis, dtype=np.float64)
    except (KeyError, ValueError, TypeError):
        values = np.zeros(0)
    largest = float(np.abs(values).max()) if values.shape == (3,) else 0.0
    if not (math.isfinite(largest) and largest > 0.0):
        raise ValueError(f"axis is {axis!r}; expected 'x', 'y', 'z' or three finite numbers that are not all zero")
    values = values / largest
    return np.asarray(values / np.linalg.norm(values))


def turn_to_z(direction: FloatArray) -> FloatArray:
    """Rotation that takes a unit vector to +z; an exchange of axes where the vector lies along one.

    Parameters
    ----------
    direction : (3,) array
        The vector.

    Returns
    -------
    (3, 3) array
        The rotation.
    """
    lead = int(np.argmax(np.abs(direction)))
    # x to y to z to x is a rotation, as often as it is needed; a half turn about x if the vector points down
    turn = np.roll(np.eye(3), 2 - lead, axis=0)
    if direction[lead] < 0.0:
        turn = np.diag([1.0, -1.0, -1.0]) @ turn
    x, y, z = (turn @ direction).tolist()
    if x == 0.0 and y == 0.0:
        return np.asarray(turn)
    # the smallest rotation from (x, y, z) to +z; z is the largest component here, so that 1 + z is never small
    share = 1.0 / (1.0 + z)
    rest = np.array([[1.0 - share * x * x, -share * x * y, -x], [-share * x * y, 1.0 - share * y * y, -y], [x, y, z]])
    return np.asarray(rest @ turn)
