"""Correlations for the wall layer and the view factors of flows, fitted to the flow study.

Every quantity is fitted by least squares with weights on the points of the matrix (all seeds), in terms of the diameter
ratio A and the velocity U* = U/sqrt(g d); flows that were thinned or jammed are left out. The weight of a point is one
over the square of its stated error and of the scatter that the fit leaves, which is found so that chi-square is its
expectation. Printed are the coefficients, their covariance, the scatter, and how far the fit misses a configuration
that it has not seen. `bedrad.heat.flow_correlations` holds what this prints, and a test holds one against the other.

Called as: python benchmarks/flow_fits.py [--csv docs/flow_study.csv]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from flow_study import ROOT, read_rows
from numpy.typing import NDArray
from scipy.optimize import brentq

FloatArray = NDArray[np.float64]

QUANTITIES = {
    "packing_fraction": "phi_wa {}[1]",
    "contact_ratio": "n_C/n_C,max at 0.01 r {}[1]",
    "nc_distance": "a closing {}[r]",
    "view_factor_1": "F_w1 {}[1]",
    "view_factor_2": "F_w2 {}[1]",
    "view_factor_3": "F_w3 {}[1]",
}
"""Name of the correlation, and the column of the table, where "error " goes into the braces."""

TERMS = {"1": (0, 0), "1/A": (1, 0), "U*": (0, 1), "U*/A": (1, 1), "U*^2": (0, 2)}
"""Terms that a fit may have: powers of 1/A and of U*."""


@dataclass(frozen=True)
class Fit:
    """Coefficients of the terms, their covariance, and the scatter about the fit that the errors do not explain."""

    coefficients: FloatArray
    covariance: FloatArray
    scatter: float
    missed: FloatArray


def fit(design: FloatArray, values: FloatArray, errors: FloatArray) -> Fit:
    """Weighted least squares with a scatter of its own, found so that chi-square is its expectation."""
    free = len(values) - design.shape[1]

    def solve(scatter: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        weight = 1.0 / np.hypot(errors, scatter)
        inverse = np.linalg.inv((design * weight[:, None] ** 2).T @ design)
        coefficients = inverse @ (design.T @ (weight**2 * values))
        return coefficients, inverse, weight * (values - design @ coefficients)

    def excess(scatter: float) -> float:
        return float((solve(scatter)[2] ** 2).sum()) - free

    scatter = 0.0 if excess(0.0) <= 0.0 else float(brentq(excess, 0.0, 10.0 * float(values.std())))
    coefficients, covariance, _ = solve(scatter)
    return Fit(coefficients, covariance, scatter, values - design @ coefficients)


def left_out(design: FloatArray, values: FloatArray, errors: FloatArray, groups: FloatArray) -> float:
    """Root mean square of what fits miss of the configurations that they have not seen."""
    missed = []
    for group in np.unique(groups):
        seen = groups != group
        if np.linalg.matrix_rank(design[seen]) < design.shape[1]:
            return float("nan")
        found = fit(design[seen], values[seen], errors[seen])
        missed.append(values[~seen] - design[~seen] @ found.coefficients)
    return float(np.sqrt(np.mean(np.concatenate(missed) ** 2)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, default=ROOT / "docs" / "flow_study.csv", help="the table")
    parser.add_argument("--terms", nargs="+", default=list(TERMS)[:4], choices=list(TERMS), help="terms of the fits")
    options = parser.parse_args()
    rows = [row for row in read_rows(options.csv) if not row["variation"]]
    dense = [row for row in rows if not any(word in row["problems"] for word in ("thinned", "jammed"))]
    A, U = (np.array([float(row[name]) for row in dense]) for name in ("A [1]", "U* [1]"))
    print(f"{len(dense)} of {len(rows)} flows, A {A.min():.1f} to {A.max():.1f}, U* {U.min():.3f} to {U.max():.3f}")
    powers = [TERMS[name] for name in options.terms]
    design = np.stack([A**-p * U**q for p, q in powers], axis=1)
    for name, column in QUANTITIES.items():
        values = np.array([float(row[column.format("")]) for row in dense])
        errors = np.array([float(row[column.format("error ")]) for row in dense])
        found = fit(design, values, errors)
        print(f"{name}: {', '.join(options.terms)}")
        print("  coefficients", np.array2string(found.coefficients, precision=5, separator=", "))
        print("  errors      ", np.array2string(np.sqrt(np.diag(found.covariance)), precision=2, separator=", "))
        print(f"  scatter {found.scatter:.4f}, misses {np.sqrt(np.mean(found.missed**2)):.4f} (rms), "
              f"unseen configurations {left_out(design, values, errors, A):.4f}")  # fmt: skip


if __name__ == "__main__":
    main()
