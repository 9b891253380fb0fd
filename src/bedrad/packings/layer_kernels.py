"""Exact volumes and surfaces of balls cut by a coaxial cylinder, by planes, or by a box (pure numba kernels).

A ball of radius r has its centre at the distance b from the axis of a cylinder of radius rho, and t = rho - b
is how far its centre lies inside the cylinder. A slice at the height z above the centre is a circle of radius
s = sqrt(r^2 - z^2); 2 alpha is the angle of its arc inside the cylinder, seen from the slice's centre, and 2
beta the angle of the cylinder's arc inside the slice, seen from the axis. With L(z) the lens area of slice
and cylinder, dL/ds = 2 s alpha, and integrating by parts twice gives for the part between the mid-plane and
the plane z

    V = z L + 2/3 (z^3 - r^3) alpha + 2/3 [r^3 alpha(0) + int (r^2 + r z + z^2)/(r + z) q(z) d(beta/2)],
    S = 2 r {(z - r) alpha + r alpha(0) + int q(z)/(r + z) d(beta/2)},      q = s^2 + t (rho + b).

The integrands have no pole where the centre lies on the cylinder and no large terms that cancel for rho >> r.
In the angles used below they are smooth but for one nearby branch point (the ball touches the far side of the
cylinder from inside, r = b + rho); panels that grow geometrically away from it keep Gauss-Legendre quadrature
at rounding error. Every factor that can vanish (r - t, b + rho - r, ...) is formed without cancellation, as
in Kahan's triangle formulas.
"""

# numba has no types for its decorators; the kernels themselves are typed
# mypy: disallow-untyped-decorators=False

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = [
    "ball_in_box",
    "ball_in_cylinder",
    "cut_by_cylinders",
    "cut_by_planes",
    "place_in_cylinder",
]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_x, _w = np.polynomial.legendre.leggauss(16)
NODES: FloatArray = 0.5 * (1.0 + _x)
WEIGHTS: FloatArray = 0.5 * _w
PANEL_GROWTH = 4.0
SMALLEST_PANEL = 1e-17
SPLITTER = 134217729.0  # 2^27 + 1 halves the digits of a double (Veltkamp 1968)


@njit(cache=True)
def _square(a: float) -> tuple[float, float]:
    """Square of a number as an unevaluated sum of two doubles (Dekker 1971)."""
    c = SPLITTER * a
    high = c - (c - a)
    low = a - high
    product = a * a
    return product, ((high * high - product) + 2.0 * high * low) + low * low


