"""Points beside the model's curve: a table of readings of a heated flow reduced to Nusselt numbers.

The table, examples/measured_flow.csv, is not from an apparatus. `simulated_table` makes it from the two-layer model
with stated errors and a fixed seed: 270 um zirconia-silica in the 9.53 mm tube of Watkins (2018) at three velocities,
the flow at about 80 and 125 degrees Celsius at the two probes. What comes out of the reduction can so be held against
what went in.

Run it with ``python examples/gallery/measured_flow.py``; it draws measured_flow.png. The same on the command line:

    bedrad reduce examples/measured_flow.csv --tube 7.614mm --outer 9.53mm --diameter 270um --heated-length 1.57m
        --insulation "25 mm: 0.09 W/(m K)" --insulation "70 mm: 0.05 W/(m K)" --instrument 0.004 -o measured.csv
"""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from bedrad.heat import RangeWarning, energy_balance
from bedrad.heat.materials import ZERO_CELSIUS, ZIRCONIA_SILICA
from bedrad.heat.measured_flow import (
    Insulation,
    Properties,
    Tube,
    beside_model,
    coverage_factor,
    inverse_graetz,
    two_layer_values,
    wall_temperature_drop,
)
from bedrad.heat.systems import System
from bedrad.jobs.measurements import reduce_measurements
from bedrad.report.measured_figure import write_measured_figure

TABLE = Path(__file__).parents[1] / "measured_flow.csv"

INNER, OUTER, DIAMETER, LENGTH = 7.614e-3, 9.53e-3, 270e-6, 1.57
INSULATION = Insulation(OUTER / 2, [OUTER / 2 + 0.025, OUTER / 2 + 0.095], [0.09, 0.05])
INLET, SURFACE = 26.0 + ZERO_CELSIUS, 28.0 + ZERO_CELSIUS
WALL_POSITIONS = (0.05, 0.15, 0.34, 0.5, 0.64, 0.8, 0.95, 1.1, 1.26, 1.4)
STATIONS = (0.64, 1.26)
RADII = 1e-3 * np.arange(0.0, 3.6, 0.5)
RESISTANCE = 0.063
"""Of the heated length. [ohm]"""

TOLERANCE = 0.004
"""Of a type K thermocouple, the same at all radii of a profile: 95 % lie within this share of degrees Celsius."""

READING, VOLTAGE, CURRENT, FLOW = 0.15, 0.005, 0.1, 0.005
"""Standard errors: of a temperature reading [K], of voltage [V] and current [A], of the mass flow (relative)."""

SEED = 20
VELOCITIES = (0.015, 0.047, 0.087)


def k_b(temperature: np.ndarray) -> np.ndarray:
    """Table 2.4 of Watkins (2018) for 270 um."""
    return 0.000248 * (temperature - ZERO_CELSIUS) + 0.287


def march(velocity: float, power: float) -> dict[str, np.ndarray]:
    """The flow along the tube by the two-layer model, losses included: positions, temperatures, flux, kappa."""
    system = System(INNER, DIAMETER, velocity)
    flow = velocity * ZIRCONIA_SILICA.bulk_density * 0.25 * np.pi * INNER**2
    z = np.linspace(0.0, LENGTH, 80)
    flux, wall = np.full(z.size, power / (np.pi * INNER * LENGTH)), np.full(z.size, INLET + 50.0)
    for _ in range(12):
        heat = energy_balance.cumulative_heat(z, flux, np.pi * INNER)
        mean = energy_balance.mean_temperature(INLET, heat, flow, ZIRCONIA_SILICA)
        z_star = inverse_graetz(np.maximum(z, 1e-3), INNER, flow, k_b(mean), ZIRCONIA_SILICA.specific_heat(mean))
        model = two_layer_values(system, wall, mean, k_b(mean), z_star)
        lost = INSULATION.loss(1.0, wall, SURFACE).value
        flux = (power / LENGTH - lost) / (np.pi * INNER)
        inside = mean + flux * INNER / (model.complete * k_b(mean))
        wall = inside + wall_temperature_drop(flux, INNER / 2, OUTER / 2, loss_per_length=lost)
    return {"z": z, "mean": mean, "inside": inside, "wall": wall, "flux": flux, "kappa": model.conductivity_ratio,
            "nusselt": model.complete}  # fmt: skip


def radial(station: dict[str, float], radii: np.ndarray) -> np.ndarray:
    """Temperatures in the bulk, developed, below the inside of the wall by the resistance of the wall layer."""
    R, delta, k = INNER / 2, INNER / 2 - DIAMETER / 2, k_b(np.asarray(station["mean"]))
    share, W = station["flux"] / (2 * k * R), delta / R
    # mean excess of the profile T(r) = centre + share r^2, with the steeper slope in the wall layer
    mean = share * R**2 * (0.5 * W**4 + W**2 * (1 - W**2) + station["kappa"] * 0.5 * (1 - W**2) ** 2)
    return station["mean"] - mean + share * radii**2


