"""What grey surfaces do to the radiation from a hot wall into a bed of spheres.

A small bed is made here: hexagonal close packing of 0.6 mm spheres on a plate, of which one in eight is left out. The
exchange factors between the wall and four layers are traced once and solved for grey surfaces of any emissivity, one
radiosity a layer (lines). Rays that are reflected where they end know no such assumption (markers).

    python examples/gallery/grey_walls.py
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import bedrad
from bedrad.heat import grey_enclosure, radiation
from bedrad.report import style

DIAMETER, TEMPERATURE = 600e-6, 1273.15
LAYERS = 4
REFLECTED = (1.0, 0.8, 0.5, 0.2)


class GreyWalls(NamedTuple):
    """k_rad [W/(m K)] against emissivity by zones, by reflected rays with standard errors, and of black surfaces."""

    emissivities: NDArray[np.float64]
    by_zones: NDArray[np.float64]
    by_rays: dict[float, tuple[float, float]]
    black: float


def close_packed(across: int = 6, layers: int = 5, left_out: float = 0.125) -> bedrad.Packing:
    """Hexagonal close packing on a plate, periodic, of which a random part is left out."""
    i, j, k = np.meshgrid(np.arange(across), np.arange(2 * across), np.arange(layers), indexing="ij")
    x = 2.0 * i + j % 2 + k % 2
    y = np.sqrt(3.0) * (j + k % 2 / 3.0)
    z = 1.0 + np.sqrt(8.0 / 3.0) * k
    kept = np.random.default_rng(1).random(x.size) >= left_out
    centers = 0.5 * DIAMETER * np.column_stack([x.ravel(), y.ravel(), z.ravel()])[kept]
    period = (across * DIAMETER, np.sqrt(3.0) * across * DIAMETER)
    return bedrad.Packing(centers, 0.5 * DIAMETER, bedrad.Plate(), period)


def compute() -> tuple[GreyWalls, NDArray[np.float64]]:
    """Numbers of the figure, and the factors to the layers (emissivities, layers) by zones."""
    packing = close_packed()
    edges = bedrad.layer_edges(packing, LAYERS)
    exchange = bedrad.exchange_factors(packing, edges, rays=2**18, seed=1)
    print(exchange)
    emissivities = np.linspace(0.05, 1.0, 20)
    factors = grey_enclosure.wall_exchange_factors(
        exchange.exchange, exchange.lost, exchange.areas, emissivities, emissivities
    )[:, :LAYERS]
    by_rays = {}
    for e in REFLECTED:
        found = bedrad.reflected_factors(packing, e, e, edges, rays=2**16, seed=1)
        steps = e * found.replicates[:, 1 : LAYERS + 1] @ np.arange(1, LAYERS + 1)
        error = np.sqrt(len(steps) - 1) * steps.std()
        one = float(radiation.conductivity([1.0], DIAMETER, TEMPERATURE))
        by_rays[e] = (float(radiation.conductivity(e * found.layers, DIAMETER, TEMPERATURE)), one * float(error))
    black = bedrad.view_factors(packing, edges, tolerance=1e-3)
    numbers = GreyWalls(
        emissivities,
        radiation.conductivity(factors, DIAMETER, TEMPERATURE),
        by_rays,
        float(radiation.conductivity(black.layers, DIAMETER, TEMPERATURE)),
    )
    return numbers, factors


def main(figure: Path = Path("grey_walls.png")) -> GreyWalls:
    numbers, factors = compute()
    print(f"k_rad of black surfaces {numbers.black:.4f} W/(m K); grey, by reflected rays and by zones:")
    for e, (value, error) in numbers.by_rays.items():
        zones = np.interp(e, numbers.emissivities, numbers.by_zones)
        print(f"emissivity {e:g}: {value:.4f} +- {error:.4f}, {zones:.4f} W/(m K)")
    with style.styled():
        drawing = style.new_figure(9.5, 4.0)
        left, right = drawing.subplots(1, 2)
        left.plot(numbers.emissivities, numbers.by_zones, color=style.COLOURS[0], label="one radiosity a layer")
        values, errors = np.array(list(numbers.by_rays.values())).T
        left.errorbar(
            list(numbers.by_rays), values, 2.0 * errors, fmt=style.MARKERS[1], color=style.COLOURS[1],
            label="reflected rays, ± 2 standard errors",
        )  # fmt: skip
        left.axhline(numbers.black, color=style.GREY, linestyle=":", label="black, from the view factors")
        left.set(xlabel="Emissivity of wall and particles", ylabel="k_rad at 1000 °C [W/(m K)]", xlim=(0, 1.03), ylim=0)
        left.legend(loc="upper left", bbox_to_anchor=(0.0, 0.93))
        layers = np.arange(1, LAYERS + 1)
        for e, colour, marker in zip((1.0, 0.8, 0.5, 0.2), style.COLOURS, style.MARKERS, strict=False):
            row = factors[np.argmin(np.abs(numbers.emissivities - e))]
            right.plot(layers, row, color=colour, marker=marker, label=f"emissivity {e:g}")
        right.set(xlabel="Layer", ylabel="Total exchange factor from the wall", yscale="log", xticks=layers)
        right.legend()
        style.save(drawing, figure, "Grey wall and particles")
    return numbers


if __name__ == "__main__":
    main()
