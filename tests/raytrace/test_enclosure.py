"""The exchange between wall and layers: closed forms, conservation, reciprocity, and the ray tracer from the wall.

Statistical tests compare in standard errors from 32 scramblings; a limit of 5 of them (Student, 31 degrees of freedom)
raises a false alarm once in 45,000 comparisons. Seeds are fixed.
"""

from functools import cache

import numpy as np
import pytest

import bedrad
from bedrad.heat import grey_enclosure
from bedrad.packings.layers import layer_areas
from bedrad.raytrace.enclosure_results import jackknife_error, reciprocal_matrix
from bedrad.walls import Window
from oracles.beds import axial_chain, hexagonal_layer, random_bed
from oracles.nasty_beds import WALLS

EDGES = np.array([0.0, 0.7, 2.0, 3.0])

TOUCHING = 0.0755868
"""View factor between touching equal spheres, to 2e-7."""


@cache
def bed_of(kind, periodic=True):
    wall, period = WALLS[kind]
    return random_bed(wall, 40, seed=3, length=6.0, spread=3.5, period=period if periodic else None)


@pytest.fixture(scope="module", params=[(k, p) for k in WALLS for p in (True, False)], ids=str)
def found(request):
    kind, periodic = request.param
    bed = bed_of(kind, periodic)
    window = bed.window(margin=0.0 if periodic else 1.0)
    return bed, periodic, bedrad.exchange_factors(bed, EDGES, rays=2**18, seed=1, window=window)


def test_rows_sum_to_one_and_the_matrix_is_reciprocal(found):
    _, _, x = found
    np.testing.assert_allclose(x.matrix.sum(axis=1), 1.0, rtol=4e-15)
    np.testing.assert_allclose(x.counted.sum(axis=1), 1.0, rtol=4e-15)
    G = x.areas[:, None] * x.exchange
    np.testing.assert_allclose(G, G.T, rtol=0, atol=1e-13 * G.max())
    assert (x.matrix >= 0).all()
    np.testing.assert_allclose(x.lost, 1.0 - x.exchange.sum(axis=1), atol=1e-14)


def test_areas_are_exact(found):
    bed, _, x = found
    exact = layer_areas(bed, EDGES, x.window).sum(axis=0)
    np.testing.assert_allclose(x.areas, [bed.wall.area(x.window), *exact], rtol=1e-13)
    np.testing.assert_array_equal(x.layer_of_zone, [-1, 0, 1, 2])


def test_what_the_wall_sees_is_what_view_factors_say(found):
    """Six shares, two matrices, six beds."""
    bed, _, x = found
    v = bedrad.view_factors(bed, EDGES, rays=2**18, seed=5, window=x.window)
    expected = np.array([v.wall, *v.layers, v.beyond, v.escaped])
    error = np.array([v.wall_error, *v.layers_error, v.beyond_error, v.escaped_error])
    periodic = found[1]
    for matrix, own in ((x.matrix, x.matrix_error), (x.counted, x.counted_error)):
        if matrix is x.matrix and not periodic:
            continue  # a short piece of an open bed exchanges with its neighbours, not with itself
        assert (np.abs(matrix[0] - expected) <= 5 * np.hypot(own[0], error)).all()


def test_rays_both_ways_agree_where_the_window_is_the_whole_bed(found):
    """Largest of six deviations below 5 standard errors; in pieces of an open bed they need not agree."""
    _, periodic, x = found
    z = x.reciprocity[np.triu_indices(4, 1)]
    assert np.isfinite(z).all()
    assert not periodic or np.abs(z).max() < 5


def test_rays_both_ways_know_more_than_those_of_one(found):
    _, periodic, x = found
    if periodic:
        # every entry that both directions measure, by its variance; each alone may be better by chance
        assert (x.matrix_error[:, :4] ** 2).sum() < 0.8 * (x.counted_error[:, :4] ** 2).sum()


def test_spheres_of_a_chain_see_their_neighbours_and_the_wall():
    """Touching spheres on a tube's axis: 2 TOUCHING to the neighbours, the rest to the wall."""
    bed = axial_chain(3.0)
    x = bedrad.exchange_factors(bed, [0.0, 3.0], rays=2**19, seed=2)
    to_wall = 1.0 - 2.0 * TOUCHING
    from_wall = to_wall * 4.0 * np.pi / (2.0 * np.pi * 3.0 * 2.0)
    expected = np.array([[1.0 - from_wall, from_wall, 0, 0], [to_wall, 1.0 - to_wall, 0, 0]])
    for matrix, error in ((x.matrix, x.matrix_error), (x.counted, x.counted_error)):
        assert (np.abs(matrix - expected) <= 5 * error + 2e-7).all()
        assert error.max() < 4e-4


