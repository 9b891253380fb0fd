"""Figures: what is drawn is what the results hold, axes name their units, and a file is whole or not there."""

import errno
import itertools
import subprocess
import sys

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.patches import StepPatch

from bedrad.errors import MissingExtraError
from bedrad.report import style
from bedrad.report.figures import draw, write_figures
from bedrad.report.records import load

ALL = ["heat_transfer", "conductivities", "view_factors", "solid_fraction", "convergence"]


def render(results):
    """All figures of a results file, laid out as they are for writing."""
    with style.styled():
        figures = draw(load(results))
        for figure in figures.values():
            figure.draw_without_rendering()
    return figures


@pytest.fixture(scope="module")
def written(whole, tmp_path_factory):
    """The files of a whole run, and the figures that went into them."""
    figures = []
    save = style.save

    def watch(figure, path, title):
        figures.append(figure)
        save(figure, path, title)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "save", watch)
        paths = write_figures(whole.results, tmp_path_factory.mktemp("figures"))
    return paths, figures


@pytest.fixture(scope="module")
def figures(written):
    return dict(zip(ALL, written[1], strict=True))


def lines(axes, linestyle=None):
    """Points (x, y) of the lines of a style, in the order of drawing."""
    return [line.get_xydata() for line in axes.get_lines() if linestyle in (None, line.get_linestyle())]


def points(x, y):
    return np.column_stack(np.broadcast_arrays(x, y))


def legend_texts(holder):
    return [text.get_text() for legend in holder for text in legend.get_texts()]


def test_every_axis_names_its_unit(figures):
    for name, figure in figures.items():
        for axes in figure.axes:
            texts = {axes.get_xlabel(), axes.get_ylabel()} | {child.get_xlabel() for child in axes.child_axes}
            for text in texts - {""}:
                assert text.endswith("]"), (name, text)


def test_heat_transfer_of_the_tube_and_of_the_published_systems(figures, whole):
    figure = figures["heat_transfer"]
    tube, published, tube_gain, published_gain = figure.axes
    assert tube.get_ylabel() == "Heat transfer coefficient $h$ [W/(m² K)]"
    assert tube_gain.get_xlabel() == published_gain.get_xlabel() == "Wall temperature [°C]"
    assert tube_gain.get_ylabel() == "Added by radiation [%]"
    for axes, gains, keys in (
        (tube, tube_gain, ("measured", "correlations")),
        (published, published_gain, ("configuration_2",)),
    ):
        cases = [whole.data["prediction"][key][2] for key in keys]
        for case, solid, dashed, gain in zip(cases, lines(axes, "-"), lines(axes, "--"), lines(gains), strict=True):
            celsius = case["wall_temperature"] - 273.15
            h, h0 = case["heat_transfer_coefficient"], case["heat_transfer_coefficient_without"]
            np.testing.assert_allclose(solid, points(celsius, h), rtol=1e-12)
            np.testing.assert_allclose(dashed, points(celsius, h0), rtol=1e-12)
            np.testing.assert_allclose(gain, points(celsius, 100 * (h / h0 - 1)), rtol=1e-12)


def test_name_of_the_job_is_text_and_no_formula(figures):
    """As matplotlib shows it; a formula it cannot read would end in an error."""
    for figure in figures.values():
        assert figure.axes[0].get_title(loc="left") == r"0.6 mm [bold]zirconia[/bold], \$\no_formula\$"


def test_legend_of_the_heat_transfer(figures):
    tube, published = figures["heat_transfer"].axes[:2]
    assert legend_texts([tube.get_legend()]) == [
        "measured packing, traced view factors",
        "correlations, published view factors",
        "with radiation",
        "without radiation",
        "± 2 standard errors of what is measured",
    ]
    assert legend_texts([published.get_legend()])[0] == "configuration 2: A 28.2, 270 µm, 0.020 m/s"
    # the correlations state no errors, so there is no band to explain
    assert not any("standard error" in text for text in legend_texts([published.get_legend()]))


