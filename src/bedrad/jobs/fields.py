"""Units and long names of what the results file holds, one table a stage."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = [
    "BUDGET",
    "CONVERGENCE",
    "FLOW",
    "HISTORY",
    "INPUT_UNITS",
    "PREDICTION",
    "STATISTICS",
    "SYSTEM",
    "UNITS",
    "VIEW_FACTORS",
    "WALL_LAYER",
    "Field",
]

Field = tuple[str, str]
"""Units ("1" for none) and long name of a dataset; ``<name>_error`` is understood beside it."""

FLOW: Mapping[str, Field] = {
    "velocity": ("m/s", "mean velocity of the flow, U"),
    "set_velocity": ("m/s", "velocity that was asked for"),
    "froude": ("1", "velocity over the root of g d, U*"),
    "velocity_fluctuation": ("m/s", "standard deviation in time of the mean velocity"),
    "core_velocity": ("m/s", "velocity of the plug core"),
    "wall_velocity": ("m/s", "velocity of the spheres beside the wall"),
    "shear_width": ("m", "width of the shear layer"),
    "profile_radii": ("m", "distances from the axis that part the bins of the velocity profile"),
    "profile_speeds": ("m/s", "velocity of each bin"),
    "granular_temperature": ("1", "mean square of a velocity component about the mean, over g d"),
    "solid_fraction": ("1", "solid fraction over the whole cross-section"),
    "rest_solid_fraction": ("1", "the same before the flow began"),
    "wall_pressure": ("Pa", "pressure of the spheres on the wall"),
    "wall_shear": ("Pa", "shear stress on the wall"),
    "janssen_pressure": ("Pa", "Janssen's asymptote of the wall pressure"),
    "discharge": ("kg/s", "mass flow"),
    "beverloo_discharge": ("kg/s", "mass flow by Beverloo's law, of an orifice"),
    "independent_structures": ("1", "length of bed that passed, in windows"),
    "frames": ("1", "frames that the values are means over"),
    "resumed": ("1", "1 if the simulation was cut off and gone on with"),
}

STATISTICS: Mapping[str, Field] = {
    "packing_fraction": ("1", "solid fraction of the wall layer"),
    "contacts_per_area": ("1/m2", "wall contacts per wall area"),
    "contact_ratio": ("1", "wall contacts over the hexagonal maximum"),
    "nc_share": ("1", "share of particles without contact in the wall layer"),
    "nc_distance": ("1", "mean gap of no-contact particles to the wall, in radii"),
    "nc_distance_weighted": ("1", "the same, weighted by volume in the wall layer"),
    "nc_distance_closing": ("1", "the same, as the one gap that closes the wall layer's solid volume"),
    "edges": ("m", "depths that part the layers"),
    "packing_fractions": ("1", "solid fraction of each layer"),
    "gap_tolerances": ("1", "gap tolerances of the counts by gap, in radii"),
    "contacts_per_area_by_gap": ("1/m2", "wall contacts per wall area, by gap tolerance"),
    "contact_ratio_by_gap": ("1", "wall contacts over the hexagonal maximum, by gap tolerance"),
    "profile_depths": ("m", "depths that part the bins of the profile"),
    "profile": ("1", "solid fraction of each bin of depth"),
    "nc_share_by_gap": ("1", "share of particles without contact in the wall layer, by gap tolerance"),
    "nc_gap_edges": ("1", "gaps that part the bins of the next dataset, in radii"),
    "nc_gap_density": ("1", "distribution of the no-contact particles' gaps: share of them a radius of gap"),
    "nc_gap_beyond": ("1", "share of them beyond the last bin"),
    "centre_depths": ("m", "depths that part the bins of centres and contacts"),
    "centre_density": ("1/m3", "sphere centres per volume, by depth"),
    "contact_density": ("1/m3", "contacts between spheres per volume, by depth"),
    "coordination": ("1", "mean contacts of a sphere with others, by the layer of its near side"),
    "coordination_by_gap": ("1", "the same, by layer and gap tolerance"),
    "contact_number_shares": ("1", "share of spheres with 0, 1, ... contacts with others, and with more"),
    "rattler_share": ("1", "share of spheres with fewer than four contacts, the wall counted"),
    "hexagonal_order": ("1", "mean bond-orientational order |psi_6| of the particles that touch the wall"),
    "wall_neighbours": ("1", "mean neighbours that these have among themselves"),
    "frames": ("1", "frames that the values are means over"),
    "spheres": ("1", "spheres with their centre in the window"),
    "contacts": ("1", "of these, spheres with wall contact"),
    "no_contacts": ("1", "of these, spheres without contact in the wall layer"),
    "mean_diameter": ("m", "number mean of the particle diameters"),
    "sauter_diameter": ("m", "Sauter mean d32 of the particle diameters"),
    "volume_mean_diameter": ("m", "volume-weighted mean d43 of the particle diameters"),
    "contact_gap": ("1", "gap that counts as contact, in radii"),
    "overlap_share": ("1", "solid volume counted twice where spheres overlap"),
    "seconds": ("s", "run time"),
}

VIEW_FACTORS: Mapping[str, Field] = {
    "layers": ("1", "view factors from the wall to the layers"),
    "beyond": ("1", "share that passes the last layer"),
    "wall": ("1", "share that meets the wall again"),
    "escaped": ("1", "share that leaves through open ends"),
    "layers_bed_error": ("1", "scatter of the bed: standard error from block to block, layers"),
    "beyond_bed_error": ("1", "scatter of the bed: standard error from block to block, beyond"),
    "wall_bed_error": ("1", "scatter of the bed: standard error from block to block, wall"),
    "escaped_bed_error": ("1", "scatter of the bed: standard error from block to block, escaped"),
    "edges": ("m", "depths that part the layers"),
    "covariance": ("1", "covariance of the shares by the ray tracing: layers, beyond, wall, escaped"),
    "bed_covariance": ("1", "covariance of means over frames by the scatter of the bed"),
    "structures": ("1", "independent frames behind the means: layers, beyond, wall, escaped"),
    "frames": ("1", "frames that the values are means over"),
    "block_shares": ("1", "shares found in each axial block: layers, beyond, wall, escaped"),
    "rays": ("1", "number of rays"),
    "seconds": ("s", "run time"),
    "setup_seconds": ("s", "of this, to build the grid and, on first use, to compile"),
}

HISTORY: Mapping[str, Field] = {
    "history_rays": ("1", "rays after each round"),
    "history_seconds": ("s", "run time after each round"),
    "history_estimates": ("1", "view factors after each round: layers, beyond, wall, escaped"),
    "history_errors": ("1", "their standard errors"),
}

CONVERGENCE: Mapping[str, Field] = {
    "rays": ("1", "number of rays of each run"),
    "seconds": ("s", "run time of each run, median over the seeds"),
    "true_error": ("1", "root mean square distance to the reference: layers, beyond, wall, escaped"),
    "stated_error": ("1", "standard error that the runs state, root mean square"),
    "exponent": ("1", "slope of log(true error) against log(rays)"),
    "reference": ("1", "view factors of the independent longer run"),
    "reference_rays": ("1", "its number of rays"),
    "setup_seconds": ("s", "time to build the grid"),
    "seeds": ("1", "repetitions behind each error"),
    "total_seconds": ("s", "time of the whole study"),
}

PREDICTION: Mapping[str, Field] = {
    "wall_temperature": ("K", "wall temperature"),
    "heat_transfer_coefficient": ("W/(m2 K)", "heat transfer coefficient, wall to mean temperature"),
    "heat_transfer_coefficient_without": ("W/(m2 K)", "heat transfer coefficient without radiation"),
    "nusselt": ("1", "Nusselt number, h D / k_b"),
    "nusselt_without": ("1", "Nusselt number without radiation"),
    "wall_layer_conductivity": ("W/(m K)", "conductivity of the wall layer by conduction, k_wa"),
    "radiative_conductivity": ("W/(m K)", "conductivity of the wall layer by radiation, k_rad"),
    "bulk_conductivity": ("W/(m K)", "bulk conductivity"),
    "bulk_conductivity_without": ("W/(m K)", "bulk conductivity without radiation"),
    "gas_conductivity": ("W/(m K)", "conductivity of air in the wall layer"),
    "mean_temperature": ("K", "mean temperature of the flow; nan without a heat flux"),
    "wall_layer_temperature": ("K", "temperature at which the wall layer's properties are taken"),
    "bulk_temperature": ("K", "temperature at which the bulk's properties are taken"),
    "radiation_bound": ("1", "most that radiation from the wall can add to h, known before tracing"),
}

INPUT_UNITS: Mapping[str, str] = {
    "tube_diameter": "m",
    "particle_diameter": "m",
    "velocity": "m/s",
    "solid_conductivity": "W/(m K)",
    "contacts_per_area": "1/m2",
    "wall_temperature": "K",
    "heat_flux": "W/m2",
}
"""Units of a prediction's inputs, which its budget holds in the attribute ``input_units``; "1" for all others."""

