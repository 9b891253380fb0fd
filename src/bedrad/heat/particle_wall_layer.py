"""The wall layer of one measured bed, particle by particle, for any pair of gas and solid."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike

from bedrad.heat.ranges import FloatArray, plain, positive, within
from bedrad.heat.systems import System
from bedrad.heat.wall_particles import contributions

__all__ = ["ParticleWallLayer"]

_NODES = 33
_SMALLEST, _LARGEST = 1.0, 1e4
"""Conductivity ratios K between which the layer is known."""


@dataclass(frozen=True, eq=False)
class ParticleWallLayer:
    """A wall layer whose every particle conducts from its own gap (`wall_particles.contributions`).

    With the geometry given, k_wa over k_g depends on K = k_s/k_g alone. It is evaluated at Chebyshev nodes of ln K from
    1 to 10^4 and interpolated in between, to better than 1e-9, so that a prediction need not sum over the particles for
    every temperature and every draw. Make one with `from_particles`.

    Parameters
    ----------
    mean_diameter : float
        Mean diameter of the particles. [m]
    wall_diameter : float
        Inner diameter of the tube; infinite for a flat wall. [m]
    logarithm : Chebyshev
        ln(k_wa/k_g) against ln K.
    relative_error : Chebyshev
        Standard error of k_wa from block to block of the wall, over its value, against ln K; 0 for a single block.
    particles : int
        Particles that reach into the layer.
    """

    mean_diameter: float
    wall_diameter: float
    logarithm: Chebyshev
    relative_error: Chebyshev
    particles: int

    @classmethod
    def from_particles(
        cls,
        gaps: ArrayLike,
        particle_diameters: ArrayLike,
        wall_area: float,
        wall_diameter: float = math.inf,
        contact_gap: float = 1e-2,
        layer_thickness: float | None = None,
        groups: ArrayLike | None = None,
        group_areas: ArrayLike | None = None,
    ) -> ParticleWallLayer:
        """Take the particles of a bed as `wall_particles.contributions` does; warns and refuses as it does."""
        low, high = math.log(_SMALLEST), math.log(_LARGEST)
        nodes = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
        found = [
            contributions(
                1.0, math.exp(x), gaps, particle_diameters, wall_area, wall_diameter, contact_gap, layer_thickness,
                groups, group_areas, warn=k == 0,
            )
            for k, x in enumerate(nodes)
        ]  # fmt: skip
        errors = [0.0 if math.isnan(one.conductivity_error) else one.conductivity_error for one in found]
        values = [one.conductivity for one in found]
        domain = [low, high]
        return cls(
            mean_diameter=float(np.mean(np.asarray(particle_diameters, dtype=np.float64))),
            wall_diameter=wall_diameter,
            logarithm=Chebyshev.fit(nodes, np.log(positive("wall-layer conductivity", values)), _NODES - 1, domain),
            relative_error=Chebyshev.fit(nodes, np.divide(errors, values), _NODES - 1, domain),
            particles=int(np.size(gaps)),
        )

    def conductivity(self, solid_conductivity: ArrayLike, gas_conductivity: ArrayLike) -> FloatArray:
        """Conductivity k_wa of the layer.

        Parameters
        ----------
        solid_conductivity, gas_conductivity : float or array
            Conductivities of particles and gas. [W/(m K)]

        Returns
        -------
        float or array
            k_wa. [W/(m K)]

        Raises
        ------
        ValueError
            If a conductivity is not positive, or their ratio not from 1 to 10^4.
        """
        gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
        return plain(gas * np.exp(self.logarithm(self._ratio(solid_conductivity, gas))))

    def error(self, solid_conductivity: ArrayLike, gas_conductivity: ArrayLike) -> FloatArray:
        """Relative standard error of `conductivity`, from block to block of the wall; takes what that takes."""
        gas = positive("gas_conductivity", gas_conductivity, "W/(m K)")
        return plain(np.maximum(self.relative_error(self._ratio(solid_conductivity, gas)), 0.0))

    def check(self, system: System) -> None:
        """Refuse a system whose tube or particles are not those of the bed, to 2 %.

        Raises
        ------
        ValueError
            If diameters differ, or the wall is flat.
        """
        for name, own in (("tube_diameter", self.wall_diameter), ("particle_diameter", self.mean_diameter)):
            given = getattr(system, name)
            if not math.isclose(given, own, rel_tol=0.02):
                raise ValueError(f"{name} is {given:g} m; the wall layer was measured in a bed with {own:g} m")

    @staticmethod
    def _ratio(solid_conductivity: ArrayLike, gas: FloatArray) -> FloatArray:
        ratio = positive("solid_conductivity", solid_conductivity, "W/(m K)") / gas
        return np.asarray(np.log(within("solid over gas conductivity", ratio, _SMALLEST, _LARGEST)))
