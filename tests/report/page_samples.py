"""Results files that pages are made from, a small job run from end to end; and pages read as a browser reads them."""

from __future__ import annotations

import warnings
from html.parser import HTMLParser

from bedrad.heat import RangeWarning
from bedrad.jobs.job import load_job
from bedrad.jobs.pipeline import run_job
from jobs.small_job import JOB, write_job

HOSTILE = '<script>alert(1)</script> "rings" & $5 </title><img src=x onerror=alert(2)>'
"""A name of a job that would run, break out of an attribute, end the title or start a formula."""


LONGER = JOB.replace("rays = 2048", "rays = 16384").replace("reference_rays = 32768", "reference_rays = 262144")
"""The small job with several runs in its study of convergence."""


def run_small_job(folder, text=LONGER, name=None):
    """Run the small job in a folder; its results."""
    if name is not None:
        quoted = name.replace("\\", "\\\\").replace('"', '\\"')
        text = text.replace('name = "rings"', f'name = "{quoted}"')
    job = write_job(folder, text)
    with warnings.catch_warnings():
        # one of the published systems lies outside the range of its own correlations
        warnings.simplefilter("ignore", RangeWarning)
        return run_job(load_job(job), folder / "results.h5")


class Page(HTMLParser):
    """Elements of a page with their attributes, its texts by element, its tables by caption."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.elements, self.texts, self.tables, self.open = [], {}, {}, []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in ("meta", "img", "input", "link"):
            self.open.append(tag)
        if tag == "tr":
            self.row = []
        if tag in ("th", "td"):
            self.row.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag
        if tag == "tr":
            self.tables[self.caption].append(self.row)

    def handle_data(self, data):
        self.texts.setdefault(self.open[-1] if self.open else "", []).append(data)
        if "caption" in self.open:
            self.caption = data
            self.tables[data] = []
        if "th" in self.open or "td" in self.open:
            self.row[-1] += data

    def anchors(self):
        return [attributes["id"] for tag, attributes in self.elements if tag == "section"]
