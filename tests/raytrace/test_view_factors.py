"""View factors against closed forms, conservation laws and symmetries, and the honesty of their errors."""

import itertools

import numpy as np
import pytest

import bedrad
from bedrad.raytrace.tracer import GridTracer
from bedrad.walls import Window
from oracles.beds import axial_chain, hexagonal_layer, random_bed

NEIGHBOUR = 0.07558681842161  # a sphere to a touching equal one
CHAIN_EXACT = (4 * np.pi) / (2 * np.pi * 1.5 * 2) * (1 - 2 * NEIGHBOUR)  # A_s/A_w times what does not meet a neighbour


def total(factors):
    return float(factors.layers.sum()) + factors.beyond + factors.wall + factors.escaped


def test_empty_periodic_tube_sees_only_itself():
    empty = bedrad.Packing(np.zeros((0, 3)), 1.0, bedrad.Tube(1.0), period=2.0)
    factors = bedrad.view_factors(empty, [0.0, 0.1, 0.5], rays=2**16)
    assert factors.wall == 1.0
    assert total(factors) == 1.0


@pytest.mark.parametrize(("tube_radius", "tolerance"), [(1.0, 3e-5), (1.5, 1e-5), (3.0, 3e-5)])
def test_axial_chain_by_reciprocity(tube_radius, tolerance):
    """F = (A_s/A_w)(1 - 2 F_neighbour): all neighbours but the nearest two are hidden. Limit 4 standard errors."""
    factors = bedrad.view_factors(axial_chain(tube_radius), [0.0, min(1.0, tube_radius)], tolerance=tolerance, seed=7)
    exact = (4 * np.pi) / (2 * np.pi * tube_radius * 2) * (1 - 2 * NEIGHBOUR)
    met = 1.0 - factors.wall
    assert factors.escaped == 0.0
    assert factors.wall_error <= tolerance
    assert abs(met - exact) < 4 * factors.wall_error


def test_off_axis_sphere_does_not_depend_on_its_radius():
    """A_w F = A_s F_s-wall, and F_s-wall of an off-axis sphere is the same for every radius; e = 0.7, R = 1, L = 4."""
    sphere_to_wall = 0.9065773498153
    for radius in (0.3, 0.15, 0.05):
        # two far specks hold the ends of the tube open at z = -2 and 2
        speck = 1e-6
        centers = [[0.7, 0.0, 0.0], [0.0, 0.0, -2.0 + speck], [0.0, 0.0, 2.0 - speck]]
        bed = bedrad.Packing(centers, [radius, speck, speck], bedrad.Tube(1.0))
        factors = bedrad.view_factors(bed, [0.0, 0.999], rays=2**21, seed=5, window=Window((-2.0 + 1e-9, 2.0 - 1e-9)))
        met = factors.layers[0] + factors.beyond
        error = np.hypot(factors.layers_error[0], factors.beyond_error)
        exact = 4 * np.pi * radius**2 / (2 * np.pi * 4.0) * sphere_to_wall
        # an edge at the axis makes nearly every hit one of layer 1, so that the two errors do not cancel
        assert abs(met - exact) < 4 * error


def test_open_tube_loses_to_its_ends_what_the_cylinder_interior_does():
    """Cylinder interior to both ends, H = L/(2R): sqrt(1 + H^2) - H; two specks mark the ends and hide < 1e-11."""
    speck = 1e-6
    bed = bedrad.Packing([[0, 0, speck], [0, 0, 4.0 - speck]], speck, bedrad.Tube(1.0))
    factors = bedrad.view_factors(bed, [0.0, 0.5], tolerance=2e-5, seed=3, window=Window((1e-9, 4.0 - 1e-9)))
    assert factors.escaped == pytest.approx(2 * 0.1180339887499, abs=4 * factors.escaped_error)
    assert factors.wall == pytest.approx(1 - 2 * 0.1180339887499, abs=4 * factors.wall_error)


