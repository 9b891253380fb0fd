"""The densest packings of equal spheres that all touch the wall of a tube, constructed from their contacts.

Lengths are in sphere diameters. The centres lie on a cylinder of radius rho = (A - 1)/2 around the axis, A being the
tube's diameter. A structure has `strands` equally spaced spheres in every level; the next level is `rise` higher and
turned by `turn`. A contact (s, j) means that a sphere touches the one that is s strands further and j levels higher:

    4 rho^2 sin^2((2 pi s/strands + j turn)/2) + (j rise)^2 = 1

Three contacts fix rho, rise and turn. Rings that are staggered and zigzags have a turn given by symmetry, and two
contacts fix the rest; a zigzag with one contact may have any A.
"""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from pathlib import Path

import mpmath
import numpy as np

import bedrad
from bedrad.walls import Window

TABLE = Path(__file__).parents[1] / "references" / "dense_packings_in_cylinders.csv"
DIGITS = 40
DIAMETER = 600e-6


@dataclass(frozen=True)
class Structure:
    """A packing, to rounding of doubles: `neighbours` is how many spheres each touches, `levels` what a period holds.

    `levels` is None where the turn is no rational share of a circle, so that there is no period.
    """

    name: str
    strands: int
    diameter_ratio: float
    rise: float
    turn: float
    neighbours: int
    levels: int | None

    @property
    def volume_fraction(self):
        """Solid over tube."""
        return self.strands / 6.0 / (0.25 * self.diameter_ratio**2 * self.rise)


def table():
    """The tabulated structures: name and the numbers (A, solid fraction, wall coverage, rise)."""
    with TABLE.open(newline="", encoding="utf-8") as file:
        return [(row[0], *map(float, row[1:])) for row in list(csv.reader(file))[1:]]


def construct(name, diameter_ratio, rise):
    """Solve the contact conditions of a tabulated structure, from the table's values on."""
    if name == "zigzag":
        return _zigzag(diameter_ratio)
    if rings := re.fullmatch(r"\((\d+),\1,0\) staggered rings", name):
        return _rings(int(rings[1]))
    if helix := re.fullmatch(r"\((\d+),(\d+),(\d+)\) single helix theta=([\d.]+)", name):
        contacts = [(0, int(j)) for j in helix.groups()[:3]]
        return _helix(name, 1, contacts, (diameter_ratio, rise, float(helix[4])), None)
    if double := re.fullmatch(r"g=(\d) \[(.*)\] theta=([\d.]+)", name):
        contacts = [(int(s), int(j)) for s, j in re.findall(r"\((\d), (\d)\)", double[2])]
        return _helix(name, int(double[1]), contacts, (diameter_ratio, rise, float(double[3])), 2)
    raise LookupError(f"{name!r} is no structure that can be constructed here")


def _zigzag(diameter_ratio):
    """Each sphere opposite the one below; in the widest, each also touches the one after the next."""
    with mpmath.workdps(DIGITS):
        widest = 1 + mpmath.sqrt(3) / 2
        closed = abs(widest - diameter_ratio) < 1e-9
        A = widest if closed else mpmath.mpf(repr(diameter_ratio))
        rise = mpmath.sqrt(1 - (A - 1) ** 2)
        return Structure("zigzag", 1, float(A), float(rise), math.pi, 4 if closed else 2, 2)


def _rings(count):
    """Touching rings, each turned by half a sphere against the one below and touching it."""
    with mpmath.workdps(DIGITS):
        rho = 1 / (2 * mpmath.sin(mpmath.pi / count))
        rise = mpmath.sqrt(1 - (2 * rho * mpmath.sin(mpmath.pi / (2 * count))) ** 2)
        # in a ring of two, both have one and the same neighbour
        neighbours = 6 if count > 2 else 5
        name = f"({count},{count},0) staggered rings"
        return Structure(name, count, float(1 + 2 * rho), float(rise), math.pi / count, neighbours, 2)


def _helix(name, strands, contacts, start, levels):
    """Three contacts, by Newton's method in 40 digits."""
    with mpmath.workdps(DIGITS):

        def excess(A, rise, turn):
            rho = (A - 1) / 2
            return [
                4 * rho**2 * mpmath.sin((2 * mpmath.pi * s / strands + j * turn) / 2) ** 2 + (j * rise) ** 2 - 1
                for s, j in contacts
            ]

        A, rise, turn = mpmath.findroot(excess, start)
        assert max(abs(mpmath.mpf(x) - y) for x, y in zip(start, (A, rise, turn), strict=True)) < 1e-6
        return Structure(name, strands, float(A), float(rise), float(turn), 6, levels)


def packing(structure, levels):
    """So many levels of a structure as a packing: periodic if these are whole periods, else open and about z = 0."""
    radius = 0.5 * (structure.diameter_ratio - 1.0) * DIAMETER
    periodic = structure.levels is not None and levels % structure.levels == 0
    first = 0 if periodic else -(levels // 2)
    steps = np.arange(first, first + levels)
    centers = []
    for level in steps:
        for strand in range(structure.strands):
            angle = level * structure.turn + 2.0 * math.pi * strand / structure.strands
            centers.append(
                (radius * math.cos(angle), radius * math.sin(angle), float(level) * structure.rise * DIAMETER)
            )
    period = levels * structure.rise * DIAMETER if periodic else None
    wall = bedrad.Tube(0.5 * structure.diameter_ratio * DIAMETER)
    return bedrad.Packing(centers, 0.5 * DIAMETER, wall, period=period, max_overlap=1e-12)


def window(structure, levels):
    """A window of so many rises about z = 0, its ends midway between levels.

    The infinite structure is carried into itself by a screw of one rise, which changes neither the tube nor its
    layers: a window of whole rises holds whole numbers of spheres in every layer, wherever it starts.
    """
    start = -(levels // 2) - 0.5
    return Window((start * structure.rise * DIAMETER, (start + levels) * structure.rise * DIAMETER))
