import pytest

from oracles.gallery import load


def test_bulk_comes_back_within_its_error(tmp_path):
    found, error = load("static_bed_cell").main(tmp_path / "cell.png")
    assert (tmp_path / "cell.png").stat().st_size > 20_000
    # Table 2.4 at 50 degrees Celsius, 320 um
    assert abs(found.bulk_conductivity - (0.000371 * 50 + 0.281)) < 2 * found.bulk_error
    assert found.chi_squared < 4
    # by hand for equal relative errors: larger than that of one bed, since a difference of beds gives the slope
    assert 0.03 < error < 0.06
    assert found.bulk_error / found.bulk_conductivity == pytest.approx(error, rel=0.1)
