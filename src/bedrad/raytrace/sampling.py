"""Where rays start: independently scrambled Sobol points.

SciPy scrambles by a random lower-triangular matrix and a digital shift (Matousek 1998), the affine form of Owen's
scrambling; it has the same variance as Owen's nested form (Owen 2003). Each scrambling alone is unbiased, so the
scatter between independent scramblings is an honest measure of the error.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

__all__ = ["BATCH", "DIMENSIONS", "MOST_POINTS", "SCRAMBLINGS", "SobolStreams"]

DIMENSIONS = 4
"""Position on the wall (2) and direction (2)."""

SCRAMBLINGS = 32
"""Independent scramblings; their scatter gives standard errors (31 degrees of freedom)."""

BATCH = 2**13
"""Points drawn at a time: few enough to stay in the cache between drawing and tracing."""

MOST_POINTS = 2**30
"""Points that one scrambling can give."""


class SobolStreams:
    """Independently scrambled Sobol sequences that are drawn further and further.

    Parameters
    ----------
    seed : int
        Seed of all scramblings together; each stream gets a child of it.
    count : int
        Number of scramblings.
    """

    def __init__(self, seed: int, count: int) -> None:
        children = np.random.SeedSequence(seed).spawn(count)
        self._engines = [qmc.Sobol(DIMENSIONS, scramble=True, rng=np.random.default_rng(c)) for c in children]

    def __len__(self) -> int:
        return len(self._engines)

    def draw(self, stream: int, count: int) -> Iterator[NDArray[np.float64]]:
        """Draw the next `count` points of one stream, in batches of at most `BATCH`.

        Parameters
        ----------
        stream : int
            Number of the scrambling.
        count : int
            How many points.

        Yields
        ------
        (m, 4) arrays
            Points in [0, 1).
        """
        engine = self._engines[stream]
        while count > 0:
            batch = min(count, BATCH)
            yield np.ascontiguousarray(engine.random(batch))
            count -= batch
