"""Nusselt numbers of the flows measured cold, developed and developing (Watkins 2018, figures 4.1 and 4.2).

python examples/gallery/cold_flows.py

The five systems of Table 2.1 between the velocities whose profiles the source shows, 0.015 and 0.047 m/s, at its
two stations 0.64 and 1.26 m below the inlet, properties at the mean temperature of 105 degC: the two-layer model
for the developed flow and the complete solution. The bands are the 95 % that the source gives the bulk
conductivity, 11 %.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.heat import bulk, correlations, gas, materials, two_layer, wall_layer
from bedrad.heat.materials import Material
from bedrad.heat.ranges import FloatArray
from bedrad.report import style

TEMPERATURE = 378.15
STATIONS = (0.64, 1.26)
TICKS = (0.03, 0.05, 0.1, 0.2, 0.3)
VELOCITIES = np.geomspace(0.015, 0.047, 33)
SYSTEMS: dict[int, tuple[float, float, Material]] = {
    1: (54.4, 140e-6, materials.ZIRCONIA_SILICA),
    2: (28.2, 270e-6, materials.ZIRCONIA_SILICA),
    3: (23.8, 320e-6, materials.ZIRCONIA_SILICA),
    4: (22.4, 340e-6, materials.ALUMINA_SILICATE),
    5: (40.1, 270e-6, materials.ZIRCONIA_SILICA),
}
"""Tube over particle diameter, particle diameter [m] and material of the configurations of Table 2.1."""

Curve = dict[str, FloatArray]


def curve(A: float, d: float, material: Material, spread: float = 1.0) -> Curve:
    """z*, developed and complete Nusselt number along the velocities, stations by rows."""
    k_b = spread * float(bulk.measured(TEMPERATURE, d, material.name, table="2.4"))
    phi = correlations.packing_fraction(A, VELOCITIES, d, warn=False)
    contacts = correlations.contact_ratio(A, VELOCITIES, d, warn=False) * correlations.maximum_contacts(A, d)
    k_wa = wall_layer.conductivity(gas.air_conductivity(TEMPERATURE), material.solid_conductivity, A, d, contacts, phi)
    z_star = two_layer.inverse_graetz(
        np.array(STATIONS)[:, None],
        k_b,
        material.bulk_density * VELOCITIES,
        material.specific_heat(TEMPERATURE),
        A * d,
    )
    kappa = np.broadcast_to(k_b / k_wa, z_star.shape)
    return {
        "z_star": z_star,
        "developed": two_layer.nusselt_developed(A, kappa),
        "complete": two_layer.nusselt(A, kappa, z_star),
    }


def main(figure: Path = Path("cold_flows.png")) -> dict[int, Curve]:
    curves = {number: curve(*system) for number, system in SYSTEMS.items()}
    for number, found in curves.items():
        excess = found["complete"] / found["developed"] - 1.0
        A, d, material = SYSTEMS[number]
        print(
            f"{number}: A {A}, {1e6 * d:.0f} um {material.name}: z* {found['z_star'].min():.3f} to "
            f"{found['z_star'].max():.2f}, Nu {found['complete'].min():.2f} to {found['complete'].max():.2f}, "
            f"developing up to {100 * excess.max():.1f} % above developed"
        )
    draw(curves, figure)
    return curves


def draw(curves: dict[int, Curve], path: Path) -> None:
    with style.styled():
        figure = style.new_figure(9.6, 6.0)
        axes = figure.subplots(2, 3, sharex=True, sharey=True)
        for (number, found), where, color in zip(curves.items(), axes.flat, style.COLOURS, strict=False):
            A, d, material = SYSTEMS[number]
            low, high = (curve(A, d, material, 1.0 + sign * 0.11) for sign in (-1, 1))
            # both stations lie on one curve but for the velocity that belongs to a z*
            for row, (station, line) in enumerate(zip(STATIONS, ("-", "--"), strict=True)):
                where.plot(found["z_star"][row], found["complete"][row], line, color=color,
                           label=f"complete, $z$ = {station} m")  # fmt: skip
                where.fill_between(found["z_star"][row], low["complete"][row], high["complete"][row], color=color,
                                   alpha=0.15, linewidth=0)  # fmt: skip
                where.plot(found["z_star"][row], found["developed"][row], ":", color=style.GREY,
                           label="developed" if row else None)  # fmt: skip
            where.axvline(0.08, color=style.GREY, linewidth=0.8)
            where.set_title(f"{number}: $A$ {A}, {1e6 * d:.0f} µm {material.name}")
            where.set_xscale("log")
            where.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
            where.minorticks_off()
            where.legend(loc="lower right")
        axes[0, 0].set_ylim(4, 8)
        axes.flat[-1].set_axis_off()
        for where in (axes[1, 0], axes[1, 1], axes[0, 2]):
            where.set_xlabel("Inverse Graetz number $z^*$")
            where.tick_params(labelbottom=True)
        for where in axes[:, 0]:
            where.set_ylabel("Nusselt number $hD/k_\\mathregular{b}$")
        style.save(figure, path, "Nusselt numbers of the flows measured cold")


if __name__ == "__main__":
    main()
