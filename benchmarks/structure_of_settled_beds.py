"""Structure of settled beds beside the wall: porosity against depth, and the tube's mean porosity against A = D/d.

    python benchmarks/structure_of_settled_beds.py [--csv PATH] [--figure PATH]

Needs the extra dem; about a quarter of an hour of one processor, and half a minute where the beds are already in
results/structure/. Beds of equal spheres are settled with the defaults of bedrad.settle (friction 0.4), cut exactly,
and measured away from floor and top (four diameters each). What the result depends on is tried apart: friction, the
height of the bed, the softened stiffness. Nothing is fitted to the published curves beside them.
"""

from __future__ import annotations

import argparse
import csv
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import structure_figure
from numpy.typing import NDArray
from scipy.optimize import curve_fit
from scipy.signal import find_peaks

import bedrad
from bedrad.packings import porosity_correlations as published
from bedrad.packings.settle import plan_settle

FloatArray = NDArray[np.float64]

DIAMETER = 600e-6
KEPT = Path("results/structure")

BIN = 0.025
"""Width of the profile's bins, in diameters."""

FITTED = (0.5, 6.0)
"""Depths between which the damped oscillation is fitted, in diameters; it ends a radius before the axis."""

FARTHEST_NEXT = 1.3
"""Largest distance between two maxima of one oscillation, in diameters; there are others near the axis."""

FEWEST_DEPTHS = 3.0
"""Half widths of tube, in diameters, from which on there is enough depth to fit an oscillation."""

PUBLISHED = {
    "Dixon 1988": published.dixon,
    "Foumeny 1991": published.foumeny,
    "Zou & Yu 1995, loose": published.zou_yu_loose,
    "Benyahia & O'Neill 2005": published.benyahia_oneill,
    "Cheng 2011": published.cheng,
}


@dataclass(frozen=True)
class Case:
    """Beds that differ in their seed only; the height is that of `bedrad.settle`, in diameters."""

    diameter_ratio: float
    height: float
    seeds: int
    friction: float = 0.4
    stiffer: float = 1.0


WIDTHS = ((2.5, 30, 8), (3, 30, 8), (4, 30, 8), (5, 30, 6), (6.5, 30, 4), (8, 30, 4), (10, 30, 3), (12.9, 30, 3),
          (17.2, 26, 2), (25, 24, 1))  # fmt: skip
