"""Rays of a picture against spheres and the wall, with a wedge of the bed taken out.

All rays are parallel. What is removed is convex, the space between two planes through a vertical line, so a ray is in
it for one interval: it sees a sphere where it enters the sphere before that, or the cut face where the interval ends.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

__all__ = ["draw_spheres", "draw_wall", "removed"]


@njit(cache=True, inline="always")
def removed(start, forward, planes):
    """Where a ray is in the removed wedge.

    Parameters
    ----------
    start, forward : (3,) arrays
        A point of the ray, relative to the middle of the wedge, and its direction.
    planes : (2, 3) array
        Normals of the planes that bound the wedge, into it; two opposite ones remove nothing.

    Returns
    -------
    near, far : float
        Distances from the point; near is the larger where the ray misses it.
    last : int
        The plane that the ray leaves by.
    """
    near, far, last = -math.inf, math.inf, 0
    for k in range(2):
        height = start[0] * planes[k, 0] + start[1] * planes[k, 1] + start[2] * planes[k, 2]
        slope = forward[0] * planes[k, 0] + forward[1] * planes[k, 1] + forward[2] * planes[k, 2]
        if abs(slope) < 1e-12:
            if height <= 0.0:
                return math.inf, -math.inf, 0
            continue
        distance = -height / slope
        if slope > 0.0:
            near = max(near, distance)
        elif distance < far:
            far, last = distance, k
    return near, far, last


@njit(cache=True)
def draw_spheres(centers, radii, axes, planes, pixel, distance, normals, points, cut):
    """Draw spheres into pictures of distance, normal and point; the nearest one counts.

    Parameters
    ----------
    centers, radii : (n, 3), (n,) arrays
        Spheres, relative to the middle of the picture and of the wedge. [m]
    axes : (3, 3) array
        Unit vectors to the right, up, and away from the eye.
    planes : (2, 3) array
        As `removed`.
    pixel : float
        Size of a pixel. [m]
    distance, normals, points, cut : (height, width), two (height, width, 3), (height, width) arrays
        Filled where a sphere is nearer than what is there: distance from the plane of the middle [m], outward normal,
        point seen [m], and whether it lies on a cut face.
    """
    height, width = distance.shape
    start = np.empty(3)
    right, up, forward = axes[0], axes[1], axes[2]
    for i in range(len(radii)):
        c, r = centers[i], radii[i]
        x = c[0] * right[0] + c[1] * right[1] + c[2] * right[2]
        y = c[0] * up[0] + c[1] * up[1] + c[2] * up[2]
        z = c[0] * forward[0] + c[1] * forward[1] + c[2] * forward[2]
        first_column = max(0, math.floor((x - r) / pixel + 0.5 * width))
        last_column = min(width - 1, math.floor((x + r) / pixel + 0.5 * width))
        first_row = max(0, math.floor(0.5 * height - (y + r) / pixel))
        last_row = min(height - 1, math.floor(0.5 * height - (y - r) / pixel))
        for row in range(first_row, last_row + 1):
            v = (0.5 * height - row - 0.5) * pixel
            for column in range(first_column, last_column + 1):
                u = (column + 0.5 - 0.5 * width) * pixel
                inside = r * r - (u - x) ** 2 - (v - y) ** 2
                if inside <= 0.0:
                    continue
                half = math.sqrt(inside)
                for k in range(3):
                    start[k] = u * right[k] + v * up[k]
                near, far, last = removed(start, forward, planes)
                seen = z - half
                on_cut = near < far and near <= seen < far
                if on_cut:
                    seen = far
                    if seen >= z + half:
                        continue
                if seen >= distance[row, column]:
                    continue
                distance[row, column], cut[row, column] = seen, on_cut
                for k in range(3):
                    points[row, column, k] = start[k] + seen * forward[k]
                    normals[row, column, k] = planes[last, k] if on_cut else (points[row, column, k] - c[k]) / r


@njit(cache=True)
def draw_wall(solid, axes, planes, pixel, distance, normals, cut, shown):
    """Draw the wall where it is nearer than what the pictures hold.

    Parameters
    ----------
    solid : (8,) array
        Outer radius of an upright cylinder and radius of its hole, lower ends of a box along x, y and z, and upper
        ends; of a cylinder only those along z count. Outer radius 0: the box itself; hole 0: none. [m]
    axes, planes, pixel, distance, normals, cut
        As `draw_spheres`; the wedge is taken out of a cylinder with a hole.
    shown : (height, width) array
        Set where the wall is seen.
    """
    height, width = distance.shape
    start, normal = np.empty(3), np.empty(3)
    right, up, forward = axes[0], axes[1], axes[2]
    for row in range(height):
        v = (0.5 * height - row - 0.5) * pixel
        for column in range(width):
            u = (column + 0.5 - 0.5 * width) * pixel
            for k in range(3):
                start[k] = u * right[k] + v * up[k]
            seen, flat = _enter(solid, start, forward, planes, normal)
            if seen < distance[row, column]:
                distance[row, column], cut[row, column], shown[row, column] = seen, flat, True
                for k in range(3):
                    normals[row, column, k] = normal[k]


@njit(cache=True)
def _enter(solid, start, forward, planes, normal):
    """Distance at which a ray meets the wall, inf if it does not, and whether on a cut face; sets the normal there."""
    outer, hole = solid[0], solid[1]
    begin, end = _enter_box(solid, start, forward, 2 if outer > 0.0 else 0, normal)
    if outer > 0.0:
        near, far = _inside_cylinder(start, forward, outer)
        if near > begin:
            begin = near
            _round_normal(start, forward, begin, 1.0, normal)
        end = min(end, far)
    flat = False
    if hole > 0.0 and begin < end:
        hole_near, hole_far = _inside_cylinder(start, forward, hole)
        near, far, last = removed(start, forward, planes)
        # out of the hole into the wedge and out of the wedge into the hole, until the ray stands in the wall
        for _ in range(4):
            if hole_near <= begin < hole_far:
                begin, flat = hole_far, False
                _round_normal(start, forward, begin, -1.0, normal)
            elif near <= begin < far:
                begin, flat = far, True
                normal[:] = planes[last]
            else:
                break
    return (begin if begin < end else math.inf), flat


@njit(cache=True)
def _enter_box(solid, start, forward, first, normal):
    """Where a ray is between the planes across the axes from `first` on; sets the normal where it comes in."""
    begin, end = -math.inf, math.inf
    for axis in range(first, 3):
        low, high = solid[2 + axis] - start[axis], solid[5 + axis] - start[axis]
        if abs(forward[axis]) < 1e-12:
            if low > 0.0 or high < 0.0:
                return math.inf, -math.inf
            continue
        near, far = min(low / forward[axis], high / forward[axis]), max(low / forward[axis], high / forward[axis])
        if near > begin:
            begin = near
            normal[:] = 0.0
            normal[axis] = -math.copysign(1.0, forward[axis])
        end = min(end, far)
    return begin, end


@njit(cache=True)
def _inside_cylinder(start, forward, radius):
    """Where a ray is inside an upright cylinder."""
    a = forward[0] ** 2 + forward[1] ** 2
    c = start[0] ** 2 + start[1] ** 2 - radius * radius
    if a < 1e-24:
        return (-math.inf, math.inf) if c < 0.0 else (math.inf, -math.inf)
    b = (start[0] * forward[0] + start[1] * forward[1]) / a
    square = b * b - c / a
    if square <= 0.0:
        return math.inf, -math.inf
    half = math.sqrt(square)
    return -b - half, -b + half


@njit(cache=True)
def _round_normal(start, forward, distance, sign, normal):
    """Set the normal of an upright cylinder at a point of a ray."""
    x, y = start[0] + distance * forward[0], start[1] + distance * forward[1]
    length = max(math.hypot(x, y), 1e-300)
    normal[0], normal[1], normal[2] = sign * x / length, sign * y / length, 0.0
