from __future__ import annotations

import base64
import io
import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import bedrad
from bedrad.report import pictures
from bedrad.report.pictures import View, make_scene, round_length, save_picture, still
from bedrad.report.pictures_kernels import draw_spheres, draw_wall
from bedrad.report.pictures_viewer import reduced, viewer, write_viewer
from jobs.small_job import ring_bed

WALLS = [bedrad.Tube(radius=6.0), bedrad.Rod(radius=1.5), bedrad.Plate()]
PIXEL, WIDTH, HEIGHT = 0.11, 140, 120


def some_bed(wall):
    """Spheres of several sizes that touch or cut the sides of the wedge."""
    rng = np.random.default_rng(4)
    centers = np.array([(x, y, z) for x in (-3.2, 0.1, 3.0) for y in (-3.0, 0.2, 3.1) for z in (0.9, 3.1)])
    centers = centers[np.hypot(centers[:, 0], centers[:, 1]) > 2.5] if wall.kind == "rod" else centers
    return bedrad.Packing(centers, rng.uniform(0.5, 0.9, len(centers)), wall)


def drawn(scene, view, *, wall):
    """What the kernels draw: distance, normals, points, cut faces, wall."""
    shape = (HEIGHT, WIDTH)
    distance, cut, shown = np.full(shape, np.inf), np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    normals, points = np.zeros((*shape, 3)), np.zeros((*shape, 3))
    if wall:
        draw_wall(scene.solid, view.axes, view.planes, PIXEL, distance, normals, cut, shown)
    else:
        draw_spheres(
            scene.centers - scene.middle, scene.radii, view.axes, view.planes, PIXEL, distance, normals, points, cut
        )
    return distance, normals, points, cut, shown


def inside(scene, view, points, *, wall):
    """Whether points are in what is shown, from the definitions alone."""
    real = points + scene.middle
    kind, opened = scene.wall.kind, (points @ view.planes.T > 0).all(axis=-1)
    if not wall:
        away = np.linalg.norm(real[..., None, :] - scene.centers, axis=-1)
        return (away < scene.radii).any(axis=-1) & ~opened
    low, high = scene.low, scene.high
    if kind == "plate":
        thick = pictures.THICKNESS * max(high[0] - low[0], high[1] - low[1])
        within = (real[..., :2] > low[:2]).all(axis=-1) & (real[..., :2] < high[:2]).all(axis=-1)
        return within & (real[..., 2] < 0) & (real[..., 2] > -thick)
    away = np.hypot(real[..., 0], real[..., 1])
    upright = (real[..., 2] > low[2]) & (real[..., 2] < high[2])
    if kind == "rod":
        return upright & (away < scene.wall.radius)
    radius = scene.wall.radius
    return upright & (away > radius) & (away < radius * (1 + pictures.THICKNESS)) & ~opened


VIEWS = [View(), View(azimuth=10.0, elevation=-20.0, opening=180.0), View(azimuth=-150.0, elevation=65.0, opening=40.0)]


@pytest.mark.parametrize("view", VIEWS, ids=["front", "below", "above"])
@pytest.mark.parametrize("wall", WALLS, ids=lambda wall: wall.kind)
@pytest.mark.parametrize("what", ["spheres", "wall"])
def test_a_ray_sees_the_first_point_that_is_there(wall, view, what):
    scene, on_wall = make_scene(some_bed(wall)), what == "wall"
    distance, normals, points, cut, _ = drawn(scene, view, wall=on_wall)
    # rays of every eleventh pixel, walked in small steps
    rows, columns = (grid.ravel() for grid in np.meshgrid(range(5, HEIGHT, 11), range(5, WIDTH, 11), indexing="ij"))
    starts = ((columns + 0.5 - WIDTH / 2) * PIXEL)[:, None] * view.axes[0]
    starts = starts + ((HEIGHT / 2 - rows - 0.5) * PIXEL)[:, None] * view.axes[1]
    step = 0.02
    t = np.arange(-9.0, 9.0, step)
    there = inside(scene, view, starts[:, None, :] + t[:, None] * view.axes[2], wall=on_wall)
    first = np.where(there.any(axis=1), t[there.argmax(axis=1)], np.inf)
    found = distance[rows, columns]
    hit = np.isfinite(found) & np.isfinite(first)
    # what is thinner than a step may be missed
    assert np.mean(np.isfinite(found) != np.isfinite(first)) < 0.01
    late = first[hit] - found[hit]
    assert np.mean((late >= -1e-9) & (late <= step + 1e-9)) > 0.985
    assert hit.sum() > 5
    # normals are unit vectors towards the eye
    assert np.allclose(np.linalg.norm(normals[rows, columns][hit], axis=1), 1.0)
    assert (normals[rows, columns][hit] @ view.axes[2] <= 1e-9).all()
    if not on_wall:
        assert np.allclose(points[rows, columns][hit], (starts + found[:, None] * view.axes[2])[hit])
        on_faces = np.abs(points[cut] @ view.planes.T).min(axis=1)
        assert np.allclose(on_faces, 0.0, atol=1e-9)


@pytest.mark.parametrize("finer", [1, 2, 4])
def test_a_sphere_covers_its_disc(finer):
    scene = make_scene(bedrad.Packing([(0, 0, 2.0)], 1.0, bedrad.Plate()))
    picture, pixel = still(scene, View(opening=0.0, wall=False), (120 * finer, 90 * finer))
    area = picture[..., 3].sum() / 255 * pixel**2
    assert area == pytest.approx(math.pi, rel=0.02 / finer)


