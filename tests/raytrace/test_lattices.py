"""Radiation between the spheres of lattices and beds, by emission from their surfaces and the kernel `first_hit`.

Lattices fill all space: `first_hit` gets a grid that is periodic along three axes. Shells of neighbours are compared
with an independent calculation in 4 combined standard errors; 20 shells, a false alarm in 800 changes of seed. Seeds
are fixed.
"""

import itertools
from functools import cache

import numpy as np
import pytest

import bedrad
from bedrad.raytrace.kernels import ESCAPED
from bedrad.raytrace.scene import build_scene
from oracles.beds import random_bed
from oracles.emission import distances, hit, lattice_grid, nearest_spheres, scene_grid, surface_rays
from oracles.references import lattice_shells

CUBE = {"SC": 2.0, "FCC": 2.0 * np.sqrt(2.0)}
IN_CUBE = {"SC": [[0.0, 0.0, 0.0]], "FCC": [[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]]}

RAYS = {"SC": 2**21, "FCC": 2**22}
BATCH = 2**18


def lattice_point(points, lattice):
    """The lattice point nearest to each point, which is the sphere that it lies on."""
    if lattice == "SC":
        return 2.0 * np.round(points / 2.0)
    # FCC: whole numbers of an even sum, in units of sqrt(2); where it is odd, the worst rounded one goes the other way
    x = points / np.sqrt(2.0)
    whole = np.round(x)
    odd = np.flatnonzero(whole.sum(axis=1) % 2 == 1)
    worst = np.abs(x - whole)[odd].argmax(axis=1)
    whole[odd, worst] += np.where(x[odd, worst] > whole[odd, worst], 1.0, -1.0)
    return np.sqrt(2.0) * whole


@cache
def flights(lattice):
    """Distances between the centres of the sphere where each ray started and the one where it ended."""
    rng, edge = np.random.default_rng(1), CUBE[lattice]
    grid = lattice_grid(edge * np.array(IN_CUBE[lattice]), 1.0, edge, 2)
    found = []
    for _ in range(RAYS[lattice] // BATCH):
        origins, directions = surface_rays(rng, np.zeros(3), 1.0, BATCH)
        inside = origins % edge
        inside[inside == edge] = 0.0  # the remainder of a tiny negative number
        t = distances(grid, inside, directions)
        assert hit(t).all()
        ends = origins + t[:, None] * directions
        centers = lattice_point(ends, lattice)
        # every ray ends on the sphere of that lattice point, after any number of periods
        np.testing.assert_allclose(np.linalg.norm(ends - centers, axis=1), 1.0, rtol=0, atol=1e-8)
        found.append(np.linalg.norm(centers, axis=1))
    return np.concatenate(found)


@pytest.mark.parametrize("lattice", ["SC", "FCC"])
def test_shells_of_neighbours_get_their_share(lattice):
    found, shells, rays = flights(lattice), lattice_shells(lattice), RAYS[lattice]
    compared = 0
    for distance, _, share, error in shells:
        count = int((np.abs(found - distance) < 1e-5).sum())
        if share == 0.0:
            # behind other spheres; a share that the reference could just not see would give 0.4 hits here
            assert count == 0
        elif share * rays > 25:
            sigma = np.sqrt(share * (1.0 - share) / rays + error**2)
            assert abs(count / rays - share) < 4 * sigma, (distance, count / rays, share, sigma)
            compared += 1
    assert compared >= 8
    # no ray ends between the shells or on its own sphere; the rest is farther than the table
    met = np.unique(np.round(found[found < shells[-1][0] + 1e-5], 5))
    assert (np.abs(met[:, None] - [s[0] for s in shells]).min(axis=1) < 1e-5).all()


def test_exchange_factor_of_the_face_centred_lattice():
    """phi <(distance/diameter)^2> of black isothermal spheres; the rays' standard error is 2e-4."""
    samples = np.pi / np.sqrt(18.0) * (flights("FCC") / 2.0) ** 2
    assert samples.std() / np.sqrt(len(samples)) < 2.5e-4
    assert abs(samples.mean() - 0.873715) < 1e-3


@pytest.fixture(scope="module")
def exchange():
    """A random bed of unequal spheres over a plate; hits of each sphere by each (n, n), on the plate, into the open."""
    bed = random_bed(bedrad.Plate(), 60, seed=3, length=6.0, spread=3.5, period=(7.0, 6.0))
    grid = scene_grid(build_scene(bed, bed.window(), 5.0))
    rng = np.random.default_rng(2)
    n, rays = len(bed), 2**15
    between, plate, open_air = np.zeros((n, n)), np.zeros(n), np.zeros(n)
    for i in range(n):
        origins, directions = surface_rays(rng, bed.centers[i], bed.radii[i], rays)
        periods = np.where(np.array(bed.box) > 0, bed.box, np.inf)
        shift = np.zeros_like(origins)
        shift[:, :2] = np.floor(origins[:, :2] / periods[:2]) * periods[:2]
        t = distances(grid, origins - shift, directions)
        met = hit(t)
        ends = origins[met] + t[met, None] * directions[met]
        whose, off = nearest_spheres(ends, bed.centers, bed.radii, bed.box)
        assert off.max() < 1e-8
        between[i] = np.bincount(whose, minlength=n)
        assert (t[~met] == ESCAPED).all()
        plate[i] = (~met & (directions[:, 2] < 0)).sum()
        open_air[i] = (~met & (directions[:, 2] > 0)).sum()
    return bed, rays, between, plate, open_air


def test_rows_of_the_exchange_sum_to_one_and_no_sphere_sees_itself(exchange):
    _, rays, between, plate, open_air = exchange
    np.testing.assert_array_equal(between.sum(axis=1) + plate + open_air, rays)
    # a sphere may see its own image a period away, never itself; the large ones are nearer to it than to others
    assert between.diagonal().max() < 0.02 * rays
    assert (between.sum(axis=1) > 0.1 * rays).all()


def test_unequal_spheres_exchange_as_much_both_ways(exchange):
    """A_i F_ij = A_j F_ji for every pair with 100 hits or more: largest z of about 500 below 4.7 (false alarm 1e-3)
    and mean square 1 within 4 of its standard errors."""
    bed, rays, between, *_ = exchange
    area = 4.0 * np.pi * bed.radii**2
    z = []
    for i, j in itertools.combinations(range(len(bed)), 2):
        if between[i, j] + between[j, i] >= 100:
            p, q = between[i, j] / rays, between[j, i] / rays
            sigma = np.sqrt(area[i] ** 2 * p * (1 - p) + area[j] ** 2 * q * (1 - q)) / np.sqrt(rays)
            z.append((area[i] * p - area[j] * q) / sigma)
    assert len(z) > 300
    assert np.abs(z).max() < 4.7
    assert abs(np.square(z).mean() - 1.0) < 4 * np.sqrt(2.0 / len(z))


def test_the_plate_gives_the_spheres_what_they_give_the_plate(exchange):
    """Emission from the spheres against `view_factors` from the plate: A_w (sum of F_w,layer) = sum of A_i F_iw."""
    bed, rays, _, plate, _ = exchange
    found = bedrad.view_factors(bed, [0.0, 1.0, 5.0], rays=2**18, seed=3)
    wall = bed.wall.area(bed.window())
    area = 4.0 * np.pi * bed.radii**2
    share = (area * plate).sum() / rays / wall
    error = np.sqrt((area**2 * plate * (1.0 - plate / rays)).sum()) / rays / wall
    assert found.wall == found.escaped == 0.0
    assert abs(share - (1.0 - found.beyond)) < 4 * np.hypot(error, found.beyond_error)
