"""Walls from triangles: tubes, rods and plates wherever they lie, and shapes that are none of them."""

from __future__ import annotations

import builtins
from pathlib import Path

import numpy as np
import pytest

from bedrad import BadFileError, MissingExtraError, Plate, Rod, Tube, read
from bedrad.packings.wall_stl import read_wall_stl

trimesh = pytest.importorskip("trimesh", reason="needs the extra mesh")

BASIS = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
BASIS *= np.linalg.det(BASIS)
POINT = np.array([0.02, -0.03, 0.05])

# what 32 bits of a corner at up to 0.1 m lose
ROUNDING = 1e-8


def mantle(radius: float, height: float, facets: int = 48) -> tuple[np.ndarray, np.ndarray]:
    """Corners and triangles of an open cylinder around z; an own construction."""
    turn = 2 * np.pi * np.arange(facets) / facets
    ring = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)
    corners = np.concatenate([np.column_stack([ring, np.full(facets, z)]) for z in (0.0, height)])
    i = np.arange(facets)
    j = (i + 1) % facets
    return corners, np.concatenate([np.stack([i, j, i + facets], 1), np.stack([j, j + facets, i + facets], 1)])


def closed(radius: float, height: float, facets: int = 48) -> tuple[np.ndarray, np.ndarray]:
    """The same with both ends, fans of triangles around corners on the axis."""
    corners, triangles = mantle(radius, height, facets)
    i = np.arange(facets)
    j = (i + 1) % facets
    ends = [np.stack([i + k * facets, j + k * facets, np.full(facets, 2 * facets + k)], 1) for k in (0, 1)]
    return np.concatenate([corners, [[0, 0, 0], [0, 0, height]]]), np.concatenate([triangles, *ends])


def write_stl(path: Path, corners: np.ndarray, triangles: np.ndarray) -> Path:
    """Binary STL by its definition: 80 bytes, a count, 50 bytes a triangle."""
    record = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    record["corners"] = corners[triangles]
    path.write_bytes(bytes(80) + np.uint32(len(triangles)).tobytes() + record.tobytes())
    return path


