"""Reading HDF5 files that others made: nothing outside the file, nothing larger than what is stored in it."""

from __future__ import annotations

import errno
import math
import mmap
import os
import struct
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError, visible
from bedrad.packings.files.text import is_ordinary

__all__ = [
    "DAMAGED",
    "attribute",
    "check_together",
    "holds",
    "member",
    "number_attribute",
    "open_hdf5",
    "read_array",
    "where",
]

DAMAGED = "damaged or cut-off HDF5 file: "
"""How the reason begins why a file could not be read."""

before_opening: Callable[[Path], None] | None = None
"""Is told of every file before the library opens it; the process that may die sets its limits by it."""

_SMALL = 1 << 24
"""Arrays up to this size are read however little is stored of them. [bytes]"""

_COMPRESSION = 100
"""How many times its stored size a larger array may have; coordinates shrink to a half or a third."""


_HEAP = b"GCOL\x01\0\0\0"
_HEAP_HEAD = 16
_OBJECT = struct.Struct("<HHxxxxQ")
"""How a global heap begins, with its size behind, and how each object in it does: number, references, size."""

_LONGEST = 200
"""What of a name or a reason stands in a message. [characters]"""


@contextmanager
def open_hdf5(path: Path) -> Iterator[h5py.File]:
    """Open an HDF5 file for reading.

    Raises
    ------
    BadFileError
        If it cannot be opened or is damaged, also while it is read.
    """
    try:
        if not is_ordinary(path):
            raise BadFileError(f"{path}: a pipe or device; expected a file")
        if before_opening is not None:
            before_opening(path)
        _check_heaps(path)
        with h5py.File(path, "r") as file:
            yield file
    except BadFileError:
        raise
    except FileNotFoundError as error:
        raise BadFileError(f"{path}: no such file") from error
    except OSError as error:
        # the library has errors of its own, without a number, for what is in a file
        if error.errno is not None:
            raise BadFileError(f"{path}: cannot be read: {os.strerror(error.errno)}") from error
        raise BadFileError(f"{path}: {DAMAGED}{visible(str(error))[:_LONGEST]}") from error
    # h5py tells of damage by any of these
    except (RuntimeError, KeyError, ValueError, TypeError, MemoryError) as error:
        reason = visible(str(error))[:_LONGEST]
        raise BadFileError(f"{path}: {DAMAGED}{reason}") from error


