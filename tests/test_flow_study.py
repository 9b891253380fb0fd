"""The table of the flow study, which several studies may add to."""

from __future__ import annotations

import csv
import importlib
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from bedrad.jobs.locking import results_lock

ROOT = Path(__file__).parents[1]


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    module = importlib.import_module("flow_study")
    for name in ("flow_study", "flow_points"):
        monkeypatch.delitem(sys.modules, name)
    return module


def rows(path):
    with path.open(newline="", encoding="utf-8") as stream:
        return [(row["point"], row["value"]) for row in csv.DictReader(stream)]


def test_rows_of_several_studies_at_once_all_find_their_place(study, tmp_path):
    names = [point.name for point in study.POINTS[:24]]
    table = tmp_path / "study.csv"
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda name: study.add_row(table, {"point": name, "value": 1.0}), reversed(names)))
    assert rows(table) == [(name, "1") for name in names]
    assert list(tmp_path.iterdir()) == [table]


def test_a_row_takes_the_place_of_an_older_one_of_its_point(study, tmp_path):
    table, names = tmp_path / "study.csv", [point.name for point in study.POINTS[:2]]
    for name, value in ((names[1], 1.0), (names[0], 2.0), (names[1], 3.0), ("no longer a point", 4.0)):
        study.add_row(table, {"point": name, "value": value})
    assert rows(table) == [(names[0], "2"), (names[1], "3"), ("no longer a point", "4")]


def test_a_table_that_is_held_too_long_is_said_to_be(study, tmp_path, monkeypatch):
    monkeypatch.setattr(study, "LONGEST_WAIT", 0.2)
    table = tmp_path / "study.csv"
    with results_lock(table), pytest.raises(TimeoutError, match=r"another study has held it for 0\.2 s"):
        study.add_row(table, {"point": "a", "value": 1.0})
    assert not table.exists()
