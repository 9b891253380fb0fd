"""The figure of predictions: what is drawn is what was predicted, in the order of rising temperature."""

import struct

import numpy as np
import pytest

from bedrad.heat.budget import LABELS
from bedrad.report import style
from bedrad.report.prediction_figures import MOST_CURVES, prediction_figure, write_prediction_figure
from report.prediction_samples import TEMPERATURES, one_temperature, two_flows

ORDER = np.argsort(TEMPERATURES)
CURVES = (
    ("heat_transfer_coefficient", "heat_transfer_coefficient_without"),
    ("wall_layer_conductivity", "radiative_conductivity", "bulk_conductivity"),
    ("nusselt", "nusselt_without"),
)
"""What the first three axes hold: of each flow, in this order."""


@pytest.fixture(autouse=True)
def drawing():
    with style.styled():
        yield


@pytest.fixture(scope="module")
def found():
    return two_flows()


def bars(figure):
    """Widths of the bars of each flow, and the names beside them, from the bottom."""
    axes = figure.axes[3]
    names = [label.get_text() for label in axes.get_yticklabels()]
    return [[patch.get_width() for patch in group] for group in axes.containers], names


def test_the_curves_are_the_predicted_arrays(found):
    figure = prediction_figure(found)
    for axes, names in zip(figure.axes, CURVES, strict=False):
        lines = axes.get_lines()
        expected = [(one, name) for one in found for name in names]
        assert len(lines) == len(expected)
        for line, (one, name) in zip(lines, expected, strict=True):
            np.testing.assert_allclose(line.get_xdata(), np.array(TEMPERATURES)[ORDER] - 273.15, rtol=1e-15)
            np.testing.assert_array_equal(line.get_ydata(), getattr(one, name)[ORDER])
        colours = [line.get_color() for line in lines]
        assert colours == [colour for colour in style.COLOURS[:2] for _ in names]


def test_bands_are_two_standard_errors_wide(found):
    figure = prediction_figure(found)
    for place, name in ((0, "heat_transfer_coefficient"), (2, "nusselt")):
        bands = figure.axes[place].collections
        assert len(bands) == len(found)
        for band, one in zip(bands, found, strict=True):
            corners = band.get_paths()[0].vertices
            value, error = getattr(one, name), getattr(one, f"{name}_error")
            for T, low, high in zip(one.wall_temperature - 273.15, value - 2 * error, value + 2 * error, strict=True):
                here = corners[np.isclose(corners[:, 0], T), 1]
                assert (here.min(), here.max()) == (low, high)


def test_bars_are_the_errors_of_the_inputs_at_the_hottest_wall(found):
    figure = prediction_figure(found)
    widths, names = bars(figure)
    hottest = int(np.argmax(TEMPERATURES))
    sizes = [
        {LABELS[name][0]: 100 * error / one.budget.heat_transfer_coefficient[hottest]
         for name, error in zip(one.budget.names, one.budget.contributions[:, hottest], strict=True)}
        for one in found
    ]  # fmt: skip
    largest = {name: max(size[name] for size in sizes) for name in sizes[0]}
    known = sorted((name for name in largest if largest[name] > 0), key=largest.__getitem__)
    assert names == known[-7:]
    for drawn, size in zip(widths, sizes, strict=True):
        np.testing.assert_allclose(drawn, [size[name] for name in names], rtol=1e-14)
    assert figure.axes[3].get_xlabel() == "Standard error of $h$ from the input [%]"
    assert figure.axes[3].get_title(loc="left") == "What matters at 1100 °C"


def test_without_errors_the_bars_are_the_changes_of_h_and_nothing_is_shaded():
    found = two_flows(errors=False)
    figure = prediction_figure(found)
    assert [len(axes.collections) for axes in figure.axes] == [0, 0, 0, 0]
    widths, names = bars(figure)
    hottest = int(np.argmax(TEMPERATURES))
    for drawn, one in zip(widths, found, strict=True):
        size = {
            LABELS[name][0]: x for name, x in zip(one.budget.names, one.budget.elasticities[:, hottest], strict=True)
        }
        np.testing.assert_allclose(drawn, [size[name] for name in names], rtol=1e-14)
    # what matters most is on top
    largest = np.abs(widths).max(axis=0)
    assert len(largest) == 7
    assert (np.diff(largest) >= 0).all()
    others = [i for i, name in enumerate(found[0].budget.names) if LABELS[name][0] not in names]
    assert max(np.abs(one.budget.elasticities[others, hottest]).max() for one in found) <= largest[0]
    assert figure.axes[3].get_xlabel() == "Change of $h$ by 1 % of the input [%]"


def test_the_legend_says_what_parts_the_flows(found):
    figure = prediction_figure(found)
    texts = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert texts == ["$d$ 600 µm, $U$ 0.016 m/s", "$d$ 500 µm, $U$ 0.032 m/s"]
    (alone,) = prediction_figure(found[:1]).axes[0].get_legend().get_texts()
    assert alone.get_text() == "$D$ 7.75 mm, $d$ 600 µm, $U$ 0.016 m/s"
    kinds = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert kinds == ["wall layer, conduction", "wall layer, radiation", "bulk"]


def test_no_more_flows_are_drawn_than_can_be_told_apart(found):
    figure = prediction_figure(found * MOST_CURVES)
    assert len(figure.axes[0].get_lines()) == 2 * MOST_CURVES
    assert len(bars(figure)[0]) == MOST_CURVES


def test_one_temperature_is_a_point_and_a_picture(tmp_path):
    one = one_temperature()
    line = prediction_figure([one]).axes[0].get_lines()[0]
    assert (line.get_xdata().tolist(), line.get_ydata().tolist()) == (
        [pytest.approx(626.85)],
        [float(one.heat_transfer_coefficient)],
    )
    write_prediction_figure([one], tmp_path / "one.png")
    content = (tmp_path / "one.png").read_bytes()
    assert content.startswith(b"\x89PNG")
    assert struct.unpack(">2I", content[16:24]) == (10.4 * style.RESOLUTION, 7.4 * style.RESOLUTION)
