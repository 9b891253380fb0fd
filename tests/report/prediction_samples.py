"""Predictions that tables and figures are made from: two flows with errors, one wall temperature alone."""

from bedrad.heat.prediction import System, predict
from bedrad.heat.uncertainties import Uncertainties

TEMPERATURES = [900.0, 400.0, 1373.15, 650.0]
"""Out of order, as a job may have them. [K]"""


def two_flows(errors=True, samples=0):
    """Flows of two particle sizes, the second twice as fast."""
    given = Uncertainties.published() if errors else Uncertainties()
    return [
        predict(System(7.75e-3, d, U, solid_conductivity=2.1), TEMPERATURES, uncertainties=given, samples=samples)
        for d, U in ((6e-4, 0.016), (5e-4, 0.032))
    ]


def one_temperature():
    """A flow at one wall temperature, given as a number."""
    return predict(System(7.75e-3, 6e-4, 0.016, solid_conductivity=2.1), 900.0)
