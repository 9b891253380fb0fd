"""The loose column: inside the tube, free of overlaps, random, and the same for the same seed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import kstest

from bedrad.packings.overlaps import pair_overlaps
from bedrad.packings.pouring import Column, count_spheres, loose_column


def column(radius: float, sizes: list[tuple[float, float]], count: int, seed: int = 1) -> Column:
    counts = [round(count * share) for _, share in sizes]
    return loose_column(radius, sizes, counts, np.random.default_rng(seed))


@pytest.mark.parametrize(
    ("radius", "sizes", "count"),
    [
        (6.0, [(1.0, 1.0)], 2000),
        (1.1, [(1.0, 1.0)], 100),
        (0.51, [(1.0, 1.0)], 50),
        (4.0, [(0.5, 0.7), (1.0, 0.2), (1.5, 0.1)], 1000),
        (3.0, [(1.0, 1.0)], 1),
    ],
)
def test_no_overlaps_and_inside_the_tube(radius: float, sizes: list[tuple[float, float]], count: int) -> None:
    made = column(radius, sizes, count)
    assert len(made.centers) == len(made.diameters) == count
    assert len(pair_overlaps(made.centers, made.diameters / 2)[0]) == 0
    r = made.diameters / 2
    # points are made from an angle and a distance: one rounding either way
    assert (np.hypot(made.centers[:, 0], made.centers[:, 1]) + r).max() <= radius * (1 + 1e-15)
    assert (made.centers[:, 2] - r).min() >= -1e-15 * made.height
    assert (made.centers[:, 2] + r).max() <= made.height * (1 + 1e-15)
    solid = (made.diameters**3).sum() / (6 * radius**2 * made.height)
    assert 0.15 < solid <= 0.3 * (1 + 1e-12) or count == 1


def test_same_seed_same_column() -> None:
    first, again, other = (column(4.0, [(1.0, 1.0)], 300, seed) for seed in (5, 5, 6))
    assert first.centers.tobytes() == again.centers.tobytes()
    assert not np.array_equal(first.centers, other.centers)


def test_spheres_are_uniform_along_the_axis_and_around_it() -> None:
    # sequential placing keeps spheres apart, which makes the distribution more even than independent points
    made = column(6.0, [(1.0, 1.0)], 1500)
    z = (made.centers[:, 2] - 0.5) / (made.height - 1.0)
    assert kstest(z, "uniform").pvalue > 1e-3
    turn = np.arctan2(made.centers[:, 1], made.centers[:, 0]) / (2 * np.pi) + 0.5
    assert kstest(turn, "uniform").pvalue > 1e-3


@pytest.mark.parametrize("sizes", [[(1.0, 1.0)], [(1.0, 0.5), (2.0, 0.5)], [(1.0, 1 / 3), (0.5, 1 / 3), (0.2, 1 / 3)]])
def test_counts_fill_the_volume_and_keep_the_shares(sizes: list[tuple[float, float]]) -> None:
    mean = sum(share * math.pi / 6 * d**3 for d, share in sizes)
    counts = count_spheres(sizes, 1000.4 * mean)
    assert sum(counts) == 1001
    assert all(abs(n - 1001 * share) < 1 for n, (_, share) in zip(counts, sizes, strict=True))


def test_at_least_one_sphere() -> None:
    assert count_spheres([(1.0, 0.5), (2.0, 0.5)], 1e-9) == [1, 0]


def test_the_data_file_carries_every_bit() -> None:
    made = column(4.0, [(1.0, 0.5), (1 / 3, 0.5)], 20)
    lines = made.data_file(2500.1, 2.0).splitlines()
    assert lines[2] == "20 atoms"
    rows = np.array([[float(word) for word in line.split()] for line in lines[10:]])
    assert rows[:, 0].tolist() == list(range(1, 21))
    assert rows[:, 2].tolist() == made.diameters.tolist()
    assert set(rows[:, 3]) == {2500.1}
    assert rows[:, 4:].tolist() == made.centers.tolist()
    box = [[float(word) for word in line.split()[:2]] for line in lines[4:7]]
    assert box[2] == [-2.0, made.height + 2.0]
    assert box[0] == box[1] == [-box[0][1], box[0][1]]
    assert box[0][1] > np.abs(made.centers[:, :2]).max() + 1.99
