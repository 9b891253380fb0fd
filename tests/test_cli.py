from __future__ import annotations

import os
import re
import shlex
import signal

import pytest

import bedrad
from bedrad import cli
from bedrad.errors import EngineFailedError, MissingExtraError
from bedrad.jobs.results import Results
from bedrad.packings import lammps
from jobs.small_job import JOB, STAGES, ring_bed, stub_stages, write_job

COMMANDS = [name for name in cli.app if not name.startswith("-")]
PREDICT = ("predict", "--tube", "7.75mm", "--diameter", "300um", "--velocity", "0.058m/s")
LAYER = ("--packing-fraction", "0.4", "--contacts-per-area", "1mm^-2")


# Help


@pytest.mark.parametrize(
    "command", [(), *((name,) for name in COMMANDS)], ids=lambda words: " ".join(words) or "bedrad"
)
def test_every_help_has_examples_that_the_command_understands(call, command):
    code, out, err = call(*command, "--help")
    assert (code, err) == (0, [])
    assert "Example:" in out
    examples = re.findall(r"bedrad ((?:[^\n]|\n(?!\s*\n))+)", out.partition("Example:")[2])
    assert examples
    for example in examples[:1] if not command else examples:
        words = shlex.split(" ".join(example.replace("│", " ").split()))
        _, bound, unused = cli.app.parse_known_args(words)[:3]
        assert not unused
        assert bound.arguments


def test_no_words_show_the_help(call):
    code, out, err = call()
    assert (code, err) == (0, [])
    assert out.startswith("Usage: bedrad COMMAND")
    assert {"run", "settle", "statistics", "view-factors", "predict"} <= set(COMMANDS)


def test_the_version_is_told(call):
    assert call("--version") == (0, f"{bedrad.__version__}\n", [])


