"""What a stage of a job is: a function of the job and of what earlier stages found, that says how to fill its group."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import h5py
import numpy as np
from numpy.typing import NDArray

from bedrad.jobs.job import Job
from bedrad.jobs.results import StageData
from bedrad.packings.flow import Flow
from bedrad.packings.packing import Packing

__all__ = ["Earlier", "Fill", "FloatArray", "Progress", "Runner"]


class Earlier(Protocol):
    """What a stage builds on: the bed, and the stages before; a results file, or a unit of work in memory."""

    @property
    def threads(self) -> int | None:
        """Threads of the stages that can have several; None for all processors."""

    def bed(self) -> Packing:
        """The bed; of a flow the first frame."""

    def flow(self) -> Flow | None:
        """The flow that the bed is of, which is measured over all its frames; None for a bed at rest."""

    def read(self, stage: str) -> StageData:
        """What an earlier stage holds."""


FloatArray = NDArray[np.float64]
Fill = Callable[[h5py.Group], None]
Progress = Callable[[float, str], None]
Runner = Callable[[Job, Earlier, Progress], Fill]
