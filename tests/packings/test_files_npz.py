"""Arrays of npz: spheropack's files, names and shapes, and what must not be opened."""

from __future__ import annotations

import io
import json
import pickle
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from bedrad import BadFileError, Rod, Tube, read
from bedrad.packings.files.npz import looks_like_npz
from packings.file_mutations import mutated, takes_or_refuses

DATA = Path(__file__).parents[1] / "data" / "npz"
TUBE = Tube(1.0)
CENTERS = np.array([[0.1, 0.2, 0.3], [0.4, -0.2, 1.3]])
RADII = np.array([0.05, 0.04])


def put(tmp_path: Path, **arrays: object) -> Path:
    path = tmp_path / "bed.npz"
    np.savez(path, **arrays)  # type: ignore[arg-type]
    return path


def zipped(tmp_path: Path, entries: dict[str, bytes], method: int = zipfile.ZIP_STORED) -> Path:
    path = tmp_path / "bed.npz"
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, data in entries.items():
            archive.writestr(name, data)
    return path


def npy(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array, allow_pickle=True)
    return stream.getvalue()


def header(text: str, length: int | None = None, version: bytes = b"\x01\x00") -> bytes:
    data = text.encode()
    return b"\x93NUMPY" + version + struct.pack("<H", len(data) if length is None else length) + data


def test_a_cylinder_of_spheropack() -> None:
    with np.load(DATA / "cylinder.npz", allow_pickle=False) as arrays:
        positions, radii = arrays["positions"], arrays["radii"]
    # the container is a tube of diameter 5 around x = y = 2.5, periodic over 6
    packing = read(DATA / "cylinder.npz", max_overlap=1e-9)
    assert packing.wall == Tube(2.5)
    assert "wall_origin" not in packing.provenance
    assert packing.centers.tobytes() == (positions - [2.5, 2.5, 0.0]).tobytes()
    assert packing.radii.tobytes() == radii.tobytes()
    assert packing.period == 6.0
    assert packing.provenance["program"] == "spheropack"
    assert packing.provenance["container"] == "cylinder of radius 2.5, its middle moved to 0"
    assert packing.provenance["length_unit"] == "m, assumed"


def test_the_wall_of_spheropack_has_the_unit_that_is_given() -> None:
    packing = read(DATA / "cylinder.npz", unit="mm")
    assert isinstance(packing.wall, Tube)
    assert packing.wall.radius == pytest.approx(2.5e-3, rel=1e-15)
    assert packing.period == pytest.approx(6e-3, rel=1e-15)
    # a wall that is given is in metres, and the period remains
    other = read(DATA / "cylinder.npz", Tube(3e-3), unit="mm")
    assert (other.wall, other.period) == (Tube(3e-3), packing.period)
    assert read(DATA / "cylinder.npz", Rod(1e-9), unit="mm", max_overlap=2.0).period is None


@pytest.mark.parametrize(("axis", "order"), [(0, [1, 2, 0]), (1, [2, 0, 1]), (2, [0, 1, 2])])
def test_a_cylinder_along_any_axis(tmp_path: Path, axis: int, order: list[int]) -> None:
    # what lies along the axis of the cylinder is z of the packing, the period too
    ball = {"axes": [k != axis for k in range(3)], "center": [0.0] * 3, "radius": 5.0}
    ball["center"] = [0.25 if k != axis else 7.0 for k in range(3)]
    container = {"lengths": [3.0, 4.0, 5.0], "periodic": [k == axis for k in range(3)], "ball": ball}
    meta = json.dumps({"format": "spheropack-1", "container": container})
    packing = read(put(tmp_path, positions=CENTERS, radii=RADII, meta=np.array(meta)))
    assert (packing.wall, packing.period) == (Tube(5.0), [3.0, 4.0, 5.0][axis])
    np.testing.assert_allclose(packing.centers[:, 2], CENTERS[:, order[2]] % packing.period)
    across = np.hypot(*(CENTERS[:, order[:2]] - 0.25).T)
    np.testing.assert_allclose(np.hypot(*packing.centers[:, :2].T), across)


def test_small_integers_do_not_grow_beyond_measure(tmp_path: Path) -> None:
    # 15 MB of zeros, which 15 kB hold, and 120 MB as doubles
    np.savez_compressed(tmp_path / "a.npz", positions=np.zeros((5_000_000, 3), np.int8))
    with pytest.raises(BadFileError, match=r"array 'positions' claims to hold \(5000000, 3\) numbers in \d+ bytes"):
        read(tmp_path / "a.npz", TUBE)


