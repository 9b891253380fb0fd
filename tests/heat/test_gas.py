import mpmath
import numpy as np
import pytest

from bedrad.heat import RangeWarning, gas

# dry air at 101325 Pa by Lemmon and Jacobsen (2004), from CoolProp 8.0.0 [K, W/(m K)]
LEMMON_JACOBSEN = np.array(
    [
        (200, 0.018503),
        (300, 0.026384),
        (400, 0.033453),
        (600, 0.046011),
        (800, 0.057249),
        (1000, 0.067677),
        (1200, 0.077576),
        (1373.15, 0.085849),
        (1500, 0.091782),
    ]
)


def stephan_laesecke(T):
    """Dilute air, 70 to 1000 K (Stephan and Laesecke 1985, J. Phys. Chem. Ref. Data 14, 227)."""
    coefficients = (
        33.9729025,
        -164.702679,
        262.108546,
        -21.5346955,
        -443.455815,
        607.339582,
        -368.790121,
        111.296674,
        -13.4122465,
    )
    reduced = T / 132.52
    return 4.358e-3 * sum(c * reduced ** ((i - 3) / 3) for i, c in enumerate(coefficients))


def test_second_correlation_of_the_same_year():
    T = np.linspace(200.0, 1000.0, 9)
    assert gas.air_conductivity(T) == pytest.approx(stephan_laesecke(T), rel=0.01)


def test_modern_equation_within_the_stated_error():
    T, expected = LEMMON_JACOBSEN.T
    difference = gas.air_conductivity(T) / expected - 1
    assert np.all(np.abs(difference) < 0.013)
    # the docstring's figures
    assert difference[0] == pytest.approx(-0.008, abs=5e-4)
    assert difference[1] == pytest.approx(-0.006, abs=5e-4)
    assert difference[5] == pytest.approx(0.0, abs=1e-3)
    assert difference[-1] == pytest.approx(0.013, abs=5e-4)


def test_textbook_values():
    assert gas.air_conductivity([300.0, 1000.0]) == pytest.approx([0.0263, 0.0667], rel=0.015)


def test_rises_smoothly():
    values = gas.air_conductivity(np.linspace(85.0, 2000.0, 500))
    assert np.all(np.diff(values) > 0)
    assert np.ndim(gas.air_conductivity(300.0)) == 0


# dry air at 101325 Pa: temperature, viscosity [Pa s], specific heat [J/(kg K)], density [kg/m3], Pr; by Lemmon et al.
# (2000) and Lemmon and Jacobsen (2004), from CoolProp 8.0.0
MODERN_AIR = np.array(
    [
        (200, 1.33335e-05, 1006.80, 1.76917, 0.725528),
        (300, 1.85373e-05, 1006.37, 1.17700, 0.707064),
        (400, 2.30554e-05, 1014.14, 0.882307, 0.698932),
        (600, 3.07687e-05, 1051.20, 0.588097, 0.702962),
        (800, 3.73700e-05, 1098.69, 0.441079, 0.717185),
        (1000, 4.32798e-05, 1141.00, 0.352877, 0.729675),
        (1200, 4.87282e-05, 1174.49, 0.294076, 0.737740),
        (1373.15, 5.31810e-05, 1197.23, 0.257001, 0.741650),
        (1500, 5.63255e-05, 1211.02, 0.235271, 0.743192),
    ]
)


def test_viscosity_specific_heat_density_and_prandtl_number_of_air():
    T, viscosity, specific_heat, density, prandtl = MODERN_AIR.T
    found = gas.air_properties(T)
    assert np.max(np.abs(found.viscosity / viscosity - 1)) < 4e-3
    assert np.max(np.abs(found.specific_heat / specific_heat - 1)) < 4.4e-3
    assert np.max(np.abs(found.specific_heat / specific_heat - 1)[T >= 600]) < 4e-4
    assert np.max(np.abs(found.density / density - 1)) < 2.5e-3
    assert np.max(np.abs(found.prandtl_number / prandtl - 1)) < 1.0e-2


def test_textbook_values_of_all_properties():
    # common tables of air at atmospheric pressure, 300 and 1000 K
    T = [300.0, 1000.0]
    assert gas.air_viscosity(T) == pytest.approx([184.6e-7, 424.4e-7], rel=0.025)
    assert gas.air_specific_heat(T) == pytest.approx([1007.0, 1141.0], rel=3e-3)
    assert gas.air_density(T) == pytest.approx([1.1614, 0.3482], rel=0.014)
    assert gas.air_prandtl_number(T) == pytest.approx([0.707, 0.726], rel=0.01)


