"""Kernels around a mesh engine: rays in the order and the numbers it likes, and where they end in double precision.

The engine itself only says which triangle a ray meets first; the distance follows from the plane of the triangle.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from bedrad.raytrace.kernels import OPTIONS, TUBE, UNSETTLED, _far_limit, _layer

__all__ = ["GOING_ON", "end_ray", "end_rays", "ray_keys", "scale_rays"]

GOING_ON = -2
"""Fate of a ray that left the images of a periodic bed and goes on from its other side."""


@njit(**OPTIONS)
def ray_keys(points, keys):
    """Numbers by which rays of one place and direction become neighbours.

    The 16 bits are, from the highest: five each of the positions along and around the wall, in turn (Morton), then
    three each of the polar angle and the azimuth, in turn. Numbers of 16 bits are sorted in linear time.

    Parameters
    ----------
    points : (n, 4) array
        Points of the unit hypercube, see `bedrad.raytrace.kernels.start_ray`.
    keys : (n,) array of uint16
        Filled.
    """
    for i in range(points.shape[0]):
        along, around = int(points[i, 0] * 32.0), int(points[i, 1] * 32.0)
        polar, azimuth = int(points[i, 2] * 8.0), int(points[i, 3] * 8.0)
        key = 0
        for bit in range(4, -1, -1):
            key = key << 2 | (along >> bit & 1) << 1 | (around >> bit & 1)
        for bit in range(2, -1, -1):
            key = key << 2 | (polar >> bit & 1) << 1 | (azimuth >> bit & 1)
        keys[i] = key


@njit(**OPTIONS)
def scale_rays(rays, middle, scale, scaled):
    """Fill the (n, 6) float32 array `scaled`: origins of (7, n) rays about `middle` over `scale`, and directions."""
    for i in range(rays.shape[1]):
        for k in range(3):
            scaled[i, k] = np.float32((rays[k, i] - middle[k]) / scale)
            scaled[i, 3 + k] = np.float32(rays[3 + k, i])


@njit(inline="always", **OPTIONS)
def _in_one_of(spheres, members, first, last, x, y, z):
    """Whether a point lies in one of some spheres (centre, radius), numbered by a run of `members`."""
    for k in range(first, last):
        sphere = spheres[members[k]]
        ax, ay, az = x - sphere[0], y - sphere[1], z - sphere[2]
        if ax * ax + ay * ay + az * az < sphere[3] * sphere[3]:
            return True
    return False


@njit(inline="always", **OPTIONS)
def _distance(ox, oy, oz, dx, dy, dz, sphere, facet, factor):
    """Distance to a facet (normal, distance from the centre) of a sphere's mesh; 0 if the ray meets it from inside."""
    nx, ny, nz = facet[0], facet[1], facet[2]
    slope = nx * dx + ny * dy + nz * dz
    if slope >= 0.0:
        return 0.0
    x, y, z = sphere[0] - ox, sphere[1] - oy, sphere[2] - oz
    size = sphere[3] * factor
    along = x * dx + y * dy + z * dz
    t = (size * facet[3] + x * nx + y * ny + z * nz) / slope
    # a facet seen edge-on says little about the distance; the hit cannot lie outside the sphere around the mesh
    return max(min(max(t, along - size), along + size), 0.0)


@njit(inline="always", **OPTIONS)
def _way_out(o, d, low, high):
    """Distance to the faces of a box along one axis, from inside it."""
    if d > 0.0:
        return (high - o) / d
    if d < 0.0:
        return (low - o) / d
    return math.inf


@njit(inline="always", **OPTIONS)
def _go_on(i, leave, rays, gone, period):
    """Move a ray on by the distance `leave`, and back into the box along the periodic axes."""
    gone[i] += leave
    for k in range(3):
        rays[k, i] += leave * rays[3 + k, i]
        if period[k] > 0.0:
            rays[k, i] -= period[k] * math.floor(rays[k, i] / period[k])


