from __future__ import annotations

import numpy as np
import pytest

from bedrad.packings.overlaps import Overlap, pair_overlaps, worst_overlap


def slow_overlaps(centers, radii, box):
    """Every pair by itself, over the nearest image."""
    apart = centers[:, None] - centers
    for axis, length in enumerate(box):
        if length:
            apart[..., axis] -= length * np.round(apart[..., axis] / length)
    depth = radii[:, None] + radii - np.sqrt((apart**2).sum(axis=-1))
    return {(i, j): depth[i, j] for i, j in np.argwhere(depth > 0).tolist() if i < j}


def as_pairs(first, second, depth):
    pairs = {(int(i), int(j)): d for i, j, d in zip(first, second, depth, strict=True)}
    # no pair twice
    assert len(pairs) == len(depth)
    return pairs


@pytest.mark.parametrize("box", [(0.0, 0.0, 0.0), (0.0, 0.0, 2.5), (3.0, 2.0, 0.0), (1.7, 2.5, 3.0)])
@pytest.mark.parametrize("ratio", [1, 3, 50])
def test_pairs_are_those_of_brute_force(box, ratio):
    rng = np.random.default_rng(ratio)
    count = 400
    size = [length or 2.5 for length in box]
    centers = rng.uniform(0.0, size, (count, 3))
    # as many spheres in every octave of size, two of the largest reach less than half a period
    radii = 0.4 * ratio ** -rng.random(count)
    found = as_pairs(*pair_overlaps(centers, radii, box))
    expected = slow_overlaps(centers, radii, box)
    assert found.keys() == expected.keys()
    assert len(expected) > 20
    for pair, depth in expected.items():
        # both distances are square roots of sums below 100
        assert found[pair] == pytest.approx(depth, abs=1e-14)


def test_spheres_that_touch_do_not_overlap_but_a_hair_more_does():
    centers = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    assert len(pair_overlaps(centers, np.ones(2))[2]) == 0
    first, second, depth = pair_overlaps(centers, np.array([1.0, 1.0 + 2**-40]))
    assert (first.tolist(), second.tolist()) == ([0], [1])
    assert depth[0] == 2**-40


def test_spheres_on_one_point_and_one_inside_another_are_found():
    centers = np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.5]])
    found = as_pairs(*pair_overlaps(centers, np.array([2.0, 0.5, 0.1])))
    assert found == pytest.approx({(0, 1): 2.5, (0, 2): 1.6, (1, 2): 0.1}, abs=1e-15)


def test_images_across_an_edge_overlap():
    centers = np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 9.9]])
    assert len(pair_overlaps(centers, np.ones(2) * 0.2, (0.0, 0.0, 10.0))[2]) == 1
    assert len(pair_overlaps(centers, np.ones(2) * 0.2)[2]) == 0


def test_the_worst_is_counted_in_the_smaller_radius():
    centers = np.array([[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 10.0, 0.0]])
    radii = np.array([1.0, 1.0, 1.0, 0.25])
    # 0.5 of 1 is more than 0.25 of a radius of 0.25, but a smaller share of it
    assert worst_overlap(centers, radii) == Overlap(2, 3, 1.0)
    assert worst_overlap(centers[:2], radii[:2]) == Overlap(0, 1, 0.5)
    assert worst_overlap(centers[::2], radii[::2]) is None


def test_no_spheres_have_no_overlaps():
    assert worst_overlap(np.zeros((0, 3)), np.zeros(0)) is None
    assert [len(part) for part in pair_overlaps(np.zeros((0, 3)), np.zeros(0))] == [0, 0, 0]
    assert worst_overlap(np.zeros((1, 3)), np.ones(1)) is None
