from __future__ import annotations

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bedrad import Packing, Plate, Rod, Tube

TUBE = Tube(5.0)
PAIR = np.array([[4.0, 0.0, 1.0], [-4.0, 0.0, 3.0]])


def refusal(*arguments, **options):
    with pytest.raises(ValueError) as error:
        Packing(*arguments, **options)
    return str(error.value)


# Forms of input


def test_one_radius_stands_for_all():
    packing = Packing(PAIR, 1.0, TUBE)
    assert packing.radii.tolist() == [1.0, 1.0]
    assert len(packing) == 2
    assert packing.mean_diameter == 2.0
    np.testing.assert_array_equal(packing.depths, [1.0, 1.0])


def test_lists_and_whole_numbers_are_taken():
    packing = Packing([[4, 0, 1]], [1], TUBE)
    assert packing.centers.dtype == packing.radii.dtype == np.float64


def test_an_empty_packing_can_be_held_but_has_no_size():
    packing = Packing([], 1.0, TUBE, period=2.0)
    assert len(packing) == 0
    assert packing.centers.shape == (0, 3)
    assert packing.extent(2) == (0.0, 2.0)
    assert repr(packing) == "Packing(0 spheres, wall=Tube(radius=5.0), period=2.0)"
    with pytest.raises(ValueError, match="an empty packing has no mean diameter"):
        _ = packing.mean_diameter
    with pytest.raises(ValueError, match="an empty packing without a period has no extent"):
        Packing([], 1.0, TUBE).extent(2)


def test_a_packing_says_what_it_is():
    text = repr(Packing(PAIR, 1.0, TUBE))
    assert text == "Packing(2 spheres, mean diameter 2 m, wall=Tube(radius=5.0), period=None)"


# Refusals


@pytest.mark.parametrize(
    ("centers", "radii", "message"),
    [
        ([[4.0, 0.0]], 1.0, "centers has the shape (1, 2); expected (n, 3)"),
        ([4.0, 0.0, 1.0], 1.0, "centers has the shape (3,); expected (n, 3)"),
        (PAIR, [1.0], "radii has the shape (1,); expected one radius or (2,), one a centre"),
        (PAIR, [[1.0], [1.0]], "radii has the shape (2, 1); expected one radius or (2,), one a centre"),
        ([[4, 0, 1], [math.nan, 0, 3]], 1.0, "sphere 1: centre (nan, 0.0, 3.0) m is not finite (1 such)"),
        ([[4, 0, math.inf], [math.nan, 0, 3]], 1.0, "sphere 0: centre (4.0, 0.0, inf) m is not finite (2 such)"),
        (PAIR, [1.0, -0.5], "sphere 1: radius -0.5 m; expected a positive, finite number (1 such)"),
        (PAIR, 0.0, "sphere 0: radius 0.0 m; expected a positive, finite number (2 such)"),
        (PAIR, [math.nan, 1.0], "sphere 0: radius nan m; expected a positive, finite number (1 such)"),
        (PAIR, [1.0, math.inf], "sphere 1: radius inf m; expected a positive, finite number (1 such)"),
        (
            [[4, 0, 1], [4.5, 0, 9]],
            1.0,
            "sphere 1: centre (4.5, 0.0, 9.0) m, radius 1 m reaches 0.5 of its radius through the tube wall "
            "(Tube(radius=5.0)); at most 0.1 is accepted (1 such)",
        ),
        (
            [[4, 0, 1], [4, 0, 1], [4, 0, 9]],
            1.0,
            "spheres 0 and 1, at (4.0, 0.0, 1.0) m and (4.0, 0.0, 1.0) m, lie on one point; at most 0.1 is accepted",
        ),
        (
            [[4, 0, 1], [4, 0, 2.5]],
            [1.0, 0.75],
            "spheres 0 and 1, at (4.0, 0.0, 1.0) m and (4.0, 0.0, 2.5) m, overlap by 0.3333 of the smaller radius; "
            "at most 0.1 is accepted",
        ),
    ],
)
def test_a_refusal_names_the_sphere_and_the_value(centers, radii, message):
    assert refusal(centers, radii, TUBE) == message


