import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erfc, jn_zeros

from bedrad.heat import RangeWarning, two_layer
from oracles import two_layer_series as oracle
from oracles.two_layer_series import table


def integrated(A, kappa):
    """Nusselt number by integration over the radius, in units of R, k_b and the wall flux.

    In a plug flow heated uniformly the flux at radius r is that at the wall times r: dT/dr = r/k(r).
    """
    edge = 1 - 1 / A

    def conductivity(r):
        return 1.0 if r < edge else 1.0 / kappa

    def below_wall(r):
        return quad(lambda s: s / conductivity(s), r, 1.0, points=[edge] if r < edge else None, epsrel=1e-12)[0]

    mean = sum(
        quad(lambda r: 2 * r * below_wall(r), low, high, epsrel=1e-11)[0] for low, high in ((0, edge), (edge, 1))
    )
    return 2.0 / mean  # h D/k_b with h = 1/(T_w - T_mean)


@pytest.mark.parametrize(("A", "kappa"), [(2.5, 0.3), (12.9, 2.5), (28.2, 1.0), (40.1, 7.0)])
def test_integration_over_the_radius(A, kappa):
    assert two_layer.nusselt_developed(A, kappa) == pytest.approx(integrated(A, kappa), rel=1e-10)


def test_one_layer_and_wide_tubes_give_eight():
    assert two_layer.nusselt_developed([2.0, 12.9, 1e6], 1.0) == pytest.approx(8.0, rel=1e-14)
    assert two_layer.nusselt_developed(np.inf, [0.1, 10.0]) == pytest.approx(8.0, rel=1e-14)


def test_source_example():
    # Watkins 2018, Fig. 4.3: k_wa 0.12, k_b 0.30 W/(m K), A = 28.2
    W = 1 - 1 / 28.2
    assert two_layer.nusselt_developed(28.2, 0.30 / 0.12) == pytest.approx(8 / (W**4 + 2.5 * (1 - W**4)), rel=1e-14)


def test_broadcast():
    assert two_layer.nusselt_developed(np.ones((3, 1)) * 20, np.array([1.0, 2.0])).shape == (3, 2)


@pytest.mark.parametrize(
    ("A", "kappa", "message"),
    [
        (1.0, 2.0, "diameter_ratio is 1; expected more than 1"),
        (np.nan, 2.0, "diameter_ratio is nan"),
        (20.0, 0.0, "conductivity_ratio is 0"),
        (20.0, np.inf, "conductivity_ratio is inf"),
    ],
)
def test_refusals(A, kappa, message):
    with pytest.raises(ValueError, match=message):
        two_layer.nusselt_developed(A, kappa)


def test_complete_model_against_the_reference_table():
    kappa, W, z_star, Nu, _ = table("two_layer_nusselt.csv")
    found = two_layer.nusselt(1 / (1 - W), kappa, z_star)
    assert np.max(np.abs(found - Nu)) < 1e-8  # eight decimals are given, W to twelve


def test_extremes_against_many_digits():
    """D/d from 1 + 1e-7 to 1e6, kappa 1e-4 to 1e4, z* 1e-16 to 0.1; the worst is 2.4e-13."""
    A, kappa, z_star, Nu = table("two_layer_extremes.csv")
    found = two_layer.nusselt_solution(A, kappa, z_star, tolerance=1e-12)
    assert np.max(np.abs(found.nusselt / Nu - 1)) < 1e-12
    assert np.any(found.terms > 0)
    assert np.any(found.error_bound > 1e-14)


@pytest.mark.parametrize("case", [("1.1", "1e-4", "1e-2"), ("1e6", "1e4", "1e-6")])
def test_table_of_extremes_is_what_its_code_gives(case):
    with mp.workdps(26):
        Nu = float(oracle.transform_nusselt(*case, degree=26))
    rows = table("two_layer_extremes.csv")
    row = np.flatnonzero(np.all(np.isclose(rows[:3].T, [float(x) for x in case], rtol=1e-12, atol=0), axis=1))
    assert rows[3, row] == pytest.approx(Nu, rel=1e-13)


def test_printed_series_in_many_digits():
    """W(73)-(80) as printed, but for the exponent in (77), with roots found by scanning (79)."""
    with mp.workdps(25):
        eigenvalues = oracle.roots("28.2", "2.5", 5, step=0.1)
        for z_star in ("0.02", "0.3"):
            Nu = float(oracle.series_nusselt("28.2", "2.5", z_star, eigenvalues))
            left_out = float(mp.exp(-4 * mp.mpf(z_star) * eigenvalues[-1] ** 2))
            assert two_layer.nusselt(28.2, 2.5, float(z_star), tolerance=1e-12) == pytest.approx(
                Nu, rel=1e-13 + left_out
            )


