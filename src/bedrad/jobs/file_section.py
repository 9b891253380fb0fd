"""The section of a job that says which file the bed is read from, and what that file does not say."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator

from bedrad.jobs.section import Finite, NotNegative, PositiveLength, Section, YesNo, form_of
from bedrad.jobs.units import Length
from bedrad.packings.files.sources import is_pattern
from bedrad.packings.wall_fit import WALL_KINDS

__all__ = ["FileSection", "Frames", "chosen_frames"]

Frames = str | tuple[int, ...]
"""Frames of each file: "all", their numbers, or a slice such as "10:200:5", as Python counts."""

_SLICE = re.compile(r"(-?\d{1,15})?:(-?\d{1,15})?(?::(\d{1,15}))?")

Unit = Literal["m", "cm", "mm", "um", "µm", "μm", "nm", "in", "ft"]


def _column(value: object) -> str:
    """A title as it is, and a number as text."""
    if isinstance(value, str) and value.strip():
        return value
    if isinstance(value, int) and not isinstance(value, bool) and value >= 1:
        return str(value)
    raise ValueError("expected the title of a column or its number, counted from 1")


def _not_all_zero(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    if not any(direction):
        raise ValueError("expected three numbers that are not all zero")
    return direction


def _wall(text: str) -> str:
    if text not in WALL_KINDS and not _is_stl(text):
        raise ValueError(f"expected {', '.join(map(repr, WALL_KINDS))} or an .stl file")
    return text


def _is_stl(text: str) -> bool:
    return Path(text).suffix.lower() == ".stl"


def _frames(value: object) -> object:
    """Frames as `Frames` has them."""
    if isinstance(value, (list, tuple)):
        if value and all(isinstance(number, int) and not isinstance(number, bool) for number in value):
            return tuple(value)
    elif isinstance(value, str) and (value == "all" or ((match := _SLICE.fullmatch(value)) and match[3] != "0")):
        return value
    raise ValueError("expected 'all', a list of frame numbers, or a slice such as '10:200:5'")


def chosen_frames(frames: Frames, count: int) -> tuple[int, ...]:
    """Numbers of the frames, from 0, of a file that has so many.

    Raises
    ------
    ValueError
        If one of them is not there, or none is.
    """
    if frames == "all":
        return tuple(range(count))
    if isinstance(frames, str):
        parts = [int(part) if part else None for part in frames.split(":")]
        found = tuple(range(count)[slice(*parts)])
        if not found:
            raise ValueError(f"frames {frames!r} are none of its {count} frames")
        return found
    for number in frames:
        if not -count <= number < count:
            raise ValueError(f"frame {number} was asked for; the file has {count}, counted from 0")
    return tuple(number % count for number in frames)


ColumnOfTable = Annotated[str, Field(max_length=200), BeforeValidator(_column)]
Direction = Annotated[tuple[Finite, Finite, Finite], AfterValidator(_not_all_zero)]


class ColumnsSection(Section):
    """Where positions and sizes stand in a table: the title of the column, or its number from 1."""

    x: ColumnOfTable | None = None
    y: ColumnOfTable | None = None
    z: ColumnOfTable | None = None
    radius: ColumnOfTable | None = None
    diameter: ColumnOfTable | None = None


class FileSection(Section):
    """A bed read from a file, or many; the keys are the parameters of `bedrad.read`, and two that are about many.

    Parameters
    ----------
    path
        A file; for many beds a pattern such as ``"beds/*.h5"``, a folder, or a list of these.
    frames
        Which frames of each file are beds of their own: see `Frames`.
    independent
        Whether the beds have nothing in common, so that their scatter tells the error of their mean. Files do, frames
        of one file do not, if not given; false is for files that are a flow's frames one after the other.
    """

    path: Annotated[
        Annotated[Path, Tag("<one>")] | Annotated[tuple[Path, ...], Field(min_length=1, max_length=500), Tag("<list>")],
        Discriminator(form_of),
    ]
    frames: Annotated[Frames, BeforeValidator(_frames)] | None = None
    independent: YesNo | None = None
    wall: Annotated[str, AfterValidator(_wall)] | None = None
    wall_unit: Unit | None = None
    diameter: PositiveLength | None = None
    period: Annotated[
        Annotated[Annotated[Length, Field(ge=0)] | None, Tag("<one>")]
        | Annotated[tuple[PositiveLength, PositiveLength], Tag("<list>")],
        Discriminator(form_of),
    ] = None
    frame: Annotated[int, Field(strict=True)] = -1
    max_overlap: NotNegative | None = None
    unit: Unit | None = None
    columns: ColumnsSection | None = None
    axis: Annotated[
        Annotated[Literal["x", "y", "z"] | None, Tag("<one>")] | Annotated[Direction, Tag("<list>")],
        Discriminator(form_of),
    ] = None
    origin: tuple[Length, Length, Length] | None = None

    @model_validator(mode="after")
    def _check_wall(self) -> FileSection:
        if self.wall_file is None and self.wall_unit is not None:
            raise ValueError("wall_unit is for a wall from an .stl file")
        if self.wall_file is not None and (self.axis is not None or self.origin is not None):
            raise ValueError("the .stl file says where the wall is; axis and origin are for other walls")
        if self.wall_file is None and self.wall is not None and self.origin is not None:
            raise ValueError(f"where the {self.wall} is will be fitted; origin is for the wall of a [wall]")
        if self.frames is not None and "frame" in self.model_fields_set:
            raise ValueError("frame is for one bed, frames for many; give one of the two")
        return self

    @property
    def is_many(self) -> bool:
        """Whether the beds are many, or may be: a list, a pattern, a folder, or frames."""
        if isinstance(self.path, tuple) or self.frames is not None or self.independent is not None:
            return True
        return is_pattern(self.path) or self.path.is_dir()

    @property
    def only_path(self) -> Path:
        """The file of a job that names one bed."""
        assert isinstance(self.path, Path)  # noqa: S101 - jobs that name many are taken apart first
        return self.path

    @property
    def wall_file(self) -> Path | None:
        """The file that the wall comes from, if one does."""
        return Path(self.wall) if self.wall is not None and _is_stl(self.wall) else None

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The files that are read."""
        beds = self.path if isinstance(self.path, tuple) else (self.path,)
        return beds if self.wall_file is None else (*beds, self.wall_file)

    def in_folder(self, folder: Path) -> FileSection:
        """The same, with relative paths counted from a folder."""
        beds = tuple(folder / path for path in self.path) if isinstance(self.path, tuple) else folder / self.path
        places: dict[str, Any] = {"path": beds}
        if self.wall_file is not None:
            places["wall"] = str(folder / self.wall_file)
        return self.model_copy(update=places)

    def options(self) -> dict[str, Any]:
        """Arguments of `bedrad.read`, beside the path and the wall."""
        columns = None if self.columns is None else self.columns.model_dump(exclude_none=True)
        names = ("diameter", "period", "frame", "max_overlap", "unit", "axis", "origin", "wall_unit")
        return {name: getattr(self, name) for name in names} | {"columns": columns}
