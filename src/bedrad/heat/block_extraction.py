"""Wall coefficient from the temperature drop of a block that a bed is put on (Adepu et al., section 3.3, Table 1).

The forward model conducts heat through a block, across a contact coefficient h, and through a bed, in one dimension;
the inverse finds the h that gives a measured drop, with its uncertainty. The source does both with a finite-difference
scheme and by trial and error on the solid fraction at the wall.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy import linalg, optimize

from bedrad.heat.ranges import FloatArray, non_negative, plain, positive, within

__all__ = ["BlockOnBed", "Extraction", "coefficient_from_drop", "solve_coefficient", "temperature"]

_RANGE = (1e-2, 1e8)
_STEP = 1e-3
_STRETCH = 6.0
_ROUNDING = 1e-5
_FEWEST_CELLS, _MOST_CELLS = 8, 2000


@dataclass(frozen=True)
class BlockOnBed:
    """A block kept at a temperature at its base, and a bed on its face (Adepu et al., Table 1 and Figure 4).

    At the start the block has a linear profile between base and face, the bed one temperature, which its far side
    keeps.

    Parameters
    ----------
    block_length : float
        From base to face. [m]
    block_conductivity : float
        [W/(m K)]
    block_density : float
        [kg/m3]
    block_specific_heat : float
        [J/(kg K)]
    bed_depth : float
        [m]
    bed_conductivity : float
        Effective conductivity of the bed, `eps_s k_s` of the source. [W/(m K)]
    bed_density : float
        Bulk density, solid fraction times that of the particles. [kg/m3]
    bed_specific_heat : float
        [J/(kg K)]
    base_temperature : float
        Kept at the base of the block. [K]
    face_temperature : float
        At the face of the block before the bed comes. [K]
    bed_temperature : float
        Of the bed at the start, kept at its far side. [K]
    """

    block_length: float
    block_conductivity: float
    block_density: float
    block_specific_heat: float
    bed_depth: float
    bed_conductivity: float
    bed_density: float
    bed_specific_heat: float
    base_temperature: float
    face_temperature: float
    bed_temperature: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if np.ndim(value):
                raise ValueError(f"{field.name} has shape {np.shape(value)}; expected one number")
            positive(field.name, value)


def _cells(length: float, number: int) -> tuple[FloatArray, FloatArray]:
    """Widths and distances from the contact of cells that grow away from it."""
    edges = length * np.expm1(_STRETCH * np.arange(number + 1) / number) / math.expm1(_STRETCH)
    return np.diff(edges), 0.5 * (edges[1:] + edges[:-1])


@dataclass(frozen=True, eq=False)
class _Cells:
    """Finite volumes from the base of the block, over the contact, to the far side of the bed.

    `below` are the distances of the block's cells from the face, from the face on; `conductances` [W/(m2 K)] join
    the fixed temperatures and the cells in turn, `capacities` [J/(m2 K)] are those of the cells.
    """

    below: FloatArray
    conductances: FloatArray
    capacities: FloatArray
    start: FloatArray


def _finite_volumes(system: BlockOnBed, h: float, n: int) -> _Cells:
    k_block, k_bed = system.block_conductivity, system.bed_conductivity
    width, below = _cells(system.block_length, n)
    bed_width, above = _cells(system.bed_depth, n)
    contact = 1.0 / (0.5 * width[0] / k_block + 1.0 / h + 0.5 * bed_width[0] / k_bed)
    block = np.append(2.0 * k_block / width[-1], (k_block / np.diff(below))[::-1])
    bed = np.append(k_bed / np.diff(above), 2.0 * k_bed / bed_width[-1])
    block_capacity = system.block_density * system.block_specific_heat * width[::-1]
    gradient = (system.base_temperature - system.face_temperature) / system.block_length
    return _Cells(
        below=below,
        conductances=np.concatenate([block, [contact], bed]),
        capacities=np.append(block_capacity, system.bed_density * system.bed_specific_heat * bed_width),
        start=np.append(system.face_temperature + gradient * below[::-1], np.full(n, system.bed_temperature)),
    )


def _history(cells: _Cells, base: float, far: float, t: FloatArray) -> FloatArray:
    """Temperatures of all cells (last axis) over time, exact for the finite volumes."""
    g = cells.conductances
    diagonal, beside = g[1:] + g[:-1], -g[1:-1]
    source = np.zeros_like(diagonal)
    source[0], source[-1] = g[0] * base, g[-1] * far
    steady = linalg.solveh_banded(np.stack([np.append(0.0, beside), diagonal]), source)
    root = np.sqrt(cells.capacities)
    rates, vectors = linalg.eigh_tridiagonal(diagonal / cells.capacities, beside / (root[1:] * root[:-1]))
    # eigenvalues are good to the rounding of the largest, which must not show in the slowest that is left
    lasts = min(float(np.max(t, initial=0.0)), 1.0 / max(float(rates[0]), np.finfo(np.float64).tiny))
    if float(rates[-1]) * np.finfo(np.float64).eps * lasts > _ROUNDING:
        raise ValueError(
            f"cells is {cells.below.size}; expected fewer, or a block that conducts less: it is so much faster than "
            "the bed that rounding would show (block_and_bed.lumped_block_drop has no such limit)"
        )
    amplitudes = vectors.T @ (root * (cells.start - steady))
    decayed = np.exp(np.multiply.outer(-t, rates)) * amplitudes
    return np.asarray(steady + decayed @ (vectors / root[:, None]).T)


def temperature(
    system: BlockOnBed, coefficient: float, time: ArrayLike, depth: float = 0.0, cells: int = 100
) -> FloatArray:
    """Temperature in the block after the bed has come onto it (Adepu et al., eq. 4 to 6).

    Finite volumes, second order in their number; the course of time is exact, by the eigenvectors of the
    tridiagonal system, so that stiff contacts need no small steps.

    Parameters
    ----------
    system : BlockOnBed
        Block and bed.
    coefficient : float
        h between them. [W/(m2 K)]
    time : float or array
        Time since the bed came. [s]
    depth : float
        Depth of the thermometer below the face. [m]
    cells : int
        Finite volumes in the block, and as many in the bed.

    Returns
    -------
    float or array
        Temperature. [K]

    Raises
    ------
    ValueError
        If an input has no meaning, or the block conducts so much better than the bed that rounding would show.
    """
    t = non_negative("time", time, "s")
    h = float(positive("coefficient", coefficient, "W/(m2 K)"))
    z = float(within("depth", depth, 0.0, system.block_length, "m"))
    if cells != int(cells) or not _FEWEST_CELLS <= cells <= _MOST_CELLS:
        raise ValueError(f"cells is {cells}; expected a whole number from {_FEWEST_CELLS} to {_MOST_CELLS}")
    n = int(cells)
    grid = _finite_volumes(system, h, n)
    history = _history(grid, system.base_temperature, system.bed_temperature, t)
    # from the base to the face, where the flux over the contact sets the temperature
    flux = grid.conductances[n] * (history[..., n - 1] - history[..., n])
    face = history[..., n - 1] - flux * grid.below[0] / system.block_conductivity
    base = np.full_like(face, system.base_temperature)
    profile = np.concatenate([base[..., None], history[..., :n], face[..., None]], axis=-1)
    depths = np.concatenate([[system.block_length], grid.below[::-1], [0.0]])
    near = int(np.clip(np.searchsorted(-depths, -z), 1, n + 1))
    share = (depths[near - 1] - z) / (depths[near - 1] - depths[near])
    return plain((1.0 - share) * profile[..., near - 1] + share * profile[..., near])


@dataclass(frozen=True)
class Extraction:
    """A contact coefficient found from a measurement, and where its uncertainty comes from.

    Parameters
    ----------
    coefficient : float
        h. [W/(m2 K)]
    standard_error : float
        Root of the sum of the squares of `budget`. [W/(m2 K)]
    sensitivity : float
        Relative change of the measured quantity over that of h: 1 where a drop is proportional to h, near 0 where
        the contact no longer matters.
    budget : dict
        Standard error of h by each input, the measurement under "measured". [W/(m2 K)]
    """

    coefficient: float
    standard_error: float
    sensitivity: float
    budget: dict[str, float]

    def __str__(self) -> str:
        """One screen, the largest contribution first."""
        rows = sorted(self.budget.items(), key=lambda item: -item[1])
        return "\n".join(
            [
                f"h {self.coefficient:.4g} ± {self.standard_error:.2g} W/(m2 K), sensitivity {self.sensitivity:.2f}",
                *(f"  by {name:<22} {value:.2g} W/(m2 K)" for name, value in rows),
            ]
        )


def solve_coefficient(
    model: Callable[[float, Mapping[str, float]], float],
    measured: float,
    measured_error: float,
    parameters: Mapping[str, float],
    relative_errors: Mapping[str, float] | None = None,
) -> Extraction:
    """Find the coefficient at which a model gives what was measured, with first-order uncertainty.

    Parameters
    ----------
    model : callable
        `model(h, parameters)`, rising with h; for instance a call of `block_and_bed.lumped_block_drop`.
    measured : float
        What the model is to give.
    measured_error : float
        Its standard error.
    parameters : mapping
        Parameters of the model by name; those with an error must not be 0.
    relative_errors : mapping, optional
        Relative standard errors of some of the parameters.

    Returns
    -------
    Extraction

    Raises
    ------
    ValueError
        If no h from 0.01 to 1e8 W/(m2 K) gives the measured value, or an error names no parameter.
    """
    wanted = float(positive("measured", measured))
    error = float(non_negative("measured_error", measured_error))
    known = dict(parameters)
    errors = dict(relative_errors or {})
    for name, value in errors.items():
        if name not in known:
            raise ValueError(f"relative_errors names {name!r}; expected one of {', '.join(known)}")
        non_negative(f"relative error of {name}", value)
    low, high = (float(model(h, known)) for h in _RANGE)
    if not low < wanted < high:
        raise ValueError(
            f"measured is {wanted:g}; expected between {low:g} and {high:g}, "
            f"which the model gives for h from {_RANGE[0]:g} to {_RANGE[1]:g} W/(m2 K)"
        )
    logarithm = optimize.brentq(
        lambda x: float(model(math.exp(x), known)) - wanted, *(math.log(h) for h in _RANGE), xtol=1e-11
    )
    h = math.exp(logarithm)
    slope = (model(h * math.exp(_STEP), known) - model(h * math.exp(-_STEP), known)) / (2.0 * _STEP)
    if slope <= 0.0:
        raise ValueError(f"model does not rise with h at {h:g} W/(m2 K); expected a measurement that depends on h")
    budget = {"measured": h * error / slope}
    for name, value in errors.items():
        if known[name] == 0.0:
            raise ValueError(f"{name} is 0; expected another value for a relative error")
        up, down = (model(h, {**known, name: known[name] * (1.0 + sign * _STEP)}) for sign in (1, -1))
        budget[name] = h * value * abs(up - down) / (2.0 * _STEP * slope)
    total = math.sqrt(sum(part * part for part in budget.values()))
    return Extraction(h, total, slope / wanted, budget)


def coefficient_from_drop(
    system: BlockOnBed,
    drop: float,
    time: float,
    depth: float,
    drop_error: float = 0.0,
    relative_errors: Mapping[str, float] | None = None,
    depth_error: float = 0.0,
    cells: int = 100,
) -> Extraction:
    """Contact coefficient from the drop of a thermometer in the block (Adepu et al., section 3.3).

    Parameters
    ----------
    system : BlockOnBed
        Block and bed.
    drop : float
        Drop of the temperature since the bed came. [K]
    time : float
        Time since the bed came. [s]
    depth : float
        Depth of the thermometer below the face. [m]
    drop_error : float
        Standard error of the drop. [K]
    relative_errors : mapping, optional
        Relative standard errors of the quantities of `BlockOnBed` that are no temperatures, by name.
    depth_error : float
        Standard error of the depth. [m]
    cells : int
        As for `temperature`.

    Returns
    -------
    Extraction

    Raises
    ------
    ValueError
        If no coefficient gives the drop, or an input has no meaning.
    """
    positive("time", time, "s")
    errors = dict(relative_errors or {})
    known = {field.name: float(getattr(system, field.name)) for field in fields(system)}
    for name in errors:
        if name.endswith("temperature"):
            raise ValueError(f"relative_errors names {name!r}; expected a quantity that is no temperature")
    where = float(within("depth", depth, 0.0, system.block_length, "m"))
    if depth_error > 0.0:
        errors["depth"] = float(positive("depth_error", depth_error, "m")) / float(positive("depth", where, "m"))
    known["depth"] = where

    def model(h: float, values: Mapping[str, float]) -> float:
        changed = replace(system, **{name: value for name, value in values.items() if name != "depth"})
        gradient = (changed.base_temperature - changed.face_temperature) / changed.block_length
        before = changed.face_temperature + gradient * values["depth"]
        return before - float(temperature(changed, h, time, values["depth"], cells))

    return solve_coefficient(model, drop, drop_error, known, errors)
