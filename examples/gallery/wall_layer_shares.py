"""What carries the heat through the wall layer: contacts, particles without contact, voids (Watkins 2018, figure 3.9).

python examples/gallery/wall_layer_shares.py

Particles of 0.3 mm in a tube of 7.75 mm at 0.058 m/s; the particles without contact are moved away from the wall, and
their number follows from the packing fraction. Beyond 0.2 radii the layer hardly cares where they are, which is why
the simplified form may take 0.22 for every flow.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.heat import correlations, gas, materials, wall_layer
from bedrad.heat.wall_layer import Contributions
from bedrad.report import style

TUBE, DIAMETER, VELOCITY = 7.75e-3, 300e-6, 0.058
TEMPERATURE = 298.15
DISTANCES = np.linspace(0.0, 0.7, 141)


def main(figure: Path = Path("wall_layer_shares.png")) -> Contributions:
    A = TUBE / DIAMETER
    contacts = correlations.contact_ratio(A, VELOCITY, DIAMETER) * correlations.maximum_contacts(A, DIAMETER)
    parts = wall_layer.contributions(
        gas.air_conductivity(TEMPERATURE),
        materials.ZIRCONIA_SILICA.solid_conductivity,
        A,
        DIAMETER,
        contacts,
        correlations.packing_fraction(A, VELOCITY, DIAMETER),
        DISTANCES,
        form="general",
        warn=False,
    )
    for a in (0.0, 0.22, 0.5):
        k = int(np.argmin(np.abs(DISTANCES - a)))
        whole = parts.conductivity[k] / 100
        print(
            f"a = {a:.2f} r: k_wa {100 * whole:.4f} W/(m K); contacts {parts.contact[k] / whole:.0f} %, "
            f"no contact {parts.no_contact[k] / whole:.0f} %, voids {parts.void[k] / whole:.0f} %"
        )
    draw(parts, figure)
    return parts


def draw(parts: Contributions, path: Path) -> None:
    with style.styled():
        figure = style.new_figure(6.2, 4.4)
        axes = figure.subplots()
        curves = {
            "wall layer": (parts.conductivity, "-"),
            "particles in contact": (np.broadcast_to(parts.contact, DISTANCES.shape), "--"),
            "particles without contact": (parts.no_contact, "-."),
            "voids": (parts.void, ":"),
        }
        for color, (label, (values, line)) in zip(style.COLOURS, curves.items(), strict=False):
            axes.plot(DISTANCES, values, line, color=color, label=label)
        axes.axvline(wall_layer.NC_DISTANCE, color=style.GREY, linewidth=0.8)
        axes.annotate("taken as constant", (wall_layer.NC_DISTANCE, 0.097), xytext=(4, 0), textcoords="offset points",
                      fontsize=8.5, color=style.GREY)  # fmt: skip
        axes.set(xlabel="Distance of particles without contact $a$ [radii]", ylabel="Conductivity [W/(m K)]")
        axes.set(xlim=(0, DISTANCES[-1]), ylim=(0, None))
        axes.legend(loc="upper right", bbox_to_anchor=(1.0, 0.6))
        style.save(figure, path, "Shares of the wall layer's conductivity")


if __name__ == "__main__":
    main()