def test_one_layer_is_the_classical_series():
    """W(6) with the zeros of J1; any A is the same tube when both layers conduct alike."""
    z_star = np.geomspace(1e-4, 2, 30)
    j = jn_zeros(1, 400)
    classical = 8 / (1 - 8 * (np.exp(-4 * j**2 * z_star[:, None]) / j**2).sum(axis=1))
    for A in (1.0001, 2.0, 28.2, 1e6, np.inf):
        assert two_layer.nusselt(A, 1.0, z_star, tolerance=1e-12) == pytest.approx(classical, rel=1e-12)


def test_ends_of_the_range():
    developed = two_layer.nusselt_developed([1.5, 28.2, np.inf], [1e-4, 2.5, 1e4])
    assert two_layer.nusselt([1.5, 28.2, np.inf], [1e-4, 2.5, 1e4], np.inf) == pytest.approx(developed, rel=1e-15)
    assert two_layer.nusselt([1.5, 28.2, np.inf], [1e-4, 2.5, 1e4], 1e9) == pytest.approx(developed, rel=1e-15)
    assert np.all(two_layer.nusselt([1.5, 28.2, np.inf], 2.5, 0.0) == np.inf)
    thin = np.nextafter(1.0, 2.0)  # a tube filled by its wall layer: one layer with k_wa
    assert 2.5 * two_layer.nusselt(thin, 2.5, 0.05) == pytest.approx(two_layer.nusselt(2.0, 1.0, 0.02), rel=1e-13)


def test_vanishing_layer():
    """No layer at D/d = infinity, whatever kappa; on the way there its resistance kappa/A is all that is felt."""
    z_star = np.array([1e-9, 1e-3, 0.1])
    bare = two_layer.nusselt(28.2, 1.0, z_star, tolerance=1e-12)
    assert two_layer.nusselt(np.inf, [[1e-4], [1e4]], z_star, tolerance=1e-12) == pytest.approx(
        np.stack([bare, bare]), rel=1e-13
    )
    A = np.array([1e10, 1e11, 1e12])[:, None]
    resistance = 2 / two_layer.nusselt(A, 1e4, z_star[1:], tolerance=1e-12) - 2 / bare[1:]
    assert resistance * A / (1e4 - 1) == pytest.approx(np.ones((3, 2)), rel=2e-3)


@pytest.mark.parametrize(("A", "kappa"), [(28.2, 2.5), (1.2, 1e-4), (5.0, 1e4)])
def test_inlet_is_a_half_space_of_wall_layer(A, kappa):
    """Nu = sqrt(pi/(kappa z*))/2 at first; then curvature and the rise of the mean, 1 - 3 sqrt(pi t/kappa)/4."""
    t = kappa * np.array([1e-8, 1e-7, 1e-6])
    Nu = two_layer.nusselt(A, kappa, t / 4, tolerance=1e-12)
    half_space = np.sqrt(np.pi / (kappa * t))
    slopes = np.diff(np.log(Nu)) / np.diff(np.log(t))
    assert slopes == pytest.approx(-0.5, abs=3e-3)
    assert np.abs(slopes + 0.5)[0] < 0.4 * np.abs(slopes + 0.5)[1]
    rest = np.abs(half_space / Nu - (1 - 0.75 * np.sqrt(np.pi * t / kappa)))
    assert np.polyfit(np.log(t), np.log(rest), 1)[0] == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("kappa", [0.04, 2.5, 1e3])
def test_thin_layer_is_a_slab_on_a_half_space(kappa):
    """Images of the interface, where heat is reflected by (1 - sqrt kappa)/(1 + sqrt kappa); curvature left out."""
    e = 1e-6
    t = kappa * e**2 * np.array([0.1, 1.0, 10.0])
    reflected = (1 - np.sqrt(kappa)) / (1 + np.sqrt(kappa))
    n = np.arange(1, 400)[:, None]
    x = n * e * np.sqrt(kappa / t)
    images = (reflected**n * (np.exp(-(x**2)) / np.sqrt(np.pi) - x * erfc(x))).sum(axis=0)
    wall = 2 * np.sqrt(kappa * t) * (1 / np.sqrt(np.pi) + 2 * images)
    assert two_layer.nusselt(1 / e, kappa, t / 4, tolerance=1e-12) == pytest.approx(2 / wall, rel=1e-4)
    assert two_layer.nusselt(1e3 / e, kappa, t / 4e6, tolerance=1e-12) == pytest.approx(2e3 / wall, rel=1e-7)


def test_falls_along_the_tube_and_towards_insulating_layers():
    z_star = np.concatenate([np.geomspace(1e-12, 0.2, 150), [np.inf]])
    Nu = two_layer.nusselt(28.2, np.geomspace(1e-4, 1e4, 9)[:, None], z_star)
    assert np.all(np.diff(Nu, axis=1) < 0)
    assert np.all(np.diff(Nu, axis=0) < 0)


