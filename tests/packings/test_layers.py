"""Layers of whole packings: edges, exact volumes, windows, periods, invariance."""

import functools
import math

import mpmath
import numpy as np
import pytest

import bedrad
from bedrad.packings.layers import (
    check_edges,
    check_window,
    layer_areas,
    layer_edges,
    layer_sums,
    layer_volumes,
    whole_volumes,
)
from bedrad.walls import Window
from oracles.beds import random_bed
from oracles.layers_beds import free_gas, hexagonal_sheet, staggered_rings
from oracles.layers_solids import ball_in_cylinder_by_slices

WALLS = {
    "tube": (bedrad.Tube(5.0), 7.0),
    "rod": (bedrad.Rod(2.0), 7.0),
    "plate": (bedrad.Plate(), (7.0, 6.0)),
}
EDGES = [0.0, 0.35, 1.1, 1.9]
BALL = 4.0 / 3.0 * math.pi
ROUNDING = 4e-15


@functools.cache
def _bed(kind, periodic=True):
    wall, period = WALLS[kind]
    return random_bed(wall, 60, seed=3, length=6.0, spread=3.5, period=period if periodic else None)


def _everything(bed):
    """Edges that hold the whole bed, and a window beyond its ends."""
    deepest = bed.wall.largest_depth if bed.wall.kind == "tube" else (bed.depths + bed.radii).max()
    lateral = (-9.0, 19.0) if bed.wall.kind == "plate" else None
    return [0.0, 0.4, 1.3, 2.0, deepest], Window((-9.0, 19.0), lateral)


# ---- edges and windows ----


def test_edges_are_a_radius_and_then_diameters():
    bed = bedrad.Packing([[0, 0, 0.5], [0, 0, 3.0]], [0.4, 0.6], bedrad.Plate())
    assert layer_edges(bed) == pytest.approx([0.0, 0.5, 1.5, 2.5])
    assert layer_edges(bed, layers=1, diameter=0.2) == pytest.approx([0.0, 0.1])
    assert layer_edges(bedrad.Packing([], 1.0, bedrad.Plate()), 2, diameter=2.0) == pytest.approx([0, 1, 3])
    with pytest.raises(ValueError, match="read-only"):
        layer_edges(bed)[0] = 1.0


def test_edges_may_reach_the_axis_and_no_further():
    bed = bedrad.Packing([[0.0, 0.0, 0.0]], 0.1, bedrad.Tube(0.5))
    assert layer_edges(bed)[-1] == 0.5
    with pytest.raises(ValueError, match=r"layers is 4.*0\.7 m.*0\.5 m.*at most 3 fit"):
        layer_edges(bed, layers=4)


def test_edges_refuse_nonsense():
    bed = bedrad.Packing([[0, 0, 1.0]], 1.0, bedrad.Plate())
    with pytest.raises(ValueError, match="layers is 0"):
        layer_edges(bed, layers=0)
    with pytest.raises(ValueError, match=r"diameter is -1\.0 m"):
        layer_edges(bed, diameter=-1.0)
    with pytest.raises(ValueError, match="empty packing"):
        layer_edges(bedrad.Packing([], 1.0, bedrad.Plate()))


@pytest.mark.parametrize(
    ("edges", "message"),
    [
        ([0.0], "at least two"),
        ([[0.0, 1.0]], "shape"),
        ([0.0, 1.0, 1.0], "rise"),
        ([-0.1, 1.0], "rise"),
        ([0.0, math.nan], "finite"),
        ([0.0, 5.1], r"last edge is 5\.1 m; the deepest point below the tube wall is 5 m"),
    ],
)
def test_given_edges_are_checked(edges, message):
    with pytest.raises(ValueError, match=message):
        check_edges(edges, bedrad.Tube(5.0))


def test_windows_are_checked():
    tube, plate = _bed("tube"), _bed("plate")
    assert check_window(tube) == Window((0.0, 7.0))
    with pytest.raises(ValueError, match="longer than the period of 7 m"):
        check_window(tube, Window((0.0, 7.1)))
    with pytest.raises(ValueError, match="lateral window"):
        check_window(plate, Window((0.0, 7.0), (0.0, 6.1)))
    with pytest.raises(ValueError, match="tube takes no lateral range"):
        check_window(tube, Window((0.0, 1.0), (0.0, 1.0)))
    with pytest.raises(ValueError, match="plate needs a lateral range"):
        check_window(plate, Window((0.0, 1.0)))
    with pytest.raises(ValueError, match="blocks is 0"):
        layer_sums(tube, EDGES, blocks=0)


