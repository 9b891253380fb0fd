"""The unrolled wall: positions that can be drawn by hand, contacts, sections, windows over the seam."""

import dataclasses
import math

import numpy as np
import pytest

import bedrad
from bedrad.packings.unrolled_wall import unrolled_wall
from bedrad.walls import Window
from oracles.layers_beds import free_gas, hexagonal_sheet

WALLS = [(bedrad.Tube(5.0), 12.0), (bedrad.Rod(3.0), 12.0), (bedrad.Plate(), (12.0, 10.0))]


def beside(wall, angle, height, gap=0.0):
    depth = 1.0 + gap
    radial = wall.radius - depth if wall.kind == "tube" else wall.radius + depth
    return [radial * math.cos(angle), radial * math.sin(angle), height]


@pytest.mark.parametrize("wall", [WALLS[0][0], WALLS[1][0]], ids=["tube", "rod"])
def test_angles_and_heights_come_back(wall):
    angles, heights, gaps = [0.3, 2.0, 4.0, 6.2], [1.0, 5.0, 8.0, 11.0], [0.0, 0.5, 0.005, 1.5]
    bed = bedrad.Packing([beside(wall, *row) for row in zip(angles, heights, gaps, strict=True)], 1.0, wall, 12.0)
    found = unrolled_wall(bed)
    # the last one has nothing in the layer
    assert found.spheres.tolist() == [0, 1, 2]
    assert found.angle == pytest.approx(angles[:3])
    assert found.across == pytest.approx(wall.radius * np.array(angles[:3]))
    assert found.height == pytest.approx(heights[:3])
    assert found.gap == pytest.approx(gaps[:3], abs=1e-12)
    assert found.contact.tolist() == [True, False, True]
    assert found.half_height == pytest.approx([1.0, math.sqrt(0.75), math.sqrt(1 - 0.005**2)])
    # seen from the axis, what lies nearer to it covers more of the wall
    grown = found.half_width > found.half_height
    assert grown.tolist() == [wall.kind == "tube"] * 3
    assert len(unrolled_wall(bed, thickness=1.6 if wall.kind == "tube" else 2.6).spheres) >= 4


@pytest.mark.parametrize(("wall", "period"), WALLS, ids=["tube", "rod", "plate"])
def test_it_shows_what_the_statistics_count(wall, period):
    bed = free_gas(wall, seed=1, mean_count=300, length=period)
    stats, found = bedrad.statistics(bed), unrolled_wall(bed)
    assert int(found.contact.sum()) == stats.contacts
    assert int((~found.contact).sum()) == stats.no_contacts
    assert found.gap[~found.contact].mean() == pytest.approx(stats.nc_distance)


def test_a_plate_has_no_angle():
    found = unrolled_wall(hexagonal_sheet(2, 2))
    assert np.isnan(found.angle).all()
    assert sorted(found.across) == pytest.approx(sorted(hexagonal_sheet(2, 2).centers[:, 1]))
    assert found.half_width.tolist() == found.half_height.tolist() == [1.0] * 8


def test_a_window_over_the_seam_has_its_heights_in_order():
    wall = bedrad.Tube(5.0)
    bed = bedrad.Packing([beside(wall, 1.0, z) for z in (0.5, 4.0, 10.4)], 1.0, wall, 12.0)
    found = unrolled_wall(bed, window=Window((10.0, 13.0)))
    assert found.height == pytest.approx([12.5, 10.4])
    assert found.spheres.tolist() == [0, 2]


def test_nonsense_is_refused():
    bed = hexagonal_sheet(2, 2)
    for arguments, message in (
        ({"contact_gap": -1.0}, r"contact_gap is -1\.0"),
        ({"contact_gap": math.nan}, "contact_gap is nan"),
        ({"thickness": 0.0}, "rise"),
        ({"window": Window((0.0, 1.0))}, "needs a lateral range"),
    ):
        with pytest.raises(ValueError, match=message):
            unrolled_wall(bed, **arguments)
    with pytest.raises(ValueError, match="empty"):
        unrolled_wall(bedrad.Packing([], 1.0, bedrad.Tube(9.0), period=3.0))


def test_the_result_is_frozen():
    found = unrolled_wall(hexagonal_sheet(2, 2))
    for field in dataclasses.fields(found):
        value = getattr(found, field.name)
        if isinstance(value, np.ndarray):
            assert not value.flags.writeable, field.name
