"""The documentation: its pages hang together, and what they show is what the program does.

`make docs` builds them and fails on a warning; here is what needs no build.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import re
import shlex
import sys
from pathlib import Path

import pytest

from bedrad import cli, heat
from bedrad.packings.files import FORMATS

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(
    page
    for suffix in ("md", "rst")
    for page in DOCS.rglob(f"*.{suffix}")
    if not {"_ext", "_static", "gallery"} & set(page.relative_to(DOCS).parts)
)
EXAMPLES = sorted(path.stem for path in (ROOT / "examples" / "gallery").glob("*.py"))
WALKED = [DOCS / "tutorial.md", *sorted((DOCS / "how_to").glob("*.md"))]
TIMES = re.compile(r"\d[\d.]* s\b|\d[\d.]* million a second")


def load_extension(file):
    name = f"docs_{file}"
    spec = importlib.util.spec_from_file_location(name, DOCS / "_ext" / f"{file}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where dataclasses look for it
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def gallery():
    return load_extension("gallery")


def toctree_entries(page):
    """The pages that the toctrees of a page name, as names of documents."""
    text = page.read_text()
    blocks = re.findall(r"```\{toctree\}\n(.*?)```", text, re.DOTALL)
    blocks += re.findall(r"\.\. toctree::\n((?:[ ]+.*\n|\n)+)", text)
    for line in "\n".join(blocks).splitlines():
        entry = line.strip()
        if entry and not entry.startswith(":"):
            target = re.sub(r"^.*<(.*)>$", r"\1", entry)
            yield ((page.parent / target).resolve()).relative_to(DOCS).as_posix()


def links(page):
    """Targets of the links and pictures of a page, without those outside the repository and within the page."""
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if not re.match(r"[a-z]+:|#", target):
            yield target.split("#")[0]


def console_blocks(page):
    """Commands of a page with what they print: pairs of a command line and lines."""
    for block in re.findall(r"```console\n(.*?)```", page.read_text(), re.DOTALL):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, printed = part.partition("\n")
            yield command, printed.rstrip().splitlines()


def bedrad_commands():
    return [
        pytest.param(command, printed, id=f"{page.stem}-{k}")
        for page in WALKED
        for k, (command, printed) in enumerate(console_blocks(page))
        if command.startswith("bedrad ")
    ]


def test_every_page_is_in_a_toctree():
    listed = {entry for page in PAGES for entry in toctree_entries(page)}
    names = {page.relative_to(DOCS).with_suffix("").as_posix() for page in PAGES}
    assert names - listed == {"index"}
    assert listed - names == {"gallery/index"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(DOCS).as_posix())
def test_links_lead_somewhere(page):
    for target in links(page):
        if target.startswith("gallery/") or "/gallery/index" in target:
            # the gallery's pages are made by the build, one an example
            assert Path(target).stem in [*EXAMPLES, "index"], target
        else:
            assert (page.parent / target).is_file(), target


@pytest.mark.parametrize("name", EXAMPLES)
def test_each_example_has_a_test_and_a_place_in_the_gallery(gallery, name):
    tests = "\n".join(path.read_text() for path in (ROOT / "tests" / "gallery").glob("test_*.py"))
    assert f'"{name}"' in tests
    assert sum(name in listed for listed in gallery.SECTIONS.values()) == 1
    example = gallery.read(ROOT / "examples" / "gallery" / f"{name}.py")
    assert example.title
    assert example.about
    assert "\npython examples" not in "\n" + example.about


def test_the_gallery_names_no_example_that_is_gone(gallery):
    assert {name for listed in gallery.SECTIONS.values() for name in listed} == set(EXAMPLES)


def test_an_example_that_no_section_names_comes_last(gallery):
    found = gallery.sections({"chute", "new"})
    assert list(found.values()) == [["chute"], ["new"]]
    assert list(found)[-1] == "More"


def test_an_example_runs_once_until_something_that_it_needs_changes(gallery, tmp_path, monkeypatch):
    monkeypatch.setattr(gallery, "KEPT", tmp_path / "kept")
    monkeypatch.setattr(gallery, "EXAMPLES", tmp_path)
    example = tmp_path / "small.py"
    example.write_text(
        "from pathlib import Path\nfrom bedrad import errors\nPath('small.png').write_bytes(b'x')\n"
        f"log = Path({str(tmp_path / 'log')!r})\nlog.write_text((log.read_text() if log.exists() else '') + 'ran')\n"
        "print('printed')\n"
    )
    for _ in range(2):
        folder = gallery.make("small")
        assert (folder / "printed.txt").read_text() == "printed\n"
    assert (tmp_path / "log").read_text() == "ran"
    assert str(ROOT / "src" / "bedrad" / "errors.py") in (folder / "needed.json").read_text()
    example.write_text(example.read_text() + "# changed\n")
    gallery.make("small")
    assert (tmp_path / "log").read_text() == "ranran"


@pytest.mark.parametrize(
    ("text", "complaint"), [("raise ValueError('no way')", "no way"), ("print(1)", r"drew no broken\.png")]
)
def test_a_broken_example_fails_the_build(gallery, tmp_path, monkeypatch, text, complaint):
    monkeypatch.setattr(gallery, "KEPT", tmp_path / "kept")
    monkeypatch.setattr(gallery, "EXAMPLES", tmp_path)
    (tmp_path / "broken.py").write_text(text)
    with pytest.raises(RuntimeError, match=complaint):
        gallery.make("broken")


def test_every_module_of_heat_is_in_the_reference():
    reference = "\n".join(page.read_text() for page in (DOCS / "api").glob("*.rst"))
    for name in heat.__all__:
        if name != "RangeWarning":
            assert f".. automodule:: bedrad.heat.{name}\n" in reference, name


def test_every_equation_names_functions_that_exist():
    count = 0
    for page in (DOCS / "theory").glob("*.md"):
        for options in re.findall(r"```\{equation\} .+\n((?::\w+:.*\n)+)", page.read_text()):
            names = re.search(r"^:by: (.+)$", options, re.MULTILINE)
            assert names is not None, options
            for name in names[1].split(", "):
                module = name
                while importlib.util.find_spec(module.split(".")[0]) and not is_module(module):
                    module = module.rpartition(".")[0]
                found = importlib.import_module(module)
                for part in name.removeprefix(module).strip(".").split("."):
                    found = getattr(found, part)
                assert callable(found), name
                count += 1
    assert count > 150


def is_module(name):
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def test_every_equation_can_be_drawn():
    draw = pytest.importorskip("ziamath") and load_extension("math_svg").draw
    for page in (DOCS / "theory").glob("*.md"):
        for latex in re.findall(r"```\{equation\} .+\n(?::\w+:.*\n)+(.+?)\n```", page.read_text(), re.DOTALL):
            assert draw(latex, False).startswith("<svg")
    with pytest.raises(ValueError, match=r"cannot draw the formula '\\\\frac\{1'"):
        draw(r"\frac{1", False)


def test_every_format_has_a_walk_through():
    text = (DOCS / "how_to" / "readers.md").read_text().lower()
    for row in FORMATS:
        assert f"\n## {row.name.lower()}\n" in text, row.name


@pytest.mark.parametrize(("command", "printed"), bedrad_commands())
def test_commands_exist(command, printed):
    """Their words are understood; nothing runs."""
    del printed
    words = shlex.split(command)[1:]
    if words != ["--version"]:
        cli.app.parse_args(words, exit_on_error=False, print_error=False)


def runs_at_once(command):
    """Commands that neither settle a bed nor need one that was settled before; nor draw for seconds."""
    pattern = r"--version| (settle|report|show) |(statistics|view-factors) bed\.h5|(beds|flows)\.toml"
    return not re.search(pattern, command)


@pytest.mark.parametrize(
    ("command", "printed"), [p for p in bedrad_commands() if runs_at_once(p.values[0]) and p.values[1]]
)
@pytest.mark.filterwarnings("ignore:specific heat")
def test_commands_print_what_the_page_shows(command, printed, call, tmp_path, monkeypatch):
    """Line by line, but for run times and for what `...` leaves out."""
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.chdir(tmp_path)
    for name in ("tests", "docs", "examples"):
        Path(name).symlink_to(ROOT / name)
    Path("liggghts_bed.dump.gz").symlink_to(DOCS / "_static" / "liggghts_bed.dump.gz")
    write_inputs(Path())
    code, out, _ = call(*shlex.split(command)[1:])
    assert code == 0
    lines = [TIMES.sub("TIME", line).rstrip() for line in out.splitlines()]
    start = 0
    for line in printed:
        if line != "...":
            wanted = TIMES.sub("TIME", line).rstrip()
            assert wanted in lines[start:], wanted
            start = lines.index(wanted, start) + 1


def write_inputs(folder):
    """The files that pages show in full."""
    job = re.search(r"```toml\n(name = .*?)```", (DOCS / "tutorial.md").read_text(), re.DOTALL)
    (folder / "liggghts_bed.toml").write_text(job[1])
    readers = (DOCS / "how_to" / "readers.md").read_text()
    for name, text in zip(
        ("rocky.csv", "points.txt"), re.findall(r"```text\n(.*?)```", readers, re.DOTALL), strict=True
    ):
        (folder / name).write_text(text)


@pytest.mark.parametrize("page", WALKED, ids=lambda page: page.stem)
def test_python_prints_what_the_page_shows(page, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("liggghts_bed.dump.gz").symlink_to(DOCS / "_static" / "liggghts_bed.dump.gz")
    for source, printed in re.findall(r"```python\n(.*?)```\n+```text\n(.*?)```", page.read_text(), re.DOTALL):
        exec(compile(ast.parse(source), page.name, "exec"), {})
        assert capsys.readouterr().out == printed
