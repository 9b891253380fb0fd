"""The command that turns one packing file into another."""

from __future__ import annotations

import re

import numpy as np
import pytest

import bedrad
from bedrad.packings.files import FORMATS
from jobs.small_job import ring_bed

WRITTEN = [suffix for form in FORMATS if form.write is not None for suffix in form.suffixes]


def ring_dump(path, unit=1e-3, axis="x", frames=3):
    """Frames of a dump of the bed in another unit, with another axis, each lying a little further on."""
    packing = ring_bed()
    turn = {"z": [0, 1, 2], "x": [2, 0, 1], "y": [1, 2, 0]}[axis]
    text = ""
    for frame in range(frames):
        head = f"ITEM: TIMESTEP\n{frame}\nITEM: NUMBER OF ATOMS\n{len(packing)}\nITEM: ATOMS x y z radius\n"
        places = (packing.centers + np.array([0.0, 0.0, 1e-3 * frame]))[:, turn] / unit
        rows = zip(places.tolist(), (packing.radii / unit).tolist(), strict=True)
        text += head + "".join(f"{x!r} {y!r} {z!r} {r!r}\n" for (x, y, z), r in rows)
    path.write_text(text)
    return path


@pytest.mark.parametrize("suffix", WRITTEN)
def test_every_format_that_can_be_written_is(call, bed, tmp_path, suffix):
    before = bedrad.read(bed)
    code, out, err = call("convert", bed, tmp_path / f"new{suffix}")
    assert (code, err) == (0, [])
    assert out.splitlines()[0] == str(before)
    assert out.splitlines()[-1] == f"wrote {tmp_path / f'new{suffix}'}"
    after = bedrad.read(tmp_path / f"new{suffix}", before.wall, period=before.period)
    np.testing.assert_allclose(after.centers, before.centers, rtol=0, atol=1e-9 * before.wall.radius)
    np.testing.assert_allclose(after.radii, before.radii, rtol=1e-9)


def test_reading_options_reach_the_reader(call, tmp_path):
    dump = ring_dump(tmp_path / "bed.dump")
    wall = ring_bed().wall
    code, out, _ = call(
        "convert", dump, tmp_path / "a.h5", "--unit", "mm", "--axis", "x", "--tube", f"{2 * wall.radius} m",
        "--frame", "1", "--max-overlap", "0.2",
    )  # fmt: skip
    assert code == 0
    after = bedrad.read(tmp_path / "a.h5")
    np.testing.assert_allclose(after.centers, ring_bed().centers + np.array([0, 0, 1e-3]), atol=1e-15)
    assert (after.wall, after.max_overlap) == (wall, 0.2)
    notes = after.provenance
    assert (notes["frame"], notes["length_unit"], notes["axis_turned_to_z"]) == (1, "mm, as given", "1 0 0")
    # what is written is said
    for name, value in notes.items():
        assert re.search(rf"^  {name} +{re.escape(str(value))}$", out, re.MULTILINE)


def test_a_fitted_wall_is_told_with_its_uncertainty(call, tmp_path):
    dump = ring_dump(tmp_path / "bed.dump", unit=1.0)
    code, _, err = call("convert", dump, tmp_path / "a.h5")
    assert code == 0
    assert len(err) == 1
    assert re.fullmatch(
        r"wall: Tube\(radius=0\.0038\d+\), tube fitted by least squares .* and turned to z; residual \S+ radii; "
        r"radius ± \S+ m; axis ± \S+ m",
        err[0],
    )
    assert bedrad.read(tmp_path / "a.h5").wall.radius == pytest.approx(ring_bed().wall.radius, rel=1e-12)


def test_all_frames_are_numbered(call, tmp_path):
    dump = ring_dump(tmp_path / "bed.dump", unit=1.0, axis="z")
    code, out, err = call("convert", dump, tmp_path / "new" / "a.h5", "--all-frames", "--tube", "7.74mm")
    assert (code, err) == (0, [])
    names = [f"a_{number:04d}.h5" for number in range(3)]
    assert sorted(file.name for file in (tmp_path / "new").iterdir()) == names
    assert [line for line in out.splitlines() if line.startswith("wrote")] == [
        f"wrote {tmp_path / 'new' / name}" for name in names
    ]
    assert out.splitlines()[-1] == "3 frames"
    assert [bedrad.read(tmp_path / "new" / name).provenance["timestep"] for name in names] == [0, 1, 2]
    # and the other way round, from a pattern
    code, out, _ = call("convert", tmp_path / "new" / "a_*.h5", tmp_path / "b.csv", "--all-frames")
    assert code == 0
    assert bedrad.read(tmp_path / "b_0002.csv").provenance["timestep"] == 2


