"""Packings written as text and read again: every bit of every number, and whatever the provenance says."""

from __future__ import annotations

import gzip
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bedrad import Packing, Plate, Rod, Tube, read, write
from bedrad.packings.files import FORMATS, facts, lines, rows
from bedrad.packings.files.text import first_bytes

DATA = Path(__file__).parents[1] / "data"
SUFFIXES = (".xyz", ".yade", ".lmp")
AWKWARD = {
    "quotes": """it's a "bed" of 'spheres'""",
    "signs": "\\ \\n \n \t # { } [ ] = , :",
    "radius µm": "3 · 10⁻⁶ \N{LINE SEPARATOR}",
    "number": 0.1 + 0.2,
    "count": -(2**63),
    "tiny": 5e-324,
    "empty": "",
    "wall: plate": "# wall: plate",
}


def beds() -> list[Packing]:
    rng = np.random.default_rng(3)
    turn = rng.random(9) * math.tau
    around = np.stack([np.cos(turn), np.sin(turn), np.arange(9) + rng.random(9) * 0.1], axis=1)
    radii = 0.3 + 0.1 * rng.random(9)
    return [
        Packing(around * [2.5, 2.5, 1 / 3 * 3], radii, Tube(1 / 0.3), 9.5, AWKWARD, 0.05),
        Packing(around * [2.5, 2.5, 1], radii, Rod(2.0), None, {"seed": 3}),
        Packing(around * 1e-3, radii * 1e-3, Plate(), (0.0031, 0.00321), {}, 1.9),
        Packing(np.abs(around) * 1e-3 + 0.7e-3, radii * 1e-3, Plate()),
        Packing(np.empty((0, 3)), np.empty(0), Tube(0.1), 0.3),
        Packing(np.empty((0, 3)), np.empty(0), Plate()),
    ]


def same(back: Packing, bed: Packing) -> None:
    assert back.centers.tobytes() == bed.centers.tobytes()
    assert back.radii.tobytes() == bed.radii.tobytes()
    assert (back.wall, back.period, back.max_overlap) == (bed.wall, bed.period, bed.max_overlap)
    assert dict(back.provenance) == dict(bed.provenance)
    assert [type(value) for value in back.provenance.values()] == [type(value) for value in bed.provenance.values()]


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("bed", beds(), ids=["tube", "rod", "plate", "open plate", "empty", "empty plate"])
def test_every_bit_comes_back(tmp_path: Path, bed: Packing, suffix: str) -> None:
    write(bed, tmp_path / f"a{suffix}")
    same(read(tmp_path / f"a{suffix}"), bed)
    # told by its content under any name, and packed
    (tmp_path / "b.gz").write_bytes(gzip.compress((tmp_path / f"a{suffix}").read_bytes()))
    same(read(tmp_path / "b.gz"), bed)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_unit_beside_metres_is_refused(tmp_path: Path, suffix: str) -> None:
    write(beds()[1], tmp_path / f"a{suffix}")
    with pytest.raises(ValueError, match=rf"the unit 'mm' was given, but .*a{suffix} states the unit"):
        read(tmp_path / f"a{suffix}", unit="mm")


@settings(max_examples=50)
@given(
    st.sampled_from(SUFFIXES),
    st.lists(st.floats(-1e150, 1e150), min_size=3, max_size=3),
    st.floats(1e-150, 1e150),
    st.dictionaries(st.text(), st.text() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False), max_size=3),
)
def test_any_number_comes_back(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, center: list[float], radius: float, notes: dict[str, object]
) -> None:
    path = tmp_path_factory.getbasetemp() / f"any{suffix}"
    # one sphere above a plate may be anywhere above it
    center[2] = max(abs(center[2]), radius)
    notes.pop("density_kg_per_m3", None)
    bed = Packing([center], radius, Plate(), None, notes)  # type: ignore[arg-type]
    write(bed, path)
    same(read(path), bed)


@pytest.mark.parametrize("suffix", [*SUFFIXES, ".csv"])
def test_a_provenance_too_long_for_a_line_is_refused(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(facts, "_LONGEST", 40)
    with pytest.raises(ValueError, match=r"the provenance takes \d+ characters; text formats hold 40"):
        write(beds()[0], tmp_path / f"a{suffix}")
    assert list(tmp_path.iterdir()) == []


def test_blocks_of_rows_make_no_difference(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bed = beds()[1]
    write(bed, tmp_path / "a.yade")
    monkeypatch.setattr(rows, "_ROWS_AT_ONCE", 4)
    same(read(tmp_path / "a.yade"), bed)
    monkeypatch.setattr(lines, "_BLOCK", 1)
    same(read(tmp_path / "a.yade"), bed)


@pytest.mark.parametrize(
    ("folder", "name"),
    [("yade", "YADE text"), ("extended_xyz", "xyz"), ("npz", "npz"), ("lammps_data", "LAMMPS data")],
)
def test_the_content_tells_the_format_of_every_sample(folder: str, name: str) -> None:
    samples = [path for path in (DATA / folder).iterdir() if path.suffix != ".md"]
    assert len(samples) >= 3
    for path in samples:
        claimed = [form.name for form in FORMATS if form.recognises(first_bytes(path))]
        # a table of points is tried last: YADE's comments are comments to it too
        assert [other for other in claimed if other != "table of points"] == [name], path.name
