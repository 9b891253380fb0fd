"""View factors over the frames of a flow: means, the rays' errors, the bed's, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2

import bedrad
from bedrad.packings.time_averages import errors_of_mean
from bedrad.raytrace.frames import TrajectoryViewFactors, frame_seed
from oracles.beds import axial_chain, random_bed

NEIGHBOUR = 0.07558681842161  # a sphere to a touching equal one


def shares(factors):
    return np.array([*factors.layers, factors.beyond, factors.wall, factors.escaped])


def loose_bed(seed):
    return random_bed(bedrad.Tube(6.0), 220, seed, 30.0, 4.0, period=30.0)


def beds(count):
    return [loose_bed(seed) for seed in range(count)]


def test_the_mean_of_a_chain_is_its_closed_form_with_honest_errors():
    """F = (A_s/A_w)(1 - 2 F_neighbour); 25 means of 4 frames each: chi-square within 99.98 % limits both sides."""
    exact = 4 * np.pi / (2 * np.pi * 1.5 * 2) * (1 - 2 * NEIGHBOUR)
    deviations = []
    for seed in range(25):
        found = bedrad.view_factors([axial_chain(1.5)] * 4, [0.0, 1.0], rays=2**14, seed=seed)
        deviations.append((1.0 - found.wall - exact) / found.wall_error)
    assert chi2.ppf(1e-4, 25) < np.sum(np.square(deviations)) < chi2.ppf(1 - 1e-4, 25)


def test_a_tolerance_is_that_of_the_mean_and_frames_share_the_rays():
    frames = beds(9)
    found = bedrad.view_factors(frames, tolerance=2e-3, seed=1)
    alone = bedrad.view_factors(frames[0], tolerance=2e-3, seed=1)
    assert isinstance(found, TrajectoryViewFactors)
    assert found.frames == 9
    assert found.history[-1].largest_error <= 2e-3
    # nine frames to a tolerance three times as wide take far fewer rays than nine to this one
    assert found.rays < 4 * alone.rays
    assert bedrad.view_factors((bed for bed in frames), tolerance=2e-3, seed=1).rays > 6 * alone.rays
    assert (
        bedrad.view_factors(frames, rays=9 * 2**15, seed=1).rays == 9 * bedrad.view_factors(frames[0], rays=2**15).rays
    )
    errors = [step.largest_error for step in found.history]
    assert len(errors) == 9
    assert errors == sorted(errors, reverse=True)


def test_means_errors_and_covariances_are_those_of_the_frames():
    """Each frame traced alone with the seed that it has among the others: the same counts, so the same to rounding."""
    frames = beds(6)
    found = bedrad.view_factors(frames, rays=6 * 2**15, seed=3, threads=1)
    parts = {"window": found.window, "blocks": len(found.block_shares)}
    each = [bedrad.view_factors(bed, found.edges, rays=2**15, seed=frame_seed(3, k), **parts) for k, bed in
            enumerate(frames)]  # fmt: skip
    assert shares(found) == pytest.approx(np.mean([shares(one) for one in each], axis=0), abs=1e-14)
    assert shares(found).sum() == pytest.approx(1.0, abs=1e-12)
    assert found.covariance == pytest.approx(np.sum([one.covariance for one in each], axis=0) / 36, abs=1e-18)
    assert found.history[-1].errors == pytest.approx(np.sqrt(np.diag(found.covariance)), rel=1e-9)
    stated = [*found.layers_bed_error, found.beyond_bed_error, found.wall_bed_error, found.escaped_bed_error]
    noise = np.mean([np.diag(one.covariance) for one in each], axis=0)
    assert stated == pytest.approx(errors_of_mean(np.array([one.block_shares for one in each]), noise)[0], rel=1e-9)
    assert np.sqrt(np.diag(found.covariance_of_bed())) == pytest.approx(stated, rel=1e-9)
    assert np.linalg.eigvalsh(found.covariance_of_bed()).min() > -1e-12
    again = bedrad.view_factors(frames, rays=6 * 2**15, seed=3, threads=2)
    assert np.array_equal(shares(found), shares(again))
    assert not np.array_equal(shares(found), shares(bedrad.view_factors(frames, rays=6 * 2**15, seed=4)))


def test_frames_that_are_all_alike_have_the_error_of_one():
    bed = loose_bed(5)
    one = bedrad.view_factors(bed, rays=2**19, seed=1)
    many = bedrad.view_factors([bed] * 8, rays=2**19, seed=1)
    # eight frames that had nothing in common would state 0.35 of it; the rays made up to 0.13 of difference on six beds
    assert many.layers_bed_error == pytest.approx(one.layers_bed_error, rel=0.3)
    assert many.structures[0] < 1.05
    # the publication's convention takes the frames' covariance, not the scatter of the blocks as such
    normalised = many.normalised("watkins")
    assert normalised.layers.sum() == pytest.approx(1.0, abs=1e-12)
    assert normalised.layers_bed_error == pytest.approx(one.normalised("watkins").layers_bed_error, rel=0.3)


def test_the_noise_of_the_rays_is_told_so_that_it_does_not_pass_for_a_bed_that_renews_itself(monkeypatch):
    told = []

    def watched(cells, noise):
        told.append(noise)
        return errors_of_mean(cells, noise)

    monkeypatch.setattr("bedrad.raytrace.frames.errors_of_mean", watched)
    found = bedrad.view_factors(beds(3), rays=3 * 2**12, seed=2)
    # of one frame, three times that of the mean
    assert told[0] == pytest.approx(3 * np.diag(found.covariance), rel=1e-12)
    assert told[0][0] > 0.0


def test_rays_of_the_first_frame_are_not_those_of_the_second():
    bed = loose_bed(5)
    found = bedrad.view_factors([bed, bed], rays=2**15, seed=1)
    first, second = found.history
    # two estimates of the same numbers, which differ
    assert not np.array_equal(first.estimates, second.estimates)


@pytest.mark.parametrize(
    ("frames", "kind", "message"),
    [
        ([], ValueError, "there are no frames; there is nothing to trace"),
        ([1.0], TypeError, "frame 0 is a float; expected a bedrad.Packing"),
        ([axial_chain(1.5), axial_chain(3.0)], ValueError, "frame 1: the wall is Tube"),
        ([bedrad.Packing(np.zeros((0, 3)), 1.0, bedrad.Tube(1.5), period=2.0)], ValueError, "frame 0: the packing is"),
    ],
)
def test_what_is_no_flow_is_refused(frames, kind, message):
    with pytest.raises(kind, match=message):
        bedrad.view_factors(frames, [0.0, 1.0], rays=1000)


def test_it_says_over_how_many_frames_the_mean_is():
    text = str(bedrad.view_factors([axial_chain(1.5)] * 3, [0.0, 1.0], rays=3000))
    assert "mean over 3 frames" in text
