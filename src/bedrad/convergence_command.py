"""The command that compares the engines: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

from pathlib import Path

from bedrad.bed_options import BedOptions
from bedrad.command_options import (
    OUTPUT,
    DryRun,
    Output,
    Seed,
    compiling_told,
    list_files,
    progress_bars,
    say,
)

__all__ = ["convergence"]


def convergence(
    file: Path,
    /,
    *,
    bed_options: BedOptions | None = None,
    tolerance: float = 1e-4,
    budget: float = 120.0,
    seeds: int = 8,
    seed: Seed = 0,
    output: Output = None,
    dry_run: DryRun = False,
) -> None:
    """Measure the error of the view factors against run time with every engine at hand.

    bedrad's exact spheres and, where the extras open3d and mesh are installed, spheres made of facets, with the scaling
    of the least bias. Bias, noise and set-up come apart; errors are distances to an independent, longer run.

    Parameters
    ----------
    file
        The packing: a file of any format of docs/formats.md.
    tolerance
        Error of the view factor to the first layer to which run times are given.
    budget
        Time for the whole study in seconds; what does not fit in is left out and said.
    seeds
        Repetitions over which the errors are averaged.
    seed
        First seed of the rays.
    output
        Beginning of the names of the tables (CSV) and the figure (PNG); the packing's name with _convergence in this
        folder if not given.
    dry_run
        Read and check the packing and say which engines would be measured.
    """
    from bedrad.jobs.results import check_writable
    from bedrad.raytrace.engine_comparison import compare_engines, mesh_libraries
    from bedrad.report.engine_figure import write_comparison_figure
    from bedrad.report.engine_tables import comparison_summary, write_comparison_tables
    from bedrad.report.style import styled

    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance is {tolerance!r}; expected a number between 0 and 1")
    options = bed_options or BedOptions()
    bed, edges = options.read(file)
    if dry_run:
        options.describe(bed, edges)
        libraries, missing = mesh_libraries()
        say(f"engines   {', '.join(('bedrad', 'grid walk', *libraries))}")
        for name, reason in missing:
            say(f"left out  {name}: {reason}")
        return
    stem = output or Path(f"{file.stem}_convergence")
    if stem.suffix.lower() in (".csv", ".png"):
        stem = stem.with_suffix("")
    figure = stem.with_name(f"{stem.name}.png")
    check_writable(figure)
    # a missing library shows before the computing, not after
    with styled():
        pass
    with compiling_told(), progress_bars() as report:
        found = compare_engines(
            bed, edges, budget=budget, seeds=seeds, seed=seed, window=bed.window(options.margin),
            progress=lambda share, text: report("convergence", share, text),
        )  # fmt: skip
    OUTPUT.print(comparison_summary(found, tolerance))
    written = write_comparison_tables(found, tolerance, stem)
    write_comparison_figure(found, tolerance, figure, file.name)
    list_files([*written, figure])
