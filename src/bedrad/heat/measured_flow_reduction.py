"""From the readings of a run to h, Nu and the first-law check at every station (Watkins 2018, sections 2.1.3, 2.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from bedrad.heat.energy_balance import SpecificHeat
from bedrad.heat.materials import ZERO_CELSIUS
from bedrad.heat.measured_flow_profile import ProfileForm, mean_from_profile
from bedrad.heat.measured_flow_run import Properties, ReducedRun, Row, Run, Tube
from bedrad.heat.measured_flow_transfer import (
    FirstLaw,
    first_law_check,
    heat_transfer_coefficient,
    inverse_graetz,
    nusselt,
)
from bedrad.heat.measured_flow_value import Measured, combined
from bedrad.heat.measured_flow_wall import regressed_wall_temperature, wall_heat_flux, wall_temperature_drop
from bedrad.heat.ranges import FloatArray, non_negative

__all__ = ["FluxChoice", "reduce_run"]

FluxChoice = Literal["local", "section"]
"""Where the wall heat flux of a station is taken: there, or over the section before it."""


def _stacked(values: Sequence[Measured]) -> Measured:
    return Measured(
        *(np.array([getattr(v, name) for v in values]) for name in ("value", "error", "degrees_of_freedom"))
    )


def _at(values: Measured, place: int) -> Measured:
    return Measured(values.value[place], values.error[place], values.degrees_of_freedom[place])


def _instrumental(reading: Measured, tolerance: float) -> Measured:
    """A reading with the error of its thermocouple: a share of the temperature in degrees Celsius."""
    return combined(
        reading.value, [(1.0, reading), (1.0, Measured(0.0, tolerance * abs(reading.value - ZERO_CELSIUS)))]
    )


def _section_mean(positions: FloatArray, readings: Sequence[Measured], start: float, end: float) -> Measured:
    """Mean over a section of what is linear between readings and constant outside; the value there if start is end."""
    places = np.unique(np.concatenate([[start, end], positions[(positions > start) & (positions < end)]]))
    shares = np.stack([np.interp(places, positions, row) for row in np.eye(positions.size)])
    weights = shares[:, 0]
    if end > start:
        weights = np.sum(0.5 * (shares[:, 1:] + shares[:, :-1]) * np.diff(places), axis=-1) / (end - start)
    values = np.array([float(r.value) for r in readings])
    return combined(float(weights @ values), list(zip(weights.tolist(), readings, strict=True)))


def _mean_along(run: Run, name: str, start: float, end: float) -> Measured:
    """Mean wall or surface temperature of a section, from all rows that have one."""
    known = [(row.position, getattr(row, name)) for row in run.rows if getattr(row, name) is not None]
    if not known:
        raise ValueError(f"{run.name}: no {name.replace('_', ' ')} is given; expected at least one for the losses")
    return _section_mean(np.array([z for z, _ in known]), [value for _, value in known], start, end)


def _flow_temperature(row: Row, tube: Tube, form: ProfileForm, tolerance: float) -> Measured:
    if row.profile is None:
        assert row.mean_temperature is not None  # noqa: S101 - a station has one of both
        return _instrumental(row.mean_temperature, tolerance)
    p = row.profile
    # one thermocouple is moved across the tube
    common = tolerance * abs(float(np.mean(p.temperature)) - ZERO_CELSIUS)
    return mean_from_profile(
        p.radius, p.temperature, 0.5 * tube.inner_diameter, p.error, form=form, instrument_error=common
    ).mean


def _with_instrument(run: Run, tolerance: float) -> Run:
    """The run with the errors of its thermocouples in wall and inlet temperatures."""
    if not tolerance:
        return run
    rows = [
        row if row.wall_temperature is None
        else replace(row, wall_temperature=_instrumental(row.wall_temperature, tolerance))
        for row in run.rows
    ]  # fmt: skip
    inlet = None if run.inlet_temperature is None else _instrumental(run.inlet_temperature, tolerance)
    return replace(run, rows=rows, inlet_temperature=inlet)


def _outer_temperature(run: Run, row: Row, developed_from: float) -> Measured:
    """Wall temperature at a station, by regression over the others where its own is missing."""
    if row.wall_temperature is not None:
        return row.wall_temperature
    others = [r for r in run.rows if r.wall_temperature is not None and r.position >= developed_from]
    if len(others) < 3:
        raise ValueError(
            f"{run.name}: no wall temperature at {row.position:g} m, and {len(others)} from {developed_from:g} m on; "
            "expected three or more for a straight line"
        )
    readings = _stacked([r.wall_temperature for r in others if r.wall_temperature is not None])
    return regressed_wall_temperature([r.position for r in others], readings.value, row.position, readings.error)


def _section(run: Run, row: Row, start: float, tube: Tube) -> tuple[Measured, Measured]:
    """Power and loss of the section from `start` to a station."""
    length = row.position - start
    if run.total_power is not None and run.heated_length is not None:
        share = length / run.heated_length
        power = combined(share * run.total_power.value, [(share, run.total_power)])
    elif row.power is not None:
        power = row.power
    else:
        raise ValueError(f"{run.name}: no power is given for the section that ends at {row.position:g} m")
    if row.loss is not None:
        return power, row.loss
    if tube.insulation is None:
        return power, Measured(0.0)
    wall, surface = (_mean_along(run, n, start, row.position) for n in ("wall_temperature", "surface_temperature"))
    return power, tube.insulation.loss(length, wall, surface)


def _loss_at(run: Run, station: Row, outer: Measured, section_loss: Measured, length: float, tube: Tube) -> Measured:
    """Loss per length just at a station; the mean of its section where it was stated and not worked out. [W/m]"""
    if station.loss is not None or tube.insulation is None:
        return combined(section_loss.value / length, [(1.0 / length, section_loss)])
    surface = _mean_along(run, "surface_temperature", station.position, station.position)
    return tube.insulation.loss(1.0, outer, surface)


def _balance(
    run: Run, position: FloatArray, T_m: Measured, power: Measured, loss: Measured, specific_heat: SpecificHeat
) -> FirstLaw | None:
    """First-law check from the inlet, or from the first station, to the other stations."""
    first = 0 if run.inlet_temperature is not None else 1
    if position.size == first:
        return None
    start = run.inlet_temperature or _at(T_m, 0)
    heat = np.cumsum((power.value - loss.value)[first:])
    # one reading of the whole power is wrong by the same share everywhere, those of sections each in its way
    supplied = power.error[first:]
    shared = np.cumsum(supplied) if run.total_power is not None else np.sqrt(np.cumsum(supplied**2))
    error = np.sqrt(shared**2 + np.cumsum(loss.error[first:] ** 2))
    there = Measured(T_m.value[first:], T_m.error[first:], T_m.degrees_of_freedom[first:])
    return first_law_check(start, Measured(heat, error), run.mass_flow, specific_heat, there)


def _wall_flux(
    run: Run,
    stations: Sequence[Row],
    power: Measured,
    loss: Measured,
    outer: Measured,
    lengths: FloatArray,
    tube: Tube,
    choice: FluxChoice,
) -> tuple[Measured, FloatArray]:
    """Flux into the flow at the stations, and the loss per length that goes with it."""
    R = 0.5 * tube.inner_diameter
    if choice == "section":
        return wall_heat_flux(power, loss, R, lengths), np.asarray(loss.value / lengths)
    each = [(_at(outer, k), _at(loss, k), float(length)) for k, length in enumerate(lengths)]
    lost = _stacked([_loss_at(run, row, *there, tube) for row, there in zip(stations, each, strict=True)])
    return wall_heat_flux(combined(power.value / lengths, [(1.0 / lengths, power)]), lost, R, 1.0), lost.value


def _check(run: Run) -> None:
    positions = np.array([row.position for row in run.rows])
    if np.any(np.diff(positions) <= 0.0):
        raise ValueError(f"{run.name}: positions are {positions.tolist()} m; expected them to increase")
    stations = [row for row in run.rows if row.is_station]
    if not stations:
        raise ValueError(f"{run.name}: no temperature of the flow is given at any position")
    if stations[0].position <= 0.0:
        raise ValueError(f"{run.name}: a station lies at {stations[0].position:g} m; expected it after z = 0")
    if (run.total_power is None) != (run.heated_length is None):
        given = "total_power" if run.heated_length is None else "heated_length"
        raise ValueError(f"{run.name}: {given} is given alone; expected total_power and heated_length, or neither")
    if run.heated_length is not None and stations[-1].position > run.heated_length:
        raise ValueError(
            f"{run.name}: a station lies at {stations[-1].position:g} m; expected it within the heated length, "
            f"{run.heated_length:g} m"
        )


def reduce_run(
    run: Run,
    tube: Tube,
    properties: Properties,
    *,
    form: ProfileForm = "quadratic",
    instrument_tolerance: float = 0.0,
    developed_from: float = 0.0,
    flux: FluxChoice = "local",
) -> ReducedRun:
    """Reduce the readings of a run (Watkins 2018, eq. 1-5, 7, 12-14, 51-57).

    Parameters
    ----------
    run : Run
        The readings.
    tube : Tube
        The heated tube.
    properties : Properties
        Of the particles.
    form : {"quadratic", "even", "spline"}
        Of the radial profiles, see `mean_from_profile`.
    instrument_tolerance : float
        Relative standard error of a thermocouple, of its temperature in degrees Celsius. It is common to all radii of
        a profile, and added to what the readings state.
    developed_from : float
        Wall temperatures from this position on give that of a station without its own. [m]
    flux : {"local", "section"}
        Wall heat flux that h is taken with: with the loss just at the station, or the mean over the section before
        it, as in the source. The wall is hottest at the end of a section, and the loss the largest.

    Returns
    -------
    ReducedRun
        Results at the stations.

    Raises
    ------
    ValueError
        If something needed is missing or has no meaning; the message names the run.

    Warns
    -----
    RangeWarning
        If a property is used outside its measured range, or a profile ends far from the wall.
    """
    tolerance = float(non_negative("instrument_tolerance", instrument_tolerance))
    if flux not in get_args(FluxChoice):
        raise ValueError(f"flux is {flux!r}; expected one of {', '.join(get_args(FluxChoice))}")
    non_negative("developed_from", developed_from, "m")
    _check(run)
    original, run = run, _with_instrument(run, tolerance)
    stations = [row for row in run.rows if row.is_station]
    position = np.array([row.position for row in stations])
    lengths = np.diff(position, prepend=0.0)
    sections = [_section(run, row, z - L, tube) for row, z, L in zip(stations, position, lengths, strict=True)]
    power, loss = (_stacked([pair[k] for pair in sections]) for k in (0, 1))
    outer = _stacked([_outer_temperature(run, row, developed_from) for row in stations])
    q, lost = _wall_flux(run, stations, power, loss, outer, lengths, tube, flux)
    inner = outer
    if tube.outer_diameter is not None:
        drop = wall_temperature_drop(
            q.value, 0.5 * tube.inner_diameter, 0.5 * tube.outer_diameter, tube.wall_conductivity, lost, tube.heating
        )
        inner = Measured(outer.value - drop, outer.error, outer.degrees_of_freedom)
    T_m = _stacked([_flow_temperature(row, tube, form, tolerance) for row in stations])
    h = heat_transfer_coefficient(q, inner, T_m)
    k_b, flow = properties.k_b(np.asarray(T_m.value)), float(run.mass_flow.value)
    return ReducedRun(
        run=original,
        position=position,
        wall_temperature=inner,
        mean_temperature=T_m,
        power=power,
        loss=loss,
        heat_flux=q,
        heat_transfer_coefficient=h,
        bulk_conductivity=k_b,
        nusselt=nusselt(h, tube.inner_diameter, k_b),
        z_star=np.asarray(
            inverse_graetz(position, tube.inner_diameter, flow, k_b.value, properties.c_p(np.asarray(T_m.value)))
        ),
        mass_flux=flow / (0.25 * np.pi * tube.inner_diameter**2),
        first_law=_balance(run, position, T_m, power, loss, properties.specific_heat),
    )
