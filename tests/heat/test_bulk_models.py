import itertools

import numpy as np
import pytest

from bedrad.heat import bulk, bulk_models
from oracles import bulk_conductivity as oracle

POROSITIES = (1e-12, 1e-6, 0.01, 0.26, 0.37, 0.4, 0.476, 0.9, 1 - 1e-6, 1 - 1e-12)
NEAR_ONE = (1 - 1e-3, 1 - 1e-9, 1 - 1e-15, 1.0, 1 + 1e-15, 1 + 1e-9, 1 + 1e-3)
RATIOS = (1e-12, 1e-6, 1e-3, 0.5, *NEAR_ONE, 2.0, 10.0, 70.0, 1e3, 1e6, 1e9, 1e12)


@pytest.mark.parametrize("row", oracle.references("zehner_schluender"))
def test_reference_values_of_zehner_schluender(row):
    value = bulk.zehner_schluender(row["k_g"], row["k_s"], row["porosity"])
    assert value == pytest.approx(row["value"], rel=4e-9)


@pytest.mark.parametrize("row", oracle.references("zehner_bauer_schluender"))
def test_reference_values_of_zehner_bauer_schluender(row):
    value = bulk.zehner_bauer_schluender(
        row["k_g"], row["k_s"], row["porosity"], row["diameter"], row["temperature"], row["emissivity"], row["contact"]
    )
    assert value == pytest.approx(row["value"], rel=2e-9)


def test_reference_value_with_the_smoluchowski_effect():
    # 3 mm spheres in air at 1 atm, accommodation 1; without the effect the value would be 0.23278276
    path = bulk.modified_free_path(300.0, 0.03)
    value = bulk.zehner_bauer_schluender(0.03, 1.5, 0.4, 3e-3, 300.0, 0.8, 0.0077, path)
    assert value == pytest.approx(0.23246215, rel=1e-7)


def test_zehner_schluender_from_no_to_perfect_conduction_of_the_solid():
    cases = np.array(list(itertools.product(RATIOS, POROSITIES)))
    values = bulk.zehner_schluender(1.0, *cases.T)
    for (K, eps), value in zip(cases, values, strict=True):
        assert oracle.deviation(value, oracle.zehner_schluender(1.0, K, eps)) < 1e-14


def test_zehner_schluender_where_it_divides_by_nothing():
    for eps in POROSITIES:
        B = float(bulk.deformation(eps))
        for off in (1e-14, 1e-8, -1e-4, 0.01, 0.2, -0.2, 0.24999, 0.25001, -0.3):
            K = B * (1 + off)
            assert oracle.deviation(bulk.zehner_schluender(1.0, K, eps), oracle.zehner_schluender(1.0, K, eps)) < 1e-13
        # at K = B itself the printed equation is 0/0; the model is smooth there
        at, beside = bulk.zehner_schluender(1.0, [B, B * (1 + 1e-9)], eps)
        assert beside == pytest.approx(at, rel=1e-8)


def test_zehner_bauer_schluender_at_the_extremes():
    materials = itertools.product((1e-6, 0.5, 1.0, 2.0, 70.0, 1e6, 1e12), (1e-6, 0.26, 0.4, 0.9, 1 - 1e-6))
    states = itertools.product(
        ((1e-4, 1e-3), (1e-3, 300.0), (5e-2, 3000.0)), (0.0, 1e-250, 0.5, 1.0), (0.0, 0.0077), (0.0, 1e-7, 1e-3, 10.0)
    )
    cases = [
        (0.03, 0.03 * K, eps, d, T, e, phi, path)
        for (K, eps), ((d, T), e, phi, path) in itertools.product(materials, list(states))
    ][::7]
    values = bulk.zehner_bauer_schluender(*np.array(cases).T)
    for case, value in zip(cases, values, strict=True):
        assert oracle.deviation(value, oracle.zehner_bauer_schluender(*case)) < 1e-14