def test_hexagonal_layer_on_a_plate():
    factors = bedrad.view_factors(hexagonal_layer(), [0.0, 1.0, 2.0], tolerance=3e-5, seed=1)
    published = np.array([0.97052, 0.01229, 0.01719])
    assert np.abs(np.array([*factors.layers, factors.beyond]) - published).max() < 2e-4
    assert factors.wall == 0.0
    assert factors.escaped == 0.0


def test_speck_beside_a_rod_by_reciprocity():
    """A small sphere at distance b from the axis of a long rod sees it under the share asin(R/b)/pi of all directions.

    The sphere's size changes that by (r/b)^2 = 1e-4, as much again is granted; the limit is their sum and 4 errors.
    """
    b, radius, length = 2.0, 0.02, 400.0
    centers = [[b, 0.0, 0.0], [0, b, -length / 2], [0, b, length / 2]]
    bed = bedrad.Packing(centers, [radius, 1e-3, 1e-3], bedrad.Rod(1.0))
    window = Window((-4.0, 4.0))
    factors = bedrad.view_factors(bed, [0.0, 2.0], rays=2**22, seed=2, window=window)
    seen = np.arcsin(1.0 / b) / np.pi
    # what of it comes from the window: an element of the band sees the sphere as r^2 cos / s^2
    axial = np.linspace(-4, 4, 4001)
    angle = np.linspace(-np.arccos(1 / b), np.arccos(1 / b), 801)
    z, phi = np.meshgrid(axial, angle, indexing="ij")
    rho2 = b * b + 1 - 2 * b * np.cos(phi)
    kernel = (b * np.cos(phi) - 1.0) / (rho2 + z**2) ** 1.5 / np.pi
    flux = np.trapezoid(np.trapezoid(kernel, angle, axis=1), axial) * radius**2 * np.pi
    exact = flux / (2 * np.pi * 8.0)
    assert 4 * np.pi * radius**2 * seen / (2 * np.pi * 8.0) > exact
    assert abs(factors.layers[0] - exact) < 4 * factors.layers_error[0] + 2e-4 * exact


@pytest.mark.parametrize(
    ("wall", "period"), [(bedrad.Tube(5.0), 6.0), (bedrad.Rod(2.0), 6.0), (bedrad.Plate(), (7.0, 6.0))]
)
def test_rows_sum_to_one_and_threads_do_not_matter(wall, period):
    bed = random_bed(wall, 60, seed=3, length=6.0, spread=3.5, period=period)
    one = bedrad.view_factors(bed, [0.0, 0.7, 2.0, 3.0], rays=2**15, seed=9, threads=1)
    many = bedrad.view_factors(bed, [0.0, 0.7, 2.0, 3.0], rays=2**15, seed=9, threads=7)
    assert total(one) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_array_equal(one.layers, many.layers)
    np.testing.assert_array_equal(one.covariance, many.covariance)
    np.testing.assert_array_equal(one.layers_bed_error, many.layers_bed_error)
    other = bedrad.view_factors(bed, [0.0, 0.7, 2.0, 3.0], rays=2**15, seed=10)
    assert (one.layers != other.layers).any()


def test_scale_and_rotation_do_not_matter():
    """The same bed in other units gives the same rays; turned about the axis the same factors within errors."""
    bed = random_bed(bedrad.Tube(5.0), 80, seed=4, length=6.0, spread=3.5, period=6.0)
    edges = np.array([0.0, 0.7, 2.0, 3.0])
    a = bedrad.view_factors(bed, edges, rays=2**18, seed=1)
    small = bedrad.Packing(bed.centers * 2.0**-20, bed.radii * 2.0**-20, bedrad.Tube(5.0 * 2.0**-20), 6.0 * 2.0**-20)
    b = bedrad.view_factors(small, edges * 2.0**-20, rays=2**18, seed=1)
    np.testing.assert_array_equal(a.covariance, b.covariance)
    turn = np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    turned = bedrad.Packing(bed.centers @ turn, bed.radii, bed.wall, bed.period)
    c = bedrad.view_factors(turned, edges, rays=2**18, seed=2)
    assert (np.abs(a.layers - c.layers) < 4.5 * np.hypot(a.layers_error, c.layers_error)).all()


