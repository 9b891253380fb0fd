"""Turns that bring an axis to z."""

from __future__ import annotations

import numpy as np
import pytest

from bedrad.packings.placing import Placing, direction_vector, turn_to_z

DIRECTIONS = [
    *np.concatenate([np.eye(3), -np.eye(3)]),
    *np.random.default_rng(1).normal(size=(40, 3)),
    *(np.array(v) for v in ([1e-9, 0.0, 1.0], [0.0, 1e-9, -1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 0.0])),
]


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_the_turn_is_a_rotation_that_takes_the_direction_to_z(direction: np.ndarray) -> None:
    vector = direction_vector(direction.tolist())
    turn = turn_to_z(vector)
    np.testing.assert_allclose(turn @ vector, [0.0, 0.0, 1.0], atol=4e-16)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=4e-16)
    assert np.linalg.det(turn) == pytest.approx(1.0, abs=1e-15)


def test_turns_between_axes_change_no_bit() -> None:
    points = np.random.default_rng(2).normal(size=(50, 3))
    for axis, sign in ((0, 1.0), (1, 1.0), (2, 1.0), (0, -1.0), (1, -1.0), (2, -1.0)):
        placing = Placing((0.0, 0.0, 0.0), turn_to_z(sign * np.eye(3)[axis]))
        placed = placing.place(points)
        assert placed[:, 2].tolist() == (sign * points[:, axis]).tolist()
        assert sorted(np.abs(placed[0]).tolist()) == sorted(np.abs(points[0]).tolist())
        periods = placing.periods({0: 1.0, 1: 2.0, 2: 3.0})
        assert periods[2] == axis + 1.0
        # the columns went where their periods are
        for new, length in periods.items():
            assert np.abs(placed[:, new]).tolist() == np.abs(points[:, int(length) - 1]).tolist()


def test_the_origin_moves_to_zero() -> None:
    placing = Placing((1.0, 2.0, 3.0), turn_to_z(direction_vector((1.0, 1.0, 0.0))))
    np.testing.assert_allclose(
        placing.place(np.array([[1.0, 2.0, 3.0], [2.0, 3.0, 3.0]])), [[0] * 3, [0, 0, 2**0.5]], atol=1e-15
    )
    assert placing.periods({0: 1.0}) == {}


@pytest.mark.parametrize("axis", ["", "xy", 3, None, (1, 2), (1, 2, "a"), (0.0, 0.0, 0.0), (1, 2, float("inf")), [[1]]])
def test_what_is_no_direction(axis: object) -> None:
    with pytest.raises(ValueError, match=r"axis is .*; expected 'x', 'y', 'z' or three finite numbers"):
        direction_vector(axis)  # type: ignore[arg-type]
