"""A bed as a picture in three dimensions: what is shown, and the still picture; `pictures_viewer` has the moving one.

Spheres are drawn exactly, as the rays of the view factors see them. A wedge of the bed and of the wall of a tube is
taken out. A colour is a layer: it belongs to the depth below the wall of the point that is seen, not to a sphere, as
the layers cut through spheres.
"""

from __future__ import annotations

import io
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bedrad.packings.layers import layer_edges
from bedrad.packings.packing import Packing
from bedrad.report import style
from bedrad.report.pictures_kernels import draw_spheres, draw_wall
from bedrad.walls import Plate, Tube, Wall

__all__ = [
    "AMBIENT",
    "BEYOND",
    "LIGHT",
    "WALL_COLOUR",
    "Scene",
    "View",
    "layer_colour",
    "layer_texts",
    "make_scene",
    "png",
    "round_length",
    "save_picture",
    "still",
]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

BEYOND, WALL_COLOUR = "#8C8F94", "#B9C0C8"
"""Colours of what lies deeper than the layers, and of the wall."""

THICKNESS = 0.04
"""Thickness of the wall of a tube in its radii, and of a plate in its length."""

FRONT = -60.0
"""Azimuth of the middle of the wedge that is taken out. [degrees]"""

_SIZE = (1000, 750)
"""Width and height of a still picture. [pixels]"""

_FINER = 2
"""Rays of a pixel along each side."""

AMBIENT = 0.42
"""Light on a surface that is turned away."""

LIGHT = (-0.45, 0.65, -1.0)
"""Where the light comes from: right, up and away from the eye."""


@dataclass(frozen=True, eq=False)
class Scene:
    """What a picture shows.

    Parameters
    ----------
    name : str
        Title.
    centers, radii : (n, 3), (n,) arrays
        The spheres. [m]
    wall : Tube, Rod or Plate
        The wall.
    edges : (layers + 1,) array
        Depths that part the layers. [m]
    low, high : (3,) arrays
        The box around the spheres, or the period where there is one. [m]
    """

    name: str
    centers: FloatArray
    radii: FloatArray
    wall: Wall
    edges: FloatArray
    low: FloatArray
    high: FloatArray

    @property
    def middle(self) -> FloatArray:
        """Middle of the picture, on the line around which the wedge opens. [m]"""
        middle = 0.5 * (self.low + self.high)
        if not isinstance(self.wall, Plate):
            middle[:2] = 0.0
        return middle

    @property
    def bounds(self) -> tuple[float, float]:
        """How far spheres and wall reach from the vertical line in the middle, and how far up or down. [m]"""
        away = self.centers - self.middle
        across = float((np.hypot(away[:, 0], away[:, 1]) + self.radii).max())
        up = float((np.abs(away[:, 2]) + self.radii).max())
        outer, low, high = self.solid[0], self.solid[2:5], self.solid[5:8]
        corners = np.maximum(np.abs(low), np.abs(high))
        return max(across, float(outer or math.hypot(corners[0], corners[1]))), max(up, float(corners[2]))

    @property
    def solid(self) -> FloatArray:
        """(8,) array: the wall as `draw_wall` takes it, relative to the middle. [m]"""
        low, high = self.low - self.middle, self.high - self.middle
        if isinstance(self.wall, Plate):
            high[2] = -self.middle[2]
            low[2] = high[2] - THICKNESS * float(np.max(high[:2] - low[:2]))
            return np.concatenate(([0.0, 0.0], low, high))
        radius = self.wall.radius
        tube = isinstance(self.wall, Tube)
        return np.concatenate(([radius * (1 + THICKNESS), radius] if tube else [radius, 0.0], low, high))


