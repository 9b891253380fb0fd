"""The job: one TOML file, checked whole before anything runs."""

from __future__ import annotations

import difflib
import json
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from bedrad.errors import BadFileError
from bedrad.jobs.units import Conductivity, Density, Length, Stiffness, Temperature, Velocity
from bedrad.walls import Plate, Rod, Tube, Wall

__all__ = ["Job", "load_job", "parse_job"]

PositiveInt = Annotated[int, Field(gt=0, strict=True)]
Seed = Annotated[int, Field(ge=0, strict=True)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class WallSection(_Section):
    """The wall: its shape, and its diameter unless it is flat."""

    shape: Literal["tube", "rod", "plate"] = "tube"
    diameter: Annotated[Length, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _check_diameter(self) -> WallSection:
        if (self.diameter is None) != (self.shape == "plate"):
            raise ValueError(f"a {self.shape} takes {'no' if self.shape == 'plate' else 'a'} diameter")
        return self

    def build(self) -> Wall:
        """The wall object."""
        if self.diameter is None:
            return Plate()
        return Tube(self.diameter / 2) if self.shape == "tube" else Rod(self.diameter / 2)


class Size(_Section):
    """One size of a size distribution."""

    diameter: Annotated[Length, Field(gt=0)]
    share: Positive


class SettleSection(_Section):
    """A bed settled by the discrete-element method."""

    height: Annotated[Length, Field(gt=0)]
    diameter: Annotated[Length, Field(gt=0)] | None = None
    sizes: tuple[Size, ...] | None = None
    density: Annotated[Density, Field(gt=0)] = 3800.0
    friction: NotNegative = 0.4
    wall_friction: NotNegative | None = None
    restitution: Annotated[float, Field(gt=0, lt=1)] = 0.85
    stiffness: Annotated[Stiffness, Field(gt=0)] | None = None
    ranks: PositiveInt = 1

    @model_validator(mode="after")
    def _check_sizes(self) -> SettleSection:
        if (self.diameter is None) == (self.sizes is None):
            raise ValueError("give a diameter or sizes, one of the two")
        return self


class FileSection(_Section):
    """A bed read from a file."""

    path: Path
    diameter: Annotated[Length, Field(gt=0)] | None = None
    period: Annotated[Length, Field(gt=0)] | tuple[Length, Length] | None = None
    frame: Annotated[int, Field(strict=True)] = -1


class PackingSection(_Section):
    """Where the bed comes from: one of `settle` and `file`."""

    settle: SettleSection | None = None
    file: FileSection | None = None

    @model_validator(mode="after")
    def _check_source(self) -> PackingSection:
        if (self.settle is None) == (self.file is None):
            raise ValueError("give one source of the bed, [packing.settle] or [packing.file]")
        return self


class LayersSection(_Section):
    """How the bed is cut: a wall layer one radius deep, the others one diameter deep."""

    count: PositiveInt = 3
    margin: NotNegative = 4.0


class StatisticsSection(_Section):
    """Measured packing statistics; the gap counts as contact, in particle radii."""

    contact_gap: NotNegative = 1e-2


class ViewFactorsSection(_Section):
    """Ray-traced view factors, to a standard error or with a number of rays."""

    tolerance: Positive | None = None
    rays: PositiveInt | None = None

    @model_validator(mode="after")
    def _check_effort(self) -> ViewFactorsSection:
        if self.tolerance is not None and self.rays is not None:
            raise ValueError("give tolerance or rays, not both")
        return self


class ConvergenceSection(_Section):
    """Error of the view factors against run time, on this bed."""

    rays: PositiveInt = 2**19
    reference_rays: PositiveInt = 2**25
    seeds: Annotated[int, Field(ge=2, strict=True)] = 8


class TemperatureRange(_Section):
    """Evenly spaced wall temperatures."""

    lowest: Annotated[Temperature, Field(gt=0)]
    highest: Annotated[Temperature, Field(gt=0)]
    count: PositiveInt = 21

    def values(self) -> list[float]:
        """The temperatures. [K]"""
        if self.count == 1:
            return [self.lowest]
        step = (self.highest - self.lowest) / (self.count - 1)
        return [self.lowest + k * step for k in range(self.count)]


class PredictionSection(_Section):
    """Heat transfer by the two-layer model, against the wall temperature."""

    wall_temperatures: TemperatureRange | tuple[Annotated[Temperature, Field(gt=0)], ...]
    velocity: Annotated[Velocity, Field(ge=0)]
    particle_diameter: Annotated[Length, Field(gt=0)] | None = None
    nc_distance: Literal["mean", "weighted", "closing"] = "mean"
    solid_conductivity: Annotated[Conductivity, Field(gt=0)] = 2.1
    bulk: Literal["auto", "table 5.2", "zbs"] = "auto"
    bulk_packing_fraction: Annotated[float, Field(gt=0, lt=1)] = 0.63
    emissivity: Annotated[float, Field(gt=0, le=1)] = 0.8
    published_systems: bool = True


class OutputSection(_Section):
    """What is written beside the results file."""

    tables: bool = True
    figures: bool = True


class Job(_Section):
    """A checked job.

    Attributes
    ----------
    name : str
        Title of the job, for figures and tables.
    seed : int
        Seed of everything random.
    wall, packing, layers, statistics, view_factors, convergence, prediction, output
        The sections; a stage without its section does not run.
    """

    name: str = "bedrad job"
    seed: Seed = 0
    wall: WallSection | None = None
    packing: PackingSection | None = None
    layers: LayersSection = LayersSection()
    statistics: StatisticsSection | None = None
    view_factors: ViewFactorsSection | None = None
    convergence: ConvergenceSection | None = None
    prediction: PredictionSection | None = None
    output: OutputSection = OutputSection()

    @model_validator(mode="after")
    def _check_stages(self) -> Job:
        if self.packing is not None and self.packing.settle is not None and self.wall is None:
            raise ValueError("[packing.settle] needs a [wall]")
        measured = [n for n in ("statistics", "view_factors", "convergence") if getattr(self, n) is not None]
        if measured and self.packing is None:
            raise ValueError(f"[{measured[0]}] needs a [packing]")
        if self.prediction is not None:
            if self.wall is not None and self.wall.shape != "tube":
                raise ValueError(f"[prediction] is for flow in a tube; the wall is a {self.wall.shape}")
            if self.packing is None and (self.wall is None or self.prediction.particle_diameter is None):
                raise ValueError("[prediction] without a [packing] needs a [wall] and a particle_diameter")
        if self.prediction is None and self.packing is None:
            raise ValueError("nothing to do: give a [packing] or a [prediction]")
        return self

    def resolved(self) -> str:
        """The job as JSON text with every default filled in and every quantity in SI units."""
        return json.dumps(self.model_dump(mode="json"), indent=1, sort_keys=True)


def load_job(path: str | Path) -> Job:
    """Read a job file.

    Parameters
    ----------
    path : path
        A TOML file. Relative paths inside it count from its folder.

    Raises
    ------
    BadFileError
        If the file is missing, is not TOML, or holds an unknown key or a wrong value. The message names the field, the
        value and what was expected.
    """
    file = Path(path)
    try:
        text = file.read_bytes().decode()
    except FileNotFoundError:
        raise BadFileError(f"{file}: no such job file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise BadFileError(f"{file}: cannot be read as a text file: {error}") from None
    return parse_job(text, file)


def parse_job(text: str, file: Path) -> Job:
    """Check the text of a job file; `file` names it in errors and is where relative paths count from.

    Raises
    ------
    BadFileError
        As `load_job`.
    """
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise BadFileError(f"{file}: not a TOML file: {error}") from None
    try:
        job = Job.model_validate(data)
    except ValidationError as error:
        raise BadFileError("\n".join(f"{file}: {line}" for line in _problems(error))) from None
    if job.packing is not None and job.packing.file is not None:
        bed = job.packing.file.model_copy(update={"path": file.parent / job.packing.file.path})
        job = job.model_copy(update={"packing": job.packing.model_copy(update={"file": bed})})
    return job


def _problems(error: ValidationError) -> list[str]:
    """One line for each problem: field, what is wrong, the value, what was expected."""
    lines = []
    for problem in error.errors():
        place = ".".join(str(part) for part in problem["loc"] if not _is_union_branch(part))
        if problem["type"] == "extra_forbidden":
            lines.append(f"{place}: unknown key{_nearest(problem['loc'])}")
            continue
        text = problem["msg"].removeprefix("Value error, ")
        text = text[0].lower() + text[1:]
        value = problem["input"]
        shown = "" if isinstance(value, dict) or repr(value) in text else f" (it is {value!r})"
        lines.append(f"{place or 'job'}: {text}{shown}")
    return list(dict.fromkeys(lines))


def _is_union_branch(part: object) -> bool:
    """Whether a piece of pydantic's error path names an alternative of a union and not a field."""
    return isinstance(part, str) and ("[" in part or part in ("TemperatureRange", "float"))


def _nearest(place: tuple[int | str, ...]) -> str:
    """Name the known key nearest to an unknown one, or all that are known."""
    known = sorted(_fields_at(place[:-1]))
    near = difflib.get_close_matches(str(place[-1]), known, n=1)
    return f"; did you mean {near[0]!r}?" if near else f"; known here: {', '.join(known)}"


def _fields_at(place: tuple[int | str, ...]) -> set[str]:
    model: Any = Job
    for part in place:
        if isinstance(part, int) or _is_union_branch(part):
            continue
        model = _section_in(model.model_fields[part].annotation)
    return set(model.model_fields)


def _section_in(annotation: Any) -> Any:
    """The section class inside an annotation such as ``tuple[Size, ...] | None``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for inner in get_args(annotation):
        found = _section_in(inner)
        if found is not None:
            return found
    return None
