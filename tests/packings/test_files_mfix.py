"""Particle files of MFiX, whole and broken."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from bedrad import BadFileError, Tube, read
from bedrad.packings.files import FORMATS
from bedrad.packings.files.mfix_input import looks_like_mfix, read_mfix
from packings.file_mutations import mutated, takes_or_refuses

DATA = Path(__file__).parents[1] / "data" / "mfix"
TUBE = Tube(0.002)

# what the samples hold: four spheres in a ring beside the wall, and two above [mm]
RING = [(1.5, 0.0, 0.5, 0.5), (0.0, 1.5, 0.5, 0.5), (-1.5, 0.0, 0.5, 0.5), (0.0, -1.5, 0.5, 0.5)]
ABOVE = [(1.125, 1.125, 1.25, 0.375), (-1.0, -1.0, 1.5, 0.5)]

OPTIONS = ["Phase_ID: T", "Diameter: T", "Density: F 2500", "Velocity: F 0 0 0", "Temperature: F 300"]
FULL = [*OPTIONS, "Species: F 1", "User_Scalar: F 0"]


def text_of(options: list[str], rows: list[str], count: object = None, dimension: object = 3) -> str:
    bar = "=" * 20
    head = ["Version 2.0", bar, *(f"instruction {k}" for k in range(15)), bar]
    head += [f"Dimension: {dimension}", f"Particles: {len(rows) if count is None else count}", bar, "Variable", bar]
    head += ["Coordinates: T", *options, bar, "| x |", bar]
    return "\n".join([*head, *rows]) + "\n"


SMALL = text_of(FULL, ["0 0 2 1 1.0", "0 0 -1 2 0.5"])


def put(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "particle_input.dat"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("sample", "wanted", "version"),
    [
        ("particle_output.dat", [*RING, *ABOVE], "2.0"),
        ("uniform.dat", RING, "2.0"),
        ("version_1.dat", [*RING, *ABOVE], "1.0"),
    ],
)
def test_samples_of_every_form(sample: str, wanted: list[tuple[float, ...]], version: str) -> None:
    packing = read(DATA / sample, TUBE)
    got = np.column_stack([packing.centers, packing.radii])
    np.testing.assert_allclose(got, 1e-3 * np.array(wanted), rtol=1e-14, atol=1e-19)
    assert packing.period is None
    assert packing.provenance["format"] == f"MFiX particles, version {version}"
    assert packing.provenance["length_unit"] == "m, assumed"
    assert read(DATA / sample, Tube(2e-5), unit="cm").radii[0] == pytest.approx(5e-6)


def test_a_packed_file(tmp_path: Path) -> None:
    path = tmp_path / "particle_output.dat.gz"
    path.write_bytes(gzip.compress((DATA / "particle_output.dat").read_bytes()))
    assert len(read(path, TUBE)) == 6
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(BadFileError, match=r"\.dat\.gz: broken or cut-off gzip file"):
        read(path, TUBE)


@pytest.mark.parametrize(
    ("options", "row", "diameter"),
    [
        (["Phase_ID: T", "Diameter: T", "Density: T", "Velocity: T"], "0 0 2 1 0.5 2500 0 0 -1", 0.5),
        (["Phase_ID: F 1", "Diameter: T", "Density: T", "Velocity: F 0 0 0"], "0 0 2 0.5 2500", 0.5),
        (["phase_id T", "DIAMETER: F 0.25", "Density: F 2500", "Velocity: t"], "0 0 2 1 0 0 -1", 0.25),
        (["Phase_ID: F 1", "Diameter: F 2.5E-01", "Density: F 1", "Velocity: F 0 0 0"], "0 0 2", 0.25),
    ],
)
@pytest.mark.parametrize("more", ["", " 300", " 300 0.5 0.5 7"])
def test_columns_follow_the_options(tmp_path: Path, options: list[str], row: str, diameter: float, more: str) -> None:
    # temperature, species and scalars may be there if their options are T, and are not if they are F
    last = ["Temperature: T", "Species: T (unless ...)", "User_Scalar: T"] if more else FULL[-3:]
    held = read_mfix(put(tmp_path, text_of([*options, *last], [row + more] * 2)))
    assert held.centers.tolist() == [[0.0, 0.0, 2.0]] * 2
    assert held.radii is not None
    assert held.radii.tolist() == [diameter / 2] * 2


def test_as_many_rows_are_read_as_the_header_says(tmp_path: Path) -> None:
    text = text_of(FULL, ["0 0 2 1 1.0", "0 0 -1 2 0.5", "what follows is not read"], count=2)
    held = read_mfix(put(tmp_path, text))
    assert held.centers[:, 2].tolist() == [2.0, -1.0]
    assert held.lines.tolist() == [35, 36]


def test_blank_lines_of_the_header_do_not_count(tmp_path: Path) -> None:
    held = read_mfix(put(tmp_path, SMALL.replace("Dimension", "\n\nDimension")))
    assert held.lines.tolist() == [37, 38]


def test_blank_lines_of_version_1_do_not_count(tmp_path: Path) -> None:
    row = "0 0 2 0.5 2500 0 0 0\n"
    assert len(read(put(tmp_path, row + "\n \n"), Tube(1.0))) == 1
    assert read_mfix(put(tmp_path, row + "\n" + row)).lines.tolist() == [1, 3]


def broken(old: str, new: str) -> str:
    assert SMALL.count(old) == 1
    return SMALL.replace(old, new)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (broken("Version 2.0", "Version 4.0"), r"line 1: the version is '4\.0'; the versions that are read are 2\.0"),
        (broken("Dimension: 3", "Dimension: 2"), "line 19: the dimension is 2; only files of spheres in space"),
        (broken("Dimension: 3", "Dimension: three"), "line 19: Dimension is 'three'; expected an integer"),
        (broken("Particles: 2", "Particles:"), "line 20: Particles is ''; expected an integer"),
        (broken("Particles: 2", "Particles: -2"), "line 20: Particles is '-2'; expected an integer"),
        (broken("Particles: 2", "Particles: 3"), "cut off: 3 rows expected, 2 found, the file ends after line 36"),
        (broken("Particles: 2", "Particles: 999999999999"), "cut off: 999999999999 rows expected, 2 found"),
        (broken("instruction 7\n", ""), "line 19: expected the line 'Dimension', found 'Particles: 2'"),
        (broken("Coordinates: T", "Coordinates: F"), "line 24: Coordinates is 'F'; expected T$"),
        (broken("Diameter: T", "Diameter: yes"), "line 26: Diameter is 'yes'; expected T or F"),
        (broken("Diameter: T", "Diameter:"), "line 26: Diameter is ''; expected T or F"),
        (broken("Diameter: T", "Diameter: F"), "line 26: Diameter is F, and no value follows"),
        (broken("Diameter: T", "Diameter: F wide"), "line 26: the diameter is 'wide'; expected a number"),
        (
            broken("Diameter: T", "Diameter: F 0"),
            r"line 26: the diameter of all particles is 0\.0; expected a positive",
        ),
        (broken("Diameter: T\n", ""), "line 26: expected the line 'Diameter', found 'Density: F 2500'"),
        (broken("Velocity: F 0 0 0", "Velocity: T"), "line 35: 5 fields; expected 8 by the options of the header"),
        (
            broken("Species: F 1", "Species: T").replace(" 0.5\n", " 0.5 1\n"),
            "line 36: 6 fields; expected 5 as in the first row",
        ),
        (
            broken("Species: F 1", "Species: T").replace(" 2 0.5\n", "\n"),
            "line 36: 3 fields; expected 5 as in the first row",
        ),
        (broken("0 0 2 1 1.0", "0 0 2"), "line 35: 3 fields; expected 5 by the options of the header"),
        (broken("0 0 2 1 1.0", "0 0 2 1 1.0 7"), "line 35: 6 fields; expected 5 by the options of the header"),
        (broken("0 0 2 1 1.0", "0 0 x 1 1.0"), "line 35: z is 'x'; expected a number"),
        (broken("0 0 2 1 1.0", "0 0 2 1 inf"), "line 35: diameter is 'inf'; expected a finite number"),
        (broken("0 0 2 1 1.0", "0 0 2 1 -1"), r"sphere 0: radius -0\.5 m.* \(line 35\)"),
        (broken("0 0 2 1 1.0", "0 0 -1 1 1.0"), r"spheres 0 and 1.* one point.* \(line 35 and line 36\)"),
        (SMALL[: SMALL.index("Density")], "cut off after line 26; expected the line 'Density'"),
        (SMALL[: SMALL.index("instruction 9")], "cut off after line 11; expected the instructions"),
        ("1 2 3 4 5 6 7\n" * 3, r"line 1: 7 fields; a file of MFiX begins with 'Version 2\.0', or has rows x y z"),
        ("\n\n", "an empty file"),
    ],
)
def test_broken_files_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    path = put(tmp_path, text)
    with pytest.raises(BadFileError, match=rf"particle_input\.dat[:,] {message}"):
        # the table of points would take the last but one; here it is asked what this reader says
        read(path, Tube(1.0)) if text.startswith("Version") else read_mfix(path)


@pytest.mark.parametrize("sample", ["particle_output.dat", "uniform.dat", "version_1.dat"])
def test_each_sample_is_told_by_its_content(sample: str) -> None:
    head = (DATA / sample).read_bytes()[:8192]
    assert next(form.name for form in FORMATS if form.recognises(head)) == "MFiX particles"


@pytest.mark.parametrize(
    "head",
    [
        b"",
        b"Version two\n",
        b"# Version 2.0\n",
        b"1 2 3 4\n",
        # eight columns that can be no radius and density: velocities, or a radius and a type
        b"0 0 2 0.5 0 0 -1 1\n0 0 1 0.5 0 0 -1 1\n",
        b"0 0 2 0.5 1 0 0 0\n",
        b"0 0 2 -0.5 2500 0 0 0\n",
    ],
)
def test_what_is_not_of_mfix(head: bytes) -> None:
    assert not looks_like_mfix(head)


@given(mutated([SMALL.encode(), b"0 0 2 0.5 2500 0 0 0\n0 0 -1 0.5 2500 0 0 0\n"]))
def test_damaged_files_are_taken_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    takes_or_refuses(tmp_path_factory.getbasetemp() / "damaged.dat", data)
