"""Earlier correlations for the heat transfer to slurries in pipes.

They are those of Table 1 of Scelzo, Peveroni, Laboureur and Buchlin ("S"), with the ranges given there.
Reynolds and Prandtl number are `rho U D/mu` and `c_p mu/k` (S, Table 2 prints the second upside down); which phase
their properties belong to differs between them and is said with each.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, warn_outside

__all__ = [
    "nusselt_dittus_boelter",
    "nusselt_harada",
    "nusselt_ku",
    "nusselt_ozbelge_somer",
    "nusselt_salamone_newman",
]


def nusselt_dittus_boelter(reynolds: ArrayLike, prandtl: ArrayLike, *, warn: bool = True) -> FloatArray:
    """Nusselt number of turbulent flow in a pipe that heats it: `0.023 Re^0.8 Pr^0.4` (Dittus and Boelter 1930).

    Parameters
    ----------
    reynolds, prandtl : float or array
        Reynolds and Prandtl number.
    warn : bool
        Warn outside the range.

    Returns
    -------
    float or array
        h D/k.

    Raises
    ------
    ValueError
        If a number is not positive.

    Warns
    -----
    RangeWarning
        Outside Re 10000 to 120000 or Pr 0.7 to 120; the flows of S are mostly below.
    """
    Re, Pr = positive("reynolds", reynolds), positive("prandtl", prandtl)
    if warn:
        warn_outside("Dittus and Boelter: reynolds", Re, 1e4, 1.2e5)
        warn_outside("Dittus and Boelter: prandtl", Pr, 0.7, 120.0)
    return plain(0.023 * Re**0.8 * Pr**0.4)


def _checked(who: str, limits: dict[str, tuple[float, float]], **values: ArrayLike | None) -> list[FloatArray]:
    """Inputs as positive arrays, in order, with a warning for each outside its range; what is None is left out."""
    checked = []
    for name, value in values.items():
        if value is None:
            continue
        x = positive(name, value)
        if name in limits:
            warn_outside(f"{who} (Table 1 of Scelzo et al.): {name}", x, *limits[name])
        checked.append(x)
    return checked


def nusselt_salamone_newman(
    reynolds: ArrayLike,
    prandtl: ArrayLike,
    diameter_ratio: ArrayLike,
    conductivity_ratio: ArrayLike,
    specific_heat_ratio: ArrayLike,
    volume_fraction: ArrayLike | None = None,
) -> FloatArray:
    """Slurry Nusselt number of Salamone and Newman (1955), as in S, Table 1, with the lost subscripts restored.

    `h D/k_l = 0.131 Re^0.62 Pr^0.72 (k_p/k_l)^0.05 (D/d)^0.05 (c_p,p/c_p,l)^0.36`. The print has C_p mu over C_p mu,
    which is one, in the last bracket; the particles' specific heat over the liquid's is what the fit was made with.

    Parameters
    ----------
    reynolds, prandtl : float or array
        Reynolds number with the density of the slurry; Prandtl number with the conductivity of the liquid.
    diameter_ratio : float or array
        Pipe over particle diameter, D/d.
    conductivity_ratio, specific_heat_ratio : float or array
        Of particles over liquid.
    volume_fraction : float or array, optional
        Only to check the range.

    Returns
    -------
    float or array
        h D/k_l.

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Outside Re 14000 to 140000, Pr 3.4 to 12.7, D/d 282 to 10500 or alpha 0.002 to 0.012.
    """
    limits = {
        "reynolds": (14e3, 140e3),
        "prandtl": (3.4, 12.7),
        "diameter_ratio": (282.0, 10500.0),
        "volume_fraction": (0.002, 0.012),
    }
    inputs = _checked(
        "Salamone and Newman",
        limits,
        reynolds=reynolds,
        prandtl=prandtl,
        diameter_ratio=diameter_ratio,
        conductivity_ratio=conductivity_ratio,
        specific_heat_ratio=specific_heat_ratio,
        volume_fraction=volume_fraction,
    )
    Re, Pr, ratio, k_ratio, c_ratio = inputs[:5]
    return plain(0.131 * Re**0.62 * Pr**0.72 * k_ratio**0.05 * ratio**0.05 * c_ratio**0.36)


def nusselt_ozbelge_somer(
    reynolds: ArrayLike,
    prandtl: ArrayLike,
    diameter_ratio: ArrayLike,
    viscosity_ratio: ArrayLike = 1.0,
    volume_fraction: ArrayLike | None = None,
) -> FloatArray:
    """Slurry Nusselt number of Ozbelge and Somer (1994), as in S, Table 1.

    `h D/k = 0.202 Re^0.6 Pr^0.675 (D/d)^0.092 (mu/mu_w)^-1.95`.

    Parameters
    ----------
    reynolds, prandtl : float or array
        With the properties of the slurry.
    diameter_ratio : float or array
        Pipe over particle diameter, D/d.
    viscosity_ratio : float or array
        Viscosity in the bulk over that at the wall.
    volume_fraction : float or array, optional
        Only to check the range.

    Returns
    -------
    float or array
        h D/k with the conductivity of the slurry.

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Outside Re 27000 to 120000, Pr 2.1 to 3.4, D/d 182 to 512 or alpha 0.005 to 0.03.
    """
    limits = {
        "reynolds": (27e3, 120e3),
        "prandtl": (2.1, 3.4),
        "diameter_ratio": (182.0, 512.0),
        "volume_fraction": (0.005, 0.03),
    }
    inputs = _checked(
        "Ozbelge and Somer",
        limits,
        reynolds=reynolds,
        prandtl=prandtl,
        diameter_ratio=diameter_ratio,
        viscosity_ratio=viscosity_ratio,
        volume_fraction=volume_fraction,
    )
    Re, Pr, ratio, mu_ratio = inputs[:4]
    return plain(0.202 * Re**0.6 * Pr**0.675 * ratio**0.092 * mu_ratio**-1.95)


def nusselt_harada(
    reynolds: ArrayLike,
    prandtl: ArrayLike,
    viscosity_ratio: ArrayLike = 1.0,
    diameter_ratio: ArrayLike | None = None,
    volume_fraction: ArrayLike | None = None,
) -> FloatArray:
    """Slurry Nusselt number of Harada, Toda, Kuriyama and Konno (1985), as in S, Table 1.

    `h D/k_l = 0.0161 Re^0.88 Pr^(1/3) (mu/mu_w)^-0.14`. The sign of the last exponent is as printed; Sieder and Tate
    (1936), whose form this is, have +0.14 there.

    Parameters
    ----------
    reynolds, prandtl : float or array
        Reynolds number with the density of the slurry; Prandtl number with the conductivity of the liquid.
    viscosity_ratio : float or array
        Viscosity in the bulk over that at the wall.
    diameter_ratio, volume_fraction : float or array, optional
        D/d and alpha, only to check the range.

    Returns
    -------
    float or array
        h D/k_l.

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Outside Re 8000 to 50000, D/d 14 to 147 or alpha 0.01 to 0.1.
    """
    limits = {"reynolds": (8e3, 50e3), "diameter_ratio": (14.0, 147.0), "volume_fraction": (0.01, 0.1)}
    inputs = _checked(
        "Harada et al.",
        limits,
        reynolds=reynolds,
        prandtl=prandtl,
        viscosity_ratio=viscosity_ratio,
        diameter_ratio=diameter_ratio,
        volume_fraction=volume_fraction,
    )
    Re, Pr, mu_ratio = inputs[:3]
    return plain(0.0161 * Re**0.88 * np.cbrt(Pr) * mu_ratio**-0.14)


def nusselt_ku(
    reynolds: ArrayLike,
    prandtl: ArrayLike,
    diameter_ratio: ArrayLike,
    volume_fraction: ArrayLike | None = None,
) -> FloatArray:
    """Slurry Nusselt number of Ku, Cho, Koo, Yoon and Lee (2000), as in S, Table 1.

    `h D/k = 0.0138 Re^0.772 Pr^0.809 (D/d)^0.042`.

    Parameters
    ----------
    reynolds, prandtl : float or array
        With the properties of the slurry.
    diameter_ratio : float or array
        Pipe over particle diameter, D/d.
    volume_fraction : float or array, optional
        Only to check the range.

    Returns
    -------
    float or array
        h D/k with the conductivity of the slurry.

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Outside Re 3000 to 11000, Pr 3.8 to 5, D/d 102 to 615 or alpha 0.01 to 0.1.
    """
    limits = {
        "reynolds": (3e3, 11e3),
        "prandtl": (3.8, 5.0),
        "diameter_ratio": (102.0, 615.0),
        "volume_fraction": (0.01, 0.1),
    }
    inputs = _checked(
        "Ku et al.",
        limits,
        reynolds=reynolds,
        prandtl=prandtl,
        diameter_ratio=diameter_ratio,
        volume_fraction=volume_fraction,
    )
    Re, Pr, ratio = inputs[:3]
    return plain(0.0138 * Re**0.772 * Pr**0.809 * ratio**0.042)
