from __future__ import annotations

import base64
import hashlib
import json
import re
import sys

import h5py
import numpy as np
import pytest

import bedrad
import bedrad.report.page
from bedrad.errors import BadFileError, MissingExtraError
from bedrad.jobs.results import Results
from bedrad.report.page import make_page, write_page
from bedrad.report.page_document import asset
from bedrad.report.page_html import Html, measured
from jobs.small_job import JOB
from report.page_samples import HOSTILE, Page, run_small_job

SECTIONS = ["computed", "bed", "wall-layer", "view-factors", "convergence", "heat", "budget", "provenance"]


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return run_small_job(tmp_path_factory.mktemp("page"), name=HOSTILE)


@pytest.fixture(scope="module")
def text(results):
    return make_page(results)


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


def test_every_stage_has_its_section_in_one_order(page):
    assert page.anchors() == SECTIONS
    links = [attributes["href"] for tag, attributes in page.elements if tag == "a"]
    assert links == ["#content", *(f"#{anchor}" for anchor in SECTIONS)]


def test_the_page_may_load_nothing_and_run_its_own_script_only(page, text):
    meta = [attributes for tag, attributes in page.elements if tag == "meta"]
    policy = next(m["content"] for m in meta if m.get("http-equiv") == "Content-Security-Policy")
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'"
    assert rules["img-src"] == "data:"
    for name, tag in (("script-src", "script>"), ("style-src", "style>")):
        inside = text.rpartition(f"<{tag}")[2].partition(f"</{tag}")[0]
        assert rules[name] == f"'sha256-{base64.b64encode(hashlib.sha256(inside.encode()).digest()).decode()}'"
    for tag, attributes in page.elements:
        assert not {name for name in attributes if name.startswith("on") or name in ("style", "srcset", "action")}
        for name in ("src", "href", "data", "poster"):
            assert attributes.get(name, "#").startswith(("#", "data:")), (tag, attributes)
    assert "http:" not in re.sub(r"base64,[A-Za-z0-9+/=]*", "", text)
    assert "https:" not in re.sub(r"base64,[A-Za-z0-9+/=]*", "", text)


def test_a_hostile_name_is_text_everywhere(page):
    assert page.texts["h1"] == [HOSTILE]
    assert page.texts["title"] == [f"{HOSTILE}: report"]
    assert [attributes for tag, attributes in page.elements if tag == "script" and attributes] == [
        {"type": "application/json", "id": "bed-data"}
    ]
    assert "alert" not in str([attributes for _, attributes in page.elements])


def test_tables_hold_the_numbers_with_their_errors(page, results):
    statistics, traced = results.read("statistics"), results.read("view_factors")
    rows = {row[0]: row[1:] for row in page.tables["Measured and by correlation"]}
    found = measured(statistics["packing_fraction"], statistics["packing_fraction_error"])
    assert rows["solid fraction [–]"][0] == found
    assert "±" in found
    count = measured(1e-6 * statistics["contacts_per_area"], 1e-6 * statistics["contacts_per_area_error"])
    assert rows["wall contacts per area [1/mm²]"][0] == count
    factors = {row[0]: row[1:] for row in page.tables["View factors from the wall"]}
    error = np.hypot(traced["layers_error"][0], traced["layers_bed_error"][0])
    assert factors["wall layer"][1] == measured(traced["layers"][0], error)
    assert float(factors["sum"][1]) == pytest.approx(1.0, abs=2e-5)
    case = results.read("prediction")["measured"]
    heat = next(rows for caption, rows in page.tables.items() if caption.startswith("Heat transfer, from the bed"))
    assert [row[0] for row in heat[1:]] == ["100", "850"]
    for k, row in enumerate(heat[1:]):
        h, e = (case[f"heat_transfer_coefficient{name}"][k] for name in ("", "_error"))
        assert row[1] == measured(h, e)


def test_the_budget_lists_every_input_of_every_case(page, results):
    prediction = results.read("prediction")
    for key, words in (("measured", "from the bed"), ("correlations", "by correlation")):
        rows = page.tables[f"What matters at 850 °C, {words}"][1:]
        budget = prediction[key]["budget"]
        assert len(rows) == len(budget["inputs"])
        shares = [float(row[4]) for row in rows if row[4] != "–"]
        assert not shares or sum(shares) == pytest.approx(100, abs=3)
        elasticities = sorted(float(row[2].replace("−", "-").replace(" × 10⁻", "e-")[:6]) for row in rows[:1])
        assert elasticities


def test_provenance_has_inputs_versions_and_the_job(page, results):
    inputs = json.loads(results.attributes()["inputs"])
    assert page.tables["Input files"][1:] == [[name, digest] for name, digest in inputs.items()]
    versions = {row[0]: row[1] for row in page.tables["Versions and seed"]}
    assert versions["bedrad that wrote it"] == bedrad.__version__
    assert versions["seed of the job"] == "3"
    assert json.loads("".join(page.texts["pre"])) == json.loads(results.attributes()["job"])


