"""The job: one TOML file, checked whole before anything runs."""

from __future__ import annotations

import difflib
import itertools
import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, Field, ValidationError, model_validator

from bedrad.errors import BadFileError
from bedrad.jobs.file_section import FileSection
from bedrad.jobs.prediction_section import PredictionSection
from bedrad.jobs.section import (
    BelowOne,
    Count,
    NotNegative,
    Positive,
    PositiveInt,
    PositiveLength,
    Section,
    Seed,
    YesNo,
)
from bedrad.jobs.sweep_section import SweepSection
from bedrad.jobs.units import Density, Stiffness, shortened
from bedrad.packings.files.text import is_ordinary
from bedrad.walls import Plate, Rod, Tube, Wall

__all__ = ["Job", "load_job", "parse_job"]


class WallSection(Section):
    """The wall: its shape, and its diameter unless it is flat."""

    shape: Literal["tube", "rod", "plate"] = "tube"
    diameter: PositiveLength | None = None

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


class Size(Section):
    """One size of a size distribution."""

    diameter: PositiveLength
    share: Positive


class SettleSection(Section):
    """A bed settled by the discrete-element method."""

    height: PositiveLength
    diameter: PositiveLength | None = None
    sizes: Annotated[tuple[Size, ...], Field(max_length=100)] | None = None
    density: Annotated[Density, Field(gt=0)] = 3800.0
    friction: NotNegative = 0.4
    wall_friction: NotNegative | None = None
    restitution: BelowOne = 0.85
    stiffness: Annotated[Stiffness, Field(gt=0)] | None = None
    ranks: PositiveInt = 1

    @model_validator(mode="after")
    def _check_sizes(self) -> SettleSection:
        if (self.diameter is None) == (self.sizes is None) or self.sizes == ():
            raise ValueError("give a diameter or sizes, one of the two")
        return self


class PackingSection(Section):
    """Where the bed comes from: one of `settle` and `file`."""

    settle: SettleSection | None = None
    file: FileSection | None = None

    @model_validator(mode="after")
    def _check_source(self) -> PackingSection:
        if (self.settle is None) == (self.file is None):
            raise ValueError("give one source of the bed, [packing.settle] or [packing.file]")
        return self


class LayersSection(Section):
    """How the bed is cut: a wall layer one radius deep, the others one diameter deep."""

    count: Count = 3
    margin: NotNegative = 4.0


class StatisticsSection(Section):
    """Measured packing statistics; the gap counts as contact, in particle radii."""

    contact_gap: NotNegative = 1e-2


class ViewFactorsSection(Section):
    """Ray-traced view factors, to a standard error or with a number of rays."""

    tolerance: Positive | None = None
    rays: Annotated[int, Field(gt=0, le=2**35, strict=True)] | None = None

    @model_validator(mode="after")
    def _check_effort(self) -> ViewFactorsSection:
        if self.tolerance is not None and self.rays is not None:
            raise ValueError("give tolerance or rays, not both")
        return self


class ConvergenceSection(Section):
    """Error of the view factors against run time, on this bed."""

    rays: PositiveInt = 2**20
    reference_rays: PositiveInt = 2**25
    seeds: Annotated[int, Field(ge=2, strict=True)] = 8

    @model_validator(mode="after")
    def _check_reference(self) -> ConvergenceSection:
        if self.reference_rays < 16 * self.rays:
            raise ValueError(
                f"reference_rays is {self.reference_rays}; expected at least 16 times rays, {16 * self.rays}"
            )
        return self


class OutputSection(Section):
    """What is written beside the results file."""

    tables: YesNo = True
    figures: YesNo = True


