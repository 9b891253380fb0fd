from bedrad import heat
from bedrad.heat import tube_bank


def test_all_public_names_are_there():
    assert heat.tube_bank is tube_bank
    assert len(set(tube_bank.__all__)) == len(tube_bank.__all__)
    for name in tube_bank.__all__:
        assert getattr(tube_bank, name) is not None


def test_a_design_from_one_end_to_the_other():
    # particles at 5 mm/s across the bare tubes of the source, coefficient from its fit, walls at one temperature:
    # the effectiveness and the log-mean difference give the same heat
    h = tube_bank.TABLE_12["ID50-K"].coefficient(0.005)
    capacity = 1823.0 * 0.005 * 0.1143**2 * 780.0
    area = 8 * tube_bank.tube_area(0.015875, 0.1016)
    units = h * area / capacity
    heat_rate = tube_bank.effectiveness(units, 0.0) * capacity * 50.0
    outlet = tube_bank.outlet_temperature(310.0, heat_rate, capacity / 780.0, 780.0)
    row = tube_bank.Measurement(heat_rate, 8, 360.0, 360.0, 310.0, capacity / 780.0, 780.0)
    assert abs(tube_bank.reduce_bare_tubes(row, 0.015875, 0.1016).coefficient / h - 1.0) < 1e-12
    assert 310.0 < outlet.temperature < 315.0
