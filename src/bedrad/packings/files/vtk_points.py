"""What all VTK files have in common: a stream of bytes that may lie about its length, and points that are spheres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.ids import id_order
from bedrad.packings.packing import Provenance

__all__ = ["Piece", "Readable", "as_declared", "is_wanted", "number_array", "spheres", "take"]

_BLOCK = 1 << 20
"""What is read at once, so that a false count does not claim memory that the file cannot fill. [bytes]"""

_SIZES = (("radius", 1.0), ("radii", 1.0), ("diameter", 0.5), ("diameters", 0.5))
"""Names of arrays with sizes, in the order of preference, and what they are multiplied by to be radii."""

_IDS = ("id", "ids", "particle_id")
_GHOSTS = "vtkghosttype"
_DUPLICATE_POINT = 1

_CONTACTS = ("force_chain_length", "force_chain_fn_mag")
"""Arrays by which the contacts that MFiX writes as points are told from its particles."""

_WANTED = frozenset((*(name for name, _ in _SIZES), *_IDS, _GHOSTS, *_CONTACTS))

_EXACT_IN_SINGLE = 1 << 24
"""From this number on single precision gives several ids the same value."""


class Readable(Protocol):
    """Anything that gives bytes; fewer than asked for only at its end."""

    def read(self, size: int, /) -> bytes:
        """Return so many bytes."""
        ...


@dataclass
class Piece:
    """The points of one piece of a file.

    Parameters
    ----------
    where : str
        The file and the piece in it, for messages.
    points : (n, 3) array
        The coordinates, in any type of numbers.
    arrays : mapping of str to (n,) array
        The point arrays that `is_wanted` names, under their names in small letters.
    shapes : int
        Number of lines, strips and polygons between the points.
    single : bool
        Whether the file has the coordinates in single precision.
    """

    where: str
    points: NDArray[Any]
    arrays: dict[str, NDArray[Any]] = field(default_factory=dict)
    shapes: int = 0
    single: bool = False


def is_wanted(name: str) -> bool:
    """Whether a point array of this name says something about spheres."""
    return name.lower() in _WANTED


def take(stream: Readable, count: int) -> bytearray:
    """Read `count` bytes, or what is left if that is less; never claims more memory than the stream fills."""
    data = bytearray()
    while len(data) < count:
        block = stream.read(min(count - len(data), _BLOCK))
        if not block:
            break
        data += block
    return data


def number_array(words: Sequence[bytes] | Sequence[str]) -> NDArray[np.float64]:
    """Turn words into numbers.

    Raises
    ------
    ValueError
        If a word is no number; the argument of the error is its place in the sequence.
    """
    try:
        return np.array(words, dtype=np.float64)
    except ValueError:
        for place, word in enumerate(words):
            try:
                np.array([word], dtype=np.float64)
            except ValueError:
                raise ValueError(place) from None
        raise


def as_declared(where: str, values: NDArray[np.float64], kind: str) -> NDArray[Any]:
    """Give numbers that were read from text the type that the file declares for them, as VTK does.

    So a text gives the same spheres as the binary form of the file.

    Parameters
    ----------
    where : str
        The file and the array, for messages.
    values : array
        The numbers.
    kind : str
        NumPy's name of the type.

    Raises
    ------
    BadFileError
        If the type is one of integers and a number is none, or does not fit.
    """
    form = np.dtype(kind)
    if form.kind in "iu":
        limits = np.iinfo(form)
        # the largest numbers of 64 bits are rounded up where they are compared
        fit = (values >= float(limits.min)) & (values < float(limits.max) + 1) & (values == np.floor(values))
        if not fit.all():
            raise BadFileError(f"{where}: {values[~fit][0]}; expected integers of {8 * form.itemsize} bits")
    with np.errstate(over="ignore", invalid="ignore"):
        return values.astype(form)


def spheres(path: Path, pieces: Sequence[Piece], provenance: Provenance) -> Contents:
    """Put the pieces of one frame together.

    Parameters
    ----------
    path : pathlib.Path
        The file, for messages.
    pieces : sequence of Piece
        The pieces; empty ones count for nothing. Points that another piece owns (VTK's ghost points) are left out.
    provenance : mapping
        Where the spheres come from; the precision of the coordinates is added where it is single.

    Returns
    -------
    Contents
        The spheres, sorted by id where every piece has ids; lengths as in the file.

    Raises
    ------
    BadFileError
        If the points are no spheres, a coordinate is not finite, some pieces have sizes and others have not, or an
        id comes twice.
    """
    notes = dict(provenance)
    full = [piece for piece in pieces if len(piece.points)]
    if not full:
        return Contents(centers=np.zeros((0, 3)), radii=np.zeros(0), provenance=notes)
    _check_kind(full)
    if any(piece.single for piece in full):
        notes["coordinates"] = "single precision"
    # what is no number is found below, and need not be said twice
    with np.errstate(invalid="ignore", over="ignore"):
        centers = np.concatenate([piece.points.astype(np.float64) for piece in full])
        radii = _radii(full)
        ids = _ids(full)
        own = _own(full)
    bad = np.flatnonzero(~np.isfinite(centers).all(axis=1))
    if len(bad):
        raise BadFileError(f"{path}: point {bad[0]} is {tuple(centers[bad[0]].tolist())}; expected finite numbers")
    if ids is not None:
        own = own[id_order(path, ids[own], "points", own)]
    return Contents(
        centers=centers[own],
        radii=radii if radii is None else radii[own],
        provenance=notes,
        ids=None if ids is None else ids[own],
    )


def _own(pieces: Sequence[Piece]) -> NDArray[np.intp]:
    """Which points belong to their piece, and are no copies of points of another one."""
    if not all(_GHOSTS in piece.arrays for piece in pieces):
        return np.arange(sum(len(piece.points) for piece in pieces))
    return np.flatnonzero((_joined(pieces, _GHOSTS).astype(np.int64) & _DUPLICATE_POINT) == 0)


def _check_kind(pieces: Sequence[Piece]) -> None:
    for piece in pieces:
        if contacts := [name for name in _CONTACTS if name in piece.arrays]:
            raise BadFileError(f"{piece.where}: the points are contacts (array {contacts[0]!r}), not spheres")
        if piece.shapes and not any(name in piece.arrays for name, _ in _SIZES):
            raise BadFileError(
                f"{piece.where}: {piece.shapes} lines or polygons and no point array radius or diameter; "
                "expected spheres"
            )


def _radii(pieces: Sequence[Piece]) -> NDArray[np.float64] | None:
    for name, factor in _SIZES:
        having = [piece for piece in pieces if name in piece.arrays]
        if len(having) == len(pieces):
            return _joined(pieces, name).astype(np.float64) * factor
    for piece in pieces:
        if not any(name in piece.arrays for name, _ in _SIZES):
            with_sizes = [p for p in pieces if any(name in p.arrays for name, _ in _SIZES)]
            if not with_sizes:
                return None
            raise BadFileError(f"{piece.where}: no point array radius or diameter, which {with_sizes[0].where} has")
    raise BadFileError(f"{pieces[0].where}: some pieces have radii and others diameters; expected one of them in all")


def _ids(pieces: Sequence[Piece]) -> NDArray[np.int64] | None:
    """The ids, or None where there are none that tell all spheres apart."""
    for name in _IDS:
        if all(name in piece.arrays for piece in pieces):
            values = _joined(pieces, name)
            if values.dtype.kind in "iu" and values.max() < 2**63:
                return values.astype(np.int64)
            # MFiX writes its ids in single precision, and gives all spheres of a glued particle the same one
            numbers = values.astype(np.float64)
            if not (np.isfinite(numbers).all() and (numbers == np.floor(numbers)).all()):
                return None
            if np.abs(numbers).max() >= _EXACT_IN_SINGLE or len(np.unique(numbers)) < len(numbers):
                return None
            return numbers.astype(np.int64)
    return None


def _joined(pieces: Sequence[Piece], name: str) -> NDArray[Any]:
    return np.concatenate([piece.arrays[name] for piece in pieces])
