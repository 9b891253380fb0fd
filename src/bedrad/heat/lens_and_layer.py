"""The same heat by two roads: Rong and Horio's fluid lenses (1999) against Watkins' wall layer (2018).

Both let heat run straight from a flat wall into every particle near it. Rong and Horio stop at the surface of an
isothermal particle, keep `asperity` as the least gap and cut the lens at 1.4 radii; Watkins goes on through the solid
to one radius from the wall, knows no asperities, takes all of the particle within that layer, and adds the gas
between the particles. The difference is the sum of these four.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from bedrad.heat.fluid_lens import LENS_RADIUS, lens_integral
from bedrad.heat.ranges import FloatArray, plain, positive, within
from bedrad.heat.single_particle import particle_conductivity

__all__ = ["LensAgainstLayer", "compare", "equivalent_asperity"]


@dataclass(frozen=True)
class LensAgainstLayer:
    """Coefficients of a wall by both models, and the four steps that lead from one to the other.

    Parameters
    ----------
    rong_horio : float
        h by fluid lenses. [W/(m2 K)]
    edge : float
        Added where each lens is widened from the given radius to all of the particle within one radius of the
        wall. [W/(m2 K)]
    solid : float
        Added, and negative, by the resistance of the solid down to one radius from the wall. [W/(m2 K)]
    asperity : float
        Added by taking the asperities away. [W/(m2 K)]
    void : float
        Added by the gas between the particles; negative where their covered areas overlap. [W/(m2 K)]
    watkins : float
        k_wa over the particle radius, the sum of all of these. [W/(m2 K)]
    """

    rong_horio: float
    edge: float
    solid: float
    asperity: float
    void: float
    watkins: float

    def __str__(self) -> str:
        """One screen."""
        rows = (
            ("fluid lenses (Rong and Horio)", self.rong_horio),
            ("+ lens out to one radius from the wall", self.edge),
            ("+ resistance of the solid", self.solid),
            ("+ no asperities", self.asperity),
            ("+ gas between the particles", self.void),
            ("= k_wa/r (Watkins)", self.watkins),
        )
        return "\n".join(f"{name:<39} {value:9.4g} W/(m2 K)" for name, value in rows)


def compare(
    gas_conductivity: float,
    solid_conductivity: float,
    particle_diameter: float,
    gaps: ArrayLike,
    wall_area: float,
    asperity: float,
    lens_radius: float = LENS_RADIUS,
) -> LensAgainstLayer:
    """Coefficient of a flat wall by Rong and Horio and by Watkins on the same gaps, and what lies between.

    The steps are taken in the order of the result. The solid comes before the asperities go: without either, a
    particle in contact would conduct without limit.

    Parameters
    ----------
    gas_conductivity, solid_conductivity : float
        Conductivities of gas and particles. [W/(m K)]
    particle_diameter : float
        Diameter of all particles. [m]
    gaps : (n,) array
        Gaps between particles and wall; overlapping particles count as touching. [m]
    wall_area : float
        Area of wall that the particles were taken from. [m2]
    asperity : float
        Height of the asperities, above 0. [m]
    lens_radius : float
        Radius of the lens in particle radii, above 1.

    Returns
    -------
    LensAgainstLayer

    Raises
    ------
    ValueError
        If an input has no meaning.
    """
    gas = float(positive("gas_conductivity", gas_conductivity, "W/(m K)"))
    K = float(positive("solid_conductivity", solid_conductivity, "W/(m K)")) / gas
    r = 0.5 * float(positive("particle_diameter", particle_diameter, "m"))
    area = float(positive("wall_area", wall_area, "m2"))
    s = float(positive("asperity", asperity, "m")) / r
    lens = float(positive("lens_radius", lens_radius))
    if lens <= 1.0:
        raise ValueError(f"lens_radius is {lens:g}; expected more than 1 particle radius")
    delta = np.asarray(gaps, dtype=np.float64)
    if delta.ndim != 1 or not np.all(np.isfinite(delta)):
        raise ValueError(f"gaps has shape {delta.shape}; expected one finite gap for each particle")
    delta = np.maximum(delta / r, 0.0)
    near = delta[delta < max(lens - 1.0, 1.0)]
    narrow = np.sqrt(np.clip((lens - 1.0 - near) * (lens + 1.0 + near), 0.0, 1.0))
    layer = near < 1.0
    wide = np.sqrt(np.where(layer, (1.0 - near) * (1.0 + near), 0.0))
    unit = gas * r / area
    rong_horio = unit * float(np.sum(lens_integral(near, s, narrow)))
    widened = unit * float(np.sum(lens_integral(near, s, wide)))
    with_solid = unit * float(np.sum(lens_integral(near, s, wide, 0.0, K)))
    covered = math.pi * wide[layer] ** 2
    smooth = unit * float(np.sum(covered * particle_conductivity(K, near[layer])))
    void = gas / r * (1.0 - r * r * float(np.sum(covered)) / area)
    return LensAgainstLayer(
        rong_horio=rong_horio,
        edge=widened - rong_horio,
        solid=with_solid - widened,
        asperity=smooth - with_solid,
        void=void,
        watkins=smooth + void,
    )


def equivalent_asperity(conductivity_ratio: ArrayLike) -> FloatArray:
    """Asperity height that resists as much as the solid of a particle in contact with the wall.

    A lens over the whole radius of an isothermal particle conducts `H/(k_g r) = 2 pi (s/2 - ln s)`; Watkins' smooth
    particle `pi k_C/k_g` (2018, eq. 34), which tends to `2 pi (ln K - 1)`. They are equal at
    `s = -2 W(-exp(-k_C/(2 k_g))/2)` with Lambert's W, hence `s -> e/K` for large K.

    Parameters
    ----------
    conductivity_ratio : float or array
        K, solid over gas conductivity, from 1.

    Returns
    -------
    float or array
        s, in particle radii, 1 for K = 1.

    Raises
    ------
    ValueError
        If a ratio is below 1 or infinite.
    """
    K = within("conductivity_ratio", conductivity_ratio, 1.0, math.inf, open_above=True)
    return plain(-2.0 * special.lambertw(-0.5 * np.exp(-0.5 * particle_conductivity(K))).real)