def test_overlaps_are_accepted_up_to_the_stated_limit():
    near = [[4.0, 0.0, 1.0], [4.0, 0.0, 2.75]]
    assert "overlap by 0.25 of the smaller radius" in refusal(near, 1.0, TUBE, max_overlap=0.2499)
    assert Packing(near, 1.0, TUBE, max_overlap=0.25).max_overlap == 0.25
    through = [[4.25, 0.0, 0.0]]
    assert "reaches 0.25 of its radius through" in refusal(through, 1.0, TUBE, max_overlap=0.2499)
    Packing(through, 1.0, TUBE, max_overlap=0.25)
    assert "reaches 1.5 of its radius" in refusal([[0, 0, -0.5]], 1.0, Plate())
    assert "reaches 0.5 of its radius" in refusal([[5.5, 0, 0]], 1.0, Rod(5.0))
    for limit in (-0.1, math.nan, math.inf):
        assert refusal(PAIR, 1.0, TUBE, max_overlap=limit).startswith(f"max_overlap is {limit}; expected")


@pytest.mark.parametrize("wall", [None, "tube", 5.0, Tube])
def test_a_wall_is_one_of_three(wall):
    with pytest.raises(TypeError, match=r"^wall is .*; expected a bedrad.Tube, bedrad.Rod or bedrad.Plate$"):
        Packing(PAIR, 1.0, wall)


@pytest.mark.parametrize("period", [0.0, -1.0, math.nan, math.inf, (1.0, 2.0), ()])
def test_a_period_along_a_tube_is_one_length(period):
    expected = f"period is {period!r}; a tube takes one positive length in metres, or None"
    assert refusal(PAIR, 0.1, TUBE, period=period) == expected


@pytest.mark.parametrize("period", [9.0, (9.0,), (9.0, 0.0), (9.0, 9.0, 9.0)])
def test_a_period_along_a_plate_is_two_lengths(period):
    assert refusal([[1, 1, 1]], 1.0, Plate(), period=period) == (
        f"period is {period!r}; a plate takes two positive lengths (along x and y) in metres, or None"
    )


def test_a_sphere_may_touch_its_own_image_but_not_more():
    message = "sphere 1: radius 1 m overlaps its own image in a period of 1.5 m by more than the 0.1 radii that are"
    assert refusal([[0, 0, 0], [0, 3, 0]], [0.5, 1.0], TUBE, period=1.5).startswith(message)
    Packing([[0, 0, 0]], 1.0, TUBE, period=2.0, max_overlap=0.0)
    # an overlap of 0.1 radii with each neighbour is a period of 1.9 radii
    Packing([[0, 0, 0]], 1.0, TUBE, period=1.9)
    assert "overlaps its own image" in refusal([[0, 0, 0]], 1.0, TUBE, period=1.9 * (1 - 1e-9))
    assert "in a period of 1.5 m" in refusal([[0, 0, 1]], 1.0, Plate(), period=(9.0, 1.5))


def test_images_across_the_end_of_a_period_are_neighbours():
    ends = [[4.0, 0.0, 0.1], [4.0, 0.0, 9.0]]
    Packing(ends, 1.0, TUBE)
    assert "overlap by 0.9 of the smaller radius" in refusal(ends, 1.0, TUBE, period=10.0)


# Periods


@pytest.mark.parametrize(
    ("z", "wrapped"),
    [
        (0.0, 0.0),
        (-0.0, 0.0),
        (10.0, 0.0),
        (-10.0, 0.0),
        (-1e-20, 0.0),
        (-5e-324, 0.0),
        (12.5, 2.5),
        (-2.5, 7.5),
        (1e6, 0.0),
        (np.nextafter(10.0, 0.0), np.nextafter(10.0, 0.0)),
        (np.nextafter(10.0, 11.0), 2**-49),
    ],
)
def test_centres_are_wrapped_into_the_period(z, wrapped):
    assert Packing([[4.0, 0.0, z]], 1.0, TUBE, period=10.0).centers[0, 2] == wrapped


@given(
    st.floats(-1e3, 1e3),
    st.floats(0.01, 1e3),
)
def test_a_wrapped_centre_lies_inside_and_a_whole_number_of_periods_away(z, period):
    found = Packing([[4.0, 0.0, z]], 1e-3, TUBE, period=period).centers[0, 2]
    assert 0.0 <= found < period
    turns = (z - found) / period
    # the roundings of z and found, in periods
    assert abs(turns - round(turns)) <= 4 * (np.spacing(abs(z)) + np.spacing(period)) / period


