import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bedrad.heat import RangeWarning, cylinder, single_particle, wall_layer, wall_particles

GAS, SOLID, D = 0.03, 2.1, 6e-4
R = D / 2


def layer(gaps, area=None, tube=math.inf, **more):
    """Contributions of particles of 0.6 mm; by default each has 4 r^2 of the wall."""
    gaps = np.asarray(gaps)
    return wall_particles.contributions(
        GAS, SOLID, gaps, D, 4 * R * R * gaps.size if area is None else area, tube, **more
    )


@pytest.mark.parametrize(("A", "form"), [(math.inf, "flat"), (12.9, "cylinder"), (2.5, "cylinder")])
@pytest.mark.parametrize("a", [0.05, 0.22, 0.7])
def test_particles_at_one_distance_are_the_form_of_the_source(A, form, a):
    touching, apart, area = 60, 25, 1e-4
    found = layer([0.0] * touching + [a] * apart, area, A * D)
    if form == "cylinder":
        volumes = cylinder.particle_volume(A, np.array([0.0, a]))
    else:
        volumes = math.pi / 3 * np.array([2.0, (1 - a) ** 2 * (2 + a)])
    fraction = float(volumes @ [touching, apart]) * R**2 / area / (1 - 0.5 / A)
    source = wall_layer.contributions(GAS, SOLID, A, D, touching / area, fraction, a, form)
    for name in ("conductivity", "contact", "no_contact", "void", "no_contact_per_area", "covered_share"):
        assert getattr(found, name) == pytest.approx(getattr(source, name), rel=1e-12), name
    assert found.contacts_per_area == touching / area


def test_sum_over_particles_of_many_sizes_against_columns_in_mpmath():
    rng = np.random.default_rng(1)
    d = rng.uniform(3e-4, 9e-4, 12)
    gaps = np.r_[0.0, 0.0, rng.uniform(0.02, 0.8, 10)]
    thickness, area = 0.5 * d.mean(), 4e-6
    found = wall_particles.contributions(GAS, SOLID, gaps, d, area, contact_gap=0.0)
    assert found.layer_thickness == pytest.approx(thickness, rel=1e-15)
    with mpmath.workdps(25):
        total = mpmath.mpf(1)
        for r, g in zip((d / 2).tolist(), (gaps * d / 2).tolist(), strict=True):
            if g >= thickness:
                continue
            deepest = min(r, mpmath.sqrt(max(r * r - max(r + g - thickness, 0) ** 2, 0)))

            def excess(rho, r=r, g=g):
                half = mpmath.sqrt(r * r - rho * rho)
                chord = min(thickness, g + r + half) - (g + r - half)
                return 2 * mpmath.pi * rho * (thickness / (thickness - chord + chord * GAS / SOLID) - 1)

            turn = r * r - (thickness - r - g) ** 2
            points = [0, r * 1e-3, r * 0.1, *([mpmath.sqrt(turn)] if 0 < turn < deepest**2 else []), deepest]
            total += mpmath.quad(excess, sorted(points)) / area
    assert found.conductivity == pytest.approx(float(GAS * total), rel=1e-11)
    assert found.conductivity == pytest.approx(found.contact + found.no_contact + found.void, rel=1e-14)


@given(seed=st.integers(0, 10**6), K=st.floats(0.1, 1e6), tube=st.sampled_from([math.inf, 8e-3]))
@settings(max_examples=25)
def test_layer_of_many_sizes_conducts_between_gas_and_solid(seed, K, tube):
    rng = np.random.default_rng(seed)
    d = rng.uniform(4e-4, 8e-4, 9)
    gaps = rng.uniform(-0.02, 1.2, 9)
    found = wall_particles.contributions(GAS, GAS * K, gaps, d, 1e-5, tube)
    low, high = sorted((GAS, GAS * K))
    assert low * (1 - 1e-12) <= found.conductivity <= high * (1 + 1e-12)
    # any order, any unit of length
    order = rng.permutation(9)
    again = wall_particles.contributions(GAS, GAS * K, gaps[order], 1e3 * d[order], 10.0, 1e3 * tube)
    assert again.conductivity == pytest.approx(found.conductivity, rel=1e-12)


def test_sizes_scattered_by_rounding_are_one_size():
    gaps = np.array([0.0, 0.1, 0.5])
    d = D * (1 + 1e-15 * np.array([1.0, -2.0, 1.0]))
    exact = layer(gaps, 1e-5, 12.9 * D)
    assert wall_particles.contributions(GAS, SOLID, gaps, d, 1e-5, 12.9 * D).conductivity == pytest.approx(
        exact.conductivity, rel=1e-12
    )


