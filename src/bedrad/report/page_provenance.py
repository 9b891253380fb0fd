"""Sections of the page on what a results file holds beside known stages, and on where everything comes from."""

from __future__ import annotations

import json
import platform
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from bedrad import __version__
from bedrad.jobs.results import StageData
from bedrad.report.page_html import Html, element, given, measured, number, page_section, table
from bedrad.report.records import Record

__all__ = ["groups", "other_stages", "provenance"]

MOST_ROWS = 60
"""Rows shown of a stage that the page has no words for."""


def groups(path: Path) -> set[str]:
    """Names of the groups in a results file."""
    with h5py.File(path, "r") as file:
        return {str(name) for name in _own(file)}


def other_stages(path: Path, names: set[str]) -> Html:
    """Stages that the page has no words of its own for: what they hold, as it stands.

    Parameters
    ----------
    path : Path
        The results file.
    names : set of str
        Their groups.
    """
    parts: list[str] = [
        element("p", "This page has no words of its own for the following; it shows numbers as the file holds them.")
    ]
    with h5py.File(path, "r") as file:
        for name in sorted(names):
            rows: list[list[str]] = []
            count = _walk(file[name], "", rows)
            note = [f"{count - len(rows):,} more are not shown."] if count > len(rows) else []
            parts.append(table(name.replace("_", " "), ["what", "value", "unit", "meaning"], rows, note, words=[2, 3]))
    return page_section("other", "Also in the file", *parts)


def _own(group: h5py.Group) -> list[str]:
    """Names of what a group holds itself; a link may lead nowhere, or back to where it is."""
    return [name for name in group if isinstance(group.get(name, getlink=True), h5py.HardLink)]


def _walk(item: Any, place: str, rows: list[list[str]]) -> int:
    """Add a row for every number in a group and the groups in it; how many there are."""
    if isinstance(item, h5py.Dataset):
        if len(rows) < MOST_ROWS:
            unit, meaning = (_attribute(item, key) for key in ("units", "long_name"))
            rows.append([place, _shown(item), "–" if unit == "1" else unit, meaning])
        return 1
    if not isinstance(item, h5py.Group):
        return 0
    names = [name for name in _own(item) if not (name.endswith("_error") and name.removesuffix("_error") in item)]
    return sum(_walk(item.get(name), f"{place}/{name}" if place else name, rows) for name in names)


def _attribute(item: Any, key: str) -> str:
    value = item.attrs.get(key, "")
    return value if isinstance(value, str) else ""


def _shown(item: Any) -> str:
    """A dataset in a few words: a number with its error, or the range of many."""
    kind = item.dtype.kind
    if item.size == 0 or item.shape is None:
        return "none"
    if kind not in "fiub":
        text = item.asstr()[()] if kind == "O" and item.shape == () and h5py.check_string_dtype(item.dtype) else None
        return f"{item.size:,} texts" if text is None else str(text)
    shape = " × ".join(map(str, item.shape))
    if item.shape == ():
        value, error = float(item[()]), item.parent.get(f"{item.name.rpartition('/')[2]}_error")
        numeric = isinstance(error, h5py.Dataset) and error.shape == () and error.dtype.kind == "f"
        if kind in "iub":
            return f"{int(item[()]):,}"
        return measured(value, float(error[()]) if numeric else float("nan"))
    values = np.asarray(item[()], dtype=float)
    finite = values[np.isfinite(values)]
    if not finite.size:
        return f"{shape} numbers, none finite"
    return f"{shape} numbers from {number(float(finite.min()))} to {number(float(finite.max()))}"


def provenance(record: Record, job: StageData, path: Path) -> Html:
    """Where everything comes from: inputs, versions, seeds, the bed, and the job as resolved."""
    attributes = record.attributes
    rows = [
        ["results file", path.name],
        ["written", str(attributes.get("created", "not known"))],
        ["bedrad that wrote it", str(attributes.get("bedrad_version", "not known"))],
        ["bedrad that made this page", __version__],
        ["Python, NumPy, HDF5", f"{platform.python_version()}, {np.__version__}, {h5py.version.hdf5_version}"],
        ["seed of the job", str(job.get("seed", "not known"))],
    ]
    parts: list[str] = [table("Versions and seed", ["", "value"], rows, words=[1])]
    inputs = _mapping(str(attributes.get("inputs", "{}")))
    if inputs:
        files = [[str(name), element("code", str(digest))] for name, digest in inputs.items()]
        parts.append(table("Input files", ["file", "SHA-256"], files, words=[1]))
    digests = [
        [stage, element("code", str(data["digest"]))] for stage, data in record.stages.items() if "digest" in data
    ]
    if digests:
        note = ["SHA-256 of all that went into a stage: the job's words, the versions and the stages before it."]
        parts.append(table("Stages", ["stage", "digest"], digests, note, words=[1]))
    bed = record.stages.get("packing", {}).get("provenance")
    if isinstance(bed, dict) and bed:
        facts = [[str(key).replace("_", " "), _fact(value)] for key, value in bed.items()]
        parts.append(table("The bed", ["", "value"], facts, words=[1]))
    text = json.dumps(job, indent=1, sort_keys=True, ensure_ascii=False)
    listing = element("pre", text, tabindex=0, role="region", aria_label="the job")
    parts.append(element("details", element("summary", "The job as resolved, in SI units"), listing))
    return page_section("provenance", "Where it comes from", *parts)


def _fact(value: Any) -> str:
    return given(value) if isinstance(value, float) else str(value)


def _mapping(text: str) -> dict[str, Any]:
    try:
        held = json.loads(text)
    except ValueError:
        return {}
    return held if isinstance(held, dict) else {}
