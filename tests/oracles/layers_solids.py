"""Slow, literal references for balls cut by a cylinder or a box, by routes the kernels do not take."""

from __future__ import annotations

import itertools

import mpmath
from mpmath import mp, mpf


def _lens(s, b, rho):
    """Area common to two circles, the textbook formula: cancels badly, so it needs the digits."""
    if b >= s + rho:
        return mpf(0)
    if b <= abs(s - rho):
        return mpmath.pi * min(s, rho) ** 2
    in_first = mpmath.acos((b * b + s * s - rho * rho) / (2 * b * s))
    in_second = mpmath.acos((b * b + rho * rho - s * s) / (2 * b * rho))
    kite = mpmath.sqrt((-b + s + rho) * (b + s - rho) * (b - s + rho) * (b + s + rho)) / 2
    return s * s * in_first + rho * rho * in_second - kite


def _arc(s, b, rho):
    """Angle of the arc of a circle of radius s that lies inside the other circle."""
    if b >= s + rho or b <= s - rho:
        return mpf(0)
    if b <= rho - s:
        return 2 * mpmath.pi
    return 2 * mpmath.acos((b * b + s * s - rho * rho) / (2 * b * s))


def _between(low, high, points):
    return sorted({low, high, *(p for p in points if low < p < high)})


def _slices(function, r, b, rho, low, high):
    """Integral over heights of a function of the slice's radius, split where the slice changes its kind."""
    with mp.workdps(34):
        r, b, rho = mpf(r), mpf(b), mpf(rho)
        low, high = max(mpf(low), -r), min(mpf(high), r)
        if high <= low:
            return 0.0
        turns = [mpmath.sqrt(r * r - s * s) for s in (abs(rho - b), rho + b) if s < r]
        points = _between(low, high, [mpf(0), *turns, *(-t for t in turns)])
        return mpmath.quad(lambda z: function(mpmath.sqrt(abs(r * r - z * z)), b, rho), points)


def ball_in_cylinder_by_slices(r, b, rho, low, high):
    """Volume between two heights, as the integral of the lens areas of slices across the axis."""
    return _slices(_lens, r, b, rho, low, high)


def sphere_in_cylinder_by_slices(r, b, rho, low, high):
    """Sphere surface between two heights: r times the arc of every slice."""
    return r * _slices(_arc, r, b, rho, low, high)


def ball_in_cylinder_by_strips(r, b, rho):
    """Volume as the integral over planes across the line of centres: circles cut by the strip |y| < width."""

    def area(x):
        s, width = mpmath.sqrt(abs(r * r - (x - b) ** 2)), mpmath.sqrt(abs(rho * rho - x * x))
        if width >= s:
            return mpmath.pi * s * s
        return 2 * (width * mpmath.sqrt(s * s - width * width) + s * s * mpmath.asin(width / s))

    with mp.workdps(24):
        r, b, rho = mpf(r), mpf(b), mpf(rho)
        low, high = max(-rho, b - r), min(rho, b + r)
        if high <= low:
            return 0.0
        # width = s where r^2 - (x - b)^2 = rho^2 - x^2
        meet = [(rho * rho - r * r + b * b) / (2 * b)] if b else []
        return mpmath.quad(area, _between(low, high, meet))


def ball_beyond_cylinder_by_rings(r, gap, ratio):
    """Volume in the layer 0..r of a tube of radius `ratio` r at a gap in radii: Watkins 2018, eq. 88.

    Integral over rings around the particle's own axis, with the missing dr and the missing factor 2 in the
    denominator of the arccosine's argument restored.
    """

    def ring(x):
        argument = (x * x - 2 * ratio * gap - 1 + (1 + gap) ** 2) / (2 * x * (ratio - 1 - gap))
        return 2 * x * mpmath.sqrt(1 - x * x) * (2 * mpmath.pi - 2 * mpmath.acos(argument))

    with mp.workdps(24):
        gap, ratio = mpf(gap), mpf(ratio)
        return r**3 * mpmath.quad(ring, [gap, 1])


def _circle_in_rectangle(s, x0, x1, y0, y1):
    low, high = max(x0, -s), min(x1, s)
    if high <= low:
        return mpf(0)
    turns = [mpmath.sqrt(s * s - y * y) for y in (y0, y1) if abs(y) < s]
    points = _between(low, high, [*turns, *(-t for t in turns)])

    def under(x):
        return (x * mpmath.sqrt(abs(s * s - x * x)) + s * s * mpmath.asin(max(min(x / s, 1), -1))) / 2

    area = mpf(0)
    for left, right in itertools.pairwise(points):
        arc, middle = under(right) - under(left), (left + right) / 2
        half = mpmath.sqrt(s * s - middle * middle)
        top = y1 * (right - left) if y1 < half else arc
        bottom = y0 * (right - left) if y0 > -half else -arc
        area += top - bottom if min(y1, half) > max(y0, -half) else 0
    return area


def ball_in_box_by_slices(r, x0, x1, y0, y1, z0, z1):
    """Volume in a box, as the integral over z of the area of a circle in a rectangle."""
    with mp.workdps(22):
        r, x0, x1, y0, y1 = (mpf(v) for v in (r, x0, x1, y0, y1))
        low, high = max(mpf(z0), -r), min(mpf(z1), r)
        if high <= low:
            return 0.0
        sides = [abs(v) for v in (x0, x1, y0, y1)] + [mpmath.hypot(x, y) for x in (x0, x1) for y in (y0, y1)]
        turns = [mpmath.sqrt(r * r - v * v) for v in sides if v < r]
        points = _between(low, high, [*turns, *(-t for t in turns)])
        return mpmath.quad(lambda z: _circle_in_rectangle(mpmath.sqrt(abs(r * r - z * z)), x0, x1, y0, y1), points)
