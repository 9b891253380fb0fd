"""A slurry of polystyrene and water in a heated pipe: Nusselt number, regime, and the bottom wall under clusters.

For the pipe of Scelzo et al. (30 mm, spheres of 0.35 and 0.85 mm): their correlation beside the earlier ones of their
Table 1, each thick within its range of Reynolds numbers (tested flows shaded); the modified Froude number against its
limit of 10, above which all particles are suspended; and what the renewal of clusters adds at the bottom wall, which
rests on how long a cluster stays there: D/U, the 0.2 s of the text, or 1 m over U, its formula taken by number.

python examples/gallery/slurry_pipe.py
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.heat import RangeWarning, slurry
from bedrad.heat.slurry import POLYSTYRENE, WATER
from bedrad.report import style

PIPE = 0.03  # [m]
SIZES = (0.35e-3, 0.85e-3)  # [m]
BETA = POLYSTYRENE.density / WATER.density
ALPHA = 0.03
TESTED = (4500.0, 14000.0)


def velocity(reynolds: Any) -> Any:
    return reynolds * WATER.viscosity / (WATER.density * PIPE)


def correlations(axes: Any) -> dict[str, float]:
    """Nusselt numbers against Reynolds number, 0.35 mm; those at Re 10000."""
    Re, Pr, ratio = np.geomspace(2e3, 2e5, 300), WATER.prandtl, PIPE / SIZES[0]
    curves = {
        "Scelzo et al., eq. 16": ((3e3, 140e3), lambda x: slurry.nusselt_scelzo(x, Pr, ratio, ALPHA, BETA)),
        "Harada et al.": ((8e3, 50e3), lambda x: slurry.nusselt_harada(x, Pr)),
        "Ku et al.": ((3e3, 11e3), lambda x: slurry.nusselt_ku(x, Pr, ratio)),
        "Ozbelge and Somer": ((27e3, 120e3), lambda x: slurry.nusselt_ozbelge_somer(x, Pr, ratio)),
        "liquid, Dittus and Boelter": ((1e4, 120e3), lambda x: slurry.nusselt_dittus_boelter(x, Pr)),
    }
    for k, (name, ((low, high), nusselt)) in enumerate(curves.items()):
        inside = (Re >= low) & (Re <= high)
        axes.loglog(Re, nusselt(Re), ":", color=style.COLOURS[k], lw=1.0)
        axes.loglog(Re[inside], nusselt(Re[inside]), color=style.COLOURS[k], lw=2.2, label=name)
    axes.axvspan(*TESTED, color="#F0F2F5", zorder=0, linewidth=0)
    axes.set_title("Nusselt number, 0.35 mm, $\\alpha$ = 3 %")
    axes.set_xlabel("Reynolds number of the liquid")
    axes.set_ylabel("$h D/k$")
    axes.legend()
    return {name: float(nusselt(1e4)) for name, (_, nusselt) in curves.items()}


def regimes(axes: Any) -> list[float]:
    """Modified Froude number against Reynolds number; where it is 10."""
    Re = np.linspace(3e3, 15e3, 200)
    limits = []
    for k, d in enumerate(SIZES):
        froude = slurry.modified_froude(velocity(Re), d, ALPHA, BETA)
        axes.semilogy(Re / 1e3, froude, color=style.COLOURS[k], label=f"{1e3 * d:.2f} mm")
        limit = float(slurry.suspension_velocity(d, ALPHA, BETA)) * WATER.density * PIPE / WATER.viscosity
        axes.semilogy([limit / 1e3], [slurry.SUSPENSION_FROUDE], style.MARKERS[k], color=style.COLOURS[k])
        limits.append(limit)
    axes.axhline(slurry.SUSPENSION_FROUDE, color=style.GREY, lw=1.0)
    axes.axvspan(TESTED[0] / 1e3, TESTED[1] / 1e3, color="#F0F2F5", zorder=0, linewidth=0)
    axes.text(15.0, 10.7, "all suspended", ha="right", color=style.GREY, fontsize=8.5)
    axes.text(15.0, 9.3, "a bed may move\nalong the bottom", ha="right", va="top", color=style.GREY, fontsize=8.5)
    axes.set_yticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
    axes.minorticks_off()
    axes.set_title("Regime")
    axes.set_xlabel("Reynolds number of the liquid / 1000")
    axes.set_ylabel("modified Froude number $Fr^*$")
    axes.legend()
    return limits


def bottom_wall(axes: Any) -> tuple[float, float]:
    """Enhancement at the bottom against the volume fraction there; at 5 % and the lowest Re for both times."""
    alpha = np.linspace(1e-4, 0.3, 400)
    at_5_percent = []
    for k, Re in enumerate(TESTED):
        U = velocity(Re)
        for time, line, text in ((None, "-", "t = D/U"), (1.0 / U, "--", "t = 1 m/U")):
            result = slurry.cluster_model(U, PIPE, SIZES[1], alpha, POLYSTYRENE, WATER, time=time)
            axes.plot(
                100 * alpha, result.enhancement, line, color=style.COLOURS[k],
                label=f"Re {Re:.0f}, {text} = {PIPE / U if time is None else time:.2g} s",
            )  # fmt: skip
            if k == 0:
                at_5_percent.append(float(np.interp(0.05, alpha, result.enhancement)))
    axes.axvline(100 * slurry.FULL_COVERAGE, color=style.GREY, lw=0.8)
    axes.annotate("wall covered\nfrom here on", (100 * slurry.FULL_COVERAGE, 0.2), xytext=(4, 0), fontsize=8.5,
                  textcoords="offset points", color=style.GREY)  # fmt: skip
    axes.set_title("Bottom wall, 0.85 mm")
    axes.set_xlabel("volume fraction at the bottom [%]")
    axes.set_ylabel("h of the slurry over h of the liquid")
    axes.set_ylim(0, 9)
    axes.legend()
    return at_5_percent[0], at_5_percent[1]


def main(figure: Path = Path("slurry_pipe.png")) -> tuple[dict[str, float], list[float], tuple[float, float]]:
    with style.styled(), warnings.catch_warnings():
        warnings.simplefilter("ignore", RangeWarning)  # what lies outside a range is drawn thin
        page = style.new_figure(12.5, 4.4)
        axes = page.subplots(1, 3)
        nusselt, limits, enhancement = correlations(axes[0]), regimes(axes[1]), bottom_wall(axes[2])
        style.save(page, figure, "Slurry in a heated pipe")
    print("Nusselt numbers at Re 10000:", ", ".join(f"{name} {value:.0f}" for name, value in nusselt.items()))
    for d, limit in zip(SIZES, limits, strict=True):
        print(f"spheres of {1e3 * d:.2f} mm are all suspended above Re {limit:.0f}")
    print(
        f"bottom wall at 5 %, Re 4500: {enhancement[0]:.2f} or {enhancement[1]:.2f} times the liquid, by the time taken"
    )
    return nusselt, limits, enhancement


if __name__ == "__main__":
    main()
