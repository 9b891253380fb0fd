"""Arrays of NumPy's npz, as spheropack and scripts save packings; never a pickle."""

from __future__ import annotations

import io
import json
import math
import struct
import tokenize
import warnings
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError, visible
from bedrad.packings.files.contents import Contents
from bedrad.packings.placing import Placing, turn_to_z
from bedrad.walls import Tube

__all__ = ["looks_like_npz", "read_npz"]

POSITIONS = ("positions", "centers", "centres", "coordinates", "points", "pos", "xyz")
RADII = ("radii", "radius", "r")
DIAMETERS = ("diameters", "diameter", "d")
"""Names of the arrays that are understood, the first that is there is taken."""

_META = "meta"
_SPHEROPACK = "spheropack-1"
_LARGEST_META = 2**20
_SUFFIX = ".npy"
_ZIP_START = b"PK\x03\x04"

_HARMLESS = 2**24
"""Up to here an array may unpack to however many times its size in the file. [bytes]"""

_LARGEST_RATIO = 100
"""What arrays larger than that may unpack to, in sizes that they take in the file: positions hardly pack at all."""

_LARGEST_HEADER = 10_000
_HEADERS = {
    (1, 0): ("<H", np.lib.format.read_array_header_1_0),
    (2, 0): ("<I", np.lib.format.read_array_header_2_0),
}
"""How each version of the header gives its length, and what reads it. Version 3 differs for named fields only."""

_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    tokenize.TokenError,
    OSError,
    EOFError,
    ValueError,
    SyntaxError,
    TypeError,
    LookupError,
    ArithmeticError,
    MemoryError,
    # of encrypted entries and unknown packing, and of brackets in brackets
    RuntimeError,
)
"""What zipfile and numpy raise where a file is damaged."""


def looks_like_npz(head: bytes) -> bool:
    """Whether a file begins as a zip file does whose first entry is an array."""
    if not head.startswith(_ZIP_START) or len(head) < 30:
        return False
    (length,) = struct.unpack_from("<H", head, 26)
    return head[30 : 30 + length].endswith(_SUFFIX.encode())


def read_npz(path: Path) -> Contents:
    """Read spheres from an npz file.

    Positions of shape (n, 3) are the array `positions` (or `centers`, `centres`, `coordinates`, `points`, `pos`,
    `xyz`); sizes are `radii` (`radius`, `r`) or `diameters` (`diameter`, `d`), one for each sphere or one for all, and
    may be missing. The container in spheropack's `meta` gives the periods. A cylinder is a tube, whose axis is moved to
    x = y = 0 and turned to z; of other curved containers the middle is moved to 0.

    Raises
    ------
    BadFileError
        If it is no npz file, is damaged, lacks positions, or holds them as Python objects, which only a pickle can;
        also if it claims to unpack to much more than it holds.
    """
    with _refusing(path), path.open("rb") as stream, zipfile.ZipFile(stream) as archive:
        entries = _listed(path, archive)
        place = _first(POSITIONS, entries)
        if place is None:
            held = visible(", ".join(sorted(entries)))[:200] or "nothing"
            raise BadFileError(f"{path}: no array {', '.join(POSITIONS)}; it holds {held}")
        centers = _numbers(path, archive, place, entries[place])
        if centers.ndim != 2 or centers.shape[1] != 3:
            flat = "; packings of discs are not read" if centers.ndim == 2 and centers.shape[1] == 2 else ""
            raise BadFileError(f"{path}: array {place!r} has the shape {centers.shape}; expected (n, 3){flat}")
        radii = _radii(path, archive, entries, len(centers))
        container = _container(path, archive, entries)
    provenance = {"file": path.name, "format": "npz"}
    if container is None:
        return Contents(centers=centers, radii=radii, provenance=provenance)
    return _contained(path, centers, radii, container, provenance | {"program": "spheropack"})


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    try:
        with warnings.catch_warnings():
            # numpy and the parser of its headers warn about what is refused or harmless here
            warnings.simplefilter("ignore")
            yield
    except BadFileError:
        raise
    except _BROKEN as error:
        raise BadFileError(f"{path}: damaged or cut-off npz file ({visible(str(error))[:200]})") from error