@njit(inline="always", **OPTIONS)
def end_ray(i, t, rays, gone, kind, wall_radius, edges, reach, low, high, period):
    """Fate of a ray that meets a sphere at the distance t; one that leaves the box first is moved to where it goes on.

    Parameters are those of `end_rays`.
    """
    layers = edges.size - 1
    ox, oy, oz, dx, dy, dz = rays[0, i], rays[1, i], rays[2, i], rays[3, i], rays[4, i], rays[5, i]
    wall, deep = _far_limit(kind, wall_radius, reach, dx, dy, rays[6, i])
    end = min(wall, deep) - gone[i]
    x, y = _way_out(ox, dx, low[0], high[0]), _way_out(oy, dy, low[1], high[1])
    z = _way_out(oz, dz, low[2], high[2])
    leave = min(x, min(y, z))
    if t < end and t <= leave:
        return _layer(kind, wall_radius, edges, ox + t * dx, oy + t * dy, oz + t * dz)
    if end <= leave:
        if wall <= deep:
            return layers + 1
        return UNSETTLED if kind == TUBE else layers
    if period[0 if x == leave else (1 if y == leave else 2)] == 0.0:
        return layers + 2
    _go_on(i, leave, rays, gone, period)
    return GOING_ON


@njit(**OPTIONS)
def end_rays(
    triangles,
    rays,
    gone,
    kind,
    wall_radius,
    edges,
    reach,
    low,
    high,
    period,
    spheres,
    facets,
    factor,
    starts,
    members,
    fates,
):
    """Say where rays end, given the triangles that they meet first.

    Rays that leave the images of a periodic bed are moved to where they go on.

    Parameters
    ----------
    triangles : (n,) array of int
        Number of the first triangle, those of one sphere after the other; -1 for none.
    rays : (7, n) array
        See `bedrad.raytrace.kernels.trace`.
    gone : (n,) array
        Distance of each origin from the wall that the ray started from, added to for those that go on.
    kind : int
        `TUBE`, `ROD` or `PLATE`.
    wall_radius : float
        Radius of the wall.
    edges : (layers + 1,) array
        Depths that part the layers.
    reach : float
        Depth down to which the mesh is complete.
    low, high, period : (3,) arrays
        Corners of the box in which the mesh is complete, and the period of the bed along each axis (0: open).
    spheres : (m, 4) array
        Centres and radii of the meshed spheres.
    facets : (f, 4) array
        Outer normals of the triangles of the unit mesh, and their planes' distances from its centre.
    factor : float
        Size of the mesh, in radii.
    starts, members : (m + 1,), (k,) arrays
        Which of the spheres that overlap the wall each sphere overlaps.
    fates : (n,) array
        Filled with where each ray ends: the number of the layer, and from there on beyond the last, back to the wall,
        escaped; `UNSETTLED` for rays of a tube that got deeper than the mesh, `GOING_ON` for rays to be traced again.

    Returns
    -------
    int
        Number of rays that go on.
    """
    count = facets.shape[0]
    going_on = 0
    for i in range(triangles.size):
        ox, oy, oz, dx, dy, dz = rays[0, i], rays[1, i], rays[2, i], rays[3, i], rays[4, i], rays[5, i]
        t = math.inf
        if triangles[i] >= 0:
            met = triangles[i] // count
            t = _distance(ox, oy, oz, dx, dy, dz, spheres[met], facets[triangles[i] % count], factor)
            # from inside a sphere that overlaps the wall, the first triangle is its own from inside, or that of a
            # sphere that overlaps it
            if _in_one_of(spheres, members, starts[met], starts[met + 1], ox, oy, oz):
                t = 0.0
        fates[i] = end_ray(i, t, rays, gone, kind, wall_radius, edges, reach, low, high, period)
        going_on += fates[i] == GOING_ON
    return going_on
