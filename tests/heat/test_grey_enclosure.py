"""Grey enclosures against closed forms, conservation, and extended precision where the usual system is singular."""

import mpmath
import numpy as np
import pytest

from bedrad.heat import radiation
from bedrad.heat.grey_enclosure import (
    absorption_factors,
    bed_emissivity,
    net_heat_fluxes,
    radiosities,
    total_exchange_factors,
    wall_exchange_factors,
    with_cap,
)

SIGMA = 5.670374419e-8
SWAP = np.array([[0.0, 1.0], [1.0, 0.0]])


def enclosure(zones, seed):
    """A reciprocal matrix and its areas, as of a convex hull of zones that see each other and themselves."""
    G = np.random.default_rng(seed).uniform(0.1, 1.0, (zones, zones))
    G = G + G.T
    areas = G.sum(axis=1)
    return G / areas[:, None], areas


def exact_factors(F, eps, digits=80):
    """F (I - (1 - eps) F)^-1 eps by a plain solve in many digits; the diagonal is what the others leave to one."""
    with mpmath.workdps(digits):
        n = len(F)
        M = mpmath.matrix(F.tolist())
        for i in range(n):
            M[i, i] = 1 - sum(M[i, j] for j in range(n) if j != i)
        e = mpmath.diag([mpmath.mpf(float(x)) for x in eps])
        B = M * mpmath.inverse(mpmath.eye(n) - (mpmath.eye(n) - e) * M) * e
        return np.array([[float(B[i, j]) for j in range(n)] for i in range(n)])


def test_black_zones_exchange_by_the_matrix_itself():
    F, _ = enclosure(5, 0)
    np.testing.assert_array_equal(absorption_factors(F, 1.0), F)
    np.testing.assert_array_equal(total_exchange_factors(F, np.ones(5)), F)


EMISSIVITIES = {
    "usual": [0.8, 0.5, 0.3, 0.9],
    "all 1e-12": [1e-12] * 4,
    "all 1e-300": [1e-300] * 4,
    "mixed": [1e-12, 0.5, 1e-6, 1.0],
    "two scales of nearly white": [1e-12, 1e-3, 1e-9, 1e-15],
    "one reradiates": [0.7, 0.0, 0.2, 0.1],
    "one absorbs": [0.0, 0.0, 0.0, 1e-9],
}


@pytest.mark.parametrize("name", EMISSIVITIES)
def test_every_factor_against_extended_precision(name):
    eps = np.array(EMISSIVITIES[name])
    F, _ = enclosure(4, 1)
    np.testing.assert_allclose(absorption_factors(F, eps), exact_factors(F, eps, 400), rtol=1e-14, atol=0)


def test_zones_that_hardly_see_each_other():
    """Two rooms with a keyhole of 1e-13 between them, walls all but white: what leaks is right to rounding."""
    leak = 1e-13
    F = np.array([[0.0, 1.0, 0.0, 0.0], [1.0 - leak, 0.0, leak, 0.0], [0.0, leak, 0.0, 1.0 - leak], [0, 0, 1.0, 0]])
    eps = np.array([1e-12, 1e-8, 1e-10, 1e-5])
    np.testing.assert_allclose(absorption_factors(F, eps), exact_factors(F, eps), rtol=1e-13, atol=0)


@pytest.mark.parametrize("e1", [1.0, 0.7, 1e-3, 1e-12])
@pytest.mark.parametrize("e2", [1.0, 0.2, 1e-12])
def test_two_infinite_plates(e1, e2):
    with mpmath.workdps(40):
        exact = float(1 / (1 / mpmath.mpf(e1) + 1 / mpmath.mpf(e2) - 1))
    assert total_exchange_factors(SWAP, [e1, e2])[0, 1] == pytest.approx(exact, rel=1e-15)
    q = net_heat_fluxes(SWAP, [e1, e2], [1000.0, 600.0])
    assert q == pytest.approx(
        [exact * SIGMA * (1000.0**4 - 600.0**4), -exact * SIGMA * (1000.0**4 - 600.0**4)], rel=1e-14
    )


@pytest.mark.parametrize("ratio", [0.5, 0.25, 1e-6])
def test_concentric_spheres_or_cylinders(ratio):
    """The inner one sees only the outer one, which sees it by the ratio of the areas, and itself."""
    F = np.array([[0.0, 1.0], [ratio, 1.0 - ratio]])
    e1, e2 = 0.6, 0.3
    assert total_exchange_factors(F, [e1, e2])[0, 1] == pytest.approx(1 / (1 / e1 + ratio * (1 / e2 - 1)), rel=1e-14)


