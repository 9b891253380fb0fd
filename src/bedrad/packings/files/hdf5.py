"""bedrad's HDF5 layout of a packing: a file of its own, or the group `/packing` of a results file."""

from __future__ import annotations

import io
from datetime import UTC, datetime
from pathlib import Path
from typing import cast

import h5py

from bedrad import __version__
from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents, describe_wall, plain_value
from bedrad.packings.files.hdf5_access import where
from bedrad.packings.files.hdf5_layout import GROUP, SCHEMA_VERSION, spheres_of
from bedrad.packings.files.hdf5_reader import ask, note_written
from bedrad.packings.packing import Packing

__all__ = [
    "GROUP",
    "SCHEMA_VERSION",
    "load_packing",
    "looks_like_hdf5",
    "read_hdf5",
    "save_packing",
    "write_hdf5",
]

_LARGEST_TEXT = 60_000
"""HDF5 keeps an attribute in an object header of at most 64 KiB. [bytes]"""


def save_packing(group: h5py.Group, packing: Packing) -> None:
    """Write a packing into an empty HDF5 group.

    Parameters
    ----------
    group : h5py.Group
        Receives the datasets `centers` and `radii`, the wall, the period and the overlap limit as attributes,
        and the provenance as attributes of the subgroup `provenance`.
    packing : Packing
        The packing; `load_packing` gives it back bit for bit.

    Raises
    ------
    ValueError
        If a provenance value is not a text, a float or a 64-bit integer, or is too long for HDF5.
    """
    group.attrs["schema_version"] = SCHEMA_VERSION
    group.attrs["long_name"] = "spheres beside a wall"
    for name, values, long_name in (
        ("centers", packing.centers, "sphere centres (x, y, z)"),
        ("radii", packing.radii, "sphere radii"),
    ):
        dataset = group.create_dataset(name, data=values)
        dataset.attrs["units"] = "m"
        dataset.attrs["long_name"] = long_name
    group.attrs["wall"], radius = describe_wall(packing.wall)
    if radius is not None:
        group.attrs["wall_radius"] = radius
    if packing.period is not None:
        group.attrs["period"] = packing.period
    group.attrs["max_overlap"] = packing.max_overlap
    notes = group.create_group("provenance")
    for key, value in packing.provenance.items():
        plain = plain_value(key, value)
        if isinstance(plain, str) and len(plain.encode()) > _LARGEST_TEXT:
            raise ValueError(f"provenance {key!r} is {len(plain)} characters long; HDF5 takes {_LARGEST_TEXT} bytes")
        notes.attrs[key] = plain


def load_packing(group: h5py.Group) -> Packing:
    """Read a packing that `save_packing` wrote.

    Parameters
    ----------
    group : h5py.Group
        The group.

    Returns
    -------
    Packing
        The packing, bit for bit.

    Raises
    ------
    BadFileError
        If something is missing or is not what it should be, or the spheres are not a valid packing; the
        message names the file and the group.
    """
    held = spheres_of(group)
    try:
        return Packing(held.centers, held.radii, held.wall, held.period, held.provenance, held.max_overlap)  # type: ignore[arg-type]
    except ValueError as error:
        raise BadFileError(f"{where(group)}: {error}") from error


def looks_like_hdf5(head: bytes) -> bool:
    """Whether a file begins with the signature of HDF5."""
    return head.startswith(b"\x89HDF\r\n\x1a\n")


def read_hdf5(path: Path) -> Contents:
    """Read the spheres from a bedrad HDF5 file, a packing's own or a results file.

    Raises
    ------
    BadFileError
        If it is no HDF5 file, is cut off, holds no packing, or makes the HDF5 library end or go on for ever.
    """
    return cast(Contents, ask("read_spheres", path))


def write_hdf5(packing: Packing, path: Path) -> None:
    """Write a packing as an HDF5 file of its own, overwriting `path`."""
    # built in memory: HDF5 itself crashes the process where a disk is full
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        file.attrs["schema_version"] = SCHEMA_VERSION
        file.attrs["bedrad_version"] = __version__
        file.attrs["created"] = datetime.now(UTC).isoformat(timespec="seconds")
        save_packing(file.create_group(GROUP), packing)
    path.write_bytes(buffer.getbuffer())
    note_written(path)
