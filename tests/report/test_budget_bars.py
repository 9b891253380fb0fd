"""Bars of a budget: which inputs they stand for, in what order, and how long they are."""

import numpy as np
import pytest

from bedrad.report import style
from bedrad.report.budget_bars import draw_bars, hottest_wall, input_bars

T = [500.0, 1300.0, 900.0]
CONTRIBUTIONS = [[1.0, 4.0, 2.0], [0.0, 0.0, 0.0], [3.0, 8.0, 5.0]]
ELASTICITIES = [[0.1, -0.9, 0.3], [0.2, 0.5, 0.6], [0.7, 0.0, 0.9]]
NAMES = ("porosity", "velocity", "emissivity")


def wall(contributions=CONTRIBUTIONS, names=NAMES):
    return hottest_wall(names, T, contributions, ELASTICITIES[: len(names)], [100.0, 400.0, 200.0])


def test_the_hottest_wall_is_taken_wherever_it_stands():
    found = wall()
    assert found.inputs == NAMES
    np.testing.assert_allclose(found.errors, [1.0, 0.0, 2.0], rtol=1e-15)  # in per cent of 400
    np.testing.assert_array_equal(found.elasticities, [-0.9, 0.5, 0.0])


def test_errors_go_before_elasticities_and_what_does_nothing_is_left_out():
    bars = input_bars([wall()], 8)
    assert bars.stated
    assert bars.inputs == ["porosity", "emissivity"]
    np.testing.assert_allclose(bars.sizes, [[1.0, 2.0]], rtol=1e-15)
    bars = input_bars([wall(np.zeros((3, 3)))], 8)
    assert not bars.stated
    assert bars.inputs == ["velocity", "porosity"]
    np.testing.assert_array_equal(bars.sizes, [[0.5, -0.9]])


def test_the_most_that_are_wanted_are_those_that_matter_most():
    assert input_bars([wall(np.zeros((3, 3)))], 1).inputs == ["porosity"]


def test_a_budget_that_lacks_an_input_has_no_bar_there():
    bars = input_bars([wall(CONTRIBUTIONS[:2], NAMES[:2]), wall()], 8)
    assert bars.inputs == ["porosity", "emissivity"]
    np.testing.assert_allclose(bars.sizes, [[1.0, 0.0], [1.0, 2.0]], rtol=1e-15)


def test_bars_stand_side_by_side_with_the_first_budget_above():
    with style.styled():
        axes = style.new_figure(4, 3).subplots()
        draw_bars(axes, input_bars([wall(), wall()], 8), 9.0, ["a $", "b"])
    first, second = axes.containers
    assert [bar.get_width() for bar in first] == pytest.approx([1.0, 2.0])
    assert all(a.get_y() >= b.get_y() + b.get_height() for a, b in zip(first, second, strict=True))
    assert [text.get_text() for text in axes.get_yticklabels()] == ["porosity of the bulk", "emissivity in the bulk"]
    # a dollar sign would start a formula
    assert axes.get_legend_handles_labels()[1] == [r"a \$", "b"]
