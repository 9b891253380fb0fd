"""Telling formats apart, refusing what is none, and finding the wall of a file that names none."""

from __future__ import annotations

import errno
import os
import pickle
from pathlib import Path

import numpy as np
import pytest

from bedrad import BadFileError, Packing, Plate, Tube, read, write
from bedrad.packings.files import FORMATS, read_frames

DATA = Path(__file__).parents[1] / "data" / "lammps_dumps"


@pytest.fixture
def bed() -> Packing:
    """Rings of touching spheres along the wall of a tube, every other ring turned, and a chain on the axis."""
    count, pitch, radius = 16, 1.9e-3, 1e-3
    ring = radius / np.sin(np.pi / count)
    turn = 2 * np.pi * (np.arange(count)[None] + 0.5 * (np.arange(12)[:, None] % 2)) / count
    z = np.broadcast_to(pitch * np.arange(12)[:, None], turn.shape)
    rings = np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=-1).reshape(-1, 3)
    axis = np.stack([np.zeros(11), np.zeros(11), 2e-3 * np.arange(11)], axis=1)
    return Packing(np.concatenate([rings, axis]), radius, Tube(ring + radius))


def test_content_comes_before_suffix(tmp_path: Path, bed: Packing) -> None:
    for suffix in ("h5", "csv"):
        write(bed, tmp_path / f"a.{suffix}")
    (tmp_path / "a.h5").rename(tmp_path / "hdf5.csv")
    (tmp_path / "a.csv").rename(tmp_path / "csv.h5")
    (tmp_path / "dump.csv").write_bytes((DATA / "plain.dump").read_bytes())
    assert len(read(tmp_path / "hdf5.csv")) == len(bed)
    assert len(read(tmp_path / "csv.h5")) == len(bed)
    assert len(read(tmp_path / "dump.csv", Tube(0.002))) == 12


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        (
            "a.foo",
            b"spheres\n",
            r"an unknown format; known are bedrad HDF5 \(\.h5 \.hdf5\), .*LAMMPS dump .*, CSV \(\.csv\)",
        ),
        ("a", b"", "an empty file; known are"),
        ("a.npz", b"PK\x03\x04", "damaged or cut-off npz file"),
        ("a.pkl", pickle.dumps([1.0]), "a Python pickle; pickles can run any code when opened and are not read"),
        ("a.h5", pickle.dumps([1.0]), "a Python pickle"),
        ("a.pickle", pickle.dumps([1.0], protocol=0), "a Python pickle"),
        ("a.h5", b"not HDF5", "damaged or cut-off HDF5 file"),
        ("a.hdf5", b"", "damaged or cut-off HDF5 file"),
        ("a.dump", b"x y z\n", "line 1: expected a line that begins with 'ITEM:', found 'x y z'"),
        ("a.dump.gz", b"\x1f\x8bxxxx", "broken or cut-off gzip file"),
        ("a.csv", b"\x00\xff\xfe,\x01", "line 1: no column x, y, z"),
    ],
)
def test_what_is_no_packing(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadFileError, match=rf"{name}[:,] {message}"):
        read(tmp_path / name, Tube(1.0))
    with pytest.raises(BadFileError, match=rf"{name}[:,] {message}"):
        list(read_frames(tmp_path / name, Tube(1.0)))


def test_missing_files_and_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(BadFileError, match=r"nowhere\.csv: no such file"):
        read(tmp_path / "nowhere.csv")
    with pytest.raises(BadFileError, match="is a folder; expected a file"):
        read(tmp_path)
    (tmp_path / "a.csv").write_text("x")

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(BadFileError, match=r"a\.csv: cannot be read: Permission denied"):
        read(tmp_path / "a.csv")


