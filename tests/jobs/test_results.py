from __future__ import annotations

import errno
import hashlib
import json
import os
from datetime import UTC, datetime, timedelta
from pathlib import Path

import h5py
import numpy as np
import pytest

import bedrad
from bedrad.errors import BadFileError
from bedrad.jobs.job import load_job
from bedrad.jobs.results import (
    SCHEMA_VERSION,
    Results,
    check_record_file,
    check_writable,
    save_fields,
    save_record,
    sha256_of,
)
from jobs.small_job import STAGES, WALL, ring_bed

FIELDS = {"share": ("1", "a share"), "depths": ("m", "some depths"), "absent": ("1", "nothing")}
KNOWN_UNITS = {"1", "m", "s", "K", "m/s", "1/m2", "1/m3", "W/(m K)", "W/(m2 K)", "SI"}


def write(results, stage="statistics", value=1.0, keep=(), digest="d", **attributes):
    def fill(group):
        group["value"] = value

    results.write_stage(stage, digest, fill, keep=keep, attributes={"job": "{}", "inputs": "{}"} | attributes)


# What a finished run holds


def test_every_dataset_of_a_run_has_units_and_a_long_name(finished):
    seen = []

    def check(name, item):
        if isinstance(item, h5py.Dataset):
            seen.append(name)
            assert item.attrs["units"] in KNOWN_UNITS, name
            assert len(item.attrs["long_name"]) > 5, name

    with h5py.File(finished / "results.h5") as file:
        file.visititems(check)
        assert set(file) == set(STAGES)
    # that the walk reached every stage, and the cases of the prediction
    assert {name.split("/")[0] for name in seen} == set(STAGES)
    assert "prediction/measured/heat_transfer_coefficient" in seen
    assert "statistics/packing_fraction_error" in seen


def test_the_file_says_what_was_run_when_by_what_and_from_what(finished):
    found = Results(finished / "results.h5").attributes()
    assert found["schema_version"] == SCHEMA_VERSION
    assert found["bedrad_version"] == bedrad.__version__
    assert timedelta(0) <= datetime.now(UTC) - datetime.fromisoformat(found["created"]) < timedelta(minutes=30)
    (path, digest), *others = json.loads(found["inputs"]).items()
    assert Path(path).name == "bed.h5"
    assert digest == hashlib.sha256((finished / "bed.h5").read_bytes()).hexdigest()
    assert not others
    job = json.loads(found["job"])
    assert (job["name"], job["seed"], job["view_factors"]["rays"]) == ("rings", 3, 4096)
    # defaults are in it too, in SI units
    assert job["layers"] == {"count": 3, "margin": 4.0}
    assert job["prediction"]["velocity"] == 0.016


def test_the_bed_and_the_measured_numbers_come_back(finished):
    results = Results(finished / "results.h5")
    bed = bedrad.read(results.path)
    np.testing.assert_array_equal(bed.centers, ring_bed().centers)
    assert bed.wall == WALL
    found = results.read("statistics")
    direct = bedrad.statistics(bed)
    assert found["packing_fraction"] == direct.packing_fraction
    np.testing.assert_array_equal(found["packing_fractions"], direct.packing_fractions)
    traced = results.read("view_factors")
    # every ray ends somewhere
    assert traced["layers"].sum() + traced["beyond"] + traced["wall"] + traced["escaped"] == pytest.approx(1, abs=1e-12)
    # and the prediction took what was measured and traced, not the correlations
    case = results.read("prediction")["measured"]
    assert case["packing_fraction"] == direct.packing_fraction
    np.testing.assert_array_equal(case["view_factors"], traced["layers"])


def test_a_stage_that_is_not_there_is_told_with_those_that_are(finished):
    with pytest.raises(BadFileError, match=r"results\.h5: no stage 'flow'; it holds .*packing.*view_factors$"):
        Results(finished / "results.h5").read("flow")


# Fields


