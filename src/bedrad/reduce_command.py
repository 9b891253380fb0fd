"""The command that reduces measured flows: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Group, Parameter

from bedrad.command_options import OUTPUT, Conductivity, Density, Length, list_files, read_as, say

if TYPE_CHECKING:
    from bedrad.heat.measured_flow import Insulation, ModelRun, ReducedRun

__all__ = ["reduce"]

SpecificHeat = Annotated[float, read_as("J/(kg K)")]

_APPARATUS = Group("Apparatus")
_PARTICLES = Group("Particles", help="Values of the material (Watkins 2018, Tables 2.2-2.4) where none is given.")

BULK_ERROR = 0.11
"""Half width of the 95 % interval of the bulk conductivities of Table 2.4, relative (Watkins 2018, appendix A)."""


def _layers(texts: tuple[str, ...], outer: float | None) -> Insulation | None:
    """Insulation from texts such as ``"25 mm: 0.12 W/(m K)"``, from inside; ValueError if one is none."""
    from bedrad.heat.measured_flow import Insulation
    from bedrad.jobs.units import quantity

    if not texts:
        return None
    if outer is None:
        raise ValueError("--insulation needs --outer, the outer diameter of the tube that it lies on")
    radius, radii, conductivities = 0.5 * outer, [], []
    for text in texts:
        thickness, separator, conductivity = text.partition(":")
        if not separator:
            raise ValueError(
                f"--insulation {text!r}: expected a thickness and a conductivity, such as '25 mm: 0.12 W/(m K)'"
            )
        radius += quantity(thickness.strip(), "m")
        radii.append(radius)
        conductivities.append(quantity(conductivity.strip(), "W/(m K)"))
    return Insulation(0.5 * outer, radii, conductivities)


def reduce(
    table: Path,
    /,
    *,
    tube: Annotated[Length, Parameter(name="--tube", group=_APPARATUS)],
    outer: Annotated[Length | None, Parameter(group=_APPARATUS)] = None,
    wall_conductivity: Annotated[Conductivity, Parameter(group=_APPARATUS)] = 14.5,
    heating: Annotated[Literal["generated", "conducted"], Parameter(group=_APPARATUS)] = "generated",
    heated_length: Annotated[Length | None, Parameter(group=_APPARATUS)] = None,
    insulation: Annotated[tuple[str, ...], Parameter(negative=(), group=_APPARATUS, show_default=False)] = (),
    instrument: Annotated[float, Parameter(group=_APPARATUS)] = 0.0,
    diameter: Annotated[Length | None, Parameter(group=_PARTICLES)] = None,
    material: Annotated[
        Literal["zirconia-silica", "alumina-silicate"], Parameter(group=_PARTICLES)
    ] = "zirconia-silica",
    bulk_conductivity: Annotated[Conductivity | None, Parameter(group=_PARTICLES)] = None,
    bulk_conductivity_error: Annotated[float | None, Parameter(group=_PARTICLES)] = None,
    specific_heat: Annotated[SpecificHeat | None, Parameter(group=_PARTICLES)] = None,
    bulk_density: Annotated[Density | None, Parameter(group=_PARTICLES)] = None,
    solid_conductivity: Annotated[Conductivity | None, Parameter(group=_PARTICLES)] = None,
    profile: Literal["quadratic", "even", "spline"] = "quadratic",
    developed_from: Length = 0.0,
    flux: Literal["local", "section"] = "local",
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
) -> None:
    """Reduce a table of a heated flow in a tube to h, Nu and a first-law check, with uncertainties.

    The table (CSV) has a row for each position of each run and these columns, units in brackets: position, mass flow,
    wall temperature; power of the section that ends there (or voltage and current); "T at r = 1.5 mm" for each
    reading across the tube, or mean temperature; and if known run, inlet temperature, surface temperature of the
    insulation, loss, and standard errors such as "wall temperature error [K]" and "T error [K]". Cells may be empty:
    rows without a temperature of the flow give wall temperatures between the stations (docs/heat_measured_flow.md).

    Parameters
    ----------
    table
        The table, a CSV file.
    tube
        Inner diameter of the tube.
    outer
        Outer diameter of the tube, where the wall temperatures are measured; if not given they are those inside.
    wall_conductivity
        Conductivity of the tube. [default: 14.5 W/(m K), Inconel]
    heating
        Heat made in the wall by a current, or conducted through it from outside.
    heated_length
        The power is that of this length from z = 0, and spread evenly; that of each section if not given.
    insulation
        A layer around the tube, from inside, once for each: "25 mm: 0.12 W/(m K)".
    instrument
        Tolerance of the thermocouples, within which 95 % lie, as a share of degrees Celsius; 0.004 for type K.
    diameter
        Particle diameter; puts the two-layer model beside the points.
    material
        Material of the particles.
    bulk_conductivity
        Bulk conductivity; by the fits for the material and diameter if not given.
    bulk_conductivity_error
        Its relative standard error; 0.056 for the fits, 0 for one that is given.
    specific_heat
        Specific heat of the bed; the material's power law if not given.
    bulk_density
        Density of the flowing bed; the material's if not given.
    solid_conductivity
        Conductivity of the particles; the material's if not given.
    profile
        Form of the radial temperature profile: quadratic regression, one symmetric about the axis, or a spline.
    developed_from
        Wall temperatures from here on give, by a straight line, that of a station without its own. [default: 0 m]
    flux
        Wall heat flux behind h: with the loss just at the station, or the mean of its section, as in the source.
    output
        Results to write (CSV), with a figure beside them (.png, extra view).
    """
    from bedrad.heat import measured_flow
    from bedrad.heat.materials import MATERIALS
    from bedrad.jobs.measurements import read_measurements, reduce_measurements
    from bedrad.report.measured_screen import measured_screen

    known = MATERIALS[material]
    missing = None if output is None else _check(output, table)
    # before what else is wanted: a table that is missing or broken
    read_measurements(table, heated_length)
    k_b, k_b_error, notes = _bulk(diameter, material, bulk_conductivity, bulk_conductivity_error)
    c_p: Any = known if specific_heat is None else specific_heat
    notes.append(
        f"c_p: {f'Table 2.3, {material}' if specific_heat is None else f'{specific_heat:g} J/(kg K)'}; "
        f"profile: {profile}; heat {heating}; flux: {flux}"
    )
    if not 0.0 <= instrument < 1.0:
        raise ValueError(f"--instrument is {instrument:g}; expected a share from 0 to below 1, such as 0.004")
    runs = reduce_measurements(
        table,
        measured_flow.Tube(tube, outer, wall_conductivity, _layers(insulation, outer), heating),
        measured_flow.Properties(c_p, k_b, k_b_error),
        heated_length=heated_length,
        form=profile,
        instrument_tolerance=instrument / float(measured_flow.coverage_factor()),
        developed_from=developed_from,
        flux=flux,
    )
    model = None
    if diameter is not None:
        density = known.bulk_density if bulk_density is None else bulk_density
        solid = known.solid_conductivity if solid_conductivity is None else solid_conductivity
        model = measured_flow.beside_model(runs, tube, diameter, density, solid)
    OUTPUT.print(measured_screen(runs, model, notes))
    if output is not None:
        _write(runs, model, output, table.name, missing)


def _bulk(
    diameter: float | None, material: str, given: float | None, error: float | None
) -> tuple[Any, float, list[str]]:
    """Bulk conductivity, its relative standard error, and a line that says where it is from."""
    from bedrad.heat.bulk import find_fit
    from bedrad.heat.measured_flow import coverage_factor

    if given is not None:
        relative = 0.0 if error is None else error
        return given, relative, [f"k_b: {given:g} W/(m K), standard error {100 * relative:.2g} %"]
    fit = None if diameter is None else find_fit(diameter, material, "2.4")
    if fit is None:
        if diameter is None:
            raise ValueError(
                "give --diameter, for the fits of the bulk conductivity and the model, or --bulk-conductivity"
            )
        raise ValueError(
            f"no bulk conductivity is known for {material} of {1e6 * diameter:g} um; give --bulk-conductivity"
        )
    relative = BULK_ERROR / float(coverage_factor()) if error is None else error
    text = f"k_b: Table 2.4 (Watkins 2018), {1e6 * fit.particle_diameter:g} um {material}"
    return fit.conductivity, relative, [f"{text}, standard error {100 * relative:.2g} %"]


def _check(output: Path, table: Path) -> str | None:
    """Make sure that results can be written before anything is computed; why no figure can, if so."""
    from bedrad.errors import MissingExtraError
    from bedrad.jobs.results import check_writable
    from bedrad.report.style import styled

    if output.suffix.lower() != ".csv":
        raise ValueError(f"{output}: suffix {output.suffix!r}; results are written as .csv")
    if output.resolve() == table.resolve():
        raise ValueError(f"{output}: is the table itself; give the results another name")
    check_writable(output)
    try:
        with styled():
            return None
    except MissingExtraError as error:
        return str(error)


def _write(runs: list[ReducedRun], model: list[ModelRun] | None, output: Path, title: str, missing: str | None) -> None:
    """Write table and figure, and list them."""
    from bedrad.report.measured_figure import write_measured_figure
    from bedrad.report.measured_tables import write_measured_table

    write_measured_table(output, runs, model)
    written = [output]
    if missing is None:
        written.append(output.with_suffix(".png"))
        write_measured_figure(written[-1], runs, model, title)
    list_files(written)
    if missing is not None:
        say(f"left out: figure: {missing}")
