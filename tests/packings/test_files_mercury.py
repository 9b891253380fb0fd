"""Data and restart files of MercuryDPM, whole and broken."""

from __future__ import annotations

import gzip
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from bedrad import BadFileError, Tube, read
from bedrad.packings.files import FORMATS, read_frames
from bedrad.packings.files.mercury_data import iterate_mercury_data, looks_like_mercury_data, read_mercury_data
from bedrad.packings.files.mercury_restart import looks_like_mercury_restart, read_mercury_restart
from packings.file_mutations import mutated, takes_or_refuses

DATA = Path(__file__).parents[1] / "data" / "mercury"
TUBE = Tube(0.002)

# what every sample holds: four spheres in a ring beside the wall, and two above [mm]
RING = [(1.5, 0.0, 0.5, 0.5), (0.0, 1.5, 0.5, 0.5), (-1.5, 0.0, 0.5, 0.5), (0.0, -1.5, 0.5, 0.5)]
ABOVE = [(1.125, 1.125, 1.25, 0.375), (-1.0, -1.0, 1.5, 0.5)]

FRAME = """\
2 0.5 -1 -1 -2 1 1 3
0 0 2 0 0 -1 0.5 0 0 0 0 0 0 0
0 0 -1 0 0 -1 0.25 0 0 0 0 0 0 0
"""

STATE = """\
MercuryDPM 1.0 name small
xMin -1 xMax 1 yMin -1 yMax 1 zMin -2 zMax 3
timeStep 0.1 time 0.5 ntimeSteps 5 timeMax 1
systemDimensions 3 particleDimensions 3 gravity 0 0 -1
Species 1
LinearViscoelasticSpecies id 0 density 1
Walls 0
Boundaries 1
PeriodicBoundary id 0 normal 0 0 1 distanceLeft -2 distanceRight 3 shift 0 0 5
Particles 2
SphericalParticle id 9 indSpecies 0 position 0 0 2 velocity 0 0 -1 radius 0.5 invMass 1
SphericalParticle id 4 indSpecies 0 position 0 0 -1 velocity 0 0 -1 radius 0.25 invMass 1
Interactions 0
"""

OLD = """\
restart_version 3
name small
xmin -1 xmax 1 ymin -1 ymax 1 zmin -2 zmax 3
dt 0.1 t 0.5 tmax 1
dim 3 gravity 0 0 -1
Species 1
k 1 disp 1 rho 1 dim_particle 3
Walls 0
Boundaries 0
Particles 2
BP 0 0 2 0 0 -1 0.5 0 0 0 0 0 0 1 1 0 0
TSP BP 0 0 -1 0 0 -1 0.25 0 0 0 0 0 0 1 1 0 0
"""


def put(tmp_path: Path, text: str, name: str = "bed.data") -> Path:
    path = tmp_path / name
    path.write_text(text)
    return path


def assert_holds(path: Path, wanted: list[tuple[float, float, float, float]], frame: int = -1) -> None:
    packing = read(path, TUBE, frame=frame)
    got = np.column_stack([packing.centers, packing.radii])
    np.testing.assert_allclose(got, 1e-3 * np.array(wanted).reshape(-1, 4), rtol=1e-14, atol=1e-19)


@pytest.mark.parametrize("packed", [False, True])
def test_frames_by_number_from_both_ends(tmp_path: Path, packed: bool) -> None:
    path = DATA / "tube.data"
    if packed:
        path = tmp_path / "tube.data.gz"
        path.write_bytes(gzip.compress((DATA / "tube.data").read_bytes()))
    falling = [(x, y, z + 0.25, r) for x, y, z, r in RING]
    for frame, wanted in ((0, []), (1, falling), (2, [*RING, *ABOVE])):
        assert_holds(path, wanted, frame)
        assert_holds(path, wanted, frame - 3)
    assert [len(p) for p in read_frames(path, TUBE)] == [0, 4, 6]
    assert [p.provenance["time"] for p in read_frames(path, TUBE)] == [0.0, 0.05, 0.1]


