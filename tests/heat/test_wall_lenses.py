import numpy as np
import pytest

from bedrad.heat import fluid_lens, wall_lenses

RNG = np.random.default_rng(3)
DIAMETERS = RNG.uniform(0.8e-4, 1.2e-4, 60)
GAPS = np.where(RNG.random(60) < 0.4, 0.0, RNG.uniform(0.0, 4e-5, 60))
AREA, HEIGHT = 1e-6, 1e-7


def test_sum_over_particles_one_by_one():
    found = wall_lenses.wall_coefficient(0.03, DIAMETERS, GAPS, AREA, HEIGHT)
    each = [float(fluid_lens.conductance(0.03, d, g, HEIGHT)) for d, g in zip(DIAMETERS, GAPS, strict=True)]
    assert found.coefficient == pytest.approx(sum(each) / AREA, rel=1e-13)
    assert found.contact + found.no_contact == pytest.approx(found.coefficient, rel=1e-13)
    touching = GAPS <= HEIGHT
    assert found.contact == pytest.approx(sum(h for h, yes in zip(each, touching, strict=True) if yes) / AREA)
    assert found.contacts == touching.sum()
    assert found.contacts + found.within_reach + found.out_of_reach == 60
    assert found.out_of_reach == sum(h == 0.0 for h in each)
    assert found.out_of_reach > 0
    assert np.isnan(found.standard_error)
    assert "contact particles" in str(found)


def test_hexagonal_layer_of_equal_particles():
    # one particle for each 2 sqrt(3) r^2 of wall: Nu = h d/k_g = H/(k_g r)/sqrt(3)
    r = 1e-4
    h = wall_lenses.wall_coefficient(0.03, 2 * r, np.zeros(10), 10 * 2 * np.sqrt(3) * r**2, 1e-3 * r).coefficient
    assert h * 2 * r / 0.03 == pytest.approx(43.26043285 / np.sqrt(3), rel=1e-9)


def test_standard_error_says_how_beds_scatter():
    rng = np.random.default_rng(11)
    pieces, each = 20, 30
    group = np.repeat(np.arange(pieces), each)
    values, errors = [], []
    for _ in range(200):
        gaps = np.where(rng.random(pieces * each) < 0.5, 0.0, rng.uniform(0, 2e-5, pieces * each))
        found = wall_lenses.wall_coefficient(0.03, 1e-4, gaps, AREA, HEIGHT, groups=group)
        values.append(found.coefficient)
        errors.append(found.standard_error)
    # 200 beds give their scatter to 5 %, the mean square of 200 errors from 20 pieces to 2 %
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(np.std(values, ddof=1), rel=0.25)


def test_pieces_without_particles_count():
    group = np.zeros(4, dtype=int)
    two = wall_lenses.wall_coefficient(0.03, 1e-4, np.zeros(4), AREA, HEIGHT, groups=group, number_of_groups=2)
    # all heat on one half: pieces of 2h and 0, whose standard error is h
    assert two.standard_error == pytest.approx(two.coefficient, rel=1e-12)
    assert two.groups == 2
    assert "2 groups" in str(two)


def test_an_empty_wall_takes_no_heat():
    none = wall_lenses.wall_coefficient(0.03, 1e-4, np.empty(0), AREA, HEIGHT)
    assert none.coefficient == 0.0
    assert "0" in str(none)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"gaps": 0.0}, "gaps has 0 dimensions"),
        ({"particle_diameters": np.ones(3)}, r"particle_diameters has shape \(3,\); expected \(2,\)"),
        ({"asperity": np.ones(3)}, r"asperity has shape \(3,\)"),
        ({"wall_area": 0.0}, "wall_area is 0 m2"),
        ({"groups": [0.0, 1.0]}, "groups is float64"),
        ({"groups": [0]}, r"groups is int64 of shape \(1,\)"),
        ({"groups": [-1, 1]}, "groups holds -1"),
        ({"groups": [0, 3], "number_of_groups": 2}, "groups holds 3; expected numbers below"),
        ({"groups": [0, 0]}, "number_of_groups is 1; expected at least 2"),
    ],
)
def test_refusals(change, message):
    good = {"gas_conductivity": 0.03, "particle_diameters": 1.0, "gaps": [0.0, 0.1], "wall_area": 9.0, "asperity": 1e-3}
    with pytest.raises(ValueError, match=message):
        wall_lenses.wall_coefficient(**{**good, **change})
