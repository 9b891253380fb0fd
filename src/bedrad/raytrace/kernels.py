"""Ray kernels: from a point on the wall to the first sphere or back to the wall, on exact spheres.

Arrays and scalars in, results out or into the arrays given for them; no state is kept. They release the interpreter
lock, so that several threads run the same compiled code on different rays; counts are integers, so that their sums do
not depend on the order.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

__all__ = [
    "ESCAPED",
    "LIMIT",
    "PLATE",
    "ROD",
    "TUBE",
    "UNSETTLED",
    "first_hit",
    "sphere_distances",
    "start_ray",
    "start_rays",
    "trace",
    "turn",
]

OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": {"contract"}}
"""How the kernels are compiled; "contract" allows fused multiply-add, nothing that changes the order of sums."""

TUBE, ROD, PLATE = 0, 1, 2

LIMIT = math.inf
"""Distance returned by `first_hit` when the ray reached its limit without a hit."""

UNSETTLED = -1
"""Fate of a ray that left the part of the bed that a grid covers."""

ESCAPED = -1.0
"""Distance returned by `first_hit` when the ray left through an open end of the bed."""


@njit(**(OPTIONS | {"fastmath": {"contract", "nnan", "nsz"}}))
def sphere_distances(ox, oy, oz, dx, dy, dz, columns, first, count, distances):
    """Distances along a ray to a run of spheres: 0 from inside one, infinite where it is missed.

    The half chord comes from the distance between centre and ray, not from the difference of two squares of the
    distance to the centre, so that far spheres lose no digits. There is no branch, so that the compiler tests several
    spheres at a time; it may take every number as one (none is nan) and ignore the sign of zero to do so.

    Parameters
    ----------
    ox, oy, oz, dx, dy, dz : float
        Origin and unit direction.
    columns : (4, n) array
        Centres and squared radii.
    first, count : int
        The run of spheres to test.
    distances : (m,) array
        Filled with `count` distances.
    """
    for k in range(count):
        x, y, z = columns[0, first + k] - ox, columns[1, first + k] - oy, columns[2, first + k] - oz
        along = x * dx + y * dy + z * dz
        px, py, pz = x - along * dx, y - along * dy, z - along * dz
        square = columns[3, first + k] - (px * px + py * py + pz * pz)
        half = math.sqrt(max(square, 0.0))
        distances[k] = max(along - half, 0.0) if (square > 0.0) & (along + half > 0.0) else math.inf


@njit(inline="always", **OPTIONS)
def _axis_walk(o, d, low, size, cells):
    """Start of a cell walk along one axis: cell number, step, distance to the next face, distance between faces."""
    # a direction of exactly zero would give 0 * inf; so small a one never reaches a face either
    inverse = 1.0 / (d if abs(d) > 1e-200 else 1e-200)
    cell = min(max(int((o - low) / size), 0), cells - 1)
    up = inverse > 0.0
    return cell, 2 * up - 1, (low + (cell + up) * size - o) * inverse, size * abs(inverse)


@njit(inline="always", **OPTIONS)
def first_hit(ox, oy, oz, dx, dy, dz, limit, low, size, cells, period, starts, columns, distances):  # noqa: C901 - three axes, each stepped in place
    """Distance to the first sphere on a ray, by a walk through the cells of a grid.

    Parameters
    ----------
    ox, oy, oz, dx, dy, dz : float
        Origin, inside the grid, and unit direction.
    limit : float
        Distance at which the ray ends without a hit.
    low, size, cells, period : (3,) arrays
        Lower corner, cell size, number of cells and period (0: open) of the grid along each axis.
    starts : (cells + 1,) array
        Where the spheres of each cell begin in `columns`.
    columns : (4, m) array
        Centres and squared radii of the spheres of each cell, cell by cell.
    distances : (k,) array
        Room for the distances to the spheres of one cell.

    Returns
    -------
    float
        The distance, `LIMIT` if none is hit before `limit`, `ESCAPED` if the ray leaves through an open face.
    """
    nx, ny, nz = cells[0], cells[1], cells[2]
    ix, sx, tx, ux = _axis_walk(ox, dx, low[0], size[0], nx)
    iy, sy, ty, uy = _axis_walk(oy, dy, low[1], size[1], ny)
    iz, sz, tz, uz = _axis_walk(oz, dz, low[2], size[2], nz)
    best = math.inf
    while True:
        cell = np.uint64((ix * ny + iy) * nz + iz)
        first = np.uint64(starts[cell])
        count = np.uint64(starts[cell + np.uint64(1)]) - first
        sphere_distances(ox, oy, oz, dx, dy, dz, columns, first, count, distances)
        for k in range(count):
            best = min(best, distances[k])
        leave = min(tx, min(ty, tz))
        if best <= leave:
            return best if best < limit else LIMIT
        if leave >= limit:
            return LIMIT
        # crossing a periodic face moves the origin by a period, the distance along the ray goes on
        if tx == leave:
            tx += ux
            ix += sx
            if ix < 0 or ix >= nx:
                if period[0] == 0.0:
                    return ESCAPED
                ix -= sx * nx
                ox -= sx * period[0]
        elif ty == leave:
            ty += uy
            iy += sy
            if iy < 0 or iy >= ny:
                if period[1] == 0.0:
                    return ESCAPED
                iy -= sy * ny
                oy -= sy * period[1]
        else:
            tz += uz
            iz += sz
            if iz < 0 or iz >= nz:
                if period[2] == 0.0:
                    return ESCAPED
                iz -= sz * nz
                oz -= sz * period[2]


@njit(inline="always", **OPTIONS)
def turn(u):
    """Cosine and sine of u full turns, 0 <= u <= 1, to two roundings.

    Power series within an eighth of a turn, mirrored to the quarter where u lies: no range reduction and no branch,
    which makes it several times faster than the library's functions; four of those were a fifth of the time of a ray.
    """
    quarter = math.floor(4.0 * u + 0.5)
    x = 2.0 * math.pi * (u - 0.25 * quarter)
    z = x * x
    c = 1.0 - z * (1 / 2 - z * (1 / 24 - z * (1 / 720 - z * (1 / 40320 - z * (
        1 / 3628800 - z * (1 / 479001600 - z * (1 / 87178291200 - z / 20922789888000)))))))  # fmt: skip
    s = x * (1.0 - z * (1 / 6 - z * (1 / 120 - z * (1 / 5040 - z * (1 / 362880 - z * (
        1 / 39916800 - z * (1 / 6227020800 - z / 1307674368000)))))))  # fmt: skip
    q = int(quarter)
    swap = (q & 1) == 1
    cosine, sine = (s if swap else c), (c if swap else s)
    return -cosine if ((q + 1) & 2) == 2 else cosine, -sine if (q & 2) == 2 else sine


@njit(inline="always", **OPTIONS)
def start_ray(u0, u1, u2, u3, kind, wall_radius, axial_low, axial_length, lateral_low, lateral_length):
    """Origin on the wall and direction by the cosine law, from a point of the unit hypercube.

    Parameters
    ----------
    u0, u1, u2, u3 : float
        Axial position, position around (or lateral), square of the sine of the polar angle, azimuth of the direction.
    kind : int
        `TUBE`, `ROD` or `PLATE`.
    wall_radius, axial_low, axial_length, lateral_low, lateral_length : float
        The wall and the window on it.

    Returns
    -------
    ox, oy, oz, dx, dy, dz, cosine : float
        Origin, unit direction and cosine of the angle to the wall's normal.
    """
    cosine = math.sqrt(1.0 - u2)
    sine = math.sqrt(u2)
    across, along = turn(u3)
    across, along = sine * across, sine * along
    axial = axial_low + axial_length * u0
    if kind == PLATE:
        return axial, lateral_low + lateral_length * u1, 0.0, along, across, cosine, cosine
    ex, ey = turn(u1)
    inward = -cosine if kind == TUBE else cosine
    dx, dy = inward * ex - across * ey, inward * ey + across * ex
    return wall_radius * ex, wall_radius * ey, axial, dx, dy, along, cosine


@njit(inline="always", **OPTIONS)
def _far_limit(kind, wall_radius, reach, dx, dy, cosine):
    """Distances at which a ray ends: at the far wall of a tube, and where it first gets deeper than `reach`."""
    if kind == PLATE:
        return math.inf, reach / cosine
    flat = dx * dx + dy * dy
    if kind == ROD:
        # outward from R to R + reach: the root of flat t^2 + 2 R cos t - reach (2 R + reach), without cancellation
        b = wall_radius * cosine
        c = reach * (2.0 * wall_radius + reach)
        return math.inf, c / (b + math.sqrt(b * b + flat * c))
    wall = 2.0 * wall_radius * cosine / flat
    inner = wall_radius - reach
    if inner <= 0.0:
        return wall, math.inf
    b = wall_radius * cosine
    c = reach * (wall_radius + inner)
    square = b * b - flat * c
    if square <= 0.0:
        return wall, math.inf
    return wall, c / (b + math.sqrt(square))


@njit(inline="always", **OPTIONS)
def _layer(kind, wall_radius, edges, x, y, z):
    """Number of the layer that holds a point: the first whose outer edge is not exceeded, len(edges) - 1 beyond."""
    if kind == PLATE:
        depth = z
    else:
        radial = math.sqrt(x * x + y * y)
        depth = wall_radius - radial if kind == TUBE else radial - wall_radius
    layer = 0
    layers = edges.size - 1
    while layer < layers and depth > edges[layer + 1]:
        layer += 1
    return layer


@njit(**OPTIONS)
def start_rays(points, kind, wall_radius, window, rays):
    """Origins, directions and cosines of rays from points of the unit hypercube.

    Parameters
    ----------
    points : (n, 4) array
        Points, see `start_ray`.
    kind : int
        `TUBE`, `ROD` or `PLATE`.
    wall_radius : float
        Radius of the wall.
    window : (4,) array
        Axial start and length, lateral start and length of the piece of wall that emits.
    rays : (7, n) array
        Filled.
    """
    for i in range(points.shape[0]):
        values = start_ray(
            points[i, 0], points[i, 1], points[i, 2], points[i, 3],
            kind, wall_radius, window[0], window[1], window[2], window[3],
        )  # fmt: skip
        for k in range(7):
            rays[k, i] = values[k]


@njit(**OPTIONS)
def _jump(ox, oy, oz, dx, dy, dz, t, low, size, cells, period):
    """Move the origin of a ray along it by t, back into the grid where it is periodic along z; whether it is inside."""
    ox, oy, oz = ox + t * dx, oy + t * dy, oz + t * dz
    top = low[2] + cells[2] * size[2]
    if period[2] > 0.0:
        oz = min(oz - period[2] * math.floor((oz - low[2]) / period[2]), top)
    return ox, oy, oz, low[2] <= oz <= top


@njit(**OPTIONS)
def trace(rays, kind, wall_radius, edges, reach, hollow, low, size, cells, period, starts, columns, distances, fates):
    """Trace rays through a grid and say where each ends.

    Parameters
    ----------
    rays : (7, n) array
        Origins on the wall, unit directions, cosines of the angle to the wall's normal.
    kind : int
        `TUBE`, `ROD` or `PLATE`.
    wall_radius : float
        Radius of the wall.
    edges : (layers + 1,) array
        Depths that part the layers.
    reach : float
        Depth down to which the grid is complete.
    hollow : float
        Depth from which on a tube holds no spheres; rays skip what lies deeper.
    low, size, cells, period, starts, columns, distances
        The grid, see `first_hit`.
    fates : (n,) array
        Filled with where each ray ends: the number of the layer, and from there on beyond the last, back to the wall,
        escaped; `UNSETTLED` for rays of a tube that got deeper than `reach`.

    Returns
    -------
    int
        Number of unsettled rays.
    """
    layers = edges.size - 1
    unsettled = 0
    for i in range(rays.shape[1]):
        ox, oy, oz, dx, dy, dz = rays[0, i], rays[1, i], rays[2, i], rays[3, i], rays[4, i], rays[5, i]
        wall, deep = _far_limit(kind, wall_radius, reach, dx, dy, rays[6, i])
        limit = min(wall, deep)
        if kind == TUBE and hollow < min(wall_radius, reach):
            _, inner = _far_limit(kind, wall_radius, hollow, dx, dy, rays[6, i])
            limit = min(limit, inner)
        t = first_hit(ox, oy, oz, dx, dy, dz, limit, low, size, cells, period, starts, columns, distances)
        if t == LIMIT and limit < min(wall, deep):
            # a chord is the same from both its ends
            ox, oy, oz, inside = _jump(ox, oy, oz, dx, dy, dz, wall - limit, low, size, cells, period)
            t = ESCAPED
            if inside:
                t = first_hit(ox, oy, oz, dx, dy, dz, limit, low, size, cells, period, starts, columns, distances)
        if t == ESCAPED:
            fates[i] = layers + 2
        elif t < LIMIT:
            fates[i] = _layer(kind, wall_radius, edges, ox + t * dx, oy + t * dy, oz + t * dz)
        elif wall <= deep:
            fates[i] = layers + 1
        elif kind == TUBE:
            fates[i] = UNSETTLED
            unsettled += 1
        else:
            fates[i] = layers
    return unsettled


@njit(**OPTIONS)
def _touches(cx, cy, cz, radius, x0, y0, z0, hx, hy, hz):
    """Whether a sphere reaches into a cell (lower corner, size)."""
    x = max(x0 - cx, 0.0, cx - x0 - hx)
    y = max(y0 - cy, 0.0, cy - y0 - hy)
    z = max(z0 - cz, 0.0, cz - z0 - hz)
    return x * x + y * y + z * z <= radius * radius * (1.0 + 1e-12)


@njit(**OPTIONS)
def fill_cells(spheres, low, size, cells, starts, members):
    """List the spheres that reach into each cell.

    Called twice: with `members` empty it adds the number of spheres of cell c to ``starts[c + 1]``; with `starts`
    summed up and `members` long enough it fills the lists, using ``starts[c]`` as the place of the next entry, which
    leaves the start of cell c in ``starts[c - 1]``.
    """
    first = np.empty(3, np.int64)
    last = np.empty(3, np.int64)
    for s in range(spheres.shape[0]):
        radius = spheres[s, 3]
        for k in range(3):
            first[k] = max(0, int((spheres[s, k] - radius - low[k]) / size[k] - 1e-9))
            last[k] = min(cells[k] - 1, int((spheres[s, k] + radius - low[k]) / size[k] + 1e-9))
        for i in range(first[0], last[0] + 1):
            for j in range(first[1], last[1] + 1):
                for k in range(first[2], last[2] + 1):
                    if _touches(
                        spheres[s, 0], spheres[s, 1], spheres[s, 2], radius,
                        low[0] + i * size[0], low[1] + j * size[1], low[2] + k * size[2], size[0], size[1], size[2],
                    ):  # fmt: skip
                        cell = (i * cells[1] + j) * cells[2] + k
                        if members.size == 0:
                            starts[cell + 1] += 1
                        else:
                            members[starts[cell]] = s
                            starts[cell] += 1
