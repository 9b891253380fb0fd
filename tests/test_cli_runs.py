from __future__ import annotations

import csv
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace

import h5py
import numpy as np
import pytest

import bedrad
from bedrad import heat
from bedrad.jobs.results import Results
from jobs.small_job import JOB, STAGES, WALL, ring_bed, stub_stages, write_job

PREDICT = ("predict", "--tube", "7.75mm", "--diameter", "300um", "--velocity", "0.058m/s")


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A folder in which a job ran, in a process of its own: folder, exit code, output, error stream."""
    folder = tmp_path_factory.mktemp("ran")
    job = write_job(folder, JOB.replace("[prediction]", "[prediction]\npublished_systems = false"))
    done = in_a_process("run", job, "-o", folder / "out" / "r.h5")
    return folder, done


def in_a_process(*words, **options):
    code = "import sys; from bedrad.cli import main; sys.exit(main())"
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, words)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env=os.environ | {"COLUMNS": "120"},
        **options,
    )


def test_a_job_leaves_results_and_tables_and_tells_of_them(ran):
    folder, done = ran
    assert done.returncode == 0, done.stderr
    written = sorted(folder.joinpath("out").iterdir())
    assert folder / "out" / "r.h5" in written
    assert {"r_prediction.csv", "r_view_factors.csv", "r_statistics.csv"} <= {file.name for file in written}
    assert sorted(re.findall(r"wrote (.*)", done.stdout)) == [str(file) for file in written]
    assert "rings" in done.stdout
    # every stage ends its bar, and nothing is warned about
    assert len(re.findall(r"100% .*done", done.stderr)) == len(STAGES)
    assert "warning" not in done.stderr


def test_the_same_job_again_computes_nothing(ran, call, monkeypatch):
    folder, _ = ran
    stub_stages(monkeypatch, **dict.fromkeys(STAGES, AssertionError("a stage ran")))
    before = (folder / "out" / "r.h5").read_bytes()
    code, _, err = call("run", folder / "job.toml", "-o", folder / "out" / "r.h5")
    assert code == 0
    assert sum("kept from an earlier run" in line for line in err) == len(STAGES)
    assert (folder / "out" / "r.h5").read_bytes() == before


def test_figures_without_matplotlib_are_refused_before_anything_runs(ran, call, monkeypatch):
    folder, _ = ran
    (folder / "figures.toml").write_text((folder / "job.toml").read_text().replace("figures = false", "figures = true"))
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    code, out, err = call("run", folder / "figures.toml", "-o", folder / "out" / "r.h5")
    assert code == 1
    assert err == ['bedrad: matplotlib is not installed; install it with: pip install "bedrad[view]"']
    assert out == ""
    assert set(Results(folder / "out" / "r.h5").digests()) == set(STAGES)


def test_a_dry_run_says_what_would_run_and_why_and_writes_nothing(ran, call):
    folder, _ = ran
    shorter = (folder / "job.toml").read_text().replace("0.016 m/s", "0.02 m/s")
    shorter = re.sub(r"\[convergence\][^\[]*", "", shorter)
    (folder / "other.toml").write_text(shorter)
    before = {file: file.stat().st_mtime_ns for file in folder.rglob("*")}
    code, out, err = call("run", folder / "other.toml", "-o", folder / "out" / "r.h5", "--dry-run")
    assert (code, err) == (0, [])
    lines = [line.split(maxsplit=2) for line in out.splitlines()]
    assert [line[:2] for line in lines[:4]] == [
        ["kept", "packing"],
        ["kept", "statistics"],
        ["kept", "view_factors"],
        ["run", "prediction"],
    ]
    assert lines[4] == [
        "left",
        "out",
        "convergence   the job has no [convergence]; the results file keeps its earlier one",
    ]
    assert lines[5][0] == "results"
    assert {file: file.stat().st_mtime_ns for file in folder.rglob("*")} == before
    code, out, _ = call("run", folder / "other.toml", "-o", folder / "new" / "r.h5", "--dry-run")
    assert (code, out.count("run  ")) == (0, 4)
    assert not (folder / "new").exists()


@pytest.mark.parametrize(
    ("command", "stage"), [("statistics --print-only", "statistics"), ("view-factors --rays 4096", "view_factors")]
)
def test_a_single_command_prints_and_saves_what_python_gives(call, bed, tmp_path, command, stage):
    name, *options = command.split()
    code, out, _ = call(name, bed, *options, "-o", tmp_path / "r.h5")
    assert code == 0
    assert out.endswith(f"wrote {tmp_path / 'r.h5'}\n")
    packing = bedrad.read(bed)
    direct = bedrad.statistics(packing) if stage == "statistics" else bedrad.view_factors(packing, rays=4096)
    wanted = "packing_fractions" if stage == "statistics" else "layers"
    with h5py.File(tmp_path / "r.h5") as file:
        np.testing.assert_array_equal(file[stage][wanted][()], getattr(direct, wanted))
    if stage == "view_factors":
        # all but the last lines, which tell the run time; tests/test_statistics_command.py has the other screen
        assert str(direct).splitlines()[:7] == out.splitlines()[:7]


def test_view_factors_of_several_files_are_the_mean_over_them(call, tmp_path):
    beds = [ring_bed(seed=k) for k in (1, 2, 3)]
    for k, bed in enumerate(beds):
        bedrad.write(bed, tmp_path / f"bed_{k}.h5")
    wanted = bedrad.view_factors(beds, rays=3 * 4096, seed=2)
    for words in ([tmp_path / "bed_*.h5"], [tmp_path / f"bed_{k}.h5" for k in range(3)], [tmp_path, "--all-frames"]):
        code, out, _ = call("view-factors", *words, "--rays", 3 * 4096, "--seed", 2, "-o", tmp_path / "r.out")
        assert code == 0
        assert "mean over 3 frames" in out
        with h5py.File(tmp_path / "r.out") as file:
            np.testing.assert_array_equal(file["view_factors/layers"][()], wanted.layers)
            np.testing.assert_array_equal(file["view_factors/bed_covariance"][()], wanted.bed_covariance)
            assert file["view_factors/frames"][()] == 3
        (tmp_path / "r.out").unlink()


def test_dry_runs_of_single_commands_read_and_write_nothing(call, bed, no_lammps):
    before = sorted(bed.parent.iterdir())
    for command in ("statistics", "view-factors"):
        code, out, _ = call(command, bed, "--dry-run", "-o", bed.parent / "r.h5")
        assert code == 0
        assert out.splitlines()[0] == str(ring_bed())
        assert "layers    0, 0.0003, 0.0009, 0.0015 m deep" in out
    code, out, _ = call(
        "settle", "--tube", "7.74mm", "--height", "3mm", "--size", "500 um:0.3", "--size", "600 um:0.7", "--dry-run"
    )
    assert code == 0
    assert out
    assert sorted(bed.parent.iterdir()) == before


def test_a_wall_given_on_the_command_line_is_taken(call, tmp_path):
    # the file names no wall
    path = tmp_path / "bed.csv"
    bedrad.write(ring_bed(), path)
    path.write_text("".join(line for line in path.read_text().splitlines(True) if not line.startswith("#")))
    code, out, _ = call("statistics", path, "--tube", f"{2e3 * WALL.radius!r} mm", "--dry-run")
    assert code == 0
    assert f"wall={WALL!r}" in out


def test_a_prediction_is_printed(call):
    code, out, err = call(*PREDICT, "--temperature", "100degC", "--temperature", "1100 degC")
    assert (code, err) == (0, [])
    header, columns, *rows = out.splitlines()
    assert header.startswith("tube: D 7.75 mm, d 300 um, A 25.83, U 0.058 m/s")
    assert columns.split()[:2] == ["T_w", "[K]"]
    assert [row.split()[0] for row in rows] == ["373.15", "1373.15"]
    # a measured wall layer and measured view factors change it
    measured = ("--packing-fraction", "0.4", "--contacts-per-area", "5 mm^-2", "--view-factor", "0.9")
    assert call(*PREDICT, "--temperature", "100degC", *measured)[1].splitlines()[2] != rows[0]


def test_a_table_of_flows_is_written_with_its_budget_and_figure(call, tmp_path):
    path = tmp_path / "hot.csv"
    words = (
        "--temperature 100degC --temperature 1100degC --diameter 600um --velocity 0.1m/s --published-errors --budget"
    )
    code, out, err = call(*PREDICT, *words.split(), "--error", "particle_diameter=1%", "--samples", "50", "-o", path)
    assert (code, err) == (0, [])
    assert out.count("tube: D 7.75 mm") == out.count("50 draws from seed 0") == out.count("elasticity") == 4
    with path.open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 8
    flow = {(row["particle diameter [m]"], row["velocity [m/s]"]) for row in rows}
    assert flow == {(d, U) for d in ("0.0003", "0.0006") for U in ("0.058", "0.1")}
    first = rows[0]
    system = heat.prediction.System(7.75e-3, 300e-6, 0.058)
    given = replace(heat.prediction.Uncertainties.published(), particle_diameter=3e-6)
    alone = heat.prediction.predict(system, 373.15, uncertainties=given)
    assert float(first["heat transfer coefficient [W/(m2 K)]"]) == pytest.approx(float(alone.heat_transfer_coefficient))
    assert float(first["its standard error [W/(m2 K)]"]) == pytest.approx(float(alone.heat_transfer_coefficient_error))
    with (tmp_path / "hot_budget.csv").open() as stream:
        budget = list(csv.DictReader(stream))
    assert len(budget) == 8 * len(alone.budget.names)
    shares = [float(row["share of variance [1]"]) for row in budget[: len(alone.budget.names)]]
    assert sum(shares) == pytest.approx(1)
    assert (tmp_path / "hot.png").stat().st_size > 20_000


def test_a_measured_layer_and_view_factors_take_errors(call):
    layer = (
        "--packing-fraction",
        "0.4",
        "--contacts-per-area",
        "5mm^-2",
        "--view-factor",
        "0.8",
        "--view-factor",
        "0.15",
    )
    sizes = ("packing_fraction=1%", "contacts_per_area=0.1mm^-2", "view_factors=5%")
    errors = (word for size in sizes for word in ("--error", size))
    code, out, _ = call(*PREDICT, "--temperature", "1100degC", *layer, *errors, "--budget")
    assert code == 0
    rows = {line[:36].strip(): line[36:].split() for line in out.splitlines()[3:]}
    assert rows["wall contacts"][:2] == ["5", "0.1"]
    assert rows["packing fraction of the wall layer"][:2] == ["0.4", "0.004"]
    # 0.8 and 2 times 0.15, each within 5 %, independent
    assert float(rows["view factors, penetration"][1]) == pytest.approx(0.05 * np.hypot(0.8, 0.3), rel=0.03)


def test_a_heat_flux_gives_the_mean_temperature_and_the_hottest_budget(call):
    walls = ("--temperature", "1100degC", "--temperature", "500degC")
    words = ("--heat-flux", "20kW/m^2", "--properties", "layers", "--budget")
    code, out, _ = call(*PREDICT, *walls, *words, "--error", "heat_flux=1%")
    assert code == 0
    lines = out.splitlines()
    assert lines[1].endswith("T_m [K]")
    T_w, h, T_m = (float(lines[2].split()[k]) for k in (0, 5, 7))
    assert T_w - 2e4 / h == pytest.approx(T_m, abs=0.05)
    assert lines[4].endswith("at 1373.15 K")


# Real processes


def test_exit_codes_reach_the_shell(tmp_path):
    done = in_a_process("statistics", tmp_path / "no.h5")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"bedrad: {tmp_path / 'no.h5'}: no such file\n"


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_ctrl_c_while_rays_are_traced_keeps_what_was_finished(tmp_path):
    # minutes of rays
    job = write_job(tmp_path, JOB.replace("rays = 4096", "tolerance = 6e-6"))
    code = "import sys; from bedrad.cli import main; sys.exit(main())"
    process = subprocess.Popen(
        [sys.executable, "-c", code, "run", str(job), "-o", str(tmp_path / "r.h5")],
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    results, deadline = Results(tmp_path / "r.h5"), time.monotonic() + 100
    while "statistics" not in results.digests():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.05)
    # well into the tracing
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert out == ""
    assert err.splitlines()[-1] == "bedrad: interrupted; what was finished is kept"
    assert "Traceback" not in err
    assert set(results.digests()) == {"packing", "statistics"}
    assert {file.name for file in tmp_path.iterdir()} == {"bed.h5", "job.toml", "r.h5"}
