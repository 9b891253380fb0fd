"""CSV files: units in the header, facts in comments, every refusal with its line."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from bedrad import BadFileError, Packing, Plate, Rod, Tube, read, write
from bedrad.packings.files import rows as number_rows

TUBE = Tube(0.01)
HEADER = "x [m],y [m],z [m],radius [m]\n"


def put(tmp_path: Path, text: str, name: str = "bed.csv") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("unit", "factor"), [("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("µm", 1e-6), ("\N{GREEK SMALL LETTER MU}m", 1e-6)]
)
def test_units_of_every_column(tmp_path: Path, unit: str, factor: float) -> None:
    path = put(tmp_path, f"x [m],y [{unit}],z [m],radius [{unit}]\n0.001,2,0.003,5\n", "bed.csv")
    packing = read(path, Tube(10.0), max_overlap=2.0)
    assert packing.centers.tolist() == [[0.001, 2 * factor, 0.003]]
    assert packing.radii.tolist() == [5 * factor]


def test_order_case_quotes_brackets_and_other_columns_do_not_matter(tmp_path: Path) -> None:
    text = '"Radius (mm)", id ,"Z (mm)",colour,X [mm],y [mm]\n0.5,7,3,red,1,2\n\n0.25,8,9,blue,4,5\n'
    packing = read(put(tmp_path, text), TUBE)
    np.testing.assert_allclose(packing.centers, [[1e-3, 2e-3, 3e-3], [4e-3, 5e-3, 9e-3]], rtol=1e-15)
    np.testing.assert_allclose(packing.radii, [5e-4, 2.5e-4], rtol=1e-15)


SPHERE = [[1e-3, 2e-3, 3e-3]]


@pytest.mark.parametrize(
    "text",
    [
        "X (m),Y (m),Z (m),Particle Diameter (m)\n.001,.002,.003,.001\n",
        "x [mm];y [mm];z [mm];d [mm]\n1;2;3;1\n",
        "x [mm]\ty [mm]\tz [mm]\tradius [um]\n1\t2\t3\t500\n",
        # what STAR-CCM+ writes of tracks, the plain position beside it
        '"Track: Parcel Index","Track: Position[X] (m)","Track: Position[Y] (m)","Track: Position[Z] (m)",'
        '"Track: Particle Diameter (m)","Track: Velocity[i] (m/s)"\n7,.001,.002,.003,.001,.5\n',
        '"X (mm)","Y (mm)","Z (mm)","Position[X] (m)","Position[Y] (m)","Position[Z] (m)","Radius (mm)"\n'
        "1,2,3,9,9,9,.5\n",
        "Region: Bed: Centroid[X] (m),Region: Bed: Centroid[Y] (m),Region: Bed: Centroid[Z] (m),Size (m)\n"
        ".001,.002,.003,.001\n",
        "Particle X-Coordinate: (m),Particle Y-Coordinate: (m),Particle Z-Coordinate: (m),Particle Size: (m)\n"
        ".001,.002,.003,.001\n",
        "Points:0 [cm],Points:1 [cm],Points:2 [cm],rad [cm]\n.1,.2,.3,.05\n",
        "x_mm,y_mm,z_mm,radius_mm\n1,2,3,0.5\n",
        "pos_x (mm), pos_y (mm), pos_z (mm), diam (mm)\n1, 2, 3, 1\n",
        # the one form has no z, the other has
        "x [mm],y [mm],center z [mm],r [mm]\n1,2,3,.5\n",
        'name,x [mm],y [mm],z [mm],r [mm]\n"a, ""b""",1,2,3,.5\n',
        'x [mm],y [mm],z [mm],r [mm]\n"1","2","3","0.5"\n',
    ],
)
def test_headers_of_many_programs(tmp_path: Path, text: str) -> None:
    # a name without a suffix: the content tells
    packing = read(put(tmp_path, text, "bed"), TUBE)
    np.testing.assert_allclose(packing.centers, SPHERE, rtol=1e-15)
    np.testing.assert_allclose(packing.radii, [5e-4], rtol=1e-15)
    assert {"file": "bed", "format": "CSV"}.items() <= packing.provenance.items()
    assert "length_unit" not in packing.provenance


def test_a_header_without_units_needs_one(tmp_path: Path) -> None:
    path = put(tmp_path, "x,y,z,radius\n1,2,3,0.5\n")
    with pytest.raises(BadFileError, match=r"bed\.csv, line 1: the columns have no unit; give the unit of its lengths"):
        read(path, TUBE)
    packing = read(path, TUBE, unit="mm")
    np.testing.assert_allclose(packing.centers, SPHERE, rtol=1e-15)
    assert packing.provenance["length_unit"] == "mm, as given"
    # a wall in a comment is no unit of the columns
    with pytest.raises(BadFileError, match="line 2: the columns have no unit"):
        read(put(tmp_path, "# wall: tube radius=0.01 m\nx,y,z,radius\n1,2,3,0.5\n"))
    with pytest.raises(ValueError, match=r"the unit 'mm' was given, but .*bed\.csv states the unit"):
        read(put(tmp_path, HEADER + "0,0,0,0.001\n"), TUBE, unit="mm")
    with pytest.raises(ValueError, match="the unit of length is 'yard'; expected one of m, cm, mm, um, nm, in, ft"):
        read(path, TUBE, unit="yard")


