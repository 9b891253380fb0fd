"""The section of a job that says which file the bed is read from, and what that file does not say."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator

from bedrad.jobs.section import Finite, NotNegative, PositiveLength, Section, form_of
from bedrad.jobs.units import Length
from bedrad.packings.wall_fit import WALL_KINDS

__all__ = ["FileSection"]

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
    """A bed read from a file; the keys are the parameters of `bedrad.read`."""

    path: Path
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
        return self

    @property
    def wall_file(self) -> Path | None:
        """The file that the wall comes from, if one does."""
        return Path(self.wall) if self.wall is not None and _is_stl(self.wall) else None

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The files that are read."""
        return (self.path,) if self.wall_file is None else (self.path, self.wall_file)

    def in_folder(self, folder: Path) -> FileSection:
        """The same, with relative paths counted from a folder."""
        places: dict[str, Any] = {"path": folder / self.path}
        if self.wall_file is not None:
            places["wall"] = str(folder / self.wall_file)
        return self.model_copy(update=places)

    def options(self) -> dict[str, Any]:
        """Arguments of `bedrad.read`, beside the path and the wall."""
        columns = None if self.columns is None else self.columns.model_dump(exclude_none=True)
        names = ("diameter", "period", "frame", "max_overlap", "unit", "axis", "origin", "wall_unit")
        return {name: getattr(self, name) for name in names} | {"columns": columns}
