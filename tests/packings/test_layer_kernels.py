"""Exact volumes of cut balls: closed forms, slow quadrature by other routes, and the compiler off."""

import json
import math
import os
import subprocess
import sys

import mpmath
import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bedrad.packings import layer_kernels
from bedrad.packings.layer_kernels import ball_in_box, ball_in_cylinder, place_in_cylinder
from oracles.layers_solids import (
    ball_beyond_cylinder_by_rings,
    ball_in_box_by_slices,
    ball_in_cylinder_by_slices,
    ball_in_cylinder_by_strips,
    sphere_in_cylinder_by_slices,
)

BALL = 4.0 / 3.0 * math.pi
ROUNDING = 4e-15
"""About twenty rounding errors: a result is a sum of a dozen terms of the size of the whole ball."""


def _cut(r, b, rho, low=-math.inf, high=math.inf):
    """Volume and surface between two heights; b and rho are exact doubles."""
    distance, inside, rho = place_in_cylinder(b, 0.0, rho, 0.0)
    above = ball_in_cylinder(r, distance, inside, rho, min(high, 2 * r))
    below = ball_in_cylinder(r, distance, inside, rho, max(low, -2 * r))
    return above[0] - below[0], above[1] - below[1]


CASES = {
    "half in, sharp curve": (1.0, 2.0, 2.0),
    "half in, R/r = 1e3": (1.0, 1e3, 1e3),
    "half in, R/r = 1e6": (1.0, 1e6, 1e6),
    "a third in, R/r = 1e6": (1.0, 1e6 + 0.3, 1e6),
    "in by a hair of its radius": (1.0, 11.0 - 1e-9, 10.0),
    "out by a hair of its radius": (1.0, 9.0 + 1e-9, 10.0),
    "centre a hair inside": (1.0, 10.0 - 1e-12, 10.0),
    "centre a hair outside": (1.0, 10.0 + 1e-12, 10.0),
    "centre near the surface": (1.0, 10.0 + 1e-3, 10.0),
    "larger than the cylinder, off axis": (1.0, 0.3, 0.4),
    "swallows the cylinder": (1.0, 0.05, 0.1),
    "touches the far side from inside": (1.0, 0.25, 0.75),
    "all but touches the far side": (1.0, 0.25, 0.75 + 1e-10),
    "just past the far side": (1.0, 0.25, 0.75 - 1e-6),
    "near the axis, equal radii": (1.0, 1e-9, 1.0),
    "near the axis, radii apart by less": (1.0, 1e-5, 1.0 + 3e-6),
    "thin core in a large ball": (50.0, 20.0, 1.0),
    "needle": (1.0, 0.5, 1e-7),
}


@pytest.mark.parametrize(("r", "b", "rho"), CASES.values(), ids=CASES)
@pytest.mark.parametrize(("low", "high"), [(-1.0, 1.0), (-0.37, 0.93)])
def test_volume_and_surface_agree_with_slices(r, b, rho, low, high):
    volume, surface = _cut(r, b, rho, low * r, high * r)
    expected = ball_in_cylinder_by_slices(r, b, rho, low * r, high * r)
    assert abs(volume - expected) < ROUNDING * BALL * r**3
    # where circles touch, the surface moves by the root of a rounding of b or rho: take both as rounded
    inside = place_in_cylinder(b, 0.0, rho, 0.0)[1]
    expected = sphere_in_cylinder_by_slices(r, b, mpmath.fadd(b, inside, exact=True), low * r, high * r)
    assert abs(surface - expected) < ROUNDING * 4 * math.pi * r * r


@pytest.mark.parametrize(("r", "b", "rho"), CASES.values(), ids=CASES)
def test_volume_agrees_with_strips(r, b, rho):
    assert abs(_cut(r, b, rho)[0] - ball_in_cylinder_by_strips(r, b, rho)) < ROUNDING * BALL * r**3


@settings(max_examples=40, deadline=None)
@given(
    log_ratio=st.floats(-2.0, 6.0),
    inside=st.floats(-1.1, 1.1),
    planes=st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2)),
)
def test_volume_agrees_with_slices_anywhere(log_ratio, inside, planes):
    rho = 10.0**log_ratio
    b = abs(rho - inside)
    volume = _cut(1.0, b, rho, *sorted(planes))[0]
    assert abs(volume - ball_in_cylinder_by_slices(1.0, b, rho, *sorted(planes))) < ROUNDING * BALL


@settings(max_examples=40, deadline=None)
@given(log_distance=st.floats(-14.0, 0.0), offset=st.floats(-2.0, 2.0))
def test_volume_near_the_axis(log_distance, offset):
    b = 10.0**log_distance
    rho = 1.0 + offset * b
    assert abs(_cut(1.0, b, rho)[0] - ball_in_cylinder_by_strips(1.0, b, rho)) < ROUNDING * BALL


