"""bedrad's HDF5 layout gives a packing back bit for bit, and refuses what is not one."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bedrad import BadFileError, Packing, Plate, Rod, Tube, read, write
from bedrad.packings.files import load_packing, save_packing
from bedrad.walls import Wall

PERIODS = {"tube": 0.3, "rod": 0.3, "plate": (0.2, 0.3)}


def chain(wall: Wall, period: float | tuple[float, float] | None = None, **more: object) -> Packing:
    """Seven spheres of unlike sizes beside any wall, at coordinates without a short decimal form."""
    r = 0.01 / np.arange(3, 10)
    x = {"tube": 1.0 / 30.0, "rod": 0.1, "plate": 1.0 / 7.0}[wall.kind]
    c = np.stack([np.full(7, x), np.full(7, -1.0 / 90.0), math.pi / 100.0 + 0.01 * np.arange(7)], axis=1)
    return Packing(c, r, wall, period, **more)  # type: ignore[arg-type]


def assert_same(a: Packing, b: Packing) -> None:
    assert a.centers.tobytes() == b.centers.tobytes()
    assert a.radii.tobytes() == b.radii.tobytes()
    assert (a.wall, a.period, a.max_overlap) == (b.wall, b.period, b.max_overlap)
    assert dict(a.provenance) == dict(b.provenance)
    assert {k: type(v) for k, v in a.provenance.items()} == {k: type(v) for k, v in b.provenance.items()}


@pytest.mark.parametrize("suffix", ["h5", "hdf5", "csv"])
@pytest.mark.parametrize("wall", [Tube(1 / 19), Rod(1 / 29), Plate()], ids=lambda w: w.kind)
@pytest.mark.parametrize("periodic", [True, False])
def test_round_trip_is_bit_exact(tmp_path: Path, suffix: str, wall: Wall, periodic: bool) -> None:
    notes = {
        "engine": "LAMMPS",
        "time_step_s": 7.29e-06 / 3,
        "seed": 2**62 + 1,
        "text": 'µ "quoted", # and\nbroken',
        "e": "",
    }
    packing = chain(wall, PERIODS[wall.kind] if periodic else None, provenance=notes, max_overlap=0.123456789)
    path = tmp_path / f"bed.{suffix}"
    write(packing, path)
    assert_same(read(path), packing)


@pytest.mark.parametrize("suffix", ["h5", "csv"])
def test_an_empty_packing_survives(tmp_path: Path, suffix: str) -> None:
    packing = Packing(np.empty((0, 3)), 1.0, Tube(1.0), period=2.0)
    write(packing, tmp_path / f"a.{suffix}")
    assert_same(read(tmp_path / f"a.{suffix}"), packing)


@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    z=st.lists(st.floats(-1e150, 1e150), min_size=1, max_size=4, unique=True),
    radius=st.floats(1e-12, 1e-3),
    suffix=st.sampled_from(["h5", "csv"]),
)
def test_any_finite_number_survives(tmp_path: Path, z: list[float], radius: float, suffix: str) -> None:
    packing = Packing([[0.0, -0.0, value] for value in z], radius, Tube(1.0), max_overlap=2.0)
    write(packing, tmp_path / f"a.{suffix}")
    assert_same(read(tmp_path / f"a.{suffix}"), packing)


def test_the_layout_says_units_and_names(tmp_path: Path) -> None:
    write(chain(Tube(0.05), 0.3), tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as file:
        assert {"schema_version", "bedrad_version", "created"} <= set(file.attrs)
        group = file["packing"]
        assert {name: dict(group[name].attrs) for name in ("centers", "radii")} == {
            "centers": {"units": "m", "long_name": "sphere centres (x, y, z)"},
            "radii": {"units": "m", "long_name": "sphere radii"},
        }
        assert (group.attrs["wall"], group.attrs["wall_radius"], group.attrs["period"]) == ("tube", 0.05, 0.3)


def test_a_results_file_holds_the_same_group(tmp_path: Path) -> None:
    packing = chain(Tube(0.05), provenance={"seed": 1})
    path = tmp_path / "results.h5"
    with h5py.File(path, "w") as file:
        file.attrs["schema_version"] = 7
        save_packing(file.create_group("packing"), packing)
        file.create_group("statistics")["packing_fraction"] = 0.43
        assert_same(load_packing(file["packing"]), packing)
    assert_same(read(path), packing)


def test_a_given_wall_and_period_win(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    write(chain(Tube(0.05), 0.3), path)
    assert read(path, Tube(0.06)).wall == Tube(0.06)
    assert read(path, Tube(0.06)).period == 0.3
    assert read(path, period=0.4).period == 0.4
    assert read(path, period=0).period is None
    # a period along z means nothing to a plate
    assert read(path, Plate()).period is None


def write_broken(path: Path, change: object) -> None:
    write(chain(Tube(0.05)), path)
    with h5py.File(path, "r+") as file:
        change(file)  # type: ignore[operator]


def replaced(name: str, values: object, units: str = "m"):
    def change(file: h5py.File) -> None:
        del file[f"packing/{name}"]
        file[f"packing/{name}"] = values
        file[f"packing/{name}"].attrs["units"] = units

    return change


def without(name: str):
    return lambda file: file["packing"].attrs.__delitem__(name)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda f: f.__delitem__("packing"), "no group /packing; the file holds nothing"),
        (lambda f: f.__delitem__("packing/radii"), "no dataset 'radii'; it holds centers, provenance"),
        (lambda f: f.__delitem__("packing/provenance"), "no group 'provenance'; it holds centers, radii"),
        (
            lambda f: f["packing"].attrs.__setitem__("schema_version", 99),
            "schema_version 99; this bedrad reads 1",
        ),
        (replaced("radii", np.ones(3)), r"centers of shape \(7, 3\) and radii of shape \(3,\)"),
        (replaced("radii", np.ones(7), units="mm"), "dataset 'radii' has the units 'mm'; expected 'm'"),
        (replaced("radii", np.arange(7)), "dataset 'radii' holds int64; expected floating-point numbers"),
        (replaced("radii", -np.ones(7)), r"sphere 0: radius -1\.0 m; expected a positive"),
        (replaced("centers", np.full((7, 3), np.nan)), "sphere 0: centre .* is not finite"),
        (without("wall"), "the wall is None; expected 'tube', 'rod' or 'plate'"),
        (without("wall_radius"), "the tube wall has the radius None; expected a number of metres"),
        (without("max_overlap"), "no attribute 'max_overlap'"),
        (lambda f: f["packing"].attrs.__setitem__("wall", "cone"), "the wall is 'cone'"),
        (lambda f: f["packing"].attrs.__setitem__("period", [1.0, 2.0, 3.0]), "'period' holds 3 numbers"),
        (lambda f: f["packing"].attrs.__setitem__("max_overlap", "much"), "is not a number"),
        (
            lambda f: f["packing/provenance"].attrs.__setitem__("x", [1, 2]),
            r"provenance 'x' is .*; expected a text",
        ),
    ],
)
def test_a_broken_layout_is_named(tmp_path: Path, change: object, message: str) -> None:
    path = tmp_path / "a.h5"
    write_broken(path, change)
    with pytest.raises(BadFileError, match=rf"a\.h5.*{message}"):
        read(path)


def test_load_packing_names_file_group_and_sphere(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    write_broken(path, replaced("radii", -np.ones(7)))
    with (
        h5py.File(path) as file,
        pytest.raises(BadFileError, match=r"a\.h5: group /packing: sphere 0: radius -1\.0 m"),
    ):
        load_packing(file["packing"])


@pytest.mark.parametrize("kept", [16, 200, 3000, -1])
def test_a_cut_off_file_is_refused(tmp_path: Path, kept: int) -> None:
    path = tmp_path / "a.h5"
    write(chain(Tube(0.05)), path)
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(BadFileError, match=r"a\.h5: damaged or cut-off HDF5 file"):
        read(path)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (2**63, "64-bit"),
        ([1], "expected a text, a float or a 64-bit integer"),
        ("x" * 70_000, "70000 characters"),
    ],
)
def test_provenance_that_cannot_be_kept_is_refused_before_a_file_appears(
    tmp_path: Path, value: object, message: str
) -> None:
    packing = chain(Tube(0.05), provenance={"key": value})
    with pytest.raises(ValueError, match=f"provenance 'key'.*{message}"):
        write(packing, tmp_path / "a.h5")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["wall", "wall_radius", "schema_version", "max_overlap", "period"])
def test_what_an_attribute_says_is_shown_short_and_on_one_line(tmp_path: Path, name: str) -> None:
    write(Packing([[0.0, 0.0, 0.0]], 0.5, Tube(1.0)), tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        file["packing"].attrs[name] = "a\n\x1b[31m" + "x" * 50_000
    with pytest.raises(BadFileError) as caught:
        read(tmp_path / "a.h5")
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 500


def test_a_crowd_that_the_file_allows_is_refused_all_the_same(tmp_path: Path) -> None:
    # datasets that were never written take no room in the file, and are zeros
    with h5py.File(tmp_path / "a.h5", "w") as file:
        group = file.create_group("packing")
        group.attrs.update({"schema_version": 1, "wall": "tube", "wall_radius": 9.0, "max_overlap": 1e9})
        group.create_group("provenance")
        group.create_dataset("centers", (60_000, 3), "f8", chunks=True).attrs["units"] = "m"
        group.create_dataset("radii", (60_000,), "f8", chunks=True, fillvalue=1.0).attrs["units"] = "m"
    with pytest.raises(BadFileError, match="60000 spheres of which more than 100 are in reach of each"):
        read(tmp_path / "a.h5")


@pytest.mark.parametrize("period", [1j, "0.1", np.ones((2, 2)), h5py.Empty("f8")])
def test_a_period_that_is_no_number(tmp_path: Path, period: object) -> None:
    write(Packing([[0.0, 0.0, 0.0]], 0.5, Tube(1.0)), tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        file["packing"].attrs["period"] = period
    with pytest.raises(BadFileError, match=r"'period' is .+; expected one or two numbers"):
        read(tmp_path / "a.h5")


def test_an_overlap_limit_that_is_no_real_number(tmp_path: Path) -> None:
    write(Packing([[0.0, 0.0, 0.0]], 0.5, Tube(1.0)), tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        file["packing"].attrs["max_overlap"] = 1j
    with pytest.raises(BadFileError, match="the attribute 'max_overlap' is not a number"):
        read(tmp_path / "a.h5")


def test_a_name_that_is_no_text(tmp_path: Path) -> None:
    write(Packing([[0.0, 0.0, 0.0]], 0.5, Tube(1.0)), tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        file["packing/provenance"].attrs[b"\xff"] = 1
    with pytest.raises(BadFileError, match=r"/packing/provenance: the attribute b'\\xff' has a name that is not UTF-8"):
        read(tmp_path / "a.h5")


@pytest.mark.parametrize("size", [0, 8, 2**63, 2**64 - 8])
def test_a_heap_of_texts_with_a_false_size(tmp_path: Path, size: int) -> None:
    # the library would go through free space of no size for ever
    path = tmp_path / "a.h5"
    write(Packing([[0.0, 0.0, 0.0]], 0.5, Tube(1.0), provenance={"a": "text"}), path)
    data = bytearray(path.read_bytes())
    place, number = data.index(b"GCOL") + 16, 1
    while number:
        start = place
        number, length = struct.unpack_from("<HxxxxxxQ", data, start)
        place += 16 + -(-length // 8) * 8
    struct.pack_into("<Q", data, start + 8, size)
    path.write_bytes(data)
    with pytest.raises(BadFileError, match=r"a\.h5: damaged or cut-off HDF5 file: a heap of texts with a false size"):
        read(path)
