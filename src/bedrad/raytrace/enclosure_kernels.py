"""Rays between all surfaces of a bed: from the wall and from the spheres, to where they end or are absorbed.

A zone is the wall (number 0), or what of the spheres' surface lies in one layer and faces the wall by one range of
angles: ``1 + layer * orientations + bin``. Bin 0 faces the wall, the last one looks away from it; all bins of a whole
sphere have the same area. After the zones come "beyond the last layer" and "escaped".

Arrays and scalars in, results out or into the arrays given for them; no state is kept. A grid is the tuple of lower
corner, cell size, number of cells, periods, starts and columns that `bedrad.raytrace.kernels.first_hit` takes.
"""

# numba infers the types of its kernels; their docstrings say what they take
# mypy: disallow-untyped-defs=False, disallow-untyped-calls=False, disallow-untyped-decorators=False

from __future__ import annotations

import math

import numpy as np
from numba import njit

from bedrad.raytrace.kernels import ESCAPED, LIMIT, OPTIONS, PLATE, TUBE, first_hit, turn

__all__ = ["LIFT", "follow_once", "follow_reflections", "random_unit", "start_on_spheres"]

LIFT = 1e-9
"""Rays start this far above their sphere, in its radii: on its surface rounding would let half of them end at once.

Of a touching neighbour's share that takes less than 1e-8: what starts within sqrt(2 LIFT) radii of the contact.
"""

ON_SURFACE = 1e-6
"""A point nearer than this to a sphere's surface, in its radii, lies on it."""

SHORT = 1e-12
"""Rays end this far before the wall, in their length."""

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_S11, _S27, _S30, _S31 = np.uint64(11), np.uint64(27), np.uint64(30), np.uint64(31)


@njit(**OPTIONS)
def _mix(z):
    """Scatter the bits of a counter (the finaliser of SplitMix64, Steele, Lea and Flood 2014)."""
    z = (z ^ (z >> _S30)) * _FIRST
    z = (z ^ (z >> _S27)) * _SECOND
    return z ^ (z >> _S31)


@njit(**OPTIONS)
def random_unit(key, number):
    """Random number in (0, 1) of a key, by its place in the key's sequence.

    Parameters
    ----------
    key : uint64
        Names the sequence.
    number : int
        Place in it.
    """
    bits = _mix(_mix(key + _GOLDEN) + np.uint64(number) * _GOLDEN)
    return (np.float64(bits >> _S11) + 0.5) * (1.0 / 9007199254740992.0)


@njit(**OPTIONS)
def _lambert(nx, ny, nz, u, v):
    """Unit direction by the cosine law about a unit normal, from two numbers in [0, 1)."""
    cosine, sine = math.sqrt(1.0 - u), math.sqrt(u)
    c, s = turn(v)
    # the axis that the normal leans to least gives a tangent without cancellation
    if abs(nx) < 0.6:
        scale = 1.0 / math.sqrt(ny * ny + nz * nz)
        tx, ty, tz = 0.0, -nz * scale, ny * scale
    else:
        scale = 1.0 / math.sqrt(nx * nx + nz * nz)
        tx, ty, tz = nz * scale, 0.0, -nx * scale
    bx, by, bz = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
    a, b = sine * c, sine * s
    return cosine * nx + a * tx + b * bx, cosine * ny + a * ty + b * by, cosine * nz + a * tz + b * bz


@njit(**OPTIONS)
def _wall_normal(kind, x, y):
    """Unit normal of the wall, into the bed, at the wall point nearest to a point."""
    if kind == PLATE:
        return 0.0, 0.0, 1.0
    rho = math.sqrt(x * x + y * y)
    if rho == 0.0:
        return 1.0, 0.0, 0.0
    outward = -1.0 / rho if kind == TUBE else 1.0 / rho
    return outward * x, outward * y, 0.0


@njit(**OPTIONS)
def _zone(kind, wall_radius, edges, orientations, x, y, z, nx, ny, nz):
    """Zone of a point on a sphere with a normal there; the first number after all zones beyond the last layer."""
    if kind == PLATE:
        depth = z
    else:
        rho = math.sqrt(x * x + y * y)
        depth = wall_radius - rho if kind == TUBE else rho - wall_radius
    layers = edges.size - 1
    layer = 0
    while layer < layers and depth > edges[layer + 1]:
        layer += 1
    if layer == layers or orientations == 1:
        return 1 + layer * orientations
    wx, wy, wz = _wall_normal(kind, x, y)
    away = 0.5 * (1.0 + nx * wx + ny * wy + nz * wz)
    return 1 + layer * orientations + min(max(int(away * orientations), 0), orientations - 1)


@njit(**OPTIONS)
def _into(x, low, period):
    """A coordinate moved by whole periods into [low, low + period], or as it is where there is no period."""
    return min(x - period * math.floor((x - low) / period), low + period) if period > 0.0 else x


