"""CSV tables: what they hold is what the results file holds, and a file is whole or not there."""

import csv
import errno
import math

import numpy as np
import pytest

from bedrad.errors import BadFileError
from bedrad.jobs.results import Results
from bedrad.report.tables import write_tables

ALL = {"prediction", "prediction_inputs", "view_factors", "statistics", "layers", "contacts", "profile", "centres",
       "nc_gaps", "coordination", "convergence", "convergence_rates"}  # fmt: skip


def read(path):
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def column(rows, name):
    return [math.nan if row[name] == "" else float(row[name]) for row in rows]


@pytest.fixture(scope="module")
def made(whole):
    return whole


@pytest.fixture(scope="module")
def tables(made, tmp_path_factory):
    paths = write_tables(made.results, tmp_path_factory.mktemp("tables"))
    return {path.name.removeprefix("bed_").removesuffix(".csv"): read(path) for path in paths}


def test_every_table_has_a_file_named_after_the_results(made, tmp_path):
    paths = write_tables(made.results, tmp_path)
    assert {path.name for path in paths} == {f"bed_{name}.csv" for name in ALL}
    assert sorted(tmp_path.iterdir()) == sorted(paths)


def test_every_column_of_numbers_names_its_unit(tables):
    texts = {"case", "title", "bulk model", "target", "layer", "contacts with spheres"}
    for name, rows in tables.items():
        for heading, value in rows[0].items():
            if heading not in texts:
                assert heading.endswith("]"), (name, heading)
                assert value == "" or math.isfinite(float(value))


def test_prediction_round_trips_to_the_last_bit(made, tables):
    rows = tables["prediction"]
    headings = {
        "wall temperature [K]": "wall_temperature",
        "heat transfer coefficient [W/(m2 K)]": "heat_transfer_coefficient",
        "heat transfer coefficient without radiation [W/(m2 K)]": "heat_transfer_coefficient_without",
        "Nusselt number [1]": "nusselt",
        "Nusselt number without radiation [1]": "nusselt_without",
        "wall layer conductivity [W/(m K)]": "wall_layer_conductivity",
        "radiative conductivity [W/(m K)]": "radiative_conductivity",
        "bulk conductivity [W/(m K)]": "bulk_conductivity",
        "bulk conductivity without radiation [W/(m K)]": "bulk_conductivity_without",
        "gas conductivity [W/(m K)]": "gas_conductivity",
        "radiation bound [1]": "radiation_bound",
    }
    for key, (title, bulk, values) in made.data["prediction"].items():
        own = [row for row in rows if row["case"] == key]
        assert {(row["title"], row["bulk model"]) for row in own} == {(title, bulk)}
        for heading, name in headings.items():
            np.testing.assert_array_equal(column(own, heading), values[name], err_msg=heading)
        assert column(own, "wall temperature [degC]") == pytest.approx(values["wall_temperature"] - 273.15, abs=1e-9)
        assert own[0]["wall temperature [degC]"] == "100.0"
        gain = values["heat_transfer_coefficient"] / values["heat_transfer_coefficient_without"] - 1
        assert column(own, "radiation gain [1]") == pytest.approx(gain, rel=1e-13)
        assert set(column(own, "particle diameter [m]")) == {values["particle_diameter"]}
        assert set(column(own, "velocity [m/s]")) == {values["velocity"]}


def test_errors_stand_where_there_are_any_and_are_empty_elsewhere(made, tables):
    heading = "heat transfer coefficient error [W/(m2 K)]"
    values = made.data["prediction"]["measured"][2]
    own = [row for row in tables["prediction"] if row["case"] == "measured"]
    np.testing.assert_array_equal(column(own, heading), values["heat_transfer_coefficient_error"])
    assert {row[heading] for row in tables["prediction"] if row["case"] == "correlations"} == {""}


def test_inputs_of_the_prediction(tables):
    measured, correlated = tables["prediction_inputs"][:2]
    assert float(measured["packing fraction [1]"]) == 0.42
    assert float(measured["packing fraction error [1]"]) == 2e-3 * 0.42
    assert float(measured["contacts per area [1/m2]"]) == 1.85e6
    assert float(measured["no-contact distance [particle radii]"]) == 0.22
    assert float(measured["view factor to layer 2 [1]"]) == 0.18
    assert float(measured["view factor to layer 2 error [1]"]) == 2e-3 * 0.18
    assert correlated["view factor to layer 2 error [1]"] == correlated["packing fraction error [1]"] == ""


def test_view_factors(made, tables):
    data, rows = made.data["view_factors"], tables["view_factors"]
    assert [row["target"] for row in rows] == ["layer 1", "layer 2", "layer 3", "beyond", "wall", "escaped", "sum"]
    factors = [*data["layers"], data["beyond"], data["wall"], data["escaped"]]
    assert column(rows, "view factor [1]")[:-1] == factors
    assert column(rows, "ray error [1]")[:3] == data["layers_error"].tolist()
    assert column(rows, "bed error [1]")[:3] == data["layers_bed_error"].tolist()
    assert column(rows, "depth from [m]")[:5] == [0.0, 3e-4, 9e-4, 1.5e-3, 0.0]
    assert column(rows, "depth to [m]")[:3] == data["edges"][1:].tolist()
    assert column(rows, "published by Watkins (2018) Table 5.3 [1]")[:3] == [0.8, 0.18, 0.02]
    for heading in ("view factor [1]", "view factor normalised as Watkins (2018) [1]",
                    "published by Watkins (2018) Table 5.3 [1]"):  # fmt: skip
        assert float(rows[-1][heading]) == pytest.approx(1.0, abs=1e-14)
    assert rows[-1]["ray error [1]"] == rows[3]["published by Watkins (2018) Table 5.3 [1]"] == ""


