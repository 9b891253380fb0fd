"""What a cell of two plates measures on a bed of particles, and how to get the conductivity of the bulk out of it.

Draws the model curves of figure 4.6 of Watkins (2018): total conductivity of a bed between two plates against its
thickness for the four kinds of particles of Table 2.4, the wall layers by the correlations at rest. The source prints
neither thicknesses nor measured values nor the plates; the plates here are 50 mm wide, at 50 degrees Celsius. Then it
measures: three beds, each 3 % uncertain, the line through their resistances (eq. 11), and what it says of bulk and wall
layer. Last, the uncertainty of the bulk against the thickest of the three beds.

python examples/gallery/static_bed_cell.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bedrad.heat import bulk, chute, static_bed
from bedrad.heat.gas import air_conductivity
from bedrad.report import style

TEMPERATURE = 323.15  # [K]
PLATE = 50e-3  # diameter [m]
SOLID = {"zirconia-silica": 2.1, "alumina-silicate": 1.76}  # [W/(m K)]
MEASURED = np.array([3e-3, 6e-3, 12e-3])  # [m]
ERROR = 0.03  # of each measured conductivity
WORST = bulk.TABLE_2_4[2]


def cell(fit: bulk.BulkFit, thickness: Any) -> tuple[Any, Any]:
    """Conductivity of the wall layers and of the whole bed. [W/(m K)]"""
    d = fit.particle_diameter
    ratio = static_bed.cell_diameter_ratio(thickness, PLATE, d)
    k_wa = chute.wall_layer_conductivity(air_conductivity(TEMPERATURE), SOLID[fit.material], ratio, d, 0.0, warn=False)
    return k_wa, static_bed.total_conductivity(thickness, d, k_wa, fit.conductivity(TEMPERATURE))


def curves(axes: Any) -> None:
    thickness = np.linspace(1e-3, 20e-3, 200)
    for k, fit in enumerate(bulk.TABLE_2_4):
        label = f"{1e6 * fit.particle_diameter:.0f} µm {fit.material}"
        axes.plot(1e3 * thickness, cell(fit, thickness)[1], color=style.COLOURS[k], label=label)
        axes.plot(1e3 * MEASURED, cell(fit, MEASURED)[1], style.MARKERS[k], color=style.COLOURS[k])
        axes.axhline(fit.conductivity(TEMPERATURE), color=style.COLOURS[k], ls=":", lw=1.2)
    axes.set_title("Total conductivity (dotted: bulk)")
    axes.set_xlabel("thickness of the bed [mm]")
    axes.set_ylabel("$k_{total}$ [W/(m K)]")
    axes.set_ylim(0.15, 0.31)
    axes.legend(loc="lower right")


def regression(axes: Any) -> static_bed.PlateCellFit:
    d = WORST.particle_diameter
    total = cell(WORST, MEASURED)[1]
    noisy = total * (1.0 + ERROR * np.array([0.5, -1.0, 0.6]))
    found = static_bed.fit_plate_cell(MEASURED, noisy, d, ERROR * total)
    resistance = MEASURED / noisy
    axes.errorbar(
        1e3 * MEASURED, 1e3 * resistance, 1e3 * ERROR * resistance, fmt="o", color=style.COLOURS[2], capsize=3,
        label="measured, 3 %",
    )  # fmt: skip
    t = np.array([d, 14e-3])
    line = d * found.wall_layer_resistivity + (t - d) / found.bulk_conductivity
    axes.plot(1e3 * t, 1e3 * line, color=style.COLOURS[2], label="line through them")
    axes.plot(1e3 * t, 1e3 * t / WORST.conductivity(TEMPERATURE), ":", color=style.GREY, label="bulk alone")
    both = (
        f"$k_b$ = {found.bulk_conductivity:.3f} ± {found.bulk_error:.3f} W/(m K)\n"
        f"$k_{{wa}}$ = {found.wall_layer_conductivity:.3f} ± {found.wall_layer_error:.3f} W/(m K)"
    )
    axes.text(0.97, 0.06, both, transform=axes.transAxes, ha="right")
    axes.set_title(f"Line of resistances, {1e6 * d:.0f} µm")
    axes.set_xlabel("thickness of the bed [mm]")
    axes.set_ylabel("$t/k_{total}$ [10$^{-3}$ m$^2$ K/W]")
    axes.set_xlim(0, None)
    axes.set_ylim(0, None)
    axes.legend()
    return found


def planning(axes: Any) -> float:
    """Relative standard errors against the thickest bed; the one of the bulk for 12 mm."""
    d = WORST.particle_diameter
    thickest = np.linspace(4e-3, 30e-3, 60)
    errors = []
    for last in thickest:
        t = np.array([3e-3, np.sqrt(3e-3 * last), last])
        total = cell(WORST, t)[1]
        fit = static_bed.fit_plate_cell(t, total, d, ERROR * total)
        errors.append((fit.bulk_error / fit.bulk_conductivity, fit.wall_layer_error / fit.wall_layer_conductivity))
    shares = np.array(errors)
    for k, name in enumerate(("bulk", "wall layer")):
        axes.semilogy(1e3 * thickest, 100 * shares[:, k], color=style.COLOURS[k], label=name)
    axes.set_yticks([3, 5, 10, 20, 50], ["3", "5", "10", "20", "50"])
    axes.minorticks_off()
    axes.set_title("Three beds, the thinnest 3 mm")
    axes.set_xlabel("thickest bed [mm]")
    axes.set_ylabel("standard error [%]")
    axes.legend()
    return float(np.interp(12e-3, thickest, shares[:, 0]))


def main(figure: Path = Path("static_bed_cell.png")) -> tuple[static_bed.PlateCellFit, float]:
    with style.styled():
        page = style.new_figure(12.0, 4.2)
        axes = page.subplots(1, 3)
        curves(axes[0])
        found = regression(axes[1])
        error = planning(axes[2])
        style.save(page, figure, "Static bed between two plates")
    print(f"bulk as put in: {WORST.conductivity(TEMPERATURE):.4f} W/(m K); out of three beds:\n{found}")
    print(f"three beds from 3 to 12 mm, 3 % each: bulk within {100 * error:.1f} %")
    return found, error


if __name__ == "__main__":
    main()
