"""What the commands share: options with units, progress bars, printing."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import cyclopts
from cyclopts import Parameter
from rich.text import Text

from bedrad.errors import visible
from bedrad.screen import Screen, visible_lines

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
                    note("compiling the kernels: once after installation, some ten seconds")
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
            note(f"compiled the kernels in {notice.seconds:.1f} s; the next run finds them")


def note(text: str) -> None:
    """Print a line beside the results, on the error stream."""
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
