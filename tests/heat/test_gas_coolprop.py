import builtins
import importlib.util

import numpy as np
import pytest

from bedrad.heat import RangeWarning, gas

needs_coolprop = pytest.mark.skipif(
    importlib.util.find_spec("CoolProp") is None, reason="CoolProp (extra gas) is not installed"
)


@needs_coolprop
def test_fits_for_air_agree_with_coolprop():
    T = np.linspace(200.0, 1500.0, 131)
    fit, reference = gas.air_properties(T), gas.properties("air", T)
    # largest deviations below and above, and where; the table of docs/heat_bulk.md
    for name, low, high in (
        ("conductivity", (-0.00788, 200.0), (0.01280, 1500.0)),
        ("viscosity", (-0.00024, 200.0), (0.00366, 1190.0)),
        ("specific_heat", (-0.00437, 200.0), (-0.00002, 1500.0)),
        ("density", (-0.00239, 200.0), (0.00037, 650.0)),
        ("prandtl_number", (-0.00991, 1500.0), (0.00768, 650.0)),
    ):
        difference = getattr(fit, name) / getattr(reference, name) - 1
        assert (difference.min(), T[difference.argmin()]) == pytest.approx(low, abs=2e-5, rel=0.02)
        assert (difference.max(), T[difference.argmax()]) == pytest.approx(high, abs=2e-5, rel=0.02)
    assert reference.source.startswith("CoolProp ")
    assert reference.gas == "Air"


@needs_coolprop
@pytest.mark.parametrize(
    ("name", "k", "viscosity", "specific_heat", "molar_mass"),
    [
        # common tables, 300 K and 1 atm
        ("N2", 0.0259, 17.8e-6, 1041.0, 28.0134e-3),
        ("He", 0.1560, 19.9e-6, 5193.0, 4.0026e-3),
        ("Ar", 0.0177, 22.7e-6, 521.0, 39.948e-3),
        ("CO2", 0.0166, 14.9e-6, 851.0, 44.0095e-3),
    ],
)
def test_other_gases(name, k, viscosity, specific_heat, molar_mass):
    found = gas.properties(name, 300.0)
    assert found.conductivity == pytest.approx(k, rel=0.012)
    assert found.viscosity == pytest.approx(viscosity, rel=0.012)
    assert found.specific_heat == pytest.approx(specific_heat, rel=3e-3)
    assert found.density == pytest.approx(gas.ATMOSPHERE * molar_mass / (8.314462618 * 300.0), rel=6e-3)


@needs_coolprop
def test_noble_gases_follow_kinetic_theory():
    # monatomic: c_p = 5/2 R, and Pr = 2/3 to a per cent
    T = np.array([300.0, 600.0, 1200.0])
    for name, molar_mass in (("He", 4.0026e-3), ("Ar", 39.948e-3)):
        found = gas.properties(name, T)
        assert found.specific_heat == pytest.approx(2.5 * 8.314462618 / molar_mass, rel=3e-3)
        assert found.prandtl_number == pytest.approx(2 / 3, rel=0.01)


@needs_coolprop
def test_shapes_and_spelling():
    found = gas.properties("n2", [[300.0], [400.0]], [1e5, 1e6, 2e6])
    assert found.density.shape == found.temperature.shape == found.pressure.shape == (2, 3)
    one = gas.properties("Nitrogen", 400.0, 2e6)
    assert np.ndim(one.density) == 0
    assert found.density[1, 2] == one.density
    assert found.conductivity[1, 2] == one.conductivity
    assert gas.properties("helium", 300.0).conductivity == gas.properties("HE", 300.0).conductivity


@needs_coolprop
@pytest.mark.parametrize("name", ["xyz", "", "N2&O2", "REFPROP::N2", "INCOMP::T66", "N2[0.5]&O2[0.5]", None, 3])
def test_gases_that_are_none(name):
    with pytest.raises(ValueError, match=r"^gas is .*; expected a pure fluid that CoolProp knows, such as 'N2'"):
        gas.properties(name, 300.0)


@needs_coolprop
def test_states_that_are_not_gases():
    with pytest.raises(ValueError, match="Water at 300 K and 101325 Pa is not a gas"):
        gas.properties("water", 300.0)
    with pytest.raises(ValueError, match=r"^CoolProp has no properties of Air at 80 K and 101325 Pa: [^\n]*$"):
        gas.properties("air", [300.0, 80.0])
    with pytest.raises(ValueError, match="temperature is -3 K"):
        gas.properties("air", -3.0)
    with pytest.raises(ValueError, match="pressure is 0 Pa"):
        gas.properties("air", 300.0, 0.0)
    with pytest.warns(RangeWarning, match=r"Air \(CoolProp\): temperature is 2200 K, outside .* 2000 K") as record:
        gas.properties("air", 2200.0)
    assert record[0].filename == __file__


@needs_coolprop
@pytest.mark.parametrize("name", ["air", "N2", "He", "Ar", "CO2"])
def test_nothing_is_said_of_what_is_no_gas_of_molecules_any_more(name):
    with pytest.raises(ValueError, match=r"temperature is 1e\+12 K; expected .* at most 10000$"):
        gas.properties(name, [300.0, 1e12])
    with pytest.warns(RangeWarning, match="temperature is 10000 K, outside the fitted range"):
        hottest = gas.properties(name, 1e4)
    for value in (hottest.conductivity, hottest.viscosity, hottest.specific_heat, hottest.density):
        assert 0.0 < value < np.inf


def test_without_coolprop_the_message_names_the_command(monkeypatch):
    real = builtins.__import__

    def without(name, *arguments, **options):
        if name.split(".")[0] == "CoolProp":
            raise ImportError(name)
        return real(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=r'CoolProp is not installed; install it with: pip install "bedrad\[gas\]"'):
        gas.properties("N2", 300.0)
    # and air needs nothing
    assert gas.air_properties(300.0).conductivity > 0
