"""Heat from one wall of a chute to a dense flow: how thick the layer of gas at the wall is, and what it costs.

Draws the model curves of figures 4.4 and 4.5 of Watkins (2018): Nusselt number against Peclet number for glass beads of
0.33 and 1.35 mm past short heated walls, and of 3 mm past a wall of 1 m, each with the gas layer that the
conductivity of the wall-adjacent layer stands for and with the 0.085 diameters fitted by Sullivan and Sabersky (1975);
and what the form of the source, resistances in series, loses against the exact solution. The source gives neither the
chutes nor the glass: perimeter and conductivity here are assumptions, named below.

python examples/gallery/chute.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bedrad.heat import bulk, chute
from bedrad.report import style

AIR, GLASS = 0.026, 1.0  # [W/(m K)]
POROSITY = 0.40
CAPACITY = (1.0 - POROSITY) * 2500.0 * 800.0  # of the bed [J/(m3 K)]
PERIMETER = 0.13  # of the chute of figure 4.4 [m]
BULK = float(bulk.zehner_bauer_schluender(AIR, GLASS, POROSITY, 1e-3, 300.0, radiation=False))


def gap(diameter: float, perimeter: float, velocity: Any) -> Any:
    """The gas layer that the wall-adjacent layer stands for. [particle diameters]"""
    ratio = chute.modified_diameter_ratio(perimeter, diameter)
    k_wa = chute.wall_layer_conductivity(AIR, GLASS, ratio, diameter, velocity, warn=False)
    return chute.gap_ratio(AIR, k_wa, BULK)


def short_walls(axes: Any) -> dict[float, float]:
    """Figure 4.4: two sizes of beads, two heated lengths each."""
    gaps = {}
    peclet = np.geomspace(30, 3e4, 200)
    for k, diameter in enumerate((0.33e-3, 1.35e-3)):
        for length, width in ((6e-3, 1.0), (25e-3, 2.0)):
            velocity = peclet * BULK / CAPACITY / length
            slow = velocity < 0.25
            chi = gap(diameter, PERIMETER, velocity[slow])
            inputs = diameter, length, BULK, AIR
            axes.loglog(
                peclet[slow], chute.nusselt_in_series(peclet[slow], chi, *inputs), color=style.COLOURS[k], lw=width,
                label=f"{1e3 * diameter:.2f} mm, L = {1e3 * length:.0f} mm",
            )  # fmt: skip
            fitted = chute.nusselt_in_series(peclet, chute.SULLIVAN_SABERSKY_GAP, *inputs)
            axes.loglog(peclet, fitted, "--", color=style.COLOURS[k], lw=width)
        gaps[diameter] = float(gap(diameter, PERIMETER, 0.01))
    axes.loglog(peclet, 2.0 * np.sqrt(peclet / np.pi), ":", color=style.GREY, label="no gas layer")
    axes.set_title("Short heated walls")
    axes.set_xlabel("Peclet number $U L/\\alpha_b$")
    axes.set_ylabel("mean Nusselt number $h L/k_b$")
    axes.legend(title="solid: by $k_{wa}$, dashed: 0.085 d", title_fontsize=8.5)
    return gaps


def long_wall(axes: Any) -> float:
    """Figure 4.5: 3 mm beads, 1 m; the velocity at which more flow stops to help, for a chute of A_m = 11."""
    velocity = np.linspace(2e-3, 0.25, 400)
    peclet = chute.peclet_number(velocity, 1.0, BULK / CAPACITY)
    inputs = 3e-3, 1.0, BULK, AIR
    best = 0.0
    for k, ratio in enumerate((9.0, 11.0, 20.0)):
        chi = gap(3e-3, 4.0 * ratio * 3e-3, velocity)
        nusselt = chute.nusselt_in_series(peclet, chi, *inputs)
        axes.plot(100 * velocity, nusselt, color=style.COLOURS[k], label=f"by $k_{{wa}}$, $A_m$ = {ratio:.0f}")
        if ratio == 11.0:
            best = float(velocity[np.argmax(nusselt)])
    fitted = chute.nusselt_in_series(peclet, chute.SULLIVAN_SABERSKY_GAP, *inputs)
    axes.plot(100 * velocity, fitted, "--", color="black", label="gas layer of 0.085 d")
    axes.axvline(9.0, color=style.GREY, lw=0.8)
    axes.annotate(
        "both meet the data\nof the source up to here", (9.0, 0.04), xycoords=("data", "axes fraction"),
        xytext=(4, 0), textcoords="offset points", fontsize=8.5, color=style.GREY,
    )  # fmt: skip
    axes.set_title("Beads of 3 mm, wall of 1 m")
    axes.set_xlabel("velocity [cm/s]")
    axes.set_ylabel("mean Nusselt number $h L/k_b$")
    axes.set_ylim(0, None)
    axes.legend()
    return best


def difference(axes: Any) -> float:
    """What eq. 43 loses against the exact solution."""
    B = np.geomspace(1e-2, 1e3, 400)
    error = chute.in_series_error(B)
    local = chute.local_in_series(B) / chute.local_half_space(B) - 1.0
    axes.semilogx(B, 100 * error, color=style.COLOURS[0], label="mean coefficient")
    axes.semilogx(B, 100 * local, color=style.COLOURS[1], label="local coefficient")
    axes.set_title("Resistances in series against exact")
    axes.set_xlabel("$B = h_c \\sqrt{\\alpha_b L/U}/k_b$")
    axes.set_ylabel("relative error [%]")
    axes.legend(loc="lower right")
    return float(error.min())


def main(figure: Path = Path("chute.png")) -> tuple[dict[float, float], float, float]:
    with style.styled():
        page = style.new_figure(12.0, 4.2)
        axes = page.subplots(1, 3)
        gaps, best, worst = short_walls(axes[0]), long_wall(axes[1]), difference(axes[2])
        style.save(page, figure, "Heat transfer to a dense flow in a chute")
    for diameter, chi in gaps.items():
        print(f"{1e3 * diameter:.2f} mm beads: gas layer of {chi:.3f} diameters (fitted: 0.085)")
    print(f"3 mm beads in a chute of A_m 11: best at {100 * best:.0f} cm/s")
    print(f"resistances in series: at most {-100 * worst:.2f} % too little heat")
    return gaps, best, worst


if __name__ == "__main__":
    main()
