"""The page docs/formats.md: its table names the formats that bedrad has, its job is one."""

from __future__ import annotations

import re
from pathlib import Path

from bedrad.jobs.job import parse_job
from bedrad.packings.files import FORMATS

PAGE = Path(__file__).parents[1] / "docs" / "formats.md"


def rows() -> list[dict[str, str]]:
    lines = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("|")]
    titles, _, *cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return [dict(zip(titles, row, strict=True)) for row in cells]


def test_the_table_has_every_format_in_the_order_in_which_they_are_tried() -> None:
    assert [row["format"] for row in rows()] == [form.name for form in FORMATS]


def test_the_table_names_the_suffixes_and_what_is_written() -> None:
    for row, form in zip(rows(), FORMATS, strict=True):
        assert tuple(row["suffixes"].split()) == form.suffixes, form.name
        assert row["written"] == ("yes" if form.write is not None else "no"), form.name


def test_the_table_says_of_every_format_what_it_was_tested_on() -> None:
    for row in rows():
        assert all(row.values()), row["format"]
        assert any(word in row["tested on"] for word in ("real files", "made here", "bedrad's own")), row["format"]


def test_the_keys_of_a_job_are_those_that_a_job_takes() -> None:
    text = re.search(r"```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert text is not None
    file = parse_job(text[1], PAGE).packing.file  # type: ignore[union-attr]
    assert file is not None
    assert file.wall_file == PAGE.parent / "tube.stl"
    assert file.options()["columns"]["radius"] == "7"
    # what it does not show, it names
    for key in {*type(file).model_fields} - file.model_fields_set:
        assert key in text[1], key
