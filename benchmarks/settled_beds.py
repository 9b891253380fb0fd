"""How much settled beds differ: the demo's bed for several seeds, statistics and view factors beside each other.

    python benchmarks/settled_beds.py [SEEDS]      # needs the extra dem; half a minute a seed, beds are kept in results/
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import bedrad

COLUMNS = ("height/d", "phi", "phi_wa", "n_C/max", "NC share", "a mean", "F_w1", "F_w2", "F_w3", "beyond", "F_ww")


def row(seed: int) -> list[float]:
    kept = Path(f"results/settled_{seed}.h5")
    if not kept.exists():
        kept.parent.mkdir(exist_ok=True)
        bedrad.write(bedrad.settle(bedrad.Tube(3.875e-3), 600e-6, 18e-3, seed=seed), kept)
    bed = bedrad.read(kept)
    s = bedrad.statistics(bed)
    f = bedrad.view_factors(bed, tolerance=1e-4, seed=seed)
    low, high = s.window.axial
    inside = (bed.centers[:, 2] >= low) & (bed.centers[:, 2] < high)
    solid = inside.sum() * np.pi / 6 * 600e-6**3 / (np.pi * 3.875e-3**2 * (high - low))
    height = bed.extent(2)[1] / 600e-6
    return [height, solid, s.packing_fraction, s.contact_ratio, s.nc_share, s.nc_distance, *f.layers, f.beyond, f.wall]


def main() -> None:
    seeds = range(1, 1 + int(sys.argv[1] if len(sys.argv) > 1 else 6))
    print("seed " + "".join(f"{name:>10}" for name in COLUMNS))
    rows = []
    for seed in seeds:
        rows.append(row(seed))
        print(f"{seed:>4} " + "".join(f"{x:>10.4f}" for x in rows[-1]), flush=True)
    print("mean " + "".join(f"{x:>10.4f}" for x in np.mean(rows, axis=0)))
    print("s.d. " + "".join(f"{x:>10.4f}" for x in np.std(rows, axis=0, ddof=1)))


if __name__ == "__main__":
    main()
