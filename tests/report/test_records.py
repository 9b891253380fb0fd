"""Numbers derived from a results file, against their definitions."""

import json
import math

import numpy as np
import pytest

from bedrad.errors import BadFileError
from bedrad.jobs.results import Results
from bedrad.report import records


def test_load_takes_the_finished_stages_and_the_name_of_the_job(fabricate):
    record = records.load(fabricate("statistics", "prediction").results)
    assert sorted(record.stages) == ["prediction", "statistics"]
    assert record.name == r"0.6 mm [bold]zirconia[/bold], $\no_formula$"


def test_load_refuses_a_missing_file(tmp_path):
    with pytest.raises(BadFileError, match=r"nowhere\.h5"):
        records.load(Results(tmp_path / "nowhere.h5"))


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.45009, 0.00285, "0.4501 ± 0.0029"),
        (649.49, 0.797, "649.49 ± 0.80"),
        (2059.18, 17.2, "2059 ± 17"),
        (2059.18, 172.0, "2059 ± 172"),
        (1.05e-5, 7.1e-6, "0.0000105 ± 0.0000071"),
        (0.45009, math.nan, "0.4501"),
        (0.45009, 0.0, "0.4501"),
    ],
)
def test_with_error(value, error, text):
    assert records.with_error(value, error) == text


def test_no_value_is_none_and_no_error_is_an_empty_cell():
    assert records.value_text(math.nan, 0.1) == "none"
    assert records.value_text(0.4501, 0.0029) == "0.4501 ± 0.0029"
    assert records.value_text(0.4501, math.nan) == "0.450"
    assert records.error_text(math.nan) == ""
    assert records.error_text(1.234e-3) == "1.2e-03"


@pytest.mark.parametrize(
    ("count", "most", "rows"), [(1, 6, [0]), (3, 6, [0, 1, 2]), (21, 6, [0, 4, 8, 12, 16, 20]), (5, 2, [0, 4])]
)
def test_rows_are_shown_evenly_with_the_first_and_the_last(count, most, rows):
    assert records.evenly(count, most).tolist() == rows


def test_the_jobs_own_cases_are_parted_from_the_published():
    found = {"measured": {"a": 1}, "configuration_2": {"a": 2}, "correlations": {"a": 3}}
    own, published = records.own_and_published(found)
    assert own == {"measured": {"a": 1}, "correlations": {"a": 3}}
    assert published == {"configuration_2": {"a": 2}}


def test_cases_come_in_order_and_by_temperature(fabricate):
    def shuffle(prediction):
        for _, _, case in prediction.values():
            order = np.random.default_rng(3).permutation(len(case["wall_temperature"]))
            for name, value in case.items():
                if isinstance(value, np.ndarray) and not name.startswith("view_factors"):
                    case[name] = value[order]

    made = fabricate()
    plain = fabricate("prediction", name="plain.h5")
    found = records.cases(made.add("prediction", shuffle).results.read("prediction"))
    expected = records.cases(plain.results.read("prediction"))
    assert list(found) == ["measured", "correlations", "configuration_2"]
    assert [records.is_published(key) for key in found] == [False, False, True]
    for key, case in found.items():
        assert np.all(np.diff(case["wall_temperature"]) > 0)
        for name, value in case.items():
            np.testing.assert_array_equal(value, expected[key][name], err_msg=name)


def test_view_factors_are_not_sorted_with_as_many_temperatures():
    case = {"wall_temperature": np.array([3.0, 1.0, 2.0]), "view_factors": np.array([0.8, 0.18, 0.02])}
    found = records.cases({"measured": case, "digest": "0"})["measured"]
    assert found["wall_temperature"].tolist() == [1.0, 2.0, 3.0]
    assert found["view_factors"].tolist() == [0.8, 0.18, 0.02]


def test_celsius_leaves_no_digits_of_the_conversion():
    assert records.celsius([373.15, 1373.15, 273.16]).tolist() == [100.0, 1100.0, 0.01]


def test_an_error_of_zero_is_no_error():
    np.testing.assert_array_equal(records.stated([0.0, 0.5]), [np.nan, 0.5])


