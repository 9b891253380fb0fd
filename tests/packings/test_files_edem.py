"""EDEM decks: whole, broken, and made to do harm."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bedrad import BadFileError, Tube, read
from bedrad.packings.files import read_frames, write
from bedrad.packings.files.edem_hdf5 import is_edem, iterate_edem, read_edem
from bedrad.packings.files.hdf5_access import read_array

DATA = Path(__file__).parents[1] / "data" / "edem"
TUBE = Tube(0.002)
SPHERE = np.dtype([("name", "S32"), ("pos", "<f4", (3,)), ("physicalRadius", "<f4"), ("contactRadius", "<f4")])

Change = Callable[[h5py.File], object]


def spheres(radius: float, *more: tuple[float, float, float]) -> np.ndarray:
    places = [(0.0, 0.0, 0.0), *more]
    return np.array([(b"sphere", place, radius, 1.2 * radius) for place in places], dtype=SPHERE)


def write_step(path: Path, step: int, time: float, *, describe: bool) -> None:
    """Three particles of type 0, one of type 1, and none of type 2; they fall by 0.1 mm a step."""
    fall = -1e-4 * step
    with h5py.File(path, "w") as file:
        if describe:
            for name, radius in (("0", 0.0005), ("1", 0.00025), ("2", 0.001)):
                file[f"CreatorData/0/ParticleTypes/{name}/spheres"] = spheres(radius)
                file[f"CreatorData/0/ParticleTypes/{name}"].attrs["name"] = f"glass {name}"
        group = file.create_group(f"TimestepData/{step}")
        group.attrs["time"] = time
        types = group.create_group("ParticleTypes")
        types["0/position"] = [[0.0, 0.0, 0.003 + fall], [0.001, 0.0, 0.002 + fall], [-0.001, 0.0, 0.002 + fall]]
        types["0/scale"] = [1.0, 0.5, 0.75]
        types["0/ids"] = np.array([9, 2, 4], dtype=np.int64)
        types["1/position"] = np.array([0.0, 0.001, 0.001 + fall])
        types["1/scale"] = [[2.0]]
        types["1/ids"] = np.array([7], dtype=np.int64)
        types.create_group("2")


def write_deck(folder: Path, numbers: range = range(3)) -> Path:
    deck = folder / "deck.dem"
    with h5py.File(deck, "w") as file:
        file.attrs["num timesteps"] = len(numbers)
    (folder / "deck_data").mkdir()
    for number in numbers:
        write_step(folder / "deck_data" / f"{number}.h5", number, 0.01 * number, describe=number == 0)
    return deck


@pytest.mark.parametrize("frame", [0, 1, 2, -1, -3])
def test_the_sample_deck(frame: int) -> None:
    packing = read(DATA / "deck.dem", TUBE, frame=frame)
    step = frame % 3
    # type 0 by id (2, 4, 9), then type 1; radius = scale x physical radius, which EDEM keeps as a float of 32 bits
    large, small = float(np.float32(0.0005)), float(np.float32(0.00025))
    assert packing.radii.tolist() == [0.5 * large, 0.75 * large, large, 2 * small]
    np.testing.assert_allclose(packing.centers[:, 0], [0.001, -0.001, 0.0, 0.0], atol=1e-18)
    np.testing.assert_allclose(packing.centers[:, 2], np.array([0.002, 0.002, 0.003, 0.001]) - 1e-4 * step, rtol=1e-12)
    assert dict(packing.provenance) == {
        "file": "deck.dem",
        "format": "EDEM deck",
        "frame": step,
        "step": str(step),
        "time_s": pytest.approx(0.01 * step),
    }
    assert packing.period is None


def test_all_frames_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    # 10.h5 comes before 2.h5 in the alphabet
    deck = write_deck(tmp_path, range(12))
    assert [p.provenance["step"] for p in read_frames(deck, TUBE)] == [str(k) for k in range(12)]
    assert read(deck, TUBE).provenance["step"] == "11"


def test_steps_of_one_file_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    path = tmp_path / "all.h5"
    write_step(path, 9, 0.9, describe=True)
    write_step(tmp_path / "other.h5", 10, 1.0, describe=False)
    with h5py.File(path, "r+") as file, h5py.File(tmp_path / "other.h5") as other:
        other.copy("TimestepData/10", file["TimestepData"])
    assert [held.provenance["step"] for held in iterate_edem(path)] == ["9", "10"]
    assert read(path, TUBE).provenance["step"] == "10"


def test_a_file_of_the_folder_by_itself() -> None:
    # the particles are described in 0.h5 beside it
    packing = read(DATA / "deck_data" / "1.h5", TUBE)
    assert packing.radii.tolist() == read(DATA / "deck.dem", TUBE, frame=1).radii.tolist()
    assert read_edem(DATA / "deck.dem").states_unit


def test_files_left_by_an_earlier_run_are_not_frames(tmp_path: Path) -> None:
    deck = write_deck(tmp_path)
    write_step(tmp_path / "deck_data" / "3.h5", 3, 0.03, describe=False)
    assert len(list(read_frames(deck, TUBE))) == 3
    with h5py.File(deck, "r+") as file:
        del file.attrs["num timesteps"]
    assert len(list(read_frames(deck, TUBE))) == 4


@pytest.mark.parametrize("parent", ["ParticleTypes", "Particle Types", "Particles"])
@pytest.mark.parametrize("name", ["physicalRadius", "physical radius"])
@pytest.mark.parametrize("attribute", [True, False])
def test_other_names_of_the_physical_radius(tmp_path: Path, parent: str, name: str, attribute: bool) -> None:
    path = tmp_path / "0.h5"
    write_step(path, 0, 0.0, describe=False)
    with h5py.File(path, "r+") as file:
        for kind, radius in (("0", 0.0005), ("1", 0.00025)):
            group = file.create_group(f"CreatorData/3/{parent}/{kind}")
            if attribute:
                group.attrs[name] = radius
            else:
                group[name] = np.array([radius])
    assert read(path, TUBE).radii.tolist() == [0.00025, 0.000375, 0.0005, 0.0005]


def test_without_ids_the_order_of_the_file_stays(tmp_path: Path) -> None:
    path = tmp_path / "0.h5"
    write_step(path, 0, 0.0, describe=True)
    with h5py.File(path, "r+") as file:
        del file["TimestepData/0/ParticleTypes/0/ids"]
    held = read_edem(path)
    assert held.centers[:3, 0].tolist() == [0.0, 0.001, -0.001]
    assert held.ids is None


def test_a_packing_of_bedrad_stays_one(tmp_path: Path) -> None:
    packing = read(DATA / "deck.dem", TUBE)
    write(packing, tmp_path / "bed.h5")
    assert not is_edem(tmp_path / "bed.h5")
    assert read(tmp_path / "bed.h5").centers.tolist() == packing.centers.tolist()
    assert not is_edem(tmp_path / "absent.h5")


def test_a_packing_of_bedrad_lies_in_its_file(tmp_path: Path) -> None:
    path = tmp_path / "bed.h5"
    write(read(DATA / "deck.dem", TUBE), path)
    with h5py.File(path, "r+") as file:
        attributes = dict(file["packing/centers"].attrs)
        del file["packing/centers"]
        huge = file.create_dataset("packing/centers", shape=(10**12, 3), dtype="f8", chunks=(1000, 3))
        huge.attrs.update(attributes)
    with pytest.raises(BadFileError, match=r"centers has the shape \(1000000000000, 3\).*0 bytes are stored"):
        read(path)
    with h5py.File(path, "r+") as file:
        del file["packing/centers"]
        file["packing/centers"] = h5py.ExternalLink("elsewhere.h5", "/centers")
    with pytest.raises(BadFileError, match="'centers' is a link by name"):
        read(path)


def replaced(name: str, values: object, **more: object) -> Change:
    def change(file: h5py.File) -> None:
        del file[name]
        file.create_dataset(name, data=values, **more)

    return change


def without(name: str) -> Change:
    return lambda file: file.__delitem__(name)


def linked(name: str, link: object) -> Change:
    def change(file: h5py.File) -> None:
        del file[name]
        file[name] = link

    return change


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout(shape=(3, 3), dtype="f8")
    layout[:] = h5py.VirtualSource("elsewhere.h5", "position", shape=(3, 3))
    del file[f"{TYPE}/position"]
    file.create_virtual_dataset(f"{TYPE}/position", layout)


def elsewhere(file: h5py.File) -> None:
    del file[f"{TYPE}/position"]
    file.create_dataset(f"{TYPE}/position", shape=(3, 3), dtype="f8", external=[("elsewhere.raw", 0, 72)])


def texts(file: h5py.File) -> None:
    del file[f"{TYPE}/position"]
    file.create_dataset(f"{TYPE}/position", data=[["a", "b", "c"]] * 3, dtype=h5py.string_dtype())


def huge(file: h5py.File) -> None:
    del file[f"{TYPE}/position"]
    file.create_dataset(f"{TYPE}/position", shape=(10**12, 3), dtype="f8", chunks=(1000, 3), compression="gzip")


def huge_chunk(file: h5py.File) -> None:
    del file[f"{TYPE}/scale"]
    # a chunk is unpacked whole, however little of it is wanted
    file.create_dataset(f"{TYPE}/scale", shape=(3,), maxshape=(None,), dtype="f8", chunks=(10**8,), compression="gzip")


TYPE = "TimestepData/0/ParticleTypes/0"
CREATOR = "CreatorData/0/ParticleTypes/0"
BROKEN: list[tuple[Change, str]] = [
    (without("TimestepData"), "no group /TimestepData, and no folder"),
    (without("TimestepData/0"), "group /TimestepData holds no time step"),
    (without("TimestepData/0/ParticleTypes"), "group /TimestepData/0 has no group 'ParticleTypes'"),
    (without(f"{TYPE}/position"), f"group /{TYPE} has no dataset 'position'"),
    (without(f"{TYPE}/scale"), f"group /{TYPE} has no dataset 'scale'"),
    (without("CreatorData"), "no description of the particles, /CreatorData/0/ParticleTypes, in 0.h5"),
    (without(CREATOR), "group /CreatorData/0/ParticleTypes has no group '0'"),
    (without(f"{CREATOR}/spheres"), f"group /{CREATOR} has no spheres; only particles that are one sphere"),
    (replaced(f"{TYPE}/position", np.zeros((3, 2))), r"position has the shape \(3, 2\); expected \(n, 3\)"),
    (replaced(f"{TYPE}/position", np.zeros((3, 3), int)), "position holds int64; expected floating-point numbers"),
    (replaced(f"{TYPE}/position", np.full((3, 3), np.nan)), "sphere 0: centre .* is not finite .*id 2"),
    (replaced(f"{TYPE}/scale", np.ones(2)), r"scale has the shape \(2,\); expected \(3,\)"),
    (replaced(f"{TYPE}/scale", -np.ones(3)), r"sphere 0: radius -0\.0005.* m; expected a positive"),
    (replaced(f"{TYPE}/scale", h5py.Empty("f8")), r"scale has the shape None; expected \(3,\)"),
    (replaced(f"{TYPE}/ids", np.array([1, 2, 2])), "particles 1 and 2: both have the id 2"),
    (replaced(f"{TYPE}/ids", np.ones(3)), "ids holds float64; expected numbers"),
    (replaced(f"{CREATOR}/spheres", spheres(0.0005, (0.001, 0, 0))), r"shape \(2,\); only particles that are one"),
    (replaced(f"{CREATOR}/spheres", spheres(0.0)), "the physical radius is 0.0 m; expected a positive number"),
    (replaced(f"{CREATOR}/spheres", np.ones(1)), "spheres: no field 'pos'; it holds float64"),
    (replaced(f"{CREATOR}/spheres", spheres(5e-4, (1e-3, 0, 0))[1:]), r"the sphere lies at \[0\.001.*\] m in the"),
    (lambda f: f["TimestepData/0"].attrs.__setitem__("time", "late"), "the attribute 'time' is not a number"),
    (lambda f: f["TimestepData/0"].attrs.__setitem__("time", np.nan), "the attribute 'time' is nan; expected a finite"),
    (linked("CreatorData/0", h5py.ExternalLink("other.h5", "/")), "'0' is a link by name; only what the group itself"),
    (linked(TYPE, h5py.SoftLink("/TimestepData/0/ParticleTypes/1")), "'0' is a link by name"),
    (linked("TimestepData/0", h5py.SoftLink("/nowhere")), "'0' is a link by name"),
    (virtual, "position: its numbers lie in other files; these are not read"),
    (elsewhere, "position: its numbers lie in other files; these are not read"),
    (texts, "position holds object; expected floating-point numbers"),
    (huge, r"position has the shape \(1000000000000, 3\), 24000000000000 bytes, of which 0 bytes are stored"),
    (huge_chunk, r"scale has the shape \(100000000,\), 800000000 bytes"),
]


@pytest.mark.parametrize(("change", "message"), BROKEN, ids=[message[:50] for _, message in BROKEN])
def test_a_broken_layout_is_named(tmp_path: Path, change: Change, message: str) -> None:
    path = tmp_path / "0.h5"
    write_step(path, 0, 0.0, describe=True)
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(BadFileError, match=rf"0\.h5.*{message}"):
        read(path, TUBE)


def test_a_deck_without_its_files(tmp_path: Path) -> None:
    deck = write_deck(tmp_path)
    (tmp_path / "deck_data" / "1.h5").unlink()
    with pytest.raises(
        BadFileError, match=r"deck\.dem: num timesteps is 3, and deck_data/1\.h5 is missing; it holds 2"
    ):
        read(deck, TUBE)
    with h5py.File(deck, "r+") as file:
        file.attrs["num timesteps"] = 10**15
    with pytest.raises(BadFileError, match=r"num timesteps is 1000000000000000, and deck_data/1\.h5 is missing"):
        read(deck, TUBE)
    with h5py.File(deck, "r+") as file:
        file.attrs["num timesteps"] = 0
    with pytest.raises(BadFileError, match=r"deck\.dem: no time steps"):
        read(deck, TUBE)
    shutil.rmtree(tmp_path / "deck_data")
    with pytest.raises(BadFileError, match=r"deck\.dem: no group /TimestepData, and no folder deck_data"):
        read(deck, TUBE)


@pytest.mark.parametrize("frame", [3, -4, 10**9])
def test_a_frame_that_is_not_there(frame: int) -> None:
    with pytest.raises(BadFileError, match=f"frame {frame} was asked for; the file has 3, counted from 0"):
        read(DATA / "deck.dem", TUBE, frame=frame)


@pytest.mark.parametrize("kept", [16, 600, 2000, -200])
def test_a_cut_off_file(tmp_path: Path, kept: int) -> None:
    deck = write_deck(tmp_path)
    part = tmp_path / "deck_data" / "2.h5"
    part.write_bytes(part.read_bytes()[:kept])
    with pytest.raises(BadFileError, match=r"2\.h5: damaged or cut-off HDF5 file"):
        read(deck, TUBE)


def test_a_small_file_that_unpacks_to_much(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        full = file.create_dataset("zeros", data=np.zeros((2**20, 3)), compression="gzip")
        assert full.id.get_storage_size() * 200 < full.nbytes
        with pytest.raises(BadFileError, match="zeros has the shape"):
            read_array(full)
        # unless the caller knows that it is as long as it should be
        assert read_array(full, allowed=full.nbytes).shape == full.shape


NAMES = st.sampled_from(
    [f"{TYPE}/{name}" for name in ("position", "scale", "ids")]
    + [TYPE, CREATOR, f"{CREATOR}/spheres", "TimestepData/0", "CreatorData/0", "CreatorData"]
)
VALUES = st.sampled_from(
    [0, 1.5, "text", [], [1.0, 2.0, 3.0], np.zeros((3, 3)), np.zeros((0, 3)), [[1, 2]], np.array([b"x"]), spheres(1e-3)]
)


@settings(max_examples=60, derandomize=True, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(name=NAMES, value=VALUES)
def test_whatever_a_name_holds_is_read_or_refused(tmp_path: Path, name: str, value: object) -> None:
    path = tmp_path / "0.h5"
    write_step(path, 0, 0.0, describe=True)
    with h5py.File(path, "r+") as file:
        replaced(name, value)(file)
    try:
        held = read_edem(path)
    except BadFileError as error:
        assert str(error).startswith(str(path))  # noqa: PT017
    else:
        assert held.radii is not None
        assert held.centers.shape == (len(held.radii), 3)


def test_one_dataset_under_many_names_does_not_add_up(tmp_path: Path) -> None:
    path = write_deck(tmp_path).with_name("deck_data") / "0.h5"
    with h5py.File(path, "r+") as file:
        types, shapes = file["TimestepData/0/ParticleTypes"], file["CreatorData/0/ParticleTypes"]
        large = types.create_group("100")
        large.create_dataset("position", (300_000, 3), "f8", chunks=True)
        large.create_dataset("scale", (300_000,), "f8", chunks=True, fillvalue=1.0)
        for number in range(101, 200):
            types[str(number)] = large
            shapes[str(number)] = shapes["0"]
    with pytest.raises(BadFileError, match=r"0\.h5: its datasets hold \d+ bytes and more together, the file \d+"):
        read(path, TUBE)