class Job(Section):
    """A checked job.

    Attributes
    ----------
    name : str
        Title of the job, for figures and tables.
    seed : int
        Seed of everything random.
    wall, packing, sweep, layers, statistics, view_factors, convergence, prediction, output
        The sections; a stage without its section does not run.
    """

    name: Annotated[str, Field(max_length=200)] = "bedrad job"
    seed: Seed = 0
    wall: WallSection | None = None
    packing: PackingSection | None = None
    sweep: SweepSection | None = None
    layers: LayersSection = LayersSection()
    statistics: StatisticsSection | None = None
    view_factors: ViewFactorsSection | None = None
    convergence: ConvergenceSection | None = None
    prediction: PredictionSection | None = None
    output: OutputSection = OutputSection()

    @model_validator(mode="after")
    def _check_stages(self) -> Job:
        if self.packing is not None and self.packing.settle is not None:
            if self.wall is None:
                raise ValueError("[packing.settle] needs a [wall]")
            if self.wall.shape != "tube":
                raise ValueError(f"[packing.settle] is for a tube; the wall is a {self.wall.shape}")
        measured = [n for n in ("statistics", "view_factors", "convergence") if getattr(self, n) is not None]
        if measured and self.packing is None:
            raise ValueError(f"[{measured[0]}] needs a [packing]")
        if self.sweep is not None:
            self._check_sweep(room_needed=bool(measured))
        elif measured and self.packing is not None and self.packing.settle is not None and self.wall is not None:
            self._check_size(self.packing.settle, self.wall)
        self._check_wall()
        if self.prediction is None and self.packing is None:
            raise ValueError("nothing to do: give a [packing] or a [prediction]")
        return self

    @property
    def is_ensemble(self) -> bool:
        """Whether the job names many beds, each a unit of work."""
        file = None if self.packing is None else self.packing.file
        return self.sweep is not None or (file is not None and file.is_many)

    def swept(self, values: Mapping[str, float]) -> Job:
        """The job of one bed of the sweep: with these values of what is swept."""
        wall, packing = self.wall, self.packing
        if "tube_diameter" in values and wall is not None:
            wall = wall.model_copy(update={"diameter": values["tube_diameter"]})
        if "particle_diameter" in values and packing is not None and packing.settle is not None:
            bed = packing.settle.model_copy(update={"diameter": values["particle_diameter"]})
            packing = packing.model_copy(update={"settle": bed})
        seed = int(values.get("seed", self.seed))
        return self.model_copy(update={"wall": wall, "packing": packing, "seed": seed, "sweep": None})

    def _check_sweep(self, *, room_needed: bool) -> None:
        """Refuse a sweep without a bed to settle, or with one that has no room for what is measured."""
        assert self.sweep is not None  # noqa: S101 - called with one
        if self.packing is None or self.packing.settle is None:
            raise ValueError("[sweep] needs a [packing.settle]")
        if self.sweep.particle_diameter is not None and self.packing.settle.sizes is not None:
            raise ValueError("sweep.particle_diameter is for beds of one size; packing.settle.sizes gives several")
        values = {name: listed for name, listed in self.sweep.values().items() if name != "seed"}
        for combination in itertools.product(*values.values()):
            one = self.swept(dict(zip(values, combination, strict=True)))
            if room_needed and one.wall is not None and one.packing is not None and one.packing.settle is not None:
                self._check_size(one.packing.settle, one.wall)

    def _check_wall(self) -> None:
        """Refuse two walls, and a prediction for what is no tube or has no wall at all."""
        fitted = None if self.packing is None or self.packing.file is None else self.packing.file.wall
        if self.wall is not None and fitted is not None:
            raise ValueError("give the wall by a [wall] or by packing.file.wall, not both")
        if self.prediction is None:
            return
        shape = fitted if self.wall is None else self.wall.shape
        if shape in ("rod", "plate"):
            raise ValueError(f"[prediction] is for flow in a tube; the wall is a {shape}")
        if self.packing is None and (self.wall is None or self.prediction.particle_diameter is None):
            raise ValueError("[prediction] without a [packing] needs a [wall] and a particle_diameter")

    def _check_size(self, settle: SettleSection, wall: WallSection) -> None:
        """Refuse what could only fail after the settling: layers or margins that the bed has no room for."""
        if settle.diameter is None or wall.diameter is None:
            return
        deepest, ends = (self.layers.count - 0.5) * settle.diameter, 2 * self.layers.margin * settle.diameter
        if deepest > wall.diameter / 2:
            raise ValueError(
                f"layers.count is {self.layers.count}: the last layer would end {deepest:.4g} m deep, beyond the axis "
                f"of the tube at {wall.diameter / 2:.4g} m"
            )
        if ends >= settle.height:
            raise ValueError(
                f"layers.margin is {self.layers.margin:g}: leaving out {ends:.4g} m of a bed {settle.height:.4g} m "
                "high leaves nothing to measure"
            )

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
        if not is_ordinary(file):
            raise BadFileError(f"{file}: is a pipe or a device; expected a text file")
        if file.stat().st_size > LARGEST:
            raise BadFileError(f"{file}: has {file.stat().st_size} bytes; a job has at most {LARGEST}")
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
    # beside its own error, a number of thousands of digits or thousands of open brackets
    except (ValueError, RecursionError) as error:
        raise BadFileError(f"{file}: not a TOML file: {error}") from None
    try:
        job = Job.model_validate(data)
    except ValidationError as error:
        raise BadFileError("\n".join(f"{file}: {line}" for line in _problems(error))) from None
    if job.packing is not None and job.packing.file is not None:
        bed = job.packing.file.in_folder(file.parent)
        job = job.model_copy(update={"packing": job.packing.model_copy(update={"file": bed})})
    return job