def simulated_table(path: Path) -> list[float]:
    """Write the table with its random errors, and return the true Nusselt numbers at the stations."""
    rng = np.random.default_rng(SEED)
    shared_columns = ["mass flow [g/s]", "mass flow error [g/s]", "voltage [V]", "voltage error [V]", "current [A]",
                      "current error [A]", "inlet temperature [degC]", "inlet temperature error [K]"]  # fmt: skip
    columns = ["run", "position [m]", *shared_columns, "surface temperature [degC]", "surface temperature error [K]"]
    columns += ["wall temperature [degC]", "wall temperature error [K]"]
    columns += [*(f"T at r = {1e3 * r:g} mm [degC]" for r in RADII), "T error [K]"]
    lines = [
        "# Simulated, not measured: two-layer model (Watkins 2018) with random errors,",
        f"# made by examples/gallery/measured_flow.py with seed {SEED}. Standard errors: {READING:g} K a reading and",
        f"# {100 * TOLERANCE / 1.96:.2g} % of degC a thermocouple (not in the error columns), {VOLTAGE:g} V, "
        f"{CURRENT:g} A, {100 * FLOW:g} % of the flow.",
        "# Voltage and current are those of the whole heated length, 1.57 m. Wall temperatures are of the outside.",
        ",".join(columns),
    ]
    truth = []

    def sensor(celsius: float, readings: int = 1) -> np.ndarray:
        return celsius * (1.0 + rng.normal() * TOLERANCE / 1.96) + rng.normal(size=readings) * READING

    for name, velocity in zip("ABC", VELOCITIES, strict=True):
        power = 105.0 * velocity / 0.015 + 14.0
        along = march(velocity, power)
        flow = 1e3 * velocity * ZIRCONIA_SILICA.bulk_density * 0.25 * np.pi * INNER**2
        shared = [f"{flow * (1 + rng.normal() * FLOW):.4f}", f"{flow * FLOW:.4f}"]
        shared += [f"{np.sqrt(power * RESISTANCE) + rng.normal() * VOLTAGE:.4f}", f"{VOLTAGE:g}"]
        shared += [f"{np.sqrt(power / RESISTANCE) + rng.normal() * CURRENT:.3f}", f"{CURRENT:g}"]
        shared += [f"{sensor(INLET - ZERO_CELSIUS)[0]:.2f}", f"{READING:g}"]
        for row, z in enumerate(WALL_POSITIONS):
            here = {name: float(np.interp(z, along["z"], values)) for name, values in along.items()}
            cells = [name, f"{z:g}", *(shared if row == 0 else [""] * len(shared))]
            cells += [f"{sensor(SURFACE - ZERO_CELSIUS)[0]:.2f}", "1", f"{sensor(here['wall'] - ZERO_CELSIUS)[0]:.2f}"]
            cells += [f"{READING:g}"]
            readings: list[str] = [""] * RADII.size
            if z in STATIONS:
                truth.append(here["nusselt"])
                true = radial(here, RADII) - ZERO_CELSIUS
                offset = sensor(float(true.mean()), RADII.size) - true.mean()
                readings = [f"{T:.2f}" for T in true + offset]
            lines.append(",".join([*cells, *readings, f"{READING:g}" if z in STATIONS else ""]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return truth


def main(figure: Path = Path("measured_flow.png")) -> dict[str, np.ndarray]:
    """Reduce the table, put the model beside it, draw both; the pulls of Nu and of the first law."""
    with warnings.catch_warnings():
        # the flow enters colder than the specific heat was measured
        warnings.simplefilter("ignore", RangeWarning)
        runs = reduce_measurements(
            TABLE,
            Tube(INNER, OUTER, insulation=INSULATION),
            Properties(ZIRCONIA_SILICA, k_b, 0.11 / 1.96),
            heated_length=LENGTH,
            instrument_tolerance=TOLERANCE / float(coverage_factor()),
        )
        model = beside_model(runs, INNER, DIAMETER, ZIRCONIA_SILICA.bulk_density, ZIRCONIA_SILICA.solid_conductivity)
    for run in runs:
        print(run)
    write_measured_figure(figure, runs, model, "Simulated readings of 270 µm zirconia-silica in a 7.61 mm tube")
    return {
        "nusselt": np.concatenate([run.nusselt.value for run in runs]),
        "error": np.concatenate([run.nusselt.error for run in runs]),
        "error_of_h": np.concatenate([run.heat_transfer_coefficient.relative_error for run in runs]),
        "model": np.concatenate([np.ravel(one.stations.complete) for one in model]),
        "first_law": np.concatenate([run.first_law.deviation for run in runs if run.first_law is not None]),
    }


if __name__ == "__main__":
    main()