@pytest.mark.parametrize("ratio", [3.0, 12.9, 36.4, 1e4])
@pytest.mark.parametrize("gap", [0.0, 0.22, 0.9])
def test_volume_of_a_wall_layer_particle_is_the_published_integral(ratio, gap):
    b = ratio - 1.0 - gap
    volume = BALL - _cut(1.0, b, ratio - 1.0)[0]
    gap = mpmath.fsub(ratio - 1.0, b, exact=True)
    assert abs(volume - ball_beyond_cylinder_by_rings(1.0, gap, ratio)) < ROUNDING * BALL


@pytest.mark.parametrize("rho", [1e-8, 0.1, 0.5, 0.999999, 1.0, 2.0])
def test_ball_on_the_axis_is_a_ball_less_a_napkin_ring(rho):
    height = math.sqrt(max(0.0, (1.0 - rho) * (1.0 + rho)))
    volume, surface = _cut(1.0, 0.0, rho)
    assert volume == pytest.approx(BALL * (1.0 - height**3), abs=ROUNDING * BALL)
    assert surface == pytest.approx(4 * math.pi * (1.0 - height), abs=ROUNDING * 4 * math.pi)


def test_ball_half_in_a_wide_cylinder_is_half_a_ball_less_the_curvature():
    # to first order the cylinder's surface falls back by y^2/(2 rho): pi r^4/(8 rho) of volume
    for rho in (1e3, 1e4, 1e5):
        assert _cut(1.0, rho, rho)[0] == pytest.approx(BALL / 2 - math.pi / (8 * rho), abs=1e-15 + 0.1 / rho**3)


@pytest.mark.parametrize("t", [1.0, 1.5, -1.0, -2.0])
def test_touching_cylinder_takes_all_or_nothing(t):
    expected = (BALL, 4 * math.pi) if t > 0 else (0.0, 0.0)
    assert _cut(1.0, 8.0 - t, 8.0) == pytest.approx(expected, rel=1e-15)


def test_cylinder_inside_a_ball_is_a_cylinder():
    # the ball reaches past the cylinder at all heights between the planes
    volume, surface = _cut(10.0, 1.0, 0.5, -2.0, 3.0)
    assert volume == pytest.approx(5.0 * math.pi * 0.25, rel=1e-14)
    assert surface == 0.0


@pytest.mark.parametrize("ratio", [1.0, 1e3, 1e6, 1e9])
def test_place_in_cylinder_is_right_to_its_last_digits(ratio):
    rng = np.random.default_rng(5)
    for _ in range(50):
        angle, radial = rng.uniform(0, 2 * np.pi), ratio + rng.uniform(-1, 1)
        x, y, offset = radial * math.cos(angle), radial * math.sin(angle), rng.uniform(-1, 1)
        with mpmath.workdps(50):
            expected = mpmath.mpf(ratio) + mpmath.mpf(offset) - mpmath.hypot(x, y)
            distance, inside, rho = place_in_cylinder(x, y, ratio, offset)
            assert abs(inside / expected - 1) < 1e-15
        assert rho == ratio + offset
        assert distance == pytest.approx(math.hypot(x, y), rel=3e-16)


def test_place_on_the_axis_of_nothing():
    assert place_in_cylinder(0.0, 0.0, 1.0, -1.0) == (0.0, 0.0, 0.0)
    assert ball_in_cylinder(1.0, 0.0, 0.0, 0.0, 1.0) == (0.0, 0.0)


limits = st.tuples(st.floats(-1.3, 1.3), st.floats(-1.3, 1.3)).map(sorted)


@settings(max_examples=30, deadline=None)
@given(limits, limits, limits)
def test_ball_in_a_box_agrees_with_slices(x, y, z):
    # where an edge of the box all but touches the sphere, angles there are differences of nearly equal numbers:
    # 2e-14 of the ball was found at a distance of 1e-5, ten times that is allowed
    volume = ball_in_box(1.0, *x, *y, *z)[0]
    assert abs(volume - ball_in_box_by_slices(1.0, *x, *y, *z)) < 2e-13 * BALL


def test_a_box_whose_edge_all_but_touches_the_sphere():
    box = (0.0, 0.99999, 0.0, 1.0, 0.0, 0.001111135233838434)
    assert abs(ball_in_box(1.0, *box)[0] - ball_in_box_by_slices(1.0, *box)) < 2e-13 * BALL