def test_targets_sum_to_one_in_both_conventions(fabricate):
    data = fabricate("view_factors").data["view_factors"]
    rows = list(records.targets(data))
    assert [row.name for row in rows] == ["layer 1", "layer 2", "layer 3", "beyond", "wall", "escaped"]
    assert math.fsum(row.factor for row in rows) == pytest.approx(1.0, abs=1e-14)
    layers = rows[:3]
    assert math.fsum(row.watkins for row in layers) == pytest.approx(1.0, abs=1e-14)
    for row in layers:
        assert row.watkins == pytest.approx(row.factor / data["layers"].sum(), rel=1e-14)
        assert row.error == pytest.approx(math.hypot(row.ray_error, row.bed_error), rel=1e-14)
    assert [row.published for row in layers] == [0.80, 0.18, 0.02]
    assert all(math.isnan(row.watkins) and math.isnan(row.published) for row in rows[3:])


def test_ray_error_of_the_normalised_factors_is_that_of_the_ratio(fabricate):
    """Against the scatter of the ratio over shares drawn from their covariance; 20,000 draws know it to 1/200."""
    data = fabricate("view_factors").data["view_factors"]
    mean = [*data["layers"], data["beyond"], data["wall"], data["escaped"]]
    shares = np.random.default_rng(3).multivariate_normal(mean, data["covariance"], 20_000)[:, :3]
    expected = (shares / shares.sum(axis=1, keepdims=True)).std(axis=0)
    found = [row.watkins_ray_error for row in records.targets(data)][:3]
    np.testing.assert_allclose(found, expected, rtol=0.025)


def test_no_bed_error_counts_as_none(fabricate):
    data = fabricate("view_factors").data["view_factors"] | {"layers_bed_error": np.full(3, np.nan)}
    row = next(records.targets(data))
    assert row.error == row.ray_error > 0


def test_targets_of_a_wall_that_sees_no_sphere(fabricate):
    data = fabricate("view_factors").data["view_factors"] | {"layers": np.zeros(3), "wall": 1.0}
    assert all(math.isnan(row.watkins) for row in records.targets(data))


def test_more_layers_than_published(fabricate):
    data = fabricate("view_factors").data["view_factors"]
    more = {"layers": np.array([0.8, 0.1, 0.05, 0.02]), "edges": np.array([0.0, 1.0, 3.0, 5.0, 7.0])}
    more |= {
        "layers_error": np.zeros(4),
        "layers_bed_error": np.zeros(4),
        "covariance": np.zeros((7, 7)),
        "block_shares": np.full((4, 7), 0.1),
    }
    rows = list(records.targets(data | more))
    assert [row.name for row in rows][:4] == ["layer 1", "layer 2", "layer 3", "layer 4"]
    assert math.isnan(rows[3].published)


def test_correlated_layer_closes_the_solid_volume(fabricate):
    """Per wall area, particles of n_C and n_NC fill phi r (1 - 1/(2A)) (Watkins 2018, eq. 31)."""
    case = fabricate("prediction").data["prediction"]["correlations"][2]
    found = records.correlated_layer(fabricate("prediction", name="b.h5").results.read("prediction"))
    A, r, a = case["diameter_ratio"], case["particle_diameter"] / 2, 0.22
    n_c = case["contacts_per_area"]
    solid = case["packing_fraction"] * r * (1 - 1 / (2 * A))
    n_nc = (solid - n_c * 2 * np.pi / 3 * r**3) / (np.pi / 3 * (1 - a) ** 2 * (2 + a) * r**3)
    assert found.nc_share == pytest.approx(n_nc / (n_nc + n_c), rel=1e-12)
    assert found.contact_ratio == pytest.approx(n_c * 2 * np.sqrt(3) * r**2 / (1 - 1 / A), rel=1e-12)
    assert (found.packing_fraction, found.nc_distance, found.velocity) == (0.42, 0.22, 0.016)


def test_nothing_correlated_without_a_prediction():
    assert records.correlated_layer(None) is None
    assert records.correlated_layer({"digest": "0"}) is None


def test_stages_of_an_earlier_job_are_not_reported(fabricate):
    """A results file may keep what another job left in it; a report is about its own job."""
    results = fabricate("statistics", "prediction").results
    assert set(records.load(results).stages) >= {"statistics", "prediction"}
    job = json.dumps({"name": "other", "prediction": {}})
    results.update_attributes({"job": job})
    assert set(records.load(results).stages) == {"prediction"}
