import math

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad

from bedrad.heat import cylinder
from bedrad.heat.single_particle import cut_particle as cut_flat
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
    ratios = np.array([1e3, 1e4, 1e5, 1e6])
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


WALLS = np.array([2.0, 2.001, 2.2, 12.9, 1e6])[:, None]
GAPS = np.array([0.0, 1e-12, 1e-6, 0.75, 0.999])


def with_finer_rules(monkeypatch):
    """The same integrals with half as many again or more nodes and azimuths."""
    monkeypatch.setattr(cylinder, "_RULE", cylinder._double_exponential(100, 3.6))
    monkeypatch.setattr(cylinder, "_FINE_RULE", cylinder._double_exponential(360, 3.9))
    monkeypatch.setattr(cylinder, "_AZIMUTHS", 48)
    monkeypatch.setattr(cylinder, "_AXIS_AZIMUTHS", 140)


@pytest.mark.parametrize("K", [1e-12, 1e-3, 70.0, 1e6, 1e12])
def test_resolves_every_peak_from_the_axis_to_a_flat_wall(K, monkeypatch):
    values = cylinder.particle_conductivity(K, WALLS, GAPS), cylinder.covered_area(WALLS, GAPS)
    with_finer_rules(monkeypatch)
    finer = cylinder.particle_conductivity(K, WALLS, GAPS), cylinder.covered_area(WALLS, GAPS)
    assert values[0] == pytest.approx(finer[0], rel=3e-11 if K == 1e6 else 1e-13)
    assert values[1] == pytest.approx(finer[1], rel=1e-13)


@pytest.mark.parametrize(("A", "a"), [(2.0, 0.0), (25.8333, 0.0)])
def test_contact_at_the_highest_ratio_against_mpmath(A, a):
    # eq. 84-86 with radial resistances, azimuth by azimuth; the peak under the contact is split into decades
    K = 1e12
    with mpmath.workdps(18):
        c, ratio = mpmath.mpf(A) - 1 - mpmath.mpf(a), mpmath.mpf(K)
        inner2, wall2 = (mpmath.mpf(A) - 1) ** 2, mpmath.mpf(A) ** 2
        layer = mpmath.log(wall2 / inner2)
        decades = [mpmath.mpf(10) ** -k for k in (20, 14, 13, 12, 11, 10, 7, 4, 1)]

        def along(azimuth):
            s = mpmath.sin(azimuth) ** 2
            total = (c + 1) ** 2 - inner2
            end = total / (s + c + mpmath.sqrt((s + c) ** 2 - s * total))

            def heat(v):
                to_wall = 2 * (c + s) * v - s * v * v + mpmath.mpf(a) * (2 * A - a)
                front2 = wall2 - to_wall
                area = ((c + 1 - v) * (1 - v) + v * (2 - v) * (1 - s)) / front2
                return area * layer * ratio / (-ratio * mpmath.log1p(-to_wall / wall2) + mpmath.log(front2 / inner2))

            return mpmath.quad(heat, [0, *(end * x for x in decades), end])

        # equal steps converge like exp(-4 N asinh(sqrt(c))): to 1e-12 with these
        N = math.ceil(7 / math.asinh(math.sqrt(float(c))))
        heat = A * sum(along((k + 0.5) * mpmath.pi / (2 * N)) for k in range(N)) * 2 * mpmath.pi / N
    found = cylinder.particle_conductivity(K, A, a) * cylinder.covered_area(A, a)
    assert found == pytest.approx(float(heat), rel=1e-11)


def test_beside_the_narrowest_tube():
    # A = 2, a = 1: a particle in the middle touches the inner surface of the layer all round and covers nothing
    assert cylinder.covered_area(2.0, 1.0) == 0.0
    assert cylinder.particle_volume(2.0, 1.0) == 0.0
    assert cylinder.particle_conductivity(70.0, 2.0, 1.0) == pytest.approx(1.0, abs=1e-14)
    # half of each of two particles side by side lies beyond the radius of one of them: all but a lens
    volume = 2 * quad(lambda t: circle_outside(math.cos(t), 1.0, 1.0) * math.cos(t), 0, math.pi / 2, epsrel=1e-11)[0]
    assert cylinder.particle_volume(2.0) == pytest.approx(volume, rel=1e-9)


