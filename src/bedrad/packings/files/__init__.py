"""Packings from files and into files: one table of formats, told by content first and by suffix second."""

from __future__ import annotations

import codecs
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from bedrad.atomic import atomic_path
from bedrad.errors import BadFileError
from bedrad.packings.files.csv_table import looks_like_csv, read_csv, write_csv
from bedrad.packings.files.edem_hdf5 import is_edem, iterate_edem, read_edem
from bedrad.packings.files.extended_xyz import iterate_xyz, looks_like_xyz, read_xyz, write_xyz
from bedrad.packings.files.format import COLUMN_NAMES, Columns, Format, sharing, single
from bedrad.packings.files.hdf5 import load_packing, looks_like_hdf5, read_hdf5, save_packing, write_hdf5
from bedrad.packings.files.lammps_data import looks_like_lammps_data, read_lammps_data, write_lammps_data
from bedrad.packings.files.lammps_dump import iterate_dump, looks_like_dump, read_dump
from bedrad.packings.files.mercury_data import iterate_mercury_data, looks_like_mercury_data, read_mercury_data
from bedrad.packings.files.mercury_restart import looks_like_mercury_restart, read_mercury_restart
from bedrad.packings.files.mfix_input import looks_like_mfix, read_mfix
from bedrad.packings.files.npz import looks_like_npz, read_npz
from bedrad.packings.files.point_table import looks_like_points, read_points
from bedrad.packings.files.reading import Axis, Options, Period, as_packing
from bedrad.packings.files.sources import Source, source_files
from bedrad.packings.files.text import first_bytes
from bedrad.packings.files.units import metres
from bedrad.packings.files.vtk_legacy import looks_like_vtk_legacy, read_vtk_legacy
from bedrad.packings.files.vtk_xml import iterate_vtk_xml, looks_like_vtk_xml, read_vtk_xml
from bedrad.packings.files.vtp_writer import write_vtp
from bedrad.packings.files.yade_text import looks_like_yade, read_yade, write_yade
from bedrad.packings.packing import Packing
from bedrad.packings.wall_fit import WALL_KINDS, WallKind
from bedrad.packings.wall_stl import WallSurface, read_wall_stl
from bedrad.walls import Wall

__all__ = [
    "FORMATS",
    "Format",
    "count_frames",
    "files_of",
    "load_packing",
    "read",
    "read_frames",
    "save_packing",
    "write",
]

PathLike = str | os.PathLike[str]

_PICKLE_STARTS = tuple(bytes((0x80, protocol)) for protocol in range(2, 6))


_EDEM = Format("EDEM deck", (".dem",), looks_like_hdf5, read_edem, iterate_edem)

FORMATS = (
    sharing(single("bedrad HDF5", (".h5", ".hdf5"), looks_like_hdf5, read_hdf5, write_hdf5), _EDEM, is_edem),
    _EDEM,
    Format("LAMMPS dump", (".dump", ".lammpstrj", ".liggghts"), looks_like_dump, read_dump, iterate_dump),
    single("MercuryDPM restart", (".restart",), looks_like_mercury_restart, read_mercury_restart),
    Format("MercuryDPM data", (".data",), looks_like_mercury_data, read_mercury_data, iterate_mercury_data),
    single("MFiX particles", (".dat",), looks_like_mfix, read_mfix),
    Format("VTK PolyData", (".vtp",), looks_like_vtk_xml, read_vtk_xml, iterate_vtk_xml, write_vtp),
    # the same readers, but what is written is PolyData
    Format("VTK XML", (".vtu", ".pvtp", ".pvtu", ".pvd"), looks_like_vtk_xml, read_vtk_xml, iterate_vtk_xml),
    single("VTK legacy", (".vtk",), looks_like_vtk_legacy, read_vtk_legacy),
    single("CSV", (".csv",), looks_like_csv, read_csv, write_csv, takes_columns=True),
    Format("xyz", (".xyz", ".extxyz"), looks_like_xyz, read_xyz, iterate_xyz, write_xyz),
    single("YADE text", (".yade", ".spheres"), looks_like_yade, read_yade, write_yade),
    single("LAMMPS data", (".lmp", ".lmpdat", ".lammps"), looks_like_lammps_data, read_lammps_data, write_lammps_data),
    single("npz", (".npz",), looks_like_npz, read_npz),
    single("table of points", (".txt", ".xyzr"), looks_like_points, read_points, takes_columns=True),
)
"""The formats, in the order in which they are tried. A new one needs a module beside this one and a row."""


