import itertools

import numpy as np
import pytest

from bedrad.heat import RangeWarning, bulk
from bedrad.heat import bulk_radiation as radiation
from oracles import bulk_conductivity as oracle

STATES = list(itertools.product((1e-6, 1e-3, 1.0), (1e-3, 1.0, 300.0, 3000.0), (0.0, 1e-250, 1e-9, 0.5, 1.0)))
SOLIDS = (1e-6, 2.1, 1e6)
POROSITIES = (1e-12, 0.01, 0.26, 0.4, 0.9, 1 - 1e-12)


def test_reference_values():
    for name, function in (("breitbach_barthels", radiation.breitbach_barthels), ("schotte", radiation.schotte)):
        rows = oracle.references(name)
        assert len(rows) == 2
        for row in rows:
            value = function(row["k_s"], row["porosity"], row["diameter"], row["temperature"], row["emissivity"])
            assert value == pytest.approx(row["value"], rel=4e-9)
    for row in oracle.references("argo_smith"):
        value = radiation.argo_smith(row["diameter"], row["temperature"], row["emissivity"])
        assert value == pytest.approx(row["value"], rel=4e-9)
    (row,) = oracle.references("singh_kaviany")
    value = radiation.singh_kaviany(row["k_s"], row["diameter"], row["temperature"], row["emissivity"])
    assert value == pytest.approx(row["value"], rel=1e-9)
    (row,) = oracle.references("singh_kaviany_black_good_conductor")
    value = radiation.exchange_factor(radiation.singh_kaviany(1e30, 1e-3, 300.0, 1.0), 1e-3, 300.0)
    assert value == pytest.approx(row["value"], rel=4e-9)
    (row,) = oracle.references("vortmeyer_exchange_factor")
    value = radiation.exchange_factor(radiation.vortmeyer(1e-3, 300.0, row["emissivity"]), 1e-3, 300.0)
    assert value == pytest.approx(row["value"], rel=1e-9)


def test_radiation_inside_the_cell_of_zehner_bauer_schluender():
    (row,) = oracle.references("zehner_bauer_schluender_cell_radiation")
    value = radiation.argo_smith(row["diameter"], row["temperature"], row["emissivity"]) / row["k_g"]
    assert value == pytest.approx(row["value"], rel=1e-9)


def test_extremes_of_the_models_with_porosity():
    for function, slow in (
        (radiation.breitbach_barthels, oracle.breitbach_barthels),
        (radiation.schotte, oracle.schotte),
    ):
        cases = [(k_s, eps, *state) for k_s, eps, state in itertools.product(SOLIDS, POROSITIES, STATES)][::3]
        for arguments, value in zip(cases, function(*np.array(cases).T), strict=True):
            assert oracle.deviation(value, slow(*arguments)) < 1e-14


def test_extremes_of_the_others():
    cases = [(k_s, *state) for k_s, state in itertools.product(SOLIDS, STATES)]
    for arguments, value in zip(cases, radiation.singh_kaviany(*np.array(cases).T), strict=True):
        assert oracle.deviation(value, oracle.singh_kaviany(*arguments)) < 1e-14
    for arguments, value in zip(STATES, radiation.vortmeyer(*np.array(STATES).T), strict=True):
        assert oracle.deviation(value, oracle.vortmeyer(*arguments)) < 1e-14


def test_breitbach_barthels_is_the_vacuum_limit_of_zehner_bauer_schluender_but_for_the_voids():
    # two publications, one cell: what Bauer's radiation leaves when the gas conducts nothing; across the voids
    # beside the core Bauer's is grey, Breitbach and Barthels' black
    d = 5e-3
    for k_s, eps, e, T in ((2.1, 0.4, 0.8, 1273.15), (0.05, 0.3, 0.3, 800.0), (46.6, 0.5, 1.0, 1500.0)):
        voids = (1 - np.sqrt(1 - eps)) * eps * (radiation.black_conductivity(d, T) - radiation.argo_smith(d, T, e))
        limit = radiation.breitbach_barthels(k_s, eps, d, T, e) - voids
        gas = np.array([1e-4, 1e-6, 1e-8]) * limit
        error = bulk.zehner_bauer_schluender(gas, k_s, eps, d, T, e) / limit - 1
        # of the order of the gas times its logarithm
        assert np.abs(error[2]) < 3e-7
        assert error[1:] / error[:-1] == pytest.approx([0.01 * 6 / 4, 0.01 * 8 / 6], rel=0.35)