@njit(**OPTIONS)
def start_on_spheres(points, spheres, shares, kind, wall_radius, window, period, edges, orientations, rays, zones):
    """Rays from the surfaces of spheres, uniform over the area, by the cosine law.

    Parameters
    ----------
    points : (n, 5) array
        Points of the unit hypercube: sphere, position on it (2), direction (2).
    spheres : (4, m) array
        Centres and radii.
    shares : (m,) array
        Sum of the spheres' areas up to each one, the last 1.
    kind, wall_radius : int, float
        The wall.
    window : (4,) array
        Axial start and length, lateral start and length of the window.
    period : (3,) array
        Periods, 0 where open.
    edges : (layers + 1,) array
        Depths that part the layers.
    orientations : int
        Ranges of angles to the wall.
    rays : (6, n) array
        Filled with origins and unit directions.
    zones : (n,) int array
        Filled with the zone of each start, -1 for points outside the window or the layers, which emit nothing.
    """
    axial = 0 if kind == PLATE else 2
    for i in range(points.shape[0]):
        s = min(np.searchsorted(shares, points[i, 0], side="right"), shares.size - 1)
        nz = 1.0 - 2.0 * points[i, 1]
        flat = 2.0 * math.sqrt(points[i, 1] * (1.0 - points[i, 1]))
        c, sine = turn(points[i, 2])
        nx, ny, radius = flat * c, flat * sine, spheres[3, s]
        x, y, z = spheres[0, s] + radius * nx, spheres[1, s] + radius * ny, spheres[2, s] + radius * nz
        along = _into(x if axial == 0 else z, window[0], period[axial])
        inside = window[0] <= along <= window[0] + window[1]
        if kind == PLATE:
            across = _into(y, window[2], period[1])
            inside = inside and window[2] <= across <= window[2] + window[3] and z >= edges[0]
        else:
            rho = math.sqrt(x * x + y * y)
            inside = inside and (wall_radius - rho if kind == TUBE else rho - wall_radius) >= edges[0]
        zone = _zone(kind, wall_radius, edges, orientations, x, y, z, nx, ny, nz)
        zones[i] = zone if inside and zone <= (edges.size - 1) * orientations else -1
        lift = LIFT * radius
        rays[0, i] = _into(x + lift * nx, 0.0, period[0])
        rays[1, i] = _into(y + lift * ny, 0.0, period[1])
        rays[2, i] = _into(z + lift * nz, 0.0, period[2])
        dx, dy, dz = _lambert(nx, ny, nz, points[i, 3], points[i, 4])
        rays[3, i], rays[4, i], rays[5, i] = dx, dy, dz


@njit(**OPTIONS)
def _limits(kind, wall_radius, reach, x, y, z, dx, dy, dz):
    """Distances from a point of the bed to the wall and to where the ray gets deeper than `reach`, or infinite.

    In a tube a ray always meets the wall; its grid must hold the whole bed.
    """
    if kind == PLATE:
        if dz < 0.0:
            return max(-z / dz, 0.0), math.inf
        return math.inf, (reach - z) / dz if dz > 0.0 else math.inf
    flat = dx * dx + dy * dy
    if flat < 1e-300:
        return math.inf, math.inf
    b = x * dx + y * dy
    c = (math.sqrt(x * x + y * y) - wall_radius) * (math.sqrt(x * x + y * y) + wall_radius)
    if kind == TUBE:
        root = math.sqrt(max(b * b - flat * c, 0.0))
        return max(-c / (b + root) if b > 0.0 else (root - b) / flat, 0.0), math.inf
    square = b * b - flat * c
    wall = math.inf
    if b < 0.0 and square > 0.0:
        wall = max(c / (math.sqrt(square) - b), 0.0)
    c -= reach * (2.0 * wall_radius + reach)
    root = math.sqrt(max(b * b - flat * c, 0.0))
    return wall, max(-c / (b + root) if b > 0.0 else (root - b) / flat, 0.0)


@njit(**OPTIONS)
def _sphere_at(x, y, z, dx, dy, dz, grid):
    """Centre and radius of the sphere whose surface holds a point where a ray ended; the nearest surface otherwise."""
    low, size, cells, _, starts, columns = grid
    best, which = math.inf, 0
    # the end of a ray may lie, by rounding, in the cell beside that where it was found
    for step in (0.0, 1e-9, -1e-9):
        ix = min(max(int((x - low[0]) / size[0] + step * dx), 0), cells[0] - 1)
        iy = min(max(int((y - low[1]) / size[1] + step * dy), 0), cells[1] - 1)
        iz = min(max(int((z - low[2]) / size[2] + step * dz), 0), cells[2] - 1)
        cell = (ix * cells[1] + iy) * cells[2] + iz
        for k in range(starts[cell], starts[cell + 1]):
            cx, cy, cz = x - columns[0, k], y - columns[1, k], z - columns[2, k]
            radius = math.sqrt(columns[3, k])
            off = abs(math.sqrt(cx * cx + cy * cy + cz * cz) - radius) / radius
            if off < best:
                best, which = off, k
        if best < ON_SURFACE:
            break
    return columns[0, which], columns[1, which], columns[2, which], math.sqrt(columns[3, which])


