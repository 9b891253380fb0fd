"""bedrad: packings near walls, exact-sphere view factors, and the heat transfer of dense granular flows.

The names below load on first use, so that ``import bedrad`` costs next to nothing and a script that only wants the
equations in `bedrad.heat` never loads the ray tracer.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bedrad import heat as heat
    from bedrad.errors import BadFileError as BadFileError
    from bedrad.errors import EngineFailedError as EngineFailedError
    from bedrad.errors import MissingExtraError as MissingExtraError
    from bedrad.heat.prediction import predict as predict
    from bedrad.packings.files import read as read
    from bedrad.packings.files import read_frames as read_frames
    from bedrad.packings.files import write as write
    from bedrad.packings.flow import flow as flow
    from bedrad.packings.layers import layer_edges as layer_edges
    from bedrad.packings.packing import Packing as Packing
    from bedrad.packings.settle import settle as settle
    from bedrad.packings.statistics import statistics as statistics
    from bedrad.packings.unrolled_wall import unrolled_wall as unrolled_wall
    from bedrad.packings.wall_gaps import particles_at_wall as particles_at_wall
    from bedrad.raytrace.enclosure import exchange_factors as exchange_factors
    from bedrad.raytrace.enclosure import reflected_factors as reflected_factors
    from bedrad.raytrace.view_factors import view_factors as view_factors
    from bedrad.walls import Plate as Plate
    from bedrad.walls import Rod as Rod
    from bedrad.walls import Tube as Tube

__version__ = "0.1.0"

_HOME = {
    "BadFileError": "errors",
    "EngineFailedError": "errors",
    "MissingExtraError": "errors",
    "Packing": "packings.packing",
    "Plate": "walls",
    "Rod": "walls",
    "Tube": "walls",
    "exchange_factors": "raytrace.enclosure",
    "flow": "packings.flow",
    "layer_edges": "packings.layers",
    "particles_at_wall": "packings.wall_gaps",
    "predict": "heat.prediction",
    "read": "packings.files",
    "read_frames": "packings.files",
    "reflected_factors": "raytrace.enclosure",
    "settle": "packings.settle",
    "statistics": "packings.statistics",
    "unrolled_wall": "packings.unrolled_wall",
    "view_factors": "raytrace.view_factors",
    "write": "packings.files",
}

__all__ = [*sorted(_HOME), "heat"]


def __getattr__(name: str) -> Any:
    if name == "heat":
        return importlib.import_module("bedrad.heat")
    if name in _HOME:
        return getattr(importlib.import_module(f"bedrad.{_HOME[name]}"), name)
    raise AttributeError(f"module 'bedrad' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
