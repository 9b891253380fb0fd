"""The command that compares the engines, on a small bed."""

import builtins
import re

import pytest

from bedrad.errors import MissingExtraError
from bedrad.raytrace import engine_comparison

MISSING = [(name, str(MissingExtraError(name, extra))) for name, extra in (("open3d", "open3d"), ("embree", "mesh"))]


@pytest.fixture
def no_meshes(monkeypatch):
    monkeypatch.setattr(engine_comparison, "mesh_libraries", lambda: ([], MISSING))


def test_tables_and_figure_are_written_beside_each_other(call, bed, tmp_path, no_meshes):
    code, out, _ = call("convergence", bed, "--budget", "0.01", "--seeds", "2", "-o", tmp_path / "new" / "small.png")
    assert code == 0
    files = ["small_engines.csv", "small_runs.csv", "small.png"]
    assert [line for line in out.splitlines() if line.startswith("wrote ")] == [
        f"wrote {tmp_path / 'new' / name}" for name in files
    ]
    assert {file.name for file in (tmp_path / "new").iterdir()} == set(files)
    words = " ".join(out.split())
    assert "bedrad" in words
    assert "grid walk" in words
    for name, reason in MISSING:
        assert f"left out: {name}: {reason}" in words


def test_files_are_named_after_the_bed(call, bed, tmp_path, no_meshes, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call("convergence", bed, "--budget", "0.01", "--seeds", "2")[0] == 0
    assert {file.name for file in tmp_path.glob("*convergence*")} == {
        "bed_convergence_engines.csv", "bed_convergence_runs.csv", "bed_convergence.png",
    }  # fmt: skip


def test_a_dry_run_names_the_engines_and_measures_nothing(call, bed, tmp_path, no_meshes, monkeypatch):
    monkeypatch.setattr(engine_comparison, "compare_engines", lambda *_, **__: pytest.fail("it was measured"))
    code, out, err = call("convergence", bed, "--dry-run", "-o", tmp_path / "new" / "x")
    assert (code, err) == (0, [])
    assert "engines   bedrad, grid walk\n" in out
    assert f"left out  embree: {MISSING[1][1]}" in out
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--tolerance 0", r"tolerance is 0\.0; expected a number between 0 and 1"),
        ("--tolerance nan", "tolerance is nan"),
        ("--budget 0", r"budget is 0\.0 s; expected a positive number of seconds"),
        ("--seeds 1", "seeds is 1; expected at least 2"),
        ("--seed -1", 'Invalid value "-1" for --seed'),
        ("--layers 0", "layers is 0; expected at least 1"),
    ],
)
def test_a_wrong_word_is_one_line_and_exit_code_2(refused, bed, tmp_path, options, message):
    assert re.search(message, refused(2, "convergence", bed, "-o", tmp_path / "x", *options.split()))
    assert list(tmp_path.iterdir()) == [bed]


def test_a_place_that_cannot_be_written_shows_before_the_computing(refused, bed, monkeypatch):
    monkeypatch.setattr(engine_comparison, "compare_engines", lambda *_, **__: pytest.fail("it was measured"))
    assert refused(1, "convergence", bed, "-o", bed / "x").endswith("cannot write: Not a directory")


def test_a_missing_matplotlib_shows_before_the_computing(refused, bed, tmp_path, monkeypatch):
    monkeypatch.setattr(engine_comparison, "compare_engines", lambda *_, **__: pytest.fail("it was measured"))
    plain = builtins.__import__

    def without(name, *rest):
        if name.split(".")[0] == "matplotlib":
            raise ImportError
        return plain(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    expected = 'matplotlib is not installed; install it with: pip install "bedrad[view]"'
    assert refused(1, "convergence", bed, "-o", tmp_path / "x") == expected


def test_ctrl_c_leaves_nothing_behind(call, bed, tmp_path, no_meshes, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(engine_comparison, "measure_tracer", interrupt)
    code, out, err = call("convergence", bed, "--budget", "0.01", "--seeds", "2", "-o", tmp_path / "x")
    assert (code, out) == (130, "")
    assert err[-1] == "bedrad: interrupted; what was finished is kept"
    assert list(tmp_path.iterdir()) == [bed]
