import pytest

from oracles.gallery import load


def test_radiation_passes_conduction_between_1_and_2_mm(tmp_path, capsys):
    example = load("bulk_conductivity")
    crossing = example.main(tmp_path / "x.png")
    assert (tmp_path / "x.png").stat().st_size > 20_000
    assert 1e3 * crossing["Zehner–Bauer–Schlünder"] == pytest.approx(1.94, abs=0.01)
    assert 1e3 * crossing["Kunii–Smith"] == pytest.approx(1.58, abs=0.01)
    assert len(crossing) == 7
    assert all(1e-3 < d < 2e-3 for d in crossing.values())
    assert "against Table 5.2, 0.27 mm: -13.0 to -3.6 %" in capsys.readouterr().out
    # hotter, it is smaller particles
    assert example.crossings(1473.15)["Argo–Smith"] < crossing["Argo–Smith"]
