"""The equations of heat transfer to dense granular flows: plain numbers in, plain numbers out.

Nothing here knows of packings, rays or jobs. Scalars broadcast with arrays everywhere, temperatures are in
kelvin, and everything is in SI units. The submodules load on first use.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from bedrad.heat.ranges import RangeWarning

if TYPE_CHECKING:
    from bedrad.heat import bulk as bulk
    from bedrad.heat import flow_correlations as flow_correlations
    from bedrad.heat import gas as gas
    from bedrad.heat import materials as materials
    from bedrad.heat import prediction as prediction
    from bedrad.heat import radiation as radiation
    from bedrad.heat import systems as systems
    from bedrad.heat import two_layer as two_layer
    from bedrad.heat import wall_layer as wall_layer

_SUBMODULES = (
    "bulk",
    "flow_correlations",
    "gas",
    "materials",
    "prediction",
    "radiation",
    "systems",
    "two_layer",
    "wall_layer",
)

__all__ = [
    "RangeWarning",
    "bulk",
    "flow_correlations",
    "gas",
    "materials",
    "prediction",
    "radiation",
    "systems",
    "two_layer",
    "wall_layer",
]


def __getattr__(name: str) -> Any:
    if name in _SUBMODULES:
        return importlib.import_module(f"bedrad.heat.{name}")
    raise AttributeError(f"module 'bedrad.heat' has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
