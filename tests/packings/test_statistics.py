"""Statistics beside a wall: exact beds, hand-counted contacts, averages, and the honesty of the errors."""

import dataclasses
import functools
import itertools
import math

import numpy as np
import pytest
import scipy.stats

import bedrad
from bedrad.packings.layers import layer_volumes
from bedrad.packings.wall_contacts import closing_distance, hexagonal_maximum, particle_volume
from bedrad.walls import Window
from oracles.beds import random_bed
from oracles.layers_beds import free_gas, hexagonal_sheet, staggered_rings

BALL = 4.0 / 3.0 * math.pi
WALLS = {
    "tube": (bedrad.Tube(9.0), 40.0),
    "rod": (bedrad.Rod(5.0), 40.0),
    "plate": (bedrad.Plate(), (40.0, 30.0)),
}


def _row(wall, gaps, spacing=4.0, radii=1.0):
    """Spheres in a row along the axis at given gaps (in radii), one a block of `spacing`, periodic."""
    gaps = np.asarray(gaps, dtype=float)
    r = np.broadcast_to(radii, gaps.shape)
    depth, along = r * (1.0 + gaps), spacing * (np.arange(len(gaps)) + 0.5)
    zero = np.zeros(len(gaps))
    if wall.kind == "plate":
        return bedrad.Packing(np.c_[along, zero, depth], r, wall, period=(spacing * len(gaps), 10.0))
    radial = wall.radius - depth if wall.kind == "tube" else wall.radius + depth
    return bedrad.Packing(np.c_[radial, zero, along], r, wall, period=spacing * len(gaps))


# ---- contacts ----

COVERAGE = {  # spheres a ring: wall coverage n_C pi r^2 of staggered rings, as tabulated to ten digits
    2: 0.3535533906,
    3: 0.4263045547,
    4: 0.4925857155,
    5: 0.5439833603,
    6: 0.5843854472,
    7: 0.6168374642,
    8: 0.6434268956,
    10: 0.6843367279,
    20: 0.7818070542,
}


@pytest.mark.parametrize("count", COVERAGE)
def test_staggered_rings_have_the_known_coverage(count):
    bed = staggered_rings(count)
    stats = bedrad.statistics(bed, blocks=2)
    assert stats.contacts_per_area * np.pi == pytest.approx(COVERAGE[count], abs=1e-10)
    assert stats.contacts == len(bed) == stats.spheres
    assert (stats.no_contacts, stats.nc_share) == (0, 0.0)
    assert math.isnan(stats.nc_distance)
    assert math.isnan(stats.nc_distance_closing)
    # two equal rings, two equal blocks
    assert stats.contacts_per_area_error == pytest.approx(0.0, abs=1e-12)
    assert stats.packing_fraction_error == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("count", "excess"), [(5, 5.0), (10, 1.2), (20, 0.3)])
def test_hexagonal_maximum_exceeds_staggered_rings_as_published(count, excess):
    ratio = bedrad.statistics(staggered_rings(count)).contact_ratio
    assert round(100 * (1 / ratio - 1), 1) == excess


def test_rings_around_a_rod_fall_short_of_the_hexagonal_maximum_by_as_little():
    # centres on the same cylinder as the rings inside a tube: the same share of the ideal sheet
    for count in (10, 20, 40):
        rod, tube = (bedrad.statistics(staggered_rings(count, convex)) for convex in (True, False))
        assert rod.contact_ratio == pytest.approx(tube.contact_ratio, rel=1e-12)
        assert rod.contact_ratio < 1.0
    assert rod.contact_ratio == pytest.approx(1.0, abs=1e-3)


def test_hexagonal_sheet_is_the_maximum():
    stats = bedrad.statistics(hexagonal_sheet(4, 3), blocks=4)
    assert stats.contact_ratio == pytest.approx(1.0, rel=1e-14)
    assert stats.contacts_per_area == pytest.approx(1 / (2 * math.sqrt(3)), rel=1e-14)
    assert stats.packing_fraction == pytest.approx(np.pi / (3 * np.sqrt(3)), rel=1e-13)