def test_margin_leaves_out_the_ends():
    bed = _bed("tube", periodic=False)
    low, high = bed.extent(2)
    margin = max(0.5 * bed.mean_diameter, 0.5 * 2 * bed.radii.max())
    assert check_window(bed, margin=0.5).axial == pytest.approx((low + margin, high - margin))
    inner = layer_volumes(bed, EDGES, margin=0.5)
    assert np.array_equal(inner, layer_volumes(bed, EDGES, check_window(bed, margin=0.5)))
    assert 0 < inner.sum() < layer_volumes(bed, EDGES, margin=0.0).sum()


# ---- exact volumes ----


@pytest.mark.parametrize("kind", ["tube", "rod"])
def test_polydisperse_bed_agrees_with_quadrature(kind):
    rng = np.random.default_rng(11)
    wall = WALLS[kind][0]
    radii = np.geomspace(0.04, 2.0, 20)
    gap = radii * rng.uniform(0.0, 0.5, 20)
    radial = wall.radius + (radii + gap) * (-1 if kind == "tube" else 1)
    angle = rng.uniform(0, 2 * np.pi, 20)
    centers = np.c_[radial * np.cos(angle), radial * np.sin(angle), rng.uniform(0, 4, 20)]
    bed = bedrad.Packing(centers, radii, wall, max_overlap=2.0)
    window = Window((0.8, 3.1))
    volumes = layer_volumes(bed, EDGES, window)
    sign = -1 if kind == "tube" else 1
    for (x, y, z), r, measured in zip(bed.centers, radii, volumes, strict=True):
        with mpmath.workdps(40):
            b, surfaces = mpmath.hypot(x, y), [mpmath.mpf(wall.radius) + sign * mpmath.mpf(e) for e in EDGES]
        low, high = window.axial[0] - z, window.axial[1] - z
        inside = [float(ball_in_cylinder_by_slices(r, b, rho, low, high)) for rho in surfaces]
        # a layer is a difference of two volumes
        assert np.abs(measured - np.abs(np.diff(inside))).max() < 2 * ROUNDING * BALL * r**3
    assert (volumes > 0).sum() > 20


@pytest.mark.parametrize("kind", WALLS)
@pytest.mark.parametrize("periodic", [True, False])
def test_layers_and_blocks_tile_the_bed(kind, periodic):
    bed = _bed(kind, periodic)
    edges, window = _everything(bed)
    if periodic:
        window = bed.window()
    whole = BALL * bed.radii**3
    # in a tube the edges end at the axis, over rods and plates at the deepest point of the bed
    volumes = layer_volumes(bed, edges, window)
    assert np.abs(volumes.sum(axis=1) - whole).max() < ROUNDING * BALL
    assert np.abs(layer_areas(bed, edges, window).sum(axis=1) - 4 * np.pi * bed.radii**2).max() < 4 * ROUNDING * BALL
    sums = layer_sums(bed, edges, window, blocks=5)
    assert sums.shape == (5, 4)
    assert sums.sum(axis=0) == pytest.approx(volumes.sum(axis=0), rel=1e-14)


@pytest.mark.parametrize("kind", WALLS)
def test_blocks_are_windows(kind):
    bed = _bed(kind)
    window = Window((1.0, 5.0), (0.5, 3.5) if kind == "plate" else None)
    sums = layer_sums(bed, EDGES, window, blocks=4)
    for k in range(4):
        piece = Window((1.0 + k, 2.0 + k), window.lateral)
        assert sums[k] == pytest.approx(layer_volumes(bed, EDGES, piece).sum(axis=0), abs=ROUNDING * 60)


@pytest.mark.parametrize("kind", WALLS)
def test_a_period_is_an_open_bed_with_images(kind):
    bed = _bed(kind)
    shifts = [np.zeros(3)]
    for axis in bed.wall.periodic_axes:
        step = np.eye(3)[axis] * bed.box[axis]
        shifts = [s + k * step for s in shifts for k in (-1, 0, 1)]
    many = bedrad.Packing(np.vstack([bed.centers + s for s in shifts]), np.tile(bed.radii, len(shifts)), bed.wall)
    for window in (bed.window(), Window((-1.5, 3.0), (4.0, 7.5) if kind == "plate" else None)):
        periodic = layer_volumes(bed, EDGES, window)
        open_ends = layer_volumes(many, EDGES, window).reshape(len(shifts), len(bed), -1).sum(axis=0)
        assert np.abs(periodic - open_ends).max() < ROUNDING * BALL
        assert periodic.sum() > 1.0


