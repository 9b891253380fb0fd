"""Standard errors of means over frames that resemble each other in time, and pieces of bed that do so in space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

__all__ = ["block_averaged_variance", "errors_of_mean", "renewal_frames"]

FloatArray = NDArray[np.float64]

FEWEST_BLOCKS = 4
"""Blocks in time below which their scatter says too little."""

CHANCE = 0.05
"""Share of cases in which the scatter between pieces counts although it exceeds the other errors by chance only."""

ROUNDING = 1e-10
"""Error over value that is taken for rounding of the sums behind it, and for zero."""

COLUMNS_AT_ONCE = 64
"""Quantities whose autocorrelations are computed together, which bounds the memory."""


def errors_of_mean(cells: FloatArray, noise: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Standard errors of means over frames, and how many independent structures the frames amount to.

    Three estimates of the variance of the mean are made, each blind to something:

    1. Block averages in time (Flyvbjerg and Petersen 1989) of the frames' values. Blind to what all frames share: of
       frames that hardly differ it makes an error that is far too small.
    2. The variance of one frame's value, from the scatter between its pieces, over the number of times that the bed
       renewed itself. A renewal takes twice the number of frames after which half the mean squared difference
       between frames is half that variance; where the frames never differ that much there was none, and the error
       is that of one frame, however many there are. This needs no mean over time, so that it holds where the
       frames are few or much alike; exact for a bed that travels past the window. Blind to parts that
       stand still while the larger part moves.
       Noise of the measurement makes frames differ that are the same bed: where it is told, it is taken out of both
       the variance and the differences before the renewals are counted, and added to the result.
    3. The scatter between pieces, each averaged over all frames. Blind to what travels from piece to piece.

    The larger of the first two is taken, and the third where it exceeds it by more than chance (chi-square
    test at 5 %). On synthetic beds (independent frames, autoregressive pieces, structures that travel, standing
    parts) the root mean square of the errors stated is right to half as large again, never more than 10 % too small.

    Parameters
    ----------
    cells : (frames, pieces, k) array
        Values of k quantities in every frame and piece, pieces of equal weight.
    noise : (k,) array, optional
        Variance that the measurement adds to a frame's value, independent from frame to frame, such as that of rays.

    Returns
    -------
    errors : (k,) array
        Standard errors of the means over frames and pieces; nan where neither frames nor pieces tell.
    structures : (k,) array
        Number of independent frames that would have this error, from 1 to `frames`; nan where the error is nan or 0.

    References
    ----------
    H. Flyvbjerg and H. G. Petersen, Error estimates on averages of correlated data, J. Chem. Phys. 91 (1989) 461.
    """
    frames, pieces, _ = cells.shape
    series = cells.mean(axis=1)
    nothing = np.full(series.shape[1], np.nan)
    in_space = cells.var(axis=1, ddof=1).mean(axis=0) / pieces if pieces > 1 else nothing
    rounding = (ROUNDING * np.abs(cells).max(axis=(0, 1))) ** 2
    if frames == 1:
        return np.sqrt(in_space), np.where(in_space > 0.0, 1.0, np.nan)
    in_time = series.var(axis=0, ddof=1)
    variance = block_averaged_variance(series)
    if pieces > 1:
        noisy = np.zeros_like(in_space) if noise is None else noise
        structure = np.maximum(in_space - noisy, 0.0)
        renewed = (structure * renewal_frames(series, structure, noise) + noisy) / frames
        variance = np.maximum(variance, renewed)
        standing = cells.mean(axis=0).var(axis=0, ddof=1) / pieces
        by_chance = chdtri(pieces - 1, CHANCE) / (pieces - 1)
        variance = np.where(standing > by_chance * variance, standing, variance)
    else:
        # frames that are all alike look the same as no error at all
        variance = np.where(in_time > rounding, variance, np.nan)
    variance = np.where(variance > rounding, variance, 0.0 * variance)
    one_frame = np.fmax(in_space, in_time)
    with np.errstate(divide="ignore", invalid="ignore"):
        structures = np.clip(one_frame / variance, 1.0, float(frames))
    return np.sqrt(variance), np.where(variance > 0.0, structures, np.nan)


