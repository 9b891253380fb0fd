"""Which particles for which temperature? h and Nu against both (Watkins 2018, figure 5.12).

python examples/gallery/particle_diameter.py

One tube, 20 mm wide, 0.015 m/s. Cold, small particles win: they leave the wall layer a smaller share of the tube. Hot,
large ones win: radiation reaches as deep as they are large. The best diameter at each temperature is printed.
"""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from bedrad.heat import RangeWarning, prediction
from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.ranges import FloatArray
from bedrad.report import style

TUBE, VELOCITY = 20e-3, 0.015
DIAMETERS = np.array([0.2, 0.3, 0.5, 0.8, 1.2]) * 1e-3
TEMPERATURES = np.linspace(100.0, 1100.0, 51) + ZERO_CELSIUS


def main(figure: Path = Path("particle_diameter.png")) -> tuple[FloatArray, FloatArray]:
    """Heat transfer coefficients and Nusselt numbers, a row a diameter."""
    with warnings.catch_warnings():
        # the smallest particles are beyond the diameter ratios of the correlations, as in the source
        warnings.simplefilter("ignore", RangeWarning)
        found = [prediction.predict(prediction.System(TUBE, d, VELOCITY), TEMPERATURES, bulk="zbs") for d in DIAMETERS]
    h = np.array([one.heat_transfer_coefficient for one in found])
    Nu = np.array([one.nusselt for one in found])
    for T in (100.0, 500.0, 800.0, 1100.0):
        k = int(np.argmin(np.abs(TEMPERATURES - ZERO_CELSIUS - T)))
        best = int(np.argmax(h[:, k]))
        print(f"{T:.0f} °C: {1e3 * DIAMETERS[best]:g} mm is best, h = {h[best, k]:.0f} W/(m2 K)")
    with style.styled():
        drawing = style.new_figure(9.6, 4.0)
        axes = drawing.subplots(1, 2)
        for d, color, marker, coefficient, number in zip(DIAMETERS, style.COLOURS, style.MARKERS, h, Nu, strict=False):
            for where, values in zip(axes, (coefficient, number), strict=True):
                where.plot(TEMPERATURES - ZERO_CELSIUS, values, color=color, marker=marker, markevery=10,
                           label=f"$d$ = {1e3 * d:g} mm")  # fmt: skip
        for where, label in zip(axes, ("$h$ [W/(m² K)]", "Nusselt number $hD/k_\\mathregular{b}$"), strict=True):
            where.set(xlabel="Wall temperature [°C]", ylabel=label)
        axes[0].legend(loc="upper left")
        style.save(drawing, figure, "Heat transfer against temperature and particle diameter")
    return h, Nu


if __name__ == "__main__":
    main()
