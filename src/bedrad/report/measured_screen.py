"""Measured flows on the screen: h, Nu and the first-law check at every station."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.text import Text

from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.measured_flow import ModelRun, ReducedRun
from bedrad.report.records import with_error
from bedrad.report.terminal import add_row, new_table

__all__ = ["measured_screen"]


def measured_screen(
    runs: Sequence[ReducedRun], model: Sequence[ModelRun] | None, notes: Sequence[str]
) -> RenderableType:
    """What was measured, in tables of 80 columns.

    Parameters
    ----------
    runs : sequence of ReducedRun
        What was measured.
    model : sequence of ModelRun or None
        The model beside each run, if there is one.
    notes : sequence of str
        Lines that say what was assumed.

    Returns
    -------
    rich renderable
        For ``rich.console.Console.print``.
    """
    return Group(_readings(runs, model), Text(), _coefficients(runs, model), Text(), _balance(runs), *map(Text, notes))


def _label(run: ReducedRun, k: int) -> str:
    name = run.run.name if len(run.run.name) <= 16 else f"{run.run.name[:15]}…"
    return f"{name}, {run.position[k]:.4g}"


def _readings(runs: Sequence[ReducedRun], model: Sequence[ModelRun] | None) -> Any:
    headings = ["T_wall [°C]", "T_mean [°C]", "q [kW/m²]", "loss [%]"] + ([] if model is None else ["U [m/s]"])
    table = new_table("Readings (± standard errors)", "run, z [m]", *headings)
    for place, run in enumerate(runs):
        for k in range(run.position.size):
            T_w, T_m, q = run.wall_temperature, run.mean_temperature, run.heat_flux
            add_row(
                table,
                _label(run, k),
                with_error(T_w.value[k] - ZERO_CELSIUS, T_w.error[k], 2),
                with_error(T_m.value[k] - ZERO_CELSIUS, T_m.error[k], 2),
                with_error(1e-3 * q.value[k], 1e-3 * q.error[k], 3),
                f"{100 * run.loss.value[k] / run.power.value[k]:.1f}",
                *([] if model is None else [f"{model[place].velocity:.4f}"]),
            )
    table.caption = Text("T_wall: of the wall's inside; loss: of the power of the section, through the insulation")
    return table


def _coefficients(runs: Sequence[ReducedRun], model: Sequence[ModelRun] | None) -> Any:
    headings = ["h [W/(m² K)]", "[%]", "Nu", "[%]", "z*"] + ([] if model is None else ["model Nu", "apart"])
    table = new_table("Heat transfer (± 95 % intervals)", "run, z [m]", *headings)
    for place, run in enumerate(runs):
        h, nu = run.heat_transfer_coefficient, run.nusselt
        for k in range(run.position.size):
            cells = [
                with_error(h.value[k], h.half_width()[k], 1),
                f"{100 * h.half_width()[k] / h.value[k]:.1f}",
                with_error(nu.value[k], nu.half_width()[k], 2),
                f"{100 * nu.half_width()[k] / nu.value[k]:.1f}",
                f"{run.z_star[k]:.3f}",
            ]
            if model is not None:
                said = float(np.atleast_1d(model[place].stations.complete)[k])
                error = float(nu.error[k])
                apart = f"{(nu.value[k] - said) / error:+.1f} σ" if error > 0.0 else f"{nu.value[k] / said - 1:+.1%}"
                cells += [f"{said:.2f}", apart]
            add_row(table, _label(run, k), *cells)
    if model is not None:
        table.caption = Text("model: two layers at z* (Watkins 2018, eq. 73), wall layer by correlations (eq. 38-41)")
    return table


def _balance(runs: Sequence[ReducedRun]) -> Any:
    table = new_table(
        "First law: mean temperature measured and by the energy balance",
        "run, z [m]",
        "balance [°C]",
        "difference [K]",
        "deviation",
        "heat found [%]",
    )
    for run in runs:
        law = run.first_law
        if law is None:
            add_row(table, run.run.name, "", "", "", "")
            continue
        first = run.position.size - np.size(law.deviation)
        for k in range(first, run.position.size):
            j = k - first
            gap, deviation = law.difference, float(np.atleast_1d(law.deviation)[j])
            add_row(
                table,
                _label(run, k),
                f"{law.balance.value[j] - ZERO_CELSIUS:.2f}",
                with_error(gap.value[j], gap.error[j], 2),
                f"{deviation:+.1f} σ" if math.isfinite(deviation) else "",
                f"{100 * law.closure[j]:.1f}",
            )
    table.caption = Text("measured less balance; heat found: what the flow took up, of what was given to it")
    return table
