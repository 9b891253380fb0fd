"""Tubes across a moving packed bed, and across air: the particle heat exchanger of Nguyen (2015).

Correlations for air across a tube and a bank (to check an apparatus with), the reduction of measurements on bare and
finned tubes to heat transfer coefficients with their uncertainty, and the values that the source measured. What is
general has modules of its own: `heat_exchanger`, `fins`, `particle_sizes`, `kopp_neumann`.
"""

from __future__ import annotations

from bedrad.heat.fins import FinnedTube, annular_fin_efficiency, corrected_radius, fin_parameter
from bedrad.heat.heat_exchanger import (
    effectiveness,
    log_mean_temperature_difference,
    logarithmic_mean,
    loss_conductance,
    outlet_temperature,
    transfer_units,
)
from bedrad.heat.kopp_neumann import mixture_specific_heat
from bedrad.heat.particle_sizes import sauter_diameter, sieve_sauter_diameter
from bedrad.heat.tube_bank_air import (
    colburn_bank,
    grimison_bank,
    grimison_constants,
    maximum_velocity,
    zhukauskas_bank,
)
from bedrad.heat.tube_bank_reduction import (
    BareTubeResult,
    FinnedTubeResult,
    Measurement,
    fin_effectiveness,
    reduce_bare_tubes,
    reduce_finned_tubes,
    surface_coefficient,
    tube_area,
    tube_temperature,
)
from bedrad.heat.tube_bank_single import ashrae_tube, churchill_bernstein_tube, hilpert_tube, zhukauskas_tube
from bedrad.heat.tube_bank_tables import (
    MATERIALS,
    SPEED_RANGE,
    TABLE_12,
    TABLE_13,
    TABLE_14,
    TABLE_15,
    ParticleMaterial,
    QuadraticFit,
)
from bedrad.heat.tube_bank_uncertainty import SensitivityBudget, budget_from_sensitivities, sensitivity_budget

__all__ = [
    "MATERIALS",
    "SPEED_RANGE",
    "TABLE_12",
    "TABLE_13",
    "TABLE_14",
    "TABLE_15",
    "BareTubeResult",
    "FinnedTube",
    "FinnedTubeResult",
    "Measurement",
    "ParticleMaterial",
    "QuadraticFit",
    "SensitivityBudget",
    "annular_fin_efficiency",
    "ashrae_tube",
    "budget_from_sensitivities",
    "churchill_bernstein_tube",
    "colburn_bank",
    "corrected_radius",
    "effectiveness",
    "fin_effectiveness",
    "fin_parameter",
    "grimison_bank",
    "grimison_constants",
    "hilpert_tube",
    "log_mean_temperature_difference",
    "logarithmic_mean",
    "loss_conductance",
    "maximum_velocity",
    "mixture_specific_heat",
    "outlet_temperature",
    "reduce_bare_tubes",
    "reduce_finned_tubes",
    "sauter_diameter",
    "sensitivity_budget",
    "sieve_sauter_diameter",
    "surface_coefficient",
    "transfer_units",
    "tube_area",
    "tube_temperature",
    "zhukauskas_bank",
    "zhukauskas_tube",
]
