"""The whole way from Python: settle a bed, cut it, measure it, trace it, and turn the numbers into heat.

python examples/python_interface.py
"""

from __future__ import annotations

import bedrad
from bedrad import heat

WALL_TEMPERATURE = 1123.15  # [K]


def main() -> tuple[bedrad.Packing, float]:
    wall = bedrad.Tube(radius=2.4e-3)
    packing = bedrad.settle(wall, diameter=600e-6, height=8.4e-3, seed=1)
    edges = bedrad.layer_edges(packing, layers=3)
    stats = bedrad.statistics(packing, edges=edges, contact_gap=1e-2)
    factors = bedrad.view_factors(packing, edges=edges, tolerance=1e-3, seed=0)
    print(stats, factors, sep="\n\n")

    ratio = 2 * wall.radius / packing.mean_diameter
    k_wa = heat.wall_layer.conductivity(
        heat.gas.air_conductivity(WALL_TEMPERATURE), 2.1, ratio, packing.mean_diameter,
        stats.contacts_per_area, stats.packing_fraction, stats.nc_distance_closing, form="general",
    )  # fmt: skip
    k_rad = heat.radiation.conductivity(factors.layers, packing.mean_diameter, WALL_TEMPERATURE)
    print(f"\nwall layer at {WALL_TEMPERATURE:g} K: k_wa {k_wa:.4f}, k_rad {k_rad:.4f} W/(m K)")
    return packing, float(k_wa + k_rad)


if __name__ == "__main__":
    main()