def test_hexagonal_maximum_on_curved_walls():
    flat = hexagonal_maximum(bedrad.Plate(), 3e-4)
    assert flat == pytest.approx(1 / (2 * math.sqrt(3) * 9e-8))
    assert hexagonal_maximum(bedrad.Tube(3.87e-3), 3e-4) == pytest.approx(flat * (1 - 1 / 12.9))
    assert hexagonal_maximum(bedrad.Rod(3.87e-3), 3e-4) == pytest.approx(flat * (1 + 1 / 12.9))


@pytest.mark.parametrize("kind", WALLS)
def test_contacts_are_counted_within_every_tolerance(kind):
    wall = WALLS[kind][0]
    gaps = [-0.01, 0.5e-4, 0.5e-3, 0.5e-2, 0.015, 0.04, 0.3, 0.9, 1.5]
    bed = _row(wall, gaps)
    stats = bedrad.statistics(bed, contact_gap=0.02, blocks=3)
    assert stats.gap_tolerances.tolist() == [0.0, 1e-4, 1e-3, 1e-2, 0.02, 0.05]
    counts = stats.contacts_per_area_by_gap * wall.area(stats.window)
    assert counts == pytest.approx([1, 2, 3, 4, 5, 6], rel=1e-12)
    assert stats.contact_ratio_by_gap == pytest.approx(
        stats.contacts_per_area_by_gap / hexagonal_maximum(wall, 1.0), rel=1e-14
    )
    assert (stats.contacts, stats.no_contacts) == (5, 3)
    assert stats.nc_share == 3 / 8
    assert stats.contacts_per_area == stats.contacts_per_area_by_gap[4]


def test_tolerance_is_in_the_spheres_own_radius():
    bed = _row(bedrad.Plate(), [0.009, 0.011, 0.009, 0.011], radii=[0.2, 0.2, 1.9, 1.9])
    assert bedrad.statistics(bed, blocks=1).contacts == 2


# ---- particles without contact ----


@pytest.mark.parametrize("kind", WALLS)
def test_the_averages_of_the_distance(kind):
    wall = WALLS[kind][0]
    gaps = np.array([0.0, 0.0, 0.1, 0.3, 0.8])
    bed = _row(wall, gaps)
    stats = bedrad.statistics(bed, blocks=1)
    assert stats.nc_distance == pytest.approx(0.4, rel=1e-12)
    volumes = np.array([particle_volume(wall, 1.0, gap, 1.0) for gap in gaps[2:]])
    assert stats.nc_distance_weighted == pytest.approx(volumes @ gaps[2:] / volumes.sum(), rel=1e-12)
    # the closing distance is the gap of a sphere of the mean volume
    closed = particle_volume(wall, 1.0, stats.nc_distance_closing, 1.0)
    assert closed == pytest.approx(volumes.mean(), rel=1e-11)
    assert stats.nc_distance_weighted < stats.nc_distance_closing < stats.nc_distance


@pytest.mark.parametrize("kind", WALLS)
def test_one_gap_is_every_average(kind):
    bed = _row(WALLS[kind][0], [0.0, 0.22, 0.0, 0.22, 0.22])
    stats = bedrad.statistics(bed, blocks=5)
    for value in (stats.nc_distance, stats.nc_distance_weighted, stats.nc_distance_closing):
        assert value == pytest.approx(0.22, abs=1e-11)
    for error in (stats.nc_distance_error, stats.nc_distance_weighted_error, stats.nc_distance_closing_error):
        assert error == pytest.approx(0.0, abs=1e-10)


def test_the_balance_is_equation_31():
    # phi = 2 A (V_C n_C + V_NC n_NC)/(r (2 A - 1))
    bed = _row(bedrad.Tube(12.9), [0.0, 0.3, 0.0, 0.5])
    stats = bedrad.statistics(bed, blocks=2)
    area = bed.wall.area(stats.window)
    touching, apart = (particle_volume(bed.wall, 1.0, gap, 1.0) for gap in (0.0, stats.nc_distance_closing))
    fraction = 2 * 12.9 * (touching * 2 + apart * 2) / area / (2 * 12.9 - 1)
    assert stats.packing_fraction == pytest.approx(fraction, rel=1e-12)


