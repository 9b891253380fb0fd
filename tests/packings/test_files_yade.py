"""Texts of YADE's export module: files that YADE wrote, what their six digits mean, and every refusal with its line."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from bedrad import BadFileError, Packing, Rod, Tube, read, write
from packings.file_mutations import mutated, takes_or_refuses

DATA = Path(__file__).parents[1] / "data" / "yade"
TUBE = Tube(0.002)
"""The tube that the spheres of the samples keep 1e-5 m away from."""

RADII = [0.0003 if k % 4 else 0.0002 for k in range(12)]
FORMATS = ("text", "x_y_z_r", "x_y_z_r_matId", "id_x_y_z_r_matId", "x_y_z_r_attrs")
HEAD = "#format x_y_z_r\n"


def put(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "bed.txt"
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", FORMATS)
def test_what_yade_wrote(name: str) -> None:
    packing = read(DATA / f"{name}.txt", TUBE)
    turn = np.array([math.tau * k / 6 + (k // 6) * math.pi / 6 for k in range(12)])
    out = 0.002 - np.array(RADII) - 1e-5
    assert packing.radii.tolist() == RADII
    np.testing.assert_allclose(packing.centers[:, 0], out * np.cos(turn), rtol=5e-6, atol=1e-18)
    np.testing.assert_allclose(packing.centers[:, 1], out * np.sin(turn), rtol=5e-6, atol=1e-18)
    # the heights are random: all forms of the same bed agree
    assert packing.centers.tolist() == read(DATA / "text.txt", TUBE).centers.tolist()
    assert packing.provenance["format"] == "YADE text"
    assert packing.provenance["position_digits"] == 6


def test_members_of_clumps() -> None:
    packing = read(DATA / "clumps.txt", TUBE, max_overlap=1.0)
    assert packing.centers.tolist() == [[0, 0, 0.0031], [0, 0.0004, 0.0031]]
    assert packing.radii.tolist() == [0.0003, 0.0003]


def test_a_unit_can_be_said() -> None:
    packing = read(DATA / "text.txt", Tube(0.002e-3), unit="mm")
    np.testing.assert_allclose(packing.radii, np.array(RADII) * 1e-3, rtol=1e-15)


@pytest.mark.parametrize("shift", [0.0, 3.0, 400.0])
def test_six_digits_leave_gaps_open_by_what_the_provenance_says(tmp_path: Path, shift: float) -> None:
    # pairs of spheres in contact, in every direction: their gap is 0 but for the rounding of what is written
    rng = np.random.default_rng(11)
    radii = 0.5 + 0.5 * rng.random((300, 2))
    way = rng.normal(size=(300, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    place = np.arange(300)
    first = np.stack([6.0 * (place % 20), 6.0 * (place // 20), np.full(300, shift)], axis=1)
    second = first + way * radii.sum(axis=1, keepdims=True)
    rows = np.concatenate([np.c_[first, radii[:, 0]], np.c_[second, radii[:, 1]]])
    text = HEAD + "".join("\t".join(f"{value:g}" for value in row) + "\n" for row in rows)
    packing = read(put(tmp_path, text), Tube(1e4))
    a, b = packing.centers[:300], packing.centers[300:]
    gaps = np.linalg.norm(a - b, axis=1) - packing.radii[:300] - packing.radii[300:]
    bound = packing.provenance["gap_rounding_radii"] * packing.radii.mean()
    assert packing.provenance["position_digits"] == 6
    assert np.abs(gaps).max() <= bound
    # and the bound is not idle: it is no more than ten times what happens
    assert np.abs(gaps).max() >= bound / 10


def test_full_digits_say_nothing_of_rounding(tmp_path: Path) -> None:
    packing = read(put(tmp_path, f"{HEAD}{1 / 3!r}\t0\t0\t1\n"), Tube(2.0))
    assert "position_digits" not in packing.provenance
    eight = read(put(tmp_path, f"{HEAD}{1 / 3:.8g}\t0\t0\t1\n"), Tube(2.0))
    assert eight.provenance["position_digits"] == 8


def test_facts_in_comments_and_spaces_for_tabs(tmp_path: Path) -> None:
    text = "\n\ufeff".lstrip("\n") + HEAD + "# by hand\n# wall: rod radius=0.02 m\n\n 0.03 0  0 0.001 \n# the end\n"
    packing = read(put(tmp_path, text))
    assert packing.wall == Rod(0.02)
    assert packing.radii.tolist() == [0.001]


def test_without_a_format_the_suffix_tells(tmp_path: Path) -> None:
    path = tmp_path / "a.spheres"
    path.write_text("0 0 0 0.001\n0 0 0.01 0.002\n")
    assert read(path, TUBE, max_overlap=1.0).radii.tolist() == [0.001, 0.002]


def test_the_written_text(tmp_path: Path) -> None:
    write(Packing([[0.1, 0.2, 1 / 3]], 0.05, Tube(1.0), 2.0, {"seed": 3}), tmp_path / "a.yade")
    assert (tmp_path / "a.yade").read_text() == (
        "#format x_y_z_r\n"
        "# wall: tube radius=1.0 m\n"
        "# period: 2.0 m\n"
        "# max_overlap: 0.1\n"
        '# provenance: {"seed": 3}\n'
        "0.1\t0.2\t0.3333333333333333\t0.05\n"
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + "0 0 0 0.001\n0 nan 0 0.001\n", r"line 3: y is 'nan'; expected a finite number"),
        (HEAD + "0 0 1e999 0.001\n", r"line 2: z is '1e999'; expected a finite number"),
        (HEAD + "# a\n\n0 0 0 O.001\n", r"line 4: radius is 'O\.001'; expected a number"),
        (HEAD + "0 0 0 0.001\n0 0 0\n", r"line 3: 3 fields; the format 'x_y_z_r' has 4"),
        (HEAD + "0 0 0 0.001 3\n", r"line 2: 5 fields; the format 'x_y_z_r' has 4"),
        (HEAD + "0,0,0,0.001\n", r"line 2: 1 fields; the format 'x_y_z_r' has 4"),
        ("#format x_y_z_r_attrs\n0 0 0 .001 1 2\n0 0 1 .001 1\n", r"line 3: 5 fields; the first row, line 2, has 6"),
        ("#format x_y_z_r_attrs\n0 0 0\n", r"line 2: 3 fields; the format 'x_y_z_r_attrs' has at least 4"),
        ("#format id_x_y_z_r\n1 0 0 0 .001\n1.5 0 0 1 .001\n", r"line 3: id is 1\.5; expected an integer"),
        ("#format id_x_y_z_r\n7 0 0 0 .001\n7 0 0 1 .001\n", r"lines 2 and 3: both have the id 7"),
        ("#format x1_y1_z1_x2_y2_z2\n0 0 0 1 1 1\n", r"line 1: the format 'x1_y1_z1_x2_y2_z2' has no x, y, z, r; exp"),
        ("#format jointedPM\n0\n", r"line 1: the format 'jointedPM' has no x, y, z, r"),
        ("#format\n0 0 0 1\n", r"line 1: the format '' has no x, y, z, r"),
        ("#format x_y_z\n", r"line 1: the format 'x_y_z' has no r"),
        (HEAD + HEAD, r"line 2: a second format; line 1 names one"),
        (HEAD + "0 0 0 0.001\n" + HEAD, r"line 3: a second format; line 1 names one"),
        (HEAD + "0 0 0 0.001\n0 0 0.1 -0.001\n", r"sphere 1: radius -0\.001 m.*\(line 3\)"),
        (
            "#format id_x_y_z_r\n7 0 0 0 .001\n3 0 0 1e-5 .001\n",
            r"spheres 0 and 1.* overlap by .* \(line 3, id 3 and line 2, id 7\)",
        ),
        (HEAD + "# wall: tube\n", r"line 2: wall 'tube' is not understood"),
        (HEAD + f"# provenance: {'[' * 100_000}\n", r"line 2: provenance .* is not understood"),
    ],
)
def test_refusals_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.txt[:,] {message}"):
        read(put(tmp_path, text), Tube(0.01))


def test_a_line_without_end_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match=r"bed\.txt, line 2: longer than \d+ bytes"):
        read(put(tmp_path, HEAD + "0" * 3_000_000), TUBE)


def test_a_frame_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match="frame 1 was asked for; a YADE text file holds one packing"):
        read(put(tmp_path, HEAD + "0 0 0 0.001\n"), TUBE, frame=1)


@given(mutated([(DATA / f"{name}.txt").read_bytes() for name in FORMATS]))
def test_damaged_files_are_taken_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    takes_or_refuses(tmp_path_factory.getbasetemp() / "damaged.spheres", data)
