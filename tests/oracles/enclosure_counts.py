"""Counts of rays between the zones of small beds; as a module, it prints them, with or without the compiler."""

from __future__ import annotations

import json

import numpy as np

import bedrad
from oracles.beds import random_bed
from oracles.nasty_beds import WALLS

EDGES = np.array([0.0, 0.7, 2.0, 3.0])


def counts():
    """Name of the bed to numbers of rays, whole ones."""
    found = {}
    for name, (wall, period) in WALLS.items():
        for kind, periods in (("periodic", period), ("open", None))[: 2 if name == "plate" else 1]:
            bed = random_bed(wall, 20, seed=3, length=6.0 if periods else 12.0, spread=3.5, period=periods)
            factors = bedrad.exchange_factors(bed, EDGES, rays=160, seed=1, orientations=2, threads=1)
            absorbed = bedrad.reflected_factors(bed, 0.5, 0.3, EDGES, rays=32, seed=2, threads=1)
            shares = np.array([absorbed.wall, *absorbed.layers, absorbed.beyond, absorbed.escaped])
            found[f"{name}, {kind}"] = np.round(factors.counted * factors.emitted[:, None]).astype(int).tolist()
            found[f"{name}, {kind}, reflected"] = np.round(shares * absorbed.rays).astype(int).tolist()
            found[f"{name}, {kind}, reflections"] = absorbed.reflections
    return found


if __name__ == "__main__":
    print(json.dumps(counts()))
