"""Engines that trace triangles: open3d's raycasting scene, and Embree by embreex. Both run Embree underneath.

An engine is made from vertices and triangles and says which triangle each ray meets first, on one thread.
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import EngineFailedError, MissingExtraError

__all__ = ["ENGINES", "Engine", "available_engines", "engine_maker"]

FloatArray = NDArray[np.float32]
IndexArray = NDArray[np.uint32]

_EXTRAS = {"open3d": "open3d", "embree": "mesh"}
_MODULES = {"open3d": ("open3d", "trimesh"), "embree": ("embreex", "trimesh")}

ENGINES = tuple(_EXTRAS)
"""Names of the engines."""

_MISSING_LIBRARY = re.compile(r"(?P<name>lib[^\s:]+): cannot open shared object file")

_PACKAGES = "libusb-1.0-0 libegl1 libgl1 libx11-6 libudev1 libidn2-0"
"""Packages of Debian and Ubuntu with the libraries that open3d is linked against and does not bring."""


class Engine(Protocol):
    """A scene of triangles, ready to be traced."""

    def first(self, rays: FloatArray, /) -> NDArray[np.int32]:
        """Number of the triangle that each of (n, 6) rays (origin, direction) meets first, -1 for none."""
        ...


Maker = Callable[[FloatArray, IndexArray], Engine]


def available_engines() -> tuple[str, ...]:
    """Engines whose extras are installed, found without loading them; a broken one shows when it is used."""
    return tuple(name for name in ENGINES if not _missing(name))


def engine_maker(name: str) -> Maker:
    """Load an engine: what makes a scene of (n, 3) vertices and (m, 3) triangles, three vertices each.

    Raises
    ------
    ValueError
        If there is no such engine.
    MissingExtraError
        If its extra is not installed.
    EngineFailedError
        If it is, but a library of the system that it needs is not there.
    """
    if name not in ENGINES:
        raise ValueError(f"engine is {name!r}; expected one of {', '.join(ENGINES)}")
    if missing := _missing(name):
        raise MissingExtraError(missing[0], _EXTRAS[name])
    try:
        return _open3d() if name == "open3d" else _embree()
    except (ImportError, OSError) as error:
        raise EngineFailedError(_explained(name, str(error))) from error


def _missing(name: str) -> list[str]:
    return [module for module in _MODULES[name] if importlib.util.find_spec(module) is None]


def _explained(name: str, error: str) -> str:
    found = _MISSING_LIBRARY.search(error)
    if found is None:
        return f"{name} cannot start: {error}"
    text = f"{name} cannot start: the system library {found['name']} is missing"
    return f"{text}; on Debian and Ubuntu: apt-get install {_PACKAGES}" if name == "open3d" else text


def _open3d() -> Maker:
    import open3d

    return partial(_Open3D, open3d)


def _embree() -> Maker:
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    return partial(_Embree, EmbreeScene, TriangleMesh)


class _Open3D:
    def __init__(self, open3d: Any, vertices: FloatArray, triangles: IndexArray) -> None:
        self._tensor = open3d.core.Tensor.from_numpy
        self._scene = open3d.t.geometry.RaycastingScene()
        self._scene.add_triangles(self._tensor(vertices), self._tensor(triangles))
        # the tree over the triangles is built for the first ray
        self.first(np.ones((1, 6), np.float32))

    def first(self, rays: FloatArray) -> NDArray[np.int32]:
        found = self._scene.cast_rays(self._tensor(rays), nthreads=1)["primitive_ids"].numpy()
        # the largest number of 32 bits stands for none
        return np.asarray(found.view(np.int32))


class _Embree:
    def __init__(self, scene: Any, mesh: Any, vertices: FloatArray, triangles: IndexArray) -> None:
        # robust: no ray slips through between two triangles of a mesh, as in open3d
        self._scene = scene(robust=True)
        self._mesh = mesh(self._scene, vertices, triangles.view(np.int32))
        self.first(np.ones((1, 6), np.float32))

    def first(self, rays: FloatArray) -> NDArray[np.int32]:
        return np.asarray(self._scene.run(rays[:, :3], rays[:, 3:]), np.int32)