@dataclass(frozen=True)
class View:
    """Where a picture is taken from.

    Parameters
    ----------
    azimuth, elevation : float
        Direction of the eye, around the vertical from x and above the horizontal. [degrees]
    opening : float
        Angle of the wedge that is taken out, around `FRONT`. [degrees]
    wall : bool
        Whether the wall is drawn.
    """

    azimuth: float = FRONT
    elevation: float = 28.0
    opening: float = 110.0
    wall: bool = True

    @property
    def axes(self) -> FloatArray:
        """(3, 3) array: unit vectors to the right, up, and away from the eye."""
        a, e = math.radians(self.azimuth), math.radians(self.elevation)
        return np.array(
            [
                [-math.sin(a), math.cos(a), 0.0],
                [-math.sin(e) * math.cos(a), -math.sin(e) * math.sin(a), math.cos(e)],
                [-math.cos(e) * math.cos(a), -math.cos(e) * math.sin(a), -math.sin(e)],
            ]
        )

    @property
    def planes(self) -> FloatArray:
        """(2, 3) array: normals of the planes that bound the wedge, into it."""
        middle, half = math.radians(FRONT), math.radians(0.5 * self.opening)
        angles = (middle + half - math.pi / 2, middle - half + math.pi / 2)
        return np.array([[math.cos(angle), math.sin(angle), 0.0] for angle in angles])


def make_scene(packing: Packing, edges: Sequence[float] | FloatArray | None = None, name: str = "bed") -> Scene:
    """Prepare a packing for pictures.

    Parameters
    ----------
    packing : Packing
        The spheres and their wall.
    edges : (layers + 1,) array, optional
        Depths that part the layers; those of three layers, or of as many as the bed has room for. [m]
    name : str
        Title.

    Raises
    ------
    ValueError
        If the packing is empty.
    """
    if not len(packing):
        raise ValueError("the packing is empty; there is nothing to show")
    if edges is None:
        room = packing.wall.largest_depth / packing.mean_diameter + 0.5
        edges = layer_edges(packing, max(1, int(min(3.0, room)))) if room >= 1.0 else [0.0, packing.wall.largest_depth]
    ranges = np.array([packing.extent(axis) for axis in range(3)])
    depths = np.array(edges, dtype=float)
    return Scene(name, packing.centers, packing.radii, packing.wall, depths, ranges[:, 0], ranges[:, 1])


def layer_colour(layer: int) -> str:
    """Colour of a layer, counted from 0."""
    return style.COLOURS[layer % len(style.COLOURS)]


def layer_texts(edges: FloatArray) -> list[str]:
    """What each layer is, and what lies deeper."""
    mm = [f"{1e3 * edge:.3g}" for edge in edges]
    texts = [
        f"{'wall layer' if k == 0 else f'layer {k + 1}'}: {near} to {far} mm deep"
        for k, (near, far) in enumerate(itertools.pairwise(mm))
    ]
    return [*texts, f"deeper than {mm[-1]} mm"]


def still(scene: Scene, view: View | None = None, size: tuple[int, int] = _SIZE) -> tuple[NDArray[np.uint8], float]:
    """Draw a scene.

    Parameters
    ----------
    scene : Scene
        What is shown.
    view : View, optional
        Where from.
    size : (int, int)
        Width and height. [pixels]

    Returns
    -------
    picture : (height, width, 4) array
        Red, green, blue and opacity, which is 0 where nothing is.
    pixel : float
        Size of a pixel. [m]
    """
    look = view or View()
    width, height = _FINER * size[0], _FINER * size[1]
    pixel = _fitting(scene, look, width, height)
    distance = np.full((height, width), np.inf)
    normals, points = np.zeros((height, width, 3)), np.zeros((height, width, 3))
    cut = np.zeros((height, width), dtype=np.bool_)
    draw_spheres(
        scene.centers - scene.middle, scene.radii, look.axes, look.planes, pixel, distance, normals, points, cut
    )
    on_wall = np.zeros_like(cut)
    if look.wall:
        draw_wall(scene.solid, look.axes, look.planes, pixel, distance, normals, cut, on_wall)
    there = np.isfinite(distance)
    rays = np.zeros((height, width, 4), dtype=np.float32)
    rays[there, :3] = _lit(scene, look, points[there], normals[there], cut[there], on_wall[there])
    rays[there, 3] = 1.0
    mean = rays.reshape(size[1], _FINER, size[0], _FINER, 4).mean(axis=(1, 3))
    # the colour of a pixel at the rim is that of what is there, not half of it
    mean[..., :3] /= np.maximum(mean[..., 3:], 1e-9)
    return np.asarray(np.round(255 * np.clip(mean, 0.0, 1.0)), dtype=np.uint8), pixel * _FINER


