"""The wall from the triangles of an STL file: a cylinder or a plane through their corners."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError, MissingExtraError
from bedrad.packings.placing import Placing, turn_to_z
from bedrad.packings.surface_fit import Surface, fit_cylinder, fit_plane, local
from bedrad.walls import Plate, Rod, Tube, Wall

__all__ = ["LARGEST_MISS", "Beside", "WallSurface", "read_wall_stl"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LARGEST_MISS = 1e-3
"""Root mean square distance of the corners from the fitted surface that is accepted, in radii of the cylinder or in
lengths of the plane's longest side."""

_FEWEST_FACETS = 12
"""Facets around a cylinder; fewer are a polygon that was meant."""

_END = 0.5
"""Cosine between a triangle's normal and the axis from which on it belongs to an end, not to the mantle."""

_STRAIGHT = 1e-6
"""Tilt from an axis of the file that is left to the roundings of STL, whose numbers have 32 bits. [rad]"""


@dataclass(frozen=True)
class Beside:
    """A wall beside spheres: what it is to them, where it is, and what is to be said about it."""

    wall: Wall
    placing: Placing
    notes: dict[str, str | float | int]


@dataclass(frozen=True)
class WallSurface:
    """A cylinder or plane that the triangles of a file are.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    origin : (float, float, float)
        The point of the axis, or of the plane, that is nearest to 0, 0, 0. [m]
    direction : (float, float, float)
        Unit vector of the axis, or normal of the plane, of either sense.
    radius : float or None
        Radius of the cylinder through the corners; None for a plane. [m]
    residual : float
        Root mean square distance of the corners from the surface. [m]
    sagitta : float
        How far the middle of the widest facet lies inside the cylinder; 0 for a plane. [m]
    triangles : int
        How many triangles the surface comes from; the ends of a closed cylinder are left out.
    """

    path: Path
    origin: tuple[float, float, float]
    direction: tuple[float, float, float]
    radius: float | None
    residual: float
    sagitta: float
    triangles: int

    def beside(self, centers: FloatArray) -> Beside:
        """Say what the surface is to spheres: a tube around most of them, a rod amid them, or a plate below them.

        Parameters
        ----------
        centers : (n, 3) array
            Sphere centres, in the coordinates of the file. [m]
        """
        p = local(centers, np.array(self.origin), np.array(self.direction))
        direction = np.array(self.direction)
        wall: Wall
        if self.radius is None:
            wall = Plate()
            if len(p) and float(np.median(p[:, 2])) < 0.0:
                direction = -direction
        else:
            inside = not len(p) or float(np.median(np.hypot(p[:, 0], p[:, 1]))) < self.radius
            wall = (Tube if inside else Rod)(self.radius)
        notes: dict[str, str | float | int] = {
            "wall_origin": f"{wall.kind} fitted to the {self.triangles} triangles of {self.path.name}",
            "wall_fit_residual_m": self.residual,
        }
        notes |= {f"wall_fit_axis_{name}_m": value for name, value in zip("xyz", self.origin, strict=True)}
        notes |= {f"wall_fit_direction_{name}": value for name, value in zip("xyz", direction.tolist(), strict=True)}
        if self.radius is not None:
            notes["wall_facet_sagitta_m"] = self.sagitta
        return Beside(wall, Placing(self.origin, turn_to_z(direction)), notes)


def read_wall_stl(path: Path, metre: float = 1.0) -> WallSurface:
    """Fit a cylinder or plane to the triangles of an STL file.

    The corners of a faceted cylinder lie on the true one, and its facets inside, by what `WallSurface` says; so the
    cylinder goes through the corners.

    Parameters
    ----------
    path : pathlib.Path
        The file, text or binary.
    metre : float
        Metres in its unit of length, which STL does not state.

    Raises
    ------
    BadFileError
        If it is no STL file, or its triangles are neither a cylinder of at least 12 facets nor a plane, to 1/1000 of
        the radius or side.
    MissingExtraError
        If the extra `mesh` is not installed.
    """
    corners, triangles = _mesh(path)
    corners = corners * metre
    sides = corners[triangles]
    normals = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    if not areas.sum() > 0.0:
        raise BadFileError(f"{path}: {len(triangles)} triangles without an area; expected the surface of a wall")
    normals = normals / np.where(areas > 0.0, areas, 1.0)[:, None]
    plane = _plane(corners)
    if plane is not None:
        return _made(path, plane, 0.0, len(triangles))
    surface, mantle, gap = _cylinder(path, corners, triangles, normals, areas)
    radius = surface.radius or 0.0
    if not surface.rms <= LARGEST_MISS * radius:
        raise BadFileError(
            f"{path}: the corners miss a common cylinder by {surface.rms:.3g} m (root mean square), and a plane by "
            f"more; at most {LARGEST_MISS:g} of the radius ({radius:.6g} m) is accepted. Expected one surface: the "
            "mantle of a tube or rod, or a plate"
        )
    if gap > 2.0 * np.pi / _FEWEST_FACETS * (1.0 + 1e-6):
        raise BadFileError(
            f"{path}: {np.degrees(gap):.4g} degrees between neighbouring corners around the axis; a tube or rod needs "
            f"at least {_FEWEST_FACETS} facets all round"
        )
    return _made(path, surface, radius * (1.0 - float(np.cos(gap / 2.0))), len(mantle))


