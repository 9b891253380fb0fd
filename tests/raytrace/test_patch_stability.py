"""The nasty scenes of test_stability.py through the patches: docs/stability.md, last column.

The very same rays, once settled by shells of spheres around their patch and once all followed through the grid, whose
ends test_stability.py holds against extended precision, must give the same counts in each half of each stratum. The two
part where rounding decides, within 1e-14 of a radius and so for less than one ray in 10^10; none does here.
"""

import numpy as np
import pytest

import bedrad
from bedrad.raytrace.patch_kernels import mix
from bedrad.raytrace.patches import PatchTracer
from bedrad.walls import Window
from oracles.beds import axial_chain, hexagonal_layer, random_bed
from oracles.layers_beds import hexagonal_sheet, staggered_rings
from oracles.nasty_beds import (
    WALLS,
    any_overlap,
    jittered_lattice,
    lined_sector,
    micrometres,
    moved,
    one_a_period,
    twice,
    two_sizes,
)
from oracles.patch_counts import patch_counts

EDGES = [0.0, 0.7, 2.0, 3.0]


def both_ways(tracer, strata, groups=None, kinds=3):
    """Counts by the shells, after a check that some shell settles rays, and by the grid."""
    shells = patch_counts(tracer, strata, groups=groups)
    grid = patch_counts(tracer, strata, hand_back=True, groups=groups)
    assert grid.handed_back == grid.rays == shells.rays
    assert shells.handed_back < 0.9 * shells.rays
    assert np.count_nonzero(shells.counts.sum(axis=(0, 1))) >= kinds
    return shells.counts, grid.counts


def agree(bed, edges, window=None, rays=2**16, kinds=3):
    tracer = PatchTracer(bed, np.array(edges), window or bed.window())
    np.testing.assert_array_equal(*both_ways(tracer, tracer.strata(rays, (1, 0)), kinds=kinds))


