"""The ray kernels against brute force, and in hostile geometry."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import bedrad
from bedrad.raytrace.kernels import first_hit, sphere_distances, start_ray, trace, turn
from bedrad.raytrace.scene import build_scene
from bedrad.walls import Window
from oracles.beds import random_bed
from oracles.rays import cosine_rays, fates, first_hits

WALLS = {
    "tube": (bedrad.Tube(5.0), 6.0),
    "rod": (bedrad.Rod(2.0), 6.0),
    "plate": (bedrad.Plate(), (7.0, 6.0)),
}

EDGES = np.array([0.0, 0.7, 2.0, 3.0])


def _scene(kind, periodic, count=60):
    wall, period = WALLS[kind]
    bed = random_bed(wall, count, seed=3, length=6.0, spread=3.5, period=period if periodic else None)
    window = bed.window(margin=1.0 if not periodic else 0.0)
    reach = wall.radius if kind == "tube" else float(EDGES[-1])
    return build_scene(bed, window, reach), window


def distance_to(ox, oy, oz, dx, dy, dz, cx, cy, cz, radius):
    found = np.empty(1)
    sphere_distances(ox, oy, oz, dx, dy, dz, np.array([[cx], [cy], [cz], [radius**2]]), 0, 1, found)
    return found[0]


def _shifts(bed):
    reach = 4 if bed.wall.kind == "plate" else 7
    spans = [np.arange(-reach, reach + 1) * b if b else np.zeros(1) for b in bed.box]
    return np.array(np.meshgrid(*spans)).reshape(3, -1).T


def _grid(scene):
    box = np.array(scene.packing.box)
    room = np.empty(scene.most_in_a_cell)
    return scene.low, scene.size, scene.cells, box, scene.starts, scene.columns, room


def _ends(bed):
    axes = [0, 1] if bed.wall.kind == "plate" else [2]
    return {axis: bed.extent(axis) for axis in axes if not bed.box[axis]}


@pytest.mark.parametrize("kind", WALLS)
@pytest.mark.parametrize("periodic", [True, False], ids=["periodic", "open"])
def test_every_ray_ends_where_brute_force_says(kind, periodic):
    scene, window = _scene(kind, periodic)
    bed, layers = scene.packing, len(EDGES) - 1
    lateral = window.lateral or (0.0, 0.0)
    wall_radius = getattr(bed.wall, "radius", 0.0)
    emitting = np.array([window.axial[0], window.length, lateral[0], lateral[1] - lateral[0]])
    points = np.random.default_rng(11).random((300, 4))
    points[:, 2] *= 0.9  # rays within 18 degrees of grazing would need more images than the oracle tries
    number = {"tube": 0, "rod": 1, "plate": 2}[kind]
    rays = np.array([start_ray(*u, number, wall_radius, *emitting) for u in points])
    origins, directions = rays[:, :3], rays[:, 3:6]
    hits = first_hits(origins, directions, bed.centers, bed.radii, _shifts(bed))
    expected = fates(bed.wall, origins, directions, hits, EDGES, _ends(bed))
    found = np.empty(len(points), np.int16)
    columns = np.ascontiguousarray(rays.T)
    assert trace(columns, number, wall_radius, EDGES, scene.reach, np.inf, *_grid(scene), found) == 0
    np.testing.assert_array_equal(found, expected)
    assert len(np.unique(found)) >= 4
    met = np.flatnonzero(expected < layers)
    distances = [first_hit(*origins[k], *directions[k], np.inf, *_grid(scene)) for k in met]
    np.testing.assert_allclose(distances, hits[met], rtol=1e-12, atol=1e-12)


def test_shares_agree_with_an_independent_sampler():
    """Shares from the kernels' own Sobol rays against brute force on independent rays, in standard errors.

    Six comparisons; a limit of 4.5 standard errors raises a false alarm once in 20,000 runs.
    """
    scene, window = _scene("tube", periodic=False)
    bed = scene.packing
    origins, directions = cosine_rays(np.random.default_rng(5), bed.wall, window, 40_000)
    hits = first_hits(origins, directions, bed.centers, bed.radii, np.zeros((1, 3)))
    brute = np.bincount(fates(bed.wall, origins, directions, hits, EDGES, _ends(bed)), minlength=6) / len(hits)
    found = bedrad.view_factors(bed, EDGES, rays=2**18, seed=1, window=window)
    shares = np.array([*found.layers, found.beyond, found.wall, found.escaped])
    errors = np.array([*found.layers_error, found.beyond_error, found.wall_error, found.escaped_error])
    sigma = np.sqrt(errors**2 + brute * (1 - brute) / len(hits))
    assert (np.abs(shares - brute) < 4.5 * sigma).all()


@settings(max_examples=200, deadline=None)
@given(
    distance=st.floats(0.0, 1e6),
    offset=st.floats(0.0, 2.0),
    radius=st.floats(0.1, 1.0),
)
def test_sphere_distance_keeps_its_digits_far_away(distance, offset, radius):
    """Against 40-digit arithmetic; the error grows with the rounding of the inputs' distance, not with its square."""
    found = distance_to(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, offset, 0.0, distance, radius)
    with mpmath.workdps(40):
        square = mpmath.mpf(radius) ** 2 - mpmath.mpf(offset) ** 2
        if square <= 0:
            exact = mpmath.inf
        else:
            near, far = distance - mpmath.sqrt(square), distance + mpmath.sqrt(square)
            exact = near if near >= 0 else (mpmath.mpf(0) if far > 0 else mpmath.inf)
    if exact == mpmath.inf:
        # inputs within one rounding of grazing may fall either way
        assert found == np.inf or abs(offset - radius) < 1e-15
    else:
        half_error = 4e-16 * radius**2 / float(mpmath.sqrt(square))
        assert abs(found - float(exact)) <= 4e-16 * distance + half_error + 1e-300


