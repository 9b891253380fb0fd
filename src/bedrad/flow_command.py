"""The command that makes packings of a flow: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter

from bedrad.command_options import (
    Density,
    DryRun,
    Length,
    Pressure,
    Seed,
    Stiffness,
    Velocity,
    check_bed_output,
    list_files,
    parse_size,
    progress_bars,
    say,
)

__all__ = ["flow"]

_CHANNEL = Group("Channel", help="Lengths in mean particle diameters (d), the hopper's in tube diameters (D).")


@Parameter(name="*", group=_CHANNEL)
@dataclass(frozen=True)
class ChannelOptions:
    """The channel of a flow.

    Parameters
    ----------
    tube_length
        Length of the tube, in d.
    belt
        Height of the belt, the piece at the foot of the tube where the velocity is set, in d.
    window
        Where the flow is measured: from and to so far above the belt, in d.
    hopper_width
        Diameter of the hopper, in D; 1 leaves it out.
    hopper_angle
        Full angle of the hopper's cone, in degrees.
    hopper_level
        Height of the particles above the cone, in D.
    orifice
        Diameter of the outlet of a blunt funnel at the foot of the tube, in place of the belt and of --velocity.
    """

    tube_length: float = 30.0
    belt: float = 3.0
    window: Annotated[tuple[float, float], Parameter(negative=())] = (10.0, 22.0)
    hopper_width: float = 1.5
    hopper_angle: float = 60.0
    hopper_level: float = 0.2
    orifice: Length | None = None


def flow(
    *,
    tube: Annotated[Length, Parameter(name="--tube")],
    diameter: Length | None = None,
    size: Annotated[tuple[str, ...], Parameter(negative=())] = (),
    velocity: Velocity | None = None,
    frames: int = 50,
    seed: Seed = 1,
    density: Density = 3800.0,
    friction: float = 0.4,
    wall_friction: float | None = None,
    restitution: float = 0.85,
    stiffness: Stiffness | None = None,
    youngs_modulus: Pressure | None = None,
    poisson_ratio: float = 0.3,
    channel: ChannelOptions | None = None,
    flush: float | None = None,
    spacing: float = 0.5,
    ranks: int = 1,
    work_dir: Path | None = None,
    output: Annotated[Path, Parameter(name=["--output", "-o"])] = Path("flow.h5"),
    dry_run: DryRun = False,
) -> None:
    """Let spheres flow down a tube with LAMMPS, keep frames of them, and measure the flow.

    A run that was cut off goes on where it was when it is started again with the same words.

    Parameters
    ----------
    tube
        Inner diameter of the tube, such as 7.75mm.
    diameter
        Particle diameter.
    size
        In place of --diameter, once for each size: diameter and number share, such as "500 um:0.3".
    velocity
        Mean velocity of the flow.
    frames
        Number of packings.
    seed
        Seed of the random start.
    density
        Density of the particles. [default: 3800 kg/m^3]
    friction
        Coefficient of friction between particles.
    wall_friction
        Coefficient of friction with the wall; as between particles if not given.
    restitution
        Coefficient of restitution.
    stiffness
        Stiffness of the contacts; softened if not given, by a rule that --dry-run shows.
    youngs_modulus
        In place of --stiffness: Young's modulus, for Hertz contacts.
    poisson_ratio
        Poisson's ratio, for Hertz contacts.
    flush
        Displacement before the first frame, in d; 20 and 6 U^2/g more if not given.
    spacing
        Displacement between two frames, in d.
    ranks
        MPI ranks of LAMMPS.
    work_dir
        Folder that keeps what LAMMPS reads and writes; if not given, one beside the output that goes when all is done.
    output
        Name of the packings; flow.h5 becomes flow_0000.h5, flow_0001.h5 and so on. Tables go beside them.
    dry_run
        Say what LAMMPS would be given; run nothing.
    """
    import bedrad
    from bedrad.packings.flow import plan_flow
    from bedrad.packings.flow_plan import Channel
    from bedrad.report.flow_tables import write_flow_tables

    options = channel or ChannelOptions()
    parameters: dict[str, Any] = {
        "sizes": [parse_size(text) for text in size] or None, "density": density, "friction": friction,
        "wall_friction": wall_friction, "restitution": restitution, "stiffness": stiffness,
        "youngs_modulus": youngs_modulus, "poisson_ratio": poisson_ratio,
        "channel": Channel(**vars(options)), "flush": flush, "spacing": spacing,
    }  # fmt: skip
    wall = bedrad.Tube(tube / 2)
    plan = plan_flow(wall, diameter, velocity, frames, **parameters)
    if dry_run:
        say(str(plan))
        return
    check_bed_output(output)
    digits = max(4, len(str(frames - 1)))
    files = [output.with_name(f"{output.stem}_{k:0{digits}d}{output.suffix}") for k in range(frames)]
    pattern = output.with_name(f"{output.stem}_{'?' * digits}{output.suffix}")
    _check_no_other_frames(pattern, files)
    folder = work_dir or _own_folder(output)
    with progress_bars() as report:
        found = bedrad.flow(
            wall, diameter, velocity, frames, seed, **parameters, ranks=ranks, work_dir=folder,
            progress=lambda share, text: report("flow", share, text),
        )  # fmt: skip
        for packing, file in zip(found, files, strict=True):
            bedrad.write(packing, file)
    say(str(found))
    tables = write_flow_tables(found, output.with_suffix(""))
    if work_dir is None:
        shutil.rmtree(folder)
    list_files([*tables, files[0], files[-1]])
    say(f"{len(files)} packings; measure them with: bedrad statistics '{pattern}'")


def _check_no_other_frames(pattern: Path, files: list[Path]) -> None:
    """Refuse frames of a longer flow that would lie among those to be written, and be measured with them."""
    expected = {file.name for file in files}
    for file in sorted(pattern.parent.glob(pattern.name)):
        number = file.stem.rpartition("_")[2]
        if number.isdigit() and file.name not in expected:
            raise ValueError(
                f"{file} is left from another flow and would lie among the {len(files)} frames of this one; "
                "remove it, or give another --output"
            )


def _own_folder(output: Path) -> Path:
    """The folder beside the output that goes when all is done; ValueError if it holds what no flow left there."""
    from bedrad.packings.flow_run import MARK

    folder = output.with_name(f"{output.stem}.run")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / MARK).exists():
        raise ValueError(f"{folder} would be removed at the end, but holds files of no flow; name a --work-dir")
    return folder
