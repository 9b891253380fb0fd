import math

import numpy as np
import pytest
from scipy.integrate import quad

from bedrad.heat import RangeWarning, materials, two_layer
from bedrad.heat.tube_temperatures import tube_temperatures
from oracles.finite_volume_tube import variable_properties

Z = np.linspace(0.0, 1.26, 22)
TUBE = {"tube_diameter": 8.5e-3, "particle_diameter": 3e-4, "mass_flow": 2.5e-3, "inlet_temperature": 300.0}


def k_b(T):
    return 0.25 + 3e-4 * (T - 300)


def k_wa(T):
    return 0.10 + 1.5e-4 * (T - 300)


def c_p(T):
    return 480.0 + 0.4 * T


CONSTANT = TUBE | {"specific_heat": 700.0, "bulk_conductivity": 0.3, "wall_layer_conductivity": 0.12}
VARIABLE = TUBE | {"specific_heat": c_p, "bulk_conductivity": k_b, "wall_layer_conductivity": k_wa}


@pytest.mark.parametrize("choice", ["mean", "film", "wall", "layers"])
def test_constant_properties_are_the_two_layer_model(choice):
    found = tube_temperatures(Z, 4e3, **CONSTANT, property_temperature=choice)
    D = TUBE["tube_diameter"]
    velocity = TUBE["mass_flow"] / (2300 * np.pi * D**2 / 4)
    flow = two_layer.flow_temperatures(
        D / 2, Z, heat_flux=4e3, tube_diameter=D, particle_diameter=3e-4, velocity=velocity, bulk_conductivity=0.3,
        wall_layer_conductivity=0.12, density=2300, specific_heat=700, inlet_temperature=300,
    )  # fmt: skip
    assert found.wall_temperature == pytest.approx(flow.wall_temperature, rel=1e-12)
    assert found.mean_temperature == pytest.approx(flow.mean_temperature, rel=1e-12)
    assert found.nusselt[0] == found.heat_transfer_coefficient[0] == np.inf
    assert found.wall_temperature[0] == 300.0


@pytest.mark.parametrize("choice", ["mean", "film", "wall", "layers"])
def test_both_equations_close(choice):
    """Enthalpy against heat by quadrature, and T_w = T_m + q/h at the properties' own temperatures."""
    flux = 4e3 * (1 + 0.1 * Z)
    found = tube_temperatures(Z, flux, **VARIABLE, property_temperature=choice)
    for i in (5, 21):
        enthalpy = TUBE["mass_flow"] * quad(c_p, 300.0, found.mean_temperature[i])[0]
        heat = np.pi * 8.5e-3 * quad(lambda z: 4e3 * (1 + 0.1 * z), 0, Z[i])[0]
        assert enthalpy == pytest.approx(heat, rel=1e-12)
        assert found.heat_rate[i] == pytest.approx(heat, rel=1e-12)
    T_m, T_w = found.mean_temperature[1:], found.wall_temperature[1:]
    film = (T_m + T_w) / 2
    bulk, layer = {"mean": (T_m, T_m), "film": (film, film), "wall": (T_w, T_w), "layers": (T_m, T_w)}[choice]
    z_star = two_layer.inverse_graetz(Z[1:], k_b(bulk), 2.5e-3 / (np.pi / 4 * 8.5e-3**2), c_p(T_m), 8.5e-3)
    Nu = two_layer.nusselt(8.5e-3 / 3e-4, k_b(bulk) / k_wa(layer), z_star)
    assert T_w - T_m == pytest.approx(flux[1:] * 8.5e-3 / (Nu * k_b(bulk)), rel=1e-9)
    assert found.heat_transfer_coefficient[1:] == pytest.approx(flux[1:] / (T_w - T_m), rel=1e-9)


@pytest.mark.parametrize(
    ("choice", "limits"),
    [("mean", (0.015, 0.045)), ("film", (-0.01, 0.01)), ("wall", (-0.045, -0.015)), ("layers", (0.002, 0.012))],
)
def test_local_properties_against_the_full_energy_equation(choice, limits):
    """Finite volumes with each cell's own properties, a strong flux (2e4 W/m2, wall 763 K, mean 696 K at the end).

    With conductivities that rise with temperature the mean temperature overstates wall less mean, the wall temperature
    understates it, the bulk at the mean and the wall layer at the wall come closest.
    """
    wall, mean = variable_properties(Z[1:], lambda z: 2e4 + 0 * z, TUBE | {
        "bulk_conductivity": k_b, "wall_layer_conductivity": k_wa, "specific_heat_line": (480.0, 0.4)
    })  # fmt: skip
    found = tube_temperatures(Z, 2e4, **VARIABLE, property_temperature=choice)
    assert found.mean_temperature[1:] == pytest.approx(mean, rel=1e-7)
    excess = (found.wall_temperature - found.mean_temperature)[1:] / (wall - mean) - 1
    assert limits[0] < excess[1:].min()
    assert excess.max() < limits[1]


