"""What tables and the screen share of the results of many beds."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from bedrad.jobs.ensemble_summary import AXES, QUANTITIES, Mean
from bedrad.jobs.results import ENSEMBLE, Results, StageData
from bedrad.jobs.unit_columns import field_of
from bedrad.report.records import celsius

__all__ = [
    "EnsembleRecord",
    "MeanRow",
    "doubtful_groups",
    "flat",
    "group_title",
    "load_ensemble",
    "mean_rows",
    "without_second_case",
]

_STAGES = tuple(QUANTITIES)

_SERIOUS = ("jammed", "thinned", "not steady")
"""How the problems of a flow begin that make its numbers doubtful; too few structures only make errors large."""

FEW_BEDS = 8
"""Beds below which their scatter alone says little: one pair in three is closer than half of what is typical."""

_ENDINGS = tuple(f"_{field.name}" for field in fields(Mean) if field.name != "mean")
_AXES = {name for names in AXES.values() for name in names}


@dataclass(frozen=True)
class EnsembleRecord:
    """The results of many beds in memory.

    Parameters
    ----------
    name : str
        Name of the job.
    ensemble, units, failures : mapping
        The groups of the file.
    """

    name: str
    ensemble: StageData
    units: StageData
    failures: StageData

    @property
    def groups(self) -> list[dict[str, float]]:
        """What is swept beside the seeds, by name, of each group of beds. [m], [m/s]"""
        names = [name for name in ("tube_diameter", "particle_diameter", "velocity") if name in self.ensemble]
        count = len(self.ensemble["units"])
        return [{name: float(self.ensemble[name][k]) for name in names} for k in range(count)]


@dataclass(frozen=True)
class MeanRow:
    """A number of the summary.

    Parameters
    ----------
    group : int
        Which group of beds.
    beds : int
        Beds in it.
    stage, name : str
        Where it stands.
    title : str
        What it is.
    units : str
        Its units.
    where : str
        Which layer, or which wall temperature.
    mean, packing_error, ray_error, scatter, unit_error : float
        As `bedrad.jobs.ensemble_summary.Mean` has them; nan where there is none.
    """

    group: int
    beds: int
    stage: str
    name: str
    title: str
    units: str
    where: str
    mean: float
    packing_error: float
    ray_error: float
    scatter: float
    unit_error: float

    @property
    def error(self) -> float:
        """Standard error of the mean: from bed to bed; of few beds not less than what they state of themselves."""
        if self.beds >= FEW_BEDS:
            return self.packing_error
        return float(np.fmax(self.packing_error, self.unit_error / math.sqrt(self.beds)))

    @property
    def celsius(self) -> float | None:
        """Wall temperature that it is for, in degrees Celsius; None where it depends on none."""
        kelvin = self.where.removesuffix(" K")
        return None if kelvin == self.where else float(celsius(float(kelvin)))


def load_ensemble(results: Results) -> EnsembleRecord:
    """Read the results of many beds; BadFileError if the file is something else."""
    attributes = results.attributes()
    name = str(json.loads(attributes["job"]).get("name", "bedrad job"))
    return EnsembleRecord(name, results.read(ENSEMBLE), results.read("units"), results.read("failures"))


def mean_rows(record: EnsembleRecord) -> Iterator[MeanRow]:
    """Every number of the summary, the groups one after the other."""
    for group, beds in enumerate(record.ensemble["units"].tolist()):
        for stage in _STAGES:
            held = flat(record.ensemble.get(stage, {}))
            for name, values in held.items():
                if name.endswith(_ENDINGS) or name.rpartition("/")[2] in _AXES:
                    continue
                units, title = field_of(stage, name)
                temperatures = held.get(f"{name.rpartition('/')[0]}/wall_temperature")
                for place, index in enumerate(np.ndindex(values.shape[1:])):
                    at = (group, *index)
                    more = [float(held[name + e][at]) if name + e in held else math.nan for e in _ENDINGS]
                    where = ""
                    if index:
                        where = f"layer {place + 1}" if temperatures is None else f"{temperatures[at]:g} K"
                    yield MeanRow(group, beds, stage, name, title, units, where, float(values[at]), *more)


def without_second_case(rows: Iterable[MeanRow]) -> list[MeanRow]:
    """Leave out predictions by correlation, where there are some by what was measured or traced."""
    kept = list(rows)
    if not any(row.name.startswith("measured/") for row in kept):
        return kept
    return [row for row in kept if not row.name.startswith("correlations/")]


def flat(data: StageData, prefix: str = "") -> dict[str, Any]:
    """What lies in groups within a group, by paths such as "measured/nusselt"."""
    found: dict[str, Any] = {}
    for name, value in data.items():
        found |= flat(value, f"{prefix}{name}/") if isinstance(value, dict) else {f"{prefix}{name}": value}
    return found


def doubtful_groups(record: EnsembleRecord) -> set[int]:
    """Groups with a flow that is jammed, thinned or not steady: what is measured of it may be of no flow at all."""
    told = record.units.get("flow", {}).get("problems", ())
    groups = record.groups
    names = list(groups[0]) if groups else []
    values = np.array([[group[name] for name in names] for group in groups], dtype=float)
    found: set[int] = set()
    for unit, text in enumerate(told):
        if any(problem.startswith(_SERIOUS) for problem in str(text).split("; ")):
            own = np.array([float(record.units[name][unit]) for name in names])
            found |= set(np.flatnonzero((values == own).all(axis=1)).tolist())
    return found


def group_title(group: Mapping[str, float]) -> str:
    """What is swept, as words."""
    shown = {name: f"{v:.4g} m/s" if name == "velocity" else f"{1e3 * v:.4g} mm" for name, v in group.items()}
    return ", ".join(f"{name.replace('_', ' ')} {text}" for name, text in shown.items())
