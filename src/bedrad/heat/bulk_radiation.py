"""Conductivity of a bed of spheres by radiation alone, `k_r = 4 sigma T^3 d F`, as published models give it.

The models differ in the exchange factor F. Those of Argo and Smith (1953), Schotte (1960) and Vortmeyer (1978) know the
emissivity, Breitbach and Barthels' (1980) and Singh and Kaviany's (1994) also that a particle's far side is colder than
its near side.
Add k_r to a conduction model such as `bulk.zehner_schluender`, not to one that has radiation already.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.bulk_models import deformation, void_fraction
from bedrad.heat.radiation import STEFAN_BOLTZMANN
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, warn_outside, within

__all__ = [
    "SINGH_KAVIANY_POROSITY",
    "argo_smith",
    "black_conductivity",
    "breitbach_barthels",
    "exchange_factor",
    "schotte",
    "singh_kaviany",
    "vortmeyer",
    "vortmeyer_transmission",
]

SINGH_KAVIANY_POROSITY: Final = 0.476
"""Porosity of the simple cubic packing of Singh and Kaviany's calculations."""

_SINGH_KAVIANY: Final = (0.5756, 1.5353, 0.8011, 0.1843)
_VORTMEYER_TRANSMISSION: Final = (0.149909, -0.24791, 0.290799, -0.20081, 0.0651042)


def black_conductivity(particle_diameter: ArrayLike, temperature: ArrayLike) -> FloatArray:
    """Radiative conductivity for F = 1, `4 sigma T^3 d`.

    Parameters
    ----------
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    float or array
        Conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    d = positive("particle_diameter", particle_diameter, "m")
    return plain(4.0 * STEFAN_BOLTZMANN * positive("temperature", temperature, "K") ** 3 * d)


def exchange_factor(conductivity: ArrayLike, particle_diameter: ArrayLike, temperature: ArrayLike) -> FloatArray:
    """Exchange factor that a radiative conductivity stands for, `F = k_r/(4 sigma T^3 d)`.

    Parameters
    ----------
    conductivity : float or array
        Radiative conductivity. [W/(m K)]
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]

    Returns
    -------
    float or array
        F.

    Raises
    ------
    ValueError
        If the conductivity is negative or another input not positive.
    """
    k_r = non_negative("conductivity", conductivity, "W/(m K)")
    return plain(k_r / black_conductivity(particle_diameter, temperature))


def argo_smith(particle_diameter: ArrayLike, temperature: ArrayLike, emissivity: ArrayLike = 0.8) -> FloatArray:
    """Radiative conductivity by Argo and Smith (1953), `F = e/(2 - e)`: parallel planes a diameter apart.

    Parameters
    ----------
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.

    Returns
    -------
    float or array
        Radiative conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    e = within("emissivity", emissivity, 0.0, 1.0)
    return plain(black_conductivity(particle_diameter, temperature) * e / (2.0 - e))


def vortmeyer_transmission(emissivity: ArrayLike) -> FloatArray:
    """Share of radiation that passes a layer of particles without touching or by reflection, for `vortmeyer`.

    A polynomial in the emissivity, `0.149909 - 0.24791 e + 0.290799 e^2 - 0.20081 e^3 + 0.0651042 e^4`, that
    stands for Vortmeyer's numbers at a porosity near 0.4.

    Parameters
    ----------
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.

    Returns
    -------
    float or array
        B.

    Raises
    ------
    ValueError
        If the emissivity is not from 0 to 1.
    """
    e = within("emissivity", emissivity, 0.0, 1.0)
    return plain(np.polynomial.polynomial.polyval(e, _VORTMEYER_TRANSMISSION))


