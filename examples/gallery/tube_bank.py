"""Particles that flow across heated tubes: a row of measurements reduced, and set among those of five materials.

The row is the one that Nguyen (2015) prints in full, Accucast ID50-K across eight bare tubes: coefficient, outlet
temperature and heat loss, and which instrument makes how much of the uncertainty. Beside it the coefficients that he
measured on bare and on finned tubes against superficial speed (points: mean of two powers; curves: his fits), and the
heat that his fins add.

python examples/gallery/tube_bank.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bedrad.heat import tube_bank
from bedrad.heat.kopp_neumann import ID50_K
from bedrad.report import style

CELSIUS = 273.15
SPEEDS = np.array([3e-3, 5e-3, 10e-3])

DENSITY, BOX = 1823.0, 0.1143  # of the bed [kg/m3]; side of the box [m]

# value, uncertainty
ROW = {
    "diameter": (0.015875, 1e-4),
    "length": (0.1016, 1e-4),
    "power": (176.2, 1.8),
    "upstream tube": (77.91 + CELSIUS, 0.004),
    "downstream tube": (74.57 + CELSIUS, 0.004),
    "inlet": (37.68 + CELSIUS, 0.0074),
    "ambient": (20.0 + CELSIUS, 5.0),
    "mass flow": (0.06802, 1e-4),
    "specific heat": (1.0, 0.1),
    "loss": (0.2934, 0.029),
}

FINNED = tube_bank.FinnedTube(
    base_radius=9.525e-3, fin_radius=18.9e-3, fin_thickness=0.57e-3, fins=32, length=0.1016, conductivity=51.9
)


class Numbers(NamedTuple):
    """What the example finds."""

    coefficient: float
    uncertainty: float
    power_share: float
    fin_efficiency: float
    fin_effectiveness: float


def reduced(**x: float) -> Any:
    """Coefficient of the bare tubes, with the specific heat as a factor of that by Kopp and Neumann."""
    row = tube_bank.Measurement(
        heat_rate=x["power"],
        tubes=8,
        upstream_temperature=x["upstream tube"],
        downstream_temperature=x["downstream tube"],
        inlet_temperature=x["inlet"],
        mass_flow=x["mass flow"],
        specific_heat=lambda T: x["specific heat"] * tube_bank.mixture_specific_heat(ID50_K, T),
        loss_conductance=x["loss"],
        ambient_temperature=x["ambient"],
    )
    return tube_bank.reduce_bare_tubes(row, x["diameter"], x["length"])


def speeds(axes: Any, fits: Any, table: Any, title: str) -> None:
    """Coefficients of the five materials against speed."""
    V = np.linspace(*tube_bank.SPEED_RANGE, 100)
    for k, material in enumerate(sorted(table, key=lambda name: -np.mean(table[name]))):
        colour = style.COLOURS[list(tube_bank.MATERIALS).index(material)]
        marker = style.MARKERS[list(tube_bank.MATERIALS).index(material)]
        axes.plot(1e3 * V, fits[material].coefficient(V), color=colour, zorder=2 + k)
        points = np.mean(table[material], axis=1)
        axes.plot(1e3 * SPEEDS, points, marker, color=colour, zorder=8, label=tube_bank.MATERIALS[material].name)
    axes.set_title(title)
    axes.set_xlabel("superficial speed [mm/s]")
    axes.set_ylim(70, 150)


def shares(axes: Any, budget: tube_bank.SensitivityBudget) -> None:
    """Bars of the inputs that make a ten-thousandth of the variance or more."""
    order = [i for i in np.argsort(budget.shares) if budget.shares[i] > 1e-4]
    bars = axes.barh([budget.names[i] for i in order], [100 * budget.shares[i] for i in order], color=style.COLOURS[0])
    axes.bar_label(bars, fmt="%.2g %%", padding=3, fontsize=8.5)
    axes.set_xlim(0, 85)
    axes.set_xlabel("share of the variance of h [%]")
    axes.set_title(f"The row reduced: h = {budget.result:.1f} ± {budget.uncertainty:.1f} W/(m$^2$ K)")
    axes.grid(False, axis="y")


def main(figure: Path = Path("tube_bank.png")) -> Numbers:
    values = {name: value for name, (value, _) in ROW.items()}
    row = reduced(**values)
    budget = tube_bank.sensitivity_budget(
        lambda **x: reduced(**x).coefficient, values, {name: error for name, (_, error) in ROW.items()}
    )
    with style.styled():
        page = style.new_figure(12.5, 4.2)
        bare, finned, bars = page.subplots(1, 3, width_ratios=(1.0, 1.0, 1.15))
        speeds(bare, tube_bank.TABLE_12, tube_bank.TABLE_14, "Bare tubes")
        speeds(finned, tube_bank.TABLE_13, tube_bank.TABLE_15, "Finned tubes, over tube and fins")
        bare.set_ylabel("heat transfer coefficient [W/(m$^2$ K)]")
        speed = values["mass flow"] / (DENSITY * BOX**2)
        bare.plot(1e3 * speed, row.coefficient, "*", ms=11, color="k", zorder=9, label="the row at the right")
        bare.legend(loc="upper left")
        shares(bars, budget)
        style.save(page, figure, "Particles across heated tubes")
    h = float(np.mean(tube_bank.TABLE_15["Riyadh"][2]))
    efficiency = float(FINNED.efficiency(h))
    apparent = h * FINNED.effective_area(h) / FINNED.bare_area
    gain = float(tube_bank.fin_effectiveness(apparent, np.mean(tube_bank.TABLE_14["Riyadh"][2])))
    share = dict(zip(budget.names, budget.shares, strict=True))["power"]
    print(row)
    print(budget)
    print(f"fins in Riyadh sand at 10 mm/s: efficiency {efficiency:.2f}, heat {gain:.1f} times that of the bare tube")
    return Numbers(float(row.coefficient), budget.uncertainty, float(share), efficiency, gain)


if __name__ == "__main__":
    main()