def test_a_sphere_as_wide_as_its_period_counts_once():
    bed = bedrad.Packing([[0.0, 0.0, 1.7]], 1.0, bedrad.Tube(4.0), period=2.0)
    assert layer_volumes(bed, [0.0, 4.0]) == pytest.approx(BALL, rel=1e-14)
    assert layer_volumes(bed, [0.0, 4.0], Window((0.2, 2.2))) == pytest.approx(BALL, rel=1e-14)


@pytest.mark.parametrize("kind", ["tube", "rod"])
def test_turning_mirroring_and_shifting_change_nothing(kind):
    bed = _bed(kind, periodic=False)
    window = Window((1.0, 5.0))
    volumes, areas = layer_volumes(bed, EDGES, window), layer_areas(bed, EDGES, window)
    c, s = math.cos(1.234), math.sin(1.234)
    turned = bed.centers @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]])
    mirrored = bed.centers * [1, -1, -1] + [0, 0, 6.0]
    shifted = bed.centers + np.array([0, 0, 2.0])
    for centers, moved in ((turned, window), (mirrored, window), (shifted, Window((3.0, 7.0)))):
        other = bedrad.Packing(centers, bed.radii, bed.wall)
        # turning rounds every coordinate: a few 1e-16 of the wall radius times the sphere's cross-section
        assert np.abs(layer_volumes(other, EDGES, moved) - volumes).max() < 2e-14
        assert np.abs(layer_areas(other, EDGES, moved) - areas).max() < 1e-13


def test_swapping_the_directions_of_a_plate_changes_nothing():
    bed = _bed("plate", periodic=False)
    swapped = bedrad.Packing(bed.centers[:, [1, 0, 2]], bed.radii, bed.wall)
    volumes = layer_volumes(bed, EDGES, Window((0.5, 4.0), (1.0, 5.0)))
    assert np.abs(layer_volumes(swapped, EDGES, Window((1.0, 5.0), (0.5, 4.0))) - volumes).max() < ROUNDING * BALL


def test_a_wide_tube_and_a_wide_rod_are_a_plate():
    # the first-order effect of curvature, pi r^4/(8 rho), has opposite signs and cancels in the mean
    radius = 1e4
    window, edges = Window((-2.0, 2.0)), [0.0, 1.0]
    tube = bedrad.Packing([[radius - 1.0, 0, 0]], 1.0, bedrad.Tube(radius))
    rod = bedrad.Packing([[0, radius + 1.0, 0]], 1.0, bedrad.Rod(radius))
    plate = bedrad.Packing([[0, 0, 1.0]], 1.0, bedrad.Plate())
    curved = layer_volumes(tube, edges, window)[0, 0], layer_volumes(rod, edges, window)[0, 0]
    flat = layer_volumes(plate, edges, Window((-2.0, 2.0), (-2.0, 2.0)))[0, 0]
    assert flat == pytest.approx(BALL / 2, rel=1e-15)
    assert curved[0] - flat == pytest.approx(np.pi / 8 / (radius - 1), rel=1e-6)
    assert curved[1] - flat == pytest.approx(-np.pi / 8 / (radius + 1), rel=1e-6)


@pytest.mark.parametrize("kind", WALLS)
def test_what_lies_beyond_the_wall_does_not_count(kind):
    wall, _ = WALLS[kind]
    depth = 0.4
    place = {"tube": (5.0 - depth, 0, 0), "rod": (2.0 + depth, 0, 0), "plate": (0, 0, depth)}[kind]
    bed = bedrad.Packing([place], 0.5, wall, max_overlap=0.3)
    window = Window((-1.0, 1.0), (-1.0, 1.0) if kind == "plate" else None)
    volume = layer_volumes(bed, [0.0, 2.0], window)[0, 0]
    beyond = {
        "tube": lambda: BALL / 8 - ball_in_cylinder_by_slices(0.5, place[0], 5.0, -1, 1),
        "rod": lambda: ball_in_cylinder_by_slices(0.5, place[0], 2.0, -1, 1),
        "plate": lambda: np.pi / 3 * 0.1**2 * 1.4,
    }[kind]()
    assert volume == pytest.approx(float(BALL / 8 - beyond), rel=ROUNDING)
    assert beyond > 0.005
    assert volume == whole_volumes(wall, bed.centers, bed.radii, np.array([0.0, 2.0]))[0, 0]