@pytest.mark.parametrize("shields", [1, 2, 10])
def test_shields_between_plates(shields):
    """N shields of equal emissivity pass 1/(N + 1) of the heat, and their fourth powers lie on a straight line."""
    gaps, eps = shields + 1, 0.2
    F = np.kron(np.eye(gaps), SWAP)
    power = np.linspace(1200.0**4, 400.0**4, gaps + 1)
    T = np.column_stack([power[:-1], power[1:]]).ravel() ** 0.25
    q = SIGMA * (1200.0**4 - 400.0**4) / (gaps * (2 / eps - 1))
    # the two sides of each shield take what they give
    np.testing.assert_allclose(net_heat_fluxes(F, eps, T), np.tile([q, -q], gaps), rtol=1e-12)


def test_a_reradiating_zone_against_the_closed_form():
    """Two grey zones and a refractory one (Hottel): the third takes no heat and passes on all that it gets."""
    F, A = enclosure(3, 4)
    e1, e2 = 0.6, 0.35
    mutual = F[0, 1] + 1 / (1 / F[0, 2] + A[0] / (A[1] * F[1, 2]))
    exact = 1 / ((1 / e1 - 1) + A[0] / A[1] * (1 / e2 - 1) + 1 / mutual)
    assert total_exchange_factors(F, [e1, e2, 0.0])[0, 1] == pytest.approx(exact, rel=1e-14)
    # whatever its temperature is said to be
    cold, hot = (net_heat_fluxes(F, [e1, e2, 0.0], [900.0, 500.0, T]) for T in (1.0, 3000.0))
    np.testing.assert_array_equal(cold, hot)
    assert hot[2] == 0.0


def test_energy_is_conserved_and_reciprocity_passes_on():
    F, A = enclosure(6, 2)
    rng = np.random.default_rng(3)
    eps, T = rng.uniform(0.01, 1.0, (7, 6)), rng.uniform(300.0, 1500.0, (7, 6))
    B = absorption_factors(F, eps)
    np.testing.assert_allclose(B.sum(axis=-1), 1.0, rtol=1e-14)
    exchange = A[:, None] * total_exchange_factors(F, eps)
    np.testing.assert_allclose(exchange, exchange.transpose(0, 2, 1), rtol=1e-13)
    q = net_heat_fluxes(F, eps, T)
    np.testing.assert_allclose((q * A).sum(axis=-1), 0.0, atol=1e-12 * np.abs(q * A).max())
    # and the radiosities satisfy their own equations: J = eps E + (1 - eps) F J, q = J - F J
    J = radiosities(F, eps, T)
    arriving = J @ F.T
    np.testing.assert_allclose(J, eps * SIGMA * T**4 + (1 - eps) * arriving, rtol=1e-13)
    np.testing.assert_allclose(J - arriving, q, rtol=0, atol=1e-12 * J.max())


def test_one_temperature_gives_no_heat_and_small_differences_keep_their_digits():
    F, _ = enclosure(4, 5)
    assert np.all(net_heat_fluxes(F, [1e-12, 0.3, 1.0, 0.5], 1000.0) == 0.0)
    T = 1000.0 * np.ones(4)
    T[0] += 1e-10
    q = net_heat_fluxes(F, 0.5, T)
    B = total_exchange_factors(F, 0.5)
    np.testing.assert_allclose(q[1:], -B[1:, 0] * 4 * SIGMA * 1e9 * (T[0] - 1000.0), rtol=1e-12)


def test_zones_split_in_two_change_nothing():
    F, A = enclosure(3, 6)
    split = np.array([0, 0, 1, 2])
    share = np.array([0.3, 0.7, 1.0, 1.0])
    finer = F[np.ix_(split, split)] * share
    B = absorption_factors(F, [0.4, 0.6, 0.2])
    fine = absorption_factors(finer, np.array([0.4, 0.6, 0.2])[split])
    np.testing.assert_allclose(fine[0, 0] + fine[0, 1], B[0, 0], rtol=1e-14)
    np.testing.assert_allclose(fine[1, 2:], B[0, 1:], rtol=1e-14)
    assert len(A) == 3


@pytest.fixture
def bed():
    """A wall and three layers of which radiation is lost; the wall sees itself."""
    F, A = enclosure(6, 8)
    F, A = F.copy(), A.copy()
    return F[:4, :4], F[:4, 4:].sum(axis=1), A[:4]