def test_fields_are_written_with_their_errors_units_and_names():
    with h5py.File.in_memory() as file:
        save_fields(file, {"share": 0.5, "share_error": 0.1, "depths": [1.0, 2.0], "other": 3}, FIELDS)
        assert set(file) == {"share", "share_error", "depths"}
        assert dict(file["share_error"].attrs) == {"units": "1", "long_name": "standard error: a share"}
        assert file["depths"].attrs["units"] == "m"


def test_records_are_read_as_attributes_and_nothing_is_written_twice():
    class Record:
        share = 0.5
        depths = None

    with h5py.File.in_memory() as file:
        file["share"] = 7.0
        save_fields(file, Record(), FIELDS)
        assert list(file) == ["share"]
        assert file["share"][()] == 7.0


def test_what_is_read_is_plain_python_and_numpy(tmp_path):
    results = Results(tmp_path / "r.h5")

    def fill(group):
        group.attrs["text"] = "abc"
        group.attrs["number"] = np.float64(0.5)
        group["scalar"] = 3
        group["texts"] = ["a", "b"]
        group["text_dataset"] = "x"
        group.create_group("inner")["array"] = np.arange(3.0)

    results.write_stage("s", "digest", fill, keep=(), attributes={"job": "{}", "inputs": "{}"})
    found = results.read("s")
    assert (found["text"], found["number"], found["scalar"], found["text_dataset"]) == ("abc", 0.5, 3, "x")
    assert [type(found[k]) for k in ("text", "number", "scalar")] == [str, float, int]
    assert found["texts"].tolist() == ["a", "b"]
    np.testing.assert_array_equal(found["inner"]["array"], [0, 1, 2])


# Whole or not at all


def test_stages_to_keep_stay_and_others_go(tmp_path):
    results = Results(tmp_path / "r.h5")
    assert results.digests() == {}
    write(results, "packing", 1.0, digest="a")
    write(results, "statistics", 2.0, keep=["packing"], digest="b")
    assert results.digests() == {"packing": "a", "statistics": "b"}
    write(results, "packing", 3.0, keep=["packing", "absent"], digest="c")
    assert results.digests() == {"packing": "c"}
    assert results.read("packing")["value"] == 3.0


@pytest.mark.parametrize("failure", [ValueError("bad"), KeyboardInterrupt(), MemoryError()])
def test_a_failure_while_a_stage_is_filled_leaves_the_old_file_bit_for_bit(tmp_path, failure):
    results = Results(tmp_path / "r.h5")
    write(results)
    before = results.path.read_bytes()

    def fill(group):
        group["half"] = 1.0
        raise failure

    with pytest.raises(type(failure)):
        results.write_stage("packing", "d", fill, keep=["statistics"], attributes={"job": "{}"})
    assert results.path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [results.path]


def test_a_full_disk_leaves_the_old_file_bit_for_bit(tmp_path, monkeypatch):
    results = Results(tmp_path / "r.h5")
    write(results)
    before = results.path.read_bytes()
    old = Path.write_bytes

    def half(path, data):
        old(path, bytes(data)[:100])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", half)
    for action in (
        lambda: write(results, "packing", keep=["statistics"]),
        lambda: results.update_attributes({"job": "new"}),
    ):
        with pytest.raises(OSError, match=r"cannot write: No space left on device: '.*r\.h5'"):
            action()
        assert results.path.read_bytes() == before
        assert list(tmp_path.iterdir()) == [results.path]


def test_attributes_are_replaced_only_where_they_differ(tmp_path):
    results = Results(tmp_path / "r.h5")
    write(results, job="old")
    before = results.path.read_bytes()
    results.update_attributes({"job": "old"})
    assert results.path.read_bytes() == before
    results.update_attributes({"job": "new"})
    assert results.attributes()["job"] == "new"
    assert results.attributes()["inputs"] == "{}"
    assert results.read("statistics")["value"] == 1.0


