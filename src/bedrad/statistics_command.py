"""The command that measures packings: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bedrad.bed_options import BedOptions
from bedrad.command_options import (
    OUTPUT,
    DryRun,
    Length,
    Output,
    Velocity,
    check_output,
    compiling_told,
    save,
    say,
)

if TYPE_CHECKING:
    from bedrad.jobs.comparison import Comparison
    from bedrad.packings.packing import Packing
    from bedrad.packings.statistics import Statistics
    from bedrad.packings.unrolled_wall import UnrolledWall

__all__ = ["statistics"]

PROFILE_RADII = 10.0
"""Depth of the profiles in mean radii: five diameters, over which the wall's order fades."""


def statistics(
    file: Path,
    /,
    *more: Path,
    bed_options: BedOptions | None = None,
    contact_gap: float = 1e-2,
    all_frames: Annotated[bool, Parameter(negative=())] = False,
    velocity: Velocity | None = None,
    depth: Length | None = None,
    stem: Path | None = None,
    print_only: Annotated[bool, Parameter(negative=())] = False,
    output: Output = None,
    dry_run: DryRun = False,
) -> None:
    """Measure a packing, or the mean over a trajectory: solid fractions, contacts, gaps, order, with errors.

    Prints one screen, writes tables (CSV), and draws the profile and the unrolled wall (PNG, extra view).

    Parameters
    ----------
    file
        The packing: a file of any format of docs/formats.md. Also a pattern in
        quotes, or with --all-frames a folder.
    more
        Further files; all frames of all files are then averaged.
    contact_gap
        Gap to the wall, or between particles, that counts as contact, in radii.
    all_frames
        Average over all frames in place of the one that --frame names.
    velocity
        Mean flow velocity to evaluate the correlations at (Watkins 2018); that of the file if it names one.
    depth
        How deep the profiles go; five diameters or as deep as there is room if not given.
    stem
        Beginning of the names of tables and figures; that of the results file, or of the packing in this folder, if
        not given.
    print_only
        Write no tables and figures.
    output
        Results file (HDF5) to write: the mean over all frames, with the checksums of all files.
    dry_run
        Read and check the packing and say what would be measured.
    """
    import bedrad
    from bedrad.jobs.comparison import check_comparable, compare_with_correlations
    from bedrad.packings.unrolled_wall import unrolled_wall
    from bedrad.report.statistics_screen import statistics_screen

    options = bed_options or BedOptions()
    first, edges, frames, sources = options.read_several(file, *more, all_frames=all_frames)
    if velocity is not None:
        check_comparable(first.wall, velocity)
    if dry_run:
        options.describe(first, edges)
        return
    check_output("statistics", output)
    names = None if print_only else _names(file, output, stem)
    missing = None if names is None else _check(names)
    velocities: list[float | None] = []
    with compiling_told():
        reach = float(first.radii.max())
        wall = unrolled_wall(first, contact_gap, float(edges[1]), margin=options.margin, overhang=reach)
        found = bedrad.statistics(
            _noting(chain([first], frames), velocities), edges, contact_gap, margin=options.margin,
            profile_depths=_profile_depth(first, float(edges[-1]), depth),
        )  # fmt: skip
    # only a flow in a tube has correlations
    speed = velocity if velocity is not None or found.wall.kind != "tube" else _mean(velocities)
    compared = [] if speed is None else compare_with_correlations(found, speed)
    OUTPUT.print(statistics_screen(found, compared, speed))
    if names is not None:
        _write(found, wall, compared, names, file.name, missing)
    if output is not None:
        from bedrad.jobs.stages import fill_statistics

        save("statistics", lambda group: fill_statistics(group, found), output, *sources)


def _noting(frames: Iterable[Packing], velocities: list[float | None]) -> Iterator[Packing]:
    """Pass frames on, and note the mean velocity of the flow that each is from."""
    from bedrad.jobs.comparison import flow_velocity

    for bed in frames:
        velocities.append(flow_velocity(bed.provenance))
        yield bed


def _mean(velocities: list[float | None]) -> float | None:
    """Mean velocity, where every frame has one."""
    known = [v for v in velocities if v is not None]
    return sum(known) / len(known) if len(known) == len(velocities) else None


def _profile_depth(bed: Packing, last_edge: float, wanted: float | None) -> float:
    """Depth of the profiles: as wanted, or five diameters where wall and bed have room, and all layers."""
    if wanted is not None:
        return wanted
    deepest = min(PROFILE_RADII * 0.5 * bed.mean_diameter, bed.wall.largest_depth, float(bed.depths.max()))
    return max(deepest, last_edge)


def _names(file: Path, output: Path | None, stem: Path | None) -> Path:
    """Beginning of the names of tables and figures."""
    if stem is not None:
        return stem.with_suffix("") if stem.suffix.lower() in (".csv", ".png") else stem
    if output is not None:
        return output.with_suffix("")
    # a pattern for several files is no name for one
    plain = "".join(letter for letter in file.name.partition(".")[0] if letter not in "*?[]").strip("_-")
    return Path(plain or "frames")


def _check(names: Path) -> str | None:
    """Make sure that tables can be written before anything is measured; why no figures can, if so."""
    from bedrad.errors import MissingExtraError
    from bedrad.jobs.results import check_writable
    from bedrad.report.style import styled

    check_writable(names.with_name(f"{names.name}_statistics.csv"))
    try:
        with styled():
            return None
    except MissingExtraError as error:
        return str(error)


def _write(
    found: Statistics, wall: UnrolledWall, compared: list[Comparison], names: Path, title: str, missing: str | None
) -> None:
    """Write tables and figures, and list them."""
    from bedrad.report.statistics_figures import write_statistics_figures
    from bedrad.report.statistics_tables import as_data, write_statistics_tables

    written = write_statistics_tables(found, wall, compared, names)
    if missing is None:
        written += write_statistics_figures(as_data(found), wall, names, title)
    for suffix in (".csv", ".png"):
        kinds = [path.stem.removeprefix(f"{names.name}_") for path in written if path.suffix == suffix]
        if kinds:
            say(f"wrote {names.with_name(f'{names.name}_*{suffix}')}: {', '.join(kinds)}")
    if missing is not None:
        say(f"left out: figures: {missing}")
