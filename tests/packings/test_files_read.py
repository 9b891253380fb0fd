"""Telling formats apart, refusing what is none, and finding the wall of a file that names none."""

from __future__ import annotations

import errno
import os
import pickle
from pathlib import Path

import numpy as np
import pytest

from bedrad import BadFileError, Packing, Tube, read, write
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
            "a.dat",
            b"1 2 3\n",
            r"an unknown format; known are bedrad HDF5 \(\.h5 \.hdf5\), LAMMPS dump .*, CSV \(\.csv\)",
        ),
        ("a", b"", "an empty file; known are"),
        ("a.npz", b"PK\x03\x04", "an unknown format"),
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
    with pytest.raises(ValueError, match=r"packings are written as \.h5, \.hdf5, \.csv"):
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


def foreign(bed: Packing, path: Path, shift: tuple[float, float]) -> Path:
    """The bed as a CSV file of someone who wrote down no wall and put the axis elsewhere."""
    rows = [
        f"{x + shift[0]!r},{y + shift[1]!r},{z!r},{r!r}"
        for (x, y, z), r in zip(bed.centers.tolist(), bed.radii.tolist(), strict=True)
    ]
    path.write_text("\n".join(["x [m],y [m],z [m],radius [m]", *rows]) + "\n")
    return path


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
    with pytest.raises(BadFileError, match=r"a\.csv: 2 spheres are too few to fit a tube around them; give the wall"):
        read(path)
    assert len(read(path, Tube(1.0))) == 2
