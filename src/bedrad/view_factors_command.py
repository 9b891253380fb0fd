"""The command that traces view factors: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from bedrad.bed_options import BedOptions, parse_columns
from bedrad.command_options import (
    DryRun,
    Output,
    Seed,
    check_output,
    compiling_told,
    progress_bars,
    save,
    say,
)

if TYPE_CHECKING:
    from bedrad.packings.packing import Packing

__all__ = ["view_factors"]


@dataclass(frozen=True)
class _Frames:
    """Frames that come one at a time, and how many: each has its share of the rays."""

    frames: Iterator[Packing]
    count: int

    def __iter__(self) -> Iterator[Packing]:
        return self.frames

    def __len__(self) -> int:
        return self.count


def view_factors(
    file: Path,
    /,
    *more: Path,
    bed_options: BedOptions | None = None,
    all_frames: Annotated[bool, Parameter(negative=())] = False,
    tolerance: float | None = None,
    rays: int | None = None,
    seed: Seed = 0,
    threads: int | None = None,
    normalised: Literal["watkins"] | None = None,
    output: Output = None,
    dry_run: DryRun = False,
) -> None:
    """Trace the view factors from the wall to the layers of a packing, or their means over a flow, with errors.

    Parameters
    ----------
    file
        The packing: a file of any format of docs/formats.md. Also a pattern in
        quotes, or with --all-frames a folder.
    more
        Further files; all frames of all files are then averaged.
    all_frames
        Average over all frames in place of the one that --frame names.
    tolerance
        Trace until every standard error, of frames that of the mean, is below this; 1e-3 if --rays is not given either.
    rays
        Trace this many rays instead.
    seed
        Seed of the rays.
    threads
        Number of threads; all processors if not given. The result does not depend on it.
    normalised
        Spread what meets no layer over the layers, as the publication named does.
    output
        Results file (HDF5) to write.
    dry_run
        Read and check the packing and say what would be traced.
    """
    import bedrad
    from bedrad.packings.files import count_frames
    from bedrad.packings.files.sources import is_pattern

    options = bed_options or BedOptions()
    bed, edges, others, sources = options.read_several(file, *more, all_frames=all_frames)
    if dry_run:
        options.describe(bed, edges)
        return
    check_output("view_factors", output)
    what: Packing | _Frames = bed
    if all_frames or more or is_pattern(file):
        count = sum(count_frames(source, parse_columns(options.column)) for source in sources)
        what = _Frames(chain([bed], others), count)
    with compiling_told(), progress_bars() as report:
        found = bedrad.view_factors(
            what, edges, tolerance, rays, seed, window=bed.window(options.margin), threads=threads,
            progress=lambda share, text: report("view factors", share, text),
        )  # fmt: skip
    if normalised is not None:
        found = found.normalised(normalised)
    say(str(found))
    ends = options.ends_left_out(bed)
    if ends is not None:
        say(f"left out: {ends}")
    if output is not None:
        from bedrad.jobs.stages import fill_view_factors

        save("view_factors", lambda group: fill_view_factors(group, found), output, *sources)
