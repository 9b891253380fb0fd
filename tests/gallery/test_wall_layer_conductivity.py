import pytest

from oracles.gallery import load


def test_forms_agree_with_the_sum_over_the_particles(tmp_path, capsys):
    found = load("wall_layer_conductivity").main(tmp_path / "x.png")
    assert (tmp_path / "x.png").stat().st_size > 20_000
    exact = found["particle by particle"]
    # one distance, weighted by volume, for all particles without contact: within 2 % at K = 70
    assert found["exact in the tube"] == pytest.approx(exact, rel=0.02)
    assert found["exact, plain mean"] < found["exact in the tube"]
    assert 1.05 < found["all in contact (a = 0)"] / exact < 1.5
    assert found["flat"] < 0.97 * found["exact in the tube"]
    assert found["Schlünder (smooth, isothermal)"] > found["all in contact (a = 0)"]
    assert 0 < found["error"] < 0.05 * exact
    assert "Yagi and Kunii" in capsys.readouterr().out
