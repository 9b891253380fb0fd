"""What the two-layer model says at measured conditions, to put beside the points (Watkins 2018, chapters 4 and 5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat import two_layer
from bedrad.heat.gas import air_conductivity
from bedrad.heat.measured_flow_run import ReducedRun
from bedrad.heat.radiation import WATKINS_FACTORS
from bedrad.heat.radiation import conductivity as radiative_conductivity
from bedrad.heat.ranges import FloatArray, plain, positive
from bedrad.heat.systems import System, WallLayer

__all__ = ["ModelRun", "TwoLayerValues", "beside_model", "two_layer_values"]


CURVE_POINTS = 80
"""Points of a curve along the tube."""


@dataclass(frozen=True, eq=False)
class TwoLayerValues:
    """The two-layer model at given conditions.

    Parameters
    ----------
    conductivity_ratio : float or array
        kappa = k_b/(k_wa + k_rad).
    developed, complete : float or array
        Nu of the developed flow (eq. 22) and at z* (eq. 73).
    """

    conductivity_ratio: FloatArray
    developed: FloatArray
    complete: FloatArray


def two_layer_values(
    system: System,
    wall_temperature: ArrayLike,
    mean_temperature: ArrayLike,
    bulk_conductivity: ArrayLike,
    z_star: ArrayLike,
) -> TwoLayerValues:
    """Nusselt numbers of the two-layer model at the temperatures of a measurement.

    As in the source, the wall layer by correlations with air at the mean temperature (chapter 4), radiation in it at
    the wall temperature with the published view factors (eq. 50).

    Parameters
    ----------
    system : System
        Tube, particles and mean velocity.
    wall_temperature, mean_temperature : float or array
        T_w and T_m. [K]
    bulk_conductivity : float or array
        k_b. [W/(m K)]
    z_star : float or array
        Inverse Graetz number.

    Returns
    -------
    TwoLayerValues
        Broadcast over the arrays.

    Raises
    ------
    ValueError
        If an input is not positive.

    Warns
    -----
    RangeWarning
        Outside the range of the correlations for the wall layer.
    """
    T_w, T_m = positive("wall_temperature", wall_temperature, "K"), positive("mean_temperature", mean_temperature, "K")
    k_b = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    z = positive("z_star", z_star, infinite=True)
    k_wa = WallLayer.from_correlations(system).conductivity(system, air_conductivity(T_m))
    kappa, z = np.broadcast_arrays(
        k_b / (k_wa + radiative_conductivity(WATKINS_FACTORS, system.particle_diameter, T_w)), z
    )
    A = system.diameter_ratio
    return TwoLayerValues(plain(kappa), two_layer.nusselt_developed(A, kappa), two_layer.nusselt(A, kappa, z))


@dataclass(frozen=True, eq=False)
class ModelRun:
    """The two-layer model beside a reduced run.

    Parameters
    ----------
    velocity : float
        Mean velocity. [m/s]
    stations : TwoLayerValues
        At the conditions of each station.
    z_star : (n,) array
        Inverse Graetz numbers of the curve.
    curve : TwoLayerValues
        Along the tube, with temperatures and k_b at the average of the stations.
    """

    velocity: float
    stations: TwoLayerValues
    z_star: FloatArray
    curve: TwoLayerValues


def beside_model(
    runs: Sequence[ReducedRun],
    tube_diameter: float,
    particle_diameter: float,
    bulk_density: float,
    solid_conductivity: float,
) -> list[ModelRun]:
    """Two-layer model for tube, particles and velocity of each reduced run.

    Parameters
    ----------
    runs : sequence of ReducedRun
        The runs, of one tube and one kind of particles.
    tube_diameter, particle_diameter : float
        Inner diameter of the tube, and diameter of the particles. [m]
    bulk_density : float
        Density of the flowing bed, by which the mass flux becomes a velocity. [kg/m3]
    solid_conductivity : float
        Conductivity of the particles. [W/(m K)]

    Returns
    -------
    list of ModelRun
        Values at the stations, and a curve over the z* of all runs and some more to both sides.

    Raises
    ------
    ValueError
        If there is no run, or an input is not positive.

    Warns
    -----
    RangeWarning
        Outside the range of the correlations for the wall layer.
    """
    if not runs:
        raise ValueError("runs is empty; expected at least one")
    density = float(positive("bulk_density", bulk_density, "kg/m3"))
    every = np.concatenate([run.z_star for run in runs])
    curve = np.geomspace(0.5 * every.min(), 2.0 * every.max(), CURVE_POINTS)
    found = []
    for run in runs:
        velocity = run.mass_flux / density
        system = System(tube_diameter, particle_diameter, velocity, solid_conductivity=solid_conductivity)
        T_w, T_m, k_b = run.wall_temperature.value, run.mean_temperature.value, run.bulk_conductivity.value
        stations = two_layer_values(system, T_w, T_m, k_b, run.z_star)
        along = two_layer_values(system, np.mean(T_w), np.mean(T_m), np.mean(k_b), curve)
        found.append(ModelRun(velocity, stations, curve, along))
    return found
