"""How much settled beds differ: the demo's bed for several seeds, statistics and view factors beside each other.

    python benchmarks/settled_beds.py [--seeds N] [--legacy-wall]

Needs the extra dem; half a minute a seed, beds are kept in results/. With --legacy-wall the same columns fall in a tube
whose wall is LAMMPS's hooke/history, which up to the release of 22 July 2025 (update 4) has no static friction.
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path

import numpy as np

import bedrad
from bedrad.packings import settle as settling
from bedrad.packings import settle_plan

COLUMNS = ("height/d", "phi", "phi_wa", "n_C/max", "NC share", "a mean", "F_w1", "F_w2", "F_w3", "beyond", "F_ww")


def legacy_script(plan: settle_plan.SettlePlan) -> str:
    normal, tangential = plan.stiffness, settle_plan.TANGENTIAL_SHARE * plan.stiffness
    rate = settle_plan.damping_rate(normal, settle_plan.sphere_mass(plan.smallest, plan.density), plan.restitution)
    wall = f"hooke/history {normal!r} {tangential!r} {rate!r} {rate / 2!r} {plan.wall_friction!r} 1 region"
    script, changed = re.subn(r"granular hooke .*? region", wall, settle_plan.settle_script(plan))
    if changed != 1:
        raise RuntimeError("the settling script has another wall than this benchmark knows")
    return script


def row(seed: int, legacy: bool) -> list[float]:
    kept = Path(f"results/settled_{'legacy_' if legacy else ''}{seed}.h5")
    if not kept.exists():
        kept.parent.mkdir(exist_ok=True)
        settling.settle_script = legacy_script if legacy else settle_plan.settle_script
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--legacy-wall", action="store_true")
    arguments = parser.parse_args()
    print("seed " + "".join(f"{name:>10}" for name in COLUMNS))
    rows = []
    for seed in range(1, 1 + arguments.seeds):
        rows.append(row(seed, arguments.legacy_wall))
        print(f"{seed:>4} " + "".join(f"{x:>10.4f}" for x in rows[-1]), flush=True)
    print("mean " + "".join(f"{x:>10.4f}" for x in np.mean(rows, axis=0)))
    print("s.d. " + "".join(f"{x:>10.4f}" for x in np.std(rows, axis=0, ddof=1)))


if __name__ == "__main__":
    main()