@pytest.mark.usefixtures("no_figures")
def test_what_was_left_out_is_said_with_its_reason(tmp_path):
    text = re.sub(r"(?m)^\[(convergence|prediction)\]\n(.+\n)*", "", JOB)
    page = Page(make_page(run_small_job(tmp_path, text)))
    assert page.anchors() == ["computed", "bed", "wall-layer", "view-factors", "provenance"]
    told = page.texts["li"]
    assert "convergence: the job has no [convergence]" in told
    assert "heat transfer: the job has no [prediction]" in told


def test_a_prediction_alone_has_a_page_without_a_picture(tmp_path):
    text = """
[wall]
diameter = "7.75 mm"
[prediction]
particle_diameter = "600 um"
wall_temperatures = ["500 degC"]
velocity = "0.016 m/s"
published_systems = false
[output]
figures = false
"""
    page = Page(make_page(run_small_job(tmp_path, text)))
    assert page.anchors() == ["computed", "heat", "budget", "provenance"]
    assert "canvas" not in {tag for tag, _ in page.elements}
    assert [attributes for tag, attributes in page.elements if tag == "script"] == []


# Files that are something else


@pytest.fixture
def no_figures(monkeypatch):
    """Pages in a moment: what figures look like is tested elsewhere."""
    monkeypatch.setattr(bedrad.report.page, "embedded", lambda *_, **__: Html(""))


def copied(results, folder):
    path = folder / "copy.h5"
    path.write_bytes(results.path.read_bytes())
    return path


@pytest.mark.usefixtures("no_figures")
def test_groups_without_words_of_their_own_are_shown_as_they_stand(results, tmp_path):
    path = copied(results, tmp_path)
    with h5py.File(path, "r+") as file:
        group = file.create_group("alchemy")
        group.attrs["digest"] = "0" * 64
        gold = group.create_dataset("gold", data=0.5)
        gold.attrs["units"], gold.attrs["long_name"] = "kg", "<b>mass</b>"
        group.create_dataset("gold_error", data=0.01)
        group.create_dataset("deep/many", data=np.arange(12.0).reshape(3, 4))
        group.create_dataset("words", data=["a", "b"])
        group.create_dataset("word", data="<i>")
        group.create_dataset("none", data=h5py.Empty("f8"))
        # links lead round in a circle, or nowhere
        group["again"], file["ghost"] = h5py.SoftLink("/alchemy"), h5py.SoftLink("/nowhere")
        for k in range(100):
            group.create_dataset(f"z{k}", data=k)
    page = Page(make_page(Results(path)))
    rows = {row[0]: row[1:] for row in page.tables["alchemy"]}
    assert rows["gold"] == ["0.500 ± 0.010", "kg", "<b>mass</b>"]
    assert rows["deep/many"][0] == "3 × 4 numbers from 0 to 11.00"
    assert rows["words"][0] == "2 texts"
    assert rows["word"][0] == "<i>"
    assert rows["none"][0] == "none"
    assert len(rows) == 61


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda file: file["statistics"].pop("packing_fraction"), "not as bedrad writes it .*packing_frac"),
        (lambda file: file["view_factors"].pop("window", None) or file["view_factors"].attrs.pop("window"), "window"),
        (lambda file: file["prediction/measured"].attrs.pop("title"), "prediction: not as bedrad writes it"),
        (lambda file: file["packing"].pop("radii"), "radii"),
        (lambda file: file.attrs.modify("job", "[1]"), "job: not as bedrad writes it"),
        (lambda file: file.attrs.modify("job", "nonsense"), "job: not as bedrad writes it"),
        (lambda file: file.pop("packing") and file.create_dataset("packing", data=1.0), None),
    ],
    ids=["statistics", "view_factors", "prediction", "packing", "list", "no job", "no group"],
)
@pytest.mark.usefixtures("no_figures")
def test_a_stage_that_bedrad_did_not_write_is_one_clear_error(results, tmp_path, damage, message):
    path = copied(results, tmp_path)
    with h5py.File(path, "r+") as file:
        damage(file)
    if message is None:
        assert "bed" not in Page(make_page(Results(path))).anchors()
        return
    with pytest.raises(BadFileError, match=message):
        make_page(Results(path))


def test_a_missing_file_and_a_missing_library_are_told(results, tmp_path, monkeypatch):
    with pytest.raises(BadFileError, match="no such results file"):
        make_page(Results(tmp_path / "none.h5"))
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingExtraError, match=r"bedrad\[view\]"):
        write_page(results, tmp_path / "page.html")
    assert list(tmp_path.iterdir()) == []


# Looks


def luminance(colour):
    short = colour.lstrip("#")
    full = short if len(short) == 6 else "".join(2 * c for c in short)
    parts = [int(full[k : k + 2], 16) / 255 for k in (0, 2, 4)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_every_palette_has_enough_contrast():
    palettes = re.findall(r":root \{[^}]*--paper[^}]*\}", asset("page.css"))
    assert len(palettes) == 3  # light, dark, print
    for palette in palettes:
        colours = dict(re.findall(r"--(\w+): (#[0-9a-f]{3,6})", palette))
        for paper in ("paper", "shade"):
            for ink in ("ink", "soft", "link"):
                lighter, darker = sorted((luminance(colours[paper]), luminance(colours[ink])), reverse=True)
                assert (lighter + 0.05) / (darker + 0.05) >= 4.5, (ink, paper)
