from __future__ import annotations

import re

import numpy as np
import pytest

import bedrad
from bedrad.jobs.ensemble import run_ensemble
from bedrad.jobs.job import load_job
from bedrad.jobs.results import Results
from bedrad.report.ensemble_records import load_ensemble
from bedrad.report.page import make_page
from bedrad.report.page_ensemble import ensemble_section
from bedrad.report.page_html import measured
from jobs.small_job import JOB, ring_bed
from report.page_samples import Page


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Three beds and a file that is none."""
    folder = tmp_path_factory.mktemp("ensemble")
    for k in range(3):
        bedrad.write(ring_bed(k), folder / f"bed_{k}.h5")
    (folder / "bed_9<i>.h5").write_bytes(b"nonsense")
    text = re.sub(r"(?m)^\[convergence\]\n(.+\n)*", "", JOB).replace('"bed.h5"', '"bed_*.h5"')
    (folder / "job.toml").write_text(text.replace('"0.016 m/s"', '"0.016 m/s"\npublished_systems = false'))
    run_ensemble(load_job(folder / "job.toml"), folder / "results.h5")
    return Results(folder / "results.h5")


def test_means_and_failures_of_many_beds_are_shown(results):
    page = Page(make_page(results))
    assert page.anchors() == ["computed", "ensemble", "provenance"]
    # what is only for flows is not left out of other beds
    assert "[flow]" not in make_page(results)
    assert "3 beds" in page.texts["h3"]
    record = load_ensemble(results)
    held = record.ensemble["statistics"]
    rows = {row[0]: row[1:] for row in page.tables["Packing statistics"]}
    found = measured(held["packing_fraction"][0], held["packing_fraction_packing_error"][0])
    assert rows["solid fraction of the wall layer"][2] == found
    h = record.ensemble["prediction"]["measured"]["heat_transfer_coefficient"][0]
    heat = page.tables["Heat transfer, from the beds"]
    assert heat[1][1] == "100 °C"
    assert float(heat[1][3].split(" ±")[0].replace(",", "")) == pytest.approx(h[0], rel=2e-3)
    assert "Heat transfer, by correlation" in page.tables
    failed = page.tables["Left out: 1 bed that failed"]
    assert "bed_9<i>.h5" in failed[1][0]
    beds = page.tables["Beds behind the means"][1:]
    assert len(beds) == 3
    assert all(re.fullmatch("[0-9a-f]{64}", row[3]) for row in beds)
    assert np.all([row[2].endswith(" s") for row in beds])


def test_the_section_can_stand_alone(results):
    assert Page(ensemble_section(results)).anchors() == ["ensemble"]
