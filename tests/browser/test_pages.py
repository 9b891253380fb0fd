"""Pages in a real browser: no errors, everything visible, at the width of a desk and of a phone."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import bedrad
from bedrad.report.page import make_page
from bedrad.report.pictures import make_scene, still
from bedrad.report.pictures_viewer import write_viewer
from browser.driver import BROWSER, DRIVER, LOOK, Browser
from report.page_samples import HOSTILE, run_small_job

pytestmark = pytest.mark.skipif(
    BROWSER is None or DRIVER is None, reason="no Chromium with its driver (Debian: chromium, chromium-driver)"
)

SECTIONS = ("computed", "bed", "wall-layer", "view-factors", "convergence", "heat", "budget", "provenance")
WIDTHS = (1100, 360)
RIGHT, HOME = "\ue014", "\ue011"


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    made = Browser(tmp_path_factory.mktemp("browser") / "profile")
    yield made
    made.close()


def other_bed(wall):
    """A few spheres at a wall that is no tube."""
    centers = [(x, y, z) for x in (-3.0, 0.0, 3.0) for y in (-3.0, 3.0) for z in (0.5, 2.0)]
    return bedrad.Packing(centers, 0.5, wall)


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Files: the report of a small job with a hostile name, and pictures of beds at other walls."""
    folder = tmp_path_factory.mktemp("pages")
    text = make_page(run_small_job(folder, name=HOSTILE.replace("alert(1)", "window.hacked = 1")))
    (folder / "job.html").write_text(text, encoding="utf-8")
    for wall in (bedrad.Rod(radius=1.5), bedrad.Plate()):
        write_viewer(make_scene(other_bed(wall), name="<b>bed</b>"), folder / f"{wall.kind}.html")
    return folder


@pytest.fixture(scope="module")
def seen(browser, pages):
    """What there is on each page at each width, and what console and network told meanwhile."""
    browser.console()
    browser.requests()
    views = {}
    for name, width in itertools.product(("job", "rod", "plate"), WIDTHS):
        browser.open(pages / f"{name}.html", width)
        views[name, width] = browser.run(LOOK)
    return views, browser.console(), browser.requests()


def test_the_console_is_silent_and_nothing_is_asked_for_but_the_pages(seen, pages):
    _, console, requests = seen
    assert console == []
    own = {(pages / f"{name}.html").as_uri() for name in ("job", "rod", "plate")}
    assert {address for address in requests if not address.startswith("data:")} == own


def test_no_script_runs_but_the_one_of_the_page(seen):
    views = seen[0].values()
    assert {view["scripts"] for view in views} == {1}
    assert {view["hacked"] for view in views} == {None}
    assert seen[0]["job", 360]["title"].startswith("<script>window.hacked = 1</script>")


def test_every_picture_is_there_and_described(seen):
    for (name, _), view in seen[0].items():
        for text, width in view["images"]:
            assert width > 0, text
            assert len(text) > 30
        # the bed, profiles, unrolled wall, view factors, convergence, two of heat transfer, budget
        assert len(view["images"]) == (8 if name == "job" else 1)


def test_links_lead_to_their_sections(seen):
    for width in WIDTHS:
        view = seen[0]["job", width]
        assert {f"#{anchor}" for anchor in SECTIONS} <= set(view["links"])
        assert {link.removeprefix("#") for link in view["links"]} <= set(view["ids"])
        assert len(view["ids"]) == len(set(view["ids"]))


def test_no_page_is_wider_than_the_screen(seen):
    assert {key: (view["width"], view["overflow"]) for key, view in seen[0].items()} == {
        (name, width): (width, 0) for name, width in seen[0]
    }


def test_headings_and_tables_are_told_to_those_who_listen(seen):
    for view in seen[0].values():
        assert view["headings"].count(1) == 1
        assert view["headings"][0] == 1
        assert all(after - before <= 1 for before, after in itertools.pairwise(view["headings"]))
        assert set(view["scopes"]) <= {"col", "row"}
        assert all(view["captions"])


@pytest.mark.parametrize("wall", [bedrad.Rod(radius=1.5), bedrad.Plate()], ids=lambda wall: wall.kind)
def test_the_browser_draws_what_the_still_picture_shows(browser, pages, wall):
    browser.open(pages / f"{wall.kind}.html")
    seen = np.array(browser.pixels()).reshape(60, 80, 4)
    drawn, _ = still(make_scene(other_bed(wall)), size=(80, 60))
    whole = (seen[..., 3] == 255) & (drawn[..., 3] == 255)
    assert whole.mean() > 0.1
    # both are means over a pixel, by different rules: rims differ
    assert np.mean((seen[..., 3] > 128) != (drawn[..., 3] > 128)) < 0.01
    difference = np.abs(seen[..., :3] - drawn[..., :3].astype(int)).max(axis=2)[whole]
    assert np.median(difference) <= 3
    assert np.mean(difference > 40) < 0.08


def differ(first, second):
    return sum(abs(a - b) > 8 for a, b in zip(first, second, strict=True))


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", ["job", "rod", "plate"])
def test_the_bed_is_drawn_and_follows_keys_pointer_and_controls(browser, pages, name, width):
    browser.open(pages / f"{name}.html", width)
    browser.run("document.querySelector('canvas').scrollIntoView({block: 'center'})")
    first = before = browser.pixels()
    colours = {tuple(first[k : k + 3]) for k in range(0, len(first), 4)}
    assert len(colours) > 50
    assert sum(opacity > 128 for opacity in first[3::4]) > 0.05 * len(first) / 4
    slide = "const s = document.querySelector('[name=opening]'); s.value = 20; s.dispatchEvent(new Event('input'))"
    actions = {
        "key": lambda: browser.press(RIGHT),
        "zoom": lambda: browser.press("+"),
        "drag": lambda: browser.drag(40, 15),
        "opening": lambda: browser.run(slide),
        "wall": lambda: browser.run("document.querySelector('[name=wall]').click()"),
    }
    for action, act in actions.items():
        act()
        after = browser.pixels()
        assert differ(before, after) > 30, action
        before = after
    browser.run("document.querySelector('button').click()")
    assert browser.pixels() == first
    assert browser.console() == []


def test_where_a_browser_cannot_draw_a_still_picture_stands_for_it(browser, pages):
    browser.tell(
        "Page.addScriptToEvaluateOnNewDocument",
        {"source": "HTMLCanvasElement.prototype.getContext = () => null"},
    )
    browser.open(pages / "job.html")
    shown = "return [...document.querySelectorAll('.still, .failed, canvas, .controls')].map((e) => e.offsetHeight > 0)"
    assert browser.run(shown) == [False, True, True, False]
    assert browser.console() == []