def test_particle_volume_over_a_plate_is_a_cap():
    for gap in (0.0, 0.22, 0.9):
        cap = np.pi / 3 * (1 - gap) ** 2 * (2 + gap) * 8
        assert particle_volume(bedrad.Plate(), 2.0, gap, 2.0) == pytest.approx(cap, rel=1e-14)


def test_a_balance_that_cannot_close_gives_nan():
    wall = bedrad.Plate()
    assert math.isnan(closing_distance(wall, 1.0, 1.0, solid=1.0, contacts=0.1, no_contacts=0.0))
    # more solid than touching particles hold, and less than those in contact
    assert math.isnan(closing_distance(wall, 1.0, 1.0, solid=1.0, contacts=0.1, no_contacts=0.1))
    assert math.isnan(closing_distance(wall, 1.0, 1.0, solid=0.1, contacts=0.1, no_contacts=0.1))
    # a tube with no room for a gap
    assert math.isnan(closing_distance(bedrad.Tube(1.0), 1.0, 1.0, solid=0.1, contacts=0.0, no_contacts=0.1))


# ---- windows, counts, profile ----


@functools.cache
def _open_bed(kind):
    wall = {"tube": bedrad.Tube(5.0), "rod": bedrad.Rod(2.0), "plate": bedrad.Plate()}[kind]
    return random_bed(wall, 70, seed=8, length=8.0, spread=3.5)


@pytest.mark.parametrize("kind", WALLS)
def test_fractions_are_exact_volumes_over_exact_layers(kind):
    bed = _open_bed(kind)
    window = Window((1.0, 7.0), (1.5, 6.0) if kind == "plate" else None)
    edges = [0.0, 0.4, 1.2, 2.0]
    stats = bedrad.statistics(bed, edges, window=window, blocks=3)
    layers = [bed.wall.layer_volume(a, b, window) for a, b in itertools.pairwise(edges)]
    expected = layer_volumes(bed, edges, window).sum(axis=0) / layers
    assert stats.packing_fractions == pytest.approx(expected, rel=1e-13)
    assert stats.packing_fraction == stats.packing_fractions[0]
    bins = [bed.wall.layer_volume(a, b, window) for a, b in itertools.pairwise(stats.profile_depths)]
    assert stats.profile @ bins == pytest.approx(expected @ layers, rel=1e-13)
    assert np.diff(stats.profile_depths).max() <= 0.05 * bed.mean_diameter * (1 + 1e-9)


def test_window_ends_are_half_open_and_counts_add_up():
    bed = _row(bedrad.Tube(9.0), [0.0] * 6)
    halves = [bedrad.statistics(bed, window=Window((a, a + 12.0)), blocks=1) for a in (2.0, 14.0)]
    assert [s.contacts for s in halves] == [3, 3]
    assert halves[0].left_out == {"outside_window": 3, "deeper": 0}
    # over the seam of the period, and a whole period from anywhere
    assert bedrad.statistics(bed, window=Window((-10.0, 2.0)), blocks=1).contacts == 3
    for start in (0.1, 2.0, -7.3):
        assert bedrad.statistics(bed, window=Window((start, start + 24.0)), blocks=4).contacts == 6


def test_lateral_window_counts_too():
    bed = hexagonal_sheet(4, 4)
    window = Window((0.0, 8.0), (0.0, 4 * math.sqrt(3)))
    stats = bedrad.statistics(bed, window=window, blocks=2)
    assert stats.spheres == 16
    assert stats.contact_ratio == pytest.approx(1.0, rel=1e-12)


def test_deep_spheres_are_left_out():
    bed = bedrad.Packing([[0, 0, 1.0], [3, 0, 9.0], [6, 0, 1.2]], 1.0, bedrad.Plate(), period=(9.0, 3.0))
    stats = bedrad.statistics(bed, blocks=1)
    assert stats.left_out == {"outside_window": 0, "deeper": 1}
    assert (stats.spheres, stats.contacts, stats.no_contacts) == (3, 1, 1)


def test_a_narrow_tube_has_fewer_layers():
    stats = bedrad.statistics(bedrad.Packing([[0, 0, 1.0]], 1.0, bedrad.Tube(2.7), period=3.0), blocks=1)
    assert stats.edges == pytest.approx([0.0, 1.0])


