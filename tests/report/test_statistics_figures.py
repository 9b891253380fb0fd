"""Figures of a measured bed: what is drawn is what was measured, at every wall and over every seam."""

import struct

import numpy as np
import pytest

import bedrad
from bedrad.packings.unrolled_wall import unrolled_wall
from bedrad.report import style
from bedrad.report.statistics_figures import CONTACT, NO_CONTACT, profile_figure, unrolled_wall_figure
from bedrad.report.statistics_figures import write_statistics_figures as write
from bedrad.report.statistics_tables import as_data
from oracles.layers_beds import free_gas, hexagonal_sheet


@pytest.fixture(autouse=True)
def drawing():
    with style.styled():
        yield


@pytest.fixture(scope="module")
def gas():
    bed = free_gas(bedrad.Tube(6.0), seed=3, mean_count=300, length=30.0)
    return bed, bedrad.statistics(bed, [0.0, 1.0, 3.0])


def outlines(figure, color):
    """Centres, widths and heights of the ellipses of a colour."""
    from matplotlib.colors import to_rgba

    found = []
    for collection in figure.axes[0].collections:
        if tuple(collection.get_facecolor()[0]) == to_rgba(color):
            size = np.c_[collection.get_widths(), collection.get_heights()]
            found.append(np.c_[collection.get_offsets(), size])
    return np.vstack(found)


def labels(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_every_particle_is_drawn_where_it_lies(gas):
    bed, stats = gas
    wall = unrolled_wall(bed)
    figure = unrolled_wall_figure(wall, "gas")
    axes = figure.axes[0]
    assert axes.get_xlim() == pytest.approx((0, 2e3 * np.pi * 6))
    assert axes.get_ylim() == pytest.approx((0, 30e3))
    for touches, color, count in ((True, CONTACT, stats.contacts), (False, NO_CONTACT, stats.no_contacts)):
        drawn = outlines(figure, color)
        some = wall.contact == touches
        # one and its eight images over the seams
        assert len(drawn) == 9 * count
        shifts = drawn[:count, :2] - 1e3 * np.c_[wall.across[some], wall.height[some]]
        assert np.ptp(shifts, axis=0) == pytest.approx([0, 0], abs=1e-6)
        inside = np.all((drawn[:, :2] >= 0) & (drawn[:, :2] < [2e3 * np.pi * 6, 30e3]), axis=1)
        assert inside.sum() == count
        assert drawn[:count, 3] == pytest.approx(2e3 * wall.half_height[some])
    assert labels(figure) == [
        f"in contact (gap up to 0.01 r): {stats.contacts}", f"without contact (NC): {stats.no_contacts}", "void",
    ]  # fmt: skip


def test_an_overhang_fills_the_ends_but_is_not_counted():
    row = bedrad.Packing([[2.0 * k, 0.0, 1.0] for k in range(10)], 1.0, bedrad.Plate())
    window = bedrad.walls.Window((4.5, 11.5), (-1.0, 1.0))
    figure = unrolled_wall_figure(unrolled_wall(row, window=window, overhang=1.0), "row")
    # centres at 6, 8, 10; those at 4 and 12 reach in
    assert sorted(outlines(figure, CONTACT)[:, 1]) == pytest.approx([4e3, 6e3, 8e3, 10e3, 12e3])
    assert labels(figure)[0].endswith(": 3")


def test_a_plate_is_drawn_without_angles():
    figure = unrolled_wall_figure(unrolled_wall(hexagonal_sheet(2, 2)), "sheet")
    axes = figure.axes[0]
    assert axes.get_xlabel() == "Position along y [mm]"
    assert axes.child_axes == []
    tube = unrolled_wall_figure(unrolled_wall(free_gas(bedrad.Rod(3.0), 1, 50, 9.0)), "rod")
    assert tube.axes[0].child_axes[0].get_xlabel() == "Angle [°]"


def test_the_profile_shows_values_and_two_errors(gas):
    _, stats = gas
    above, below = profile_figure(as_data(stats), "gas $x$").axes[:2]
    # the title is text and no formula
    assert above.get_title(loc="left") == r"gas \$x\$"
    stairs = [patch.get_data() for patch in above.patches if hasattr(patch, "get_data")]
    assert stairs[0].values == pytest.approx(stats.profile)
    assert stairs[1].values == pytest.approx(stats.profile + 2 * stats.profile_error)
    assert stairs[1].baseline == pytest.approx(stats.profile - 2 * stats.profile_error)
    centres, contacts = [patch.get_data() for patch in below.patches]
    filled = stats.centre_density > 0
    assert centres.values[filled] == pytest.approx(8 * stats.centre_density[filled])
    assert np.isnan(centres.values[~filled]).all()
    assert contacts.edges == pytest.approx(1e3 * stats.centre_depths)


def test_without_errors_there_is_no_band():
    stats = bedrad.statistics(hexagonal_sheet(2, 2), [0.0, 1.0], blocks=1)
    above = profile_figure(as_data(stats), "sheet").axes[0]
    assert len([patch for patch in above.patches if hasattr(patch, "get_data")]) == 1


def test_both_are_written(gas, tmp_path):
    bed, stats = gas
    paths = write(as_data(stats), unrolled_wall(bed), tmp_path / "x", "gas")
    assert [path.name for path in paths] == ["x_profile.png", "x_unrolled_wall.png"]
    for path in paths:
        width, height = struct.unpack(">II", path.read_bytes()[16:24])
        assert width > 1000
        assert height > 500