def _lit(
    scene: Scene, view: View, points: FloatArray, normals: FloatArray, cut: BoolArray, on_wall: BoolArray
) -> FloatArray:
    """(n, 3) array: colours of points, lit; cut faces evenly, so that they are told from round ones."""
    layer = np.searchsorted(scene.edges, scene.wall.depth(points + scene.middle), side="right") - 1
    shades = [*(layer_colour(k) for k in range(len(scene.edges) - 1)), BEYOND, WALL_COLOUR]
    palette = np.array([[int(shade[k : k + 2], 16) / 255 for k in (1, 3, 5)] for shade in shades])
    colours = palette[np.where(on_wall, len(shades) - 1, np.clip(layer, 0, len(scene.edges) - 1))]
    light = np.array(LIGHT) @ view.axes / np.linalg.norm(LIGHT)
    bright = AMBIENT + (1 - AMBIENT) * np.clip(normals @ light, 0.0, None)
    return np.asarray(colours * np.where(cut, 0.55 + 0.45 * bright, bright)[:, None])


def _fitting(scene: Scene, view: View, width: int, height: int) -> float:
    """Size of a pixel at which everything is in the picture. [m]"""
    across, up = scene.bounds
    tilt = math.radians(view.elevation)
    tall = up * abs(math.cos(tilt)) + across * abs(math.sin(tilt))
    return 1.04 * 2 * max(across / width, tall / height)


def png(picture: NDArray[np.uint8]) -> bytes:
    """A picture as PNG; MissingExtraError without matplotlib."""
    with style.styled():
        from matplotlib.image import imsave

        buffer = io.BytesIO()
        imsave(buffer, picture, format="png")
    return buffer.getvalue()


def save_picture(scene: Scene, path: Path, view: View | None = None) -> None:
    """Write a still picture with its legend and a length as PNG, whole or not at all.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    OSError
        If the file cannot be written.
    """
    picture, pixel = still(scene, view)
    with style.styled():
        style.save(_framed(scene, picture, pixel), path, scene.name)


def _framed(scene: Scene, picture: NDArray[np.uint8], pixel: float) -> Any:
    from matplotlib.patches import Patch

    height, width = picture.shape[:2]
    figure = style.new_figure(8.0, 8.0 * height / width + 0.8)
    axes = figure.subplots()
    axes.imshow(picture, interpolation="lanczos")
    axes.set_axis_off()
    axes.set_title(style.literal(scene.name))
    length = round_length(0.2 * width * pixel)
    left, base = 0.02 * width, 0.985 * height
    axes.plot([left, left + length / pixel], [base, base], color="black", linewidth=2.0, solid_capstyle="butt")
    axes.annotate(f"{1e3 * length:g} mm", (left, base), (0, 4), textcoords="offset points", fontsize=8.5)
    shown = [*(layer_colour(k) for k in range(len(scene.edges) - 1)), BEYOND]
    handles = [Patch(facecolor=colour) for colour in shown]
    figure.legend(handles, layer_texts(scene.edges), loc="outside lower center", ncols=2)
    return figure


def round_length(longest: float) -> float:
    """The longest of 1, 2, 5, 10, ... that is not longer. [m]"""
    power = 10.0 ** math.floor(math.log10(longest) + 1e-9)
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= longest * (1 + 1e-9))
