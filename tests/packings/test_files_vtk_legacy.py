"""VTK's legacy files of LIGGGHTS and of VTK itself, whole and broken."""

from __future__ import annotations

import gzip
import shutil
import struct
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from bedrad import BadFileError, Tube, read
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.lammps_dump import read_dump
from bedrad.packings.files.vtk_legacy import looks_like_vtk_legacy, read_vtk_legacy
from packings.file_mutations import mutated

DATA = Path(__file__).parents[1] / "data" / "vtk"

SMALL = """\
# vtk DataFile Version 3.0
two spheres
ASCII

DATASET POLYDATA
POINTS 2 double
0 0 2 0 0
-1
VERTICES 2 4
1 0
1 1
POINT_DATA 2
SCALARS type int 1
LOOKUP_TABLE default
1 1
VECTORS v float
0 0 1 0 0 1
FIELD FieldData 2
id 1 2 int
9 4
METADATA
INFORMATION 0

radius 1 2 double
0.5 0.25
"""


def put(tmp_path: Path, content: str | bytes) -> Path:
    path = tmp_path / "bed.vtk"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def binary(*, points: int = 2, kind: str = "double", version: str = "3.0", cells: bytes = b"") -> bytes:
    """The two spheres of SMALL, in binary."""
    form = {"double": "d", "float": "f"}[kind]
    head = f"# vtk DataFile Version {version}\ntwo spheres\nBINARY\nDATASET POLYDATA\nPOINTS {points} {kind}\n"
    about = b"POINT_DATA 2\nSCALARS radius double\nLOOKUP_TABLE default\n" + struct.pack(">2d", 0.5, 0.25)
    about += b"\nFIELD FieldData 1\nid 1 2 int\n" + struct.pack(">2i", 9, 4) + b"\n"
    return head.encode() + struct.pack(f">6{form}", 0, 0, 2, 0, 0, -1) + b"\n" + cells + about


def check_small(held: Contents) -> None:
    assert held.centers.tolist() == [[0, 0, -1], [0, 0, 2]]
    assert held.radii is not None
    assert held.radii.tolist() == [0.25, 0.5]
    assert held.ids.tolist() == [4, 9]


@pytest.fixture(scope="module")
def plain() -> Contents:
    """The spheres in all digits, from the text dump that the same run of LIGGGHTS wrote."""
    return read_dump(DATA / "plain2000.dump")


@pytest.mark.parametrize(
    ("name", "digits"),
    [
        ("binary2000.vtk", None),
        ("text2000.vtk", 6),
        ("vtk_4.2_binary.vtk", 17),
        ("vtk_5.1_binary.vtk", 17),
        ("vtk_4.2_text.vtk", 6),
        ("vtk_5.1_text.vtk", 6),
    ],
)
def test_files_of_programs(name: str, digits: int | None, plain: Contents) -> None:
    held = read_vtk_legacy(DATA / name)
    # LIGGGHTS keeps the points of its VTK files in single precision
    single = name.startswith(("binary", "text"))
    expected = plain.centers.astype(np.float32) if single else plain.centers
    if digits == 6:
        expected = np.array([[float(f"{x:.6g}") for x in row] for row in plain.centers])
        expected = expected.astype(np.float32) if single else expected
    assert held.centers.tolist() == expected.tolist()
    assert held.radii is not None
    assert plain.radii is not None
    assert held.radii.tolist() == plain.radii.tolist()
    assert held.ids.tolist() == list(range(1, 13))
    assert held.provenance == {"file": name, "format": "VTK legacy"} | (
        {"coordinates": "single precision"} if single else {}
    )
    assert not held.states_unit


@pytest.mark.parametrize("name", ["textboundingBox_2000.vtk", "polyboundingBox_2000.vtr"])
def test_the_bounding_box_of_liggghts_is_no_frame(name: str) -> None:
    with pytest.raises(BadFileError, match=rf"{name}, line \d: a rectilinear grid, as the bounding box is"):
        read(DATA / name, Tube(0.004))


def test_content_comes_before_suffix(tmp_path: Path) -> None:
    shutil.copy(DATA / "binary2000.vtk", tmp_path / "bed.csv")
    packing = read(tmp_path / "bed.csv", Tube(0.004))
    assert len(packing) == 12
    assert packing.provenance["format"] == "VTK legacy"
    (tmp_path / "bed.vtk.gz").write_bytes(gzip.compress((DATA / "binary2000.vtk").read_bytes()))
    assert read(tmp_path / "bed.vtk.gz", Tube(0.004)).centers.tolist() == packing.centers.tolist()
    with pytest.raises(BadFileError, match="frame 1 was asked for; a VTK legacy file holds one packing"):
        read(tmp_path / "bed.csv", Tube(0.004), frame=1)
    assert not looks_like_vtk_legacy(b"# vtk")


OLD_CELLS = b"VERTICES 1 3\n" + struct.pack(">3i", 2, 0, 1) + b"\n"
NEW_CELLS = (
    b"VERTICES 2 2\nOFFSETS vtktypeint64\n"
    + struct.pack(">2q", 0, 2)
    + b"\nCONNECTIVITY vtktypeint64\n"
    + struct.pack(">2q", 0, 1)
    + b"\nLINES 0 0\n"
)