@pytest.mark.parametrize("path", [0.0, 1e-6])
def test_printed_equations_for_random_beds(path):
    rng = np.random.default_rng(3)
    for _ in range(40):
        k_g, k_s, d = 10 ** rng.uniform((-2, -2, -4), (0, 1.5, -2))
        case = (k_g, k_s, rng.uniform(0.2, 0.8), d, 1000.0, 0.7, 0.01, path)
        value = bulk.zehner_bauer_schluender(*case)
        assert oracle.deviation(value, oracle.zehner_bauer_schluender(*case)) < 1e-13


def test_bed_of_gas_conducts_like_gas():
    eps = np.array([1e-300, 1e-9, *np.linspace(0.2, 0.9, 8), 1 - 1e-16])
    assert bulk.zehner_schluender(0.03, 0.03, eps) == pytest.approx(0.03, rel=1e-14)
    # a free path makes the gas in the gaps conduct less than the gas in the voids
    value = bulk.zehner_bauer_schluender(0.03, 0.03, eps[2:-1], 1e-3, 300.0, radiation=False)
    assert value == pytest.approx(0.03, rel=1e-14)


def test_bounds_of_any_isotropic_mixture():
    # no mixture conducts better than layers along the flux or worse than layers across it (Wiener 1912)
    for eps in (0.3, 0.4, 0.5):
        K = np.array([0.01, 0.5, 2.0, 70.0, 1e4])
        value = bulk.zehner_schluender(1.0, K, eps)
        assert np.all(value < eps + (1 - eps) * K)
        assert np.all(value > 1 / (eps + (1 - eps) / K))


def test_grows_with_the_logarithm_of_a_perfect_solid():
    # point contacts: from some K on, each decade of K adds the same, 2 sqrt(1-eps) B ln 10
    eps = 0.4
    decades = np.diff(bulk.zehner_schluender(1.0, 10.0 ** np.arange(6, 13), eps))
    expected = 2 * np.sqrt(1 - eps) * float(bulk.deformation(eps)) * np.log(10)
    assert decades[-1] == pytest.approx(expected, rel=1e-8)
    error = np.abs(decades / expected - 1)
    assert np.all(error[1:4] / error[:3] < 0.15)


def test_conduction_only_is_the_same_by_both():
    K = np.array([2.0, 70.0, 1000.0])
    both = bulk.zehner_bauer_schluender(0.03, 0.03 * K, 0.37, 1e-3, 300.0, radiation=False)
    assert both == pytest.approx(bulk.zehner_schluender(0.03, 0.03 * K, 0.37), rel=1e-15)


def test_radiation_raises_it_and_fades_with_the_temperature():
    T = np.array([1.0, 300.0, 800.0, 1400.0])
    with_radiation = bulk.zehner_bauer_schluender(0.05, 2.1, 0.37, 1e-3, T)
    without = bulk.zehner_bauer_schluender(0.05, 2.1, 0.37, 1e-3, T, radiation=False)
    assert np.ptp(without) == 0.0
    assert np.all(np.diff(with_radiation - without) > 0)
    assert with_radiation[0] == pytest.approx(without[0], rel=1e-7)
    mirrors = bulk.zehner_bauer_schluender(0.05, 2.1, 0.37, 1e-3, T, 0.0)
    assert np.array_equal(mirrors, without)


def test_radiation_diverges_as_the_bed_empties():
    # a defect of the model that the docstring tells: the core's radiation grows like (1 - eps)^(-11/18)
    rest = np.array([1e-6, 1e-8])
    k = bulk.zehner_bauer_schluender(0.05, 2.1, 1 - rest, 1e-3, 1000.0)
    assert np.log(k[1] / k[0]) / np.log(rest[1] / rest[0]) == pytest.approx(-11 / 18, abs=5e-3)


