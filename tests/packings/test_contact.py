"""The damped spring against the integrated equation of motion, and the softening rule against its own claims."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bedrad.packings.contact import (
    contact_duration,
    damping_rate,
    damping_ratio,
    effective_mass,
    softened_stiffness,
    softening_rule,
    sphere_mass,
)


@pytest.mark.parametrize("restitution", [0.05, 0.3, 0.85, 0.99])
def test_integrating_the_collision_gives_restitution_and_duration(restitution: float) -> None:
    stiffness, mass = 100.0, 2.1e-7
    rate = damping_rate(stiffness, mass, restitution)
    time = contact_duration(stiffness, mass, restitution)

    def apart(_: float, y: np.ndarray) -> float:
        return float(y[0])

    apart.terminal, apart.direction = True, -1  # type: ignore[attr-defined]
    # unit speed, time in contact durations
    ran = solve_ivp(
        lambda _, y: [y[1] * time, -(stiffness / mass * y[0] + rate * y[1]) * time],
        (0.0, 2.0),
        [0.0, 1.0],
        events=apart,
        rtol=1e-11,
        atol=1e-15,
        method="DOP853",
    )
    assert ran.t_events[0][-1] == pytest.approx(1.0, rel=1e-8)
    assert -ran.y_events[0][-1][1] == pytest.approx(restitution, rel=1e-7)


def test_the_reference_contact_of_two_and_of_sphere_and_wall() -> None:
    # 0.6 mm, 3800 kg/m3, 100 N/m, restitution 0.85: rates of a published-style LAMMPS input, 2229 and 1576 1/s
    mass = sphere_mass(6e-4, 3800.0)
    assert mass == pytest.approx(3800 * math.pi / 6 * 2.16e-10, rel=1e-15)
    assert damping_rate(100.0, effective_mass(mass, mass), 0.85) == pytest.approx(2229.0, abs=0.5)
    assert damping_rate(100.0, effective_mass(mass), 0.85) == pytest.approx(1576.0, abs=0.5)


def test_limits_of_the_damping() -> None:
    assert damping_ratio(1.0) == 0.0
    assert damping_ratio(1e-300) < 1.0
    assert effective_mass(2.0, 1e300) == pytest.approx(effective_mass(2.0))


def test_softening_reference_and_scaling() -> None:
    reference = softened_stiffness(6e-4, 3800.0, 9.81, 7.75e-3, 0.018)
    assert reference == pytest.approx(100.0, rel=1e-15)
    # the force on a contact goes with density gravity D d^2; the overlap in diameters must not change
    for d, rho, g, tube in ((2e-3, 3800.0, 9.81, 25.8e-3), (3e-4, 2500.0, 1.6, 7.75e-3)):
        stiffness = softened_stiffness(d, rho, g, tube, 0.0)
        overlap = rho * g * tube * d**2 / (stiffness * d)
        assert overlap == pytest.approx(3800 * 9.81 * 7.75e-3 * 6e-4 / 100, rel=1e-12)


def test_a_long_fall_is_met_by_a_stiffer_contact() -> None:
    d, rho, g, tube = 6e-4, 3800.0, 9.81, 7.75e-3
    stiffness = softened_stiffness(d, rho, g, tube, 1.0)
    # energy balance of two spheres that meet at the speed of the fall, without damping
    mass = effective_mass(sphere_mass(d, rho), sphere_mass(d, rho))
    assert math.sqrt(2 * g * 1.0 * mass / stiffness) == pytest.approx(0.1 * d, rel=1e-12)
    # the two rules meet at a fall of 11.0 tube diameters, whatever the spheres
    for size, density in ((6e-4, 3800.0), (3e-3, 1000.0)):
        low = softened_stiffness(size, density, g, tube, 10.9 * tube)
        high = softened_stiffness(size, density, g, tube, 11.1 * tube)
        assert low == softened_stiffness(size, density, g, tube, 0.0) < high


def test_the_words_hold_the_numbers() -> None:
    assert all(text in softening_rule() for text in ("100 N/m", "3800 kg/m3", "9.81 m/s2", "0.0006 m", "0.00775 m"))
