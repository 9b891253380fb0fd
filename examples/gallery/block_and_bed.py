"""How well, and when, does a hot block tell the coefficient between itself and a bed? (Adepu et al., section 3.3)

python examples/gallery/block_and_bed.py

An aluminium block of 70 degC meets glass particles of 20 degC; a thermometer 2 mm below its face falls by some tenths
of a kelvin, from which h follows. Early, the drop is small against the thermometer; late, the bed's own conductivity
decides.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.heat import bulk, gas
from bedrad.heat.block_extraction import BlockOnBed, Extraction, coefficient_from_drop, temperature
from bedrad.report import style

SOLID_FRACTION = 0.58
BED_CONDUCTIVITY = float(
    bulk.zehner_bauer_schluender(gas.air_conductivity(318.15), 1.0, 1.0 - SOLID_FRACTION, 165e-6, 318.15, 0.9)
)
BLOCK = BlockOnBed(
    block_length=0.08,
    block_conductivity=167.0,
    block_density=2700.0,
    block_specific_heat=896.0,
    bed_depth=0.05,
    bed_conductivity=BED_CONDUCTIVITY,
    bed_density=SOLID_FRACTION * 2500.0,
    bed_specific_heat=795.0,
    base_temperature=343.15,
    face_temperature=343.15,
    bed_temperature=293.15,
)
DEPTH, THERMOMETER = 2e-3, 0.02
ERRORS = {"bed_conductivity": 0.1, "bed_density": 0.02, "bed_specific_heat": 0.02}
COEFFICIENTS = (300.0, 1000.0, 3000.0)
TIMES = np.geomspace(0.1, 10.0, 21)


def main(figure: Path = Path("block_and_bed.png")) -> dict[float, list[Extraction]]:
    found = {}
    for h in COEFFICIENTS:
        drops = BLOCK.face_temperature - temperature(BLOCK, h, TIMES, DEPTH)
        found[h] = [
            coefficient_from_drop(BLOCK, float(drop), float(t), DEPTH, THERMOMETER, ERRORS)
            for drop, t in zip(drops, TIMES, strict=True)
        ]
        best = min(range(TIMES.size), key=lambda k: found[h][k].standard_error)
        one = found[h][best]
        share = 100 * one.budget["measured"] / one.standard_error
        print(
            f"h = {h:.0f}: best read after {TIMES[best]:.2g} s, a drop of {drops[best]:.2f} K, "
            f"± {100 * one.standard_error / h:.0f} %, thermometer {share:.0f} % of it"
        )
    with style.styled():
        drawing = style.new_figure(6.4, 4.2)
        axes = drawing.subplots()
        for h, color, marker in zip(COEFFICIENTS, style.COLOURS, style.MARKERS, strict=False):
            errors = [100 * one.standard_error / h for one in found[h]]
            thermometer = [100 * one.budget["measured"] / h for one in found[h]]
            axes.loglog(TIMES, errors, color=color, marker=marker, markevery=5, label=f"$h$ = {h:.0f} W/(m² K)")
            axes.loglog(TIMES, thermometer, ":", color=color)
        axes.plot([], [], ":", color=style.GREY, label="from the thermometer, ± 0.02 K")
        axes.set(xlabel="Time after contact [s]", ylabel="Standard error of $h$ [%]")
        axes.legend(loc="upper left")
        style.save(drawing, figure, "Coefficient from the drop of a block")
    return found


if __name__ == "__main__":
    main()