def vortmeyer(particle_diameter: ArrayLike, temperature: ArrayLike, emissivity: ArrayLike = 0.8) -> FloatArray:
    """Radiative conductivity by the layer model of Vortmeyer (1978).

    6th Int. Heat Transfer Conf. 6, 525-539: `F = [2B + e (1 - B)]/[2 (1 - B) - e (1 - B)]`, with the
    transmission B of a layer from `vortmeyer_transmission`.

    Parameters
    ----------
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.

    Returns
    -------
    float or array
        Radiative conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    e = within("emissivity", emissivity, 0.0, 1.0)
    B = vortmeyer_transmission(e)
    F = (2.0 * B + e * (1.0 - B)) / ((2.0 - e) * (1.0 - B))
    return plain(black_conductivity(particle_diameter, temperature) * F)


def schotte(
    solid_conductivity: ArrayLike,
    porosity: ArrayLike,
    particle_diameter: ArrayLike,
    temperature: ArrayLike,
    emissivity: ArrayLike = 0.8,
) -> FloatArray:
    """Radiative conductivity by Schotte (1960): through the solid in series, across the voids beside it.

    AIChE J. 6, 63-67: `k_r = (1 - eps)/(1/k_s + 1/k_r0) + eps k_r0` with `k_r0 = 4 sigma e T^3 d`.

    Parameters
    ----------
    solid_conductivity : float or array
        Conductivity of the solid. [W/(m K)]
    porosity : float or array
        Void fraction of the bed, between 0 and 1.
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.

    Returns
    -------
    float or array
        Radiative conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    k_s = positive("solid_conductivity", solid_conductivity, "W/(m K)")
    eps = void_fraction(porosity)
    k_r0 = within("emissivity", emissivity, 0.0, 1.0) * black_conductivity(particle_diameter, temperature)
    return plain((1.0 - eps) * k_r0 / (1.0 + k_r0 / k_s) + eps * k_r0)


def breitbach_barthels(
    solid_conductivity: ArrayLike,
    porosity: ArrayLike,
    particle_diameter: ArrayLike,
    temperature: ArrayLike,
    emissivity: ArrayLike = 0.8,
) -> FloatArray:
    """Radiative conductivity by Breitbach and Barthels (1980): Zehner and Schluender's cell in a vacuum.

    Nucl. Technol. 49, 392-399: `F = (1 - sqrt(1-eps)) eps + sqrt(1-eps)/(2/e - 1) (B+1)/B /(1 + 1/((2/e - 1) L))`
    with `L = k_s/(4 sigma T^3 d)` and B = `bulk.deformation`. Made for pebble beds, porosities near 0.4: as the
    porosity goes to 1, F diverges like (1 - eps)^(-11/18); at emissivity 0 the voids still exchange.

    Parameters
    ----------
    solid_conductivity : float or array
        Conductivity of the solid. [W/(m K)]
    porosity : float or array
        Void fraction of the bed, between 0 and 1.
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.

    Returns
    -------
    float or array
        Radiative conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    k_s = positive("solid_conductivity", solid_conductivity, "W/(m K)")
    eps = void_fraction(porosity)
    e = within("emissivity", emissivity, 0.0, 1.0)
    black = black_conductivity(particle_diameter, temperature)
    root, grey = np.sqrt(1.0 - eps), e / (2.0 - e)
    F = eps * eps / (1.0 + root) + root * grey * (1.0 + 1.0 / deformation(eps)) / (1.0 + grey * black / k_s)
    return plain(black * F)


def singh_kaviany(
    solid_conductivity: ArrayLike,
    particle_diameter: ArrayLike,
    temperature: ArrayLike,
    emissivity: ArrayLike = 0.8,
    porosity: ArrayLike = SINGH_KAVIANY_POROSITY,
) -> FloatArray:
    """Radiative conductivity by the fit of Singh and Kaviany (1994) to their Monte Carlo calculations.

    Int. J. Heat Mass Transfer 37, 2579-2583: `F = a_1 e arctan(a_2 L^a_3/e) + a_4`, `L = k_s/(4 sigma T^3 d)`,
    for opaque, diffusely reflecting spheres. Porosity is not in the fit: it holds near 0.476 and is used at 0.4 to 0.5.

    Parameters
    ----------
    solid_conductivity : float or array
        Conductivity of the solid. [W/(m K)]
    particle_diameter : float or array
        Particle diameter. [m]
    temperature : float or array
        Temperature. [K]
    emissivity : float or array
        Emissivity of the particle surface, 0 to 1.
    porosity : float or array
        Void fraction of the bed: changes nothing, but warns where the fit was not made for it.

    Returns
    -------
    float or array
        Radiative conductivity. [W/(m K)]

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If the porosity is outside 0.4 to 0.5.
    """
    a_1, a_2, a_3, a_4 = _SINGH_KAVIANY
    k_s = positive("solid_conductivity", solid_conductivity, "W/(m K)")
    e = within("emissivity", emissivity, 0.0, 1.0)
    eps = void_fraction(porosity)
    warn_outside("singh_kaviany (Singh and Kaviany 1994): porosity", eps, 0.4, 0.5)
    black = black_conductivity(particle_diameter, temperature)
    # the arctangent of a quotient whose parts stay finite as T or e go to 0
    F = a_1 * e * np.arctan2(a_2, e * (black / k_s) ** a_3) + a_4
    return plain(np.broadcast_arrays(black * F, eps)[0])
