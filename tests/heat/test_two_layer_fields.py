import numpy as np
import pytest

from bedrad.heat import two_layer
from bedrad.heat.two_layer_fields import largest_amplitude
from bedrad.heat.two_layer_modes import find_modes, layers

FLOW = {
    "heat_flux": 5e3,
    "tube_diameter": 8e-3,
    "particle_diameter": 3e-4,
    "velocity": 0.05,
    "bulk_conductivity": 0.3,
    "wall_layer_conductivity": 0.12,
    "density": 2300.0,
    "specific_heat": 700.0,
    "inlet_temperature": 300.0,
}


def panels(A):
    """Radii and weights of r dr: Gauss' rule on panels that narrow towards interface and wall."""
    W, fine = 1 - 1 / A, 10.0 ** np.linspace(-7, 0, 15)
    edges = np.unique(np.concatenate([[0.0, 1.0], W * (1 - fine), W + (1 - W) * fine, 1 - (1 - W) * fine, [W]]))
    x, w = np.polynomial.legendre.leggauss(20)
    half = 0.5 * np.diff(edges)[:, None]
    r = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * x
    return r.ravel(), (half * w * r).ravel()


@pytest.mark.parametrize(("A", "kappa"), [(28.2, 2.5), (1.01, 1e-4), (3.0, 1e4), (1e3, 1e4), (2.0, 1e-4)])
def test_mean_of_the_field_is_the_energy_balance(A, kappa):
    """2 int r theta dr = 4 z*, linear along the tube, by series and by transform."""
    r, weight = panels(A)
    for z_star in (1e-6, 1e-4, 1e-2, 0.1, 1.0, 1e3):
        field = two_layer.temperature_rise(r, A, kappa, z_star)
        scale = max(4 * z_star, 1e-4 * two_layer.temperature_rise(1.0, A, kappa, z_star))
        assert 2 * weight @ field == pytest.approx(4 * z_star, abs=1e-10 * scale)


def test_wall_less_mean_is_one_over_nusselt():
    A, kappa = np.array([1.1, 28.2, 1e4])[:, None, None], np.array([1e-3, 2.5, 1e3])[:, None]
    z_star = np.array([1e-7, 1e-4, 0.01, 0.1, 2.0])
    wall = two_layer.temperature_rise(1.0, A, kappa, z_star)
    assert wall - 4 * z_star == pytest.approx(1 / two_layer.nusselt(A, kappa, z_star), rel=1e-9)


def test_developed_field_as_printed():
    """W(69), (70) with their constants, over q D/k_b."""
    A, kappa, z = 5.0, 3.0, 10.0
    W, r = 1 - 1 / A, np.linspace(0, 1, 21)
    bulk = r**2 / 2 - W**2 / 2 * (W**2 / 2 - 1) * (kappa - 1) - kappa / 4
    layer = kappa * r**2 / 2 - W**4 / 4 * (kappa - 1) - kappa / 4
    printed = 4 * z + 0.5 * np.where(r <= W, bulk, layer)
    assert two_layer.temperature_rise(r, A, kappa, z) == pytest.approx(printed, rel=1e-14)


def test_solves_the_energy_equation():
    """dT/dz* over 4 equals the divergence of k dT/dr/D^2; flux and value continuous at W, no flux on the axis."""
    A, kappa, z, h = 4.0, 5.0, 0.03, 1e-3
    W = 1 - 1 / A

    def rise(r, z):
        return two_layer.temperature_rise(r, A, kappa, z, tolerance=1e-12)

    for r, k in ((0.3, 1.0), (0.6, 1.0), (0.9, 1 / kappa)):
        along = (rise(r, z + 1e-4) - rise(r, z - 1e-4)) / 2e-4
        slope = (rise(r + h, z) - rise(r - h, z)) / (2 * h)
        curvature = (rise(r + h, z) - 2 * rise(r, z) + rise(r - h, z)) / h**2
        assert along == pytest.approx(4 * k * (curvature + slope / r), rel=1e-4)
    inside = (3 * rise(W, z) - 4 * rise(W - h, z) + rise(W - 2 * h, z)) / (2 * h)
    outside = -(3 * rise(W, z) - 4 * rise(W + h, z) + rise(W + 2 * h, z)) / (2 * h)
    assert inside == pytest.approx(outside / kappa, rel=1e-4)
    at_wall = (3 * rise(1.0, z) - 4 * rise(1 - h, z) + rise(1 - 2 * h, z)) / (2 * h)
    assert at_wall == pytest.approx(0.5 * kappa, rel=1e-4)  # q/k_wa, in q D/k_b per R
    assert rise(W + 1e-13, z) == pytest.approx(rise(W - 1e-13, z), rel=1e-11)
    assert rise(1e-6, z) == pytest.approx(rise(0.0, z), rel=1e-11)


