"""Dumps of LAMMPS and LIGGGHTS, whole and broken."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from bedrad import BadFileError, Plate, Rod, Tube, read
from bedrad.packings.files import read_frames

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
    assert dict(packing.provenance) == {"file": "plain.dump", "format": "LAMMPS dump", "frame": 2, "timestep": 80}


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
        ("ITEM: UNITS\nreal\n" + SMALL, "line 2: the units are 'real'; expected one of si, cgs, micro, nano"),
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
