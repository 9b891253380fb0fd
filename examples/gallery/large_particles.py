"""Conduction and radiation into a flow of 2 mm particles (Watkins 2018, figure 5.11).

python examples/gallery/large_particles.py

The diameter ratio of a small system, seven times larger: radiation passes conduction within the range of a solar
receiver. The source's "63 %" is radiation's share of h, not what it adds (docs/heat_claims.md).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.heat import prediction
from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.prediction import Prediction, System
from bedrad.report import style

LARGE = System(28.2 * 2e-3, 2e-3, 0.015, name="2 mm")
TEMPERATURES = np.linspace(100.0, 1100.0, 101) + ZERO_CELSIUS


def main(figure: Path = Path("large_particles.png")) -> Prediction:
    found = prediction.predict(LARGE, TEMPERATURES)
    share = found.radiation_share
    half = float(np.interp(0.5, share, TEMPERATURES - ZERO_CELSIUS))
    print(f"radiation carries {100 * share[-1]:.0f} % of h at 1100 °C and half of it from {half:.0f} °C on")
    with style.styled():
        drawing = style.new_figure(6.2, 4.0)
        axes = drawing.subplots()
        T = TEMPERATURES - ZERO_CELSIUS
        h, without = found.heat_transfer_coefficient, found.heat_transfer_coefficient_without
        axes.plot(T, h, color=style.COLOURS[0], label="together")
        axes.plot(T, without, "--", color=style.COLOURS[1], label="conduction alone")
        axes.plot(T, h - without, ":", color=style.COLOURS[2], label="what radiation adds")
        axes.axvline(half, color=style.GREY, linewidth=0.8)
        axes.set(xlabel="Wall temperature [°C]", ylabel="$h$ [W/(m² K)]", xlim=(T[0], T[-1]), ylim=(0, None))
        axes.legend(loc="upper left")
        style.save(drawing, figure, "Flow of 2 mm particles")
    return found


if __name__ == "__main__":
    main()
