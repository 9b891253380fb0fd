"""The end of a run in the terminal: what was measured, traced and predicted, and what it cost."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bedrad.errors import visible
from bedrad.jobs.results import Results, StageData
from bedrad.report.records import (
    Record,
    cases,
    celsius,
    correlated_layer,
    error_text,
    evenly,
    load,
    own_and_published,
    radiation_gain,
    stated,
    targets,
    value_text,
    with_error,
)

__all__ = ["WALL_LAYER_ROWS", "add_row", "new_table", "summary"]

SHOWN_TEMPERATURES = 6
"""Wall temperatures in the tables, evenly spread over those computed."""

WALL_LAYER_ROWS = (
    ("solid fraction phi_wa", "packing_fraction", 1.0),
    ("wall contacts per area n_C [1/mm²]", "contacts_per_area", 1e-6),
    ("contacts over hexagonal maximum n_C/n_C,max", "contact_ratio", 1.0),
    ("share of no-contact (NC) particles", "nc_share", 1.0),
    ("NC distance a [particle radii], plain mean", "nc_distance", 1.0),
    ("  weighted by volume in the wall layer", "nc_distance_weighted", 1.0),
    ("  the one that closes the solid volume", "nc_distance_closing", 1.0),
)
"""What is measured at the wall: text, name in the statistics, and factor from SI units to the text's."""


def summary(results: Results) -> RenderableType:
    """What a results file holds, as tables for a terminal of 80 columns or more.

    Parameters
    ----------
    results : Results
        The results file; stages that did not run are left out.

    Returns
    -------
    rich renderable
        For ``rich.console.Console.print``.

    Raises
    ------
    BadFileError
        If the results file is missing or is something else.
    """
    record = load(results)
    stages = record.stages
    tables: list[Table] = []
    if "statistics" in stages:
        tables.append(_statistics(stages["statistics"], stages.get("prediction")))
    if "view_factors" in stages:
        tables.append(_view_factors(stages["view_factors"]))
    if "prediction" in stages:
        tables += _prediction(cases(stages["prediction"]))
    tables.append(_costs(record))
    parts: list[RenderableType] = [Text(visible(record.name), style="bold")]
    for table in tables:
        if table.row_count:
            parts += [Text(), table]
    return Group(*parts)


def new_table(title: str, first: str, *columns: str) -> Table:
    """A table with a title to the left, texts in the first column and numbers in the others."""
    table = Table(
        title=Text(title, style="bold"),
        title_justify="left",
        caption_justify="left",
        caption_style="",
        box=box.SIMPLE_HEAD,
        show_edge=False,
        padding=(0, 0, 0, 1),
        header_style="",
    )
    table.add_column(Text(first), no_wrap=True)
    for column in columns:
        table.add_column(Text(column), justify="right", no_wrap=True)
    return table


def add_row(table: Table, *cells: str) -> None:
    """Add a row of texts as they are: rich would take [...] in a string for a style. A cell is one line."""
    table.add_row(*(Text(visible(cell)) for cell in cells))


def _statistics(data: StageData, prediction: StageData | None) -> Table:
    """The wall layer measured, and beside it by correlation."""
    correlated = correlated_layer(prediction)
    headings = ["measured"] + (["by correlation"] if correlated else [])
    table = new_table("Wall layer", "", *headings)
    for text, name, scale in WALL_LAYER_ROWS:
        cells = [value_text(scale * data[name], scale * data[f"{name}_error"])]
        if correlated is not None:
            given = getattr(correlated, name, None)
            cells.append("" if given is None else f"{scale * given:.3f}")
        add_row(table, text, *cells)
    notes = [f"contact: gap up to {data['contact_gap']:g} radii"]
    if correlated is not None:
        notes.append(f"by correlation: a flow at {correlated.velocity:g} m/s (Watkins 2018, eq. 31, 38-40)")
    table.caption = Text("\n".join(notes))
    return table


