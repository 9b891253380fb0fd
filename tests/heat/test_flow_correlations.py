"""Correlations of bedrad's own flows: the fits are those of the kept table, and predictions can take them."""

from __future__ import annotations

import csv
import importlib
import math
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from bedrad.heat import correlations, flow_coefficients, flow_correlations
from bedrad.heat.prediction import System, predict
from bedrad.heat.ranges import RangeWarning
from bedrad.heat.systems import ViewFactors, WallLayer

ROOT = Path(__file__).parents[2]
LOW, HIGH = flow_coefficients.DIAMETER_RATIOS
SLOW, FAST = flow_coefficients.VELOCITIES
D = 450e-6


def velocity(dimensionless: float, diameter: float = D) -> float:
    return dimensionless * math.sqrt(9.81 * diameter)


@pytest.fixture(scope="module")
def study() -> list[dict[str, str]]:
    with (ROOT / "docs" / "flow_study.csv").open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture
def flow_fits(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    module = importlib.import_module("flow_fits")
    for name in ("flow_fits", "flow_study", "flow_points"):
        monkeypatch.delitem(sys.modules, name)
    return module


class TestFits:
    def test_the_coefficients_are_those_of_the_kept_table(
        self, flow_fits: ModuleType, study: list[dict[str, str]]
    ) -> None:
        A, U, found = flow_fits.fits(study)
        assert len(A) == flow_coefficients.POINTS
        assert flow_fits.module_text(A, U, found) == Path(flow_coefficients.__file__).read_text(encoding="utf-8")

    def test_least_squares_find_coefficients_and_scatter(self, flow_fits: ModuleType) -> None:
        # made-up flows with a known law, known errors and a scatter of their own, many times over
        rng = np.random.default_rng(11)
        A, U = rng.uniform(10.0, 40.0, 40), rng.uniform(0.3, 3.0, 40)
        design = np.stack([A**-p * U**q for p, q in flow_fits.TERMS], axis=1)
        true, scatter = np.array([0.45, -0.3, -0.01, -0.2]), 0.01
        z, scatters = [], []
        for _ in range(400):
            errors = rng.uniform(0.003, 0.01, 40)
            values = design @ true + rng.normal(0.0, np.hypot(errors, scatter))
            coefficients, covariance, found = flow_fits.least_squares(design, values, errors)
            z.append((coefficients - true) / np.sqrt(np.diag(covariance)))
            scatters.append(found)
        # 1,600 standard scores, correlated in fours; the scatter is itself estimated, from 36 degrees of freedom
        assert np.mean(np.square(z)) == pytest.approx(1.0, abs=5 * math.sqrt(2 / 400) * 0.7)
        assert abs(np.mean(z)) < 5 / math.sqrt(400)
        assert np.mean(scatters) == pytest.approx(scatter, rel=0.1)

    def test_the_flows_lie_about_the_fit_as_its_errors_say(self, study: list[dict[str, str]]) -> None:
        rows = [row for row in study if not row["variation"] and "thinned" not in row["problems"]]
        for quantity, column in (("packing_fraction", "phi_wa"), ("view_factor_1", "F_w1")):
            z = []
            for row in rows:
                arguments = (float(row["A [1]"]), float(row["U [m/s]"]), float(row["particle diameter [m]"]))
                value, error = flow_correlations.estimate(quantity, *arguments, warn=False)  # type: ignore[arg-type]
                z.append((float(row[f"{column} [1]"]) - value) / math.hypot(error, float(row[f"{column} error [1]"])))
            # chi-square per flow is below one, as the flows were fitted; 4.5: one flow in 150,000
            assert max(map(abs, z)) < 4.5
            assert np.mean(np.square(z)) < 1.5


class TestEstimate:
    @pytest.mark.parametrize("quantity", list(flow_coefficients.FITS))
    def test_it_is_the_sum_of_its_terms(self, quantity: flow_correlations.Quantity) -> None:
        A, U = 0.5 * (LOW + HIGH), 0.5 * (SLOW + FAST)
        value, error = flow_correlations.estimate(quantity, A, velocity(U), D)
        (c, covariance, scatter) = flow_coefficients.FITS[quantity]
        assert value == pytest.approx(c[0] + c[1] / A + (c[2] + c[3] / A) * U, rel=1e-12)
        terms = [1.0, 1.0 / A, U, U / A]
        variance = sum(terms[i] * terms[j] * covariance[i][j] for i in range(4) for j in range(4))
        assert error == pytest.approx(math.sqrt(variance + scatter**2), rel=1e-9)

    def test_arrays_broadcast(self) -> None:
        value, error = flow_correlations.estimate(
            "packing_fraction", np.linspace(LOW, HIGH, 3)[:, None], velocity(np.linspace(SLOW, FAST, 4)), D
        )
        assert value.shape == error.shape == (3, 4)

    def test_view_factors_leave_room_for_what_returns_and_goes_beyond(self) -> None:
        A, U = np.meshgrid(np.linspace(LOW, HIGH, 5), np.linspace(SLOW, FAST, 5))
        factors = [
            flow_correlations.estimate(name, A, velocity(U), D)[0]
            for name in ("view_factor_1", "view_factor_2", "view_factor_3")
        ]
        assert (np.array(factors) > 0.0).all()
        total = np.sum(factors, axis=0)
        # a concave wall sees itself, the less the wider the tube; the flows that were fitted have 0.985 to 0.993
        assert ((total > 0.98) & (total < 1.0)).all()
        assert (np.diff(total, axis=1) > 0.0).all()

    def test_outside_its_range_it_warns(self) -> None:
        with pytest.warns(RangeWarning, match="diameter_ratio"):
            flow_correlations.estimate("packing_fraction", 2.0 * HIGH, velocity(SLOW), D)
        with pytest.warns(RangeWarning, match="velocity"):
            flow_correlations.estimate("packing_fraction", LOW, velocity(2.0 * FAST), D)

    def test_wrong_input_is_refused(self) -> None:
        with pytest.raises(ValueError, match="quantity is 'phi'; expected one of packing_fraction"):
            flow_correlations.estimate("phi", LOW, 0.1, D)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="particle_diameter"):
            flow_correlations.estimate("packing_fraction", LOW, 0.1, 0.0)


