"""The systems measured hot, with radiation and without, and what is sure about them (Watkins 2018, figure 5.10).

python examples/gallery/hot_flows.py

The three systems of Table 5.1 up to 1100 degC with the uncertainties that the source states. Radiation counts from
some 600 degC on, in these small particles never for most of the heat.
"""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from bedrad.heat import RangeWarning, prediction
from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.prediction import Prediction
from bedrad.report import style

TEMPERATURES = np.linspace(100.0, 1100.0, 41) + ZERO_CELSIUS


def main(figure: Path = Path("hot_flows.png")) -> list[Prediction]:
    with warnings.catch_warnings():
        # Table 5.2 ends at 1000 degC and one tube is wider than the flows behind the correlations, as in the source
        warnings.simplefilter("ignore", RangeWarning)
        found = [
            prediction.predict(system, TEMPERATURES, uncertainties=prediction.Uncertainties.published())
            for system in prediction.TABLE_5_1
        ]
    for one in found:
        h, error, gain = one.heat_transfer_coefficient, one.heat_transfer_coefficient_error, 100 * one.radiation_gain
        print(
            f"{one.system.name}: h {h[0]:.0f} to {h[-1]:.0f} ± {error[-1]:.0f} W/(m2 K); "
            f"radiation adds {gain[0]:.1f} to {gain[-1]:.1f} %"
        )
    draw(found, figure)
    return found


def draw(found: list[Prediction], path: Path) -> None:
    with style.styled():
        figure = style.new_figure(9.6, 3.6)
        axes = figure.subplots(1, 3, sharey=True)
        T = TEMPERATURES - ZERO_CELSIUS
        for one, where, color in zip(found, axes, style.COLOURS, strict=False):
            h, error = one.heat_transfer_coefficient, one.heat_transfer_coefficient_error
            where.fill_between(T, h - 1.96 * error, h + 1.96 * error, color=color, alpha=0.2, linewidth=0, label="95 %")
            where.plot(T, h, color=color, label="with radiation")
            where.plot(T, one.heat_transfer_coefficient_without, "--", color=color, label="without")
            s = one.system
            where.set_title(f"$D$ {1e3 * s.tube_diameter:.1f} mm, $d$ {1e6 * s.particle_diameter:.0f} µm")
            where.set_xlabel("Wall temperature [°C]")
            where.legend(loc="upper left")
        axes[0].set_ylabel("$h$ [W/(m² K)]")
        axes[0].set_ylim(0, None)
        style.save(figure, path, "Flows measured hot")


if __name__ == "__main__":
    main()
