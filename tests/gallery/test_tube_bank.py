import pytest

from oracles.gallery import load


def test_tube_bank(tmp_path):
    found = load("tube_bank").main(tmp_path / "tubes.png")
    assert (tmp_path / "tubes.png").stat().st_size > 20_000
    # Nguyen (2015), figure 21: 117.9 +- 1.565 W/(m2 K), 64.94 % of the variance from the power
    assert found.coefficient == pytest.approx(117.9, abs=0.06)
    assert found.uncertainty == pytest.approx(1.565, abs=0.005)
    assert found.power_share == pytest.approx(0.6494, abs=3e-3)
    # section 8: about 8
    assert 7.0 < found.fin_effectiveness < 9.5
    assert found.fin_efficiency == pytest.approx(0.71, abs=0.02)
