import numpy as np
import pytest

from bedrad.heat.particle_sizes import SIEVE_OPENINGS, sauter_diameter, sieve_sauter_diameter
from oracles.nguyen import rows

SIEVES = (25, 35, 50, 70, 100)


def sieved(material, **corrected):
    row = next(r for r in rows("sieves") if r["material"] == material) | corrected
    masses = [float(row[f"sieve_{number}"]) for number in SIEVES[:-1]]
    # the shares belong to what is finer than the sieve named
    return 1e3 * sieve_sauter_diameter([SIEVE_OPENINGS[n] for n in SIEVES], masses), float(row["table_17_mm"])


def test_equal_spheres_and_two_sizes():
    assert sauter_diameter(3e-4, 2.0) == pytest.approx(3e-4, rel=1e-15)
    # equal masses of 1 and 3: 2/(1 + 1/3)
    assert sauter_diameter([1.0, 3.0], [0.5, 0.5]) == pytest.approx(1.5, rel=1e-15)


def test_volume_over_surface_of_counted_spheres():
    d = np.random.default_rng(3).uniform(0.1e-3, 1e-3, 500)
    volume, surface = np.sum(np.pi * d**3 / 6), np.sum(np.pi * d**2)
    # eq. 3-1 as printed is the ratio itself, a sixth of the diameter
    assert sauter_diameter(d, d**3) == pytest.approx(6.0 * volume / surface, rel=1e-13)


def test_last_axis_holds_the_classes():
    d = np.array([1.0, 2.0, 4.0])
    w = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    assert sauter_diameter(d, w) == pytest.approx([1.0, 3 / 1.75], rel=1e-15)
    assert sieve_sauter_diameter([4.0, 2.0, 1.0], [[1.0, 0.0], [0.0, 1.0]]) == pytest.approx([3.0, 1.5], rel=1e-15)
    assert sieve_sauter_diameter([1.0, 2.0, 4.0], [1.0, 0.0]) == pytest.approx(1.5, rel=1e-15)


@pytest.mark.parametrize(
    ("material", "found", "tolerance"),
    [("Atlanta Industrial Sand", 0.299, 0.0051), ("ID50-K", 0.275, 0.0051), ("Riyadh Red Sand", 0.266, 0.006)],
)
def test_rows_of_table_17_that_agree(material, found, tolerance):
    got, printed = sieved(material)
    assert got == pytest.approx(found, abs=6e-4)
    assert got == pytest.approx(printed, abs=tolerance)


def test_misprinted_shares_of_table_17():
    # 130 % and 114 % in all; 3 % for 33 %, and 1.6 % for 16 %, give 100 % and the printed diameters
    for material, wrong, right in (
        ("Arizona Fracking Sand", {}, {"sieve_35": "3"}),
        ("Riyadh White Sand", {}, {"sieve_25": "1.6"}),
    ):
        got, printed = sieved(material, **right)
        assert got == pytest.approx(printed, abs=0.005)
        assert abs(sieved(material, **wrong)[0] - printed) > 0.02


def test_carbohsp_of_table_17_does_not_agree():
    got, printed = sieved("CarboHSP")
    assert printed == 0.61
    assert got == pytest.approx(0.5175, abs=1e-3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sauter_diameter([0.0, 1.0], [1.0, 1.0]), "diameters is 0 m"),
        (lambda: sauter_diameter([1.0, 2.0], [1.0, -1.0]), "masses is -1"),
        (lambda: sauter_diameter([1.0, 2.0], [0.0, 0.0]), "sum of the masses is 0"),
        (lambda: sieve_sauter_diameter([1.0, 2.0], [1.0, 1.0]), "expected 3 openings"),
        (lambda: sieve_sauter_diameter([1.0, 3.0, 2.0], [1.0, 1.0]), "openings are out of order"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
