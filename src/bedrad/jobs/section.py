"""What the sections of a job share: the base class, and numbers within bounds."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from bedrad.jobs.units import Length, Temperature, Velocity

__all__ = [
    "BelowOne",
    "Count",
    "FieldError",
    "Finite",
    "NotNegative",
    "Positive",
    "PositiveInt",
    "PositiveLength",
    "PositiveTemperature",
    "PositiveVelocity",
    "Section",
    "Seed",
    "UpToOne",
    "YesNo",
    "form_of",
]

PositiveInt = Annotated[int, Field(gt=0, strict=True)]
Count = Annotated[int, Field(gt=0, le=10_000, strict=True)]
# HDF5 keeps integers of 64 bits, and texts, such as the whole job, of 64 KiB
Seed = Annotated[int, Field(ge=0, lt=2**63, strict=True)]
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False, strict=True)]
BelowOne = Annotated[float, Field(gt=0, lt=1, strict=True)]
UpToOne = Annotated[float, Field(gt=0, le=1, strict=True)]
YesNo = Annotated[bool, Field(strict=True)]
PositiveLength = Annotated[Length, Field(gt=0)]
PositiveVelocity = Annotated[Velocity, Field(gt=0)]
PositiveTemperature = Annotated[Temperature, Field(gt=0)]


class FieldError(ValueError):
    """A problem of one field that shows only beside others; `field` is its path."""

    def __init__(self, field: str, problem: str) -> None:
        super().__init__(problem)
        self.field = field


def form_of(value: object) -> str:
    """Tag of the alternative that a value is meant as, so that only that one's errors are told."""
    return "<list>" if isinstance(value, (list, tuple)) else "<one>"


class Section(BaseModel):
    """A table of the job; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)
