"""The command that measures: what it prints, writes, draws and refuses."""

import builtins
import csv
import hashlib
import json
import re

import h5py
import pytest

import bedrad
from jobs.small_job import DIAMETER, WALL, ring_bed

TABLES = {"statistics", "layers", "contacts", "profile", "centres", "nc_gaps", "coordination", "unrolled_wall"}
FIGURES = {"profile", "unrolled_wall"}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Tables and figures go to the working folder."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def write_dump(path, beds):
    with path.open("w") as stream:
        for step, bed in enumerate(beds):
            high = bed.period
            stream.write(f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(bed)}\n")
            stream.write(f"ITEM: BOX BOUNDS ff ff pp\n-1 1\n-1 1\n0 {high!r}\nITEM: ATOMS id x y z radius\n")
            for number, center in enumerate(bed.centers.tolist()):
                stream.write(" ".join(map(repr, (number + 1, *center, DIAMETER / 2))) + "\n")


@pytest.fixture
def flow(tmp_path):
    """A trajectory of three frames."""
    beds = [ring_bed(seed) for seed in (1, 2, 3)]
    write_dump(tmp_path / "flow.dump", beds)
    return tmp_path / "flow.dump", beds


@pytest.fixture
def undrawn(monkeypatch):
    """Figures that are only named: drawing takes a second."""

    def write(_, unrolled, stem, name):
        paths = [stem.with_name(f"{stem.name}_{figure}.png") for figure in sorted(FIGURES)]
        for path in paths:
            path.touch()
        return paths

    monkeypatch.setattr("bedrad.report.statistics_figures.write_statistics_figures", write)


TUBE = ("--tube", f"{2e3 * WALL.radius!r} mm")


def named(folder, stem):
    return {path.suffix[1:] + " " + path.stem.removeprefix(f"{stem}_") for path in folder.glob(f"{stem}_*")}


EVERYTHING = {f"csv {name}" for name in TABLES} | {f"png {name}" for name in FIGURES}


def rows(path):
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_one_screen_with_the_numbers_of_python(call, undrawn, bed):
    code, out, err = call("statistics", bed)
    assert (code, err) == (0, [])
    lines = out.splitlines()
    assert 24 <= len(lines) <= 40
    assert max(len(line.rstrip()) for line in lines if not line.startswith("wrote ")) <= 80
    assert "…" not in out
    found = bedrad.statistics(bedrad.read(bed))
    assert lines[0] == "tube of 7.74 mm, A = 12.9; 1,212 spheres"
    for name, start in (("packing_fraction", "solid fraction phi_wa"), ("nc_share", "share of no-contact"),
                        ("nc_distance", "NC distance a"), ("hexagonal_order", "hexagonal order")):  # fmt: skip
        line = next(line for line in lines if line.strip().startswith(start))
        value, error = map(float, re.search(r"([\d.]+) ± ([\d.]+)", line).groups())
        assert value == pytest.approx(getattr(found, name), abs=0.6 * 10.0 ** -len(f"{value}".split(".")[1]))
        assert error == pytest.approx(getattr(found, name + "_error"), rel=0.05)
    gaps = [line.split()[0] for line in lines if re.match(r" 0(\.\d+)? +\d+\.\d+ ±", line)]
    assert gaps == ["0", "0.001", "0.01"]


def test_tables_and_figures_are_named_after_the_bed(call, bed, elsewhere):
    code, out, _ = call("statistics", bed)
    assert code == 0
    assert named(elsewhere, "bed") == EVERYTHING
    assert [line for line in out.splitlines() if line.startswith("wrote ")] == [
        f"wrote bed_*.csv: {', '.join(('statistics', 'layers', 'contacts', 'profile', 'centres', 'nc_gaps'))}, "
        "coordination, unrolled_wall",
        "wrote bed_*.png: profile, unrolled_wall",
    ]


@pytest.mark.parametrize(
    ("words", "folder", "stem"),
    [
        (("--stem", "new/x"), "new", "x"),
        (("--stem", "new/x.png"), "new", "x"),
        (("-o", "deep/r.h5"), "deep", "r"),
        (("-o", "deep/r.h5", "--stem", "new/x"), "new", "x"),
    ],
)
def test_or_as_told(call, undrawn, bed, elsewhere, words, folder, stem):
    assert call("statistics", bed, *words)[0] == 0
    assert named(elsewhere / folder, stem) == EVERYTHING


