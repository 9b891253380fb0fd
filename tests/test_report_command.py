from __future__ import annotations

import sys
import webbrowser

import pytest

import bedrad.report.page
from bedrad.report.page_html import Html
from report.page_samples import run_small_job


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("report")
    run_small_job(made)
    return made


@pytest.fixture(autouse=True)
def _no_figures(monkeypatch):
    monkeypatch.setattr(bedrad.report.page, "embedded", lambda *_, **__: Html(""))


def test_the_page_goes_beside_its_results(folder, call):
    code, out, err = call("report", folder / "results.h5")
    assert (code, err) == (0, [])
    assert out == f"wrote {folder / 'results.html'}\n"
    text = (folder / "results.html").read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>")
    assert "<h1>rings</h1>" in text


def test_the_page_goes_where_it_is_wanted_and_is_opened(folder, call, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    target = tmp_path / "deep" / "page.htm"
    code, _, err = call("report", folder / "results.h5", "-o", target, "--open")
    assert (code, err) == (0, [])
    assert opened == [target.as_uri()]
    monkeypatch.setattr(webbrowser, "open", lambda _: False)
    code, _, err = call("report", folder / "results.h5", "-o", target, "--open")
    assert code == 1
    assert "no browser opened" in err[0]


def test_what_cannot_be_a_page_is_refused_before_anything_is_read(folder, refused, tmp_path):
    assert "suffix '.pdf'; a page is written as .html" in refused(2, "report", folder / "results.h5", "-o", "page.pdf")
    assert "no such results file" in refused(2, "report", tmp_path / "none.h5")
    (tmp_path / "bed.html").write_bytes((folder / "results.h5").read_bytes())
    assert "is what the page is made from" in refused(2, "report", tmp_path / "bed.html")
    assert "not a bedrad results file" in refused(2, "report", folder / "bed.h5")
    (tmp_path / "file").write_text("")
    told = refused(1, "report", folder / "results.h5", "-o", tmp_path / "file" / "page.html")
    assert "cannot write" in told


def test_a_missing_library_leaves_no_page(folder, refused, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    told = refused(1, "report", folder / "results.h5", "-o", tmp_path / "page.html")
    assert told == 'matplotlib is not installed; install it with: pip install "bedrad[view]"'
    assert list(tmp_path.iterdir()) == []