def test_the_box_of_a_data_file_is_no_period() -> None:
    packing = read(DATA / "tube.data", TUBE)
    assert packing.period is None
    assert packing.provenance["format"] == "MercuryDPM data"
    assert packing.provenance["length_unit"] == "m, assumed"
    assert read(DATA / "tube.data", Tube(2e-6), unit="mm").radii[0] == pytest.approx(5e-7)


def test_rows_with_two_numbers_at_the_end(tmp_path: Path) -> None:
    packing = read(put(tmp_path, FRAME.replace(" 0\n", " 0 7\n")), Tube(1.0))
    assert packing.radii.tolist() == [0.5, 0.25]
    assert packing.centers[:, 2].tolist() == [2.0, -1.0]


def test_a_flat_frame_is_refused() -> None:
    with pytest.raises(BadFileError, match=r"flat\.data, line 1: a header of 6 numbers.*a two-dimensional frame"):
        read(DATA / "flat.data", TUBE)


def test_an_earlier_frame_needs_no_whole_end(tmp_path: Path) -> None:
    path = put(tmp_path, FRAME + FRAME[:-40])
    assert len(read(path, Tube(1.0), frame=0)) == 2
    with pytest.raises(BadFileError, match="frame 1 is cut off"):
        read(path, Tube(1.0))


def test_one_frame_is_in_memory_however_many_there_are(tmp_path: Path) -> None:
    row = "0.5 0.5 0.5 0 0 0 0.25 0 0 0 0 0 0 0\n"
    path = put(tmp_path, f"4000 0 0 0 0 1 1 1\n{row * 4000}" * 8)
    tracemalloc.start()
    try:
        frames = sum(1 for _ in iterate_mercury_data(path))
        read_mercury_data(path, -7)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert frames == 8
    # the text, fields and numbers of a frame are 5 MB while they are read; those of eight would be 40 MB
    assert peak < 10e6


@pytest.mark.parametrize(
    ("sample", "count", "period", "walls", "time"),
    [
        ("tube.restart", 6, 0.004, "1 AxisymmetricIntersectionOfWalls, 1 InfiniteWall", 0.1),
        ("version_1.restart", 2, None, None, 0.00601),
        ("version_3.restart", 3, 0.004, "1 InfiniteWall", 2.5),
    ],
)
def test_restart_files_of_every_form(
    sample: str, count: int, period: float | None, walls: str | None, time: float
) -> None:
    packing = read(DATA / sample, TUBE)
    wanted = {2: RING[:2], 3: [*RING[:2], ABOVE[0]], 6: [*RING, *ABOVE]}[count]
    assert_holds(DATA / sample, wanted)
    assert packing.period == period
    assert packing.provenance.get("walls_not_used") == walls
    assert packing.provenance["time"] == time


def test_particles_come_in_the_order_of_their_ids(tmp_path: Path) -> None:
    held = read_mercury_restart(put(tmp_path, STATE))
    assert held.ids.tolist() == [4, 9]
    assert held.lines.tolist() == [12, 11]
    assert held.axis_periods == {2: 5.0}
    assert held.centers[:, 2].tolist() == [-1.0, 2.0]


def test_keywords_may_stand_anywhere(tmp_path: Path) -> None:
    # a row of another form between those of one form
    text = STATE.replace(
        "SphericalParticle id 4 indSpecies 0 position 0 0 -1 velocity 0 0 -1 radius 0.25 invMass 1",
        "ThermalParticle temperature 300 radius 0.25 velocity 0 0 -1 position 0 0 -1 id 4",
    )
    held = read_mercury_restart(put(tmp_path, text))
    assert (held.centers[:, 2].tolist(), held.ids.tolist()) == ([-1.0, 2.0], [4, 9])
    assert held.radii is not None
    assert held.radii.tolist() == [0.25, 0.5]