LARGEST = 2**16
"""Bytes of a job, which HDF5 keeps as an attribute of at most so many."""

MOST_PROBLEMS = 20
"""Problems of a job that are told."""

_EXPECTED = {
    "missing": "required, and not there",
    "model_type": "expected a table of keys and values",
    "too_long": "too many items",
    "tuple_type": "expected a list",
    "path_type": "expected a path as text",
}
"""Words for what pydantic says about its own types, by the type of the error."""


def _problems(error: ValidationError) -> list[str]:
    """One line for each problem: field, what is wrong, the value, what was expected."""
    lines = []
    for problem in error.errors():
        if problem["type"] == "extra_forbidden":
            lines.append(_unknown(problem["loc"]))
            continue
        place = _dotted(_keys(problem["loc"]))
        text = _EXPECTED.get(problem["type"], problem["msg"].removeprefix("Value error, "))
        text = text[0].lower() + text[1:]
        value = problem["input"]
        shown = "" if isinstance(value, dict) or text.startswith(shortened(value)) else f" (it is {shortened(value)})"
        lines.append(f"{place or 'job'}: {text}{shown}")
    if len(lines) > MOST_PROBLEMS:
        lines[MOST_PROBLEMS:] = [f"and {len(lines) - MOST_PROBLEMS} more problems"]
    return lines


def _keys(place: tuple[int | str, ...]) -> list[str]:
    """The keys in pydantic's error path, which also names alternatives of a union."""
    return [str(part) for part in place if not _is_tag(part)]


def _dotted(keys: list[str]) -> str:
    """Path of a field, as TOML writes keys: quoted unless they are bare."""
    return ".".join(key if re.fullmatch("[A-Za-z0-9_-]+", key) else json.dumps(key) for key in keys)


def _is_tag(part: object) -> bool:
    """Whether a piece of pydantic's error path names an alternative of a union and not a field."""
    return part in ("<one>", "<list>")


def _unknown(place: tuple[int | str, ...]) -> str:
    """Name an unknown key, and the known one nearest to it or all that are known."""
    known, key = sorted(_fields_at(place[:-1])), str(place[-1])
    near = difflib.get_close_matches(key, known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"known here: {', '.join(known)}"
    return f"{_dotted([*_keys(place[:-1]), key])}: unknown key; {hint}"


def _fields_at(place: tuple[int | str, ...]) -> set[str]:
    model: Any = Job
    for part in place:
        if isinstance(part, int) or _is_tag(part):
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