def test_a_good_conductor_matters_to_half_of_the_models():
    d, T = 1e-3, 1273.15
    k_s = np.array([0.1, 1.0, 10.0, 1000.0])
    assert np.all(np.diff(radiation.breitbach_barthels(k_s, 0.4, d, T)) > 0)
    assert np.all(np.diff(radiation.singh_kaviany(k_s, d, T)) > 0)
    assert np.all(np.diff(radiation.schotte(k_s, 0.4, d, T)) > 0)


def test_black_good_conductors():
    # what is left of each: 1 by construction, and the models' own limits; FCC of black isothermal spheres has 0.8737
    d, T = 1e-3, 1000.0

    def factor(conductivity):
        return radiation.exchange_factor(conductivity, d, T)

    assert factor(radiation.argo_smith(d, T, 1.0)) == 1.0
    assert factor(radiation.schotte(1e30, 0.4, d, T, 1.0)) == pytest.approx(1.0, rel=1e-15)
    assert factor(radiation.vortmeyer(d, T, 1.0)) == pytest.approx(1.121098, abs=1e-6)
    B = float(bulk.deformation(0.4))
    root = np.sqrt(0.6)
    expected = (1 - root) * 0.4 + root * (1 + B) / B
    assert factor(radiation.breitbach_barthels(1e30, 0.4, d, T, 1.0)) == pytest.approx(expected, rel=1e-14)


def test_grow_with_emissivity_cube_of_temperature_and_diameter():
    e = np.linspace(0.0, 1.0, 21)
    for conductivity in (
        radiation.argo_smith(1e-3, 1000.0, e),
        radiation.vortmeyer(1e-3, 1000.0, e),
        radiation.schotte(2.1, 0.4, 1e-3, 1000.0, e),
        radiation.breitbach_barthels(2.1, 0.4, 1e-3, 1000.0, e),
        radiation.singh_kaviany(2.1, 1e-3, 1000.0, e),
    ):
        assert np.all(np.diff(conductivity) > 0)
    assert radiation.vortmeyer(2e-3, 600.0) / radiation.vortmeyer(1e-3, 300.0) == pytest.approx(16.0, rel=1e-14)
    # mirrors still pass radiation on, except in the models that know no reflection
    assert radiation.argo_smith(1e-3, 1000.0, 0.0) == 0.0
    assert radiation.exchange_factor(radiation.singh_kaviany(2.1, 1e-3, 1000.0, 0.0), 1e-3, 1000.0) == pytest.approx(
        0.1843, rel=1e-14
    )


def test_range_and_refusals():
    with pytest.warns(RangeWarning, match=r"porosity is 0\.37, outside the fitted range 0\.4 to 0\.5") as record:
        values = radiation.singh_kaviany(2.1, 1e-3, 300.0, 0.8, [0.45, 0.37])
    assert record[0].filename == __file__
    assert values == pytest.approx(radiation.singh_kaviany(2.1, 1e-3, 300.0), rel=1e-15)
    assert values.shape == (2,)
    for call, message in (
        (lambda: radiation.argo_smith(0.0, 300.0), "particle_diameter is 0 m"),
        (lambda: radiation.argo_smith(1e-3, 300.0, 1.5), r"emissivity is 1\.5"),
        (lambda: radiation.vortmeyer(1e-3, -5.0), "temperature is -5 K"),
        (lambda: radiation.vortmeyer_transmission(-0.1), r"emissivity is -0\.1"),
        (lambda: radiation.schotte(0.0, 0.4, 1e-3, 300.0), "solid_conductivity is 0"),
        (lambda: radiation.breitbach_barthels(2.1, 1.0, 1e-3, 300.0), "porosity is 1"),
        (lambda: radiation.singh_kaviany(np.inf, 1e-3, 300.0), "solid_conductivity is inf"),
        (lambda: radiation.exchange_factor(-1.0, 1e-3, 300.0), "conductivity is -1"),
    ):
        with pytest.raises(ValueError, match=message):
            call()
