"""Heat transfer of a wall against the solid fraction next to it (Morris et al., in Adepu et al., eq. 9)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, warn_outside, within

__all__ = ["LARGEST_SOLID_FRACTION", "NUSSELT_RATIO", "nusselt_ratio"]

NUSSELT_RATIO = (1.0838e-3, -2.1709e-2, 2.4268, 1.9101, -122.43, 615.04, -1170.6, 790.93)
"""Coefficients of eq. 9, powers 0 to 7. The powers of ten are lost in the print; these are the only ones that give a
curve that rises throughout."""

LARGEST_SOLID_FRACTION = math.pi / (3.0 * math.sqrt(3.0))
"""Solid fraction of a hexagonal layer of touching spheres, cut one radius from the wall: 0.6046."""


def nusselt_ratio(solid_fraction: ArrayLike) -> FloatArray:
    """Nusselt number of a wall over its largest, against the solid fraction at the wall (Adepu et al., eq. 9).

    Fit of Morris et al. to simulations with fluid lenses. Adepu et al. use it from 0.53 to 0.58. It falls by 5e-5
    below a fraction of 0.0045, reaches 0.81 at the densest possible wall layer and 1 at 0.620.

    Parameters
    ----------
    solid_fraction : float or array
        Solid fraction next to the wall, from 0 to 1.

    Returns
    -------
    float or array
        Nu/Nu_max.

    Raises
    ------
    ValueError
        If a fraction does not lie between 0 and 1.

    Warns
    -----
    RangeWarning
        Above 0.6046, the solid fraction of a hexagonal wall layer.
    """
    fraction = within("solid_fraction", solid_fraction, 0.0, 1.0)
    warn_outside("nusselt_ratio (Adepu et al., eq. 9): solid_fraction", fraction, 0.0, LARGEST_SOLID_FRACTION)
    total = np.zeros_like(fraction)
    for coefficient in reversed(NUSSELT_RATIO):
        total = total * fraction + coefficient
    return plain(total)