@pytest.mark.parametrize("name", ["a.dump", "a.txt", "a", "a.csv.gz"])
def test_suffixes_that_are_not_written(tmp_path: Path, bed: Packing, name: str) -> None:
    with pytest.raises(ValueError, match=r"packings are written as \.h5, \.hdf5, .*\.csv"):
        write(bed, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_leaves_the_old_file(tmp_path: Path, bed: Packing, monkeypatch: pytest.MonkeyPatch) -> None:
    write(bed, tmp_path / "a.csv")
    before = (tmp_path / "a.csv").read_bytes()

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match=r"cannot write: No space left on device: '.*a\.csv'"):
        write(bed, tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


def test_the_table_of_formats_is_consistent() -> None:
    suffixes = [suffix for form in FORMATS for suffix in form.suffixes]
    assert len(suffixes) == len(set(suffixes))
    assert all(suffix.startswith(".") and suffix == suffix.lower() for suffix in suffixes)


def table(centers: np.ndarray, radii: np.ndarray, path: Path) -> Path:
    """Spheres as a CSV file of someone who wrote down no wall."""
    rows = [f"{x!r},{y!r},{z!r},{r!r}" for (x, y, z), r in zip(centers.tolist(), radii.tolist(), strict=True)]
    path.write_text("\n".join(["x [m],y [m],z [m],radius [m]", *rows]) + "\n")
    return path


def foreign(bed: Packing, path: Path, shift: tuple[float, float]) -> Path:
    """The bed with its axis elsewhere."""
    return table(bed.centers + np.array([*shift, 0.0]), bed.radii, path)


def test_a_wall_that_is_not_named_is_fitted_and_said_so(tmp_path: Path, bed: Packing) -> None:
    packing = read(foreign(bed, tmp_path / "a.csv", (0.3, -0.2)))
    assert isinstance(packing.wall, Tube)
    # coordinates near 0.3 m carry roundings of that size
    assert packing.wall.radius == pytest.approx(bed.wall.radius, abs=1e-15)
    np.testing.assert_allclose(packing.centers, bed.centers, atol=1e-15)
    assert str(packing.provenance["wall_origin"]).startswith("tube fitted by least squares")
    assert packing.provenance["wall_fit_axis_x_m"] == pytest.approx(0.3, abs=1e-15)
    assert packing.provenance["wall_fit_axis_y_m"] == pytest.approx(-0.2, abs=1e-15)
    assert packing.provenance["wall_fit_residual_radii"] < 1e-12
    assert packing.provenance["wall_fit_spheres"] == 12 * 16


def test_a_wall_that_cannot_be_fitted_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("x [m],y [m],z [m],radius [m]\n0,0,0,0.1\n0,0,1,0.1\n")
    with pytest.raises(BadFileError, match=r"a\.csv: 2 spheres are too few to fit a tube to them; give the wall"):
        read(path)
    assert len(read(path, Tube(1.0))) == 2


# columns of the file that become x, y, z when an axis becomes z: a turn, not a mirror
TURNS = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_an_axis_of_the_file_is_turned_to_z_exactly_and_its_period_with_it(tmp_path: Path, axis: str) -> None:
    rng = np.random.default_rng(1)
    lengths = np.array([0.3, 0.4, 0.5])
    centers = rng.uniform(0.0, 0.1, (3, 3)) + np.array([[0.0], [0.1], [0.2]])
    rows = "".join(f"{x!r} {y!r} {z!r} 0.01\n" for x, y, z in centers.tolist())
    path = tmp_path / "a.dump"
    path.write_text(
        "ITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp pp\n0 0.3\n0 0.4\n0 0.5\nITEM: ATOMS x y z radius\n" + rows
    )
    turn = list(TURNS[axis])
    for given in (axis, np.eye(3)["xyz".index(axis)] * 7.0):
        packing = read(path, Tube(1.0), axis=given)
        assert packing.centers.tolist() == centers[:, turn].tolist()
        assert packing.period == lengths[turn][2]
        plate = read(path, Plate(), axis=given)
        assert plate.period == (lengths[turn][0], lengths[turn][1])
    turned = read(path, Tube(1.0), axis=axis).provenance["axis_turned_to_z"]
    assert turned == {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}[axis]


@pytest.mark.parametrize("axis", [(1.0, 2.0, 3.0), (-1.0, 0.2, 0.1), (0.0, 0.0, -1.0), (0.3, -5.0, 1.0)])
def test_any_axis_through_any_point_becomes_z(tmp_path: Path, bed: Packing, axis: tuple[float, float, float]) -> None:
    # an own construction: columns of an orthonormal basis whose last vector is the axis
    basis = np.linalg.qr(np.column_stack([axis, [1.0, 0.7, 0.0], [0.0, 0.4, 1.0]]))[0][:, [1, 2, 0]]
    basis *= np.sign(basis[:, 2] @ axis)
    point = np.array([0.2, -0.3, 0.7])
    path = table(bed.centers @ basis.T + point, bed.radii, tmp_path / "a.csv")
    packing = read(path, bed.wall, axis=axis, origin=point.tolist())
    np.testing.assert_allclose(packing.centers[:, 2], bed.centers[:, 2], atol=1e-15)
    np.testing.assert_allclose(packing.depths, bed.depths, atol=1e-15)
    # a turn and not a mirror: the sense of three spheres stays
    spheres = [0, 1, 40]
    sense = np.linalg.det(packing.centers[spheres]) / np.linalg.det(bed.centers[spheres] @ basis.T)
    assert sense == pytest.approx(1.0)
    assert packing.provenance["origin_moved_to_0_m"] == "0.2 -0.3 0.7"


def test_periods_are_left_out_where_no_axis_of_the_box_becomes_z(tmp_path: Path) -> None:
    path = tmp_path / "a.dump"
    path.write_text(
        "ITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\nITEM: ATOMS x y z radius\n0 0 0 .1\n"
    )
    assert read(path, Tube(1.0), axis=(0.0, 0.1, 1.0)).period is None
    assert read(path, Tube(1.0), axis=(0.0, 0.1, 1.0), period=2.0).period == 2.0


@pytest.mark.parametrize("unit", [None, "mm"])
def test_a_tube_that_lies_anywhere_is_found(tmp_path: Path, bed: Packing, unit: str | None) -> None:
    basis = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    path = table(bed.centers @ basis.T + 0.01, bed.radii, tmp_path / "a.csv")
    if unit is not None:
        path.write_text(path.read_text().replace(" [m]", ""))
    packing = read(path, unit=unit)
    metre = 1.0 if unit is None else 1e-3
    assert packing.wall.radius == pytest.approx(bed.wall.radius * metre, rel=1e-12)
    axis = [packing.provenance[f"wall_fit_direction_{name}"] for name in "xyz"]
    assert abs(float(np.dot(axis, basis[:, 2]))) == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(packing.depths, bed.depths * metre, atol=1e-14)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"axis": "w"}, "axis is 'w'; expected 'x', 'y', 'z' or three finite numbers that are not all zero"),
        ({"axis": (0, 0, 0)}, r"axis is \(0, 0, 0\); expected"),
        ({"axis": (0, 1)}, r"axis is \(0, 1\); expected"),
        ({"axis": (0, 1, float("nan"))}, "axis is .*; expected"),
        ({"origin": (0, 1)}, r"origin is \(0, 1\); expected three finite numbers of metres"),
        ({"origin": ("a", "b", "c")}, "origin is .*; expected three finite numbers"),
        ({"origin": (0, 0, 0)}, "an origin was given, but no wall, so that the tube around the bed of .* is fitted"),
        ({"wall": "rod", "origin": (0, 0, 0)}, "an origin was given, but where the rod is will be fitted"),
        ({"wall": "cone"}, "wall is 'cone'; expected a wall, 'tube', 'rod', 'plate' or an .stl file"),
        ({"wall_unit": "mm"}, "the unit of the wall is 'mm', but the wall is no STL file"),
        ({"unit": "mile"}, "the unit of length is 'mile'; expected one of m, cm, mm, um, nm, in, ft"),
    ],
)
def test_options_that_make_no_sense(tmp_path: Path, bed: Packing, options: dict, message: str) -> None:
    path = foreign(bed, tmp_path / "a.csv", (0.0, 0.0))
    with pytest.raises(ValueError, match=message):
        read(path, **options)
    with pytest.raises(ValueError, match=message):
        list(read_frames(path, **options))


