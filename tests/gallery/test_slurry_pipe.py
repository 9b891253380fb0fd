import pytest

from oracles.gallery import load


def test_slurry_pipe(tmp_path):
    nusselt, limits, enhancement = load("slurry_pipe").main(tmp_path / "slurry.png")
    assert (tmp_path / "slurry.png").stat().st_size > 20_000
    # Harada below eq. 16 and Ozbelge far above, as the text says
    new = nusselt["Scelzo et al., eq. 16"]
    assert nusselt["Harada et al."] < 0.8 * new < 1.6 * new < nusselt["Ozbelge and Somer"]
    # Re = rho D sqrt(10 g d (1 + 0.03 (beta - 1)))/mu by hand
    assert limits == pytest.approx([5556.0, 8659.0], rel=2e-3)
    assert enhancement == pytest.approx((5.75, 1.79), rel=0.01)
