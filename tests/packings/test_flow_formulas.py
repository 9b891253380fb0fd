"""Beverloo's discharge and Janssen's pressure; the duration of a Hertz contact."""

from __future__ import annotations

import math

import pytest
from scipy.integrate import solve_ivp

from bedrad.packings.contact import hertz_duration, sphere_mass
from bedrad.packings.flow_formulas import beverloo_discharge, janssen_pressure


def test_janssen_pressure_is_where_the_balance_of_a_slice_ends() -> None:
    # dp_z/dz = rho g - (4/D) mu K p_z, with p_wall = K p_z, from a free surface down twenty tube diameters
    rho, g, diameter, mu, ratio = 2100.0, 9.81, 7.75e-3, 0.4, 0.6
    deep = solve_ivp(
        lambda _, p: [rho * g - 4.0 / diameter * mu * ratio * p[0]],
        (0.0, 20.0 * diameter),
        [0.0],
        rtol=1e-10,
        atol=1e-9,
    )
    assert ratio * deep.y[0, -1] == pytest.approx(janssen_pressure(rho, g, diameter, mu), rel=1e-7)


def test_a_wall_without_friction_carries_nothing() -> None:
    assert janssen_pressure(2000.0, 9.81, 0.01, 0.0) == math.inf


def test_beverloo_discharge_has_the_power_and_the_empty_annulus() -> None:
    # the 2/5th power of the discharge is linear in the orifice and vanishes at k d
    wide, wider = (beverloo_discharge(opening, 1e-3, 1500.0) ** 0.4 for opening in (0.01, 0.02))
    slope = (wider - wide) / 0.01
    assert wide - slope * (0.01 - 1.4e-3) == pytest.approx(0.0, abs=1e-12)
    assert slope == pytest.approx((0.58 * 1500.0 * math.sqrt(9.81)) ** 0.4, rel=1e-12)
    assert beverloo_discharge(1.3e-3, 1e-3, 1500.0) == 0.0


@pytest.mark.parametrize("speed", [0.01, 0.5])
def test_hertz_contact_lasts_as_long_as_the_equation_of_motion_says(speed: float) -> None:
    modulus, ratio, diameter, density = 5e7, 0.3, 6e-4, 3800.0
    mass, radius = sphere_mass(diameter, density) / 2.0, diameter / 4.0
    stiffness = 4.0 / 3.0 * modulus / (2.0 * (1.0 - ratio**2)) * math.sqrt(radius)

    def apart(_: float, state: list[float]) -> float:
        return state[0]

    apart.terminal, apart.direction = True, -1.0  # type: ignore[attr-defined]
    stated = hertz_duration(modulus, ratio, diameter, density, speed)
    found = solve_ivp(
        lambda _, s: [s[1], -stiffness / mass * max(s[0], 0.0) ** 1.5],
        (0.0, 3.0 * stated), [0.0, speed], events=apart, rtol=1e-9, atol=1e-14, max_step=stated / 50.0,
    )  # fmt: skip
    # Johnson prints the coefficient as 2.87; it is 2.868
    assert found.t_events[0][-1] == pytest.approx(stated, rel=1e-3)
