"""What an ensemble found: means over its beds, their errors from bed to bed, and of these what comes from the rays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.jobs.members import Member
from bedrad.jobs.unit_columns import Column
from bedrad.packings.time_averages import block_averaged_variance

__all__ = ["AXES", "QUANTITIES", "Mean", "Summary", "summarise"]

FloatArray = NDArray[np.float64]

QUANTITIES: Mapping[str, tuple[str, ...]] = {
    "flow": (
        "velocity",
        "velocity_fluctuation",
        "froude",
        "core_velocity",
        "wall_velocity",
        "shear_width",
        "solid_fraction",
        "wall_pressure",
        "granular_temperature",
    ),
    "statistics": (
        "packing_fraction",
        "contacts_per_area",
        "contact_ratio",
        "nc_share",
        "nc_distance",
        "nc_distance_weighted",
        "nc_distance_closing",
        "packing_fractions",
        "mean_diameter",
    ),
    "view_factors": ("layers", "beyond", "wall", "escaped"),
    "prediction": (
        "heat_transfer_coefficient",
        "heat_transfer_coefficient_without",
        "nusselt",
        "wall_layer_conductivity",
        "radiative_conductivity",
    ),
}
"""The quantities of each stage whose means are taken."""

AXES: Mapping[str, tuple[str, ...]] = {
    "flow": (),
    "statistics": ("edges",),
    "view_factors": ("edges",),
    "prediction": ("wall_temperature",),
}
"""What these are functions of: taken from the first bed."""


@dataclass(frozen=True)
class Mean:
    """The mean of a quantity over the beds of every group; all arrays are (groups, ...).

    Parameters
    ----------
    mean : array
        The mean over the beds that have a value; nan where none has.
    packing_error : array
        Standard error of the mean from the scatter between beds, in which the rays' is contained; nan where fewer
        than two beds have a value.
    ray_error : array or None
        What of it comes from the rays; None for what is measured without rays.
    scatter : array
        Standard deviation between beds.
    unit_error : array or None
        Standard error that a single bed states by itself, root mean square over the beds.
    """

    mean: FloatArray
    packing_error: FloatArray
    ray_error: FloatArray | None
    scatter: FloatArray
    unit_error: FloatArray | None


@dataclass(frozen=True)
class Summary:
    """An ensemble in short.

    Parameters
    ----------
    groups : mapping
        Values of what is swept, beside the seeds, one a group, by name. [m], [m/s]
    units : (groups,) int array
        Beds in each group.
    means : mapping
        `Mean` by stage and name.
    axes : mapping
        What the quantities are functions of, by stage and name: from the first bed of each group.
    """

    groups: Mapping[str, FloatArray]
    units: NDArray[np.int64]
    means: Mapping[str, Mapping[str, Mean]]
    axes: Mapping[str, Mapping[str, FloatArray]]


def summarise(members: Sequence[Member], columns: Mapping[str, Mapping[str, Column]]) -> Summary:
    """Take the means of an ensemble.

    Beds that have nothing in common are averaged as such. Frames that follow each other resemble each other: the
    variance of their mean is by averages over blocks in time (`time_averages.block_averaged_variance`), or by the
    scatter between trajectories where there are several and it is larger.

    Parameters
    ----------
    members : sequence of Member
        The beds.
    columns : mapping
        What was found, a row a bed.
    """
    names = [name for name in (members[0].values or {} if members else {}) if name != "seed"]
    groups: dict[tuple[float, ...], list[int]] = {}
    for number, member in enumerate(members):
        groups.setdefault(tuple((member.values or {})[name] for name in names), []).append(number)
    means: dict[str, dict[str, Mean]] = {}
    axes: dict[str, dict[str, FloatArray]] = {}
    for stage, held in columns.items():
        means[stage], axes[stage] = {}, {}
        for name, column in held.items():
            last = name.rpartition("/")[2]
            if isinstance(column.values, list):
                continue
            if last in QUANTITIES.get(stage, ()):
                means[stage][name] = _mean(stage, name, held, list(groups.values()), members)
            elif last in AXES.get(stage, ()):
                axes[stage][name] = np.array([column.values[rows[0]] for rows in groups.values()], dtype=float)
    values = np.array(list(groups), dtype=float).reshape(len(groups), len(names))
    return Summary(
        {name: values[:, k] for k, name in enumerate(names)},
        np.array([len(rows) for rows in groups.values()], dtype=np.int64),
        means,
        axes,
    )


def _mean(
    stage: str, name: str, held: Mapping[str, Column], groups: Sequence[Sequence[int]], members: Sequence[Member]
) -> Mean:
    def of(key: str) -> FloatArray | None:
        column = held.get(key)
        return None if column is None or isinstance(column.values, list) else np.asarray(column.values, dtype=float)

    X = of(name)
    assert X is not None  # noqa: S101 - the caller has seen it
    rays = of(f"{name}_error") if stage == "view_factors" else None
    stated = of(f"{name}_bed_error" if stage == "view_factors" else f"{name}_error")
    found: list[tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]] = []
    for rows in groups:
        x = X[rows]
        there = np.isfinite(x)
        n = there.sum(axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = np.where(there, x, 0.0).sum(axis=0) / n
            scatter = np.sqrt((np.where(there, x - mean, 0.0) ** 2).sum(axis=0) / np.where(n > 1, n - 1, np.nan))
            error = _error_of_mean(x, scatter, n, [members[row].series for row in rows])
            ray = np.full(x.shape[1:], np.nan) if rays is None else np.sqrt(np.nansum(rays[rows] ** 2, axis=0)) / n
            own = np.full(x.shape[1:], np.nan) if stated is None else _root_mean_square(stated[rows])
        found.append((mean, error, ray, scatter, own))
    mean, error, ray, scatter, own = (np.array(each) for each in zip(*found, strict=True))
    return Mean(mean, error, None if rays is None else ray, scatter, None if stated is None else own)


def _root_mean_square(errors: FloatArray) -> FloatArray:
    there = np.isfinite(errors)
    n = there.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.sqrt((np.where(there, errors, 0.0) ** 2).sum(axis=0) / n))


def _error_of_mean(x: FloatArray, scatter: FloatArray, n: NDArray[np.int64], series: Sequence[str]) -> FloatArray:
    """Standard error of the mean over the beds of a group."""
    together: dict[str, list[int]] = {}
    for row, name in enumerate(series):
        together.setdefault(name, []).append(row)
    independent = np.asarray(scatter / np.sqrt(n))
    if set(together) == {""}:
        return independent
    flat = x.reshape(len(x), -1)
    variance = np.zeros(flat.shape[1])
    means = []
    for rows in together.values():
        part = flat[rows]
        # where frames have no value, there is no series to take blocks of
        own = block_averaged_variance(part) if len(part) > 1 else np.full(flat.shape[1], np.nan)
        variance += (len(rows) / len(x)) ** 2 * own
        means.append(part.mean(axis=0))
    if len(means) > 1:
        between = np.var(means, axis=0, ddof=1) / len(means)
        variance = np.fmax(variance, between)
    return np.sqrt(variance).reshape(x.shape[1:])
