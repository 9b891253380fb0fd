"""Why a faster flow takes less heat from its wall: contacts or packing? (Watkins 2018, figure 3.10)

python examples/gallery/wall_layer_velocity.py

The wall layer's conductivity against velocity at A = 17.2, once as the correlations have it, once with the contacts or
the packing fraction of the slowest flow, and once with every particle of the layer in contact (a = 0).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.heat import correlations, gas, materials, wall_layer
from bedrad.heat.ranges import FloatArray
from bedrad.report import style

TUBE, DIAMETER = 7.75e-3, 450e-6
A = TUBE / DIAMETER
TEMPERATURE = 378.15
VELOCITIES = np.linspace(0.002, 0.25, 125)


def main(figure: Path = Path("wall_layer_velocity.png")) -> dict[str, FloatArray]:
    k_g, k_s = gas.air_conductivity(TEMPERATURE), materials.ZIRCONIA_SILICA.solid_conductivity
    phi = correlations.packing_fraction(A, VELOCITIES, DIAMETER)
    contacts = correlations.contact_ratio(A, VELOCITIES, DIAMETER) * correlations.maximum_contacts(A, DIAMETER)
    # half spheres of the slowest flow's contacts alone would be more than a fast flow has in its layer
    room = phi * (1.0 - 0.5 / A) / (2.0 * np.pi / 3.0) / (0.5 * DIAMETER) ** 2
    slow = np.where(contacts[0] <= room, contacts[0], np.nan)
    fits = np.isfinite(slow)
    curves = {
        "contacts and packing vary": wall_layer.conductivity(k_g, k_s, A, DIAMETER, contacts, phi),
        "contacts of the slowest flow": np.full(VELOCITIES.shape, np.nan),
        "packing of the slowest flow": wall_layer.conductivity(k_g, k_s, A, DIAMETER, contacts, phi[0]),
        "all particles in contact, $a$ = 0": wall_layer.conductivity(
            k_g, k_s, A, DIAMETER, contacts, phi, 0.0, form="general"
        ),
    }
    curves["contacts of the slowest flow"][fits] = wall_layer.conductivity(k_g, k_s, A, DIAMETER, slow[fits], phi[fits])
    first, kept, packed, touching = curves.values()
    print(f"k_wa from {first[0]:.4f} to {first[-1]:.4f} W/(m K), {100 * (first[-1] / first[0] - 1):+.0f} %")
    print(f"with the packing of the slowest flow {100 * (packed[-1] / packed[0] - 1):+.0f} %")
    print(f"with its contacts {100 * (kept[fits][-1] / kept[0] - 1):+.0f} % up to {VELOCITIES[fits][-1]:.2f} m/s")
    print(f"all in contact: {100 * (touching / first - 1).max():.0f} % more at most")
    draw(curves, figure)
    return curves


def draw(curves: dict[str, FloatArray], path: Path) -> None:
    with style.styled():
        figure = style.new_figure(6.2, 4.2)
        axes = figure.subplots()
        for color, marker, (label, values) in zip(style.COLOURS, style.MARKERS, curves.items(), strict=False):
            axes.plot(VELOCITIES, values, color=color, marker=marker, markevery=15, label=label)
        axes.set(xlabel="Mean velocity $U$ [m/s]", ylabel="$k_\\mathregular{wa}$ [W/(m K)]", xlim=(0, 0.25))
        axes.set_ylim(0.09, None)
        axes.legend(loc="lower left")
        style.save(figure, path, "Conductivity of the wall layer against velocity")


if __name__ == "__main__":
    main()
