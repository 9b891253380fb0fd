"""The patch tracer ray by ray against the grid walk, its counts, its errors and its bins."""

import numpy as np
import pytest
from scipy import stats

import bedrad
from bedrad.packings.layers import check_window
from bedrad.raytrace.patch_kernels import make_room, trace_groups
from bedrad.raytrace.patches import PatchTracer, Sample, build_bins
from oracles.beds import axial_chain, hexagonal_layer, random_bed
from oracles.patch_counts import patch_counts

EDGES = np.array([0.0, 0.7, 2.0, 3.0])


def _bed(name):
    match name:
        case "tube" | "open tube":
            period = 6.0 if name == "tube" else None
            return random_bed(bedrad.Tube(5.0), 110, seed=3, length=24.0 if period is None else 6.0, spread=4.0,
                              period=period)  # fmt: skip
        case "narrow tube":
            return random_bed(bedrad.Tube(3.2), 25, seed=5, length=6.0, spread=2.6, period=6.0)
        case "rod" | "open rod":
            period = 6.0 if name == "rod" else None
            return random_bed(bedrad.Rod(2.0), 60, seed=3, length=16.0 if period is None else 6.0, spread=3.5,
                              period=period)  # fmt: skip
        case "plate":
            return random_bed(bedrad.Plate(), 60, seed=3, length=6.0, spread=3.5, period=(7.0, 6.0))
        case "open plate":
            return random_bed(bedrad.Plate(), 150, seed=3, length=16.0, spread=3.5)
        case "many sizes":
            return random_bed(bedrad.Plate(), 300, seed=6, length=6.0, spread=3.0, ratio=20.0, period=(6.0, 6.0))
    raise AssertionError(name)


BEDS = ["tube", "open tube", "narrow tube", "rod", "open rod", "plate", "open plate", "many sizes"]


@pytest.mark.parametrize("name", BEDS)
@pytest.mark.parametrize("rays", [2**10, 2**15, 2**18])
def test_patches_settle_every_ray_as_the_grid_does(name, rays):
    """The same rays, settled by shells of spheres around their patch and by the walk through the grid.

    Different rounding may part the two where a ray grazes a sphere or a layer's edge within 1e-15 of a radius: less
    than one ray in 10^12, so none here.
    """
    bed = _bed(name)
    tracer = PatchTracer(bed, EDGES, check_window(bed, None))
    strata = tracer.strata(rays, (1, 0), 2)
    by_shells, by_grid = patch_counts(tracer, strata), patch_counts(tracer, strata, hand_back=True)
    assert by_grid.handed_back == by_grid.rays
    assert by_shells.handed_back < by_shells.rays  # otherwise the grid would be compared with itself
    np.testing.assert_array_equal(by_shells.counts, by_grid.counts)
    assert (by_shells.counts.sum(axis=2) == strata.net.shape[1]).all()
    assert (by_shells.counts.sum(axis=(0, 1)) > 0).sum() >= 4 or rays < 2**15