def test_free_path_of_air():
    # the temperature jumps at both walls of a gap (Kennard 1938), 2 (2 - a)/a 2 gamma/(gamma + 1) path/Pr, with the
    # ordinary free path of 67.3 nm at 300 K and 1 atm, gamma = 1.4 and Pr = 0.707
    path = bulk.modified_free_path(300.0, 0.0262)
    assert path == pytest.approx(2 * 2.8 / 2.4 * 67.3e-9 / 0.707, rel=0.01)
    assert bulk.modified_free_path(300.0, 0.0262, accommodation=0.9) / path == pytest.approx(1.1 / 0.9, rel=1e-12)
    assert bulk.modified_free_path(300.0, 0.0262, 101.325) == pytest.approx(1000 * path, rel=1e-12)
    # in a vacuum the gas conducts nothing, and with point contacts and no radiation the bed neither
    nothing = bulk.zehner_bauer_schluender(0.03, 2.1, 0.37, 1e-3, 300.0, 0.8, 0.0, [1e3, 1e6], radiation=False)
    assert nothing[1] / nothing[0] == pytest.approx(1e-3, rel=0.01)


def test_other_shapes_than_spheres():
    assert bulk.deformation(0.5) == 1.25
    assert bulk.deformation(0.5, 2.5) == 2.5
    assert bulk.zehner_schluender(0.03, 2.1, 0.4, 1.4) > bulk.zehner_schluender(0.03, 2.1, 0.4)
    value = bulk.zehner_bauer_schluender(0.03, 2.1, 0.4, 1e-3, 300.0, radiation=False, shape=1.4)
    assert value == pytest.approx(bulk.zehner_schluender(0.03, 2.1, 0.4, 1.4), rel=1e-14)


def test_scalars_arrays_and_broadcasting():
    assert np.ndim(bulk.zehner_schluender(0.03, 2.1, 0.4)) == 0
    table = bulk.zehner_bauer_schluender(0.03, 2.1, 0.4, np.array([1e-4, 1e-3])[:, None], [300.0, 600.0, 900.0])
    assert table.shape == (2, 3)
    assert table[1, 2] == bulk.zehner_bauer_schluender(0.03, 2.1, 0.4, 1e-3, 900.0)


def test_logarithm_rest_across_the_change_of_form():
    import mpmath

    with mpmath.workdps(40):
        for q in (-0.25001, -0.24999, -1e-9, 0.0, 1e-300, 0.1, 0.24999, 0.25001, 0.49):
            x = mpmath.mpf(q)
            expected = (mpmath.log1p(x) - x + x**2 / 2) / x**3 if abs(q) > 1e-10 else mpmath.mpf(1) / 3
            assert float(bulk_models.logarithm_rest(np.array(q))) == pytest.approx(float(expected), rel=3e-14, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"porosity": 1.0}, "porosity is 1; expected .* less than 1"),
        ({"porosity": 0.0}, "porosity is 0"),
        ({"porosity": np.nan}, "porosity is nan"),
        ({"emissivity": 1.1}, r"emissivity is 1\.1"),
        ({"emissivity": -0.1}, r"emissivity is -0\.1"),
        ({"temperature": 0.0}, "temperature is 0 K"),
        ({"particle_diameter": -1e-3}, r"particle_diameter is -0\.001 m"),
        ({"solid_conductivity": 0.0}, r"solid_conductivity is 0 W/\(m K\)"),
        ({"contact": -0.1}, r"contact is -0\.1"),
        ({"free_path": -1e-7}, "free_path is -1e-07 m"),
        ({"shape": 0.0}, "shape is 0"),
    ],
)
def test_refusals(change, message):
    arguments = {
        "gas_conductivity": 0.03,
        "solid_conductivity": 2.1,
        "porosity": 0.4,
        "particle_diameter": 1e-3,
        "temperature": 300.0,
    }
    with pytest.raises(ValueError, match=message):
        bulk.zehner_bauer_schluender(**(arguments | change))


def test_accommodation_is_a_share():
    with pytest.raises(ValueError, match=r"accommodation is 1\.2"):
        bulk.modified_free_path(300.0, 0.03, accommodation=1.2)