def test_statistics_and_layers(made, tables):
    data = made.data["statistics"]
    (row,) = tables["statistics"]
    assert float(row["packing fraction [1]"]) == 0.4501
    assert float(row["contacts per area error [1/m2]"]) == 1.7e4
    assert float(row["no-contact distance [particle radii]"]) == 0.465
    assert row["no-contact distance closing [particle radii]"] == ""
    assert row["contacts [1]"] == "724"
    assert float(row["sauter diameter [m]"]) == 6.1e-4
    assert float(row["hexagonal order [1]"]) == 0.597
    layers = tables["layers"]
    assert column(layers, "depth to [m]") == data["edges"][1:].tolist()
    assert column(layers, "solid fraction [1]") == data["packing_fractions"].tolist()
    assert column(layers, "solid fraction error [1]") == data["packing_fractions_error"].tolist()
    assert column(layers, "contacts a sphere [1]") == data["coordination"].tolist()


def test_contacts_and_profile(made, tables):
    data = made.data["statistics"]
    contacts = tables["contacts"]
    assert column(contacts, "gap tolerance [particle radii]") == [0.0, 1e-3, 1e-2]
    assert column(contacts, "contacts per area [1/m2]") == data["contacts_per_area_by_gap"].tolist()
    assert column(contacts, "contact ratio error [1]") == data["contact_ratio_by_gap_error"].tolist()
    profile = tables["profile"]
    np.testing.assert_array_equal(column(profile, "solid fraction [1]"), data["profile"])
    np.testing.assert_array_equal(column(profile, "depth to [m]"), data["profile_depths"][1:])
    middles = (np.arange(25) + 0.5) * 5.0 / 25  # 25 bins over five radii
    np.testing.assert_allclose(column(profile, "mean depth [particle radii]"), middles, rtol=1e-12)
    np.testing.assert_allclose(column(profile, "mean radial position [m]"), 3.87e-3 - 3e-4 * middles, rtol=1e-12)
    assert column(contacts, "no-contact share error [1]") == data["nc_share_by_gap_error"].tolist()
    assert column(contacts, "contacts a sphere in layer 2 [1]") == data["coordination_by_gap"][1].tolist()


def test_distributions(made, tables):
    data = made.data["statistics"]
    centres, gaps, numbers = tables["centres"], tables["nc_gaps"], tables["coordination"]
    assert column(centres, "sphere centres per volume [1/m3]") == data["centre_density"].tolist()
    assert column(centres, "contacts between spheres per volume error [1/m3]") == data["contact_density_error"].tolist()
    heading = "share of no-contact particles per gap [1/particle radius]"
    assert column(gaps, heading) == data["nc_gap_density"].tolist()
    assert column(gaps, "gap to [particle radii]") == [0.25, 0.5, 0.75, 1.0]
    assert [row["contacts with spheres"] for row in numbers] == ["0", "1", "2", "3", "4", "5", "more than 5"]
    assert column(numbers, "share of spheres [1]") == data["contact_number_shares"].tolist()


def test_convergence(made, tables):
    data, rows = made.data["convergence"], tables["convergence"]
    assert column(rows, "rays [1]") == data["rays"].tolist()
    assert column(rows, "run time [s]") == data["seconds"].tolist()
    assert column(rows, "true error of layer 2 [1]") == data["true_error"][:, 1].tolist()
    assert column(rows, "stated error of beyond [1]") == data["stated_error"][:, 3].tolist()
    rates = tables["convergence_rates"]
    assert [row["target"] for row in rates] == ["layer 1", "layer 2", "layer 3", "beyond", "wall", "escaped"]
    np.testing.assert_array_equal(column(rates, "exponent of rays [1]"), data["exponent"])
    assert column(rates, "reference view factor [1]") == data["reference"].tolist()


@pytest.mark.parametrize(
    ("stage", "names"),
    [
        ("prediction", {"prediction", "prediction_inputs"}),
        ("view_factors", {"view_factors"}),
        ("statistics", {"statistics", "layers", "contacts", "profile", "centres", "nc_gaps", "coordination"}),
        ("convergence", {"convergence", "convergence_rates"}),
    ],
)
def test_only_stages_that_ran(fabricate, tmp_path, stage, names):
    paths = write_tables(fabricate(stage).results, tmp_path)
    assert {path.name for path in paths} == {f"bed_{name}.csv" for name in names}


def test_no_results_file(tmp_path):
    with pytest.raises(BadFileError, match="gone"):
        write_tables(Results(tmp_path / "gone.h5"), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_missing_folder_is_named(made, tmp_path):
    with pytest.raises(OSError, match="not_there"):
        write_tables(made.results, tmp_path / "not_there")


def test_full_disk_leaves_the_old_table_and_no_half_one(made, tmp_path, monkeypatch):
    written = write_tables(made.results, tmp_path)
    before = {path: path.read_bytes() for path in written}

    class FullDisk:
        def __init__(self, stream, **_):
            self.stream = stream

        def writerow(self, row):
            self.stream.write("half a")

        def writerows(self, rows):
            raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(csv, "writer", FullDisk)
    with pytest.raises(OSError, match="No space left"):
        write_tables(made.results, tmp_path)
    assert {path: path.read_bytes() for path in written} == before
    assert sorted(tmp_path.iterdir()) == sorted(written)