def test_spheres_out_of_reach_have_no_volume():
    bed = bedrad.Packing([[0, 0, 1.0], [0, 0, 8.0], [20.0, 0, 1.0]], 1.0, bedrad.Plate())
    window = Window((-3.0, 3.0), (-3.0, 3.0))
    volumes = layer_volumes(bed, [0.0, 1.0, 3.0], window)
    assert volumes[0] == pytest.approx([BALL / 2, BALL / 2])
    assert (volumes[1:] == 0.0).all()
    assert layer_sums(bedrad.Packing([], 1.0, bedrad.Plate()), [0.0, 1.0], window).tolist() == [[0.0]]


def test_no_volume_is_negative():
    for kind in WALLS:
        bed = _bed(kind)
        assert (layer_volumes(bed, np.linspace(0, 4, 200)) >= 0.0).all()
        assert (layer_areas(bed, np.linspace(0, 4, 200)) >= 0.0).all()


# ---- beds with known solid fractions ----


def test_hexagonal_sheet_has_the_known_profile():
    bed = hexagonal_sheet(3, 2)
    depths = np.linspace(0.0, 2.0, 21)
    area = bed.period[0] * bed.period[1]
    measured = layer_sums(bed, depths)[0] / area / np.diff(depths)
    # 1 - eps = pi/(2 sqrt 3) (2 y - y^2) in radii, integrated over each bin
    filled = np.pi / (2 * np.sqrt(3)) * (depths**2 - depths**3 / 3)
    assert measured == pytest.approx(np.diff(filled) / np.diff(depths), rel=1e-13)


def test_hexagonal_sheet_has_the_known_surface():
    # a zone of a sphere has the area of its cylinder's
    bed = hexagonal_sheet(3, 2)
    assert layer_areas(bed, [0.0, 0.3, 1.0, 2.0]) == pytest.approx(
        np.outer(np.ones(12), 2 * np.pi * np.array([0.3, 0.7, 1.0])), rel=1e-13
    )


RINGS = {  # spheres a ring: tube over sphere diameter, solid fraction, as tabulated to ten digits
    2: (2.0, 0.4714045208),
    3: (2.1547005384, 0.5275963530),
    4: (2.4142135624, 0.5440951573),
    5: (2.7013016167, 0.5370086351),
    6: (3.0, 0.5194537309),
    7: (3.3047648710, 0.4977358356),
    8: (3.6131259298, 0.4748810554),
    10: (4.2360679775, 0.4307999661),
    20: (7.3924532215, 0.2820198855),
}


@pytest.mark.parametrize("count", RINGS)
def test_staggered_rings_have_the_known_solid_fraction(count):
    bed = staggered_rings(count)
    ratio, fraction = RINGS[count]
    radius = bed.wall.radius
    assert radius == pytest.approx(ratio, abs=1e-10)
    solid = layer_sums(bed, [0.0, 0.5, radius], blocks=3).sum()
    assert solid / (np.pi * radius**2 * bed.period) == pytest.approx(fraction, abs=1e-10)


def test_a_gas_fills_its_layers_as_its_density_says():
    # centres uniform between the depths 1 and 9: from 4 to 6 the mean fraction is density times ball volume
    rng = np.random.default_rng(2)
    n, side = 20000, 40.0
    centers = np.c_[rng.uniform(0, side, (n, 2)), rng.uniform(1.0, 9.0, n)]
    bed = bedrad.Packing(centers, 1.0, bedrad.Plate(), period=(side, side), max_overlap=2.0)
    fraction = layer_sums(bed, [4.0, 6.0])[0, 0] / (2 * side**2)
    expected = n * BALL / (8 * side**2)
    # variance of a mean of n independent ball volumes between 0 and BALL
    assert abs(fraction - expected) < 5 * BALL * math.sqrt(n * 0.5) / (2 * side**2)


def test_gas_beds_are_what_they_say():
    for kind, (wall, _) in WALLS.items():
        length = (30.0, 20.0) if kind == "plate" else 30.0
        bed = free_gas(wall, 1, 200, length)
        assert (bed.depths >= 1.0 - 1e-12).all()
        assert 100 < len(bed) < 300
