"""The comparison with the correlations: their values written out, residuals, and beds that have none."""

import math

import numpy as np
import pytest

import bedrad
from bedrad.heat.ranges import RangeWarning
from bedrad.jobs.comparison import check_comparable, compare_with_correlations, flow_velocity
from bedrad.packings.wall_contacts import hexagonal_maximum
from jobs.small_job import DIAMETER, WALL, ring_bed

U = 0.05


@pytest.fixture(scope="module")
def found():
    return bedrad.statistics(ring_bed())


def test_the_correlations_are_those_of_the_source(found):
    fraction, *contacts = compare_with_correlations(found, U)
    A, speed = 12.9, U / math.sqrt(9.81 * DIAMETER)
    assert fraction.correlation == pytest.approx(0.43 - 2 / (3 * A**2) - (0.003 + 1 / (4 * A)) * speed)
    expected = (1.6 / A**0.09 - 0.6) * math.exp(-(0.07 + 175 / A**2.55) * speed)
    assert [row.correlation for row in contacts] == pytest.approx([expected] * 3)
    assert [row.equation for row in (fraction, *contacts)] == ["38", "40", "40", "40"]
    assert [row.accuracy for row in (fraction, *contacts)] == [0.05, 0.16, 0.16, 0.16]


def test_the_maximum_of_both_is_the_same(found):
    from bedrad.heat.correlations import maximum_contacts

    assert hexagonal_maximum(WALL, DIAMETER / 2) == pytest.approx(maximum_contacts(12.9, DIAMETER), rel=1e-12)


def test_contacts_are_compared_at_three_gaps(found):
    _, *contacts = compare_with_correlations(found, U)
    assert [row.name for row in contacts] == [f"n_C/n_C,max at {gap} r" for gap in ("0", "0.001", "0.01")]
    for row, k in zip(contacts, (0, 2, 3), strict=True):
        assert (row.measured, row.error) == (found.contact_ratio_by_gap[k], found.contact_ratio_by_gap_error[k])


def test_residuals_are_in_standard_errors(found):
    for row in compare_with_correlations(found, U):
        assert row.residual == pytest.approx((row.measured - row.correlation) / row.error)
        assert row.difference == pytest.approx(row.measured / row.correlation - 1)
        assert abs(row.residual) > 1
    without = compare_with_correlations(bedrad.statistics(ring_bed(), blocks=1), U)
    assert all(np.isnan(row.residual) for row in without)


def test_outside_the_fits_is_warned_about(found):
    with pytest.warns(RangeWarning, match=r"velocity is 0\.5 m/s"):
        compare_with_correlations(found, 0.5)


def test_other_walls_and_velocities_are_refused(found):
    bed = bedrad.Packing([[0, 0, 1.0]], 1.0, bedrad.Plate(), (4.0, 4.0))
    with pytest.raises(ValueError, match=r"for flow in a tube; the wall is Plate\(\)"):
        compare_with_correlations(bedrad.statistics(bed, [0.0, 1.0]), U)
    with pytest.raises(ValueError, match=r"velocity is -1\.0 m/s"):
        compare_with_correlations(found, -1.0)
    check_comparable(WALL, 0.0)
    with pytest.raises(ValueError, match="velocity is nan"):
        check_comparable(WALL, math.nan)


@pytest.mark.parametrize(("notes", "expected"), [
    ({"mean_velocity_m_per_s": 0.05}, 0.05), ({"mean_velocity_m_per_s": 1}, 1.0), ({}, None),
    ({"mean_velocity_m_per_s": "fast"}, None), ({"mean_velocity_m_per_s": math.nan}, None),
])  # fmt: skip
def test_a_flow_tells_its_velocity(notes, expected):
    assert flow_velocity(notes) == expected
