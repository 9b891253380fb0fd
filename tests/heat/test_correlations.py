import csv
from pathlib import Path

import numpy as np
import pytest

from bedrad.heat import RangeWarning, correlations, wall_layer

TABLE = Path(__file__).parents[1] / "data" / "wall_layer_conductivity.csv"
ROWS = list(csv.DictReader(line for line in TABLE.read_text().splitlines() if not line.startswith("#")))


@pytest.mark.parametrize("row", ROWS)
def test_reference_table(row):
    d, U = float(row["particle_diameter_m"]), float(row["velocity_m_s"])
    A = float(row["tube_diameter_m"]) / d
    assert wall_layer.packing_fraction(A, U, d) == pytest.approx(float(row["packing_fraction"]), rel=1e-8)
    assert wall_layer.contact_ratio(A, U, d) == pytest.approx(float(row["contact_ratio"]), rel=1e-8)
    assert wall_layer.maximum_contacts(A, d) == pytest.approx(float(row["maximum_contacts_m_2"]), rel=1e-8)


def test_maximum_is_a_hexagonal_layer_of_the_centres():
    # touching spheres in a hexagonal layer: one in sqrt(3)/2 d^2 of the surface their centres lie on
    d = 0.6e-3
    assert wall_layer.maximum_contacts(np.inf, d) == pytest.approx(2 / (np.sqrt(3) * d * d), rel=1e-14)
    A = 12.9
    per_length = wall_layer.maximum_contacts(A, d) * np.pi * A * d
    assert per_length == pytest.approx(2 / (np.sqrt(3) * d * d) * np.pi * (A - 1) * d, rel=1e-14)


@pytest.mark.parametrize("function", [wall_layer.packing_fraction, wall_layer.contact_ratio])
@pytest.mark.parametrize(
    ("A", "U", "what"),
    [(40.1, 0.014, "40.1"), (12.8, 0.05, "12.8"), (20, 0.3, "0.3 m/s"), (20, 0.0, "0 m/s")],
)
def test_one_warning_outside_the_fitted_range(function, A, U, what):
    with pytest.warns(RangeWarning, match=rf"is {what}.*outside the fitted range") as record:
        function(A, U, 3e-4)
    assert len(record) == 1
    assert record[0].filename == __file__
    assert np.isfinite(function(A, U, 3e-4, warn=False))


def test_no_warning_at_the_ends_of_the_fitted_range():
    for A in (7.75 / 0.6, 12.9, 10.92 / 0.3):
        for U in (0.002, 0.25):
            assert 0.3 < wall_layer.packing_fraction(A, U, 6e-4) < 0.43


def test_both_fall_with_the_velocity():
    U = np.linspace(0.002, 0.25, 20)
    assert np.all(np.diff(wall_layer.packing_fraction(12.9, U, 6e-4)) < 0)
    assert np.all(np.diff(wall_layer.contact_ratio(12.9, U, 6e-4)) < 0)


def test_refusals():
    with pytest.raises(ValueError, match=r"gives -.*expected a positive value"):
        correlations.packing_fraction(5.0, 2.0, 3e-4, warn=False)
    with pytest.raises(ValueError, match=r"velocity is -1 m/s"):
        correlations.contact_ratio(20.0, -1.0, 3e-4)
    with pytest.raises(ValueError, match=r"particle_diameter is 0 m"):
        correlations.packing_fraction(20.0, 0.1, 0.0)
    with pytest.raises(ValueError, match=r"diameter_ratio is 1; expected more than 1"):
        correlations.maximum_contacts(1.0, 3e-4)
