"""Small scenes that together run every line of the kernels; as a module, they print what they found.

Every scene returns whole numbers, which must not depend on the compiler, or floats, which may by their rounding.
"""

from __future__ import annotations

import json
import sys

import numpy as np

import bedrad
from bedrad.packings.layer_kernels import ball_in_cylinder, place_in_cylinder
from bedrad.packings.layers import check_window, layer_areas, layer_sums, layer_volumes, whole_volumes
from bedrad.raytrace.meshes import MeshTracer
from bedrad.raytrace.patch_kernels import make_room
from bedrad.raytrace.patches import PatchTracer
from bedrad.raytrace.tracer import GridTracer
from oracles.beds import random_bed
from oracles.nasty_beds import WALLS, any_overlap
from oracles.patch_counts import patch_counts

EDGES = np.array([0.0, 0.7, 2.0, 3.0])


def beds():
    """Periodic and open beds at every wall, many sizes, and nothing at all."""
    for name, (wall, period) in WALLS.items():
        yield f"{name}, periodic", random_bed(wall, 20, seed=3, length=6.0, spread=3.5, period=period)
        yield f"{name}, open", random_bed(wall, 20, seed=3, length=12.0, spread=3.5)
        yield f"{name}, empty", bedrad.Packing(np.empty((0, 3)), 1.0, wall, period=period)
    yield "many sizes", random_bed(bedrad.Plate(), 40, seed=6, length=6.0, spread=3.0, ratio=20.0, period=(6.0, 6.0))


def by_view_factors():
    """Numbers of rays by end, from the public interface."""
    found = {}
    for name, bed in beds():
        factors = bedrad.view_factors(bed, EDGES, rays=256, seed=4, blocks=1)
        found[name] = np.round(factors.history[-1].estimates * factors.rays).astype(int)
    return found


def by_grid():
    """Ends of rays one by one; in a tube some skip the hollow, in a bed with far more spheres inside some go deep."""
    points = np.random.default_rng(1).random((150, 4))
    found = {}
    for name, bed in beds():
        found[name] = GridTracer(bed, EDGES, check_window(bed, None)).fates(points)
    wide = random_bed(bedrad.Tube(14.0), 40, seed=1, length=3.0, spread=14.0, ratio=1.2, period=3.0)
    deep = GridTracer(wide, np.array([0.0, 0.3, 0.6]), wide.window())
    found["deep"] = deep.fates(points)
    assert deep.deep_rays > 0
    return found


def by_patches():
    """Counts by half stratum and end, and rays handed back: by shells, with none, with little room, far apart."""
    bed = random_bed(bedrad.Tube(5.0), 60, seed=3, length=6.0, spread=4.0, period=6.0)
    tracer = PatchTracer(bed, EDGES, check_window(bed, None))
    strata = tracer.strata(512, (1, 0))
    found = {"shells": patch_counts(tracer, strata), "no shell": patch_counts(tracer, strata, hand_back=True)}
    for near, candidates in ((24, 4096), (2048, 24)):
        search, scratch = make_room()
        small = search._replace(near=search.near[:, :near].copy(), candidates=search.candidates[:, :candidates].copy())
        found[f"room for {near}, {candidates}"] = patch_counts(tracer, strata, room=(small, scratch))
    tracer.effective_radius /= 12.0  # several patches a stratum, of which each half draws one
    drawn = tracer.strata(512, (1, 0))
    assert drawn.parts_along * drawn.parts_around > 1
    found["drawn"] = patch_counts(tracer, drawn)
    return {name: [*counts.counts.ravel(), counts.handed_back] for name, counts in found.items()}


def by_mesh(engine):
    """Ends of rays on triangles; where spheres overlap each other and the wall, some rays start inside one."""
    points = np.random.default_rng(1).random((60, 4))
    points[:, 2] *= 0.9
    return {
        f"{engine}, {name}": MeshTracer(bed, EDGES, check_window(bed, None), engine, subdivision=1).fates(points)
        for name, bed in [*beds(), ("overlaps", any_overlap("tube"))]
    }


BALLS = {
    "half in": (1.0, 2.0, 2.0),
    "half in, large": (1.0, 1e3, 1e3),
    "inside": (1.0, 0.2, 3.0),
    "outside": (1.0, 5.0, 3.0),
    "swallows the cylinder": (1.0, 0.05, 0.1),
    "larger than the cylinder, off axis": (1.0, 0.3, 0.4),
    "touches the far side from inside": (1.0, 0.25, 0.75),
    "all but touches the far side": (1.0, 0.25, 0.75 + 1e-10),
    "thin core in a large ball": (5.0, 2.0, 0.1),
    "no cylinder": (1.0, 0.5, 0.0),
}
"""Radius of a ball, distance of its centre from the axis of a cylinder, radius of the cylinder."""


def by_volumes():
    """Volumes and surfaces of cut balls."""
    found = {}
    for name, bed in beds():
        for cut in (layer_volumes, layer_areas):
            found[f"{cut.__name__}, {name}"] = cut(bed, EDGES)
        found[f"blocks, {name}"] = layer_sums(bed, EDGES, blocks=3)
        found[f"whole, {name}"] = whole_volumes(bed.wall, bed.centers, bed.radii, EDGES)
    for name, (r, b, rho) in BALLS.items():
        place = place_in_cylinder(b, 0.0, rho, 0.0)
        parts = [ball_in_cylinder(r, *place, z) for z in (-0.3 * r, 0.05 * r, 0.7 * r, r)]
        found[f"ball, {name}"] = [*place, *np.ravel(parts)]
    return found


def scenes(*engines):
    """All of them: name of the scene to numbers, whole or not."""
    parts = [("view_factors", by_view_factors), ("grid", by_grid), ("patches", by_patches), ("volumes", by_volumes)]
    parts += [("mesh", lambda engine=engine: by_mesh(engine)) for engine in engines]
    return {
        f"{part}, {name}": np.asarray(values).ravel().tolist()
        for part, scene in parts
        for name, values in scene().items()
    }


if __name__ == "__main__":
    print(json.dumps(scenes(*sys.argv[1:])))