def test_monolayer_gives_the_plate_what_it_gets_from_it():
    """Hexagonal touching layer, reference values from the plate (standard error 6e-5)."""
    bed = hexagonal_layer()
    x = bedrad.exchange_factors(bed, [0.0, 1.0, 2.0], rays=2**19, seed=3)
    wall, sphere = 4.0 * np.sqrt(3.0), 4.0 * np.pi
    assert x.areas == pytest.approx([wall, sphere, sphere], rel=1e-12)
    for layer, share in ((1, 0.970518), (2, 0.012294375)):
        back = share * wall / sphere
        assert abs(x.counted[layer, 0] - back) < 5 * np.hypot(x.counted_error[layer, 0], 6e-5 * wall / sphere)
        assert abs(x.matrix[0, layer] - share) < 5 * np.hypot(x.matrix_error[0, layer], 6e-5)
    # a layer is its own mirror image
    assert abs(x.counted[1, 1] - x.counted[2, 2]) < 5 * np.hypot(x.counted_error[1, 1], x.counted_error[2, 2])
    assert abs(x.counted[1, 0] - x.counted[2, 3]) < 5 * np.hypot(x.counted_error[1, 0], x.counted_error[2, 3])


@pytest.mark.parametrize("orientations", [1, 2, 4])
def test_orientations_of_a_lone_sphere_over_a_plate(orientations):
    """An element whose normal has the cosine c to the plate sees it by (1 + c)/2; images lie 40 radii off and more."""
    bed = bedrad.Packing([[0.0, 0.0, 1.5]], 1.0, bedrad.Plate(), (40.0, 40.0))
    x = bedrad.exchange_factors(bed, [0.0, 5.0], rays=2**18, seed=4, orientations=orientations)
    middle = 1.0 - (np.arange(orientations) + 0.5) * 2.0 / orientations
    images = 8e-3  # what four images and those behind take from the horizon
    np.testing.assert_allclose(x.counted[1:, 0], 0.5 * (1.0 + middle), atol=images)
    np.testing.assert_allclose(x.counted[1:, -2], 0.5 * (1.0 - middle), atol=images)
    np.testing.assert_allclose(x.areas[1:], 4.0 * np.pi / orientations, rtol=1e-3)
    assert x.areas[1:].sum() == pytest.approx(4.0 * np.pi, rel=1e-12)
    np.testing.assert_array_equal(x.layer_of_zone, [-1] + [0] * orientations)


def test_finer_zones_add_up_to_coarser_ones():
    bed = bed_of("tube")
    coarse = bedrad.exchange_factors(bed, EDGES, rays=2**17, seed=6)
    fine = bedrad.exchange_factors(bed, EDGES, rays=2**17, seed=6, orientations=3)
    # the same rays: the wall sees the sum
    np.testing.assert_allclose(fine.counted[0, 1:-2].reshape(3, 3).sum(axis=1), coarse.counted[0, 1:-2], rtol=1e-12)
    np.testing.assert_allclose(fine.areas[1:].reshape(3, 3).sum(axis=1), coarse.areas[1:], rtol=1e-12)
    np.testing.assert_array_equal(fine.emitted[1:].reshape(3, 3).sum(axis=1), coarse.emitted[1:])


def test_same_seed_same_answer_whatever_the_number_of_threads():
    bed = bed_of("tube")
    one, three = (bedrad.exchange_factors(bed, EDGES, rays=2**15, seed=7, threads=n) for n in (1, 3))
    np.testing.assert_array_equal(one.matrix, three.matrix)
    np.testing.assert_array_equal(one.matrix_error, three.matrix_error)
    other = bedrad.exchange_factors(bed, EDGES, rays=2**15, seed=8)
    assert (one.matrix != other.matrix).any()


def test_standard_errors_are_honest():
    """30 seeds of a chain against the closed form: mean square of the deviation in its errors is 1 within 4 of its own
    standard errors, sqrt(2/30) and a little for the 31 degrees of freedom; a false alarm in 16,000."""
    bed, to_wall = axial_chain(3.0), 1.0 - 2.0 * TOUCHING
    z = []
    for seed in range(30):
        x = bedrad.exchange_factors(bed, [0.0, 3.0], rays=2**11, seed=seed, threads=1)
        z.append((x.counted[1, 0] - to_wall) / x.counted_error[1, 0])
    assert abs(np.square(z).mean() * 29 / 31 - 1.0) < 4 * np.sqrt(2 / 30 * 1.1)


