import math

import numpy as np
import pytest

from bedrad.heat import RangeWarning
from bedrad.heat.tube_bank_air import (
    colburn_bank,
    grimison_bank,
    grimison_constants,
    maximum_velocity,
    zhukauskas_bank,
)


def test_largest_velocity():
    # the apparatus of the source: 3 tubes of 0.625 in across 4.5 in
    assert maximum_velocity(1.0, 0.625, 1.5, 1.25) == pytest.approx(4.5 / 2.625, rel=1e-14)
    # close rows: the two gaps along the diagonals are narrower
    diagonal = math.hypot(0.6, 1.5)
    assert maximum_velocity(2.0, 1.0, 3.0, 0.6) == pytest.approx(2.0 * 3.0 / (2 * (diagonal - 1.0)), rel=1e-14)
    assert maximum_velocity(2.0, 1.0, 3.0, 0.6, "aligned") == pytest.approx(3.0, rel=1e-14)


def test_known_bank():
    # Incropera and DeWitt (2002), example 7.7: staggered, S_T 31.3, S_L 34.3, D 16.4 mm, 7 rows; the example rounds
    # 0.35 (S_T/S_L)^0.2 to 0.34
    nusselt = zhukauskas_bank(13943.0, 0.71, 0.701, 31.3 / 34.3, rows=7)
    assert nusselt * 0.34 / (0.35 * (31.3 / 34.3) ** 0.2) == pytest.approx(87.9, abs=0.1)
    assert maximum_velocity(6.0, 16.4e-3, 31.3e-3, 34.3e-3) == pytest.approx(12.6, abs=0.01)


def test_formulas_by_hand():
    assert colburn_bank(1e4, 8.0) == pytest.approx(0.33 * 1e4**0.6 * 2.0, rel=1e-14)
    assert zhukauskas_bank(1e4, 1.0, 1.0, 3.0) == pytest.approx(0.40 * 1e4**0.6, rel=1e-14)
    assert zhukauskas_bank(1e6, 1.0, 1.0, 1.0) == pytest.approx(0.022 * 1e6**0.84, rel=1e-14)
    assert zhukauskas_bank(1e4, 1.0, 1.0, 1.0, arrangement="aligned") == pytest.approx(0.27 * 1e4**0.63, rel=1e-14)
    assert grimison_bank(1e4, 1.0, (0.5, 0.56)) == pytest.approx(1.13 * 0.5 * 1e4**0.56, rel=1e-14)


def test_few_rows():
    for bank in (
        lambda rows: zhukauskas_bank(7000.0, 0.7, 0.7, 1.2, rows),
        lambda rows: grimison_bank(7000.0, 0.7, (0.482, 0.556), rows),
    ):
        factors = bank(np.arange(1, 31)) / bank(40)
        assert np.all(np.diff(factors) >= 0.0)
        assert factors[-1] == 1.0
    assert zhukauskas_bank(7e3, 0.7, 0.7, 1.2, 3) / zhukauskas_bank(7e3, 0.7, 0.7, 1.2) == pytest.approx(0.84)
    # 6 rows lie between 5 (0.92) and 7 (0.95)
    assert zhukauskas_bank(7e3, 0.7, 0.7, 1.2, 6) / zhukauskas_bank(7e3, 0.7, 0.7, 1.2) == pytest.approx(0.935)
    assert grimison_bank(7e3, 0.7, (0.4, 0.5), 3) / grimison_bank(7e3, 0.7, (0.4, 0.5)) == pytest.approx(0.83)


def test_grimison_table_and_between():
    assert grimison_constants(2.0, 2.0) == pytest.approx((0.482, 0.556))
    assert grimison_constants(3.0, 0.6) == pytest.approx((0.213, 0.636))
    assert grimison_constants(1.5, 1.0) == pytest.approx((0.497, 0.558))
    assert grimison_constants(1.25, 3.0, "aligned") == pytest.approx((0.290, 0.601))
    assert grimison_constants(3.0, 1.25, "aligned") == pytest.approx((0.0633, 0.752))
    # a Nusselt number between pitches lies between theirs, at both ends of the range
    for Re in (2000.0, 40000.0):
        ends = [grimison_bank(Re, 0.7, grimison_constants(across, 2.0)) for across in (2.0, 3.0)]
        assert min(ends) < grimison_bank(Re, 0.7, grimison_constants(2.4, 2.0)) < max(ends)


def test_correlations_agree_about_a_usual_bank():
    # staggered, pitches of 2 D, 10 rows and more: the three within 12 %
    values = [
        colburn_bank(1e4, 0.7),
        zhukauskas_bank(1e4, 0.7, 0.7, 1.0),
        grimison_bank(1e4, 0.7, grimison_constants(2.0, 2.0)),
    ]
    assert max(values) / min(values) < 1.12


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: zhukauskas_bank(500.0, 0.7, 0.7, 1.0), "1000 to 2e"),
        (lambda: zhukauskas_bank(5e3, 0.5, 0.7, 1.0), "0.7 to 500"),
        (
            lambda: zhukauskas_bank(5e3, 0.7, 0.7, 0.6, arrangement="aligned"),
            "pitch ratio is 0.6, outside the fitted range from 0.7",
        ),
        (lambda: grimison_bank(1e3, 0.7, (0.5, 0.5)), "2000 to 40000"),
        (lambda: grimison_bank(1e4, 0.6, (0.5, 0.5)), "Prandtl number is 0.6, outside the fitted range from 0.7"),
    ],
)
def test_warnings(call, message):
    with pytest.warns(RangeWarning, match=message):
        call()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: maximum_velocity(1.0, 2.0, 1.5, 1.25, "aligned"), "gap between the tubes is -0.5 m"),
        (lambda: maximum_velocity(1.0, 1.0, 1.5, 0.5, "hexagonal"), "arrangement is 'hexagonal'"),
        (lambda: grimison_constants(4.0, 2.0), "transverse_ratio is 4"),
        (lambda: grimison_constants(1.25, 1.0), r"longitudinal_ratio at transverse_ratio 1.25 \(staggered\) is 1"),
        (lambda: grimison_bank(1e4, 0.7, (0.5, -1.0)), "constants is -1"),
        (lambda: grimison_bank(1e4, 0.7, (0.5, 0.5), 0), "rows is 0"),
        (lambda: zhukauskas_bank(1e4, 0.7, 0.7, 1.0, 0), "rows is 0"),
        (lambda: colburn_bank(-1.0, 0.7), "maximum_reynolds is -1"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ValueError, match=message):
        call()