@pytest.mark.parametrize(
    "columns",
    [
        {"x": "Easting", "y": "Northing", "z": "Up", "diameter": "Grain"},
        {"x": "easting (MM)", "y": "northing", "z": "up", "diameter": "grain"},
        {"x": 2, "y": "3", "z": 4, "diameter": 1},
    ],
)
def test_columns_that_are_named_by_the_user(tmp_path: Path, columns: dict[str, str | int]) -> None:
    path = put(tmp_path, "Grain (mm),Easting (mm),Northing (mm),Up (mm),z (m)\n1,1,2,3,77\n")
    packing = read(path, TUBE, columns=columns)
    np.testing.assert_allclose(packing.centers, SPHERE, rtol=1e-15)
    np.testing.assert_allclose(packing.radii, [5e-4], rtol=1e-15)


def test_numbers_of_columns_need_no_header(tmp_path: Path) -> None:
    path = put(tmp_path, "# no header\n1,2,3,0.5\n4,5,6,0.25\n")
    packing = read(path, TUBE, columns={"x": 1, "y": 2, "z": 3, "radius": 4}, unit="mm")
    np.testing.assert_allclose(packing.centers, [*SPHERE, [4e-3, 5e-3, 6e-3]], rtol=1e-15)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"x": "a"}, r"line 1: column 'a' for x is not there; the header has x \[m\], y"),
        ({"x": 6}, "line 1: column '6' for x is not there"),
        ({"x": 0}, "line 1: column '0' for x is not there"),
        ({"x": "y"}, "line 1: column 'y' for x comes 2 times"),
    ],
)
def test_columns_that_are_not_there(tmp_path: Path, columns: dict[str, str | int], message: str) -> None:
    with pytest.raises(BadFileError, match=message):
        read(put(tmp_path, "x [m],y [m],Y [cm],z [m],radius [m]\n0,0,0,0,1\n"), TUBE, columns=columns)


def test_columns_that_bedrad_does_not_have(tmp_path: Path) -> None:
    path = put(tmp_path, HEADER + "0,0,0,0.001\n")
    with pytest.raises(ValueError, match="columns name 'colour'; expected x, y, z, radius, diameter"):
        read(path, TUBE, columns={"colour": "radius"})


def test_chunks_leave_no_seam(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(number_rows, "_ROWS_AT_ONCE", 7)
    rows = [f"0,0,{0.002 * i!r},0.001\n" for i in range(50)]
    rows.insert(33, "# a comment amid the rows\n\n")
    assert read(put(tmp_path, HEADER + "".join(rows)), TUBE).centers[:, 2].tolist() == [0.002 * i for i in range(50)]
    rows[40] = "0,0,7,x\n"
    with pytest.raises(BadFileError, match="line 43: radius is 'x'"):
        read(put(tmp_path, HEADER + "".join(rows)), TUBE)


def test_a_column_of_diameters(tmp_path: Path) -> None:
    assert read(put(tmp_path, "x [m],y [m],z [m],diameter [m]\n0,0,0,0.002\n"), TUBE).radii.tolist() == [0.001]


def test_positions_only_need_a_diameter(tmp_path: Path) -> None:
    path = put(tmp_path, "x [m],y [m],z [m]\n0,0,0\n0,0,0.01\n")
    assert read(path, TUBE, diameter=0.002).radii.tolist() == [0.001, 0.001]
    with pytest.raises(BadFileError, match=r"bed\.csv: no column radius or diameter; give the diameter"):
        read(path, TUBE)
    with pytest.raises(ValueError, match=r"diameter is -0\.002; expected a positive number"):
        read(path, TUBE, diameter=-0.002)


def test_a_diameter_beside_sizes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"diameter 0\.002 m was given, but .*bed\.csv has the sizes"):
        read(put(tmp_path, "x [m],y [m],z [m],radius [m]\n0,0,0,0.001\n"), TUBE, diameter=0.002)


@pytest.mark.parametrize("lead", ["", "\ufeff"])
def test_comments_restore_wall_and_period_and_a_byte_order_mark_is_no_harm(tmp_path: Path, lead: str) -> None:
    text = f"{lead}# made by hand\n# wall: rod radius=0.02 m\n# period: 0.5 m\n{HEADER}0.03,0,0,0.001\n"
    packing = read(put(tmp_path, text))
    assert (packing.wall, packing.period) == (Rod(0.02), 0.5)
    assert {"file": "bed.csv", "format": "CSV"}.items() <= packing.provenance.items()


