from __future__ import annotations

import zlib
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bedrad.jobs.unit_columns import field_of, record_of_row, stack
from bedrad.jobs.unit_record import StageRecord, UnitRecord, gather, key_of, pack, unpack

STATISTICS = {"a": np.array(0.1), "profile": np.arange(3.0), "wall": "tube", "n": np.array(7)}
FACTORS = {"case/h": np.array([[1.0, np.nan], [np.inf, -0.0]]), "none": np.empty((0, 3))}
RECORD = UnitRecord(
    "key",
    {"statistics": StageRecord("d1", STATISTICS), "view_factors": StageRecord("d2", FACTORS)},
    ("a warning", "another"),
    1.5,
)


def same(one, two):
    assert (one.key, one.warnings, one.seconds, list(one.stages)) == (
        two.key,
        two.warnings,
        two.seconds,
        list(two.stages),
    )
    for name, stage in one.stages.items():
        other = two.stages[name]
        assert (stage.digest, set(stage.values)) == (other.digest, set(other.values))
        for title, value in stage.values.items():
            np.testing.assert_array_equal(value, other.values[title])
            if not isinstance(value, str):
                assert (value.dtype, value.shape) == (other.values[title].dtype, other.values[title].shape)
                assert value.tobytes() == other.values[title].tobytes()


def test_a_record_comes_back_bit_for_bit():
    same(unpack(pack(RECORD)), RECORD)
    assert key_of(pack(RECORD)) == "key"
    assert unpack(pack(RECORD)).stages["view_factors"].data()["case"]["h"].shape == (2, 2)
    assert unpack(pack(RECORD)).stages["statistics"].data()["n"] == 7


@given(st.binary(max_size=300), st.booleans())
def test_no_bytes_do_harm(content, packed):
    with pytest.raises(ValueError):
        unpack(b"key\n" + zlib.compress(content) if packed else content)


@given(st.integers(0, 400), st.integers(0, 255))
def test_a_changed_byte_is_a_value_error_or_another_record(place, value):
    whole = bytearray(zlib.decompress(pack(RECORD).removeprefix(b"key\n")))
    whole[place % len(whole)] = value
    with suppress(ValueError):
        assert isinstance(unpack(b"key\n" + zlib.compress(bytes(whole))), UnitRecord)


def test_what_a_stage_writes_is_gathered():
    def fill(group):
        made = group.create_dataset("x", data=[1.0, 2.0])
        made.attrs["units"] = "m"
        group.attrs["window"] = (0.0, 1.0)
        group.attrs["wall"] = "tube"
        case = group.create_group("measured")
        case.create_dataset("h", data=3.0)
        case.create_group("budget").create_dataset("much", data=np.zeros(1000))
        case.create_group("other").attrs["inputs"] = ["a", "b"]
        assert "x" in group
        assert "y" not in group

    found = gather("d", fill, leave_out="budget")
    assert found.digest == "d"
    assert set(found.values) == {"x", "window", "wall", "measured/h"}
    assert found.values["measured/h"] == 3.0


def test_columns_give_back_the_records_that_they_were_made_of():
    """Rows of other shapes and fields that some units lack included."""
    statistics = {"a": np.array(2), "profile": np.arange(5.0), "wall": "rod", "n": np.array(8)}
    factors = {"case/h": np.ones((1, 3)), "none": np.empty((0, 3)), "extra": np.array(1.0)}
    stages = {"statistics": StageRecord("e1", statistics), "view_factors": StageRecord("e2", factors)}
    other = UnitRecord("other", stages, (), 2.5)
    records = [RECORD, other]
    packed = [pack(record) for record in records]
    columns, told, seconds = stack(packed, packed, 2, {"statistics", "view_factors"})
    assert (told, seconds) == ([RECORD.warnings, ()], [1.5, 2.5])
    assert stack(packed, packed, 2, {"statistics"})[0].keys() == {"statistics"}
    assert columns["statistics"]["profile"].values.shape == (2, 5)
    assert np.isnan(columns["statistics"]["profile"].values[0, 3:]).all()
    same(record_of_row("key", columns, 0, RECORD.warnings, 1.5), RECORD)
    found = record_of_row("other", columns, 1, (), 2.5)
    # a whole number among fractions becomes one
    assert found.stages["statistics"].values["a"].dtype == float
    np.testing.assert_array_equal(found.stages["view_factors"].values["case/h"], np.ones((1, 3)))
    assert set(found.stages["view_factors"].values) == {"case/h", "none", "extra"}


@pytest.mark.parametrize(
    ("stage", "name", "units", "start"),
    [
        ("statistics", "contacts_per_area", "1/m2", "wall contacts"),
        ("statistics", "contacts_per_area_error", "1/m2", "standard error: wall contacts"),
        ("view_factors", "history_errors", "1", "their standard errors"),
        ("prediction", "measured/heat_transfer_coefficient_error", "W/(m2 K)", "standard error: heat transfer"),
        ("prediction", "measured/contacts_per_area", "1/m2", "wall contacts"),
        ("statistics", "window", "m", "ends of"),
        ("statistics", "left_out_deeper", "1", "left out deeper"),
        ("view_factors", "digest", "", "digest"),
    ],
)
def test_fields_have_units_and_names(stage, name, units, start):
    found = field_of(stage, name)
    assert found[0] == units
    assert found[1].startswith(start)