def groups_near(tracer, strata, inside):
    """Numbers of the groups whose middle, along the axis and around or across, is inside a piece of wall."""
    side = tracer.side(strata)
    around = -(-strata.around // side)
    along, across = np.divmod(np.arange(-(-strata.along // side) * around), around)
    start, length, low, width = strata.window
    z = start + length * (along + 0.5) * side / strata.along
    y = low + width * (across + 0.5) * side / strata.around
    return np.flatnonzero(inside(z, y))


@pytest.mark.parametrize("gap", [1e-9, 1e-7])
def test_a_gap_between_sphere_and_tube(gap):
    agree(axial_chain(1.0 + gap), [0.0, gap, 0.1, 0.5], Window((0.0, 2.0)), kinds=4)


@pytest.mark.parametrize(
    ("ratio", "rays"), [(2.2, 2**16), (12.9, 2**17), (1e2, 2**19), (1e3, 2**22), (1e4, 2**25)], ids=str
)
def test_a_lined_sector_of_a_tube_of_any_width(ratio, rays):
    """The patches on both sides of the tube; 10,000 rays or more from there."""
    bed, window = lined_sector(ratio, 3 if ratio < 3 else 24, seed=1)
    tracer = PatchTracer(bed, np.array([0.0, 1.0, 2.0]), window)
    strata = tracer.strata(rays, (1, 0))
    lined = groups_near(tracer, strata, lambda _, angle: np.abs(np.sin(angle)) < 5.0 / ratio)
    traced = 0
    for group in lined:
        # all strata of the group, some of which may see nothing
        shells = patch_counts(tracer, strata, groups=(group, group + 1))
        grid = patch_counts(tracer, strata, hand_back=True, groups=(group, group + 1))
        np.testing.assert_array_equal(shells.counts, grid.counts)
        traced += shells.rays
    assert traced > 10_000


@pytest.mark.parametrize("convex", [False, True], ids=["tube", "rod"])
@pytest.mark.parametrize("ratio", [1e2, 1e3, 1e4])
def test_a_lined_tube_or_rod_of_any_width(ratio, convex):
    agree(staggered_rings(round(np.pi * ratio), convex), [0.0, 1.0, 2.0], rays=2**17)


def test_radii_from_one_to_fifty():
    agree(two_sizes(6, 1000, 50.0, seed=1), [0.0, 0.02, 1.0, 2.5], rays=2**17)


@pytest.mark.parametrize("kind", WALLS)
def test_any_overlap_of_spheres_and_a_tenth_of_a_diameter_with_the_wall(kind):
    agree(any_overlap(kind), EDGES)


@pytest.mark.parametrize("kind", WALLS)
def test_every_sphere_twice(kind):
    wall, period = WALLS[kind]
    agree(twice(random_bed(wall, 60, seed=3, length=6.0, spread=3.5, period=period)), EDGES)


@pytest.mark.parametrize("bed", [hexagonal_layer(), staggered_rings(14), staggered_rings(14, convex=True)])
def test_spheres_that_touch_the_wall_and_each_other(bed):
    agree(bed, [0.0, 0.5, 1.0])


@pytest.mark.parametrize("cosine", [1e-2, 1e-3, 1e-4, 1.1e-5])
@pytest.mark.parametrize("gap", [0.0, 1e-3])
def test_grazing_rays_over_a_plate(cosine, gap):
    """One half's points have all the given angle; the smallest is that of the last point of 32 bits."""
    sheet = hexagonal_sheet(8, 6, gap)
    bed = bedrad.Packing(sheet.centers, sheet.radii, sheet.wall)  # without a period: what leaves has escaped
    tracer = PatchTracer(bed, np.array([0.0, 1e-4, 1e-2, 1.0]), Window((7.0, 8.0), (8.0, 9.0)))
    strata = tracer.strata(2**12, (1, 0))
    strata = strata._replace(along=1, around=1)
    # the same shift that the kernel draws for the first half of the first stratum turns these points into the angle
    with np.errstate(over="ignore"):
        shift = int(mix(mix(strata.seed) + np.uint64(0x3C6EF372FE94F82A))) & 0xFFFFFFFF
    net = strata.net.copy()
    net[2] = np.uint32(int((1.0 - cosine**2) * 2.0**32)) ^ np.uint32(shift)
    shells, grid = both_ways(tracer, strata._replace(net=net), kinds=2)
    np.testing.assert_array_equal(shells, grid)
    handed = patch_counts(tracer, strata._replace(net=net), hand_back=True).left
    np.testing.assert_allclose(handed[6, : net.shape[1]], cosine, rtol=0.3)


@pytest.mark.parametrize("kind", WALLS)
def test_micrometres_ten_kilometres_from_the_origin(kind):
    """Numbers there are 1.8e-6 radii apart, the shells' patch among them, so that each ray's end may turn with a
    chance of 3e-6: two of 140,000 rays may part."""
    bed, window = micrometres(kind)
    agree(bed, np.array(EDGES) * 1e-6, window, rays=2**17, kinds=4)
    far, window = moved(bed, window, 1e4)
    tracer = PatchTracer(far, np.array(EDGES) * 1e-6, window)
    shells, grid = both_ways(tracer, tracer.strata(2**17, (1, 0)), kinds=4)
    assert np.abs(shells - grid).sum() <= 2 * 2


@pytest.mark.parametrize(("kind", "fate"), [("tube", 3), ("rod", 2), ("plate", 2)])
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_empty_beds(kind, fate, size):
    wall, period = WALLS[kind]
    sized = wall if kind == "plate" else type(wall)(wall.radius * size)
    empty = bedrad.Packing(np.empty((0, 3)), 1.0, sized, period=tuple(size * np.atleast_1d(period)))
    tracer = PatchTracer(empty, np.array([0.0, 0.5, 1.0]) * size, empty.window())
    strata = tracer.strata(2**12, (1, 0))
    shells, grid = both_ways(tracer, strata, kinds=1)
    np.testing.assert_array_equal(shells, grid)
    assert (shells[:, :, fate] == strata.net.shape[1]).all()


@pytest.mark.parametrize("period", [1.9, 1.0, 0.3, 0.02])
@pytest.mark.parametrize("kind", WALLS)
def test_periods_shorter_than_a_diameter(kind, period):
    bed, window = one_a_period(kind, period)
    agree(bed, [0.0, 0.3, 0.9], window, rays=2**17)


def test_a_million_spheres():
    bed = jittered_lattice(500, 500, 4)
    agree(bed, [0.0, 1.0, 3.0, 5.0, 8.8], Window((540.0, 560.0), (540.0, 560.0)), rays=2**12, kinds=5)