@pytest.mark.parametrize(
    ("boundary", "periods", "unused"),
    [
        ("PeriodicBoundary normal 1 0 0 distanceLeft -1 distanceRight 1", {0: 2.0}, None),
        ("PeriodicBoundary normal 0 -1 0 scaleFactor 1 distanceLeft -1 distanceRight 1 shift 0 -2 0", {1: 2.0}, None),
        # planes at z = distance / 2, as the normal is two long
        ("PeriodicBoundary normal 0 0 2 distanceLeft 0 distanceRight 3", {2: 1.5}, None),
        ("PeriodicBoundary normal 0 0.6 0.8 distanceLeft 0 distanceRight 3", {}, "1 tilted PeriodicBoundary"),
        (
            "PeriodicBoundary normal 0 0 1 distanceLeft 0 distanceRight 3 shift 1 0 3",
            {},
            "1 tilted PeriodicBoundary",
        ),
        ("LeesEdwardsBoundary normal 0 0 1 shift 0 velocity 0", {}, "1 LeesEdwardsBoundary"),
        ("TimeDependentPeriodicBoundary normal 0 0 1 distanceLeft 0 distanceRight 3", {}, "1 TimeDependentPeriodic"),
    ],
)
def test_periodic_boundaries(tmp_path: Path, boundary: str, periods: dict[int, float], unused: str | None) -> None:
    old = "PeriodicBoundary id 0 normal 0 0 1 distanceLeft -2 distanceRight 3 shift 0 0 5"
    held = read_mercury_restart(put(tmp_path, STATE.replace(old, boundary)))
    assert held.axis_periods == pytest.approx(periods)
    assert str(held.provenance.get("boundaries_not_used")).startswith(str(unused))


def broken(old: str, new: str, text: str = FRAME) -> str:
    assert text.count(old) == 1
    return text.replace(old, new)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (broken("2 0.5 -1 -1 -2 1 1 3", "3 0.5 -1 -1 -2 1 1 3"), "frame 0 is cut off: 3 rows expected, 2 found"),
        (
            broken("0 0 2 0 0 -1 0.5 0 0 0 0 0 0 0", "0 0 2 0.5"),
            "line 2: 4 fields; a row of spheres has 14, or 15 in all of a frame",
        ),
        (broken("0 0 -1 0 0 -1 0.25", "0 nan -1 0 0 -1 0.25"), "line 3: y is 'nan'; expected a finite number"),
        (broken("0.25", "big"), "line 3: radius is 'big'; expected a number"),
        (broken("0.25", "-0.25"), r"sphere 1: radius -0\.25 m.* \(line 3\)"),
        (broken("0 0 -1 0 0 -1 0.25", "0.9 0 -1 0 0 -1 0.25"), r"sphere 1: .* through the tube wall.* \(line 3\)"),
        (broken("0 0 -1 0 0 -1 0.25", "0 0 2 0 0 -1 0.25"), r"spheres 0 and 1.* one point.* \(line 2 and line 3\)"),
        (broken("2 0.5", "2.0 0.5"), r"line 1: N is '2\.0'; expected the number of rows of frame 0, an integer"),
        (broken("2 0.5", "-2 0.5"), "line 1: N is '-2'; expected the number of rows"),
        (broken("2 0.5", "2 soon"), "line 1: time is 'soon'; expected a number"),
        (broken("-1 -1 -2 1 1 3", "-1 -1 3 1 1 -2"), r"line 1: the box of frame 0 reaches from 3\.0 to -2\.0 along z"),
        (broken("2 0.5", "999999999999 0.5"), "frame 0 is cut off: 999999999999 rows expected, 2 found"),
        (broken("2 0.5", "9" * 30 + " 0.5"), "line 1: N is '9{30}'"),
        (broken("-1 -1 -2 1 1 3", "-1 -1 -2 1 1"), "line 1: 7 fields; expected the header of frame 0"),
        ("\n\n", "no frame in the whole file"),
        (FRAME[: FRAME.index("\n0 0 -1") + 1] + "0 " * 2**20, "line 3: longer than 1048576 bytes"),
    ],
)
def test_broken_data_files_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    for frame in (0, -1):
        with pytest.raises(BadFileError, match=rf"bed\.data[:,] {message}"):
            read(put(tmp_path, text), Tube(1.0), frame=frame)


