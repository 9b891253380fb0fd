"""Reading EDEM decks, whose layout `edem_hdf5` describes: time steps, and the particles' shapes beside them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.hdf5_access import (
    check_together,
    holds,
    member,
    number_attribute,
    open_hdf5,
    read_array,
    where,
)
from bedrad.packings.files.ids import id_order

__all__ = ["edem_steps", "is_edem", "read_step"]

FloatArray = NDArray[np.float64]

_STEPS = "TimestepData"
_CREATOR = "CreatorData"
_COUNT = "num timesteps"
_TYPES = ("ParticleTypes", "Particle Types", "Particles")
"""Names under which the descriptions of the particle types are known."""
_RADIUS = ("physicalRadius", "physical radius")
_OFF_CENTRE = 1e-6
"""How far the one sphere of a particle may lie from the particle's position, in radii."""


def is_edem(path: Path) -> bool:
    """Whether an HDF5 file is an EDEM deck or one of its time steps; False if it cannot be opened."""
    if path.suffix.lower() == ".dem":
        return True
    try:
        with open_hdf5(path) as file:
            return holds(file, _STEPS) or holds(file, _CREATOR) or _COUNT in file.attrs
    except BadFileError:
        return False


def edem_steps(path: Path) -> list[tuple[str, str]]:
    """File and name of every time step of a deck, in order; errors as for `read_edem`."""
    with open_hdf5(path) as file:
        if holds(file, _STEPS):
            return _steps_of_file(file, path)
        claimed = number_attribute(file, _COUNT)
    steps: list[tuple[str, str]] = []
    for part in _parts(path, claimed):
        with open_hdf5(part) as file:
            steps += _steps_of_file(file, part)
    return steps


def _parts(path: Path, claimed: float | None) -> list[Path]:
    """The files of the time steps beside a deck, in order."""
    folder = path.with_name(f"{path.stem}_data")
    if not folder.is_dir():
        raise BadFileError(f"{path}: no group /{_STEPS}, and no folder {folder.name} with the time steps beside it")
    found = {int(part.stem): part for part in folder.glob("*.h5") if re.fullmatch(r"[0-9]{1,18}", part.stem)}
    numbers = sorted(found)
    if claimed is not None:
        # what lies beyond the count was left by an earlier run
        wanted = range(max(int(claimed), 0))
        absent = next((number for number in wanted if number not in found), None)
        if absent is not None:
            raise BadFileError(
                f"{path}: {_COUNT} is {int(claimed)}, and {folder.name}/{absent}.h5 is missing; it holds "
                f"{len(found)} time steps"
            )
        numbers = list(wanted)
    if not numbers:
        raise BadFileError(f"{path}: no time steps; {folder.name} has no files such as 0.h5 that the deck counts")
    return [found[number] for number in numbers]


def _steps_of_file(file: h5py.File, path: Path) -> list[tuple[str, str]]:
    names = _numbered(_group(file, _STEPS))
    if not names:
        raise BadFileError(f"{path}: group /{_STEPS} holds no time step")
    return [(str(path), name) for name in names]


def read_step(path: Path, deck_name: str, step: str, index: int) -> Contents:
    """Read one time step.

    Parameters
    ----------
    path : pathlib.Path
        The file that it is in.
    deck_name : str
        Path of the deck.
    step : str
        Its name in the file.
    index : int
        Its number in the deck, for the provenance.

    Raises
    ------
    BadFileError
        As `read_edem` does.
    """
    deck = Path(deck_name)
    centers: list[FloatArray] = [np.empty((0, 3))]
    radii: list[FloatArray] = [np.empty(0)]
    ids: list[NDArray[np.int64]] = [np.empty(0, np.int64)]
    held = 0
    with open_hdf5(path) as file:
        group = _group(_group(file, _STEPS), step)
        types = _group(group, _TYPES[0])
        time = number_attribute(group, "time")
        scales = {}
        for name in _numbered(types):
            particles = _particles(_group(types, name))
            if particles is not None:
                position, scales[name], number = particles
                held += position.nbytes
                check_together(file, held)
                centers.append(position)
                ids.append(number)
    sizes = _physical_radii(deck, path, list(scales))
    radii += [scale * sizes[name] for name, scale in scales.items()]
    provenance: dict[str, str | float | int] = {"file": deck.name, "format": "EDEM deck", "frame": index}
    provenance["step"] = step
    if time is not None:
        provenance["time_s"] = time
    numbers = np.concatenate(ids)
    return Contents(
        centers=np.concatenate(centers),
        radii=np.concatenate(radii),
        provenance=provenance,
        ids=numbers if (numbers >= 0).all() else None,
        states_unit=True,
    )


