import pytest

from oracles.gallery import load


def test_two_layer_entry(tmp_path, capsys):
    numbers = load("two_layer_entry").main(tmp_path / "x.png")
    assert (tmp_path / "x.png").stat().st_size > 20_000
    assert numbers["excess at z* = 0.08"] == pytest.approx(0.0043, abs=5e-5)  # Watkins 2018, section 4.1: developed
    assert numbers["developed z*"] == pytest.approx(0.03889, abs=1e-5)
    assert numbers["earliest"] < 0.01
    assert numbers["latest"] > 2
    assert "exceeds the developed one by 0.43%" in capsys.readouterr().out
