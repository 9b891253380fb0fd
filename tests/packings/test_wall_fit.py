"""A tube is fitted where the bed has one, and refused where it has none."""

from __future__ import annotations

import numpy as np
import pytest

from bedrad.packings.wall_fit import fit_tube


def wall_layer(rng: np.random.Generator, radius: float, count: int = 2000, overlap: float = 0.0) -> np.ndarray:
    """Centres of spheres of radius 1: two thirds touch a tube (with overlaps), the rest lie deeper."""
    gap = np.where(rng.random(count) < 2 / 3, -overlap * rng.random(count), rng.uniform(0.05, 3.0, count))
    reach = np.maximum(radius - 1.0 - gap, 0.0)
    turn = rng.uniform(0, 2 * np.pi, count)
    return np.stack([reach * np.cos(turn), reach * np.sin(turn), rng.uniform(0, 60, count)], axis=1)


@pytest.mark.parametrize("radius", [2.5, 12.9])
def test_exact_contacts_give_the_exact_tube(radius: float) -> None:
    centers = wall_layer(np.random.default_rng(1), radius) + np.array([5.0, -7.0, 0.0])
    fit = fit_tube(centers, np.ones(len(centers)))
    np.testing.assert_allclose([*fit.axis, fit.radius], [5.0, -7.0, radius], rtol=1e-12)


def test_overlaps_shift_the_radius_by_their_mean() -> None:
    # overlaps uniform in 0 .. 0.015 radii: the mean contact reaches 0.0075 too far out
    centers = wall_layer(np.random.default_rng(2), 12.9, overlap=0.015)
    fit = fit_tube(centers, np.ones(len(centers)))
    scatter = 0.015 / np.sqrt(12) / np.sqrt(fit.touching)
    assert fit.radius - 12.9 == pytest.approx(0.0075, abs=4 * scatter)
    assert np.hypot(*fit.axis) < 6 * scatter
    assert 0 < fit.residual < 0.015


def test_spheres_of_unlike_sizes() -> None:
    rng = np.random.default_rng(3)
    radii = rng.uniform(0.5, 1.0, 1000)
    turn = rng.uniform(0, 2 * np.pi, 1000)
    centers = np.stack([(9 - radii) * np.cos(turn), (9 - radii) * np.sin(turn), rng.uniform(0, 50, 1000)], axis=1)
    fit = fit_tube(centers, radii)
    np.testing.assert_allclose([*fit.axis, fit.radius], [0.0, 0.0, 9.0], atol=1e-12)


def test_a_square_box_is_no_tube() -> None:
    centers = np.random.default_rng(4).uniform(0, 30, (6000, 3))
    with pytest.raises(ValueError, match=r"miss a common circle by .* radii .*; give the wall"):
        fit_tube(centers, np.ones(6000))


def test_a_ragged_cloud_is_no_tube() -> None:
    centers = np.random.default_rng(5).normal(size=(3000, 3)) * [6, 6, 20]
    with pytest.raises(ValueError, match="miss a common circle"):
        fit_tube(centers, np.ones(3000))


def test_half_a_tube_is_no_tube() -> None:
    centers = wall_layer(np.random.default_rng(6), 12.9)
    with pytest.raises(ValueError, match=r"give the wall"):
        fit_tube(centers[centers[:, 0] > 4.0], np.ones(int((centers[:, 0] > 4.0).sum())))


def test_a_chain_on_an_axis_is_no_tube() -> None:
    centers = np.stack([np.zeros(40), np.zeros(40), 2.0 * np.arange(40)], axis=1)
    with pytest.raises(ValueError, match="do not surround an axis"):
        fit_tube(centers, np.ones(40))


def test_broken_numbers_are_left_to_the_packing() -> None:
    with pytest.raises(ValueError, match="not finite and positive"):
        fit_tube(np.full((20, 3), np.nan), np.ones(20))