def test_spread_of_sizes_matters_to_second_order():
    # sizes +-s about the mean, at a flat wall and in a tube: no first-order term, so that halving s quarters it
    gaps, area = np.full(2, 0.1), 1e-5
    for tube in (math.inf, 12.9 * D):
        even = wall_particles.contributions(GAS, SOLID, gaps, D, area, tube).conductivity
        apart = [
            wall_particles.contributions(GAS, SOLID, gaps, D * np.array([1 - s, 1 + s]), area, tube).conductivity - even
            for s in (0.08, 0.04)
        ]
        assert apart[0] / apart[1] == pytest.approx(4.0, abs=0.25)


def test_overlaps_count_as_contact_at_a_point_and_are_told():
    even = layer([0.0, 0.0, 0.3])
    found = layer([-0.05, 0.009, 0.3])
    assert found.conductivity == even.conductivity
    assert (found.overlapping, even.overlapping) == (1, 0)
    assert "1 of them overlap it" in str(found)
    # the tolerance decides which particles touch
    assert layer([-0.05, 0.009, 0.3], contact_gap=0.0).contact == pytest.approx(0.5 * even.contact)


def test_particles_beyond_the_layer_do_not_count_unless_they_touch():
    assert layer([0.0, 0.2], 1e-6).conductivity == layer([0.0, 0.2, 1.0, 3.0], 1e-6).conductivity
    nothing = layer([1.0, 2.0])
    assert (nothing.conductivity, nothing.void, nothing.covered_share) == (GAS, GAS, 0.0)
    empty = wall_particles.contributions(GAS, SOLID, [], [], 1e-5, layer_thickness=R)
    assert (empty.conductivity, empty.no_contact_per_area) == (GAS, 0.0)


def test_standard_errors_come_from_the_blocks():
    # three blocks of different area, with known conductivities
    gaps, groups, areas = [0.0, 0.0, 0.0, 0.4, 0.4], [0, 0, 1, 1, 2], np.array([2e-6, 1e-6, 3e-6])
    found = layer(gaps, 6e-6, groups=groups, group_areas=areas)
    each = [layer([g for g, b in zip(gaps, groups, strict=True) if b == k], areas[k]) for k in range(3)]
    for name in ("conductivity", "contact", "no_contact", "void"):
        values = np.array([getattr(one, name) for one in each])
        weight = areas / areas.sum()
        mean = weight @ values
        assert getattr(found, name) == pytest.approx(mean, rel=1e-13)
        expected = math.sqrt(1.5 * (weight**2 * (values - mean) ** 2).sum())
        assert getattr(found, name + "_error") == pytest.approx(expected, rel=1e-12), name
    assert math.isnan(layer(gaps).conductivity_error)
    assert "+-" in str(found)
    assert "+-" not in str(layer(gaps))


def test_standard_errors_are_those_of_independent_particles():
    # particles thrown at random: the error of the mean over 400 beds against the one estimated from 12 blocks
    rng = np.random.default_rng(7)
    blocks, each = 12, 20
    groups, areas = np.repeat(np.arange(blocks), each), np.full(blocks, 4 * R * R * each)
    beds = [layer(rng.choice([0.0, 0.3, 0.8], groups.size), groups=groups, group_areas=areas) for _ in range(400)]
    spread = np.std([bed.conductivity for bed in beds], ddof=1)
    estimated = math.sqrt(np.mean([bed.conductivity_error**2 for bed in beds]))
    # both are known to 3.5 %; four standard deviations of their ratio
    assert estimated / spread == pytest.approx(1.0, abs=0.16)


def test_extremes_of_conductivity_and_distance():
    gaps = np.array([0.0, 1e-12, 1e-6, 0.22, 1 - 1e-12])
    for K in (1 - 1e-9, 1.0, 1 + 1e-9):
        found = wall_particles.contributions(GAS, GAS * K, gaps, D, 1e-5, contact_gap=0.0)
        assert found.conductivity == pytest.approx(GAS, rel=1e-8)
    high = wall_particles.contributions(GAS, GAS * 1e12, gaps, D, 1e-5, contact_gap=0.0)
    covered = math.pi * R**2 * (1 - gaps**2) / 1e-5
    factors = single_particle.particle_conductivity(1e12, gaps)
    assert high.conductivity == pytest.approx(GAS * (1 + covered @ (factors - 1)), rel=1e-13)


def test_overlapping_areas_are_reported():
    with pytest.warns(RangeWarning, match="void share of k_wa is negative") as record:
        found = layer(np.full(50, 0.3), 50 * 2.5 * R * R)
    assert record[0].filename == __file__
    assert found.void < 0 < found.covered_share - 1
    assert layer(np.full(50, 0.3), 50 * 2.5 * R * R, warn=False).void == found.void


