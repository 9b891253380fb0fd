"""The mesh engines ray by ray against the exact spheres, and the rates at which the facets' errors fall."""

import functools
import subprocess
import sys

import numpy as np
import pytest
from scipy.stats import qmc

import bedrad
from bedrad.errors import EngineFailedError, MissingExtraError
from bedrad.raytrace import mesh_engines, meshes
from bedrad.raytrace.meshes import ENGINES, SCALINGS, MeshTracer, available_engines
from bedrad.raytrace.tracer import GridTracer
from bedrad.walls import Window
from oracles.beds import axial_chain, hexagonal_layer, random_bed

EDGES = np.array([0.0, 0.7, 2.0, 3.0])

BEDS = {
    "tube": (bedrad.Tube(5.0), 6.0),
    "rod": (bedrad.Rod(2.0), 6.0),
    "plate": (bedrad.Plate(), (7.0, 6.0)),
}


@functools.cache
def why_not(engine):
    """Why an engine cannot run here, or None: an extra or a library of the system is not there."""
    try:
        mesh_engines.engine_maker(engine)
    except (MissingExtraError, EngineFailedError) as error:
        return str(error)
    return None


@pytest.fixture(params=ENGINES)
def engine(request):
    if reason := why_not(request.param):
        pytest.skip(reason)
    return request.param


@pytest.fixture
def some_engine():
    for name in ENGINES:
        if not why_not(name):
            return name
    pytest.skip("; ".join(why_not(name) for name in ENGINES))


def sobol(count, seed=0):
    return np.ascontiguousarray(qmc.Sobol(4, rng=np.random.default_rng(seed)).random(count))


@functools.cache
def bed_of(kind, periodic):
    wall, period = BEDS[kind]
    bed = random_bed(wall, 60, seed=3, length=6.0, spread=3.5, period=period if periodic else None)
    return bed, bed.window(margin=0.0 if periodic else 1.0)


def met(fates):
    """Share of the rays that end in a layer."""
    return (fates < len(EDGES) - 1).mean()


@pytest.mark.parametrize("periodic", [True, False], ids=["periodic", "open"])
@pytest.mark.parametrize("kind", BEDS)
def test_rays_end_as_with_exact_spheres_but_for_the_facets(kind, periodic, engine):
    """The gap between facets and sphere is inversely proportional to the number of triangles, and so is the share of
    the rays that pass an outline or an edge that close: it falls four-fold a subdivision. Measured over two of them;
    some 70 rays differ at the finest, which leaves the logarithm of the ratio a scatter of 4 %."""
    bed, window = bed_of(kind, periodic)
    points = sobol(2**16)
    exact = GridTracer(bed, EDGES, window).fates(points)
    found = [MeshTracer(bed, EDGES, window, engine, subdivision).fates(points) for subdivision in (1, 2, 3)]
    assert len(set(exact)) >= 4
    assert set(np.concatenate(found)) == set(exact)
    shares = [(fates != exact).mean() for fates in found]
    assert 0.0 < shares[2] < 2e-3
    assert np.log(shares[0] / shares[2]) / 2.0 == pytest.approx(np.log(4.0), rel=0.2)


@pytest.mark.parametrize("kind", BEDS)
def test_inscribed_meshes_are_the_most_biased(kind, some_engine):
    """Inscribed meshes are too small: too few rays end in the layers. The bias falls four-fold a subdivision."""
    bed, window = bed_of(kind, True)
    points = sobol(2**16)
    exact = met(GridTracer(bed, EDGES, window).fates(points))
    bias = {
        (scaling, n): met(MeshTracer(bed, EDGES, window, some_engine, n, scaling).fates(points)) - exact
        for scaling in SCALINGS
        for n in (1, 2)
    }
    assert bias["inscribed", 2] < -5e-3
    assert bias["inscribed", 1] / bias["inscribed", 2] == pytest.approx(4.0, rel=0.15)
    for scaling in ("equal area", "equal volume"):
        assert 3.0 * abs(bias[scaling, 1]) < -bias["inscribed", 1]
        assert 3.0 * abs(bias[scaling, 2]) < -bias["inscribed", 2]


