import mpmath as mp
import numpy as np
import pytest
from scipy.special import j0, j1, jn_zeros, y0, y1

from bedrad.heat.two_layer_modes import count_below, find_modes, layers
from oracles import two_layer_series as oracle
from oracles.finite_volume_tube import Tube
from oracles.two_layer_series import table


def pair(A, kappa):
    return layers(np.array([float(A)]), np.array([float(kappa)]))


def test_table_of_modes():
    _, mu, nu, G, H, norm, wall, E, share = table("two_layer_modes_kappa2.5_A28.2.csv")
    modes = find_modes(pair(28.2, 2.5), mu.size)
    assert modes.mu[0] == pytest.approx(mu, rel=2e-11)  # twelve digits are given
    assert np.sqrt(2.5) * modes.mu[0] == pytest.approx(nu, rel=2e-11)
    assert modes.weights[0] == pytest.approx(-share, rel=2e-11)
    assert modes.weights[0] == pytest.approx(wall**2 / (norm * mu**2), rel=2e-11)
    assert 1 / modes.bulk[0] == pytest.approx(wall, rel=1e-9)  # the table has the value 1 on the axis
    r = np.array([[0.0, 0.5, 1 - 1 / 28.2, 0.98, 1.0]])
    expected = np.where(r.T <= 1 - 1 / 28.2, j0(mu * r.T), G * j0(nu * r.T) + H * y0(nu * r.T))
    assert modes.shapes(r)[0] * wall == pytest.approx(expected, abs=1e-9)
    assert E * wall == pytest.approx(share, rel=1e-10)


def test_printed_coefficients_in_many_digits():
    """(75)-(78) as printed: the bracket of (74) is phi(R), E_p is -phi(R)/(lambda^2 n), denominators are Wronskians."""
    with mp.workdps(30):
        for A, kappa in (("28.2", "2.5"), ("3", "0.04")):
            W, k = 1 - 1 / mp.mpf(A), mp.mpf(kappa)
            modes = find_modes(pair(A, kappa), 3)
            for p, lam in enumerate(oracle.roots(A, kappa, 3, step=0.1)):
                G, H = oracle.coefficients(lam, W, k)
                wall = lam * mp.sqrt(k)
                phi = G * mp.besselj(0, wall) + H * mp.bessely(0, wall)
                n = oracle.norm(lam, W, k, G, H)
                a = wall * W
                below = mp.besselj(1, a) * mp.bessely(0, a) - mp.besselj(0, a) * mp.bessely(1, a)
                assert abs(below * mp.pi * a / 2 - 1) < 1e-25
                assert abs(oracle.printed_bracket(lam, W, k, G, H) / phi - 1) < 1e-25
                assert abs(oracle.printed_amplitude(lam, W, k, G, H) * lam**2 * n / -phi - 1) < 1e-25
                assert modes.mu[0, p] == pytest.approx(float(lam), rel=2e-15)
                assert modes.weights[0, p] == pytest.approx(float(phi**2 / (lam**2 * n)), rel=1e-13)


@pytest.mark.parametrize(
    ("A", "kappa"),
    [("28.2", "1e4"), ("1e3", "1e4"), ("28.2", "1e-4"), ("1.01", "1e-4"), ("1.5", "1e-4")],
)
def test_close_roots_in_many_digits(A, kappa):
    """The first modes of layers whose roots come in groups, none missed by a scan of (79) at 20 digits."""
    with mp.workdps(20):
        found = [float(x) for x in oracle.roots(A, kappa, 4, step=0.1)]
    modes = find_modes(pair(A, kappa), 4)
    assert modes.mu[0] == pytest.approx(found, rel=1e-13)


def test_no_mode_is_missed():
    """Sign changes of (79), scanned at 60 points a mode, for 300 tubes from thin layers to thin bulks."""
    rng = np.random.default_rng(5)
    A, kappa = 1 + 10 ** rng.uniform(-3, 4, 300), 10 ** rng.uniform(-4, 4, 300)
    pairs = layers(A, kappa)
    top = rng.uniform(5, 40, 300) * np.pi / pairs.depth
    counted = count_below(pairs, top)
    lam = top[:, None] * np.arange(1, 2401) / 2400
    W, root = pairs.W[:, None], np.sqrt(kappa)[:, None]
    b, a, R = lam * W, root * lam * W, root * lam
    left = j0(b) * (y1(a) * j1(R) - j1(a) * y1(R)) + root * j1(b) * (j0(a) * y1(R) - j1(R) * y0(a))
    assert np.all(np.sum(left[:, 1:] * left[:, :-1] < 0, axis=1) == counted)


@pytest.mark.parametrize(("A", "kappa"), [(28.2, 1e4), (1.5, 1e-4), (5.0, 1e4), (200.0, 1e3)])
def test_modes_of_a_finite_volume_grid(A, kappa):
    """A matrix has its eigenvalues whole and in order; they fall on the modes, one by one, as the grid is refined."""
    modes = find_modes(pair(A, kappa), 12).mu[0]
    errors = [np.abs(Tube(A, kappa, n, n).eigenvalues(12) / modes - 1) for n in (500, 1000)]
    assert np.max(errors[1]) < 2e-3
    # the least eigenvalue lies within the rounding of the largest
    assert errors[0][1:] / errors[1][1:] == pytest.approx(np.full(11, 4.0), rel=0.01)


@pytest.mark.parametrize(("A", "kappa"), [(28.2, 1.0), (1.5, 2.5), (3.0, 0.1), (4.0, 30.0)])
def test_weights_add_up_to_the_developed_resistance(A, kappa):
    """The sum of E_p phi_p(R) at z = 0 is -[W^4 + kappa (1 - W^4)]/4; what is missing falls as 1/number."""
    modes = find_modes(pair(A, kappa), 2000)
    missing = modes.layers.resistance[0] - np.cumsum(modes.weights[0])
    number = np.array([125, 250, 500, 1000, 2000])
    assert np.all(np.diff(np.cumsum(modes.weights[0])) > 0)
    # averaged over neighbours, as the weights of two layers alternate
    mean = [missing[n - 25 : n].mean() for n in number]
    assert np.polyfit(np.log(number - 12.0), np.log(mean), 1)[0] == pytest.approx(-1.0, abs=0.04)
    assert missing[-1] < 2e-3 * modes.layers.resistance[0]


def test_one_layer():
    zeros = jn_zeros(1, 50)
    modes = find_modes(layers(np.array([1.001, 3.0, 1e6, np.inf]), np.ones(4)), 50)
    assert modes.mu == pytest.approx(np.broadcast_to(zeros, (4, 50)), rel=1e-14)
    assert modes.weights == pytest.approx(np.broadcast_to(2 / zeros**2, (4, 50)), rel=1e-12)


def test_shapes_are_orthogonal_and_without_mean():
    W, x, w = 1 - 1 / 4.0, *np.polynomial.legendre.leggauss(60)
    r = np.concatenate([0.5 * W * (1 + x), W + 0.5 * (1 - W) * (1 + x)])
    weight = np.concatenate([0.5 * W * w, 0.5 * (1 - W) * w]) * r
    modes = find_modes(pair(4.0, 6.0), 10)
    phi = modes.shapes(r[None])[0]
    products = (phi * weight[:, None]).T @ phi
    assert products == pytest.approx(np.diag(1 / (modes.mu[0] ** 2 * modes.weights[0])), abs=1e-13)
    assert weight @ phi == pytest.approx(np.zeros(10), abs=1e-14)
