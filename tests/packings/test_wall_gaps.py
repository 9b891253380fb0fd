"""Particles at the wall as plain arrays: by hand, and against the statistics of the same bed."""

import math

import numpy as np
import pytest

import bedrad
from bedrad.packings.wall_gaps import particles_at_wall
from bedrad.walls import Window
from oracles.layers_beds import free_gas

WALLS = [(bedrad.Tube(5.0), 12.0), (bedrad.Rod(3.0), 12.0), (bedrad.Plate(), (12.0, 10.0))]


def beside(wall, angle, height, gap=0.0, radius=1.0):
    depth = radius * (1.0 + gap)
    radial = wall.radius - depth if wall.kind == "tube" else wall.radius + depth
    return [radial * math.cos(angle), radial * math.sin(angle), height]


@pytest.mark.parametrize("wall", [WALLS[0][0], WALLS[1][0]], ids=["tube", "rod"])
def test_gaps_and_blocks_come_back(wall):
    angles, heights, gaps = [0.3, 2.0, 4.0, 6.2], [1.0, 5.0, 8.0, 11.0], [-0.05, 0.5, 0.005, 1.5]
    bed = bedrad.Packing([beside(wall, *row) for row in zip(angles, heights, gaps, strict=True)], 1.0, wall, 12.0)
    found = particles_at_wall(bed, blocks=3)
    # the last one has nothing in the layer
    assert found.spheres.tolist() == [0, 1, 2]
    assert found.gaps == pytest.approx(gaps[:3], abs=1e-12)
    assert found.diameters.tolist() == [2.0] * 3
    assert found.groups.tolist() == [0, 1, 2]
    assert found.group_areas == pytest.approx([2 * math.pi * wall.radius * 4.0] * 3)
    assert found.wall_area == pytest.approx(found.group_areas.sum(), rel=1e-14)
    assert found.layer_thickness == 1.0
    assert len(found) == 3
    assert "3 particles within" in str(found)
    if wall.kind == "tube":
        assert found.wall_diameter == 10.0
    else:
        assert math.isnan(found.wall_diameter)
    assert len(particles_at_wall(bed, layer_thickness=1.6)) == 4


def test_sizes_have_their_own_gaps_and_one_layer():
    wall = bedrad.Tube(5.0)
    rows, radii = [(0.3, 2.0, 0.2, 1.0), (2.0, 5.0, 0.2, 0.5), (4.0, 8.0, 3.5, 0.5)], [1.0, 0.5, 0.5]
    bed = bedrad.Packing([beside(wall, *row) for row in rows], radii, wall, 12.0)
    found = particles_at_wall(bed)
    # the mean radius is 2/3; the third starts at 1.75
    assert found.layer_thickness == pytest.approx(2 / 3)
    assert found.spheres.tolist() == [0, 1]
    assert found.gaps == pytest.approx([0.2, 0.2])
    assert found.diameters.tolist() == [2.0, 1.0]


@pytest.mark.parametrize(("wall", "period"), WALLS, ids=["tube", "rod", "plate"])
def test_they_are_what_the_statistics_count(wall, period):
    bed = free_gas(wall, seed=1, mean_count=300, length=period)
    stats, found = bedrad.statistics(bed), particles_at_wall(bed)
    touching = found.gaps <= 1e-2
    assert touching.sum() / found.wall_area == pytest.approx(stats.contacts_per_area)
    assert (~touching).sum() == stats.no_contacts
    assert found.gaps[~touching].mean() == pytest.approx(stats.nc_distance)
    assert np.array_equal(found.spheres, bedrad.unrolled_wall(bed).spheres)
    assert len(found.group_areas) == stats.blocks
    assert np.all((found.groups >= 0) & (found.groups < stats.blocks))


def test_a_plate_is_flat_and_a_window_bounds_it():
    bed = free_gas(WALLS[2][0], seed=2, mean_count=300, length=WALLS[2][1])
    found = particles_at_wall(bed, Window((2.0, 8.0), (1.0, 5.0)), blocks=2)
    assert math.isinf(found.wall_diameter)
    assert found.wall_area == pytest.approx(24.0)
    x, y = bed.centers[found.spheres, 0], bed.centers[found.spheres, 1]
    assert np.all((x >= 2) & (x < 8) & (y >= 1) & (y < 5))
    assert np.array_equal(found.groups, (x >= 5).astype(int))


def test_arrays_cannot_be_changed():
    bed = free_gas(WALLS[0][0], seed=1, mean_count=300, length=12.0)
    with pytest.raises(ValueError, match="read-only"):
        particles_at_wall(bed).gaps[0] = 1.0


def test_refusals():
    wall = bedrad.Tube(5.0)
    bed = bedrad.Packing([[0.0, 0.0, 2.0]], 1.0, wall, 12.0)
    with pytest.raises(ValueError, match=r"no sphere with its centre in .* reaches within 1 m of the wall"):
        particles_at_wall(bed)
    with pytest.raises(ValueError, match="the packing is empty"):
        particles_at_wall(bedrad.Packing(np.empty((0, 3)), 1.0, wall, 12.0))
    with pytest.raises(ValueError, match="blocks is 0; expected at least 1"):
        particles_at_wall(bed, blocks=0)
    with pytest.raises(ValueError, match="rise from 0"):
        particles_at_wall(bed, layer_thickness=-1.0)
