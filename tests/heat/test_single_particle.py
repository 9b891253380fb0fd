import mpmath
import numpy as np
import pytest

from bedrad.heat import single_particle, wall_layer

RATIOS = [
    1e-3,
    0.01,
    0.3,
    0.9,
    0.99,
    1 - 1e-4,
    1 - 1e-9,
    1.0,
    1 + 1e-9,
    1 + 1e-4,
    1.05,
    1.12,
    2,
    10,
    70,
    1e3,
    1e6,
    1e9,
    1e12,
]
DISTANCES = [0.0, 1e-12, 1e-6, 0.05, 0.22, 0.6, 0.999, 1 - 1e-9]


def printed_factor(K, a):
    """Watkins 2018, eq. 37 as printed, in 80 digits; its limit (1 - a^2)/2 at K = 1."""
    with mpmath.workdps(80):
        K, a = mpmath.mpf(K), mpmath.mpf(a)
        if K == 1:
            return (1 - a * a) / 2
        bracket = (a * (K - 1) + K) / K * mpmath.log(K / (a * K + 1 - a)) - (1 - a) * (K - 1) / K
        return (K / (K - 1)) ** 2 * bracket


@pytest.mark.parametrize("K", RATIOS)
@pytest.mark.parametrize("a", DISTANCES)
def test_factors_hold_to_rounding_over_fifteen_decades(K, a):
    exact = printed_factor(K, a)
    assert abs(wall_layer.no_contact_factor(K, a) / exact - 1) < 1e-14
    with mpmath.workdps(80):
        conductivity = 2 * exact / (1 - mpmath.mpf(a) ** 2)
    assert abs(wall_layer.particle_conductivity(K, a) / conductivity - 1) < 1e-14
    if a == 0.0:
        assert wall_layer.contact_factor(K) == wall_layer.no_contact_factor(K, 0.0)


@pytest.mark.parametrize(
    ("K", "contact", "apart"),
    [
        (2, 1.54517744, 1.33391271),
        (10, 3.46317307, 1.94181814),
        (70, 6.71607926, 2.19227961),
        (1000, 11.84118108, 2.23937710),
    ],
)
def test_reference_conductivities(K, contact, apart):
    assert wall_layer.particle_conductivity(K) == pytest.approx(contact, rel=1e-8)
    assert 2 * wall_layer.contact_factor(K) == pytest.approx(contact, rel=1e-8)
    assert wall_layer.particle_conductivity(K, 0.22) == pytest.approx(apart, rel=1e-8)


def test_a_particle_of_gas_or_at_the_edge_of_the_layer_conducts_like_gas():
    assert wall_layer.particle_conductivity(1.0, np.linspace(0, 1, 11)) == pytest.approx(1.0, abs=1e-15)
    assert wall_layer.particle_conductivity(np.logspace(-3, 6, 10), 1.0) == pytest.approx(1.0, abs=1e-15)
    assert np.all(wall_layer.no_contact_factor(np.logspace(-3, 6, 10), 1.0) == 0.0)


def test_conductivity_lies_between_gas_and_solid_and_falls_with_the_distance():
    K = np.logspace(0.1, 5, 30)[:, None]
    values = wall_layer.particle_conductivity(K, np.linspace(0, 1, 50))
    assert np.all(values >= 1.0)
    assert np.all(values <= K)
    assert np.all(np.diff(values, axis=1) < 0.0)


def test_integral_of_the_local_resistances():
    # eq. 32-33: each ring conducts through its gas and its solid in series
    K, a = 70.0, 0.22
    with mpmath.workdps(20):
        edge = mpmath.sqrt(1 - mpmath.mpf(a) ** 2)

        def ring(r):
            surface = mpmath.sqrt(1 - r * r)
            return 2 * r / ((1 + a - surface) + (surface - a) / K)

        expected = mpmath.quad(ring, [0, edge / 2, edge]) / edge**2
    assert wall_layer.particle_conductivity(K, a) == pytest.approx(float(expected), rel=1e-13)


def test_numbers_give_numbers_and_arrays_broadcast():
    assert np.ndim(wall_layer.contact_factor(70.0)) == 0
    assert wall_layer.no_contact_factor(np.ones((3, 1)) * 7, np.zeros(4)).shape == (3, 4)


@pytest.mark.parametrize("K", [0.0, -1.0, np.nan, np.inf])
def test_refuses_ratios_without_meaning(K):
    with pytest.raises(ValueError, match=r"K .* expected a positive, finite number"):
        wall_layer.contact_factor(K)


@pytest.mark.parametrize("a", [-0.1, 1.1, np.nan])
def test_refuses_distances_outside_the_layer(a):
    with pytest.raises(ValueError, match=r"a \(distance .* expected at least 0 and at most 1"):
        wall_layer.no_contact_factor(70.0, a)


def column_integral(K, a, depth):
    """Conductivity over k_g of a particle in a layer of any depth, column by column, in 40 digits."""
    with mpmath.workdps(40):
        K, a, depth = (mpmath.mpf(x) for x in (K, a, depth))
        cap = min(depth - a, 2)
        first, turn = max(1 - cap, 0), cap - 1

        def column(u):
            chord = min(depth, a + 1 + u) - (a + 1 - u)
            return u / (depth - chord + chord / K)

        peaks = [1 - mpmath.mpf(10) ** -k for k in (1, 2, 4, 6, 9, 12, 15)]
        points = [first, turn, *peaks, 1]
        points = sorted({p for p in points if first <= p <= 1})
        return 2 * depth * mpmath.quad(column, points) / (1 - first**2)


@pytest.mark.parametrize("depth", [0.3, 1.0, 1.1, 1.7, 2.0, 2.5])
@pytest.mark.parametrize("K", [1e-3, 1 - 1e-9, 1.0, 70.0, 1e12])
def test_particles_cut_at_any_depth(K, depth):
    for a in (0.0, 1e-9, 0.25):
        area, k = single_particle.cut_particle(K, a, depth)
        assert abs(k / column_integral(K, a, depth) - 1) < 1e-14
        cap = min(depth - a, 1.0)
        assert area == pytest.approx(np.pi * cap * (2 - cap), rel=1e-14)


def test_cut_at_one_radius_is_eq_34():
    K, a = np.logspace(-3, 12, 40)[:, None], np.linspace(0, 1, 21)
    area, k = single_particle.cut_particle(K, a)
    assert k == pytest.approx(single_particle.particle_conductivity(K, a), rel=1e-14)
    assert area == pytest.approx(np.broadcast_to(np.pi * (1 - a * a), area.shape), rel=1e-14)


def test_cut_particle_refuses_what_lies_beyond_the_layer():
    with pytest.raises(ValueError, match=r"nc_distance is 1.2 particle radii; expected at most layer_depth"):
        single_particle.cut_particle(70.0, 1.2, 1.1)