def read(
    path: PathLike,
    wall: Wall | PathLike | None = None,
    *,
    diameter: float | None = None,
    period: Period | None = None,
    frame: int = -1,
    max_overlap: float | None = None,
    unit: str | None = None,
    columns: Mapping[str, str | int] | None = None,
    axis: Axis | None = None,
    origin: Sequence[float] | None = None,
    wall_unit: str | None = None,
) -> Packing:
    """Read a packing from a file.

    The format is told from the content, and from the suffix where the content does not tell.

    Parameters
    ----------
    path : path
        A file of any format that `bedrad.packings.files.FORMATS` lists; the text formats also packed with gzip.
    wall : Tube, Rod, Plate, "tube", "rod", "plate", path or None
        The wall. A word has a wall of this kind fitted to the spheres nearest to it; the path of an STL file has a
        cylinder or plane fitted to its triangles (extra `mesh`), and the spheres decide what it is to them. None takes
        the wall from the file or, where the file names none, fits a tube. What is fitted is moved to where bedrad has
        its walls (the axis to x = y = 0 along z, the plate to z = 0, below the bed) and said in the provenance, with
        its residual.
    diameter : float, optional
        Sphere diameter, for files that hold positions only. [m]
    period : float or (float, float), optional
        Axial period; None takes it from the file, 0 means open ends whatever the file says. [m]
    frame : int
        Which frame of a file that holds several, counted from 0, or from the end if negative.
    max_overlap : float, optional
        Overlap that is still accepted, in radii; None takes it from the file, or the default of `Packing`.
    unit : str, optional
        What the file's lengths are in (m, cm, mm, um, nm, in or ft), where it does not say so; else metres are assumed,
        and that is said in the provenance. Lengths given here are metres in any case.
    columns : mapping, optional
        Where x, y, z and radius or diameter stand in a table: the name of a column, or its number from 1.
    axis : "x", "y", "z" or (float, float, float), optional
        Direction in the file of the axis of a tube or rod, or the normal of a plate into the bed. The spheres are
        turned so that it is z; the file's periods go with them if it is x, y or z, and are left out otherwise.
    origin : (float, float, float), optional
        A point in the file that a given wall's axis, or the plate, passes through; it moves to 0, 0, 0. [m]
    wall_unit : str, optional
        What the lengths of an STL file are in; `unit` if not given, or metres.

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
        If `diameter` is not positive, or is given although the file has sphere sizes; if `unit` is given although the
        file states it, `columns` although its columns are known, or `axis` or `origin` although the place of the wall
        is.
    MissingExtraError
        If the wall is an STL file and the extra `mesh` is not installed.
    """
    source = Path(path)
    options = Options(_wall(wall, unit, wall_unit), diameter, period, max_overlap, unit, axis, origin)
    form = _recognise(source)
    return as_packing(source, form.read(source, frame, *_columns(source, form, columns)), options)


def read_frames(
    path: Source,
    wall: Wall | PathLike | None = None,
    *,
    diameter: float | None = None,
    period: Period | None = None,
    max_overlap: float | None = None,
    unit: str | None = None,
    columns: Mapping[str, str | int] | None = None,
    axis: Axis | None = None,
    origin: Sequence[float] | None = None,
    wall_unit: str | None = None,
) -> Iterator[Packing]:
    """Yield the packings of all frames, one after the other, with one in memory; other parameters as for `read`.

    Parameters
    ----------
    path : path or iterable of paths
        A file; a pattern such as ``"dump_*.vtk"``, or a folder of files of one kind, in the order of the numbers in
        their names and without the bounding boxes that LIGGGHTS writes; or several files, in the order given.
    wall : Tube, Rod, Plate, "tube", "rod", "plate", path or None
        The wall, as for `read`; one that is fitted to the spheres is fitted to every frame by itself.

    Raises
    ------
    BadFileError
        If nothing matches a pattern, or a folder holds files of several kinds; else as for `read`.
    """
    options = Options(_wall(wall, unit, wall_unit), diameter, period, max_overlap, unit, axis, origin)
    return _packings(files_of(path), columns, options)


def files_of(path: Source) -> list[Path]:
    """Return the files that `read_frames` reads, in order; BadFileError as there."""
    return source_files(path, tuple(dict.fromkeys(suffix for form in FORMATS for suffix in form.suffixes)))


def count_frames(path: PathLike, columns: Mapping[str, str | int] | None = None) -> int:
    """Return the number of frames in a file, which is read through for it; errors as for `read`."""
    source = Path(path)
    form = _recognise(source)
    return sum(1 for _ in form.frames(source, *_columns(source, form, columns)))


def _packings(paths: Sequence[Path], columns: Mapping[str, str | int] | None, options: Options) -> Iterator[Packing]:
    for path in paths:
        form = _recognise(path)
        for held in form.frames(path, *_columns(path, form, columns)):
            yield as_packing(path, held, options)


def write(packing: Packing, path: PathLike) -> None:
    """Write a packing to a file, in the format of the suffix: any that `bedrad.packings.files.FORMATS` can write.

    bedrad's own formats keep centres, radii, wall, period, overlap limit and provenance, and read back bit for bit. The
    file appears whole or not at all.

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
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise BadFileError(f"{path}: a text in UTF-16; save it as UTF-8 or plain text")
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


def _wall(
    wall: Wall | PathLike | None, unit: str | None, wall_unit: str | None
) -> Wall | WallSurface | WallKind | None:
    """The wall, read if it is a file."""
    if isinstance(wall, (str, os.PathLike)) and wall not in WALL_KINDS:
        path = Path(wall)
        if path.suffix.lower() != ".stl":
            raise ValueError(
                f"wall is {str(wall)!r}; expected a wall, {', '.join(map(repr, WALL_KINDS))} or an .stl file"
            )
        return read_wall_stl(path, metres(wall_unit or unit or "m"))
    if wall_unit is not None:
        raise ValueError(f"the unit of the wall is {wall_unit!r}, but the wall is no STL file")
    return wall  # type: ignore[return-value]


def _columns(path: Path, form: Format, columns: Mapping[str, str | int] | None) -> tuple[Columns, ...]:
    """The argument that says which column is which, for the formats that take it."""
    if columns and not form.takes_columns:
        raise ValueError(f"columns were given, but {path} is a {form.name} file, whose columns are known")
    unknown = [name for name in columns or () if name not in COLUMN_NAMES]
    if unknown:
        raise ValueError(f"columns name {unknown[0]!r}; expected {', '.join(COLUMN_NAMES)}")
    return ({name: str(column) for name, column in (columns or {}).items()},) if form.takes_columns else ()
