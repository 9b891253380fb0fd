"""How well does the layer at the wall conduct? One bed, particle by particle, and what every model makes of it.

Overlapping random points in a tube are pushed apart until they are a packing of spheres; no engine is needed. The
gap of every particle at the wall gives k_wa particle by particle. Beside it stand the four forms of Watkins (2018)
with the packing fraction, contacts and distance measured on the same bed or taken from his correlations, and the
models of Yagi, Kunii and Ofuchi and of Schluender, in which every particle touches the wall.

Run it with ``python examples/gallery/wall_layer_conductivity.py``; it writes wall_layer_conductivity.png.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

import bedrad
from bedrad.heat import bulk, wall_layer, wall_models, wall_particles
from bedrad.packings.statistics import Statistics
from bedrad.packings.wall_gaps import ParticlesAtWall, particles_at_wall
from bedrad.report import style

DIAMETER, RATIO, LENGTH, FRACTION = 600e-6, 12.9, 7.0, 0.57
"""Particle diameter [m]; tube diameter and length of a period in particle diameters; solid fraction of the tube."""

GAS, TEMPERATURE, VELOCITY = 0.03, 400.0, 0.05
"""Conductivity of the gas [W/(m K)], temperature [K], and the velocity that the correlations are taken at [m/s]."""

K = np.unique([*np.logspace(0, 4, 33), 70.0])
"""Solid over gas conductivity."""


def pushed_apart(seed: int = 1, overlap: float = 5e-3) -> bedrad.Packing:
    """Random points in a periodic piece of tube, moved out of each other until no overlap exceeds some radii."""
    rng = np.random.default_rng(seed)
    wall, radius, period = 0.5 * RATIO * DIAMETER, 0.5 * DIAMETER, LENGTH * DIAMETER
    count = round(FRACTION * 1.5 * RATIO**2 * LENGTH)
    distance, angle = (wall - radius) * np.sqrt(rng.random(count)), rng.uniform(0.0, 2.0 * math.pi, count)
    x = np.stack([distance * np.cos(angle), distance * np.sin(angle), rng.uniform(0.0, period, count)], axis=1)
    for _ in range(20_000):
        x[:, 2] %= period
        tree = cKDTree(x + np.array([2.0 * wall, 2.0 * wall, 0.0]), boxsize=[4.0 * wall, 4.0 * wall, period])
        first, second = tree.query_pairs(DIAMETER, output_type="ndarray").T
        apart = x[first] - x[second]
        apart[:, 2] -= period * np.round(apart[:, 2] / period)
        length = np.linalg.norm(apart, axis=1)
        push = 0.55 * apart * ((DIAMETER - length) / length)[:, None]
        out = np.maximum(np.hypot(x[:, 0], x[:, 1]) - (wall - radius), 0.0)
        if max((DIAMETER - length).max(), out.max()) < overlap * radius:
            return bedrad.Packing(x, radius, bedrad.Tube(wall), period)
        for axis in range(3):
            x[:, axis] += np.bincount(first, push[:, axis], count) - np.bincount(second, push[:, axis], count)
        x[:, :2] *= (1.0 - out / np.maximum(np.hypot(x[:, 0], x[:, 1]), radius))[:, None]
    raise RuntimeError("the spheres did not come apart; take a smaller solid fraction")


def layer(at: ParticlesAtWall, ratio: float) -> wall_particles.ParticleLayer:
    """k_wa of the bed, particle by particle, with its standard error from blocks along the tube."""
    wall = at.wall_area, at.wall_diameter
    return wall_particles.contributions(
        GAS, GAS * ratio, at.gaps, at.diameters, *wall, groups=at.groups, group_areas=at.group_areas
    )


def forms_of(stats: Statistics) -> dict[str, Any]:
    """k_wa against K by the four forms, with what was measured on the bed, and by other means of the distance."""
    measured = GAS, GAS * K, RATIO, DIAMETER, stats.contacts_per_area, stats.packing_fraction
    by_volume = stats.nc_distance_weighted
    return {
        "exact in the tube": wall_layer.conductivity(*measured, by_volume, "cylinder"),
        "general": wall_layer.conductivity(*measured, by_volume, "general"),
        "simplified, a = 0.22": wall_layer.conductivity(*measured),
        "flat": wall_layer.conductivity(*measured, by_volume, "flat"),
        "exact, plain mean": wall_layer.conductivity(*measured, stats.nc_distance, "cylinder"),
        "exact, closing mean": wall_layer.conductivity(*measured, stats.nc_distance_closing, "cylinder"),
    }


def models_of(stats: Statistics) -> dict[str, Any]:
    """k_wa against K by correlation, with every particle in contact, and by other models of the wall layer."""
    measured = GAS, GAS * K, RATIO, DIAMETER, stats.contacts_per_area, stats.packing_fraction
    contacts = wall_layer.contact_ratio(RATIO, VELOCITY, DIAMETER) * wall_layer.maximum_contacts(RATIO, DIAMETER)
    fraction = wall_layer.packing_fraction(RATIO, VELOCITY, DIAMETER)
    schluender = wall_models.schluender_coefficient(GAS, DIAMETER, bulk.modified_free_path(TEMPERATURE, GAS))
    return {
        "simplified form, by correlation": wall_layer.conductivity(GAS, GAS * K, RATIO, DIAMETER, contacts, fraction),
        "all in contact (a = 0)": wall_layer.conductivity(*measured, 0.0, "cylinder"),
        "Yagi, Ofuchi and Kunii": wall_models.ofuchi_kunii_conductivity(GAS, GAS * K, 1.0 - stats.packing_fraction),
        "Schlünder (smooth, isothermal)": np.full(K.size, wall_models.layer_conductivity(schluender, DIAMETER)),
    }


def main(figure: Path = Path("wall_layer_conductivity.png")) -> dict[str, float]:
    """Compute and draw; return k_wa [W/(m K)] at K = 70 by name, and some numbers of the bed."""
    bed = pushed_apart()
    stats, at = bedrad.statistics(bed), particles_at_wall(bed)
    found = [layer(at, k) for k in K]
    exact = np.array([each.conductivity for each in found])
    errors = np.array([each.conductivity_error for each in found])
    forms, models = forms_of(stats), models_of(stats)
    i = int(np.flatnonzero(K == 70.0)[0])
    k_ofuchi = models["Yagi, Ofuchi and Kunii"][i]
    k_bulk = bulk.zehner_bauer_schluender(GAS, 70 * GAS, 0.42, DIAMETER, TEMPERATURE, radiation=False)
    coefficient = {name: wall_models.layer_coefficient(values[i], DIAMETER) for name, values in models.items()}
    print(f"{at}\n{found[i]}\n{wall_particles.mean_distances(70.0, at.gaps, RATIO)}")
    print(
        f"coefficients at K = 70, W/(m2 K): layer {wall_models.layer_coefficient(exact[i], DIAMETER):.0f}; "
        + ", ".join(f"{name} {h:.0f}" for name, h in coefficient.items())
        + f"; Yagi and Kunii's h_w on top of a bulk of {k_bulk:.3f} W/(m K) up to the wall "
        f"{wall_models.yagi_kunii_coefficient(k_ofuchi, k_bulk, DIAMETER):.0f}"
    )
    with style.styled():
        drawn = style.new_figure(10.0, 4.4)
        _draw(drawn, exact, errors, forms, models)
        style.save(drawn, figure, "Conductivity of the wall layer")
    return {
        "particle by particle": float(exact[i]),
        "error": float(errors[i]),
        "packing fraction": stats.packing_fraction,
        "distance by volume": stats.nc_distance_weighted,
        **{name: float(values[i]) for name, values in (forms | models).items()},
    }


def _draw(figure: Any, exact: Any, errors: Any, forms: dict[str, Any], models: dict[str, Any]) -> None:
    left, right = figure.subplots(1, 2)
    left.plot(K, exact / GAS, color="black", linewidth=2.4, label="particle by particle")
    style.band(left, K, exact / GAS, errors / GAS, style.GREY)
    for (name, values), color, marker in zip(models.items(), style.COLOURS, style.MARKERS, strict=False):
        left.plot(K, values / GAS, color=color, marker=marker, markevery=4, label=name)
    left.set(xscale="log", xlabel="solid over gas conductivity, K", ylabel="$k_{wa}/k_g$", ylim=(0.0, 15.0))
    left.set_title("Conductivity of the layer at the wall")
    left.legend(loc="upper left")
    right.axhline(0.0, color="black", linewidth=2.4, label="particle by particle")
    if style.band(right, K, 0.0 * K, 100.0 * errors / exact, style.GREY):
        right.collections[-1].set_label("two standard errors")
    for (name, values), color, marker in zip(forms.items(), style.COLOURS, style.MARKERS, strict=True):
        right.plot(K, 100.0 * (values / exact - 1.0), color=color, marker=marker, markevery=4, label=name)
    right.set(xscale="log", xlabel="solid over gas conductivity, K", ylabel="deviation [%]", ylim=(-8.0, 7.0))
    right.set_title("Forms of Watkins with what the bed measures")
    right.legend(loc="upper left", ncols=2)


if __name__ == "__main__":
    main()
