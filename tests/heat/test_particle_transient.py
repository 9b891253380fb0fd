import functools
import math

import mpmath
import numpy as np
import pytest
from scipy import integrate, sparse
from scipy.sparse import linalg as sparse_linalg

from bedrad.heat import fluid_lens, particle_transient
from bedrad.heat.particle_transient import critical_biot, heated_through_lens, heated_uniformly, isothermal_error

S = 117e-9 / 250e-6  # asperities of the 500 um glass sphere of Adepu et al., in radii


def series(biot, fourier):
    """Mean temperature left and heat rate of a sphere in a stirred fluid (Carslaw and Jaeger), in 60 digits."""
    with mpmath.workdps(60):
        Bi, t = mpmath.mpf(biot), mpmath.mpf(fourier)

        def characteristic(z):
            return z * mpmath.cos(z) - (1 - Bi) * mpmath.sin(z)

        left = rate = mpmath.mpf(0)
        for n in range(200):
            low, high = n * mpmath.pi + mpmath.mpf(10) ** -30, (n + 1) * mpmath.pi - mpmath.mpf(10) ** -30
            if n == 0:
                low = mpmath.sqrt(3 * Bi) / 2 if Bi < 1 else mpmath.mpf(1)
            z = mpmath.findroot(characteristic, (low, high), solver="anderson", tol=1e-30)
            for _ in range(3):
                z -= characteristic(z) / (Bi * mpmath.cos(z) - z * mpmath.sin(z))
            part = 6 * Bi**2 / (z**2 * (z**2 + Bi**2 - Bi)) * mpmath.exp(-z * z * t)
            left += part
            rate += 4 * mpmath.pi / 3 * z * z * part
            if z * z * t > 80:
                return left, rate
    raise AssertionError("the series has not converged")


@pytest.mark.parametrize("biot", [1e-6, 1e-3, 0.1, 2.0, 30.0, 1e3])
def test_uniform_heating_is_the_classical_series_at_any_stiffness(biot):
    sphere = heated_uniformly(biot)
    for fourier in (2e-3, 0.03, 0.5, 2.0):
        left, rate = series(biot, fourier)
        assert abs(mpmath.mpf(float(sphere.heat_rate(fourier))) / rate - 1) < 1e-10
        assert abs(mpmath.mpf(float(sphere.mean_temperature(fourier))) / (1 - left) - 1) < 1e-10


def test_slow_time_of_a_particle_that_hardly_resists():
    # at Bi = 1e-6 heating takes 3e5 times as long as conduction inside
    sphere = heated_uniformly(1e-6)
    for times in (0.1, 1.0, 10.0):
        _, rate = series(1e-6, times * sphere.time_constant)
        assert abs(mpmath.mpf(float(sphere.heat_rate(times * sphere.time_constant))) / rate - 1) < 1e-10
    slowest = mpmath.findroot(lambda z: z * mpmath.cos(z) - (1 - mpmath.mpf(1e-6)) * mpmath.sin(z), 1.732e-3) ** 2
    assert abs(sphere.decay_rates[0] / slowest - 1) < 1e-13


def test_uniform_heating_converges_faster_than_any_power_of_the_functions():
    _, rate = series(30.0, 2e-3)
    errors = [abs(float(heated_uniformly(30.0, n).heat_rate(2e-3) / rate) - 1) for n in (4, 8, 16)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.diff(orders) > 0)
    assert orders[-1] > 10