def test_specific_heat_against_the_printed_equation():
    # Lemmon et al. 2000, the exponentials as printed
    def printed(T):
        T = mpmath.mpf(T)
        powers = ("3.490888032", 0), ("2.395525583e-6", 1), ("7.172111248e-9", 2), ("-3.115413101e-13", 3)
        total = sum(mpmath.mpf(c) * T**n for c, n in powers) + mpmath.mpf("0.223806688") * T ** mpmath.mpf(-1.5)
        for weight, scale in (("0.791309509", "3364.011"), ("0.212236768", "2242.45")):
            u = mpmath.mpf(scale) / T
            total += mpmath.mpf(weight) * u**2 * mpmath.exp(u) / (mpmath.exp(u) - 1) ** 2
        w, two_thirds = mpmath.mpf("11580.4") / T, mpmath.mpf(2) / 3
        total += mpmath.mpf("0.197938904") * w**2 * two_thirds * mpmath.exp(-w) / (1 + two_thirds * mpmath.exp(-w)) ** 2
        return float(mpmath.mpf(gas.AIR_GAS_CONSTANT) * total)

    with mpmath.workdps(30):
        for T in (200.0, 300.0, 1000.0, 2000.0):
            assert gas.air_specific_heat(T) == pytest.approx(printed(T), rel=1e-14)
        # far out of the range nothing overflows; 0.223806688/T^1.5 is there all that is left besides the constant
        with pytest.warns(RangeWarning):
            assert gas.air_specific_heat(1.0) == pytest.approx(printed(1.0), rel=1e-14)


def test_diatomic_gas_at_room_temperature():
    # 7/2 R, the vibrations being frozen, to half a per cent
    assert gas.air_specific_heat(273.15) == pytest.approx(3.5 * gas.AIR_GAS_CONSTANT, rel=5e-3)


def test_density_follows_the_ideal_gas_law():
    assert gas.air_density(300.0, 2e5) / gas.air_density(600.0, 1e5) == pytest.approx(4.0, rel=1e-14)
    assert gas.air_density([300.0, 400.0], [[1e5], [2e5]]).shape == (2, 2)


def test_properties_read_well_and_do_not_change():
    found = gas.air_properties(300.0)
    assert np.ndim(found.conductivity) == 0
    assert str(found).splitlines() == [
        "air (Kadoya et al. 1985, Lemmon et al. 2000)",
        "  300.00 K     101325 Pa  k 0.02623 W/(m K)  viscosity 1.8569e-05 Pa s  c_p 1004.8 J/(kg K)  "
        "density 1.1766 kg/m3  Pr 0.7112",
    ]
    assert len(str(gas.air_properties([300.0, 400.0])).splitlines()) == 3
    assert found.diffusivity == pytest.approx(0.02623 / (1.1766 * 1004.8), rel=1e-3)
    with pytest.raises(AttributeError):
        found.density = 1.0


def test_range_and_refusals():
    with pytest.warns(RangeWarning, match="temperature is 2100 K, outside the fitted range 85 to 2000 K") as record:
        gas.air_conductivity([300.0, 2100.0])
    assert record[0].filename == __file__
    with pytest.raises(ValueError, match="temperature is -10 K"):
        gas.air_conductivity([300.0, -10.0])
    for function in (gas.air_specific_heat, gas.air_density):
        with pytest.warns(RangeWarning, match="temperature is 150 K, outside the fitted range 200 to 2000 K") as record:
            function(150.0)
        assert record[0].filename == __file__
    with pytest.warns(RangeWarning, match="air_viscosity .*temperature is 80 K, outside the fitted range 85 to 2000 K"):
        gas.air_viscosity(80.0)
    with pytest.raises(ValueError, match="pressure is 0 Pa"):
        gas.air_density(300.0, 0.0)
    with pytest.raises(ValueError, match="temperature is nan K"):
        gas.air_properties(np.nan)


def test_specific_heat_is_refused_where_its_series_leads_astray():
    T = np.linspace(2000.0, 1e4, 50)
    with pytest.warns(RangeWarning, match="air_specific_heat"):
        c_p = gas.air_specific_heat(T)
    # a gas of two atoms has no more than 9/2 R, and the electronic part
    assert (np.diff(c_p) > 0.0).all()
    assert c_p[-1] < 5.0 * gas.AIR_GAS_CONSTANT


@pytest.mark.filterwarnings("ignore::bedrad.heat.RangeWarning")
@pytest.mark.parametrize("function", [gas.air_specific_heat, gas.air_prandtl_number, gas.air_properties])
def test_no_specific_heat_of_what_is_no_gas_of_molecules_any_more(function):
    with pytest.raises(ValueError, match=r"temperature is 1e\+12 K; expected .* at most 10000$"):
        function([300.0, 1e12])