def test_bands_are_two_standard_errors(figures, whole):
    tube = figures["heat_transfer"].axes[0]
    case = whole.data["prediction"]["measured"][2]
    outlines = [band.get_paths()[0].vertices for band in tube.collections]
    assert len(outlines) == 2
    for outline, name in zip(outlines, ("heat_transfer_coefficient", "heat_transfer_coefficient_without"), strict=True):
        high, low = (case[name] + sign * 2 * case[f"{name}_error"] for sign in (1, -1))
        assert outline[:, 1].max() == pytest.approx(high.max(), rel=1e-12)
        assert outline[:, 1].min() == pytest.approx(low.min(), rel=1e-12)


def test_a_case_keeps_its_colour_from_panel_to_panel(figures):
    tube, published, tube_gain, published_gain = figures["heat_transfer"].axes
    for above, below in ((tube, tube_gain), (published, published_gain)):
        seen = list(dict.fromkeys(to_hex(line.get_color()) for line in above.get_lines()))
        assert seen == [to_hex(line.get_color()) for line in below.get_lines()]
    assert len({to_hex(c) for c in style.COLOURS}) == len(style.COLOURS) == len(style.MARKERS)


def test_conductivities(figures, whole):
    (axes,) = figures["conductivities"].axes
    assert axes.get_ylabel() == "Conductivity of the wall layer [W/(m K)]"
    for k, key in enumerate(("measured", "correlations")):
        case = whole.data["prediction"][key][2]
        celsius = case["wall_temperature"] - 273.15
        for linestyle, name in (("-", "wall_layer_conductivity"), ("--", "radiative_conductivity")):
            np.testing.assert_allclose(lines(axes, linestyle)[k], points(celsius, case[name]), rtol=1e-12)


def test_view_factors_lie_at_the_depths_of_their_layers(figures, whole):
    main, side = figures["view_factors"].axes
    data = whole.data["view_factors"]
    assert main.get_yscale() == "log"
    assert main.get_xlabel() == "Depth below the wall [mm]"
    assert main.get_ylabel() == "View factor from the wall [–]"
    traced, published = style.COLOURS[:2]
    levels = [
        line.get_xydata() for line in main.get_lines() if line.get_color() == traced and len(line.get_xdata()) == 2
    ]
    # each line has both ends of its layer; the caps of the error bars have one point each
    for k, level in enumerate(levels):
        np.testing.assert_allclose(level, points(1e3 * data["edges"][k : k + 2], data["layers"][k]), rtol=1e-12)
    assert len(levels) == 3
    given = [line.get_ydata() for line in main.get_lines() if line.get_color() == published]
    assert [set(values) for values in given] == [{0.80}, {0.18}, {0.02}]
    shares = [line.get_xydata()[0] for line in side.get_lines() if line.get_marker() == "o"]
    np.testing.assert_allclose(shares, points([0, 1, 2], [data["beyond"], data["wall"], data["escaped"]]), rtol=1e-12)
    assert [tick.get_text().split("\n")[0] for tick in side.get_xticklabels()] == [
        "beyond the",
        "back to",
        "out at the",
    ]


def test_error_bars_of_view_factors_are_two_errors_of_rays_and_bed(figures, whole):
    main = figures["view_factors"].axes[0]
    data = whole.data["view_factors"]
    for k, bar in enumerate(main.containers):
        segment = bar.lines[2][0].get_segments()[0]
        error = 2 * np.hypot(data["layers_error"][k], data["layers_bed_error"][k])
        np.testing.assert_allclose(segment[:, 1], data["layers"][k] + error * np.array([-1, 1]), rtol=1e-12)


def test_depths_also_in_radii(figures):
    for name in ("view_factors", "solid_fraction"):
        main = figures[name].axes[0]
        (above,) = main.child_axes
        assert above.get_xlabel() == "Depth [particle radii]"
        assert main.get_xlim() == pytest.approx((0.0, 1.5))
        assert above.get_xlim() == pytest.approx((0.0, 5.0))