def test_a_box_of_spheropack() -> None:
    packing = read(DATA / "box.npz", Tube(10.0), max_overlap=1e-9)
    assert packing.period == 4.0
    assert len(packing) == 20


def test_discs_of_spheropack_are_refused() -> None:
    with pytest.raises(BadFileError, match=r"disc\.npz: array 'positions' has the shape \(10, 2\).*discs are not read"):
        read(DATA / "disc.npz", TUBE)


@pytest.mark.parametrize("name", ["positions", "centers", "centres", "coordinates", "points", "pos", "xyz"])
@pytest.mark.parametrize(
    ("size", "values"),
    [
        ("radii", RADII),
        ("radius", RADII),
        ("r", RADII),
        ("diameters", 2 * RADII),
        ("diameter", 2 * RADII),
        ("d", 2 * RADII),
    ],
)
def test_names_of_arrays(tmp_path: Path, name: str, size: str, values: np.ndarray) -> None:
    packing = read(put(tmp_path, other=np.arange(5), **{name: CENTERS, size: values}), TUBE)
    assert packing.centers.tolist() == CENTERS.tolist()
    assert packing.radii.tolist() == RADII.tolist()
    assert packing.period is None


@pytest.mark.parametrize("dtype", ["<f8", ">f8", "<f4", "<f2", "<i8", "u1"])
@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_kinds_of_numbers(tmp_path: Path, dtype: str, order: str, save: object) -> None:
    centers = np.array([[0, 0, 1], [0, 0, 5], [1, 2, 9]]).astype(dtype, order=order)  # type: ignore[call-overload]
    save(tmp_path / "a.npz", positions=centers, radius=1.0)  # type: ignore[operator]
    packing = read(tmp_path / "a.npz", Tube(4.0))
    assert packing.centers.tolist() == [[0, 0, 1], [0, 0, 5], [1, 2, 9]]
    assert packing.radii.tolist() == [1, 1, 1]


def test_positions_only_and_none_at_all(tmp_path: Path) -> None:
    path = put(tmp_path, positions=CENTERS)
    assert read(path, TUBE, diameter=0.1).radii.tolist() == [0.05, 0.05]
    with pytest.raises(BadFileError, match=r"bed\.npz: no column radius or diameter"):
        read(path, TUBE)
    assert len(read(put(tmp_path, positions=np.empty((0, 3)), radii=np.empty(0)), TUBE)) == 0


def test_equal_radii_that_pack_well_are_no_bomb(tmp_path: Path) -> None:
    np.savez_compressed(
        tmp_path / "a.npz", positions=np.arange(3.0)[None] + np.arange(9000.0)[:, None], radii=np.full(9000, 0.1)
    )
    assert len(read(tmp_path / "a.npz", Tube(1e5))) == 9000


