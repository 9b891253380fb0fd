"""Are the stated errors of the view factors right? 100 seeds on a settled bed against an independent 2^26-ray run.

    python benchmarks/calibration.py [BED] [--rays N]

For every share it counts how often the true error lies within one and within two stated standard errors, and tests the
normalised errors against Student's t with 31 degrees of freedom (32 scramblings) by chi-square. The reference's own
error is 1/8 of that of a run with 2^20 rays or less and is added in quadrature.
"""

from __future__ import annotations

import argparse

import numpy as np
from ray_rate import demo_bed
from scipy import stats

import bedrad
from bedrad.raytrace.view_factors import SCRAMBLINGS

SEEDS = 100
REFERENCE = 2**26


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bed", nargs="?")
    parser.add_argument("--rays", type=int, default=2**18)
    arguments = parser.parse_args()
    bed = demo_bed(arguments.bed)
    truth = bedrad.view_factors(bed, rays=REFERENCE, seed=10**6).history[-1]
    runs = [bedrad.view_factors(bed, rays=arguments.rays, seed=s).history[-1] for s in range(SEEDS)]
    names = [*(f"layer {k + 1}" for k in range(len(truth.estimates) - 3)), "beyond", "wall", "escaped"]
    student = stats.t(SCRAMBLINGS - 1)
    wanted = [student.cdf(k) - student.cdf(-k) for k in (1, 2)]
    print(f"{len(bed):,} spheres, {SEEDS} seeds of {arguments.rays:,} rays, reference of {REFERENCE:,}")
    print(f"{'share':<10}{'factor':>12}{'stated':>10}{'true rms':>10}{'< 1 SE':>8}{'< 2 SE':>8}{'chi-square p':>14}")
    for k, name in enumerate(names):
        estimates = np.array([r.estimates[k] for r in runs])
        errors = np.hypot([r.errors[k] for r in runs], truth.errors[k])
        z = (estimates - truth.estimates[k]) / errors
        counts = np.bincount(np.minimum((student.cdf(z) * 10).astype(int), 9), minlength=10)
        p = stats.chisquare(counts).pvalue
        print(
            f"{name:<10}{truth.estimates[k]:>12.6f}{np.sqrt(np.mean(errors**2)):>10.1e}"
            f"{np.sqrt(np.mean((estimates - truth.estimates[k]) ** 2)):>10.1e}"
            f"{np.mean(abs(z) < 1):>8.2f}{np.mean(abs(z) < 2):>8.2f}{p:>14.3f}"
        )
    print(f"{'expected':<42}{wanted[0]:>8.2f}{wanted[1]:>8.2f}")


if __name__ == "__main__":
    main()