BUDGET: Mapping[str, Field] = {
    "values": ("SI", "inputs, a row each in its own unit; conductivities of gas and bulk over those of their models"),
    "errors": ("SI", "standard errors of the inputs, a row each in its own unit"),
    "elasticities": ("1", "change of ln h over that of ln of the input, a row each"),
    "contributions": ("W/(m2 K)", "standard error of h from each input, a row each"),
    "shares": ("1", "part of the variance of h from each input, a row each"),
}

SYSTEM: Mapping[str, Field] = {
    "tube_diameter": ("m", "inner diameter of the tube"),
    "particle_diameter": ("m", "particle diameter"),
    "velocity": ("m/s", "mean flow velocity"),
    "diameter_ratio": ("1", "tube over particle diameter, A"),
    "solid_conductivity": ("W/(m K)", "conductivity of the particles"),
    "porosity": ("1", "void fraction of the bulk"),
    "emissivity": ("1", "emissivity of the particles in the bulk"),
}

WALL_LAYER: Mapping[str, Field] = {
    "packing_fraction": ("1", "solid fraction of the wall layer"),
    "contacts_per_area": ("1/m2", "wall contacts per wall area"),
    "nc_distance": ("1", "distance of no-contact particles, in radii"),
}

UNITS: Mapping[str, Field] = {
    "label": ("", "which bed: file and frame, or values of the sweep"),
    "key": ("", "digest of the bed and how it is read or settled"),
    "path": ("", "file"),
    "frame": ("1", "frame of the file"),
    "content": ("", "SHA-256 of the file"),
    "series": ("", "what the bed has in common with others: a trajectory"),
    "seed": ("1", "seed of the rays"),
    "warnings": ("", "what was warned about, a line each"),
    "seconds": ("s", "run time"),
    "tube_diameter": ("m", "inner diameter of the tube, swept"),
    "particle_diameter": ("m", "particle diameter, swept"),
    "velocity": ("m/s", "velocity that was asked for, swept"),
    "bed_seed": ("1", "seed that the bed is settled with, swept"),
    "window": ("m", "ends of the measured window along the axis"),
    "window_lateral": ("m", "ends of the measured window across the plate"),
    "wall_radius": ("m", "radius of the wall"),
    "view_factors": ("1", "view factors from the wall to the layers"),
    "radiation_bound": PREDICTION["radiation_bound"],
    "error": ("", "why there are no results"),
}
"""What a file of many beds says of each, beside the fields of the stages."""
