"""Packings from files and into files: one table of formats, told by content first and by suffix second."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bedrad.atomic import atomic_path
from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.csv_table import looks_like_csv, read_csv, write_csv
from bedrad.packings.files.format import Format, single
from bedrad.packings.files.hdf5 import load_packing, looks_like_hdf5, read_hdf5, save_packing, write_hdf5
from bedrad.packings.files.lammps_dump import iterate_dump, looks_like_dump, read_dump
from bedrad.packings.files.text import first_bytes
from bedrad.packings.packing import LARGEST_OVERLAP, Packing
from bedrad.packings.wall_fit import fit_tube
from bedrad.walls import Tube, Wall

__all__ = ["FORMATS", "Format", "load_packing", "read", "read_frames", "save_packing", "write"]

PathLike = str | os.PathLike[str]

_PICKLE_STARTS = tuple(bytes((0x80, protocol)) for protocol in range(2, 6))


FORMATS = (
    single("bedrad HDF5", (".h5", ".hdf5"), looks_like_hdf5, read_hdf5, write_hdf5),
    Format("LAMMPS dump", (".dump", ".lammpstrj", ".liggghts"), looks_like_dump, read_dump, iterate_dump),
    single("CSV", (".csv",), looks_like_csv, read_csv, write_csv),
)
"""The formats, in the order in which they are tried. A new one needs a module beside this one and a row."""


def read(
    path: PathLike,
    wall: Wall | None = None,
    *,
    diameter: float | None = None,
    period: float | tuple[float, float] | None = None,
    frame: int = -1,
    max_overlap: float | None = None,
) -> Packing:
    """Read a packing from a file.

    The format is told from the content, and from the suffix where the content does not tell.

    Parameters
    ----------
    path : path
        A bedrad HDF5 file (a packing or results), a CSV file with units in its header, or a LAMMPS or
        LIGGGHTS text dump; the text formats also packed with gzip.
    wall : Tube, Rod, Plate or None
        The wall; None takes it from the file or, where the file names none, fits a tube around the z
        direction to the outermost spheres, moves its axis to x = y = 0 and says so in the provenance.
    diameter : float, optional
        Sphere diameter, for files that hold positions only. [m]
    period : float or (float, float), optional
        Axial period; None takes it from the file, 0 means open ends whatever the file says. [m]
    frame : int
        Which frame of a dump, counted from 0, or from the end if negative.
    max_overlap : float, optional
        Overlap that is still accepted, in radii; None takes it from the file, or the default of `Packing`.

    Returns
    -------
    Packing
        The spheres, in the order of the file or, where it has ids, of these.

    Raises
    ------
    BadFileError
        If the file is missing, of no known format, damaged, or does not hold a valid packing; the message
        names the file and, for text, the line.
    ValueError
        If `diameter` is not positive, or is given although the file has sphere sizes.
    """
    source = Path(path)
    held = _recognise(source).read(source, frame)
    return _packing(source, held, wall, diameter, period, max_overlap)


def read_frames(
    path: PathLike,
    wall: Wall | None = None,
    *,
    diameter: float | None = None,
    period: float | tuple[float, float] | None = None,
    max_overlap: float | None = None,
) -> Iterator[Packing]:
    """Yield the packings of all frames of a file, one after the other; parameters and errors as for `read`.

    A wall that is not given is fitted to every frame by itself.
    """
    source = Path(path)
    for held in _recognise(source).frames(source):
        yield _packing(source, held, wall, diameter, period, max_overlap)


def write(packing: Packing, path: PathLike) -> None:
    """Write a packing to a file, in the format of the suffix: ``.h5``/``.hdf5`` or ``.csv``.

    Both keep centres, radii, wall, period, overlap limit and provenance, and read back bit for bit. The file
    appears whole or not at all.

    Parameters
    ----------
    packing : Packing
        The packing.
    path : path
        The file.

    Raises
    ------
    ValueError
        If no format that can be written has this suffix, or a provenance value cannot be stored.
    OSError
        If the file cannot be written; the message names it.
    """
    target = Path(path)
    known = {suffix: form.write for form in FORMATS for suffix in form.suffixes if form.write}
    writer = known.get(target.suffix.lower())
    if writer is None:
        raise ValueError(f"{target}: suffix {target.suffix!r}; packings are written as {', '.join(known)}")
    with atomic_path(target) as temporary:
        writer(packing, temporary)


def _recognise(path: Path) -> Format:
    head = first_bytes(path)
    for form in FORMATS:
        if form.recognises(head):
            return form
    suffixes = [suffix.lower() for suffix in path.suffixes]
    if head[:2] in _PICKLE_STARTS or {".pkl", ".pickle"} & {*suffixes}:
        raise BadFileError(f"{path}: a Python pickle; pickles can run any code when opened and are not read")
    if suffixes[-1:] == [".gz"]:
        suffixes.pop()
    for form in FORMATS:
        if suffixes and suffixes[-1] in form.suffixes:
            return form
    known = ", ".join(f"{form.name} ({' '.join(form.suffixes)})" for form in FORMATS)
    raise BadFileError(f"{path}: {'an empty file' if not head else 'an unknown format'}; known are {known}")


def _packing(
    path: Path,
    held: Contents,
    wall: Wall | None,
    diameter: float | None,
    period: float | tuple[float, float] | None,
    max_overlap: float | None,
) -> Packing:
    radii = _sizes(path, held, diameter)
    provenance = dict(held.provenance)
    centers = held.centers
    chosen = wall if wall is not None else held.wall
    try:
        if chosen is None:
            fit = fit_tube(centers, radii)
            chosen = Tube(fit.radius)
            centers = centers - [*fit.axis, 0.0]
            provenance |= fit.notes()
        limit = max_overlap if max_overlap is not None else held.max_overlap
        return Packing(
            centers,
            radii,
            chosen,
            _period(held, chosen, period),
            provenance,
            LARGEST_OVERLAP if limit is None else limit,
        )
    except ValueError as error:
        raise BadFileError(f"{path}: {error}{_origins(held, str(error))}") from error


def _sizes(path: Path, held: Contents, diameter: float | None) -> NDArray[np.float64]:
    if held.radii is None:
        if diameter is None:
            raise BadFileError(f"{path}: no column radius or diameter; give the diameter of the spheres")
        if not (math.isfinite(diameter) and diameter > 0):
            raise ValueError(f"diameter is {diameter!r}; expected a positive number of metres")
        return np.full(len(held.centers), diameter / 2)
    if diameter is not None:
        raise ValueError(f"diameter {diameter!r} m was given, but {path} has the sizes of its spheres")
    return held.radii


def _period(
    held: Contents, wall: Wall, given: float | tuple[float, float] | None
) -> float | tuple[float, float] | None:
    if given is not None:
        return None if given == 0 else given
    if held.wall is not None:
        # a period along the wall means something else for another kind of wall
        return held.period if held.wall.kind == wall.kind else None
    lengths = [held.axis_periods[axis] for axis in wall.periodic_axes if axis in held.axis_periods]
    if len(lengths) < len(wall.periodic_axes):
        return None
    return lengths[0] if len(lengths) == 1 else (lengths[0], lengths[1])


def _origins(held: Contents, message: str) -> str:
    """Where the spheres that a message of `Packing` names stand in the file."""
    match = re.match(r"spheres? (\d+)(?: and (\d+))?", message)
    places = [held.origin(int(number)) for number in match.groups() if number is not None] if match else []
    return f" ({' and '.join(places)})" if any(places) else ""