@functools.cache
def literal_matrices(delta, s, modes, radial):
    """Coupling at Bi = 1, stiffness and roots of the mass of the same Galerkin equations, by quadrature."""
    with mpmath.workdps(30):
        delta, s = mpmath.mpf(delta), mpmath.mpf(s)
        c, outer = 1 + delta, mpmath.mpf(1.4) ** 2 - (1 + delta) ** 2
        u_o, u_i = mpmath.sqrt(1 - outer), min(c - s, mpmath.mpf(1))
        pieces = sorted({u_o, u_i, mpmath.mpf(1)})
        pieces = [u_o, *(c - (c - u_o) / 4**n for n in range(1, 6) if c - (c - u_o) / 4**n < u_i), *pieces[1:]]

        def over_lens(f):
            return mpmath.quad(lambda mu: mu * f(mu) / max(c - mu, s), pieces)

        gas = (outer - (1 - u_i**2)) / 2 / over_lens(lambda mu: 1)
        C = mpmath.matrix(modes, modes)
        for i in range(modes):
            for j in range(i + 1):
                product = over_lens(lambda mu, i=i, j=j: mpmath.legendre(i, mu) * mpmath.legendre(j, mu))
                C[i, j] = C[j, i] = gas * product

        def function(deg, k, r):
            return r**deg * mpmath.jacobi(k, 0, deg + mpmath.mpf("0.5"), 2 * r * r - 1)

        n = modes * radial
        A, roots = (mpmath.matrix(n, n), mpmath.matrix(n, n)), []
        for i in range(n):
            deg, k = divmod(i, radial)
            norm = mpmath.quad(lambda r, deg=deg, k=k: r * r * function(deg, k, r) ** 2, [0, 1])
            roots.append(mpmath.sqrt(2 * norm / (2 * deg + 1)))
        for i in range(n):
            for j in range(n):
                (deg, k), (other, q) = divmod(i, radial), divmod(j, radial)
                A[0][i, j] = C[deg, other] / (roots[i] * roots[j])
                if deg == other:

                    def gradients(r, deg=deg, k=k, q=q):
                        a, b = (mpmath.diff(lambda x, p=p, deg=deg: function(deg, p, x), r) for p in (k, q))
                        return r * r * a * b + deg * (deg + 1) * function(deg, k, r) * function(deg, q, r)

                    stiffness = mpmath.quad(gradients, [0, 1]) * 2 / mpmath.mpf(2 * deg + 1)
                    A[1][i, j] = stiffness / (roots[i] * roots[j])
        return A


def literal(biot, delta, s, modes, radial):
    """Rates and weights of the parts from those matrices, in 30 digits."""
    with mpmath.workdps(30):
        coupling, stiffness = literal_matrices(delta, s, modes, radial)
        rates, vectors = mpmath.eigsy(mpmath.mpf(biot) * coupling + stiffness)
        return rates, [vectors[0, j] ** 2 for j in range(len(rates))]


@pytest.mark.parametrize("biot", [1e-6, 0.35, 1e3])
def test_lens_against_a_literal_evaluation_in_many_digits(biot):
    rates, weights = literal(biot, 0.01, 0.02, 3, 2)
    found = heated_through_lens(biot, 0.01, 0.02, modes=3, radial=2)
    for fourier in (0.0, 1e-3, 0.1, 1.0, found.time_constant):
        with mpmath.workdps(30):
            parts = [w * mpmath.exp(-x * fourier) for x, w in zip(rates, weights, strict=True)]
            rate = 4 * mpmath.pi / 3 * sum(x * part for x, part in zip(rates, parts, strict=True))
            mean = 1 - sum(parts)
            assert abs(mpmath.mpf(float(found.heat_rate(fourier))) / rate - 1) < 1e-10
            if fourier:
                assert abs(mpmath.mpf(float(found.mean_temperature(fourier))) / mean - 1) < 1e-10