def test_cooling_mirrors_heating():
    warm = tube_temperatures(Z, 1e3, **CONSTANT)
    cold = tube_temperatures(Z, -1e3, **CONSTANT)
    assert cold.wall_temperature - 300 == pytest.approx(300 - warm.wall_temperature, rel=1e-12)
    root = tube_temperatures(Z, -1e3, **(VARIABLE | {"inlet_temperature": 600.0}), property_temperature="wall")
    assert np.all(root.wall_temperature[1:] < root.mean_temperature[1:])


def test_table_of_fluxes_and_an_unheated_stretch():
    flux = np.where(Z < 0.5, 4e3, 0.0)
    found = tube_temperatures(Z, flux, **VARIABLE, property_temperature="film")
    unheated = flux == 0.0
    assert np.array_equal(found.wall_temperature[unheated], found.mean_temperature[unheated])
    assert np.ptp(found.mean_temperature[unheated]) == 0.0
    assert np.all(np.diff(found.mean_temperature)[:8] > 0)


def test_conductivity_that_falls_with_temperature():
    """q/h grows with the wall temperature here; the search goes beyond the first guess and still closes."""
    falling = CONSTANT | {"wall_layer_conductivity": lambda T: 0.12 * (300 / T) ** 0.7}
    found = tube_temperatures(Z, 8e3, **falling, property_temperature="wall")
    Nu = two_layer.nusselt(8.5e-3 / 3e-4, 0.3 / (0.12 * (300 / found.wall_temperature[1:]) ** 0.7), found.z_star[1:])
    difference = (found.wall_temperature - found.mean_temperature)[1:]
    assert difference == pytest.approx(8e3 * 8.5e-3 / (0.3 * Nu), rel=1e-9)


def test_materials_power_law_and_its_warning():
    material = materials.ZIRCONIA_SILICA
    case = CONSTANT | {"specific_heat": material, "inlet_temperature": 350.0}
    found = tube_temperatures(Z, 4e3, **case, property_temperature="wall")
    rise = material.specific_heat_coefficient / (material.specific_heat_exponent + 1)
    C = found.mean_temperature - 273.15
    enthalpy = rise * (C ** (material.specific_heat_exponent + 1))
    assert 2.5e-3 * (enthalpy[-1] - enthalpy[0]) == pytest.approx(found.heat_rate[-1], rel=1e-12)
    with pytest.warns(RangeWarning, match="specific heat of zirconia-silica"):
        tube_temperatures(Z, 4e4, **case)


def test_result_says_what_was_neglected():
    found = tube_temperatures(Z, 4e3, **CONSTANT, tolerance=1e-6)
    assert np.all(found.error_bound <= 1e-6)
    assert found.terms[1] > found.terms[-1] >= 1
    assert str(found) == (
        "flow from 300.00 to 376.91 K over 1.26 m, 134.6 W; at the outlet wall 393.92 K, Nu 6.662, h 235.1 W/(m2 K), "
        "z* 0.17 (conductivities at: mean)"
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"heat_flux": np.ones(3)},
            r"heat_flux has the shape \(3,\); expected a number, or one for each of 22 positions",
        ),
        ({"heat_flux": np.nan}, "heat_flux is nan W/m2"),
        ({"heat_flux": -5e4}, "above absolute zero"),
        ({"property_temperature": "bulk"}, "property_temperature is 'bulk'; expected one of mean, film, wall, layers"),
        ({"bulk_conductivity": lambda T: 0.3 - T}, "bulk_conductivity is -"),
        ({"wall_layer_conductivity": 0.0}, "wall_layer_conductivity is 0"),
        ({"specific_heat": lambda T: -T}, "specific_heat is -"),
        ({"particle_diameter": 1e-2}, "diameter_ratio is 0.85; expected more than 1"),
        ({"mass_flow": 0.0}, "mass_flow is 0 kg/s"),
        ({"mass_flow": [1e-3, 2e-3]}, r"mass_flow has the shape \(2,\); expected one number"),
        ({"bulk_conductivity": lambda T: np.ones(3)}, r"bulk_conductivity gives the shape \(3,\) for 21 temperatures"),
        ({"position": [0.0, 0.0, 1.0]}, "position"),
        ({"tolerance": 0.0}, "tolerance is 0"),
    ],
)
def test_refusals(change, message):
    given = {"position": Z, "heat_flux": 4e3} | CONSTANT | change
    with pytest.raises(ValueError, match=message):
        tube_temperatures(given.pop("position"), given.pop("heat_flux"), **given)


def test_refuses_a_flux_that_no_wall_can_carry():
    """A wall layer that conducts as 1/T^2: beyond some flux the wall runs away."""
    runaway = CONSTANT | {"wall_layer_conductivity": lambda T: 0.12 * (300 / T) ** 2}
    with pytest.raises(ValueError, match=r"heat_flux is 40000 W/m2 at [0-9.]+ m from the inlet.*below 10000 K"):
        tube_temperatures(Z, 4e4, **runaway, property_temperature="wall")
    with pytest.raises(ValueError, match=r"expected (a wall above 0 K|one that a wall above 0 K can carry)"):
        tube_temperatures([0.0, 1e-3, 1e-2], -4e5, **CONSTANT)
    assert math.isfinite(tube_temperatures(Z, 1e3, **runaway, property_temperature="wall").wall_temperature[-1])
