"""Mean diameters against sums written out, and a lognormal distribution's closed forms."""

import math

import numpy as np
import pytest
from scipy.special import ndtri

from bedrad.packings.sizes import mean_diameters


def test_two_sizes_written_out():
    found = mean_diameters([1.0, 1.0, 1.0, 2.0])
    assert found.number == pytest.approx((3 * 2 + 4) / 4)
    assert found.sauter == pytest.approx((3 * 8 + 64) / (3 * 4 + 16))
    assert found.volume_weighted == pytest.approx((3 * 16 + 256) / (3 * 8 + 64))


def test_equal_spheres_have_one_diameter():
    found = mean_diameters(np.full(7, 3e-4))
    assert (found.number, found.sauter, found.volume_weighted) == pytest.approx((6e-4,) * 3, rel=1e-14)


@pytest.mark.parametrize("scale", [1e-120, 1.0, 1e120])
def test_a_lognormal_distribution(scale):
    # quantiles at equal steps: median 2 r, shape s: d_pq = exp((p + q) s^2/2) times the median
    levels = (np.arange(200_000) + 0.5) / 200_000
    s = 0.3
    found = mean_diameters(scale * 0.5 * np.exp(s * ndtri(levels)))
    assert found.number / scale == pytest.approx(math.exp(0.5 * s**2), rel=1e-4)
    assert found.sauter / scale == pytest.approx(math.exp(2.5 * s**2), rel=1e-3)
    assert found.volume_weighted / scale == pytest.approx(math.exp(3.5 * s**2), rel=2e-3)


@pytest.mark.parametrize("radii", [[], [1.0, 0.0], [1.0, -1.0], [math.nan], [math.inf], [[1.0]]])
def test_nonsense_is_refused(radii):
    with pytest.raises(ValueError, match="expected at least one positive"):
        mean_diameters(radii)
