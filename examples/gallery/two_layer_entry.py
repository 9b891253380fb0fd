"""How a dense flow warms up in a heated tube, by the two-layer model.

Nusselt number along the tube from the first 1e-8 of its Graetz length to the developed flow, temperature profiles,
where the flow counts as developed for any wall layer, and how many terms of the series a figure needs.

    python examples/gallery/two_layer_entry.py      # writes two_layer_entry.png
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bedrad.heat import two_layer
from bedrad.report import style

A = 28.2
"""Tube over particle diameter of the source's example, with k_b/k_wa = 2.5."""

KAPPAS = (0.4, 1.0, 2.5, 10.0)
SHARE = 0.05


def nusselt_along_the_tube(axes: Any) -> None:
    z_star = np.geomspace(1e-7, 1, 160)
    for kappa, colour, marker in zip(KAPPAS, style.COLOURS, style.MARKERS, strict=False):
        Nu = two_layer.nusselt(A, kappa, z_star)
        axes.loglog(z_star, Nu, color=colour, marker=marker, markevery=20, label=f"{kappa:g}")
        near = z_star[z_star < 3e-3]
        axes.loglog(near, 0.5 * np.sqrt(np.pi / (kappa * near)), color=colour, linestyle=":", linewidth=1.0)
    axes.axvline(0.08, ymax=0.75, color=style.GREY, linewidth=0.8, linestyle="--")
    axes.annotate("z* = 0.08", (0.08, 50), xytext=(-4, 0), textcoords="offset points", ha="right", color=style.GREY)
    axes.set(xlabel="inverse Graetz number z*", ylabel="Nu = h D/k$_b$", title=f"Nusselt number, D/d = {A:g}")
    axes.legend(title="k$_b$/k$_{wa}$ (dotted: half space)", ncols=2, loc="upper right")


def profiles(axes: Any) -> None:
    r = np.unique(np.concatenate([np.linspace(0, 1, 121), np.linspace(0.9, 1, 101)]))
    for z_star, colour, marker in zip((1e-3, 0.01, 0.03, 0.08), style.COLOURS, style.MARKERS, strict=False):
        rise = two_layer.temperature_rise(r, A, 2.5, z_star)
        axes.plot(r, rise, color=colour, marker=marker, markevery=20, label=f"{z_star:g}")
    axes.axvspan(1 - 1 / A, 1, color="#F0F2F5", zorder=0)
    axes.annotate("wall layer", (0.955, 0.48), ha="right", va="center", color=style.GREY, fontsize=8.5)
    axes.set(
        xlabel="radius r/R", ylabel="(T − T$_{in}$) k$_b$/(q D)", xlim=(0, 1), ylim=(0, 0.5),
        title="Temperature, k$_b$/k$_{wa}$ = 2.5",
    )  # fmt: skip
    axes.legend(title="z*", loc="upper left")


def map_of_development(figure: Any, axes: Any) -> np.ndarray:
    ratios, kappas = np.geomspace(1.5, 300, 25), np.geomspace(0.01, 100, 25)
    z_star = two_layer.developed_z_star(ratios, kappas[:, None], SHARE)
    levels = 10.0 ** np.arange(-2.25, 0.76, 0.25)
    shades = axes.contourf(ratios, kappas, z_star, levels=levels, cmap="cividis", norm="log")
    lines = axes.contour(ratios, kappas, z_star, levels=[0.08, 0.3, 1.0], colors="white")
    axes.clabel(lines, fmt="%g", fontsize=8.5, inline_spacing=1)
    axes.plot(A, 2.5, "o", color="white", markeredgecolor="black")
    axes.set(
        xscale="log", yscale="log", xlabel="tube over particle diameter D/d", ylabel="k$_b$/k$_{wa}$",
        title=f"z* where Nu is within {SHARE:.0%} of developed",
    )  # fmt: skip
    axes.grid(visible=False)
    bar = figure.colorbar(shades, ax=axes, label="z*", ticks=[0.01, 0.03, 0.1, 0.3, 1, 3], format="%g")
    bar.ax.minorticks_off()
    return z_star


def error_against_terms(axes: Any) -> None:
    terms = np.arange(1, 41)
    for z_star, colour, marker in zip((1e-4, 1e-3, 1e-2, 0.05), style.COLOURS, style.MARKERS, strict=False):
        exact = two_layer.nusselt(A, 2.5, z_star, tolerance=1e-12)
        cut = [two_layer.nusselt_series(A, 2.5, z_star, int(n)) for n in terms]
        error = np.array([abs(c.nusselt / exact - 1) for c in cut])
        shown = error > 1e-12
        axes.semilogy(terms[shown], error[shown], marker, color=colour, label=f"{z_star:g}", markersize=3.5)
        axes.semilogy(terms, [c.error_bound for c in cut], color=colour, linewidth=0.9)
    axes.set(xlabel="terms of the series", ylabel="relative error of Nu", ylim=(1e-12, 10))
    axes.set_title("Error (points) and its stated bound (lines)")
    axes.legend(title="z*", loc="lower right")


def main(figure: Path = Path("two_layer_entry.png")) -> dict[str, float]:
    with style.styled():
        drawing = style.new_figure(9.0, 7.2)
        (a, b), (c, d) = drawing.subplots(2, 2)
        nusselt_along_the_tube(a)
        profiles(b)
        z_star = map_of_development(drawing, c)
        error_against_terms(d)
        style.save(drawing, figure, "Thermal entry of a dense flow by the two-layer model")
    excess = float(two_layer.nusselt(A, 2.5, 0.08) / two_layer.nusselt_developed(A, 2.5) - 1)
    numbers = {
        "excess at z* = 0.08": excess,
        "developed z*": float(two_layer.developed_z_star(A, 2.5, SHARE)),
        "earliest": float(z_star.min()),
        "latest": float(z_star.max()),
    }
    print(f"D/d {A:g}, k_b/k_wa 2.5: Nu at z* = 0.08 exceeds the developed one by {excess:.2%};")
    print(f"within {SHARE:.0%} of it from z* = {numbers['developed z*']:.4f} on")
    print(f"over the map: from z* = {numbers['earliest']:.3g} to {numbers['latest']:.3g}; figure in {figure}")
    return numbers


if __name__ == "__main__":
    main()
