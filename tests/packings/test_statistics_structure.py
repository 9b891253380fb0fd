"""What depends on the tolerance, distributions of gaps, profiles of centres, and beds of two sizes."""

import itertools
import math

import numpy as np
import pytest

import bedrad
from bedrad.packings.wall_contacts import hexagonal_maximum, particle_volume, wall_gaps
from oracles.beds import random_bed
from oracles.layers_beds import free_gas, hexagonal_sheet


def row(gaps, radii=1.0, spacing=4.0):
    """Spheres in a row on a plate, at given gaps in their own radii."""
    gaps = np.asarray(gaps, dtype=float)
    r = np.broadcast_to(radii, gaps.shape)
    along = spacing * (np.arange(len(gaps)) + 0.5)
    centers = np.c_[along, 0 * along, r * (1 + gaps)]
    return bedrad.Packing(centers, r, bedrad.Plate(), period=(spacing * len(gaps), 10.0))


# ---- against the tolerance ----


def test_the_share_without_contact_falls_with_the_tolerance():
    # the seventh lies too deep to have volume in the wall layer
    stats = bedrad.statistics(row([-0.01, 5e-5, 5e-4, 5e-3, 0.04, 0.6, 1.5]), blocks=1)
    assert stats.gap_tolerances.tolist() == [0.0, 1e-4, 1e-3, 1e-2, 5e-2]
    assert stats.nc_share_by_gap == pytest.approx(np.array([5, 4, 3, 2, 1]) / 6)
    assert stats.nc_share == stats.nc_share_by_gap[3]
    # particles, not volumes, are shared out: with one tolerance more nothing else changes
    finer = bedrad.statistics(row([-0.01, 5e-5, 5e-4, 5e-3, 0.04, 0.6, 1.5]), contact_gap=0.3, blocks=1)
    assert finer.nc_share_by_gap == pytest.approx(np.array([5, 4, 3, 2, 1, 1]) / 6)


def test_shares_and_contacts_agree_at_every_tolerance():
    bed = free_gas(bedrad.Tube(8.0), seed=3, mean_count=400, length=30.0)
    stats = bedrad.statistics(bed)
    gaps = wall_gaps(bed)
    for k, tolerance in enumerate(stats.gap_tolerances):
        touching, apart = (gaps <= tolerance).sum(), ((gaps > tolerance) & (gaps < 1)).sum()
        assert stats.nc_share_by_gap[k] == pytest.approx(apart / (apart + touching))
    assert np.all(stats.nc_share_by_gap_error > 0)


# ---- distribution of the gaps ----


def test_gaps_come_into_their_bins():
    stats = bedrad.statistics(row([0.0, 0.02, 0.06, 0.07, 0.97, 0.3]), blocks=1)
    assert stats.nc_gap_edges == pytest.approx(np.linspace(0, 1, 21))
    counts = stats.nc_gap_density * 0.05 * 5
    assert np.flatnonzero(counts.round(9)).tolist() == [0, 1, 6, 19]
    assert counts[[0, 1, 6, 19]] == pytest.approx([1, 2, 1, 1])
    assert stats.nc_gap_beyond == 0.0


def test_the_distribution_adds_up_and_has_its_mean():
    bed = free_gas(bedrad.Tube(8.0), seed=5, mean_count=900, length=60.0)
    stats = bedrad.statistics(bed)
    assert stats.nc_gap_density.sum() * 0.05 == pytest.approx(1.0)
    middle = 0.5 * (stats.nc_gap_edges[1:] + stats.nc_gap_edges[:-1])
    assert (stats.nc_gap_density * middle).sum() * 0.05 == pytest.approx(stats.nc_distance, abs=0.02)
    # gaps of the gas are uniform from 0.02: one in 0.98 a radius, each bin within 5 of its errors
    z = (stats.nc_gap_density[1:] - 1 / 0.98) / stats.nc_gap_density_error[1:]
    assert np.abs(z).max() < 5
    assert np.sqrt(np.mean(z**2)) == pytest.approx(1.0, abs=0.6)


def test_small_spheres_may_lie_beyond_the_last_bin():
    # the layer is as thick as the mean radius, 0.6: spheres of 0.2 lie in it up to a gap of 2
    stats = bedrad.statistics(row([0.0, 0.5, 1.5, 3.5], radii=[1.0, 1.0, 0.2, 0.2]), blocks=1)
    assert stats.edges[1] == pytest.approx(0.6)
    assert stats.nc_gap_beyond == pytest.approx(0.5)
    assert stats.nc_gap_density.sum() * 0.05 == pytest.approx(0.5)


