"""Engines whose bias, noise and speed are known, measured."""

import dataclasses
import math

import numpy as np
import pytest
from scipy import stats

import bedrad
from bedrad.raytrace import engine_runs
from bedrad.raytrace.convergence import shares_and_errors
from bedrad.raytrace.engine_errors import EngineRuns, Reference, power_law
from bedrad.raytrace.engine_runs import LEAST_REFERENCE, measure_method, measure_tracer, timed_build, trace_reference
from bedrad.raytrace.factors import standard_error
from bedrad.raytrace.sampling import SobolStreams
from bedrad.raytrace.tracer import GridTracer
from jobs.small_job import ring_bed
from oracles.engines import BiasedTracer, Clock, Coins

SHARES = np.array([0.7, 0.2, 0.06, 0.04])
KNOWN = Reference(SHARES, np.zeros(4), 2**40, 0.0)
EFFORT = {"seeds": 8, "seed": 1, "seconds": 0.0}


@pytest.fixture(scope="module")
def coins():
    """Dice measured up to 2^17 rays: only the lengths that every engine gets would be three."""
    return measure_tracer(
        "coins", "coins", "", Coins(SHARES), 0.0, KNOWN, most_rays=2**17, seeds=8, seed=1, seconds=60.0
    )


@pytest.fixture(scope="module")
def scene():
    bed = ring_bed()
    return bed, bedrad.layer_edges(bed, 3), bed.window()


@pytest.fixture(scope="module")
def grid(scene):
    return GridTracer(*scene)


@pytest.fixture(scope="module")
def reference(scene):
    """A run of a million rays of its own."""
    found = bedrad.view_factors(scene[0], scene[1], rays=2**20, seed=100, window=scene[2])
    return Reference(*shares_and_errors(found), found.rays, found.seconds)


def test_independent_rays_have_the_noise_of_the_binomial_and_fall_by_a_half(coins):
    """Stated errors of 8 x 32 scramblings are known to 1/sqrt(2 x 8 x 31) = 4.5 %, true ones of 8 seeds to 25 %.

    Limits of 4 standard errors, 4 columns and 5 lengths: a false alarm in 800.
    """
    assert coins.rays.tolist() == [2**k for k in range(13, 18)]
    exact = np.sqrt(SHARES * (1 - SHARES) / coins.rays[:, None])
    assert np.abs(coins.stated_error / exact - 1.0).max() < 4 * 0.045
    assert np.abs(coins.true_error**2 / exact**2 - 1.0).max() < 4 * np.sqrt(2 / 8)
    assert (coins.bias == 0.0).all()
    np.testing.assert_array_equal(coins.true_error, coins.noise)
    # longer runs hold the rays of shorter ones: the exponent is known to about 0.045/2.2 at the ends
    assert np.abs(coins.stated_exponent + 0.5).max() < 0.08
    # eight seeds: the mean square over the seeds is chi-square
    z = 8 * coins.noise[-1] ** 2 / exact[-1] ** 2
    assert (stats.chi2.sf(z, 8) > 1e-4).all()
    assert (stats.chi2.cdf(z, 8) > 1e-4).all()


def test_time_to_an_error_is_that_of_the_rays_it_takes(coins):
    """Plain Monte Carlo takes p (1 - p)/e^2 rays; the level of the law is known to 4 %, in the range of the runs."""
    timed = dataclasses.replace(coins, seconds=coins.rays / 1e6)
    for error in (2e-3, 4e-3):
        rays = SHARES[0] * (1 - SHARES[0]) / error**2
        assert timed.seconds_to(error) == pytest.approx(rays / 1e6, rel=0.35)
        assert timed.error_after(timed.seconds_to(error)) == pytest.approx(error, rel=1e-9)
    # a fixed cost of every run counts where runs are short, and the rate of the longest beyond them
    slow = dataclasses.replace(coins, seconds=np.maximum(0.02, coins.rays / 1e6))
    assert slow.seconds_to(6e-3) == pytest.approx(0.02)
    assert slow.seconds_to(1e-5) == timed.seconds_to(1e-5)
    assert slow.seconds_to(0.5) == 0.02


def test_a_known_bias_is_found_within_its_error_and_apart_from_noise(grid, reference):
    """A third of a percent of the first layer is sent to the second; limit 4 standard errors, two columns."""
    share = 3e-3
    biased = BiasedTracer(grid, share)
    runs = measure_tracer("biased", "fake", "", biased, 0.0, reference, exact=grid, batch=2**16, **EFFORT)
    assert len(runs.rays) == 3
    expected = share * reference.estimates[0] * np.array([-1, 1])
    assert np.abs((runs.bias[:2] - expected) / runs.bias_error[:2]).max() < 4.0
    # the same rays through both: known far better than either result
    assert runs.bias_error[0] < 0.25 * runs.stated_error[-1, 0]
    np.testing.assert_array_equal(runs.bias[2:], 0.0)
    np.testing.assert_allclose(runs.bias.sum(), 0.0, atol=1e-15)
    # distance to the reference shifted by the bias, by the definition of a variance
    shift = runs.true_error**2 - runs.noise**2
    mean_distance = (shift + runs.bias**2) / 2 / np.where(runs.bias == 0.0, 1.0, runs.bias)
    assert np.abs(mean_distance[-1, 0] - runs.bias[0]) < 4 * runs.stated_error[-1, 0] / np.sqrt(8)
    assert runs.seconds_to(0.5 * abs(runs.bias[0])) == math.inf
    assert math.isfinite(runs.seconds_to(2.0 * abs(runs.bias[0])))
    # with facets there is nothing below the bias
    assert runs.error_after(1e9) == pytest.approx(runs.least_error(), rel=1e-3)


