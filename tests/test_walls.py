from __future__ import annotations

import math
import re
from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bedrad import Plate, Rod, Tube
from bedrad.walls import Window

RING = Window((-0.3, 1.7))
PATCH = Window((-0.3, 1.7), (2.0, 2.5))
WALLS = [(Tube(1.25), RING), (Rod(1.25), RING), (Plate(), PATCH)]
NAMES = [wall.kind for wall, _ in WALLS]

coordinate = st.floats(-3.0, 3.0)
points = st.tuples(coordinate, coordinate, coordinate)


@pytest.mark.parametrize(("wall", "window"), WALLS, ids=NAMES)
@given(point=points, step=st.floats(0.0, 0.5))
def test_a_step_along_the_normal_adds_to_the_depth(wall, window, point, step):
    x = np.array(point)
    normal = wall.normal(x)
    assert np.linalg.norm(normal) == pytest.approx(1.0, abs=4e-16)
    start = float(wall.depth(x))
    if wall.kind == "tube":
        # beyond the axis the way leads back to the wall
        step = min(step, wall.radius - start)
    # a few roundings of numbers below 5
    assert wall.depth(x + step * normal) == pytest.approx(start + step, abs=4e-15)
    # and a step of that length back ends on the wall
    assert wall.depth(x - start * normal) == pytest.approx(0.0, abs=4e-15)


@pytest.mark.parametrize(("wall", "window"), WALLS, ids=NAMES)
def test_depths_and_normals_of_many_points_are_those_of_each(wall, window):
    x = np.random.default_rng(1).normal(size=(4, 5, 3))
    assert wall.depth(x).shape == (4, 5)
    assert wall.normal(x).shape == (4, 5, 3)
    for i in np.ndindex(4, 5):
        assert wall.depth(x[i]) == wall.depth(x)[i]
        np.testing.assert_array_equal(wall.normal(x[i]), wall.normal(x)[i])
    assert wall.depth(np.zeros((0, 3))).shape == (0,)


@pytest.mark.parametrize(("wall", "window"), WALLS, ids=NAMES)
def test_whole_numbers_are_taken_as_lengths(wall, window):
    assert wall.depth([[3, 4, 5]]).dtype == np.float64
    assert wall.depth([3, 4, 5]) == {"tube": -3.75, "rod": 3.75, "plate": 5.0}[wall.kind]
    np.testing.assert_array_equal(
        wall.normal([3, 4, 5]), {"tube": [-0.6, -0.8, 0], "rod": [0.6, 0.8, 0], "plate": [0, 0, 1]}[wall.kind]
    )


def test_depths_are_new_arrays():
    x = np.ones((2, 3))
    Plate().depth(x)[0] = 7.0
    assert x[0, 2] == 1.0


def test_on_the_axis_every_direction_is_as_good():
    for wall in (Tube(1.0), Rod(1.0)):
        assert np.linalg.norm(wall.normal([0.0, 0.0, 3.0])) == 1.0
    # so close to it that the squares of the coordinates are zero
    np.testing.assert_allclose(Rod(1.0).normal([3e-200, 4e-200, 0.0]), [0.6, 0.8, 0.0], rtol=1e-15)


@pytest.mark.parametrize(("wall", "window"), WALLS, ids=NAMES)
def test_the_volume_of_a_layer_grows_by_its_area(wall, window):
    # the volume is a polynomial of second degree in the depth, for which central differences are exact
    step, volume = 2.0**-10, lambda depth: wall.layer_volume(0.0, depth, window)
    at_wall = (-1.5 * volume(0.0) + 2.0 * volume(step) - 0.5 * volume(2 * step)) / step
    # the roundings of the volumes, over the step
    assert at_wall == pytest.approx(wall.area(window), rel=1e-12)
    for depth in (0.25, 0.5, 1.0):
        growth = (volume(depth + step) - volume(depth - step)) / (2 * step)
        shrunk = {"tube": Tube, "rod": Rod}.get(wall.kind)
        there = shrunk(1.25 - depth if wall.kind == "tube" else 1.25 + depth) if shrunk else wall
        assert growth == pytest.approx(there.area(window), rel=1e-11)


