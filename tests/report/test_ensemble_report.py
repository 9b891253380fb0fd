from __future__ import annotations

import csv
import io
import math

import h5py
import numpy as np
import pytest
from rich.console import Console

from bedrad.errors import BadFileError
from bedrad.jobs.ensemble_store import EnsembleStore
from bedrad.jobs.members import Failure, Member
from bedrad.jobs.results import Results
from bedrad.jobs.unit_record import StageRecord, UnitRecord, pack
from bedrad.report.ensemble_records import load_ensemble, mean_rows
from bedrad.report.ensemble_screen import SHOWN_GROUPS, summary
from bedrad.report.ensemble_tables import write_tables

ATTRIBUTES = {"job": '{"name": "made up"}', "inputs": "{}"}


A_FAILURE = Failure("a bad one", "no [reason] at all")


def make(path, diameters, seeds=(1, 2, 3), warn=0, failures=(A_FAILURE,)):
    """Results of beds whose numbers are known: solid fraction .4 + seed/100, view factors with an error of .003."""
    store, members = EnsembleStore(path), []
    for d in diameters:
        for seed in seeds:
            key = f"{len(members):064x}"
            statistics = {
                "packing_fraction": np.array(0.4 + seed / 100),
                "packing_fraction_error": np.array(0.02),
                "nc_distance": np.array(math.nan if seed == 1 else 0.3),
                "edges": np.array([0, d / 2]),
            }
            factors = {"layers": np.array([0.8, 0.1]), "layers_error": np.array([0.003, 0.003])}
            stages = {"statistics": StageRecord("s", statistics), "view_factors": StageRecord("v", factors)}
            told = tuple(f"warning {k}" for k in range(warn))
            store.add(pack(UnitRecord(key, stages, told, 0.5)))
            values = {"particle_diameter": d, "seed": seed}
            members.append(
                Member(f"bed {len(members)}", key, {"statistics": "s", "view_factors": "v"}, 9, values=values)
            )
    store.merge(members, list(failures), ATTRIBUTES)
    return Results(path)


def screen(results, width=80):
    console = Console(width=width, record=True, file=io.StringIO())
    console.print(summary(results))
    return console.export_text()


def test_numbers_of_the_summary_are_those_put_in(tmp_path):
    rows = list(mean_rows(load_ensemble(make(tmp_path / "r.h5", [5e-4, 6e-4]))))
    found = {(row.group, row.name, row.where): row for row in rows}
    phi = found[1, "packing_fraction", ""]
    assert (phi.beds, phi.units) == (3, "1")
    assert phi.mean == pytest.approx(0.42)
    assert phi.scatter == pytest.approx(0.01)
    assert phi.packing_error == pytest.approx(0.01 / math.sqrt(3))
    assert phi.unit_error == pytest.approx(0.02)
    assert math.isnan(phi.ray_error)
    # a bed without a value does not count
    assert found[0, "nc_distance", ""].mean == 0.3
    layer = found[0, "layers", "layer 2"]
    assert (layer.mean, layer.scatter) == (pytest.approx(0.1), pytest.approx(0.0, abs=1e-15))
    assert layer.ray_error == pytest.approx(0.003 / math.sqrt(3))


def test_tables_have_a_row_a_number_and_a_row_a_bed(tmp_path):
    files = write_tables(make(tmp_path / "r.h5", [5e-4, 6e-4]), tmp_path)
    assert [file.name for file in files] == ["r_means.csv", "r_beds.csv", "r_failures.csv"]
    with (tmp_path / "r_beds.csv").open() as stream:
        beds = list(csv.DictReader(stream))
    assert len(beds) == 6
    assert beds[0]["particle diameter [m]"] == "0.0005"
    assert beds[0]["statistics/nc_distance [1]"] == ""
    assert float(beds[4]["statistics/packing_fraction [1]"]) == 0.4 + 2 / 100
    assert [bed["view_factors/layers 2 [1]"] for bed in beds] == ["0.1"] * 6
    with (tmp_path / "r_failures.csv").open() as stream:
        assert list(csv.DictReader(stream)) == [{"label": "a bad one", "error": "no [reason] at all"}]


def test_a_table_of_failures_goes_when_nothing_fails_any_more(tmp_path):
    kept, table = [tmp_path / "r_means.csv", tmp_path / "r_beds.csv"], tmp_path / "r_failures.csv"
    assert write_tables(make(tmp_path / "r.h5", [5e-4]), tmp_path) == [*kept, table]
    results = make(tmp_path / "r.h5", [5e-4], failures=())
    assert write_tables(results, tmp_path) == kept
    assert sorted(tmp_path.glob("*.csv")) == sorted(kept)
    # a file of that name that is none of ours stays
    table.write_text("label,reason\nmine,too\n")
    assert write_tables(results, tmp_path) == kept
    assert table.read_text() == "label,reason\nmine,too\n"


def test_the_screen_has_a_table_a_group_and_tells_of_failures_and_warnings(tmp_path):
    text = screen(make(tmp_path / "r.h5", [5e-4, 6e-4], warn=5))
    assert text.startswith("made up")
    assert "3 beds: particle diameter 0.5 mm" in text
    assert "3 beds: particle diameter 0.6 mm" in text
    # three beds scatter by .0058 about their mean, and state .02 each
    assert "0.420 ± 0.012" in text
    assert "1 bed failed: see the table of failures" in text
    assert text.count("6 beds warn: ") == 3
    assert "and 2 other warnings" in text
    assert max(map(len, text.splitlines())) <= 80


def test_of_many_beds_the_scatter_alone_counts(tmp_path):
    text = screen(make(tmp_path / "r.h5", [5e-4], seeds=tuple(range(1, 10))))
    error = np.std(np.arange(1, 10) / 100, ddof=1) / 3
    assert f"0.4500 ± {error:.4f}" in text


def test_many_groups_are_cut_short(tmp_path):
    text = screen(make(tmp_path / "r.h5", np.linspace(4e-4, 9e-4, SHOWN_GROUPS + 3), seeds=(1,)))
    assert "and 3 more combinations" in text


def test_results_of_one_bed_are_refused(tmp_path):
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file.attrs.update({"schema_version": 1, **ATTRIBUTES})
    with pytest.raises(BadFileError, match="no stage 'ensemble'"):
        write_tables(Results(tmp_path / "r.h5"), tmp_path)