@njit(cache=True)
def _sum(a: float, b: float) -> tuple[float, float]:
    """Sum of two numbers and its rounding error (Knuth 1969)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@njit(cache=True)
def place_in_cylinder(x: float, y: float, wall_radius: float, offset: float) -> tuple[float, float, float]:
    """Where the point (x, y) lies in the cylinder of radius `wall_radius + offset`.

    Returns the distance from the axis, how far the point lies inside the cylinder, and the cylinder's radius,
    all in the unit of the arguments. The second is right to its own last digits however thin the layer is
    beside the wall: rho - b = (rho^2 - x^2 - y^2)/(rho + b) with the numerator in doubled precision.
    """
    rho, rho_error = _sum(wall_radius, offset)
    rho_square, e1 = _square(rho)
    x_square, e2 = _square(x)
    y_square, e3 = _square(y)
    first, f1 = _sum(rho_square, -x_square)
    second, f2 = _sum(first, -y_square)
    numerator = second + (f1 + f2 + (e1 - e2 - e3) + 2.0 * rho * rho_error)
    distance = math.sqrt(x_square + y_square)
    span = rho + distance
    return distance, (numerator / span if span > 0.0 else 0.0), rho


@njit(cache=True)
def _segment(x: float) -> float:
    """(x - sin x)/2, the area of a circular segment of angle x and unit radius, to its own last digits."""
    if abs(x) > 1.0:
        return 0.5 * (x - math.sin(x))
    u = x * x
    series = 1.0 - u / 210.0 * (1.0 - u / 272.0)
    series = 1.0 - u / 72.0 * (1.0 - u / 110.0 * (1.0 - u / 156.0 * series))
    return x * u / 12.0 * (1.0 - u / 20.0 * (1.0 - u / 42.0 * series))


@njit(cache=True)
def _half_angles(s: float, t: float, span: float, outer: float, inner: float) -> tuple[float, float]:
    """Half angles alpha (at the slice's centre) and beta (at the axis) of a slice that crosses the cylinder.

    `span` is rho + b, `outer` is s^2 - t^2 and `inner` is span^2 - s^2. Half-angle formulas with these
    factors keep all digits for needle-like triangles (Kahan 2014).
    """
    far = span + s
    if t >= 0.0:
        alpha = 2.0 * math.atan2((s + t) * math.sqrt(inner), far * math.sqrt(outer))
    else:
        alpha = 2.0 * math.atan2(math.sqrt(outer * inner), (s - t) * far)
    return alpha, 2.0 * math.atan2(math.sqrt(outer), math.sqrt(inner))


@njit(cache=True)
def _arc_integrals(
    r: float, t: float, span: float, outer: float, inner: float, product: float, top: float
) -> tuple[float, float]:
    """Integrate over d(beta/2), as in the module's head, from the smallest height of the arc up to `top`.

    `outer` is r^2 - t^2 and `inner` r^2 - span^2, the squares of the arc's largest and smallest height
    (`inner` is negative where the arc reaches the mid-plane), and `product` is 4 b rho. The variable is the
    angle theta with z = sqrt(outer) sin(theta) where the arc reaches the mid-plane, else z^2 = inner +
    product sin^2(theta).
    """
    reaches = inner <= 0.0
    across = outer if reaches else product
    edge = top
    if abs(inner) < across * top * top:
        edge = min(top, max(math.sqrt(abs(inner) / across), SMALLEST_PANEL))
    height = math.sqrt(outer)
    base = t * span
    volume = surface = low = 0.0
    while True:
        width = edge - low
        for k in range(len(NODES)):
            sine = math.sin(low + width * NODES[k])
            weight = WEIGHTS[k] * width
            if reaches:
                z = height * sine
                weight *= z / math.sqrt(z * z - inner)
            else:
                z = math.sqrt(inner + product * sine * sine)
            value = weight * ((r - z) * (r + z) + base) / (r + z)
            surface += value
            volume += value * (r * r + r * z + z * z)
        if edge >= top:
            return volume, surface
        low = edge
        edge = min(top, PANEL_GROWTH * edge)


@njit(cache=True)
def ball_in_cylinder(r: float, b: float, t: float, rho: float, z: float) -> tuple[float, float]:
    """Volume and sphere surface of a ball inside a cylinder, between the ball's mid-plane and a plane.

    Parameters
    ----------
    r : float
        Radius of the ball. [m]
    b, t, rho : float
        Distance of its centre from the cylinder's axis, how far it lies inside the cylinder (rho - b), and
        the radius of the cylinder. [m]
    z : float
        Height of the plane above the centre; both results are odd in z. [m]

    Returns
    -------
    volume, surface : float
        [m3], [m2]
    """
    sign = 1.0 if z >= 0.0 else -1.0
    z = min(abs(z), r)
    if rho <= 0.0 or t <= -r:
        return 0.0, 0.0
    if t >= r:
        return sign * math.pi * z * (r * r - z * z / 3.0), sign * 2.0 * math.pi * r * z
    span = rho + b
    outer = (r - t) * (r + t)
    inner = -(2.0 * b - (r - t)) * (span + r)
    if inner >= 0.0 and z * z <= inner:
        return sign * math.pi * rho * rho * z, 0.0
    left, risen = outer - z * z, z * z - inner
    start = _half_angles(r, t, span, outer, -inner)[0] if inner < 0.0 else 0.0
    if left <= 0.0:
        top = 0.5 * math.pi
        alpha = math.pi if t > 0.0 else 0.0
        area = alpha * (r - z) * (r + z)
    else:
        alpha, beta = _half_angles(math.sqrt((r - z) * (r + z)), t, span, left, risen)
        area = (r - z) * (r + z) * _segment(2.0 * alpha) + rho * rho * _segment(2.0 * beta)
        top = math.atan2(z if inner <= 0.0 else math.sqrt(risen), math.sqrt(left))
    volume, surface = _arc_integrals(r, t, span, outer, inner, 4.0 * b * rho, top)
    volume += r * r * r * start - (r - z) * (r * r + r * z + z * z) * alpha
    surface += r * start - (r - z) * alpha
    return sign * (z * area + 2.0 / 3.0 * volume), sign * 2.0 * r * surface


@njit(cache=True)
def _cap(a: float) -> tuple[float, float]:
    """Volume and surface of the unit ball beyond the plane x = a."""
    a = min(max(a, -1.0), 1.0)
    return math.pi / 3.0 * (1.0 - a) ** 2 * (2.0 + a), 2.0 * math.pi * (1.0 - a)


@njit(cache=True)
def _wedge(a: float, b: float) -> tuple[float, float]:
    """Volume and surface of the unit ball beyond the planes x = a and y = b."""
    sign = 1.0
    volume = surface = 0.0
    if a < 0.0:
        volume, surface = _cap(b)
        sign, a = -1.0, -a
    if b < 0.0:
        v, s = _cap(a)
        volume, surface, sign, b = volume + sign * v, surface + sign * s, -sign, -b
    chord = 1.0 - a * a - b * b
    if chord > 0.0:
        half = math.sqrt(chord)
        on_a, on_b = math.atan2(half, b), math.atan2(half, a)
        s = 2.0 * (math.atan2(half, a * b) - a * on_a - b * on_b)
        faces = a * (1.0 - a * a) * _segment(2.0 * on_a) + b * (1.0 - b * b) * _segment(2.0 * on_b)
        volume += sign * (s - faces) / 3.0
        surface += sign * s
    return volume, surface


@njit(cache=True)
def _edge(a: float, b: float, c: float) -> tuple[float, float]:
    """Angle of the unit sphere's arc on x = a beyond y = b and z = c, and area of the face it bounds."""
    y, z = math.sqrt(1.0 - a * a - c * c), math.sqrt(1.0 - a * a - b * b)
    angle = math.atan2(z, b) - math.atan2(c, y)
    return angle, 0.5 * ((1.0 - a * a) * angle - b * (z - c) - c * (y - b))


@njit(cache=True)
def _corner(a: float, b: float, c: float) -> tuple[float, float]:
    """Volume and surface of the unit ball beyond the planes x = a, y = b and z = c.

    The surface follows from the Gauss-Bonnet theorem, the volume from the divergence theorem. Planes on the
    far side of the centre are folded to the near side by inclusion and exclusion.
    """
    sign = 1.0
    volume = surface = 0.0
    if a < 0.0:
        volume, surface = _wedge(b, c)
        sign, a = -1.0, -a
    if b < 0.0:
        v, s = _wedge(a, c)
        volume, surface, sign, b = volume + sign * v, surface + sign * s, -sign, -b
    if c < 0.0:
        v, s = _wedge(a, b)
        volume, surface, sign, c = volume + sign * v, surface + sign * s, -sign, -c
    if a * a + b * b + c * c < 1.0:
        on_a, face_a = _edge(a, b, c)
        on_b, face_b = _edge(b, c, a)
        on_c, face_c = _edge(c, a, b)
        angles = math.atan2(math.sqrt(1.0 - a * a - b * b), a * b)
        angles += math.atan2(math.sqrt(1.0 - b * b - c * c), b * c)
        angles += math.atan2(math.sqrt(1.0 - c * c - a * a), c * a)
        s = angles - math.pi - a * on_a - b * on_b - c * on_c
        volume += sign * (s - a * face_a - b * face_b - c * face_c) / 3.0
        surface += sign * s
    return volume, surface


@njit(cache=True)
def ball_in_box(r: float, x0: float, x1: float, y0: float, y1: float, z0: float, z1: float) -> tuple[float, float]:
    """Volume and sphere surface of a ball inside the box x0..x1, y0..y1, z0..z1, measured from its centre.

    Returns
    -------
    volume, surface : float
        [m3], [m2]
    """
    if min(x1, y1, z1) <= -r or max(x0, y0, z0) >= r:
        return 0.0, 0.0
    volume = surface = 0.0
    for i in range(2):
        x = x1 if i else x0
        if x >= r or (i and x <= -r):
            continue
        for j in range(2):
            y = y1 if j else y0
            if y >= r or (j and y <= -r):
                continue
            for k in range(2):
                z = z1 if k else z0
                if z >= r:
                    continue
                v, s = _corner(max(x / r, -1.0), max(y / r, -1.0), max(z / r, -1.0))
                sign = -1.0 if (i + j + k) % 2 else 1.0
                volume += sign * v
                surface += sign * s
    return volume * r * r * r, surface * r * r


@njit(cache=True)
def cut_by_cylinders(
    centers: FloatArray,
    radii: FloatArray,
    rows: IntArray,
    wall_radius: float,
    outward: float,
    edges: FloatArray,
    planes: FloatArray,
    volumes: FloatArray,
    surfaces: FloatArray,
) -> None:
    """Add what every ball has in every layer beside a tube or rod, between every two planes across z.

    Parameters
    ----------
    centers, radii : (n, 3), (n,) arrays
        The balls. [m]
    rows : (n,) array
        Row of the results that the first block of each ball is added to; block j goes to row `rows[i] + j`.
    wall_radius : float
        Radius of the wall. [m]
    outward : float
        +1 where depth grows away from the axis (a rod), -1 where it grows towards it (a tube).
    edges, planes : (l + 1,), (m + 1,) arrays
        Depths that bound the layers and heights z that bound the blocks, both rising. [m]
    volumes, surfaces : (rows, l) arrays
        Volumes and sphere surfaces, added to. [m3], [m2]
    """
    for i in range(len(radii)):
        r, z = radii[i], centers[i, 2]
        for j in range(len(planes) - 1):
            low, high = max(planes[j] - z, -r), min(planes[j + 1] - z, r)
            if high <= low:
                continue
            row = rows[i] + j
            last_volume = last_surface = 0.0
            for k in range(len(edges)):
                b, t, rho = place_in_cylinder(centers[i, 0], centers[i, 1], wall_radius, outward * edges[k])
                volume, surface = ball_in_cylinder(r, b, t, rho, high)
                if low == -high:
                    volume, surface = 2.0 * volume, 2.0 * surface
                else:
                    below = ball_in_cylinder(r, b, t, rho, low)
                    volume, surface = volume - below[0], surface - below[1]
                if k > 0:
                    # a layer that the ball only touches may come out a rounding error below nothing
                    volumes[row, k - 1] += max(0.0, outward * (volume - last_volume))
                    surfaces[row, k - 1] += max(0.0, outward * (surface - last_surface))
                last_volume, last_surface = volume, surface


@njit(cache=True)
def cut_by_planes(
    centers: FloatArray,
    radii: FloatArray,
    rows: IntArray,
    lateral: tuple[float, float],
    edges: FloatArray,
    planes: FloatArray,
    volumes: FloatArray,
    surfaces: FloatArray,
) -> None:
    """Add what every ball has in every layer over the plate z = 0, between every two planes across x.

    Parameters as for `cut_by_cylinders`; `lateral` is the range of y. [m]
    """
    for i in range(len(radii)):
        r, x, y, z = radii[i], centers[i, 0], centers[i, 1], centers[i, 2]
        for j in range(len(planes) - 1):
            low, high = planes[j] - x, planes[j + 1] - x
            if high <= -r or low >= r:
                continue
            row = rows[i] + j
            for k in range(len(edges) - 1):
                volume, surface = ball_in_box(
                    r, low, high, lateral[0] - y, lateral[1] - y, edges[k] - z, edges[k + 1] - z
                )
                volumes[row, k] += max(0.0, volume)
                surfaces[row, k] += max(0.0, surface)
