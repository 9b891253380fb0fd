"""A bed as files that ParaView opens: the spheres with what is known of each, and the wall as a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.atomic import atomic_path
from bedrad.errors import BadFileError
from bedrad.jobs.results import Results
from bedrad.packings.files.vtp_writer import write_vtp
from bedrad.packings.packing import Packing
from bedrad.packings.wall_contacts import wall_gaps
from bedrad.report.records import load
from bedrad.walls import Plate

__all__ = ["Known", "known_of", "sphere_arrays", "vtp_paths", "wall_surface", "write_vtp_files"]

FloatArray = NDArray[np.float64]

_SIDES = 96
"""Flat pieces of a round wall."""


@dataclass(frozen=True, eq=False)
class Known:
    """What a file says of a bed beside its spheres.

    Parameters
    ----------
    name : str
        Title of the bed.
    edges : (layers + 1,) array or None
        Depths that part the layers. [m]
    contact_gap : float
        Gap that counts as contact, in particle radii.
    view_factors : (layers,) array or None
        View factors from the wall to these layers.
    """

    name: str
    edges: FloatArray | None = None
    contact_gap: float = 1e-2
    view_factors: FloatArray | None = None


def known_of(file: Path) -> Known:
    """What a file says: all of it where it holds the results of a job, else its name.

    Raises
    ------
    BadFileError
        If it holds results of which a stage cannot be read.
    """
    results = Results(file)
    try:
        results.attributes()
    except BadFileError:
        return Known(file.name)
    record = load(results)
    statistics, traced = record.stages.get("statistics", {}), record.stages.get("view_factors", {})
    edges = traced.get("edges", statistics.get("edges"))
    gap = float(statistics.get("contact_gap", Known.contact_gap))
    return Known(record.name, edges, gap, traced.get("layers"))


def vtp_paths(beginning: Path) -> tuple[Path, Path]:
    """Files of the spheres and of the wall, by the beginning of their names."""
    return beginning.with_name(f"{beginning.name}_spheres.vtp"), beginning.with_name(f"{beginning.name}_wall.vtp")


def sphere_arrays(packing: Packing, edges: FloatArray, known: Known) -> dict[str, NDArray[np.generic]]:
    """What is known of every sphere.

    Returns
    -------
    dict of (n,) arrays
        ``layer``, the number of the layer that holds the centre, 1 at the wall and 0 deeper than all; ``contact``,
        whether the sphere touches the wall; ``view_factor`` from the wall to that layer, nan deeper than all, where
        the view factors are those of these layers.
    """
    layer = np.searchsorted(edges, packing.depths, side="right").astype(np.int64)
    # a soft sphere is at most a part of its radius through the wall, but a small one may be with its centre
    layer = np.maximum(layer, 1)
    layer[layer == len(edges)] = 0
    arrays: dict[str, NDArray[np.generic]] = {"layer": layer, "contact": wall_gaps(packing) <= known.contact_gap}
    if known.view_factors is not None and known.edges is not None and np.array_equal(edges, known.edges):
        arrays["view_factor"] = np.concatenate(([np.nan], known.view_factors))[layer]
    return arrays


def write_vtp_files(packing: Packing, edges: FloatArray, known: Known, beginning: Path) -> list[Path]:
    """Write spheres and wall, each whole or not at all, and return the files.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    spheres, wall = vtp_paths(beginning)
    with atomic_path(spheres) as temporary:
        write_vtp(packing, temporary, sphere_arrays(packing, edges, known))
    with atomic_path(wall) as temporary:
        temporary.write_text(_surface_text(*wall_surface(packing)), encoding="ascii")
    return [spheres, wall]


def wall_surface(packing: Packing) -> tuple[FloatArray, NDArray[np.int64]]:
    """The wall beside a packing.

    Returns
    -------
    points : (n, 3) array
        Corners. [m]
    faces : (m, 4) array
        Corners of each flat piece, in order around the normal that points into the bed.
    """
    wall = packing.wall
    if isinstance(wall, Plate):
        (left, right), (front, back) = packing.extent(0), packing.extent(1)
        corners = [(left, front, 0.0), (right, front, 0.0), (right, back, 0.0), (left, back, 0.0)]
        return np.array(corners), np.array([[0, 1, 2, 3]])
    angles = 2.0 * math.pi * np.arange(_SIDES) / _SIDES
    ring = wall.radius * np.c_[np.cos(angles), np.sin(angles)]
    points = np.vstack([np.c_[ring, np.full(_SIDES, height)] for height in packing.extent(2)])
    first = np.arange(_SIDES)
    following = (first + 1) % _SIDES
    outward = np.c_[first, following, following + _SIDES, first + _SIDES]
    into_bed = outward[:, ::-1] if wall.kind == "tube" else outward
    return points, np.ascontiguousarray(into_bed)


def _surface_text(points: FloatArray, faces: NDArray[np.int64]) -> str:
    """A surface as VTK's XML PolyData."""

    def numbers(kind: str, name: str, values: NDArray[np.generic], more: str = "") -> str:
        text = " ".join(repr(value) for value in values.ravel().tolist())
        return f'<DataArray type="{kind}" Name="{name}"{more} format="ascii">{text}</DataArray>'

    ends = faces.shape[1] * np.arange(1, len(faces) + 1)
    return f"""<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian">
  <PolyData>
    <Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0"
           NumberOfPolys="{len(faces)}">
      <Points>
        {numbers("Float64", "Points", points, ' NumberOfComponents="3"')}
      </Points>
      <Polys>
        {numbers("Int64", "connectivity", faces)}
        {numbers("Int64", "offsets", ends)}
      </Polys>
    </Piece>
  </PolyData>
</VTKFile>
"""