@pytest.mark.parametrize("A", [math.inf, 12.9])
def test_means_of_distances_order_as_the_convexity_says(A):
    gaps = np.r_[np.zeros(5), np.linspace(0.03, 0.97, 40)]
    for K in (2.0, 70.0, 1000.0):
        found = wall_particles.mean_distances(K, gaps, A)
        assert found.conducting < found.volume_weighted < found.area_weighted < found.plain
        assert found.volume_weighted < found.closing < found.plain
        assert found.plain == pytest.approx(0.5)


@pytest.mark.parametrize(("A", "form"), [(math.inf, "flat"), (12.9, "cylinder")])
def test_distances_that_conserve_volume_and_conductivity_do(A, form):
    rng = np.random.default_rng(3)
    gaps, area = np.r_[np.zeros(60), rng.uniform(0.02, 0.98, 30)], 1e-4
    exact = layer(gaps, area, A * D)
    apart = gaps[gaps > 0]
    if form == "cylinder":
        volume = 60 * cylinder.particle_volume(A) + cylinder.particle_volume(A, apart).sum()
    else:
        volume = math.pi / 3 * (120 + ((1 - apart) ** 2 * (2 + apart)).sum())
    fraction = volume * R**2 / area / (1 - 0.5 / A)
    found = wall_particles.mean_distances(SOLID / GAS, gaps, A)
    arguments = GAS, SOLID, A, D, 60 / area, fraction
    closing = wall_layer.contributions(*arguments, found.closing, form)
    assert closing.no_contact_per_area == pytest.approx(30 / area, rel=1e-10)
    assert wall_layer.conductivity(*arguments, found.conducting, form) == pytest.approx(exact.conductivity, rel=1e-11)
    # a mean weighted by volume is nearer than one that counts particles
    errors = [
        exact.conductivity - wall_layer.conductivity(*arguments, a, form)
        for a in (found.volume_weighted, found.area_weighted, found.closing, found.plain)
    ]
    assert 0 < errors[0] < errors[1] < errors[2] < errors[3]


def test_one_distance_is_every_mean():
    for A in (math.inf, 12.9):
        found = wall_particles.mean_distances(70.0, [0.0, 0.3, 0.3, 1.4], A)
        values = found.plain, found.area_weighted, found.volume_weighted, found.closing, found.conducting
        assert values == pytest.approx((0.3,) * 5, rel=1e-14)
    assert math.isnan(wall_particles.mean_distances(70.0, [0.0, 1.2]).closing)
    # particles like the gas conduct the same from anywhere
    assert math.isnan(wall_particles.mean_distances(1.0, [0.1, 0.5]).conducting)
    assert "plain mean 0.3000" in str(found)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"gas_conductivity": 0.0}, r"gas_conductivity is 0 W/\(m K\)"),
        ({"gaps": [0.1, np.nan]}, "gaps are not a list of finite numbers"),
        ({"gaps": [[0.1, 0.2]]}, "gaps are not a list"),
        ({"gaps": [0.1, -1.5]}, "gaps has -1.5 particle radii; expected more than -1"),
        ({"particle_diameters": [D, D, D]}, "particle_diameters has 3 values for 2 gaps"),
        ({"particle_diameters": -D}, "particle_diameters is -0.0006 m"),
        ({"wall_area": 0.0}, "wall_area is 0 m2"),
        ({"wall_diameter": np.nan}, "wall_diameter is nan m"),
        ({"wall_diameter": 1.5 * D}, "diameter_ratio is 1.5"),
        ({"contact_gap": -0.1}, "contact_gap is -0.1"),
        ({"layer_thickness": 0.0}, "layer_thickness is 0 m"),
        ({"gaps": [], "particle_diameters": []}, "layer_thickness is missing"),
        ({"groups": [0, 1]}, "groups and group_areas belong together"),
        ({"groups": [0, 2], "group_areas": [5e-7, 5e-7]}, "groups reach from 0 to 2; expected 0 to 1"),
        ({"groups": [0.0, 1.0], "group_areas": [5e-7, 5e-7]}, "of type float64; expected 2 integers"),
        ({"groups": [0], "group_areas": [1e-6]}, "groups has 1 values .* expected 2 integers"),
        ({"groups": [0, 1], "group_areas": [5e-7, 6e-7]}, "group_areas add up to 1.1e-06 m2; expected the wall_area"),
    ],
)
def test_refusals(change, message):
    arguments = {
        "gas_conductivity": GAS,
        "solid_conductivity": SOLID,
        "gaps": [0.0, 0.4],
        "particle_diameters": D,
        "wall_area": 1e-6,
    }
    with pytest.raises(ValueError, match=message):
        wall_particles.contributions(**(arguments | change))