def test_options_that_the_file_leaves_no_room_for(tmp_path: Path, bed: Packing) -> None:
    write(bed, tmp_path / "a.h5")
    for options in ({"axis": "x"}, {"origin": (0.0, 0.0, 0.0)}):
        with pytest.raises(
            ValueError, match=r"axis or origin was given, but .*a\.h5 holds a bed whose wall is in place"
        ):
            read(tmp_path / "a.h5", **options)
    with pytest.raises(ValueError, match=r"the unit 'mm' was given, but .* states the unit"):
        read(tmp_path / "a.h5", unit="mm")
    with pytest.raises(ValueError, match=r"columns were given, but .* is a bedrad HDF5 file, whose columns are known"):
        read(tmp_path / "a.h5", columns={"x": 1})


def frame_file(path: Path, place: float) -> None:
    path.write_text(f"x [m],y [m],z [m],radius [m]\n0,0,{place},0.1\n")


def places(*arguments: object) -> list[float]:
    return [float(packing.centers[0, 2]) for packing in read_frames(*arguments)]  # type: ignore[arg-type]


def test_trajectories_over_many_files_come_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    for number in (1000, 9, 10, 99):
        frame_file(tmp_path / f"dump_{number}.csv", float(number))
    (tmp_path / "dump_9_boundingBox.csv").write_text("not a frame")
    (tmp_path / ".dump_7.csv").write_text("hidden")
    ordered = [9.0, 10.0, 99.0, 1000.0]
    assert places(tmp_path / "dump_*.csv", Tube(1.0)) == ordered
    assert places(str(tmp_path / "dump_[0-9]*.csv"), Tube(1.0)) == ordered
    assert places(tmp_path, Tube(1.0)) == ordered
    assert places([tmp_path / "dump_99.csv", tmp_path / "dump_9.csv"], Tube(1.0)) == [99.0, 9.0]
    assert places(tmp_path / "dump_99.csv", Tube(1.0)) == [99.0]
    # every file may hold several frames
    text = (DATA / "plain.dump").read_text()
    for name in ("run.1.dump", "run.2.dump"):
        (tmp_path / name).write_text(text)
    found = [p.provenance["file"] for p in read_frames(tmp_path / "run.*.dump", Tube(0.002))]
    assert found == ["run.1.dump"] * 3 + ["run.2.dump"] * 3