def block_averaged_variance(series: FloatArray) -> FloatArray:
    """Variance of the means of correlated series, by averaging over ever longer blocks (Flyvbjerg and Petersen 1989).

    The plateau is the smallest block length m (a power of two) with m^3 > 2 n g^2, g being the variance at this
    length over that of uncorrelated values: there the bias that is left is as small as the scatter of the estimate
    (Wolff 2004; Lee et al. 2011). Where no length with at least four blocks is that long, the largest variance of
    all lengths is taken, which is then a lower bound.

    Parameters
    ----------
    series : (n, k) array
        k series of n values, n at least 2.

    Returns
    -------
    (k,) array
        Variances of the k means.
    """
    n, count = series.shape
    lengths, levels = [], []
    length = 1
    while length == 1 or n // length >= FEWEST_BLOCKS:
        blocks = n // length
        means = series[: blocks * length].reshape(blocks, length, count).mean(axis=1)
        lengths.append(length)
        levels.append(means.var(axis=0, ddof=1) / blocks)
        length *= 2
    variances = np.array(levels)
    # written without a quotient: a series that never changes has no inefficiency
    enough = np.array(lengths)[:, None] ** 3 * variances[0] ** 2 > 2.0 * n * variances**2
    chosen = variances[enough.argmax(axis=0), np.arange(count)]
    return np.asarray(np.where(enough.any(axis=0), chosen, variances.max(axis=0)))


def renewal_frames(series: FloatArray, variance: FloatArray, noise: FloatArray | None = None) -> FloatArray:
    """Number of frames that a bed takes to renew itself, between 1 and the number of frames.

    Parameters
    ----------
    series : (n, k) array
        Values of k quantities in n frames.
    variance : (k,) array
        Variance of one frame's value between beds that have nothing in common.
    noise : (k,) array, optional
        Variance that the measurement adds to it, independent from frame to frame.

    Returns
    -------
    (k,) array
        Twice the lag, interpolated, at which half the mean squared difference between frames, less the noise, is half
        the variance; n where that never happens.
    """
    n = len(series)
    noisy = np.zeros_like(variance) if noise is None else noise
    parts = [slice(k, k + COLUMNS_AT_ONCE) for k in range(0, series.shape[1], COLUMNS_AT_ONCE)]
    found = [_half_rise(series[:, part], 0.5 * variance[part], noisy[part]) for part in parts]
    return np.clip(2.0 * np.concatenate(found), 1.0, float(n))


def _half_rise(series: FloatArray, half: FloatArray, noise: FloatArray) -> FloatArray:
    """Lag at which half the mean squared difference, less the noise, reaches `half`; n where it does not."""
    n = len(series)
    x = series - series.mean(axis=0)
    transform = np.fft.rfft(x, 2 * n, axis=0)
    products = np.fft.irfft(np.abs(transform) ** 2, 2 * n, axis=0)[:n]
    squares = np.cumsum(x * x, axis=0)
    lags = np.arange(1, n)
    both_ends = squares[n - 1 - lags] + squares[-1] - squares[lags - 1]
    difference = np.zeros_like(x)
    difference[1:] = (0.5 * both_ends - products[1:]) / (n - lags)[:, None] - noise
    reached = difference >= half
    reached[0] = False
    first = reached.argmax(axis=0)
    columns = np.arange(len(half))
    before, after = difference[np.maximum(first - 1, 0), columns], difference[first, columns]
    with np.errstate(divide="ignore", invalid="ignore"):
        within = np.clip(np.nan_to_num((half - before) / (after - before)), 0.0, 1.0)
    return np.asarray(np.where(first > 0, first - 1 + within, float(n)))
