"""Heat transfer coefficient, Nusselt number and first-law check of a measured flow (Watkins 2018, ch. 2, app. A)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bedrad.heat.energy_balance import SpecificHeat, heat_rate, mean_temperature
from bedrad.heat.materials import Material
from bedrad.heat.measured_flow_value import Measured, as_measured, combined
from bedrad.heat.ranges import FloatArray, non_negative, plain, positive

__all__ = ["FirstLaw", "first_law_check", "heat_transfer_coefficient", "inverse_graetz", "nusselt"]


def heat_transfer_coefficient(
    heat_flux: ArrayLike | Measured, wall_temperature: ArrayLike | Measured, mean_temperature: ArrayLike | Measured
) -> Measured:
    """Heat transfer coefficient with its error (Watkins 2018, eq. 1, 56).

    Parameters
    ----------
    heat_flux : float, array or Measured
        Wall heat flux q, positive into the flow. [W/m2]
    wall_temperature : float, array or Measured
        Temperature of the wall's inside, T_w. [K]
    mean_temperature : float, array or Measured
        Mean temperature of the flow, T_m. [K]

    Returns
    -------
    Measured
        `h = q/(T_w - T_m)`. [W/(m2 K)]

    Raises
    ------
    ValueError
        If an input has no meaning, or flux and temperature difference are not of the same sign.
    """
    q = as_measured("heat_flux", heat_flux, "W/m2", sign=True)
    T_w = as_measured("wall_temperature", wall_temperature, "K")
    T_m = as_measured("mean_temperature", mean_temperature, "K")
    difference, flux = np.broadcast_arrays(T_w.value - T_m.value, q.value)
    if np.any(difference * flux <= 0.0):
        where = int(np.argmin(difference * flux))
        raise ValueError(
            f"wall_temperature less mean_temperature is {difference.flat[where]:g} K for a heat_flux of "
            f"{flux.flat[where]:g} W/m2; expected both of one sign"
        )
    h = np.asarray(q.value / difference)
    return combined(h, [(1.0 / difference, q), (h / difference, T_w), (h / difference, T_m)])


def nusselt(
    heat_transfer_coefficient: ArrayLike | Measured,
    tube_diameter: ArrayLike,
    bulk_conductivity: ArrayLike | Measured,
) -> Measured:
    """Nusselt number with its error (Watkins 2018, eq. 5, 57).

    The first term of eq. 57 is `(sigma_h/h)^2`; the printed `(sigma_h/h^2)^2` is not a pure number.

    Parameters
    ----------
    heat_transfer_coefficient : float, array or Measured
        h. [W/(m2 K)]
    tube_diameter : float or array
        Inner diameter, exact. [m]
    bulk_conductivity : float, array or Measured
        k_b. [W/(m K)]

    Returns
    -------
    Measured
        `Nu = h D/k_b`.

    Raises
    ------
    ValueError
        If an input is not positive.
    """
    h = as_measured("heat_transfer_coefficient", heat_transfer_coefficient, "W/(m2 K)")
    k_b = as_measured("bulk_conductivity", bulk_conductivity, "W/(m K)")
    D = positive("tube_diameter", tube_diameter, "m")
    number = np.asarray(h.value * D / k_b.value)
    return combined(number, [(D / k_b.value, h), (number / k_b.value, k_b)])


def inverse_graetz(
    position: ArrayLike,
    tube_diameter: ArrayLike,
    mass_flow: ArrayLike,
    bulk_conductivity: ArrayLike,
    specific_heat: ArrayLike,
) -> FloatArray:
    """Inverse Graetz number of a position along the tube (Watkins 2018, eq. 7).

    Parameters
    ----------
    position : float or array
        Distance z from the start of heating. [m]
    tube_diameter : float or array
        Inner diameter D. [m]
    mass_flow : float or array
        Mass flow m; the mass flux is m over the cross-section of the tube. [kg/s]
    bulk_conductivity : float or array
        k_b. [W/(m K)]
    specific_heat : float or array
        c_p. [J/(kg K)]

    Returns
    -------
    float or array
        `z* = (z/D)/Pe = z k_b/(m'' D^2 c_p)`, which for a tube is `pi z k_b/(4 m c_p)`: D cancels.

    Raises
    ------
    ValueError
        If the position is negative or another input not positive.
    """
    z, D = non_negative("position", position, "m"), positive("tube_diameter", tube_diameter, "m")
    mass_flux = positive("mass_flow", mass_flow, "kg/s") / (0.25 * np.pi * D**2)
    k_b = positive("bulk_conductivity", bulk_conductivity, "W/(m K)")
    return plain(z * k_b / (mass_flux * D**2 * positive("specific_heat", specific_heat, "J/(kg K)")))


@dataclass(frozen=True, eq=False)
class FirstLaw:
    """Measured mean temperatures beside those of the energy balance.

    Parameters
    ----------
    measured, balance : Measured
        Mean temperatures. [K]
    heat : Measured
        Heat given to the flow since the inlet. [W]
    taken_up : float or array
        Heat that the flow has taken up by its measured temperatures. [W]
    """

    measured: Measured
    balance: Measured
    heat: Measured
    taken_up: FloatArray

    @property
    def difference(self) -> Measured:
        """Measured less balance. [K]"""
        return combined(self.measured.value - self.balance.value, [(1.0, self.measured), (-1.0, self.balance)])

    @property
    def deviation(self) -> FloatArray:
        """The difference in standard errors; infinite where temperatures differ that count as exact."""
        gap = self.difference
        value, error = np.broadcast_arrays(gap.value, gap.error)
        exact = np.where(value == 0.0, 0.0, np.copysign(np.inf, value))
        return plain(np.divide(value, error, out=exact, where=error > 0.0))

    @property
    def closure(self) -> FloatArray:
        """Heat taken up over heat given, 1 where the balance closes; NaN where none is given."""
        taken, given = np.broadcast_arrays(self.taken_up, self.heat.value)
        return plain(np.divide(taken, given, out=np.full(given.shape, np.nan), where=given != 0.0))

    def __str__(self) -> str:
        rows = [np.ravel(x) for x in (self.measured.value, self.balance.value, self.deviation, self.closure)]
        return "\n".join(
            f"T_m {m:.2f} K, by the balance {b:.2f} K: {d:+.1f} standard errors, {100 * c:.1f} % of the heat found"
            for m, b, d, c in zip(*np.broadcast_arrays(*rows), strict=True)
        )


def first_law_check(
    inlet_temperature: ArrayLike | Measured,
    heat: ArrayLike | Measured,
    mass_flow: ArrayLike | Measured,
    specific_heat: SpecificHeat,
    measured_temperature: ArrayLike | Measured,
) -> FirstLaw:
    """Compare measured mean temperatures with the energy balance (Watkins 2018, eq. 12-14, Figure 2.15).

    Parameters
    ----------
    inlet_temperature : float, array or Measured
        T_in. [K]
    heat : float, array or Measured
        Heat given to the flow between the inlet and each position; see `bedrad.heat.energy_balance`. [W]
    mass_flow : float, array or Measured
        Mass flow. [kg/s]
    specific_heat : float, Material or callable
        c_p as for `energy_balance.mean_temperature`. [J/(kg K)]
    measured_temperature : float, array or Measured
        Mean temperatures from the profiles. [K]

    Returns
    -------
    FirstLaw
        Both temperatures with their errors. That of the balance comes from inlet, heat and mass flow.

    Raises
    ------
    ValueError
        If an input has no meaning.

    Warns
    -----
    RangeWarning
        If a temperature lies outside the measured range of a material.
    """
    T_in = as_measured("inlet_temperature", inlet_temperature, "K")
    Q = as_measured("heat", heat, "W", sign=True)
    flow = as_measured("mass_flow", mass_flow, "kg/s")
    T_m = as_measured("measured_temperature", measured_temperature, "K")
    T = np.asarray(mean_temperature(T_in.value, Q.value, flow.value, specific_heat))
    if isinstance(specific_heat, Material):
        c_in, c_out = specific_heat.specific_heat(T_in.value), specific_heat.specific_heat(T)
    elif callable(specific_heat):
        c_in, c_out = np.asarray(specific_heat(np.asarray(T_in.value))), np.asarray(specific_heat(T))
    else:
        c_in = c_out = np.asarray(specific_heat, dtype=np.float64)
    slope = 1.0 / (flow.value * c_out)
    balance = combined(T, [(c_in / c_out, T_in), (slope, Q), (-Q.value * slope / flow.value, flow)])
    return FirstLaw(T_m, balance, Q, heat_rate(T_in.value, T_m.value, flow.value, specific_heat))
