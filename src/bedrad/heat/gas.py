"""Conductivity of dry air at atmospheric pressure."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside

__all__ = ["AIR_RANGE", "air_conductivity"]

AIR_RANGE = (85.0, 2000.0)
"""Temperatures of the correlation. [K]"""

_ATMOSPHERE = 101325.0
_AIR_GAS_CONSTANT = 287.05
# Kadoya, Matsunaga, Nagashima 1985: scales, powers of T/132.5 K and their coefficients, coefficients in
# density
_SCALE = 25.9778e-3
_TEMPERATURE = 132.5
_DENSITY = 314.3
_DILUTE = (
    (1.0, 0.239503),
    (0.5, 0.00649768),
    (0.0, 1.0),
    (-1.0, -1.92615),
    (-2.0, 2.00383),
    (-3.0, -1.07553),
    (-4.0, 0.229414),
)
_RESIDUAL = (0.402287, 0.356603)


def air_conductivity(temperature: ArrayLike) -> FloatArray:
    """Thermal conductivity of dry air at 101.325 kPa (Kadoya, Matsunaga and Nagashima 1985).

    J. Phys. Chem. Ref. Data 14, 947-970, for 85 to 2000 K and up to 100 MPa. Against the equation of Lemmon
    and Jacobsen (2004) it lies 0.8 % lower at 200 K, 0.6 % lower at 300 to 600 K, equal at 1000 K and 1.3 %
    higher at 1500 K; within 1.5 % of the usual textbook table from 300 to 1000 K (0.0263 and 0.0667 W/(m K)
    there).

    Parameters
    ----------
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    float or array
        Conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If a temperature is not positive.

    Warns
    -----
    RangeWarning
        Outside 85 to 2000 K.
    """
    T = positive("temperature", temperature, "K")
    warn_outside("air_conductivity (Kadoya et al. 1985): temperature", T, *AIR_RANGE, "K")
    reduced = T / _TEMPERATURE
    # the residual part is 0.15 % at 300 K, so the ideal gas law is exact enough, and its cubic and higher
    # terms nothing
    density = _ATMOSPHERE / (_AIR_GAS_CONSTANT * T) / _DENSITY
    dilute = np.zeros_like(reduced)
    for power, coefficient in _DILUTE:
        dilute = dilute + coefficient * reduced**power
    return plain(_SCALE * (dilute + density * (_RESIDUAL[0] + _RESIDUAL[1] * density)))
