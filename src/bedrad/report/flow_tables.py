"""CSV tables of a flow: what was measured, and the velocity profile."""

from __future__ import annotations

from pathlib import Path

from bedrad.packings.flow import Flow
from bedrad.report.csv_tables import Table, write_tables_beside

__all__ = ["write_flow_tables"]


def write_flow_tables(found: Flow, stem: Path) -> list[Path]:
    """Write ``<stem>_flow.csv`` and ``<stem>_velocity.csv``.

    Parameters
    ----------
    found : Flow
        The flow.
    stem : Path
        Beginning of the files' names.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    OSError
        If a table cannot be written; no half-written file stays behind.
    """
    return write_tables_beside(stem, {"flow": _measures(found), "velocity": _velocities(found)})


def _measures(found: Flow) -> Table:
    m, gaussian = found.measures, found.measures.profile.gaussian
    row = {
        "set velocity [m/s]": found.plan.velocity,
        "velocity [m/s]": m.velocity,
        "velocity error [m/s]": m.velocity_error,
        "velocity fluctuation [m/s]": m.velocity_fluctuation,
        "plug core velocity [m/s]": m.profile.core,
        "wall velocity [m/s]": m.profile.wall,
        "shear layer width [m]": m.profile.shear_width,
        "Gaussian amplitude A [m/s]": gaussian.amplitude,
        "Gaussian centre B [m]": gaussian.center,
        "Gaussian width Y [m]": gaussian.width,
        "Gaussian offset Z [m/s]": gaussian.offset,
        "Gaussian residual [mean velocity]": gaussian.residual,
        "granular temperature [g d]": m.granular_temperature,
        "solid fraction [1]": m.solid_fraction,
        "solid fraction error [1]": m.solid_fraction_error,
        "solid fraction at rest [1]": m.rest_solid_fraction,
        "wall pressure [Pa]": m.wall_pressure,
        "wall pressure error [Pa]": m.wall_pressure_error,
        "wall shear [Pa]": m.wall_shear,
        "wall shear error [Pa]": m.wall_shear_error,
        "Janssen pressure [Pa]": m.janssen_pressure,
        "discharge [kg/s]": m.discharge,
        "Beverloo discharge [kg/s]": m.beverloo_discharge,
        "independent structures [1]": m.independent_structures,
        "problems": "; ".join(m.problems),
        "run time [s]": found.seconds,
    }
    return {heading: [value] for heading, value in row.items()}


def _velocities(found: Flow) -> Table:
    profile = found.measures.profile
    return {
        "inner radius [m]": profile.radii[:-1].tolist(),
        "outer radius [m]": profile.radii[1:].tolist(),
        "velocity [m/s]": profile.speeds.tolist(),
        "velocity error [m/s]": profile.speeds_error.tolist(),
    }
