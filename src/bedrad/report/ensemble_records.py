"""What tables and the screen share of the results of many beds."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from bedrad.jobs.fields import UNITS
from bedrad.jobs.results import ENSEMBLE, Results, StageData
from bedrad.jobs.unit_columns import field_of

__all__ = ["EnsembleRecord", "MeanRow", "load_ensemble", "mean_rows"]

_STAGES = ("statistics", "view_factors", "prediction")
_ENDINGS = ("_packing_error", "_ray_error", "_scatter", "_unit_error")
_AXES = ("edges", "wall_temperature")


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
        """What is swept beside the seeds, by name, of each group of beds. [m]"""
        names = [name for name in ("tube_diameter", "particle_diameter") if name in self.ensemble]
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


def load_ensemble(results: Results) -> EnsembleRecord:
    """Read the results of many beds; BadFileError if the file is something else."""
    attributes = results.attributes()
    name = str(json.loads(attributes["job"]).get("name", "bedrad job"))
    return EnsembleRecord(name, results.read(ENSEMBLE), results.read("units"), results.read("failures"))


def mean_rows(record: EnsembleRecord) -> Iterator[MeanRow]:
    """Every number of the summary, the groups one after the other."""
    for group, beds in enumerate(record.ensemble["units"].tolist()):
        for stage in _STAGES:
            held = _flat(record.ensemble.get(stage, {}))
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


def _flat(data: StageData, prefix: str = "") -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in data.items():
        found |= _flat(value, f"{prefix}{name}/") if isinstance(value, dict) else {f"{prefix}{name}": value}
    return found


def unit_title(name: str) -> str:
    """Name of a column for what a file of many beds says of each."""
    units = UNITS[name][0]
    return f"{name.replace('_', ' ')} [{units}]" if units else name.replace("_", " ")