def test_an_engine_without_bias_has_none(grid, reference):
    runs = measure_tracer("exact", "fake", "", grid, 0.0, reference, exact=grid, batch=2**12, **EFFORT)
    assert (runs.bias == 0.0).all()
    assert (runs.bias_error == 0.0).all()
    assert runs.least_error() == 0.0


def test_the_size_of_the_batches_changes_nothing(grid, reference):
    one, other = (
        measure_tracer("grid", "fake", "", grid, 0.0, reference, exact=grid, batch=batch, **EFFORT)
        for batch in (2**8, 2**17)
    )
    for name in ("true_error", "stated_error", "rays"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_estimates_are_those_of_the_scramblings_traced_one_by_one(grid, reference):
    runs = measure_tracer("grid", "fake", "", grid, 0.0, reference, seeds=2, seed=5, seconds=0.0)
    for k, rays in enumerate(runs.rays):
        distance, stated = [], []
        for seed in (5, 6):
            streams = SobolStreams(seed, 32)
            shares = np.array([
                np.bincount(grid.fates(np.concatenate(list(streams.draw(s, int(rays) // 32)))), minlength=6)
                for s in range(32)
            ]) / (rays // 32)  # fmt: skip
            distance.append(shares.mean(axis=0) - reference.estimates)
            stated.append(standard_error(shares))
        np.testing.assert_allclose(runs.true_error[k], np.sqrt(np.mean(np.square(distance), axis=0)), rtol=1e-12)
        np.testing.assert_allclose(runs.stated_error[k], np.sqrt(np.mean(np.square(stated), axis=0)), rtol=1e-12)


def test_a_reference_that_is_not_long_enough_ends_the_runs(grid, reference):
    """Runs stop before the reference's own error is more than a third of theirs."""
    least = 2e-4
    short = dataclasses.replace(reference, errors=np.full(6, least))
    runs = measure_tracer("grid", "fake", "", grid, 0.0, short, seeds=2, seed=5, seconds=30.0)
    assert len(runs.rays) > 3
    assert runs.stated_error[-1, 0] / math.sqrt(2) < 3 * least < runs.stated_error[-2, 0] / math.sqrt(2)


def test_the_reference_is_as_long_as_its_time_allows_and_does_not_depend_on_threads(grid):
    one, two = (trace_reference(grid, 6, seed=3, seconds=0.0, threads=n) for n in (1, 2))
    np.testing.assert_array_equal(one.estimates, two.estimates)
    assert one.rays == LEAST_REFERENCE
    # each round goes on where the last one ended
    longer = trace_reference(grid, 6, seed=3, seconds=0.5, threads=2)
    assert longer.rays >= one.rays
    points = longer.rays // 32
    assert points & (points - 1) == 0
    streams = SobolStreams(3, 32)
    shares = np.array([
        np.bincount(grid.fates(np.concatenate(list(streams.draw(s, points)))), minlength=6) for s in range(32)
    ]) / points  # fmt: skip
    np.testing.assert_allclose(longer.estimates, shares.mean(axis=0), rtol=1e-12)
    np.testing.assert_allclose(longer.errors, standard_error(shares), rtol=1e-12)


def test_an_interrupt_ends_the_reference(grid):
    class Interrupted:
        def fates(self, points):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        trace_reference(Interrupted(), 6, seed=3, seconds=60.0, threads=2)


def test_bedrads_own_method_is_measured_as_it_is_run(scene, reference):
    bed, edges, window = scene
    runs = measure_method("bedrad", {}, *scene, reference, seeds=2, seed=5, seconds=0.0)
    found = [bedrad.view_factors(bed, edges, rays=2**15, seed=s, window=window) for s in (5, 6)]
    assert runs.rays[-1] == np.mean([f.rays for f in found]).round()
    distance = np.array([f.layers[0] for f in found]) - reference.estimates[0]
    stated = np.array([f.layers_error[0] for f in found])
    assert runs.true_error[-1, 0] == pytest.approx(np.sqrt((distance**2).mean()), rel=1e-12)
    assert runs.stated_error[-1, 0] == pytest.approx(np.sqrt((stated**2).mean()), rel=1e-12)
    assert (runs.seconds > 0.0).all()
    assert runs.setup_seconds > 0.0


class Slow:
    """Takes 50 ms to make, as much again with its first rays, as a tree does that is made late, and 1 us a ray."""

    def __init__(self, clock):
        self.clock, self.late = clock, 0.05
        clock.now += 0.05

    def fates(self, points):
        self.clock.now += self.late + 1e-6 * len(points)
        self.late = 0.0
        return np.zeros(len(points), int)


def test_setup_and_speed_of_a_slow_engine_are_told_apart(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(engine_runs, "time", clock)
    slow, setup = timed_build(lambda: Slow(clock))
    assert setup == pytest.approx(0.1)
    runs = measure_tracer("slow", "slow", "", slow, setup, KNOWN, seeds=2, seed=1, seconds=0.5)
    np.testing.assert_allclose(runs.seconds, 1e-6 * runs.rays, rtol=1e-9)
    assert runs.rate == pytest.approx(1e6)
    # two seeds of 2^17 rays take 0.26 s, and twice as many would take 0.52 s
    assert runs.rays[-1] == 2**17


def test_the_exact_engine_beside_a_mesh_is_not_on_its_clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(engine_runs, "time", clock)
    runs = measure_tracer("slow", "slow", "", Coins(SHARES), 0.0, KNOWN, exact=Slow(clock), **EFFORT)
    assert (runs.seconds == 0.0).all()
    assert clock.now > 0.0


def made_runs(stated, true=None, rays=(2**13, 2**14, 2**15, 2**16), bias=0.0, bias_error=0.0, rate=1e6, seeds=8):
    """Runs with errors in one column, as a power law of its own."""
    rays = np.array(rays)
    stated = np.asarray(stated, dtype=float)[:, None]
    noise = stated if true is None else np.asarray(true, dtype=float)[:, None]
    level, exponent = power_law(rays, stated)
    one = np.zeros(1)
    return EngineRuns("made", "made", "", True, 0.0, rays, rays / rate, np.hypot(noise, bias), noise, stated,
                      one + bias, one + bias_error, one, one, one, one, level, exponent, seeds)  # fmt: skip


def test_an_engine_that_understates_its_error_gains_nothing_by_it():
    """Three times the stated error in truth: 3 x 4 = 12.3 standard errors of eight seeds."""
    stated = 1.0 / np.sqrt([2**13, 2**14, 2**15, 2**16])
    honest, boasting = made_runs(stated), made_runs(stated / 3, stated)
    assert boasting.calibration()[0] == pytest.approx(3.0)
    assert boasting.seconds_to(1e-4) == pytest.approx(honest.seconds_to(1e-4), rel=1e-9)
    # but what chance explains is no reason to doubt: 1.3 is within three of 0.25
    lucky = made_runs(stated, 1.3 * stated)
    assert lucky.seconds_to(1e-4) == pytest.approx(honest.seconds_to(1e-4), rel=1e-9)
    # nor is an error that is stated too large taken for less
    assert made_runs(3 * stated, stated).seconds_to(1e-4) == pytest.approx(9 * honest.seconds_to(1e-4), rel=1e-9)


def test_bias_and_noise_add_in_quadrature():
    stated = 1.0 / np.sqrt([2**13, 2**14, 2**15, 2**16])
    runs = made_runs(stated, bias=6e-4)
    # noise may be 8e-4 of the 1e-3: 1/64e-8 rays at 1e6 a second
    assert runs.seconds_to(1e-3) == pytest.approx(1.5625, rel=1e-9)
    assert runs.error_after(1.5625) == pytest.approx(1e-3, rel=1e-9)
    # what the bias owes to its own error is not held against the engine
    assert made_runs(stated, bias=6e-4, bias_error=6e-4).least_error() == 0.0
    assert made_runs(stated, bias=1e-3, bias_error=6e-4).least_error() == pytest.approx(8e-4)


def test_a_short_run_of_the_same_rays_takes_the_law_of_a_long_one():
    rays = np.array([2**k for k in range(13, 21)])
    long = made_runs(3.0 * rays**-0.56, rays=rays)
    rough = np.array([1.1, 1.0, 0.9])[:, None]
    level, exponent = power_law(rays[:3], 3.0 * rays[:3, None] ** -0.56 * rough, long)
    assert exponent[0] == pytest.approx(-0.56)
    assert level[0] == pytest.approx(3.0 * (1.1 * 0.9) ** (1 / 3))
    # other rays, or none that met the target: its own fit
    level, exponent = power_law(2 * rays[:3] + 1, 3.0 * rays[:3, None] ** -0.5, long)
    assert exponent[0] != pytest.approx(-0.56, abs=0.01)
    level, exponent = power_law(rays[:3], np.zeros((3, 1)), long)
    assert level[0] == 0.0


def test_a_target_that_no_ray_meets_is_known_at_once(grid, reference):
    """No ray of a periodic bed escapes."""
    runs = measure_tracer("grid", "fake", "", grid, 0.0, reference, **EFFORT)
    assert (runs.stated_error[:, 5] == 0.0).all()
    assert runs.seconds_to(1e-9, 5) == runs.seconds[0]
    assert runs.error_after(1.0, 5) == 0.0
    assert math.isnan(runs.calibration(5)[0])
