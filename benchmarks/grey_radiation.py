"""When does it matter that wall and particles are taken as black? Grey beds by reflected rays and by zones.

    python benchmarks/grey_radiation.py [--csv docs/grey_radiation.csv] [--figure docs/images/grey_radiation.png]
    python benchmarks/grey_radiation.py --draw-only

The settled bed takes half a minute (extra dem) and is kept in results/; the rest some five minutes of two processors.
With --draw-only the figure is drawn from the table that is there. Prints what the documentation quotes.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import astuple, dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import Any

import beds
import numpy as np
from numpy.typing import NDArray

import bedrad
from bedrad.heat import bulk, grey_enclosure, radiation, wall_layer
from bedrad.heat.gas import air_conductivity
from bedrad.heat.two_layer import nusselt_developed
from bedrad.packings.layers import layer_sums
from bedrad.raytrace.enclosure_results import jackknife_error
from bedrad.report import style

FloatArray = NDArray[np.float64]

ROOT = Path(__file__).parents[1]

EMISSIVITIES = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)
REFLECTED, EXCHANGED = 2**20, 2**21
"""Rays that are reflected for each pair of emissivities, and of an exchange matrix."""

LAYERS = 6
FEW_LAYERS = (1, 2, 3, 4)
FINER = ((1, 1), (1, 16), (2, 8), (4, 8), (4, 16))
"""Sub-layers and ranges of angle to the wall that zones of the settled bed are parted into."""

SETTLED = "settled"
RATIO, SOLID_FRACTION, CONTACTS = 12.917, 0.432, 0.708
"""Of the settled bed: tube over particle diameter, solid fraction of the wall layer, contacts per area times d^2."""

SOLID_CONDUCTIVITY, POROSITY = 2.1, 0.40
"""Of the particles [W/(m K)], as in Watkins (2018); of the bulk of the settled bed."""

SHADES = ("#F7FAFD", "#E8F1FA", "#D6E6F4", "#C3DAEE", "#A9CBE6", "#8DBADC", "#6FA8D1", "#5A97C4")
LABELS = [(0.42, 520.0), (0.57, 640.0), (1.5, 600.0), (1.0, 900.0), (1.4, 920.0), (2.0, 940.0), (3.0, 940.0)]
"""Colours between the contours of the figure, and where these are labelled [mm, K]."""

TEMPERATURES = np.linspace(400.0, 1600.0, 49)
DIAMETERS = np.geomspace(1e-4, 1e-2, 41)


@dataclass(frozen=True)
class Row:
    """One pair of emissivities of one bed. k_rad is over that of black surfaces by the same rays or zones."""

    bed: str
    solid_fraction: float
    layers: int
    wall_emissivity: float
    particle_emissivity: float
    k_rad_reflected: float
    k_rad_reflected_error: float
    k_rad_zones: float
    k_rad_zones_error: float
    k_rad_zones_mirrored: float
    bed_emissivity: float
    bed_emissivity_error: float
    factor_1: float
    factor_2: float
    factor_3: float
    beyond: float


def close_packed(across: int, layers: int) -> bedrad.Packing:
    """Hexagonal close packing on a plate, periodic."""
    r = beds.RADIUS
    rows = 2 * across
    x, y, z = np.meshgrid(np.arange(across), np.arange(rows), np.arange(layers), indexing="ij")
    shifted = z % 2
    centers = np.stack([
        2.0 * x + (y % 2) + shifted,
        np.sqrt(3.0) * (y + shifted / 3.0),
        1.0 + 2.0 * np.sqrt(2.0 / 3.0) * z,
    ], axis=-1)  # fmt: skip
    period = (2.0 * across * r, np.sqrt(3.0) * rows * r)
    return bedrad.Packing(centers.reshape(-1, 3) * r, r, bedrad.Plate(), period)


def thinned(packing: bedrad.Packing, kept: float) -> bedrad.Packing:
    """A bed of which a random part of the spheres is left."""
    chosen = np.random.default_rng(1).random(len(packing)) < kept
    return bedrad.Packing(packing.centers[chosen], packing.radii[chosen], packing.wall, packing.period)


def all_beds() -> dict[str, bedrad.Packing]:
    random = beds.layer_bed(6000)
    return {
        SETTLED: beds.demo_bed(),
        "close packed on a plate": close_packed(12, 9),
        "random on a plate": random,
        "random, 3/4 left": thinned(random, 0.75),
        "random, half left": thinned(random, 0.5),
    }


def solid_fraction(packing: bedrad.Packing, edges: FloatArray) -> float:
    """Of the layers behind the first."""
    window = packing.window()
    volumes = layer_sums(packing, edges[1:], window)
    return float(volumes.sum() / packing.wall.layer_volume(edges[1], edges[-1], window))


def weights(layers: int) -> FloatArray:
    """Number of steps to each layer in Watkins (2018), eq. 50."""
    return np.arange(1.0, layers + 1.0)


def reflected(packing: bedrad.Packing, edges: FloatArray, pair: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
    """Steps `sum j F_wj`, first three factors, beyond, bed emissivity; and the replicates of the steps and the last."""
    r = bedrad.reflected_factors(packing, *pair, edges, rays=REFLECTED, seed=1)
    n = len(edges) - 1
    both = np.vstack([np.concatenate([[r.wall], r.layers, [r.beyond, r.escaped]]), r.replicates])
    factors = pair[0] * both[:, 1 : n + 1]
    steps = factors @ weights(n)
    # what a black wall gives to all behind it; with a grey wall by the resistance of its own surface
    whole = pair[0] * (1.0 - both[:, 0])
    seen = 1.0 / (1.0 / whole - 1.0 / pair[0] + 1.0)
    first = np.pad(factors[0, :3], (0, max(3 - n, 0)))
    values = np.concatenate([[steps[0]], first, [pair[0] * (r.beyond + r.escaped), seen[0]]])
    return values, np.column_stack([steps[1:], seen[1:]])


def zone_steps(
    matrix: FloatArray, areas: FloatArray, layer_of_zone: Any, pair: tuple[float, float], cap: float
) -> float:
    """`sum j F_wj` by zones of uniform radiosity, from a matrix (zones, zones + 2)."""
    n = len(areas)
    factors = grey_enclosure.wall_exchange_factors(matrix[:, :n], matrix[:, n:].sum(axis=1), areas, *pair, cap)
    return float(factors[:-1] @ (1.0 + layer_of_zone[1:]))


def rows_of(name: str, packing: bedrad.Packing, layers: int, pairs: list[tuple[float, float]]) -> list[Row]:
    edges = bedrad.layer_edges(packing, layers)
    x = bedrad.exchange_factors(packing, edges, rays=EXCHANGED, seed=1)
    solid = solid_fraction(packing, bedrad.layer_edges(packing, LAYERS - 1))
    black, black_replicates = reflected(packing, edges, (1.0, 1.0))
    of_zones = (x.areas, x.layer_of_zone)
    found = []
    for pair in pairs:
        own, replicates = (black, black_replicates) if pair == (1.0, 1.0) else reflected(packing, edges, pair)

        def ratio(matrix: FloatArray, pair: tuple[float, float] = pair) -> FloatArray:
            return np.array(zone_steps(matrix, *of_zones, pair, 1.0) / zone_steps(matrix, *of_zones, (1.0, 1.0), 1.0))

        mirrored = zone_steps(x.matrix, *of_zones, pair, 0.0) / zone_steps(x.matrix, *of_zones, (1.0, 1.0), 0.0)
        error, seen_error = jackknife_error(
            np.column_stack([replicates[:, 0] / black_replicates[:, 0], replicates[:, 1]])
        )
        found.append(
            Row(
                name, solid, layers, *pair, own[0] / black[0], error, float(ratio(x.matrix)),
                float(x.error_of(ratio)), mirrored, own[5], seen_error, *own[1:5],
            )
        )  # fmt: skip
        print(
            f"{name}, {layers} layers, {pair}: {own[0] / black[0]:.4f}, zones {found[-1].k_rad_zones:.4f}", flush=True
        )
    return found


def compute() -> list[Row]:
    both = [(e, e) for e in EMISSIVITIES]
    black_wall = [(1.0, e) for e in EMISSIVITIES[1:]]
    grey_wall = [(e, 1.0) for e in (0.8, 0.5, 0.2)]
    made = all_beds()
    rows = []
    for name, packing in made.items():
        rows += rows_of(name, packing, LAYERS - (packing.wall.kind == "plate"), both)
    rows += rows_of(SETTLED, made[SETTLED], LAYERS, black_wall + grey_wall)
    for layers in FEW_LAYERS:
        rows += rows_of(SETTLED, made[SETTLED], layers, [(e, e) for e in (0.8, 0.5, 0.2)])
    return rows


def print_refinement() -> None:
    """Zones parted further and further, against reflected rays, on the settled bed."""
    packing = beds.demo_bed()
    edges = bedrad.layer_edges(packing, LAYERS)
    for eps in (0.8, 0.5, 0.2):
        steps = reflected(packing, edges, (eps, eps))[0][0]
        for parts, orientations in FINER:
            fine = np.concatenate([[0.0], *(np.linspace(a, b, parts + 1)[1:] for a, b in pairwise(edges))])
            x = bedrad.exchange_factors(packing, fine, rays=EXCHANGED, seed=2, orientations=orientations)
            coarse = x.layer_of_zone // parts

            def off(matrix: FloatArray, x: Any = x, coarse: Any = coarse, eps: float = eps, s: float = steps) -> Any:
                return np.array(zone_steps(matrix, x.areas, coarse, (eps, eps), 1.0) / s - 1.0)

            print(
                f"emissivity {eps}, {parts} sub-layers, {orientations} ranges of angle: k_rad by zones "
                f"{100 * float(off(x.matrix)):+.2f} % +- {100 * float(x.error_of(off)):.2f} %"
            )


def read_rows(path: Path) -> list[Row]:
    with path.open(encoding="utf-8", newline="") as file:
        next(file)
        kinds = {f.name: {"str": str, "int": int, "float": float}[str(f.type)] for f in fields(Row)}
        return [Row(**{k: kinds[k](v) for k, v in line.items()}) for line in csv.DictReader(file)]


def write_rows(rows: list[Row], path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        print("# python benchmarks/grey_radiation.py", file=file)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(f.name for f in fields(Row))
        for row in rows:
            writer.writerow(f"{v:.6g}" if isinstance(v, float) else v for v in astuple(row))


def error_of_h(grey: Row, steps: float, d: FloatArray, T: FloatArray) -> FloatArray:
    """Error of h of the developed flow from a black wall layer in place of a grey one; bulk grey in both.

    Parameters
    ----------
    grey : Row
        What greyness does to k_rad.
    steps : float
        `sum j F_wj` of black surfaces.
    d, T : arrays
        Particle diameters [m], wall temperatures [K]; they broadcast.
    """
    k_g = air_conductivity(T)
    k_wa = wall_layer.conductivity(
        k_g, SOLID_CONDUCTIVITY, RATIO, d, CONTACTS / d**2, SOLID_FRACTION, form="general", warn=False
    )
    k_b = bulk.zehner_bauer_schluender(k_g, SOLID_CONDUCTIVITY, POROSITY, d, T, grey.particle_emissivity)
    k_rad = 2.0 * radiation.STEFAN_BOLTZMANN * d * T**3 * steps
    black, real = (nusselt_developed(RATIO, k_b / (k_wa + share * k_rad)) for share in (1.0, grey.k_rad_reflected))
    return np.asarray(black / real - 1.0)


def select(rows: list[Row], bed: str, layers: int | None = None) -> list[Row]:
    """Rows of a bed with wall and particles alike, by falling emissivity."""
    found = [r for r in rows if r.bed == bed and r.wall_emissivity == r.particle_emissivity]
    most = max(r.layers for r in found) if layers is None else layers
    return sorted((r for r in found if r.layers == most), key=lambda r: -r.particle_emissivity)


def black_steps(row: Row) -> float:
    return row.factor_1 + 2.0 * row.factor_2 + 3.0 * row.factor_3


def draw_ratio(axes: Any, rows: list[Row]) -> None:
    """k_rad of grey surfaces over that of black ones, against emissivity."""
    own = select(rows, SETTLED)
    x = np.array([r.particle_emissivity for r in own])
    for name, colour, marker in zip({r.bed: 0 for r in rows}, style.COLOURS, style.MARKERS, strict=False):
        of_bed = select(rows, name)
        axes.errorbar(
            [r.particle_emissivity for r in of_bed], [r.k_rad_reflected for r in of_bed],
            [2.0 * r.k_rad_reflected_error for r in of_bed], fmt=marker, color=colour, linewidth=1.0,
            label=f"{name}, {of_bed[0].solid_fraction:.2f}",
        )  # fmt: skip
    axes.plot(x, [r.k_rad_zones for r in own], color=style.COLOURS[0], linestyle="--", label="settled, by zones")
    fine = np.linspace(0.0, 1.0, 101)
    axes.plot(fine, fine / (2.0 - fine), color=style.GREY, linewidth=1.1, label="two plates, 1/(2/\u03b5 - 1)")
    black = [r for r in rows if r.bed == SETTLED and r.wall_emissivity == 1.0]
    black.sort(key=lambda r: r.particle_emissivity)
    axes.plot(
        [r.particle_emissivity for r in black], [r.k_rad_reflected for r in black], color=style.COLOURS[0],
        linestyle=":", label="settled, only the particles grey",
    )  # fmt: skip
    axes.set(
        xlim=(0.0, 1.02),
        ylim=(0.0, 1.03),
        xlabel="Emissivity of wall and particles",
        ylabel="k_rad over that of black surfaces",
    )
    axes.set_title("What greyness takes from k_rad")
    handles, labels = axes.get_legend_handles_labels()
    curves = len(labels) - len({r.bed for r in rows})
    axes.legend(handles[curves:] + handles[:curves], labels[curves:] + labels[:curves], loc="upper left", fontsize=8)


def draw_error(axes: Any, rows: list[Row]) -> None:
    """Error of h from black surfaces, over particle diameter and wall temperature."""
    own = {r.particle_emissivity: r for r in select(rows, SETTLED)}
    d, T = np.meshgrid(DIAMETERS, TEMPERATURES)
    levels = (0.5, 1, 2, 3, 4, 5, 6)
    steps = black_steps(own[1.0])
    percent = 100.0 * error_of_h(own[0.8], steps, d, T)
    axes.contourf(1e3 * d, T, percent, levels=(0.0, *levels, 8.0), colors=SHADES)
    lines = axes.contour(1e3 * d, T, percent, levels=levels, colors="#1F3B57", linewidths=0.8)
    axes.clabel(lines, fmt="%g %%", fontsize=8, manual=LABELS)
    greyer = 100.0 * error_of_h(own[0.5], steps, d, T)
    axes.contour(1e3 * d, T, greyer, levels=(5.0,), colors=style.COLOURS[1], linestyles="--", linewidths=1.6)
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.5}
    axes.annotate(
        "5 % at \u03b5 = 0.5", (0.62, 945.0), fontsize=8, color=style.COLOURS[1], ha="right", va="top", bbox=box
    )
    axes.plot([0.27, 0.27], [400.0, 1373.0], color=style.COLOURS[2], linewidth=2.5)
    axes.annotate("Watkins 2018,\n0.27 mm", (0.26, 430.0), ha="right", fontsize=8, color=style.COLOURS[2])
    axes.plot(2.0, 1373.0, style.MARKERS[3], color=style.COLOURS[2], markeredgecolor="white", markersize=8)
    axes.annotate("Watkins 2018, 2 mm", (2.2, 1362.0), fontsize=8, color="white")
    axes.set_xscale("log")
    axes.set_xticks([0.1, 0.2, 0.5, 1, 2, 5, 10], ["0.1", "0.2", "0.5", "1", "2", "5", "10"])
    axes.set_xticks([], minor=True)
    axes.grid(False)
    axes.set(xlabel="Particle diameter [mm]", ylabel="Wall temperature [K]")
    axes.set_title("How much too large h is with black surfaces, \u03b5 = 0.8")


def draw(rows: list[Row], path: Path) -> None:
    with style.styled():
        figure = style.new_figure(11.0, 4.8)
        left, right = figure.subplots(1, 2)
        draw_ratio(left, rows)
        draw_error(right, rows)
        style.save(figure, path, "When does the black assumption matter?")


def print_answers(rows: list[Row]) -> None:
    own = {r.particle_emissivity: r for r in select(rows, SETTLED)}
    steps = black_steps(own[1.0])
    for eps in (0.9, 0.8, 0.5):
        for d in (270e-6, 600e-6, 2e-3):
            percent = 100.0 * error_of_h(own[eps], steps, np.array(d), np.array([673.15, 1073.15, 1373.15]))
            print(f"emissivity {eps}, d {1e3 * d:g} mm: h too large by {np.round(percent, 2)} % at 400, 800, 1100 degC")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, default=ROOT / "docs" / "grey_radiation.csv")
    parser.add_argument("--figure", type=Path, default=ROOT / "docs" / "images" / "grey_radiation.png")
    parser.add_argument("--draw-only", action="store_true")
    arguments = parser.parse_args()
    if not arguments.draw_only:
        write_rows(compute(), arguments.csv)
        print_refinement()
    rows = read_rows(arguments.csv)
    draw(rows, arguments.figure)
    print_answers(rows)


if __name__ == "__main__":
    main()
