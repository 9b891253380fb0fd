"""What tables, figures and the terminal report share: a results file in memory, and numbers derived from it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.heat import correlations, wall_layer
from bedrad.heat.radiation import WATKINS_FACTORS
from bedrad.jobs.results import Results, StageData
from bedrad.raytrace.factors import covariance_of_mean, fold_leakage

__all__ = [
    "CorrelatedLayer",
    "Record",
    "Target",
    "cases",
    "celsius",
    "correlated_layer",
    "error_text",
    "evenly",
    "is_published",
    "load",
    "own_and_published",
    "radiation_gain",
    "stated",
    "targets",
    "value_text",
    "with_error",
]

FloatArray = NDArray[np.float64]

ZERO_CELSIUS = 273.15
"""Zero degrees Celsius. [K]"""

JOB_CASES = ("measured", "correlations")
"""Names of the cases of a prediction that are about the job's own tube; all others are published systems."""


@dataclass(frozen=True)
class Record:
    """A results file in memory.

    Parameters
    ----------
    name : str
        Name of the job.
    attributes : mapping
        Attributes of the file: version, time.
    stages : mapping
        What each finished stage holds; a stage that is not there did not run.
    """

    name: str
    attributes: StageData
    stages: dict[str, StageData]


@dataclass(frozen=True)
class Target:
    """Where radiation from the wall goes, and how much of it.

    Parameters
    ----------
    name : str
        "layer 1" (the wall layer), "layer 2", ..., "beyond", "wall", "escaped".
    near, far : float
        Depths that bound it; nan where it has none. [m]
    factor, ray_error, bed_error : float
        View factor, its standard error from the rays, and its standard error from block to block of the bed.
    watkins, watkins_ray_error, watkins_bed_error : float
        The same, with the layers made to sum to one; nan where no ray met a layer.
    published : float
        Published view factor (Watkins 2018, Table 5.3); nan where there is none.
    """

    name: str
    near: float
    far: float
    factor: float
    ray_error: float
    bed_error: float
    watkins: float
    watkins_ray_error: float
    watkins_bed_error: float
    published: float

    @property
    def error(self) -> float:
        """Standard error of rays and bed together."""
        return math.hypot(*(float(e) for e in np.nan_to_num((self.ray_error, self.bed_error))))


@dataclass(frozen=True)
class CorrelatedLayer:
    """The wall layer by correlation (Watkins 2018, eq. 38-41).

    Parameters
    ----------
    packing_fraction, contacts_per_area, contact_ratio, nc_share, nc_distance : float
        As in the measured statistics; contacts per area in 1/m2.
    velocity : float
        Mean flow velocity that the correlations were evaluated at. [m/s]
    """

    packing_fraction: float
    contacts_per_area: float
    contact_ratio: float
    nc_share: float
    nc_distance: float
    velocity: float


def load(results: Results) -> Record:
    """Read the finished stages of a results file that its job asks for.

    The file may hold others from an earlier job with the same file; they say nothing about this one.

    Raises
    ------
    BadFileError
        If the file is missing or is not a bedrad results file.
    """
    attributes = results.attributes()
    job = json.loads(attributes["job"])
    wanted = [stage for stage in results.digests() if job.get(stage) is not None]
    return Record(str(job.get("name", "bedrad job")), attributes, {stage: results.read(stage) for stage in wanted})


def celsius(temperature: ArrayLike) -> FloatArray:
    """Temperatures in degrees Celsius, rounded where only the conversion leaves digits.

    Parameters
    ----------
    temperature : float or (n,) array
        [K]
    """
    return np.asarray(np.round(np.asarray(temperature, dtype=float) - ZERO_CELSIUS, 9))


def cases(prediction: StageData) -> dict[str, StageData]:
    """Cases of a prediction: the job's tube measured, by correlation, then the published systems.

    All arrays over the wall temperature come in the order of rising temperature.
    """
    found = {key: value for key, value in prediction.items() if isinstance(value, dict)}
    order = [key for key in JOB_CASES if key in found] + [key for key in found if key not in JOB_CASES]
    return {key: _by_temperature(found[key]) for key in order}


def _by_temperature(case: StageData) -> StageData:
    T = np.atleast_1d(case["wall_temperature"])
    order = np.argsort(T, kind="stable")
    # the view factors can be as many as the temperatures
    kept = {name: value for name, value in case.items() if name.startswith("view_factors")}
    return {k: v[order] if isinstance(v, np.ndarray) and v.shape == T.shape else v for k, v in case.items()} | kept


def is_published(key: str) -> bool:
    """Whether a case of a prediction is a published system and not the job's own tube."""
    return key not in JOB_CASES


