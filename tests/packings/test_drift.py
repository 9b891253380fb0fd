"""Drifts are told where there are some, and seldom where there are none: on made-up series with a known memory."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import binom

from bedrad.packings.drift import significant_drifts

FloatArray = NDArray[np.float64]

FLOWS = 2000
PIECES = 4


def autoregressive(rng: np.random.Generator, frames: int, pieces: int, alike: float, count: int) -> FloatArray:
    """Steady series of variance 1 that are alike from frame to frame by a share, (frames, pieces, count)."""
    x = np.empty((frames, pieces, count))
    x[0] = rng.standard_normal((pieces, count))
    for k in range(1, frames):
        x[k] = alike * x[k - 1] + math.sqrt(1.0 - alike**2) * rng.standard_normal((pieces, count))
    return x


def travelling(rng: np.random.Generator, frames: int, step: int, count: int) -> FloatArray:
    """A bed without order, in slices half a diameter high, that moves so many slices a frame past pieces of six."""
    slices = np.concatenate([np.zeros((1, count)), rng.standard_normal((6 * PIECES + step * frames, count))])
    sums = slices.cumsum(axis=0)
    lower = step * np.arange(frames)[:, None] + 6 * np.arange(PIECES)
    return np.asarray(sums[lower + 6] - sums[lower])


def surging(rng: np.random.Generator, frames: int, alike: float, count: int) -> FloatArray:
    """Series that all pieces share, as a plug that moves as one."""
    return np.repeat(autoregressive(rng, frames, 1, alike, count), PIECES, axis=1)


@pytest.mark.parametrize("frames", [8, 9, 12, 16, 22, 31, 33, 51, 64, 121])
def test_a_steady_flow_is_told_to_drift_in_less_than_one_case_of_a_hundred(frames: int) -> None:
    """Of its two series; a count beyond the limit comes by chance in 1e-6 of cases where the share is just 1 %."""
    rng = np.random.default_rng(frames)
    most = int(binom.ppf(1.0 - 1e-6, FLOWS, 0.01))
    kinds = {
        **{f"surging {a}": surging(rng, frames, a, 2 * FLOWS) for a in (0.0, 0.3, 0.5)},
        **{f"pieces {a}": autoregressive(rng, frames, PIECES, a, 2 * FLOWS) for a in (0.0, 0.5, 0.8, 0.9)},
        **{f"travelling {s}": travelling(rng, frames, s, 2 * FLOWS) for s in (1, 3)},
    }
    for kind, cells in kinds.items():
        told = (significant_drifts(10.0 + cells) != 0.0).reshape(FLOWS, 2).any(axis=1)
        assert told.sum() <= most, f"{kind}: {told.mean():.2%}"


@pytest.mark.parametrize("frames", [31, 61])
def test_drifts_that_stand_out_of_the_scatter_are_told(frames: int) -> None:
    """A line, and a decay to e^-3: halves four and eight standard deviations of a frame apart."""
    rng, time = np.random.default_rng(1), np.linspace(0.0, 1.0, frames)
    decay = np.exp(-3.0 * time)
    for trend, apart, least in ((time, 4.0, 0.9), (time, 8.0, 0.999), (decay, 8.0, 0.9)):
        half = frames // 2
        scale = apart / (trend[-half:].mean() - trend[:half].mean())
        for alike in (0.0, 0.5):
            cells = surging(rng, frames, alike, 1000) + scale * trend[:, None, None]
            found = significant_drifts(cells)
            assert (found != 0.0).mean() > least, (apart, alike)
            assert np.mean(found[found != 0.0]) == pytest.approx(apart, rel=0.1)


def test_a_drift_without_scatter_is_told_and_rest_is_not() -> None:
    time = np.linspace(0.0, 1.0, 20)
    cells = np.stack([np.ones(20), time, np.exp(-3.0 * time), np.sign(time - 0.5)], axis=1)[:, None, :]
    found = significant_drifts(np.repeat(cells, PIECES, axis=1))
    assert found[0] == 0.0
    assert found[1] == pytest.approx(10.0 / 19.0, rel=1e-12)
    assert found[2] < -0.3
    assert found[3] == pytest.approx(2.0, rel=1e-12)


def test_few_frames_tell_no_drift() -> None:
    assert significant_drifts(np.arange(14.0).reshape(7, 1, 2)).tolist() == [0.0, 0.0]
    assert (significant_drifts(np.arange(16.0).reshape(8, 1, 2)) == 8.0).all()
