"""The kernels of the exchange between surfaces: starts on spheres, ends of rays, random numbers."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import bedrad
from bedrad.packings.layers import layer_areas
from bedrad.raytrace.enclosure_kernels import LIFT, follow_once, random_unit
from bedrad.raytrace.enclosure_scene import EnclosureScene
from oracles import enclosure_counts
from oracles.beds import random_bed
from oracles.nasty_beds import WALLS
from oracles.rays import first_hits

EDGES = np.array([0.0, 0.7, 2.0, 3.0])


def scene_of(kind, periodic, orientations=1):
    wall, period = WALLS[kind]
    bed = random_bed(wall, 40, seed=3, length=6.0, spread=3.5, period=period if periodic else None)
    return EnclosureScene(bed, EDGES, bed.window(margin=0.0 if periodic else 1.0), orientations)


def shifts_of(bed):
    reach = 4 if bed.wall.kind == "plate" else 7
    spans = [np.arange(-reach, reach + 1) * b if b else np.zeros(1) for b in bed.box]
    return np.array(np.meshgrid(*spans)).reshape(3, -1).T


def wall_distances(bed, origins, directions):
    """Distance to the wall, and to the cylinder or plane at the last edge beside a rod or plate, infinite for none."""
    with np.errstate(all="ignore"):
        if bed.wall.kind == "plate":
            t = -origins[:, 2] / directions[:, 2]
            deep = (EDGES[-1] - origins[:, 2]) / directions[:, 2]
            return np.where(directions[:, 2] < 0, t, np.inf), np.where(directions[:, 2] > 0, deep, np.inf)
        a = (directions[:, :2] ** 2).sum(axis=1)
        b = (origins[:, :2] * directions[:, :2]).sum(axis=1)

        def roots(radius):
            square = b * b - a * ((origins[:, :2] ** 2).sum(axis=1) - radius**2)
            return (-b - np.sqrt(square)) / a, (-b + np.sqrt(square)) / a

        if bed.wall.kind == "tube":
            return roots(bed.wall.radius)[1], np.full(len(a), np.inf)
        near = roots(bed.wall.radius)[0]
        return np.where(near > 0, near, np.inf), roots(bed.wall.radius + EDGES[-1])[1]


@pytest.mark.parametrize("kind", WALLS)
@pytest.mark.parametrize("periodic", [True, False], ids=["periodic", "open"])
def test_every_ray_from_a_sphere_ends_where_brute_force_says(kind, periodic):
    scene = scene_of(kind, periodic)
    bed = scene.packing
    points = np.random.default_rng(5).random((300, 5))
    rays, zones = scene.sphere_rays(points)
    origins, directions = rays[:3].T, rays[3:].T
    # grazing rays would need more images than the oracle tries
    kept = (zones >= 0) & (np.abs(directions[:, bed.wall.axial]) < 0.95)
    if kind == "plate":
        kept &= np.abs(directions[:, 2]) > 0.3
    origins, directions = origins[kept], directions[kept]
    hits = first_hits(origins, directions, bed.centers, bed.radii, shifts_of(bed))
    wall, deep = wall_distances(bed, origins, directions)
    ends = np.minimum(hits, np.minimum(wall, deep))
    points_of_end = origins + np.where(np.isfinite(ends), ends, 0.0)[:, None] * directions
    expected = 1 + np.searchsorted(EDGES[1:], bed.wall.depth(points_of_end))
    expected[(wall < hits) & (wall <= deep)] = 0
    expected[(deep < hits) & (deep < wall)] = 4
    for axis in [0, 1] if kind == "plate" else [2]:
        low, high = bed.extent(axis)
        if not bed.box[axis]:
            expected[(points_of_end[:, axis] < low) | (points_of_end[:, axis] > high)] = 5
    place = (scene.kind, scene.wall_radius, scene.edges, 1, scene.reach, scene.grid, scene.room())
    found = []
    for k in np.flatnonzero(kept):
        counts = np.zeros((4, 6), np.int64)
        follow_once(rays[:, k : k + 1].copy(), zones[k : k + 1], *place, counts)
        found.append(int(counts.sum(axis=0).argmax()))
        assert counts[zones[k]].sum() == 1
    np.testing.assert_array_equal(found, expected)
    assert len(np.unique(found)) >= 4


@pytest.mark.parametrize("kind", WALLS)
def test_starts_are_uniform_over_the_exact_areas_and_follow_the_cosine_law(kind):
    """400,000 starts: shares of the layers against the exact areas, and <cos> = 2/3, <cos^2> = 1/2, in 4.5 standard
    errors of independent points, five comparisons: a false alarm in 30,000 changes of seed."""
    scene = scene_of(kind, periodic=False)
    bed, n = scene.packing, 400_000
    rays, zones = scene.sphere_rays(np.random.default_rng(7).random((n, 5)))
    exact = layer_areas(bed, EDGES, scene.window).sum(axis=0) / (4 * np.pi * (scene.spheres[3] ** 2).sum())
    for layer in range(3):
        assert abs((zones == layer + 1).mean() - exact[layer]) < 4.5 * np.sqrt(exact[layer] / n)
    some = rays[:, :2000]
    gaps = np.linalg.norm(some[:3].T[:, None] - bed.centers, axis=2) / bed.radii - 1.0
    whose = np.abs(gaps - LIFT).argmin(axis=1)
    np.testing.assert_allclose(gaps[np.arange(2000), whose], LIFT, atol=1e-14)
    normals = (some[:3].T - bed.centers[whose]) / bed.radii[whose][:, None]
    cosine = (normals * some[3:].T).sum(axis=1)
    np.testing.assert_allclose((some[3:] ** 2).sum(axis=0), 1.0, rtol=1e-14)
    assert abs(cosine.mean() - 2 / 3) < 4.5 * np.sqrt(1 / 18 / 2000)
    assert abs((cosine**2).mean() - 1 / 2) < 4.5 * np.sqrt(1 / 12 / 2000)


def test_a_start_inside_another_sphere_ends_there():
    bed = bedrad.Packing([[0.0, 0.0, 1.0], [0.0, 0.0, 2.8]], 1.0, bedrad.Plate(), (9.0, 9.0), max_overlap=0.3)
    scene = EnclosureScene(bed, np.array([0.0, 1.9, 4.0]), bed.window())
    rays, zones = scene.sphere_rays(np.random.default_rng(1).random((4000, 5)))
    # moved back from the periodic image
    at = (rays[:2] + 4.5) % 9.0 - 4.5
    distance = np.sqrt(at[0] ** 2 + at[1] ** 2 + (rays[2] - bed.centers[:, 2:]) ** 2)
    inside = distance.min(axis=0) < 1.0 - 1e-6
    # a cap of height 0.1 on each sphere, a twentieth of its area
    assert abs(inside.mean() - 0.05) < 4.5 * np.sqrt(0.05 / 4000)
    counts = np.zeros((3, 5), np.int64)
    place = (scene.kind, 0.0, scene.edges, 1, scene.reach, scene.grid, scene.room())
    follow_once(np.ascontiguousarray(rays[:, inside]), zones[inside], *place, counts)
    np.testing.assert_array_equal(counts[:, :3], np.diag(np.bincount(zones[inside], minlength=3)))
    assert counts[:, 3:].sum() == 0


def test_random_numbers_are_uniform_and_independent():
    """Chi square of 100 cells, of pairs along a sequence and across keys: within 5 standard deviations (6e-7 each)."""
    keys, numbers = 300, 300
    u = np.array([[random_unit(np.uint64(key), k) for k in range(numbers)] for key in range(keys)])
    assert u.min() > 0.0
    assert u.max() < 1.0
    for x, y in ((u[:, :-1], u[:, 1:]), (u[:-1], u[1:]), (u[:, :-3], u[:, 3:])):
        cells = np.histogram2d(x.ravel(), y.ravel(), bins=10, range=[[0, 1], [0, 1]])[0]
        chi = ((cells - x.size / 100) ** 2 / (x.size / 100)).sum()
        assert abs(chi - 99) < 5 * np.sqrt(2 * 99)


def test_with_the_compiler_off_the_counts_are_the_same():
    # the numbers of unsigned integers wrap around in numpy as compiled, but numpy warns of it
    done = subprocess.run(
        [sys.executable, "-W", "ignore::RuntimeWarning", "-m", "oracles.enclosure_counts"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == enclosure_counts.counts()