def test_inlet_is_at_rest():
    assert np.all(two_layer.temperature_rise([0.0, 0.5, 1.0], 20.0, 2.0, 0.0) == 0.0)


def test_physical_temperatures():
    D, k_b = FLOW["tube_diameter"], FLOW["bulk_conductivity"]
    z = np.array([0.0, 0.1, 1.0])
    found = two_layer.flow_temperatures(np.array([[0.0], [0.5 * D]]), z, **FLOW)
    assert found.temperature.shape == (2, 3)
    assert found.temperature[1] == pytest.approx(found.wall_temperature[1], rel=1e-12)
    m = FLOW["density"] * FLOW["velocity"] * np.pi * D**2 / 4
    heat = FLOW["heat_flux"] * np.pi * D * z
    assert found.mean_temperature[0] == pytest.approx(300 + heat / (m * FLOW["specific_heat"]), rel=1e-14)
    z_star = two_layer.inverse_graetz(z[1:], k_b, FLOW["density"] * FLOW["velocity"], FLOW["specific_heat"], D)
    Nu = two_layer.nusselt(D / FLOW["particle_diameter"], 2.5, z_star)
    h = FLOW["heat_flux"] / (found.wall_temperature - found.mean_temperature)[0, 1:]
    assert h * D / k_b == pytest.approx(Nu, rel=1e-9)
    loose = two_layer.flow_temperatures(np.array([[0.0], [0.5 * D]]), z, **FLOW, tolerance=1e-4)
    assert np.all(np.abs(loose.temperature - found.temperature) <= loose.error_bound + found.error_bound)
    assert loose.terms[0, 1] < found.terms[0, 1]
    assert str(found) == "6 temperatures from 300 to 350.96 K (10 terms at most, error below 1.3e-09 K)"


@pytest.mark.parametrize(
    ("radius", "change", "message"),
    [
        (5e-3, {}, "radius over half the tube_diameter is 1.25; expected at most 1"),
        (-1e-3, {}, "radius is -0.001 m"),
        (0.0, {"heat_flux": np.inf}, "heat_flux is inf W/m2"),
        (0.0, {"heat_flux": -5e5}, "heat_flux is -500000 W/m2; expected one that leaves the wall above 0 K"),
        (0.0, {"particle_diameter": 9e-3}, "diameter_ratio is 0.888889; expected more than 1"),
        (0.0, {"velocity": 0.0}, "velocity is 0 m/s"),
    ],
)
def test_refusals(radius, change, message):
    with pytest.raises(ValueError, match=message):
        two_layer.flow_temperatures(radius, 0.5, **(FLOW | change))


def test_no_mode_exceeds_its_bound():
    """What the error bound of the field rests on; reached within a factor of 2 by some mode on the axis."""
    rng = np.random.default_rng(8)
    pairs = layers(1 + 10 ** rng.uniform(-2, 3, 60), 10 ** rng.uniform(-4, 4, 60))
    modes = find_modes(pairs, 20)
    r = np.sort(np.concatenate([rng.uniform(0, 1, (60, 300)), pairs.W[:, None], np.zeros((60, 1))], axis=1), axis=1)
    bound = largest_amplitude(layers(1 / pairs.e[:, None], pairs.kappa[:, None]), modes.mu)
    share = np.max(np.abs(modes.shapes(r)), axis=1) / bound
    assert np.max(share) <= 1.0
    assert np.max(share) > 0.5


def test_refuses_radii_outside():
    with pytest.raises(ValueError, match=r"radius_ratio is 1\.1; expected at least 0 and at most 1"):
        two_layer.temperature_rise(1.1, 20.0, 2.0, 0.1)
    with pytest.raises(ValueError, match="z_star is inf"):
        two_layer.temperature_rise(1.0, 20.0, 2.0, np.inf)
