import numpy as np

from oracles.gallery import load


def test_grey_walls(tmp_path):
    numbers = load("grey_walls").main(tmp_path / "grey_walls.png")
    assert (tmp_path / "grey_walls.png").stat().st_size > 10_000
    # the black limit of both ways is that of the view factors; 5 standard errors and the tolerance of the latter
    value, error = numbers.by_rays[1.0]
    assert abs(value - numbers.black) < 5 * error + 2e-3
    assert abs(numbers.by_zones[-1] - numbers.black) < 4e-3
    # grey surfaces pass more than two plates would, less than black ones; one radiosity a layer passes too much
    for e in (0.8, 0.5, 0.2):
        share = numbers.by_rays[e][0] / numbers.black
        assert 1.0 / (2.0 / e - 1.0) < share < e
        assert np.interp(e, numbers.emissivities, numbers.by_zones) > numbers.by_rays[e][0]