def test_given_profile_depths_are_used():
    stats = bedrad.statistics(hexagonal_sheet(2, 2), profile_depths=[0.0, 0.5, 2.0])
    y = np.array([0.0, 0.5, 2.0])
    filled = np.pi / (2 * np.sqrt(3)) * (y**2 - y**3 / 3)
    assert stats.profile == pytest.approx(np.diff(filled) / np.diff(y), rel=1e-13)


@pytest.mark.parametrize(("first", "second", "distance"), [(1.0, 1.0, 1.95), (1.0, 0.4, 1.37), (1.0, 0.2, 0.5)])
def test_overlap_share_is_the_lens_of_two_spheres(first, second, distance):
    bed = bedrad.Packing([[0, 0, 1], [distance, 0, 1]], [first, second], bedrad.Plate(), (9.0, 9.0), max_overlap=4.0)
    stats = bedrad.statistics(bed, [0.0, 1.0], blocks=1)
    # each sphere's cap beyond the plane through the circle where they meet
    x = (distance**2 + first**2 - second**2) / (2 * distance)
    caps = [np.pi / 3 * (r - d) ** 2 * (2 * r + d) for r, d in ((first, x), (second, distance - x))]
    lens = sum(caps) if distance > abs(first - second) else BALL * second**3
    assert stats.overlap_share == pytest.approx(lens / (BALL * (first**3 + second**3)), rel=1e-12)
    # with one of them outside the window, half the lens over the other's volume
    half = bedrad.statistics(bed, [0.0, 1.0], window=Window((-0.1, 0.3), (-2, 2)), blocks=1)
    assert half.overlap_share == pytest.approx(0.5 * lens / (BALL * first**3), rel=1e-12)


def test_overlaps_out_of_reach_do_not_count():
    bed = bedrad.Packing([[0, 0, 1], [3, 0, 9], [4.9, 0, 9]], 1.0, bedrad.Plate(), period=(9.0, 9.0))
    assert bedrad.statistics(bed, [0.0, 1.0], blocks=1).overlap_share == 0.0


# ---- errors ----

SEEDS = 150
FALSE_ALARM = 1e-5  # of each comparison below, two-sided


@functools.cache
def _gas_runs(kind):
    wall, length = WALLS[kind]
    edges = [0.0, 1.0, 3.0]
    return [bedrad.statistics(free_gas(wall, seed, 500, length), edges, profile_depths=edges) for seed in range(SEEDS)]


@pytest.mark.parametrize("kind", WALLS)
@pytest.mark.parametrize(
    "name",
    [
        "packing_fraction",
        "contacts_per_area",
        "contact_ratio",
        "nc_share",
        "nc_distance",
        "nc_distance_weighted",
        "nc_distance_closing",
    ],
)
def test_block_errors_match_the_scatter_of_independent_beds(kind, name):
    runs = _gas_runs(kind)
    values = np.array([getattr(s, name) for s in runs])
    errors = np.array([getattr(s, name + "_error") for s in runs])
    # variance of 150 values over the mean squared error, of 7 degrees of freedom each: an F distribution with
    # a width of 12 %. Cut volumes of neighbouring blocks share spheres, and these blocks are only five radii
    # long: over 2000 beds the solid fraction's ratio comes to 1.13; the others lie between 0.94 and 1.01.
    ratio = values.var(ddof=1) / np.mean(errors**2)
    low, high = scipy.stats.f.ppf([FALSE_ALARM / 2, 1 - FALSE_ALARM / 2], SEEDS - 1, 7 * SEEDS)
    assert low < ratio < high


@pytest.mark.parametrize("kind", WALLS)
def test_errors_of_counts_are_poisson(kind):
    wall, _ = WALLS[kind]
    runs = _gas_runs(kind)
    area = wall.area(runs[0].window)
    expected = 0.4 * 500 / area**2
    variances = np.array([s.contacts_per_area_error**2 for s in runs])
    low, high = scipy.stats.chi2.ppf([FALSE_ALARM / 2, 1 - FALSE_ALARM / 2], 7 * SEEDS) / (7 * SEEDS)
    assert low < variances.mean() / expected < high
    # and the values are normal about the truth with that width
    score = (np.mean([s.contacts_per_area for s in runs]) - 200 / area) / math.sqrt(expected / SEEDS)
    assert abs(score) < scipy.stats.norm.isf(FALSE_ALARM / 2)