def test_solid_fraction_profile_and_means(figures, whole):
    (axes,) = figures["solid_fraction"].axes
    data = whole.data["statistics"]
    profile, band = [patch.get_data() for patch in axes.patches if isinstance(patch, StepPatch)]
    np.testing.assert_array_equal(profile.values, data["profile"])
    np.testing.assert_allclose(profile.edges, 1e3 * data["profile_depths"], rtol=1e-12)
    np.testing.assert_allclose(band.values, data["profile"] + 0.008, rtol=1e-12)
    np.testing.assert_allclose(band.baseline, data["profile"] - 0.008, rtol=1e-12)
    means = [line.get_xydata() for line in axes.get_lines() if line.get_label() == "mean of each layer"]
    for k, mean in enumerate(means):
        np.testing.assert_allclose(
            mean, points(1e3 * data["edges"][k : k + 2], data["packing_fractions"][k]), rtol=1e-12
        )
    assert len(means) == 3
    (correlated,) = lines(axes, ":")
    np.testing.assert_allclose(correlated, points([0.0, 0.3], [0.42, 0.42]), rtol=1e-12)
    assert axes.get_ylabel() == "Solid fraction [–]"
    texts = [text.get_text() for text in axes.texts]
    assert texts[:4] == ["wall layer", "0.4501 ± 0.0029", "layer 2", "0.6063 ± 0.0011"]
    shared = legend_texts(figures["solid_fraction"].legends)
    assert shared.count("mean of each layer") == 1
    assert "wall layer by correlation (Watkins 2018, eq. 38): 0.420" in shared


def test_convergence_against_time_and_rays(figures, whole):
    by_time, by_rays, above = figures["convergence"].axes
    data = whole.data["convergence"]
    assert by_time.get_xlabel() == "Run time, without set-up of the grid [s]"
    assert by_rays.get_xlabel() == above.get_xlabel() == "Number of rays [–]"
    assert by_time.get_ylabel() == "Error of the view factors [–]"
    assert [axes.get_xscale() + axes.get_yscale() for axes in (by_time, by_rays)] == ["loglog", "loglog"]
    for axes, x in ((by_time, data["seconds"]), (by_rays, data["rays"])):
        order = np.argsort(x)
        true = [bar.lines[0].get_xydata() for bar in axes.containers]
        # escaped: 1.2e-5 of 32768 rays is less than one
        assert len(true) == len(lines(axes, "-")) == 5 - 1
        drawn = [0, 1, 2, 4]
        for k, dots, line in zip(drawn, true, lines(axes, "-"), strict=True):
            np.testing.assert_allclose(dots, points(x, data["true_error"][:, k])[order], rtol=1e-12)
            np.testing.assert_allclose(line, points(x, data["stated_error"][:, k])[order], rtol=1e-12)


def test_scatter_of_a_root_mean_square_over_eight_runs_is_a_quarter(figures, whole):
    bar = figures["convergence"].axes[1].containers[0]
    first = bar.lines[2][0].get_segments()[0]
    error = whole.data["convergence"]["true_error"][0, 0]
    np.testing.assert_allclose(first[:, 1], error * np.array([0.75, 1.25]), rtol=1e-12)


def test_guide_falls_as_one_over_the_root_of_the_rays(figures, whole):
    by_time, by_rays = figures["convergence"].axes[:2]
    data = whole.data["convergence"]
    (guide,) = lines(by_rays, ":")
    slope = np.diff(np.log(guide[:, 1])) / np.diff(np.log(guide[:, 0]))
    np.testing.assert_allclose(slope, -0.5, rtol=1e-9)
    assert (guide[:, 1] > data["true_error"].max(axis=1)).all()
    (timed,) = lines(by_time, ":")
    order = np.argsort(data["seconds"])
    np.testing.assert_allclose(timed, points(data["seconds"], guide[:, 1])[order], rtol=1e-12)


def test_legend_of_the_convergence_names_exponents_and_what_is_left_out(figures):
    texts = legend_texts(figures["convergence"].legends)
    assert "wall layer: exponent −0.485 ± 0.031" in texts
    assert "not shown, met by fewer than 100 rays of the longest run: beyond, escaped" in texts
    assert any(text.startswith("true error: rms distance of 8 runs to one of 16.8 million rays") for text in texts)