# ---- profiles of centres ----


def test_touching_particles_come_into_the_middle_of_a_bin():
    stats = bedrad.statistics(hexagonal_sheet(3, 2), blocks=2)
    assert stats.centre_depths[[0, 1, -1]] == pytest.approx([0.0, 0.05, 5.0])
    filled = np.flatnonzero(stats.centre_density)
    assert filled.tolist() == [10]
    assert stats.centre_depths[[10, 11]] == pytest.approx([0.95, 1.05])
    assert stats.centre_density[10] == pytest.approx(0.5 / math.sqrt(3) / 0.1)
    # three contacts a sphere, in the same bin
    assert np.flatnonzero(stats.contact_density).tolist() == [10]
    assert stats.contact_density[10] == pytest.approx(3 * stats.centre_density[10])


@pytest.mark.parametrize(
    ("wall", "length"), [(bedrad.Tube(8.0), 40.0), (bedrad.Rod(4.0), 40.0), (bedrad.Plate(), (30.0, 25.0))]
)
def test_centres_per_volume_are_counts_over_exact_volumes(wall, length):
    bed = free_gas(wall, seed=6, mean_count=500, length=length, deepest=4.0)
    depths = np.array([0.0, 0.9, 1.1, 2.0, 3.5])
    stats = bedrad.statistics(bed, [0.0, 1.0, 3.0], profile_depths=depths)
    volumes = [wall.layer_volume(a, b, stats.window) for a, b in itertools.pairwise(depths)]
    counts, _ = np.histogram(bed.depths, depths)
    assert stats.centre_density * volumes == pytest.approx(counts)
    # a Poisson number of spheres on the wall: the error is its root
    assert stats.centre_density_error[1] * volumes[1] == pytest.approx(math.sqrt(counts[1]), rel=0.8)


# ---- several sizes ----


def test_the_number_mean_sets_lengths_and_each_sphere_its_own_gap():
    # two of three are small: number mean radius 0.5, Sauter and volume-weighted well above
    radii = np.tile([0.25, 0.25, 1.0], 8)
    gaps = np.tile([0.005, 0.3, 0.015], 8)
    stats = bedrad.statistics(row(gaps, radii), blocks=4)
    assert stats.mean_diameter == pytest.approx(1.0)
    assert stats.sauter_diameter == pytest.approx(2 * (2 * 0.25**3 + 1) / (2 * 0.25**2 + 1))
    assert stats.volume_mean_diameter == pytest.approx(2 * (2 * 0.25**4 + 1) / (2 * 0.25**3 + 1))
    assert stats.edges == pytest.approx([0.0, 0.5, 1.5, 2.5])
    assert stats.profile_depths[1] == pytest.approx(0.05)
    # contacts by own radii: only the first of each three
    assert (stats.contacts, stats.no_contacts) == (8, 16)
    assert stats.nc_distance == pytest.approx((0.3 + 0.015) / 2)
    volumes = [particle_volume(stats.wall, r, gap, 0.5) for r, gap in ((0.25, 0.3), (1.0, 0.015))]
    assert stats.nc_distance_weighted == pytest.approx(np.average([0.3, 0.015], weights=volumes))
    # the hexagonal maximum at the number-mean radius
    area = stats.wall.area(stats.window)
    assert stats.contact_ratio == pytest.approx(8 / area / hexagonal_maximum(stats.wall, 0.5))


def test_equal_spheres_have_one_mean_diameter():
    stats = bedrad.statistics(hexagonal_sheet(2, 2))
    assert stats.sauter_diameter == pytest.approx(stats.mean_diameter) == pytest.approx(stats.volume_mean_diameter)


def test_layers_of_spheres_go_by_their_near_side():
    bed = random_bed(bedrad.Tube(6.0), 80, seed=2, length=8.0, spread=4.5, period=8.0)
    edges = [0.0, 0.3, 1.1, 2.0]
    stats = bedrad.statistics(bed, edges, blocks=2, contact_gap=0.05)
    near_side = bed.depths - bed.radii
    counts, _ = np.histogram(near_side, edges)
    assert (near_side < 2.0).sum() < len(bed)
    assert counts[0] == stats.no_contacts + stats.contacts
    # shares of contact numbers are over the spheres of all layers, whose mean is the mean over the layers
    mean = np.average(stats.coordination, weights=counts)
    assert stats.contact_number_shares @ np.arange(14) == pytest.approx(mean)
    assert mean > 0.05