def _view_factors(data: StageData) -> Table:
    table = new_table(
        "View factors from the wall", "to", "depth [mm]", "traced", "± rays", "± bed", "normalised", "published"
    )
    rows = list(targets(data))
    for row in rows:
        depth = {"beyond": f"> {1e3 * row.near:.3g}"}.get(row.name, "")
        if row.name.startswith("layer"):
            depth = f"{1e3 * row.near:.3g} to {1e3 * row.far:.3g}"
        add_row(
            table,
            {"beyond": "beyond layers", "wall": "back to wall",
             "escaped": "open ends"}.get(row.name, row.name),
            depth,
            f"{row.factor:.5f}",
            error_text(row.ray_error),
            error_text(row.bed_error),
            "" if math.isnan(row.watkins) else f"{row.watkins:.5f}",
            "" if math.isnan(row.published) else f"{row.published:.2f}",
        )  # fmt: skip
    add_row(table, "sum", "", f"{math.fsum(row.factor for row in rows):.5f}")
    low, high = (1e3 * x for x in data["window"])
    table.caption = Text(
        f"from {low:.4g} to {high:.4g} mm along the axis; the wall outside is left out\n"
        "normalised: leakage folded into the layers, as in the published factors\n"
        "published: 0.6 mm in a 7.75 mm tube, flow at 0.016 m/s (Watkins 2018, Table 5.3)"
    )
    return table


def _prediction(found: Mapping[str, StageData]) -> list[Table]:
    own, published = own_and_published(found)
    parts: list[Table] = []
    if own:
        parts += [_coefficients(own), _conductivities(own)]
    if published:
        parts.append(_published(published))
    return parts


def _chosen(case: StageData) -> NDArray[np.int64]:
    """Indices of the wall temperatures to show."""
    return evenly(np.size(case["wall_temperature"]), SHOWN_TEMPERATURES)


def _values(case: StageData, name: str, decimals: int, scale: float = 1.0) -> list[str]:
    """A quantity at the shown temperatures, with its error where it has one."""
    values = scale * np.atleast_1d(case[name])
    errors = scale * np.atleast_1d(stated(case.get(f"{name}_error", np.zeros_like(values))))
    texts = []
    for k in _chosen(case):
        text = f"{values[k]:.{decimals}f}"
        texts.append(text if math.isnan(errors[k]) else f"{text} ± {errors[k]:.{decimals}f}")
    return texts


def _by_temperature(title: str, case: StageData, columns: Sequence[tuple[str, Sequence[str]]]) -> Table:
    table = new_table(title, "T_wall\n\n[°C]", *(heading for heading, _ in columns))
    table.columns[0].justify = "right"
    T = np.atleast_1d(celsius(case["wall_temperature"]))[_chosen(case)]
    for row in zip((f"{round(t, 1):g}" for t in T), *(values for _, values in columns), strict=True):
        add_row(table, *row)
    return table


_SHORT = {"correlations": "correl."}
_BULK = {"zbs": "Zehner-Bauer-Schluender", "table 5.2": "Table 5.2 (Watkins 2018)"}


def _coefficients(own: Mapping[str, StageData]) -> Table:
    """Heat transfer with and without radiation, the cases side by side."""
    columns = []
    largest = max(np.max(case["heat_transfer_coefficient"]) for case in own.values())
    decimals = 1 if largest < 1000 else 0
    for name, text in (("", "h"), ("_without", "h without")):
        for key, case in own.items():
            heading = f"{text}\n{_SHORT.get(key, key)}\n"
            columns.append((heading, _values(case, f"heat_transfer_coefficient{name}", decimals)))
    for key, case in own.items():
        gain = 100 * np.atleast_1d(radiation_gain(case))[_chosen(case)]
        columns.append((f"gain\n{_SHORT.get(key, key)}\n[%]", [f"{g:+.1f}" for g in gain]))
    table = _by_temperature("Heat transfer coefficient in the tube, h [W/(m² K)]", next(iter(own.values())), columns)
    notes = [
        f"{visible(_SHORT.get(key, key))}: {visible(str(case['title']))};\n"
        f"  k_b by {visible(str(_BULK.get(case['bulk_model'], case['bulk_model'])))}"
        for key, case in own.items()
    ]
    signs = "without: no radiation; gain: what radiation adds to h"
    if any(np.any(np.isfinite(stated(case["heat_transfer_coefficient_error"]))) for case in own.values()):
        signs += "\n±: standard error from what is measured"
    table.caption = Text("\n".join([*notes, signs]))
    return table


