"""`bedrad flow`: what it would run, what it writes, what it refuses."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

import bedrad
from bedrad.cli import main

WORDS = ["flow", "--tube", "3mm", "--diameter", "600um"]
SHORT = ["--tube-length", "14", "--window", "4", "9", "--frames", "2", "--flush", "1"]


def test_a_dry_run_says_what_would_run(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*WORDS, "--velocity", "0.1m/s", "--hopper-width", "2", "--dry-run"]) == 0
    told = capsys.readouterr().out
    assert "hopper     2 tube diameters wide" in told
    assert "belt over the lowest 3 d at 0.1 m/s" in told
    assert "31.3 d" not in told


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "velocity and orifice: neither was given"),
        (["--velocity", "0.1m/s", "--orifice", "2.4mm"], "both were given"),
        (["--velocity", "0.1"], "velocity"),
        (["--velocity", "0.1m/s", "--window", "10", "40"], "window is 10 to 40"),
        (["--velocity", "0.1m/s", "--youngs-modulus", "5e6"], "youngs-modulus"),
        (["--velocity", "0.1m/s", "--youngs-modulus", "5MPa", "--stiffness", "100N/m"], "both given"),
        (["--velocity", "0.1m/s", "-o", "flow.txt"], ".txt"),
        (["--velocity", "0.1m/s", "--frames", "0"], "frames is 0"),
    ],
)
def test_wrong_words_are_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*WORDS, *words]) == 2
    told = capsys.readouterr().err
    assert message in " ".join(told.split())
    assert "Traceback" not in told


def test_frames_of_a_longer_flow_are_not_mixed_with_new_ones(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bed_0002.h5").touch()
    assert main([*WORDS, "--velocity", "0.1m/s", *SHORT, "-o", str(tmp_path / "bed.h5")]) == 2
    assert "bed_0002.h5 is left from another flow" in " ".join(capsys.readouterr().err.split())
    assert [path.name for path in tmp_path.iterdir()] == ["bed_0002.h5"]


def test_a_folder_with_files_of_no_flow_is_not_taken_for_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept = tmp_path / "bed.run" / "thesis.tex"
    kept.parent.mkdir()
    kept.touch()
    assert main([*WORDS, "--velocity", "0.1m/s", *SHORT, "-o", str(tmp_path / "bed.h5")]) == 2
    assert "holds files of no flow" in " ".join(capsys.readouterr().err.split())
    assert kept.exists()


@pytest.mark.dem
@pytest.mark.filterwarnings("always:the flow is")
def test_packings_and_tables_are_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = tmp_path / "run" / "bed.h5"
    output.parent.mkdir()
    assert main([*WORDS, "--velocity", "0.1m/s", *SHORT, "-o", str(output)]) == 0
    told = capsys.readouterr()
    assert "short of independent structures" in told.err
    names = sorted(path.name for path in output.parent.iterdir())
    # the folder that LAMMPS ran in has gone
    assert names == ["bed_0000.h5", "bed_0001.h5", "bed_flow.csv", "bed_velocity.csv"]
    frames = list(bedrad.read_frames(str(output.parent / "bed_*.h5")))
    assert len(frames) == 2
    with (output.parent / "bed_flow.csv").open(newline="") as stream:
        (row,) = csv.DictReader(stream)
    assert float(row["velocity [m/s]"]) == frames[0].provenance["mean_velocity_m_per_s"]
    with (output.parent / "bed_velocity.csv").open(newline="") as stream:
        bins = list(csv.DictReader(stream))
    outer = [float(each["outer radius [m]"]) for each in bins]
    # from the axis to the wall in steps of half a diameter, one of them about where spheres touch the wall
    assert outer == pytest.approx([0.15e-3, 0.45e-3, 0.75e-3, 1.05e-3, 1.35e-3, 1.5e-3])
    assert [bool(each["velocity [m/s]"]) for each in bins[-2:]] == [True, False]


@pytest.mark.dem
@pytest.mark.filterwarnings("always:the flow is")
def test_a_folder_that_was_named_is_kept(tmp_path: Path) -> None:
    work = tmp_path / "work"
    words = [*WORDS, "--velocity", "0.1m/s", *SHORT, "-o", str(tmp_path / "bed.h5"), "--work-dir", str(work)]
    assert main(words) == 0
    assert (work / "log.lammps").exists()
