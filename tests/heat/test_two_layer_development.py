import numpy as np
import pytest
from scipy.special import jn_zeros

from bedrad.heat import two_layer


def test_excess_at_the_distance_is_the_share():
    A, kappa = np.array([1.5, 28.2, 1e3])[:, None, None], np.array([1e-3, 2.5, 1e3])[:, None]
    share = np.array([1e-6, 0.0043, 0.05, 3.0, 1000.0])
    z_star = two_layer.developed_z_star(A, kappa, share)
    excess = two_layer.nusselt(A, kappa, z_star, tolerance=1e-12) / two_layer.nusselt_developed(A, kappa) - 1
    assert excess == pytest.approx(np.broadcast_to(share, excess.shape), rel=1e-5)
    assert excess[..., 1:] == pytest.approx(np.broadcast_to(share[1:], (3, 3, 4)), rel=1e-8)


def test_source_example():
    assert two_layer.developed_z_star(28.2, 2.5, 0.0043) == pytest.approx(0.08, rel=2e-3)
    assert two_layer.developed_z_star(28.2, 2.5) == pytest.approx(0.03889, abs=1e-5)


def test_small_shares_leave_one_mode():
    """One layer: share = 8 exp(-4 j^2 z*)/j^2 with the first zero of J1."""
    j, share = jn_zeros(1, 1)[0], np.array([1e-12, 1e-9])
    first = np.log(8 / (j**2 * share)) / (4 * j**2)
    assert two_layer.developed_z_star(28.2, 1.0, share) == pytest.approx(first, rel=1e-9)


def test_insulating_layers_develop_later():
    """As kappa grows in a thick layer its own diffusion decides: z* in proportion to kappa."""
    z_star = two_layer.developed_z_star(2.0, [1e3, 1e4, 1e5])
    assert z_star[1:] / z_star[:-1] == pytest.approx([10, 10], rel=0.05)
    one = two_layer.developed_z_star([1 + 1e-9, 3.0, np.inf], [1.0, 1.0, 7.0])
    assert one == pytest.approx(np.full(3, one[0]), rel=1e-9)


def test_shapes():
    assert two_layer.developed_z_star(np.zeros((0, 3)) + 2, 1.0).shape == (0, 3)
    assert isinstance(two_layer.developed_z_star(20.0, 2.0), float)


@pytest.mark.parametrize("share", [0.0, -0.1, 1e4, np.nan])
def test_refusals(share):
    with pytest.raises(ValueError, match="share is"):
        two_layer.developed_z_star(20.0, 2.0, share)