def test_source_claim_developed_beyond_0_08():
    """Section 4.1 of the source; its systems (A 12.9 to 40.1, kappa 1 to 4) are within 0.6 % of W(22) there."""
    A, kappa = np.linspace(12.9, 40.1, 8)[:, None], np.linspace(1, 4, 7)
    excess = two_layer.nusselt(A, kappa, 0.08) / two_layer.nusselt_developed(A, kappa) - 1
    assert two_layer.nusselt(28.2, 2.5, 0.08) / two_layer.nusselt_developed(28.2, 2.5) - 1 == pytest.approx(
        0.0043, abs=5e-5
    )
    assert np.max(excess) < 0.006
    assert two_layer.nusselt(2.5, 20.0, 0.08) / two_layer.nusselt_developed(2.5, 20.0) > 1.5  # but not for any layer


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-10, 1e-12])
def test_tolerance_is_held_with_few_terms(tolerance):
    A, kappa = np.array([1.1, 28.2, 1e3])[:, None, None], np.array([1e-2, 2.5, 1e2])[:, None]
    z_star = np.geomspace(1e-4, 1, 12)
    found = two_layer.nusselt_solution(A, kappa, z_star, tolerance=tolerance)
    best = two_layer.nusselt(A, kappa, z_star, tolerance=1e-12)
    assert np.all(np.abs(found.nusselt / best - 1) <= found.error_bound + 2e-12)
    assert np.all(found.error_bound <= tolerance)
    fewer = two_layer.nusselt_series(28.2, 2.5, 0.02, int(found.terms[1, 1, 6]))
    assert fewer.error_bound < tolerance or found.terms[1, 1, 6] == 0


@pytest.mark.parametrize(("A", "kappa"), [(28.2, 2.5), (1.5, 1e-4), (28.2, 1e4)])
def test_bound_of_the_rest_and_exponential_convergence(A, kappa):
    z_star = 0.005 * two_layer.nusselt_developed(A, 1.0) * two_layer.developed_z_star(A, kappa)
    exact = two_layer.nusselt(A, kappa, z_star, tolerance=1e-12)
    errors = []
    for terms in range(12):
        cut = two_layer.nusselt_series(A, kappa, z_star, terms)
        errors.append(abs(cut.nusselt / exact - 1))
        assert errors[-1] <= cut.error_bound + 1e-12
        assert cut.nusselt <= exact * (1 + 1e-12)  # each term adds to Nu
    assert errors[-1] < 1e-3 * errors[0]


def test_no_terms_is_the_developed_flow():
    cut = two_layer.nusselt_series(28.2, 2.5, 1e-6, 0)
    assert cut.nusselt == pytest.approx(two_layer.nusselt_developed(28.2, 2.5))
    assert cut.error_bound > 1e4  # says nothing, and says so


def test_solution_says_what_it_is():
    assert str(two_layer.nusselt_solution(28.2, 2.5, 0.08)).startswith("Nu = 6.6856324 (2 terms at most")
    several = two_layer.nusselt_solution(28.2, 2.5, [1e-6, 0.08])
    assert str(several) == "Nu = 6.68563 to 561.443 (2 terms at most, relative error below 1.0e-12)"
    assert str(two_layer.nusselt_solution(28.2, 2.5, [])) == "no Nusselt numbers"


def test_complete_model_broadcasts():
    found = two_layer.nusselt(np.full((3, 1, 1), 20.0), np.array([[1.0], [2.0]]), [0.1, 1e-5])
    assert found.shape == (3, 2, 2)
    assert isinstance(two_layer.nusselt(20, 2, 0.1), float)
    assert found[0, 1, 1] == two_layer.nusselt(20, 2, 1e-5)


def test_inverse_graetz_number():
    # W(7): z/D over U D/alpha
    k, rho, c, U, D, z = 0.3, 2300.0, 700.0, 0.05, 8e-3, 0.64
    assert two_layer.inverse_graetz(z, k, rho * U, c, D) == pytest.approx((z / D) / (U * D * rho * c / k))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"diameter_ratio": 1.0}, "diameter_ratio is 1; expected more than 1"),
        ({"conductivity_ratio": -1.0}, "conductivity_ratio is -1"),
        ({"z_star": -1e-3}, "z_star is -0.001"),
        ({"z_star": np.nan}, "z_star is nan"),
        ({"z_star": 1e-300}, "z_star is 1e-300; expected 0 or at least 1e-290"),
        ({"tolerance": 1e-14}, "tolerance is 1e-14; expected at least 1e-12 and at most 0.01"),
    ],
)
def test_refusals_of_the_complete_model(change, message):
    given = {"diameter_ratio": 20.0, "conductivity_ratio": 2.0, "z_star": 0.1} | change
    with pytest.raises(ValueError, match=message):
        two_layer.nusselt(**given)


@pytest.mark.parametrize("terms", [-1, 2.5, 2001])
def test_refusal_of_terms(terms):
    with pytest.raises(ValueError, match=f"terms is {terms}; expected a whole number from 0 to 2000"):
        two_layer.nusselt_series(20.0, 2.0, 0.1, terms)


def test_warns_where_digits_were_not_verified():
    with pytest.warns(RangeWarning, match="conductivity_ratio is 1e-07, outside 1e-06 to 1e"):
        two_layer.nusselt(20.0, [1.0, 1e-7], 0.1)