def test_rays_above_the_run_time_stand_at_their_run_times(figures, whole):
    above = figures["convergence"].axes[2]
    data = whole.data["convergence"]
    ticks = dict(zip([text.get_text() for text in above.get_xticklabels()], above.get_xticks(), strict=True))
    names = ["1.02 k", "2.05 k", "4.1 k", "8.19 k", "16.4 k", "32.8 k"]
    expected = dict(zip(names, data["seconds"], strict=True))
    assert list(ticks)[-1] == names[-1]
    for name, place in ticks.items():
        assert place == pytest.approx(expected[name], rel=1e-12)


def of_runs(fabricate, rays, seconds):
    """The axes of the convergence figure of these runs: by time, by rays, rays above the time."""

    def change(data):
        for name in ("true_error", "stated_error"):
            data[name] = data[name][: len(rays)]
        data |= {"rays": np.array(rays), "seconds": np.array(seconds)}

    figure = render(fabricate().add("convergence", change).results)["convergence"]
    return figure, figure.axes


@pytest.mark.parametrize(
    ("rays", "seconds"),
    [
        ([4096], [0.02]),
        ([4096, 4096, 4096], [0.02, 0.02, 0.02]),
        ([1024, 2048, 4096], [0.02, 0.02, 0.02]),
        ([100_000, 120_000], [0.9, 1.1]),
        ([131_072, 262_144], [1.3e-5, 1.9e-5]),
    ],
)
def test_few_or_equal_runs_stand_in_the_middle_of_axes_a_decade_long(fabricate, rays, seconds):
    figure, (by_time, by_rays, above) = of_runs(fabricate, rays, seconds)
    for axes, values in ((by_time, seconds), (by_rays, rays)):
        low, high = np.log10(axes.get_xlim())
        assert high - low == pytest.approx(1.1)
        assert 0.5 * (low + high) == pytest.approx(0.5 * np.log10(values[0] * values[-1]))
    assert above.get_xlim() == by_time.get_xlim()
    assert set(above.get_xticks()) <= set(seconds)
    renderer = FigureCanvasAgg(figure).get_renderer()
    for axes in (by_time, by_rays, above):
        low, high = axes.get_xlim()
        shown = [
            text.get_window_extent(renderer)
            for place, text in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
            if low <= place <= high and text.get_text()
        ]
        assert len(shown) >= (1 if axes is above else 3)
        assert all(left.x1 < right.x0 for left, right in itertools.pairwise(shown))
        assert not any(text.get_text() for text in axes.xaxis.get_minorticklabels())


def test_the_stated_error_of_a_single_run_is_seen(fabricate):
    _, (by_time, *_) = of_runs(fabricate, [4096], [0.02])
    stated = [line for line in by_time.get_lines() if line.get_marker() == "_"]
    assert len(stated) == 2  # the other four targets are met by too few of 4096 rays


def test_a_run_that_took_no_time_that_could_be_measured_is_left_out(fabricate):
    _, (by_time, by_rays, above) = of_runs(fabricate, [4096, 8192], [0.0, 0.045])
    assert above.get_xticks() == pytest.approx([0.045])
    assert [text.get_text() for text in above.get_xticklabels()] == ["8.19 k"]
    drawn = by_time.containers[0].lines[0].get_xydata()
    assert np.isnan(drawn[:, 0]).sum() == 1
    assert len(by_rays.containers[0].lines[0].get_xydata()) == 2


def test_a_stated_error_of_zero_is_not_drawn(fabricate):
    made = fabricate()

    def more_rays(data):
        data["rays"] = data["rays"] * 8

    figure = render(made.add("convergence", more_rays).results)["convergence"]
    by_rays = figure.axes[1]
    beyond = lines(by_rays, "-")[3]
    assert np.isnan(beyond[:2, 1]).all()
    np.testing.assert_allclose(beyond[2:, 1], made.data["convergence"]["stated_error"][2:, 3], rtol=1e-12)
    assert "beyond the last layer" in legend_texts(figure.legends)  # its exponent is nan


