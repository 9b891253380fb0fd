import math

import mpmath
import numpy as np
import pytest

from bedrad.heat import block_and_bed as bed


def erfcx(z):
    """exp(z^2) erfc(z), by its asymptotic series where erfc would need thousands of digits."""
    z = mpmath.mpmathify(z)
    if abs(z) < 60:
        return mpmath.exp(z * z) * mpmath.erfc(z)
    return sum((-1) ** n * mpmath.fac2(2 * n - 1) / (2 * z * z) ** n for n in range(40)) / (z * mpmath.sqrt(mpmath.pi))


def two_roots(total, product):
    """Drop and flux of the lumped block from its two roots, in 80 digits."""
    with mpmath.workdps(80):
        total, product = mpmath.mpf(total), mpmath.mpf(product)
        root = mpmath.sqrt(total * total / 4 - product)
        if root == 0:
            root = mpmath.mpf(10) ** -30
        a = total / 2 + root
        b = product / a
        left = (b * erfcx(a) - a * erfcx(b)) / (b - a)
        return mpmath.re(1 - left), mpmath.re((b * erfcx(b) - a * erfcx(a)) / (b - a))


# B = h sqrt(t)/e from 1e-8 to 1e6, and the ratio of h t/m to the square of half of it, at which the roots meet
NUMBERS = [1e-8, 1e-3, 0.3, 1.0, 2.0, 8.27, 60.0, 1e3, 1e6]
RATIOS = [1e-12, 1e-6, 0.1, 0.9, 1 - 1e-4, 1 - 1e-6, 1 - 1e-9, 1.0, 1 + 1e-9, 1 + 1e-6, 1 + 1e-5, 1.1, 1.9]


@pytest.mark.parametrize("number", NUMBERS)
def test_lumped_block_from_double_to_distant_roots(number):
    for ratio in RATIOS:
        m = number / (number * number / 4 * ratio)
        exact = two_roots(number, number / m)
        found = bed.lumped_block_drop(1.0, number, m, 1.0), bed.lumped_block_flux(1.0, number, m, 1.0)
        for value, wanted in zip(found, exact, strict=True):
            assert abs(mpmath.mpf(float(value)) / wanted - 1) < 1e-10


@pytest.mark.parametrize(("number", "product"), [(0.01, 0.5), (0.1, 3.0), (1.0, 40.0), (1e-4, 1.5), (0.5, 600.0)])
def test_lumped_block_that_its_contact_drains_faster_than_the_bed_fills(number, product):
    exact = two_roots(number, product)
    m = number / product
    assert abs(mpmath.mpf(float(bed.lumped_block_drop(1.0, number, m, 1.0))) / exact[0] - 1) < 1e-10
    assert abs(mpmath.mpf(float(bed.lumped_block_flux(1.0, number, m, 1.0))) / exact[1] - 1) < 1e-10


def test_lumped_block_against_the_inverse_transform_as_a_real_integral():
    # around the branch cut of 1/(p + (h/e) sqrt(p) + h/m): the integrand is positive, so the flux only falls
    h, m, e = 800.0, 3000.0, 450.0
    for t in (0.1, 2.0, 60.0):
        with mpmath.workdps(20):

            def cut(v, t=t):
                return 2 * v * v * h / e * mpmath.exp(-v * v * t) / ((h / m - v * v) ** 2 + (h * v / e) ** 2)

            expected = mpmath.quad(cut, [0, 0.1, 0.5, 1, 3, 10, 40]) / mpmath.pi
        assert bed.lumped_block_flux(t, h, m, e) == pytest.approx(float(expected), rel=1e-9)


def test_lumped_block_loses_what_flows():
    h, m, e = 800.0, 3000.0, 450.0
    t, w = np.polynomial.legendre.leggauss(60)
    v = 0.5 * (t + 1)
    lost = np.sum(0.5 * w * 2 * v * 20.0 * bed.lumped_block_flux(20.0 * v * v, h, m, e)) * h / m
    assert bed.lumped_block_drop(20.0, h, m, e) == pytest.approx(lost, rel=1e-10)


def test_limits_of_the_lumped_block():
    t = np.array([0.0, 0.5, 3.0, 40.0])
    # bed that keeps its temperature: Newton's cooling
    assert bed.lumped_block_drop(t, 20.0, 30.0, math.inf) == pytest.approx(-np.expm1(-t * 20 / 30), rel=1e-12)
    assert bed.lumped_block_flux(t, 20.0, 30.0, math.inf) == pytest.approx(np.exp(-t * 20 / 30), abs=1e-14)
    # block that keeps its temperature: half-space with a contact coefficient
    assert np.all(bed.lumped_block_drop(t, 20.0, math.inf, 40.0) == 0.0)
    assert bed.lumped_block_flux(t, 20.0, math.inf, 40.0) == pytest.approx(
        bed.contact_flux(t, 20.0, math.inf, 40.0), rel=1e-12
    )
    # at once: h t/m of the difference
    assert bed.lumped_block_drop(1e-14, 20.0, 30.0, 40.0) == pytest.approx(1e-14 * 20 / 30, rel=1e-6)


