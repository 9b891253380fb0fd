import math

import mpmath
import numpy as np
import pytest

from bedrad.heat import fluid_lens, lens_and_layer, particle_transient, wall_lenses
from bedrad.heat.single_particle import particle_conductivity

D, S = 165e-6, 117e-9
R = D / 2
AREA = (20 * D) ** 2
RNG = np.random.default_rng(7)
GAPS = np.where(RNG.random(430) < 0.6, 0.0, RNG.uniform(-0.01, 1.3, 430) * R)
NAMES = ("edge", "solid", "asperity", "void")


def compare(gas=0.0242, solid=1.1, gaps=GAPS, asperity=S, lens=1.4):
    return lens_and_layer.compare(gas, solid, D, gaps, AREA, asperity, lens)


@pytest.mark.parametrize("solid", [0.03, 1.1, 46.6, 1e6])
def test_ends_are_the_two_models_and_the_steps_add_up(solid):
    found = compare(solid=solid)
    lenses = wall_lenses.wall_coefficient(0.0242, D, GAPS, AREA, S)
    assert found.rong_horio == pytest.approx(lenses.coefficient, rel=1e-12)
    # k_wa of a flat wall, particle by particle (Watkins 2018, eq. 29-34)
    a = np.maximum(GAPS / R, 0.0)
    a = a[a < 1]
    area = math.pi * R**2 * (1 - a**2)
    k_wa = 0.0242 * (np.sum(area * particle_conductivity(solid / 0.0242, a)) + AREA - np.sum(area)) / AREA
    assert found.watkins == pytest.approx(k_wa / R, rel=1e-12)
    assert found.rong_horio + sum(getattr(found, name) for name in NAMES) == pytest.approx(found.watkins, rel=1e-12)


def test_each_step_vanishes_with_its_cause():
    found = compare()
    # a lens of sqrt(2) covers all of a particle in contact, so that only particles apart have an edge left
    touching = np.zeros(200)
    assert compare(gaps=touching, lens=math.sqrt(2)).edge == pytest.approx(0.0, abs=1e-9 * found.rong_horio)
    assert compare(gaps=touching).edge > 0.003 * compare(gaps=touching).rong_horio
    # the isothermal particle is the limit of a solid that conducts without limit
    solids = np.array([1e4, 1e6, 1e8])
    lost = np.array([compare(solid=k).solid for k in solids])
    assert -lost[1:] / found.rong_horio == pytest.approx(0.0, abs=1e-3)
    assert np.diff(np.log(-lost)) / np.diff(np.log(solids)) == pytest.approx(-1.0, abs=0.1)
    # with a solid that conducts like glass, asperities fade out in proportion to their height
    heights = np.array([1e-2, 1e-3, 1e-4]) * S
    gained = np.array([compare(asperity=s).asperity for s in heights])
    assert np.all(gained > 0)
    assert np.diff(np.log(gained)) / np.diff(np.log(heights)) == pytest.approx(2.0, abs=0.1)
    # particles side by side in a square lattice leave 1 - pi/4 of the wall to the gas
    square = lens_and_layer.compare(0.0242, 1.1, D, np.zeros(1), D * D, S)
    assert square.void == pytest.approx(0.0242 / R * (1 - math.pi / 4), rel=1e-12)
    assert lens_and_layer.compare(0.0242, 1.1, D, np.zeros(2), D * D, S).void < 0.0


def test_what_parts_the_models_for_glass_is_the_solid():
    """The table in docs/heat_fluid_lens.md: a hexagonal layer with 60 % of its places in contact, the rest apart."""
    places = 1.0 / (2 * math.sqrt(3) * R**2)
    gaps = np.concatenate([np.zeros(600), np.linspace(0.0, 0.44, 400) * R])
    table = {
        (1.1, 117e-9): (2626, 96, -1393, 1, 39, 1369),
        (46.6, 117e-9): (2626, 96, -235, 188, 39, 2715),
        (46.6, 32e-9): (3100, 96, -560, 39, 39, 2715),
        (1e9, 117e-9): (2626, 96, 0, 6131, 39, 8892),
    }
    for (solid, asperity), expected in table.items():
        found = lens_and_layer.compare(0.0277, solid, D, gaps, 1000 / places, asperity)
        values = [found.rong_horio, *(getattr(found, name) for name in NAMES), found.watkins]
        assert values == pytest.approx(expected, abs=0.6)


def test_solid_of_a_touching_particle_resists_like_asperities_of_e_over_k():
    K = np.array([1.0, 2.0, 45.0, 1e3, 1e6])
    s = lens_and_layer.equivalent_asperity(K)
    # a lens over the whole radius of an isothermal particle with these asperities conducts like Watkins' particle
    lens = fluid_lens.conductance(1.0, 2.0, 0.0, s, math.sqrt(2))
    assert lens == pytest.approx(math.pi * particle_conductivity(K), rel=1e-12)
    assert s[0] == pytest.approx(1.0, abs=1e-7)
    assert s[3:] * K[3:] / math.e == pytest.approx(1.0, abs=0.02)
    with mpmath.workdps(30):
        k_c = 2 * (mpmath.mpf(45) / 44) ** 2 * (mpmath.log(45) - mpmath.mpf(44) / 45)
        root = mpmath.findroot(lambda x: x / 2 - mpmath.log(x) - k_c / 2, 0.05)
    assert s[2] == pytest.approx(float(root), rel=1e-13)


def test_particles_out_of_reach_change_nothing():
    more = np.concatenate([GAPS, [5 * R, 100 * R, 1e6 * R]])
    assert compare(gaps=more) == compare()
    assert "resistance of the solid" in str(compare())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"gas": 0.0}, "gas_conductivity is 0"),
        ({"solid": -1.0}, "solid_conductivity is -1"),
        ({"asperity": 0.0}, "asperity is 0 m"),
        ({"lens": 0.9}, r"lens_radius is 0\.9"),
        ({"gaps": 1.0}, r"gaps has shape \(\)"),
        ({"gaps": [np.nan]}, r"gaps has shape \(1,\); expected one finite gap"),
    ],
)
def test_refusals(change, message):
    with pytest.raises(ValueError, match=message):
        compare(**change)


@pytest.mark.parametrize("K", [0.5, np.inf, np.nan])
def test_refuses_solids_that_conduct_less_than_the_gas(K):
    with pytest.raises(ValueError, match="conductivity_ratio is"):
        lens_and_layer.equivalent_asperity(K)


def test_a_sphere_that_conducts_in_all_directions_lies_between_the_models_for_glass_and_near_the_lens_for_steel():
    """H/(k_g r) of one particle in contact: isothermal, resolved in three dimensions, along straight lines."""
    gas = 0.0277
    for solid, d, s, expected in ((1.1, D, S, (41.07, 24.03, 17.90)), (46.6, 1e-3, 32e-9, (60.53, 56.23, 40.44))):
        biot = float(fluid_lens.biot_number(gas, solid, d, 0.0, s))
        sphere = particle_transient.heated_through_lens(biot, 0.0, 2 * s / d, modes=200, radial=4)
        isothermal = float(fluid_lens.conductance(gas, d, 0.0, s)) / (gas * d / 2)
        resolved = isothermal * sphere.lasting_conductance / sphere.conductance
        straight = math.pi * float(particle_conductivity(solid / gas))
        assert (isothermal, resolved, straight) == pytest.approx(expected, abs=0.03)