def test_handed_back_rays_follow_the_cosine_law_from_the_whole_window():
    """Moments of the handed-back rays: uniform origins, <cos> = 2/3, <cos^2> = 1/2, no preferred azimuth.

    Stratified points scatter less than independent ones: limits of 5 standard errors of those, false alarm < 1e-5.
    """
    bed = _bed("tube")
    tracer = PatchTracer(bed, EDGES, check_window(bed, None))
    strata = tracer.strata(2**16, (5, 0), 2)
    side = tracer.side(strata)
    groups = -(-strata.along // side) * -(-strata.around // side)
    n = groups * side**2 * 2 * strata.net.shape[1]
    left, slots = np.empty((7, n)), np.empty((n, 2), np.int64)
    rows, counts = np.full(groups * side**2, -1), np.zeros((groups * side**2, 2, 6), np.int64)
    wall = tracer.wall._replace(first_shell=-1.0)
    found = trace_groups(0, groups, strata, wall, tracer.bins, *make_room(), rows, counts, left, slots)
    o, d, cosine = left[:3, :found].T, left[3:6, :found].T, left[6, :found]
    np.testing.assert_allclose(bed.wall.depth(o), 0.0, atol=1e-14)
    np.testing.assert_allclose((d**2).sum(axis=1), 1.0, rtol=1e-14)
    np.testing.assert_allclose((bed.wall.normal(o) * d).sum(axis=1), cosine, atol=1e-14)
    angle = np.arctan2(o[:, 1], o[:, 0])
    tangent = np.column_stack([-np.sin(angle), np.cos(angle), np.zeros(found)])
    for values, mean, variance in (
        (cosine, 2 / 3, 1 / 18), (cosine**2, 1 / 2, 1 / 12), (d[:, 2], 0.0, 1 / 4),
        ((d * tangent).sum(axis=1), 0.0, 1 / 4), (o[:, 2] / bed.period, 0.5, 1 / 12), (np.cos(angle), 0.0, 1 / 2),
        (np.sin(3 * angle), 0.0, 1 / 2),
    ):  # fmt: skip
        assert abs(values.mean() - mean) < 5 * np.sqrt(variance / found)


@pytest.mark.parametrize("parts", [1, 3])
def test_error_of_a_sum_of_strata_is_that_of_their_halves(parts):
    """Variance from the halves' differences against the scatter over 200 seeds, by chi-square of 199 degrees of
    freedom for each of two shares, each in the middle 99.9 %: false alarm 4e-3 once, seeds fixed."""
    bed = _bed("tube")
    tracer = PatchTracer(bed, EDGES, check_window(bed, None))
    if parts == 3:
        tracer.effective_radius /= 12.0  # smaller patches than strata, so that each half draws one
    samples = []
    for seed in range(200):
        strata = tracer.strata(2**12, (seed, 0), 2)
        assert (strata.parts_along * strata.parts_around > 1) == (parts == 3)
        total = Sample.empty(2, 6)
        for groups in tracer.batches(strata):
            total += tracer.trace(strata, groups, 2)
        samples.append(total)
    shares = np.array([s.shares for s in samples])
    stated = np.mean([s.covariance.diagonal() for s in samples], axis=0)
    for k in (0, 1):
        ratio = 199 * shares[:, k].var(ddof=1) / stated[k]
        assert stats.chi2(199).ppf(0.0005) < ratio < stats.chi2(199).ppf(0.9995)


def test_samples_add_up_and_their_errors_too():
    bed = hexagonal_layer()
    tracer = PatchTracer(bed, np.array([0.0, 1.0, 2.0]), check_window(bed, None))
    strata = tracer.strata(2**12, (1, 0), 1)
    parts = [tracer.trace(strata, groups, 1) for groups in tracer.batches(strata)]
    total = sum(parts[1:], parts[0])
    twice = total + total
    np.testing.assert_array_equal(twice.shares, total.shares)
    np.testing.assert_allclose(twice.covariance, total.covariance / 2)
    assert twice.rays == 2 * total.rays
    assert total.counts.sum() == total.rays == strata.along * strata.around * 2 * strata.net.shape[1]


@pytest.mark.parametrize("name", BEDS)
def test_bins_hold_each_near_sphere_once(name):
    bed = _bed(name)
    bins = build_bins(bed, 2.0)
    near = bed.depths - bed.radii < 2.0
    expected = np.column_stack([bed.centers, bed.radii])[near]
    found = bins.spheres.T
    np.testing.assert_array_equal(found[np.lexsort(found.T)], expected[np.lexsort(expected.T)])
    assert (np.diff(bins.starts) >= 0).all()
    assert bins.starts[-1] == near.sum()
    assert (bins.classes[:, 0] <= bed.radii.max()).all()


def test_a_chain_alone_in_a_wide_tube_is_found_through_many_shells():
    """First shells hold nothing; by reciprocity as in the closed form of the axial chain, within 4 standard errors."""
    chain = axial_chain(9.0)
    factors = bedrad.view_factors(chain, [0.0, 8.0, 9.0], rays=2**18, seed=3)
    exact = (4 * np.pi) / (2 * np.pi * 9.0 * 2) * (1 - 2 * 0.07558681842161)
    assert abs(1.0 - factors.wall - exact) < 4 * factors.wall_error
