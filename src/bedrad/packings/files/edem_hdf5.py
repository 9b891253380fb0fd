"""EDEM decks: HDF5 files with the time steps, and the shapes of the particles beside them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import cast

from bedrad.errors import BadFileError
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.hdf5_reader import ask

__all__ = ["is_edem", "iterate_edem", "read_edem"]

_Step = tuple[str, str]
"""File and name of a time step."""


def is_edem(path: Path) -> bool:
    """Whether an HDF5 file is an EDEM deck or one of its time steps; False if it cannot be opened."""
    if path.suffix.lower() == ".dem":
        return True
    try:
        return bool(ask("is_edem", path))
    except BadFileError:
        return False


def read_edem(path: Path, frame: int = -1) -> Contents:
    """Read one time step of an EDEM deck.

    EDEM's layout is not published; what follows is what open programs that read decks rely on, and bedrad relies
    on no more. A deck `name.dem` has an attribute `num timesteps` and a folder `name_data` beside it with the files
    `0.h5`, `1.h5` and so on, one a saved time; each of these can also be read by itself. They hold

    - `/TimestepData/<step>` with the attribute `time` (s), and in it `ParticleTypes/<type>` with the datasets
      `position` ((n, 3) or flat, m), `scale` (n) and, optionally, `ids` (n);
    - `/CreatorData/<k>/ParticleTypes/<type>`, in the same file or in `0.h5`, with the dataset `spheres`: a record
      a sphere, of which `pos` and `physicalRadius` (m) are used; or `physicalRadius` or `physical radius` itself,
      as a dataset or an attribute. Of several `<k>` the first is taken.

    The radius of a particle is taken as its scale times the physical radius of its type, which no open program states.
    Types of several spheres, of a
    sphere off the centre, and of other shapes are refused. Frames are the files in the order of their numbers, and
    in a file the steps in the order of theirs. Spheres are sorted by type, and by id where there is one. Lengths
    are in metres. Periodic boundaries are not known from these files.

    Parameters
    ----------
    path : pathlib.Path
        The deck (`.dem`) or one of its files (`.h5`).
    frame : int
        Which frame, counted from 0, or from the end if negative.

    Raises
    ------
    BadFileError
        If the frame does not exist, a file is missing or damaged, or the layout is another.
    """
    steps = _steps(path)
    if not -len(steps) <= frame < len(steps):
        raise BadFileError(f"{path}: frame {frame} was asked for; the file has {len(steps)}, counted from 0")
    return _read(path, steps[frame], frame % len(steps))


def iterate_edem(path: Path) -> Iterator[Contents]:
    """Yield the time steps of an EDEM deck one after the other, keeping one in memory."""
    for index, step in enumerate(_steps(path)):
        yield _read(path, step, index)


def _steps(path: Path) -> list[_Step]:
    return [(file, name) for file, name in cast("list[_Step]", ask("edem_steps", path))]


def _read(deck: Path, step: _Step, index: int) -> Contents:
    return cast(Contents, ask("read_step", Path(step[0]), str(deck), step[1], index))
