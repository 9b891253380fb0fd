from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

import bedrad
from bedrad.packings.packing import Packing
from bedrad.report.pictures_vtp import Known, known_of, sphere_arrays, wall_surface, write_vtp_files
from jobs.small_job import ring_bed
from report.page_samples import run_small_job

WALLS = [bedrad.Tube(radius=3.0), bedrad.Rod(radius=1.5), bedrad.Plate()]


def bed_at(wall):
    centers = np.array([(2.0, 0.0, 1.0), (0.0, 2.9, 4.0), (-2.2, 0.0, 2.5)])
    centers = centers if wall.kind != "tube" else 0.5 * centers
    return Packing(centers, 0.5, wall)


def test_layers_contacts_and_view_factors_of_spheres_are_those_of_their_depths():
    wall = bedrad.Plate()
    depths = [0.5, 0.5 * 1.005, 0.8, 1.6, 2.6, 4.0]
    bed = Packing([(3.0 * k, 0.0, depth) for k, depth in enumerate(depths)], 0.5, wall)
    edges = np.array([0.0, 0.5, 1.5, 2.5])
    known = Known("bed", edges, 0.01, np.array([0.8, 0.15, 0.02]))
    arrays = sphere_arrays(bed, edges, known)
    # an edge belongs to the layer behind it
    assert arrays["layer"].tolist() == [2, 2, 2, 3, 0, 0]
    assert arrays["contact"].tolist() == [True, True, False, False, False, False]
    np.testing.assert_array_equal(arrays["view_factor"], [0.15, 0.15, 0.15, 0.02, np.nan, np.nan])
    # of other layers the view factors say nothing
    assert set(sphere_arrays(bed, edges[:-1], known)) == {"layer", "contact"}
    sunken = Packing([(0, 0, -0.01)], 0.1, wall, max_overlap=2.0)
    assert sphere_arrays(sunken, edges, known)["layer"].tolist() == [1]


@pytest.mark.parametrize("wall", WALLS, ids=lambda wall: wall.kind)
def test_the_wall_is_where_its_depth_is_zero_and_faces_the_bed(wall):
    bed = bed_at(wall)
    points, faces = wall_surface(bed)
    np.testing.assert_allclose(wall.depth(points), 0.0, atol=1e-12)
    corners = points[faces]
    middle = corners.mean(axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    assert ((normals / areas[:, None]) * wall.normal(middle)).sum(axis=1) == pytest.approx(1.0)
    low, high = bed.extent(wall.axial)
    assert (points[:, wall.axial].min(), points[:, wall.axial].max()) == (low, high)
    if wall.kind != "plate":
        assert areas.sum() == pytest.approx(2 * np.pi * wall.radius * (high - low), rel=2e-3)


def numbers(element):
    return np.array(element.text.split(), dtype=float)


def test_the_files_are_read_back(tmp_path):
    bed = ring_bed()
    edges = bedrad.layer_edges(bed, 3)
    files = write_vtp_files(bed, edges, Known("bed"), tmp_path / "a.b")
    assert sorted(file.name for file in files) == sorted(file.name for file in tmp_path.iterdir())
    assert [file.name for file in files] == ["a.b_spheres.vtp", "a.b_wall.vtp"]
    back = bedrad.read(files[0])
    np.testing.assert_array_equal(back.centers, bed.centers)
    assert back.wall == bed.wall
    piece = ET.parse(files[1]).getroot().find("PolyData/Piece")
    points, faces = wall_surface(bed)
    np.testing.assert_array_equal(numbers(piece.find("Points/DataArray")).reshape(-1, 3), points)
    connectivity, offsets = piece.findall("Polys/DataArray")
    np.testing.assert_array_equal(numbers(connectivity), faces.ravel())
    np.testing.assert_array_equal(numbers(offsets), 4 * np.arange(1, len(faces) + 1))
    assert int(piece.get("NumberOfPolys")) == len(faces)


def test_a_results_file_says_more_than_a_packing(tmp_path):
    results = run_small_job(tmp_path)
    known = known_of(results.path)
    assert known.name == "rings"
    np.testing.assert_array_equal(known.edges, results.read("view_factors")["edges"])
    np.testing.assert_array_equal(known.view_factors, results.read("view_factors")["layers"])
    alone = known_of(tmp_path / "bed.h5")
    assert (alone.name, alone.edges, alone.view_factors) == ("bed.h5", None, None)
