"""The comparison of engines as tables: in the terminal and as CSV."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from bedrad.raytrace.engine_comparison import EngineComparison
from bedrad.raytrace.engine_errors import EngineRuns
from bedrad.report.csv_tables import Table, write_tables_beside
from bedrad.report.records import with_error
from bedrad.report.terminal import add_row, new_table

__all__ = ["comparison_summary", "write_comparison_tables"]


def comparison_summary(found: EngineComparison, tolerance: float) -> RenderableType:
    """The engines, side by side, for a terminal of 80 columns.

    Parameters
    ----------
    found : EngineComparison
        What was measured.
    tolerance : float
        Error of the view factor to the first layer that the run times are given for.

    Returns
    -------
    rich renderable
        For ``rich.console.Console.print``.
    """
    parts: list[RenderableType] = [_costs(found, tolerance), Text(), _errors(found), Text()]
    notes = [_reference(found), *_choices(found)]
    notes += [f"left out: {name}: {reason}" for name, reason in found.left_out]
    return Group(*parts, *(Text(note) for note in notes))


def _costs(found: EngineComparison, tolerance: float) -> RenderableType:
    headings = (
        "set-up\n[s]",
        "rays/s\n[10⁶]",
        "facet bias of\nF_w1 [10⁻⁴]",
        f"to {tolerance:g}\n[s]",
        "with\nset-up [s]",
    )
    table = new_table("Run time on one core to an error of F_w1, bias and noise together", "\n", *headings)
    for runs in found.engines:
        seconds = runs.seconds_to(tolerance)
        bias = with_error(1e4 * runs.bias[0], 1e4 * runs.bias_error[0], 2) if runs.facets else "none"
        add_row(
            table,
            runs.name,
            f"{runs.setup_seconds:.3g}",
            f"{runs.rate / 1e6:.3g}",
            bias,
            *((f"{t:.3g}" if math.isfinite(t) else "never") for t in (seconds, seconds + runs.setup_seconds)),
        )
    caption = Text(
        "bedrad: what view-factors runs; grid walk: as the reference, with other rays\n"
        "F_w1: view factor to the first layer; never: the facet bias alone is larger"
    )
    return Group(table, caption)


def _errors(found: EngineComparison) -> RenderableType:
    headings = (
        "longest run\n[rays]",
        "true\nerror",
        "of it\nnoise",
        "stated\nerror",
        "exponent\nof rays",
    )
    table = new_table("Error of F_w1, true and stated", "\n", *headings)
    for runs in found.engines:
        exponent, error = float(runs.stated_exponent[0]), float(runs.stated_exponent_error[0])
        add_row(
            table,
            runs.name,
            f"{runs.rays[-1]:,}",
            *(f"{values[-1, 0]:.1e}" for values in (runs.true_error, runs.noise, runs.stated_error)),
            with_error(exponent, error, 2) if math.isfinite(exponent) else "",
        )
    seeds = found.engines[0].seeds
    caption = Text(
        f"true: rms distance of {seeds} runs to the reference, ± {100 / math.sqrt(2 * seeds):.0f} %\n"
        "noise: without the facet bias; stated: by the scatter within each run, with the\nexponent of its decay"
    )
    return Group(table, caption)


def _reference(found: EngineComparison) -> str:
    reference = found.reference
    value = with_error(reference.estimates[0], reference.errors[0])
    return f"reference: F_w1 = {value}, independent grid walk of {reference.rays:,} rays"


def _choices(found: EngineComparison) -> list[str]:
    """How the meshes were chosen, engine by engine."""
    notes = []
    for engine in dict.fromkeys(trial.engine for trial in found.trials):
        trials = [trial for trial in found.trials if trial.engine == engine]
        tried = [trial for trial in trials if trial.sort]
        best = min(tried, key=lambda trial: abs(trial.bias))
        if len(tried) > 1:
            biases = ", ".join(f"{t.scaling} {with_error(1e4 * t.bias, 1e4 * t.bias_error, 1)}" for t in tried)
            notes.append(f"scaling of meshes: {best.scaling}, by the coarsest's bias [10⁻⁴]: {biases}")
        rates = {trial.sort: trial.rate / 1e6 for trial in trials if trial.scaling == best.scaling}
        notes.append(f"{engine}: {rates[True]:.3g} million rays a second sorted, {rates[False]:.3g} unsorted")
    return notes


def write_comparison_tables(found: EngineComparison, tolerance: float, stem: Path) -> list[Path]:
    """Write the comparison as two CSV tables: an engine a row, and a run and target a row.

    Parameters
    ----------
    found : EngineComparison
        What was measured.
    tolerance : float
        Error of the view factor to the first layer that run times are given for.
    stem : Path
        The tables are ``<stem>_engines.csv`` and ``<stem>_runs.csv``.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    OSError
        If a table cannot be written; no half-written file stays behind.
    """
    return write_tables_beside(stem, {"engines": _engines(found, tolerance), "runs": _runs(found)})


def _engines(found: EngineComparison, tolerance: float) -> Table:
    """Every engine a row, those left out too."""
    rows = [_engine(runs, found, tolerance) for runs in found.engines]
    missing = dict.fromkeys(rows[0], math.nan)
    rows += [missing | {"engine": name, "details": f"left out: {reason}"} for name, reason in found.left_out]
    return {heading: [row[heading] for row in rows] for heading in rows[0]}


def _engine(runs: EngineRuns, found: EngineComparison, tolerance: float) -> dict[str, Any]:
    seconds = runs.seconds_to(tolerance)
    ratio, ratio_error = runs.calibration()
    return {
        "engine": runs.name,
        "details": runs.details,
        "set-up [s]": runs.setup_seconds,
        "ray rate [1/s]": runs.rate,
        "facet bias of layer 1 [1]": runs.bias[0],
        "facet bias of layer 1 error [1]": runs.bias_error[0],
        "tolerance of layer 1 [1]": tolerance,
        "run time to tolerance [s]": seconds,
        "run time to tolerance with set-up [s]": seconds + runs.setup_seconds,
        "exponent of true noise [1]": runs.exponent[0],
        "exponent of true noise error [1]": runs.exponent_error[0],
        "exponent of stated error [1]": runs.stated_exponent[0],
        "exponent of stated error error [1]": runs.stated_exponent_error[0],
        "true noise over stated error [1]": ratio,
        "true noise over stated error error [1]": ratio_error,
        "seeds [1]": runs.seeds,
        "reference layer 1 [1]": found.reference.estimates[0],
        "reference layer 1 error [1]": found.reference.errors[0],
        "reference rays [1]": found.reference.rays,
    }


def _runs(found: EngineComparison) -> Table:
    """Every engine, number of rays and target a row."""
    rows = [
        (runs.name, target, rays, runs.seconds[i], runs.setup_seconds, runs.true_error[i, k], runs.noise[i, k],
         runs.stated_error[i, k], runs.bias[k], runs.bias_error[k],
         found.reference.estimates[k], found.reference.errors[k])
        for runs in found.engines
        for k, target in enumerate(found.names)
        for i, rays in enumerate(runs.rays)
    ]  # fmt: skip
    headings = (
        "engine", "target", "rays [1]", "run time [s]", "set-up [s]", "true error [1]", "true noise [1]",
        "stated error [1]", "facet bias [1]", "facet bias error [1]", "reference [1]", "reference error [1]",
    )  # fmt: skip
    return {heading: list(column) for heading, column in zip(headings, zip(*rows, strict=True), strict=True)}