@pytest.mark.parametrize("cells", [b"", OLD_CELLS, NEW_CELLS])
@pytest.mark.parametrize("kind", ["float", "double"])
def test_binary_files_in_every_form(tmp_path: Path, cells: bytes, kind: str) -> None:
    check_small(read_vtk_legacy(put(tmp_path, binary(kind=kind, cells=cells))))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("\n", "\r\n"),
        ("0 0 2 0 0\n-1", "0\n0\n2\n0\n0\n-1"),
        ("VERTICES 2 4\n1 0\n1 1", "VERTICES 3 2\nOFFSETS vtktypeint64\n0 1 2\nCONNECTIVITY vtktypeint64\n0 1"),
        ("VERTICES 2 4\n1 0\n1 1\n", ""),
        ("LOOKUP_TABLE default\n", ""),
        ("radius 1 2 double\n0.5 0.25", "Diameter 1 2 float\n1 0.5"),
        ("radius 1 2 double\n0.5 0.25", "RADII 1 2 double\n0.5 0.25\n"),
        ("FIELD FieldData 2\n", "FIELD FieldData 3\ndiameter 1 2 double\n77 78\n"),
        ("FIELD FieldData 2\n", "FIELD FieldData 3\nNULL_ARRAY\n"),
        ("POINT_DATA 2\n", "LOOKUP_TABLE map 1\n0 0 0 1\nCELL_DATA 2\nSCALARS radius float\n5 6\nPOINT_DATA 2\n"),
        ("SCALARS type int 1", "COLOR_SCALARS c 1\n.5 .5\nTEXTURE_COORDINATES t 2 float\n0 0 0 0\nSCALARS type int 1"),
        ("FIELD FieldData 2\n", "FIELD FieldData 3\ntext 1 1 string\n" + 3000 * "x" + "\n"),
        ("POINTS 2 double", "points 2 DOUBLE"),
    ],
)
def test_the_same_spheres_in_other_words(tmp_path: Path, old: str, new: str) -> None:
    assert old in SMALL
    check_small(read_vtk_legacy(put(tmp_path, SMALL.replace(old, new))))


def test_without_sizes_and_ids(tmp_path: Path) -> None:
    path = put(tmp_path, SMALL.replace("radius 1 2", "mass 1 2").replace("id 1 2", "nr 1 2"))
    with pytest.raises(BadFileError, match=r"bed\.vtk.* no .*radius or diameter"):
        read(path, Tube(1.0))
    packing = read(path, Tube(1.0), diameter=0.5)
    assert packing.radii.tolist() == [0.25, 0.25]
    # in the order of the file
    assert packing.centers[:, 2].tolist() == [2, -1]


def test_a_refused_sphere_is_named_by_its_id(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match=r"sphere 1: .* through the tube wall.* \(id 9\)"):
        read(put(tmp_path, SMALL), Tube(0.3))


def test_no_points_at_all(tmp_path: Path) -> None:
    head = SMALL[: SMALL.index("POINTS")]
    assert len(read(put(tmp_path, head + "POINTS 0 float\nPOINT_DATA 0\nSCALARS radius double\n"), Tube(1.0))) == 0


