import mpmath
import numpy as np
import pytest
from scipy.integrate import quad

from bedrad.heat import bulk, single_particle, wall_layer, wall_models

RATIOS = [1.0, 1 + 1e-12, 1 + 1e-9, 1 + 1e-4, 1.05, 2.0, 10.0, 70.0, 1e3, 1e6, 1e12]


def test_reference_of_schluender():
    # d 0.3 mm, l 136 nm, k_g 0.03
    value = wall_models.schluender_particle_coefficient(0.03, 0.3e-3, 1.36e-7)
    assert value == pytest.approx(2405.19785, rel=2e-9)
    assert wall_models.schluender_coefficient(0.03, 0.3e-3, 1.36e-7) == pytest.approx(0.8 * value, rel=1e-15)


@pytest.mark.parametrize("q", [1e-300, 1e-12, 1e-6, 1e-3, 0.5, 1.0, 3.999, 4.001, 10.0, 1e3, 1e12, 1e300])
def test_schluender_from_no_gap_to_no_particle(q):
    with mpmath.workdps(700):
        exact = (1 + mpmath.mpf(q)) * mpmath.log(1 + 1 / mpmath.mpf(q)) - 1
    # 4 k_g/d = 1
    assert abs(wall_models.schluender_particle_coefficient(0.25, 1.0, 0.5 * q) / exact - 1) < 2e-14


def test_schluender_is_the_mean_over_the_projected_sphere():
    gas, d, gap = 0.03, 1e-3, 4e-6
    r = d / 2
    flux = quad(lambda u: 2 * gas * u / (r * (1 - u) + gap), 0, 1, epsrel=1e-12)[0]
    assert wall_models.schluender_particle_coefficient(gas, d, 1e-6, 3e-6) == pytest.approx(flux, rel=1e-10)
    # roughness and free path only count together
    assert wall_models.schluender_particle_coefficient(gas, d, 4e-6) == pytest.approx(flux, rel=1e-10)


@pytest.mark.parametrize("K", [1 + 1e-6, 2.0, 70.0, 1e12])
def test_a_solid_resists_like_a_gap_of_one_in_k_less_one(K):
    # Watkins' k_C and Schluender's alpha_WP are one integral
    alpha = wall_models.schluender_particle_coefficient(1.0, 2.0, 1 / (K - 1))
    assert single_particle.particle_conductivity(K) == pytest.approx(K / (K - 1) * alpha, rel=1e-9 if K < 2 else 1e-13)


@pytest.mark.parametrize("K", RATIOS)
def test_film_of_ofuchi_and_kunii(K):
    with mpmath.workdps(60):
        k = mpmath.mpf(K)
        x = (k - 1) / k
        film = mpmath.mpf(1) / 6 if K == 1 else x**2 / (4 * (mpmath.log(k) - x)) - 1 / (3 * k)
        conductivity = mpmath.mpf("0.4") + mpmath.mpf("0.6") / (2 * film + 2 / (3 * k))
    assert abs(wall_models.ofuchi_kunii_film_thickness(K) / film - 1) < 2e-15
    assert abs(wall_models.ofuchi_kunii_conductivity(1.0, K, 0.4) / conductivity - 1) < 2e-15


def test_film_is_half_of_that_between_two_spheres():
    # Kunii and Smith 1960 with the contact taken over the whole half sphere
    K, cosine = 70.0, 0.0
    bracket = np.log(K - (K - 1) * cosine) - (K - 1) / K * (1 - cosine)
    between = 0.5 * ((K - 1) / K) ** 2 / bracket - 2 / (3 * K)
    assert wall_models.ofuchi_kunii_film_thickness(K) == pytest.approx(0.5 * between, rel=1e-14)


def test_ofuchi_and_kunii_is_the_flat_form_with_all_particles_in_contact():
    K = np.array([2.0, 70.0, 1000.0])
    fraction = 0.42
    d, A = 6e-4, 1e9
    flat = wall_layer.conductivity(0.03, 0.03 * K, A, d, 0.0, fraction, 0.0, form="flat")
    covered = 1.5 * fraction * (1 - 0.5 / A)
    assert wall_models.ofuchi_kunii_conductivity(0.03, 0.03 * K, 1 - covered) == pytest.approx(flat, rel=1e-13)
    # taken with the porosity instead, it gives less: the half sphere covers more wall than it fills of the layer
    assert np.all(wall_models.ofuchi_kunii_conductivity(0.03, 0.03 * K, 1 - fraction) < flat)