def test_spheres_too_deep_for_any_ray_change_nothing():
    """Beside a plate nothing beyond the last edge matters."""
    plate = random_bed(bedrad.Plate(), 60, seed=3, length=6.0, spread=3.0, period=(7.0, 6.0))
    deep = np.vstack([plate.centers, [[1.0, 1.0, 9.0]]])
    more = bedrad.Packing(deep, np.append(plate.radii, 1.0), plate.wall, plate.period)
    edges = [0.0, 0.7, 2.0, 3.0]
    a, b = (bedrad.view_factors(p, edges, rays=2**14, seed=1) for p in (plate, more))
    np.testing.assert_array_equal(a.covariance, b.covariance)
    assert b.left_out.spheres == a.left_out.spheres + 1


def test_the_lazy_grid_of_a_tube_gives_what_the_whole_bed_gives(monkeypatch):
    bed = random_bed(bedrad.Tube(12.0), 150, seed=8, length=6.0, spread=11.0, period=6.0)
    edges = [0.0, 0.7, 2.0, 3.0]
    monkeypatch.setattr("bedrad.raytrace.tracer.EXTRA_REACH", 0.1)
    lazy = bedrad.view_factors(bed, edges, rays=2**15, seed=1)
    assert lazy.left_out.deep_rays > 100
    monkeypatch.setattr("bedrad.raytrace.tracer.EXTRA_REACH", 100.0)
    whole = bedrad.view_factors(bed, edges, rays=2**15, seed=1)
    assert whole.left_out.deep_rays == 0
    np.testing.assert_array_equal(lazy.covariance, whole.covariance)
    np.testing.assert_array_equal(lazy.layers, whole.layers)


@pytest.mark.parametrize("period", [6.0, None])
def test_rays_that_skip_the_hollow_of_a_tube_end_where_those_that_walk_do(period):
    """Spheres near the wall only; rays that pass them cross the empty core, out of the open ends too."""
    bed = random_bed(bedrad.Tube(40.0), 400, seed=8, length=6.0, spread=4.0, period=period)
    tracer = GridTracer(bed, np.array([0.0, 1.0, 2.0]), Window((2.0, 4.0)))
    points = np.random.default_rng(3).random((40_000, 4))
    assert tracer.hollow < 20.0
    skipping = tracer.fates(points)
    tracer.hollow = np.inf
    np.testing.assert_array_equal(skipping, tracer.fates(points))
    assert len(np.unique(skipping)) >= 4


def test_a_sphere_through_the_wall_takes_the_wall_it_covers():
    """Rays that start inside an overlapping sphere end in layer 1 at depth 0: the covered share of the wall."""
    through = 0.1
    bed = bedrad.Packing([[1.0, 1.0, 1.0 - through]], 1.0, bedrad.Plate(), period=(2.0, 2.0))
    covered = np.pi * (1 - (1 - through) ** 2) / 4.0
    factors = bedrad.view_factors(bed, [0.0, 1e-9, 1.0], rays=2**18, seed=1)
    assert abs(factors.layers[0] - covered) < 4 * factors.layers_error[0] + 1e-6


def test_error_falls_faster_than_plain_monte_carlo():
    """Slope of log(rms error) against log(rays) over 2^10..2^18 rays, 16 seeds: below -0.5 by 2 standard errors.

    The slope's standard error from 16 seeds at 9 sizes is 1/sqrt(2*16)/sqrt(sum x^2) = 0.033 with x in steps of ln 2.
    """
    chain = axial_chain(1.5)
    sizes = 2 ** np.arange(10, 19)

    def deviation(rays, seed):
        return 1 - bedrad.view_factors(chain, [0.0, 1.0], rays=int(rays), seed=seed).wall - CHAIN_EXACT

    square = [np.mean([deviation(n, seed) ** 2 for seed in range(16)]) for n in sizes]
    x = np.log(sizes) - np.log(sizes).mean()
    slope = (x * np.log(np.sqrt(square))).sum() / (x * x).sum()
    uncertainty = 1 / np.sqrt(2 * 16) / np.sqrt((x * x).sum())
    assert slope < -0.5 - 2 * uncertainty