def _mesh(path: Path) -> tuple[FloatArray, IntArray]:
    """The corners, each once, and the triangles of a file."""
    try:
        import trimesh
    except ImportError:
        raise MissingExtraError("trimesh", "mesh") from None
    # it prints a traceback where it can do without what a broken file does not hold
    talk = logging.getLogger("trimesh")
    level = talk.level
    talk.setLevel(logging.CRITICAL)
    try:
        with path.open("rb") as stream:
            mesh = trimesh.load_mesh(stream, file_type="stl")
        corners, triangles = np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.int64)
    except OSError as error:
        raise BadFileError(f"{path}: cannot be read: {error.strerror or error}") from error
    except Exception as error:
        # whatever trimesh stumbles over in a broken file
        raise BadFileError(f"{path}: not an STL file that can be read ({error})") from error
    finally:
        talk.setLevel(level)
    if not (len(triangles) and np.isfinite(corners).all()):
        raise BadFileError(f"{path}: no triangles with finite corners; expected the surface of a wall")
    return corners, triangles


def _plane(corners: FloatArray) -> Surface | None:
    """The plane that the corners are on, if they are."""
    middle = corners.mean(axis=0)
    size = float(np.ptp(corners, axis=0).max())
    normal = np.linalg.svd(corners - middle, full_matrices=False)[2][2]
    heights = (corners - middle) @ normal
    if float(np.sqrt(np.mean(heights**2))) > LARGEST_MISS * size:
        return None
    if len(corners) == 3:
        return Surface(middle, normal, None, heights, np.zeros((1, 1)))
    return fit_plane(corners, np.zeros(len(corners)), normal, free=len(corners) > 3)


def _cylinder(
    path: Path, corners: FloatArray, triangles: IntArray, normals: FloatArray, areas: FloatArray
) -> tuple[Surface, IntArray, float]:
    """The cylinder through the corners of the mantle, the mantle's triangles, and the widest angle between corners."""
    best: tuple[Surface, IntArray, float] | None = None
    for direction in _axes(normals, areas):
        mantle = np.flatnonzero((np.abs(normals @ direction) < _END) & (areas > 0.0))
        points = corners[np.unique(triangles[mantle])]
        if len(points) < _FEWEST_FACETS:
            continue
        try:
            surface = fit_cylinder(points, np.zeros(len(points)), points.mean(axis=0), direction, free=True)
        except ValueError:
            continue
        if best is None or surface.rms / (surface.radius or 1.0) < best[0].rms / (best[0].radius or 1.0):
            p = local(points, surface.origin, surface.direction)
            turns = np.sort(np.arctan2(p[:, 1], p[:, 0]))
            best = surface, mantle, float(np.diff(np.append(turns, turns[0] + 2.0 * np.pi)).max())
            if surface.rms <= LARGEST_MISS * (surface.radius or 0.0):
                break
    if best is None:
        raise BadFileError(
            f"{path}: {len(triangles)} triangles that are neither a plane nor a cylinder of {_FEWEST_FACETS} facets"
        )
    return best


def _axes(normals: FloatArray, areas: FloatArray) -> list[FloatArray]:
    """Directions that the axis may have."""
    # the mantle's normals leave out one principal direction, unless the ends of a closed cylinder hide it: then they
    # are the largest flat piece
    principal = np.linalg.eigh((normals * areas[:, None]).T @ normals)[1].T
    kinds, which = np.unique(np.round(np.abs(normals), 4), axis=0, return_inverse=True)
    flat = normals[int(np.argmax(which.ravel() == np.argmax(np.bincount(which.ravel(), areas, len(kinds)))))]
    return [v * _sense(v) for v in (*principal, flat)]


def _sense(direction: FloatArray) -> float:
    """1 or -1, so that an axis points the way that the axis of the file does which is nearest to it."""
    return float(np.sign(direction[np.argmax(np.abs(direction))]))


def _made(path: Path, surface: Surface, sagitta: float, triangles: int) -> WallSurface:
    direction = surface.direction * _sense(surface.direction)
    nearest = np.zeros(3)
    nearest[np.argmax(np.abs(direction))] = 1.0
    if float(np.linalg.norm(direction - nearest)) < _STRAIGHT:
        direction = nearest
    along = direction * float(direction @ surface.origin)
    x, y, z = (along if surface.radius is None else surface.origin - along).tolist()
    u, v, w = direction.tolist()
    return WallSurface(path, (x, y, z), (u, v, w), surface.radius, surface.rms, sagitta, triangles)
