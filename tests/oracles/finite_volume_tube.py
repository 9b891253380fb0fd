"""Plug flow in a heated tube by radial finite volumes: no series, no Bessel functions.

Lengths in tube radii, conductivities in k_b, temperatures in q R/k_b; time t = z alpha_b/(U R^2) = 4 z*. A face lies on
the interface of the two layers, the flux between two cells goes through both halves in series, and along t the
linear system is solved exactly by its eigenvectors: the error is that of the radial grid alone, of second order.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh_tridiagonal, eigvalsh_tridiagonal


def faces(diameter_ratio, bulk_cells, layer_cells):
    """Faces of the cells from axis to wall, equal ones in each layer."""
    W = 1.0 - 1.0 / diameter_ratio
    return np.concatenate([np.linspace(0.0, W, bulk_cells + 1), np.linspace(W, 1.0, layer_cells + 1)[1:]])


class Tube:
    """Cells, their coupling and its eigenvectors."""

    def __init__(self, diameter_ratio, kappa, bulk_cells, layer_cells):
        f = faces(diameter_ratio, bulk_cells, layer_cells)
        k = np.where(np.arange(f.size - 1) < bulk_cells, 1.0, 1.0 / kappa)
        self.kappa, self.width = kappa, np.diff(f)
        self.centres = 0.5 * (f[1:] + f[:-1])
        self.volume = 0.5 * (f[1:] ** 2 - f[:-1] ** 2)
        half = 0.5 * self.width / k
        coupling = f[1:-1] / (half[1:] + half[:-1])
        out = np.concatenate([coupling, [0.0]]) + np.concatenate([[0.0], coupling])
        self.bands = out / self.volume, -coupling / np.sqrt(self.volume[1:] * self.volume[:-1])

    def eigenvalues(self, number):
        """The first eigenvalues lambda_b R above zero."""
        return np.sqrt(eigvalsh_tridiagonal(*self.bands, select="i", select_range=(1, number)))

    def temperature(self, t, ramp=0.0):
        """Rise (cells,) after a wall flux 1 + ramp t from t = 0 on."""
        rate, vectors = eigh_tridiagonal(*self.bands)
        flux = vectors[-1] / np.sqrt(self.volume[-1])
        rate[0] = 0.0
        x = rate * t
        steady = np.divide(-np.expm1(-x), rate, out=np.full_like(rate, t), where=rate > 0)
        growing = np.divide(t - steady, rate, out=np.full_like(rate, 0.5 * t * t), where=rate > 0)
        return vectors @ (flux * (steady + ramp * growing)) / np.sqrt(self.volume)

    def excess(self, t, ramp=0.0):
        """Wall less mean temperature."""
        T = self.temperature(t, ramp)
        wall = T[-1] + 0.5 * self.width[-1] * self.kappa * (1.0 + ramp * t)
        return wall - 2.0 * np.dot(self.volume, T)

    def nusselt(self, z_star):
        return 2.0 / self.excess(4.0 * z_star)


def variable_properties(distance, flux, case, bulk_cells=60, layer_cells=20):
    """Wall and mean temperature [K] at distances (n,) from the inlet, each cell with the properties of its temperature.

    `flux` [W/m2] is a function of the distance; `case` a dictionary with what `tube_temperatures` takes, its properties
    functions of temperature, c_p = c0 + c1 T given as `specific_heat_line` for the enthalpy.
    """
    R, m = 0.5 * case["tube_diameter"], case["mass_flow"] / (np.pi * (0.5 * case["tube_diameter"]) ** 2)
    f = faces(case["tube_diameter"] / case["particle_diameter"], bulk_cells, layer_cells) * R
    width, volume, bulk = np.diff(f), 0.5 * np.diff(f**2), np.arange(f.size - 1) < bulk_cells
    c0, c1 = case["specific_heat_line"]

    def conductivity(T):
        return np.where(bulk, case["bulk_conductivity"](T), case["wall_layer_conductivity"](T))

    def slope(z, T):
        half = 0.5 * width / conductivity(T)
        heat = f[1:-1] * (T[1:] - T[:-1]) / (half[1:] + half[:-1])
        into = np.concatenate([heat, [R * flux(z)]]) - np.concatenate([[0.0], heat])
        return into / (volume * m * (c0 + c1 * T))

    start = np.full(f.size - 1, case["inlet_temperature"])
    found = solve_ivp(slope, (0, distance[-1]), start, "LSODA", t_eval=distance, rtol=1e-8, atol=1e-6, lband=1, uband=1)
    T = found.y
    wall = T[-1] + flux(distance) * 0.5 * width[-1] / case["wall_layer_conductivity"](T[-1])
    enthalpy = 2.0 / R**2 * volume @ (c0 * T + 0.5 * c1 * T**2)
    mean = enthalpy / c0 if c1 == 0 else (-c0 + np.sqrt(c0**2 + 2.0 * c1 * enthalpy)) / c1
    return wall, mean
