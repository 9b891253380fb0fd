"""The command line: words to calls, nothing computed here.

Every command loads what it needs when it runs, so that ``bedrad --help`` answers at once.
"""

from __future__ import annotations

import io
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import cyclopts
from cyclopts import App, Parameter

from bedrad import __version__
from bedrad.command_options import (
    Density,
    DryRun,
    Length,
    Seed,
    Stiffness,
    check_bed_output,
    ended_like_ctrl_c,
    fail,
    list_files,
    parse_size,
    progress_bars,
    say,
    warning_printer,
)
from bedrad.convergence_command import convergence
from bedrad.convert_command import convert
from bedrad.errors import EngineFailedError, MissingExtraError
from bedrad.flow_command import flow
from bedrad.predict_command import predict
from bedrad.reduce_command import reduce
from bedrad.report_command import report
from bedrad.run_command import run
from bedrad.show_command import show
from bedrad.statistics_command import statistics
from bedrad.view_factors_command import view_factors

__all__ = ["app", "main"]

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""

app = App(
    name="bedrad",
    # a list is an option given several times; a text in brackets is no list but wrong
    default_parameter=Parameter(json_list=False),
    version=__version__,
    help="Packings near walls, exact-sphere view factors, and the heat transfer of dense granular flows up to "
    "1100 degC.",
    help_epilogue="Example:  bedrad run examples/hot_tube.toml -o results/hot_tube.h5\n\n"
    "Exit codes: 0 done, 1 the job failed (what was finished is kept), 2 the input is wrong, 130 interrupted.",
    result_action="return_value",
    suppress_keyboard_interrupt=False,
)


app.command(
    run,
    help_epilogue="Example:  bedrad run examples/hot_tube.toml -o results/hot_tube.h5\n\n"
    "Many beds, two at a time:  bedrad run examples/ensemble.toml -o results/ensemble.h5 --workers 2",
)


@app.command(
    help_epilogue="Example:  bedrad settle --tube 7.75mm --diameter 600um --height 18mm --seed 1 -o bed.h5\n\n"
    'A mixture:  bedrad settle --tube 7.75mm --size "500 um:0.3" --size "600 um:0.7" --height 18mm -o bed.h5'
)
def settle(
    *,
    tube: Annotated[Length, Parameter(name="--tube")],
    height: Length,
    diameter: Length | None = None,
    size: Annotated[tuple[str, ...], Parameter(negative=())] = (),
    seed: Seed = 1,
    density: Density = 3800.0,
    friction: float = 0.4,
    wall_friction: float | None = None,
    restitution: float = 0.85,
    stiffness: Stiffness | None = None,
    ranks: int = 1,
    output: Annotated[Path, Parameter(name=["--output", "-o"])] = Path("bed.h5"),
    dry_run: DryRun = False,
) -> None:
    """Settle a bed of spheres in a tube with LAMMPS and write it to a file.

    Parameters
    ----------
    tube
        Inner diameter of the tube, such as 7.75mm.
    height
        Height of the settled bed.
    diameter
        Particle diameter.
    size
        In place of --diameter, once for each size: diameter and number share, such as "500 um:0.3".
    seed
        Seed of the random start; the same seed gives the same bed.
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
    ranks
        MPI ranks of LAMMPS.
    output
        File to write; the suffix says the format: .h5, .vtp, .csv and others of docs/formats.md.
    dry_run
        Say what LAMMPS would be given; run nothing.
    """
    import bedrad
    from bedrad.packings.settle import plan_settle

    wall = bedrad.Tube(tube / 2)
    sizes = [parse_size(text) for text in size] or None
    parameters: dict[str, Any] = {
        "sizes": sizes, "density": density, "friction": friction, "wall_friction": wall_friction,
        "restitution": restitution, "stiffness": stiffness,
    }  # fmt: skip
    plan = plan_settle(wall, diameter, height, seed, **parameters)
    if dry_run:
        say(str(plan))
        return
    check_bed_output(output)
    with progress_bars() as report:
        bed = bedrad.settle(
            wall,
            diameter,
            height,
            seed,
            **parameters,
            ranks=ranks,
            progress=lambda f, t: report("settle", f, t),
        )
        bedrad.write(bed, output)
    say(f"{bed}")
    for name, value in bed.provenance.items():
        say(f"  {name:<28} {value}")
    list_files([output])