@pytest.mark.parametrize(("wall", "window"), WALLS, ids=NAMES)
@given(st.lists(st.floats(0.0, 1.25), min_size=3, max_size=3).map(sorted))
def test_layers_add_up(wall, window, depths):
    a, b, c = depths
    parts = wall.layer_volume(a, b, window) + wall.layer_volume(b, c, window)
    # a few roundings each of volumes below 32
    assert parts == pytest.approx(wall.layer_volume(a, c, window), abs=8 * np.spacing(31.0))


def test_areas_and_volumes_known_in_closed_form():
    assert Tube(1.25).area(RING) == pytest.approx(5 * math.pi, rel=1e-15)
    assert Rod(1.25).area(RING) == pytest.approx(5 * math.pi, rel=1e-15)
    assert Plate().area(PATCH) == pytest.approx(1.0, rel=1e-15)
    assert Tube(1.25).layer_volume(0.0, 1.25, RING) == pytest.approx(math.pi * 1.25**2 * 2, rel=1e-15)
    assert Rod(1.25).layer_volume(0.0, 0.75, RING) == pytest.approx(math.pi * (4 - 1.25**2) * 2, rel=1e-15)
    assert Plate().layer_volume(0.5, 2.5, PATCH) == pytest.approx(2.0, rel=1e-15)


def test_a_thin_layer_keeps_its_digits():
    # 1 um of a tube of 1 m: the difference of two squares would lose six digits of it
    found = Tube(1.0).layer_volume(0.0, 1e-6, Window((0.0, 1.0)))
    assert found == pytest.approx(2e-6 * math.pi * (1 - 0.5e-6), rel=1e-10)


def test_a_tube_ends_at_its_axis():
    tube = Tube(1.0)
    assert tube.largest_depth == 1.0
    assert Rod(1.0).largest_depth == Plate().largest_depth == math.inf
    assert tube.layer_volume(0.5, 9.0, RING) == tube.layer_volume(0.5, 1.0, RING)
    assert tube.layer_volume(2.0, 9.0, RING) == 0.0


@pytest.mark.parametrize("shape", [Tube, Rod])
@pytest.mark.parametrize("radius", [0, 0.0, -1.0, math.nan, math.inf, "1", None])
def test_a_radius_that_is_none_is_refused_with_its_value(shape, radius):
    message = f"{shape.kind} radius is {radius!r}; expected a positive, finite number of metres"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        shape(radius)


@pytest.mark.parametrize("shape", [Tube, Rod])
def test_a_radius_becomes_a_float(shape):
    for radius in (2, np.float32(2.0), np.int64(2)):
        wall = shape(radius)
        assert type(wall.radius) is float
        assert wall == shape(2.0)
        assert hash(wall) == hash(shape(2.0))
    with pytest.raises(FrozenInstanceError):
        wall.radius = 3.0


def test_walls_of_different_kinds_differ():
    assert Tube(1.0) != Rod(1.0)
    assert Plate() == Plate()


@pytest.mark.parametrize("interval", [(1.0, 1.0), (2.0, 1.0), (math.nan, 1.0), (0.0, math.inf)])
def test_an_empty_window_is_refused(interval):
    low, high = interval
    for name, window in (("axial", {"axial": interval}), ("lateral", {"axial": (0.0, 1.0), "lateral": interval})):
        message = f"{name} window ({low}, {high}) m is empty or not finite; expected low < high"
        with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
            Window(**window)


def test_the_length_of_a_window_and_the_lateral_range_of_a_plate():
    assert RING.length == 2.0
    with pytest.raises(ValueError, match="the window of a plate needs a lateral range; it is None"):
        Plate().area(RING)
    with pytest.raises(ValueError, match="the window of a plate needs a lateral range"):
        Plate().layer_volume(0.0, 1.0, RING)
