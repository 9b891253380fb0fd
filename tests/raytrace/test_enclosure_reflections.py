"""Rays that are reflected where they end, against closed forms and against zones of uniform radiosity.

Limits are 5 standard errors from 32 scramblings (Student, 31 degrees of freedom): a false alarm in 45,000 comparisons.
Seeds are fixed.
"""

from itertools import pairwise

import numpy as np
import pytest

import bedrad
from bedrad.heat import grey_enclosure
from bedrad.raytrace import enclosure
from bedrad.walls import Window
from oracles.beds import axial_chain, hexagonal_layer, random_bed
from oracles.nasty_beds import WALLS

EDGES = np.array([0.0, 0.7, 2.0, 3.0])


def shares(r):
    """Wall, layers, beyond, escaped, and their errors."""
    return (
        np.array([r.wall, *r.layers, r.beyond, r.escaped]),
        np.array([r.wall_error, *r.layers_error, r.beyond_error, r.escaped_error]),
    )


def by_zones(x, wall_emissivity, particle_emissivity):
    """Wall, layers, beyond, as absorbed of the wall's radiation if each zone has one radiosity; and its errors."""
    n = len(x.areas)

    def absorbed(matrix):
        closed, _ = grey_enclosure.with_cap(matrix[:, :n], matrix[:, n:].sum(axis=1), x.areas)
        eps = np.array([wall_emissivity, *np.full(n - 1, particle_emissivity), 1.0])
        row = grey_enclosure.absorption_factors(closed, eps)[0]
        layers = np.bincount(x.layer_of_zone[1:], weights=row[1:n])
        return np.array([row[0], *layers, row[n]])

    return absorbed(x.matrix), x.error_of(absorbed)


def bed_of(kind):
    wall, period = WALLS[kind]
    return random_bed(wall, 30, seed=3, length=6.0, spread=3.5, period=period)


@pytest.mark.parametrize("kind", WALLS)
def test_black_surfaces_absorb_what_view_factors_say(kind):
    bed = bed_of(kind)
    r = bedrad.reflected_factors(bed, 1.0, 1.0, EDGES, rays=2**17, seed=1)
    v = bedrad.view_factors(bed, EDGES, rays=2**17, seed=2)
    found, error = shares(r)
    expected = np.array([v.wall, *v.layers, v.beyond, v.escaped])
    other = np.array([v.wall_error, *v.layers_error, v.beyond_error, v.escaped_error])
    assert (np.abs(found - expected) <= 5 * np.hypot(error, other)).all()
    assert r.reflections == r.ended == 0
    assert found.sum() == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize(("eps_w", "eps_s"), [(1.0, 0.3), (0.3, 1.0), (0.2, 0.1), (0.0, 0.5)])
def test_two_infinite_plates(eps_w, eps_s):
    """Below a sphere of 10^5 times the gap a plate sees a plate, each of one radiosity; 2e-5 gets out each time."""
    gap = 1e-5
    bed = bedrad.Packing([[0.0, 0.0, 1.0 + gap]], 1.0, bedrad.Plate())
    window = Window((-gap, gap), (-gap, gap))
    r = bedrad.reflected_factors(bed, eps_w, eps_s, [0.0, 1.0], rays=2**16, seed=3, window=window)
    # absorbed by the sphere at once, or after any number of returns
    exact = eps_s / (1.0 - (1.0 - eps_w) * (1.0 - eps_s))
    swap = [[0.0, 1.0], [1.0, 0.0]]
    assert grey_enclosure.absorption_factors(swap, [eps_w, eps_s])[0, 1] == pytest.approx(exact, rel=1e-14)
    leaks = 2.0 * gap * (1.0 + r.reflections / r.rays)
    assert abs(r.layers[0] - exact) < 5 * r.layers_error[0] + leaks
    assert abs(r.wall - (1.0 - exact)) < 5 * r.wall_error + leaks


def test_reflections_of_a_closed_enclosure_of_one_emissivity():
    """Absorbed with probability eps wherever it ends: (1 - eps)/eps reflections, with a variance of (1 - eps)/eps^2."""
    r = bedrad.reflected_factors(axial_chain(3.0), 0.2, 0.2, [0.0, 3.0], rays=2**16, seed=4)
    assert abs(r.reflections / r.rays - 4.0) < 5 * np.sqrt(0.8 / 0.04 / r.rays)
    assert r.beyond == r.escaped == 0.0


def test_a_small_body_in_a_black_tube_absorbs_by_its_emissivity():
    """A sphere that sees the wall only: what it reflects is lost to the wall; its images are 60 radii off."""
    bed = bedrad.Packing([[0.0, 0.0, 30.0]], 1.0, bedrad.Tube(2.0), 60.0)
    exact = 4.0 * np.pi / (2.0 * np.pi * 2.0 * 60.0)
    for eps in (1.0, 0.25):
        r = bedrad.reflected_factors(bed, 1.0, eps, [0.0, 2.0], rays=2**17, seed=5)
        assert abs(r.layers[0] - eps * exact) < 5 * r.layers_error[0] + 3e-4 * eps * exact