@pytest.mark.parametrize("K", [1e-12, 0.5, 1 - 1e-9, 1.0, 1 + 1e-9, 1e12])
def test_conductivity_holds_on_both_sides_of_one(K):
    with mpmath.workdps(60):
        k = mpmath.mpf(K)
        factor = mpmath.mpf(1) / 2 if K == 1 else (k / (k - 1)) ** 2 * (mpmath.log(k) - (k - 1) / k)
        exact = mpmath.mpf("0.25") + mpmath.mpf("0.75") * 2 * factor
    assert abs(wall_models.ofuchi_kunii_conductivity(1.0, K, 0.25) / exact - 1) < 1e-14


def test_yagi_and_kunii_put_the_excess_resistance_of_the_layer_into_the_wall():
    layer, k_e, d = 0.12, 0.30, 5e-4
    h = wall_models.yagi_kunii_coefficient(layer, k_e, d)
    # wall and half a diameter of bulk in series resist as the layer does
    assert 1 / h + 0.5 * d / k_e == pytest.approx(0.5 * d / layer, rel=1e-14)
    assert h > wall_models.layer_coefficient(layer, d)
    assert wall_models.yagi_kunii_coefficient(0.3, [0.3, 0.6], 1e-3).tolist() == [np.inf, pytest.approx(1200.0)]
    with mpmath.workdps(40):
        near = 0.3 * (1 + 1e-12)
        exact = 2 / (mpmath.mpf(1e-3) * (1 / mpmath.mpf(0.3) - 1 / mpmath.mpf(near)))
    assert wall_models.yagi_kunii_coefficient(0.3, near, 1e-3) == pytest.approx(float(exact), rel=1e-14)


def test_layers_and_coefficients_turn_into_each_other():
    d = 3e-4
    assert wall_models.layer_coefficient(0.12, d) == pytest.approx(2 * 0.12 / d, rel=1e-15)
    A = np.array([1 + 1e-12, 2.0, 12.9, 1e6, 1e300, np.inf])
    h = wall_models.layer_coefficient(0.12, d, A)
    assert wall_models.layer_conductivity(h, d, A) == pytest.approx(0.12, rel=1e-14)
    for ratio, value in zip(A[:4].tolist(), h.tolist(), strict=False):
        with mpmath.workdps(40):
            exact = mpmath.mpf(0.12) / (mpmath.mpf(ratio) * d / 2 * mpmath.log(ratio / (mpmath.mpf(ratio) - 1)))
        assert value == pytest.approx(float(exact), rel=1e-13)
    assert h[4] == h[5] == wall_models.layer_coefficient(0.12, d)


def test_arrays_broadcast_and_numbers_stay_numbers():
    T = np.array([300.0, 800.0])
    path = bulk.modified_free_path(T, 0.03)
    assert wall_models.schluender_coefficient(0.03, [[3e-4], [6e-4]], path).shape == (2, 2)
    assert np.ndim(wall_models.schluender_particle_coefficient(0.03, 3e-4, 1e-7)) == 0
    assert np.ndim(wall_models.ofuchi_kunii_conductivity(0.03, 2.1, 0.4)) == 0
    # a longer free path insulates
    assert np.all(np.diff(wall_models.schluender_coefficient(0.03, 3e-4, path)) < 0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: wall_models.schluender_particle_coefficient(0.03, 3e-4, 0.0),
            "free_path .* is 0; expected a positive",
        ),
        (lambda: wall_models.schluender_particle_coefficient(0.03, 3e-4, -1e-7), "free_path is -1e-07 m"),
        (lambda: wall_models.schluender_coefficient(0.03, 3e-4, 1e-7, coverage=1.2), "coverage is 1.2"),
        (lambda: wall_models.ofuchi_kunii_film_thickness(0.5), "K .* is 0.5; expected at least 1"),
        (lambda: wall_models.ofuchi_kunii_conductivity(0.03, 2.1, 1.2), "porosity is 1.2"),
        (
            lambda: wall_models.yagi_kunii_coefficient(0.4, 0.3, 1e-3),
            "layer_conductivity is 0.4 .* above the bulk's 0.3",
        ),
        (lambda: wall_models.layer_coefficient(0.1, 1e-3, 1.0), "diameter_ratio is 1; expected more than 1"),
        (lambda: wall_models.layer_conductivity(-1.0, 1e-3), "coefficient is -1"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
