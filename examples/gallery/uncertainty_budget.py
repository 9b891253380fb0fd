"""What should be measured better? The budget of uncertainty of a predicted heat transfer coefficient.

python examples/gallery/uncertainty_budget.py

A flow of 0.6 mm particles at 850 degC with a measured wall layer and traced view factors: to first order, by drawing,
and what would be left if one input were known exactly.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bedrad.heat import prediction
from bedrad.heat.budget import LABELS
from bedrad.heat.prediction import Prediction, System, Uncertainties, ViewFactors, WallLayer
from bedrad.report import style

SYSTEM = System(7.75e-3, 600e-6, 0.016)
LAYER = WallLayer(0.45, 2.0e6, 0.16, packing_fraction_error=0.004, contacts_per_area_error=3e4, nc_distance_error=0.02)
COVARIANCE = 1e-6 * np.array([[4.0, -3.6, -0.3], [-3.6, 3.5, 0.1], [-0.3, 0.1, 0.2]])
FACTORS = ViewFactors([0.829, 0.150, 0.0095], covariance=COVARIANCE)
GIVEN = Uncertainties(
    particle_diameter=10e-6,
    solid_conductivity=0.2,
    porosity=0.01,
    emissivity=0.05,
    wall_temperature=5.0,
    gas_conductivity=0.01,
    bulk_conductivity=0.056,
)


def main(figure: Path = Path("uncertainty_budget.png"), samples: int = 4000) -> Prediction:
    found = prediction.predict(SYSTEM, 1123.15, LAYER, FACTORS, uncertainties=GIVEN, samples=samples, seed=1)
    print(found.budget)
    print(found.monte_carlo)
    budget = found.budget
    order = [i for i in np.argsort(budget.contributions[:, 0]) if budget.contributions[i, 0] > 0.0]
    h, total = float(budget.heat_transfer_coefficient[0]), float(budget.total[0])
    left = np.sqrt(total**2 - budget.contributions[order, 0] ** 2)
    with style.styled():
        drawing = style.new_figure(7.2, 4.0)
        axes = drawing.subplots()
        places = np.arange(len(order))
        axes.barh(places, 100 * budget.contributions[order, 0] / h, color=style.COLOURS[0], label="from this input")
        axes.plot(100 * left / h, places, "D", color=style.COLOURS[1], label="left without it")
        axes.axvline(100 * total / h, color=style.GREY, linestyle=":", label="all together")
        axes.set_yticks(places, [LABELS[budget.names[i]][0] for i in order], fontsize=8.5)
        axes.set_xlabel("Standard error of $h$ [%]")
        axes.grid(False, axis="y")
        axes.legend(loc="center")
        style.save(drawing, figure, "Budget of uncertainty")
    return found


if __name__ == "__main__":
    main()
