"""A settled bed has the layers beside the wall that every measurement of packed tubes has found."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.signal import find_peaks

import bedrad

D = 6e-4
RATIO = 6.5
BINS_A_DIAMETER = 20

CLOSEST, FARTHEST = math.sqrt(2.0 / 3.0), 1.0
"""Distance of layers that lie in each other's hollows, and of layers that stand on top of each other, in diameters."""


@pytest.fixture(scope="module")
def profile():
    """Depths [d], porosity and its standard error in one bed, bin by bin from the wall to the axis."""
    bed = bedrad.settle(bedrad.Tube(0.5 * RATIO * D), D, 40 * D, seed=1)
    bins = round(0.5 * RATIO * BINS_A_DIAMETER)
    edges = np.linspace(0.0, bed.wall.radius, bins + 1)
    stats = bedrad.statistics(bed, edges=[0.0, bed.wall.radius], profile_depths=edges)
    return 0.5 * (edges[1:] + edges[:-1]) / D, 1.0 - stats.profile, stats.profile_error


@pytest.fixture(scope="module")
def turning_points(profile):
    """Bins of the minima and of the maxima between them.

    Each stands out from its neighbours by more than four standard errors of a difference, so that chance seldom makes
    one.
    """
    _, porosity, error = profile
    prominence = 4.0 * math.sqrt(2.0) * float(np.median(error))
    minima, _ = find_peaks(-porosity, prominence=prominence)
    maxima = [a + int(porosity[a:b].argmax()) for a, b in itertools.pairwise(minima)]
    return minima, np.array(maxima)


@pytest.mark.dem
def test_the_first_minimum_lies_half_a_diameter_from_the_wall(profile, turning_points):
    depths, porosity, _ = profile
    first = turning_points[0][0]
    assert 0.4 <= depths[first] <= 0.6
    # a touching hexagonal layer would leave 1 - pi/(2 sqrt 3) there, and no other layer is as dense as the first
    assert 1.0 - math.pi / (2.0 * math.sqrt(3.0)) < porosity[first] == porosity[turning_points[0]].min()


@pytest.mark.dem
def test_at_the_wall_itself_there_is_no_solid(profile):
    depths, porosity, _ = profile
    # spheres that touch the wall leave a solid share in proportion to the depth, at most 2 pi/sqrt(3) y/d
    assert 1.0 - 2.0 * math.pi / math.sqrt(3.0) * depths[0] < porosity[0] < 1.0
    assert (np.diff(porosity[: BINS_A_DIAMETER // 2]) < 0.0).all()


@pytest.mark.dem
def test_three_damped_oscillations_less_than_a_diameter_long(profile, turning_points):
    depths, porosity, error = profile
    minima, maxima = turning_points
    assert len(minima) >= 3
    swings = porosity[maxima[:2]] - porosity[minima[:2]], porosity[maxima[:2]] - porosity[minima[1:3]]
    falls = np.array([swings[0][0], swings[1][0], swings[0][1], swings[1][1]])
    # each swing is smaller than the one before, but for four standard errors of the difference of two differences,
    # and the last clearly smaller than the first
    tolerance = 4.0 * 2.0 * float(np.median(error))
    assert (np.diff(falls) < tolerance).all()
    assert falls[-1] < falls[0] - tolerance
    # the bins place a minimum to half a bin
    spacing = np.diff(depths[minima[:3]])
    assert (spacing >= CLOSEST - 1.0 / BINS_A_DIAMETER).all()
    assert (spacing <= FARTHEST + 1.0 / BINS_A_DIAMETER).all()