def test_error_of_a_quantity_is_that_of_its_replicates():
    x = bedrad.exchange_factors(bed_of("plate"), EDGES, rays=2**15, seed=9)
    np.testing.assert_allclose(x.error_of(lambda m: m), x.matrix_error, rtol=1e-12)
    np.testing.assert_allclose(x.error_of(lambda m: 3.0 * m[0, 1]), 3.0 * x.matrix_error[0, 1], rtol=1e-12)
    samples = np.random.default_rng(0).normal(size=(32, 3))
    without = (samples.sum(axis=0) - samples) / 31
    np.testing.assert_allclose(jackknife_error(without), samples.std(axis=0, ddof=1) / np.sqrt(32), rtol=1e-12)


def test_reciprocal_matrix_keeps_what_is_consistent_and_finds_the_truth():
    rng = np.random.default_rng(1)
    G = rng.uniform(0.1, 1.0, (4, 4))
    G = G + G.T
    lost = rng.uniform(0.0, 0.3, (4, 1))
    flows = np.hstack([G, lost])
    areas = flows.sum(axis=1)
    consistent = np.round(1e12 * flows).astype(np.int64)
    np.testing.assert_allclose(reciprocal_matrix(consistent, areas), flows / areas[:, None], rtol=1e-10)
    # from noisy counts: nearer to the truth than each row alone, on average over 200 draws
    better = alone = 0.0
    for _ in range(200):
        counts = np.array([rng.multinomial(3000, row / a) for row, a in zip(flows, areas, strict=True)])
        better += ((reciprocal_matrix(counts, areas) - flows / areas[:, None]) ** 2).sum()
        alone += ((counts / 3000 - flows / areas[:, None]) ** 2).sum()
    assert better < 0.6 * alone


def test_layers_without_surface_have_no_area_and_harm_nothing():
    bed = bedrad.Packing([[0.0, 0.0, 4.0]], 1.0, bedrad.Plate(), (6.0, 6.0))
    x = bedrad.exchange_factors(bed, [0.0, 2.0, 6.0], rays=2**14, seed=1)
    assert x.areas[1] == 0.0
    np.testing.assert_array_equal(x.matrix[1], [1, 0, 0, 0, 0])
    factors = grey_enclosure.wall_exchange_factors(x.exchange, x.lost, x.areas, 0.5, 0.5)
    assert factors[0] == 0.0
    assert 0.0 < factors[1] < 0.5
    empty = bedrad.exchange_factors(bedrad.Packing(np.empty((0, 3)), 1.0, bedrad.Tube(1.0), 2.0), [0.0, 0.5], rays=64)
    np.testing.assert_array_equal(empty.matrix, [[1, 0, 0, 0], [1, 0, 0, 0]])


def test_prints_the_matrix_and_what_it_cost():
    x = bedrad.exchange_factors(bed_of("plate"), EDGES, rays=2**12, seed=1, orientations=2)
    text = str(x)
    assert "layer 2.1" in text
    assert "reciprocity within" in text
    assert "left out: 1 spheres that no ray reached" in text


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"edges": [0.5, 1.0]}, "the first must be 0, the wall itself"),
        ({"edges": [0.0, 9.0]}, "the last edge is 9 m; the deepest point below the tube"),
        ({"rays": 0}, "rays is 0; expected a whole number from 1"),
        ({"rays": 2**60}, "rays is 1152921504606846976; expected"),
        ({"orientations": 0}, "orientations is 0; expected at least 1"),
        ({"threads": 0}, "threads is 0; expected at least 1"),
        ({"window": Window((-1.0, 3.0), (0.0, 1.0))}, "takes no lateral range"),
    ],
)
def test_refuses_what_has_no_meaning(change, message):
    with pytest.raises(ValueError, match=message):
        bedrad.exchange_factors(bed_of("tube"), **({"edges": EDGES, "rays": 64} | change))


def test_refuses_to_say_what_no_ray_has_seen():
    with pytest.raises(ValueError, match=r"too few of .* rays start in layer 1, which has 1.26e-08 m2 of surface"):
        bedrad.exchange_factors(hexagonal_layer(), [0.0, 1e-9, 2.0], rays=2**10)