def test_meta_of_someone_else_is_passed_over(tmp_path: Path) -> None:
    for meta in ("no JSON", "[1]", '{"format": "other"}', "[" * 100_000):
        assert len(read(put(tmp_path, positions=CENTERS, radii=RADII, meta=np.array(meta)), TUBE)) == 2
    assert len(read(put(tmp_path, positions=CENTERS, radii=RADII, meta=np.arange(3)), TUBE)) == 2


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"x": CENTERS}, r"no array positions, centers, .*; it holds radius, x"),
        (
            {"positions": CENTERS[:, :2]},
            r"array 'positions' has the shape \(2, 2\); expected \(n, 3\); packings of discs",
        ),
        ({"positions": CENTERS[0]}, r"array 'positions' has the shape \(3,\); expected \(n, 3\)"),
        ({"positions": CENTERS, "radii": RADII[:1]}, r"array 'radii' has the shape \(1,\); expected \(2,\) or one"),
        ({"positions": CENTERS.astype(complex)}, r"array 'positions' holds complex128; expected real numbers"),
        ({"positions": CENTERS.astype(str)}, r"array 'positions' holds <U\d+; expected real numbers"),
        ({"positions": CENTERS.astype("M8[s]")}, r"array 'positions' holds datetime64\[s\]; expected real numbers"),
        ({"positions": np.zeros(2, dtype="f8,f8")}, r"array 'positions' holds .*; expected real numbers"),
        ({"positions": CENTERS * [1, np.nan, 1]}, r"array 'positions' holds nan at \[0, 1\]; expected finite numbers"),
        ({"positions": CENTERS, "radii": RADII * [1, np.inf]}, r"array 'radii' holds inf at \[1\]"),
        ({"positions": CENTERS, "radii": -RADII}, r"sphere 0: radius -0\.05 m"),
        ({"positions": CENTERS.astype(object)}, r"array 'positions' holds Python objects, a pickle, which can run any"),
        (
            {"positions": CENTERS, "meta": np.array('{"format": "spheropack-1"}')},
            r"spheropack's array 'meta' names no container",
        ),
    ],
)
def test_arrays_that_are_no_packing(tmp_path: Path, arrays: dict[str, object], message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.npz: {message}"):
        read(put(tmp_path, **({"radius": 0.1} | arrays if "radii" not in arrays else arrays)), TUBE)


@pytest.mark.parametrize(
    "container",
    [
        {},
        {"lengths": [1, 2], "periodic": [True, True], "ball": None},
        {"lengths": [1, 2, -3], "periodic": [True, True, True], "ball": None},
        {"lengths": [1, 2, "x"], "periodic": [True, True, True], "ball": None},
        {"lengths": None, "periodic": 1, "ball": None},
        {"lengths": [1, 2, 3], "periodic": [False, False, True], "ball": {"axes": [True, True]}},
        {"lengths": [1, 2, 3], "periodic": [False] * 3, "ball": {"axes": [True] * 2, "center": [1], "radius": 2}},
    ],
)
def test_containers_that_spheropack_does_not_write(tmp_path: Path, container: object) -> None:
    meta = np.array(json.dumps({"format": "spheropack-1", "container": container}))
    with pytest.raises(BadFileError, match=r"bed\.npz: spheropack's container .* is not understood"):
        read(put(tmp_path, positions=CENTERS, radii=RADII, meta=meta), TUBE)


GOOD = npy(CENTERS)


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        (
            {"positions.npy": GOOD, "../radii.npy": npy(RADII)},
            r"entry '\.\./radii\.npy'; expected arrays .* in no folder",
        ),
        ({"positions.npy": GOOD, "a\\b.npy": npy(RADII)}, r"entry 'a.*b\.npy'; expected arrays"),
        ({"positions.npy": GOOD, "script.py": b"print()"}, r"entry 'script\.py'; expected arrays"),
        ({"positions.npy": GOOD, ".npy": npy(RADII)}, r"entry '\.npy'; expected arrays"),
        ({"positions.npy": GOOD[:-8]}, r"array 'positions' of shape \(2, 3\) takes 48 bytes; the file holds 40"),
        ({"positions.npy": GOOD + b"more"}, r"array 'positions' .* takes 48 bytes; the file holds 52"),
        ({"positions.npy": b""}, r"damaged or cut-off npz file"),
        ({"positions.npy": b"\x93NUMPY\x01"}, r"damaged or cut-off npz file"),
        ({"positions.npy": pickle.dumps(CENTERS)}, r"damaged or cut-off npz file \(the magic string is not correct"),
        (
            {"positions.npy": header("{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000, 3)}\n")},
            r"array 'positions' of shape \(1000000000000, 3\) takes 24000000000000 bytes; the file holds 0",
        ),
        (
            {"positions.npy": header("{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 3)}\n")},
            r"(array 'positions' .* takes -24 bytes|damaged)",
        ),
        (
            {"positions.npy": header("{'descr': '|V0', 'fortran_order': False, 'shape': (10000000, 3)}\n")},
            r"array 'positions' holds \|V0; expected real numbers",
        ),
        (
            {"positions.npy": header("{'descr': '|O', 'fortran_order': False, 'shape': (1,)}\n")},
            r".* holds Python objects",
        ),
        ({"positions.npy": header("__import__('os').abort()\n")}, r"damaged or cut-off npz file"),
        ({"positions.npy": header("(" * 5000 + "\n")}, r"damaged or cut-off npz file"),
        (
            {"positions.npy": header(" ", 40_000)},
            r"array 'positions' has a header of 40000 bytes; expected 10000 at most",
        ),
        ({"positions.npy": header(" ", version=b"\x03\x00")}, r"array 'positions' has a header of version \(3, 0\)"),
    ],
)
def test_entries_that_numpy_does_not_write(tmp_path: Path, entries: dict[str, bytes], message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.npz: {message}"):
        read(zipped(tmp_path, entries), TUBE)


def test_a_zip_bomb_is_not_unpacked(tmp_path: Path) -> None:
    # 96 MiB of zeros in 100 kB
    size = 2**22
    data = header(f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({size}, 3)}}\n") + bytes(24 * size)
    path = zipped(tmp_path, {"positions.npy": data}, zipfile.ZIP_DEFLATED)
    with pytest.raises(BadFileError, match=r"array 'positions' claims to unpack from \d+ to 100663370 bytes"):
        read(path, TUBE)


