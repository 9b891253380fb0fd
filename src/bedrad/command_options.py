"""What the commands share: options with units, the wall, progress bars, printing."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import cyclopts
from cyclopts import Group, Parameter
from rich.text import Text

from bedrad.errors import visible
from bedrad.screen import Screen, visible_lines

if TYPE_CHECKING:
    from bedrad.packings.packing import Packing
    from bedrad.walls import Wall

OUTPUT, NOTES = Screen(), Screen(stderr=True)
"""Results go to the one, progress, warnings and errors to the other; neither lets a text steer the terminal."""


def read_as(unit: str) -> Any:
    """Parameter that reads a text such as ``600um`` as a number in the SI unit `unit`."""

    def convert(_: type, tokens: Sequence[cyclopts.Token]) -> float:
        from bedrad.jobs.units import quantity

        try:
            return quantity(tokens[0].value, unit)
        except ValueError as error:
            # inside a tuple cyclopts would drop the reason of a plain ValueError
            raise cyclopts.CoercionError(msg=Text(str(error)), token=tokens[0], target_type=float) from None

    return Parameter(converter=convert, show_default=False)


Length = Annotated[float, read_as("m")]
Velocity = Annotated[float, read_as("m/s")]
Temperature = Annotated[float, read_as("K")]
Density = Annotated[float, read_as("kg/m^3")]
Stiffness = Annotated[float, read_as("N/m")]
Pressure = Annotated[float, read_as("Pa")]
HeatFlux = Annotated[float, read_as("W/m^2")]
Conductivity = Annotated[float, read_as("W/(m K)")]
PerArea = Annotated[float, read_as("1/m^2")]
Seed = Annotated[int, Parameter(validator=cyclopts.validators.Number(gte=0, lt=2**63))]
Output = Annotated[Path | None, Parameter(name=["--output", "-o"])]
DryRun = Annotated[bool, Parameter(negative=())]
WALL_GROUP = Group("Wall", help="One of these where the file does not name its wall; fitted to the spheres otherwise.")
TubeDiameter = Annotated[Length | None, Parameter(name="--tube", group=WALL_GROUP)]
RodDiameter = Annotated[Length | None, Parameter(name="--rod", group=WALL_GROUP)]
IsPlate = Annotated[bool, Parameter(name="--plate", group=WALL_GROUP, negative=())]
WallFile = Annotated[Path | None, Parameter(name="--wall-stl", group=WALL_GROUP)]
FittedWall = Annotated[Literal["tube", "rod", "plate"] | None, Parameter(name="--fit-wall", group=WALL_GROUP)]


def parse_size(text: str) -> tuple[float, float]:
    """Diameter [m] and number share from a text such as ``"500 um:0.3"``; ValueError if it is not one."""
    from bedrad.jobs.units import quantity

    diameter, separator, share = text.rpartition(":")
    try:
        if not separator:
            raise ValueError
        number = float(share)
    except ValueError:
        raise ValueError(f'--size {text!r}: expected a diameter and a number share, such as "500 um:0.3"') from None
    return quantity(diameter, "m"), number


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
        _note("; ".join(parts))

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


def check_output(stage: str, output: Path | None) -> None:
    """Check that a record can be saved, before it is computed."""
    if output is None:
        return
    from bedrad.jobs.results import check_record_file

    check_record_file(output, stage)


def check_bed_output(output: Path, *, place: bool = True) -> None:
    """Check that a packing can be written, before it is computed: ValueError for its suffix, OSError for its place."""
    from bedrad.jobs.results import check_writable
    from bedrad.packings.files import FORMATS

    known = [suffix for form in FORMATS if form.write is not None for suffix in form.suffixes]
    if output.suffix.lower() not in known:
        raise ValueError(f"{output}: suffix {output.suffix!r}; packings are written as {', '.join(known)}")
    if place:
        check_writable(output)


def save(stage: str, fill: Any, output: Path | None, *sources: Path) -> None:
    """Write a record of what was measured in files to a results file, if one was asked for."""
    if output is None:
        return
    from bedrad.jobs.results import save_record

    save_record(output, stage, fill, *sources)
    list_files([output])


def say(text: str) -> None:
    """Print a line of results, or several, as they are."""
    OUTPUT.print(visible_lines(text), soft_wrap=True)


def list_files(paths: list[Path]) -> None:
    """Print the files that were written."""
    for path in paths:
        say(f"wrote {visible(str(path))}")


@contextmanager
def progress_bars() -> Iterator[Any]:
    """Bars on the error stream: stage, share done, time left."""
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description:<13}", markup=False),
        BarColumn(bar_width=30),
        TaskProgressColumn(),
        TimeRemainingColumn(elapsed_when_finished=True),
        TextColumn("{task.fields[note]}", markup=False),
    )
    with Progress(*columns, console=NOTES) as bars:
        tasks: dict[str, Any] = {}

        def report(stage: str, share: float, text: str) -> None:
            if stage not in tasks:
                tasks[stage] = bars.add_task(stage.replace("_", " "), total=1.0, note="")
            bars.update(tasks[stage], completed=share, note=text)

        yield report


@contextmanager
def compiling_told() -> Iterator[None]:
    """Say on the error stream when kernels are compiled, as they are on first use, and how long it took."""
    from numba.core import event

    class Notice(event.Listener):  # type: ignore[misc]
        """Of the compiler's events; a kernel that comes from the cache causes none. Kernels compile what they call."""

        depth, begin, seconds = 0, 0.0, 0.0

        def on_start(self, _: event.Event) -> None:
            if self.depth == 0:
                self.begin = time.perf_counter()
                if self.seconds == 0.0:
                    _note("compiling the kernels: once after installation, some ten seconds")
            self.depth += 1

        def on_end(self, _: event.Event) -> None:
            self.depth -= 1
            if self.depth == 0:
                self.seconds += time.perf_counter() - self.begin

    notice = Notice()
    try:
        with event.install_listener("numba:compile", notice):
            yield
    finally:
        if notice.seconds:
            _note(f"compiled the kernels in {notice.seconds:.1f} s; the next run finds them")


def _note(text: str) -> None:
    NOTES.print(visible_lines(text), soft_wrap=True)


@contextmanager
def ended_like_ctrl_c() -> Iterator[None]:
    """Let a request to end (SIGTERM) do what Ctrl-C does, so that LAMMPS and half-written files go with us."""

    def stop(*_: Any) -> None:
        raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def warning_printer() -> Callable[..., None]:
    """Make a function that prints each warning as one line, and the same text only once."""
    shown: set[str] = set()

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        text = " ".join(str(message).split())
        if text not in shown:
            shown.add(text)
            NOTES.print(f"warning: {visible(text)}", style="yellow", soft_wrap=True)

    return show


def fail(error: BaseException | str, code: int) -> int:
    """Print an error as one line and pass on the exit code."""
    text = str(error) or type(error).__name__
    if isinstance(error, OSError) and error.filename is not None and error.strerror:
        text = f"{visible(str(error.filename))}: {error.strerror}"
    NOTES.print(f"bedrad: {visible_lines(text)}", style="red", soft_wrap=True)
    return code