CASES = (
    *(Case(a, height, seeds) for a, height, seeds in WIDTHS),
    *(Case(a, height, (seeds + 1) // 2, friction=0.1) for a, height, seeds in WIDTHS),
    Case(6.5, 30, 2, friction=0.2),
    Case(12.9, 30, 2, friction=0.2),
    Case(5, 15, 12),
    Case(5, 60, 4),
    Case(5, 15, 12, stiffer=10.0),
    Case(5, 30, 6, stiffer=10.0),
    Case(5, 60, 4, stiffer=10.0),
    Case(12.9, 30, 2, stiffer=10.0),
)


@dataclass(frozen=True)
class Profile:
    """Porosity against depth (in diameters), the mean over the beds of a case."""

    edges: FloatArray
    porosity: FloatArray
    error: FloatArray

    @property
    def depths(self) -> FloatArray:
        """Middles of the bins."""
        return 0.5 * (self.edges[1:] + self.edges[:-1])


@dataclass(frozen=True)
class Row:
    """What one case gave; lengths are in diameters.

    Errors are standard errors from blocks along the axis. `oscillations` are the maxima that stand out by six
    standard errors, one after the other from the wall on.
    """

    diameter_ratio: float
    height: float
    friction: float
    stiffer: float
    seeds: int
    spheres: int
    porosity: float
    porosity_error: float
    porosity_sd_of_seeds: float
    wall_layer_fraction: float
    contact_ratio: float
    mean_pair_overlap: float
    first_minimum_depth: float
    first_minimum: float
    first_maximum_depth: float
    first_maximum: float
    oscillations: int
    period: float
    decay_length: float
    bulk_porosity: float


def bed(case: Case, seed: int) -> bedrad.Packing:
    """A bed, from results/structure or settled now."""
    stiff = f"_stiffer{case.stiffer:g}" if case.stiffer != 1.0 else ""
    kept = KEPT / f"A{case.diameter_ratio:g}_height{case.height:g}_friction{case.friction:g}{stiff}_seed{seed}.h5"
    if not kept.exists():
        kept.parent.mkdir(parents=True, exist_ok=True)
        wall, height = bedrad.Tube(0.5 * case.diameter_ratio * DIAMETER), case.height * DIAMETER
        stiffness = None
        if case.stiffer != 1.0:
            stiffness = case.stiffer * plan_settle(wall, DIAMETER, height, seed=seed).stiffness
        packing = bedrad.settle(wall, DIAMETER, height, seed=seed, friction=case.friction, stiffness=stiffness)
        bedrad.write(packing, kept)
        print(f"settled {kept} in {float(packing.provenance['run_seconds']):.0f} s", flush=True)
    return bedrad.read(kept)


def measure(case: Case) -> tuple[Row, Profile]:
    """Settle, cut and measure the beds of a case."""
    beds = [bed(case, seed) for seed in range(1, case.seeds + 1)]
    radius = 0.5 * case.diameter_ratio
    edges = np.linspace(0.0, radius, round(radius / BIN) + 1)
    deepest = beds[0].wall.largest_depth
    tubes = [
        bedrad.statistics(b, edges=[0.0, deepest], profile_depths=np.minimum(edges * DIAMETER, deepest)) for b in beds
    ]
    walls = [bedrad.statistics(b, edges=[0.0, 0.5 * DIAMETER, deepest]) for b in beds]
    porosities = np.array([1.0 - s.packing_fraction for s in tubes])
    profile = Profile(
        edges,
        1.0 - np.mean([s.profile for s in tubes], axis=0),
        _error_of_mean([s.profile_error for s in tubes]),
    )
    minima, maxima = extrema(profile)
    period, decay, bulk = oscillation(profile, radius)
    return Row(
        diameter_ratio=case.diameter_ratio,
        height=case.height,
        friction=case.friction,
        stiffer=case.stiffer,
        seeds=case.seeds,
        spheres=sum(s.spheres for s in tubes),
        porosity=float(porosities.mean()),
        porosity_error=float(_error_of_mean([np.array(s.packing_fraction_error) for s in tubes])),
        porosity_sd_of_seeds=float(porosities.std(ddof=1)) if case.seeds > 1 else math.nan,
        wall_layer_fraction=float(np.mean([s.packing_fraction for s in walls])),
        contact_ratio=float(np.mean([s.contact_ratio for s in walls])),
        mean_pair_overlap=float(np.mean([float(b.provenance["mean_pair_overlap_d"]) for b in beds])),
        first_minimum_depth=minima[0][0],
        first_minimum=minima[0][1],
        first_maximum_depth=maxima[0][0] if maxima else math.nan,
        first_maximum=maxima[0][1] if maxima else math.nan,
        oscillations=_in_a_row([depth for depth, _ in maxima]),
        period=period,
        decay_length=decay,
        bulk_porosity=bulk,
    ), profile


def _error_of_mean(errors: Sequence[FloatArray]) -> FloatArray:
    """Standard error of the mean of independent values with these errors."""
    return np.asarray(np.sqrt((np.array(errors) ** 2).sum(axis=0)) / len(errors))


def extrema(profile: Profile) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """Minima and maxima (depth, porosity) that stand out by six standard errors, the depth from a parabola.

    The last radius before the axis is left out: few spheres have their volume there.
    """
    y, eps = profile.depths, profile.porosity
    inside = y < y[-1] - 0.5 + BIN
    prominence = 6.0 * float(np.median(profile.error[inside]))
    found = []
    for sign in (-1.0, 1.0):
        peaks, _ = find_peaks(sign * eps, prominence=prominence, distance=round(0.4 / BIN))
        points = []
        for k in peaks[inside[peaks]]:
            near = slice(max(k - 3, 0), k + 4)
            bend, slope, level = np.polyfit(y[near] - y[k], eps[near], 2)
            shift = -slope / (2.0 * bend)
            points.append((float(y[k] + shift), float(level + 0.5 * slope * shift)))
        found.append(points)
    return found[0], found[1]


def _in_a_row(depths: Sequence[float]) -> int:
    """How many maxima follow each other from the wall on."""
    far = np.flatnonzero(np.diff(depths, prepend=0.0) > FARTHEST_NEXT)
    return int(far[0]) if len(far) else len(depths)


def damped(y: FloatArray, bulk: float, height: float, decay: float, period: float, shift: float) -> FloatArray:
    """Porosity of a damped oscillation about that of the bulk."""
    return np.asarray(bulk + height * np.exp(-y / decay) * np.cos(2.0 * np.pi * (y - shift) / period))


def oscillation(profile: Profile, radius: float) -> tuple[float, float, float]:
    """Period, decay length and bulk porosity of the damped oscillation, by least squares; nan in a narrow tube."""
    if radius < FEWEST_DEPTHS:
        return math.nan, math.nan, math.nan
    y = profile.depths
    used = (y >= FITTED[0]) & (y <= min(FITTED[1], radius - 0.5))
    start = (0.42, 0.3, 1.5, 0.9, 0.1)
    best, _ = curve_fit(damped, y[used], profile.porosity[used], start)
    return float(best[3]), float(best[2]), float(best[0])


def show(rows: Sequence[Row]) -> None:
    """Print the table beside the published mean porosities."""
    names = "".join(f"{name.split(' ')[0]:>10}" for name in PUBLISHED)
    print(
        f"{'A':>5}{'height':>7}{'friction':>9}{'stiffer':>8}{'porosity':>18}{names}"
        f"{'minimum at':>11}{'eps':>7}{'maxima':>7}{'period':>8}{'decay':>7}{'bulk':>7}"
    )
    for r in rows:
        others = "".join(f"{float(f(r.diameter_ratio)):>10.3f}" for f in PUBLISHED.values())
        print(
            f"{r.diameter_ratio:>5g}{r.height:>7g}{r.friction:>9g}{r.stiffer:>8g}"
            f"{r.porosity:>9.4f} ± {r.porosity_error:.4f}{others}"
            f"{r.first_minimum_depth:>11.3f}{r.first_minimum:>7.3f}{r.oscillations:>7}{r.period:>8.3f}"
            f"{r.decay_length:>7.2f}{r.bulk_porosity:>7.3f}"
        )


def write_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write the table below the command that made it."""
    with path.open("w", newline="", encoding="utf-8") as file:
        print("# make study-structure: benchmarks/structure_of_settled_beds.py; lengths in diameters", file=file)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(Row.__dataclass_fields__)
        for row in rows:
            values = (getattr(row, name) for name in Row.__dataclass_fields__)
            writer.writerow("" if v != v else f"{v:.5g}" if isinstance(v, float) else v for v in values)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, help="where the table goes")
    parser.add_argument("--figure", type=Path, help="where the figure goes")
    arguments = parser.parse_args()
    # a bed that is a little lower than asked for is as good here
    warnings.filterwarnings("ignore", message="the bed is .* tall, lower than")
    measured = {case: measure(case) for case in CASES}
    rows = [row for row, _ in measured.values()]
    show(rows)
    if arguments.csv:
        write_rows(arguments.csv, rows)
    if arguments.figure:
        drawn = CASES[: 2 * len(WIDTHS) + 2]
        profiles = {(c.diameter_ratio, c.friction): measured[c][1] for c in CASES[: 2 * len(WIDTHS)]}
        structure_figure.draw(
            arguments.figure,
            {case: (p.depths, p.porosity) for case, p in profiles.items()},
            [(r.diameter_ratio, r.friction, r.porosity, r.porosity_error) for r in (measured[c][0] for c in drawn)],
            PUBLISHED,
        )


if __name__ == "__main__":
    main()
