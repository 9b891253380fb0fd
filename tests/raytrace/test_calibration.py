"""Are the stated errors right? Many seeds against the truth, share by share and by the covariance of all together.

`benchmarks/calibration.py` does the same on large beds at five tolerances.
"""

import numpy as np
import pytest
from scipy import stats

import bedrad
from oracles.beds import axial_chain, random_bed

SEEDS = 300
BINS = 10
FALSE_ALARM = 1e-3
"""Of each test here, were its seeds drawn anew. With 300 seeds it finds errors a fifth too large or too small."""


def in_bins(probabilities):
    """Chi-square p of the numbers in equally likely bins."""
    observed = np.bincount(np.minimum((probabilities * BINS).astype(int), BINS - 1), minlength=BINS)
    return stats.chisquare(observed).pvalue


def p_values(deviations, errors):
    """Whether deviations over stated errors are normal, and whether their mean square is one."""
    z = deviations / errors
    below = stats.chi2.cdf((z**2).sum(), len(z))
    return [in_bins(stats.norm.cdf(z)), 2 * min(below, 1 - below)]


@pytest.mark.parametrize("effort", [{"tolerance": 1e-3}, {"rays": 2**17}])
def test_errors_of_a_chain_against_the_closed_form(effort):
    """F = (A_s/A_w)(1 - 2 F_neighbour) of touching spheres on the axis of a tube of 1.5 radii."""
    exact = 2 / 3 * (1 - 2 * 0.07558681842161)
    found = [bedrad.view_factors(axial_chain(1.5), [0.0, 1.0], seed=s, threads=1, **effort) for s in range(SEEDS)]
    p = p_values(np.array([1 - f.wall - exact for f in found]), np.array([f.wall_error for f in found]))
    assert min(p) > FALSE_ALARM / len(p)


@pytest.mark.parametrize("tolerance", [2e-3, 5e-4])
def test_errors_and_covariance_of_six_shares_against_a_long_run(tolerance):
    """A narrow window of an open tube of mixed sizes; the truth's error, 1/20 or 1/10, is added in quadrature.

    The rounds to the looser tolerance are the smallest there are, and whether there is another depends on the error.
    """
    bed = random_bed(bedrad.Tube(5.0), 150, seed=4, length=8.0, spread=3.5)
    edges = [0.0, 0.6, 1.5, 3.0]
    truth = bedrad.view_factors(bed, edges, tolerance=5e-5, seed=SEEDS)
    found = [bedrad.view_factors(bed, edges, tolerance=tolerance, seed=s, threads=1) for s in range(SEEDS)]
    expected = truth.history[-1].estimates
    # whole numbers are too few values for bins where they are small
    assert expected.min() * found[0].rays > 100
    deviations = np.array([f.history[-1].estimates for f in found]) - expected
    covariances = np.array([f.covariance for f in found]) + truth.covariance
    p = [p_values(deviations[:, k], np.sqrt(covariances[:, k, k])) for k in range(6)]
    # the shares sum to one: the first follows from the others
    square = [d @ np.linalg.solve(c, d) for d, c in zip(deviations[:, 1:], covariances[:, 1:, 1:], strict=True)]
    tests = [*np.ravel(p), in_bins(stats.chi2.cdf(square, 5))]
    assert min(tests) > FALSE_ALARM / len(tests)
