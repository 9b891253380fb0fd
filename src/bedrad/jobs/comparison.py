"""Measured statistics against the correlations for the wall layer of a flow in a tube (Watkins 2018, eq. 38-40)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from bedrad.heat import correlations
from bedrad.packings.statistics import Statistics
from bedrad.walls import Tube, Wall

__all__ = ["COMPARED_TOLERANCES", "Comparison", "check_comparable", "compare_with_correlations", "flow_velocity"]

COMPARED_TOLERANCES = (0.0, 1e-3, 1e-2)
"""Gaps, in radii, at which the contacts are compared."""

VELOCITY_NOTE = "mean_velocity_m_per_s"
"""Name in a packing's provenance of the mean velocity of the flow it is from. [m/s]"""

PACKING_FRACTION_ACCURACY, CONTACT_RATIO_ACCURACY = 0.05, 0.16
"""Relative deviation within which the source states its fits of eq. 38 and 40 to hold for its own flows."""


@dataclass(frozen=True)
class Comparison:
    """One measured quantity beside its correlation.

    Attributes
    ----------
    name : str
        The quantity.
    equation : str
        The correlation's number in Watkins (2018).
    measured, error : float
        Measured value and its standard error.
    correlation : float
        Value of the correlation.
    accuracy : float
        Relative deviation within which the source states the correlation to hold.
    """

    name: str
    equation: str
    measured: float
    error: float
    correlation: float
    accuracy: float

    @property
    def difference(self) -> float:
        """Measured over correlation, less 1."""
        return self.measured / self.correlation - 1.0

    @property
    def residual(self) -> float:
        """Measured less correlation, in standard errors of the measured; nan where there is no error."""
        return (self.measured - self.correlation) / self.error if self.error > 0.0 else math.nan


def compare_with_correlations(found: Statistics, velocity: float) -> list[Comparison]:
    """Set measured statistics beside the correlations at their diameter ratio and a velocity.

    The correlations get the number-mean diameter of the particles. Contacts depend on the gap that counts as one, so
    that they are compared at each of `COMPARED_TOLERANCES`.

    Parameters
    ----------
    found : Statistics
        The measured bed, in a tube.
    velocity : float
        Mean velocity of the flow. [m/s]

    Returns
    -------
    list of Comparison
        Solid fraction of the wall layer (eq. 38), and contacts over their hexagonal maximum (eq. 40 and 39).

    Raises
    ------
    ValueError
        If the wall is not a tube, or the velocity is negative.

    Warns
    -----
    RangeWarning
        Outside the diameter ratios and velocities that the correlations were fitted to.
    """
    diameter = found.mean_diameter
    ratio = 2.0 * _tube_radius(found.wall, velocity) / diameter
    rows = [
        Comparison(
            "phi_wa",
            "38",
            found.packing_fraction,
            found.packing_fraction_error,
            float(correlations.packing_fraction(ratio, velocity, diameter)),
            PACKING_FRACTION_ACCURACY,
        )
    ]
    contacts = float(correlations.contact_ratio(ratio, velocity, diameter))
    for k, gap in enumerate(found.gap_tolerances.tolist()):
        if gap in COMPARED_TOLERANCES:
            value, error = float(found.contact_ratio_by_gap[k]), float(found.contact_ratio_by_gap_error[k])
            name = f"n_C/n_C,max at {gap:g} r"
            rows.append(Comparison(name, "40", value, error, contacts, CONTACT_RATIO_ACCURACY))
    return rows


def check_comparable(wall: Wall, velocity: float) -> None:
    """Check that there are correlations for a wall and a velocity, before anything is measured.

    Raises
    ------
    ValueError
        If the wall is not a tube, or the velocity is not a number of m/s, zero or more.
    """
    _tube_radius(wall, velocity)


def _tube_radius(wall: Wall, velocity: float) -> float:
    if not isinstance(wall, Tube):
        raise ValueError(f"the correlations are for flow in a tube; the wall is {wall!r}")  # noqa: TRY004
    if not (math.isfinite(velocity) and velocity >= 0.0):
        raise ValueError(f"velocity is {velocity} m/s; expected a number, zero or more")
    return wall.radius


def flow_velocity(provenance: Mapping[str, str | float | int]) -> float | None:
    """Mean velocity of the flow that a packing is from, where its provenance says so. [m/s]"""
    value = provenance.get(VELOCITY_NOTE)
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else None
