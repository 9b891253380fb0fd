"""`bedrad run` on many beds; on one bed in tests/test_cli_runs.py."""

from __future__ import annotations

import csv
import sys

import pytest

from bedrad import cli
from jobs.ensemble_job import BEDS, JOB, write_ensemble
from jobs.small_job import ring_bed


@pytest.fixture
def job_file(tmp_path):
    return write_ensemble(tmp_path, JOB.replace("[prediction]", "[prediction]\npublished_systems = false"))


def rows(path):
    with path.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_many_beds_leave_results_tables_and_a_summary(call, job_file, tmp_path):
    code, out, err = call("run", job_file, "-o", tmp_path / "r.h5", "--dry-run")
    assert (code, err) == (0, [])
    assert f"run       {BEDS} beds: statistics, view_factors, prediction" in out
    assert not (tmp_path / "r.h5").exists()
    code, out, err = call("run", job_file, "-o", tmp_path / "r.h5")
    assert code == 0
    assert out.startswith("four beds")
    for text in (f"{BEDS} beds", "solid fraction phi_wa", "view factor to layer 1", "at 850 °C"):
        assert text in out
    names = ["r.h5", "r_means.csv", "r_beds.csv"]
    assert out.splitlines()[-3:] == [f"wrote {tmp_path / name}" for name in names]
    assert {file.name for file in tmp_path.iterdir()} == {*names, "beds", "job.toml"}
    beds, means = rows(tmp_path / "r_beds.csv"), rows(tmp_path / "r_means.csv")
    assert len(beds) == BEDS
    values = [float(row["statistics/packing_fraction [1]"]) for row in beds]
    (mean,) = [row for row in means if row["quantity"] == "packing_fraction"]
    assert float(mean["mean"]) == pytest.approx(sum(values) / BEDS, rel=1e-14)
    layers = [row["where"] for row in means if row["quantity"] == "layers"]
    assert layers == ["layer 1", "layer 2", "layer 3"]
    assert float(next(row for row in means if row["quantity"] == "layers")["of this from the rays"]) > 0
    code, out, _ = call("run", job_file, "-o", tmp_path / "r.h5", "--dry-run")
    assert f"kept      {BEDS} beds measured before" in out


def test_failed_beds_are_told_in_the_end_and_the_code_is_1(call, job_file, tmp_path):
    job_file.write_text(job_file.read_text().replace("[statistics]", "[convergence]\n[statistics]"))
    (tmp_path / "beds" / "bed_7.h5").write_text("none")
    (tmp_path / "beds" / "bed_8.h5").write_bytes((tmp_path / "beds" / "bed_1.h5").read_bytes())
    code, out, err = call("run", job_file, "-o", tmp_path / "r.h5", "--dry-run")
    assert code == 0
    assert "left out  convergence: it is about one bed" in out
    assert "bed_8.h5: the same bed as" in out
    code, out, err = call("run", job_file, "-o", tmp_path / "r.h5")
    assert code == 1
    assert "1 bed failed: see the table of failures" in out
    assert "bed_8.h5 is the same bed as" in out
    assert err[-2].startswith(f"bedrad: {tmp_path / 'beds' / 'bed_7.h5'}: ")
    assert err[-1] == f"bedrad: 1 of {BEDS + 1} beds failed, the others are kept; the same command tries them again"
    (row,) = rows(tmp_path / "r_failures.csv")
    assert row["label"] == str(tmp_path / "beds" / "bed_7.h5")


def test_ctrl_c_keeps_what_is_finished(call, job_file, tmp_path, monkeypatch):
    from bedrad.jobs import stages

    working = stages.RUNNERS["statistics"]

    def interrupted(job, unit, progress):
        if len(unit.bed()) == len(ring_bed(rings=8)):
            raise KeyboardInterrupt
        return working(job, unit, progress)

    monkeypatch.setitem(stages.RUNNERS, "statistics", interrupted)
    code, _, err = call("run", job_file, "-o", tmp_path / "r.h5")
    assert code == cli.INTERRUPTED
    assert err[-1] == "bedrad: interrupted; what was finished is kept"
    monkeypatch.undo()
    code, out, _ = call("run", job_file, "-o", tmp_path / "r.h5", "--dry-run")
    assert "kept      2 beds measured before" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--workers", "2", "--cluster", "tcp://a:1"], "give --workers or --cluster, not both"),
        (["--workers", "0"], "Must be >= 1"),
        (["--cluster", "nowhere.json"], "nowhere.json: no such scheduler file"),
    ],
)
def test_workers_that_cannot_be_are_refused(refused, job_file, words, message):
    assert message in refused(2, "run", job_file, *words)


def test_one_bed_needs_no_workers(refused, job_file, tmp_path):
    one = tmp_path / "one.toml"
    one.write_text(JOB.replace("bed_*.h5", "bed_1.h5"))
    assert "names one bed" in refused(2, "run", one, "--workers", "2")


def test_a_sweep_without_matplotlib_is_refused_before_anything_runs_if_it_has_a_figure(call, tmp_path, monkeypatch):
    text = '[wall]\ndiameter = "7 mm"\n[packing.settle]\ndiameter = "0.6 mm"\nheight = "18 mm"\n[sweep]\n'
    ran = []
    monkeypatch.setattr("bedrad.jobs.ensemble.run_ensemble", lambda *given: ran.append(given) or 1 / 0)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    (tmp_path / "job.toml").write_text(text + 'tube_diameter = ["7 mm", "8 mm"]\nseed = [1, 2]\n')
    code, _, err = call("run", tmp_path / "job.toml", "-o", tmp_path / "r.h5")
    assert (code, ran) == (1, [])
    assert err == ['bedrad: matplotlib is not installed; install it with: pip install "bedrad[view]"']
    # seeds alone have no figure
    (tmp_path / "job.toml").write_text(text + "seed = [1, 2]\n")
    with pytest.raises(ZeroDivisionError):
        call("run", tmp_path / "job.toml", "-o", tmp_path / "r.h5")
    assert len(ran) == 1
