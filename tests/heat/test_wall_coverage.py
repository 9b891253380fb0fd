import itertools

import numpy as np
import pytest

from bedrad.heat import RangeWarning, wall_coverage

MANTISSAS = np.array([1.0838, -2.1709, 2.4268, 1.9101, -1.2243, 6.1504, -1.1706, 7.9093])
FRACTIONS = np.linspace(0.01, 0.6, 60)


def test_values():
    found = wall_coverage.nusselt_ratio([0.5, 0.55, 0.58])
    assert found == pytest.approx([0.292332, 0.430375, 0.591730], abs=5e-7)
    assert wall_coverage.nusselt_ratio(0.0) == 1.0838e-3
    assert wall_coverage.nusselt_ratio(wall_coverage.LARGEST_SOLID_FRACTION) == pytest.approx(0.806, abs=1e-3)


def test_restored_powers_of_ten_are_the_only_ones_that_rise():
    """The print shows 10^-3 and 10^-2, then one mark for 10 to an even power or none, and another twice."""
    powers = np.vander(FRACTIONS, 8, increasing=True)
    rising = []
    for exponents in itertools.product(range(4), repeat=6):
        # the 5th and the last coefficient carry the same mark in the print, so the same exponent
        if exponents[2] != exponents[5]:
            continue
        curve = powers @ (MANTISSAS * 10.0 ** np.array([-3, -2, *exponents]))
        if np.all(np.diff(curve) > 0) and curve[0] >= 0 and curve[-1] <= 1:
            rising.append(exponents)
    assert rising == [(0, 0, 2, 2, 3, 2)]
    restored = MANTISSAS * 10.0 ** np.array([-3, -2, *rising[0]])
    assert np.array(wall_coverage.NUSSELT_RATIO) == pytest.approx(restored, rel=1e-12)


def test_rises_throughout_but_for_a_trifle_next_to_nothing():
    curve = wall_coverage.nusselt_ratio(np.linspace(0.0, 0.6, 6001))
    assert np.all(np.diff(curve)[50:] > 0)
    assert curve.min() == pytest.approx(1.036e-3, abs=1e-6)


def test_range():
    with pytest.warns(RangeWarning, match=r"solid_fraction is 0\.65, outside the fitted range 0 to 0\.6046"):
        wall_coverage.nusselt_ratio(0.65)
    with pytest.raises(ValueError, match=r"solid_fraction is 1\.2"):
        wall_coverage.nusselt_ratio(1.2)
    assert wall_coverage.nusselt_ratio(np.full((2, 3), 0.55)).shape == (2, 3)
