from __future__ import annotations

import webbrowser
from pathlib import Path
from urllib.parse import unquote, urlparse

import numpy as np
import pytest

import bedrad
from bedrad.report import pictures_viewer
from report.page_samples import run_small_job


@pytest.fixture(autouse=True)
def _small_pictures(monkeypatch):
    monkeypatch.setattr(pictures_viewer, "_STILL", (80, 60))


def test_a_bed_is_opened_in_the_browser(bed, call, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    code, out, err = call("show", bed)
    assert (code, err) == (0, [])
    page = Path(unquote(urlparse(opened[0]).path))
    assert out == f"wrote {page}\n"
    assert "<h1>bed.h5</h1>" in page.read_text(encoding="utf-8")
    monkeypatch.setattr(webbrowser, "open", lambda _: False)
    code, _, err = call("show", bed)
    assert code == 1
    assert "it can be opened by hand" in err[0]


@pytest.mark.parametrize("name", ["bed.png", "bed.html"])
def test_a_picture_is_saved_and_nothing_opened(bed, call, tmp_path, monkeypatch, name):
    monkeypatch.setattr(webbrowser, "open", lambda _: pytest.fail("opened"))
    target = tmp_path / "deep" / name
    code, out, err = call("show", bed, "--save", target, "--layers", "2")
    assert (code, out, err) == (0, f"wrote {target}\n", [])
    assert target.read_bytes().startswith(b"\x89PNG" if name.endswith("png") else b"<!DOCTYPE html>")


def test_files_for_paraview_know_what_the_results_know(call, tmp_path, monkeypatch):
    monkeypatch.setattr(webbrowser, "open", lambda _: pytest.fail("opened"))
    results = run_small_job(tmp_path)
    code, out, err = call("show", results.path, "--vtp", tmp_path / "hot")
    assert (code, err) == (0, [])
    assert out == f"wrote {tmp_path / 'hot_spheres.vtp'}\nwrote {tmp_path / 'hot_wall.vtp'}\n"
    head = (tmp_path / "hot_spheres.vtp").read_bytes().partition(b"<AppendedData")[0].decode()
    for name in ("radius", "id", "layer", "contact", "view_factor"):
        assert f'Name="{name}"' in head
    np.testing.assert_array_equal(bedrad.read(tmp_path / "hot_spheres.vtp").radii, bedrad.read(results.path).radii)


def test_what_cannot_be_shown_is_refused(bed, refused, tmp_path):
    assert "suffix '.jpg'; a picture is written as .png or .html" in refused(2, "show", bed, "--save", "x.jpg")
    assert "no such file" in refused(2, "show", tmp_path / "none.h5").lower()
    assert "layers is 0; expected at least 1" in refused(2, "show", bed, "--layers", "0")
    assert "layers is 90" in refused(2, "show", bed, "--layers", "90", "--save", tmp_path / "x.png")
    (tmp_path / "bed.html").write_bytes(bed.read_bytes())
    assert "is the bed itself" in refused(2, "show", tmp_path / "bed.html", "--save", tmp_path / "bed.html")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["bed.h5", "bed.html"]
