"""Heat transfer coefficient of a wall by the fluid lenses of the particles near it, from their gaps."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bedrad.heat.fluid_lens import LENS_RADIUS, Overlap, conductance
from bedrad.heat.ranges import positive

__all__ = ["WallCoefficient", "wall_coefficient"]


@dataclass(frozen=True)
class WallCoefficient:
    """Heat transfer coefficient of a wall by the lenses of its particles.

    Parameters
    ----------
    coefficient : float
        h, over the whole wall, particle temperatures taken as one. [W/(m2 K)]
    contact, no_contact : float
        Shares of h by particles that stand on their asperities (gap at most s), and by the others.
        [W/(m2 K)]
    standard_error : float
        Standard error of h from the scatter over groups, NaN without groups. [W/(m2 K)]
    contacts, within_reach, out_of_reach : int
        Particles in contact, in reach of the wall without contact, and too far to take up heat.
    groups : int
        Groups of wall behind the standard error; 0 without.
    """

    coefficient: float
    contact: float
    no_contact: float
    standard_error: float
    contacts: int
    within_reach: int
    out_of_reach: int
    groups: int

    def __str__(self) -> str:
        """One screen."""
        error = f" ± {self.standard_error:.2g} ({self.groups} groups)" if self.groups else ""
        share = self.contact / self.coefficient if self.coefficient > 0.0 else math.nan
        return (
            f"h through the gas {self.coefficient:.4g}{error} W/(m2 K)\n"
            f"  contact particles    {self.contacts:6d}  {self.contact:.4g} W/(m2 K), {share:.1%}\n"
            f"  no-contact particles {self.within_reach:6d}  {self.no_contact:.4g} W/(m2 K), {1.0 - share:.1%}\n"
            f"  out of reach         {self.out_of_reach:6d}"
        )


def _labels(groups: ArrayLike, shape: tuple[int, ...], number: int | None) -> NDArray[np.int64]:
    label = np.asarray(groups)
    if label.shape != shape or not np.issubdtype(label.dtype, np.integer):
        raise ValueError(f"groups is {label.dtype} of shape {label.shape}; expected integers of shape {shape}, as gaps")
    if label.size and label.min() < 0:
        raise ValueError(f"groups holds {int(label.min())}; expected numbers from 0")
    if number is not None and label.size and label.max() >= number:
        raise ValueError(f"groups holds {int(label.max())}; expected numbers below number_of_groups, {number}")
    return label.astype(np.int64)


def wall_coefficient(
    gas_conductivity: float,
    particle_diameters: ArrayLike,
    gaps: ArrayLike,
    wall_area: float,
    asperity: ArrayLike,
    lens_radius: float = LENS_RADIUS,
    free_path: float = 0.0,
    overlap: Overlap = "contact",
    groups: ArrayLike | None = None,
    number_of_groups: int | None = None,
) -> WallCoefficient:
    """Heat transfer coefficient of a flat wall by the lenses of all particles near it (Adepu et al., eq. 1).

    `h = sum H_i/A_wall`, with one temperature for all particles.

    Parameters
    ----------
    gas_conductivity : float
        Conductivity of the interstitial gas. [W/(m K)]
    particle_diameters : float or (n,) array
        Particle diameters; a bed may be polydisperse. [m]
    gaps : (n,) array
        Gaps between particles and wall; negative where they overlap. Far particles may stay in: they take up
        nothing. [m]
    wall_area : float
        Area of wall that the particles were taken from. [m2]
    asperity : float or (n,) array
        Height of the asperities. [m]
    lens_radius, free_path, overlap
        As for `conductance`.
    groups : (n,) array of int, optional
        Number of the piece of wall that each particle belongs to, from 0; pieces of equal area, far enough
        apart or large enough to be independent. Gives the standard error.
    number_of_groups : int, optional
        Pieces in all, where the last ones may hold no particle; by default the largest number in `groups` + 1.

    Returns
    -------
    WallCoefficient

    Raises
    ------
    ValueError
        If an input has no meaning, the arrays differ in length, or there are fewer than two groups.
    """
    area = float(positive("wall_area", wall_area, "m2"))
    delta = np.asarray(gaps, dtype=np.float64)
    if delta.ndim != 1:
        raise ValueError(f"gaps has {delta.ndim} dimensions; expected 1, one gap for each particle")
    if np.ndim(particle_diameters) and np.shape(particle_diameters) != delta.shape:
        raise ValueError(
            f"particle_diameters has shape {np.shape(particle_diameters)}; expected {delta.shape}, as gaps"
        )
    if np.ndim(asperity) and np.shape(asperity) != delta.shape:
        raise ValueError(f"asperity has shape {np.shape(asperity)}; expected {delta.shape}, as gaps")
    H = np.asarray(conductance(gas_conductivity, particle_diameters, delta, asperity, lens_radius, free_path, overlap))
    touching = delta <= np.asarray(asperity)
    error, pieces = math.nan, 0
    if groups is not None:
        label = _labels(groups, delta.shape, number_of_groups)
        pieces = int(number_of_groups or label.max(initial=-1) + 1)
        if pieces < 2:
            raise ValueError(f"number_of_groups is {pieces}; expected at least 2 for a standard error")
        parts = np.bincount(label, weights=H, minlength=pieces) / (area / pieces)
        error = float(np.std(parts, ddof=1) / math.sqrt(pieces))
    return WallCoefficient(
        coefficient=float(np.sum(H)) / area,
        contact=float(np.sum(H[touching])) / area,
        no_contact=float(np.sum(H[~touching])) / area,
        standard_error=error,
        contacts=int(np.count_nonzero(touching)),
        within_reach=int(np.count_nonzero(~touching & (H > 0.0))),
        out_of_reach=int(np.count_nonzero(H == 0.0)),
        groups=pieces,
    )
