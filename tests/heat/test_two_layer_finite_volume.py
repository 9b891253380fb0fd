"""The complete model against finite volumes, which know nothing of modes or transforms."""

import numpy as np
import pytest

from bedrad.heat import two_layer
from bedrad.heat.two_layer_modes import find_modes, layers
from oracles.finite_volume_tube import Tube

CELLS = np.array([40, 80, 160, 320])


@pytest.mark.parametrize(("A", "kappa"), [(28.2, 2.5), (3.0, 100.0), (3.0, 0.01), (1.5, 5.0)])
def test_second_order_convergence(A, kappa):
    """The distance to the complete model is the error of the grid: it falls with the square of the cell's width."""
    z_star = np.array([0.005, 0.08, 0.3])
    exact = two_layer.nusselt(A, kappa, z_star, tolerance=1e-12)
    errors = np.array([[Tube(A, kappa, n, n // 2).nusselt(z) for z in z_star] for n in CELLS]) / exact - 1
    for k in range(z_star.size):
        order = -np.polyfit(np.log(CELLS), np.log(np.abs(errors[:, k])), 1)[0]
        assert order == pytest.approx(2.0, abs=0.02)
    extrapolated = (4 * errors[-1] - errors[-2]) / 3
    assert np.max(np.abs(extrapolated)) < 2e-5 if kappa == 100.0 else np.max(np.abs(extrapolated)) < 1e-6


@pytest.mark.parametrize(("A", "kappa", "z_star"), [(4.0, 6.0, 0.02), (4.0, 0.1, 0.1), (28.2, 2.5, 1e-3)])
def test_field_converges(A, kappa, z_star):
    errors = []
    for n in (100, 200):
        tube = Tube(A, kappa, n, n)
        field = two_layer.temperature_rise(tube.centres, A, kappa, z_star)
        errors.append(
            np.max(np.abs(0.5 * tube.temperature(4 * z_star) - field))
            / two_layer.temperature_rise(1.0, A, kappa, z_star)
        )
    assert errors[1] < 2e-4
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_what_the_local_form_neglects():
    """A flux that rises by 12 % on the way to z* = 0.3: the local one there overstates the difference by 0.32 %.

    To leading order by the flux's relative slope in t times the sum of weights/mu^2 over the sum of weights.
    """
    tube, t, ramp = Tube(28.2, 2.5, 300, 100), 1.2, 0.1
    flux = 1 + ramp * t
    overstated = flux * tube.excess(t) / tube.excess(t, ramp) - 1
    assert overstated == pytest.approx(0.00324, abs=2e-5)
    modes = find_modes(layers(np.array([28.2]), np.array([2.5])), 50)
    lag = np.sum(modes.weights / modes.mu**2) / modes.layers.resistance[0]
    assert overstated == pytest.approx(ramp / flux * lag, rel=0.03)
