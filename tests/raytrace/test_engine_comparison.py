"""The comparison of engines, with engines whose bias is known in place of meshes, and with meshes."""

import math

import numpy as np
import pytest

import bedrad
from bedrad.errors import MissingExtraError
from bedrad.raytrace import engine_comparison, engine_runs
from bedrad.raytrace.engine_comparison import compare_engines, free_memory, mesh_libraries
from bedrad.raytrace.mesh_engines import ENGINES, available_engines
from bedrad.raytrace.tracer import GridTracer
from jobs.small_job import ring_bed
from oracles.engines import BiasedTracer

SHARES = {"inscribed": 0.1, "equal area": 0.02, "equal volume": 0.05}
"""What fake meshes send from the first layer to the second at subdivision 2; a quarter of it at each further one."""

MISSING = str(MissingExtraError("embreex", "mesh"))


class FakeMesh(BiasedTracer):
    """A mesh with a bias by subdivision and scaling, that remembers what was asked for."""

    made = ()

    def __init__(self, packing, edges, window, engine, subdivision, scaling, sort):
        super().__init__(GridTracer(packing, edges, window), SHARES[scaling] / 4 ** (subdivision - 2))
        self.triangles = 20 * 4**subdivision * len(packing)
        type(self).made += ((engine, subdivision, scaling, sort),)


@pytest.fixture
def fake(monkeypatch):
    monkeypatch.setattr(engine_comparison, "mesh_libraries", lambda: (["open3d"], [("embree", MISSING)]))
    monkeypatch.setattr(engine_comparison, "MeshTracer", FakeMesh)
    monkeypatch.setattr(FakeMesh, "made", ())
    return FakeMesh


def test_meshes_get_their_best_scaling_and_their_bias_is_found(fake, monkeypatch):
    """Biases of 3 subdivisions within 4 standard errors."""
    monkeypatch.setattr(engine_comparison, "_too_costly", lambda *_: "")
    bed = ring_bed()
    found = compare_engines(bed, budget=1e-3, seeds=4, seed=3)
    assert [runs.name for runs in found.engines] == [
        "bedrad", "grid walk", "open3d, subdivision 2", "open3d, subdivision 3", "open3d, subdivision 4",
    ]  # fmt: skip
    assert found.names == ("layer 1", "layer 2", "layer 3", "beyond", "wall", "escaped")
    assert found.left_out == (("embree", MISSING),)
    assert {made[2] for made in fake.made[4:]} == {"equal area"}
    assert [made[1] for made in fake.made[4:]] == [2, 3, 4]
    known = bedrad.view_factors(bed, rays=2**19, seed=77)
    for k, runs in enumerate(found.engines[2:]):
        expected = SHARES["equal area"] / 4**k * known.layers[0]
        assert abs(runs.bias[0] + expected) < 4 * runs.bias_error[0]
        assert runs.facets
    assert not any(runs.facets or runs.bias.any() for runs in found.engines[:2])
    # each trial at the coarsest subdivision, sorted, and the best one unsorted
    assert [(t.engine, t.scaling, t.sort) for t in found.trials] == [
        *(("open3d", scaling, True) for scaling in ("inscribed", "equal area", "equal volume")),
        ("open3d", "equal area", False),
    ]
    for trial in found.trials:
        assert abs(trial.bias + SHARES[trial.scaling] * known.layers[0]) < 4 * trial.bias_error
    # coarse ones never get there, and exact ones do
    assert found.engines[2].seconds_to(1e-3) == math.inf
    assert all(math.isfinite(runs.seconds_to(1e-6)) for runs in found.engines[:2])


def test_trials_runs_and_reference_share_no_seed(fake, monkeypatch):
    seeds = []

    plain = engine_runs.SobolStreams

    def watch(seed, count):
        if count > 1:
            seeds.append(seed)
        return plain(seed, count)

    monkeypatch.setattr(engine_runs, "SobolStreams", watch)
    compare_engines(ring_bed(), budget=1e-3, seeds=2, seed=10)
    # the reference; the grid walk; four trials; the coarsest mesh
    assert seeds == [12, 10, 11, *[13, 14] * 4, 10, 11]


