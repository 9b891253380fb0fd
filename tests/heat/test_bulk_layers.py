import itertools

import numpy as np
import pytest

from bedrad.heat import RangeWarning, bulk
from oracles import bulk_conductivity as oracle

POROSITIES = (0.26, 0.3, 0.37, 0.4, 0.476)
BEYOND = (1e-12, 1e-6, 0.01, 0.9, 1 - 1e-6, 1 - 1e-12)
RATIOS = (1e-12, 1e-6, 0.5, 1 - 1e-3, 1 - 1e-9, 1 - 1e-15, 1.0, 1 + 1e-15, 1 + 1e-9, 1 + 1e-3, 2.0, 70.0, 1e6, 1e12)


def case(row):
    return [row[name] for name in ("k_g", "k_s", "porosity", "diameter", "temperature", "emissivity")]


def test_reference_values():
    (loosest,) = oracle.references("kunii_smith_film_loosest")
    (film,) = oracle.references("kunii_smith_film")
    for row in (loosest, film):
        value = bulk.kunii_smith_gas_film(row["k_s"] / row["k_g"], row["porosity"])
        assert value == pytest.approx(row["value"], rel=1e-9)
    for row in oracle.references("kunii_smith"):
        assert bulk.kunii_smith(*case(row)) == pytest.approx(row["value"], rel=2e-9)
    (row,) = oracle.references("yagi_kunii")
    assert bulk.yagi_kunii(*case(row)) == pytest.approx(row["value"], rel=2e-9)


@pytest.mark.filterwarnings("ignore::bedrad.heat.RangeWarning")
def test_gas_film_from_no_to_perfect_conduction_of_the_solid():
    for eps in (*POROSITIES, *BEYOND):
        values = bulk.kunii_smith_gas_film(RATIOS, eps)
        for K, value in zip(RATIOS, values, strict=True):
            assert oracle.deviation(value, oracle.kunii_smith_gas_film(K, eps)) < 1e-14


def test_gas_film_across_the_change_of_form():
    for n in (1.5, 4 * np.sqrt(3)):
        cap = 1 - np.sqrt(1 - 1 / n)
        for y in (0.2499, 0.2501, 0.4999, 0.5001):
            K = 1 + y / cap
            assert oracle.deviation(bulk.kunii_smith_gas_film(K, 0.4), oracle.kunii_smith_gas_film(K, 0.4)) < 1e-14


@pytest.mark.filterwarnings("ignore::bedrad.heat.RangeWarning")
def test_both_models_at_the_extremes():
    states = itertools.product(((1e-4, 1e-3), (1e-3, 300.0), (5e-2, 3000.0)), (0.0, 1e-250, 0.5, 1.0))
    cases = [
        (0.03, 0.03 * K, eps, d, T, e)
        for K, eps, ((d, T), e) in itertools.product(RATIOS, (*POROSITIES, *BEYOND), list(states))
    ][::5]
    columns = np.array(cases).T
    smith, yagi = bulk.kunii_smith(*columns), bulk.yagi_kunii(*columns)
    for arguments, first, second in zip(cases, smith, yagi, strict=True):
        assert oracle.deviation(first, oracle.kunii_smith(*arguments, 0.9)) < 1e-14
        assert oracle.deviation(second, oracle.kunii_smith(*arguments, 0.9, gas_in_voids=0)) < 1e-14


def test_bed_of_gas():
    assert bulk.kunii_smith_gas_film(1.0, POROSITIES) == pytest.approx(1 / 3, rel=1e-15)
    cold = (0.03, 0.03, 0.4, 1e-3, 300.0, 0.0)
    assert bulk.kunii_smith(*cold, spacing=1.0) == pytest.approx(0.03, rel=1e-14)
    # the docstring's 6 %
    assert bulk.kunii_smith(*cold) == pytest.approx(0.94 * 0.03, rel=1e-14)


def test_yagi_kunii_leaves_out_the_gas_in_the_voids():
    T = np.array([300.0, 1000.0])
    smith = bulk.kunii_smith(0.03, 2.1, 0.4, 1e-3, T)
    assert smith - bulk.yagi_kunii(0.03, 2.1, 0.4, 1e-3, T) == pytest.approx(0.4 * 0.03, rel=1e-12)


def test_yagi_kunii_with_a_film_of_ones_own():
    film = bulk.kunii_smith_gas_film(70.0, 0.4)
    value = bulk.yagi_kunii(0.03, 2.1, 0.4, 1e-3, 300.0, gas_film=film)
    assert value == bulk.yagi_kunii(0.03, 2.1, 0.4, 1e-3, 300.0)
    # no film at all: the spheres alone, 3/2 K (1 - eps)
    bare = bulk.yagi_kunii(0.03, 2.1, 0.4, 1e-3, 300.0, 0.0, 1.0, 1e-300)
    assert bare == pytest.approx(1.5 * 2.1 * 0.6, rel=1e-14)
    # a film given, the porosity is free
    assert bulk.yagi_kunii(0.03, 2.1, 0.6, 1e-3, 300.0, gas_film=0.05) > 0


def test_black_spheres_radiate_more():
    e = np.linspace(0.0, 1.0, 11)
    assert np.all(np.diff(bulk.kunii_smith(0.03, 2.1, 0.4, 1e-3, 1000.0, e)) > 0)
    assert np.all(np.diff(bulk.yagi_kunii(0.03, 2.1, 0.4, 1e-3, 1000.0, e)) > 0)


def test_range_and_refusals():
    match = r"porosity is 0\.5, outside the fitted range 0\.26 to 0\.476"
    for function in (bulk.kunii_smith, bulk.yagi_kunii):
        with pytest.warns(RangeWarning, match=match) as record:
            function(0.03, 2.1, [0.4, 0.5], 1e-3, 300.0)
        assert len(record) == 1
        assert record[0].filename == __file__
    with pytest.warns(RangeWarning, match=match):
        beyond = bulk.kunii_smith_gas_film(70.0, 0.5)
    assert beyond == bulk.kunii_smith_gas_film(70.0, 0.476)
    for change, message in (
        ({"porosity": 1.0}, "porosity is 1"),
        ({"spacing": 0.0}, "spacing is 0"),
        ({"emissivity": 2.0}, "emissivity is 2"),
        ({"temperature": -1.0}, "temperature is -1 K"),
        ({"gas_conductivity": 0.0}, "gas_conductivity is 0"),
    ):
        arguments = {
            "gas_conductivity": 0.03,
            "solid_conductivity": 2.1,
            "porosity": 0.4,
            "particle_diameter": 1e-3,
            "temperature": 300.0,
        }
        with pytest.raises(ValueError, match=message):
            bulk.kunii_smith(**(arguments | change))
    with pytest.raises(ValueError, match="gas_film is 0"):
        bulk.yagi_kunii(0.03, 2.1, 0.4, 1e-3, 300.0, gas_film=0.0)
    with pytest.raises(ValueError, match="ratio is -2"):
        bulk.kunii_smith_gas_film(-2.0, 0.4)
