"""View factors of random beds on a flat wall: the floor of wide settled tubes, for three frictions.

python benchmarks/flat_wall.py            # needs the extra dem; a few minutes, beds are kept in results/
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import bedrad
from bedrad.walls import Window

DIAMETER = 600e-6
TUBE = 30 * DIAMETER
FRICTIONS = (0.1, 0.4, 1.0)


def floor_bed(friction: float) -> bedrad.Packing:
    kept = Path(f"results/floor_bed_{friction:g}.h5")
    if not kept.exists():
        kept.parent.mkdir(exist_ok=True)
        bedrad.write(bedrad.settle(bedrad.Tube(TUBE / 2), DIAMETER, 9 * DIAMETER, seed=1, friction=friction), kept)
    bed = bedrad.read(kept)
    return bedrad.Packing(bed.centers, bed.radii, bedrad.Plate())


def main() -> None:
    # the square inside the tube's circle, less four diameters to the wall
    half = TUBE / 2 / np.sqrt(2) - 4 * DIAMETER
    window = Window((-half, half), (-half, half))
    print(
        "friction   n_C/max       phi_wa        F_w1 ± bed      F_w2 ± bed      F_w3 ± bed       beyond   (± rays 1e-4)"
    )
    for friction in FRICTIONS:
        bed = floor_bed(friction)
        f = bedrad.view_factors(bed, tolerance=1e-4, window=window)
        s = bedrad.statistics(bed, window=window)
        layers = "  ".join(f"{x:.4f} ± {e:.4f}" for x, e in zip(f.layers, f.layers_bed_error, strict=True))
        print(
            f"{friction:>8g}  {s.contact_ratio:.3f} ± {s.contact_ratio_error:.3f}"
            f"  {s.packing_fraction:.3f} ± {s.packing_fraction_error:.3f}  {layers}  {f.beyond:.5f}"
        )


if __name__ == "__main__":
    main()