def turned(shape: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    return shape[0] @ BASIS.T + POINT, shape[1]


@pytest.mark.parametrize("facets", [12, 13, 48])
# at a height of two radii the ends hide the axis: all principal directions are alike
@pytest.mark.parametrize("height", [0.02, 0.01, 0.003, 0.2])
@pytest.mark.parametrize("shape", [mantle, closed])
def test_a_cylinder_goes_through_its_corners(tmp_path: Path, shape: object, height: float, facets: int) -> None:
    surface = read_wall_stl(write_stl(tmp_path / "a.stl", *turned(shape(0.005, height, facets))))  # type: ignore[operator]
    assert surface.radius == pytest.approx(0.005, abs=ROUNDING)
    assert abs(float(np.dot(surface.direction, BASIS[:, 2]))) == pytest.approx(1.0, abs=1e-9)
    apart = np.cross(np.array(surface.origin) - POINT, BASIS[:, 2])
    assert np.linalg.norm(apart) < 1e-7
    assert float(np.dot(surface.origin, surface.direction)) == pytest.approx(0.0, abs=1e-12)
    assert surface.residual < ROUNDING
    # the distance from the middle of a chord to the circle
    assert surface.sagitta == pytest.approx(0.005 * (1 - np.cos(np.pi / facets)), rel=1e-4)
    assert surface.triangles == 2 * facets


def test_an_upright_cylinder_is_upright_to_the_last_bit(tmp_path: Path) -> None:
    surface = read_wall_stl(write_stl(tmp_path / "a.stl", *mantle(0.003875, 0.03)))
    assert surface.direction == (0.0, 0.0, 1.0)
    assert read_wall_stl(tmp_path / "a.stl", 1e-3).radius == pytest.approx(3.875e-6, abs=1e-3 * ROUNDING)


def test_ascii_files_are_read(tmp_path: Path) -> None:
    corners, triangles = mantle(1.0, 3.0)
    text = "solid wall\n"
    for triangle in corners[triangles].tolist():
        text += "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in triangle)
        text += "endloop\nendfacet\n"
    (tmp_path / "a.stl").write_text(text + "endsolid wall\n")
    assert read_wall_stl(tmp_path / "a.stl").radius == pytest.approx(1.0, abs=1e-6)


def spheres(path: Path, centers: np.ndarray, unit: str = "m") -> Path:
    rows = [f"{x!r},{y!r},{z!r},{r!r}" for (x, y, z), r in zip(centers.tolist(), [0.0005] * len(centers), strict=True)]
    path.write_text("\n".join([f"x [{unit}],y [{unit}],z [{unit}],radius [{unit}]", *rows]) + "\n")
    return path


RING = np.stack([np.cos(np.arange(8) * np.pi / 4), np.sin(np.arange(8) * np.pi / 4), 0.5 * np.arange(8)], axis=1)


@pytest.mark.parametrize(("reach", "wall"), [(0.0045, Tube), (0.0055, Rod)])
def test_the_spheres_decide_between_tube_and_rod(tmp_path: Path, reach: float, wall: type) -> None:
    centers = RING * [reach, reach, 0.002]
    stl = write_stl(tmp_path / "wall.STL", *turned(mantle(0.005, 0.02)))
    packing = read(spheres(tmp_path / "a.csv", centers @ BASIS.T + POINT), stl)
    assert isinstance(packing.wall, wall)
    assert packing.wall.radius == pytest.approx(0.005, abs=ROUNDING)  # type: ignore[union-attr]
    np.testing.assert_allclose(packing.depths, 0.0005, atol=1e-7)
    # along the axis nothing but its sense is left open
    np.testing.assert_allclose(np.abs(np.diff(packing.centers[:, 2])), 0.001, atol=1e-9)
    notes = packing.provenance
    assert notes["wall_origin"] == f"{wall.__name__.lower()} fitted to the 96 triangles of wall.STL"
    assert notes["wall_fit_residual_m"] < ROUNDING  # type: ignore[operator]
    assert notes["wall_facet_sagitta_m"] == pytest.approx(0.005 * (1 - np.cos(np.pi / 48)), rel=1e-4)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_plate_lies_below_the_spheres_whichever_side_they_are_on(tmp_path: Path, side: float) -> None:
    corners = np.array([[0, 0, 0], [0.01, 0, 0], [0.01, 0.02, 0], [0, 0.02, 0]])
    stl = write_stl(tmp_path / "floor.stl", *turned((corners, np.array([[0, 1, 2], [0, 2, 3]]))))
    centers = np.array([[0.001, 0.001, side * 0.0005], [0.003, 0.001, side * 0.0006]])
    packing = read(spheres(tmp_path / "a.csv", centers @ BASIS.T + POINT), stl)
    assert packing.wall == Plate()
    np.testing.assert_allclose(packing.depths, [0.0005, 0.0006], atol=ROUNDING)


def test_one_triangle_is_a_plate(tmp_path: Path) -> None:
    surface = read_wall_stl(write_stl(tmp_path / "a.stl", np.eye(3), np.array([[0, 1, 2]])))
    np.testing.assert_allclose(surface.origin, [1 / 3] * 3, atol=1e-7)
    np.testing.assert_allclose(surface.direction, [3**-0.5] * 3, atol=1e-7)


def test_units_of_the_wall(tmp_path: Path) -> None:
    stl = write_stl(tmp_path / "wall.stl", *mantle(5.0, 20.0))
    inside = RING * [0.0045, 0.0045, 0.002]
    path = spheres(tmp_path / "a.csv", inside)
    assert read(path, stl, wall_unit="mm").wall.radius == pytest.approx(0.005, abs=ROUNDING)  # type: ignore[union-attr]
    path.write_text(path.read_text().replace(" [m]", ""))
    # the unit of the spheres is that of their wall
    assert read(path, stl, unit="mm", max_overlap=1.0).wall.radius == pytest.approx(0.005, abs=ROUNDING)  # type: ignore[union-attr]
    assert read(path, str(stl), unit="m", wall_unit="mm").wall.radius == pytest.approx(0.005, abs=ROUNDING)  # type: ignore[union-attr]
    with pytest.raises(ValueError, match=r"wall\.stl says where the wall is; axis and origin are for other walls"):
        read(path, stl, unit="m", wall_unit="mm", axis="x")


def box() -> tuple[np.ndarray, np.ndarray]:
    mesh = trimesh.creation.box()
    return mesh.vertices, mesh.faces


def pipe() -> tuple[np.ndarray, np.ndarray]:
    (inner, triangles), (outer, more) = mantle(1.0, 3.0), mantle(1.2, 3.0)
    return np.concatenate([inner, outer]), np.concatenate([triangles, more + len(inner)])


def cone() -> tuple[np.ndarray, np.ndarray]:
    corners, triangles = mantle(1.0, 3.0)
    return corners * (1.0 - 0.01 * corners[:, 2:]), triangles


def half() -> tuple[np.ndarray, np.ndarray]:
    corners, triangles = mantle(1.0, 3.0)
    return corners, triangles[(corners[triangles][:, :, 0] > -1e-9).all(axis=1)]


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        (lambda: mantle(1.0, 3.0, 8), "45 degrees between neighbouring corners around the axis; .* at least 12 facets"),
        (half, "180 degrees between neighbouring corners"),
        (pipe, r"the corners miss a common cylinder by 0\.\d+ m .* Expected one surface"),
        (cone, r"the corners miss a common cylinder by 0\.0\d+ m .* at most 0\.001 of the radius"),
        (box, "12 triangles that are neither a plane nor a cylinder of 12 facets"),
        (lambda: (np.zeros((3, 3)), np.array([[0, 1, 2]])), "1 triangles without an area; expected"),
    ],
)
def test_shapes_that_are_no_wall(tmp_path: Path, shape: object, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"a\.stl: {message}"):
        read_wall_stl(write_stl(tmp_path / "a.stl", *shape()))  # type: ignore[operator]


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"solid wall\nendsolid wall\n",
        b"solid wall\nfacet normal 0 0 0\nouter loop\nvertex a b c\n",
        bytes(84),
        bytes(80) + b"\xff\xff\xff\xff",
        b"solid wall\nfacet normal a b c\nouter loop\nvertex 0 0 0\n",
        bytes(80) + b"\2\0\0\0" + bytes(50),
        bytes(80) + b"\1\0\0\0" + np.full(12, np.nan, "<f4").tobytes() + bytes(2),
        b"PK\3\4" + bytes(100),
        b"x [m],y [m]\n1,2\n",
    ],
)
def test_files_that_are_no_stl(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.stl").write_bytes(content)
    with pytest.raises(BadFileError, match=r"a\.stl: (not an STL file|no triangles with finite corners)"):
        read_wall_stl(tmp_path / "a.stl")


def test_normals_that_are_broken_are_not_needed_and_not_talked_about(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    text = "solid a\nfacet normal up 0 x\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    (tmp_path / "a.stl").write_text(text + "endsolid a\n")
    assert read_wall_stl(tmp_path / "a.stl").direction == (0.0, 0.0, 1.0)
    assert caplog.records == []


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match=r"a\.stl: cannot be read: No such file or directory"):
        read_wall_stl(tmp_path / "a.stl")


def test_without_trimesh_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = builtins.__import__

    def without(name: str, *rest: object) -> object:
        if name == "trimesh":
            raise ImportError
        return plain(name, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingExtraError, match=r'trimesh is not installed; .* pip install "bedrad\[mesh\]"'):
        read_wall_stl(tmp_path / "a.stl")
