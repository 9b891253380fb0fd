"""Mean diameters of spheres of several sizes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["MeanDiameters", "mean_diameters"]


@dataclass(frozen=True)
class MeanDiameters:
    """Means of a distribution of sizes; equal for equal spheres, else in rising order.

    Attributes
    ----------
    number : float
        Number mean d10 = sum d / n. [m]
    sauter : float
        Sauter mean d32 = sum d^3 / sum d^2: the size with the bed's ratio of volume to surface. [m]
    volume_weighted : float
        Volume-weighted (De Brouckere) mean d43 = sum d^4 / sum d^3. [m]
    """

    number: float
    sauter: float
    volume_weighted: float


def mean_diameters(radii: ArrayLike) -> MeanDiameters:
    """Mean diameters of spheres.

    Parameters
    ----------
    radii : (n,) array
        At least one radius. [m]

    Returns
    -------
    MeanDiameters
        Number, Sauter and volume-weighted mean.

    Raises
    ------
    ValueError
        If there is no sphere, or a radius is not positive and finite.
    """
    d = 2.0 * np.asarray(radii, dtype=float)
    if d.ndim != 1 or not len(d) or not (np.isfinite(d).all() and (d > 0.0).all()):
        raise ValueError(f"radii has the shape {d.shape}; expected at least one positive, finite radius")
    # powers of sizes over the largest neither vanish nor overflow
    x = d / d.max()
    return MeanDiameters(
        number=float(d.mean()),
        sauter=float(d.max() * (x**3).sum() / (x**2).sum()),
        volume_weighted=float(d.max() * (x**4).sum() / (x**3).sum()),
    )
