import pytest

from oracles.gallery import load


@pytest.mark.dem
def test_glass_bed_on_a_hot_floor(tmp_path):
    example = load("fluid_lens")
    wall, found = example.main(tmp_path / "x.png", tube_radius=6.0)
    # all contacts of the floor, of which a hexagonal layer would have 1.155 a square diameter, conduct alike
    floor = 16 * 3.141592653589793
    assert 0.7 < wall.contacts / floor < 1.0
    one = example.fluid_lens.conductance(example.GAS, example.DIAMETER, 0.0, example.ASPERITY)
    assert wall.contact == pytest.approx(wall.contacts * one / (floor * example.DIAMETER**2), rel=1e-3)
    assert 0.005 < wall.standard_error / wall.coefficient < 0.1
    # what parts the models is the solid for glass, not for steel
    glass, steel = found["glass"], found["steel"]
    assert glass.watkins / glass.rong_horio == pytest.approx(0.48, abs=0.03)
    assert steel.watkins / steel.rong_horio == pytest.approx(1.02, abs=0.03)
    assert -glass.solid > 0.9 * (glass.rong_horio - glass.watkins)
    assert (tmp_path / "x.png").stat().st_size > 20_000
