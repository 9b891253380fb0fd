"""The equations of heat transfer to dense granular flows: plain numbers in, plain numbers out.

Nothing here knows of packings, rays or jobs. Scalars broadcast with arrays everywhere, temperatures are in
kelvin, and everything is in SI units. The submodules load on first use.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from bedrad.heat.ranges import RangeWarning

if TYPE_CHECKING:
    from bedrad.heat import block_and_bed as block_and_bed
    from bedrad.heat import block_extraction as block_extraction
    from bedrad.heat import bulk as bulk
    from bedrad.heat import bulk_radiation as bulk_radiation
    from bedrad.heat import chute as chute
    from bedrad.heat import energy_balance as energy_balance
    from bedrad.heat import fins as fins
    from bedrad.heat import flow_correlations as flow_correlations
    from bedrad.heat import fluid_lens as fluid_lens
    from bedrad.heat import gas as gas
    from bedrad.heat import grey_enclosure as grey_enclosure
    from bedrad.heat import half_space as half_space
    from bedrad.heat import heat_exchanger as heat_exchanger
    from bedrad.heat import kopp_neumann as kopp_neumann
    from bedrad.heat import lens_and_layer as lens_and_layer
    from bedrad.heat import materials as materials
    from bedrad.heat import measured_flow as measured_flow
    from bedrad.heat import particle_sizes as particle_sizes
    from bedrad.heat import particle_transient as particle_transient
    from bedrad.heat import prediction as prediction
    from bedrad.heat import radiation as radiation
    from bedrad.heat import slurry as slurry
    from bedrad.heat import static_bed as static_bed
    from bedrad.heat import systems as systems
    from bedrad.heat import tube_bank as tube_bank
    from bedrad.heat import tube_temperatures as tube_temperatures
    from bedrad.heat import two_layer as two_layer
    from bedrad.heat import wall_coverage as wall_coverage
    from bedrad.heat import wall_layer as wall_layer
    from bedrad.heat import wall_lenses as wall_lenses
    from bedrad.heat import wall_models as wall_models
    from bedrad.heat import wall_particles as wall_particles
    from bedrad.heat import wall_temperature_profile as wall_temperature_profile

_SUBMODULES = (
    "block_and_bed",
    "block_extraction",
    "bulk",
    "bulk_radiation",
    "chute",
    "energy_balance",
    "fins",
    "flow_correlations",
    "fluid_lens",
    "gas",
    "grey_enclosure",
    "half_space",
    "heat_exchanger",
    "kopp_neumann",
    "lens_and_layer",
    "materials",
    "measured_flow",
    "particle_sizes",
    "particle_transient",
    "prediction",
    "radiation",
    "slurry",
    "static_bed",
    "systems",
    "tube_bank",
    "tube_temperatures",
    "two_layer",
    "wall_coverage",
    "wall_layer",
    "wall_lenses",
    "wall_models",
    "wall_particles",
    "wall_temperature_profile",
)

__all__ = ["RangeWarning", *_SUBMODULES]


def __getattr__(name: str) -> Any:
    if name in _SUBMODULES:
        return importlib.import_module(f"bedrad.heat.{name}")
    raise AttributeError(f"module 'bedrad.heat' has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
