"""Tables of predictions: every cell reads back as the number that was predicted, and the columns fit each other."""

import csv
import errno

import numpy as np
import pytest

from bedrad.report.prediction_tables import budget_table, prediction_table, write_prediction_tables
from report.prediction_samples import TEMPERATURES, one_temperature, two_flows

SYSTEM = {
    "tube diameter [m]": "tube_diameter",
    "particle diameter [m]": "particle_diameter",
    "velocity [m/s]": "velocity",
}
VALUES = {
    "wall temperature [K]": "wall_temperature",
    "mean temperature [K]": "mean_temperature",
    "temperature of the wall layer's properties [K]": "wall_layer_temperature",
    "temperature of the bulk's properties [K]": "bulk_temperature",
    "heat transfer coefficient [W/(m2 K)]": "heat_transfer_coefficient",
    "its standard error [W/(m2 K)]": "heat_transfer_coefficient_error",
    "heat transfer coefficient without radiation [W/(m2 K)]": "heat_transfer_coefficient_without",
    "its standard error without radiation [W/(m2 K)]": "heat_transfer_coefficient_without_error",
    "share of radiation [1]": "radiation_share",
    "Nusselt number [1]": "nusselt",
    "Nusselt number, standard error [1]": "nusselt_error",
    "wall-layer conductivity [W/(m K)]": "wall_layer_conductivity",
    "wall-layer conductivity, standard error [W/(m K)]": "wall_layer_conductivity_error",
    "radiative conductivity [W/(m K)]": "radiative_conductivity",
    "radiative conductivity, standard error [W/(m K)]": "radiative_conductivity_error",
    "bulk conductivity [W/(m K)]": "bulk_conductivity",
    "bulk conductivity without radiation [W/(m K)]": "bulk_conductivity_without",
    "gas conductivity [W/(m K)]": "gas_conductivity",
}
DRAWN = [f"heat transfer coefficient, {what} [W/(m2 K)]" for what in
         ("mean of draws", "standard deviation of draws", "2.5 % of draws below", "97.5 % of draws below")]  # fmt: skip
H, K_BULK = "heat transfer coefficient [W/(m2 K)]", "bulk conductivity [W/(m K)]"
ERROR = "its standard error [W/(m2 K)]"


def read(path):
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def numbers(rows, name):
    return np.array([float(row[name] or "nan") for row in rows])


@pytest.fixture(scope="module")
def found():
    return two_flows(samples=8)


@pytest.fixture(scope="module")
def written(found, tmp_path_factory):
    path = tmp_path_factory.mktemp("tables") / "flows.csv"
    files = write_prediction_tables(found, path)
    assert files == [path, path.with_name("flows_budget.csv")]
    assert sorted(path.parent.iterdir()) == files
    return [read(file) for file in files]


def test_every_number_reads_back_to_the_last_digit(found, written):
    rows, _ = written
    assert list(rows[0]) == [*SYSTEM, *VALUES, *DRAWN, "bulk model", "temperature of properties"]
    assert len(rows) == 2 * len(TEMPERATURES)
    for heading, name in SYSTEM.items():
        expected = np.repeat([getattr(one.system, name) for one in found], len(TEMPERATURES))
        np.testing.assert_array_equal(numbers(rows, heading), expected)
    for heading, name in VALUES.items():
        np.testing.assert_array_equal(numbers(rows, heading), np.concatenate([getattr(one, name) for one in found]))
    assert {row["bulk model"] for row in rows} == {one.bulk_model for one in found}
    assert {row["temperature of properties"] for row in rows} == {"wall"}


def test_draws_have_their_mean_deviation_and_interval(found, written):
    rows, _ = written
    h = "heat_transfer_coefficient"
    many = [one.monte_carlo for one in found]
    values = [
        np.concatenate([each.mean[h] for each in many]),
        np.concatenate([each.standard_deviation[h] for each in many]),
        *(np.concatenate([each.interval[h][k] for each in many]) for k in range(2)),
    ]
    for heading, expected in zip(DRAWN, values, strict=True):
        np.testing.assert_array_equal(numbers(rows, heading), expected)


def test_the_columns_fit_each_other(written):
    rows, _ = written
    nusselt = numbers(rows, H) * numbers(rows, "tube diameter [m]") / numbers(rows, K_BULK)
    np.testing.assert_allclose(numbers(rows, "Nusselt number [1]"), nusselt, rtol=1e-12)
    share = 1.0 - numbers(rows, "heat transfer coefficient without radiation [W/(m2 K)]") / numbers(rows, H)
    np.testing.assert_allclose(numbers(rows, "share of radiation [1]"), share, rtol=1e-12)
    # properties at the wall's temperature, and no heat flux to part it from the mean
    np.testing.assert_array_equal(numbers(rows, "wall temperature [K]"), TEMPERATURES * 2)
    assert {row["mean temperature [K]"] for row in rows} == {""}


def test_the_budget_has_a_row_an_input_and_adds_up_to_the_error(found, written):
    rows, budget = written
    columns = {"value": "values", "standard error": "errors", "elasticity of h [1]": "elasticities",
               "error of h [W/(m2 K)]": "contributions", "share of variance [1]": "shares"}  # fmt: skip
    assert list(budget[0]) == [*SYSTEM, "wall temperature [K]", "input", *columns]
    for place, one in enumerate(found):
        for column, T in enumerate(TEMPERATURES):
            size = one.system.particle_diameter
            own = [row for row in budget if (float(row["particle diameter [m]"]), float(row["wall temperature [K]"]))
                   == (size, T)]  # fmt: skip
            assert [row["input"] for row in own] == [name.replace("_", " ") for name in one.budget.names]
            for heading, name in columns.items():
                np.testing.assert_array_equal(numbers(own, heading), getattr(one.budget, name)[:, column])
            error = float(rows[place * len(TEMPERATURES) + column][ERROR])
            assert np.linalg.norm(numbers(own, "error of h [W/(m2 K)]")) == pytest.approx(error, rel=1e-12)
            assert numbers(own, "share of variance [1]").sum() == pytest.approx(1.0, rel=1e-12)


def test_one_temperature_is_one_row_without_draws():
    one = one_temperature()
    table = prediction_table([one])
    assert {len(values) for values in table.values()} == {1}
    assert table[H] == [float(one.heat_transfer_coefficient)]
    assert [table[heading] for heading in DRAWN] == [[None]] * 4
    budget = budget_table([one])
    assert budget["wall temperature [K]"] == [900.0] * len(one.budget.names)
    # nothing is uncertain
    assert set(budget["error of h [W/(m2 K)]"]) == {0.0}


def test_a_folder_that_is_missing_is_told(tmp_path):
    with pytest.raises(OSError, match=r"flows\.csv") as caught:
        write_prediction_tables([one_temperature()], tmp_path / "missing" / "flows.csv")
    assert caught.value.errno == errno.ENOENT
