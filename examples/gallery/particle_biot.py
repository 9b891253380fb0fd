"""When is a particle at one temperature? The error of the isothermal particle against its Biot number.

A sphere is heated from a wall through its fluid lens, with the conduction inside it resolved. The figure shows how much
an isothermal particle overstates the heat rate, by three measures, and the temperature on the surface of a glass and a
steel sphere of 0.5 mm when the isothermal particle would have come within 1/e of the wall.

python examples/gallery/particle_biot.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.heat import fluid_lens, particle_transient
from bedrad.report import style

DIAMETER, ASPERITY = 500e-6, 117e-9  # of the glass spheres of Adepu et al. [m]
GAS, GLASS, STEEL = 0.0277, 1.1, 46.6  # [W/(m K)]
MEASURES = {
    "rate": "heat rate, mean over $\\tau$ (Adepu et al., eq. 14)",
    "heat": "heat taken up in $\\tau$",
    "resistance": "resistance to the mean temperature",
}
GAP = ASPERITY / (0.5 * DIAMETER)  # as the source has it: the gap is the asperities' height [particle radii]


def draw_errors(axes, biot: np.ndarray, errors: np.ndarray, critical: float) -> None:
    for error, text, color, marker in zip(errors, MEASURES.values(), style.COLOURS, style.MARKERS, strict=False):
        axes.plot(biot, 100 * error, color=color, marker=marker, markevery=2, label=text)
    axes.axhline(10, color=style.GREY, linewidth=0.8)
    axes.plot([0.015], [10], "X", color="black", markersize=7, zorder=4)
    axes.annotate("Adepu et al.:\nBi 0.015", (0.015, 10), (0, 7), textcoords="offset points", ha="center")
    axes.plot([critical], [10], "o", color="black", zorder=4)
    axes.annotate(f"here: Bi {critical:.3f}", (critical, 10), (6, -13), textcoords="offset points")
    axes.set(xscale="log", xlabel="Biot number $h r/k_s$", ylabel="Isothermal particle too high by [%]", ylim=(0, 100))
    axes.set_title("Error of the isothermal particle")
    axes.legend(loc="upper left")


def draw_surfaces(axes, spheres: dict[str, particle_transient.ParticleTransient]) -> None:
    angle = np.linspace(0, 180, 361)
    for (name, sphere), color in zip(spheres.items(), style.COLOURS, strict=False):
        for times, line in ((0.1, ":"), (1.0, "-")):
            surface = sphere.temperature(times * sphere.time_constant, 1.0, np.cos(np.radians(angle)))
            label = f"{name}, Bi {sphere.biot:.2g}, $t = {times:g}\\,\\tau$"
            axes.plot(angle, surface, line, color=color, label=label)
    axes.set(xlabel="Angle from the point nearest to the wall [°]", ylabel="Surface temperature, $(T-T_0)/(T_w-T_0)$")
    axes.set(ylim=(0, 1.15), xticks=range(0, 181, 45), title="Surface of a sphere of 0.5 mm")
    axes.legend(ncols=2, loc="upper center")


def main(figure: Path = Path("particle_biot.png"), points: int = 21, modes: int = 120) -> dict[str, float]:
    biot = np.logspace(-3, 2, points)
    heated = [particle_transient.heated_through_lens(b, GAP, GAP, modes=modes) for b in biot]
    errors = np.array([[particle_transient.isothermal_error(x, measure) for x in heated] for measure in MEASURES])
    critical = {m: particle_transient.critical_biot(0.1, GAP, GAP, m, modes=modes) for m in MEASURES}
    for measure, value in critical.items():
        print(f"isothermal particle 10 % too high by {measure}: Bi {value:.4f}")
    spheres = {}
    for name, solid in (("glass", GLASS), ("steel", STEEL)):
        number = float(fluid_lens.biot_number(GAS, solid, DIAMETER, ASPERITY, ASPERITY))
        spheres[name] = particle_transient.heated_through_lens(number, GAP, GAP, modes=modes)
        print(f"{name}: {spheres[name]}")
    with style.styled():
        drawn = style.new_figure(10.5, 4.2)
        left, right = drawn.subplots(1, 2)
        draw_errors(left, biot, errors, critical["rate"])
        draw_surfaces(right, spheres)
        style.save(drawn, figure, "Error of the isothermal particle against the Biot number")
    return critical


if __name__ == "__main__":
    main()
