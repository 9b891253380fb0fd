from __future__ import annotations

import numpy as np
import pytest

from bedrad.packings import overlaps
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


def random_beds():
    """Beds of many shapes of neighbourhood: even, of unlike sizes, in a period, in clumps, in lines."""
    rng = np.random.default_rng(5)
    even = rng.uniform(0.0, 3.0, (600, 3))
    clumps = np.concatenate([rng.normal(k, 0.02, (40, 3)) for k in range(6)]) + 1.0
    line = np.stack([np.linspace(0.0, 9.0, 300), np.zeros(300), np.zeros(300)], axis=1)
    return {
        "even": (even, np.full(600, 0.11), (0.0, 0.0, 0.0)),
        "unlike sizes": (even, 0.2 * 40.0 ** -rng.random(600), (0.0, 0.0, 0.0)),
        "periodic": (even, np.full(600, 0.11), (3.0, 0.0, 3.0)),
        "clumps": (clumps, np.full(240, 0.02), (0.0, 0.0, 0.0)),
        "line": (line, np.full(300, 0.016), (0.0, 0.0, 0.0)),
    }


@pytest.mark.parametrize("name", random_beds())
@pytest.mark.parametrize(("chunk", "most", "crowd"), [(7, 1 << 20, 32), (64, 30, 0), (1, 1, 0)])
def test_chunks_give_what_all_at_once_gives(monkeypatch, name, chunk, most, crowd):
    centers, radii, box = random_beds()[name]
    whole = pair_overlaps(centers, radii, box)
    worst = worst_overlap(centers, radii, box)
    assert as_pairs(*whole).keys() == slow_overlaps(centers, radii, box).keys()
    monkeypatch.setattr(overlaps, "_CHUNK", chunk)
    monkeypatch.setattr(overlaps, "_LARGEST_SEARCH", most)
    monkeypatch.setattr(overlaps, "_CROWD", crowd)
    for part, other in zip(pair_overlaps(centers, radii, box), whole, strict=True):
        assert part.tolist() == other.tolist()
    assert worst_overlap(centers, radii, box) == worst


def test_of_equal_overlaps_the_first_is_named():
    centers = np.array([[9.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 5.0, 0.0], [1.5, 5.0, 0.0]])
    assert worst_overlap(centers, np.ones(5)) == Overlap(1, 2, 0.5)
    order = [4, 0, 1, 3, 2]
    assert worst_overlap(centers[order], np.ones(5)) == Overlap(0, 3, 0.5)


def test_no_search_holds_more_than_its_limit(monkeypatch):
    # 2000 spheres on one point are 4 million pairs
    monkeypatch.setattr(overlaps, "_LARGEST_SEARCH", 5000)
    searches = [found.seen for found in overlaps._searched(np.zeros((2000, 3)), np.ones(2000), (0.0, 0.0, 0.0))]
    assert max(searches) <= 5000
    assert sum(searches) == 2000**2


def test_a_crowd_ends_the_search_once_enough_is_found(monkeypatch):
    monkeypatch.setattr(overlaps, "_CHUNK", 16)
    centers = np.concatenate([np.zeros((3000, 3)), [[50.0, 0.0, 0.0], [50.0, 0.0, 0.0]]])
    radii = np.concatenate([np.ones(3000), [0.9, 0.6]])
    looked = []
    searched = overlaps._searched

    def counted(*arguments):
        for found in searched(*arguments):
            looked.append(found.seen)
            yield found

    monkeypatch.setattr(overlaps, "_searched", counted)
    found = worst_overlap(centers, radii, enough=0.1)
    assert found is not None
    assert found.share == 2.0
    assert sum(looked) <= 100 * len(radii) + 16 * len(radii)
    looked.clear()
    # without it all is searched, and the worst of all is the one of unlike radii
    assert worst_overlap(centers, radii) == Overlap(3000, 3001, 2.5)
    assert sum(looked) > 3000**2


def test_a_bed_that_is_no_crowd_is_searched_whole_whatever_is_enough():
    centers = np.array([[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 9.0, 0.0], [1.0, 9.0, 0.0]])
    assert worst_overlap(centers, np.ones(4), enough=0.1) == Overlap(2, 3, 1.0)


def test_spheres_strewn_beyond_all_measure_are_no_harm():
    centers = np.array([[0.0, 0.0, 0.0], [1e100, 0.0, 0.0], [1e100, 0.0, 0.0], [-1e100, 1.0, 0.0]])
    assert worst_overlap(centers, np.ones(4)) == Overlap(1, 2, 2.0)


def test_a_crowd_is_refused_where_all_of_it_is_allowed():
    with pytest.raises(ValueError, match="20000 spheres of which more than 100 are in reach of each"):
        worst_overlap(np.zeros((20_000, 3)), np.ones(20_000), enough=2.0)
    # as many as a soft bed may have are none
    assert worst_overlap(np.zeros((90, 3)), np.ones(90), enough=2.0).share == 2.0