def test_what_has_no_time_is_left_out_with_the_reason(fake):
    found = compare_engines(ring_bed(), budget=1e-3, seeds=2)
    assert [name for name, _ in found.left_out] == ["embree", "open3d, subdivision 3", "open3d, subdivision 4"]
    for _, reason in found.left_out[1:]:
        assert reason.startswith("set-up would take about ")
        assert reason.endswith(" s of the budget are left")
    assert [runs.name for runs in found.engines][-1] == "open3d, subdivision 2"
    # every engine has the runs that a slope needs all the same
    assert min(len(runs.rays) for runs in found.engines) == 3


def test_what_has_no_memory_is_left_out_with_the_reason(fake, monkeypatch):
    facets = 20 * 4**3 * len(ring_bed())
    monkeypatch.setattr(engine_comparison, "free_memory", lambda: 2.0 * facets * engine_comparison.BYTES_PER_FACET)
    plain = engine_comparison._too_costly
    monkeypatch.setattr(engine_comparison, "_too_costly", lambda setup, facets, _: plain(setup, facets, math.inf))
    found = compare_engines(ring_bed(), budget=1e-3, seeds=2)
    assert [name for name, _ in found.left_out] == ["embree", "open3d, subdivision 4"]
    assert f"{4 * facets:,} facets would take about" in found.left_out[1][1]


def test_a_mesh_that_runs_out_of_memory_is_left_out(fake, monkeypatch):
    def fail(self, packing, edges, window, engine, subdivision, scaling, sort):
        plain(self, packing, edges, window, engine, subdivision, scaling, sort)
        if len(self.made) > 4:
            raise MemoryError

    plain = FakeMesh.__init__
    monkeypatch.setattr(FakeMesh, "__init__", fail)
    found = compare_engines(ring_bed(), budget=1e-3, seeds=2)
    assert ("open3d, subdivision 2", "out of memory") in found.left_out
    assert [runs.name for runs in found.engines] == ["bedrad", "grid walk"]


def test_progress_goes_one_way_and_names_what_is_done(fake):
    told = []
    compare_engines(ring_bed(), budget=1.0, seeds=2, progress=lambda share, text: told.append((share, text)))
    shares = [share for share, _ in told]
    assert shares == sorted(shares)
    assert (told[0][1], told[-1]) == ("compiling", (1.0, "done"))
    texts = " ".join(text for _, text in told)
    for name in ("reference", "bedrad", "grid walk", "trying equal area", "open3d, subdivision 2"):
        assert name in texts


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"budget": 0.0}, r"budget is 0\.0 s; expected a positive"),
        ({"budget": math.nan}, "budget is nan s"),
        ({"seeds": 1}, "seeds is 1; expected at least 2"),
        ({"edges": [0.0, 1.0]}, "deepest point below the tube wall"),
    ],
)
def test_wrong_arguments_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        compare_engines(ring_bed(), **arguments)


def test_free_memory_is_less_than_there_is():
    assert 1e6 < free_memory() <= math.inf


def test_an_engine_that_is_not_installed_is_told_with_what_installs_it(monkeypatch):
    monkeypatch.setattr("bedrad.raytrace.mesh_engines.importlib.util.find_spec", lambda _: None)
    found, missing = mesh_libraries()
    assert found == []
    assert [name for name, _ in missing] == list(ENGINES)
    assert all('install it with: pip install "bedrad[' in reason for _, reason in missing)


@pytest.mark.skipif(not available_engines(), reason="no mesh engine is installed (extras mesh, open3d)")
def test_meshes_themselves():
    """Both engines trace the same facets: their biases are one; inscribed spheres are too small."""
    libraries, missing = mesh_libraries()
    if not libraries:
        pytest.skip(missing[0][1])
    found = compare_engines(ring_bed(rings=6), budget=1e-3, seeds=2)
    meshes = [runs for runs in found.engines if runs.facets]
    assert [runs.family for runs in meshes] == libraries
    for runs in meshes[1:]:
        np.testing.assert_allclose(runs.bias, meshes[0].bias, atol=4 * runs.bias_error.max())
    trials = {trial.scaling: trial for trial in found.trials if trial.engine == libraries[0] and trial.sort}
    assert trials["inscribed"].bias < -4 * trials["inscribed"].bias_error
    chosen = meshes[0].details.split(",")[0]
    assert abs(trials[chosen].bias) == min(abs(trial.bias) for trial in trials.values())