@njit(**OPTIONS)
def _fly(ray, kind, wall_radius, edges, orientations, reach, grid, room):
    """End of one ray: its zone, the point (moved back into the bed's period) and the surface's normal there.

    ``ray`` is the tuple of origin and direction. The normal of what lies beyond, or escapes, is zero.
    """
    low, size, cells, period, starts, columns = grid
    x, y, z, dx, dy, dz = ray
    beyond = 1 + (edges.size - 1) * orientations
    wall, deep = _limits(kind, wall_radius, reach, x, y, z, dx, dy, dz)
    t = LIMIT
    if wall > 0.0:
        # a plate is a face of the grid: rounding must not take the ray through it before it is at the wall
        limit = min(wall * (1.0 - SHORT), deep)
        t = first_hit(x, y, z, dx, dy, dz, limit, low, size, cells, period, starts, columns, room)
    if t == ESCAPED:
        return beyond + 1, x, y, z, 0.0, 0.0, 0.0
    met = t < LIMIT
    if not met:
        t = min(wall, deep)
        if deep < wall or t == math.inf:
            return beyond, x, y, z, 0.0, 0.0, 0.0
    x = _into(x + t * dx, 0.0, period[0])
    y = _into(y + t * dy, 0.0, period[1])
    z = _into(z + t * dz, 0.0, period[2])
    if not met:
        nx, ny, nz = _wall_normal(kind, x, y)
        return 0, x, y, z, nx, ny, nz
    cx, cy, cz, radius = _sphere_at(x, y, z, dx, dy, dz, grid)
    nx, ny, nz = x - cx, y - cy, z - cz
    scale = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz)
    nx, ny, nz = scale * nx, scale * ny, scale * nz
    zone = _zone(kind, wall_radius, edges, orientations, x, y, z, nx, ny, nz)
    lift = LIFT * radius
    return zone, x + lift * nx, y + lift * ny, z + lift * nz, nx, ny, nz


@njit(**OPTIONS)
def follow_once(rays, zones, kind, wall_radius, edges, orientations, reach, grid, room, counts):
    """Count rays by the zones where they start and end.

    Parameters
    ----------
    rays : (6, n) array
        Origins and unit directions.
    zones : (n,) int array
        Zones where they start; rays of a negative one are not followed.
    kind, wall_radius, edges, orientations
        As for `start_on_spheres`.
    reach : float
        Depth down to which the grid is complete, the radius of a tube, the last edge beside a rod or plate.
    grid : tuple
        Lower corner, cell size, number of cells, periods, starts and columns.
    room : (k,) array
        Room for the distances to the spheres of one cell.
    counts : (zones, zones + 2) int array
        Added to.
    """
    for i in range(zones.size):
        if zones[i] >= 0:
            ray = (rays[0, i], rays[1, i], rays[2, i], rays[3, i], rays[4, i], rays[5, i])
            counts[zones[i], _fly(ray, kind, wall_radius, edges, orientations, reach, grid, room)[0]] += 1


@njit(**OPTIONS)
def follow_reflections(rays, key, emissivities, most, kind, wall_radius, edges, reach, grid, room, counts):
    """Count rays by the zone that absorbs them; what is not absorbed goes on by the cosine law from where it ended.

    Parameters
    ----------
    rays : (6, n) array
        Origins and unit directions.
    key : uint64
        Names the random numbers.
    emissivities : (2,) array
        Of wall and spheres: the probability that a ray is absorbed where it ends. Beyond and escaped absorb all.
    most : int
        Reflections after which a ray ends where it is.
    kind, wall_radius, edges, reach, grid, room
        As for `follow_once`.
    counts : (layers + 3,) int array
        Added to: wall, layers, beyond, escaped.

    Returns
    -------
    int, int
        Number of reflections of all rays, number of rays that `most` ended.
    """
    beyond = edges.size
    reflections, ended = 0, 0
    for i in range(rays.shape[1]):
        own = _mix(key ^ np.uint64(i + 1) * _GOLDEN)
        ray = (rays[0, i], rays[1, i], rays[2, i], rays[3, i], rays[4, i], rays[5, i])
        met = 0
        while True:
            zone, x, y, z, nx, ny, nz = _fly(ray, kind, wall_radius, edges, 1, reach, grid, room)
            if zone >= beyond or random_unit(own, 3 * met) < emissivities[1 if zone > 0 else 0]:
                break
            if met == most:
                ended += 1
                break
            dx, dy, dz = _lambert(nx, ny, nz, random_unit(own, 3 * met + 1), random_unit(own, 3 * met + 2))
            ray = (x, y, z, dx, dy, dz)
            met += 1
        reflections += met
        counts[zone] += 1
    return reflections, ended
