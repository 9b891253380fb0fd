"""Nusselt number against tube over particle diameter: towards the continuum (Watkins 2018, figure 4.3).

python examples/gallery/diameter_ratio.py

Wall layer and bulk keep their conductivities; only the share of the tube that the wall layer takes changes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.heat import two_layer
from bedrad.heat.ranges import FloatArray
from bedrad.report import style

WALL_LAYER, BULK = 0.12, 0.30
"""Conductivities of the source. [W/(m K)]"""

RATIOS = np.geomspace(5.0, 2000.0, 161)


def main(figure: Path = Path("diameter_ratio.png")) -> FloatArray:
    Nu = two_layer.nusselt_developed(RATIOS, BULK / WALL_LAYER)
    for A in (10, 28.2, 54.4, 100, 1000):
        print(f"A = {A:>6g}: Nu = {two_layer.nusselt_developed(A, BULK / WALL_LAYER):.3f}")
    with style.styled():
        drawing = style.new_figure(6.2, 4.0)
        axes = drawing.subplots()
        for kappa, color in zip((1.25, 2.5, 5.0), style.COLOURS, strict=False):
            axes.plot(RATIOS, two_layer.nusselt_developed(RATIOS, kappa), color=color,
                      label=f"$k_\\mathregular{{b}}/k_\\mathregular{{wa}}$ = {kappa:g}")  # fmt: skip
        axes.axhline(8.0, color=style.GREY, linestyle=":", label="continuum, Nu = 8")
        axes.set(xlabel="Tube over particle diameter $A$", ylabel="Nusselt number $hD/k_\\mathregular{b}$")
        axes.set(xscale="log", xlim=(RATIOS[0], RATIOS[-1]), ylim=(0, 8.4))
        axes.legend(loc="lower right")
        style.save(drawing, figure, "Nusselt number against diameter ratio")
    return Nu


if __name__ == "__main__":
    main()
