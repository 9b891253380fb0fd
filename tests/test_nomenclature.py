"""The names that the nomenclature gives are those of the code."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROWS = [line for line in (ROOT / "docs" / "nomenclature.md").read_text().splitlines() if line.startswith("| ")]
NAMES = sorted({name for row in ROWS for name in re.findall(r"`([A-Za-z_.]+)`", row)})


def test_the_page_names_what_it_lists():
    assert len(NAMES) > 50


@pytest.mark.parametrize("name", NAMES)
def test_every_name_is_in_the_code(name):
    """As a word: a module, a parameter or a function of the package."""
    words = [word for word in name.split(".") if word not in ("heat", "wall")]
    text = "\n".join(path.read_text() for path in (ROOT / "src" / "bedrad").rglob("*.py"))
    stems = {path.stem for path in (ROOT / "src" / "bedrad").rglob("*.py")}
    for word in words:
        assert word in stems or re.search(rf"\b{re.escape(word)}\b", text), word