def test_one_frame_at_a_time_is_held(tmp_path: Path) -> None:
    for number in (1, 2):
        frame_file(tmp_path / f"a{number}.csv", float(number))
    frames = read_frames(tmp_path / "a*.csv", Tube(1.0))
    assert next(frames).centers[0, 2] == 1.0
    # the second file is not touched before it is wanted
    (tmp_path / "a2.csv").unlink()
    with pytest.raises(BadFileError, match=r"a2\.csv: no such file"):
        next(frames)


def test_files_that_are_no_trajectory(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match=r"dump_\*\.csv: no such files"):
        read_frames(tmp_path / "dump_*.csv")
    with pytest.raises(BadFileError, match=r"a folder without a file of a known suffix; known are \.h5"):
        read_frames(tmp_path)
    with pytest.raises(BadFileError, match="no files were given"):
        read_frames([])
    with pytest.raises(BadFileError, match="wild cards in the name of a folder; expected them in the last part only"):
        read_frames(tmp_path / "run*" / "*.csv")
    frame_file(tmp_path / "a.csv", 1.0)
    (tmp_path / "a.dump").write_text("ITEM: ATOMS\n")
    with pytest.raises(BadFileError, match=r"files of several kinds \(\.csv \.dump\); expected one kind, or a pattern"):
        read_frames(tmp_path)
    with pytest.raises(BadFileError, match="is a folder; expected a file"):
        read(tmp_path)


def test_a_name_with_wild_cards_that_is_there_is_a_file(tmp_path: Path) -> None:
    frame_file(tmp_path / "a[1].csv", 3.0)
    assert places(tmp_path / "a[1].csv", Tube(1.0)) == [3.0]


@pytest.mark.parametrize("name", ["bed.dump", "bed.h5", "bed.dem", "bed.pvd"])
def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    with pytest.raises(BadFileError, match=rf"{name}: a pipe or device; expected a file"):
        read(tmp_path / name)


def test_a_device_is_refused() -> None:
    with pytest.raises(BadFileError, match="/dev/zero: a pipe or device; expected a file"):
        read("/dev/zero")


def test_numbers_whose_ratios_are_none_are_refused_without_a_warning(tmp_path: Path) -> None:
    path = tmp_path / "bed.csv"
    path.write_text("x [m],y [m],z [m],radius [m]\n0,0,0,1e-308\n0,0,9,1\n")
    assert len(read(path, Tube(2.0))) == 2
    path.write_text("x [m],y [m],z [m],radius [m]\n1e300,0,0,1e-300\n0,0,0,1e200\n")
    with pytest.raises(BadFileError, match="reaches inf of its radius through the tube wall"):
        read(path, Tube(1.0))


@pytest.mark.parametrize("name", ["a\0.csv", "a\0.h5", "folder\0/a.dump"])
def test_a_name_that_no_file_can_have_is_told(name):
    with pytest.raises(BadFileError, match=r"x00.*: has a NUL in its name; expected the name of a file$"):
        read(name)
