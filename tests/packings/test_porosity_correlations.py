"""Published porosities: values evaluated apart in 30 digits, limits, branches that meet, and refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from bedrad.packings.porosity_correlations import (
    benyahia_oneill,
    cheng,
    de_klerk_profile,
    dixon,
    foumeny,
    zou_yu_loose,
)

RATIOS = np.array([2.5, 3.9, 6.0, 12.9, 25.0])
VALUES = {  # from the equations rearranged (common denominators, powers of e), in 30 digits
    dixon: [0.48592, 0.439907955293, 0.419777777778, 0.406351781744, 0.4026592],
    foumeny: [0.504328777895, 0.436614367488, 0.409598487793, 0.39130850633, 0.38615032045],
    zou_yu_loose: [0.5228, 0.538491781723, 0.449357892409, 0.412895884678, 0.405333271773],
    benyahia_oneill: [0.521324719237, 0.458499622071, 0.424131299579, 0.398827038742, 0.392546467172],
    cheng: [0.517196956868, 0.421234228011, 0.393521000706, 0.381562805592, 0.379867715137],
}
LIMITS = {dixon: 0.4, foumeny: 0.383, zou_yu_loose: 0.4, benyahia_oneill: 0.39, cheng: 0.38}
SMALLEST = {dixon: 2.0, foumeny: 2.0, zou_yu_loose: 1.0 / 0.538, benyahia_oneill: 1.5, cheng: 1.0}

each = pytest.mark.parametrize("correlation", VALUES, ids=lambda f: f.__name__)


@each
def test_values(correlation):
    assert correlation(RATIOS) == pytest.approx(VALUES[correlation], abs=1e-11)
    assert isinstance(correlation(6.0), float)


@each
def test_a_wide_tube_has_the_porosity_of_the_bulk(correlation):

    assert correlation(1e6) == pytest.approx(LIMITS[correlation], abs=2e-5)


@each
def test_what_is_too_narrow_or_no_number_is_refused(correlation):
    smallest = SMALLEST[correlation]
    for ratio in (smallest - 0.01, np.nan, np.inf, -3.0):
        with pytest.raises(ValueError, match=r"^diameter_ratio is .*; expected a finite number from"):
            correlation(np.array([6.0, ratio]))
    assert np.isfinite(correlation(smallest + 1e-9))


def test_benyahia_and_oneill_as_another_program_gives_it():
    # python-fluids 1.0, documented example of voidage_Benyahia_Oneil_spherical
    assert benyahia_oneill(50.0) == pytest.approx(0.3906653157443224, rel=1e-15)


def test_the_branches_of_zou_and_yu_meet():
    assert zou_yu_loose(np.nextafter(3.95, 0.0)) == pytest.approx(zou_yu_loose(3.95), abs=1e-3)


def test_profile_values():
    values = [1.0, 0.50125, 0.2524, 0.625676307819, 0.402367861113]
    assert de_klerk_profile([0.0, 0.25, 0.6, 1.03, 2.5], 0.41) == pytest.approx(values, abs=1e-11)
    assert de_klerk_profile(40.0, 0.41) == pytest.approx(0.41, abs=1e-9)


def test_profile_has_its_first_minimum_and_meets_itself_where_it_says():
    lowest = minimize_scalar(de_klerk_profile, bounds=(0.3, 0.637), method="bounded", options={"xatol": 1e-9})
    assert lowest.x == pytest.approx(0.591, abs=5e-4)
    z = np.array([0.637, np.nextafter(0.637, 1.0)])
    assert de_klerk_profile(z, 0.361) == pytest.approx([0.2568] * 2, abs=2e-4)
    assert np.diff(de_klerk_profile(z, 0.41))[0] == pytest.approx(0.41 - 0.361, abs=2e-4)


def test_profile_refuses_what_has_no_meaning():
    for depth in (-0.1, np.nan, np.inf):
        with pytest.raises(ValueError, match=r"^depth is .*; expected a distance that is not negative"):
            de_klerk_profile([0.5, depth])
    for bulk in (0.0, 1.0, np.nan):
        with pytest.raises(ValueError, match=r"^bulk_porosity is .*; expected a number between 0 and 1"):
            de_klerk_profile(0.5, bulk)
