"""With the compiler off the kernels are plain Python: the same numbers, and every line and branch of them runs.

Compiled code may fuse a product and a sum, so that floats differ by roundings; a ray's end changes by them only where
it grazes a sphere or an edge within 1e-15, one in 10^12.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import coverage
import numpy as np
import pytest

import bedrad
from bedrad.errors import EngineFailedError
from bedrad.raytrace.mesh_engines import available_engines, engine_maker
from oracles.kernel_scenes import scenes

SOURCE = Path(bedrad.__file__).parent
KERNELS = ["raytrace/kernels", "raytrace/block_kernels", "raytrace/candidate_kernels", "raytrace/patch_kernels",
           "packings/layer_kernels"]  # fmt: skip


def engines():
    """Mesh engines that start."""
    found = []
    for name in available_engines():
        try:
            engine_maker(name)
        except EngineFailedError:
            continue
        found.append(name)
    return found


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """What the scenes give in a process without the compiler, and for each module what of it ran there."""
    folder = tmp_path_factory.mktemp("coverage")
    data = folder / "data"
    words = ["-m", "coverage", "run", "--branch", "--rcfile=", f"--data-file={data}", f"--source={SOURCE}"]
    done = subprocess.run(
        # the numbers of unsigned integers wrap around in numpy as compiled, but numpy warns of it
        [sys.executable, "-W", "ignore::RuntimeWarning", *words, "-m", "oracles.kernel_scenes", *engines()],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    ran = coverage.Coverage(data_file=str(data), config_file=False)
    ran.load()
    ran.json_report(outfile=str(folder / "report.json"))
    report = json.loads((folder / "report.json").read_text())["files"]
    return json.loads(done.stdout), {Path(name).name: values for name, values in report.items()}


def test_kernels_give_the_same_numbers_with_the_compiler_off(plain):
    """Counts and ends of rays exactly; volumes and surfaces of balls within ten roundings of the whole ball's."""
    compiled = scenes(*engines())
    assert plain[0].keys() == compiled.keys()
    for name, expected in compiled.items():
        values = np.array(plain[0][name])
        if name.startswith("volumes"):
            np.testing.assert_allclose(values, expected, rtol=1e-15, atol=1e-14, err_msg=name)
        else:
            assert values.dtype == int, name
            np.testing.assert_array_equal(values, expected, err_msg=name)


@pytest.mark.parametrize("module", [*KERNELS, "raytrace/mesh_kernels"])
def test_every_line_and_branch_of_the_kernels_runs(plain, module):
    if module.endswith("mesh_kernels") and not engines():
        pytest.skip("neither open3d nor embreex is there")
    path = SOURCE / f"{module}.py"
    found, lines = plain[1][path.name], path.read_text(encoding="utf-8").splitlines()
    assert [f"{path.name}:{k}: {lines[k - 1].strip()}" for k in found["missing_lines"]] == []
    # a negative number stands for the way out of a function
    assert [f"{path.name}:{k} never goes to {to}: {lines[k - 1].strip()}" for k, to in found["missing_branches"]] == []
    assert found["summary"]["covered_lines"] > 50
    assert found["summary"]["covered_branches"] > 20
