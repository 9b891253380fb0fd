"""Extended xyz of OVITO, ASE and spheropack, plain xyz, and every refusal with its line."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from bedrad import BadFileError, Packing, Plate, Rod, Tube, read, write
from bedrad.packings.files import read_frames
from packings.file_mutations import mutated, takes_or_refuses

DATA = Path(__file__).parents[1] / "data" / "extended_xyz"
TUBE = Tube(2.1)
SAMPLES = ("ase.xyz", "ovito.xyz", "plain.xyz", "spheropack.xyz")
KEYS = "Properties=species:S:1:pos:R:3:radius:R:1"
SMALL = f'2\n{KEYS} Lattice="2 0 0 0 3 0 0 0 4" pbc="F F T"\nX 0 0 1 0.5\nX 0 0 3 0.25\n'


def put(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "bed.xyz"
    path.write_text(text)
    return path


def with_keys(keys: str) -> str:
    return f"1\n{keys}\nX 0 0 1 0.5\n"


@pytest.mark.parametrize("name", ["ase.xyz", "ovito.xyz"])
@pytest.mark.parametrize("frame", [0, 1, -1, -2])
def test_frames_of_ase_and_of_ovito(name: str, frame: int) -> None:
    packing = read(DATA / name, TUBE, frame=frame)
    turn = 2 * np.pi * np.arange(6) / 6 + 0.1 * (frame % 2)
    wanted = np.stack([1.5 * np.cos(turn), 1.5 * np.sin(turn), 0.5 + 0.1 * np.arange(6)], axis=1)
    # both print eight decimals or fewer
    np.testing.assert_allclose(packing.centers, wanted, atol=5.1e-9)
    assert packing.radii.tolist() == [0.5, 0.4] * 3
    assert packing.period == 3.0
    assert packing.provenance["frame"] == frame % 2
    assert packing.provenance["position_digits"] == 9


def test_frames_come_one_after_the_other() -> None:
    packings = list(read_frames(DATA / "ase.xyz", TUBE))
    assert [packing.provenance["frame"] for packing in packings] == [0, 1]
    for index, packing in enumerate(packings):
        assert packing.centers.tolist() == read(DATA / "ase.xyz", TUBE, frame=index).centers.tolist()


def test_spheropack_agrees_with_its_own_npz() -> None:
    # a tube of diameter 5 around x = y = 2.5
    packing = read(DATA / "spheropack.xyz", Tube(2.5), origin=(2.5, 2.5, 0.0))
    other = read(DATA.parent / "npz" / "cylinder.npz", Tube(2.5))
    assert packing.centers.tobytes() == other.centers.tobytes()
    assert packing.radii.tobytes() == other.radii.tobytes()
    assert packing.period == other.period == 6.0


def test_plain_xyz_holds_positions_only() -> None:
    packing = read(DATA / "plain.xyz", TUBE, diameter=0.8)
    np.testing.assert_allclose(packing.centers, read(DATA / "ase.xyz", TUBE, frame=0).centers, atol=5.1e-9)
    assert packing.radii.tolist() == [0.4] * 6
    assert packing.period is None
    with pytest.raises(BadFileError, match=r"plain\.xyz: no column radius or diameter; give the diameter"):
        read(DATA / "plain.xyz", TUBE)


def test_plain_xyz_with_more_columns_and_any_comment(tmp_path: Path) -> None:
    path = put(tmp_path, '2\nan open "quote, a = sign and {\nFe 0 0 1 7 8\nHe 0 0 2 9 1\n')
    assert read(path, TUBE, diameter=1.0).centers[:, 2].tolist() == [1.0, 2.0]


@pytest.mark.parametrize(
    ("keys", "wall", "period"),
    [
        ('Lattice="2 0 0 0 3 0 0 0 4"', TUBE, 4.0),
        ("pbc=[T, T, F] Lattice={2 0 0 0 3 0 0 0 4}", TUBE, None),
        ("Lattice='2 0 0 0 3 0 0 0 4' pbc='T T F'", Plate(), (2.0, 3.0)),
        ('Lattice="2,0,0,0,3,0,0,0,4" pbc="1 0 1"', Plate(), None),
        ('Lattice="2 3 4" pbc="False False True"', Rod(0.1), 4.0),
        ('Lattice="2 0 0 0 0 0 0 0 4" pbc="T F T"', TUBE, 4.0),
        ('Lattice="2 0 1e-15 0 3 0 0 0 4"', TUBE, 4.0),
        ('pbc="T T T"', TUBE, None),
    ],
)
def test_the_box_gives_the_period(tmp_path: Path, keys: str, wall: object, period: object) -> None:
    packing = read(put(tmp_path, f"0\n{KEYS} {keys}\n"), wall)  # type: ignore[arg-type]
    assert packing.period == period


@pytest.mark.parametrize(
    ("properties", "row", "radius"),
    [
        ("pos:R:3:radius:R:1", "0 0 1 0.5", 0.5),
        ("id:I:1:Radius:R:1:velo:R:3:Position:R:3:species:S:1", "4 0.5 nan x 1 0 0 1 any", 0.5),
        ("pos:R:3:diameter:R:1", "0 0 1 0.5", 0.25),
        ("pos:R:3:diameter:R:1:radius:R:1", "0 0 1 9 0.5", 0.5),
        ("pos:I:3:radii:I:1", "0 0 1 1", 1.0),
    ],
)
def test_columns_in_any_order(tmp_path: Path, properties: str, row: str, radius: float) -> None:
    packing = read(put(tmp_path, f"1\nProperties={properties}\n{row}\n"), TUBE)
    assert packing.centers.tolist() == [[0.0, 0.0, 1.0]]
    assert packing.radii.tolist() == [radius]


def test_ids_give_the_order(tmp_path: Path) -> None:
    path = put(tmp_path, "2\nProperties=id:I:1:pos:R:3:radius:R:1\n9 0 0 2 0.5\n4 0 0 1 0.25\n")
    assert read(path, TUBE).radii.tolist() == [0.25, 0.5]


def test_what_is_written_is_for_others_too(tmp_path: Path) -> None:
    write(Packing([[0.1, 0.2, 0.3]], 0.05, Tube(1.0), 2.0, {"of": "a 'bed'"}), tmp_path / "a.xyz")
    count, comment, row = (tmp_path / "a.xyz").read_text().splitlines()
    assert (count, row) == ("1", "X 0.1 0.2 0.3 0.05")
    assert comment == (
        f'{KEYS} Lattice="2.0 0.0 0.0 0.0 2.0 0.0 0.0 0.0 2.0" Origin="-1.0 -1.0 0.0" pbc="F F T" '
        'bedrad_wall="tube radius=1.0 m" bedrad_period="2.0 m" bedrad_max_overlap="0.1" '
        r"""bedrad_provenance="{'of': 'a \u0027bed\u0027'}" """.rstrip()
    )
    # with the quotes turned back, the provenance is JSON
    assert json.loads(comment.split('"')[-2].replace("'", '"')) == {"of": "a 'bed'"}


def test_an_earlier_frame_needs_no_whole_end(tmp_path: Path) -> None:
    path = put(tmp_path, SMALL + "\n" + SMALL[:-13])
    assert len(read(path, TUBE, frame=0)) == 2
    with pytest.raises(BadFileError, match=r"frame 1 is cut off: 2 rows expected, 1 found.*; 1 whole frames come"):
        read(path, TUBE)


def broken(old: str, new: str) -> str:
    assert SMALL.count(old) == 1
    return SMALL.replace(old, new)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (broken("X 0 0 3 0.25\n", ""), "frame 0 is cut off: 2 rows expected, 1 found, the file ends after line 3"),
        (broken("2\nProp", "1000000000000\nProp"), "frame 0 is cut off: 1000000000000 rows expected, 2 found"),
        (broken("2\nProp", "1\nProp"), "line 4: expected the number of spheres of frame 1, found 'X 0 0 3 0.25'"),
        (broken("2\nProp", "-2\nProp"), "line 1: expected the number of spheres of frame 0, found '-2'"),
        (broken("2\nProp", "two\nProp"), "line 1: expected the number of spheres of frame 0, found 'two'"),
        ("7\n", "cut off after line 1; expected the comment of frame 0"),
        ("\n\n", "no frame in the whole file; expected the number of spheres first"),
        (broken("X 0 0 3 0.25\n", "X 0 0 3\n"), "line 4: 4 fields; a row of frame 0 has 5"),
        (broken("X 0 0 3 0.25\n", "X 0 0 3 0.25 1\n"), "line 4: 6 fields; a row of frame 0 has 5"),
        (broken("X 0 0 3", "X 0 nan 3"), "line 4: y is 'nan'; expected a finite number"),
        (broken("X 0 0 3", "X 0 0 E3"), "line 4: z is 'E3'; expected a number"),
        (broken("0.25", "-0.25"), r"sphere 1: radius -0\.25 m.* \(line 4\)"),
        (broken("X 0 0 3", "X 0 0 1"), r"spheres 0 and 1.* one point.* \(line 3 and line 4\)"),
        ("1\nno keys\n0 0 1\n", "line 3: 3 fields; a row of frame 0 has at least 4"),
        (with_keys("Properties=pos:R:3:radius:R"), "line 2: Properties='pos:R:3:radius:R'; expected a name, a type"),
        (
            with_keys("Properties=pos:R:3:radius:F:1"),
            "line 2: property 'radius' has the type 'F'; expected S, R, I or L",
        ),
        (with_keys("Properties=pos:R:x"), "line 2: property 'pos' has 'x' columns; expected 1 to"),
        (with_keys("Properties=pos:R:3:f:R:99999999999"), "line 2: property 'f' has '99999999999' columns"),
        (with_keys("Properties=pos:R:2"), "line 2: property 'pos' is R:2; expected R:3"),
        (with_keys("Properties=pos:R:3:radius:S:1"), "line 2: property 'radius' is S:1; expected R:1"),
        (with_keys("Properties=pos:R:3:Pos:R:3"), "line 2: property 'Pos' comes twice"),
        (with_keys("Properties=species:S:1:radius:R:1"), "line 2: Properties='species:S:1:radius:R:1' has no pos:R:3"),
        (with_keys(KEYS + ' Lattice="2 0 0 0 3 0 0 0"'), "line 2: Lattice has 8 numbers; expected 9"),
        (with_keys(KEYS + ' Lattice="2 0 0 0 3 0 0 0 a"'), "line 2: Lattice is 'a'; expected a number"),
        (
            with_keys(KEYS + ' Lattice="2 0 0 1 3 0 0 0 4"'),
            "line 2: the box of Lattice '2 0 0 1 3 0 0 0 4' is triclinic",
        ),
        (with_keys(KEYS + ' Lattice="2 3 0" '), r"line 2: the box is periodic along z and 0\.0 long"),
        (with_keys(KEYS + ' Lattice="2 3 4" pbc="T T"'), "line 2: pbc is 'T T'; expected three of T and F"),
        (with_keys(KEYS + ' Lattice="2 3 4'), "line 2: the value of 'Lattice' begins with \" and does not end"),
        (with_keys(KEYS + ' bedrad_wall="tube"'), "line 2: wall 'tube' is not understood"),
        (with_keys(KEYS + ' bedrad_provenance="[1]"'), r"line 2: provenance '\[1\]' is not understood"),
        (with_keys(KEYS + " " + "a={" * 300_000), "line 2: the value of 'a' begins with { and does not end"),
    ],
)
def test_refusals_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.xyz[:,] {message}"):
        read(put(tmp_path, text), TUBE)


def test_two_frames_with_one_broken_row(tmp_path: Path) -> None:
    path = put(tmp_path, SMALL + broken("X 0 0 3", "X 0 0 much"))
    with pytest.raises(BadFileError, match=r"line 8: z is 'much'"):
        list(read_frames(path, TUBE))


@pytest.mark.parametrize("frame", [1, 7, -2])
def test_a_frame_that_is_not_there(tmp_path: Path, frame: int) -> None:
    with pytest.raises(BadFileError, match=f"frame {frame} was asked for; the file has 1, counted from 0"):
        read(put(tmp_path, SMALL), TUBE, frame=frame)


def test_a_cut_off_gzip_file(tmp_path: Path) -> None:
    path = tmp_path / "bed.xyz.gz"
    whole = gzip.compress((DATA / "spheropack.xyz").read_bytes())
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(BadFileError, match=r"bed\.xyz\.gz: broken or cut-off gzip file"):
        read(path, TUBE)


@given(mutated([(DATA / name).read_bytes() for name in SAMPLES]))
def test_damaged_files_are_taken_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    takes_or_refuses(tmp_path_factory.getbasetemp() / "damaged.xyz", data)


def test_blank_rows_are_refused_without_a_warning(tmp_path: Path) -> None:
    path = tmp_path / "a.xyz"
    path.write_text("2\n\n\n\n")
    with pytest.raises(BadFileError, match=r"a\.xyz, line 3: 0 fields; a row of frame 0 has at least 4"):
        read(path, Tube(1.0))
