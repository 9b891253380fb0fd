"""Heat transfer of a measured flow: readings reduced to h, Nu and z*, with errors (Watkins 2018, ch. 2, app. A).

Inputs are numbers or arrays, which count as exact, or `Measured` values with standard errors. Errors propagate to
first order (eq. 52), the inputs taken as independent. Intervals are of 95 % where they are asked for, as in the source.
The models one by one: wall heat flux with losses (eq. 2, 55), mean temperature from a profile (eq. 3-4, 54), h (eq.
1, 56), Nu (eq. 5, 57), z* (eq. 7), first-law check (eq. 12-14); all together: `reduce_run`; beside the two-layer
model: `beside_model`.
"""

from __future__ import annotations

from bedrad.heat.measured_flow_model import ModelRun, TwoLayerValues, beside_model, two_layer_values
from bedrad.heat.measured_flow_profile import ProfileForm, ProfileMean, mean_from_profile, quadratic_mean
from bedrad.heat.measured_flow_reduction import FluxChoice, reduce_run
from bedrad.heat.measured_flow_run import Profile, Properties, ReducedRun, Row, Run, Tube
from bedrad.heat.measured_flow_transfer import (
    FirstLaw,
    first_law_check,
    heat_transfer_coefficient,
    inverse_graetz,
    nusselt,
)
from bedrad.heat.measured_flow_value import LEVEL, Measured, coverage_factor, propagated
from bedrad.heat.measured_flow_wall import (
    INCONEL_CONDUCTIVITY,
    Insulation,
    WallHeating,
    electrical_power,
    regressed_wall_temperature,
    wall_heat_flux,
    wall_temperature_drop,
)

__all__ = [
    "INCONEL_CONDUCTIVITY",
    "LEVEL",
    "FirstLaw",
    "FluxChoice",
    "Insulation",
    "Measured",
    "ModelRun",
    "Profile",
    "ProfileForm",
    "ProfileMean",
    "Properties",
    "ReducedRun",
    "Row",
    "Run",
    "Tube",
    "TwoLayerValues",
    "WallHeating",
    "beside_model",
    "coverage_factor",
    "electrical_power",
    "first_law_check",
    "heat_transfer_coefficient",
    "inverse_graetz",
    "mean_from_profile",
    "nusselt",
    "propagated",
    "quadratic_mean",
    "reduce_run",
    "regressed_wall_temperature",
    "two_layer_values",
    "wall_heat_flux",
    "wall_temperature_drop",
]
