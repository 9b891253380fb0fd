"""Are the stated errors of the view factors right? 200 seeds at each of five tolerances on three beds.

    python benchmarks/calibration.py [DEMO_BED] [--beds demo,plate,mixed] [--seeds N] [--fixed]
                                     [--threads N] [--csv PATH]

DEMO_BED is a packing; without it, a bed like that of the demo is settled first (needs the extra dem). The truth is an
independent run to a twentieth of the tightest tolerance, itself held against plain random rays through the grid. Its
error is added in quadrature; the part that it shifts all seeds by adds at most 0.5 to a chi-square of nine degrees of
freedom. Each z = (estimate - truth) / error is tested in three ways:

- chi-square of the numbers of z in ten equally likely bins of the normal distribution;
- chi-square of the sum of z^2, which sees errors that are some 10 % too large or too small;
- the Mahalanobis distances of all shares together, by the stated covariance, in ten equally likely bins.

Numbers of hits are whole, so that z takes few values where hits are few: a uniform half hit at most is added to each
number. Shares of fewer than 100 hits a run are listed but not judged: their errors are those of Poisson's distribution,
which is not normal. One verdict is given on all tests together, by Bonferroni's limit: it would fail right errors in
1 % of runs with other seeds, or less often. Seeds are never used twice. A run stops when its stated errors are small
enough, which could favour those that come out too small; --fixed also makes as many runs of as many rays at once.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import beds
import numpy as np
from numpy.typing import NDArray
from scipy import stats

import bedrad
from bedrad.raytrace.tracer import GridTracer

FloatArray = NDArray[np.float64]

TOLERANCES = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
BEDS = ("demo", "plate", "mixed")
REFINEMENT = 20
REFERENCE_SEED = 10**6
FALSE_ALARM = 0.01
BINS = 10
FEWEST_HITS = 100
RANDOM_BATCH, RANDOM_BATCHES = 2**18, 128


@dataclass(frozen=True)
class Runs:
    """What the seeds found.

    Parameters
    ----------
    estimates : (seeds, shares) array
        The layers, beyond, wall, escaped.
    covariances : (seeds, shares, shares) array
        Their stated covariances.
    rays, rounds : (seeds,) arrays
        Numbers of rays and of rounds.
    """

    estimates: FloatArray
    covariances: FloatArray
    rays: FloatArray
    rounds: FloatArray


@dataclass(frozen=True)
class Row:
    """One share, or all of them together ("joint"), at one tolerance."""

    bed: str
    tolerance: float
    stop: str
    share: str
    truth: float
    hits: float
    rounds: float
    stated: float
    actual: float
    within_1: float
    within_2: float
    mean_z: float
    rms_z: float
    p_bins: float
    p_spread: float
    judged: bool


def trace(bed: bedrad.Packing, seeds: Iterable[int], threads: int | None, **effort: float) -> Runs:
    """One run a seed."""
    found = [bedrad.view_factors(bed, seed=s, threads=threads, **effort) for s in seeds]  # type: ignore[arg-type]
    return Runs(
        estimates=np.array([f.history[-1].estimates for f in found]),
        covariances=np.array([f.covariance for f in found]),
        rays=np.array([float(f.rays) for f in found]),
        rounds=np.array([float(len(f.history)) for f in found]),
    )


def in_bins(probabilities: FloatArray) -> float:
    """Chi-square p of the numbers in equally likely bins."""
    counts = np.bincount(np.minimum((probabilities * BINS).astype(int), BINS - 1), minlength=BINS)
    return float(stats.chisquare(counts).pvalue)


def test_runs(runs: Runs, truth: bedrad.ViewFactors, labels: tuple[str, float, str]) -> Iterator[Row]:
    """Test the stated errors of every share and of all shares together.

    Parameters
    ----------
    runs : Runs
        What the seeds found.
    truth : ViewFactors
        The reference.
    labels : tuple
        Bed, tolerance, and how the runs were stopped.
    """
    expected = truth.history[-1].estimates
    names = [*(f"layer {k + 1}" for k in range(len(truth.layers))), "beyond", "wall", "escaped"]
    seeds = len(runs.rays)
    # the variance of a uniform half hit at most is 1/12
    dither = np.random.default_rng(0).uniform(-0.5, 0.5, runs.estimates.shape) / runs.rays[:, None]
    deviations = runs.estimates + dither - expected
    covariances = runs.covariances + truth.covariance + np.eye(len(names)) / (12.0 * runs.rays[:, None, None] ** 2)
    hits = np.median(runs.rays) * expected
    judged = hits >= FEWEST_HITS
    for k in np.flatnonzero(expected):
        z = deviations[:, k] / np.sqrt(covariances[:, k, k])
        below = float(stats.chi2.cdf((z**2).sum(), seeds))
        yield Row(
            *labels,
            names[k],
            truth=float(expected[k]),
            hits=float(hits[k]),
            rounds=float(runs.rounds.mean()),
            stated=float(np.sqrt(runs.covariances[:, k, k].mean())),
            actual=float(np.sqrt(np.mean((runs.estimates[:, k] - expected[k]) ** 2))),
            within_1=float(np.mean(abs(z) < 1)),
            within_2=float(np.mean(abs(z) < 2)),
            mean_z=float(z.mean()),
            rms_z=float(np.sqrt(np.mean(z**2))),
            p_bins=in_bins(stats.norm.cdf(z)),
            p_spread=2.0 * min(below, 1.0 - below),
            judged=bool(judged[k]),
        )
    # the shares sum to one: the largest follows from the others
    used = np.flatnonzero(judged & (np.arange(len(names)) != expected.argmax()))
    square = _squared_distances(deviations[:, used], covariances[:, used][:, :, used])
    nan = float("nan")
    yield Row(
        *labels, "joint", nan, nan, float(runs.rounds.mean()), nan, nan, nan, nan, nan,
        rms_z=float(np.sqrt(square.mean() / len(used))),
        p_bins=in_bins(stats.chi2.cdf(square, len(used))), p_spread=nan, judged=True,
    )  # fmt: skip


def _squared_distances(deviations: FloatArray, covariances: FloatArray) -> FloatArray:
    """Squared Mahalanobis distances, (seeds,)."""
    solved = np.linalg.solve(covariances, deviations[..., None])[..., 0]
    return np.asarray((deviations * solved).sum(axis=1))


def against_random_rays(bed: bedrad.Packing, truth: bedrad.ViewFactors) -> float:
    """P-value of the reference against plain random rays through the grid, all shares together."""
    tracer = GridTracer(bed, truth.edges, truth.window)
    rng = np.random.default_rng(REFERENCE_SEED)
    fates = len(truth.layers) + 3
    counts = np.zeros(fates)
    for _ in range(RANDOM_BATCHES):
        counts += np.bincount(tracer.fates(rng.random((RANDOM_BATCH, 4))), minlength=fates)
    shares = counts / counts.sum()
    used = np.flatnonzero((counts >= FEWEST_HITS) & (np.arange(fates) != shares.argmax()))
    multinomial = (np.diag(shares) - np.outer(shares, shares)) / counts.sum()
    difference = (shares - truth.history[-1].estimates)[used]
    covariance = (multinomial + truth.covariance)[np.ix_(used, used)]
    square = float(_squared_distances(difference[None], covariance[None])[0])
    print(
        f"  {counts.sum():,.0f} random rays through the grid: {', '.join(f'{s:.6f}' for s in shares)}; "
        f"squared distance {square:.1f} with {len(used)} degrees of freedom"
    )
    return float(stats.chi2.sf(square, len(used)))


def show(row: Row) -> None:
    """Print a row."""
    head = f"  {row.tolerance:<8g}{row.stop:<11}{row.share:<9}"
    if row.share == "joint":
        print(f"{head}{'':>76}{row.rms_z:>7.3f}{row.p_bins:>9.3f}", flush=True)
        return
    print(
        f"{head}{row.truth:>11.6f}{row.hits:>12,.0f}{row.rounds:>8.1f}{row.stated:>10.1e}{row.actual:>10.1e}"
        f"{row.within_1:>8.2f}{row.within_2:>8.3f}{row.mean_z:>9.2f}{row.rms_z:>7.3f}{row.p_bins:>9.3f}"
        f"{row.p_spread:>9.3f}{'' if row.judged else '  few hits'}",
        flush=True,
    )


def calibrate(name: str, bed: bedrad.Packing, arguments: argparse.Namespace) -> tuple[list[Row], float]:
    """All rows of a bed, and the p-value of its reference."""
    threads = arguments.threads
    truth = bedrad.view_factors(bed, tolerance=min(TOLERANCES) / REFINEMENT, seed=REFERENCE_SEED, threads=threads)
    print(f"\n{name}: {bed!r}, {arguments.seeds} seeds a tolerance")
    print(f"  reference of {truth.rays:,} rays: {', '.join(f'{s:.6f}' for s in truth.history[-1].estimates)}")
    p_reference = against_random_rays(bed, truth)
    print(
        f"  {'tol.':<8}{'stops at':<11}{'share':<9}{'factor':>11}{'hits':>12}{'rounds':>8}{'stated':>10}"
        f"{'true rms':>10}{'< 1 SE':>8}{'< 2 SE':>8}{'mean z':>9}{'rms z':>7}{'p bins':>9}{'p z^2':>9}"
    )
    rows = []
    for k, tolerance in enumerate(TOLERANCES):
        first = 2 * k * arguments.seeds
        runs = trace(bed, range(first, first + arguments.seeds), threads, tolerance=tolerance)
        stops = [("tolerance", runs)]
        if arguments.fixed:
            others = range(first + arguments.seeds, first + 2 * arguments.seeds)
            stops.append(("rays", trace(bed, others, threads, rays=int(np.median(runs.rays)))))
        for stop, found in stops:
            for row in test_runs(found, truth, (name, tolerance, stop)):
                show(row)
                rows.append(row)
    return rows, p_reference


def conclude(rows: list[Row], references: list[float]) -> bool:
    """Print what all beds and tolerances say together; whether the stated errors pass."""
    print(
        f"\nexpected: {stats.norm.cdf(1) * 2 - 1:.3f} within 1 SE, {stats.norm.cdf(2) * 2 - 1:.3f} within 2 SE, rms z 1"
    )
    judged = [row for row in rows if row.judged]
    for stop in dict.fromkeys(row.stop for row in rows):
        for share in dict.fromkeys(row.share for row in judged if row.share != "joint"):
            chosen = [r for r in judged if (r.stop, r.share) == (stop, share)]
            print(
                f"all beds and tolerances, stopped by {stop}, {share}: "
                f"mean z {np.mean([r.mean_z for r in chosen]):+.3f}, "
                f"rms z {np.sqrt(np.mean([r.rms_z**2 for r in chosen])):.3f} of {len(chosen)} sets of seeds, "
                f"{np.mean([r.within_1 for r in chosen]):.3f} within 1 SE, "
                f"{np.mean([r.within_2 for r in chosen]):.3f} within 2 SE"
            )
    p = np.array([v for r in judged for v in (r.p_bins, r.p_spread) if np.isfinite(v)] + references)
    limit = FALSE_ALARM / len(p)
    passed = bool(p.min() >= limit)
    print(
        f"{len(p)} tests, {np.count_nonzero(p < 0.05)} with p < 0.05 ({0.05 * len(p):.0f} expected), "
        f"least p {p.min():.1e}, limit {limit:.1e} (false alarm {FALSE_ALARM:g} in all): {'pass' if passed else 'FAIL'}"
    )
    return passed


def write(arguments: argparse.Namespace, rows: list[Row]) -> None:
    """Write the rows to a table, below the command that made it."""
    fixed = " --fixed" if arguments.fixed else ""
    with arguments.csv.open("w", newline="", encoding="utf-8") as file:
        print(f"# python benchmarks/calibration.py --beds {arguments.beds} --seeds {arguments.seeds}{fixed}", file=file)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(Row.__dataclass_fields__)
        for row in rows:
            values = (getattr(row, name) for name in Row.__dataclass_fields__)
            writer.writerow("" if v != v else f"{v:.6g}" if isinstance(v, float) else v for v in values)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("demo_bed", nargs="?")
    parser.add_argument("--beds", default=",".join(BEDS))
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--fixed", action="store_true", help="also runs of a fixed number of rays")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--csv", type=Path)
    arguments = parser.parse_args()
    makers = {
        "demo": lambda: beds.demo_bed(arguments.demo_bed),
        "plate": lambda: beds.layer_bed(100_000),
        "mixed": beds.mixed_bed,
    }
    rows: list[Row] = []
    references = []
    for name in arguments.beds.split(","):
        of_bed, p_reference = calibrate(name, makers[name](), arguments)
        rows += of_bed
        references.append(p_reference)
    if arguments.csv:
        write(arguments, rows)
    return 0 if conclude(rows, references) else 1


if __name__ == "__main__":
    sys.exit(main())