@pytest.mark.parametrize(
    ("scaling", "power", "exact"), [("equal area", 2, 4.0 * np.pi), ("equal volume", 3, 4.0 * np.pi / 3.0)]
)
def test_meshes_have_the_area_or_the_volume_that_they_are_named_after(scaling, power, exact):
    trimesh = pytest.importorskip("trimesh")
    ball = meshes.icosphere(2, scaling)
    whole = trimesh.Trimesh(ball.vertices * ball.factor, ball.triangles.astype(int))
    assert (whole.area if power == 2 else whole.volume) == pytest.approx(exact, rel=1e-12)


def test_sorting_changes_the_order_only(engine):
    bed, window = bed_of("tube", True)
    points = sobol(2**12)
    found = [MeshTracer(bed, EDGES, window, engine, 2, "inscribed", sort).fates(points) for sort in (False, True)]
    np.testing.assert_array_equal(*found)


def test_the_engines_agree_ray_by_ray():
    for name in ENGINES:
        if reason := why_not(name):
            pytest.skip(reason)
    bed, window = bed_of("plate", True)
    points = sobol(2**14)
    one, other = (MeshTracer(bed, EDGES, window, name).fates(points) for name in ENGINES)
    # both run in single precision: a ray within about 1e-6 of an outline may fall either way
    assert (one != other).sum() <= 2


@pytest.mark.parametrize("kind", ["tube", "plate"])
def test_rays_that_leave_the_images_go_on(kind, some_engine, monkeypatch):
    """With fewer images more rays start again on the other side of the box; they end where they would have ended."""
    bed, window = bed_of(kind, True)
    points = sobol(2**14)
    many = MeshTracer(bed, EDGES, window, some_engine)
    monkeypatch.setattr(meshes, "IMAGES", 0.05)
    few = MeshTracer(bed, EDGES, window, some_engine)
    assert few.triangles < 0.75 * many.triangles
    assert (many.fates(points) != few.fates(points)).sum() <= 2


def test_rays_deeper_than_the_first_mesh_are_followed(some_engine):
    """A thin chain on the axis of a wide tube, all of it deeper than the first mesh, which is empty.

    Grazing rays go on through many periods. By reciprocity the chain gets the ratio of the areas, times the share of
    a sphere's view that misses its neighbours; the limit is 4 standard errors of as many random rays.
    """
    bed = axial_chain(12.0)
    window, edges, points = bed.window(), np.array([0.0, 1.0]), sobol(2**16)
    tracer = MeshTracer(bed, edges, window, some_engine)
    assert tracer.triangles == 0
    found = tracer.fates(points)
    assert (found != GridTracer(bed, edges, window).fates(points)).mean() < 5e-4
    share = 4.0 * np.pi / (2.0 * np.pi * 12.0 * 2.0) * (1.0 - 2.0 * 0.07558681842161)
    assert (found == 1).mean() == pytest.approx(share, abs=4.0 * np.sqrt(share / len(points)))
    assert set(found) == {1, 2}


def test_empty_beds_end_at_the_wall_or_beyond(engine):
    points = sobol(2**10)
    nothing = np.zeros((0, 3))
    tube = bedrad.Packing(nothing, 1.0, bedrad.Tube(1.0), period=2.0)
    assert set(MeshTracer(tube, EDGES[:2], tube.window(), engine).fates(points)) == {2}
    plate = bedrad.Packing(nothing, 1.0, bedrad.Plate(), period=(2.0, 3.0))
    assert set(MeshTracer(plate, EDGES[:2], plate.window(), engine).fates(points)) == {1}


def test_no_rays_have_no_fates(some_engine):
    bed, window = bed_of("rod", True)
    assert MeshTracer(bed, EDGES, window, some_engine, 1).fates(np.empty((0, 4))).shape == (0,)


