"""The moving picture of a bed: a script that comes with bedrad, and the spheres as 16-bit numbers in the page."""

from __future__ import annotations

import base64
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bedrad.report.page_document import asset, data_uri, document, write_document
from bedrad.report.page_html import Html, element, joined
from bedrad.report.pictures import (
    AMBIENT,
    BEYOND,
    FRONT,
    LIGHT,
    WALL_COLOUR,
    Scene,
    View,
    layer_colour,
    layer_texts,
    png,
    still,
)
from bedrad.report.style import COLOURS
from bedrad.walls import Plate, Tube

__all__ = ["LARGEST_PAGE", "reduced", "viewer", "viewer_script", "write_viewer"]

LARGEST_PAGE = 15_000_000
"""A page is not longer than this. [bytes]"""

_BYTES = 8
"""Of a sphere: three coordinates and a radius, 16 bits each."""

_STILL = (800, 600)
"""Width and height of the picture that stands where a browser cannot draw. [pixels]"""

_STEPS = 65535


def reduced(scene: Scene, room: int) -> Scene | None:
    """A scene whose spheres fit into a page: all, or those that reach into the layers; None where neither fits.

    Parameters
    ----------
    scene : Scene
        The scene.
    room : int
        Bytes of the page that are left.
    """
    most = room * 3 // 4 // _BYTES
    if len(scene.radii) <= most:
        return scene
    near = scene.wall.depth(scene.centers) - scene.radii < scene.edges[-1]
    if np.count_nonzero(near) > most:
        return None
    return replace(scene, centers=scene.centers[near], radii=scene.radii[near])


def viewer(scene: Scene, room: int = LARGEST_PAGE) -> Html:
    """The picture of a bed, for a page with the `viewer_script`; a still one where the spheres do not fit.

    Parameters
    ----------
    scene : Scene
        The scene.
    room : int
        Bytes of the page that are left.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    view = View()
    picture, _ = still(scene, view, _STILL)
    image = element("img", src=data_uri(png(picture), "image/png"), alt=_described(scene), class_="still")
    shown = reduced(scene, room - len(image))
    legend = element(
        "ul",
        *(
            element("li", element("span", text), class_=_class(k, len(scene.edges) - 1))
            for k, text in enumerate(layer_texts(scene.edges))
        ),
        class_="legend",
    )
    notes = [f"{len(scene.radii):,} spheres; a wedge of the bed is taken out."]
    if shown is None:
        notes.append("Too many spheres for a moving picture in one page.")
        return element("figure", image, legend, element("figcaption", " ".join(notes)), class_="viewer")
    if len(shown.radii) < len(scene.radii):
        notes.append(f"The moving picture shows the {len(shown.radii):,} that reach into the layers.")
    notes.append(
        "Each colour is a layer, by the depth of the point that is seen. Drag to turn, with shift to move; chosen, "
        "the picture follows the wheel, the arrow keys, + and −; Home is the first view."
    )
    canvas = element(
        "canvas",
        width=_STILL[0],
        height=_STILL[1],
        tabindex=0,
        role="img",
        aria_label=f"{_described(scene)} It turns with the arrow keys.",
    )
    failed = element("p", "This browser cannot draw in three dimensions (WebGL 2); a still picture stands for it.",
                     class_="note failed")  # fmt: skip
    bar = element("div", class_="bar", aria_hidden="true")
    stage = element("div", canvas, image, bar, class_="stage")
    held = element("script", Html(_json(_data(shown, view))), type="application/json", id="bed-data")
    caption = element("figcaption", " ".join(notes))
    return joined([element("figure", stage, failed, _controls(view), legend, caption, class_="viewer"), held])


def viewer_script() -> str:
    """The script that turns `viewer` into a moving picture."""
    return asset("viewer.js")


def write_viewer(scene: Scene, path: Path) -> None:
    """Write a page of its own with the picture of a bed.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    OSError
        If it cannot be written.
    """
    body = joined(
        [
            element("header", element("h1", scene.name), element("p", f"{scene.wall!r}", class_="lead")),
            element("main", viewer(scene)),
        ]
    )
    write_document(document(scene.name, body, viewer_script()), path)


def _class(layer: int, layers: int) -> str:
    return "beyond" if layer == layers else f"layer-{layer % len(COLOURS) + 1}"


def _described(scene: Scene) -> str:
    return (
        f"The bed at the wall of a {scene.wall.kind} in three dimensions, cut open: {len(scene.radii):,} spheres, "
        f"coloured by {len(scene.edges) - 1} layers of depth below the wall."
    )


def _controls(view: View) -> Html:
    angle = element(
        "input", type="range", name="opening", min=0, max=180, step=5, value=int(view.opening), autocomplete="off"
    )
    wall = element("input", type="checkbox", name="wall", checked=True, autocomplete="off")
    return element(
        "div",
        element("label", "Opening ", angle),
        element("label", wall, " Wall"),
        element("button", "First view", type="button"),
        class_="controls",
    )


def _data(scene: Scene, view: View) -> dict[str, Any]:
    """What the script needs; lengths in millimetres from the middle of the picture."""
    centers = 1e3 * (scene.centers - scene.middle)
    low, extent = centers.min(axis=0), np.ptp(centers, axis=0)
    largest = 1e3 * float(scene.radii.max())
    packed = np.empty((len(centers), 4), dtype="<u2")
    packed[:, :3] = np.round(_STEPS * (centers - low) / np.where(extent > 0, extent, 1.0))
    packed[:, 3] = np.round(_STEPS * 1e3 * scene.radii / largest)
    layers = len(scene.edges) - 1
    wall_radius = 0.0 if isinstance(scene.wall, Plate) else 1e3 * scene.wall.radius
    solid = 1e3 * scene.solid
    across, half_height = (1e3 * length for length in scene.bounds)
    return {
        "spheres": base64.b64encode(packed.tobytes()).decode(),
        "low": low.tolist(),
        "extent": extent.tolist(),
        "largest": largest,
        "middle": (1e3 * scene.middle).tolist(),
        "edges": (1e3 * scene.edges).tolist(),
        "kind": 2 if isinstance(scene.wall, Plate) else 0 if isinstance(scene.wall, Tube) else 1,
        "wall_radius": wall_radius,
        "solid": solid.tolist(),
        "across": across,
        "half_height": half_height,
        "reach": 1.01 * math.hypot(across, half_height),
        "palette": [_rgb(layer_colour(k)) for k in range(layers)] + [_rgb(BEYOND)],
        "wall_color": _rgb(WALL_COLOUR),
        "ambient": AMBIENT,
        "light": list(LIGHT),
        "front": FRONT,
        "azimuth": view.azimuth,
        "elevation": view.elevation,
        "opening": view.opening,
    }


def _rgb(colour: str) -> list[float]:
    return [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]


def _json(data: dict[str, Any]) -> str:
    """JSON that no HTML parser takes for the end of the script."""
    return json.dumps(data).replace("<", "\\u003c")
