"""Heat from a hot plate into a bed of glass through the gas: fluid lenses, Watkins' layer, and what parts them.

A bed of the smallest glass spheres of Adepu et al. settles on the floor of a tube (LAMMPS, half a minute), and each
sphere near the floor takes up heat through its gap. The figure shows the conductance of one sphere against its gap, and
the way from the coefficient by Rong and Horio to k_wa/r by Watkins, for glass and for steel in the same places.

python examples/gallery/fluid_lens.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import bedrad
from bedrad.heat import bulk, fluid_lens, lens_and_layer, wall_lenses
from bedrad.report import style

DIAMETER, ASPERITY = 165e-6, 117e-9  # [m]
GAS, GLASS, STEEL = 0.0277, 1.1, 46.6  # air at 45 C, soda-lime glass, 52100 steel [W/(m K)]
SECTORS = 8
MARGIN = 2.0  # of the floor, left out along the tube's wall [diameters]


def gaps_on_floor(tube_radius: float, seed: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Gaps to the floor, the sector that each sphere belongs to, and the area of the floor they were taken from."""
    bed = bedrad.settle(
        bedrad.Tube(radius=tube_radius * DIAMETER),
        DIAMETER,
        3.5 * DIAMETER,
        seed,
        density=2500.0,
        friction=0.275,
        wall_friction=0.334,
    )
    x, y, z = bed.centers.T
    reach = (tube_radius - MARGIN) * DIAMETER
    chosen = np.hypot(x, y) < reach
    sector = np.floor((np.arctan2(y, x) / (2 * np.pi) + 0.5) * SECTORS).astype(int) % SECTORS
    return (z - bed.radii)[chosen], sector[chosen], np.pi * reach**2


def draw_lenses(axes, gaps: np.ndarray) -> None:
    delta = np.logspace(-5, np.log10(0.4), 300)
    for s, color in zip((1e-4, 1e-3, 1e-2), style.COLOURS, strict=False):
        H = fluid_lens.conductance(1.0, 2.0, delta, s)
        axes.plot(delta, H, color=color, label=f"asperities {s:g} r")
    near = np.sort(gaps / (0.5 * DIAMETER))
    near = near[(near > 1e-3) & (near < 0.4)]
    axes.plot(near, np.full(near.size, 1.5), "|", color=style.GREY, markersize=9, label="no-contact spheres of the bed")
    axes.set(xscale="log", xlabel="Gap to the wall [particle radii]", ylabel="Conductance of one lens, $H/(k_g r)$")
    axes.set(title="One sphere", ylim=(0, None))
    axes.legend()


def draw_steps(axes, found: dict[str, lens_and_layer.LensAgainstLayer]) -> None:
    names = ("fluid lenses", "edge of\nthe lens", "solid", "no\nasperities", "gas\nbetween", "$k_{wa}/r$")
    for k, (material, each) in enumerate(found.items()):
        steps = np.array([each.rong_horio, each.edge, each.solid, each.asperity, each.void])
        tops = np.append(np.cumsum(steps), each.watkins)
        heights = np.append(steps, each.watkins)
        places = np.arange(6) + 0.38 * (k - 0.5)
        axes.bar(places, heights, 0.36, bottom=tops - heights, color=style.COLOURS[k], label=material)
        for place, height, top in zip(places, heights, np.maximum(tops, tops - heights), strict=True):
            text = f"{height:+.0f}" if 0 < round(place) < 5 else f"{height:.0f}"
            axes.annotate(text, (place, top), (0, 2), textcoords="offset points", ha="center", fontsize=7.5)
    axes.set_xticks(range(6), names, fontsize=8.5)
    axes.grid(False, axis="x")
    axes.set(ylabel="Heat transfer coefficient [W/(m² K)]", title="The same bed by two models")
    axes.legend(loc="center", bbox_to_anchor=(0.62, 0.62))


def main(
    figure: Path = Path("fluid_lens.png"), tube_radius: float = 12.0, seed: int = 1
) -> tuple[wall_lenses.WallCoefficient, dict[str, lens_and_layer.LensAgainstLayer]]:
    gaps, sector, area = gaps_on_floor(tube_radius, seed)
    wall = wall_lenses.wall_coefficient(GAS, DIAMETER, gaps, area, ASPERITY, groups=sector, number_of_groups=SECTORS)
    print(wall)
    jump = float(bulk.modified_free_path(318.0, GAS))
    with_jump = wall_lenses.wall_coefficient(GAS, DIAMETER, gaps, area, ASPERITY, free_path=jump)
    print(f"with the temperature jump of the air, {1e9 * jump:.0f} nm: {with_jump.coefficient:.4g} W/(m2 K)\n")
    found = {
        name: lens_and_layer.compare(GAS, solid, DIAMETER, gaps, area, ASPERITY)
        for name, solid in (("glass", GLASS), ("steel", STEEL))
    }
    for name, each in found.items():
        print(f"{name}\n{each}\n")
    with style.styled():
        drawn = style.new_figure(10.5, 4.2)
        left, right = drawn.subplots(1, 2, width_ratios=(1, 1.35))
        draw_lenses(left, gaps)
        draw_steps(right, found)
        style.save(drawn, figure, "Heat through the gas into a bed: fluid lenses and Watkins' layer")
    return wall, found


if __name__ == "__main__":
    main()