def own_and_published(found: Mapping[str, StageData]) -> tuple[dict[str, StageData], dict[str, StageData]]:
    """The cases of the job's own tube, and the published systems."""
    own = {key: case for key, case in found.items() if not is_published(key)}
    return own, {key: case for key, case in found.items() if is_published(key)}


def radiation_gain(case: StageData) -> FloatArray:
    """What radiation adds to h: h with radiation over h without, less 1. (n,) array."""
    with_radiation = np.asarray(case["heat_transfer_coefficient"], dtype=float)
    return np.asarray(with_radiation / case["heat_transfer_coefficient_without"] - 1.0)


def stated(errors: ArrayLike) -> FloatArray:
    """Errors of a prediction, nan in place of zero: its inputs then state none, and none is not zero."""
    e = np.asarray(errors, dtype=float)
    return np.where(e > 0.0, e, np.nan)


def with_error(value: float, error: float, decimals: int = 4) -> str:
    """A value and its standard error to two significant digits of the error, such as "0.4501 ± 0.0029".

    Parameters
    ----------
    value, error : float
        The error may be nan or zero: then the value stands alone.
    decimals : int
        Decimals of a value without error.
    """
    if not (math.isfinite(error) and error > 0.0):
        return f"{value:.{decimals}f}"
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def value_text(value: float, error: float, decimals: int = 3) -> str:
    """A value and its standard error as `with_error` writes them; "none" where there is no value."""
    return "none" if math.isnan(value) else with_error(value, error, decimals)


def error_text(error: float) -> str:
    """An error in a column of its own, such as "1.2e-03"; empty where there is none."""
    return "" if math.isnan(error) else f"{error:.1e}"


def evenly(count: int, most: int) -> NDArray[np.int64]:
    """Indices of at most so many of a number of rows, the first, the last and evenly between them."""
    return np.unique(np.round(np.linspace(0, count - 1, min(count, most))).astype(np.int64))


def targets(data: StageData) -> Iterator[Target]:
    """Rows of a table of view factors: the layers, beyond, wall, escaped.

    Parameters
    ----------
    data : mapping
        The stage "view_factors".
    """
    edges, layers = data["edges"], data["layers"]
    folded, folded_ray_error, folded_bed_error = _normalised(data)
    for k, factor in enumerate(layers):
        yield Target(
            name=f"layer {k + 1}",
            near=float(edges[k]),
            far=float(edges[k + 1]),
            factor=float(factor),
            ray_error=float(data["layers_error"][k]),
            bed_error=float(data["layers_bed_error"][k]),
            watkins=float(folded[k]),
            watkins_ray_error=float(folded_ray_error[k]),
            watkins_bed_error=float(folded_bed_error[k]),
            published=WATKINS_FACTORS[k] if k < len(WATKINS_FACTORS) else math.nan,
        )
    depths = {"beyond": (float(edges[-1]), math.nan), "wall": (0.0, 0.0), "escaped": (math.nan, math.nan)}
    for name, (near, far) in depths.items():
        found = (data[name], data[f"{name}_error"], data[f"{name}_bed_error"])
        yield Target(name, near, far, *found, math.nan, math.nan, math.nan, math.nan)


def _normalised(data: StageData) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The layers in the convention of Watkins (2018), with errors of rays and bed; nan where no ray met a layer."""
    count = len(data["layers"])
    if not float(data["layers"].sum()) > 0.0:
        none = np.full(count, math.nan)
        return none, none, none
    shares = np.array([*data["layers"], data["beyond"], data["wall"], data["escaped"]])
    ratio, error = fold_leakage(shares, data["covariance"], count)
    _, bed_error = fold_leakage(shares, covariance_of_mean(data["block_shares"]), count)
    return ratio, error, bed_error


def correlated_layer(prediction: StageData | None) -> CorrelatedLayer | None:
    """The wall layer by correlation in the job's tube; None where nothing was predicted."""
    case = None if prediction is None else prediction.get("correlations")
    if case is None:
        return None
    ratio, diameter, count = case["diameter_ratio"], case["particle_diameter"], case["contacts_per_area"]
    shares = wall_layer.contributions(
        np.atleast_1d(case["gas_conductivity"])[0],
        case["solid_conductivity"],
        ratio,
        diameter,
        count,
        case["packing_fraction"],
        case["nc_distance"],
        "simplified",
        warn=False,
    )
    no_contact = float(shares.no_contact_per_area)
    return CorrelatedLayer(
        packing_fraction=case["packing_fraction"],
        contacts_per_area=count,
        contact_ratio=float(count / correlations.maximum_contacts(ratio, diameter)),
        nc_share=no_contact / (no_contact + count),
        nc_distance=case["nc_distance"],
        velocity=case["velocity"],
    )