def test_rays_from_inside_a_sphere_end_at_once(engine):
    """Sphere A reaches through the plate and B into A: from inside A, a ray meets B first, in a deeper layer."""
    centers = [[3.0, 3.0, 0.8], [3.0, 3.0, 2.3]]
    bed = bedrad.Packing(centers, 1.0, bedrad.Plate(), period=(6.0, 6.0), max_overlap=0.6)
    window, edges, points = bed.window(), np.array([0.0, 0.5, 1.0, 2.0, 3.0]), sobol(2**14)
    inside = np.hypot(points[:, 0] * 6.0 - 3.0, points[:, 1] * 6.0 - 3.0) < 0.6
    assert inside.sum() > 500
    exact = GridTracer(bed, edges, window).fates(points)
    for scaling in SCALINGS:
        found = MeshTracer(bed, edges, window, engine, 3, scaling).fates(points)
        assert set(found[inside]) == {0}
        assert set(found[~inside]) == set(exact[~inside]) == {0, 1, 2, 3, 4}
        assert (found != exact).mean() < 5e-3


def test_hexagonal_layer_on_a_plate(some_engine):
    """The published view factors, within 3 standard errors of as many random rays; the facets' error is less."""
    bed = hexagonal_layer()
    found = MeshTracer(bed, np.array([0.0, 1.0, 2.0]), bed.window(), some_engine, 4).fates(sobol(2**17))
    shares = np.bincount(found, minlength=5) / 2**17
    assert np.abs(shares[:3] - [0.97052, 0.01229, 0.01719]).max() < 1.4e-3
    assert shares[3:].sum() == 0.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"engine": "povray"}, "engine is 'povray'; expected one of open3d, embree"),
        (
            {"scaling": "circumscribed"},
            "scaling is 'circumscribed'; expected one of inscribed, equal area, equal",
        ),
        ({"subdivision": 7}, "subdivision is 7; expected a whole number from 0 to 6"),
        ({"subdivision": 2.5}, "subdivision is 2.5"),
        ({"subdivision": -1}, "subdivision is -1"),
    ],
)
def test_wrong_arguments_are_named(options, message):
    bed, window = bed_of("rod", True)
    with pytest.raises(ValueError, match=message):
        MeshTracer(bed, EDGES, window, **options)


def test_window_outside_the_bed_is_refused(some_engine):
    bed, _ = bed_of("tube", False)
    with pytest.raises(ValueError, match="reaches beyond the bed"):
        MeshTracer(bed, EDGES, Window((-5.0, 3.0)), some_engine)


@pytest.mark.parametrize(("name", "extra"), [("open3d", "open3d"), ("embree", "mesh")])
def test_a_missing_extra_is_named(name, extra, monkeypatch):
    monkeypatch.setattr(mesh_engines.importlib.util, "find_spec", lambda _: None)
    bed, window = bed_of("rod", True)
    assert available_engines() == ()
    with pytest.raises(MissingExtraError, match=rf'install it with: pip install "bedrad\[{extra}\]"'):
        MeshTracer(bed, EDGES, window, name)


def test_a_missing_library_of_the_system_is_named(tmp_path, monkeypatch):
    loader = "libusb-1.0.so.0: cannot open shared object file: No such file or directory"
    (tmp_path / "open3d.py").write_text(f"raise ImportError({loader!r})\n")
    (tmp_path / "trimesh.py").touch()
    monkeypatch.syspath_prepend(tmp_path)
    for module in ("open3d", "trimesh"):
        monkeypatch.delitem(sys.modules, module, raising=False)
    bed, window = bed_of("rod", True)
    assert "open3d" in available_engines()
    with pytest.raises(
        EngineFailedError, match=r"system library libusb-1\.0\.so\.0 is missing.*apt-get install libusb-1"
    ):
        MeshTracer(bed, EDGES, window, "open3d")


def test_looking_for_engines_loads_none():
    code = "import sys; from bedrad.raytrace import meshes; meshes.available_engines(); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "bedrad.raytrace.meshes" in done.stdout.split()
    assert {"open3d", "trimesh", "embreex"} & set(done.stdout.split()) == set()
