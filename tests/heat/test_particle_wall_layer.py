import numpy as np
import pytest

import bedrad
from bedrad.heat import cylinder, prediction, wall_particles
from bedrad.heat.gas import air_conductivity
from bedrad.heat.prediction import ParticleWallLayer, System, ViewFactors, WallLayer

DIAMETER, AREA = 600e-6, 40e-6
TUBE = System(7.75e-3, DIAMETER, 0.016)


def bed(blocks=8, seed=4):
    """Gaps of 75 touching particles and 25 others, in blocks of wall."""
    rng = np.random.default_rng(seed)
    gaps = np.concatenate([np.zeros(75), rng.uniform(0.02, 0.9, 25)])
    return gaps, rng.integers(0, blocks, gaps.size), np.full(blocks, AREA / blocks)


GAPS, GROUPS, AREAS = bed()
LAYER = ParticleWallLayer.from_particles(GAPS, DIAMETER, AREA, TUBE.tube_diameter, groups=GROUPS, group_areas=AREAS)


@pytest.mark.parametrize("K", [1.0, 1.0001, 2.0, 31.6, 70.0, 1e3, 9.9e3, 1e4])
def test_any_pair_of_conductivities_against_the_sum_over_the_particles(K):
    exact = wall_particles.contributions(
        0.05, 0.05 * K, GAPS, DIAMETER, AREA, TUBE.tube_diameter, groups=GROUPS, group_areas=AREAS
    )
    assert LAYER.conductivity(0.05 * K, 0.05) == pytest.approx(exact.conductivity, rel=1e-9)
    relative = exact.conductivity_error / exact.conductivity
    assert LAYER.error(0.05 * K, 0.05) == pytest.approx(relative, rel=1e-6, abs=1e-12)


def test_equal_particles_are_the_exact_cylinder():
    """With one gap for all others, particle by particle and by means are the same sum."""
    gaps = np.concatenate([np.zeros(75), np.full(25, 0.3)])
    layer = ParticleWallLayer.from_particles(gaps, DIAMETER, AREA, TUBE.tube_diameter)
    A, r = TUBE.diameter_ratio, DIAMETER / 2
    volume = 75 * cylinder.particle_volume(A) + 25 * cylinder.particle_volume(A, 0.3)
    phi = float(volume) * r**3 / (AREA * r * (1 - 1 / (2 * A)))
    means = WallLayer(phi, 75 / AREA, 0.3, form="cylinder")
    T = np.array([400.0, 1373.15])
    traced = ViewFactors([0.83, 0.15, 0.01])
    one = prediction.predict(TUBE, T, layer, traced)
    other = prediction.predict(TUBE, T, means, traced)
    assert one.wall_layer_conductivity == pytest.approx(other.wall_layer_conductivity, rel=1e-8)
    assert one.heat_transfer_coefficient == pytest.approx(other.heat_transfer_coefficient, rel=1e-8)


def test_the_scatter_of_the_blocks_goes_into_the_budget():
    T = np.array([400.0, 1373.15])
    one = prediction.predict(TUBE, T, LAYER, ViewFactors([0.83]), samples=3000)
    row = one.budget.names.index("wall_layer_conductivity")
    expected = LAYER.error(TUBE.solid_conductivity, air_conductivity(T))
    assert one.budget.errors[row] == pytest.approx(expected)
    assert one.wall_layer_conductivity_error == pytest.approx(expected * one.wall_layer_conductivity, rel=1e-7)
    assert one.budget.shares[row] == pytest.approx(1.0)
    drawn = one.monte_carlo.standard_deviation["heat_transfer_coefficient"]
    # 4 standard errors of a standard deviation of 3,000 draws, and 1 % for curvature
    assert drawn == pytest.approx(one.heat_transfer_coefficient_error, rel=4 / np.sqrt(6000) + 0.01)
    assert "wall-layer conductivity" in str(one.budget)
    # without blocks nothing is known of the scatter
    bare = ParticleWallLayer.from_particles(GAPS, DIAMETER, AREA, TUBE.tube_diameter)
    assert (prediction.predict(TUBE, T, bare, ViewFactors([0.83])).heat_transfer_coefficient_error == 0.0).all()


def test_what_does_not_belong_together_is_refused():
    with pytest.raises(
        ValueError, match=r"particle_diameter is 0.0003 m; the wall layer was measured in a bed with 0.0006 m"
    ):
        prediction.predict(System(7.75e-3, 300e-6, 0.016), 900.0, LAYER)
    flat = ParticleWallLayer.from_particles(GAPS, DIAMETER, AREA)
    with pytest.raises(
        ValueError, match=r"tube_diameter is 0.00775 m; the wall layer was measured in a bed with inf m"
    ):
        prediction.predict(TUBE, 900.0, flat)
    with pytest.raises(
        ValueError, match=r"solid over gas conductivity is 20000; expected at least 1 and at most 10000"
    ):
        LAYER.conductivity(1e3, 0.05)
    assert flat.conductivity(2.0, 0.05) == pytest.approx(
        wall_particles.contributions(0.05, 2.0, GAPS, DIAMETER, AREA).conductivity, rel=1e-9
    )


def test_from_a_packing_to_a_prediction():
    """Rings of touching spheres in a tube: as many contacts as particles, and k_wa as that of the exact cylinder."""
    angle = 2.0 * np.pi * np.arange(36) / 36
    R, r = TUBE.tube_diameter / 2, DIAMETER / 2
    rings = [np.c_[(R - r) * np.cos(angle), (R - r) * np.sin(angle), np.full(36, k * 2.2 * r)] for k in range(10)]
    packing = bedrad.Packing(np.vstack(rings), r, bedrad.Tube(R), period=22.0 * r)
    at = bedrad.particles_at_wall(packing)
    layer = ParticleWallLayer.from_particles(
        at.gaps, at.diameters, at.wall_area, at.wall_diameter, groups=at.groups, group_areas=at.group_areas
    )
    found = bedrad.predict(TUBE, 900.0, layer, ViewFactors([0.8]))
    A = TUBE.diameter_ratio
    phi = len(at) * float(cylinder.particle_volume(A)) * r**3 / (at.wall_area * r * (1 - 1 / (2 * A)))
    means = WallLayer(phi, len(at) / at.wall_area, form="cylinder")
    assert found.wall_layer_conductivity == pytest.approx(means.conductivity(TUBE, air_conductivity(900.0)), rel=1e-8)


def test_the_bound_on_radiation_takes_particles_too():
    T = np.array([600.0, 1200.0])
    bound = prediction.largest_wall_radiation_effect(TUBE, T, LAYER, "zbs")
    one = prediction.predict(TUBE, T, LAYER, ViewFactors([0.2, 0.3, 0.5]), "zbs")
    dark = prediction.predict(TUBE, T, LAYER, ViewFactors([0.0]), "zbs")
    gain = one.heat_transfer_coefficient / dark.heat_transfer_coefficient - 1
    assert (gain < bound).all()