def test_what_was_finished_is_kept_when_a_later_frame_is_broken(call, tmp_path):
    dump = ring_dump(tmp_path / "bed.dump", unit=1.0, axis="z")
    dump.write_text(dump.read_text()[:-50])
    code, _, err = call("convert", dump, tmp_path / "a.h5", "--all-frames", "--tube", "7.74mm")
    assert code == 2
    assert "frame 2 is cut off" in err[-1] or "fields" in err[-1]
    assert sorted(file.name for file in tmp_path.glob("a*")) == ["a_0000.h5", "a_0001.h5"]


@pytest.mark.parametrize("more", [[], ["--all-frames"]])
def test_a_dry_run_writes_nothing(call, bed, tmp_path, more):
    code, out, err = call("convert", bed, tmp_path / "new" / "a.csv", "--dry-run", *more)
    assert (code, err) == (0, [])
    assert out.splitlines()[0] == str(bedrad.read(bed))
    assert "wrote" not in out
    assert list(tmp_path.iterdir()) == [bed]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("{bed} {new}.stl", r"new\.stl: suffix '\.stl'; packings are written as \.h5"),
        ("{bed} {new}.h5 --frame 3", r"bed\.h5: frame 3 was asked for"),
        ("{bed} {new}.h5 --frame 1 --all-frames", "--frame 1 and --all-frames: give one of them"),
        ("{bed} {new}.h5 --unit mm", r"the unit 'mm' was given, but .*bed\.h5 states the unit"),
        ("{bed} {new}.h5 --axis up", "axis is 'up'; expected 'x', 'y', 'z' or three"),
        ("{bed} {new}.h5 --axis 1,0", r"axis is \(1\.0, 0\.0\); expected"),
        ("{bed} {new}.h5 --axis 1,0,q", r"--axis '1,0,q': expected x, y, z or three numbers"),
        ("{bed} {new}.h5 --column x", "--column 'x': expected a quantity and a column"),
        ("{bed} {new}.h5 --column x=1 --column x=2", "--column 'x=2': x was given before, as '1'"),
        ("{bed} {new}.h5 --column x=1", "columns were given, but .* is a bedrad HDF5 file"),
        ("{bed} {new}.h5 --tube 1mm --fit-wall rod", "give one wall: --tube, --rod, --plate, --wall-stl or --fit-wall"),
        ("{bed} {new}.h5 --wall-stl {bed}", r"wall is '.*bed\.h5'; expected a wall, .* or an \.stl file"),
        ("{bed} {new}.h5 --wall-stl {new}.stl", r"new\.stl: cannot be read: No such file"),
        ("{bed} {new}.h5 --wall-unit mm", "the unit of the wall is 'mm', but the wall is no STL file"),
        ("{bed} {new}.h5 --fit-wall cone", 'Invalid value "cone" for --fit-wall'),
        ("{bed} {new}.h5 --origin 1mm 2mm q", "'q' is not a quantity"),
        ("{new}.dump {new}.h5", r"new\.dump: no such file"),
        ("{new}_*.dump {new}.h5 --all-frames", r"new_\*\.dump: no such files"),
    ],
)
def test_wrong_words_are_one_line_and_exit_code_2(refused, bed, tmp_path, words, message):
    said = refused(2, "convert", *(word.format(bed=bed, new=tmp_path / "new") for word in words.split()))
    assert re.search(message, said)
    assert list(tmp_path.iterdir()) == [bed]


def test_a_place_that_cannot_be_written_shows_before_the_reading(refused, bed):
    assert refused(1, "convert", bed.parent / "nothing.dump", bed / "x.h5").endswith("cannot write: Not a directory")