def broken(old: str, new: str) -> str:
    assert SMALL.count(old) == 1
    return SMALL.replace(old, new)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (broken("ASCII", "TEXT"), "line 3: 'TEXT'; expected ASCII or BINARY"),
        (broken("DATASET POLYDATA", "POINTS 3"), "line 5: 'POINTS 3'; expected DATASET and its kind"),
        (broken("POLYDATA", "STRUCTURED_POINTS"), "line 5: the data set is 'STRUCTURED_POINTS'; expected POLYDATA or"),
        (broken("POINTS 2 double", "POINTS two double"), "line 6: 'POINTS two double': 'two'; expected a count"),
        (broken("POINTS 2 double", "POINTS -2 double"), "line 6: .* '-2'; expected a count"),
        (broken("POINTS 2 double", "POINTS 2"), "line 6: 'POINTS 2': 2 words; expected 3 or more"),
        (broken("POINTS 2 double", "POINTS 2 quad"), "line 6: POINTS is of the type 'quad'; expected one of"),
        (broken("POINTS 2 double", "POINTS 3 double"), "line 9: POINTS has 'VERTICES'; expected a number"),
        (broken("POINT_DATA 2", "POINT_DATA 3"), "line 12: POINT_DATA of 3 points; the file has 2"),
        (broken("0 0 2 0 0\n-1", "0 0 2 0 0\n-1 0"), "line 8: '0' is no keyword of VTK's legacy files"),
        (broken("-1", "-1.0.0"), r"line 8: POINTS has '-1\.0\.0'; expected a number"),
        (broken("0 0 2 0 0", "0 0 nan 0 0"), r"point 0 is \(0\.0, 0\.0, nan\); expected finite numbers"),
        (broken("0.5 0.25", "0.5 big"), "line 25: radius has 'big'; expected a number"),
        (broken("0.5 0.25\n", "0.5"), "cut off after line 24: radius has 1 numbers; expected 2"),
        (
            broken("radius 1 2 double", "radius 3 2 double"),
            "line 24: array 'radius' has 2 rows of 3; expected one number",
        ),
        (
            broken("radius 1 2 double", "radius 1 1 double"),
            "line 24: array 'radius' has 1 rows of 1; expected one number",
        ),
        (broken("radius 1 2 double", "radius 1 2"), "line 24: 'radius 1 2': 3 words; expected 4 or more"),
        (broken("9 4\n", "9 9\n"), "points 0 and 1: both have the id 9"),
        (broken("9 4\n", "9 4.5\n"), r"id: 4\.5; expected integers of 32 bits"),
        (broken("9 4\n", "9 5000000000\n"), r"id: 5000000000\.0; expected integers of 32 bits"),
        (broken("VERTICES 2 4", "VERTICES 2"), "line 9: 'VERTICES 2': 2 words; expected 3 or more"),
        (
            broken("VECTORS v float", "VECTORS radius float"),
            "line 16: array 'radius' has 3 numbers a point",
        ),
        (SMALL[: SMALL.index("POINTS")], "no POINTS in the whole file"),
        (SMALL[: SMALL.index("two")], "cut off after line 1; expected the title"),
        (SMALL[: SMALL.index("radius")], "cut off after line 23; expected an array of the field"),
        (SMALL + "POINTS 0 double\n", "line 26: POINTS comes twice"),
        (SMALL + "x" * 5000, "line 26: a line of more than 4096 characters"),
        (broken("-1", "1" * 1200), "line 7: a word of more than 512 characters; expected a number"),
        (
            SMALL.replace("radius", "mass").replace("VERTICES 2 4\n1 0\n1 1", "LINES 1 3\n2 0 1"),
            "1 lines or polygons and no point array radius or diameter; expected spheres",
        ),
    ],
)
def test_refusals_of_text(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.vtk[:,] {message}"):
        read_vtk_legacy(put(tmp_path, text))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (binary()[:120], r"cut off: POINTS has \d+ bytes; expected 48"),
        (binary()[:-3], "cut off: id has 6 bytes; expected 8"),
        (binary(points=999_999_999_999), r"cut off: POINTS has \d+ bytes; expected 23999999999976"),
        (binary(cells=b"VERTICES 9 999999999999999999\n"), r"cut off: VERTICES has \d+ bytes"),
        (binary(cells=NEW_CELLS[:-30].replace(b"CONN", b"DISC")), r"'DISCECTIVITY'; expected CONNECTIVITY"),
        (binary(cells=b"FIELD f 1\nt 1 1 string\n" + bytes([0, *8 * [255]])), r"cut off: a text has \d+ bytes"),
        (binary(cells=b"junk\n"), "'junk' is no keyword of VTK's legacy files"),
        (binary(cells=b"POINT_DATA 2\nSCALARS radius bit\n\x80"), "radius is of the type 'bit'; expected one of"),
    ],
)
def test_refusals_of_binary(tmp_path: Path, content: bytes, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.vtk: {message}"):
        read_vtk_legacy(put(tmp_path, content))


@pytest.mark.parametrize(
    "content",
    [
        binary(points=10**17),
        SMALL.replace("POINTS 2", "POINTS 99999999999999999").encode(),
        SMALL.replace("FieldData 2", "FieldData 99999999999999999").encode(),
        binary(cells=b"CELL_TYPES 99999999999999999\n"),
    ],
)
def test_a_claim_takes_no_memory(tmp_path: Path, content: bytes) -> None:
    path = put(tmp_path, content)
    tracemalloc.start()
    try:
        with pytest.raises(BadFileError):
            read_vtk_legacy(path)
        assert tracemalloc.get_traced_memory()[1] < 4e6
    finally:
        tracemalloc.stop()


SAMPLES = [
    SMALL.encode(),
    binary(cells=NEW_CELLS),
    *((DATA / name).read_bytes() for name in ("text2000.vtk", "binary2000.vtk", "vtk_4.2_binary.vtk")),
]


@settings(max_examples=300)
@given(mutated(SAMPLES))
def test_damaged_files_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.vtk"
    path.write_bytes(data)
    try:
        held = read_vtk_legacy(path)
    except BadFileError as error:
        assert str(path) in str(error)  # noqa: PT017
    else:
        assert np.isfinite(held.centers).all()
        assert held.radii is None or held.radii.shape == held.centers.shape[:1]


@pytest.mark.parametrize("line", [2, 3])
def test_a_long_line_of_the_header_is_shown_short(tmp_path: Path, line: int) -> None:
    lines = ["# vtk DataFile Version 3.0", "title", "ASCII", "DATASET POLYDATA"]
    lines[line] = "DATASET " + "x" * 3000
    (tmp_path / "a.vtk").write_text("\n".join(lines) + "\n")
    with pytest.raises(BadFileError, match=r"a\.vtk, line \d: .*expected (ASCII or BINARY|POLYDATA)") as caught:
        read(tmp_path / "a.vtk")
    assert len(str(caught.value)) < 500