def test_nothing_is_written_if_only_printing_was_asked_for(call, bed, elsewhere):
    code, out, _ = call("statistics", bed, "--print-only")
    assert (code, "wrote" in out) == (0, False)
    assert list(elsewhere.iterdir()) == []


def test_tables_hold_what_was_measured(call, undrawn, bed, elsewhere):
    call("statistics", bed, "--contact-gap", "0.02")
    found = bedrad.statistics(bedrad.read(bed), contact_gap=0.02)
    contacts = rows(elsewhere / "bed_contacts.csv")
    for heading, name in (("contact ratio [1]", "contact_ratio_by_gap"),
                          ("no-contact share [1]", "nc_share_by_gap")):  # fmt: skip
        assert [float(row[heading]) for row in contacts] == getattr(found, name).tolist()
    gaps = rows(elsewhere / "bed_nc_gaps.csv")
    heading = "share of no-contact particles per gap [1/particle radius]"
    assert [float(row[heading]) for row in gaps] == found.nc_gap_density.tolist()
    wall = rows(elsewhere / "bed_unrolled_wall.csv")
    assert len(wall) == found.contacts + found.no_contacts
    assert sum(int(row["contact"]) for row in wall) == found.contacts
    profile = rows(elsewhere / "bed_profile.csv")
    # as deep as the centres of the fourth ring, a tenth of a radius each
    assert len(profile) == 76
    assert float(profile[0]["mean radial position [m]"]) == pytest.approx(WALL.radius - 0.05 * DIAMETER / 2)
    assert float(profile[12]["solid fraction [1]"]) == pytest.approx(found.profile[12], rel=1e-9)


def test_a_depth_can_be_given(call, undrawn, bed, elsewhere):
    assert call("statistics", bed, "--depth", "0.9mm")[0] == 0
    assert len(rows(elsewhere / "bed_profile.csv")) == 30


# Flows


def test_a_velocity_brings_the_correlations(call, undrawn, bed, elsewhere):
    code, out, _ = call("statistics", bed, "--velocity", "0.05 m/s")
    assert code == 0
    assert "Against Watkins (2018) for a flow at 0.05 m/s" in out
    assert re.search(r"phi_wa +0\.\d+ ± [\d.]+ +0\.4\d\d +[+-][\d.]+ % +[+-][\d.]+ SE +5 %", out)
    assert len(re.findall(r"n_C/n_C,max at [\d.]+ r", out)) == 3
    assert len(rows(elsewhere / "bed_correlations.csv")) == 4
    assert len(out.splitlines()) <= 40


def test_so_does_a_file_that_names_its_own(call, tmp_path):
    bed = ring_bed()
    notes = {"mean_velocity_m_per_s": 0.037}
    bedrad.write(bedrad.Packing(bed.centers, bed.radii, bed.wall, bed.period, notes), tmp_path / "flow.h5")
    assert "for a flow at 0.037 m/s" in call("statistics", tmp_path / "flow.h5", "--print-only")[1]
    # what is given goes first
    assert "at 0.05 m/s" in call("statistics", tmp_path / "flow.h5", "--print-only", "--velocity", "0.05m/s")[1]


def test_all_frames_are_averaged(call, undrawn, flow, tmp_path):
    path, beds = flow
    code, out, _ = call("statistics", path, *TUBE, "--all-frames", "-o", tmp_path / "r.h5", "--stem", "x")
    assert code == 0
    assert out.startswith("tube of 7.74 mm, A = 12.9; 3,636 spheres, mean over 3 frames\n")
    direct = bedrad.statistics(beds)
    with h5py.File(tmp_path / "r.h5") as file:
        group = file["statistics"]
        assert group["frames"][()] == 3
        assert group["nc_distance"][()] == pytest.approx(direct.nc_distance, rel=1e-9)
        assert group["nc_distance_error"][()] == pytest.approx(direct.nc_distance_error, rel=1e-6)
        assert 1 <= group["nc_distance_structures"][()] <= 3
        assert group["nc_distance_structures"].attrs["long_name"].startswith("independent structures behind: mean gap")
        assert group["coordination_by_gap_structures"].shape == (3, 5)
        assert (group.attrs["wall"], group.attrs["wall_radius"]) == ("tube", WALL.radius)
    assert re.search(r"measured +structures", out)
    assert float(rows(tmp_path / "here" / "x_statistics.csv")[0]["no-contact share independent structures [1]"]) >= 1


