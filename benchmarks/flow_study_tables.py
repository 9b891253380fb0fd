"""Tables of the flow study for its page: the matrix beside Watkins' correlations, what is varied, how errors fare.

Called as: python benchmarks/flow_study_tables.py [--csv docs/flow_study.csv]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from flow_points import REFERENCE, VARIATION_VELOCITY, VARIED
from flow_study import ROOT, read_rows
from flow_study_figures import Rows, mean_of_seeds, value

from bedrad.heat import correlations

COLUMNS = ("phi_wa", "n_C/n_C,max at 0 r", "n_C/n_C,max at 0.01 r", "NC share", "a plain", "a closing", "F_w1", "F_w2",
           "F_w3", "F_ww")  # fmt: skip


def cell(rows: Rows, name: str) -> str:
    """Mean over the seeds and its error, as many digits as the error has."""
    mean, error = mean_of_seeds(rows, name)
    digits = max(0, 1 - int(np.floor(np.log10(error)))) if error > 0.0 else 4
    return f"{mean:.{min(digits, 4)}f} ± {error:.{min(digits, 4)}f}"


def matrix(rows: Rows) -> list[str]:
    """A row for every configuration and velocity."""
    points = [row for row in rows if not row["variation"]]
    keys = sorted({(float(row["A [1]"]), float(row["set velocity [m/s]"])) for row in points})
    lines = [f"| A | U [m/s] | U* | seeds | W(38) | W(40) | {' | '.join(COLUMNS)} |", "|---" * (6 + len(COLUMNS)) + "|"]
    for ratio, velocity in keys:
        own = [r for r in points if (float(r["A [1]"]), float(r["set velocity [m/s]"])) == (ratio, velocity)]
        u, star = (float(np.mean([float(row[name]) for row in own])) for name in ("U [m/s]", "U* [1]"))
        d = float(own[0]["particle diameter [m]"])
        solid = float(correlations.packing_fraction(ratio, u, d, warn=False))
        contacts = float(correlations.contact_ratio(ratio, u, d, warn=False))
        cells = " | ".join(cell(own, name) for name in COLUMNS)
        lines.append(f"| {ratio:.1f} | {u:.4f} | {star:.2f} | {len(own)} | {solid:.3f} | {contacts:.3f} | {cells} |")
    return lines


def variations(rows: Rows) -> list[str]:
    """A row for everything that is varied around the reference point."""
    place = (*REFERENCE, VARIATION_VELOCITY)
    names = ("tube diameter [m]", "particle diameter [m]", "set velocity [m/s]")
    own = [row for row in rows if tuple(float(row[name]) for name in names) == place]
    lines = [f"| varied | seeds | {' | '.join(COLUMNS[:7])} |", "|---" * 9 + "|"]
    for variation in ["", *(name for name, _ in VARIED)]:
        some = [row for row in own if row["variation"] == variation]
        if some:
            cells = " | ".join(cell(some, name) for name in COLUMNS[:7])
            lines.append(f"| {variation or 'reference'} | {len(some)} | {cells} |")
    return lines


def errors(rows: Rows) -> list[str]:
    """A row for every quantity: what the two seeds of a flow differ by, in standard errors of the difference."""
    twins: dict[tuple[str, ...], Rows] = {}
    for row in rows:
        place = ("tube diameter [m]", "particle diameter [m]", "set velocity [m/s]", "variation")
        twins.setdefault(tuple(row[name] for name in place), []).append(row)
    lines = ["| quantity | pairs of seeds | root mean square | beyond 2 | largest |", "|---|---|---|---|---|"]
    for name in COLUMNS:
        pairs = np.array([[value(row, name) for row in pair] for pair in twins.values() if len(pair) == 2])
        apart = np.abs(pairs[:, 0, 0] - pairs[:, 1, 0]) / np.hypot(pairs[:, 0, 1], pairs[:, 1, 1])
        root = np.sqrt((apart**2).mean())
        lines.append(f"| {name} | {len(apart)} | {root:.2f} | {(apart > 2.0).mean():.0%} | {apart.max():.1f} |")
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, default=ROOT / "docs" / "flow_study.csv", help="the table")
    rows = read_rows(parser.parse_args().csv)
    print("\n".join([*matrix(rows), "", *variations(rows), "", *errors(rows)]))


if __name__ == "__main__":
    main()
