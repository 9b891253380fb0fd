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

TERMS = ((0, 0), (1, 0), (0, 1), (1, 1))
"""Terms of every fit: powers of 1/A and of U*."""

_HEAD = '''"""Coefficients of correlations for flows: written by benchmarks/flow_fits.py from docs/flow_study.csv."""

from __future__ import annotations

__all__ = ["DIAMETER_RATIOS", "FITS", "POINTS", "TERMS", "VELOCITIES", "VIEW_FACTOR_CORRELATIONS"]

'''


@dataclass(frozen=True)
class Fit:
    """Coefficients, covariance, the scatter that errors do not explain, and what is missed (root mean squares)."""

    coefficients: FloatArray
    covariance: FloatArray
    scatter: float
    missed: float
    residuals: FloatArray
    unseen: float


def fit(design: FloatArray, values: FloatArray, errors: FloatArray, groups: FloatArray) -> Fit:
    """Fit, and fit again without each group."""
    coefficients, covariance, scatter = least_squares(design, values, errors)
    missed = values - design @ coefficients
    unseen = []
    for group in np.unique(groups):
        seen = groups != group
        if np.linalg.matrix_rank(design[seen]) == design.shape[1] < seen.sum():
            without, _, _ = least_squares(design[seen], values[seen], errors[seen])
            unseen.append(values[~seen] - design[~seen] @ without)
    unseen_rms = _rms(np.concatenate(unseen)) if unseen else np.nan
    return Fit(coefficients, covariance, scatter, _rms(missed), missed, unseen_rms)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values * values)))


def least_squares(design: FloatArray, values: FloatArray, errors: FloatArray) -> tuple[FloatArray, FloatArray, float]:
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
    return coefficients, covariance, scatter


def fits(rows: list[dict[str, str]]) -> tuple[FloatArray, FloatArray, dict[str, Fit]]:
    """Diameter ratios and velocities U* of the flows that are fitted, and the fits."""
    dense = [
        row for row in rows
        if not row["variation"] and not any(word in row["problems"] for word in ("thinned", "jammed"))
    ]  # fmt: skip
    A, U = (np.array([float(row[name]) for row in dense]) for name in ("A [1]", "U* [1]"))
    design = np.stack([A**-p * U**q for p, q in TERMS], axis=1)
    found = {}
    for name, column in QUANTITIES.items():
        values = np.array([float(row[column.format("")]) for row in dense])
        errors = np.array([float(row[column.format("error ")]) for row in dense])
        found[name] = fit(design, values, errors, A)
    return A, U, found


def view_factor_correlations(found: dict[str, Fit]) -> FloatArray:
    """Correlation matrix of the residuals of the view factors to the layers."""
    return np.corrcoef([found[f"view_factor_{k}"].residuals for k in (1, 2, 3)])


def module_text(A: FloatArray, U: FloatArray, found: dict[str, Fit]) -> str:
    """The Python module that holds the fits."""
    lines = [
        f"POINTS = {len(A)}",
        '"""Flows that were fitted."""\n',
        f"DIAMETER_RATIOS = ({A.min():.1f}, {A.max():.1f})",
        f"VELOCITIES = ({U.min():.3f}, {U.max():.3f})",
        '"""Range of U/sqrt(g d)."""\n',
        f"TERMS = {TERMS!r}",
        '"""Powers of 1/A and of U/sqrt(g d)."""\n',
        "FITS = {",
    ]
    for name, each in found.items():
        covariance = "".join(f"            {tuple(float(f'{x:.6g}') for x in row)!r},\n" for row in each.covariance)
        lines += [
            f'    "{name}": (',
            f"        {tuple(float(f'{c:.8g}') for c in each.coefficients)!r},",
            f"        (\n{covariance}        ),",
            f"        {each.scatter:.4g},",
            "    ),",
        ]
    lines += ["}", '"""Coefficients, their covariance, and the standard deviation of a flow about the fit."""\n']
    rows = "".join(f"    {tuple(float(f'{x:.6g}') for x in row)!r},\n" for row in view_factor_correlations(found))
    lines += [
        f"VIEW_FACTOR_CORRELATIONS = (\n{rows})",
        '"""How the residuals of the three view factors go together."""\n',
    ]
    return _HEAD + "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, default=ROOT / "docs" / "flow_study.csv", help="the table")
    parser.add_argument("--module", type=Path, help="Python module to write")
    options = parser.parse_args()
    A, U, found = fits(read_rows(options.csv))
    print(f"{len(A)} flows, A {A.min():.1f} to {A.max():.1f}, U* {U.min():.3f} to {U.max():.3f}; terms {TERMS}")
    for name, each in found.items():
        print(name)
        print("  coefficients", np.array2string(each.coefficients, precision=5, separator=", "))
        print("  errors      ", np.array2string(np.sqrt(np.diag(each.covariance)), precision=2, separator=", "))
        print(
            f"  scatter {each.scatter:.4f}, misses {each.missed:.4f} (rms), of unseen configurations {each.unseen:.4f}"
        )
    if options.module is not None:
        options.module.write_text(module_text(A, U, found), encoding="utf-8")


if __name__ == "__main__":
    main()
