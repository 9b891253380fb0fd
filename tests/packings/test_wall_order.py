"""Order of the wall layer: perfect layers, a slow evaluation of random points, what has no order."""

import math

import numpy as np
import pytest

import bedrad
from bedrad.packings.wall_contacts import wall_gaps
from bedrad.packings.wall_order import wall_order
from oracles.layers_beds import free_gas, hexagonal_sheet, staggered_rings
from oracles.unrolled import orders


def square_sheet(n=4):
    return bedrad.Packing(
        [[2.0 * i, 2.0 * j, 1.0] for i in range(n) for j in range(n)], 1.0, bedrad.Plate(), (8.0, 8.0)
    )


def test_a_hexagonal_layer_is_in_order():
    stats = bedrad.statistics(hexagonal_sheet(4, 3), [0.0, 1.0], blocks=2)
    assert stats.hexagonal_order == pytest.approx(1.0, abs=1e-12)
    assert stats.wall_neighbours == 6.0
    assert stats.hexagonal_order_error == pytest.approx(0.0, abs=1e-12)


def test_so_it_is_whichever_way_it_lies():
    sheet = hexagonal_sheet(4, 3)
    turned = bedrad.Packing(sheet.centers[:, [1, 0, 2]], 1.0, bedrad.Plate(), sheet.period[::-1])
    assert wall_order(turned, np.ones(len(turned), bool)).order == pytest.approx(np.ones(len(turned)), abs=1e-12)


def test_a_square_layer_has_none():
    stats = bedrad.statistics(square_sheet(), [0.0, 1.0], blocks=2)
    assert stats.hexagonal_order == pytest.approx(0.0, abs=1e-12)
    assert stats.wall_neighbours == 4.0


@pytest.mark.parametrize("convex", [True, False])
def test_staggered_rings_become_hexagonal_as_the_wall_flattens(convex):
    lack = [1 - bedrad.statistics(staggered_rings(n, convex), [0.0, 0.5]).hexagonal_order for n in (10, 20, 40)]
    # an arc exceeds its chord by 1/n^2, which turns the bonds by as much; the order falls with the square of that
    assert lack[0] / lack[1] == pytest.approx(16.0, rel=0.05)
    assert lack[1] / lack[2] == pytest.approx(16.0, rel=0.05)
    assert 0 < lack[0] < 1e-3


@pytest.mark.parametrize(("kind", "length"), [("tube", 20.0), ("rod", 20.0), ("plate", (20.0, 16.0))])
def test_random_points_have_the_small_order_of_a_slow_evaluation(kind, length):
    wall = {"tube": bedrad.Tube(6.0), "rod": bedrad.Rod(4.0), "plate": bedrad.Plate()}[kind]
    bed = free_gas(wall, seed=2, mean_count=160, length=length)
    touching = wall_gaps(bed) <= 1e-2
    found, expected = wall_order(bed, touching), orders(bed, touching)
    assert sorted(expected) == np.flatnonzero(touching).tolist()
    assert found.order[touching] == pytest.approx([order for order, _ in expected.values()], abs=1e-12)
    assert found.neighbours[touching].tolist() == [count for _, count in expected.values()]
    assert not found.order[~touching].any()


def test_random_points_have_the_order_of_random_angles():
    # N bonds of random angle add up to a random walk: mean |psi_6| is near sqrt(pi/(4 N))
    bed = free_gas(bedrad.Plate(), seed=4, mean_count=8000, length=(150.0, 150.0), touching=1.0)
    found = wall_order(bed, np.ones(len(bed), bool))
    walks = np.random.default_rng(5).uniform(0, 2 * np.pi, (100_000, 20))
    for count in (4, 7, 10):
        some = found.order[found.neighbours == count]
        expected = np.abs(np.exp(1j * walks[:, :count]).mean(axis=1))
        # five standard errors of correlated neighbours, each shared by some ten others
        assert some.mean() == pytest.approx(expected.mean(), abs=5 * math.sqrt(10) * some.std() / math.sqrt(len(some)))
        assert len(some) > 150
    assert found.neighbours.mean() == pytest.approx(8000 / 150**2 * np.pi * (1 + math.sqrt(3)) ** 2, rel=0.05)


def test_lone_spheres_and_pairs_have_no_order():
    bed = bedrad.Packing([[0, 0, 1], [2, 0, 1], [12, 8, 1]], 1.0, bedrad.Plate(), (20.0, 20.0))
    found = wall_order(bed, np.ones(3, bool))
    assert found.order.tolist() == [0.0, 0.0, 0.0]
    assert found.neighbours.tolist() == [1, 1, 0]


def test_the_first_shell_ends_between_hexagonal_neighbours():
    reach = 1 + math.sqrt(3)
    for distance, neighbours in ((reach - 1e-6, 1), (reach + 1e-6, 0)):
        bed = bedrad.Packing([[0, 0, 1], [distance, 0, 1]], 1.0, bedrad.Plate(), (20.0, 20.0))
        assert wall_order(bed, np.ones(2, bool)).neighbours.tolist() == [neighbours] * 2


def test_without_touching_particles_there_is_no_order():
    bed = bedrad.Packing([[0, 0, 1.5], [3, 0, 1.4]], 1.0, bedrad.Plate(), (9.0, 9.0))
    stats = bedrad.statistics(bed, [0.0, 1.0], blocks=1)
    assert math.isnan(stats.hexagonal_order)
    assert math.isnan(stats.wall_neighbours)