def test_tolerance_is_met_and_the_history_ends_there():
    factors = bedrad.view_factors(hexagonal_layer(), [0.0, 1.0, 2.0], tolerance=5e-4, seed=1)
    last = factors.history[-1]
    assert last.largest_error <= 5e-4 < factors.history[-2].largest_error
    assert last.rays == factors.rays
    assert all(b.rays >= 1.2 * a.rays for a, b in itertools.pairwise(factors.history))


def test_a_tolerance_that_no_number_of_rays_meets_is_refused_early():
    with pytest.raises(ValueError, match=r"tolerance 1e-09 would take about .* rays, more than 3e\+11"):
        bedrad.view_factors(axial_chain(1.5), [0.0, 1.0], tolerance=1e-9)


def test_no_hit_is_not_no_error():
    """After n rays without a hit the share is below 3/n with 95 % confidence (1 - exp(-3) = 0.950)."""
    factors = bedrad.view_factors(axial_chain(1.5), [0.0, 1.0], rays=2**15)
    assert factors.escaped == 0.0
    line = next(line for line in str(factors).splitlines() if line.startswith("escaped"))
    assert factors.rays >= 2**15
    assert f"< {3 / factors.rays:.0e}" in line


def test_one_layer_normalised_is_one_without_error():
    bed = random_bed(bedrad.Tube(5.0), 100, seed=4, length=6.0, spread=3.5, period=6.0)
    factors = bedrad.view_factors(bed, [0.0, 2.0], rays=2**13, seed=1, blocks=3).normalised("watkins")
    np.testing.assert_allclose(
        [factors.layers[0], factors.layers_error[0], factors.layers_bed_error[0]], [1.0, 0.0, 0.0], atol=1e-14
    )


def test_watkins_normalisation_sums_to_one_over_the_layers():
    bed = random_bed(bedrad.Tube(5.0), 100, seed=4, length=6.0, spread=3.5, period=6.0)
    factors = bedrad.view_factors(bed, [0.0, 0.7, 2.0, 3.0], rays=2**16, seed=1)
    published = factors.normalised("watkins")
    assert published.layers.sum() == pytest.approx(1.0, abs=1e-12)
    assert published.wall == published.beyond == published.escaped == 0.0
    np.testing.assert_allclose(published.layers, factors.layers / factors.layers.sum(), rtol=1e-14)
    # the ratio's scatter over shares drawn from their covariance; 20,000 draws know it to 1/200
    shares = factors.history[-1].estimates
    drawn = np.random.default_rng(1).multivariate_normal(shares, factors.covariance, 20_000)[:, :3]
    ratios = drawn / drawn.sum(axis=1, keepdims=True)
    np.testing.assert_allclose(published.layers_error, ratios.std(axis=0), rtol=0.025)
    with pytest.raises(ValueError, match="'isothermal'"):
        factors.normalised("isothermal")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"tolerance": 1e-3, "rays": 100}, "not both"),
        ({"tolerance": -1.0}, "-1.0"),
        ({"tolerance": float("nan")}, "nan"),
        ({"rays": 0}, "rays is 0"),
        ({"threads": 0, "rays": 64}, "threads is 0"),
        ({"edges": [0.1, 1.0]}, "first must be 0"),
        ({"edges": [0.0, 2.0, 1.0]}, "finite depths that rise"),
        ({"edges": [0.0, 1.6]}, "deepest point below the tube wall is 1.5 m"),
    ],
)
def test_wrong_arguments_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        bedrad.view_factors(axial_chain(1.5), **({"edges": [0.0, 1.0]} | arguments))
