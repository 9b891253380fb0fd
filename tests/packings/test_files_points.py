"""Tables of points: with and without a header, columns named by the user, every refusal with its line."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from bedrad import BadFileError, Tube, read
from bedrad.packings.files import read_frames
from bedrad.packings.files.point_table import looks_like_points, read_points
from packings.file_mutations import mutated, takes_or_refuses

TUBE = Tube(0.1)
ROWS = "0.01 0.02 0.1 0.005\n0.03 -0.01 0.2 0.004\n"
CENTERS = [[0.01, 0.02, 0.1], [0.03, -0.01, 0.2]]


def put(tmp_path: Path, text: str, name: str = "bed.txt") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "head",
    [
        "",
        "# made by a program\n",
        "# x y z r\n",
        "#x y z radius\n",
        "% X Y Z Rad\n\n! 17 2 3\n",
        "// columns: x y z r\n",
        "x y z r\n",
        '"x" "y" "z" "Radius"\n',
        "# x, y, z, r\n",
        "; any\nX Y Z R\n# a comment between\n\n",
        "\ufeffx y z r\n",
    ],
)
@pytest.mark.parametrize("name", ["bed.txt", "bed", "bed.dat"])
def test_four_columns(tmp_path: Path, head: str, name: str) -> None:
    packing = read(put(tmp_path, head + ROWS, name), TUBE)
    assert packing.centers.tolist() == CENTERS
    assert packing.radii.tolist() == [0.005, 0.004]
    assert packing.provenance["format"] == "table of points"


@pytest.mark.parametrize("head", ["x y z d\n", "# X Y Z Diameter\n", "x y z diam\n"])
def test_a_header_of_diameters(tmp_path: Path, head: str) -> None:
    assert read(put(tmp_path, head + ROWS), TUBE).radii.tolist() == [0.0025, 0.002]


@pytest.mark.parametrize("head", ["", "# x y z\n", "x y z\n"])
def test_positions_only_need_a_diameter(tmp_path: Path, head: str) -> None:
    path = put(tmp_path, head + "0.01 0.02 0.1\n0.03 -0.01 0.2\n")
    packing = read(path, TUBE, diameter=0.01)
    assert (packing.centers.tolist(), packing.radii.tolist()) == (CENTERS, [0.005, 0.005])
    with pytest.raises(BadFileError, match=r"bed\.txt: no column radius or diameter; give the diameter"):
        read(path, TUBE)


def test_other_columns_are_passed_over_and_ids_give_the_order(tmp_path: Path) -> None:
    path = put(tmp_path, "id r z vx y x\n7 0.004 0.2 1 -0.01 0.03\n2 0.005 0.1 nan 0.02 0.01\n")
    packing = read(path, TUBE)
    assert (packing.centers.tolist(), packing.radii.tolist()) == (CENTERS, [0.005, 0.004])


@pytest.mark.parametrize("head", ["# x[mm] y[mm] z[mm] r[mm]\n", "x(mm) y(mm) z(mm) r(mm)\n"])
def test_units_in_the_header(tmp_path: Path, head: str) -> None:
    path = put(tmp_path, head + "10 20 100 5\n30 -10 200 4\n")
    packing = read(path, TUBE)
    np.testing.assert_allclose(packing.centers, CENTERS, rtol=1e-15)
    np.testing.assert_allclose(packing.radii, [0.005, 0.004], rtol=1e-15)
    with pytest.raises(ValueError, match=r"the unit 'cm' was given, but .*bed\.txt states the unit"):
        read(path, TUBE, unit="cm")


def test_a_unit_can_be_said(tmp_path: Path) -> None:
    packing = read(put(tmp_path, "10 20 100 5\n30 -10 200 4\n"), TUBE, unit="mm")
    np.testing.assert_allclose(packing.centers, CENTERS, rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("0.1 0.01 0.02 0.01\n0.2 0.03 -0.01 0.008\n", {"x": "2", "y": "3", "z": "1", "diameter": "4"}),
        ("0.01 0.02 0.1 0.01\n0.03 -0.01 0.2 0.008\n", {"diameter": "4"}),
        ("0.01 0.02 0.1 7 0.005\n0.03 -0.01 0.2 7 0.004\n", {"x": "1", "y": "2", "z": "3", "radius": "5"}),
        ("px py pz size\n" + ROWS, {"x": "px", "y": "py", "z": "pz", "radius": "size"}),
        ("# px py pz size\n" + ROWS, {"x": "px", "y": "2", "z": "pz", "radius": "4"}),
        ("x y z r size\n0.01 0.02 0.1 9 0.005\n0.03 -0.01 0.2 9 0.004\n", {"radius": "size"}),
        ("x y z r size\n0.01 0.02 0.1 9 0.01\n0.03 -0.01 0.2 9 0.008\n", {"diameter": "size"}),
    ],
)
def test_columns_named_by_the_user(tmp_path: Path, text: str, columns: Mapping[str, str]) -> None:
    packing = read(put(tmp_path, text), TUBE, columns=columns)
    assert (packing.centers.tolist(), packing.radii.tolist()) == (CENTERS, [0.005, 0.004])


def test_gzip_line_ends_and_frames(tmp_path: Path) -> None:
    path = tmp_path / "bed.xyzr.gz"
    path.write_bytes(gzip.compress(ROWS.replace("\n", "\r\n").encode()))
    assert [packing.centers.tolist() for packing in read_frames(path, TUBE)] == [CENTERS]
    with pytest.raises(BadFileError, match="frame 1 was asked for; a table of points file holds one packing"):
        read(path, TUBE, frame=1)


def test_numbers_of_rows_are_not_taken_for_positions(tmp_path: Path) -> None:
    rows = "".join(f"{k} 0.0 0.0 {k * 0.1}\n" for k in range(4))
    with pytest.raises(BadFileError, match=r"bed\.txt, line 1: the first column only counts the rows; say which"):
        read(put(tmp_path, rows), TUBE, diameter=0.01)
    columns = {"x": "2", "y": "3", "z": "4"}
    packing = read(put(tmp_path, rows), TUBE, diameter=0.01, columns=columns)
    assert packing.centers.tolist() == [[0.0, 0.0, k * 0.1] for k in range(4)]


@pytest.mark.parametrize(
    ("text", "taken"),
    [
        (ROWS, True),
        ("# only a comment\n", False),
        ("x y z r\n", False),
        ("1 2\n3 4\n", False),
        ("1,2,3\n4,5,6\n", False),
        ("3\n\n1 2 3\n", False),
        # the header of MercuryDPM's data has 8 numbers, its rows 14
        ("1 0 0 0 0 1 1 1\n0 0 0 0 0 0 .1 0 0 0 0 0 0 0\n", False),
        ("some words that are\nno table\n", False),
        ("x y z r\n1 2 3 four\n", False),
        # a long file ends in the middle of a row
        (ROWS * 300 + "0.1 0.", True),
        ("", False),
    ],
)
def test_what_looks_like_a_table(text: str, taken: bool) -> None:
    assert looks_like_points(text.encode()) == taken


@pytest.mark.parametrize(
    ("text", "columns", "message"),
    [
        (ROWS + "0 nan 0.3 0.001\n", {}, r"line 3: y is 'nan'; expected a finite number"),
        (ROWS + "# a\n0 0 1e999 0.001\n", {}, r"line 4: z is '1e999'; expected a finite number"),
        ("0 0 O.1 0.001\n", {}, r"line 1: z is 'O\.1'; expected a number"),
        (ROWS + "0 0 0.3\n", {}, r"line 3: 3 fields; the first row, line 1, has 4"),
        (ROWS + "0 0 0.3 1 1\n", {}, r"line 3: 5 fields; the first row, line 1, has 4"),
        ("x y z r\n0 0 0\n", {}, r"line 2: 3 fields; the header in line 1 names 4"),
        ("1 2\n3 4\n", {}, r"line 1: 2 columns and no header; expected x y z or x y z radius"),
        ("1 2 3 4 5\n", {}, r"line 1: 5 columns and no header"),
        ("x y height r\n1 2 3 4\n", {}, r"line 2: no column z; the header has x, y, height, r; say which"),
        ("x y z x\n1 2 3 4\n", {}, r"line 1: column 'x' comes twice"),
        ("x y z r\n", {}, r"no row of numbers after the header 'x y z r' in line 1"),
        ("# nothing\n", {}, r"no row of numbers; expected x y z"),
        ("x[mm] y[mm] z[mm] r[m]\n1 2 3 4\n", {}, r"line 1: units differ: x mm, y mm, z mm, radius m; expected one"),
        ("x[mm] y[mm] z[mm] r\n1 2 3 4\n", {}, r"line 1: units differ: .*radius none"),
        ("x[pc] y[pc] z[pc]\n1 2 3\n", {}, r"line 1: the unit is 'pc'; expected one of m,"),
        (ROWS, {"x": "5"}, r"line 1: x is asked from column '5'; expected 1 to 4, as no header names them"),
        (ROWS, {"x": "0"}, r"line 1: x is asked from column '0'; expected 1 to 4"),
        (ROWS, {"x": "9" * 5000}, r"line 1: x is asked from column '9+'[.]{3}; expected 1 to 4"),
        (ROWS, {"x": "px"}, r"line 1: x is asked from column 'px'; expected 1 to 4"),
        ("x y z r\n1 2 3 4\n", {"z": "h"}, r"line 2: z is asked from column 'h'; expected 1 to 4 or one of x, y, z, r"),
        (ROWS, {"x": "2"}, r"line 1: no column y; say which columns they are"),
        ("x y z r\n" + ROWS, {"x": "2"}, r"line 2: column 2 is asked for both y and x"),
        ("1 2 3 4 5\n", {"x": "2"}, r"line 1: no column y, z; say which columns they are"),
        (ROWS + "0 0 0.3 -0.001\n", {}, r"sphere 2: radius -0\.001 m.*\(line 3\)"),
        (ROWS + ROWS, {}, r"spheres .*one point.*\(line 1 and line 3\)"),
        ("id x y z r\n1 0 0 0 .001\n1 0 0 .1 .001\n", {}, r"lines 2 and 3: both have the id 1"),
    ],
)
def test_refusals_name_the_line(tmp_path: Path, text: str, columns: Mapping[str, str], message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.txt[:,] {message}"):
        read(put(tmp_path, text), TUBE, columns=columns)


def test_the_reader_without_columns(tmp_path: Path) -> None:
    held = read_points(put(tmp_path, ROWS))
    assert held.centers.tolist() == CENTERS
    assert held.lines.tolist() == [1, 2]


@given(mutated([(head + ROWS * 3).encode() for head in ("", "x y z r\n", "# id x y z\n", "x[mm] y[mm] z[mm] d[mm]\n")]))
def test_damaged_files_are_taken_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    takes_or_refuses(tmp_path_factory.getbasetemp() / "damaged.txt", data)
