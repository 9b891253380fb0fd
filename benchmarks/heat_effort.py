"""Error against run time in the heat models: terms of a series, nodes of a quadrature, draws of a Monte Carlo.

python benchmarks/heat_effort.py [--csv docs/heat_effort.csv] [--figure docs/images/heat_effort.png]

Errors do not depend on the machine, times do: the least processor time of several runs on one core.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.heat import RangeWarning, cylinder, prediction, two_layer
from bedrad.heat.prediction import System, Uncertainties
from bedrad.report import style
from bedrad.report.csv_tables import Table, write_table

A, KAPPAS = 28.2, np.geomspace(0.25, 25.0, 100)
POSITIONS = (1e-4, 1e-3, 1e-2)
SYSTEM = System(7.75e-3, 300e-6, 0.058)
GIVEN = Uncertainties(
    tube_diameter=2e-5, particle_diameter=6e-6, solid_conductivity=0.2, porosity=0.01, emissivity=0.05,
    wall_temperature=5.0, gas_conductivity=0.01, bulk_conductivity=0.05, packing_fraction=0.02, contacts_per_area=0.05,
)  # fmt: skip
RESULT = "heat_transfer_coefficient"


def timed(function: Callable[[], Any], repeats: int = 25) -> tuple[Any, float]:
    """Result and least processor time of several runs; the first is not counted."""
    found = function()
    spent = []
    for _ in range(repeats):
        started = time.process_time()
        function()
        spent.append(time.process_time() - started)
    return found, min(spent)


def series() -> list[tuple[str, int, float, float]]:
    """Nusselt number near the inlet, by terms, and what `nusselt` chooses: largest error and time a value."""
    rows = []
    for z in POSITIONS:
        exact = two_layer.nusselt(A, KAPPAS, z, tolerance=1e-12)
        for terms in (1, 2, 4, 8, 16, 32, 64, 128):
            found, seconds = timed(lambda z=z, n=terms: two_layer.nusselt_series(A, KAPPAS, z, n).nusselt)
            error = float(np.max(np.abs(found / exact - 1.0)))
            rows.append((f"series, z* = {z:g}", terms, error, seconds / KAPPAS.size))
            if error < 1e-12:
                break
        found, seconds = timed(lambda z=z: two_layer.nusselt_solution(A, KAPPAS, z))
        error = float(np.max(np.abs(found.nusselt / exact - 1.0)))
        rows.append((f"chosen, z* = {z:g}", int(np.max(found.terms)), error, seconds / KAPPAS.size))
    return rows


def quadrature() -> list[tuple[str, int, float, float]]:
    """Conductivity of a particle at a tube wall, by nodes: largest error over tubes and time a value."""
    rows = []
    tubes = np.geomspace(5.0, 500.0, 100)
    for K in (10.0, 70.0, 1e4):
        inputs = (np.full(tubes.shape, K), tubes, np.zeros(tubes.shape))
        fine = cylinder._integrals(*inputs, cylinder._double_exponential(250, 3.8))
        for count in (3, 5, 8, 12, 18, 26, 36, 48, 60):
            rule = cylinder._double_exponential(count, 3.4)
            (area, heat), seconds = timed(lambda inputs=inputs, rule=rule: cylinder._integrals(*inputs, rule))
            error = float(np.max(np.abs(heat / area / (fine[1] / fine[0]) - 1.0)))
            rows.append((f"quadrature, K = {K:g}", 2 * count + 1, error, seconds / tubes.size))
    return rows


def draws() -> list[tuple[str, int, float, float]]:
    """Standard error of h: the scatter of what draws say over 32 seeds, and how far the first order is off."""

    def run(samples: int, seed: int) -> Any:
        return prediction.predict(SYSTEM, 1123.15, uncertainties=GIVEN, samples=samples, seed=seed)

    exact = float(run(400_000, 12345).monte_carlo.standard_deviation[RESULT][0])
    rows = []
    for samples in (100, 400, 1600, 6400, 25600):
        found = [float(run(samples, seed).monte_carlo.standard_deviation[RESULT][0]) for seed in range(32)]
        _, seconds = timed(lambda n=samples: run(n, 0), 7)
        error = float(np.sqrt(np.mean((np.array(found) / exact - 1.0) ** 2)))
        rows.append(("draws", samples, error, seconds))
    first, seconds = timed(lambda: run(0, 0))
    error = abs(float(first.heat_transfer_coefficient_error) / exact - 1.0)
    rows.append(("first order", 1, max(error, 0.5 / np.sqrt(2 * 400_000)), seconds))
    return rows


def figure(rows: list[tuple[str, int, float, float]], path: Path) -> None:
    panels = {
        "Series of the two-layer model": ("series", "chosen"),
        "Particle at a tube wall": ("quadrature",),
        "Standard error of $h$": ("draws", "first"),
    }
    from matplotlib.ticker import NullFormatter

    with style.styled():
        drawing = style.new_figure(11.0, 4.0)
        for axes, (title, kinds) in zip(drawing.subplots(1, 3), panels.items(), strict=True):
            names = list(dict.fromkeys(row[0] for row in rows if row[0].startswith(kinds)))
            curves = [name for name in names if not name.startswith(("chosen", "first"))]
            for name, color, marker in zip(curves, style.COLOURS, style.MARKERS, strict=False):
                found = [row for row in rows if row[0] == name]
                label = name.split(", ")[-1].replace("z*", "$z^*$").replace("K", "$K$")
                axes.loglog(
                    [1e3 * row[3] for row in found], [row[2] for row in found], color=color, marker=marker, label=label
                )
                for row in found[:: max(1, len(found) // 3)]:
                    place = (1e3 * row[3], row[2])
                    axes.annotate(
                        f"{row[1]}", place, xytext=(5, 3), textcoords="offset points", fontsize=7.5, color=color
                    )
            for name, color in zip((n for n in names if n not in curves), style.COLOURS, strict=False):
                row = next(row for row in rows if row[0] == name)
                label = "by `nusselt`" if name.startswith("chosen") else "first order"
                known = axes.get_legend_handles_labels()[1]
                color = style.GREY if name.startswith("first") else color
                axes.loglog(1e3 * row[3], max(row[2], 1e-14), "*", color=color, markersize=11,
                            label=None if label in known else label)  # fmt: skip
            axes.set_title(title)
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_minor_formatter(NullFormatter())
            low, high = (1e3 * end(row[3] for row in rows if row[0] in names) for end in (min, max))
            axes.set_xlim(10 ** np.floor(np.log10(low)), 10 ** np.ceil(np.log10(high)))
            axes.set_xlabel("Processor time of one value [ms]")
            axes.legend(loc="best")
        drawing.axes[0].set_ylabel("Relative error")
        style.save(drawing, path, "Error against run time in the heat models")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--csv", type=Path, default=Path("docs/heat_effort.csv"))
    parser.add_argument("--figure", type=Path, default=Path("docs/images/heat_effort.png"))
    given = parser.parse_args()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RangeWarning)
        rows = [*series(), *quadrature(), *draws()]
    names = ("what", "terms, nodes or draws", "relative error [1]", "time [s]")
    table: Table = {name: [row[k] for row in rows] for k, name in enumerate(names)}
    write_table(given.csv, table)
    for row in rows:
        print(f"{row[0]:<24}{row[1]:>7}{row[2]:>12.2e}{1e3 * row[3]:>10.3f} ms")
    figure(rows, given.figure)


if __name__ == "__main__":
    main()
