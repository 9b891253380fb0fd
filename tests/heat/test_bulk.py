import mpmath
import numpy as np
import pytest

from bedrad.heat import RangeWarning, bulk
from bedrad.heat.gas import air_conductivity

SIGMA = 5.670374419e-8


def atlas(k_g, k_s, eps, d, T, e, phi, path):
    """VDI Heat Atlas D6.3 as printed, in 60 digits."""
    with mpmath.workdps(60):
        k_g, k_s, eps, d, T, e, phi, path = map(mpmath.mpf, (k_g, k_s, eps, d, T, e, phi, path))
        K, B = k_s / k_g, mpmath.mpf(5) / 4 * ((1 - eps) / eps) ** (mpmath.mpf(10) / 9)
        R = 4 * mpmath.mpf(SIGMA) * T**3 * d / ((2 / e - 1) * k_g)
        G = 1 / (1 + path / d)
        N = (1 + (R - B * G) / K) / G - B * (1 / G - 1) * (1 + R / K)
        core = B * (K + R - 1) / (N**2 * G * K) * mpmath.log((K + R) / (B * (G + (1 - G) * (K + R))))
        core += (B + 1) / (2 * B) * (R / G - B * (1 + (1 - G) / G * R)) - (B - 1) / (N * G)
        root = mpmath.sqrt(1 - eps)
        return k_g * ((1 - root) * eps * (1 / (eps - 1 + 1 / G) + R) + root * (phi * K + (1 - phi) * 2 / N * core))


@pytest.mark.parametrize(
    ("T", "contact", "expected"),
    [(300.0, 0.0, 0.412723197), (1000.0, 0.0077, 0.463474886), (1273.15, 0.0, 0.498165303)],
)
def test_reference_values(T, contact, expected):
    value = bulk.zehner_bauer_schluender(0.07, 2.1, 0.4, 0.3e-3, T, 0.8, contact)
    assert value == pytest.approx(expected, rel=3e-9)


@pytest.mark.parametrize(
    ("K", "porosity", "expected"),
    [(70, 0.4, 7.94911793), (70, 0.37, 8.78928086), (10, 0.4, 3.64272606), (1000, 0.4, 15.4674694)],
)
def test_conduction_only(K, porosity, expected):
    value = bulk.zehner_bauer_schluender(1.0, K, porosity, 1e-3, 300.0, radiation=False)
    assert value == pytest.approx(expected, rel=3e-9)


def test_reference_value_with_the_smoluchowski_effect():
    # 3 mm spheres in air at 1 atm, accommodation 1; without the effect the value would be 0.23278276
    path = bulk.modified_free_path(300.0, 0.03)
    value = bulk.zehner_bauer_schluender(0.03, 1.5, 0.4, 3e-3, 300.0, 0.8, 0.0077, path)
    assert value == pytest.approx(0.23246215, rel=1e-7)


@pytest.mark.parametrize("path", [0.0, 1e-6])
def test_printed_equations_also_where_they_divide_by_nothing(path):
    rng = np.random.default_rng(3)
    cases = [
        (
            10 ** rng.uniform(-2, 0),
            10 ** rng.uniform(-2, 1.5),
            rng.uniform(0.2, 0.8),
            10 ** rng.uniform(-4, -2),
        )
        for _ in range(40)
    ]
    # no radiation, no free path: N vanishes at K = B
    B = 1.25 * (0.63 / 0.37) ** (10 / 9)
    cases += [(0.03, 0.03 * B * (1 + x), 0.37, 1e-4) for x in (1e-12, -1e-6, 1e-3, 0.2, -0.3)]
    for k_g, k_s, eps, d in cases:
        value = bulk.zehner_bauer_schluender(k_g, k_s, eps, d, 1000.0, 0.7, 0.01, path)
        assert value == pytest.approx(float(atlas(k_g, k_s, eps, d, 1000.0, 0.7, 0.01, path)), rel=1e-12)


def test_bed_of_gas_conducts_like_gas():
    eps = np.linspace(0.2, 0.9, 8)
    value = bulk.zehner_bauer_schluender(0.03, 0.03, eps, 1e-3, 300.0, radiation=False)
    assert value == pytest.approx(0.03, rel=1e-13)


def test_radiation_raises_it_and_fades_with_the_temperature():
    T = np.array([1.0, 300.0, 800.0, 1400.0])
    with_radiation = bulk.zehner_bauer_schluender(0.05, 2.1, 0.37, 1e-3, T)
    without = bulk.zehner_bauer_schluender(0.05, 2.1, 0.37, 1e-3, T, radiation=False)
    assert np.ptp(without) == 0.0
    assert np.all(np.diff(with_radiation - without) > 0)
    assert with_radiation[0] == pytest.approx(without[0], rel=1e-7)


def test_tables_as_printed():
    printed = {
        "2.4": [(140, 400, 0.000264, 0.252), (270, 400, 0.000248, 0.287), (320, 300, 0.000371, 0.281)],
        "5.2": [(270, 1000, 0.00031, 0.273), (320, 1000, 0.00033, 0.270)],
    }
    for table, rows in printed.items():
        for diameter, celsius, slope, intercept in rows:
            value = bulk.measured(celsius + 273.15, diameter * 1e-6, table=table)
            assert value == pytest.approx(slope * celsius + intercept, rel=1e-12)
    value = bulk.measured([373.15, 673.15], 340e-6, "alumina-silicate", "2.4")
    assert value == pytest.approx([0.2865, 0.414], rel=1e-12)


def test_model_lies_3_to_13_percent_below_the_fits():
    # the model with the room-temperature conductivity of the solid and the static packing fraction
    T = np.linspace(313.15, 1273.15, 20)
    for fit in bulk.TABLE_5_2:
        model = bulk.zehner_bauer_schluender(air_conductivity(T), 2.1, 0.37, fit.particle_diameter, T)
        ratio = model / fit.conductivity(T)
        assert np.all((ratio > 0.87) & (ratio < 0.97))


def test_range_and_refusals():
    with pytest.warns(RangeWarning, match=r"1373\.15 K, outside the fitted range 313.15 to 1273.15 K") as record:
        bulk.measured([900.0, 1373.15], 270e-6)
    assert len(record) == 1
    assert record[0].filename == __file__
    with pytest.raises(ValueError, match=r"particle_diameter is 600 um .*Table 5.2 has 270 um zirconia-silica, 320 um"):
        bulk.measured(900.0, 600e-6)
    with pytest.raises(ValueError, match=r"table is '9\.9'"):
        bulk.find_fit(270e-6, table="9.9")
    for change, message in (
        ({"porosity": 1.0}, "porosity is 1; expected .* less than 1"),
        ({"porosity": 0.0}, "porosity is 0"),
        ({"emissivity": 1.1}, "emissivity is 1.1"),
        ({"temperature": 0.0}, "temperature is 0 K"),
        ({"contact": -0.1}, "contact is -0.1"),
        ({"free_path": -1e-7}, "free_path is -1e-07 m"),
    ):
        arguments = {"porosity": 0.4, "particle_diameter": 1e-3, "temperature": 300.0} | change
        with pytest.raises(ValueError, match=message):
            bulk.zehner_bauer_schluender(0.03, 2.1, **arguments)
    with pytest.raises(ValueError, match=r"accommodation is 1.2"):
        bulk.modified_free_path(300.0, 0.03, accommodation=1.2)