class TestPrediction:
    SYSTEM = System(LOW * D * 1.2, D, velocity(0.5 * (SLOW + FAST)))

    def test_it_takes_bedrads_flows_with_their_errors(self) -> None:
        found = predict(self.SYSTEM, 1000.0, bulk="zbs", correlation="bedrad")
        A, d, U = self.SYSTEM.diameter_ratio, self.SYSTEM.particle_diameter, self.SYSTEM.velocity
        solid, error = flow_correlations.estimate("packing_fraction", A, U, d)
        assert (found.wall_layer.packing_fraction, found.wall_layer.packing_fraction_error) == (solid, error)
        contacts, _ = flow_correlations.estimate("contact_ratio", A, U, d)
        assert found.wall_layer.contacts_per_area == pytest.approx(contacts * correlations.maximum_contacts(A, d))
        assert found.view_factors.to_layers[1] == flow_correlations.estimate("view_factor_2", A, U, d)[0]
        assert (found.heat_transfer_coefficient_error > 0.0).all()

    def test_watkins_is_the_default(self) -> None:
        one, other = (
            predict(self.SYSTEM, 1000.0, bulk="zbs", **words)  # type: ignore[arg-type]
            for words in ({}, {"correlation": "watkins"})
        )
        assert one.heat_transfer_coefficient == other.heat_transfer_coefficient
        assert one.wall_layer == WallLayer.from_correlations(self.SYSTEM)
        assert one.view_factors.to_layers.tolist() == ViewFactors.watkins().to_layers.tolist()

    def test_no_other_is_known(self) -> None:
        with pytest.raises(ValueError, match="correlation is 'mine'; expected 'watkins' or 'bedrad'"):
            predict(self.SYSTEM, 1000.0, correlation="mine")  # type: ignore[arg-type]