def _listed(path: Path, archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """Arrays by name; a listing that numpy does not write is refused."""
    entries: dict[str, zipfile.ZipInfo] = {}
    for info in archive.infolist():
        name = info.filename.removesuffix(_SUFFIX)
        if name == info.filename or "/" in name or "\\" in name or not name:
            raise BadFileError(
                f"{path}: entry {info.filename[:80]!r}; expected arrays (.npy) side by side, in no folder"
            )
        if name in entries:
            raise BadFileError(f"{path}: array {name!r} comes twice")
        if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise BadFileError(f"{path}: array {name!r} is packed by method {info.compress_type}; expected 0 or 8")
        entries[name] = info
    return entries


def _first(names: tuple[str, ...], entries: Mapping[str, zipfile.ZipInfo]) -> str | None:
    return next((name for name in names if name in entries), None)


def _numbers(path: Path, archive: zipfile.ZipFile, name: str, info: zipfile.ZipInfo) -> NDArray[np.float64]:
    values = _array(path, archive, name, info)
    if values.dtype.kind not in "fiu":
        raise BadFileError(f"{path}: array {name!r} holds {values.dtype}; expected real numbers")
    values = np.asarray(values, dtype=np.float64, order="C")
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        at = tuple(bad[0].tolist())
        raise BadFileError(f"{path}: array {name!r} holds {values[at]} at {list(at)}; expected finite numbers")
    return values


def _array(path: Path, archive: zipfile.ZipFile, name: str, info: zipfile.ZipInfo) -> NDArray[Any]:
    """Read one array, once its header, the zip listing and the size of the file agree about how large it is."""
    packed = info.compress_size
    stored = info.compress_type == zipfile.ZIP_STORED
    most = packed if stored else max(_HARMLESS, _LARGEST_RATIO * packed)
    if packed > path.stat().st_size or info.file_size > most:
        raise BadFileError(f"{path}: array {name!r} claims to unpack from {packed} to {info.file_size} bytes")
    with archive.open(info) as stream:
        shape, fortran, dtype = _header(path, name, stream)
        size = math.prod(shape) * dtype.itemsize
        held = info.file_size - stream.tell()
        # integers of one byte grow to eight
        if 8 * math.prod(shape) > most and not stored:
            raise BadFileError(f"{path}: array {name!r} claims to hold {shape} numbers in {packed} bytes")
        if size != held:
            raise BadFileError(f"{path}: array {name!r} of shape {shape} takes {size} bytes; the file holds {held}")
        return np.ndarray(shape, dtype, buffer=stream.read(), order="F" if fortran else "C")


def _header(path: Path, name: str, stream: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Read what stands before the numbers: shape, whether the first index runs fastest, and kind of number."""
    start = stream.read(np.lib.format.MAGIC_LEN)
    version = np.lib.format.read_magic(io.BytesIO(start))
    if version not in _HEADERS:
        raise BadFileError(f"{path}: array {name!r} has a header of version {version}; expected (1, 0) or (2, 0)")
    form, read = _HEADERS[version]
    packed_length = stream.read(struct.calcsize(form))
    (length,) = struct.unpack(form, packed_length)
    if length > _LARGEST_HEADER:
        raise BadFileError(f"{path}: array {name!r} has a header of {length} bytes; expected {_LARGEST_HEADER} at most")
    shape, fortran, dtype = read(io.BytesIO(packed_length + stream.read(length)))
    if dtype.hasobject:
        raise BadFileError(f"{path}: array {name!r} holds Python objects, a pickle, which can run any code: not read")
    return shape, fortran, dtype


def _radii(
    path: Path, archive: zipfile.ZipFile, entries: Mapping[str, zipfile.ZipInfo], count: int
) -> NDArray[np.float64] | None:
    name = _first((*RADII, *DIAMETERS), entries)
    if name is None:
        return None
    sizes = _numbers(path, archive, name, entries[name])
    if sizes.shape not in ((), (count,)):
        raise BadFileError(f"{path}: array {name!r} has the shape {sizes.shape}; expected ({count},) or one number")
    return np.full(count, sizes / 2 if name in DIAMETERS else sizes)


def _container(
    path: Path, archive: zipfile.ZipFile, entries: Mapping[str, zipfile.ZipInfo]
) -> Mapping[str, Any] | None:
    """What spheropack says about its container; None in another program's file."""
    info = entries.get(_META)
    if info is None or info.file_size > _LARGEST_META:
        return None
    text = _array(path, archive, _META, info)
    if text.shape != () or text.dtype.kind != "U":
        return None
    try:
        meta = json.loads(str(text))
    except (ValueError, RecursionError):
        return None
    if not isinstance(meta, dict) or meta.get("format") != _SPHEROPACK:
        return None
    if not isinstance(meta.get("container"), dict):
        raise BadFileError(f"{path}: spheropack's array 'meta' names no container")
    return dict(meta["container"])


def _contained(
    path: Path,
    centers: NDArray[np.float64],
    radii: NDArray[np.float64] | None,
    container: Mapping[str, Any],
    provenance: Mapping[str, str],
) -> Contents:
    try:
        lengths = [float(length) for length in container["lengths"]]
        periodic = [bool(flag) for flag in container["periodic"]]
        ball = container["ball"]
        axes = [] if ball is None else [bool(axis) for axis in ball["axes"]]
        if len(lengths) != 3 or len(periodic) != 3 or not all(0 < length < math.inf for length in lengths):
            raise ValueError("expected three positive lengths and three flags")
        if ball is not None and (len(axes) != 3 or not any(axes)):
            raise ValueError("expected three flags of axes, of which one is set")
        periods = {axis: lengths[axis] for axis in range(3) if periodic[axis]}
        if ball is None:
            return Contents(centers, radii, axis_periods=periods, provenance=provenance)
        middle = np.where(axes, np.array([float(value) for value in ball["center"]]), 0.0)
        kind = {2: "cylinder", 3: "sphere"}.get(sum(axes), "slab")
        notes = {**provenance, "container": f"{kind} of radius {float(ball['radius'])!r}, its middle moved to 0"}
        if kind != "cylinder":
            # no wall that bedrad knows
            return Contents(centers - middle, radii, axis_periods=periods, provenance=notes)
        # along z the turn is none, and no number changes by it
        placing = Placing(tuple(middle.tolist()), turn_to_z(np.eye(3)[axes.index(False)]))
        return Contents(
            placing.place(centers),
            radii,
            wall=Tube(float(ball["radius"])),
            period=placing.periods(periods).get(Tube.axial),
            provenance=notes,
            wall_in_file_unit=True,
        )
    except (LookupError, TypeError, ValueError) as error:
        raise BadFileError(
            f"{path}: spheropack's container {str(container)[:200]} is not understood: {error}"
        ) from error