def test_a_ray_from_inside_a_sphere_ends_at_once():
    assert distance_to(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3, 0.2, 0.0, 1.0) == 0.0


def test_a_sphere_behind_is_not_met():
    assert distance_to(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -3.0, 0.0, 0.0, 1.0) == np.inf


@settings(max_examples=300, deadline=None)
@given(st.floats(0.0, 1.0))
def test_turn_is_cosine_and_sine_to_two_roundings(u):
    """2 roundings of 1.1e-16, and one more of the angle, at most pi/4 from a quarter turn."""
    with mpmath.workdps(40):
        exact = mpmath.cos(2 * mpmath.pi * mpmath.mpf(u)), mpmath.sin(2 * mpmath.pi * mpmath.mpf(u))
        for found, wanted in zip(turn(u), exact, strict=True):
            assert abs(found - wanted) < 3.4e-16


@pytest.mark.parametrize("kind", [0, 1, 2])
def test_rays_start_on_the_wall_and_follow_the_cosine_law(kind):
    """Origins on the wall, unit directions into the bed, and the moments of the cosine law: <cos> = 2/3, <cos^2> = 1/2.

    Mean of 20,000 rays; standard deviations sqrt(1/18) and sqrt(1/12): limits of 5 standard errors, false alarm 1e-6.
    """
    rng = np.random.default_rng(2)
    rays = np.array([start_ray(*u, kind, 3.0, -1.0, 2.0, 5.0, 4.0) for u in rng.random((20_000, 4))])
    o, d, cosine = rays[:, :3], rays[:, 3:6], rays[:, 6]
    wall = (bedrad.Tube(3.0), bedrad.Rod(3.0), bedrad.Plate())[kind]
    np.testing.assert_allclose(wall.depth(o), 0.0, atol=1e-15 * 3)
    np.testing.assert_allclose((d**2).sum(axis=1), 1.0, rtol=4e-15)
    np.testing.assert_allclose((wall.normal(o) * d).sum(axis=1), cosine, rtol=0, atol=1e-15)
    assert abs(cosine.mean() - 2 / 3) < 5 * np.sqrt(1 / 18 / len(rays))
    assert abs((cosine**2).mean() - 1 / 2) < 5 * np.sqrt(1 / 12 / len(rays))
    axial = o[:, wall.axial]
    assert axial.min() >= -1.0
    assert axial.max() <= 1.0


def bed_with_images(scene):
    bed = scene.packing
    images = [bed.centers + np.array([0.0, 0.0, k * bed.period]) for k in (-1, 0, 1)]
    return np.column_stack([np.concatenate(images), np.tile(bed.radii, 3)])


def test_cells_hold_every_sphere_that_reaches_into_them():
    scene, _ = _scene("tube", periodic=True)
    rng = np.random.default_rng(0)
    points = rng.uniform(scene.low, scene.low + scene.size * scene.cells, (2000, 3))
    cell = ((points - scene.low) / scene.size).astype(int)
    index = (cell[:, 0] * scene.cells[1] + cell[:, 1]) * scene.cells[2] + cell[:, 2]
    inside = 0
    spheres = bed_with_images(scene)
    for p, k in zip(points, index, strict=True):
        holds = set(map(tuple, scene.columns[:3, scene.starts[k] : scene.starts[k + 1]].T.tolist()))
        around = np.linalg.norm(spheres[:, :3] - p, axis=1) < spheres[:, 3]
        assert set(map(tuple, spheres[around, :3].tolist())) <= holds
        inside += around.any()
    assert inside > 100


def test_window_outside_the_bed_is_refused():
    bed = random_bed(bedrad.Tube(5.0), 30, seed=1, length=6.0, spread=3.0)
    with pytest.raises(ValueError, match="reaches beyond the bed"):
        bedrad.view_factors(bed, [0.0, 1.0], rays=64, window=Window((-5.0, 3.0)))
