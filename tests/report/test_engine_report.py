"""The comparison of engines as tables and figure: what is shown is what was measured."""

import csv
import dataclasses
import io
import math
import re

import numpy as np
import pytest
from rich.console import Console

from bedrad.raytrace.engine_comparison import EngineComparison, Trial
from bedrad.raytrace.engine_errors import EngineRuns, Reference, power_law
from bedrad.report import style
from bedrad.report.engine_figure import comparison_figure, write_comparison_figure
from bedrad.report.engine_tables import comparison_summary, write_comparison_tables

NAMES = ("layer 1", "beyond", "wall", "escaped")
TOLERANCE = 1e-4
REASON = "set-up would take about 40 s, and 27 s of the budget are left"


def runs(name, family, seconds_per_ray, setup, bias=None, bias_error=None, last=18):
    """An engine whose error falls by the root of the rays; layer 1, and targets that nothing meets."""
    rays = 2 ** np.arange(13, last + 1)
    stated = np.outer(0.4 / np.sqrt(rays), [1.0, 0.5, 0.2, 0.0])
    true = stated * 1.1
    biases = np.array([bias or 0.0, 0.0, 0.0, 0.0])
    errors = np.array([bias_error or 0.0, 0.0, 0.0, 0.0])
    slope = np.array([-0.5, -0.5, -0.5, np.nan])
    return EngineRuns(
        name, family, "some details", bias is not None, setup, rays, seconds_per_ray * rays, np.hypot(true, biases),
        true, stated, biases, errors, slope, 0.01 + 0 * slope, slope, 0.01 + 0 * slope,
        *power_law(rays, stated), 8,
    )  # fmt: skip


@pytest.fixture(scope="module")
def found():
    return EngineComparison(
        names=NAMES,
        engines=(
            runs("bedrad", "bedrad", 2e-8, 0.05),
            runs("grid walk", "grid walk", 1e-7, 1e-3),
            runs("open3d, subdivision 2", "open3d", 5e-7, 0.7, -9e-4, 3e-5),
            runs("embree, subdivision 2", "embree", 6e-7, 0.9, -9e-4, 3e-5),
            runs("open3d, subdivision 3", "open3d", 7e-7, 4.0, -6e-5, 2e-5, last=15),
        ),
        left_out=(("open3d, subdivision 4", REASON), ("embree, subdivision 3", "out of memory")),
        trials=(
            Trial("open3d", "inscribed", True, -0.0119, 2e-4, 1.9e6),
            Trial("open3d", "equal area", True, -9e-4, 1e-4, 2.1e6),
            Trial("open3d", "equal area", False, -9e-4, 1e-4, 1.2e6),
            Trial("embree", "equal area", True, -9e-4, 1e-4, 1.7e6),
            Trial("embree", "equal area", False, -9e-4, 1e-4, 1.1e6),
        ),
        reference=Reference(np.array([0.8, 0.15, 0.05, 0.0]), np.array([2e-5, 1e-5, 1e-5, 0.0]), 2**27, 20.0),
        budget=120.0,
        total_seconds=118.0,
    )


@pytest.fixture(scope="module")
def text(found):
    stream = io.StringIO()
    Console(file=stream, width=80, no_color=True).print(comparison_summary(found, TOLERANCE))
    return stream.getvalue()


@pytest.fixture(scope="module")
def tables(found, tmp_path_factory):
    paths = write_comparison_tables(found, TOLERANCE, tmp_path_factory.mktemp("tables") / "bed.v2")
    assert [path.name for path in paths] == ["bed.v2_engines.csv", "bed.v2_runs.csv"]
    return [list(csv.DictReader(path.read_text(encoding="utf-8").splitlines())) for path in paths]


@pytest.fixture(scope="module")
def figure(found):
    with style.styled():
        drawn = comparison_figure(found, TOLERANCE, "$bed$")
        drawn.draw_without_rendering()
    return drawn


def test_fits_in_eighty_columns_and_loses_nothing(text):
    assert max(len(line) for line in text.splitlines()) <= 80
    assert "…" not in text


def test_costs_are_those_measured(text, found):
    costs = text[: text.index("Error of F_w1")]
    rows = {
        m[1]: re.split(r"\s{2,}", m[2].strip())
        for m in re.finditer(r"^ (bedrad|grid walk|\w+, subdivision \d)(.*)$", costs, re.M)
    }
    assert list(rows) == [runs.name for runs in found.engines]
    # (0.4/1e-4)^2 rays at 50 million a second
    assert rows["bedrad"] == ["0.05", "50", "none", "0.32", "0.37"]
    assert rows["open3d, subdivision 2"] == ["0.7", "2", "-9.00 ± 0.30", "never", "never"]
    noise = math.sqrt(1e-8 - (6e-5**2 - 2e-5**2))
    seconds = (0.4 / noise) ** 2 * 7e-7
    assert rows["open3d, subdivision 3"][2:] == ["-0.60 ± 0.20", f"{seconds:.3g}", f"{seconds + 4.0:.3g}"]


def test_choices_reference_and_what_is_left_out_are_told(text):
    words = " ".join(text.split())
    assert "reference: F_w1 = 0.800000 ± 0.000020, independent grid walk of 134,217,728 rays" in words
    assert "scaling of meshes: equal area, by the coarsest's bias [10⁻⁴]: inscribed -119.0 ± 2.0, equal area" in words
    assert "open3d: 2.1 million rays a second sorted, 1.2 unsorted" in words
    assert "embree: 1.7 million rays a second sorted, 1.1 unsorted" in words
    assert f"left out: open3d, subdivision 4: {REASON}" in words
    assert "rms distance of 8 runs to the reference, ± 25 %" in words


