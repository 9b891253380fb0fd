"""A small, made-up results file with known numbers, written as the pipeline writes it."""

import json

import numpy as np
import pytest

from bedrad.jobs.fields import CONVERGENCE, PREDICTION, STATISTICS, SYSTEM, VIEW_FACTORS, WALL_LAYER
from bedrad.jobs.results import Results, save_fields
from bedrad.jobs.stages import ORDER

NAME = r"0.6 mm [bold]zirconia[/bold], $\no_formula$"
TEMPERATURES = np.linspace(373.15, 1373.15, 11)
EDGES = np.array([0.0, 3e-4, 9e-4, 1.5e-3])


def made_up_case(scale, errors, **system):
    """A case of a prediction; h without radiation is 200 `scale` at 100 degC, and radiation adds (T/1000 K)^3/5."""
    T = TEMPERATURES
    without = 200.0 * scale * (T / T[0]) ** 0.5
    gain = 0.2 * (T / 1000.0) ** 3
    values = {
        "wall_temperature": T,
        "heat_transfer_coefficient": without * (1.0 + gain),
        "heat_transfer_coefficient_without": without,
        "nusselt": 6.5 * scale + T / 1e4,
        "nusselt_without": 6.4 * scale + T / 2e4,
        "wall_layer_conductivity": 0.15 * scale * (T / T[0]) ** 0.6,
        "radiative_conductivity": 0.08 * scale * (T / 1000.0) ** 3,
        "bulk_conductivity": 0.28 + T / 5e3,
        "bulk_conductivity_without": 0.27 + T / 6e3,
        "gas_conductivity": 3e-2 * (T / T[0]) ** 0.8,
        "radiation_bound": 2.0 * gain,
    }
    for name in ("heat_transfer_coefficient", "heat_transfer_coefficient_without", "nusselt", "nusselt_without",
                 "wall_layer_conductivity", "radiative_conductivity"):  # fmt: skip
        values[f"{name}_error"] = errors * values[name]
    values |= {"tube_diameter": 7.74e-3, "particle_diameter": 6e-4, "velocity": 0.016, "solid_conductivity": 2.1}
    values |= {"porosity": 0.37, "emissivity": 0.8}
    values |= {"packing_fraction": 0.42, "contacts_per_area": 1.85e6, "nc_distance": 0.22}
    values |= {f"{name}_error": errors * values[name] for name in WALL_LAYER}
    values |= {"view_factors": np.array([0.80, 0.18, 0.02]), "view_factors_error": errors * np.array([0.8, 0.18, 0.02])}
    values |= system
    return values | {"diameter_ratio": values["tube_diameter"] / values["particle_diameter"]}


def made_up_prediction():
    return {
        "measured": ("measured packing, traced view factors", "zbs", made_up_case(1.05, 2e-3)),
        "correlations": ("correlations, published view factors", "zbs", made_up_case(1.0, 0.0)),
        "configuration_2": (
            "Table 5.1, configuration 2",
            "table 5.2",
            made_up_case(1.3, 0.0, tube_diameter=7.614e-3, particle_diameter=2.7e-4, velocity=0.020),
        ),
    }


def made_up_view_factors():
    mean = np.array([0.829, 0.151, 0.0091, 6.6e-4, 0.0102, 0.0])
    mean[-1] = 1.0 - mean.sum()
    wobble = np.random.default_rng(1).normal(scale=1e-4, size=(8, 6)) * mean
    samples = mean + wobble - wobble.mean(axis=0)
    error = samples.std(axis=0, ddof=1) / np.sqrt(8)
    bed = 30 * error
    values = {"layers": mean[:3], "layers_error": error[:3], "layers_bed_error": bed[:3]}
    for k, name in enumerate(("beyond", "wall", "escaped"), start=3):
        values |= {name: mean[k], f"{name}_error": error[k], f"{name}_bed_error": bed[k]}
    return values | {
        "edges": EDGES,
        "covariance": np.cov(samples.T) / len(samples),
        "block_shares": samples[:4],
        "rays": 2**20,
        "seconds": 0.75,
        "setup_seconds": 0.25,
    }