class FiniteVolumes:
    """The sphere in cells of radius and angle, the angle finer towards the wall; second order, nothing shared."""

    def __init__(self, biot, delta, s, n):
        r = np.linspace(0, 1, n + 1)
        theta = math.pi * np.expm1(4.0 * np.linspace(0, 1, 2 * n + 1)) / math.expm1(4.0)
        mu = np.cos(theta)
        centre_r, centre = 0.5 * (r[1:] + r[:-1]), 0.5 * (theta[1:] + theta[:-1])
        band = -np.diff(mu)
        self.volume = np.outer(np.diff(r**3) / 3, band)
        index = np.arange(self.volume.size).reshape(self.volume.shape)
        radially = np.outer(r[1:-1] ** 2 / np.diff(centre_r), band)
        around = np.outer(np.diff(r), np.sin(theta[1:-1]) / np.diff(centre))
        left = np.concatenate([index[:-1].ravel(), index[:, :-1].ravel()])
        right = np.concatenate([index[1:].ravel(), index[:, 1:].ravel()])
        g = np.concatenate([radially.ravel(), around.ravel()])
        # conductance of the lens over each band, in the closed form of the local gap; the flat cap apart
        c, outer = 1 + delta, 1.4**2 - (1 + delta) ** 2
        u_o, u_i = math.sqrt(1 - outer), min(c - s, 1.0)

        def upto(u):
            straight = np.clip(u, u_o, u_i)
            return -straight - c * np.log(c - straight) + (np.clip(u, u_i, 1.0) ** 2 - u_i**2) / (2 * max(s, delta))

        lens = -np.diff(upto(mu))
        gas = biot * (outer - (1 - u_i**2)) / 2 / lens.sum()
        half_cell = band / (1 - centre_r[-1])
        self.lens = 1 / (1 / np.maximum(gas * lens, 1e-300) + 1 / half_cell)
        self.isothermal = gas * lens.sum()
        n_all = index.size
        diagonal = np.bincount(left, g, n_all) + np.bincount(right, g, n_all)
        diagonal[index[-1]] += self.lens
        self.surface = index[-1]
        self.matrix = sparse.diags(diagonal) - sparse.coo_matrix((g, (left, right)), (n_all, n_all))
        self.matrix = (self.matrix - sparse.coo_matrix((g, (right, left)), (n_all, n_all))).tocsc()

    def lasting(self):
        """Slowest rate times volume, over the isothermal conductance, by inverse iteration."""
        solve, mass = sparse_linalg.splu(self.matrix).solve, self.volume.ravel()
        x = np.ones(mass.size)
        for _ in range(12):
            x = solve(mass * x)
            x /= np.sqrt(mass @ x**2)
        return float(x @ (self.matrix @ x)) * 2 / 3 / self.isothermal

    def error(self):
        """Eq. 14, by a stiff integrator in the square root of time."""
        mass, tau = self.volume.ravel(), 2 / 3 / self.isothermal
        operator = sparse.diags(-1 / mass) @ self.matrix

        def slope(v, y):
            return np.append(2 * v * tau * (operator @ y[:-1]), 2 * v * math.exp(v * v) * (self.lens @ y[self.surface]))

        def jacobian(v, y):
            row = sparse.csr_matrix(
                (2 * v * math.exp(v * v) * self.lens, (0 * self.surface, self.surface)), (1, y.size - 1)
            )
            return sparse.bmat([[2 * v * tau * operator, None], [row, sparse.csr_matrix((1, 1))]]).tocsc()

        start = np.append(np.ones(mass.size), 0.0)
        run = integrate.solve_ivp(slope, (0, 1), start, method="BDF", jac=jacobian, rtol=1e-5, atol=1e-7)
        return 1 - run.y[-1, -1] / self.isothermal


def test_lens_against_finite_volumes_of_second_order():
    wanted = heated_through_lens(0.35, S, S, modes=160, radial=6)
    ratio = wanted.lasting_conductance / wanted.conductance
    errors = np.array([abs(FiniteVolumes(0.35, S, S, n).lasting() - ratio) for n in (10, 20, 40)])
    assert errors[-1] < 3e-3 * ratio
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all((orders > 1.5) & (orders < 2.6))


def test_isothermal_error_against_finite_volumes_and_a_stiff_integrator():
    for biot in (0.015, 0.35):
        spectral = isothermal_error(heated_through_lens(biot, S, S))
        coarse, fine = (FiniteVolumes(biot, S, S, n).error() for n in (10, 20))
        assert spectral == pytest.approx(fine + (fine - coarse) / 3, rel=0.01)


def test_convergence_in_the_modes():
    """The lens has a kink where it begins and a jump where it ends: errors fall with a power of the modes."""
    modes = np.array([8, 16, 32, 64])
    values = np.array([isothermal_error(heated_through_lens(1.0, 0.01, 0.02, modes=n, radial=6)) for n in modes])
    best = isothermal_error(heated_through_lens(1.0, 0.01, 0.02, modes=160, radial=6))
    errors = np.abs(values - best)
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all(orders > 2.5)
    assert errors[-1] < 1e-6


def test_few_resistances_inside_leave_the_lumped_exponential():
    particle = heated_through_lens(1e-6, S, S, modes=60)
    t = np.array([0.01, 0.3, 1.0, 5.0]) * particle.time_constant
    assert particle.heat_rate(t) == pytest.approx(particle.isothermal_heat_rate(t), rel=2e-5)
    assert particle.mean_temperature(t) == pytest.approx(-np.expm1(-t / particle.time_constant), rel=2e-5)


