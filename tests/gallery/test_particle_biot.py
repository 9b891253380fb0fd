import pytest

from oracles.gallery import load

PNG = b"\x89PNG\r\n\x1a\n"


def test_critical_biot_numbers(tmp_path):
    critical = load("particle_biot").main(tmp_path / "x.png", points=3, modes=70)
    # 70 modes leave 0.2 % of the values with 120
    assert critical["rate"] == pytest.approx(0.0804, rel=5e-3)
    assert critical["heat"] == pytest.approx(0.0695, rel=5e-3)
    assert critical["resistance"] == pytest.approx(0.0394, rel=5e-3)
    assert (tmp_path / "x.png").read_bytes().startswith(PNG)