def test_tables_hold_every_number_with_its_unit(tables, found):
    engines, table = tables
    assert [row["engine"] for row in engines] == [*(r.name for r in found.engines), *(n for n, _ in found.left_out)]
    for row, measured in zip(engines, found.engines, strict=False):
        assert float(row["set-up [s]"]) == measured.setup_seconds
        assert float(row["run time to tolerance [s]"]) == measured.seconds_to(TOLERANCE)
        assert float(row["facet bias of layer 1 [1]"]) == measured.bias[0]
    assert engines[-1]["details"] == "left out: out of memory"
    assert engines[-1]["set-up [s]"] == ""
    assert len(table) == sum(len(r.rays) * len(NAMES) for r in found.engines)
    k = 0
    for measured in found.engines:
        for j, target in enumerate(NAMES):
            for i, rays in enumerate(measured.rays):
                row = table[k]
                assert (row["engine"], row["target"], int(row["rays [1]"])) == (measured.name, target, rays)
                assert float(row["true error [1]"]) == measured.true_error[i, j]
                assert float(row["stated error [1]"]) == measured.stated_error[i, j]
                assert float(row["run time [s]"]) == measured.seconds[i]
                k += 1
    for row in (engines[0], table[0]):
        assert all(name in ("engine", "details", "target") or re.search(r" \[(1|s|1/s)\]$", name) for name in row)


def test_figure_shows_true_errors_as_points_and_bias_with_noise_as_lines(figure, found):
    axes = figure.axes[0]
    points = [c for c in axes.containers if hasattr(c, "has_yerr")]
    assert len(points) == len(found.engines)
    for drawn, measured in zip(points, found.engines, strict=True):
        np.testing.assert_array_equal(drawn.lines[0].get_xdata(), measured.seconds)
        np.testing.assert_array_equal(drawn.lines[0].get_ydata(), measured.true_error[:, 0])
        assert drawn.get_label() == measured.name
    curves = [line for line in axes.get_lines() if len(line.get_xdata()) == 200]
    for curve, measured in zip(curves, found.engines, strict=True):
        x, y = curve.get_data()
        assert y[0] == pytest.approx(
            math.hypot(measured.least_error(), 0.4 / math.sqrt(x[0] * measured.rate)), rel=1e-6
        )
        assert y[-1] == pytest.approx(
            math.hypot(measured.least_error(), 0.4 / math.sqrt(x[-1] * measured.rate)), rel=1e-6
        )
    # each engine gets a look of its own, each family a colour
    looks = {(line.get_color(), line.get_linestyle()) for line in curves}
    assert len(looks) == len(curves)
    assert len({line.get_color() for line in curves}) == 4
    # the axis holds the place where each engine gets to the tolerance, if it does
    assert axes.get_xlim()[1] > max(t for r in found.engines if math.isfinite(t := r.seconds_to(TOLERANCE)))
    assert axes.get_ylim()[0] < TOLERANCE
    assert axes.get_title(loc="left") == r"\$bed\$"


def test_figure_has_setup_bias_and_time_apart(figure, found):
    setup, bias, seconds = figure.axes[1:]
    assert [label.get_text() for label in setup.get_yticklabels()] == [r.name for r in found.engines]
    assert [line.get_xdata()[0] for line in setup.get_lines()] == [r.setup_seconds for r in found.engines]
    shown = [c.lines[0].get_xdata()[0] for c in bias.containers]
    np.testing.assert_allclose(shown, [9e-4, 9e-4, 6e-5])
    assert sum(t.get_text() == "none" for t in bias.texts) == 2
    finite = [t for r in found.engines if math.isfinite(t := r.seconds_to(TOLERANCE))]
    drawn = [float(line.get_xdata()[0]) for line in seconds.get_lines()]
    setups = [r.setup_seconds for r in found.engines if math.isfinite(r.seconds_to(TOLERANCE))]
    np.testing.assert_allclose(drawn, [*finite, *np.add(finite, setups)])
    assert sum(t.get_text() == "never" for t in seconds.texts) == 2
    for axes in figure.axes:
        assert re.search(r"\[(s|–)\]", axes.get_xlabel())


def test_errors_that_are_all_zero_have_a_figure_and_a_table_too(found):
    """No ray meets a layer of an empty tube, and every engine knows at once; without meshes there is no bias."""
    none = {name: np.zeros_like(getattr(found.engines[0], name)) for name in ("true_error", "noise", "stated_error")}
    nothing = dataclasses.replace(found.engines[0], **none, law_level=np.zeros(4), stated_exponent=np.full(4, np.nan))
    empty = dataclasses.replace(found, engines=(nothing, nothing), trials=(), left_out=())
    stream = io.StringIO()
    Console(file=stream, width=80).print(comparison_summary(empty, TOLERANCE))
    assert "never: the facet bias alone" in stream.getvalue()
    assert re.search(r"131,072|262,144", stream.getvalue())
    with style.styled():
        comparison_figure(empty, TOLERANCE, "empty").draw_without_rendering()


def test_figure_is_written(found, tmp_path):
    path = tmp_path / "bed.png"
    write_comparison_figure(found, TOLERANCE, path, "bed")
    assert path.read_bytes().startswith(b"\x89PNG")
    assert [file.name for file in tmp_path.iterdir()] == ["bed.png"]