# Files of others, and damaged ones


def foreign_hdf5(path):
    with h5py.File(path, "w") as file:
        file["precious"] = 1.0


def other_version(path):
    write(Results(path))
    with h5py.File(path, "r+") as file:
        file.attrs["schema_version"] = SCHEMA_VERSION + 1


OTHERS = {
    "hdf5": foreign_hdf5,
    "text": lambda path: path.write_text("precious"),
    "empty": lambda path: path.write_bytes(b""),
    "packing": lambda path: bedrad.write(ring_bed(), path),
    "version": other_version,
}


@pytest.mark.parametrize("kind", OTHERS)
def test_a_file_of_another_kind_is_refused_and_left_alone(tmp_path, kind):
    path = tmp_path / "precious.h5"
    OTHERS[kind](path)
    before = path.read_bytes()
    results = Results(path)
    for action in (results.digests, results.attributes, lambda: results.read("packing"), lambda: write(results)):
        with pytest.raises(BadFileError, match=r"precious\.h5: not a bedrad results file.*remove this one$"):
            action()
    with pytest.raises(BadFileError, match=r"precious\.h5: holds something else than one 'statistics' record"):
        save_record(path, "statistics", {"share": 0.5}, FIELDS)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_in_place_of_a_file_is_refused(tmp_path):
    with pytest.raises(BadFileError, match=r"not a bedrad results file.*Is a directory"):
        Results(tmp_path).digests()


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.7, 0.99])
def test_a_truncated_results_file_is_one_clear_error(finished, share):
    path = finished / "results.h5"
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    for action in (Results(path).digests, Results(path).attributes, lambda: Results(path).read("packing")):
        with pytest.raises(BadFileError, match=r"results\.h5: not a bedrad results file, or a damaged one \("):
            action()


def test_a_damaged_stage_is_one_clear_error(finished):
    path = finished / "results.h5"
    with h5py.File(path, "r") as file:
        dataset = file["packing/centers"]
        offset, size = dataset.id.get_offset(), dataset.id.get_storage_size()
    whole = bytearray(path.read_bytes())
    # everything but the coordinates and the first page, which says that this is a results file
    whole[offset + size :] = bytes(len(whole) - offset - size)
    path.write_bytes(whole)
    with pytest.raises(BadFileError, match="or a damaged one"):
        Results(path).read("prediction")


# Records of a single command


def test_a_record_replaces_an_older_one_of_its_stage_only(tmp_path):
    path, source = tmp_path / "deep" / "statistics.h5", tmp_path / "bed.csv"
    source.write_bytes(b"spheres")
    for value in (0.25, 0.5):
        save_record(path, "statistics", lambda group, v=value: save_fields(group, {"share": v}, FIELDS), source)
        with h5py.File(path) as file:
            assert json.loads(file.attrs["inputs"]) == {str(source): hashlib.sha256(b"spheres").hexdigest()}
            assert file["statistics/share"][()] == value
            assert file.attrs["schema_version"] == SCHEMA_VERSION
            assert file.attrs["bedrad_version"] == bedrad.__version__
    with pytest.raises(BadFileError, match="something else than one 'view_factors' record"):
        check_record_file(path, "view_factors")
    check_record_file(path, "statistics")


def test_a_place_is_tried_before_anything_is_computed_for_it(tmp_path):
    check_writable(tmp_path / "new" / "deep" / "r.h5")
    assert list((tmp_path / "new" / "deep").iterdir()) == []
    (tmp_path / "file").write_text("x")
    with pytest.raises(NotADirectoryError, match=r"cannot write: Not a directory: '.*file/r\.h5'"):
        check_writable(tmp_path / "file" / "r.h5")
    with pytest.raises(NotADirectoryError):
        check_writable(tmp_path / "file" / "deep" / "r.h5")
    with pytest.raises(OSError, match=r"cannot write: .*: '/proc/bedrad/r\.h5'"):
        check_writable(Path("/proc/bedrad/r.h5"))