# Words that are wrong


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["phlogiston"], r'Unknown command "phlogiston"'),
        (["run"], "JOB_FILE requires an argument"),
        (["run", "job.toml", "--workres", "3"], "Unknown option: --workres"),
        ([*PREDICT], "--temperature requires an argument"),
        ([*PREDICT, "--temperature", "500"], "--temperature: '500' is not a quantity; .*such as '850 degC'$"),
        ([*PREDICT, "--temperature", "500 mm"], "--temperature: '500 mm' has the wrong kind of unit"),
        ([*PREDICT, "--temperature", "0 K"], "wall_temperature is 0 K; expected a positive"),
        ([*PREDICT, "--temperature", "500K", "--properties", "layers"], "'layers' needs a heat_flux"),
        ([*PREDICT, "--temperature", "500K", "--heat-flux", "5kW"], "--heat-flux: '5kW' has the wrong kind of unit"),
        (
            [*PREDICT, "--temperature", "500K", "--error", "diameter=5um"],
            "--error 'diameter=5um': expected .*NAME=SIZE",
        ),
        ([*PREDICT, "--temperature", "500K", "--error", "porosity"], "--error 'porosity': expected .*NAME=SIZE"),
        ([*PREDICT, "--temperature", "500K", "--error", "porosity=x"], "--error 'porosity=x': could not convert"),
        (
            [*PREDICT, "--temperature", "500K", "--error", "wall_temperature=5degC"],
            "'5degC' is a temperature; expected a",
        ),
        (
            [*PREDICT, "--temperature", "500K", "--error", "velocity=-1%"],
            "--error 'velocity=-1%': standard error of vel",
        ),
        ([*PREDICT, "--temperature", "500K", "--error", "nc_distance=1%"], "there is no such input without --packing"),
        (
            [*PREDICT, "--temperature", "500K", "--error", "view_factors=1%"],
            "there is no such input without --view-factor",
        ),
        ([*PREDICT, "--temperature", "500K", "--error", "heat_flux=1%"], "there is no such input without --heat-flux"),
        (
            [*PREDICT, "--temperature", "500K", "--bulk-packing-fraction", "63"],
            "--bulk-packing-fraction is 63; expected a",
        ),
        (
            [*PREDICT, "--temperature", "500K", "--heat-flux", "5MW/m^2"],
            "heat_flux is 5e.06 W/m2; expected less: no flow",
        ),
        ([*PREDICT, "--temperature", "500K", "--samples", "1"], "samples is 1; expected at least 2"),
        ([*PREDICT, "--temperature", "500K", "-o", "a.txt"], "--output 'a.txt': expected a file that ends in .csv"),
        (
            [*PREDICT, "--diameter", "1mm", "--temperature", "1K", *LAYER],
            "a measured wall layer belongs to one flow",
        ),
        (["predict", "--tube", "7.75 lm", *PREDICT[3:]], "--tube: '7.75 lm' has the wrong kind of unit"),
        (["predict", "--tube", "[/x]", *PREDICT[3:]], r"--tube: '\[/x\]' is not a quantity"),
        ([*PREDICT, "--temperature", "1 K", "--bulk", "zbss"], '--bulk. Choose from: "auto", "table 5.2", "zbs"'),
        ([*PREDICT, "--temperature", "500K", "--packing-fraction", "0.4"], "give --packing-fraction and --contacts"),
        ([*PREDICT, "--temperature", "500K", "--nc-distance", "0.3"], "--nc-distance with them only"),
        ([*PREDICT, "--temperature", "500K", "--view-factor", "2"], "view factor is 2; expected at least 0"),
        (
            ["settle", "--tube", "7.75mm", "--height", "1mm", "--size", "500um"],
            "--size '500um': expected a diameter and",
        ),
        (
            ["settle", "--tube", "7.75mm", "--height", "1mm", "--diameter", "9mm"],
            "9mm|0.009 m does not fit into a tube",
        ),
    ],
)
def test_a_wrong_word_is_one_line_and_exit_code_2(refused, no_lammps, words, message):
    assert re.search(message, refused(2, *words))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--layers 0", "layers is 0; expected at least 1"),
        ("--layers 99", "layers is 99: the last edge would lie at .* deeper than"),
        ("--layers x", '--layers: unable to convert "x" into int'),
        ("--margin -1", "margin is -1.0; expected a number of mean diameters that is not negative"),
        ("--tube 7.74mm --rod 1mm", "give one wall: --tube, --rod, --plate, --wall-stl or --fit-wall"),
        ("--tube 5mm", r"bed\.h5: sphere 0: .* through the tube wall \(Tube\(radius=0\.0025\)\)"),
        ("--plate", r"bed\.h5: sphere 0: .* through the plate wall"),
        ("--frame 3", r"bed\.h5: frame 3 was asked for"),
        ("--diameter 1mm", r"diameter 0\.001 m was given, but .*bed\.h5 has the sizes"),
    ],
)
@pytest.mark.parametrize("command", ["statistics", "view-factors"])
def test_a_wrong_measure_is_one_line_and_exit_code_2(refused, bed, command, options, message):
    assert re.search(message, refused(2, command, bed, *options.split()))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--rays 0", "rays is 0; expected"),
        ("--tolerance nan", "tolerance is nan; expected a positive number"),
        ("--rays 64 --tolerance 0.1", "give tolerance or rays, not both"),
        ("--seed -1", 'Invalid value "-1" for --seed'),
        ("--threads 0", "threads is 0; expected at least 1"),
        ("--normalised nobody", '"nobody" for --normalised'),
    ],
)
def test_a_wrong_effort_is_one_line_and_exit_code_2(refused, bed, options, message):
    assert re.search(message, refused(2, "view-factors", bed, *options.split()))


# Files that are wrong

TABLE = """\
# wall: tube radius=5.0 m
x [m],y [m],z [m],radius [m]
4.0,0.0,1.0,1.0
4.0,0.0,9.0,1.0
4.0,0.0,17.0,1.0
"""

