"""Two-layer model of a plug flow in a tube with uniform wall heat flux (Watkins 2018, section 3.1).

A bulk of conductivity k_b fills the tube up to one particle radius from the wall; the wall-adjacent layer
there has the conductivity k_wa. Both move with the same uniform velocity.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive

__all__ = ["nusselt_developed"]


def nusselt_developed(diameter_ratio: ArrayLike, conductivity_ratio: ArrayLike) -> FloatArray:
    """Nusselt number of the thermally developed flow (Watkins 2018, eq. 22-23).

    The two terms of its denominator are the resistances of bulk and wall layer in series, so the heat
    transfer coefficient `h = Nu k_b/D` rises with either conductivity.

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, above 1; may be infinite.
    conductivity_ratio : float or array
        Bulk over wall-layer conductivity, kappa = k_b/k_wa.

    Returns
    -------
    float or array
        Nu = h D/k_b, with h on the difference of wall and mean temperature.

    Raises
    ------
    ValueError
        If the diameter ratio is not above 1 or the conductivity ratio not positive.
    """
    A = positive("diameter_ratio", diameter_ratio, infinite=True)
    if np.any(A <= 1.0):
        raise ValueError(f"diameter_ratio is {float(np.min(A)):g}; expected more than 1")
    kappa = positive("conductivity_ratio", conductivity_ratio)
    e = 1.0 / A
    wall_share = e * (4.0 + e * (-6.0 + e * (4.0 - e)))
    return plain(8.0 / ((1.0 - e) ** 4 + kappa * wall_share))