def _particles(group: h5py.Group) -> tuple[FloatArray, FloatArray, NDArray[np.int64]] | None:
    """Positions, scales and ids (-1 where there are none) of one type, sorted by id; None if it has no particles."""
    if not any(holds(group, name) for name in ("position", "scale", "ids")):
        return None
    position = np.asarray(read_array(_dataset(group, "position")), dtype=np.float64)
    shape = position.shape
    if position.ndim == 1 and position.size % 3 == 0:
        position = position.reshape(-1, 3)
    if position.ndim != 2 or position.shape[1] != 3:
        raise BadFileError(f"{where(group)}: position has the shape {shape}; expected (n, 3)")
    count = len(position)
    scale = np.asarray(_column(group, "scale", count, "f"), dtype=np.float64)
    if not holds(group, "ids"):
        return (position, scale, np.full(count, -1)) if count else None
    number = np.asarray(_column(group, "ids", count, "iu"), dtype=np.int64)
    order = id_order(where(group), number, "particles")
    return (position[order], scale[order], number[order]) if count else None


def _column(group: h5py.Group, name: str, count: int, kinds: str) -> NDArray[np.generic]:
    """One number a particle, as (n,) or (n, 1)."""
    dataset = _dataset(group, name)
    if dataset.shape not in ((count,), (count, 1)):
        raise BadFileError(f"{where(dataset)} has the shape {dataset.shape}; expected ({count},), one a position")
    # a constant column shrinks to almost nothing; the positions confirm how long it is
    return read_array(dataset, kinds, allowed=32 * count).reshape(count)


def _physical_radii(deck: Path, part: Path, names: Sequence[str]) -> dict[str, float]:
    """Physical radii of the types, from the first file that describes the particles. [m]"""
    if not names:
        return {}
    tried = list(dict.fromkeys([part, part.with_name("0.h5"), deck]))
    for path in tried:
        if not path.is_file():
            continue
        with open_hdf5(path) as file:
            if not holds(file, _CREATOR):
                continue
            creators = _group(file, _CREATOR)
            first = next(iter(_numbered(creators)), None)
            holder = None if first is None else _group(creators, first)
            parent = next((name for name in _TYPES if holder is not None and holds(holder, name)), None)
            if holder is not None and parent is not None:
                return {name: _physical_radius(_group(_group(holder, parent), name)) for name in names}
    raise BadFileError(
        f"{part}: no description of the particles, /{_CREATOR}/0/{_TYPES[0]}, in {', '.join(p.name for p in tried)}"
    )


def _physical_radius(group: h5py.Group) -> float:
    """The physical radius of a type that is one sphere. [m]"""
    spheres = member(group, "spheres")
    if spheres is None:
        for name in _RADIUS:
            value = number_attribute(group, name)
            dataset = member(group, name)
            if isinstance(dataset, h5py.Dataset) and dataset.size == 1:
                value = float(np.asarray(read_array(dataset), dtype=np.float64).reshape(()))
            if value is not None:
                return _positive(group, value)
        raise BadFileError(f"{where(group)} has no spheres; only particles that are one sphere are read")
    if not isinstance(spheres, h5py.Dataset) or spheres.shape != (1,):
        shape = spheres.shape if isinstance(spheres, h5py.Dataset) else None
        raise BadFileError(
            f"{where(spheres)} has the shape {shape}; only particles that are one sphere, (1,), are read"
        )
    record = read_array(spheres, "f", ("pos", "physicalRadius"))[0]
    radius = _positive(group, float(record["physicalRadius"]))
    offset = np.asarray(record["pos"], dtype=np.float64)
    if not np.abs(offset).max() <= _OFF_CENTRE * radius:
        raise BadFileError(
            f"{where(spheres)}: the sphere lies at {offset.tolist()} m in the particle; only spheres at its position "
            "are read"
        )
    return radius


def _positive(group: h5py.Group, radius: float) -> float:
    if not 0 < radius < float("inf"):
        raise BadFileError(f"{where(group)}: the physical radius is {radius} m; expected a positive number")
    return radius


def _numbered(group: h5py.Group) -> list[str]:
    """Names in a group in the order of the number they end with, which is not that of the alphabet."""

    def key(name: str) -> tuple[float, str]:
        match = re.search(r"[0-9]{1,18}$", name)
        return (int(match[0]) if match else -1, name)

    return sorted(group, key=key)


def _group(parent: h5py.Group, name: str) -> h5py.Group:
    found = member(parent, name)
    if not isinstance(found, h5py.Group):
        raise BadFileError(f"{where(parent)} has no group {name!r}")
    return found


def _dataset(parent: h5py.Group, name: str) -> h5py.Dataset:
    found = member(parent, name)
    if not isinstance(found, h5py.Dataset):
        raise BadFileError(f"{where(parent)} has no dataset {name!r}")
    return found
