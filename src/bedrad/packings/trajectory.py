"""What makes packings the frames of one trajectory, so that means over them have a meaning."""

from __future__ import annotations

from bedrad.packings.layers import check_window
from bedrad.packings.packing import Packing
from bedrad.walls import Plate, Wall, Window

__all__ = ["WALL_TOLERANCE", "check_frame"]

WALL_TOLERANCE = 0.01
"""How much the wall's radius may differ between frames, in mean radii of the spheres: as where it is fitted to each."""


def check_frame(packing: Packing, wall: Wall, window: Window, radius: float) -> None:
    """Refuse a frame that cannot be averaged with the first.

    Parameters
    ----------
    packing : Packing
        The frame.
    wall, window : Wall, Window
        Those of the first frame.
    radius : float
        Mean radius of the spheres in it. [m]

    Raises
    ------
    ValueError
        If the frame is empty, has another wall, or does not reach over the window.
    """
    if not len(packing):
        raise ValueError("the packing is empty; there is nothing to measure")
    apart = 0.0 if isinstance(wall, Plate) or isinstance(packing.wall, Plate) else packing.wall.radius - wall.radius
    if packing.wall.kind != wall.kind or abs(apart) > WALL_TOLERANCE * radius:
        raise ValueError(
            f"the wall is {packing.wall!r}, that of the first frame {wall!r}; give the wall when the frames are read"
        )
    check_window(packing, window)
    axes = [(wall.axial, window.axial)]
    if isinstance(wall, Plate) and window.lateral is not None:
        axes.append((1, window.lateral))
    for axis, (low, high) in axes:
        reach = packing.extent(axis)
        if not packing.box[axis] and not (reach[0] <= low and high <= reach[1]):
            raise ValueError(
                f"the bed reaches from {reach[0]:.6g} to {reach[1]:.6g} m in {'xyz'[axis]}; it does not fill the "
                f"window from {low:.6g} to {high:.6g} m: give a window that all frames fill"
            )
