"""Packings as VTK's PolyData, written by bedrad and read back."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from bedrad import BadFileError, Packing, Plate, Rod, Tube, read, write
from bedrad.packings.files.vtk_xml import read_vtk_xml
from bedrad.packings.files.vtp_writer import write_vtp
from packings.vtk_samples import collection, put


def some_bed(wall: Tube | Rod | Plate, period: float | tuple[float, float] | None) -> Packing:
    rng = np.random.default_rng(7)
    places = np.stack(np.meshgrid(*3 * [np.arange(3.0)], indexing="ij"), axis=-1).reshape(-1, 3)
    centers = (places + np.array([4.0, 4.0, 1.0])) * 1e-3 + rng.uniform(-1e-4, 1e-4, (27, 3))
    notes = {"text": 'é <&>" \n\x00', "float": 0.1, "integer": 2**62, "none": float("inf")}
    return Packing(centers, rng.uniform(3e-4, 4e-4, 27), wall, period, notes, 0.0123456789012345)


@pytest.mark.parametrize(
    ("wall", "period"),
    [(Tube(0.01 / 3 + 0.01), None), (Tube(0.0123), 0.0049), (Rod(1e-3 / 7), 0.0049), (Plate(), (0.1 / 3, 0.2 / 3))],
)
def test_round_trips_bit_for_bit(tmp_path: Path, wall: Tube | Rod | Plate, period: float | None) -> None:
    bed = some_bed(wall, period)
    write(bed, tmp_path / "bed.vtp")
    back = read(tmp_path / "bed.vtp")
    assert back.centers.tobytes() == bed.centers.tobytes()
    assert back.radii.tobytes() == bed.radii.tobytes()
    assert (back.wall, back.period, back.max_overlap) == (bed.wall, bed.period, bed.max_overlap)
    assert dict(back.provenance) == dict(bed.provenance)
    assert read_vtk_xml(tmp_path / "bed.vtp").states_unit
    # also out of a collection, which has a time of its own but no better knowledge
    path = put(tmp_path, collection("bed.vtp"), "bed.pvd")
    assert read(path).centers.tobytes() == bed.centers.tobytes()
    assert dict(read(path).provenance) == dict(bed.provenance)


def test_an_empty_bed(tmp_path: Path) -> None:
    write(Packing(np.zeros((0, 3)), np.zeros(0), Tube(0.01)), tmp_path / "bed.vtp")
    back = read(tmp_path / "bed.vtp")
    assert (len(back), back.wall) == (0, Tube(0.01))


def test_more_about_every_sphere(tmp_path: Path) -> None:
    bed = some_bed(Tube(0.0123), None)
    arrays = {"layer": np.arange(27, dtype=np.int8), "a <b> & \"c'": bed.centers, "near": bed.centers[:, 0] > 5e-3}
    write_vtp(bed, tmp_path / "bed.vtp", arrays)
    assert read(tmp_path / "bed.vtp").radii.tobytes() == bed.radii.tobytes()
    content = (tmp_path / "bed.vtp").read_bytes()
    head = content[: content.index(b"<AppendedData")].decode()
    # the declared arrays follow each other, each after its own count of bytes
    start = content.index(b"_", len(head)) + 1
    expected = [
        bed.centers,
        bed.radii,
        np.arange(27),
        np.arange(27),
        bed.centers,
        arrays["near"],
        np.arange(27),
        np.arange(1, 28),
    ]
    kinds = ["<f8", "<f8", "<i8", "<i8", "<f8", "u1", "<i8", "<i8"]
    for values, kind in zip(expected, kinds, strict=True):
        data = np.asarray(values, dtype=kind).tobytes()
        assert f'offset="{start - content.index(b"_", len(head)) - 1}"' in head
        assert content[start : start + 8] == struct.pack("<Q", len(data))
        assert content[start + 8 : start + 8 + len(data)] == data
        start += 8 + len(data)
    assert content[start:] == b"\n  </AppendedData>\n</VTKFile>\n"
    assert '<DataArray type="Float64" Name="a &lt;b&gt; &amp; ' in head


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("flux", np.zeros(26), r"the array 'flux' has the shape \(26,\); expected \(27,\) or \(27, 3\)"),
        ("flux", np.zeros((27, 2)), r"has the shape \(27, 2\)"),
        ("flux", np.array(27 * ["a"]), "the array 'flux' holds <U1; expected floats, integers below"),
        ("flux", np.zeros(27, dtype=np.uint64), "the array 'flux' holds uint64"),
        ("flux", np.zeros(27, dtype=complex), "the array 'flux' holds complex128"),
        ("Diameter", np.zeros(27), "the array 'Diameter': expected a printable name that says nothing about sizes"),
        ("id", np.zeros(27), "the array 'id': expected"),
        ("", np.zeros(27), "the array '': expected a printable name"),
        ("a\nb", np.zeros(27), "expected a printable name"),
    ],
)
def test_arrays_that_cannot_be_written(tmp_path: Path, name: str, values: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        write_vtp(some_bed(Plate(), None), tmp_path / "bed.vtp", {name: values})
    assert not (tmp_path / "bed.vtp").exists()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("116 117 98 101", "116 117 98 102", r"wall 'tubf radius=0\.0123 m' is not understood: the wall is 'tubf'"),
        ("116 117 98 101", "999 117 98 101", "'bedrad_wall': expected a text, one byte a number"),
        ("116 117 98 101", "nan 117 98 101", "'bedrad_wall': expected a text, one byte a number"),
        ("116 117 98 101", "-61 -87 98 101", "wall 'é"),
        (
            '"String" Name="bedrad_wall"',
            '"Int8" Name="bedrad_wall"',
            "'bedrad_wall' has the type 'Int8'; expected String",
        ),
        ("123 34 116", "123 123 123", "provenance .* is not understood"),
    ],
)
def test_facts_that_are_not_understood(tmp_path: Path, old: str, new: str, message: str) -> None:
    write(some_bed(Tube(0.0123), None), tmp_path / "bed.vtp")
    content = (tmp_path / "bed.vtp").read_bytes()
    assert content.count(old.encode()) == 1
    with pytest.raises(BadFileError, match=rf"bed\.vtp.*{message}"):
        read(put(tmp_path, content.replace(old.encode(), new.encode())))


@pytest.mark.parametrize("count", [1, 3])
def test_damaged_files_of_bedrad(tmp_path: Path, count: int) -> None:
    write(some_bed(Tube(0.0123), 0.0049), tmp_path / "bed.vtp")
    content = (tmp_path / "bed.vtp").read_bytes()
    rng = np.random.default_rng(count)
    refused = 0
    for _ in range(80):
        data = bytearray(content)
        for at in rng.integers(0, len(data), count):
            data[at] = int(rng.integers(0, 256))
        try:
            read_vtk_xml(put(tmp_path, bytes(data)))
        except BadFileError:
            refused += 1
    assert 0 < refused < 80
