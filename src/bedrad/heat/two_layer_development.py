"""Where a flow in a heated tube is developed, by the two-layer model (Watkins 2018, section 4.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import elementwise

from bedrad.heat import two_layer_evaluation as evaluation
from bedrad.heat.ranges import FloatArray, plain, within
from bedrad.heat.two_layer_modes import Layers, checked, find_modes

__all__ = ["developed_z_star"]

_NEAREST = 1e-14
"""Start of the search, over the distance at which the flow is developed for sure."""


def developed_z_star(diameter_ratio: ArrayLike, conductivity_ratio: ArrayLike, share: ArrayLike = 0.05) -> FloatArray:
    """Distance from the inlet at which Nu exceeds that of the developed flow by a given share.

    By `nusselt_developed` the error of Nu is below `share` everywhere behind it, as Nu falls along the tube. By the
    complete model, Watkins (2018, eq. 73).

    Parameters
    ----------
    diameter_ratio : float or array
        Tube inner diameter over particle diameter, above 1; may be infinite.
    conductivity_ratio : float or array
        Bulk over wall-layer conductivity, kappa = k_b/k_wa.
    share : float or array
        Nu over that of the developed flow, less 1; from 1e-12 to 1000.

    Returns
    -------
    float or array
        z* = z alpha_b/(U D^2).

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If a conductivity ratio lies outside 1e-6 to 1e6, where rounding was not measured.
    """
    A, kappa = checked(diameter_ratio, conductivity_ratio)
    shape, pairs, (wanted,) = evaluation.flattened(A, kappa, within("share", share, 1e-12, 1e3))
    if wanted.size == 0:
        return plain(np.zeros(shape))
    # what is missing decays at least as fast as the first mode, and is never less than that mode
    first, missing = find_modes(pairs, 1), wanted / (1.0 + wanted)
    latest = -np.log(missing) / first.mu[:, 0] ** 2
    head_start = np.log(first.weights[:, 0] / (pairs.resistance * missing)) / first.mu[:, 0] ** 2
    earliest = np.maximum(_NEAREST * latest, head_start * (1.0 - 1e-9))
    tolerance = 1e-11 * min(1.0, float(wanted.min()))

    def above(log_t: FloatArray, W: FloatArray, e: FloatArray, kappa: FloatArray, wanted: FloatArray) -> FloatArray:
        found = evaluation.excess(Layers(W, e, kappa), np.exp(log_t), tolerance)
        return np.asarray(np.log(found.missing / found.value) - np.log(wanted))

    bracket = np.log(earliest), np.log(latest * (1.0 + 1e-9))
    found = elementwise.find_root(above, bracket, args=(pairs.W, pairs.e, pairs.kappa, wanted))
    if not np.all(found.success):
        raise ArithmeticError("no z* with the wanted excess over the developed flow was found")
    return plain(0.25 * np.exp(found.x).reshape(shape))