def test_lit_and_shadow_side_of_a_lone_sphere():
    """Grey sphere over a black plate. Where the normal has the cosine c to the plate, (1 + c)/2 arrives and as much of
    what is reflected goes back: 2/3 of all. With one radiosity it is 1/2, with k ranges of c 2/3 - 1/(6 k^2): the
    difference falls with the square of k. Images, 12 radii off, and the horizon behind them change that by 1 %.
    """
    bed, eps = bedrad.Packing([[0.0, 0.0, 1.5]], 1.0, bedrad.Plate(), (12.0, 12.0)), 0.1
    seen = 2.0 * np.pi / 12.0**2 * (1.0 - eps)
    r = bedrad.reflected_factors(bed, 1.0, eps, [0.0, 5.0], rays=2**19, seed=6)
    back, error = r.wall / seen, r.wall_error / seen
    assert abs(back - 2.0 / 3.0) < 5 * error + 0.01
    zones = []
    for k in (1, 2, 4, 8):
        found, own = by_zones(bedrad.exchange_factors(bed, [0.0, 5.0], 2**18, seed=7, orientations=k), 1.0, eps)
        zones.append(found[0] / seen)
        assert own[0] / seen < 2e-3
        assert abs(back - zones[-1] - 1.0 / (6.0 * k * k)) < 5 * error + 0.01
    assert back - zones[0] > 20 * error
    assert abs(back - zones[3]) < 5 * error
    gains = np.diff(zones)
    np.testing.assert_allclose(np.log2(gains[:-1] / gains[1:]), 2.0, atol=0.15)


@pytest.mark.parametrize("eps", [0.3, 0.8])
def test_zones_reach_the_reflected_rays_where_they_follow_the_radiosity(eps):
    """Hexagonal touching layer, plate black, spheres grey. With one radiosity a sphere, light comes out of its far side
    as if it had shone through: 0.09 to 0.3 too little returns to the plate. With ranges of angle that falls to nothing.
    """
    bed = hexagonal_layer()
    r = bedrad.reflected_factors(bed, 1.0, eps, [0.0, 2.0], rays=2**17, seed=8)
    expected, error = (values[:3] for values in shares(r))
    off = []
    for orientations in (1, 4, 32):
        x = bedrad.exchange_factors(bed, [0.0, 2.0], rays=2**17, seed=9, orientations=orientations)
        found, own = by_zones(x, 1.0, eps)
        off.append(found - expected)
        assert own.max() < 1.5e-3
    assert off[0][0] < -50 * error[0]
    assert off[0][2] > 50 * error[2]
    assert (np.abs(off[1]) < 0.4 * np.abs(off[0])).all()
    assert (np.abs(off[2]) < 5 * np.hypot(error, own)).all()


def test_finer_zones_come_nearer_on_a_random_bed():
    bed = random_bed(bedrad.Tube(5.0), 90, seed=3, length=6.0, spread=3.5, period=6.0)
    r = bedrad.reflected_factors(bed, 0.5, 0.3, EDGES, rays=2**17, seed=10)
    expected, error = shares(r)
    expected, error = np.array([*expected[:4], expected[4:].sum()]), np.array([*error[:4], error[4]])
    off = []
    for parts in (1, 2, 4):
        fine = np.concatenate([[0.0], *(np.linspace(a, b, parts + 1)[1:] for a, b in pairwise(EDGES))])
        x = bedrad.exchange_factors(bed, fine, rays=2**18, seed=11, orientations=parts)
        found, own = by_zones(x, 0.5, 0.3)
        layers = found[1:-1].reshape(3, parts).sum(axis=1)
        off.append(np.abs(np.array([found[0], *layers, found[-1]]) - expected))
        assert own.max() < 2e-3
    total = np.array([o.sum() for o in off])
    assert total[0] > 20 * error.max()
    assert total[1] < 0.75 * total[0]
    assert total[2] < 0.75 * total[1]


def test_same_seed_same_answer_whatever_the_number_of_threads():
    bed = bed_of("rod")
    one, three = (bedrad.reflected_factors(bed, 0.5, 0.5, EDGES, rays=2**13, seed=7, threads=n) for n in (1, 3))
    np.testing.assert_array_equal(one.replicates, three.replicates)
    assert one.reflections == three.reflections
    other = bedrad.reflected_factors(bed, 0.5, 0.5, EDGES, rays=2**13, seed=8)
    assert (one.layers != other.layers).any()


def test_rays_that_nothing_absorbs_are_ended_and_told(monkeypatch):
    monkeypatch.setattr(enclosure, "MOST_REFLECTIONS", 20)
    empty = bedrad.Packing(np.empty((0, 3)), 1.0, bedrad.Tube(1.0), 2.0)
    r = bedrad.reflected_factors(empty, 0.0, 1.0, [0.0, 0.5], rays=64, seed=1)
    assert r.ended == r.rays == 64
    assert r.reflections == 20 * 64
    assert r.wall == 1.0
    assert "64 rays were ended before they were absorbed" in str(r)
    assert "emissivity 0 (wall), 1 (particles): 64 rays, 20.00 reflections each" in str(r)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wall_emissivity": 1.1}, "wall_emissivity is 1.1; expected a number from 0 to 1"),
        ({"particle_emissivity": 0.0}, "particle_emissivity is 0.0; expected a number from 0.001 to 1"),
        ({"particle_emissivity": np.nan}, "particle_emissivity is nan"),
        ({"rays": 0}, "rays is 0"),
        ({"edges": [0.1, 1.0]}, "the first must be 0"),
        ({"threads": -1}, "threads is -1"),
    ],
)
def test_refuses_what_has_no_meaning(change, message):
    good = {"wall_emissivity": 0.5, "particle_emissivity": 0.5, "edges": [0.0, 2.0], "rays": 64}
    with pytest.raises(ValueError, match=message):
        bedrad.reflected_factors(hexagonal_layer(), **(good | change))
