"""Dense packings in cylinders: solid fraction and wall coverage to 1e-10 of the table, measured by bedrad itself."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.distance import pdist, squareform

import bedrad
from bedrad import heat
from bedrad.packings.layers import layer_volumes
from bedrad.walls import Window
from oracles.dense_cylinder_packings import DIAMETER, construct, packing, table, window

ROWS = table()
NAMES = [f"{name.split(' theta')[0]}-{A:.3f}" for name, A, *_ in ROWS]
BALL = math.pi / 6.0 * DIAMETER**3

rows = pytest.mark.parametrize("row", ROWS, ids=NAMES)


def measured(structure, levels=12):
    """Statistics of the tube from wall to axis: a whole period, or a window of whole rises inside a long helix.

    Blocks are a rise long, so that every one must hold the same.
    """
    whole = structure.levels is not None
    # beyond the window in an open packing: two diameters at each end
    beyond = 0 if whole else 2 * math.ceil(2.0 / structure.rise)
    bed = packing(structure, levels + beyond)
    assert (bed.period is None) != whole
    edges = [0.0, bed.wall.radius]
    return bed, bedrad.statistics(bed, edges=edges, contact_gap=1e-12, window=window(structure, levels), blocks=levels)


def test_the_table_holds_every_kind():
    assert len(ROWS) == 21
    kinds = ("zigzag", "staggered rings", "single helix", "g=2")
    assert [sum(kind in name for name, *_ in ROWS) for kind in kinds] == [4, 9, 7, 1]


@rows
def test_the_contact_conditions_give_the_tabulated_structure(row):
    name, diameter_ratio, fraction, _, rise = row
    structure = construct(name, diameter_ratio, rise)
    assert structure.diameter_ratio == pytest.approx(diameter_ratio, abs=1e-10)
    assert structure.rise == pytest.approx(rise, abs=1e-10)
    assert structure.volume_fraction == pytest.approx(fraction, abs=1e-10)


@rows
def test_solid_fraction_of_the_whole_tube(row):
    name, diameter_ratio, fraction, _, rise = row
    bed, stats = measured(construct(name, diameter_ratio, rise))
    assert stats.packing_fraction == pytest.approx(fraction, abs=1e-10)
    # every rise is like every other: no block differs from the next
    assert stats.packing_fraction_error < 1e-12
    solid = layer_volumes(bed, stats.edges, stats.window).sum()
    assert solid == pytest.approx(stats.spheres * BALL, rel=1e-12)


@rows
def test_wall_coverage(row):
    name, diameter_ratio, _, coverage, rise = row
    structure = construct(name, diameter_ratio, rise)
    _, stats = measured(structure)
    assert stats.contacts_per_area * math.pi * (0.5 * DIAMETER) ** 2 == pytest.approx(coverage, abs=1e-10)
    assert stats.contacts == stats.spheres == 12 * structure.strands
    assert stats.contacts_per_area_error < 1e-12 * stats.contacts_per_area
    assert stats.no_contacts == 0


@rows
def test_spheres_touch_as_they_should_and_overlap_nowhere(row):
    name, diameter_ratio, _, _, rise = row
    structure = construct(name, diameter_ratio, rise)
    levels = 3 + 2 * math.ceil(1.0 / rise)
    # an odd number of levels is no whole period: an open packing, whose middle level has all its neighbours
    bed = packing(structure, levels)
    assert bed.period is None
    assert np.abs(bed.depths / bed.radii - 1.0).max() < 1e-14
    distances = squareform(pdist(bed.centers)) / DIAMETER
    np.fill_diagonal(distances, np.inf)
    assert distances.min() == pytest.approx(1.0, abs=1e-14)
    middle = np.abs(bed.centers[:, 2]) < 0.5 * rise * DIAMETER
    assert middle.sum() == structure.strands
    touching = np.abs(distances[middle] - 1.0) < 1e-13
    assert touching.sum(axis=1).tolist() == [structure.neighbours] * structure.strands
    # the next nearest are clearly apart, so that the count does not hang on its tolerance
    assert distances[middle][~touching].min() > 1.0 + 1e-4


@pytest.mark.parametrize("start", [0.0, 0.3, 1.0 / 7.0])
def test_a_window_of_whole_rises_may_start_anywhere_in_a_helix(start):
    name, diameter_ratio, fraction, _, rise = next(row for row in ROWS if row[0].startswith("(7,5,2)"))
    structure = construct(name, diameter_ratio, rise)
    bed = packing(structure, 60)
    low = (start - 5.0) * structure.rise * DIAMETER
    inside = Window((low, low + 9 * structure.rise * DIAMETER))
    edges = np.array([0.0, 0.5 * DIAMETER, 0.8 * DIAMETER, bed.wall.radius])
    stats = bedrad.statistics(bed, edges=edges, window=inside, blocks=1)
    volumes = np.diff((bed.wall.radius - edges) ** 2) / -(bed.wall.radius**2)
    assert stats.packing_fractions @ volumes == pytest.approx(fraction, abs=1e-10)
    # and each layer holds as much as in any other such window
    again = bedrad.statistics(bed, edges=edges, window=window(structure, 9), blocks=1)
    assert stats.packing_fractions == pytest.approx(again.packing_fractions, rel=1e-12)
    # a window that is no whole number of rises long does not hold whole spheres
    cut = Window((low, low + 9.3 * structure.rise * DIAMETER))
    assert abs(bedrad.statistics(bed, edges=edges, window=cut, blocks=1).packing_fractions @ volumes - fraction) > 1e-5


@pytest.mark.parametrize(("count", "A", "excess"), [(5, 2.70, 5.0), (10, 4.24, 1.2), (20, 7.39, 0.3)])
def test_equation_39_exceeds_the_rings_as_published(count, A, excess):
    name, diameter_ratio, _, coverage, rise = next(r for r in ROWS if r[0] == f"({count},{count},0) staggered rings")
    assert round(diameter_ratio, 2) == A
    _, stats = measured(construct(name, diameter_ratio, rise))
    maximum = heat.wall_layer.maximum_contacts(diameter_ratio, DIAMETER)
    assert round(100.0 * (maximum / stats.contacts_per_area - 1.0), 1) == excess
    assert round(100.0 * (maximum * math.pi * (0.5 * DIAMETER) ** 2 / coverage - 1.0), 1) == excess
