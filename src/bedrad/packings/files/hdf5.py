"""bedrad's HDF5 layout of a packing: a file of its own, or the group `/packing` of a results file."""

from __future__ import annotations

import io
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from bedrad import __version__
from bedrad.errors import BadFileError, visible
from bedrad.packings.files.contents import Contents, describe_wall, make_wall, plain_value
from bedrad.packings.files.hdf5_access import member, number_attribute, open_hdf5, read_array, where
from bedrad.packings.packing import Packing, Provenance

__all__ = [
    "GROUP",
    "SCHEMA_VERSION",
    "load_packing",
    "looks_like_hdf5",
    "read_hdf5",
    "save_packing",
    "write_hdf5",
]

GROUP = "packing"
"""Name of the group that holds the packing, in a packing's own file and in a results file."""

SCHEMA_VERSION = 1
"""Version of the layout of that group."""

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
    held = _contents(group)
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
        If it is no HDF5 file, is cut off, or holds no packing.
    """
    with open_hdf5(path) as file:
        group = member(file, GROUP)
        if isinstance(group, h5py.Group):
            return _contents(group)
        raise BadFileError(f"{path}: no group /{GROUP}; the file holds {_listing(file)}")


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


def _contents(group: h5py.Group) -> Contents:
    place = where(group)
    version = group.attrs.get("schema_version")
    if version != SCHEMA_VERSION:
        raise BadFileError(
            f"{place} has the schema_version {visible(str(version))[:40]}; this bedrad reads {SCHEMA_VERSION}"
        )
    centers, radii = (_dataset(group, name) for name in ("centers", "radii"))
    if centers.ndim != 2 or centers.shape[1] != 3 or radii.shape != centers.shape[:1]:
        raise BadFileError(
            f"{place} has centers of shape {centers.shape} and radii of shape {radii.shape}; expected (n, 3) and (n,)"
        )
    if "max_overlap" not in group.attrs:
        raise BadFileError(f"{place} has no attribute 'max_overlap'; it has {_listing(group.attrs)}")
    try:
        return Contents(
            centers=centers,
            radii=radii,
            wall=make_wall(group.attrs.get("wall"), group.attrs.get("wall_radius")),
            period=_period(group.attrs.get("period")),
            provenance=_notes(group),
            max_overlap=number_attribute(group, "max_overlap"),
            states_unit=True,
        )
    except BadFileError:
        raise
    except (TypeError, ValueError) as error:
        raise BadFileError(f"{place}: {visible(str(error))[:200]}") from error


def _dataset(group: h5py.Group, name: str) -> NDArray[np.float64]:
    place = where(group)
    dataset = member(group, name)
    if not isinstance(dataset, h5py.Dataset):
        raise BadFileError(f"{place} has no dataset {name!r}; it holds {_listing(group)}")
    if dataset.dtype.kind != "f":
        raise BadFileError(f"{place}: dataset {name!r} holds {dataset.dtype}; expected floating-point numbers")
    units = dataset.attrs.get("units")
    if units != "m":
        raise BadFileError(f"{place}: dataset {name!r} has the units {units!r:.40}; expected 'm'")
    return np.asarray(read_array(dataset), dtype=np.float64)


def _period(stored: object) -> float | tuple[float, float] | None:
    if stored is None:
        return None
    given = np.atleast_1d(np.asarray(stored))
    if given.dtype.kind not in "fiu" or given.ndim != 1:
        raise ValueError(f"the attribute 'period' is {stored!r:.40}; expected one or two numbers")
    values = [float(v) for v in given]
    if len(values) not in (1, 2):
        raise ValueError(f"the attribute 'period' holds {len(values)} numbers; expected 1 or 2")
    return values[0] if len(values) == 1 else (values[0], values[1])


def _notes(group: h5py.Group) -> Provenance:
    notes = member(group, "provenance")
    if not isinstance(notes, h5py.Group):
        raise BadFileError(f"{where(group)} has no group 'provenance'; it holds {_listing(group)}")
    return {key: plain_value(key, value) for key, value in notes.attrs.items()}


def _listing(names: Iterable[str]) -> str:
    return visible(", ".join(sorted(names)))[:200] or "nothing"