def test_chunks_of_long_arrays_join_up():
    K = np.linspace(2.0, 200.0, 300)
    values = cylinder.particle_conductivity(K, 12.9, 0.22)
    assert values[137] == cylinder.particle_conductivity(K[137], 12.9, 0.22)
    assert np.all(np.diff(values) > 0)


def test_edge_of_the_layer():
    assert cylinder.particle_conductivity(70.0, 12.9, 1.0) == pytest.approx(1.0, abs=1e-14)
    assert cylinder.covered_area(12.9, 1.0) == 0.0
    assert cylinder.particle_volume(12.9, 1.0) == 0.0


@pytest.mark.parametrize("A", [1.99, 1.0, 0.5])
def test_refuses_tubes_without_a_bulk(A):
    with pytest.raises(ValueError, match=rf"diameter_ratio is {A:g}; expected at least 2"):
        cylinder.covered_area(A)


def by_columns(K, A, a, depth, steps=1500):
    """Area and heat of a particle in a layer of any depth, by a fine grid of columns on the wall."""
    c, inner = A - 1 - a, A - depth
    angle, z = np.meshgrid((np.arange(steps) + 0.5) / steps * math.asin(1 / c), (np.arange(steps) + 0.5) / steps)
    square = 1 - z * z - (c * np.sin(angle)) ** 2
    root = np.sqrt(np.maximum(square, 0.0))
    front = c * np.cos(angle) + root
    hit = (square > 0) & (front > inner)
    solid = np.where(hit, np.log(np.maximum(front, inner) / np.maximum(c * np.cos(angle) - root, inner)), 0.0)
    layer = math.log(A / inner)
    each = 4 * A * math.asin(1 / c) / steps**2
    area = hit.sum() * each
    return area, (hit * layer / (layer - solid + solid / K)).sum() * each / area


@pytest.mark.parametrize(
    ("K", "A", "a", "depth"),
    [(70, 5, 0.3, 0.7), (70, 5, 0.1, 1.3), (0.1, 5, 0.1, 1.3), (70, 6, 0.3, 2.5), (1000, 12.9, 0.02, 1.05)],
)
def test_layers_that_cut_above_below_and_behind_the_centre(K, A, a, depth):
    found = cylinder.cut_particle(K, A, a, depth)
    # the grid counts columns at the outline whole or not at all: 1e-5 of the area
    assert found == pytest.approx(by_columns(K, A, a, depth), rel=4e-5)


def test_cut_at_one_radius_is_the_integral_of_the_source():
    a = np.array([0.0, 0.22, 0.9, 1.0])
    area, k = cylinder.cut_particle(70.0, 12.9, a)
    assert area == pytest.approx(cylinder.covered_area(12.9, a), rel=1e-15)
    assert k == pytest.approx(cylinder.particle_conductivity(70.0, 12.9, a), rel=1e-14)
    # and the general rule comes to it from both sides
    for depth in (1 - 1e-9, 1 + 1e-9):
        near = cylinder.cut_particle(70.0, 12.9, a[:3], depth)
        assert near[0] == pytest.approx(area[:3], rel=3e-8)
        assert near[1] == pytest.approx(k[:3], rel=3e-8)


def test_cut_particles_are_flat_in_wide_tubes():
    K, a, depth = 70.0, 0.1, np.array([0.6, 1.4, 2.3])
    flat = cut_flat(K, a, depth)
    error = [np.abs(np.array(cylinder.cut_particle(K, A, a, depth)) / np.array(flat) - 1) for A in (1e3, 1e4)]
    assert np.log10(error[0] / error[1]) == pytest.approx(1.0, abs=0.01)


def test_cut_particle_refusals():
    with pytest.raises(ValueError, match="expected at least 2 and at least 2 \\+ layer_depth"):
        cylinder.cut_particle(70.0, 3.0, 0.0, 1.5)
    with pytest.raises(ValueError, match=r"nc_distance is 1.2 particle radii; expected at least 0 and at most layer"):
        cylinder.cut_particle(70.0, 12.9, 1.2)
    with pytest.raises(ValueError, match="layer_depth is 0"):
        cylinder.cut_particle(70.0, 12.9, 0.0, 0.0)