def test_wrong_counts_among_several_frames(tmp_path: Path) -> None:
    path = put(tmp_path, broken("2 0.5", "3 0.5") + FRAME)
    with pytest.raises(BadFileError, match=r"frame 0 is cut off: 3 rows .*, 2 found, line 4 is the header of another"):
        read(path, Tube(1.0), frame=0)
    with pytest.raises(BadFileError, match=r"line 5: 14 fields; expected the header of frame 1, .*frame 0 says 3 rows"):
        read(path, Tube(1.0))
    path = put(tmp_path, broken("2 0.5", "1 0.5") + FRAME)
    assert len(read(path, Tube(1.0), frame=0)) == 1
    with pytest.raises(BadFileError, match=r"line 3: 14 fields; expected the header of frame 1, .* rows after line 1"):
        read(path, Tube(1.0))


@pytest.mark.parametrize("frame", [1, 7, -2])
def test_a_frame_that_is_not_there(tmp_path: Path, frame: int) -> None:
    with pytest.raises(BadFileError, match=f"frame {frame} was asked for; the file has 1, counted from 0"):
        read(put(tmp_path, FRAME), Tube(1.0), frame=frame)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (broken("Particles 2", "Particles 3", STATE), r"line 13: 'Interactions': no 'id' with 1 numbers after it"),
        (broken("Particles 2", "Particles 999999999999", OLD), "cut off: 999999999999 particles expected, 2 found"),
        (broken("Particles 2", "Particles two", STATE), "line 10: the number of particles is 'two'; expected an integ"),
        (STATE[: STATE.index("Particles 2")], "no 'Particles' in the whole file, which ends after line 9"),
        (broken("id 4", "id 9", STATE), "lines 11 and 12: both have the id 9"),
        (broken("id 4", "id 4.5", STATE), r"line 12: id is 4\.5; expected an integer"),
        (broken("radius 0.25", "size 0.25", STATE), "line 12: 'SphericalParticle': no 'radius' with 1 numbers"),
        (broken("radius 0.25", "radius thick", STATE), "line 12: radius is 'thick'; expected a number"),
        (broken("radius 0.25", "radius -1", STATE), r"sphere 0: radius -1\.0 m.* \(line 12, id 4\)"),
        (broken("position 0 0 -1", "position 0 inf -1", STATE), "line 12: y is 'inf'; expected a finite number"),
        (
            broken("SphericalParticle id 4", "SuperQuadricParticle id 4", STATE),
            "line 12: SuperQuadricParticle; expected a spherical particle",
        ),
        (broken("systemDimensions 3", "systemDimensions 2", STATE), "a state in 2 dimensions; only spheres in space"),
        (broken("dim 3", "dim 2", OLD), "a state in 2 dimensions; only spheres in space"),
        (broken("distanceRight 3", "distanceRight -3", STATE), r"line 9: PeriodicBoundary: distanceLeft is -2\.0 and"),
        (broken("distanceRight 3", "", STATE), "line 9: PeriodicBoundary without 'distanceRight'"),
        (
            broken("normal 0 0 1", "normal 0 0 0", STATE),
            r"line 9: PeriodicBoundary: the normal is \[0\.0, 0\.0, 0\.0\]",
        ),
        (broken("normal 0 0 1", "normal 0 0 up", STATE), "line 9: normal is 'up'; expected a number"),
        (broken("Particles 2", STATE.splitlines()[8] + "\nParticles 2", STATE), "line 10: a second PeriodicBoundary"),
        (broken("time 0.5", "time now", STATE), "line 3: time is 'now'; expected a number"),
        (broken("restart_version 3", "restart_version 2", OLD), "line 1: restart_version is '2'; those that are read"),
        (broken("TSP BP 0 0 -1", "TSP BP MP 0 0 -1", OLD), "line 12: expected a particle, such as 'BP' and then x y"),
        (broken("BP 0 0 2 0 0 -1 0.5", "BP 0 0 2 0 0 fast 0.5", OLD), None),
        (broken("BP 0 0 2 0 0 -1 0.5", "BP 0 zero 2 0 0 -1 0.5", OLD), "line 11: y is 'zero'; expected a number"),
    ],
)
def test_broken_restart_files_name_the_line(tmp_path: Path, text: str, message: str | None) -> None:
    path = put(tmp_path, text, "bed.restart")
    if message is None:
        # velocities are not looked at
        assert len(read(path, Tube(1.0))) == 2
        return
    with pytest.raises(BadFileError, match=rf"bed\.restart[:,] {message}"):
        read(path, Tube(1.0))