def test_one_wall_temperature_no_published_systems_and_one_block(fabricate):
    def single(prediction):
        del prediction["configuration_2"]
        for _, _, case in prediction.values():
            for name, value in case.items():
                if isinstance(value, np.ndarray) and len(value) == 11:
                    case[name] = value[-1:]

    def one_block(statistics):
        for name, value in statistics.items():
            if name.endswith("_error"):
                statistics[name] = np.full_like(value, np.nan)

    made = fabricate().add("prediction", single).add("statistics", one_block)
    figures = render(made.results)
    assert len(figures["heat_transfer"].axes) == 2
    measured = lines(figures["heat_transfer"].axes[0], "-")[0]
    assert measured[:, 0] == pytest.approx([1100.0])
    assert figures["heat_transfer"].axes[0].get_lines()[0].get_marker() == "o"
    patches = [patch for patch in figures["solid_fraction"].axes[0].patches if isinstance(patch, StepPatch)]
    assert len(patches) == 1
    assert [text.get_text() for text in figures["solid_fraction"].axes[0].texts][1] == "0.450"


def test_nothing_escapes_and_many_layers(fabricate):
    def change(data):
        data["escaped"] = data["escaped_error"] = data["escaped_bed_error"] = 0.0
        data["layers"] = np.array([0.8, 0.15, 0.03, 0.005, 0.0])
        data["layers_error"] = data["layers_bed_error"] = np.full(5, 1e-4)
        data["covariance"] = np.zeros((8, 8))
        data["edges"] = 3e-4 * np.array([0.0, 1.0, 3.0, 5.0, 7.0, 9.0])

    figure = render(fabricate().add("view_factors", change).results)["view_factors"]
    main, side = figure.axes
    assert "none" in [text.get_text() for text in side.texts]
    assert len(main.containers) == 4  # the fifth layer is met by no ray
    assert [text.get_text() for text in main.texts if text.get_text() in ("0.8", "none")] == ["0.8", "none"]


@pytest.mark.parametrize(
    ("stage", "names"),
    [
        ("prediction", ["heat_transfer", "conductivities"]),
        ("view_factors", ["view_factors"]),
        ("statistics", ["solid_fraction"]),
        ("convergence", ["convergence"]),
    ],
)
def test_only_stages_that_ran(fabricate, stage, names):
    with style.styled():
        assert list(draw(load(fabricate(stage).results))) == names


def test_files_are_whole_pngs_named_after_the_results(written):
    paths = written[0]
    assert [path.name for path in paths] == [f"bed_{name}.png" for name in ALL]
    assert sorted(paths[0].parent.iterdir()) == sorted(paths)
    for path in paths:
        content = path.read_bytes()
        assert content.startswith(b"\x89PNG\r\n")
        assert content.rstrip().endswith(b"IEND\xaeB`\x82")
        assert int.from_bytes(content[16:20], "big") >= 900  # pixels across


def test_matplotlib_stays_as_it_was(fabricate, tmp_path):
    made = fabricate("statistics")
    settings, pyplot = dict(mpl.rcParams), "matplotlib.pyplot" in sys.modules
    write_figures(made.results, tmp_path)
    assert dict(mpl.rcParams) == settings
    assert ("matplotlib.pyplot" in sys.modules) == pyplot


def test_full_disk_leaves_no_half_figure(fabricate, tmp_path, monkeypatch):
    made = fabricate("statistics")

    def full(self, stream, **_):
        stream.write(b"\x89PNG half")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(FigureCanvasAgg, "print_png", full)
    with pytest.raises(OSError, match="No space left"):
        write_figures(made.results, tmp_path)
    assert list(tmp_path.iterdir()) == [tmp_path / "bed.h5"]


def test_without_matplotlib_the_extra_is_named(whole, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingExtraError, match=r'pip install "bedrad\[view\]"'):
        write_figures(whole.results, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_matplotlib_loads_with_the_first_figure_only():
    code = "import sys, bedrad.report.figures, bedrad.report.tables; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_labels_keep_their_distance_and_the_last_is_kept():
    assert style.spread(np.array([0.0, 0.05, 0.1, 0.5, 0.9, 1.0]), 0.2) == [2, 3, 5]
    # run times need not rise with the number of rays
    assert style.spread(np.array([0.3, 0.0, 0.5, 1.0]), 0.25) == [1, 2, 3]