def _check_heaps(path: Path) -> None:
    """Walk through the heaps in which texts are kept: the library (2.0.0) never ends where an object has no size."""
    if not path.stat().st_size:
        return
    with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        heap = _next_heap(stream.fileno(), data, 0)
        while heap >= 0:
            if heap + _HEAP_HEAD > len(data):
                break
            (size,) = struct.unpack_from("<Q", data, heap + len(_HEAP))
            place, end = heap + _HEAP_HEAD, heap + size
            while place + _OBJECT.size <= end:
                if end > len(data):
                    raise BadFileError(f"{path}: {DAMAGED}a heap of texts ends beyond it")
                number, _, length = _OBJECT.unpack_from(data, place)
                # free space counts its own head, an object does not and is filled up to eight bytes
                taken = length if number == 0 else _OBJECT.size + -(-length // 8) * 8
                if not _OBJECT.size <= taken <= end - place:
                    raise BadFileError(f"{path}: {DAMAGED}a heap of texts with a false size")
                place += taken
            heap = _next_heap(stream.fileno(), data, heap + _HEAP_HEAD)


def _next_heap(descriptor: int, data: mmap.mmap, begin: int) -> int:
    """Where the next heap begins, or -1. Holes are passed over: going through them takes time, and room in memory."""
    while begin < len(data):
        end = len(data)
        try:
            begin = os.lseek(descriptor, begin, os.SEEK_DATA)
            end = os.lseek(descriptor, begin, os.SEEK_HOLE)
        except (AttributeError, OSError) as error:
            if getattr(error, "errno", None) == errno.ENXIO:
                return -1
            # this system or disk knows no holes
        # the zeros at the end of its name may lie in one
        found = data.find(_HEAP, begin, end + len(_HEAP) - 1)
        if found >= 0:
            return found
        begin = end
    return -1


def where(item: h5py.Group | h5py.Dataset) -> str:
    """File and place of a group or dataset, for messages."""
    kind = "dataset" if isinstance(item, h5py.Dataset) else "group"
    return f"{item.file.filename}: {kind} {visible(str(item.name))[:_LONGEST]}"


def holds(group: h5py.Group, name: str) -> bool:
    """Whether a group holds something under a name, wherever it leads."""
    return bool(group.id.links.exists(_raw(name)))


def member(group: h5py.Group, name: str) -> h5py.Group | h5py.Dataset | None:
    """Return what a group holds under a name, None if nothing.

    Raises
    ------
    BadFileError
        If it is a link by name, which may lead to another file.
    """
    if not holds(group, name):
        return None
    if group.id.links.get_info(_raw(name)).type != h5py.h5l.TYPE_HARD:
        raise BadFileError(f"{where(group)}: {name!r} is a link by name; only what the group itself holds is read")
    found = group[name]
    return found if isinstance(found, (h5py.Group, h5py.Dataset)) else None


def attribute(item: h5py.Group | h5py.Dataset, name: str) -> Any:
    """Return an attribute as h5py gives it; None if there is no such attribute.

    Raises
    ------
    BadFileError
        If it is a list of variable length, which nothing that is read here has. The library (2.0.0) takes a text whose
        kind is broken for one, does not know where in memory to put it, and crashes (a NULL file in `H5VL_blob_put`).
    """
    if name not in item.attrs:
        return None
    if item.attrs.get_id(name).get_type().detect_class(h5py.h5t.VLEN):
        told = visible(name)[:_LONGEST]
        raise BadFileError(
            f"{where(item)}: the attribute {told!r} is a list of variable length; expected texts, numbers"
        )
    return item.attrs[name]


def number_attribute(item: h5py.Group | h5py.Dataset, name: str) -> float | None:
    """Return an attribute that is one number; None if there is no such attribute.

    Raises
    ------
    BadFileError
        If it is something else.
    """
    if name not in item.attrs:
        return None
    found = item.attrs.get_id(name)
    if found.dtype.kind not in "fiu" or not _is_one(found.shape):
        raise BadFileError(f"{where(item)}: the attribute {name!r} is not a number")
    value = float(np.asarray(item.attrs[name]).reshape(()))
    if not math.isfinite(value):
        raise BadFileError(f"{where(item)}: the attribute {name!r} is {value}; expected a finite number")
    return value


def read_array(
    dataset: h5py.Dataset, kinds: str = "f", fields: Sequence[str] = (), allowed: int = 0
) -> NDArray[np.generic]:
    """Read a whole dataset of numbers.

    Parameters
    ----------
    dataset : h5py.Dataset
        The dataset.
    kinds : str
        What its numbers may be: ``f`` for floating point, ``i`` and ``u`` for integers.
    fields : sequence of str
        For a dataset of records, the fields to read.
    allowed : int
        Size that is accepted however well it is compressed, where something else confirms it. [bytes]

    Raises
    ------
    BadFileError
        If it holds something else, lies in other files, or claims to be much larger than what is stored.
    """
    types = [dataset.dtype]
    if fields:
        absent = [name for name in fields if name not in (dataset.dtype.names or ())]
        if absent:
            raise BadFileError(f"{where(dataset)}: no field {absent[0]!r}; it holds {dataset.dtype}")
        types = [dataset.dtype[name] for name in fields]
    for dtype in types:
        if dtype.base.kind not in kinds:
            expected = "floating-point numbers" if kinds == "f" else "numbers"
            raise BadFileError(f"{where(dataset)} holds {dtype}; expected {expected}")
    if dataset.is_virtual or dataset.external:
        raise BadFileError(f"{where(dataset)}: its numbers lie in other files; these are not read")
    if dataset.shape is None:
        raise BadFileError(f"{where(dataset)} is empty")
    # unwritten parts are stored nowhere, and a broken index may name the same bytes many times
    stored = min(dataset.id.get_storage_size(), dataset.file.id.get_filesize())
    for shape in (dataset.shape, dataset.chunks or ()):
        size = math.prod(shape) * dataset.dtype.itemsize
        if size > max(_SMALL, allowed, _COMPRESSION * stored):
            raise BadFileError(
                f"{where(dataset)} has the shape {shape}, {size} bytes, of which {stored} bytes are stored"
            )
    read: NDArray[np.generic] = np.asarray(dataset.fields(list(fields))[()] if fields else dataset[()])
    return read


def check_together(file: h5py.File, size: int) -> None:
    """Refuse what many datasets of a file hold together, if it is much larger than the file.

    Each may be small, stored nowhere, or the same one under many names.

    Parameters
    ----------
    file : h5py.File
        The file.
    size : int
        What was read of it. [bytes]

    Raises
    ------
    BadFileError
        If it is more than any file of this size can hold.
    """
    stored = file.id.get_filesize()
    if size > max(_SMALL, _COMPRESSION * stored):
        raise BadFileError(f"{file.filename}: its datasets hold {size} bytes and more together, the file {stored}")


def _raw(name: str) -> bytes:
    return name.encode("utf-8", "surrogateescape")


def _is_one(shape: tuple[int, ...] | None) -> bool:
    return shape is not None and math.prod(shape) == 1
