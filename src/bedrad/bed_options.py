"""Options of the commands that read beds: which wall, which frame, what a file does not say, how the bed is cut."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Group, Parameter

from bedrad.command_options import Length, note, say

if TYPE_CHECKING:
    from bedrad.packings.packing import Packing
    from bedrad.walls import Wall

__all__ = ["BedOptions", "ReadOptions", "parse_axis", "parse_columns"]

WALL_GROUP = Group("Wall", help="One of these where the file does not name its wall; fitted to the spheres otherwise.")
TubeDiameter = Annotated[Length | None, Parameter(name="--tube", group=WALL_GROUP)]
RodDiameter = Annotated[Length | None, Parameter(name="--rod", group=WALL_GROUP)]
IsPlate = Annotated[bool, Parameter(name="--plate", group=WALL_GROUP, negative=())]
WallFile = Annotated[Path | None, Parameter(name="--wall-stl", group=WALL_GROUP)]
FittedWall = Annotated[Literal["tube", "rod", "plate"] | None, Parameter(name="--fit-wall", group=WALL_GROUP)]


def parse_axis(text: str) -> str | tuple[float, ...]:
    """Direction from ``x``, ``y`` or ``z``, or from three numbers such as ``"0.1, 0, 1"``; ValueError if it is none."""
    parts = text.replace(",", " ").split()
    if len(parts) == 1:
        return parts[0]
    try:
        return tuple(float(part) for part in parts)
    except ValueError:
        raise ValueError(f'--axis {text!r}: expected x, y, z or three numbers, such as "0.1,0,1"') from None


def parse_columns(texts: Sequence[str]) -> dict[str, str]:
    """Columns from texts such as ``"x=Position X"``; ValueError if one is none, or names a quantity again."""
    columns: dict[str, str] = {}
    for text in texts:
        name, separator, column = (part.strip() for part in text.partition("="))
        if not (name and separator and column):
            raise ValueError(f'--column {text!r}: expected a quantity and a column, such as "x=Position X" or "x=2"')
        if name in columns:
            raise ValueError(f"--column {text!r}: {name} was given before, as {columns[name]!r}")
        columns[name] = column
    return columns


@Parameter(name="*")
@dataclass(frozen=True)
class ReadOptions:
    """Which bed is in a file, and what the file does not say.

    Parameters
    ----------
    tube
        The bed is in a tube of this inner diameter.
    rod
        The bed is around a rod of this diameter.
    plate
        The bed lies on the plane z = 0.
    wall_stl
        The wall is the cylinder or plane in this STL file (extra mesh).
    fit_wall
        Fit this kind of wall to the spheres.
    wall_unit
        What the lengths in the STL file are in; --unit if not given, or m.
    period
        The bed repeats along the axis of a tube or rod after this length.
    diameter
        Particle diameter, for files that hold positions only.
    unit
        What the lengths in the file are in, where it does not say so: m, cm, mm, um, nm, in or ft. [default: m]
    axis
        Direction in the file of the wall's axis, or the normal of a plate: x, y, z or three numbers, such as "0.1,0,1".
    origin
        A point of the axis or plate in the file: three lengths.
    column
        Where a quantity stands in a table, once for each: "x=Position X", or "x=2" for the second column.
    frame
        Number of the frame, from 0; -1 is the last.
    max_overlap
        Overlap that is accepted, in radii; the file's or 0.1 if not given.
    """

    tube: TubeDiameter = None
    rod: RodDiameter = None
    plate: IsPlate = False
    wall_stl: WallFile = None
    fit_wall: FittedWall = None
    wall_unit: Annotated[str | None, Parameter(group=WALL_GROUP)] = None
    period: Length | None = None
    diameter: Length | None = None
    unit: str | None = None
    axis: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None
    origin: Annotated[tuple[Length, Length, Length] | None, Parameter(negative=(), allow_leading_hyphen=True)] = None
    column: Annotated[tuple[str, ...], Parameter(negative=(), show_default=False)] = ()
    frame: int = -1
    max_overlap: float | None = None

    def read_packing(self, file: Path) -> Packing:
        """Read one frame, and say on the error stream what wall was fitted; ValueError if several walls were given."""
        import bedrad

        bed = bedrad.read(file, frame=self.frame, **self._arguments())
        self.tell_wall(bed)
        return bed

    def read_frames(self, source: Path) -> Iterator[Packing]:
        """Read all frames of a file, a pattern or a folder, one after the other."""
        import bedrad

        return bedrad.read_frames(source, **self._arguments())

    def tell_wall(self, bed: Packing) -> None:
        """Say on the error stream what wall was fitted, if one was, and how sure it is."""
        notes = bed.provenance
        if "wall_origin" not in notes or self.tube is not None or self.rod is not None or self.plate:
            return
        parts = [f"wall: {bed.wall!r}, {notes['wall_origin']}"]
        for key, form in (
            ("wall_fit_residual_radii", "residual {:.2g} radii"),
            ("wall_fit_residual_m", "residual {:.2g} m"),
            ("wall_fit_radius_error_m", "radius ± {:.2g} m"),
            ("wall_fit_axis_error_m", "axis ± {:.2g} m"),
            ("wall_fit_height_error_m", "height ± {:.2g} m"),
            ("wall_fit_direction_error_rad", "direction ± {:.2g} rad"),
            ("wall_facet_sagitta_m", "facets up to {:.2g} m inside"),
        ):
            if key in notes:
                parts.append(form.format(notes[key]))
        note("; ".join(parts))

    def _arguments(self) -> dict[str, Any]:
        """What `bedrad.read` is given."""
        import bedrad

        given: list[Wall | Path | str] = []
        if self.tube is not None:
            given.append(bedrad.Tube(self.tube / 2))
        if self.rod is not None:
            given.append(bedrad.Rod(self.rod / 2))
        if self.plate:
            given.append(bedrad.Plate())
        given += [wall for wall in (self.wall_stl, self.fit_wall) if wall is not None]
        if len(given) > 1:
            raise ValueError("give one wall: --tube, --rod, --plate, --wall-stl or --fit-wall")
        return {
            "wall": given[0] if given else None,
            "diameter": self.diameter,
            "period": self.period,
            "max_overlap": self.max_overlap,
            "unit": self.unit,
            "columns": parse_columns(self.column),
            "axis": None if self.axis is None else parse_axis(self.axis),
            "origin": self.origin,
            "wall_unit": self.wall_unit,
        }


@Parameter(name="*")
@dataclass(frozen=True)
class BedOptions(ReadOptions):
    """Which bed a command measures, and how it is cut; the parameters of `ReadOptions`, and two more.

    Parameters
    ----------
    layers
        Number of layers: the first one radius deep, the others one diameter.
    margin
        What is left out at open ends, in mean diameters.
    """

    layers: int = 3
    margin: float = 4.0

    def read(self, file: Path) -> tuple[Packing, Any]:
        """Read the bed and cut it: the packing and the depths of its layers; ValueError if several walls were given."""
        import bedrad

        bed = self.read_packing(file)
        return bed, bedrad.layer_edges(bed, self.layers)

    def read_several(
        self, file: Path, *more: Path, all_frames: bool
    ) -> tuple[Packing, Any, Iterator[Packing], list[Path]]:
        """Read frames one by one: the first, depths of its layers, those that follow, the files; or the only one."""
        from bedrad.packings.files import files_of
        from bedrad.packings.files.sources import is_pattern

        if not (all_frames or more or is_pattern(file)):
            return *self.read(file), iter(()), [file]
        import bedrad

        frames = chain.from_iterable(self.read_frames(source) for source in (file, *more))
        first = next(frames, None)
        if first is None:
            raise ValueError(f"{file}: holds no frames; there is nothing to measure")
        self.tell_wall(first)
        sources = [each for given in (file, *more) for each in files_of(given)]
        return first, bedrad.layer_edges(first, self.layers), frames, sources

    def describe(self, bed: Packing, edges: Any) -> None:
        """Print what would be measured."""
        window = bed.window(self.margin)
        say(str(bed))
        say(f"window    {window.axial[0]:.6g} to {window.axial[1]:.6g} m along the axis")
        say(f"layers    {', '.join(f'{e:.6g}' for e in edges)} m deep")

    def ends_left_out(self, bed: Packing) -> str | None:
        """What is left out of the wall at open ends, and why; None where the bed repeats."""
        window, axis = bed.window(self.margin), bed.wall.axial
        if bed.box[axis]:
            return None
        cut = 1e3 * (window.axial[0] - bed.extent(axis)[0])
        return f"{cut:.3g} mm of wall at either end, {self.margin:g} mean diameters, as the bed is loose and open there"
