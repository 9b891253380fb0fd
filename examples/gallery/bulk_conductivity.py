"""How well a bed of spheres conducts, against temperature and particle diameter.

Draws figure 2.12 of Watkins (2018) again for the zirconia-silica bed in air: on the left the bulk conductivity by the
model of Zehner, Bauer and Schluender for diameters from 0.14 to 2 mm, with the fits of Tables 2.4 and 5.2 over
their ranges; on the right conduction and radiation at 1100 degrees Celsius against the diameter, radiation by seven
published models, and where it passes conduction.

Run it with `python examples/gallery/bulk_conductivity.py`; it writes bulk_conductivity.png.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

from bedrad.heat import RangeWarning, bulk, bulk_radiation, gas, materials
from bedrad.report import style

DIAMETERS = (0.14e-3, 0.27e-3, 0.32e-3, 0.6e-3, 1e-3, 2e-3)
HOT = materials.ZERO_CELSIUS + 1100.0
SOLID = materials.ZIRCONIA_SILICA.solid_conductivity
EMISSIVITY = materials.ZIRCONIA_SILICA.emissivity
POROSITY = 1.0 - materials.ZIRCONIA_SILICA.packing_fraction
COLD = 1e-3
"""A temperature at which nothing radiates, for the conduction of models that have both in one. [K]"""


def conductivity(temperature: Any, diameter: Any) -> Any:
    """Bulk conductivity by Zehner, Bauer and Schluender. [W/(m K)]"""
    k_g = gas.air_conductivity(temperature)
    return bulk.zehner_bauer_schluender(k_g, SOLID, POROSITY, diameter, temperature, EMISSIVITY)


def radiation_models(temperature: float) -> dict[str, tuple[Any, Any]]:
    """For each model of radiation a function of the diameter, and the conduction it is to be added to. [W/(m K)]"""
    k_g = gas.air_conductivity(temperature)
    conduction = bulk.zehner_schluender(k_g, SOLID, POROSITY)
    layers = bulk.kunii_smith(k_g, SOLID, POROSITY, 1e-3, COLD, EMISSIVITY)
    state = temperature, EMISSIVITY
    return {
        "Zehner–Bauer–Schlünder": (lambda d: conductivity(temperature, d) - conduction, conduction),
        "Kunii–Smith": (lambda d: bulk.kunii_smith(k_g, SOLID, POROSITY, d, *state) - layers, layers),
        "Breitbach–Barthels": (lambda d: bulk_radiation.breitbach_barthels(SOLID, POROSITY, d, *state), conduction),
        "Singh–Kaviany": (lambda d: bulk_radiation.singh_kaviany(SOLID, d, *state), conduction),
        "Vortmeyer": (lambda d: bulk_radiation.vortmeyer(d, *state), conduction),
        "Argo–Smith": (lambda d: bulk_radiation.argo_smith(d, *state), conduction),
        "Schotte": (lambda d: bulk_radiation.schotte(SOLID, POROSITY, d, *state), conduction),
    }


def crossings(temperature: float = HOT) -> dict[str, float]:
    """Diameter at which radiation passes conduction, by each model. [m]"""
    return {
        name: float(brentq(lambda d, r=radiation, c=conduction: r(d) - c, 1e-5, 1.0))
        for name, (radiation, conduction) in radiation_models(temperature).items()
    }


def draw_temperatures(axes: Any) -> None:
    celsius = np.linspace(40.0, 1100.0, 107)
    for diameter, colour in zip(DIAMETERS, style.COLOURS, strict=True):
        axes.plot(celsius, conductivity(celsius + materials.ZERO_CELSIUS, diameter), color=colour, linewidth=1.1)
        axes.annotate(
            f"{1e3 * diameter:g} mm",
            (1100.0, conductivity(HOT, diameter)),
            xytext=(4, {0.27e-3: -3, 0.32e-3: 3, 0.14e-3: -6}.get(diameter, 0)),
            textcoords="offset points",
            va="center",
            fontsize=8.5,
            color=colour,
        )
    of = dict(zip(DIAMETERS, zip(style.COLOURS, style.MARKERS, strict=True), strict=True))
    for fit in (*bulk.TABLE_2_4, *bulk.TABLE_5_2):
        measured = fit.table == "2.4"
        colour, marker = of.get(fit.particle_diameter, (style.GREY, "x"))
        ends = np.linspace(fit.lowest, fit.highest, 6)
        axes.plot(
            ends - materials.ZERO_CELSIUS,
            fit.conductivity(ends),
            color=colour,
            linewidth=2.4 if measured else 1.4,
            linestyle="-" if measured else (0, (2, 1.5)),
            marker=marker if measured else None,
            markersize=4.5,
        )
    for linewidth, linestyle, marker, colour, label in (
        (1.1, "-", None, "black", "Zehner–Bauer–Schlünder"),
        (2.4, "-", "o", "black", "fits to measurements, Table 2.4"),
        (1.4, (0, (2, 1.5)), None, "black", "van Antwerpen's model, Table 5.2"),
        (2.4, "-", "x", style.GREY, "0.34 mm alumina-silicate, Table 2.4"),
    ):
        axes.plot([], [], color=colour, linewidth=linewidth, linestyle=linestyle, marker=marker, label=label)
    axes.set(xlim=(0, 1290), ylim=(0.2, 1.1), xlabel="Bed temperature [°C]", ylabel="Bulk conductivity [W/(m K)]")
    axes.set_title("Zirconia-silica in air, by particle diameter")
    axes.legend(loc="upper left")


def draw_diameters(axes: Any, crossing: dict[str, float]) -> None:
    d = np.geomspace(1e-4, 5e-3, 60)
    models = radiation_models(HOT)
    look = zip([*style.COLOURS, "#333333"], [*style.MARKERS, "X"], strict=True)
    for (name, (radiation, conduction)), (colour, marker) in zip(models.items(), look, strict=True):
        axes.plot(1e3 * d, radiation(d), color=colour)
        axes.plot(1e3 * crossing[name], conduction, color=colour, marker=marker, markersize=7, linestyle="none")
        axes.plot([], [], color=colour, marker=marker, label=f"{name}, {1e3 * crossing[name]:.2f} mm")
    for name, text, down in (
        ("Argo–Smith", "conduction, Zehner–Schlünder", 4),
        ("Kunii–Smith", "conduction, Kunii–Smith", -11),
    ):
        conduction = models[name][1]
        axes.axhline(conduction, color=style.GREY, linewidth=1.0, linestyle=(0, (4, 2)))
        axes.annotate(
            text, (0.105, conduction), xytext=(0, down), textcoords="offset points", fontsize=8.5, color=style.GREY
        )
    axes.set(xscale="log", yscale="log", xlim=(0.1, 5.0), xlabel="Particle diameter [mm]")
    axes.set(ylabel="Conductivity by radiation [W/(m K)]")
    axes.set_xticks([0.1, 0.2, 0.5, 1, 2, 5], labels=["0.1", "0.2", "0.5", "1", "2", "5"])
    axes.set_yticks([0.03, 0.1, 0.3, 1, 3], labels=["0.03", "0.1", "0.3", "1", "3"])
    axes.minorticks_off()
    axes.set_title("At 1100 °C: where radiation passes conduction")
    axes.legend(loc="lower right")


def main(figure: Path = Path("bulk_conductivity.png")) -> dict[str, float]:
    """Draw the figure, print what it shows; the diameters at which radiation passes conduction. [m]"""
    crossing = crossings()
    print("Radiation passes conduction in zirconia-silica in air of 1100 °C at")
    for name, diameter in crossing.items():
        print(f"  {1e3 * diameter:5.2f} mm  {name}")
    for fit in bulk.TABLE_5_2:
        T = np.linspace(fit.lowest, fit.highest, 100)
        off = 100 * (conductivity(T, fit.particle_diameter) / fit.conductivity(T) - 1)
        print(
            f"Zehner–Bauer–Schlünder against Table 5.2, {1e3 * fit.particle_diameter:g} mm: {off.min():.1f} to "
            f"{off.max():.1f} %"
        )
    with style.styled(), warnings.catch_warnings():
        warnings.simplefilter("error", RangeWarning)
        canvas = style.new_figure(10.0, 4.6)
        left, right = canvas.subplots(1, 2)
        draw_temperatures(left)
        draw_diameters(right, crossing)
        style.save(canvas, figure, "Bulk conductivity against temperature and particle diameter")
    return crossing


if __name__ == "__main__":
    main()
