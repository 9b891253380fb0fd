"""Reading bedrad's HDF5 layout of a packing: a file of its own, or the group `/packing` of a results file."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError, visible
from bedrad.packings.files.contents import Contents, make_wall, plain_value
from bedrad.packings.files.hdf5_access import attribute, member, number_attribute, open_hdf5, read_array, where

if TYPE_CHECKING:
    from bedrad.packings.packing import Provenance

__all__ = ["GROUP", "SCHEMA_VERSION", "read_spheres", "spheres_of"]

GROUP = "packing"
"""Name of the group that holds the packing, in a packing's own file and in a results file."""

SCHEMA_VERSION = 1
"""Version of the layout of that group."""


def read_spheres(path: Path) -> Contents:
    """Read the spheres from a file; errors as for `bedrad.packings.files.hdf5.read_hdf5`."""
    with open_hdf5(path) as file:
        group = member(file, GROUP)
        if isinstance(group, h5py.Group):
            return spheres_of(group)
        raise BadFileError(f"{path}: no group /{GROUP}; the file holds {_listing(file)}")


def spheres_of(group: h5py.Group) -> Contents:
    """Read the spheres from a group; BadFileError if something is missing or not what it should be."""
    place = where(group)
    version = attribute(group, "schema_version")
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
            wall=make_wall(attribute(group, "wall"), attribute(group, "wall_radius")),
            period=_period(attribute(group, "period")),
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
    units = attribute(dataset, "units")
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
    for key in notes.attrs:
        if not isinstance(key, str):
            raise BadFileError(f"{where(notes)}: the attribute {key!r:.60} has a name that is not UTF-8")
    return {key: plain_value(key, attribute(notes, key)) for key in notes.attrs}


def _listing(names: Iterable[str]) -> str:
    return visible(", ".join(sorted(names)))[:200] or "nothing"
