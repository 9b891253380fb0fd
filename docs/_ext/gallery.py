"""The gallery: a page for each file of examples/gallery, with what it draws, what it prints and how it is written.

Each example runs in a process and a folder of its own. What it made is kept under build/gallery with the digests of the
files that it loaded from here, and is used again until one of them changes.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "gallery"
KEPT = ROOT / "build" / "gallery"
PAGES = ROOT / "docs" / "gallery"
LONGEST = 300
"""Seconds after which an example is taken to hang."""

SECTIONS = {
    "The wall layer": ("wall_layer_conductivity", "wall_layer_shares", "wall_layer_velocity", "fluid_lens"),
    "Radiation and bulk": ("grey_walls", "bulk_conductivity"),
    "Heated tubes": ("two_layer_entry", "cold_flows", "diameter_ratio", "measured_flow"),
    "Hot flows": ("hot_flows", "large_particles", "particle_diameter", "uncertainty_budget"),
    "Particles and blocks": ("particle_biot", "block_and_bed"),
    "Chutes, cells, tube banks, slurries": ("chute", "static_bed_cell", "tube_bank", "slurry_pipe"),
}
"""Which examples stand together, and in which order; what is not named here comes last."""

# runs the example, and then says which files of this project it needed
RUNNER = """\
import json, pathlib, runpy, sys
example, needed, root = sys.argv[1:4]
sys.argv = [example]
runpy.run_path(example, run_name="__main__")
files = {getattr(m, "__file__", None) for m in list(sys.modules.values())}
here = sorted(f for f in files if f and f.startswith(root + "/src/"))
pathlib.Path(needed).write_text(json.dumps([example, *here]))
"""


@dataclass(frozen=True)
class Example:
    """An example: its name, the first line and the rest of what it says about itself, and its text."""

    name: str
    title: str
    about: str
    source: str


def read(path: Path) -> Example:
    """Read an example without running it."""
    source = path.read_text()
    text = ast.get_docstring(ast.parse(source)) or ""
    title, _, about = text.partition("\n")
    # the line that says how to run it is on the page anyway
    about = "\n".join(line for line in about.splitlines() if not line.strip().startswith("python examples/"))
    return Example(path.stem, title.strip().rstrip("."), about.strip(), source)


def sections(names: set[str]) -> dict[str, list[str]]:
    """The examples of each section; a last one for those that no section names."""
    found = {title: [name for name in listed if name in names] for title, listed in SECTIONS.items()}
    rest = sorted(names.difference(*found.values()))
    return {title: listed for title, listed in (found | {"More": rest}).items() if listed}


def _digest(path: str) -> str:
    file = Path(path)
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else ""


def _fresh(record: Path) -> bool:
    if not record.is_file():
        return False
    kept = json.loads(record.read_text())
    return all(_digest(path) == digest for path, digest in kept.items())


def make(name: str) -> Path:
    """The folder with what an example printed and drew; it runs if that is not there or no longer right.

    Raises
    ------
    RuntimeError
        If the example fails, or draws nothing.
    """
    folder, record = KEPT / name, KEPT / name / "needed.json"
    if _fresh(record):
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    environment = os.environ | {"MPLBACKEND": "Agg", "PYTHONWARNINGS": "default", "PYTHONIOENCODING": "utf-8"}
    words = [sys.executable, "-c", RUNNER, str(EXAMPLES / f"{name}.py"), "files.json", str(ROOT)]
    ran = subprocess.run(  # noqa: S603
        words, cwd=folder, env=environment, capture_output=True, text=True, timeout=LONGEST, check=False
    )
    if ran.returncode:
        raise RuntimeError(f"examples/gallery/{name}.py failed:\n{ran.stderr}")
    if not (folder / f"{name}.png").is_file():
        raise RuntimeError(f"examples/gallery/{name}.py drew no {name}.png; an example saves a picture of its name")
    (folder / "printed.txt").write_text(ran.stdout)
    needed = {*json.loads((folder / "files.json").read_text()), *map(str, (ROOT / "examples").glob("*.csv"))}
    record.write_text(json.dumps({path: _digest(path) for path in sorted(needed)}))
    return folder


def page(example: Example, folder: Path) -> str:
    """The page of one example."""
    picture = os.path.relpath(folder / f"{example.name}.png", PAGES)
    printed = (folder / "printed.txt").read_text().strip()
    parts = [
        f"# {example.title}",
        f"![{example.title}]({picture})",
        example.about,
        f"    python examples/gallery/{example.name}.py",
    ]
    if printed:
        parts += ["## What it prints", f"```text\n{printed}\n```"]
    parts += ["## How it is written", f"```python\n{example.source.strip()}\n```"]
    return "\n\n".join(parts) + "\n"


def index(examples: dict[str, Example]) -> str:
    """The page that shows all of them."""
    parts = [
        "# Gallery",
        "One example a model. Each runs on its own, without network, in seconds; these pages show what it drew and "
        "printed when they were built. Each has a test that asserts what it shows.",
    ]
    for title, names in sections(set(examples)).items():
        parts.append(f"## {title}")
        cards = []
        for name in names:
            picture = os.path.relpath(KEPT / name / f"{name}.png", PAGES)
            cards.append(f"- [![]({picture})]({name}.md) [{examples[name].title}]({name}.md)")
        parts += ["{.gallery}\n" + "\n".join(cards)]
        listed = [f"{name.replace('_', ' ').capitalize()} <{name}>" for name in names]
        parts.append("```{toctree}\n:hidden:\n\n" + "\n".join(listed) + "\n```")
    return "\n\n".join(parts) + "\n"


def _write(path: Path, text: str) -> None:
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)


def build(_: Sphinx) -> None:
    """Run what has to run, and write the pages."""
    examples = {path.stem: read(path) for path in sorted(EXAMPLES.glob("*.py"))}
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        folders = dict(zip(examples, pool.map(make, examples), strict=True))
    PAGES.mkdir(exist_ok=True)
    for old in PAGES.glob("*.md"):
        if old.stem not in examples and old.name != "index.md":
            old.unlink()
    for name, example in examples.items():
        _write(PAGES / f"{name}.md", page(example, folders[name]))
    _write(PAGES / "index.md", index(examples))


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", build, priority=100)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