app.command(
    flow,
    help_epilogue="Example:  bedrad flow --tube 7.75mm --diameter 600um --velocity 0.1m/s --frames 31 -o flow.h5\n\n"
    "Through an orifice:  bedrad flow --tube 7.75mm --diameter 450um --orifice 5mm -o orifice.h5",
)


app.command(
    statistics,
    help_epilogue="Example:  bedrad statistics bed.h5 --contact-gap 0.01\n\n"
    "The mean over a flow:  bedrad statistics flow.dump --tube 7.75mm --all-frames --velocity 0.05m/s -o statistics.h5",
)


app.command(
    view_factors,
    help_epilogue="Example:  bedrad view-factors bed.h5 --tolerance 1e-4\n\n"
    "A dump:  bedrad view-factors bed.dump --tube 7.75mm --rays 4194304 --seed 2 -o factors.h5\n\n"
    "The mean over a flow:  bedrad view-factors 'flow_*.h5'",
)

app.command(
    convert,
    help_epilogue="Example:  bedrad convert bed.dump bed.vtp --tube 7.75mm --unit mm\n\n"
    "A trajectory:  bedrad convert 'dump_*.vtk' frames/bed.h5 --all-frames --axis x",
)

app.command(
    convergence,
    help_epilogue="Example:  bedrad convergence bed.h5 --tolerance 1e-4\n\n"
    "A dump, with time for fine meshes:  bedrad convergence bed.dump --tube 7.75mm --budget 300 -o engines",
)


app.command(
    reduce,
    help_epilogue="Example:  bedrad reduce examples/measured_flow.csv --tube 7.614mm --outer 9.53mm --diameter 270um "
    '--heated-length 1.57m --insulation "25 mm: 0.09 W/(m K)" --insulation "70 mm: 0.05 W/(m K)" -o measured.csv',
)


app.command(
    predict,
    help_epilogue="Example:  bedrad predict --tube 7.75mm --diameter 300um --velocity 0.058m/s "
    "--temperature 100degC --temperature 1100degC\n\n"
    "What matters most:  bedrad predict --tube 7.75mm --diameter 300um --velocity 0.058m/s --temperature 850degC "
    "--published-errors --error particle_diameter=5um --budget",
)

app.command(
    report,
    help_epilogue="Example:  bedrad report results/hot_tube.h5\n\n"
    "Into another file, and look at it:  bedrad report results/hot_tube.h5 -o hot_tube.html --open",
)

app.command(
    show,
    help_epilogue="Example:  bedrad show results/hot_tube.h5\n\n"
    "A picture:  bedrad show bed.dump --tube 7.75mm --save bed.png\n\n"
    "For ParaView:  bedrad show results/hot_tube.h5 --vtp hot_tube",
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        The words after ``bedrad``; those of the process if not given.

    Returns
    -------
    int
        Exit code: 0 done, 1 the job failed, 2 the input is wrong, 130 interrupted.
    """
    for stream in (sys.stdout, sys.stderr):
        # a terminal without "±" shows a question mark, not a traceback
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    with warnings.catch_warnings():
        warnings.showwarning = warning_printer()
        try:
            with ended_like_ctrl_c():
                words = sys.argv[1:] if arguments is None else arguments
                code = app(words, exit_on_error=False, print_error=False)
        except (cyclopts.CycloptsError, ValueError) as error:
            return fail(error, 2)
        except (EngineFailedError, MissingExtraError, OSError, MemoryError) as error:
            return fail(error, 1)
        except KeyboardInterrupt:
            return fail("interrupted; what was finished is kept", INTERRUPTED)
    # only a command of which a part failed says so by a number
    return code if isinstance(code, int) else 0