def test_frames_of_several_files_come_together(call, flow, tmp_path):
    path, beds = flow
    write_dump(tmp_path / "one.dump", beds[:1])
    write_dump(tmp_path / "two.dump", beds[1:])
    _, whole, _ = call("statistics", path, *TUBE, "--all-frames", "--print-only")
    _, parts, _ = call("statistics", tmp_path / "one.dump", tmp_path / "two.dump", *TUBE, "--print-only")

    def timeless(out):
        return re.sub(r"[\d.]+ s\n", "", out)

    assert timeless(parts) == timeless(whole)
    # one frame is the last, if not told otherwise
    _, last, _ = call("statistics", path, *TUBE, "--print-only")
    assert "mean over" not in last


def test_a_pattern_is_all_its_files(call, undrawn, flow, tmp_path, elsewhere):
    _, beds = flow
    for k, bed in enumerate(beds):
        write_dump(tmp_path / f"part_{k}.dump", [bed])
    code, out, _ = call("statistics", tmp_path / "part_*.dump", *TUBE)
    assert (code, "mean over 3 frames" in out) == (0, True)
    assert named(elsewhere, "part") == EVERYTHING


@pytest.mark.parametrize(
    "words", [["part_0.dump", "part_1.dump", "part_2.dump"], ["part_*.dump"], [".", "--all-frames"]]
)
def test_the_mean_over_several_files_is_kept_with_their_checksums(call, undrawn, flow, tmp_path, words):
    path, beds = flow
    folder = tmp_path / "parts"
    folder.mkdir()
    for k, bed in enumerate(beds):
        write_dump(folder / f"part_{k}.dump", [bed])
    given = [word if word.startswith("--") else folder / word for word in words]
    assert call("statistics", *given, *TUBE, "-o", tmp_path / "r.h5")[0] == 0
    assert call("statistics", path, *TUBE, "--all-frames", "-o", tmp_path / "one.h5")[0] == 0
    with h5py.File(tmp_path / "r.h5") as several, h5py.File(tmp_path / "one.h5") as one:
        assert json.loads(several.attrs["inputs"]) == {
            str(folder / f"part_{k}.dump"): hashlib.sha256((folder / f"part_{k}.dump").read_bytes()).hexdigest()
            for k in range(3)
        }
        assert several["statistics"].keys() == one["statistics"].keys()
        for name in ("packing_fraction", "packing_fraction_error", "nc_distance_structures"):
            assert several[f"statistics/{name}"][()] == one[f"statistics/{name}"][()]


# Refusals


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--contact-gap -1", r"contact_gap is -1\.0"),
        ("--depth 0mm", "rise"),
        ("--depth 9mm", "the last edge is 0.009 m; the deepest point"),
        ("--velocity 5mm", "--velocity: '5mm' has the wrong kind of unit"),
        ("--velocity=-1m/s", r"velocity is -1\.0 m/s; expected a number"),
    ],
)
def test_a_wrong_word_is_one_line_and_exit_code_2(refused, bed, elsewhere, options, message):
    assert re.search(message, refused(2, "statistics", bed, *options.split()))
    assert list(elsewhere.iterdir()) == []


def test_a_place_that_cannot_be_written_shows_before_the_measuring(refused, bed, monkeypatch):
    monkeypatch.setattr("bedrad.packings.statistics.statistics", lambda *_, **__: pytest.fail("it was measured"))
    assert refused(1, "statistics", bed, "--stem", bed / "x").endswith("cannot write: Not a directory")


def test_without_matplotlib_everything_but_the_figures_is_there(call, bed, elsewhere, monkeypatch):
    plain = builtins.__import__

    def without(name, *rest):
        if name.split(".")[0] == "matplotlib":
            raise ImportError
        return plain(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    code, out, _ = call("statistics", bed)
    assert code == 0
    assert out.splitlines()[-1] == (
        'left out: figures: matplotlib is not installed; install it with: pip install "bedrad[view]"'
    )
    assert named(elsewhere, "bed") == {f"csv {name}" for name in TABLES}


def test_a_dry_run_measures_and_writes_nothing(call, bed, elsewhere, monkeypatch):
    monkeypatch.setattr("bedrad.packings.statistics.statistics", lambda *_, **__: pytest.fail("it was measured"))
    code, out, _ = call("statistics", bed, "--dry-run", "--stem", "deep/x", "--velocity", "0.05m/s")
    assert (code, out.splitlines()[0]) == (0, str(ring_bed()))
    assert list(elsewhere.iterdir()) == []