def test_cap_takes_what_is_lost_and_sees_not_itself(bed):
    F, lost, A = bed
    closed, areas = with_cap(F, lost, A)
    np.testing.assert_allclose(closed.sum(axis=1), 1.0, rtol=1e-15)
    G = areas[:, None] * closed
    np.testing.assert_allclose(G, G.T, rtol=1e-14)
    assert closed[-1, -1] == 0.0
    np.testing.assert_array_equal(closed[:4, :4], F)


def test_cap_of_a_closed_enclosure_has_no_area_and_no_effect():
    F, A = enclosure(4, 9)
    closed, areas = with_cap(F, np.zeros(4), A)
    assert areas[-1] == 0.0
    for cap in (0.0, 1.0):
        B = absorption_factors(closed, [0.5, 0.4, 0.3, 0.2, cap])
        np.testing.assert_allclose(B[:4, :4], absorption_factors(F, [0.5, 0.4, 0.3, 0.2]), rtol=1e-14)


def test_black_bed_has_the_view_factors_and_k_rad_of_the_black_model(bed):
    F, lost, A = bed
    factors = wall_exchange_factors(F, lost, A, 1.0, 1.0)
    np.testing.assert_array_equal(factors, [*F[0, 1:], lost[0]])
    black = radiation.conductivity(F[0, 1:], 6e-4, 1000.0)
    assert radiation.conductivity(factors[:-1], 6e-4, 1000.0) == black


def test_wall_and_bed_of_one_temperature_are_two_plates(bed):
    eps_w, eps_p = np.array([[1.0], [0.5], [1e-9]]), np.array([1.0, 0.5, 0.1, 1e-12])
    for cap in (0.0, 1.0):
        factors = wall_exchange_factors(*bed, eps_w, eps_p, cap)
        assert factors.shape == (3, 4, 4)
        whole = bed_emissivity(*bed, eps_p, cap)
        np.testing.assert_allclose(factors.sum(axis=-1), 1 / (1 / eps_w + 1 / whole - 1), rtol=1e-13)
    assert np.all(np.diff(bed_emissivity(*bed, eps_p)) < 0)
    # with a black cap nothing comes back from there; with one that sends all back, white particles absorb nothing
    assert bed_emissivity(*bed, 1e-12) > 0.1
    assert 0.0 < bed_emissivity(*bed, 1e-12, 0.0) < 1e-11
    assert np.ndim(bed_emissivity(*bed, 0.5)) == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: absorption_factors([[0.5, 0.4], [0.5, 0.5]], 0.5), "row 0 of exchange_matrix sums to 0.9"),
        (lambda: absorption_factors([[0.5, 0.5]], 0.5), r"exchange_matrix has the shape \(1, 2\)"),
        (lambda: absorption_factors([[1.2, -0.2], [0.0, 1.0]], 0.5), "exchange factor is 1.2 "),
        (lambda: absorption_factors(SWAP, [0.5, 1.1]), "emissivity is 1.1"),
        (lambda: absorption_factors(SWAP, [0.5, np.nan]), "emissivity is nan"),
        (lambda: absorption_factors(SWAP, [0.5, 0.5, 0.5]), r"emissivities has the shape \(3,\); expected 2 zones"),
        (lambda: absorption_factors(SWAP, 0.0), "emissivity is 0 for zones that see only each other"),
        (lambda: absorption_factors(np.kron(np.eye(2), SWAP), [1.0, 1.0, 0.0, 0.0]), "emissivity is 0 for zones"),
        (lambda: absorption_factors(np.eye(2), [0.0, 1.0]), "emissivity is 0 for zones"),
        (lambda: net_heat_fluxes(SWAP, 0.5, [0.0, 300.0]), "temperature is 0 K"),
        (lambda: radiosities(SWAP, 0.5, [[300.0]]), r"temperatures has the shape \(1, 1\)"),
        (lambda: with_cap(SWAP, [0.1, 0.0], [1.0, 1.0]), "row 0 of exchange_matrix sums to 1.1"),
        (lambda: with_cap(SWAP, [0.0], [1.0, 1.0]), r"have the shapes \(2, 2\), \(1,\) and \(2,\)"),
        (lambda: wall_exchange_factors(SWAP, [0.0, 0.0], [1, 1], 0.5, 2.0), "particle_emissivity is 2"),
        (lambda: wall_exchange_factors(SWAP, [0.0, 0.0], [1, 1], 0.5, 0.5, -1.0), "cap_emissivity is -1"),
    ],
)
def test_refuses_what_has_no_meaning(call, message):
    with pytest.raises(ValueError, match=message):
        call()
