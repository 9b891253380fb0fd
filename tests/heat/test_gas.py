import numpy as np
import pytest

from bedrad.heat import RangeWarning, gas

# dry air at 101325 Pa by Lemmon and Jacobsen (2004), from CoolProp 8.0.0 [K, W/(m K)]
LEMMON_JACOBSEN = np.array(
    [
        (200, 0.018503),
        (300, 0.026384),
        (400, 0.033453),
        (600, 0.046011),
        (800, 0.057249),
        (1000, 0.067677),
        (1200, 0.077576),
        (1373.15, 0.085849),
        (1500, 0.091782),
    ]
)


def stephan_laesecke(T):
    """Dilute air, 70 to 1000 K (Stephan and Laesecke 1985, J. Phys. Chem. Ref. Data 14, 227)."""
    coefficients = (
        33.9729025,
        -164.702679,
        262.108546,
        -21.5346955,
        -443.455815,
        607.339582,
        -368.790121,
        111.296674,
        -13.4122465,
    )
    reduced = T / 132.52
    return 4.358e-3 * sum(c * reduced ** ((i - 3) / 3) for i, c in enumerate(coefficients))


def test_second_correlation_of_the_same_year():
    T = np.linspace(200.0, 1000.0, 9)
    assert gas.air_conductivity(T) == pytest.approx(stephan_laesecke(T), rel=0.01)


def test_modern_equation_within_the_stated_error():
    T, expected = LEMMON_JACOBSEN.T
    difference = gas.air_conductivity(T) / expected - 1
    assert np.all(np.abs(difference) < 0.013)
    # the docstring's figures
    assert difference[0] == pytest.approx(-0.008, abs=5e-4)
    assert difference[1] == pytest.approx(-0.006, abs=5e-4)
    assert difference[5] == pytest.approx(0.0, abs=1e-3)
    assert difference[-1] == pytest.approx(0.013, abs=5e-4)


def test_textbook_values():
    assert gas.air_conductivity([300.0, 1000.0]) == pytest.approx([0.0263, 0.0667], rel=0.015)


def test_rises_smoothly():
    values = gas.air_conductivity(np.linspace(85.0, 2000.0, 500))
    assert np.all(np.diff(values) > 0)
    assert np.ndim(gas.air_conductivity(300.0)) == 0


def test_range_and_refusals():
    with pytest.warns(RangeWarning, match="temperature is 2100 K, outside the fitted range 85 to 2000 K") as record:
        gas.air_conductivity([300.0, 2100.0])
    assert record[0].filename == __file__
    with pytest.raises(ValueError, match="temperature is -10 K"):
        gas.air_conductivity([300.0, -10.0])