@pytest.mark.parametrize("biot", [1e-6, 0.015, 0.35, 1e3])
def test_energy(biot):
    particle = heated_through_lens(biot, S, S, modes=60)
    # at the start the whole sphere is at one temperature, whatever its Biot number
    assert particle.heat_rate(0.0) == pytest.approx(particle.conductance, rel=1e-10)
    assert particle.weights.sum() == pytest.approx(1.0, rel=1e-13)
    # heat that came in is heat that is in there
    tau = particle.time_constant
    came = integrate.quad(lambda v: 2 * v * particle.heat_rate(v * v * tau) * tau, 0, 1, epsrel=1e-9)[0]
    assert came == pytest.approx(4 * math.pi / 3 * particle.mean_temperature(tau), rel=1e-8)
    # and the heat through the lens is that of the local gap at the local surface temperature
    if biot < 1:
        x, w = np.polynomial.legendre.leggauss(60)
        c = 1 + S
        gap = np.exp(np.linspace(math.log(S), math.log(c - math.sqrt(1 - (1.4**2 - c**2))), 9))
        local = 0.5 * (gap[1:] + gap[:-1])[:, None] + 0.5 * np.diff(gap)[:, None] * x
        mu, weight = (c - local).ravel(), (0.5 * np.diff(gap)[:, None] * w / local).ravel()
        H = 2 * math.pi * np.sum(weight * mu)
        surface = particle.temperature(tau, 1.0, mu)
        assert particle.conductance / H * 2 * math.pi * np.sum(weight * mu * (1 - surface)) == pytest.approx(
            particle.heat_rate(tau), rel=1e-6
        )


def test_temperature_inside():
    particle = heated_through_lens(0.35, S, S)
    tau = particle.time_constant
    r, w = np.polynomial.legendre.leggauss(30)
    radius, mu = np.meshgrid(0.5 * (r + 1), r)
    volume = np.outer(w, 0.5 * w * (0.5 * (r + 1)) ** 2)
    inside = particle.temperature(tau, radius, mu)
    assert np.sum(volume * inside) / np.sum(volume) == pytest.approx(particle.mean_temperature(tau), abs=2e-4)
    down = particle.temperature(tau, 1.0, np.array([1.0, 0.9, 0.5, 0.0, -1.0]))
    assert np.all(np.diff(down) < 0)
    assert particle.temperature(0.0, [0.0, 0.5], [1.0, -0.3]) == pytest.approx(0.0, abs=1e-12)
    assert particle.temperature(60 * tau, 0.3, 0.3) == pytest.approx(1.0, abs=1e-10)
    # glass of 500 um at t* = 1 spans 25 K of the 50 between wall and start, steel (Bi 0.01) 1.6 K
    steel = heated_through_lens(0.01, S, S)
    span = [50 * float(np.ptp(x.temperature(x.time_constant, 1.0, [1.0, -1.0]))) for x in (particle, steel)]
    assert span == pytest.approx([24.8, 1.4], abs=0.1)


def test_error_of_the_isothermal_particle_against_the_source():
    """Adepu et al. give 10 % at Bi = 0.015; eq. 14 gives 2 % there, and no reading gives more than 5 %."""
    glass = heated_through_lens(0.35, S, S)
    near_limit = heated_through_lens(0.015, S, S)
    measures = ("rate", "heat", "resistance")
    assert [isothermal_error(near_limit, m) for m in measures] == pytest.approx([0.0215, 0.0248, 0.0418], abs=1e-4)
    assert [isothermal_error(glass, m) for m in measures] == pytest.approx([0.2864, 0.3086, 0.4300], abs=1e-4)
    assert critical_biot(0.1, S, S, modes=80) == pytest.approx(0.0804, abs=1e-4)
    assert critical_biot(0.1, S, S, "resistance", modes=80) == pytest.approx(0.0394, abs=1e-4)
    # a constant for the resistance inside: eq. 14 sees half of it, since the colder particle goes on drawing heat
    small = [isothermal_error(heated_through_lens(1e-4, S, S, modes=40), m) for m in measures]
    assert small[0] == pytest.approx(small[2] / 2, rel=1e-3)
    assert small[1] == pytest.approx(small[2] / math.expm1(1.0), rel=1e-3)


