"""Data files of LAMMPS: written by it and for it, styles named or not, every refusal with its line."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from bedrad import BadFileError, Packing, Plate, Rod, Tube, read, write
from bedrad.packings.files.lammps_data import looks_like_lammps_data
from bedrad.packings.lammps import run_lammps
from packings.file_mutations import mutated, takes_or_refuses

DATA = Path(__file__).parents[1] / "data" / "lammps_data"
DUMP = DATA.parent / "lammps_dumps" / "plain.dump"
TUBE = Tube(0.002)

HEAD = """\
a title

2 atoms
1 atom types

-1 1 xlo xhi
-1 1 ylo yhi
-2 3 zlo zhi

"""
SMALL = f"""{HEAD}Atoms # sphere

9 1 0.5 2500 0 0 2
4 1 0.25 2500 0 0 -1

Velocities

9 0 0 0 0 0 0
4 0 0 0 0 0 0
"""


def put(tmp_path: Path, text: str, name: str = "bed.data") -> Path:
    path = tmp_path / name
    path.write_text(text)
    return path


def broken(old: str, new: str) -> str:
    assert SMALL.count(old) == 1, SMALL.count(old)
    return SMALL.replace(old, new)


def test_what_lammps_wrote_is_what_it_dumped() -> None:
    # the last frame of the dump and the data file are of the same step of the same run
    packing, dump = read(DATA / "written.data", TUBE), read(DUMP, TUBE, period=0)
    np.testing.assert_allclose(packing.centers, dump.centers, rtol=1e-15)
    np.testing.assert_allclose(packing.radii, dump.radii, rtol=1e-15)
    assert packing.period is None
    assert read(DATA / "written.data", TUBE, period=0.004).period == 0.004
    # its title names the units
    with pytest.raises(ValueError, match=r"the unit 'mm' was given, but .*written\.data states the unit"):
        read(DATA / "written.data", TUBE, unit="mm")


def test_spheropack_agrees_with_its_own_npz() -> None:
    packing = read(DATA / "spheropack.data", Tube(2.5), origin=(2.5, 2.5, 0.0), period=6.0)
    other = read(DATA.parent / "npz" / "cylinder.npz", Tube(2.5))
    assert packing.centers.tobytes() == other.centers.tobytes()
    assert packing.radii.tobytes() == other.radii.tobytes()


def test_yade_writes_radii_for_diameters() -> None:
    packing = read(DATA / "yade_liggghts_in.data", TUBE)
    other = read(DATA.parent / "yade" / "text.txt", TUBE)
    np.testing.assert_allclose(packing.centers, other.centers, rtol=1e-15)
    assert packing.radii.tolist() == other.radii.tolist()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Atoms # sphere", "Atoms"),
        ("Atoms # sphere", "Atoms #granular"),
        ("0 0 2\n", "0 0 2 # a comment\n"),
        ("9 1 0.5 2500 0 0 2\n4 1 0.25 2500 0 0 -1\n", "9 1 .5 2500 0 0 2 0 0 0\n4 1 .25 2500 0 0 -1 1 0 7\n"),
        ("9 1 0.5 2500 0 0 2\n4 1 0.25 2500 0 0 -1\n", "4 1 .25 2500 0 0 -1\n9 1 .5 2500 0 0 2"),
        ("2 atoms", "  2   atoms  # of them"),
        ("-2 3 zlo zhi", "-2 3 zlo zhi\n0.0 0 0 xy xz yz"),
        ("Atoms # sphere", "Masses\n\n1 2.5\n\nPair Coeffs # gran/hooke\n\n1 7 8 9\n\nAtoms # sphere"),
        ("a title", ""),
        ("a title", "\ufeffLAMMPS data file, units = lj"),
    ],
)
def test_forms_of_the_same_file(tmp_path: Path, old: str, new: str) -> None:
    packing = read(put(tmp_path, broken(old, new)), Tube(1.0))
    # in the order of the ids
    assert packing.centers.tolist() == [[0, 0, -1], [0, 0, 2]]
    assert packing.radii.tolist() == [0.125, 0.25]


def test_molecules_of_bpm(tmp_path: Path) -> None:
    text = HEAD + "Atoms # bpm/sphere\n\n9 1 1 0.5 2500 0 0 2\n4 1 1 0.25 2500 0 0 -1\n"
    assert read(put(tmp_path, text), Tube(1.0)).radii.tolist() == [0.125, 0.25]


@pytest.mark.parametrize(("units", "metre"), [("si", 1.0), ("cgs", 1e-2), ("micro", 1e-6), ("nano", 1e-9)])
def test_units_that_the_title_names(tmp_path: Path, units: str, metre: float) -> None:
    text = broken("a title", f"LAMMPS data file via write_data, version 1, timestep = 80, units = {units}")
    packing = read(put(tmp_path, text), Tube(1.0))
    np.testing.assert_allclose(packing.radii, [0.125 * metre, 0.25 * metre], rtol=1e-15)
    np.testing.assert_allclose(packing.centers[:, 2], [-metre, 2 * metre], rtol=1e-15)
    assert "length_unit" not in packing.provenance


def test_no_atoms(tmp_path: Path) -> None:
    assert len(read(put(tmp_path, HEAD.replace("2 atoms", "0 atoms")), TUBE)) == 0
    assert len(read(put(tmp_path, HEAD.replace("2 atoms", "0 atoms") + "Atoms # sphere\n\n"), TUBE)) == 0


def test_gzip_and_frames(tmp_path: Path) -> None:
    path = tmp_path / "bed.data.gz"
    path.write_bytes(gzip.compress(SMALL.encode()))
    assert len(read(path, Tube(1.0))) == 2
    with pytest.raises(BadFileError, match="frame 1 was asked for; a LAMMPS data file holds one packing"):
        read(path, Tube(1.0), frame=1)


def test_the_written_text(tmp_path: Path) -> None:
    write(Packing([[0.1, 0.2, 1 / 3]], 0.05, Tube(1.0), 2.0, {"density_kg_per_m3": 3800}), tmp_path / "a.lmp")
    title, *lines = (tmp_path / "a.lmp").read_text().splitlines()
    assert title.startswith("LAMMPS data file written by bedrad ")
    assert title.endswith(", units = si")
    assert lines == [
        "",
        "# density: 3800.0 kg/m^3, from the provenance",
        "# wall: tube radius=1.0 m",
        "# period: 2.0 m",
        "# max_overlap: 0.1",
        '# provenance: {"density_kg_per_m3": 3800}',
        "",
        "1 atoms",
        "1 atom types",
        "",
        "-1.0 1.0 xlo xhi",
        "-1.0 1.0 ylo yhi",
        "0.0 2.0 zlo zhi",
        "",
        "Atoms # sphere",
        "",
        "1 1 0.1 3800.0 0.1 0.2 0.3333333333333333",
    ]


def test_no_line_is_too_long_for_liggghts(tmp_path: Path) -> None:
    notes = {"spaces": " " * 999, "backslashes": "\\" * 999, "both": "\\ " * 500, "n": "\n" * 300}
    bed = Packing([[0.1, 0.2, 0.3]], 0.05, Tube(1.0), None, notes)
    write(bed, tmp_path / "a.lmp")
    lengths = [len(line) for line in (tmp_path / "a.lmp").read_text().splitlines()]
    assert max(lengths) == 200
    assert dict(read(tmp_path / "a.lmp").provenance) == notes


def test_the_density_that_lammps_needs(tmp_path: Path) -> None:
    write(Packing([[0.1, 0.2, 0.3]], 0.05, Tube(1.0)), tmp_path / "a.lmp")
    assert "# density: 1000.0 kg/m^3, which LAMMPS needs and the packing lacks\n" in (tmp_path / "a.lmp").read_text()
    for density in (0, -1.0, float("nan"), float("inf"), "heavy"):
        with pytest.raises(ValueError, match=r"the provenance 'density_kg_per_m3' is .*; expected a positive number"):
            write(Packing([[0.1, 0.2, 0.3]], 0.05, Tube(1.0), None, {"density_kg_per_m3": density}), tmp_path / "b.lmp")
    assert not (tmp_path / "b.lmp").exists()


@pytest.mark.dem
@pytest.mark.parametrize(
    ("bed", "boundary"),
    [
        (
            Packing([[0.4, 0.1, 1e-300], [-0.4, -0.1, 1 / 3]], [0.1, 1 / 7], Tube(0.55), 1.5, {"long": "x" * 5000}),
            "f f p",
        ),
        (Packing([[2.4, 0.1, 0.0], [-2.4, -0.1, 1 / 3]], [0.1, 1 / 7], Rod(2.1)), "f f f"),
        (Packing([[0.0, 0.0, 0.2], [0.6, 0.7, 1 / 3]], [0.1, 1 / 7], Plate(), (0.8, 0.9)), "p p f"),
        (Packing(np.empty((0, 3)), np.empty(0), Tube(0.55), 1.5), "f f p"),
    ],
    ids=["tube", "rod", "plate", "empty"],
)
def test_lammps_reads_what_is_written(tmp_path: Path, bed: Packing, boundary: str) -> None:
    write(bed, tmp_path / "a.lmp")
    run_lammps(
        f"units si\natom_style sphere\nboundary {boundary}\nread_data a.lmp\n"
        "pair_style zero 1.0\npair_coeff * *\nfix 1 all nve/sphere\n"
        "dump a all custom 1 a.dump id x y z radius mass\ndump_modify a format float %.17g\nrun 0\n",
        tmp_path,
    )
    assert "WARNING" not in (tmp_path / "log.lammps").read_text()
    rows = (tmp_path / "a.dump").read_text().split("mass\n")[1].split()
    values = np.array(rows, dtype=float).reshape(-1, 6)
    values = values[np.argsort(values[:, 0])]
    assert values[:, 1:4].tolist() == bed.centers.tolist()
    assert values[:, 4].tolist() == bed.radii.tolist()
    np.testing.assert_allclose(values[:, 5], 1000.0 * 4 / 3 * np.pi * bed.radii**3, rtol=1e-14)
    assert read(tmp_path / "a.dump", bed.wall).period == bed.period


@pytest.mark.parametrize(
    ("text", "taken"),
    [
        (SMALL, True),
        ("LAMMPS data file via write_data\n", True),
        ("LIGGGHTS Description\n\n", True),
        (SMALL.encode().decode().replace("xlo", "x"), False),
        ("2 atoms\n", False),
        ("ITEM: TIMESTEP\n0\n", False),
        ("", False),
    ],
)
def test_what_looks_like_a_data_file(text: str, taken: bool) -> None:
    assert looks_like_lammps_data(text.encode()) == taken


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (broken("4 1 0.25", "4 1 nan"), r"line 13: diameter is 'nan'; expected a finite number"),
        (broken("4 1 0.25 2500 0 0 -1", "4 1 0.25 2500 0 0 low"), r"line 13: z is 'low'; expected a number"),
        (broken("4 1 0.25", "4.5 1 0.25"), r"line 13: id is 4\.5; expected an integer"),
        (broken("4 1 0.25", "9 1 0.25"), r"lines 12 and 13: both have the id 9"),
        (broken("4 1 0.25 2500 0 0 -1", "4 1 0.25 2500 0 0"), r"line 13: 6 fields; the first row has 7"),
        (broken("4 1 0.25 2500 0 0 -1", "4 1 0.25 2500 0 0 -1 0"), r"line 13: 8 fields; the first row has 7"),
        (broken("4 1 0.25 2500 0 0 -1", ""), r"line 13: 0 fields; the first row has 7"),
        (
            broken("9 1 0.5 2500 0 0 2", "9 1 0.5 0 0 2"),
            r"line 12: 6 fields; expected 7 \(id type diameter density x y z\)",
        ),
        (broken("2 atoms", "1 atoms"), r"line 13: expected the end or a section after 1 atoms, found '4 1 0\.25"),
        (broken("2 atoms", "3 atoms"), r"line 14: 0 fields; the first row has 7"),
        (SMALL[: SMALL.index("4 1")], r"cut off: 2 rows of atoms expected, 1 found, the file ends after line 12"),
        (SMALL[: SMALL.index("9 1")].replace("2 atoms", "999999999999 atoms"), r"cut off: 999999999999 rows of atoms"),
        (broken("2 atoms", "two atoms"), r"line 3: the number of atoms is 'two'; expected 0 or more"),
        (broken("2 atoms", "-2 atoms"), r"line 3: the number of atoms is '-2'; expected 0 or more"),
        (broken("2 atoms\n", ""), r"line 9: 'Atoms' comes before the number of atoms"),
        (HEAD, r"no section 'Atoms'; the header says 2 atoms"),
        ("LAMMPS data file\n\n", r"no number of atoms, such as '100 atoms', in the whole file"),
        (broken("# sphere", "# full"), r"line 10: the atom style is 'full'; expected one of sphere, granular"),
        (
            broken("# sphere\n", "\n").replace("0.5", "1"),
            r"line 10: 'Atoms' names no style, and line 12 \(7 fields, the",
        ),
        (HEAD + "Atoms\n\n1 1 0 0 0\n2 1 0 0 1\n", r"line 10: 'Atoms' names no style, and line 12 \(5 fields"),
        (HEAD + "Atoms\n\n1 1\n2 1\n", r"line 10: 'Atoms' names no style, and line 12 \(2 fields, the third missing"),
        (broken("sphere\n\n9", "sphere\n9"), r"line 11: expected a blank line after 'Atoms'"),
        (broken("-2 3 zlo zhi", "-2 3 zlo zhi\n0 0.1 0 xy xz yz"), r"line 9: a triclinic box; only boxes with right"),
        (broken("-1 1 xlo xhi", "-1 1 xlo xhi\n1 0 0 avec"), r"line 7: a triclinic box"),
        (broken("a title", "LAMMPS data file, units = real"), r"line 1: the units are 'real'; expected one of si, cgs"),
        (broken("4 1 0.25", "4 1 -0.25"), r"sphere 0: radius -0\.125 m.* \(line 13, id 4\)"),
        (broken("a title", "a title\n# wall: tube"), r"line 2: wall 'tube' is not understood"),
        (broken("0 0 2\n", "0 0 -1.01\n"), r"spheres 0 and 1.* \(line 13, id 4 and line 12, id 9\)"),
    ],
)
def test_refusals_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    # a name that tells the format where a broken header does not
    with pytest.raises(BadFileError, match=rf"bed\.lmp[:,] {message}"):
        read(put(tmp_path, text, "bed.lmp"), Tube(1.0))


@given(mutated([(DATA / name).read_bytes() for name in ("written.data", "spheropack.data", "yade_liggghts_in.data")]))
def test_damaged_files_are_taken_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    takes_or_refuses(tmp_path_factory.getbasetemp() / "damaged.lmp", data)
