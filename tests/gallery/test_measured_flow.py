"""The gallery's measured flow: the table is what its maker writes, and what went in comes out."""

import numpy as np
import pytest

from oracles.gallery import load

pytestmark = pytest.mark.filterwarnings("ignore::bedrad.heat.RangeWarning")


@pytest.fixture(scope="module")
def example():
    return load("measured_flow")


def test_the_table_is_reproducible_and_its_nusselt_numbers_come_back(example, tmp_path):
    truth = np.array(example.simulated_table(tmp_path / "table.csv"))
    assert (tmp_path / "table.csv").read_text(encoding="utf-8") == example.TABLE.read_text(encoding="utf-8")
    found = example.main(tmp_path / "x.png")
    assert (tmp_path / "x.png").stat().st_size > 10_000
    # k_b is the same in both, so that only the errors of h tell; 4 of them, one false alarm in 2600 seeds
    pulls = (found["nusselt"] / truth - 1.0) / found["error_of_h"]
    assert np.max(np.abs(pulls)) < 4.0
    assert np.max(np.abs(found["first_law"])) < 4.0
    # the slowest flow has the smallest temperature difference and the largest error
    assert found["error_of_h"][1] > 4.0 * found["error_of_h"][5]


def test_without_random_errors_only_the_wall_layer_that_no_probe_sees_is_missing(example, tmp_path, monkeypatch):
    """Nu (kappa - 1)(1 - W^2)^2/8 of h, about 0.6 % for A = 28.2."""
    for name in ("READING", "TOLERANCE", "VOLTAGE", "CURRENT", "FLOW"):
        monkeypatch.setattr(example, name, 1e-9)
    monkeypatch.setattr(example, "TABLE", tmp_path / "table.csv")
    truth = np.array(example.simulated_table(tmp_path / "table.csv"))
    found = example.main(tmp_path / "x.png")
    W = 1.0 - example.DIAMETER / example.INNER
    bias = truth * (2.45 - 1.0) * (1.0 - W**2) ** 2 / 8.0
    np.testing.assert_allclose(1.0 - found["nusselt"] / truth, bias, atol=6e-4)
