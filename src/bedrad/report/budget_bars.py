"""Bars of a budget of uncertainty: what each input does to h at the hottest wall."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.heat.budget import LABELS
from bedrad.report import style

__all__ = ["Bars", "HottestWall", "draw_bars", "hottest_wall", "input_bars"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class HottestWall:
    """A budget at the hottest wall.

    Parameters
    ----------
    inputs : sequence of str
        Names of the inputs.
    errors : (inputs,) array
        Standard error of h from each input. [%]
    elasticities : (inputs,) array
        Change of h by 1 % of each input. [%]
    """

    inputs: Sequence[str]
    errors: FloatArray
    elasticities: FloatArray


@dataclass(frozen=True)
class Bars:
    """What is drawn.

    Parameters
    ----------
    inputs : sequence of str
        Names of the inputs, from the bottom: the one that matters most comes last.
    sizes : (budgets, inputs) array
        Size of each bar. [%]
    stated : bool
        Whether they are errors of h, and not changes of h by 1 % of the input.
    """

    inputs: Sequence[str]
    sizes: FloatArray
    stated: bool


def hottest_wall(
    inputs: Sequence[str],
    wall_temperature: ArrayLike,
    contributions: ArrayLike,
    elasticities: ArrayLike,
    heat_transfer_coefficient: ArrayLike,
) -> HottestWall:
    """A budget at the hottest of the wall temperatures it is for.

    Parameters
    ----------
    inputs : sequence of str
        Names of the m inputs.
    wall_temperature : float or (n,) array
        [K]
    contributions : (m, n) array
        Standard error of h from each input. [W/(m2 K)]
    elasticities : (m, n) array
        Change of ln h over that of ln of each input.
    heat_transfer_coefficient : float or (n,) array
        [W/(m2 K)]
    """
    k = int(np.argmax(np.atleast_1d(wall_temperature)))
    h = float(np.atleast_1d(heat_transfer_coefficient)[k])
    errors, changes = (
        np.asarray(array, dtype=float).reshape(len(inputs), -1)[:, k] for array in (contributions, elasticities)
    )
    return HottestWall(inputs, 100.0 * errors / h, changes)


def input_bars(walls: Sequence[HottestWall], most: int) -> Bars:
    """The inputs that matter most: by the error they make where any budget states one, else by their elasticity.

    Parameters
    ----------
    walls : sequence of HottestWall
        The budgets; one may lack an input that another has.
    most : int
        Inputs at the most; those that do nothing are left out.
    """
    stated = any(np.any(wall.errors > 0) for wall in walls)
    rows = [
        dict(zip(wall.inputs, (wall.errors if stated else wall.elasticities).tolist(), strict=True)) for wall in walls
    ]
    inputs = list(dict.fromkeys(name for row in rows for name in row))
    table = np.array([[row.get(name, 0.0) for name in inputs] for row in rows])
    largest = np.abs(table).max(axis=0)
    order = np.argsort(-largest, kind="stable")[: min(most, np.count_nonzero(largest))][::-1]
    return Bars([inputs[k] for k in order], table[:, order], stated)


def draw_bars(axes: Any, bars: Bars, font_size: float, titles: Sequence[str] | None = None) -> None:
    """Draw the bars of all budgets side by side, the first above.

    Parameters
    ----------
    axes : matplotlib Axes
        Where to draw.
    bars : Bars
        What to draw.
    font_size : float
        Size of the inputs' names. [points]
    titles : sequence of str, optional
        Texts of the budgets for a legend.
    """
    count = np.arange(len(bars.inputs))
    height = 0.8 / len(bars.sizes)
    for k, row in enumerate(bars.sizes):
        label = "" if titles is None else style.literal(titles[k])
        axes.barh(count + 0.4 - (k + 0.5) * height, row, height=0.9 * height, color=style.COLOURS[k], label=label)
    axes.set_yticks(count, [LABELS.get(name, (name,))[0] for name in bars.inputs], fontsize=font_size)
    axes.axvline(0.0, color=style.GREY, linewidth=0.8)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel(
        "Standard error of $h$ from the input [%]" if bars.stated else "Change of $h$ by 1 % of the input [%]"
    )
