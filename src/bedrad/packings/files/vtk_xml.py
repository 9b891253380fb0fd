"""XML files of VTK: PolyData and UnstructuredGrid, their parallel forms with pieces beside them, and collections."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path, PureWindowsPath

from bedrad.errors import BadFileError, visible
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.facts import FACTS
from bedrad.packings.files.vtk_points import Piece, spheres
from bedrad.packings.files.vtk_xml_document import COLLECTION, PARALLEL, Document, parse

__all__ = ["iterate_vtk_xml", "looks_like_vtk_xml", "read_vtk_xml"]


_LONGEST_NAME = 500
"""What the name of another file may have, its folders included. [characters]"""


def looks_like_vtk_xml(head: bytes) -> bool:
    """Whether a file begins as an XML file of VTK does."""
    return b"<VTKFile" in head and head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<")


def read_vtk_xml(path: Path, frame: int = -1) -> Contents:
    """Read the points of an XML file of VTK as spheres.

    Sizes come from the point array ``radius`` (or ``radii``) or, without one, ``diameter``, ids from ``id`` or
    ``Particle_ID``; small and capital letters are the same. Lengths are returned as in the file. Files that bedrad
    wrote also give the wall, the period, the overlap limit and the provenance.

    Parameters
    ----------
    path : pathlib.Path
        A ``.vtp`` or ``.vtu`` file, a parallel ``.pvtp`` or ``.pvtu`` file, or a ``.pvd`` collection. The pieces of a
        parallel file and the files of a collection lie in its folder or in folders of that.
    frame : int
        Which time of a collection, counted from 0, or from the end if negative.

    Raises
    ------
    BadFileError
        If the frame does not exist, the file or one of its pieces is damaged or cut off, a piece lies elsewhere, or the
        file holds something else than points; the message names the file and the array.
    """
    document = parse(path)
    steps = _steps(path, document)
    if not -len(steps) <= frame < len(steps):
        raise BadFileError(f"{path}: frame {frame} was asked for; the file has {len(steps)}, counted from 0")
    number = range(len(steps))[frame]
    return _contents(path, document, number, *steps[number])


def iterate_vtk_xml(path: Path) -> Iterator[Contents]:
    """Yield the times of a collection one after the other, or the one packing of another file."""
    document = parse(path)
    for number, (time, names) in enumerate(_steps(path, document)):
        yield _contents(path, document, number, time, names)


def _steps(path: Path, document: Document) -> list[tuple[str, list[str]]]:
    """The times of a collection and the files of each; one time without files for what is no collection."""
    if document.kind != COLLECTION:
        return [("", [])]
    steps: dict[str, list[str]] = {}
    for time, name in document.files:
        steps.setdefault(time, []).append(name)
    if not steps:
        raise BadFileError(f"{path}: a collection of no files; expected elements DataSet")
    return list(steps.items())


def _contents(path: Path, document: Document, number: int, time: str, names: list[str]) -> Contents:
    if document.kind != COLLECTION:
        return _one(path, document)
    notes: dict[str, str | float | int] = {"file": path.name, "format": "VTK collection", "frame": number}
    if time:
        notes["time"] = _time(path, time)
    members = [(file, parse(file)) for file in _beside(path, names)]
    for file, member in members:
        if member.kind == COLLECTION:
            raise BadFileError(f"{path}: the file {file.name!r} is a collection too; expected points")
    if len(members) == 1:
        held = _one(*members[0])
        return held if held.states_unit else replace(held, provenance=notes | _precision(held))
    return spheres(path, [piece for file, member in members for piece in _pieces(file, member)], notes)


def _time(path: Path, text: str) -> float:
    try:
        time = float(text)
    except ValueError:
        time = math.nan
    if not math.isfinite(time):
        raise BadFileError(f"{path}: timestep is {text[:40]!r}; expected a finite number")
    return time


def _precision(held: Contents) -> dict[str, str | float | int]:
    return {key: value for key, value in held.provenance.items() if key == "coordinates"}


def _one(path: Path, document: Document) -> Contents:
    held = spheres(path, _pieces(path, document), {"file": path.name, "format": f"VTK {document.kind}"})
    if not document.facts:
        return held
    understood: dict[str, object] = {}
    for key, text in document.facts.items():
        try:
            understood[key] = FACTS[key](text)
        except (ValueError, RecursionError) as error:
            reason = visible(str(error))[:200]
            raise BadFileError(f"{path}: {key} {text[:80]!r} is not understood: {reason}") from error
    return replace(held, states_unit=True, **understood)  # type: ignore[arg-type]


def _pieces(path: Path, document: Document) -> list[Piece]:
    if document.kind not in PARALLEL:
        return document.pieces
    pieces: list[Piece] = []
    for file in _beside(path, [name for _, name in document.files]):
        part = parse(file)
        if part.kind != PARALLEL[document.kind]:
            raise BadFileError(f"{file}: holds {part.kind}; {path.name} expects {PARALLEL[document.kind]}")
        pieces += part.pieces
    return pieces


def _beside(path: Path, names: list[str]) -> list[Path]:
    """The files of these names, each once and none outside the folder of the file that names them."""
    found: dict[Path, Path] = {}
    for name in names:
        # of Windows, as it takes both kinds of stroke for the border between folders
        parts = PureWindowsPath(name)
        odd = not name.strip() or not name.isprintable() or len(name) > _LONGEST_NAME
        outside = odd or bool(parts.anchor) or ".." in parts.parts
        file = path.parent if outside else path.parent.joinpath(*parts.parts)
        try:
            whole = file.resolve()
        except (OSError, RuntimeError) as error:
            raise BadFileError(f"{path}: names the file {name[:80]!r}, which cannot be followed ({error})") from error
        if outside or not whole.is_relative_to(path.parent.resolve()):
            raise BadFileError(f"{path}: names the file {name[:80]!r}; expected one in the folder of this file")
        if whole in found:
            raise BadFileError(f"{path}: names the file {name[:80]!r} twice")
        found[whole] = file
    return list(found.values())
