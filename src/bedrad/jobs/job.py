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
from bedrad.jobs.flow_section import FlowSection
from bedrad.jobs.layers_section import LayersSection
from bedrad.jobs.prediction_section import PredictionSection
from bedrad.jobs.section import (
    FieldError,
    NotNegative,
    Positive,
    PositiveInt,
    PositiveLength,
    Section,
    Seed,
    YesNo,
)
from bedrad.jobs.settle_section import SettleSection
from bedrad.jobs.sweep_section import SweepSection
from bedrad.jobs.toml_keys import MOST_PARTS, longest_key
from bedrad.jobs.units import shortened
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


class PackingSection(Section):
    """Where the bed comes from: one of `settle`, `flow` and `file`."""

    settle: SettleSection | None = None
    flow: FlowSection | None = None
    file: FileSection | None = None

    @model_validator(mode="after")
    def _check_source(self) -> PackingSection:
        if sum(source is not None for source in (self.settle, self.flow, self.file)) != 1:
            raise ValueError("give one source of the bed, [packing.settle], [packing.flow] or [packing.file]")
        return self

    @property
    def source(self) -> Literal["settle", "flow", "file"]:
        """Which of them it is."""
        return "settle" if self.settle is not None else "flow" if self.flow is not None else "file"

    @property
    def made(self) -> SettleSection | FlowSection | None:
        """How the bed is made; None if it is read."""
        return self.settle or self.flow


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


_MOST_PLANNED = 100
"""Flows of a sweep that are planned when the job is read; one beyond that cannot be made fails in its turn."""

_SWEPT_OF_BED = {"particle_diameter": "diameter", "velocity": "velocity"}
"""What is swept and belongs to how the bed is made, and its name there."""


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
        measured = [n for n in ("statistics", "view_factors", "convergence") if getattr(self, n) is not None]
        if measured and self.packing is None:
            raise ValueError(f"[{measured[0]}] needs a [packing]")
        self._check_made(measured=bool(measured))
        self._check_wall()
        self._check_velocity()
        if self.prediction is None and self.packing is None:
            raise ValueError("nothing to do: give a [packing] or a [prediction]")
        return self

    @property
    def is_ensemble(self) -> bool:
        """Whether the job may name many beds, each a unit of work; a flow is one, measured over all its frames."""
        packing = self.packing
        return self.sweep is not None or (
            packing is not None and (packing.flow is not None or (packing.file is not None and packing.file.is_many))
        )

    def swept(self, values: Mapping[str, float]) -> Job:
        """The job of one bed of the sweep: with these values of what is swept."""
        wall, packing = self.wall, self.packing
        if "tube_diameter" in values and wall is not None:
            wall = wall.model_copy(update={"diameter": values["tube_diameter"]})
        own = {name: values[key] for key, name in _SWEPT_OF_BED.items() if key in values}
        if own and packing is not None and (made := packing.made) is not None:
            packing = packing.model_copy(update={packing.source: made.model_copy(update=own)})
        seed = int(values.get("seed", self.seed))
        return self.model_copy(update={"wall": wall, "packing": packing, "seed": seed, "sweep": None})

    def _check_made(self, *, measured: bool) -> None:
        """Refuse a sweep without beds to make, and beds that could not be made, or not be measured when they are."""
        made = None if self.packing is None else self.packing.made
        if self.packing is None or made is None:
            if self.sweep is not None:
                raise ValueError("[sweep] needs a [packing.settle] or a [packing.flow]")
            return
        if self.wall is None:
            raise ValueError(f"[packing.{self.packing.source}] needs a [wall]")
        if self.wall.shape != "tube":
            raise ValueError(f"[packing.{self.packing.source}] is for a tube; the wall is a {self.wall.shape}")
        values = {} if self.sweep is None else self.sweep.values()
        if "particle_diameter" in values and made.sizes is not None:
            raise ValueError(
                f"sweep.particle_diameter is for beds of one size; packing.{self.packing.source}.sizes gives several"
            )
        if "velocity" in values and self.packing.flow is None:
            raise ValueError("sweep.velocity is for a [packing.flow]; a settled bed does not move")
        shapes = {name: listed for name, listed in values.items() if name != "seed"}
        combinations = itertools.product(*shapes.values())
        for combination in itertools.islice(combinations, None if self.packing.settle else _MOST_PLANNED):
            one = self.swept(dict(zip(shapes, combination, strict=True)))
            assert one.packing is not None  # noqa: S101 - as this has one
            assert one.wall is not None  # noqa: S101 - the same
            if one.packing.made is not None:
                one.packing.made.check_room(one.wall.build(), one.layers, measured=measured)

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

    def _check_velocity(self) -> None:
        """Refuse a prediction without a velocity, or with another one than that of its flow."""
        if self.prediction is None:
            return
        flows = self.packing is not None and self.packing.flow is not None
        if flows and self.prediction.velocity is not None:
            raise FieldError("prediction.velocity", "a [packing.flow] has its own, which is measured; leave it out")
        if not flows and self.prediction.velocity is None:
            raise FieldError("prediction.velocity", "required, and not there")

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
    parts, line = longest_key(text)
    if parts > MOST_PARTS:
        raise BadFileError(f"{file}: line {line}: a key of {parts} parts; those of a job have at most {MOST_PARTS}")
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
        place = getattr(problem.get("ctx", {}).get("error"), "field", "") or _dotted(_keys(problem["loc"]))
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