def test_a_listing_that_lies_about_sizes(tmp_path: Path) -> None:
    path = zipped(tmp_path, {"positions.npy": GOOD})
    data = path.read_bytes()
    at = data.index(b"PK\x01\x02") + 20
    packed, unpacked = struct.unpack_from("<II", data, at)
    assert packed == unpacked == len(GOOD)
    for sizes in ((packed, 2**31), (2**31, 2**31), (2**31, unpacked), (1, unpacked), (packed, 20)):
        path.write_bytes(data[:at] + struct.pack("<II", *sizes) + data[at + 8 :])
        with pytest.raises(
            BadFileError, match=r"bed\.npz: (array 'positions' claims|damaged|array 'positions' of shape)"
        ):
            read(path, TUBE, diameter=0.1)


def test_other_packing_and_encryption(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match=r"array 'positions' is packed by method 12; expected 0 or 8"):
        read(zipped(tmp_path, {"positions.npy": GOOD}, zipfile.ZIP_BZIP2), TUBE)
    path = zipped(tmp_path, {"positions.npy": GOOD})
    data = bytearray(path.read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1
    data[6] |= 1
    path.write_bytes(data)
    with pytest.raises(BadFileError, match=r"damaged or cut-off npz file \(.*encrypted"):
        read(path, TUBE)


def test_an_array_that_comes_twice(tmp_path: Path) -> None:
    path = tmp_path / "bed.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("positions.npy", GOOD)
        with pytest.warns(UserWarning, match="Duplicate name"):
            archive.writestr("positions.npy", GOOD)
    with pytest.raises(BadFileError, match=r"bed\.npz: array 'positions' comes twice"):
        read(path, TUBE)


def test_what_looks_like_npz(tmp_path: Path) -> None:
    assert looks_like_npz((DATA / "box.npz").read_bytes())
    assert not looks_like_npz(zipped(tmp_path, {"word/document.xml": b"<a/>"}).read_bytes())
    assert not looks_like_npz(b"PK\x03\x04")
    path = tmp_path / "packing"
    path.write_bytes((DATA / "box.npz").read_bytes())
    assert len(read(path, Tube(10.0))) == 20
    # a pickle is one, whatever its suffix says
    (tmp_path / "a.npz").write_bytes(pickle.dumps({"positions": CENTERS}))
    with pytest.raises(BadFileError, match=r"a\.npz: a Python pickle"):
        read(tmp_path / "a.npz", TUBE)


def test_a_cut_off_file(tmp_path: Path) -> None:
    data = (DATA / "cylinder.npz").read_bytes()
    for length in (10, 40, 1000, len(data) - 5):
        (tmp_path / "a.npz").write_bytes(data[:length])
        with pytest.raises(BadFileError, match=r"a\.npz: damaged or cut-off npz file"):
            read(tmp_path / "a.npz", TUBE)


@given(mutated([(DATA / name).read_bytes() for name in ("box.npz", "cylinder.npz")]))
def test_damaged_files_are_taken_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    takes_or_refuses(tmp_path_factory.getbasetemp() / "damaged.npz", data)


@given(mutated([GOOD, npy(RADII.astype(">f4"))]))
def test_damaged_arrays_are_taken_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("positions.npy", data)
        archive.writestr("radius.npy", npy(np.array(0.01)))
    takes_or_refuses(tmp_path_factory.getbasetemp() / "array.npz", stream.getvalue())


def test_what_a_damaged_header_says_is_shown_short(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match=r"bed\.npz: damaged or cut-off npz file") as caught:
        read(zipped(tmp_path, {"positions.npy": header("{'descr': " + "x" * 5000 + "}")}), TUBE)
    assert len(str(caught.value)) < 500
