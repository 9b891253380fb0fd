"""The command that turns one packing file into another: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bedrad.bed_options import ReadOptions
from bedrad.command_options import DryRun, check_bed_output, list_files, say
from bedrad.errors import visible

if TYPE_CHECKING:
    from bedrad.packings.packing import Packing

__all__ = ["convert"]


def convert(
    source: Path,
    target: Path,
    /,
    *,
    read_options: ReadOptions | None = None,
    all_frames: Annotated[bool, Parameter(negative=())] = False,
    dry_run: DryRun = False,
) -> None:
    """Read a packing and write it in another format, with what was read and fitted in its provenance.

    Parameters
    ----------
    source
        The packing: a file of any format of docs/formats.md. With --all-frames also a folder, or a pattern in quotes.
    target
        The file to write; the suffix says the format: .h5, .vtp, .csv and others of docs/formats.md.
    all_frames
        Write every frame, numbered from 0, to a file of its own: bed.h5 becomes bed_0000.h5, bed_0001.h5 and so on.
    dry_run
        Read and check, and say what was found; write nothing.
    """
    import bedrad

    options = read_options or ReadOptions()
    check_bed_output(target, place=not dry_run)
    if not all_frames:
        bed = options.read_packing(source)
        _tell(bed)
        if not dry_run:
            bedrad.write(bed, target)
            list_files([target])
        return
    if options.frame != -1:
        raise ValueError(f"--frame {options.frame} and --all-frames: give one of them")
    count = 0
    for count, bed in enumerate(options.read_frames(source), start=1):
        options.tell_wall(bed)
        if count == 1:
            _tell(bed)
        if not dry_run:
            each = target.with_name(f"{target.stem}_{count - 1:04d}{target.suffix}")
            bedrad.write(bed, each)
            list_files([each])
    say(f"{count} frames")


def _tell(bed: Packing) -> None:
    say(str(bed))
    for name, value in bed.provenance.items():
        say(f"  {name:<28} {visible(str(value))}")