def test_the_file_holds_the_resolved_job(finished):
    # this copy of the bed lies elsewhere
    held = json.loads(Results(finished / "results.h5").attributes()["job"])
    assert held == json.loads(load_job(finished / "job.toml").resolved()) | {"packing": held["packing"]}


# Results that somebody else may have made


def hostile(tmp_path, change):
    results = Results(tmp_path / "r.h5")
    write(results)
    with h5py.File(results.path, "r+") as file:
        change(file)
    os.utime(results.path, (1.0, 1.0))
    return results


def endless(group):
    for _ in range(12):
        group = group.create_group("more")


@pytest.mark.parametrize(("version", "shown"), [([1, 1], r"array\(\[1, 1\]\)"), ("x" * 60_000, "'x{39}")])
def test_a_version_that_is_no_number_is_one_error(tmp_path, version, shown):
    results = hostile(tmp_path, lambda file: file.attrs.__setitem__("schema_version", version))
    with pytest.raises(BadFileError, match=rf"not a bedrad results file of schema version 1 \(it has {shown}\)"):
        results.digests()


def many(group):
    for number in range(9):
        group.create_dataset(f"a{number}", 400_000, "f8", chunks=(1000,))


def of_many_names(group):
    dataset = group.create_dataset("a", data=np.zeros(100_000))
    for number in range(200):
        group[f"a{number}"] = dataset


def elsewhere(file):
    layout = h5py.VirtualLayout((1,), "f8")
    layout[:] = h5py.VirtualSource("other.h5", "a", (1,))
    file["statistics"].create_virtual_dataset("a", layout)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda file: many(file["statistics"]), "its datasets hold 19200.* bytes and more together"),
        (lambda file: of_many_names(file["statistics"]), "its datasets hold .* bytes and more together"),
        (lambda file: file["statistics"].__setitem__("a", file["statistics"]), "a: is a group that has another name"),
        (lambda file: file["statistics"].__setitem__("a", file["/"]), "a: is a group that has another name"),
        (lambda file: file["statistics"].__setitem__(b"\xff", 1.0), "/statistics: holds b'.xff', a name that is not"),
        (
            lambda file: file["statistics"].attrs.__setitem__(b"\xff", 1.0),
            "/statistics: the attribute b'.xff' has a na",
        ),
        (elsewhere, "a: its values lie in other files"),
        (lambda file: file["statistics"].__setitem__("a", h5py.SoftLink("/statistics")), "statistics/a: is a link to"),
        (
            lambda file: file["statistics"].__setitem__("a", h5py.ExternalLink("/etc/hosts", "/")),
            "a: is a link to elsewhere",
        ),
        (lambda file: file["statistics"].__setitem__("a", np.dtype("f8")), "a: is neither a group nor a dataset"),
        (lambda file: file["statistics"].__setitem__("a", h5py.Empty("f8")), "a: is neither a group nor a dataset"),
        (
            lambda file: file["statistics"].create_dataset("a", (10**6, 10**6), "f8", chunks=(1, 1000)),
            "far more than the file",
        ),
        (lambda file: endless(file["statistics"]), "groups lie deeper than 8"),
        (lambda file: (file.__delitem__("statistics"), file.create_dataset("statistics", data=1.0)), "is no group"),
    ],
)
def test_what_no_run_writes_is_one_clear_error(tmp_path, change, message):
    with pytest.raises(BadFileError, match=message):
        hostile(tmp_path, change).read("statistics")


def test_a_link_that_leads_nowhere_is_no_stage(tmp_path):
    results = hostile(tmp_path, lambda file: file.__setitem__("other", h5py.SoftLink("/nowhere")))
    assert set(results.digests()) == {"statistics"}


def test_a_device_has_no_digest():
    with pytest.raises(BadFileError, match="is a pipe or a device"):
        sha256_of(Path("/dev/zero"))