DUMP = """\
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS ff ff ff
-5 5
-5 5
0 20
ITEM: ATOMS id x y z radius
1 4 0 1 1
2 4 0 9 1
"""


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", TABLE.replace("9.0", "nan"), r"a\.csv, line 4.*nan"),
        ("a.csv", TABLE.replace("9.0,1.0", "9.0,-1.0"), r"a\.csv: sphere 1: radius -1\.0 m; .*\(line 4\)"),
        (
            "a.csv",
            TABLE.replace("4.0,0.0,9.0", "4.5,0.0,9.0"),
            r"a\.csv: sphere 1: .* through the tube wall.*\(line 4\)",
        ),
        ("a.csv", TABLE.replace("17.0", "9.0"), r"a\.csv: spheres 1 and 2, .* lie on one point.*line 4 and line 5"),
        ("a.csv", TABLE.replace("9.0,1.0", "9.0"), r"a\.csv, line 4"),
        ("a.csv", "", r"a\.csv: no header; expected a header such as 'x \[m\],y"),
        ("a.dump", DUMP[: DUMP.index("2 4 0 9")], r"a\.dump.*(cut off|ends|truncated)"),
        ("a.dump", DUMP.replace("9 1\n", "x 1\n"), r"a\.dump.*line 11.*'x'"),
        ("a.what", "what is this", r"a\.what: an unknown format; known are bedrad HDF5"),
        ("a.h5", "\x89HDF\r\n\x1a\n", r"a\.h5: "),
    ],
)
@pytest.mark.parametrize("command", ["statistics", "view-factors"])
def test_a_broken_bed_is_one_line_and_exit_code_2(refused, tmp_path, command, name, text, message):
    (tmp_path / name).write_bytes(text.encode("latin-1"))
    wall = ("--tube", "10m") if name.endswith("dump") else ()
    assert re.search(message, refused(2, command, tmp_path / name, *wall))


def test_files_that_are_not_there_are_named(refused, tmp_path):
    assert refused(2, "statistics", tmp_path / "no.h5").endswith("no.h5: no such file")
    assert refused(2, "run", tmp_path / "no.toml").endswith("no.toml: no such job file")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("seed = 3", "sede = 3", "job.toml: sede: unknown key; did you mean 'seed'?"),
        ("0.016 m/s", "0.016 m", "job.toml: prediction.velocity: '0.016 m' has the wrong kind of unit"),
        ("[statistics]", "[statistics", "job.toml: not a TOML file: "),
        ("bed.h5", "no.h5", "no.h5: cannot be read: No such file or directory"),
        (
            "reference_rays = 32768",
            "reference_rays = 3",
            "job.toml: convergence: reference_rays is 3; expected at least",
        ),
    ],
)
def test_a_broken_job_is_one_line_and_exit_code_2(refused, tmp_path, old, new, message):
    job = write_job(tmp_path, JOB.replace(old, new))
    assert message in refused(2, "run", job, "-o", tmp_path / "r.h5")
    assert not (tmp_path / "r.h5").exists()


# Places that are wrong


def test_a_place_that_cannot_be_written_is_one_line_and_exit_code_1(refused, bed, tmp_path, monkeypatch, no_lammps):
    job = write_job(tmp_path)
    stub_stages(monkeypatch, packing=AssertionError("a stage ran"))
    target = bed / "r.h5"
    settle = ("settle", "--tube", "7.75mm", "--diameter", "1mm", "--height", "9mm")
    for words in (("run", job), ("statistics", bed), ("view-factors", bed), settle):
        assert refused(1, *words, "-o", target) == f"{target}: cannot write: Not a directory"
    assert "cannot write" in refused(1, "statistics", bed, "-o", "/proc/bedrad/r.h5")


def test_files_of_others_are_not_overwritten(refused, bed, tmp_path, monkeypatch):
    job = write_job(tmp_path)
    stub_stages(monkeypatch, packing=AssertionError("a stage ran"))
    before = bed.read_bytes()
    assert "holds something else than one 'statistics' record" in refused(2, "statistics", bed, "-o", bed)
    assert "holds something else than one 'view_factors' record" in refused(2, "view-factors", bed, "-o", bed)
    assert "is the bed of this job" in refused(2, "run", job, "-o", bed)
    other = tmp_path / "other.h5"
    bedrad.write(bedrad.read(bed), other)
    assert "not a bedrad results file" in refused(2, "run", job, "-o", other)
    assert bed.read_bytes() == before


def test_a_bed_is_not_settled_for_a_file_that_cannot_hold_it(refused, tmp_path, no_lammps):
    words = ("settle", "--tube", "7.75mm", "--diameter", "1mm", "--height", "9mm", "-o", tmp_path / "bed.stl")
    assert re.search(r"suffix '\.stl'; packings are written as .*\.h5.*\.csv", refused(2, *words))


# Engines that are missing or fail


