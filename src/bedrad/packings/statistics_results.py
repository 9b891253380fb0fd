"""What `statistics` gives: for one packing, and for a trajectory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bedrad.walls import Wall, Window

__all__ = ["Statistics", "TrajectoryStatistics"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Statistics:
    """What `statistics` measured.

    Every `<name>_error` is a standard error from blocks along the axis, nan where there is none.

    A gap is in radii: between a particle and the wall in the particle's own, between two particles in those of the
    smaller one. In a bed of several sizes the number-mean diameter sets lengths only: the thickness of the default
    layers and bins, the margin, `hexagonal_maximum`, and the sphere that closes the balance.

    Attributes
    ----------
    packing_fraction, packing_fraction_error : float
        Solid fraction of the wall layer.
    contacts_per_area, contacts_per_area_error : float
        Wall contacts per wall area within `contact_gap`. [1/m2]
    contact_ratio, contact_ratio_error : float
        The same over the hexagonal maximum, `wall_contacts.hexagonal_maximum` at the mean radius.
    nc_share, nc_share_error : float
        Share of particles without contact (NC) among those with volume in the wall layer.
    nc_distance, nc_distance_error : float
        Plain mean over the NC particles of their gap to the wall, in their own radii.
    nc_distance_weighted, nc_distance_weighted_error : float
        The same mean, weighted by each particle's volume in the wall layer.
    nc_distance_closing, nc_distance_closing_error : float
        The one gap that closes the wall layer's solid volume, `wall_contacts.closing_distance` at the mean
        radius. The volume is that of the counted particles; it differs from the packing fraction's only where
        the ends of the window cut them.
    edges : (layers + 1,) array
        Depths that bound the layers. [m]
    packing_fractions, packing_fractions_error : (layers,) arrays
        Solid fraction of every layer.
    gap_tolerances : (k,) array
        Gap tolerances, in particle radii, of the next arrays.
    contacts_per_area_by_gap, contacts_per_area_by_gap_error : (k,) arrays
        Wall contacts per wall area within each tolerance. [1/m2]
    contact_ratio_by_gap, contact_ratio_by_gap_error : (k,) arrays
        The same over the hexagonal maximum.
    profile_depths : (bins + 1,) array
        Depths that bound the bins of the profile. [m]
    profile, profile_error : (bins,) arrays
        Solid fraction of every bin.
    nc_share_by_gap, nc_share_by_gap_error : (k,) arrays
        NC share within each tolerance.
    nc_gap_edges : (gap bins + 1,) array
        Gaps that bound the bins of the next array, in particle radii.
    nc_gap_density, nc_gap_density_error : (gap bins,) arrays
        Distribution of the NC particles' gaps to the wall: share of them a radius of gap.
    nc_gap_beyond, nc_gap_beyond_error : float
        Share of them beyond the last bin, where only particles smaller than the mean can be.
    centre_depths : (centre bins + 1,) array
        Depths that bound the bins of the next two arrays. [m]
    centre_density, centre_density_error : (centre bins,) arrays
        Sphere centres per volume. [1/m3]
    contact_density, contact_density_error : (centre bins,) arrays
        Contacts between spheres within `contact_gap` per volume. [1/m3]
    coordination, coordination_error : (layers,) arrays
        Mean number of contacts that a sphere has with other spheres within `contact_gap`, wherever these lie. A sphere
        belongs to the layer that its near side, the point nearest to the wall, lies in: so the first layer's are the
        wall-layer particles, touching and NC.
    coordination_by_gap, coordination_by_gap_error : (layers, k) arrays
        The same within each tolerance.
    contact_number_shares, contact_number_shares_error : (14,) arrays
        Share of the spheres of all layers that have 0, 1, ... 12, and more contacts with other spheres.
    rattler_share, rattler_share_error : float
        Share of these spheres with fewer than four contacts, the wall counted (`coordination.RATTLER_CONTACTS`).
    hexagonal_order, hexagonal_order_error : float
        Mean |psi_6| of the particles that touch the wall (`wall_order.wall_order`): 1 in a hexagonal layer.
    wall_neighbours, wall_neighbours_error : float
        Mean number of neighbours that these have among themselves, 6 in a hexagonal layer.
    spheres, contacts, no_contacts : int
        Spheres with their centre in the window; of these, with wall contact, and NC.
    wall : Tube, Rod or Plate
        The wall.
    mean_diameter : float
        Number-mean diameter of the packing. [m]
    sauter_diameter, volume_mean_diameter : float
        Its Sauter mean d32 and volume-weighted mean d43, for comparison; nothing else depends on them. [m]
    window : Window
        The piece of wall that was measured.
    contact_gap : float
        Gap tolerance, in particle radii, that separates contact from no contact.
    blocks : int
        Blocks along the axis that the errors come from.
    overlap_share : float
        Volume counted twice where spheres overlap each other, as a share of the volume of the spheres in the
        window that reach the layers.
    left_out : mapping of str to int
        `outside_window`: spheres with their centre outside the window; `deeper`: spheres in the window that
        do not reach the last edge and were never cut.
    seconds : float
        Run time. [s]
    """

    packing_fraction: float
    packing_fraction_error: float
    contacts_per_area: float
    contacts_per_area_error: float
    contact_ratio: float
    contact_ratio_error: float
    nc_share: float
    nc_share_error: float
    nc_distance: float
    nc_distance_error: float
    nc_distance_weighted: float
    nc_distance_weighted_error: float
    nc_distance_closing: float
    nc_distance_closing_error: float
    edges: FloatArray
    packing_fractions: FloatArray
    packing_fractions_error: FloatArray
    gap_tolerances: FloatArray
    contacts_per_area_by_gap: FloatArray
    contacts_per_area_by_gap_error: FloatArray
    contact_ratio_by_gap: FloatArray
    contact_ratio_by_gap_error: FloatArray
    profile_depths: FloatArray
    profile: FloatArray
    profile_error: FloatArray
    nc_share_by_gap: FloatArray
    nc_share_by_gap_error: FloatArray
    nc_gap_edges: FloatArray
    nc_gap_density: FloatArray
    nc_gap_density_error: FloatArray
    nc_gap_beyond: float
    nc_gap_beyond_error: float
    centre_depths: FloatArray
    centre_density: FloatArray
    centre_density_error: FloatArray
    contact_density: FloatArray
    contact_density_error: FloatArray
    coordination: FloatArray
    coordination_error: FloatArray
    coordination_by_gap: FloatArray
    coordination_by_gap_error: FloatArray
    contact_number_shares: FloatArray
    contact_number_shares_error: FloatArray
    rattler_share: float
    rattler_share_error: float
    hexagonal_order: float
    hexagonal_order_error: float
    wall_neighbours: float
    wall_neighbours_error: float
    spheres: int
    contacts: int
    no_contacts: int
    wall: Wall
    mean_diameter: float
    sauter_diameter: float
    volume_mean_diameter: float
    window: Window
    contact_gap: float
    blocks: int
    overlap_share: float
    left_out: Mapping[str, int]
    seconds: float

    def __str__(self) -> str:
        low, high = (1e3 * x for x in self.window.axial)
        lines = [
            f"{self.wall!r}, mean diameter {1e6 * self.mean_diameter:.4g} um, window {low:.4g}..{high:.4g} mm",
            f"  {self.spheres} spheres, {self.contacts} in contact (gap <= {self.contact_gap:g} r), "
            f"{self.no_contacts} without contact (NC) in the wall layer",
        ]
        lines += [
            _line(label, scale * getattr(self, name), scale * getattr(self, name + "_error"), unit)
            for label, name, scale, unit in _ROWS
        ]
        for k, edge in enumerate(self.edges[:-1]):
            label = f"solid fraction, depth {1e3 * edge:.4g}..{1e3 * self.edges[k + 1]:.4g} mm"
            lines.append(_line(label, self.packing_fractions[k], self.packing_fractions_error[k]))
        for k, gap in enumerate(self.gap_tolerances):
            label = f"contacts / hexagonal maximum, gap <= {gap:g} r"
            lines.append(_line(label, self.contact_ratio_by_gap[k], self.contact_ratio_by_gap_error[k]))
        for k, edge in enumerate(self.edges[:-1]):
            label = f"contacts a sphere, near side {1e3 * edge:.4g}..{1e3 * self.edges[k + 1]:.4g} mm"
            lines.append(_line(label, self.coordination[k], self.coordination_error[k]))
        lines.append(
            f"  errors from {self.blocks} blocks; overlaps are {self.overlap_share:.2e} of the solid volume; "
            f"left out: {self.left_out['outside_window']} spheres outside the window, "
            f"{self.left_out['deeper']} deeper than the layers; {self.seconds:.2f} s"
        )
        return "\n".join(lines)


@dataclass(frozen=True, eq=False)
class TrajectoryStatistics(Statistics):
    """What `statistics` measured in several frames: means over time, under the names of `Statistics`.

    Ratios are those of the sums over all frames. Every `<name>_error` accounts for frames that resemble each other
    (`time_averages.errors_of_mean`). `spheres`, `contacts`, `no_contacts` and `left_out` count all frames together;
    `overlap_share` is their mean; mean diameters, layers, bins and window are those of the first frame.

    Attributes
    ----------
    frames : int
        Number of frames.
    structures : mapping of str to float or array
        For each name with an error the number of independent frames that would have this error, from 1 (all frames
        show one structure) to `frames`; `frames` over it is the statistical inefficiency. nan where nothing varies.
    """

    frames: int
    structures: Mapping[str, float | FloatArray]

    def __str__(self) -> str:
        head, _, rest = super().__str__().partition("\n")
        told = {name: self.structures[name] for _, name, _, _ in _ROWS if self.structures[name] > 0}
        fewest = min(told, key=lambda name: float(told[name]), default=None)
        text = "nothing varies" if fewest is None else f"at least {told[fewest]:.1f} independent structures ({fewest})"
        return f"{head}\n  mean over {self.frames} frames; {text}\n{rest}"


_ROWS = (
    ("wall contacts per area", "contacts_per_area", 1e-6, "1/mm2"),
    ("wall contacts / hexagonal maximum", "contact_ratio", 1.0, ""),
    ("NC share of the wall-layer particles", "nc_share", 1.0, ""),
    ("NC distance, plain mean", "nc_distance", 1.0, "r"),
    ("NC distance, weighted by volume", "nc_distance_weighted", 1.0, "r"),
    ("NC distance that closes the balance", "nc_distance_closing", 1.0, "r"),
    ("hexagonal order |psi_6| of the touching ones", "hexagonal_order", 1.0, ""),
    ("rattlers: fewer than four contacts", "rattler_share", 1.0, ""),
)


def _line(label: str, value: float, error: float, unit: str = "") -> str:
    return f"  {label:<46}{value:>9.5g} ± {error:.2g} {unit}".rstrip()
