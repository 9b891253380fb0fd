"""Whether series of frames drift, or only wander as steady ones do that are alike from frame to frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.time_averages import errors_of_mean

__all__ = ["significant_drifts"]

FloatArray = NDArray[np.float64]

FEWEST_FRAMES = 8
"""Frames below which no drift can be told from chance."""

BLOCKS = 6
"""Blocks in time, at least, of what a line through a half leaves."""

SIGNIFICANT = 3.2
"""Errors of the difference between the halves that it must exceed."""

ABOUT_LINES = (3.4, 80.0)
"""The same for errors about a line through each half, which are smaller: so many, and so many more over the frames.

Found with made-up steady series of 8 to 200 frames: a bed that surges as a whole, alike from frame to frame by 0 to
0.5, pieces that change on their own, by 0 to 0.9, and beds that travel past. A flow, which has two series, is told to
drift by chance in less than 1 % of cases; in 3 % of 31 frames where it surges and is alike by 0.7, in 26 % by 0.9."""


def significant_drifts(cells: FloatArray) -> FloatArray:
    """Differences between the means of the two halves of a sample that are more than chance.

    Two errors of a difference must both be exceeded, each by as much as it takes. The first is by
    `bedrad.packings.time_averages.errors_of_mean` of each half: the pieces tell how long a bed takes to travel past the
    window, but a drift within the halves counts as noise. The second is by averages over blocks in time of what a line
    through each half leaves: no noise from a drift, but only part of that of a slow wandering.

    Parameters
    ----------
    cells : (frames, pieces, k) array
        Values of k quantities in every frame and piece, pieces of equal weight.

    Returns
    -------
    (k,) array
        Mean of the second half less that of the first; 0 where this may be chance.
    """
    frames = len(cells)
    half = frames // 2
    if frames < FEWEST_FRAMES:
        return np.zeros(cells.shape[2])
    halves = (cells[:half], cells[-half:])
    drift = halves[1].mean(axis=(0, 1)) - halves[0].mean(axis=(0, 1))
    noise = np.hypot(*(np.nan_to_num(errors_of_mean(part)[0]) for part in halves))
    about_lines = np.hypot(*(_errors_about_lines(part.mean(axis=1)) for part in halves))
    least, more = ABOUT_LINES
    limit = np.maximum(SIGNIFICANT * noise, (least + more / frames) * about_lines)
    return np.asarray(np.where(np.abs(drift) > limit, drift, 0.0))


def _errors_about_lines(series: FloatArray) -> FloatArray:
    """Errors of the means of series, (n, k), by block averages of what a straight line through each leaves."""
    n, count = series.shape
    time = np.linspace(-1.0, 1.0, n)
    rest = series - series.mean(axis=0) - np.outer(time, time @ series) / (time @ time)
    length = max(1, n // BLOCKS)
    blocks = n // length
    means = rest[: blocks * length].reshape(blocks, length, count).mean(axis=1)
    # a line takes two of the blocks' degrees of freedom
    return np.asarray(np.sqrt(means.var(axis=0) / (blocks - 2)))
