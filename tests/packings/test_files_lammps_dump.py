"""Dumps of LAMMPS and LIGGGHTS, whole and broken."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from bedrad import BadFileError, Plate, Rod, Tube, read
from bedrad.packings.files import lines, read_frames, rows

DATA = Path(__file__).parents[1] / "data" / "lammps_dumps"
TUBE = Tube(0.002)
PERIOD = 0.004

SMALL = """\
ITEM: TIMESTEP
100
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS ff ff pp
-1 1
-1 1
-2 3
ITEM: ATOMS id x y z radius
9 0 0 2 0.5
4 0 0 -1 0.25
"""


def put(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "bed.dump"
    path.write_text(text)
    return path


@pytest.mark.parametrize("frame", [0, 1, 2, -1])
@pytest.mark.parametrize(
    ("name", "roundings"),
    # LAMMPS adds the image flag plus 512 to xsu and takes the 512 away again: half an eps of 512 is lost
    [("scaled.dump", 2), ("unwrapped.dump", 2), ("scaled_unwrapped.dump.gz", 2 + 256)],
)
def test_every_form_of_position_gives_the_same_packing(name: str, roundings: int, frame: int) -> None:
    plain = read(DATA / "plain.dump", TUBE, frame=frame)
    other = read(DATA / name, TUBE, frame=frame)
    apart = np.abs(other.centers - plain.centers)
    apart[:, 2] = np.minimum(apart[:, 2], PERIOD - apart[:, 2])
    assert apart.max() <= roundings * np.finfo(float).eps * PERIOD
    # LAMMPS itself halves and doubles the diameter, which is exact
    assert other.radii.tolist() == plain.radii.tolist()


def test_a_dump_of_lammps_in_full() -> None:
    packing = read(DATA / "plain.dump", TUBE)
    assert packing.period == PERIOD
    assert [round(r * 1e4) for r in packing.radii] == [3, 3, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3]
    # id 8, which the last frame lists first
    assert packing.centers[7].tolist() == [0.00023728752676271231, 0.00097146230090942886, 0.0021194756541491932]
    assert dict(packing.provenance) == {
        "file": "plain.dump",
        "format": "LAMMPS dump",
        "frame": 2,
        "timestep": 80,
        "length_unit": "m, assumed",
    }


def test_frames_come_one_after_the_other() -> None:
    packings = list(read_frames(DATA / "scaled.dump", TUBE))
    assert [p.provenance["timestep"] for p in packings] == [0, 40, 80]
    for index, packing in enumerate(packings):
        assert packing.centers.tolist() == read(DATA / "scaled.dump", TUBE, frame=index).centers.tolist()
        assert packing.centers.tolist() == read(DATA / "scaled.dump", TUBE, frame=index - 3).centers.tolist()


def test_liggghts_labels_order_and_open_ends() -> None:
    first, last = read_frames(DATA / "liggghts.dump", Tube(0.004))
    assert first.centers[:, 0].tolist() == [-0.001, -0.0005, 0.001]
    assert first.radii.tolist() == [0.0003, 0.0002, 0.0003]
    assert last.centers[:, 2].tolist() == [0.0003, 0.00425]
    assert first.period is None
    assert last.provenance["timestep"] == 20000


@pytest.mark.parametrize(
    ("flags", "wall", "period"),
    [
        ("ff ff pp", TUBE, 5.0),
        ("pp pp pp", Rod(1e-3), 5.0),
        ("pp pp ff", TUBE, None),
        ("pp pp ff", Plate(), (2.0, 4.0)),
        ("pp ff pp", Plate(), None),
        ("", TUBE, None),
    ],
)
def test_the_flags_of_the_box_give_the_period(tmp_path: Path, flags: str, wall: object, period: object) -> None:
    text = f"ITEM: NUMBER OF ATOMS\n0\nITEM: BOX BOUNDS {flags}\n-1 1\n-1 3\n-2 3\nITEM: ATOMS id x y z radius\n"
    packing = read(put(tmp_path, text), wall)  # type: ignore[arg-type]
    assert packing.period == period
    assert len(packing) == 0


def test_a_shifted_box_is_wrapped_whole(tmp_path: Path) -> None:
    packing = read(put(tmp_path, SMALL), Tube(1.0))
    # sorted by id; z = -1 is 4 in a period of 5
    assert packing.centers[:, 2].tolist() == [4.0, 2.0]
    assert read(put(tmp_path, SMALL), Tube(1.0), period=0).centers[:, 2].tolist() == [-1.0, 2.0]


@pytest.mark.parametrize(("units", "metre"), [("si", 1.0), ("cgs", 1e-2), ("micro", 1e-6), ("nano", 1e-9)])
def test_units_that_the_dump_names(tmp_path: Path, units: str, metre: float) -> None:
    # named once, in the first frame, and valid for all
    text = f"ITEM: UNITS\n{units}\n" + SMALL + SMALL
    packing = read(put(tmp_path, text), Tube(1.0))
    np.testing.assert_allclose(packing.radii, [0.25 * metre, 0.5 * metre], rtol=1e-15)
    np.testing.assert_allclose(packing.centers[:, 2], [4 * metre, 2 * metre], rtol=1e-12)
    assert packing.period == pytest.approx(5 * metre, rel=1e-15)
    assert "length_unit" not in packing.provenance
    with pytest.raises(ValueError, match=r"the unit 'mm' was given, but .*bed\.dump states the unit of its lengths"):
        read(put(tmp_path, text), Tube(1.0), unit="mm")


def test_a_unit_that_the_dump_does_not_name(tmp_path: Path) -> None:
    # lj is no unit: lengths are plain numbers
    for text in (SMALL, f"ITEM: UNITS\nlj\n{SMALL}"):
        packing = read(put(tmp_path, text), Tube(1.0), unit="mm")
        np.testing.assert_allclose(packing.radii, [0.25e-3, 0.5e-3], rtol=1e-15)
        np.testing.assert_allclose(packing.centers[:, 2], [4e-3, 2e-3], rtol=1e-12)
        assert packing.period == pytest.approx(5e-3, rel=1e-15)
        assert packing.provenance["length_unit"] == "mm, as given"
        assert read(put(tmp_path, text), Tube(1.0)).provenance["length_unit"] == "m, assumed"


def test_labels_times_and_columns_of_words_are_passed_over(tmp_path: Path) -> None:
    text = SMALL.replace("ITEM: NUMBER", "ITEM: LABEL\nspheres of glass\nITEM: TIME\n0.5\nITEM: NUMBER")
    assert (
        read(put(tmp_path, text), Tube(1.0)).centers.tolist() == read(put(tmp_path, SMALL), Tube(1.0)).centers.tolist()
    )
    words = text.replace("z radius", "z radius element").replace("2 0.5", "2 0.5 Si").replace("-1 0.25", "-1 0.25 O")
    packing = read(put(tmp_path, words), Tube(1.0))
    assert (packing.radii.tolist(), packing.centers[:, 2].tolist()) == ([0.25, 0.5], [4.0, 2.0])


def many(frames: int, count: int) -> str:
    """Frames of a column of spheres, the last first; frame k lies k/100 m further out."""
    head = f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{count}\nITEM: ATOMS id x y z radius\n"
    return "".join(head + "".join(f"{i} {k / 100} 0 {2 * i} 1\n" for i in range(count, 0, -1)) for k in range(frames))


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("frame", [0, 3, -1, -5])
def test_blocks_and_chunks_leave_no_seam(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, packed: bool, frame: int
) -> None:
    monkeypatch.setattr(lines, "_BLOCK", 64)
    monkeypatch.setattr(rows, "_ROWS_AT_ONCE", 7)
    text = many(5, 40)
    path = tmp_path / ("bed.dump.gz" if packed else "bed.dump")
    # the last line without its end, as a killed run may leave it
    path.write_bytes(gzip.compress(text[:-1].encode()) if packed else text[:-1].encode())
    packing = read(path, Tube(5.0), frame=frame)
    assert packing.centers.tolist() == [[frame % 5 / 100, 0.0, 2.0 * i] for i in range(1, 41)]
    assert [p.centers[0, 0] for p in read_frames(path, Tube(5.0))] == [0.0, 0.01, 0.02, 0.03, 0.04]


def test_earlier_frames_are_counted_and_not_read(tmp_path: Path) -> None:
    text = many(1, 3).replace(" 0 ", " soon ") + many(1, 3)
    assert len(read(put(tmp_path, text), Tube(5.0))) == 3
    with pytest.raises(BadFileError, match="line 6: y is 'soon'"):
        read(put(tmp_path, text), Tube(5.0), frame=0)


def test_an_error_deep_in_a_long_frame_has_its_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rows, "_ROWS_AT_ONCE", 7)
    for wrong, message in (("31 0.0 0 6x 1", "z is '6x'"), ("31 0.0 0 62", "4 fields"), ("31 0 0 62 1 1", "6 fields")):
        text = many(1, 40).replace("31 0.0 0 62 1", wrong)
        with pytest.raises(BadFileError, match=f"line 15: {message}"):
            read(put(tmp_path, text), Tube(5.0))
    # a short row and a long one, which together have as many fields as two good ones
    text = many(1, 40).replace("31 0.0 0 62 1", "31 0.0 0 62").replace("30 0.0 0 60 1", "30 0.0 0 60 1 1")
    with pytest.raises(BadFileError, match="line 15: 4 fields"):
        read(put(tmp_path, text), Tube(5.0))


@pytest.mark.parametrize("packed", [False, True])
def test_a_count_beyond_the_file_takes_no_memory(tmp_path: Path, packed: bool) -> None:
    text = many(1, 3).replace("ATOMS\n3", "ATOMS\n1000000000000")
    path = tmp_path / "bed.dump"
    path.write_bytes(gzip.compress(text.encode()) if packed else text.encode())
    for frame in (0, -1):
        with pytest.raises(BadFileError, match="frame 0 is cut off: 1000000000000 rows expected, 3 found"):
            read(path, TUBE, frame=frame)


def test_a_file_without_line_ends_is_no_dump(tmp_path: Path) -> None:
    path = put(tmp_path, "ITEM: ATOMS" + "x" * 2**22)
    with pytest.raises(BadFileError, match=r"bed\.dump, line 1: longer than 1048576 bytes; no table has such lines"):
        read(path, TUBE)


def test_diameters_and_sizes_from_outside(tmp_path: Path) -> None:
    assert read(put(tmp_path, SMALL.replace("radius", "diameter")), Tube(1.0)).radii.tolist() == [0.125, 0.25]
    bare = SMALL.replace(" radius", "").replace(" 0.5\n", "\n").replace(" 0.25\n", "\n")
    assert read(put(tmp_path, bare), Tube(1.0), diameter=0.5).radii.tolist() == [0.25, 0.25]
    with pytest.raises(BadFileError, match=r"bed\.dump: no column radius or diameter"):
        read(put(tmp_path, bare), Tube(1.0))


def test_without_ids_the_order_of_the_file_stays(tmp_path: Path) -> None:
    text = SMALL.replace("ATOMS id", "ATOMS mol")
    assert read(put(tmp_path, text), Tube(1.0)).radii.tolist() == [0.5, 0.25]


def test_an_earlier_frame_needs_no_whole_end(tmp_path: Path) -> None:
    path = put(tmp_path, SMALL + SMALL[:-20])
    assert len(read(path, Tube(1.0), frame=0)) == 2
    with pytest.raises(BadFileError, match="frame 1 is cut off"):
        read(path, Tube(1.0))


def broken(old: str, new: str) -> str:
    assert SMALL.count(old) == 1
    return SMALL.replace(old, new)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            broken("4 0 0 -1 0.25\n", ""),
            "frame 0 is cut off: 2 rows expected, 1 found, the file ends after line 10",
        ),
        (
            SMALL + broken("4 0 0 -1 0.25\n", "") + SMALL,
            "frame 1 is cut off: 2 rows expected, 1 found, line 22 is 'ITEM: TIMESTEP'; 1 whole frames come before it",
        ),
        (broken("4 0 0 -1 0.25\n", "4 0 0 -1\n"), "line 11: 4 fields; 'ITEM: ATOMS' names 5 columns"),
        (broken("4 0 0 -1 0.25", "4 0 nan -1 0.25"), "line 11: y is 'nan'; expected a finite number"),
        (broken("9 0 0 2 0.5", "9 0 0 2 big"), "line 10: radius is 'big'; expected a number"),
        (broken("9 0 0 2 0.5", "9 0 0 2 -0.5"), r"sphere 1: radius -0\.5 m.* \(line 10, id 9\)"),
        (broken("9 0 0 2 0.5", "9 0.9 0 2 0.5"), r"sphere 1: .* through the tube wall.* \(line 10, id 9\)"),
        (broken("9 0 0 2 0.5", "9 0 0 -1 0.5"), r"spheres 0 and 1.* one point.* \(line 11, id 4 and line 10, id 9\)"),
        (broken("9 0 0 2", "4 0 0 2"), "lines 10 and 11: both have the id 4"),
        (broken("9 0 0 2", "9.5 0 0 2"), r"line 10: id is 9\.5; expected an integer"),
        (
            broken("4 0 0 -1 0.25\n", "4 0 0 -1 0.25\n5 0 0 0 0.25\n"),
            "line 12: expected a line that begins with 'ITEM:'",
        ),
        (
            broken("id x y z", "id x y height"),
            "line 9: no columns x, y, z .*; the columns are id, x, y, height, radius",
        ),
        (broken("ITEM: NUMBER OF ATOMS\n2\n", ""), "line 7: frame 0 has no 'ITEM: NUMBER OF ATOMS'"),
        (broken("ATOMS\n2\n", "ATOMS\n2.5\n"), r"line 4: the number of atoms is '2\.5'; expected an integer"),
        (broken("ATOMS\n2\n", "ATOMS\n-2\n"), "line 4: the number of atoms is -2; expected 0 or more"),
        (broken("\n100\n", "\nsoon\n"), "line 2: the time step is 'soon'; expected an integer"),
        (broken("-2 3\n", "3 -2\n"), r"line 8: the box along z reaches from 3\.0 to -2\.0"),
        (broken("-2 3\n", "-2\n"), r"line 8: 1 numbers for the box along z; expected 2"),
        (broken("-2 3\n", "-2 inf\n"), "line 8: the upper bound is 'inf'; expected a finite number"),
        (broken("BOUNDS ff ff pp", "BOUNDS xy xz yz ff ff pp"), "line 5: a triclinic box"),
        (broken("BOUNDS ff ff pp", "BOUNDS abc origin ff ff pp"), "line 5: a triclinic box"),
        ("ITEM: UNITS\nreal\n" + SMALL, "line 2: the units are 'real'; expected one of si, cgs, micro, nano, lj"),
        (broken("9 0 0 2 0.5", ""), "line 10: 0 fields; 'ITEM: ATOMS' names 5 columns"),
        (broken("9 0 0 2", "1e300 0 0 2"), "line 10: id is 1e[+]300; expected an integer"),
        (SMALL[: SMALL.index("-1 1\n-2")], "cut off after line 6; expected the bounds of the box along y"),
        (SMALL[: SMALL.index("100")], "cut off after line 1; expected the time step"),
        (SMALL[: SMALL.index("ITEM: ATOMS")], "no 'ITEM: ATOMS' in the whole file"),
        (
            "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS xs ys zs radius\n.5 .5 .5 .1\n",
            "line 3: scaled coordinates need 'ITEM: BOX BOUNDS'",
        ),
    ],
)
def test_refusals_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.dump[:,] {message}"):
        read(put(tmp_path, text), Tube(1.0))


@pytest.mark.parametrize("frame", [1, 7, -2])
def test_a_frame_that_is_not_there(tmp_path: Path, frame: int) -> None:
    with pytest.raises(BadFileError, match=f"frame {frame} was asked for; the file has 1, counted from 0"):
        read(put(tmp_path, SMALL), Tube(1.0), frame=frame)


def test_a_cut_off_gzip_file(tmp_path: Path) -> None:
    path = tmp_path / "bed.dump.gz"
    whole = gzip.compress((DATA / "plain.dump").read_bytes())
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(BadFileError, match=r"bed\.dump\.gz: broken or cut-off gzip file"):
        read(path, TUBE)
    path.write_bytes(whole[:200] + bytes(50) + whole[250:])
    with pytest.raises(BadFileError, match=r"bed\.dump\.gz"):
        read(path, TUBE)


def test_shares_of_a_box_beyond_all_numbers(tmp_path: Path) -> None:
    path = tmp_path / "a.dump"
    bounds = "-1e308 1e308\n" * 3
    path.write_text(
        f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n{bounds}"
        "ITEM: ATOMS xs ys zs radius\n0.5 0.5 2 1\n"
    )
    with pytest.raises(BadFileError, match=r"sphere 0: centre .* is not finite"):
        read(path, Tube(1.0), period=0)


def test_an_integer_of_thousands_of_digits_is_shown_short(tmp_path: Path) -> None:
    (tmp_path / "a.dump").write_text(f"ITEM: NUMBER OF ATOMS\n{'9' * 4000}\nITEM: ATOMS x y z radius\n")
    with pytest.raises(BadFileError, match=r"line 2: the number of atoms is '9+'\.\.\.; expected an integer"):
        read(tmp_path / "a.dump", Tube(1.0))