def test_only_periodic_axes_are_wrapped():
    tube = Packing([[4.0, -1.0, -3.0]], 0.5, TUBE, period=10.0)
    assert tube.centers.tolist() == [[4.0, -1.0, 7.0]]
    assert tube.box == (0.0, 0.0, 10.0)
    plate = Packing([[-1.0, 12.0, 30.0]], 0.5, Plate(), period=(9.0, 10.0))
    assert plate.centers.tolist() == [[8.0, 2.0, 30.0]]
    assert plate.box == (9.0, 10.0, 0.0)
    assert Packing(PAIR, 1.0, TUBE).box == (0.0, 0.0, 0.0)


# What cannot be changed


def test_arrays_are_copied_and_cannot_be_written():
    centers, radii, notes = PAIR.copy(), np.ones(2), {"source": "a"}
    packing = Packing(centers, radii, TUBE, provenance=notes)
    centers[:], radii[:], notes["source"] = 7.0, 7.0, "b"
    np.testing.assert_array_equal(packing.centers, PAIR)
    assert packing.radii.tolist() == [1.0, 1.0]
    assert packing.provenance == {"source": "a"}
    for array in (packing.centers, packing.radii):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 7.0
    with pytest.raises(TypeError):
        packing.provenance["source"] = "b"
    with pytest.raises(dataclasses.FrozenInstanceError):
        packing.period = 3.0


def test_arrays_that_cannot_be_written_are_taken():
    centers = PAIR.copy()
    centers.setflags(write=False)
    assert Packing(centers, 1.0, TUBE, period=2.5).centers[1, 2] == 0.5
    assert centers[1, 2] == 3.0


@pytest.mark.parametrize("again", [lambda p: pickle.loads(pickle.dumps(p)), copy.deepcopy, dataclasses.replace])
def test_a_packing_travels_bit_for_bit(again):
    packing = Packing(PAIR, [1.0, 0.1], TUBE, period=7.0, provenance={"seed": 3}, max_overlap=0.2)
    found = again(packing)
    np.testing.assert_array_equal(found.centers, packing.centers)
    np.testing.assert_array_equal(found.radii, packing.radii)
    assert (found.wall, found.period, found.max_overlap) == (packing.wall, 7.0, 0.2)
    assert found.provenance == {"seed": 3}
    assert not found.centers.flags.writeable


# The measuring window


def test_the_window_leaves_out_open_ends_and_takes_a_whole_period():
    z = np.linspace(0.0, 40.0, 21)
    column = np.c_[np.full(21, 4.0), np.zeros(21), z]
    open_ends = Packing(column, 1.0, TUBE)
    assert open_ends.extent(2) == (-1.0, 41.0)
    # four diameters at each end
    assert open_ends.window().axial == (7.0, 33.0)
    assert open_ends.window(margin=1.0).axial == (1.0, 39.0)
    assert Packing(column, 1.0, TUBE, period=42.0).window().axial == (0.0, 42.0)
    with pytest.raises(
        ValueError, match=r"^the bed is 42 m long in z; leaving out 11 mean diameters \(22 m\) at each end leaves"
    ):
        open_ends.window(margin=11.0)
    assert open_ends.window(margin=0.0).axial == (-1.0, 41.0)
    assert open_ends.window(margin=0.25).axial == (-0.5, 40.5)
    # at least the largest sphere from a margin of one on, however small the mean
    mixed = Packing(column, np.where(z == 20.0, 1.0, 0.25), TUBE)
    assert mixed.window(margin=1.0).axial == (1.75, 38.25)
    for margin in (-1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match=f"^margin is {margin}; expected a number of mean diameters"):
            open_ends.window(margin)


def test_the_window_of_a_plate_has_two_ranges():
    centers = [[x, y, 1.0] for x in np.arange(0.0, 40.0, 2.0) for y in (0.0, 2.0)]
    sheet = Packing(centers, 1.0, Plate(), period=(40.0, 4.0))
    assert (sheet.window().axial, sheet.window().lateral) == ((0.0, 40.0), (0.0, 4.0))
    strip = Packing(centers, 1.0, Plate())
    with pytest.raises(ValueError, match="the bed is 4 m long in y"):
        strip.window()
    assert strip.window(margin=0.0).lateral == (-1.0, 3.0)