def test_a_restart_file_holds_one_frame() -> None:
    with pytest.raises(BadFileError, match=r"frame 1 was asked for; a MercuryDPM restart file holds one packing"):
        read(DATA / "tube.restart", TUBE, frame=1)


@pytest.mark.parametrize("sample", ["tube.data", "tube.restart"])
def test_a_cut_off_gzip_file(tmp_path: Path, sample: str) -> None:
    path = tmp_path / f"{sample}.gz"
    path.write_bytes(gzip.compress((DATA / sample).read_bytes())[:-40])
    with pytest.raises(BadFileError, match=r"\.gz: broken or cut-off gzip file"):
        read(path, TUBE)


def test_each_sample_is_told_by_its_content() -> None:
    names = {
        "tube.data": "MercuryDPM data",
        "flat.data": "MercuryDPM data",
        "tube.restart": "MercuryDPM restart",
        "version_1.restart": "MercuryDPM restart",
        "version_3.restart": "MercuryDPM restart",
    }
    for sample, name in names.items():
        head = (DATA / sample).read_bytes()[:8192]
        assert next(form.name for form in FORMATS if form.recognises(head)) == name
        assert looks_like_mercury_data(head) == (name == "MercuryDPM data")
        assert looks_like_mercury_restart(head) == (name == "MercuryDPM restart")


@pytest.mark.parametrize(
    "head",
    [
        b"",
        b"1 2 3 4\n5 6 7 8\n",
        # eight columns, as many as a header has
        b"0 0.1 0.2 0.001 2500 0 0 0\n0.1 0.1 0.2 0.001 2500 0 0 0\n",
        b"3 0 0 0 0 1 1 1\n1 2 3 4 5 6 7 8\n",
        b"3 0 0 0 0 1 1 one\n",
        b"MercuryDPM",
        b"restart_versions\n",
        b"x,y,z\n",
    ],
)
def test_what_is_not_of_mercury(head: bytes) -> None:
    assert not looks_like_mercury_data(head)
    assert not looks_like_mercury_restart(head)


@given(data=mutated([(FRAME + FRAME).encode()]), other=mutated([STATE.encode(), OLD.encode()]))
def test_damaged_files_are_taken_or_refused(
    tmp_path_factory: pytest.TempPathFactory, data: bytes, other: bytes
) -> None:
    takes_or_refuses(tmp_path_factory.getbasetemp() / "damaged.data", data)
    takes_or_refuses(tmp_path_factory.getbasetemp() / "damaged.restart", other)


def test_a_boundary_whose_normal_is_almost_nothing(tmp_path: Path) -> None:
    text = (DATA / "tube.restart").read_text()
    line = next(line for line in text.splitlines() if line.startswith("PeriodicBoundary"))
    words = line.split()
    at = words.index("normal")
    words[at + 1 : at + 4] = ["1e-320", "1e308", "0"]
    (tmp_path / "a.restart").write_text(text.replace(line, " ".join(words)))
    assert read(tmp_path / "a.restart", TUBE, max_overlap=2.0).period is None
