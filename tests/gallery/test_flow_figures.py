"""Figures 4.1 to 4.3 and 5.10 to 5.12 of Watkins (2018) and what his text says about them."""

import numpy as np
import pytest

from oracles.gallery import load


def test_cold_flows_are_developed_beyond_z_star_of_0_08(tmp_path, capsys):
    curves = load("cold_flows").main(tmp_path / "cold.png")
    for found in curves.values():
        excess = found["complete"] / found["developed"] - 1
        assert (excess > 0).all()
        # "developed for z* > 0.08": to within half a percent
        assert excess[found["z_star"] > 0.08].max() < 5e-3
        # and the model falls slightly with the flow rate where the measurements seem to rise
        assert (np.diff(found["developed"], axis=1) < 0).all()
    # in the narrow tube nearly all flows are developed at the lower station; at the upper one, fast ones are developing
    # still, which is why the source sets them against the complete solution
    for number in (1, 2, 3, 4):
        upper, lower = curves[number]["z_star"]
        assert (lower > 0.08).mean() > 0.9
        assert 0.03 < upper.min() < 0.08 < upper.max()
    # the wider tube has the larger Nusselt number with the same particles
    assert (curves[5]["developed"] > curves[2]["developed"]).all()
    assert capsys.readouterr().out.count("developing up to") == 5


def test_nusselt_number_tends_to_8_as_the_tube_grows(tmp_path):
    example = load("diameter_ratio")
    Nu = example.main(tmp_path / "ratio.png")
    assert (np.diff(Nu) > 0).all()
    # 8 - Nu falls as 1/A: 8 * 4 (kappa - 1)/A
    missing = (8 - Nu[-40:]) * example.RATIOS[-40:]
    assert missing[-1] == pytest.approx(32 * (2.5 - 1), rel=0.01)
    assert np.polyfit(np.log(example.RATIOS[-40:]), np.log(8 - Nu[-40:]), 1)[0] == pytest.approx(-1, abs=0.02)


def test_hot_flows_gain_up_to_a_quarter_from_radiation(tmp_path, capsys):
    found = load("hot_flows").main(tmp_path / "hot.png")
    for one in found:
        # negligible when cold, growing, and at 1100 degC what docs/heat_claims.md compares with the published 29 %
        assert one.radiation_gain[0] < 0.012
        assert (np.diff(one.radiation_gain) > 0).all()
    assert max(one.radiation_gain[-1] for one in found) == pytest.approx(0.232, abs=0.005)
    # the wider tube: more Nusselt number, less coefficient
    assert (found[1].nusselt > found[0].nusselt).all()
    assert (found[1].heat_transfer_coefficient < found[0].heat_transfer_coefficient).all()
    # 270 and 320 um cannot be told apart: less than 5 % where the uncertainty is above 4 %
    apart = found[2].heat_transfer_coefficient / found[1].heat_transfer_coefficient - 1
    assert np.abs(apart).max() < 0.05
    assert (found[1].heat_transfer_coefficient_error > 0.04 * found[1].heat_transfer_coefficient).all()
    assert capsys.readouterr().out.count("radiation adds") == 3


def test_radiation_passes_conduction_in_large_particles(tmp_path):
    example = load("large_particles")
    found = example.main(tmp_path / "large.png")
    # "63 %" as a share; the models of bedrad have 55 % (docs/heat_claims.md)
    assert found.radiation_share[-1] == pytest.approx(0.55, abs=0.01)
    assert found.radiation_share[0] < 0.1
    assert (np.diff(found.radiation_share) > 0).all()


def test_small_particles_win_cold_and_large_ones_hot(tmp_path, capsys):
    example = load("particle_diameter")
    h, Nu = example.main(tmp_path / "diameter.png")
    assert np.argmax(h[:, 0]) == 0
    assert np.argmax(h[:, -1]) == len(example.DIAMETERS) - 1
    # cold, h falls with the diameter throughout; hot, it rises
    assert (np.diff(h[:, 0]) < 0).all()
    assert (np.diff(h[:, -1]) > 0).all()
    assert (np.diff(Nu[:, 0]) < 0).all()
    assert "1100 °C: 1.2 mm is best" in capsys.readouterr().out


def test_the_budget_names_the_bulk_first(tmp_path, capsys):
    example = load("uncertainty_budget")
    found = example.main(tmp_path / "budget.png", samples=2000)
    budget = found.budget
    assert budget.names[int(np.argmax(budget.contributions[:, 0]))] == "bulk_conductivity"
    # all inputs independent but for the view factors among themselves: squares add up
    assert (budget.contributions[:, 0] ** 2).sum() == pytest.approx(float(budget.total[0]) ** 2, rel=1e-12)
    drawn = found.monte_carlo.standard_deviation["heat_transfer_coefficient"][0]
    # 4 standard errors of a standard deviation of 2,000 draws, and 1 % for curvature
    assert drawn == pytest.approx(float(budget.total[0]), rel=4 / np.sqrt(4000) + 0.01)
    assert "2000 draws" in capsys.readouterr().out
