"""Series and inverted transform are two roads to the same solution; they must meet wherever both can go."""

import numpy as np
import pytest

from bedrad.heat import two_layer_evaluation as evaluation
from bedrad.heat import two_layer_transform as transform
from bedrad.heat.two_layer_fields import developed_shape
from bedrad.heat.two_layer_modes import find_modes, layers
from bedrad.heat.two_layer_transform import CONTOUR_ERROR, field_rise, wall_excess


def random_pairs(number, kappas=(-4, 4), seed=1):
    rng = np.random.default_rng(seed)
    return rng, layers(1 + 10 ** rng.uniform(-6, 6, number), 10 ** rng.uniform(*kappas, number))


def test_both_roads_agree_on_both_sides_of_the_switch():
    """1,000 tubes, D/d - 1 from 1e-6 to 1e6, where the series needs 3 to 60 terms."""
    rng, pairs = random_pairs(1000)
    mu = rng.uniform(3, 60, 1000) * np.pi / pairs.depth
    t = 34.0 / mu**2
    series = evaluation.truncated(find_modes(pairs, 71), t, np.full(1000, 70))
    used = evaluation.excess(pairs, t, 1e-12)
    assert np.sum(used.terms > 0) > 300
    assert np.sum(used.terms == 0) > 300
    assert np.max(np.abs(wall_excess(pairs, t) / series.value - 1)) < 5e-12
    assert np.max(np.abs(used.value / series.value - 1)) < 5e-12


@pytest.mark.parametrize("kappas", [(4, 6), (-6, -4)])
def test_digits_up_to_the_ends_of_the_verified_ratios(kappas):
    rng, pairs = random_pairs(500, kappas, seed=2)
    mu = rng.uniform(1, 30, 500) * np.pi / pairs.depth
    t = 34.0 / mu**2
    series = evaluation.truncated(find_modes(pairs, 41), t, np.full(500, 40))
    assert np.max(np.abs(wall_excess(pairs, t) / series.value - 1)) < 5e-11


def test_contour_error_against_halves_of_the_step(monkeypatch):
    """Fewer points leave ten times the error each, down to the stated one."""
    from bedrad.heat import two_layer_transform as transform

    pairs, t = layers(np.full(3, 28.2), np.array([1e-2, 2.5, 1e2])), np.array([1e-6, 1e-4, 1e-3])
    best = wall_excess(pairs, t)
    errors = []
    for nodes in (8, 10, 12):
        monkeypatch.setattr(transform, "_NODES", nodes)
        monkeypatch.setattr(transform, "_STEP", 1.081792140 / nodes)
        monkeypatch.setattr(transform, "_STRETCH", 4.492075287 * nodes)
        errors.append(np.max(np.abs(wall_excess(pairs, t) / best - 1)))
    rate = np.polyfit([8, 10, 12], np.log10(errors), 1)[0]
    assert rate == pytest.approx(-1.0, abs=0.1)
    assert errors[-1] * 10 ** (4 * rate) < CONTOUR_ERROR


def test_field_by_both_roads():
    """All radii of 200 tubes, where the series needs some 20 terms; errors over the rise of the wall."""
    rng, pairs = random_pairs(200, kappas=(-3, 3), seed=3)
    t = 34.0 / (20 * np.pi / pairs.depth) ** 2
    r = rng.uniform(0, 1, (200, 6))
    r[:, 0], r[:, 1], r[:, 2] = 0.0, 1.0, pairs.W
    modes = find_modes(pairs, 60)
    decay = (modes.weights * np.exp(-(modes.mu**2) * t[:, None]))[:, None, :]
    shape = np.stack([developed_shape(pairs, x) for x in r.T], axis=1)
    series = 2 * t[:, None] + shape - np.sum(decay * modes.shapes(r), axis=2)
    wall = series[:, 1:2]
    assert np.max(np.abs(field_rise(pairs, t, r) - series) / wall) < 1e-11


def test_blocks_change_nothing(monkeypatch):
    rng, pairs = random_pairs(60, kappas=(-1, 1), seed=4)
    t, r = 10 ** rng.uniform(-6, 0, 60), rng.uniform(0, 1, (60, 2))
    whole = evaluation.excess(pairs, t, 1e-10), field_rise(pairs, t, r)
    monkeypatch.setattr(evaluation, "_BLOCK", 40)
    monkeypatch.setattr(transform, "_BLOCK", 100)
    parts = evaluation.excess(pairs, t, 1e-10), field_rise(pairs, t, r)
    assert np.array_equal(parts[0].value, whole[0].value)
    assert np.array_equal(parts[0].terms, whole[0].terms)
    assert np.array_equal(parts[1], whole[1])


def test_no_overflow_at_the_ends():
    pairs = layers(np.array([np.nextafter(1, 2), 1e300, np.inf, 28.2]), np.array([1e6, 1e-6, 1.0, 1e6]))
    with np.errstate(all="raise"):
        for t in (1e-289, 1e-30, 1e-3, 10.0, 1e200):
            found = evaluation.excess(pairs, np.full(4, t), 1e-10)
            assert np.all(np.isfinite(found.value))
            assert np.all(found.value > 0)
