"""CSV tables of the statistics: values, layers, counts against the gap, profiles, distributions, the unrolled wall."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.jobs.comparison import Comparison
from bedrad.jobs.fields import STATISTICS
from bedrad.jobs.results import StageData
from bedrad.packings.files.contents import describe_wall
from bedrad.packings.statistics import Statistics
from bedrad.packings.unrolled_wall import UnrolledWall
from bedrad.report.csv_tables import Table, heading, write_tables_beside

__all__ = ["as_data", "statistics_tables", "write_statistics_tables"]

_VALUES = (
    "packing_fraction",
    "contacts_per_area",
    "contact_ratio",
    "nc_share",
    "nc_distance",
    "nc_distance_weighted",
    "nc_distance_closing",
    "nc_gap_beyond",
    "rattler_share",
    "hexagonal_order",
    "wall_neighbours",
)

_COUNTS = (
    "contact_gap",
    "mean_diameter",
    "sauter_diameter",
    "volume_mean_diameter",
    "frames",
    "spheres",
    "contacts",
    "no_contacts",
    "overlap_share",
    "seconds",
)


def as_data(found: Statistics) -> StageData:
    """Statistics as the results file holds them."""
    data = {field.name: getattr(found, field.name) for field in fields(found)}
    data |= {f"{name}_structures": number for name, number in data.pop("structures", {}).items()}
    kind, radius = describe_wall(found.wall)
    return data | {"wall": kind} | ({} if radius is None else {"wall_radius": radius})


def write_statistics_tables(
    found: Statistics, unrolled: UnrolledWall, compared: Sequence[Comparison], stem: Path
) -> list[Path]:
    """Write all tables of a measured bed: ``<stem>_statistics.csv`` and so on.

    Parameters
    ----------
    found : Statistics
        What was measured.
    unrolled : UnrolledWall
        The unrolled wall of one frame.
    compared : sequence of Comparison
        The same beside the correlations; without any there is no such table.
    stem : Path
        Beginning of the files' names.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    OSError
        If a table cannot be written; no half-written file stays behind.
    """
    tables = statistics_tables(as_data(found)) | {"unrolled_wall": _unrolled_wall(unrolled)}
    if compared:
        tables["correlations"] = _correlations(compared)
    return write_tables_beside(stem, tables)


def statistics_tables(data: StageData) -> dict[str, Table]:
    """All tables that the statistics in a results file allow, by name."""
    return {
        "statistics": _values(data),
        "layers": _layers(data),
        "contacts": _contacts(data),
        "profile": _profile(data),
        "centres": _centres(data),
        "nc_gaps": _nc_gaps(data),
        "coordination": _coordination(data),
    }


def _values(data: StageData) -> Table:
    """The wall layer in one row."""
    table: Table = {}
    for name in _VALUES:
        for column in (name, f"{name}_error"):
            table[heading(column, STATISTICS)] = [data[column]]
        if f"{name}_structures" in data:
            table[f"{heading(name, STATISTICS).rpartition(' [')[0]} independent structures [1]"] = [
                data[f"{name}_structures"]
            ]
    return table | {heading(name, STATISTICS): [data[name]] for name in _COUNTS if name in data}


def _with_error(data: StageData, name: str, title: str, values: Any = None, error: Any = None) -> Table:
    """A column, its error, and the independent structures behind it where there are several frames."""
    text, _, unit = title.rpartition(" [")
    table: Table = {
        title: list(data[name] if values is None else values),
        f"{text} error [{unit}": list(data[f"{name}_error"] if error is None else error),
    }
    if f"{name}_structures" in data and values is None:
        table[f"{text} independent structures [1]"] = list(data[f"{name}_structures"])
    return table


def _bins(data: StageData, edges: np.ndarray[Any, Any]) -> Table:
    """Depths that bound bins, in metres and radii, and as positions from the axis where there is one."""
    middle = 0.5 * (edges[:-1] + edges[1:])
    table: Table = {
        "depth from [m]": list(edges[:-1]),
        "depth to [m]": list(edges[1:]),
        "mean depth [particle radii]": list(middle / (0.5 * data["mean_diameter"])),
    }
    if "wall_radius" in data:
        table["mean radial position [m]"] = list(data["wall_radius"] + middle * (-1 if data["wall"] == "tube" else 1))
    return table


def _layers(data: StageData) -> Table:
    edges = data["edges"]
    return {
        "layer": list(range(1, len(edges))),
        "depth from [m]": list(edges[:-1]),
        "depth to [m]": list(edges[1:]),
        **_with_error(data, "packing_fractions", "solid fraction [1]"),
        **_with_error(data, "coordination", "contacts a sphere [1]"),
    }


def _contacts(data: StageData) -> Table:
    """Every gap tolerance a row."""
    table: Table = {"gap tolerance [particle radii]": list(data["gap_tolerances"])}
    for name in ("contacts_per_area", "contact_ratio", "nc_share"):
        table |= _with_error(data, f"{name}_by_gap", heading(name, STATISTICS))
    for k in range(len(data["edges"]) - 1):
        values, errors = (data[f"coordination_by_gap{suffix}"][k] for suffix in ("", "_error"))
        table |= _with_error(data, "coordination_by_gap", f"contacts a sphere in layer {k + 1} [1]", values, errors)
    return table


def _profile(data: StageData) -> Table:
    return _bins(data, data["profile_depths"]) | _with_error(data, "profile", "solid fraction [1]")


def _centres(data: StageData) -> Table:
    return {
        **_bins(data, data["centre_depths"]),
        **_with_error(data, "centre_density", "sphere centres per volume [1/m3]"),
        **_with_error(data, "contact_density", "contacts between spheres per volume [1/m3]"),
    }


def _nc_gaps(data: StageData) -> Table:
    edges = data["nc_gap_edges"]
    return {
        "gap from [particle radii]": list(edges[:-1]),
        "gap to [particle radii]": list(edges[1:]),
        **_with_error(data, "nc_gap_density", "share of no-contact particles per gap [1/particle radius]"),
    }


def _coordination(data: StageData) -> Table:
    shares = data["contact_number_shares"]
    names = [*map(str, range(len(shares) - 1)), f"more than {len(shares) - 2}"]
    return {"contacts with spheres": names, **_with_error(data, "contact_number_shares", "share of spheres [1]")}


def _unrolled_wall(unrolled: UnrolledWall) -> Table:
    columns = {
        "sphere": unrolled.spheres,
        "angle [rad]": unrolled.angle,
        "height [m]": unrolled.height,
        "across [m]": unrolled.across,
        "radius [m]": unrolled.radius,
        "gap [particle radii]": unrolled.gap,
        "contact": unrolled.contact.astype(int),
    }
    return {name: list(np.asarray(values)[unrolled.inside]) for name, values in columns.items()}


def _correlations(compared: Sequence[Comparison]) -> Table:
    return {
        "quantity": [row.name for row in compared],
        "equation of Watkins (2018)": [row.equation for row in compared],
        "measured [1]": [row.measured for row in compared],
        "measured error [1]": [row.error for row in compared],
        "correlation [1]": [row.correlation for row in compared],
        "stated accuracy [1]": [row.accuracy for row in compared],
        "difference [1]": [row.difference for row in compared],
        "residual [standard errors]": [row.residual for row in compared],
    }
