import math

import numpy as np
import pytest
from scipy.integrate import quad

from bedrad.heat import cylinder
from bedrad.heat.single_particle import particle_conductivity

# eq. 84-87 as printed and eq. 88 with its corrections, by mpmath with 30 digits: K, A, a, k/k_g
MPMATH = [
    (70, 25.8333, 0.22, 2.2053754433251944),
    (70, 25.8333, 0.0, 6.707183292126623),
    (1000, 12.9, 0.01, 7.195504571762991),
]


def printed(K, A, a):
    """Watkins 2018, eq. 84-87: nested adaptive quadrature, sine substitution at the ends."""
    c, layer = A - 1 - a, math.log(A / (A - 1))
    highest = math.sqrt(1 - a * a)

    def last_angle(z):
        cosine = (2 * c * c + 2 * a * c + a * a - 1 + z * z) / (2 * (c * c + a * c))
        return math.acos(min(1.0, cosine))

    def local(angle, z):
        root = math.sqrt(max(1 - z * z - (c * math.sin(angle)) ** 2, 0.0))
        return K * layer / ((K - 1) * math.log(A / (c * math.cos(angle) + root)) + layer)

    def row(t):
        z = highest * math.sin(t)
        end = last_angle(z)
        through = quad(lambda s: local(end * math.sin(s), z) * end * math.cos(s), 0, math.pi / 2, epsrel=1e-10)[0]
        return through * highest * math.cos(t)

    heat = quad(row, 0, math.pi / 2, epsrel=1e-9)[0]
    area = quad(lambda t: last_angle(highest * math.sin(t)) * highest * math.cos(t), 0, math.pi / 2, epsrel=1e-11)[0]
    return heat / area, 4 * A * area


def circle_outside(radius, distance, other):
    """Area of a circle, its centre at `distance`, outside another circle of radius `other`."""
    if distance + radius <= other:
        return 0.0
    x = (distance**2 + radius**2 - other**2) / (2 * distance * radius)
    y = (distance**2 + other**2 - radius**2) / (2 * distance * other)
    span = (
        (distance + radius - other)
        * (distance - radius + other)
        * (-distance + radius + other)
        * (distance + radius + other)
    )
    lens = radius**2 * math.acos(x) + other**2 * math.acos(y) - 0.5 * math.sqrt(max(span, 0.0))
    return math.pi * radius**2 - lens


@pytest.mark.parametrize(("K", "A", "a", "expected"), MPMATH)
def test_high_precision_references(K, A, a, expected):
    assert cylinder.particle_conductivity(K, A, a) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize(("K", "A", "a"), [(70, 2.5, 0.3), (0.1, 5.0, 0.22)])
def test_printed_double_integral(K, A, a):
    conductivity, area = printed(K, A, a)
    assert cylinder.particle_conductivity(K, A, a) == pytest.approx(conductivity, rel=1e-8)
    assert cylinder.covered_area(A, a) == pytest.approx(area, rel=1e-10)


@pytest.mark.parametrize(("A", "a"), [(2.2, 0.0), (5.0, 0.22), (25.8333, 0.0), (12.9, 0.9)])
def test_volume_by_slices_across_the_tube(A, a):
    c = A - 1 - a
    height = math.sqrt(1 - a * a)
    # the slice at height z is a circle, cut by the inner surface of the layer; sine substitution at the end
    volume = quad(
        lambda t: 2 * circle_outside(math.sqrt(1 - (height * math.sin(t)) ** 2), c, c + a) * height * math.cos(t),
        0,
        math.pi / 2,
        epsrel=1e-11,
    )[0]
    assert cylinder.particle_volume(A, a) == pytest.approx(volume, rel=1e-9)


def test_wide_tubes_are_flat_to_first_order_in_the_curvature():
    a = np.array([0.0, 0.22, 0.7])
    ratios = np.array([1e3, 1e4, 1e5])
    flat = np.stack([particle_conductivity(70.0, a), math.pi * (1 - a * a), math.pi / 3 * (1 - a) ** 2 * (2 + a)])[
        :, None, :
    ]
    A = ratios[:, None]
    exact = np.stack(
        [
            cylinder.particle_conductivity(70.0, A, a),
            cylinder.covered_area(A, a),
            cylinder.particle_volume(A, a),
        ]
    )
    error = np.abs(exact / flat - 1)
    slopes = np.diff(np.log(error), axis=1) / np.diff(np.log(ratios))[:, None]
    assert slopes == pytest.approx(-1.0, abs=0.01)


def test_resolves_the_peak_under_the_contact_for_nine_decades_of_conductivity(monkeypatch):
    K = np.logspace(-3, 6, 10)[:, None]
    A = np.array([2.2, 12.9, 1e3])
    values = cylinder.particle_conductivity(K, A, 0.0)
    finer = cylinder._double_exponential(140, 3.6)
    for name, value in zip(("_X", "_REST", "_WEIGHT"), finer, strict=True):
        monkeypatch.setattr(cylinder, name, value)
    monkeypatch.setattr(cylinder, "_AZIMUTHS", 80)
    assert values == pytest.approx(cylinder.particle_conductivity(K, A, 0.0), rel=1e-10)


def test_chunks_of_long_arrays_join_up():
    K = np.linspace(2.0, 200.0, 300)
    values = cylinder.particle_conductivity(K, 12.9, 0.22)
    assert values[137] == cylinder.particle_conductivity(K[137], 12.9, 0.22)
    assert np.all(np.diff(values) > 0)


def test_edge_of_the_layer():
    assert cylinder.particle_conductivity(70.0, 12.9, 1.0) == pytest.approx(1.0, abs=1e-14)
    assert cylinder.covered_area(12.9, 1.0) == 0.0
    assert cylinder.particle_volume(12.9, 1.0) == 0.0


def test_refuses_tubes_without_a_bulk():
    with pytest.raises(ValueError, match=r"diameter_ratio is 2; expected at least 2.2"):
        cylinder.covered_area(2.0)