def test_lammps_that_is_missing_is_told_with_what_installs_it(call, tmp_path, monkeypatch):
    monkeypatch.setattr(lammps.importlib.util, "find_spec", lambda *_: None)
    monkeypatch.setattr(lammps.shutil, "which", lambda *_: None)
    monkeypatch.setattr(lammps.sys, "executable", "/nowhere/python")
    job = tmp_path / "job.toml"
    job.write_text('[wall]\ndiameter = "4 mm"\n[packing.settle]\ndiameter = "1 mm"\nheight = "3 mm"\n')
    expected = 'bedrad: LAMMPS is not installed; install it with: pip install "bedrad[dem]"'
    for words in (
        ("run", job, "-o", tmp_path / "r.h5"),
        ("settle", "--tube", "4mm", "--diameter", "1mm", "--height", "3mm", "-o", tmp_path / "bed.h5"),
    ):
        code, _, err = call(*words)
        assert code == 1
        assert err[-1] == expected
    assert sorted(tmp_path.iterdir()) == [job]


@pytest.mark.parametrize(
    ("failure", "code", "message"),
    [
        (EngineFailedError("LAMMPS ended with the exit code 1"), 1, "LAMMPS ended with the exit code 1"),
        (MissingExtraError("X", "y"), 1, 'X is not installed; install it with: pip install "bedrad[y]"'),
        (MemoryError(), 1, "MemoryError"),
        (
            OSError(28, "cannot write: No space left on device", "r.h5"),
            1,
            "r.h5: cannot write: No space left on device",
        ),
        (ValueError("the bed is 1 m long"), 2, "the bed is 1 m long"),
        (KeyboardInterrupt(), 130, "interrupted; what was finished is kept"),
    ],
)
@pytest.mark.parametrize("broken", STAGES)
def test_a_stage_that_fails_leaves_what_was_finished(call, tmp_path, monkeypatch, broken, failure, code, message):
    stub_stages(monkeypatch, **{broken: failure})
    found, _, err = call("run", write_job(tmp_path), "-o", tmp_path / "r.h5")
    assert found == code
    assert err[-1] == f"bedrad: {message}"
    finished = STAGES[: STAGES.index(broken)]
    assert set(Results(tmp_path / "r.h5").digests()) == set(finished)
    assert {file.name for file in tmp_path.iterdir()} == {"bed.h5", "job.toml", *(["r.h5"] if finished else [])}


def test_ctrl_c_outside_a_job_is_told_too(refused, bed, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("bedrad.packings.statistics.statistics", interrupt)
    assert refused(130, "statistics", bed) == "interrupted; what was finished is kept"


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_a_request_to_end_does_what_ctrl_c_does(refused, bed, monkeypatch):
    before = signal.getsignal(signal.SIGTERM)
    monkeypatch.setattr("bedrad.packings.statistics.statistics", lambda *_, **__: signal.raise_signal(signal.SIGTERM))
    assert refused(130, "statistics", bed) == "interrupted; what was finished is kept"
    assert signal.getsignal(signal.SIGTERM) is before


# Warnings


@pytest.mark.filterwarnings("default")
def test_a_warning_is_one_line_and_comes_once(call):
    # three temperatures, two of them beyond what the conductivity of air was fitted to
    words = ("predict", "--tube", "7.75mm", "--diameter", "100um", "--velocity", "0.058m/s")
    code, out, err = call(*words, "--temperature", "500K", "--temperature", "2500K", "--temperature", "2600K")
    assert code == 0
    assert len(out.splitlines()) == 5
    assert len(err) == len(set(err)) >= 2
    assert all(line.startswith("warning: ") for line in err)
    assert any("diameter_ratio is 77.5, outside the fitted range 12.9 to 36.4" in line for line in err)
    # and again in the next run, although it is the same process
    assert call(*words, "--temperature", "500K")[2]


def test_a_fitted_wall_is_told(call, tmp_path):
    rows = "\n".join(",".join(map(repr, c)) for c in ring_bed().centers.tolist())
    (tmp_path / "bare.csv").write_text(f"x [m],y [m],z [m]\n{rows}\n")
    words = ("--diameter", "600um", "--layers", "2", "--margin", "1", "--print-only")
    code, _, err = call("statistics", tmp_path / "bare.csv", *words)
    assert code == 0
    assert any(line.startswith("wall: Tube(radius=0.0038") and "fitted by least squares" in line for line in err)