def test_jackknife_of_a_mean_is_the_textbook_error():
    bed = _open_bed("tube")
    stats = bedrad.statistics(bed, [0.0, 1.0], window=Window((0.0, 8.0)), blocks=4)
    pieces = [bedrad.statistics(bed, [0.0, 1.0], window=Window((a, a + 2.0)), blocks=1) for a in (0.0, 2.0, 4.0, 6.0)]
    for name in ("packing_fraction", "contacts_per_area", "contact_ratio"):
        values = [getattr(piece, name) for piece in pieces]
        assert getattr(stats, name) == pytest.approx(np.mean(values), rel=1e-12)
        assert getattr(stats, name + "_error") == pytest.approx(np.std(values, ddof=1) / 2, rel=1e-9)
    profile = [piece.profile for piece in pieces]
    assert stats.profile_error == pytest.approx(np.std(profile, axis=0, ddof=1) / 2, rel=1e-9, abs=1e-15)


def test_errors_without_blocks_or_particles_are_nan():
    stats = bedrad.statistics(_row(bedrad.Tube(9.0), [0.0, 0.3, 0.0, 0.0]), blocks=1)
    for field in dataclasses.fields(stats):
        if field.name.endswith("_error"):
            assert np.isnan(getattr(stats, field.name)).all(), field.name
    # one NC particle: without its block there is no distance to average
    stats = bedrad.statistics(_row(bedrad.Tube(9.0), [0.0, 0.3, 0.0, 0.0]), blocks=4)
    assert stats.nc_distance == pytest.approx(0.3)
    assert math.isnan(stats.nc_distance_error)
    assert stats.nc_share_error > 0


# ---- the result ----


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"contact_gap": -0.1}, r"contact_gap is -0\.1"),
        ({"contact_gap": math.nan}, "contact_gap is nan"),
        ({"blocks": 0}, "blocks is 0"),
        ({"edges": [0.1, 1.0]}, r"first edge is 0\.1 m"),
        ({"edges": [0.0, 9.9]}, r"last edge is 9\.9 m"),
        ({"profile_depths": [0.0, 0.0]}, "rise"),
        ({"window": Window((2.5, 3.5))}, "no sphere has its centre"),
        ({"window": Window((0.0, 99.0))}, "longer than the period"),
    ],
)
def test_nonsense_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        bedrad.statistics(_row(bedrad.Tube(9.0), [0.0, 0.1]), **arguments)


def test_an_empty_packing_is_refused():
    with pytest.raises(ValueError, match="empty"):
        bedrad.statistics(bedrad.Packing([], 1.0, bedrad.Tube(9.0), period=3.0))


def test_a_bed_too_short_for_its_ends_is_refused():
    with pytest.raises(ValueError, match="leaves nothing to measure"):
        bedrad.statistics(_open_bed("tube"), margin=9.0)


def test_the_result_is_frozen():
    stats = bedrad.statistics(hexagonal_sheet(2, 2))
    with pytest.raises(dataclasses.FrozenInstanceError):
        stats.contacts = 3
    for field in dataclasses.fields(stats):
        value = getattr(stats, field.name)
        if isinstance(value, np.ndarray):
            assert not value.flags.writeable, field.name
    assert stats.seconds > 0


def test_the_result_reads_well():
    bed = _row(bedrad.Tube(9e-3), [0.0, 0.22, 0.0, 0.22], spacing=4e-3, radii=1e-3)
    text = str(bedrad.statistics(bed, blocks=2))
    assert "4 spheres, 2 in contact (gap <= 0.01 r), 2 without contact (NC)" in text
    assert "mean diameter 2000 um" in text
    assert "NC distance, plain mean" in text
    assert "gap <= 0.05 r" in text
    assert "0.22 ± " in text
    assert max(len(line) for line in text.splitlines()) < 140