@pytest.mark.parametrize("B", [0.0, 1e-9, 1e-3, 1.0, 30.0, 1e3, 1e6])
def test_contact_flux(B):
    wanted = erfcx(mpmath.mpf(B))
    assert abs(mpmath.mpf(float(bed.contact_flux(B * B, 1.0, 2.0, 2.0))) / wanted - 1) < 1e-13


@pytest.mark.parametrize("xi", [0.0, 1e-9, 1e-3, 0.5, 3.0, 12.0])
def test_half_space_drop_keeps_its_digits(xi):
    for B in (1e-12, 1e-6, 0.01, 0.49, 0.51, 3.0, 100.0, 1e6):
        with mpmath.workdps(60):
            x = mpmath.mpf(xi)
            wanted = (mpmath.erfc(x) - mpmath.exp(-x * x) * erfcx(x + mpmath.mpf(B))) / 4
        # block three times as effusive as the bed, diffusivity 1, time 1
        found = bed.half_space_drop(1.0, 2 * xi, B / (1 / 3 + 1), 3.0, 1.0, 1.0)
        assert abs(mpmath.mpf(float(found)) / wanted - 1) < 1e-12


def test_half_space_drop_solves_the_heat_equation_and_its_contact():
    h, block, cold, alpha = 900.0, 20000.0, 460.0, 6.9e-5
    t, z = 0.7, 3e-3

    def drop(time, depth):
        return float(bed.half_space_drop(time, depth, h, block, cold, alpha))

    in_time = (drop(t + 1e-4, z) - drop(t - 1e-4, z)) / 2e-4
    in_space = (drop(t, z + 1e-5) - 2 * drop(t, z) + drop(t, z - 1e-5)) / 1e-10
    assert in_time == pytest.approx(alpha * in_space, rel=1e-4)
    # flux into the bed leaves the block: k d(drop)/dz = -h flux, k = e sqrt(alpha)
    slope = (-3 * drop(t, 0) + 4 * drop(t, 1e-6) - drop(t, 2e-6)) / 2e-6
    flux = float(bed.contact_flux(t, h, block, cold))
    assert -block * math.sqrt(alpha) * slope == pytest.approx(h * flux, rel=1e-5)
    # and over the contact: the two faces differ by flux over h
    assert 1 - drop(t, 0) - drop(t, 0) * block / cold == pytest.approx(flux, rel=1e-12)


def test_extremes_give_no_warning_and_no_nan():
    t = np.array([0.0, 1e-300, 1e-10, 1.0, 1e10, 1e30])
    for e in (1e-6, 1.0, 1e12, math.inf):
        for m in (1e-12, 1.0, 1e12, math.inf):
            drop, flux = (f(t, 1e3, m, e) for f in (bed.lumped_block_drop, bed.lumped_block_flux))
            assert np.all((drop >= 0) & (drop <= 1))
            assert np.all((flux >= 0) & (flux <= 1))
            assert np.all(np.diff(drop) >= -1e-15)
    assert np.all(np.isfinite(bed.half_space_drop(t, [[0.0], [1e-3], [1e3]], 1e6, 1.0, 1e-3, 1e-7)))


def test_effusivity_and_shapes():
    assert bed.effusivity(167.0, 2700.0, 896.0) == pytest.approx(20099.9, abs=0.1)
    assert np.ndim(bed.lumped_block_drop(1.0, 1.0, 1.0, 1.0)) == 0
    assert bed.lumped_block_flux(np.ones((2, 1)), np.ones(3), 1.0, 1.0).shape == (2, 3)
    assert bed.half_space_drop(np.ones((2, 1)), np.ones(3), 1.0, 1.0, 1.0, 1.0).shape == (2, 3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: bed.contact_flux(-1.0, 1.0, 1.0, 1.0), "time is -1 s"),
        (lambda: bed.contact_flux(1.0, 0.0, 1.0, 1.0), "coefficient is 0 W"),
        (lambda: bed.half_space_drop(1.0, -1.0, 1.0, 1.0, 1.0, 1.0), "depth is -1 m"),
        (lambda: bed.half_space_drop(1.0, 1.0, 1.0, math.inf, 1.0, 1.0), "block_effusivity is inf"),
        (lambda: bed.half_space_drop(1.0, 1.0, 1.0, 1.0, 1.0, 0.0), "block_diffusivity is 0 m2/s"),
        (lambda: bed.lumped_block_drop(1.0, 1.0, -1.0, 1.0), "heat_capacity is -1 J"),
        (lambda: bed.lumped_block_flux(1.0, 1.0, 1.0, np.nan), "bed_effusivity is nan"),
        (lambda: bed.effusivity(1.0, 0.0, 1.0), "density is 0 kg/m3"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
