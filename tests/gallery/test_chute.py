import pytest

from oracles.gallery import load


def test_gas_layers_turning_point_and_error(tmp_path):
    gaps, best, worst = load("chute").main(tmp_path / "chute.png")
    assert (tmp_path / "chute.png").stat().st_size > 20_000
    # "similar" for 1.35 mm, "slightly greater" for 0.33 mm than the fitted 0.085
    assert gaps[1.35e-3] == pytest.approx(0.085, rel=0.15)
    assert 0.085 < gaps[0.33e-3] < 0.105
    # the heat transfer falls at flows faster than some 9 cm/s
    assert 0.07 < best < 0.15
    assert worst == pytest.approx(-0.04764, abs=1e-5)