@settings(max_examples=100, deadline=None)
@given(limits, limits, limits, st.floats(0.01, 0.99))
def test_surface_in_a_box_is_the_change_of_volume_with_the_radius(x, y, z, r):
    # volume(r) is smooth between the radii at which the sphere meets a new face, edge or corner
    marks = [abs(v) for v in (*x, *y, *z)]
    marks += [math.hypot(a, b) for p, q in ((x, y), (y, z), (z, x)) for a in p for b in q]
    marks += [math.hypot(a, b, c) for a in x for b in y for c in z]
    if min(abs(m - r) for m in marks) < 0.01:
        return
    step = 1e-4
    slope = (ball_in_box(r + step, *x, *y, *z)[0] - ball_in_box(r - step, *x, *y, *z)[0]) / (2 * step)
    # next term of the difference: step^2/6 of the third derivative, which the nearest mark bounds
    assert ball_in_box(r, *x, *y, *z)[1] == pytest.approx(slope, abs=3e-6)


def test_ball_in_a_box_closed_forms():
    far = 9.0
    cap = math.pi / 3 * 0.7**2 * 2.3
    assert ball_in_box(1.0, -far, far, -far, far, 0.3, far) == pytest.approx((cap, 1.4 * math.pi), rel=1e-15)
    assert ball_in_box(1.0, 0.0, far, 0.0, far, 0.0, far) == pytest.approx((BALL / 8, math.pi / 2), rel=1e-15)
    assert ball_in_box(2.0, -far, 0.0, 0.0, far, -far, far) == pytest.approx((2 * BALL, 4 * math.pi), rel=1e-15)
    assert ball_in_box(2.0, -far, far, -far, far, -far, far) == pytest.approx((8 * BALL, 16 * math.pi), rel=1e-15)
    # a cube inside the ball, and one that circumscribes it
    assert ball_in_box(1.0, -0.5, 0.5, -0.5, 0.5, -0.5, 0.5) == pytest.approx((1.0, 0.0), abs=ROUNDING * BALL)
    assert ball_in_box(1.0, *(-1.0, 1.0) * 3) == pytest.approx((BALL, 4 * math.pi), rel=1e-15)
    assert ball_in_box(1.0, 1.0, 2.0, -far, far, -far, far) == (0.0, 0.0)


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_kernels_compiled_and_not_agree():
    rng = np.random.default_rng(7)
    for _ in range(200):
        rho, t, z = 10 ** rng.uniform(-1, 4), rng.uniform(-1, 1), rng.uniform(-1, 1)
        b = abs(rho - t)
        for kernel, arguments in (
            (ball_in_cylinder, (1.0, b, rho - b, rho, z)),
            (ball_in_box, (1.0, *sorted((t, z)), -0.5, 0.4, *sorted((z, 0.2)))),
            (place_in_cylinder, (b, t, rho, z)),
        ):
            compiled, plain = np.array(kernel(*arguments)), np.array(kernel.py_func(*arguments))
            assert np.abs(compiled - plain).max() <= 1e-15 * max(1.0, np.abs(plain).max())


BED = """
import json, numpy as np, bedrad
from bedrad.packings.layers import layer_areas, layer_volumes
centers = np.random.default_rng(1).uniform([-.5, -.5, 0], [.5, .5, 2], (12, 3))
out = []
for wall, shift in ((bedrad.Tube(2.2), 0.0), (bedrad.Rod(1.0), 3.0), (bedrad.Plate(), 1.0)):
    c = centers[:, [0, 1, 2]] + ([0, 0, shift] if wall.kind == "plate" else [shift, 0, 0])
    bed = bedrad.Packing(c, .6, wall, max_overlap=2.0)
    window = bedrad.walls.Window((.3, 1.7), (-.3, .4) if wall.kind == "plate" else None)
    for measure in (layer_volumes, layer_areas):
        out.append(measure(bed, [0.0, 0.4, 1.1, 2.0], window).tolist())
print(json.dumps(out))
"""


def test_layers_are_the_same_with_the_compiler_off():
    results = []
    for off in ("0", "1"):
        run = subprocess.run(
            [sys.executable, "-c", BED],
            env=os.environ | {"NUMBA_DISABLE_JIT": off},
            capture_output=True,
            text=True,
            check=True,
        )
        results.append(np.array(json.loads(run.stdout)))
    assert results[0].max() > 0.3
    assert np.abs(results[0] - results[1]).max() <= 1e-15


def test_quadrature_rule_has_unit_weight():
    assert layer_kernels.WEIGHTS.sum() == pytest.approx(1.0, rel=1e-15)
    assert np.dot(layer_kernels.WEIGHTS, layer_kernels.NODES**31) == pytest.approx(1 / 32, rel=1e-13)