def test_resistance_inside_is_that_of_the_lens_flux_on_a_half_insulated_sphere():
    """For Bi -> 0 the flux is that of the isothermal lens; the constriction follows from its Legendre moments."""
    biot, modes = 1e-5, 60
    coupling = particle_transient._lens_coupling(0.01, 0.02, 1.4, 0.0, modes)
    found = heated_through_lens(biot, 0.01, 0.02, modes=modes)
    l = np.arange(1, modes)  # noqa: E741
    # a flux P_l (moment b_l) at the surface of a sphere raises it by b_l (2l + 1)/(2 l) P_l
    constriction = np.sum((2 * l + 1) / (2 * l) * coupling[0, 1:] ** 2) / coupling[0, 0] ** 2 / (2 * math.pi)
    # and the mean of the sphere lags behind the mean of its surface by a fifth of the mean gradient
    constriction += 1 / (20 * math.pi)
    assert isothermal_error(found, "resistance") == pytest.approx(found.conductance * constriction, rel=1e-3)


@pytest.mark.parametrize("measure", ["rate", "heat", "resistance"])
def test_critical_biot_gives_its_error(measure):
    biot = critical_biot(0.2, 0.01, 0.02, measure, modes=30)
    assert isothermal_error(heated_through_lens(biot, 0.01, 0.02, modes=30), measure) == pytest.approx(0.2, rel=1e-5)


def test_error_grows_with_the_biot_number_and_smooth_contacts():
    biots = np.logspace(-4, 2, 7)
    errors = [isothermal_error(heated_through_lens(b, 0.01, 0.02, modes=20)) for b in biots]
    assert np.all(np.diff(errors) > 0)
    smoother = [isothermal_error(heated_through_lens(0.1, s, s, modes=80)) for s in (1e-2, 1e-3, 1e-4)]
    assert np.all(np.diff(smoother) > 0)


def test_no_contact_particle_and_free_path():
    far = heated_through_lens(0.1, 0.2, S, modes=20)
    # Bi times the area of the lens
    assert far.conductance == pytest.approx(0.1 * math.pi * (1.4**2 - 1.2**2), rel=1e-12)
    with_jump = heated_through_lens(0.1, 0.0, 1e-4, free_path=1e-2, modes=60)
    assert isothermal_error(with_jump) < isothermal_error(heated_through_lens(0.1, 0.0, 1e-4, modes=60))
    area = float(fluid_lens.lens_area(2.0, 0.0, 1e-4))
    assert with_jump.conductance == pytest.approx(0.1 * area, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"biot": 0.0}, "biot is 0"),
        ({"biot": np.inf}, "biot is inf"),
        ({"gap": 0.5}, r"gap is 0\.5 particle radii; expected less than lens_radius - 1 = 0\.4"),
        ({"gap": -0.1}, r"gap is -0\.1"),
        ({"modes": 0}, "modes is 0; expected a whole number from 1 to 1000"),
        ({"radial": 2.5}, r"radial is 2\.5; expected a whole number"),
        ({"asperity": 0.0, "gap": 0.0}, "asperity and free_path are both 0"),
    ],
)
def test_refusals(change, message):
    with pytest.raises(ValueError, match=message):
        heated_through_lens(**{"biot": 0.1, "gap": S, "asperity": S, **change})


def test_refusals_of_the_result():
    particle = heated_through_lens(0.1, 0.01, 0.02, modes=5, radial=3)
    with pytest.raises(ValueError, match="measure is 'mean'; expected one of rate, heat, resistance"):
        isothermal_error(particle, "mean")
    with pytest.raises(ValueError, match=r"radius is 1\.5"):
        particle.temperature(1.0, 1.5, 0.0)
    with pytest.raises(ValueError, match=r"fourier has shape \(2,\)"):
        particle.temperature([1.0, 2.0], 0.5, 0.0)
    with pytest.raises(ValueError, match="fourier is -1"):
        particle.heat_rate(-1.0)
    with pytest.raises(ValueError, match="error is 2"):
        critical_biot(2.0, 0.01, 0.02)
    assert "5 Legendre modes" in str(particle)