def made_up_statistics():
    depths = np.linspace(0.0, EDGES[-1], 26)
    middle = 0.5 * (depths[:-1] + depths[1:])
    profile = 0.6 * (1.0 - np.exp(-middle / 2e-4) * np.cos(middle / 1e-4))
    return {
        "packing_fraction": 0.4501,
        "contacts_per_area": 2.059e6,
        "contact_ratio": 0.6959,
        "nc_share": 0.1773,
        "nc_distance": 0.465,
        "nc_distance_weighted": 0.194,
        "nc_distance_closing": np.nan,
        "packing_fraction_error": 0.0029,
        "contacts_per_area_error": 1.7e4,
        "contact_ratio_error": 0.0058,
        "nc_share_error": 0.0089,
        "nc_distance_error": 0.021,
        "nc_distance_weighted_error": 0.012,
        "nc_distance_closing_error": np.nan,
        "edges": EDGES,
        "packing_fractions": np.array([0.4501, 0.6063, 0.594]),
        "packing_fractions_error": np.array([0.0029, 0.0011, 0.0037]),
        "gap_tolerances": np.array([0.0, 1e-3, 1e-2]),
        "contacts_per_area_by_gap": np.array([1.96e6, 1.98e6, 2.059e6]),
        "contacts_per_area_by_gap_error": np.array([2.7e4, 2.8e4, 1.7e4]),
        "contact_ratio_by_gap": np.array([0.664, 0.669, 0.6959]),
        "contact_ratio_by_gap_error": np.array([0.009, 0.009, 0.0058]),
        "profile_depths": depths,
        "profile": profile,
        "profile_error": np.full_like(profile, 0.004),
        "nc_share_by_gap": np.array([0.22, 0.21, 0.1773]),
        "nc_share_by_gap_error": np.array([0.009, 0.009, 0.0089]),
        "nc_gap_edges": np.linspace(0.0, 1.0, 5),
        "nc_gap_density": np.array([0.8, 0.6, 1.0, 1.6]),
        "nc_gap_density_error": np.array([0.1, 0.2, 0.1, 0.2]),
        "nc_gap_beyond": 0.0,
        "nc_gap_beyond_error": 0.0,
        "centre_depths": depths,
        "centre_density": 5e9 * profile,
        "centre_density_error": np.full_like(profile, 1e8),
        "contact_density": 1.5e10 * profile,
        "contact_density_error": np.full_like(profile, 3e8),
        "coordination": np.array([4.13, 5.17, 5.41]),
        "coordination_error": np.array([0.05, 0.05, 0.06]),
        "coordination_by_gap": np.array([[3.8, 3.9, 4.13], [4.8, 4.9, 5.17], [5.0, 5.1, 5.41]]),
        "coordination_by_gap_error": np.full((3, 3), 0.05),
        "contact_number_shares": np.array([0.0, 0.1, 0.2, 0.3, 0.25, 0.1, 0.05]),
        "contact_number_shares_error": np.full(7, 0.01),
        "rattler_share": 0.094,
        "rattler_share_error": 0.007,
        "hexagonal_order": 0.597,
        "hexagonal_order_error": 0.013,
        "wall_neighbours": 3.95,
        "wall_neighbours_error": 0.07,
        "sauter_diameter": 6.1e-4,
        "volume_mean_diameter": 6.2e-4,
        "spheres": 3477,
        "contacts": 724,
        "no_contacts": 156,
        "mean_diameter": 6e-4,
        "contact_gap": 0.01,
        "overlap_share": 6.8e-6,
        "seconds": 0.39,
    }


def made_up_convergence():
    rays = 1024 * 2 ** np.arange(6)
    reference = np.array([0.83, 0.15, 0.0091, 6.4e-4, 0.0102, 1.2e-5])
    true = 0.3 * np.sqrt(reference * (1 - reference)) / np.sqrt(rays)[:, None]
    said = 1.1 * true
    said[:2, 3] = 0.0
    return {
        "rays": rays,
        # the second run is quicker than the first, as happens
        "seconds": np.array([0.021, 0.020, 0.03, 0.04, 0.07, 0.13]),
        "true_error": true,
        "stated_error": said,
        "exponent": np.array([-0.485, -0.52, -0.5, np.nan, -0.49, -0.3]),
        "exponent_error": np.array([0.031, 0.037, 0.05, np.nan, 0.017, 0.16]),
        "reference": reference,
        "reference_error": reference * 1e-4,
        "reference_rays": 2**24,
        "setup_seconds": 0.002,
        "seeds": 8,
        "total_seconds": 8.7,
    }


def fill_prediction(group, prediction):
    for key, (title, bulk, values) in prediction.items():
        case = group.create_group(key)
        case.attrs.update({"title": title, "bulk_model": bulk})
        for fields in (PREDICTION, SYSTEM, WALL_LAYER, {"view_factors": ("1", "view factors")}):
            save_fields(case, values, fields)


def fill_view_factors(group, data):
    save_fields(group, data, VIEW_FACTORS)
    group.attrs.update({"window": (2.4e-3, 1.68e-2), "seed": 1, "left_out": "17 spheres that no ray reached"})


def fill_statistics(group, data):
    save_fields(group, data, STATISTICS)
    group.attrs.update(
        {"left_out_outside_window": 1028, "left_out_deeper": 1038, "wall": "tube", "wall_radius": 3.87e-3}
    )


def fill_convergence(group, data):
    save_fields(group, data, CONVERGENCE)
    group.attrs["names"] = ["layer 1", "layer 2", "layer 3", "beyond", "wall", "escaped"]


STAGES = {
    "statistics": (made_up_statistics, fill_statistics),
    "view_factors": (made_up_view_factors, fill_view_factors),
    "convergence": (made_up_convergence, fill_convergence),
    "prediction": (made_up_prediction, fill_prediction),
}


class Fabricated:
    """A results file and the numbers that went into it."""

    def __init__(self, path):
        self.results = Results(path)
        self.data = {}

    def add(self, stage, change=None):
        """Write a stage; `change` may alter the made-up numbers first."""
        make, fill = STAGES[stage]
        data = make()
        if change is not None:
            change(data)
        self.results.write_stage(
            stage, "0" * 64, lambda group: fill(group, data), keep=list(self.data),
            attributes={"job": json.dumps({"name": NAME} | {stage: {} for stage in ORDER}), "inputs": "{}"},
        )  # fmt: skip
        self.data[stage] = data
        return self


@pytest.fixture
def fabricate(tmp_path):
    """Make a results file with the named stages."""

    def make(*stages, name="bed.h5"):
        made = Fabricated(tmp_path / name)
        for stage in stages:
            made.add(stage)
        return made

    return make


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """A results file with all stages, not to be changed."""
    made = Fabricated(tmp_path_factory.mktemp("whole") / "bed.h5")
    for stage in STAGES:
        made.add(stage)
    return made
