"""The section [sweep] of a job: settled beds, or flows, of several sizes, velocities and seeds."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Annotated

from pydantic import Discriminator, Field, Tag, model_validator

from bedrad.jobs.section import PositiveLength, PositiveVelocity, Section, Seed, form_of

__all__ = ["MOST_BEDS", "SweepSection"]

MOST_BEDS = 1_000_000
"""More beds than this are refused."""

_LISTED = 500


class SeedRange(Section):
    """Seeds one after the other."""

    first: Seed = 1
    count: Annotated[int, Field(gt=0, le=MOST_BEDS, strict=True)]

    def values(self) -> tuple[int, ...]:
        """The seeds."""
        return tuple(range(self.first, self.first + self.count))


Lengths = Annotated[tuple[PositiveLength, ...], Field(min_length=1, max_length=_LISTED)]


class SweepSection(Section):
    """Every combination of what is listed is a bed; what is not listed is as in the rest of the job."""

    tube_diameter: Lengths | None = None
    particle_diameter: Lengths | None = None
    velocity: Annotated[tuple[PositiveVelocity, ...], Field(min_length=1, max_length=_LISTED)] | None = None
    seed: Annotated[
        Annotated[SeedRange | None, Tag("<one>")]
        | Annotated[tuple[Seed, ...], Field(min_length=1, max_length=_LISTED), Tag("<list>")],
        Discriminator(form_of),
    ] = None

    @model_validator(mode="after")
    def _check(self) -> SweepSection:
        values = self.values()
        if not values:
            raise ValueError("give a list of tube_diameter, particle_diameter, velocity or seed")
        for name, given in values.items():
            if len(set(given)) < len(given):
                raise ValueError(f"{name} names a value twice")
        if (count := math.prod(map(len, values.values()))) > MOST_BEDS:
            raise ValueError(f"{count:,} beds; expected at most {MOST_BEDS:,}")
        return self

    def values(self) -> dict[str, tuple[float, ...]]:
        """What is listed, by name. [m], [m/s], and seeds"""
        seeds = self.seed.values() if isinstance(self.seed, SeedRange) else self.seed
        given = {
            "tube_diameter": self.tube_diameter,
            "particle_diameter": self.particle_diameter,
            "velocity": self.velocity,
            "seed": seeds,
        }
        return {name: values for name, values in given.items() if values is not None}

    def combinations(self) -> Iterator[dict[str, float]]:
        """Every combination, by name; seeds change first."""
        values = self.values()
        for combination in itertools.product(*values.values()):
            yield dict(zip(values, combination, strict=True))