def test_colours_are_the_layers_of_the_points_seen():
    wall = bedrad.Tube(radius=5.0)
    scene = make_scene(bedrad.Packing([(3.0, 0.0, 0.0)], 1.5, wall), edges=[0.0, 1.0, 2.0])
    # from above: depth is 5 - x on the way to the eye, and x runs to the right
    picture, pixel = still(scene, View(azimuth=-90.0, elevation=90.0, opening=0.0, wall=False), (201, 201))
    assert pixel > 0
    row = picture[100]
    x = (np.arange(201) - 100) * pixel
    palette = {tuple(int(c[k : k + 2], 16) for k in (1, 3, 5)) for c in pictures.style.COLOURS[:2]} | {
        tuple(int(pictures.BEYOND[k : k + 2], 16) for k in (1, 3, 5))
    }
    hues = {tuple(np.round(np.array(c) / max(c), 1)): c for c in palette}
    wanted = [(4.2, pictures.style.COLOURS[0]), (3.5, pictures.style.COLOURS[1]), (2.0, pictures.BEYOND)]
    for place, colour in wanted:
        seen = row[np.abs(x - place).argmin()]
        assert seen[3] == 255
        near = min(hues, key=lambda hue: np.abs(np.array(hue) - seen[:3] / seen[:3].max()).sum())
        assert hues[near] == tuple(int(colour[k : k + 2], 16) for k in (1, 3, 5))


@pytest.mark.parametrize("wall", WALLS, ids=lambda wall: wall.kind)
@pytest.mark.parametrize("elevation", [-90.0, 28.0, 90.0])
def test_everything_is_in_the_picture(wall, elevation):
    picture, _ = still(make_scene(some_bed(wall)), View(elevation=elevation), (80, 60))
    rim = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
    assert (rim[:, 3] == 0).all()
    assert (picture[..., 3] > 0).any()


def test_beds_that_are_too_narrow_for_three_layers_have_fewer():
    narrow = bedrad.Packing([(0, 0, 0), (0, 0, 2)], 0.9, bedrad.Tube(radius=1.0))
    assert len(make_scene(narrow).edges) == 2
    thin = bedrad.Packing([(0, 0, 0)], 0.9, bedrad.Tube(radius=0.9))
    assert make_scene(thin).edges[-1] == pytest.approx(0.9)
    with pytest.raises(ValueError, match="empty; there is nothing to show"):
        make_scene(bedrad.Packing([], 1.0, bedrad.Plate()))


@pytest.mark.parametrize(("longest", "length"), [(1.0, 1.0), (1.9, 1.0), (2.0, 2.0), (4.99e-3, 2e-3), (0.77, 0.5)])
def test_a_length_is_round(longest, length):
    assert round_length(longest) == pytest.approx(length)


def test_a_picture_is_written_whole(tmp_path):
    save_picture(make_scene(ring_bed(), name="$x$ <b>"), tmp_path / "bed.png")
    assert [file.name for file in tmp_path.iterdir()] == ["bed.png"]
    with Image.open(tmp_path / "bed.png") as image:
        assert image.size[0] == 1200
        assert len(image.convert("RGB").getcolors(2**24)) > 100


# The moving picture


def data_of(text):
    return json.loads(re.search(r'<script type="application/json" id="bed-data">(.*?)</script>', text)[1])


def test_the_page_holds_the_spheres_to_16_bits():
    scene = make_scene(ring_bed())
    data = data_of(viewer(scene))
    packed = np.frombuffer(base64.b64decode(data["spheres"]), dtype="<u2").reshape(-1, 4) / 65535
    centers = np.array(data["low"]) + packed[:, :3] * data["extent"]
    step = np.array(data["extent"]) / 65535
    assert (np.abs(centers - 1e3 * (scene.centers - scene.middle)) <= 0.51 * step).all()
    assert np.abs(packed[:, 3] * data["largest"] - 1e3 * scene.radii).max() <= data["largest"] / 65535
    assert data["edges"] == pytest.approx([0.0, 0.3, 0.9, 1.5])


def test_a_still_picture_stands_where_the_spheres_do_not_fit():
    scene = make_scene(ring_bed())
    near = int((scene.wall.depth(scene.centers) - scene.radii < scene.edges[-1]).sum())
    assert 0 < near < len(scene.radii)
    enough = 8 * len(scene.radii) * 4 // 3 + 4
    assert reduced(scene, enough) is scene
    assert len(reduced(scene, enough - 100).radii) == near
    assert reduced(scene, 8 * near) is None
    text = viewer(scene, 0)
    assert "<canvas" not in text
    assert "Too many spheres" in text
    image = re.search(r'src="data:image/png;base64,([^"]*)"', text)[1]
    with Image.open(io.BytesIO(base64.b64decode(image))) as picture:
        assert picture.size == (800, 600)


def test_names_of_beds_are_text(tmp_path):
    scene = replace(make_scene(ring_bed()), name="</title></script><script>alert(1)</script>")
    write_viewer(scene, tmp_path / "bed.html")
    text = (tmp_path / "bed.html").read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert text.count("</title>") == 1