def _conductivities(own: Mapping[str, StageData]) -> Table:
    """What the heat transfer rests on: the conductivities of both layers, the cases side by side."""
    columns = []
    for name, symbol, decimals in (("wall_layer_conductivity", "k_wa", 1), ("radiative_conductivity", "k_rad", 2)):
        for key, case in own.items():
            columns.append((f"{symbol}\n{_SHORT.get(key, key)}\n", _values(case, name, decimals, scale=1e3)))
    first = next(iter(own.values()))
    columns.append(("k_b\n\n", _values(first, "bulk_conductivity", 0, scale=1e3)))
    for key, case in own.items():
        columns.append(
            (f"Nu\n{_SHORT.get(key, key)}\n", [f"{nu:.2f}" for nu in np.atleast_1d(case["nusselt"])[_chosen(case)]])
        )
    title = "Wall layer (k_wa + k_rad) and bulk (k_b) [mW/(m K)]; Nu = h D/k_b"
    return _by_temperature(title, first, columns)


def _published(published: Mapping[str, StageData]) -> Table:
    """What radiation adds in the published systems."""
    first = next(iter(published.values()))
    T = np.atleast_1d(celsius(first["wall_temperature"]))[_chosen(first)]
    headings = ["A\n", "d\n[µm]", "U\n[m/s]", *(f"{round(t, 1):g}\n°C" for t in T), f"h at\n{T[-1]:.4g} °C"]
    title = "Gain of h by radiation [%], and h [W/(m² K)], in the published systems"
    table = new_table(title, "\n", *headings)
    table.caption = Text("Watkins 2018, Table 5.1; published: gain up to 29 %")
    for case in published.values():
        chosen = _chosen(case)
        add_row(
            table,
            str(case["title"]).removeprefix("Table 5.1, ").replace("configuration", "config."),
            f"{case['diameter_ratio']:.1f}",
            f"{1e6 * case['particle_diameter']:.0f}",
            f"{case['velocity']:.3f}",
            *(f"{100 * gain:+.1f}" for gain in np.atleast_1d(radiation_gain(case))[chosen]),
            f"{np.atleast_1d(case['heat_transfer_coefficient'])[chosen[-1]]:.1f}",
        )
    return table


def _costs(record: Record) -> Table:
    """Run times, rays, and what was left out."""
    table = Table(title=Text("Cost", style="bold"), title_justify="left", box=None, show_header=False)
    table.add_column(no_wrap=True)
    table.add_column(justify="right", no_wrap=True)
    table.add_column(overflow="fold")
    stages = record.stages
    settled = stages.get("packing", {}).get("provenance", {})
    if "run_seconds" in settled:
        add_row(table, "settling", _seconds(settled["run_seconds"]), f"{int(settled.get('spheres', 0)):,} spheres")
    if "statistics" in stages:
        data = stages["statistics"]
        outside = [f"{data[k]:,} {text}" for k, text in _LEFT_OUT.items() if k in data]
        text = f"{data['spheres']:,} spheres" + (f"; left out: {', '.join(outside)}" if outside else "")
        add_row(table, "statistics", _seconds(data["seconds"]), text)
    if "view_factors" in stages:
        data = stages["view_factors"]
        rate = data["rays"] / max(data["seconds"] - data["setup_seconds"], 1e-9) / 1e6
        left = f"; left out: {data['left_out']}" if "left_out" in data else ""
        text = f"{data['rays']:,} rays, {rate:.1f} million a second{left}"
        add_row(table, "view factors", _seconds(data["seconds"]), text)
    if "convergence" in stages:
        data = stages["convergence"]
        rays = data["reference_rays"] + data["seeds"] * int(np.sum(data["rays"]))
        add_row(table, "convergence", _seconds(data["total_seconds"]), f"{rays:,} rays{_exponent(data)}")
    return table


_LEFT_OUT = {"left_out_outside_window": "outside the window", "left_out_deeper": "too deep"}


def _seconds(seconds: float) -> str:
    return f"{seconds:.2f} s"


def _exponent(data: StageData) -> str:
    exponent, error = float(data["exponent"][0]), float(data["exponent_error"][0])
    if math.isnan(exponent):
        return ""
    return f"; error of F_w1 ~ rays^n, n = {with_error(exponent, error, 2)}"