def test_the_written_text(tmp_path: Path) -> None:
    write(Packing([[0.1, 0.2, 1 / 3]], 0.05, Plate(), (1.0, 0.7), {"seed": 3}), tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_text() == (
        "# wall: plate\n"
        "# period: 1.0 0.7 m\n"
        "# max_overlap: 0.1\n"
        '# provenance: {"seed": 3}\n'
        "x [m],y [m],z [m],radius [m]\n"
        "0.1,0.2,0.3333333333333333,0.05\n"
    )


def test_windows_line_ends_and_gzip(tmp_path: Path) -> None:
    text = "x [m],y [m],z [m],radius [m]\r\n0,0,0,0.001\r\n"
    (tmp_path / "bed.csv.gz").write_bytes(gzip.compress(text.encode()))
    assert len(read(tmp_path / "bed.csv.gz", TUBE)) == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEADER + "0,0,0,0.001\n0,nan,0,0.001\n", r"line 3: y is 'nan'; expected a finite number"),
        (HEADER + "0,0,0,0.001\n0,0,1e999,0.001\n", r"line 3: z is '1e999'; expected a finite number"),
        ("# a\n\n" + HEADER + "0,0,0,O.001\n", r"line 4: radius is 'O\.001'; expected a number"),
        (HEADER + "0,0,,0.001\n", r"line 2: z is ''; expected a number"),
        (HEADER + "0,0,0,0.001\n0,0,0\n", r"line 3: 3 fields; the header names 4 columns"),
        (HEADER + "0,0,0,0.001\n0,0,0.1,-0.001\n", r"sphere 1: radius -0\.001 m.*\(line 3\)"),
        (HEADER + "0,0,0,0.001\n0.0095,0,0.1,0.001\n", r"sphere 1: .* through the tube wall.*\(line 3\)"),
        (HEADER + "0,0,0,0.001\n\n0,0,0,0.001\n", r"spheres 0 and 1.* lie on one point.*\(line 2 and line 4\)"),
        ("x [m],y [m],radius [m]\n0,0,1\n", r"line 1: no column z; the header has x \[m\], y \[m\], radius \[m\]"),
        ("x [m],y,z [m],radius [m]\n0,0,0,1\n", r"line 1: column 'y' has no unit; expected a header such as"),
        ("x [m],y [inch],z [m]\n0,0,0\n", r"line 1: column 'y' has the unit 'inch'"),
        ("x [m],x [m],y [m],z [m]\n0,0,0,0\n", r"line 1: column 'x' comes twice"),
        ("0.1,0.2,0.3,0.4\n0.1,0.2,0.3,0.4\n", r"line 1: no column x, y, z"),
        ("x [m];y [m];z [m];r [m]\n0,1;0;0;0,001\n", r"line 2: x is '0,1'; expected a number"),
        (HEADER + '"0,0",0,0.001\n', r"line 2: 3 fields; the header names 4 columns"),
        (HEADER + "0,0,0,0.001,\n", r"line 2: 5 fields; the header names 4 columns"),
        (HEADER + "0,0,0\n0,0,0,0.001,9\n", r"line 2: 3 fields; the header names 4 columns"),
        ("x [m],y [m],z [m],radius [m],diameter [m],d [mm]\n", r"line 1: column 'diameter' comes twice: 'diameter"),
        ("# only a comment\n", r"no header; expected a header such as"),
        ("# wall: tube\n" + HEADER, r"line 1: wall 'tube' is not understood: the tube wall has the radius None"),
        ("# wall: tube radius=wide m\n" + HEADER, r"line 1: wall .* is not understood: could not convert"),
        ("# wall: tube radius=-1 m\n" + HEADER, r"line 1: wall .* is not understood: tube radius is -1\.0"),
        ("# wall: a tube of 1 m\n" + HEADER, r"line 1: wall .* is not understood: expected 'tube radius="),
        ("# period: 3 mm\n" + HEADER, r"line 1: period '3 mm' is not understood: expected one or two numbers"),
        ("# provenance: [1]\n" + HEADER, r"line 1: provenance .* is not understood: expected names and values"),
        ('# provenance: {"a": true, "b": [1]}\n' + HEADER, r"line 1: provenance .*: provenance 'b' is \[1\]"),
        ("# provenance: __import__('os')\n" + HEADER, r"line 1: provenance .* is not understood"),
        ("# max_overlap: few\n" + HEADER, r"line 1: max_overlap 'few' is not understood"),
    ],
)
def test_refusals_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.csv[:,] {message}"):
        read(put(tmp_path, text), TUBE)


def test_a_frame_is_refused(tmp_path: Path) -> None:
    path = put(tmp_path, HEADER + "0,0,0,0.001\n")
    assert len(read(path, TUBE, frame=0)) == 1
    with pytest.raises(BadFileError, match=r"bed\.csv: frame 2 was asked for; a CSV file holds one packing"):
        read(path, TUBE, frame=2)


def test_a_fact_of_thousands_of_digits_is_shown_short(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"# max_overlap: {'9' * 5000}x\nx [m],y [m],z [m],radius [m]\n0,0,0,1\n")
    with pytest.raises(BadFileError, match=r"a\.csv, line 1: max_overlap '9+'\.\.\. is not understood") as caught:
        read(path, Tube(9.0))
    assert len(str(caught.value)) < 500
