import numpy as np
import pytest
from scipy.integrate import quad

from bedrad.heat import two_layer


def integrated(A, kappa):
    """Nusselt number by integration over the radius, in units of R, k_b and the wall flux.

    In a plug flow heated uniformly the flux at radius r is that at the wall times r: dT/dr = r/k(r).
    """
    edge = 1 - 1 / A

    def conductivity(r):
        return 1.0 if r < edge else 1.0 / kappa

    def below_wall(r):
        return quad(lambda s: s / conductivity(s), r, 1.0, points=[edge] if r < edge else None, epsrel=1e-12)[0]

    mean = sum(
        quad(lambda r: 2 * r * below_wall(r), low, high, epsrel=1e-11)[0] for low, high in ((0, edge), (edge, 1))
    )
    return 2.0 / mean  # h D/k_b with h = 1/(T_w - T_mean)


@pytest.mark.parametrize(("A", "kappa"), [(2.5, 0.3), (12.9, 2.5), (28.2, 1.0), (40.1, 7.0)])
def test_integration_over_the_radius(A, kappa):
    assert two_layer.nusselt_developed(A, kappa) == pytest.approx(integrated(A, kappa), rel=1e-10)


def test_one_layer_and_wide_tubes_give_eight():
    assert two_layer.nusselt_developed([2.0, 12.9, 1e6], 1.0) == pytest.approx(8.0, rel=1e-14)
    assert two_layer.nusselt_developed(np.inf, [0.1, 10.0]) == pytest.approx(8.0, rel=1e-14)


def test_source_example():
    # Watkins 2018, Fig. 4.3: k_wa 0.12, k_b 0.30 W/(m K), A = 28.2
    W = 1 - 1 / 28.2
    assert two_layer.nusselt_developed(28.2, 0.30 / 0.12) == pytest.approx(8 / (W**4 + 2.5 * (1 - W**4)), rel=1e-14)


def test_broadcast():
    assert two_layer.nusselt_developed(np.ones((3, 1)) * 20, np.array([1.0, 2.0])).shape == (3, 2)


@pytest.mark.parametrize(
    ("A", "kappa", "message"),
    [
        (1.0, 2.0, "diameter_ratio is 1; expected more than 1"),
        (np.nan, 2.0, "diameter_ratio is nan"),
        (20.0, 0.0, "conductivity_ratio is 0"),
        (20.0, np.inf, "conductivity_ratio is inf"),
    ],
)
def test_refusals(A, kappa, message):
    with pytest.raises(ValueError, match=message):
        two_layer.nusselt_developed(A, kappa)
